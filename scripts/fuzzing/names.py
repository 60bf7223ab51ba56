"""Recordings with made-up names of columns: only positions are read as positions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from fuzzing.cases import Case
from fuzzing.values import Rng, pick

import alpha5_model as a5

#: Words for anything but a measured position; a column with one of them holds none.
OTHERS = (
    "tau",
    "torque",
    "trq",
    "effort",
    "eff",
    "force",
    "moment",
    "current",
    "cur",
    "amps",
    "iq",
    "voltage",
    "volt",
    "power",
    "watts",
    "temp",
    "temperature",
    "vel",
    "velocity",
    "dq",
    "qd",
    "qdot",
    "speed",
    "omega",
    "rpm",
    "acc",
    "accel",
    "ddq",
    "jerk",
    "cmd",
    "command",
    "desired",
    "des",
    "ref",
    "reference",
    "target",
    "goal",
    "setpoint",
    "error",
    "err",
    "std",
    "sigma",
    "var",
    "cov",
    "min",
    "max",
    "limit",
    "kp",
    "gain",
    "pwm",
    "duty",
    "counts",
    "raw",
    "adc",
    "status",
    "mode",
    "fault",
    "load",
    "mass",
    "drag",
    "inertia",
    "deg",
    "degrees",
    "stamp",
    "delay",
    "foo",
    "xyz",
    "residual",
    "delta",
    "offset",
    "bias",
    "pressure",
)
#: Words that may also be a robot's name, if the column says that it is a position.
AMBIGUOUS = {"foo", "xyz", "eff", "qd"}
POSITIONS = ("", "_pos", "_position")
ROBOTS = ("", "alpha_", "left_", "arm_", "robot.", "/joint_states/")


class MisreadError(Exception):
    """A column was read as what it is not."""


def target(rng: Rng, folder: Path) -> Case:
    """A table with or without positions, among columns that are none."""
    suffix = pick(rng, POSITIONS)
    with_positions = bool(rng.integers(3))
    count = 8
    time = np.arange(count) * 0.05
    positions = rng.uniform(0.5, 1.5, (4, count))
    columns = [("time_secs", time)]
    if with_positions:
        columns += [
            (f"axis_{x}{suffix}", row) for x, row in zip("edcb", positions, strict=True)
        ]
    for _ in range(int(rng.integers(1, 4))):
        pattern = _pattern(rng)
        # out of any range, in degrees, too: whoever reads them as positions is seen
        noise = rng.uniform(5000, 6000, (4, count))
        columns += [
            (pattern.replace("*", f"axis_{x}"), row)
            for x, row in zip("edcb", noise, strict=True)
        ]
    columns = [columns[k] for k in rng.permutation(len(columns))]
    known: dict[str, np.ndarray] = {}
    for name, row in columns:
        known.setdefault(name, row)
    path = folder / "columns.csv"
    rows = [
        ",".join(f"{x:.17g}" for x in row) for row in np.transpose([*known.values()])
    ]
    path.write_text("\n".join([",".join(known), *rows]), encoding="utf-8")

    def call(path: Path) -> Any:
        motion = a5.trajectory.read_motion(path)
        if not with_positions:
            raise MisreadError(f"read {motion.position[0]} as positions")
        if not np.array_equal(motion.position, positions.T):
            raise MisreadError(f"read {motion.position[0]}, not {positions.T[0]}")
        return motion

    return Case(call, {"path": path})


def _pattern(rng: Rng) -> str:
    """A name with ``*`` for the joint and a word that says that it is no position."""
    word = pick(rng, OTHERS)
    more = "" if word in AMBIGUOUS else pick(rng, ("", "", "_pos", "_q", "pos_"))
    word = pick(rng, (word, word, word.upper(), word.capitalize()))
    robot = pick(rng, ROBOTS)
    separator = pick(rng, ("_", "_", ".", "/", " "))
    if rng.integers(2):
        return f"{word}{separator}{robot}*{more if more.startswith('_') else ''}"
    return f"{robot}{more if not more.startswith('_') else ''}*{separator}{word}"
