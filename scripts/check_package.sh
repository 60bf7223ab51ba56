#!/usr/bin/env bash
# Build the wheel, install it into an empty environment, use it from an unrelated folder.
set -euo pipefail
repository=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_CONSTRAINT="$repository/constraints.txt" PIP_DISABLE_PIP_VERSION_CHECK=1

"${PYTHON:-python3}" -m venv "$work/venv"
"$work/venv/bin/python" -m pip wheel --quiet --no-deps --wheel-dir "$work/dist" "$repository"
"$work/venv/bin/python" -m pip install --quiet "$work"/dist/*.whl
mkdir "$work/elsewhere" && cd "$work/elsewhere"

"$work/venv/bin/python" - <<'PYTHON'
from pathlib import Path
import alpha5_model as a5
import numpy as np

assert "_data" in a5.URDF_PATH and Path(a5.URDF_PATH).is_file(), a5.URDF_PATH
arm = a5.load()
q = np.array([3.0, 1.0, 1.0, 0.5])
v = np.zeros(4)
assert arm.model.nv == 4
np.testing.assert_allclose(arm.inverse_dynamics(q, v, v), arm.hydrostatic_torque(q), atol=1e-12)
PYTHON
"$work/venv/bin/alpha5" --version
"$work/venv/bin/alpha5" generate --gripper jaws --output arm.urdf
grep -q '<mimic joint="axis_a"' arm.urdf
test -s meshes/link_0.obj
for format in mjcf sdf; do "$work/venv/bin/alpha5" generate --format $format --output $format; done
test -s mjcf/assets/link_0.obj && test -s sdf/meshes/link_0.obj
"$work/venv/bin/alpha5" check >check.txt || { cat check.txt; exit 1; }
"$work/venv/bin/alpha5" ik 0.3 0.1 0.1
"$work/venv/bin/python" -m alpha5_model --version
if "$work/venv/bin/alpha5" generate --gripper none 2>error.txt; then exit 1; fi
test "$(wc -l <error.txt)" = 1
"$work/venv/bin/alpha5" generate --check
echo "package check passed"
