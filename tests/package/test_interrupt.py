"""Ctrl-C in a batch: it ends at once, on whatever computes it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest

import alpha5_model as a5

#: From the signal to the answer [s], with time to spare: batches take many times that.
LIMIT = 1.0
#: On a machine that does other work, the quickest of so many.
ATTEMPTS = 4

CHILD = """
import signal, sys, time
import numpy as np
import pinocchio as pin
import alpha5_model as a5

gripper, floating, method, states, moving = sys.argv[1:]
arm = a5.load(gripper=gripper, floating_base=floating == "floating")
q = np.broadcast_to(pin.neutral(arm.model), (int(states), arm.model.nq))
v = np.broadcast_to(np.ones(arm.model.nv), (int(states), arm.model.nv))
if moving == "moving":
    arm = arm.with_hydrodynamics((0.1, 0.0, 0.0))
batch = getattr(arm, method)
batch(q[:2], v[:2], v[:2])
signal.signal(signal.SIGINT, signal.default_int_handler)
print("ready", flush=True)
try:
    batch(q, v, v, threads=1)
    print("computed")
except KeyboardInterrupt:
    print(time.monotonic())
"""

#: What computes: gripper, base, method, states (seconds of work), water, kernels.
CASES = {
    "compiled": (
        "locked",
        "fixed",
        "forward_dynamics_batch",
        "20000000",
        "still",
        "compiled",
    ),
    "compiled, current": (
        "locked",
        "fixed",
        "inverse_dynamics_batch",
        "1000000",
        "moving",
        "compiled",
    ),
    "NumPy": (
        "locked",
        "fixed",
        "forward_dynamics_batch",
        "20000000",
        "still",
        "numpy",
    ),
    "Pinocchio": (
        "locked",
        "floating",
        "inverse_dynamics_batch",
        "1000000",
        "still",
        "numpy",
    ),
    "Pinocchio, ABA": (
        "locked",
        "floating",
        "forward_dynamics_batch",
        "1000000",
        "still",
        "numpy",
    ),
    "Pinocchio, mount": (
        "locked",
        "floating",
        "base_wrench_batch",
        "1000000",
        "still",
        "numpy",
    ),
    "Pinocchio, solved": (
        "jaws",
        "fixed",
        "forward_dynamics_batch",
        "1000000",
        "still",
        "numpy",
    ),
}


@contextmanager
def computing(*arguments: str, kernels: str) -> Iterator[subprocess.Popen[str]]:
    """A child that has just begun to compute a batch."""
    environment = {**os.environ, "ALPHA5_KERNELS": kernels}
    command = [sys.executable, "-c", CHILD, *arguments]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, text=True
    ) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "ready\n"
        yield child


def delay(*arguments: str, kernels: str) -> float:
    """Seconds from the signal to its answer; infinite if the batch ran to its end."""
    with computing(*arguments, kernels=kernels) as child:
        time.sleep(0.7)
        sent = time.monotonic()
        child.send_signal(signal.SIGINT)
        answer = child.stdout.readline().strip()
    return float("inf") if answer == "computed" else float(answer) - sent


def whole(*arguments: str, kernels: str) -> float:
    """Seconds that the batch takes without a signal."""
    with computing(*arguments, kernels=kernels) as child:
        begin = time.monotonic()
        assert child.stdout.readline() == "computed\n"
        return time.monotonic() - begin


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT for a child")
@pytest.mark.parametrize("case", CASES)
def test_a_batch_ends_upon_ctrl_c(case: str) -> None:
    *arguments, kernels = CASES[case]
    if kernels == "compiled":
        pytest.importorskip(
            "alpha5_model.kernels._compiled",
            reason="the kernels are not compiled here",
            exc_type=ImportError,
        )
    quickest = float("inf")
    for _ in range(ATTEMPTS):
        quickest = min(quickest, delay(*arguments, kernels=kernels))
        if quickest < LIMIT:
            return
    # On a slow or busy machine the batch takes longer, too.
    assert quickest < whole(*arguments, kernels=kernels) / 3


@pytest.mark.slow
@pytest.mark.skipif(
    not hasattr(signal, "setitimer"), reason="no such timer on this system"
)
def test_signals_are_answered_within_a_batch_and_change_nothing() -> None:
    compiled = pytest.importorskip(
        "alpha5_model.kernels._compiled",
        reason="the kernels are not compiled here",
        exc_type=ImportError,
    )
    rng = np.random.default_rng(5)
    parameters = a5.load()._kernel_parameters
    q, v, tau = rng.normal(
        scale=1e6, size=(3, 150_000, 4)
    )  # slow: sines of large angles
    parts = [slice(start, start + 1000) for start in range(0, len(q), 1000)]
    wanted = [
        compiled.rows("forward_dynamics", parameters, q[part], v[part], tau[part])[0]
        for part in parts
    ]
    answered: list[int] = []
    before = signal.signal(signal.SIGALRM, lambda number, _: answered.append(number))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.005, 0.005)
        (out,) = compiled.rows("forward_dynamics", parameters, q, v, tau)
        within = len(answered)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert within > 1
    np.testing.assert_array_equal(out, np.concatenate(wanted))
