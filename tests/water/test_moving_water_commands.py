"""A current on the command line loads the arm as a sum over strips says.

It is a cause of its own in tables and plots.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path

import current_load
import numpy as np
import pytest
from reference import LOWER, UPPER
from torque_command import torque, words

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.viewer import figures
from alpha5_model.viewer.mount_plot import mount_load_figure
from alpha5_model.water.terms import water_terms

CURRENT = (0.4, -0.7, 0.3)
TEXT = " ".join(map(str, CURRENT))


@pytest.mark.parametrize(("fluid", "density"), [("sea", 1025.0), ("fresh", 1000.0)])
def test_a_steady_current_by_an_own_strip_sum(capsys, fluid, density):
    for q in np.random.default_rng(5).uniform(LOWER, UPPER, (4, 4)):
        arguments = ["--q", *words(q), "--fluid", fluid, "--json"]
        still = json.loads(torque(capsys, *arguments))
        moved = json.loads(torque(capsys, *arguments, "--water-velocity", TEXT))
        levels = [current_load.load(q, CURRENT, level, density) for level in range(3)]
        for i, (joint, before) in enumerate(
            zip(moved["joints"], still["joints"], strict=True)
        ):
            by_level = [tau[i] for tau, _, _ in levels]
            assert joint["moving_water"] == pytest.approx(by_level[1], abs=1e-12)
            ends = [min(by_level), max(by_level)]
            assert joint["moving_water_range"] == pytest.approx(ends, abs=1e-12)
            assert joint["torque"] - before["torque"] == pytest.approx(
                by_level[1], abs=1e-12
            )
            terms = ("inertia", "coriolis", "weight", "buoyancy")
            assert [joint[name] for name in terms] == [before[name] for name in terms]
        for name, (_, force, moment) in zip(LEVELS, levels, strict=True):
            load = moved["mount"]["moving_water"][name]
            np.testing.assert_allclose(load["force"], force, atol=1e-11)
            np.testing.assert_allclose(load["moment"], moment, atol=1e-11)
        change = np.subtract(moved["mount"]["force"], still["mount"]["force"])
        np.testing.assert_allclose(change, levels[1][1], atol=1e-11)
        assert moved["water_current"] == list(CURRENT)


def test_still_water_resists_a_motion(capsys):
    """A current of zero adds drag and added mass, which cost power."""
    arguments = ["--q", "3.1", "1.2", "1.8", "0.4", "--v", "0.3", "0.3", "-0.3", "0"]
    out = torque(capsys, *arguments, "--water-velocity", "0 0 0", "--json")
    joints = json.loads(out)["joints"]
    power = sum(joint["moving_water"] * joint["velocity"] for joint in joints)
    assert power > 0
    wet = a5.load().with_hydrodynamics()
    q, v = ([joint[key] for joint in joints] for key in ("position", "velocity"))
    expected = wet.inverse_dynamics(q, v, np.zeros(4))
    np.testing.assert_allclose(
        [joint["torque"] for joint in joints], expected, atol=1e-13
    )


def test_the_text_names_the_cause_and_its_interval(capsys):
    arguments = ["--q", "3.1", "1.2", "1.8", "0.4"]
    result = json.loads(torque(capsys, *arguments, "--water-velocity", TEXT, "--json"))
    out = torque(capsys, *arguments, "--water-velocity", TEXT)
    assert "buoyancy  + water  = torque" in out
    _, _, water = out.partition("moving water, ")
    assert water.startswith("(0.4, -0.7, 0.3) m/s in base_link; estimated, not publ")
    rows = {
        words[0]: [float(x) for x in words[1:4]]
        for words in (
            row.replace(" to ", " ").split() for row in water.splitlines()[2:8]
        )
    }
    for joint in result["joints"]:
        figures = [joint["moving_water"], *joint["moving_water_range"]]
        assert rows.pop(joint["joint"]) == pytest.approx(figures, abs=5.1e-5)
    for part in ("force", "moment"):
        loads = [
            result["mount"]["moving_water"][level][part]
            for level in ("nominal", "low", "high")
        ]
        figures = np.linalg.norm(loads, axis=1)
        assert rows.pop(part) == pytest.approx(figures, abs=5.1e-5)
    assert not rows
    assert max(map(len, out.splitlines())) <= 80
    assert "water" not in torque(capsys, *arguments)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("1 0", "three numbers"),
        ("1 0 nan", "water_velocity"),
        ("east", "three numbers"),
        ("1e9 0 0", "at most 100 m/s"),
    ],
)
@pytest.mark.parametrize("command", ["torque", "trajectory"])
def test_a_bad_current_is_one_line_and_status_2(
    capsys, tmp_path, command, text, message
):
    path = tmp_path / "motion.csv"
    path.write_text(motion_text())
    first = ["--q", "3", "1", "1", "0"] if command == "torque" else [str(path)]
    assert main([command, *first, "--water-velocity", text]) == 2
    out = capsys.readouterr()
    assert out.out == ""
    assert len(out.err.strip().splitlines()) == 1
    assert message in out.err


def motion_text(rod: bool = False) -> str:
    t = np.arange(0, 4, 0.05)
    q = [1.5 + amplitude * np.sin(t) for amplitude in (0.4, 0.3, 0.2, 0.5)]
    names = [f"axis_{k}_pos" for k in ("edcba" if rod else "edcb")]
    table = np.column_stack([t, *q, *([0.007 + 0.002 * np.sin(t)] if rod else [])])
    rows = [",".join(words(row)) for row in table]
    return "\n".join([",".join(["time_secs", *names]), *rows]) + "\n"


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "motion.csv"
    path.write_text(motion_text(rod=True))
    return path


def test_a_motion_in_a_current_is_that_of_the_arm_in_moving_water(file):
    a = a5.trajectory.analyse(a5.trajectory.read_motion(file), water_velocity=CURRENT)
    s = a.smooth
    for k in (0, 17, 60):
        state = s.position[k], s.velocity[k], s.acceleration[k]
        for level, name in enumerate(LEVELS):
            wet = a.arm.with_hydrodynamics(CURRENT, name)
            tau = (
                a.torque[k]
                + a.moving_water.torque[k, level]
                - a.moving_water.torque[k, 1]
            )
            load = (
                a.base_wrench[k]
                + a.moving_water.wrench[k, level]
                - a.moving_water.wrench[k, 1]
            )
            np.testing.assert_allclose(tau, wet.inverse_dynamics(*state), atol=1e-12)
            np.testing.assert_allclose(load, wet.base_wrench(*state).vector, atol=1e-11)
    causes = a.causes()
    assert list(causes) == [
        "inertia",
        "coriolis",
        "weight",
        "buoyancy",
        "moving_water",
        "friction",
    ]
    total = sum(x for name, x in causes.items() if name != "friction")
    np.testing.assert_allclose(total, a.torque, atol=1e-14)


def columns_of_the_command(file, tmp_path):
    """The table that the command writes for a current: name -> numbers."""
    table = tmp_path / "out.csv"
    words = ["trajectory", str(file), "--water-velocity", TEXT, "--output", str(table)]
    assert main(words) == 0
    with table.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def summary_of_the_command(file, capsys):
    assert main(["trajectory", str(file), "--water-velocity", TEXT, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def test_text_and_summary_have_the_current(file, tmp_path, capsys):
    columns_of_the_command(file, tmp_path)
    said = capsys.readouterr().out
    assert "current (0.4, -0.7, 0.3) m/s; estimated, not published" in said
    summary = summary_of_the_command(file, capsys)
    assert summary["model"]["water_current"] == list(CURRENT)


def test_table_and_summary_have_the_cause(file, tmp_path, capsys):
    column = columns_of_the_command(file, tmp_path)
    capsys.readouterr()
    summary = summary_of_the_command(file, capsys)
    for name, joint in summary["joints"].items():
        nominal = column[f"{name}_torque_moving_water"]
        low = column[f"{name}_torque_moving_water_low"]
        high = column[f"{name}_torque_moving_water_high"]
        at = np.abs(nominal).argmax()
        peak = joint["moving_water_peak"]
        assert peak["value"] == pytest.approx(nominal[at], rel=1e-8)
        # As terms have different signs, the nominal value may be the outermost.
        ends = (low[at], nominal[at], high[at])
        assert peak["interval"] == pytest.approx([min(ends), max(ends)], rel=1e-8)
        assert joint["causes_peak"]["moving_water"] == pytest.approx(abs(peak["value"]))
        causes = ("inertia", "coriolis", "weight", "buoyancy", "moving_water")
        total = sum(column[f"{name}_torque_{cause}"] for cause in causes)
        np.testing.assert_allclose(total, column[f"{name}_torque"], atol=1e-8)


def test_summary_has_the_cause_on_the_mount(file, capsys):
    summary = summary_of_the_command(file, capsys)
    a = a5.trajectory.analyse(a5.trajectory.read_motion(file), water_velocity=CURRENT)
    for key, part in (
        ("water_force_peak_n", slice(3)),
        ("water_moment_peak_nm", slice(3, 6)),
    ):
        sizes = np.linalg.norm(a.moving_water.wrench[:, :, part], axis=2)
        at = sizes[:, 1].argmax()
        load = summary["mount"][key]
        assert load["value"] == pytest.approx(sizes[at, 1])
        assert load["interval"] == pytest.approx(sorted(sizes[at, [0, 2]]))


def test_without_a_current_nothing_is_said_of_moving_water(file):
    a = a5.trajectory.analyse(a5.trajectory.read_motion(file))
    assert a.moving_water is None
    assert "water" not in a5.trajectory.text(a)
    assert not any("water" in name for name in a5.trajectory.columns(a))


def test_a_floating_base_has_no_mount_to_load():
    arm = a5.load(floating_base=True)
    q = np.zeros((1, 11))
    v = np.zeros((1, 10))
    with pytest.raises(a5.errors.InputError, match="fixed base"):
        water_terms(arm, q, v, v, CURRENT)


def test_the_polar_picture_is_the_load_over_the_direction(tmp_path, capsys):
    q = (3.1, 1.2, 1.8, 0.4)
    arm = a5.load()
    page = mount_load_figure(arm, q, 0.8)
    angles = page.axes[0].lines[0].get_xdata()
    for i in (0, 11, 40, 72):
        flow = 0.8 * np.array([np.cos(angles[i]), np.sin(angles[i]), 0.0])
        for axes, kind in zip(page.axes, (1, 2), strict=True):
            sizes = [
                np.linalg.norm(current_load.load(q, flow, level)[kind])
                for level in range(3)
            ]
            assert axes.lines[0].get_ydata()[i] == pytest.approx(sizes[1], rel=1e-9)
            corners = axes.collections[0].get_paths()[0].vertices
            for end in (sizes[0], sizes[2]):
                near = np.abs(corners - [angles[i], end]).max(axis=1)
                assert near.min() < 1e-9
    assert "estimated, not published" in page.get_suptitle()
    path = tmp_path / "polar.svg"
    words_given = ["--q", *words(q), "--water-velocity", "0.8 0 0", "--plot", str(path)]
    assert torque(capsys, *words_given).endswith(f"wrote {path}\n")
    assert path.stat().st_size > 5000


def test_the_polar_picture_is_that_of_the_position(monkeypatch, tmp_path, capsys):
    """Not of the velocity or acceleration, and of this arm and speed."""
    made = []
    kept = figures.write_figure

    def write_figure(page, *arguments, **named):
        made.append(page)
        kept(page, *arguments, **named)

    monkeypatch.setattr(figures, "write_figure", write_figure)
    q = (3.0, 1.1, 1.7, 0.3)
    given = [
        "--q",
        *words(q),
        "--v",
        "0.3",
        "0.2",
        "0.1",
        "0.4",
        "--a",
        "1",
        "2",
        "3",
        "4",
    ]
    path = str(tmp_path / "polar.svg")
    torque(
        capsys,
        *given,
        "--fluid",
        "fresh",
        "--water-velocity",
        "0.3 0.4 0",
        "--plot",
        path,
    )
    wanted = mount_load_figure(a5.load(a5.FRESH_WATER), q, 0.5)
    (page,) = made
    for axes, other in zip(page.axes, wanted.axes, strict=True):
        line = axes.lines[0].get_ydata()
        assert line == pytest.approx(other.lines[0].get_ydata(), rel=1e-9)


@pytest.mark.parametrize("current", [[], ["--water-velocity", "0 0 0"]])
def test_a_polar_picture_needs_a_current(tmp_path, capsys, current):
    path = tmp_path / "polar.png"
    assert (
        main(["torque", "--q", "3", "1", "1", "0", *current, "--plot", str(path)]) == 2
    )
    out = capsys.readouterr()
    assert "--water-velocity" in out.err
    assert (out.out, path.exists()) == ("", False)


#: Rows of the documentation's table.
LOADS = (
    "force on the mount [N]",
    "moment on the mount [N m]",
    "torque of axis_e [N m]",
    "torque of axis_d [N m]",
    "torque of axis_c [N m]",
)


def documented_loads() -> list[str]:
    """Rows of the documentation's table of loads, of 20 000 poses and directions."""
    rng = np.random.default_rng(0)
    q = rng.uniform(LOWER, UPPER, (20_000, 4))
    direction = rng.normal(size=(20_000, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    found = [loads_of_unit_current(level, q, direction) for level in LEVELS]
    low, nominal, high = np.median(found, axis=1)
    most = np.max(found[1], axis=0)
    rows = []
    for name, *loads in zip(LOADS, low, nominal, high, most, strict=True):
        cells = " | ".join(f"{value:.2g}" for value in loads)
        rows.append(f"| {name} | {cells} |")
    return rows


def loads_of_unit_current(
    level: str, q: np.ndarray, direction: np.ndarray
) -> np.ndarray:
    """Force and moment on the mount and three joint torques by 1 m/s, (n, 5)."""
    arm = a5.load()
    wet = arm.with_hydrodynamics(level=level)
    still = np.zeros_like(q)
    tau = wet.inverse_dynamics_batch(q, still, still, water_velocity=direction)
    tau -= arm.inverse_dynamics_batch(q, still, still)
    wrench = wet.base_wrench_batch(q, still, still, water_velocity=direction)
    wrench -= arm.base_wrench_batch(q, still, still)
    sizes = np.linalg.norm(wrench.reshape(-1, 2, 3), axis=2)
    return np.column_stack([sizes, np.abs(tau[:, :3])])


def test_the_documented_table_of_loads_is_the_strips():
    page = Path(__file__).parents[2] / "docs" / "guides" / "moving-water.md"
    lines = page.read_text("utf-8").splitlines()
    beginnings = tuple(f"| {name} |" for name in LOADS)
    rows = [line for line in lines if line.startswith(beginnings)]
    assert rows == documented_loads()


def test_the_load_of_a_current_grows_with_its_square():
    q = np.tile(a5.named_pose("reach"), (2, 1))
    direction = np.array([[0.6, -0.64, 0.48], [1.2, -1.28, 0.96]])
    slow, fast = loads_of_unit_current("nominal", q, direction)
    np.testing.assert_allclose(fast, 4.0 * slow, rtol=1e-12)
