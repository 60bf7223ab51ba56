"""A long recorded motion, read, computed and summarised, against parts of that work."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
from benchmarks.timing import Row, measure

import alpha5_model as a5

SAMPLES = 100_000
OWN = "alpha5_model"
READING = "numpy.loadtxt, which only reads the file"
TORQUES = "Pinocchio: rnea in a loop, no water"


def missing() -> list[str]:
    """Peers that are not installed."""
    return []


def rows() -> list[Row]:
    """One work: 100 000 samples from a CSV file, which should stay below 3 s on two
    cores.
    """
    rng = np.random.default_rng(12)
    t = np.cumsum(rng.uniform(0.005, 0.035, SAMPLES))
    shape = np.array([1.0, 0.8, 0.9, 1.2])
    q = (
        1.7
        + np.sin(0.2 * t)[:, None] * shape
        + rng.normal(scale=1e-4, size=(SAMPLES, 4))
    )
    v = 0.2 * np.cos(0.2 * t)[:, None] * shape
    header = ["time_secs", *(f"{a}_{k}" for k in ("pos", "vel") for a in _AXES)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "long.csv"
        table = np.column_stack([t, q, v]).tolist()
        path.write_text(
            "\n".join([",".join(header), *(",".join(map(repr, r)) for r in table)])
        )
        arm = a5.load()
        model, data = arm.model, arm.model.createData()
        still = np.zeros(4)

        def ours() -> str:
            motion = a5.trajectory.read_motion(path)
            return a5.trajectory.text(
                a5.trajectory.summary(a5.trajectory.analyse(motion))
            )

        def reading() -> object:
            return np.loadtxt(path, delimiter=",", skiprows=1)

        def torques() -> None:
            for row, speed in zip(q, v, strict=True):
                pin.rnea(model, data, row, speed, still)

        seconds = measure({OWN: ours, READING: reading, TORQUES: torques}, rounds=3)
    setups = {
        OWN: "read, smooth, five torque terms, currents, power, mount, tcp, summary",
        READING: "reads the same file and does nothing else",
        TORQUES: "one torque per sample in air, from arrays in memory",
    }
    work = f"a recording of {SAMPLES} samples, read and analysed"
    return [Row(work, k, s, setup=setups[k]) for k, s in seconds.items()]


_AXES = ("axis_e", "axis_d", "axis_c", "axis_b")
