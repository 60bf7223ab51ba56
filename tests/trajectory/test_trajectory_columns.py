"""What a column's name says: only measured joint positions are read as such."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag
from column_names import POSITIONS, not_positions
from least_time import assert_linear_time

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError

JOINTS = [f"axis_{letter}" for letter in "edcb"]
ROWS = 8
TIME = 0.1 * np.arange(ROWS)
#: (8, 4) [rad]
ANGLES = 1.0 + 0.1 * np.arange(4) + 0.01 * np.arange(ROWS)[:, None]
OTHERS = 0.2 + 0.05 * np.arange(4) + 0.01 * np.arange(ROWS)[:, None]


def named(pattern: str, values: np.ndarray) -> dict[str, np.ndarray]:
    """A column of each arm joint."""
    return {pattern.replace("*", joint): values[:, k] for k, joint in enumerate(JOINTS)}


def write(path: Path, table: dict[str, np.ndarray]) -> Path:
    lines = [",".join(f'"{name}"' for name in table)]
    lines += [
        ",".join(map(repr, map(float, row)))
        for row in zip(*table.values(), strict=True)
    ]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def test_beside_positions_they_change_none(tmp_path: Path) -> None:
    plain = write(tmp_path / "p.csv", {"time": TIME, **named("*_pos", ANGLES)})
    expected = a5.trajectory.read_motion(plain)
    for pattern in not_positions():
        others = named(pattern, OTHERS)
        table = {"time": TIME, **others, **named("*_pos", ANGLES)}
        motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", table))
        np.testing.assert_array_equal(motion.position, expected.position)
        optional = (motion.velocity, motion.effort, motion.current)
        used = [x for x in optional if x is not None]
        assert len(used) <= 1
        if used:
            milli = 1e-3 if pattern.lower().endswith(("_ma", "_milliamps")) else 1.0
            np.testing.assert_array_equal(used[0], OTHERS * milli)
        assert motion.ignored == (() if used else tuple(others))


@pytest.mark.parametrize(("pattern", "prefix"), POSITIONS.items())
def test_these_are_positions(pattern: str, prefix: str, tmp_path: Path) -> None:
    other = "dq_" + prefix + "*"
    table = {"time": TIME, **named(pattern, ANGLES), **named(other, OTHERS)}
    path = write(tmp_path / "m.csv", table)
    for asked in (None, prefix):
        motion = a5.trajectory.read_motion(path, prefix=asked)
        np.testing.assert_array_equal(motion.position, ANGLES)
        assert motion.ignored in ((), tuple(named(other, OTHERS)))
        assert (motion.velocity is None) == bool(motion.ignored)


def test_a_log_of_the_vehicles_simulator(tmp_path: Path) -> None:
    """The columns of a public logger of this arm, in its order."""
    effort = OTHERS + 1
    table = {"wall_time_sec": 1e9 + TIME, "sim_time_sec": TIME, "pass_index": 0 * TIME}
    table |= named("q_alpha_*", ANGLES)
    table |= named("dq_alpha_*", OTHERS)
    table |= named("ddq_alpha_*", OTHERS + 2)
    table |= named("ref_alpha_*", ANGLES + 0.1)
    table |= named("dref_alpha_*", OTHERS + 4)
    table |= named("effort_alpha_*", effort)
    table |= named("cmd_tau_*", OTHERS + 3) | {"cmd_tau_axis_a": TIME}
    table |= {"vehicle_x": TIME, "vehicle_roll": TIME}
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", table))
    assert motion.joints == tuple(JOINTS)
    np.testing.assert_array_equal(motion.time, 1e9 + TIME)
    np.testing.assert_array_equal(motion.position, ANGLES)
    np.testing.assert_array_equal(motion.velocity, OTHERS)
    np.testing.assert_array_equal(motion.effort, effort)
    unused = ("sim_time", "pass_", "ddq_", "ref_", "dref_", "cmd_", "vehicle_")
    assert motion.ignored == tuple(name for name in table if name.startswith(unused))
    notes = {warning.kind: warning for warning in motion.warnings}
    assert sorted(notes) == ["command", "time_column"]
    assert notes["command"].count == 4 + 4 + 5
    assert notes["command"].first == "ref_alpha_axis_e, line 1"
    assert "ignored" in notes["command"].text
    assert (
        notes["time_column"].text == "wall_time_sec read as the time, not sim_time_sec"
    )
    assert (notes["time_column"].count, notes["time_column"].first) == (1, "line 1")


def test_a_file_of_commands_is_refused_by_name_and_read_on_request(
    tmp_path: Path,
) -> None:
    """The columns of a public file of torque commands."""
    table = {"time_sec": TIME, "vehicle_fx": TIME}
    table |= named("tau_*", OTHERS) | {"tau_axis_a": 0 * TIME}
    table |= named("arm_ref_*", ANGLES) | {"arm_ref_axis_a": 0.002 + 0 * TIME}
    table |= named("arm_dref_*", OTHERS)
    path = write(tmp_path / "commands.csv", table)
    expected = (
        r"tau_axis_e is a torque, arm_ref_axis_e is a command \(prefix arm_ref_ reads"
    )
    with pytest.raises(FileFormatError, match=expected):
        a5.trajectory.read_motion(path)
    motion = a5.trajectory.read_motion(path, prefix="arm_ref_")
    np.testing.assert_array_equal(motion.position[:, :4], ANGLES)
    assert motion.joints[-1] == "axis_a"
    for prefix in ("tau_", "torque_", "current_", "vel_"):
        path = write(tmp_path / "m.csv", {"time": TIME, **named(prefix + "*", OTHERS)})
        with pytest.raises(FileFormatError, match=rf"{prefix}axis_e is a"):
            a5.trajectory.read_motion(path, prefix=prefix)


def test_what_is_not_known_is_read_on_request(tmp_path: Path) -> None:
    for prefix in ("foo_", "cmd_", "raw_", "lower_", "x/", "measured_"):
        table = {"time": TIME, **named(prefix + "*", ANGLES)}
        path = write(tmp_path / "m.csv", table)
        with pytest.raises(FileFormatError, match=f"prefix {prefix} reads it"):
            a5.trajectory.read_motion(path)
        motion = a5.trajectory.read_motion(path, prefix=prefix)
        np.testing.assert_array_equal(motion.position, ANGLES)


def test_parquet_and_bags_have_the_same_rule(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    table = {"time": TIME, **named("tau_*", OTHERS)}
    parquet.write_table(pyarrow.table(table), tmp_path / "m.parquet")
    with pytest.raises(FileFormatError, match="tau_axis_e is a torque"):
        a5.trajectory.read_motion(tmp_path / "m.parquet")

    for prefix, found in {"tau_": 0, "cmd_": 0, "foo_": 1, "q_alpha_": 1}.items():
        names = [prefix + joint for joint in JOINTS]
        states = [
            State(stamp=10**12 + k * 10**8, names=names, position=row, velocity=row)
            for k, row in enumerate(ANGLES)
        ]
        folder = tmp_path / prefix
        folder.mkdir()
        path = write_bag(folder, ".mcap", states)
        if not found:
            with pytest.raises(
                FileFormatError, match=f"no message has all of.*{prefix}axis_e"
            ):
                a5.trajectory.read_motion(path)
        asked = None if found else prefix
        if prefix == "tau_":
            with pytest.raises(FileFormatError, match="tau_axis_e"):
                a5.trajectory.read_motion(path, prefix=asked)
            continue
        motion = a5.trajectory.read_motion(path, prefix=asked)
        np.testing.assert_array_equal(motion.position, ANGLES)
        np.testing.assert_array_equal(motion.velocity, ANGLES)


@pytest.mark.slow
@pytest.mark.parametrize(
    "pattern", ["c{}", "p{}_axis_e", "left_axis_e_{}", "axis_e" * 3 + "_{}"]
)
def test_many_columns_take_linear_time(pattern: str, tmp_path: Path) -> None:
    """Four times as many columns take about four times as long.

    60 000 columns once took half a minute.
    """
    for joints in (["axis_e_pos", "axis_d_pos", "axis_c_pos", "axis_b_pos"], []):

        def prepared(count: int, joints: list[str] = joints) -> Callable[[], None]:
            header = ["time", *joints, *map(pattern.format, range(count))]
            row = ",".join(["1"] * len(header))
            path = tmp_path / f"{count}.csv"
            path.write_text("\n".join([",".join(header), row]))

            def read() -> None:
                with pytest.raises((InputError, FileFormatError)):
                    a5.trajectory.read_motion(path)

            return read

        assert_linear_time(prepared, 15_000)
