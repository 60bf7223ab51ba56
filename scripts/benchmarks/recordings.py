"""A long recorded motion, read, computed and summarised; and the rows of a sweep."""

from __future__ import annotations

import tempfile
from functools import partial
from pathlib import Path

import numpy as np
import pinocchio as pin
from benchmarks.timing import Row, compare

import alpha5_model as a5
from alpha5_model.studies.sweep.parts import compute
from alpha5_model.studies.sweep.study import read_study

SAMPLES = 100_000
#: Of a file that is only read.
LONG = 1_000_000
AXES = ("axis_e", "axis_d", "axis_c", "axis_b")
SWEPT = 200_000
#: Form of an output -> its keys in a study.
FORMS = {
    "peak": "",
    "quantile": "levels = [0.5]",
    "histogram": "range = [-1, 1]\nbins = 100",
    "table": "",
}
STUDY = f"""
samples = {SWEPT}
[axes]
axis_e_pos = 0.1
axis_d_pos = {{random = [0, 3]}}
axis_c_pos = {{random = [0, 3]}}
axis_b_pos = {{random = [-3, 3]}}
axis_d_vel = {{random = [-0.5, 0.5]}}
[outputs.torque]
quantity = "torque"
"""


def rows() -> list[Row]:
    """Measured rows of this subject."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        return [*_recording(place), *_long_file(place), *_sweep(place)]


def _recording(folder: Path) -> list[Row]:
    """All of an analysis, beside reading the file only, and beside torques only."""
    rng = np.random.default_rng(12)
    t = np.cumsum(rng.uniform(0.005, 0.035, SAMPLES))
    shape = np.array([1.0, 0.8, 0.9, 1.2])
    noise = rng.normal(scale=1e-4, size=(SAMPLES, 4))
    q = 1.7 + np.sin(0.2 * t)[:, None] * shape + noise
    v = 0.2 * np.cos(0.2 * t)[:, None] * shape
    header = ["time_secs", *(f"{a}_{kind}" for kind in ("pos", "vel") for a in AXES)]
    path = folder / "long.csv"
    table = np.column_stack([t, q, v])
    np.savetxt(path, table, "%.17g", ",", header=",".join(header), comments="")
    arm = a5.load()
    model, data = arm.model, arm.model.createData()
    still = np.zeros(4)

    def ours() -> str:
        analysis = a5.trajectory.analyse(a5.trajectory.read_motion(path))
        return a5.trajectory.text(analysis)

    def torques() -> None:
        for row, speed in zip(q, v, strict=True):
            pin.rnea(model, data, row, speed, still)

    candidates = {
        "alpha5_model": ours,
        "numpy.loadtxt, which only reads the file": partial(
            np.loadtxt, path, delimiter=",", skiprows=1
        ),
        "Pinocchio: rnea in a loop, no water": torques,
    }
    work = f"a recording of {SAMPLES} samples, read and analysed"
    return compare(work, candidates, rounds=3)


def _long_file(folder: Path) -> list[Row]:
    """A million rows of CSV, beside NumPy, which knows nothing of columns."""
    t = 0.02 * np.arange(LONG)
    q = 1.7 + np.sin(0.2 * t)[:, None] * np.array([1.0, 0.8, 0.9, 1.2])
    header = ",".join(
        ["time_secs", *(f"{a}_{x}" for x in ("pos", "vel") for a in AXES)]
    )
    path = folder / "million.csv"
    np.savetxt(
        path, np.column_stack([t, q, 0.1 * q]), "%.9g", ",", header=header, comments=""
    )
    candidates = {
        "alpha5_model": partial(a5.trajectory.read_motion, path),
        "numpy.loadtxt": partial(np.loadtxt, path, delimiter=",", skiprows=1),
    }
    return compare(f"a CSV of {LONG} rows, read", candidates, rounds=2)


def _sweep(folder: Path) -> list[Row]:
    """Random states, their torques, and what is kept of them."""
    functions = {}
    for form, keys in FORMS.items():
        study = folder / f"{form}.toml"
        study.write_text(f'{STUDY}as = "{form}"\n{keys}\n', encoding="utf-8")
        functions[form] = partial(compute, read_study(study), 0)
    return compare("a row of a sweep", functions, SWEPT, rounds=5)
