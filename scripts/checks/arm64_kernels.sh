#!/usr/bin/env bash
# Do the kernels of a Raspberry Pi or a Jetson give the bits of this machine? Compiles them for ARM64 as a wheel, runs
# that by qemu with Debian's Python for ARM64, and compares each number with what this machine computes.
#
#     scripts/checks/arm64_kernels.sh PYTHON [FOLDER]
#
# PYTHON has this package with compiled kernels; the wheel is left in FOLDER. Needs Debian's
# gcc-aarch64-linux-gnu and qemu-user-static. An emulator says nothing of the speed.
set -euo pipefail
repository=$(cd "$(dirname "$0")/../.." && pwd)
python=$(command -v "$1")
case $python in /*) ;; *) python=$PWD/$python ;; esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
wheels=${2:-$work/wheels}
mkdir -p "$wheels" "$work"/{debs,root,site}
retry=(bash "$repository/scripts/checks/retry.sh")
for program in aarch64-linux-gnu-gcc qemu-aarch64-static; do
  command -v $program >/dev/null || { echo "$program is not here: apt-get install gcc-aarch64-linux-gnu qemu-user-static"; exit 1; }
done

# Debian's packages of another architecture, by lists of our own: the system's stay as they are.
mkdir -p "$work"/apt/{state/lists/partial,cache/archives/partial} && touch "$work/apt/status"
apt=(apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Acquire::Languages=none -o Debug::NoLocking=1
  -o "Dir::State=$work/apt/state" -o "Dir::State::status=$work/apt/status" -o "Dir::Cache=$work/apt/cache" -o APT::Sandbox::User=root)
"${retry[@]}" "${apt[@]}" update
(cd "$work/debs" && "${retry[@]}" "${apt[@]}" download python3.11-minimal libpython3.11-{minimal,stdlib,dev} libc6 libgcc-s1 libgomp1 \
  libstdc++6 zlib1g libexpat1 libssl3 libffi8 libbz2-1.0 liblzma5)
for package in "$work"/debs/*.deb; do dpkg-deb -x "$package" "$work/root"; done

# NumPy of the version that this machine has, here to build and there to run.
numpy=$("$python" -c "import numpy; print(numpy.__version__)")
"$python" -m venv "$work/build"
"${retry[@]}" "$work/build/bin/python" -m pip install --quiet hatchling setuptools "numpy==$numpy"
"${retry[@]}" "$work/build/bin/python" -m pip download --quiet --dest "$work" --no-deps --only-binary=:all: --python-version 3.11 \
  --platform manylinux_2_17_aarch64 --platform manylinux_2_27_aarch64 --platform manylinux_2_28_aarch64 "numpy==$numpy"

# The wheel: the build hook takes the compiler, and the platform's name, from the environment.
headers=$work/root/usr/include
(cd "$repository" && ALPHA5_REQUIRE_KERNELS=1 _PYTHON_HOST_PLATFORM=linux-aarch64 CC=aarch64-linux-gnu-gcc \
  LDSHARED="aarch64-linux-gnu-gcc -shared" CFLAGS="-I$headers -I$headers/python3.11" "$work/build/bin/python" -m hatchling build -t wheel -d "$wheels")
wheel=$(ls "$wheels"/alpha5_model-*-cp311-abi3-linux_aarch64.whl)

for file in "$wheel" "$work"/numpy-*aarch64.whl; do "$python" -m zipfile -e "$file" "$work/site"; done

"$python" "$repository/scripts/checks/kernel_bits.py" write "$work/here.npz"
emulated() { qemu-aarch64-static -L "$work/root" -E PYTHONPATH="$work/site" -E OPENBLAS_NUM_THREADS=1 "$work/root/usr/bin/python3.11" "$@"; }
emulated "$repository/scripts/checks/numpy_alone.py" | tee "$work/alone.txt"
grep -q 'kernels: compiled;' "$work/alone.txt"
emulated "$repository/scripts/checks/kernel_bits.py" compare "$work/here.npz"
echo "ARM64 check passed: $(basename "$wheel")"
