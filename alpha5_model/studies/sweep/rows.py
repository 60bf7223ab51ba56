"""Rows of a study, block by block, on any machine: states by their numbers, cases, their quantities; what is kept.

A block lies where it lies, however many make a chunk: what NumPy computes of it does not depend on who computes it.
Of quantities extremes with their rows are kept, and whole counts, in any order of the blocks. Nothing is added up in
floating point: the same states give the same result, whoever computed which of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.actuators import Actuator
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import SEA_WATER, gravity_in_base
from alpha5_model.numbers.parameters import parameters
from alpha5_model.studies.sweep.study import BLOCK, Output, Study
from alpha5_model.studies.uncertainty.effects import sample
from alpha5_model.trajectory import SmoothMotion, read_motion, smooth
from alpha5_model.trajectory.motors import motor_columns

#: Numbers set aside for the samples of a recording.
_RECORDED = 2**32
#: Edges of a quantile's bins: magnitudes from 2^-20 to 2^20, 256 to an octave.
_EDGES = np.outer(np.ldexp(1.0, np.arange(-20, 20)), 1 + np.arange(256) / 256).ravel()
#: Places on the grid, other columns, and the motion.
States = tuple[dict[str, Any], dict[str, Any], SmoothMotion]
#: One study's parameter sets.
_sample = lru_cache(maxsize=1)(sample)
#: Numbers of the rows (n,), places on the grid, other columns, quantities (n, 4).
Block = tuple[Any, dict[str, Any], dict[str, Any], dict[str, FloatArray]]


def blocks(study: Study, first: int, last: int) -> Iterator[Block]:
    """Blocks by their numbers.

    Raises:
        Alpha5Error: A recording, or an arm, that cannot be used.
    """
    wanted = {output.quantity for output in study.outputs.values()}
    grid, (_, size, each) = study.cases, study.sizes()
    for case, n in (divmod(number, each) for number in range(first, last)):
        at = np.unravel_index(case, [*map(len, grid.values())]) if grid else ()
        index, start, row = (
            dict(zip(grid, map(int, at), strict=True)),
            n * BLOCK,
            case * size,
        )
        if "recording" in grid:
            row = case * _RECORDED
            states = _recorded(
                Path(study.folder, grid["recording"][index["recording"]])
            )
        else:
            states = _states(study, start, min(size, start + BLOCK))
        values = _quantities(wanted, *_arm(study, tuple(index.items())), states[2])
        rows = row + start + np.arange(len(states[2].time))
        yield rows, index | states[0], states[1], values


def inputs(study: Study, row: int) -> dict[str, Any]:
    """What stands behind a row: the value of each axis, or the recording and its sample."""
    _, size, each = study.sizes()
    case, state = divmod(row, _RECORDED if "recording" in study.cases else size)
    number = case * each + (0 if "recording" in study.cases else state // BLOCK)
    block = next(blocks(study, number, number + 1))
    return {
        name: x[row - block[0][0]].item() for name, x in columns(study, block).items()
    }


def columns(study: Study, block: Block) -> dict[str, Any]:
    """A block as a table: number of the row, axes, and the quantities kept as tables."""
    rows, index, more, values = block
    grid = study.cases | study.states
    out = {
        "row": rows,
        **{name: np.array(grid[name])[i] for name, i in index.items()},
        **more,
    }
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
    drawn = {
        k: low + (high - low) * next(numbers) for k, (low, high) in study.drawn.items()
    }
    given = {name: np.array(study.states[name])[i] for name, i in index.items()} | drawn
    names = [[f"axis_{x}_{rate}" for x in "edcb"] for rate in ("pos", "vel", "acc")]
    zero = np.zeros(last - first)
    q, v, a = (
        np.stack([given.get(name, zero) for name in table], axis=1) for table in names
    )
    motion = SmoothMotion(
        zero, (), q, v, a, np.sign(v), "interpolate", None, False, zero
    )
    return index, drawn, motion


@lru_cache(maxsize=1)
def _recorded(path: Path) -> States:
    s = smooth(read_motion(path))
    arrays = ("position", "velocity", "acceleration", "direction")
    four: dict[str, Any] = {
        name: np.ascontiguousarray(getattr(s, name)[:, :4]) for name in arrays
    }
    return {}, {"sample": np.arange(len(s.time)), "time": s.time}, replace(s, **four)


@lru_cache(maxsize=64)
def _arm(
    study: Study, place: tuple[tuple[str, int], ...]
) -> tuple[Any, list[Actuator]]:
    """The arm of a case, in moving water where there is a current, and its motors."""
    with plausibility.said():  # by the study, when it was read
        return _arm_of_case(study, place)


def _arm_of_case(
    study: Study, place: tuple[tuple[str, int], ...]
) -> tuple[Any, list[Actuator]]:
    at: dict[str, Any] = {name: study.cases[name][i] for name, i in place}
    rotation = rotation_from_rpy(
        [at.get(f"mount_{x}", 0.0) for x in ("roll", "pitch", "yaw")]
    )
    names = (
        at.get("corrections", "+".join(DEFAULT_CORRECTIONS))
        .replace("none", "")
        .split("+")
    )
    density, gravity = at.get("fluid_density", SEA_WATER), gravity_in_base(rotation)
    values = parameters(filter(None, names))
    if "parameters" in at:
        values = _sample(len(study.cases["parameters"]), study.seed).parameters(
            at["parameters"]
        )
    arm: Any = arm_of(values, density, gravity)
    motors = [*map(Actuator, arm.joint_names, values.actuators)]
    if any(name.startswith("payload_") for name in at):
        com, volume = (
            [at.get(f"payload_{x}", 0.0) for x in "xyz"],
            at.get("payload_volume", 0.0),
        )
        arm = arm.with_payload(at.get("payload_mass", 0.0), com, volume=volume)
    if "current_speed" not in at:
        return arm, motors
    angles = 0.0, -at.get("current_elevation", 0.0), at.get("current_azimuth", 0.0)
    flow = at["current_speed"] * rotation_from_rpy(angles)[:, 0]
    return arm.with_hydrodynamics(rotation.T @ flow), motors


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
        found = motor_columns(motors, motion, tau)
        out |= {"current": found["current"], "power": found["electrical_power"]}
    if wanted & {"mount_force", "mount_moment"}:
        wrench = arm.base_wrench_batch(q, v, a, 1)
        out |= {
            "mount_force": _with_norm(wrench[:, :3]),
            "mount_moment": _with_norm(wrench[:, 3:]),
        }
    if "reach" in wanted:
        out["reach"] = _with_norm(batch.frame_positions(getattr(arm, "still", arm), q))
    return out


def _with_norm(vectors: FloatArray) -> FloatArray:
    return np.column_stack([vectors, np.sqrt((vectors**2).sum(axis=1))])


class Reduction:
    """One output in the making: a number and a row of each key, or a count.

    Attributes:
        values: Of extremes, by column and group; -inf where there is none yet. A minimum has its sign turned.
        counts: The row of the extreme, the first of equals; or how many fell between two edges.
    """

    def __init__(self, study: Study, output: Output) -> None:
        self.output, self.extreme = (
            output,
            output.form in ("peak", "maximum", "minimum"),
        )
        self.by = {name: (study.cases | study.states)[name] for name in output.by}
        edges = np.linspace(*output.range, output.bins + 1)
        if output.levels:
            edges = np.concatenate([-_EDGES[::-1], _EDGES])
        self.edges = np.concatenate([[-np.inf], edges, [np.inf]])
        self.groups = (
            math.prod(map(len, self.by.values())) if self.extreme else len(edges) + 1
        )
        self.values = np.full(len(output.columns) * self.groups, -np.inf)
        self.counts = np.zeros(len(self.values), np.int64)

    def add(self, values: FloatArray, index: dict[str, Any], rows: Any) -> None:
        """A block: values (n, columns), NaN where there are none; places on the axes; numbers of the rows."""
        first = np.arange(values.shape[1]) * self.groups
        if not self.extreme:
            place = np.searchsorted(self.edges[1:-1], values, side="right")
            np.add.at(self.counts, (place + first)[~np.isnan(values)], 1)
            return
        values = np.abs(values) if self.output.form == "peak" else values
        values = -values if self.output.form == "minimum" else values
        group: Any = 0
        for name, axis in self.by.items():
            group = group * len(axis) + index[name]
        if np.ndim(group):
            rows = np.repeat(rows, len(first))
        else:  # one group: its best row is enough
            best = np.where(np.isnan(values), -np.inf, values).argmax(axis=0)
            values, rows = values[best, np.arange(len(first))], rows[best]
        self.merge(np.add.outer(group, first).ravel(), values.ravel(), rows)

    def merge(self, keys: Any, values: Any, counts: Any) -> None:
        """Further numbers of some keys, which may repeat; rows in order."""
        if not self.extreme:
            np.add.at(self.counts, keys, counts)
            return
        better = values > self.values[keys]  # not NaN
        better |= (values == self.values[keys]) & (counts < self.counts[keys])
        keys, values, counts = keys[better], values[better], counts[better]
        np.maximum.at(self.values, keys, values)
        best = values == self.values[keys]
        # Of a key that repeats, the last assignment stays: that of the first row.
        self.counts[keys[best][::-1]] = counts[best][::-1]

    def parts(self, name: str) -> dict[str, Any]:
        """Keys that have something, with what `merge` takes of them, as a table."""
        keys = np.flatnonzero(self.values > -np.inf if self.extreme else self.counts)
        table = {"key": keys, "value": self.values[keys], "count": self.counts[keys]}
        return {"output": np.full(len(keys), name), **table}

    def result(self) -> dict[str, Any]:
        """Columns by name; of extremes, NaN and row -1 where a group has none."""
        counts = dict(
            zip(self.output.columns, self.counts.reshape(-1, self.groups), strict=True)
        )
        if self.output.levels:
            out: dict[str, Any] = {"level": np.array(self.output.levels)}
            for name, column in counts.items():
                sums = np.cumsum(column)
                place = np.searchsorted(
                    sums, np.maximum(np.ceil(out["level"] * sums[-1]), 1)
                )
                ends = np.append(self.edges, np.nan)  # of no values at all
                out |= {f"{name}_low": ends[place], f"{name}_high": ends[place + 1]}
            return out
        if not self.extreme:
            return {"low": self.edges[:-1], "high": self.edges[1:], **counts}
        grid = np.meshgrid(*self.by.values(), indexing="ij")
        out = dict(zip(self.by, map(np.ravel, grid), strict=True))
        sign = -1.0 if self.output.form == "minimum" else 1.0
        values = self.values.reshape(-1, self.groups)
        for (name, row), value in zip(counts.items(), values, strict=True):
            none = value == -np.inf
            out[name] = np.where(none, np.nan, sign * value)
            out[f"{name}_row"] = np.where(none, -1, row)
        return out


def reductions(study: Study) -> dict[str, Reduction]:
    """Of each output but tables, empty."""
    named = study.outputs.items()
    return {
        name: Reduction(study, output)
        for name, output in named
        if output.form != "table"
    }
