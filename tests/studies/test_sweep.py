"""Studies have the rows computed by hand, whatever the parts, workers or accidents."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from least_time import least_time
from parquet_files import read_table

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.cli import main
from alpha5_model.studies.sweep import parts

STATES = """
axis_e_pos = {from = 0, to = 350, count = 3, unit = "deg"}
axis_d_pos = {values = [0.3, 1.7]}
axis_c_pos = [0.2, 1.4, 3.0]
axis_b_pos = 0.5
axis_d_vel = -0.4
axis_b_acc = {values = 90, unit = "deg/s^2"}
"""
GRID = f"""
[axes]
{STATES}
mount_pitch = {{from = -90, to = 90, count = 3, unit = "deg"}}
payload_mass = {{values = [0, 250], unit = "g"}}
payload_z = {{values = 30, unit = "mm"}}
[outputs.torque]
quantity = "torque"
as = "peak"
[outputs.least]
quantity = "margin"
as = "minimum"
[outputs.map]
quantity = "mount_moment"
as = "maximum"
by = ["payload_mass", "axis_d_pos"]
[outputs.rows]
quantity = "torque"
as = "table"
"""
DRAWN = """
seed = 7
samples = 40000
[axes]
axis_e_pos = 0.1
axis_d_pos = {random = [0, 200], unit = "deg"}
axis_c_pos = {random = [0, 200], unit = "deg"}
axis_b_pos = {random = [-3, 3]}
axis_d_vel = {random = [-0.5, 0.5]}
fluid_density = [1000, 1025]
[outputs.peak]
quantity = "torque"
as = "peak"
by = ["fluid_density"]
[outputs.spread]
quantity = "torque"
as = "quantile"
levels = [0.001, 0.5, 0.9, 1]
[outputs.bars]
quantity = "torque"
as = "histogram"
range = [-1, 1]
bins = 8
[outputs.all]
quantity = "torque"
as = "table"
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "study.toml"
    path.write_text(text, "utf-8")
    return path


def content(folder: Path) -> dict[str, Any]:
    """What no part or process may change: results as bytes, rows as a table."""
    files = {p.name: p.read_bytes() for p in folder.iterdir() if p.is_file()}
    return {**files, "rows": read_table(folder / "rows").to_pydict()}


