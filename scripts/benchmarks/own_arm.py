"""Arms with their own lengths and tools, against the catalogue's.

All arms use the same kernels, which receive an arm's numbers. A tool beside the wrist
axis should cost at most 1.5 times the catalogue's arm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from benchmarks.timing import Row, measure

import alpha5_model as a5
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tool import ToolPose
from alpha5_model.theory.dh.alpha5_table import alpha5_table
from alpha5_model.theory.dh.chain import DHChain

TARGETS = 100_000
#: Largest error of a solved position [m].
SOLVED = 1e-14
CATALOGUE = "catalogue's arm"


def missing() -> list[str]:
    """Peers that are not installed: there are none."""
    return []


def rows() -> list[Row]:
    """Measured rows of this section."""
    return [
        *_inverse_kinematics("one target", 1),
        *_inverse_kinematics("100 000 targets", TARGETS),
        *_dynamics(),
    ]


def _arms() -> dict[str, Alpha5Parameters]:
    printed = a5.parameters()
    dh = list(printed.dh)
    dh[1] = replace(dh[1], a=dh[1].a + 0.01)
    beside = ToolPose(position=np.array([0.03, 0.04, -0.21]), rotation=np.eye(3))
    return {
        CATALOGUE: printed,
        "own lengths": replace(printed, dh=tuple(dh)),
        "tool beside the axis": replace(printed, tool=beside),
    }


def _inverse_kinematics(work: str, count: int) -> list[Row]:
    """One kind of work of all arms."""
    solvers: dict[str, Callable[[], Any]] = {}
    shares = {}
    for name, record in _arms().items():
        joints = record.joints[:4]
        lower = [joint.lower for joint in joints]
        upper = [joint.upper for joint in joints]
        q = np.random.default_rng(7).uniform(lower, upper, (count, 4))
        chain = DHChain(**alpha5_table(record))
        position = chain.forward_kinematics(q)[:, :3, 3].copy()
        given = (position, q[:, 3].copy()) if count > 1 else (position[0], q[0, 3])
        solvers[name] = partial(a5.inverse_kinematics, *given, arm=record)

        solutions = a5.inverse_kinematics(position, q[:, 3], arm=record)
        tips = chain.forward_kinematics(np.nan_to_num(solutions.q))[..., :3, 3]
        error = np.abs(tips - position[:, None]).max(axis=-1)
        good = solutions.within_limits & (error < SOLVED)
        shares[name] = float(good.any(axis=-1).mean())

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


def _dynamics() -> list[Row]:
    """Inverse dynamics of many states, by kernels in one thread."""
    q, v, a = np.random.default_rng(7).uniform(0.3, 2.0, (3, TARGETS, 4))
    calls: dict[str, Callable[[], Any]] = {}
    for name, record in _arms().items():
        calls[name] = partial(a5.load(arm=record).inverse_dynamics_batch, q, v, a)
    seconds = measure(calls, per_call=TARGETS, rounds=41)
    work = "inverse dynamics of any arm: 100 000 states"
    return [
        Row(work=work, candidate=name, seconds=time) for name, time in seconds.items()
    ]
