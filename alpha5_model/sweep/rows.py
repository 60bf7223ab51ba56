"""Rows of a study, block by block, on any machine: states by their numbers, cases, and their quantities.

A block lies where it lies, however many make a chunk: what NumPy computes of it does not depend on who computes it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.actuators import Actuator
from alpha5_model.checks import FloatArray
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.dynamics import arm_of
from alpha5_model.dynamics.series import frame_positions
from alpha5_model.fluids import SEA_WATER, gravity_in_base
from alpha5_model.parameters import parameters
from alpha5_model.spatial import rotation_from_rpy
from alpha5_model.sweep.study import Study
from alpha5_model.trajectory import SmoothMotion, read_motion, smooth
from alpha5_model.trajectory.analysis import motor_side
from alpha5_model.uncertainty import Sample, sample

#: States computed at a time: what a kernel reads and writes of them stays in the cache.
BLOCK = 8192
#: Numbers set aside for the samples of a recording.
_RECORDED = 2**32
#: Places on the grid, other columns, and the motion.
States = tuple[dict[str, Any], dict[str, Any], SmoothMotion]
#: Numbers of the rows (n,), places on the grid, other columns, quantities (n, 4).
Block = tuple[Any, dict[str, Any], dict[str, Any], dict[str, FloatArray]]


def block_count(study: Study) -> tuple[int, int]:
    """Blocks of a study, and of each case."""
    cases, states = study.sizes()
    return cases * -(-states // BLOCK), -(-states // BLOCK)


def blocks(study: Study, first: int, last: int) -> Iterator[Block]:
    """Blocks by their numbers.

    Raises:
        Alpha5Error: A recording, or an arm, that cannot be used.
    """
    wanted = {output.quantity for output in study.outputs.values()}
    grid, size, each = study.cases, study.sizes()[1], block_count(study)[1]
    for case, n in (divmod(number, each) for number in range(first, last)):
        at = np.unravel_index(case, [*map(len, grid.values())]) if grid else ()
        index, start, row = dict(zip(grid, map(int, at), strict=True)), n * BLOCK, case * size
        if "recording" in grid:
            row = case * _RECORDED
            states = _recorded(Path(study.folder, grid["recording"][index["recording"]]))
        else:
            states = _states(study, start, min(size, start + BLOCK))
        values = _quantities(wanted, *_arm(study, tuple(index.items())), states[2])
        rows = row + start + np.arange(len(states[2].time))
        yield rows, index | states[0], states[1], values


def inputs(study: Study, row: int) -> dict[str, Any]:
    """What stands behind a row: the value of each axis, or the recording and its sample."""
    case, state = divmod(row, _RECORDED if "recording" in study.cases else study.sizes()[1])
    number = case if "recording" in study.cases else case * block_count(study)[1] + state // BLOCK
    block = next(blocks(study, number, number + 1))
    return {name: x[row - block[0][0]].item() for name, x in columns(study, block).items()}


def columns(study: Study, block: Block) -> dict[str, Any]:
    """A block as a table: number of the row, axes, and the quantities kept as tables."""
    rows, index, more, values = block
    grid = study.cases | study.states
    out = {"row": rows, **{name: np.array(grid[name])[i] for name, i in index.items()}, **more}
    for output in study.outputs.values():
        if output.form == "table":
            names = (f"{output.quantity}.{name}" for name in output.columns)
            out |= zip(names, values[output.quantity].T, strict=True)
    return {name: np.broadcast_to(column, rows.shape) for name, column in out.items()}


@lru_cache(maxsize=32)
def _states(study: Study, first: int, last: int) -> States:
    """States by their numbers in a case; random ones from the counts of the generator that are theirs alone."""
    place, index = np.arange(first, last) // study.samples, {}
    for name in reversed(study.states):
        place, index[name] = np.divmod(place, len(study.states[name]))
    width = -(-len(study.drawn) // 4)  # four numbers for each count
    counted = np.random.Generator(np.random.Philox(study.seed).advance(first * width))
    numbers = iter(counted.random((last - first, 4 * width)).T)
    drawn = {k: low + (high - low) * next(numbers) for k, (low, high) in study.drawn.items()}
    given = {name: np.array(study.states[name])[i] for name, i in index.items()} | drawn
    names = [[f"axis_{x}_{rate}" for x in "edcb"] for rate in ("pos", "vel", "acc")]
    zero = np.zeros(last - first)
    q, v, a = (np.stack([given.get(name, zero) for name in table], axis=1) for table in names)
    motion = SmoothMotion(zero, (), q, v, a, np.sign(v), "interpolate", None, False, zero)
    return index, drawn, motion


@lru_cache(maxsize=1)
def _recorded(path: Path) -> States:
    s = smooth(read_motion(path))
    arrays = ("position", "velocity", "acceleration", "direction")
    four: dict[str, Any] = {name: np.ascontiguousarray(getattr(s, name)[:, :4]) for name in arrays}
    return {}, {"sample": np.arange(len(s.time)), "time": s.time}, replace(s, **four)


@lru_cache(maxsize=64)
def _arm(study: Study, place: tuple[tuple[str, int], ...]) -> tuple[Any, list[Actuator]]:
    """The arm of a case, in moving water where there is a current, and its motors."""
    at: dict[str, Any] = {name: study.cases[name][i] for name, i in place}
    rotation = rotation_from_rpy([at.get(f"mount_{x}", 0.0) for x in ("roll", "pitch", "yaw")])
    names = at.get("corrections", "+".join(DEFAULT_CORRECTIONS)).replace("none", "").split("+")
    density, gravity = at.get("fluid_density", SEA_WATER), gravity_in_base(rotation)
    values = parameters(filter(None, names))
    if "parameters" in at:
        values = _sample(len(study.cases["parameters"]), study.seed).parameters(at["parameters"])
    arm: Any = arm_of(values, density, gravity)
    motors = [*map(Actuator, arm.joint_names, values.actuators)]
    if any(name.startswith("payload_") for name in at):
        com, volume = [at.get(f"payload_{x}", 0.0) for x in "xyz"], at.get("payload_volume", 0.0)
        arm = arm.with_payload(at.get("payload_mass", 0.0), com, volume=volume)
    if "current_speed" not in at:
        return arm, motors
    angles = 0.0, -at.get("current_elevation", 0.0), at.get("current_azimuth", 0.0)
    flow = at["current_speed"] * rotation_from_rpy(angles)[:, 0]
    return arm.with_hydrodynamics(rotation.T @ flow), motors


@lru_cache(maxsize=1)
def _sample(count: int, seed: int) -> Sample:
    return sample(count, seed)


def _quantities(
    wanted: set[str], arm: Any, motors: Sequence[Actuator], motion: SmoothMotion
) -> dict[str, FloatArray]:
    """What the study asks for, (n, 4) each."""
    out: dict[str, FloatArray] = {}
    q, v, a = motion.position, motion.velocity, motion.acceleration
    if wanted & {"torque", "current", "power", "margin"}:
        out["torque"] = tau = arm.inverse_dynamics_batch(q, v, a, 1)
    if "margin" in wanted:
        # No rating is published: this is the effort that public models have.
        out["margin"] = arm.limits.effort - np.abs(tau)
    if wanted & {"current", "power"}:
        found, _ = motor_side(motors, motion, tau, None)
        out |= {"current": found["current"], "power": found["electrical_power"]}
    if wanted & {"mount_force", "mount_moment"}:
        wrench = arm.base_wrench_batch(q, v, a, 1)
        out |= {"mount_force": _with_norm(wrench[:, :3]), "mount_moment": _with_norm(wrench[:, 3:])}
    if "reach" in wanted:
        out["reach"] = _with_norm(frame_positions(getattr(arm, "still", arm), q))
    return out


def _with_norm(vectors: FloatArray) -> FloatArray:
    return np.column_stack([vectors, np.sqrt((vectors**2).sum(axis=1))])
