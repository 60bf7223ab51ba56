#!/usr/bin/env bash
# Build the source archive and of it the wheel, install that into an empty environment, use it from an
# unrelated folder; then install the sources where there is no C compiler.
set -euo pipefail
repository=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_CONSTRAINT="$repository/constraints.txt" PIP_DISABLE_PIP_VERSION_CHECK=1

"${PYTHON:-python3}" -m venv "$work/build"
"$work/build/bin/python" -m pip install --quiet hatchling
"${PYTHON:-python3}" -m venv "$work/venv"
(cd "$repository" && "$work/build/bin/python" -m hatchling build -t sdist -d "$work/dist" >"$work/sdist.txt")
export ALPHA5_REQUIRE_KERNELS=1
"$work/venv/bin/python" -m pip wheel --quiet --no-deps --wheel-dir "$work/dist" "$work"/dist/*.tar.gz
ls "$work"/dist/alpha5_model-*-cp311-abi3-*.whl # one for every Python from 3.11
"$work/venv/bin/python" -m pip install --quiet "$work"/dist/*.whl
mkdir "$work/elsewhere" && cd "$work/elsewhere"

"$work/venv/bin/python" - <<'PYTHON'
from collections import Counter
from hashlib import sha256
from importlib.metadata import metadata
from pathlib import Path
from xml.etree import ElementTree
import alpha5_model as a5
import numpy as np

assert "_data" in a5.URDF_PATH and Path(a5.URDF_PATH).is_file(), a5.URDF_PATH
arm = a5.load()
q = np.array([3.0, 1.0, 1.0, 0.5])
v = np.zeros(4)
assert arm.model.nv == 4
assert a5.backend() == "compiled", a5.backend()
np.testing.assert_allclose(arm.inverse_dynamics(q, v, v), arm.hydrostatic_torque(q), atol=1e-12)

# An index shows README.
assert "## Conventions" in metadata("alpha5_model").get_payload()

# The meshes are there once, and MuJoCo's models find them.
data = Path(a5.REPOSITORY_PATH)
meshes = [file for file in data.rglob("*") if file.suffix in (".obj", ".glb")]
copies = Counter(sha256(file.read_bytes()).hexdigest() for file in meshes)
assert len(meshes) == 8 and set(copies.values()) == {1}, meshes
models = [ElementTree.parse(file).getroot() for file in data.glob("mjcf/alpha5*.xml")]
for model in models:
    folder = data / "mjcf" / model.find("compiler").get("meshdir")
    named = [folder / mesh.get("file") for mesh in model.iter("mesh")]
    assert named and all(file.is_file() for file in named), named
assert len(models) == 3, models
PYTHON
"$work/venv/bin/alpha5" --version
"$work/venv/bin/alpha5" --version | grep -q ', kernels: compiled'
"$work/venv/bin/alpha5" generate urdf --gripper jaws --output arm.urdf
grep -q '<mimic joint="axis_a"' arm.urdf
test -s meshes/link_0.obj
for format in mjcf sdf; do "$work/venv/bin/alpha5" generate $format --output $format; done
test -s mjcf/assets/link_0.obj && test -s sdf/meshes/link_0.obj
if "$work/venv/bin/alpha5" generate c --output c 2>error.txt; then exit 1; fi
grep -qF "pip install 'alpha5-model[symbolic]'" error.txt
"$work/venv/bin/alpha5" view --html arm.html
grep -q "function inverse_kinematics" arm.html
"$work/venv/bin/alpha5" check >check.txt || { cat check.txt; exit 1; }
"$work/venv/bin/alpha5" ik 0.3 0.1 0.1
"$work/venv/bin/python" -m alpha5_model --version
if "$work/venv/bin/alpha5" generate urdf --gripper none 2>error.txt; then exit 1; fi
test "$(wc -l <error.txt)" = 1

# Kinematics, kernels and files with NumPy alone.
"${PYTHON:-python3}" -m venv "$work/numpy"
"$work/numpy/bin/python" -m pip install --quiet numpy
"$work/numpy/bin/python" -m pip install --quiet --no-deps "$work"/dist/*.whl
"$work/numpy/bin/python" "$repository/scripts/checks/numpy_alone.py"

# A command for a version such as 3.12, if there is one here: on the path, of uv or of pyenv.
python_of() {
  local found
  for found in "python$1" "$(uv python find "$1" 2>/dev/null)" "$(pyenv prefix "$1" 2>/dev/null)/bin/python"; do
    if "$found" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null; then
      echo "$found" && return
    fi
  done
}

# The same wheel, and the first lines of README, on each Python that is here.
awk '/^```python$/ {inside = 1; next} /^```$/ {if (inside) exit} inside' "$repository/README.md" >first.py
echo 'import numpy as np; print(a5.backend(), tau); assert tau.shape == (4,) and np.isfinite(tau).all()' >>first.py
echo 'assert a5.backend().startswith("compiled")' >>first.py
main=$("$work/venv/bin/python" -c "import sys; print('%d.%d' % sys.version_info[:2])")
ln -s "$work/venv" "$work/$main"
for version in 3.11 3.12 3.13; do
  python=$(python_of "$version")
  if [ ! -e "$work/$version" ]; then
    if [ -z "$python" ]; then
      echo "Python $version is not here: not run"
      continue
    fi
    "$python" -m venv "$work/$version"
    "$work/$version/bin/python" -m pip install --quiet "$work"/dist/*.whl
  fi
  echo "Python $version"
  "$work/$version/bin/python" first.py
  "$work/$version/bin/alpha5" ik 0.25 0.10 0.10
done

# Without a compiler: an error where the kernels are required, else one line, and NumPy computes.
"$work/venv/bin/python" -m pip install --quiet hatchling setuptools editables
without_compiler() { env -u CC PATH="$work/venv/bin" "$work/venv/bin/python" "$@"; }
mkdir "$work/source" && tar -xzf "$work"/dist/*.tar.gz -C "$work/source" --strip-components 1
install=(-m pip install -v --no-deps --no-build-isolation --editable "$work/source")
if without_compiler "${install[@]}" >"$work/required.txt" 2>&1; then exit 1; fi
grep 'RuntimeError: the kernels cannot be compiled here' "$work/required.txt"
unset ALPHA5_REQUIRE_KERNELS
without_compiler "${install[@]}" >"$work/without.txt" 2>&1 || { cat "$work/without.txt"; exit 1; }
grep --max-count 1 "kernels not compiled, NumPy will compute" "$work/without.txt"
without_compiler - <<'PYTHON'
import alpha5_model as a5
import numpy as np

assert a5.backend() == "numpy", a5.backend()
arm = a5.load()
q, v, a = np.random.default_rng(1).uniform(-1.0, 1.0, (3, 100, 4))
single = [arm.inverse_dynamics(*state) for state in zip(q, v, a)]
np.testing.assert_allclose(arm.inverse_dynamics_batch(q, v, a), single, atol=1e-12)
PYTHON
without_compiler -m alpha5_model --version | grep ', kernels: numpy$'
if ALPHA5_KERNELS=compiled without_compiler -c 'import alpha5_model as a5; a5.backend()' 2>error.txt; then exit 1; fi
tail -1 error.txt | grep 'ALPHA5_KERNELS=compiled needs alpha5_model.kernels._compiled'
echo "package check passed"
