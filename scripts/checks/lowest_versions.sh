#!/usr/bin/env bash
# Run the tests with the lowest versions that pyproject.toml declares.
#   scripts/checks/lowest_versions.sh UV [arguments of pytest]
# UV is the uv program: it resolves to the lowest versions of direct dependencies.
set -euo pipefail
cd "$(dirname "$0")/../.."
uv=$1
shift

environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT
export VIRTUAL_ENV=$environment PATH="$environment/bin:$PATH"
unset PIP_CONSTRAINT

"$uv" venv --quiet --clear --python 3.11 "$environment"
bash scripts/checks/retry.sh "$uv" pip install --quiet --resolution lowest-direct --editable '.[test]'
"$uv" pip list | grep -E '^(numpy|pin|scipy|typer|rich|mujoco|pytest) '
python -m pytest --numprocesses 2 --dist loadfile "$@"