def columns(folder: Path, *names: str) -> np.ndarray:
    table = read_table(folder / "rows")
    return np.stack([table[name].to_numpy() for name in names], axis=1)


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A study, and what one process makes of it in one part."""
    folder = tmp_path_factory.mktemp("drawn")
    study = written(folder, DRAWN)
    a5.sweep(study, folder / "one")
    return study, folder / "one"


#: The values of GRID's axes.
PITCHES = (-np.pi / 2, 0.0, np.pi / 2)
LOADS = (0.0, 0.25)
AXIS_D = (0.3, 1.7)


@dataclass(frozen=True)
class GridRows:
    """What single calls give for the rows of GRID."""

    load: np.ndarray  # (n,)
    axis_d: np.ndarray  # (n,)
    torque: np.ndarray  # (n, 4)
    moment: np.ndarray  # (n, 3)


@pytest.fixture(scope="module")
def grid_rows() -> GridRows:
    e = (0.0, np.radians(175), np.radians(350))
    c = (0.2, 1.4, 3.0)
    v = np.array([0, -0.4, 0, 0])
    a = np.array([0, 0, 0, np.pi / 2])
    inputs = []
    torque = []
    moment = []
    for pitch, load in itertools.product(PITCHES, LOADS):
        gravity = rotation_from_rpy([0.0, pitch, 0.0]).T @ [0, 0, -9.81]
        arm = a5.load(gravity=gravity).with_payload(load, (0, 0, 0.03))
        for q in itertools.product(e, AXIS_D, c, (0.5,)):
            inputs.append((load, q[1]))
            torque.append(arm.inverse_dynamics(np.array(q), v, a))
            moment.append(arm.base_wrench(np.array(q), v, a).angular)
    loads, axis_d = np.transpose(inputs)
    return GridRows(
        load=loads,
        axis_d=axis_d,
        torque=np.array(torque),
        moment=np.array(moment),
    )


@pytest.fixture(scope="module")
def grid(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    """The folder of the results of GRID, and what `sweep` returns."""
    folder = tmp_path_factory.mktemp("grid")
    found = a5.sweep(written(folder, GRID), folder / "out")
    return folder / "out", found


def test_rows_of_a_grid_are_single_calls_of_pinocchio(
    grid: tuple[Path, Any], grid_rows: GridRows
) -> None:
    folder, found = grid
    rows = columns(folder, *(f"torque.axis_{x}" for x in "edcb"))
    assert found.rows == len(grid_rows.torque) == len(rows)
    np.testing.assert_allclose(rows, grid_rows.torque, rtol=1e-12, atol=1e-14)
    numbers = columns(folder, "row")[:, 0]
    np.testing.assert_array_equal(numbers, range(len(rows)))


@pytest.mark.parametrize(
    ("k", "joint"), enumerate(("axis_e", "axis_d", "axis_c", "axis_b"))
)
def test_peaks_of_a_grid_are_those_of_its_rows(
    k: int, joint: str, grid: tuple[Path, Any], grid_rows: GridRows
) -> None:
    _, found = grid
    peak = np.abs(grid_rows.torque[:, k]).max()
    largest = found.outputs["torque"][joint][0]
    assert largest == pytest.approx(peak, rel=1e-12)
    effort = a5.parameters().joints[k].effort
    least = found.outputs["least"][joint][0]
    assert least == pytest.approx(effort - peak, rel=1e-12)

    row = int(found.outputs["torque"][f"{joint}_row"][0])
    behind = found.inputs(row)
    assert abs(behind[f"torque.{joint}"]) == largest
    expected = [PITCHES[row // 36], LOADS[row // 18 % 2]]
    assert [behind["mount_pitch"], behind["payload_mass"]] == pytest.approx(expected)


def test_a_map_of_a_grid_has_the_peaks_of_each_cell(
    grid: tuple[Path, Any], grid_rows: GridRows
) -> None:
    _, found = grid
    cells = found.outputs["map"]
    for k, (load, axis_d) in enumerate(itertools.product(LOADS, AXIS_D)):
        in_cell = (grid_rows.load == load) & (grid_rows.axis_d == axis_d)
        moment = grid_rows.moment[in_cell]
        assert cells["payload_mass"][k] == load
        assert cells["axis_d_pos"][k] == axis_d
        assert cells["x"][k] == pytest.approx(moment[:, 0].max(), abs=1e-13)
        norm = np.linalg.norm(moment, axis=1).max()
        assert cells["norm"][k] == pytest.approx(norm, rel=1e-12)


@pytest.mark.parametrize("row", [-1, 108, 10**6, 2.0, True, None, math.nan])
def test_a_row_outside_the_study_has_no_inputs(
    row: Any, grid: tuple[Path, Any]
) -> None:
    _, found = grid
    with pytest.raises(a5.errors.InputError, match="row: expected the number of a row"):
        found.inputs(row)


def named(row: dict[str, Any], quantity: str, parts: str) -> list[float]:
    """The numbers of a quantity in a row, such as ``reach.x`` to ``reach.z``."""
    return [row[f"{quantity}{part}"] for part in parts]


def test_water_corrections_and_motors_against_single_calls(tmp_path: Path) -> None:
    study = f"""
    [axes]
    {STATES}
    mount_roll = 0.7
    current_speed = 0.6
    current_azimuth = [0.4, 2.0]
    current_elevation = 0.3
    corrections = ["none", "base_frame+link3_cob"]
    [outputs.t]
    quantity = "torque"
    as = "table"
    [outputs.i]
    quantity = "current"
    as = "table"
    [outputs.p]
    quantity = "power"
    as = "table"
    [outputs.m]
    quantity = "mount_force"
    as = "table"
    [outputs.r]
    quantity = "reach"
    as = "table"
    """
    a5.sweep(written(tmp_path, study), tmp_path / "out")
    table = read_table(tmp_path / "out" / "rows").to_pylist()
    v = np.array([0, -0.4, 0, 0])
    a = np.array([0, 0, 0, np.pi / 2])
    for row in (table[3], table[30], table[-1]):
        arm = arm_of_row(row)
        q = np.array([row[f"axis_{x}_pos"] for x in "edcb"])
        tau = arm.inverse_dynamics(q, v, a)
        np.testing.assert_allclose(named(row, "torque.axis_", "edcb"), tau, rtol=1e-9)
        force = arm.base_wrench(q, v, a).linear
        np.testing.assert_allclose(named(row, "mount_force.", "xyz"), force, rtol=1e-9)
        tcp = arm.forward_kinematics(q).translation
        np.testing.assert_allclose(named(row, "reach.", "xyz"), tcp, atol=1e-14)
        motor = a5.actuators.actuator("axis_d")
        current = float(motor.current(tau[1], -0.4))
        assert row["current.axis_d"] == pytest.approx(current)
        electrical = motor.power(tau[1], -0.4).electrical
        assert row["power.axis_d"] == pytest.approx(float(electrical))
        low, high = a5.actuators.actuator("axis_c").holding_current(tau[2])
        assert row["current.axis_c"] == pytest.approx(float(np.clip(0.0, low, high)))


def arm_of_row(row: dict[str, Any]) -> Any:
    """The rolled arm in the current, with the corrections, of a row."""
    rotation = rotation_from_rpy([0.7, 0.0, 0.0])
    corrections = tuple(x for x in row["corrections"].split("+") if x != "none")
    azimuth = row["current_azimuth"]
    level = np.cos(0.3)
    up = np.sin(0.3)
    flow = 0.6 * np.array([level * np.cos(azimuth), level * np.sin(azimuth), up])
    still = a5.load(gravity=rotation.T @ [0, 0, -9.81], corrections=corrections)
    return still.with_hydrodynamics(rotation.T @ flow)


def test_what_is_drawn(drawn: tuple[Path, Path]) -> None:
    names = ["axis_d_pos", "axis_c_pos", "axis_b_pos", "axis_d_vel"]
    low = [0, 0, -3, -0.5]
    high = [np.radians(200), np.radians(200), 3, 0.5]
    numbers = (columns(drawn[1], *names) - low) / np.subtract(high, low)
    # Both fluids get the same states.
    np.testing.assert_array_equal(numbers[:40000], numbers[40000:])
    one = numbers[:40000]
    # The states fill their ranges evenly, and no two axes are correlated.
    assert (one >= 0).all()
    assert (one < 1).all()
    for column in one.T:
        assert np.abs(np.sort(column) - np.linspace(0, 1, 40000)).max() < 0.01
    assert np.abs(np.corrcoef(one.T) - np.eye(4)).max() < 0.02
    assert len(np.unique(one)) == one.size


def test_quantiles_and_histograms_against_the_table(drawn: tuple[Path, Path]) -> None:
    study, folder = drawn
    found = a5.sweep(study, folder)  # nothing is left to do
    torque = columns(folder, *(f"torque.axis_{x}" for x in "edcb"))
    spread = found.outputs["spread"]
    bars = found.outputs["bars"]
    for k, joint in enumerate(("axis_e", "axis_d", "axis_c", "axis_b")):
        exact = np.quantile(torque[:, k], spread["level"], method="inverted_cdf")
        low = spread[f"{joint}_low"]
        high = spread[f"{joint}_high"]
        assert (low <= exact).all()
        assert (exact <= high).all()
        assert (high - low <= np.maximum(np.abs(exact) / 256, 2.0**-19)).all()
        edges = np.concatenate([[-np.inf], np.linspace(-1, 1, 9), [np.inf]])
        counts = [
            np.sum((torque[:, k] >= a) & (torque[:, k] < b))
            for a, b in itertools.pairwise(edges)
        ]
        np.testing.assert_array_equal(bars[joint], counts)
        peaks = np.abs(torque[:, k].reshape(2, -1))
        np.testing.assert_array_equal(found.outputs["peak"][joint], peaks.max(axis=1))
        first = np.add(peaks.argmax(axis=1), [0, 40000])
        np.testing.assert_array_equal(found.outputs["peak"][f"{joint}_row"], first)


def test_any_size_of_parts(
    drawn: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "STATES", 9000)
    a5.sweep(drawn[0], tmp_path)
    assert len([*(tmp_path / "parts").iterdir()]) == 10
    assert content(tmp_path) == content(drawn[1])


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (
            ("axis_b_pos = 0.5", "axis_b_position = 0.5"),
            "unknown axis 'axis_b_position'",
        ),
        (("axis_b_pos = 0.5", ""), "axes, states"),
        (("axis_b_pos = 0.5", "axis_b_pos = []"), "axes.axis_b_pos"),
        (("count = 3", "count = 0"), "axes.axis_e_pos.count"),
        (("count = 3", "count = 3000000000000"), "axes.axis_e_pos"),
        (("to = 350", "to = -350"), "axes.axis_e_pos"),
        (
            ('unit = "g"', 'unit = "m"'),
            "unit of axes.payload_mass 'm'; choose from kg, g",
        ),
        (("[0, 250]", "[0, -250]"), "axes.payload_mass"),
        (("values = 30", "random = [0, 30]"), "axes.payload_z"),
        (("[0.2, 1.4, 3.0]", "[0.2, nan]"), "axes.axis_c_pos"),
        (("[0.2, 1.4, 3.0]", "[[0.2, 1.4], 3.0]"), "axes.axis_c_pos"),
        (("[0.2, 1.4, 3.0]", "'0.2'"), "axes.axis_c_pos"),
        (
            ('"torque"', '"torques"'),
            "outputs.torque.quantity 'torques'; choose from torque,",
        ),
        (('"peak"', '"mean"'), "outputs.torque.as 'mean'; choose from peak,"),
        (('"payload_mass", "axis_d_pos"', '"payload_x"'), "outputs.map.by 'payload_x'"),
        (('as = "peak"', 'as = "histogram"'), "outputs.torque.bins"),
        (('as = "peak"', 'as = "quantile"\nlevels = [0, 1]'), "outputs.torque.levels"),
        (('as = "peak"', 'as = "peak"\nbins = 3'), "key of outputs.torque 'bins'"),
        (("[outputs.torque]", '[outputs."../torque"]'), "outputs"),
        (("[axes]", "samples = 4\n[axes]"), "samples"),
        (("[axes]", "seed = -1\n[axes]"), "seed"),
        (("[axes]", "sed = 1\n[axes]"), "unknown key 'sed'"),
        (("[axes]", "[axes"), "line"),
        (("[axes]", "[axes]\nrecordings = 'none.csv'"), "axes, states"),
        (("[axes]", "[axes]\nrecordings = []"), "axes.recordings"),
        (("[axes]", "[axes]\nparameters = 2\ncorrections = ['none']"), "axes"),
        (
            ("[axes]", "[axes]\ncorrections = ['link4_cob']"),
            "axes.corrections 'link4_cob'",
        ),
        (
            ("[axes]", "[axes]\ncorrections = ['none+link3_cob']"),
            "axes.corrections: expected 'none' alone",
        ),
    ],
)
def test_a_bad_study_ends_in_one_line_with_the_place(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    change: tuple[str, str],
    place: str,
) -> None:
    assert change[0] in GRID
    study = written(tmp_path, GRID.replace(*change, 1))
    assert main(["sweep", str(study), "--output", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr().err
    assert printed.count("\n") == 1
    assert f"{study}" in printed
    assert place in printed
    assert not (tmp_path / "out").exists()


NESTED = {
    "brackets": "a = " + "[" * 90_000,
    "tables": "a = " + "{a = " * 20_000,
    "long key": ".".join("a" * 45_000) + " = 1",
    "long quoted key": ".".join(["'a'"] * 25_000) + " = 1",
    "long header": "[" + " . ".join("a" * 30_000) + "]",
    "deep header": "[" + ".".join("a" * 2000) + "]\n" + "k = 1\n" * 12_000,
    "word": "a" * 90_000,
    "quotes": '"' * 90_000,
    "spaces": "a" + " " * 90_000,
    "digits": "a = " + "1" * 90_000,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", NESTED)
def test_a_study_that_takes_long_to_read(name: str, tmp_path: Path) -> None:
    study = written(tmp_path, NESTED[name])
    answers = []

    def read() -> None:
        with pytest.raises(a5.errors.FileFormatError) as caught:
            a5.sweep(study, tmp_path / "out")
        answers.append(str(caught.value))

    assert least_time(read, 2.0) < 2.0
    assert "\n" not in answers[0]
    if "key" in name or "header" in name:
        assert answers[0].endswith("line 1: a key of more than 20 parts")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "axes"),
        ("axes = {}\n", "axes"),
        ("axes = [1]\n", "axes"),
        ("axes.axis_e_pos = 1.0\n", "outputs"),
        ("axes.axis_e_pos = 1.0\noutputs = {}\n", "outputs"),
        ("axes.axis_e_pos = 1.0\noutputs = ['torque']\n", "outputs"),
    ],
)
def test_a_study_needs_axes_and_outputs(text: str, place: str, tmp_path: Path) -> None:
    expected = f"{place}: expected a table with at least one key"
    with pytest.raises(a5.errors.FileFormatError, match=expected):
        a5.sweep(written(tmp_path, text), tmp_path / "out")
