"""Recorded currents against the computed ones, and efforts that are milliamperes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError, ShapeError

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
TIME = np.arange(0.0, 6.0, 0.05)
#: (120, 4) [rad]
POSITION = a5.named_pose("home") + 0.3 * np.sin(
    TIME[:, None] / np.array([1.0, 0.7, 0.5, 0.8])
)


@pytest.fixture(scope="module")
def computed() -> a5.trajectory.Analysis:
    return a5.trajectory.analyse(a5.trajectory.motion(TIME, POSITION))


def table(path: Path, ending: str, values: np.ndarray, **more: np.ndarray) -> Path:
    """A recording with one column of a quantity for each joint."""
    columns = {"time_secs": TIME}
    columns |= {f"{name}_pos": POSITION[:, k] for k, name in enumerate(JOINTS)}
    columns |= {name + ending: values[:, k] for k, name in enumerate(JOINTS)}
    columns |= more
    rows = np.column_stack([*columns.values()])
    np.savetxt(path, rows, delimiter=",", header=",".join(columns), comments="")
    return path


def analysed(path: Path) -> a5.trajectory.Analysis:
    return a5.trajectory.analyse(a5.trajectory.read_motion(path))


def kinds(analysis: a5.trajectory.Analysis) -> set[str]:
    return {warning.kind for warning in analysis.warnings}


def figures(analysis: a5.trajectory.Analysis) -> dict[str, Any]:
    joints = a5.trajectory.summary(analysis)["joints"]
    return {name: joint["recorded_current"] for name, joint in joints.items()}


#: Ending of the column -> numbers in it for one ampere, and the kinds of warnings.
UNITS: dict[str, tuple[float, set[str]]] = {
    "_current": (1.0, set()),
    "_measured_current": (1e3, {"current_unit"}),
    "_current [A]": (1.0, set()),
    "_current [mA]": (1e3, set()),
    "_current_mA": (1e3, set()),
    "_current_A": (1.0, set()),
    "_mA": (1e3, set()),
    "_effort [mA]": (1e3, set()),
    "_effort_A": (1.0, set()),
    "_effort": (1e3, {"effort_unit"}),
}


@pytest.mark.parametrize("ending", UNITS)
def test_currents_are_compared_with_those_computed(
    computed: a5.trajectory.Analysis, ending: str, tmp_path: Path
) -> None:
    """A known gain and offset give figures that are known beforehand."""
    count, expected = UNITS[ending]
    recorded = 2 * computed.current + 0.125
    analysis = analysed(table(tmp_path / "m.csv", ending, count * recorded))
    assert kinds(analysis) == expected
    assert analysis.effort is None
    np.testing.assert_allclose(analysis.recorded_current, recorded, rtol=1e-12)
    np.testing.assert_array_equal(analysis.torque, computed.torque)

    difference = computed.current + 0.125
    for k, joint in enumerate(figures(analysis).values()):
        assert joint["samples"] == TIME.size
        assert joint["difference_mean"] == pytest.approx(difference[:, k].mean())
        rms = np.sqrt(np.mean(difference[:, k] ** 2))
        assert joint["difference_rms"] == pytest.approx(rms)
        largest = difference[np.abs(difference[:, k]).argmax(), k]
        assert joint["difference_peak"]["value"] == pytest.approx(largest)
        assert joint["correlation"] == pytest.approx(1.0)


@pytest.mark.parametrize("scale", [0.1, 1.0, 1.9])
def test_efforts_in_newton_metres_stay_so(
    computed: a5.trajectory.Analysis, scale: float, tmp_path: Path
) -> None:
    """Also with all of Table 4's friction, and with almost none."""
    effort = scale * (computed.torque + computed.friction)
    analysis = analysed(table(tmp_path / "m.csv", "_effort", effort))
    assert kinds(analysis) == set()
    assert analysis.recorded_current is None
    np.testing.assert_allclose(analysis.effort, effort, rtol=1e-12)


def test_recorded_currents_win_over_efforts_in_milliamperes(
    computed: a5.trajectory.Analysis, tmp_path: Path
) -> None:
    efforts = {
        f"{name}_effort": 900 * computed.current[:, k] for k, name in enumerate(JOINTS)
    }
    path = table(tmp_path / "m.csv", "_current", computed.current, **efforts)
    analysis = analysed(path)
    np.testing.assert_allclose(analysis.recorded_current, computed.current)
    assert analysis.effort is None


def test_holes_and_text_in_currents(
    computed: a5.trajectory.Analysis, tmp_path: Path
) -> None:
    holes = computed.current.copy()
    holes[3:50, 1] = np.nan
    holes[:, 3] = np.nan
    path = table(tmp_path / "m.csv", "_current", holes)
    found = figures(analysed(path))
    assert found["axis_d"]["samples"] == TIME.size - 47
    assert found["axis_b"] is None

    # Efforts are not lost because the currents hold text.
    efforts = {f"{name}_effort": np.ones(TIME.size) for name in JOINTS}
    path = table(tmp_path / "m.csv", "_current", computed.current * np.nan, **efforts)
    path.write_text(path.read_text("utf-8").replace("nan", "off"), "utf-8")
    motion = a5.trajectory.read_motion(path)
    assert motion.current is None
    np.testing.assert_array_equal(motion.effort, np.ones((TIME.size, 4)))
    assert "axis_e_current" in motion.ignored


def test_currents_of_arrays_and_of_the_jaw_rod() -> None:
    position = np.column_stack([POSITION, np.full(TIME.size, 0.005)])
    recorded = np.arange(5.0) + np.zeros_like(position)
    names = [*JOINTS, "axis_a"]
    motion = a5.trajectory.motion(
        TIME, position[:, ::-1], joints=names[::-1], current=recorded[:, ::-1]
    )
    np.testing.assert_array_equal(motion.current, recorded)
    found = figures(a5.trajectory.analyse(motion))
    # The current of the rod's motor cannot be computed without the screw's lead.
    assert found["axis_a"] is None
    assert found["axis_b"]["rms"] == pytest.approx(3.0)
    # An arm with locked jaws leaves the rod out.
    locked = a5.trajectory.analyse(motion, a5.load())
    np.testing.assert_array_equal(locked.recorded_current, recorded[:, :4])

    with pytest.raises(ShapeError, match="current"):
        a5.trajectory.motion(TIME, position, current=recorded[:, :4])
    with pytest.raises(InputError, match=r"up to the .* A of a stalled motor; divide"):
        a5.trajectory.motion(TIME, position, current=1e3 * recorded)


def test_a_written_table_returns_what_was_recorded(
    computed: a5.trajectory.Analysis, tmp_path: Path
) -> None:
    """Not what was computed, whose columns have an interval."""
    recorded = 2 * computed.current + 0.125
    analysis = analysed(table(tmp_path / "m.csv", "_current", recorded))
    a5.trajectory.write(analysis, tmp_path / "again.csv")
    again = a5.trajectory.read_motion(tmp_path / "again.csv")
    np.testing.assert_allclose(again.current, recorded, rtol=1e-8)

    a5.trajectory.write(computed, tmp_path / "computed.csv")
    assert a5.trajectory.read_motion(tmp_path / "computed.csv").current is None
