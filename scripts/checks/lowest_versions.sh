#!/usr/bin/env bash
# Run the fast tests with the lowest versions that pyproject.toml declares.
#   scripts/checks/lowest_versions.sh UV [arguments of pytest]
# UV is the uv program: it resolves to the lowest versions of direct dependencies.
#
# Everything is in a temporary folder. The source archive is what the tests run from, with
# the kernels that are compiled in the checkout already.
#
# The tests of the scripts are left out: scripts run with the versions in constraints.txt.
set -euo pipefail
uv=$(realpath "$1")
shift
cd "$(dirname "$0")/../.."
repository=$PWD

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export VIRTUAL_ENV=$work/environment PATH="$work/environment/bin:$PATH"
unset PIP_CONSTRAINT
retry=(bash "$repository/scripts/checks/retry.sh")

"${retry[@]}" "$uv" build --quiet --sdist --out-dir "$work" "$repository"
mkdir "$work/checkout"
tar --extract --file "$work"/alpha5_model-*.tar.gz --directory "$work/checkout" --strip-components 1
kernels=alpha5_model/kernels
cp $kernels/_compiled.abi3.so "$work/checkout/$kernels/"

# Recordings are beside the checkout, or named by ALPHA5_RECORDINGS.
if [ -d "$repository/../shared" ]; then
  ln -s "$repository/../shared" "$work/shared"
fi

cd "$work/checkout"
"$uv" venv --quiet --python 3.11 "$VIRTUAL_ENV"
"${retry[@]}" "$uv" pip install --quiet --resolution lowest-direct --editable '.[test]'
"$uv" pip list | grep -E '^(numpy|pin|scipy|rich|mujoco|pytest) '
python -m pytest --numprocesses 2 --dist loadfile --ignore tests/scripts -m "not slow and not browser and not tools" "$@"
