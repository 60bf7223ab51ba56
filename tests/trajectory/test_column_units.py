"""Units in the names of columns."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.trajectory.column_units import scale

JOINTS = [f"axis_{letter}" for letter in "edcb"]
TIME = 0.125 * np.arange(12)
#: (12, 4) [rad] or [rad/s]
ANGLES = 1.0 + 0.25 * np.arange(4) + 0.015625 * np.arange(12)[:, None]
ROD = 0.005 + 0.0001 * np.arange(12)


def written(path: Path, columns: dict[str, np.ndarray]) -> Path:
    rows = [[*columns], *zip(*columns.values(), strict=True)]
    path.write_text("\n".join(",".join(map(str, row)) for row in rows), "utf-8")
    return path


def named(pattern: str, values: np.ndarray) -> dict[str, np.ndarray]:
    return {pattern.replace("*", joint): values[:, k] for k, joint in enumerate(JOINTS)}


def test_positions_in_degrees(tmp_path: Path) -> None:
    for pattern in (
        "*_pos [deg]",
        "*_pos(deg)",
        "*_pos_deg",
        "*_deg",
        "* [deg]",
        "*_degrees",
        "q_* [°]",
        "left_*_position [Degrees]",
        "*_DEG",
    ):
        table = {"time": TIME, **named(pattern, ANGLES * 180 / math.pi)}
        motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", table))
        np.testing.assert_allclose(motion.position, ANGLES, rtol=1e-15)
        assert motion.warnings == ()


def test_angles_in_degrees_without_a_unit(tmp_path: Path) -> None:
    """Velocities are in deg/s, the rod in m, efforts in N m, and units hold."""
    table = {"time": TIME, **named("*_pos", ANGLES * 180 / math.pi)}
    table |= {"axis_a_pos": ROD, "axis_a_vel": ROD}
    table |= named("*_vel", ANGLES * 180 / math.pi)
    table |= named("*_effort", ANGLES)
    table["axis_d_pos [rad]"] = table.pop("axis_d_pos") * math.pi / 180
    motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", table), degrees=True)
    assert motion.velocity is not None
    assert motion.effort is not None
    expected = np.column_stack([ANGLES, ROD])
    np.testing.assert_allclose(motion.position, expected, rtol=1e-15)
    np.testing.assert_allclose(motion.velocity, expected, rtol=1e-15)
    np.testing.assert_array_equal(motion.effort[:, :4], ANGLES)


@pytest.mark.parametrize("joint", [None, *range(4)])
def test_degrees_read_as_radians_are_refused(joint: int | None, tmp_path: Path) -> None:
    """All joints, or one of them; the first that is far off is named."""
    angles = ANGLES.copy()
    columns = slice(None) if joint is None else joint
    angles[:, columns] *= 180 / math.pi
    k = joint or 0
    path = written(tmp_path / "m.csv", {"time": TIME, **named("*_pos", angles)})
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert f"line 2, column {k + 2} (axis_{'edcb'[k]}_pos)" in str(caught.value)
    assert "--degrees" in str(caught.value)
    with pytest.raises(InputError, match=f"axis_{'edcb'[k]} in degrees"):
        a5.trajectory.motion(TIME, angles)


def test_outliers_and_other_units_are_no_degrees() -> None:
    outliers = ANGLES.copy()
    outliers[:6] *= 180 / math.pi  # half of the samples
    assert a5.trajectory.motion(TIME, outliers).warnings
    gradians = ANGLES * 1e3
    assert a5.trajectory.motion(TIME, gradians).warnings


def test_positions_in_radians(tmp_path: Path) -> None:
    for pattern in ("*_pos [rad]", "*_rad", "* (radians)", "*"):
        table = {"time": TIME, **named(pattern, ANGLES)}
        motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", table))
        np.testing.assert_array_equal(motion.position, ANGLES)


def test_each_quantity_has_its_own_units(tmp_path: Path) -> None:
    table = {"time [ms]": TIME * 1e3, **named("*_pos [rad]", ANGLES)}
    table |= {"axis_a_pos [mm]": ROD * 1e3, "axis_a_vel [mm/s]": ROD * 1e3}
    table |= named("*_vel [deg/s]", ANGLES * 180 / math.pi)
    table |= named("*_effort [Nm]", ANGLES)
    motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", table))
    assert motion.velocity is not None
    assert motion.effort is not None
    expected = np.column_stack([ANGLES, ROD])
    np.testing.assert_allclose(motion.time, TIME, rtol=1e-15)
    np.testing.assert_allclose(motion.position, expected, rtol=1e-15)
    np.testing.assert_allclose(motion.velocity, expected, rtol=1e-15)
    np.testing.assert_array_equal(motion.effort[:, :4], ANGLES)


def test_a_unit_of_another_quantity_is_refused(tmp_path: Path) -> None:
    for unit in (" [mm]", " [Nm]", " [deg/s]", " [mA]", " [x]"):
        table = {"time": TIME, **named(f"*_pos{unit}", ANGLES)}
        path = written(tmp_path / "m.csv", table)
        with pytest.raises(FileFormatError, match="the position of axis_e"):
            a5.trajectory.read_motion(path)


@pytest.mark.parametrize(
    ("joint", "quantity", "units", "size"),
    [
        ("axis_e", "position", "deg degs degree degrees °", math.radians(1)),
        ("axis_e", "position", "rad radian radians", 1.0),
        ("axis_e", "velocity", "deg/s °/s", math.radians(1)),
        ("axis_e", "velocity", "rad/s", 1.0),
        ("axis_e", "effort", "nm n*m n·m", 1.0),
        ("axis_a", "position", "mm", 1e-3),
        ("axis_a", "position", "m", 1.0),
        ("axis_a", "velocity", "mm/s", 1e-3),
        ("axis_a", "velocity", "m/s", 1.0),
        ("axis_a", "effort", "n", 1.0),
        ("axis_b", "current", "a amp amps ampere amperes", 1.0),
        ("axis_a", "current", "ma milliamp milliamps milliamperes", 1e-3),
    ],
)
def test_each_unit_has_its_size(
    joint: str, quantity: str, units: str, size: float
) -> None:
    for unit in units.split():
        assert scale(joint, quantity, unit) == pytest.approx(size, rel=1e-15)
    assert scale("axis_e", "effort", "n m") == 1.0
    assert scale(joint, quantity, "furlong") is None
    assert scale(joint, "torque", units.split()[0]) is None
