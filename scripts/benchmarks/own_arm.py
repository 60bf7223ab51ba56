"""Arms with their own lengths and tools, against the catalogue's.

In the inverse kinematics, the catalogue's kernel holds its numbers as constants; the
others receive an arm's. Each kernel solves positions that its arm reaches, in the C
code alone: one target at a time without and with the processor's vectors, and in a
batch. Own lengths should cost at most 1.25, a tool beside the wrist axis at most 1.5
times the catalogue's arm. The kernels of the dynamics receive any arm's numbers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from benchmarks.timing import Row, measure

import alpha5_model as a5
from alpha5_model.codegen.kernels.choice import module
from alpha5_model.kinematics.arm_shape import ArmShape
from alpha5_model.kinematics.solver import OFF_AXIS, ON_AXIS

TARGETS = 100_000
#: Fewer than a kernel takes at a time: so many are solved one by one.
FEW = 31
#: Largest error of a solved position [m].
SOLVED = 1e-15
CATALOGUE = "catalogue's arm"


def missing() -> list[str]:
    """Peers that are not installed: there are none."""
    return []


def rows() -> list[Row]:
    """Measured rows of this section."""
    kernels = module()
    measured = []
    if hasattr(kernels, "width"):
        kernels.width(1)
        measured += _rows("one target, scalar C", FEW)
        kernels.width(8)
    measured += _rows("one target", FEW)
    measured += _rows("100 000 targets", TARGETS)
    measured += _dynamics_rows()
    return measured


def _dynamics_rows() -> list[Row]:
    """Inverse dynamics of many states, by kernels in one thread."""
    printed = a5.parameters()
    rows = list(printed.dh)
    rows[1] = replace(rows[1], a=rows[1].a + 0.01)
    arms = {
        CATALOGUE: a5.load(),
        "own lengths": a5.load(arm=replace(printed, dh=tuple(rows))),
    }
    q, v, a = np.random.default_rng(7).uniform(0.3, 2.0, (3, TARGETS, 4))
    calls: dict[str, Callable[[], Any]] = {}
    for name, arm in arms.items():
        calls[name] = partial(arm.inverse_dynamics_batch, q, v, a)
    seconds = measure(calls, per_call=TARGETS, rounds=41)
    work = "inverse dynamics of any arm: 100 000 states"
    return [
        Row(work=work, candidate=name, seconds=time) for name, time in seconds.items()
    ]


def _arms() -> dict[str, tuple[str, ArmShape]]:
    """Candidate -> kernel and arm."""
    ours = ArmShape.from_parameters(a5.parameters())
    return {
        CATALOGUE: ("inverse_kinematics", ours),
        "own lengths": (ON_AXIS, ours._replace(a_1=0.16, z=-0.21)),
        "tool beside the axis": (OFF_AXIS, ours._replace(x=0.03, y=0.04, z=-0.21)),
    }


def _rows(work: str, count: int) -> list[Row]:
    """One kind of work of all arms."""
    solvers: dict[str, Callable[[], Any]] = {}
    shares = {}
    for name, (kernel, shape) in _arms().items():
        q = np.random.default_rng(7).uniform(shape.lower, shape.upper, (count, 4))
        position = _tips(shape, q)
        outputs = [np.empty((count, size)) for size in (16, 4, 4, 1)]
        numbers = np.empty(0) if name == CATALOGUE else shape.numbers
        wrist = np.ascontiguousarray(q[:, 3])
        solvers[name] = partial(
            module().batch, kernel, numbers, position, wrist, *outputs
        )
        solvers[name]()
        shares[name] = _solved(shape, position, outputs[0], outputs[2])

    seconds = measure(solvers, per_call=count, rounds=41)
    return [
        Row(
            work=f"IK of any arm: {work}",
            candidate=name,
            seconds=time,
            success=shares[name],
        )
        for name, time in seconds.items()
    ]


def _solved(
    shape: ArmShape, position: np.ndarray, angles: np.ndarray, within: np.ndarray
) -> float:
    """Share of targets that a solution within the limits reaches."""
    q = angles.reshape(-1, 4, 4)
    error = np.abs(_tips(shape, q) - position[:, None]).max(axis=-1)
    good = (within != 0.0) & (error < SOLVED)
    return float(good.any(axis=-1).mean())


def _tips(shape: ArmShape, q: np.ndarray) -> np.ndarray:
    """tcp positions (..., 3) at joint positions (..., 4)."""
    psi = q[..., 3] + shape.wrist_offset
    c = shape.a_2 + shape.x * np.cos(psi) - shape.y * np.sin(psi)
    w = -(shape.x * np.sin(psi) + shape.y * np.cos(psi))
    phi = q[..., 1] + shape.phi_offset
    chi = phi - q[..., 2] - shape.elbow_offset
    r = shape.a_0 + shape.a_1 * np.cos(phi) + c * np.cos(chi) + shape.z * np.sin(chi)
    z = shape.d_0 + shape.a_1 * np.sin(phi) + c * np.sin(chi) - shape.z * np.cos(chi)
    azimuth = q[..., 0] + shape.azimuth_offset
    x = r * np.cos(azimuth) - w * np.sin(azimuth)
    y = r * np.sin(azimuth) + w * np.cos(azimuth)
    return np.stack([x, y, z], axis=-1)
