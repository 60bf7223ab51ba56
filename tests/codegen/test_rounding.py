"""The kernels are right if another library has changed the rounding of this thread.

The compiled sines bring an angle to a quarter turn by an addition that rounds. With
another rounding they were off by 1e-10.
"""

from __future__ import annotations

import ctypes.util
import os
import platform
import subprocess
import sys

import pytest
from compiled_kernels import compiled_kernels

#: fesetround's words for down, up and to zero, by processor.
MODES = {
    "x86_64": (0x400, 0x800, 0xC00),
    "aarch64": (0x800000, 0x400000, 0xC00000),
}
LIBM = ctypes.util.find_library("m")

CHILD = """
import ctypes, sys
import numpy as np
import alpha5_model as a5

libm = ctypes.CDLL(sys.argv[1])
mode, exact = int(sys.argv[2]), sys.argv[3] == "compiled"
rng = np.random.default_rng(2)
q, v, a = rng.normal(scale=3.0, size=(3, 203, 4))
q[7] *= 1e6  # sines of libm
position = rng.uniform(-0.3, 0.3, (203, 3))
arm = a5.load()

def answers():
    yield arm.inverse_dynamics_batch(q, v, a)
    yield arm.forward_dynamics_batch(q, v, a)
    yield arm.base_wrench_batch(q, v, a)
    yield arm.regressor(q, v, a).matrix
    yield a5.inverse_kinematics(position).q
    for i in range(20):
        yield a5.inverse_kinematics(position[i]).q

# They tell the rounding of the processor's vectors, which fegetround may not read.
def sums(one=1.0, little=1e-30):
    return one + little, one - little

wanted = list(answers())
to_nearest = sums()
assert libm.fesetround(mode) == 0
before = sums()
got = list(answers())
after = sums()
left = libm.fegetround()
libm.fesetround(0)
assert left == mode, (left, mode)
assert before == after != to_nearest, (before, after)
for x, y in zip(got, wanted, strict=True):
    assert np.array_equal(np.isnan(x), np.isnan(y))
    x, y = np.nan_to_num(x), np.nan_to_num(y)
    off = np.abs(x - y).max() / max(1.0, np.abs(y).max())
    assert off == 0.0 if exact else off < 1e-11, off
"""


@pytest.mark.slow
@pytest.mark.skipif(LIBM is None, reason="no libm")
@pytest.mark.parametrize("kernels", ["compiled", "numpy"])
@pytest.mark.parametrize("mode", MODES.get(platform.machine(), ()))
def test_rounding_changes_nothing_and_stays(mode: int, kernels: str) -> None:
    if kernels == "compiled":
        compiled_kernels()
    environment = {**os.environ, "ALPHA5_KERNELS": kernels}
    command = [sys.executable, "-c", CHILD, str(LIBM), str(mode), kernels]
    child = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False
    )
    assert child.returncode == 0, child.stderr
