"""What recordings of real arms have: each fault is repaired and said, or refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
TIME = 0.02 * np.arange(600)
#: Motion of the four joints in the middle of their ranges, [rad].
MOVED = np.column_stack(
    [
        2.8 + 0.6 * np.sin(0.4 * TIME),
        1.4 + 0.5 * np.sin(0.5 * TIME),
        1.6 + 0.4 * np.sin(0.8 * TIME),
        2.5 + 0.3 * np.sin(2.0 * TIME),
    ]
)
Rows = list[list[str]]


def write(path: Path, header: list[str], rows: Rows, encoding: str = "utf-8") -> Path:
    lines = [",".join(header), *(",".join(row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding=encoding)
    return path


def rows_of(position: np.ndarray, time: np.ndarray = TIME) -> Rows:
    return [
        [f"{t:.17g}", *(f"{x:.9f}" for x in q)]
        for t, q in zip(time.tolist(), position.tolist(), strict=True)
    ]


def header(ending: str = "_pos", time: str = "time_secs") -> list[str]:
    return [time, *(joint + ending for joint in JOINTS)]


def peaks(motion: a5.trajectory.Motion) -> np.ndarray:
    return np.abs(a5.trajectory.analyse(motion, a5.load()).torque).max(axis=0)


def kinds(motion: a5.trajectory.Motion) -> set[str]:
    return {warning.kind for warning in motion.warnings}


TRUE_PEAKS = peaks(a5.trajectory.motion(TIME, MOVED))


def test_one_empty_cell_loses_one_effort(tmp_path: Path) -> None:
    names = header()
    names += [f"{joint}_effort" for joint in JOINTS]
    names += [f"{joint}_current" for joint in JOINTS]
    extra = 0.01 * np.arange(600 * 8).reshape(600, 8) / 4800
    rows = [
        row + [f"{x:.9f}" for x in more]
        for row, more in zip(rows_of(MOVED), extra.tolist(), strict=True)
    ]
    rows[70][5] = ""
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", names, rows))
    expected = extra.round(9)
    expected[70, 0] = np.nan
    np.testing.assert_array_equal(motion.effort, expected[:, :4])
    np.testing.assert_array_equal(motion.current, expected[:, 4:])
    assert motion.ignored == ()


def test_csv_and_parquet_of_a_frame_are_the_same(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("pyarrow")
    frame = pandas.DataFrame(MOVED.copy(), columns=header()[1:])
    frame.insert(0, "time_secs", TIME)
    for k, joint in enumerate(JOINTS):
        frame[f"{joint}_effort"] = 0.1 * MOVED[:, k]
    frame.loc[70, "axis_e_effort"] = np.nan
    frame.loc[90, "axis_d_pos"] = np.nan
    frame.to_csv(tmp_path / "m.csv", index=False)
    frame.to_parquet(tmp_path / "m.parquet")
    one = a5.trajectory.read_motion(tmp_path / "m.csv")
    other = a5.trajectory.read_motion(tmp_path / "m.parquet")
    for name in ("time", "position", "effort"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert kinds(one) == kinds(other) == {"bad_row"}


def test_a_clock_that_was_set_back_is_refused_with_all_digits(tmp_path: Path) -> None:
    time = 1.76e9 + TIME
    time[300:] -= 2.3
    path = write(tmp_path / "m.csv", header(), rows_of(MOVED, time))
    with pytest.raises(FileFormatError) as refusal:
        a5.trajectory.read_motion(path)
    assert "line 302" in str(refusal.value)
    assert "1760000005.98 s, got 1760000003.7 s" in str(refusal.value)


@pytest.mark.parametrize("low", [-np.pi, 0.0])
def test_wrapped_angles_go_on(low: float) -> None:
    shifted = MOVED.copy()
    shifted[:, 0] += 3.1 if low == 0.0 else 0.0
    wrapped = (shifted - low) % (2 * np.pi) + low
    assert (np.abs(np.diff(wrapped, axis=0)) > 6.0).any()
    motion = a5.trajectory.motion(TIME, wrapped)
    difference = motion.position - shifted
    turns = np.round(difference / (2 * np.pi))
    np.testing.assert_allclose(difference, 2 * np.pi * turns, atol=1e-12)
    assert (np.ptp(turns, axis=0) == 0).all()
    assert "wrapped" in kinds(motion)


@pytest.mark.parametrize("factor", [0.0, 10.0, -1.0])
def test_velocities_that_contradict_the_positions_are_not_used(factor: float) -> None:
    slope = np.gradient(MOVED, TIME, axis=0)
    wrong = a5.trajectory.motion(TIME, MOVED, factor * slope)
    analysis = a5.trajectory.analyse(wrong, a5.load())
    assert not analysis.smooth.from_velocity
    assert "velocity" in {warning.kind for warning in analysis.warnings}
    np.testing.assert_allclose(np.abs(analysis.torque).max(axis=0), TRUE_PEAKS)
    right = a5.trajectory.analyse(a5.trajectory.motion(TIME, MOVED, slope), a5.load())
    assert right.smooth.from_velocity
    given = a5.trajectory.analyse(wrong, a5.load(), use_velocity=True)
    assert given.smooth.from_velocity


@pytest.mark.parametrize("fault", ["spike", "zeros"])
def test_a_moment_of_wrong_velocities_is_found(fault: str) -> None:
    velocity = np.gradient(MOVED, TIME, axis=0)
    if fault == "spike":
        at = int(np.argmin(np.abs(velocity[50:-50, 1]))) + 50
        velocity[at, 1] = 50.0
    else:
        at = int(np.argmax(np.abs(velocity[50:-50, 1]))) + 50
        velocity[at - 20 : at + 21] = 0.0
    wrong = a5.trajectory.motion(TIME, MOVED, velocity)
    analysis = a5.trajectory.analyse(wrong, a5.load())
    assert not analysis.smooth.from_velocity
    np.testing.assert_allclose(np.abs(analysis.torque).max(axis=0), TRUE_PEAKS)
    [found] = [w for w in analysis.warnings if w.joint == "axis_d"]
    place = float(found.first.removeprefix("at ").removesuffix(" s"))
    assert place == pytest.approx(TIME[at], abs=0.1)


def test_velocities_beside_a_gap_or_late_by_a_hold_are_used() -> None:
    velocity = np.gradient(MOVED, TIME, axis=0)
    gap = (TIME < 3.0) | (TIME > 4.5)
    late = np.stack([np.interp(TIME - 0.1, TIME, v) for v in velocity.T], axis=1)
    for time, position, given in (
        (TIME[gap], MOVED[gap], velocity[gap]),
        (TIME, MOVED, late),
    ):
        motion = a5.trajectory.motion(time, position, given)
        assert a5.trajectory.analyse(motion, a5.load()).smooth.from_velocity


def test_slow_motion_with_velocities_of_zero() -> None:
    slow = MOVED[0] + 0.02 * np.sin(0.4 * TIME)[:, None]
    motion = a5.trajectory.motion(TIME, slow, np.zeros_like(slow))
    assert not a5.trajectory.analyse(motion, a5.load()).smooth.from_velocity


@pytest.mark.parametrize("length", [1, 2, 3])
def test_spikes_are_left_out_by_name(length: int) -> None:
    spiked = MOVED.copy()
    spiked[200 : 200 + length, 1] += 0.8
    motion = a5.trajectory.motion(TIME, spiked)
    [warning] = motion.warnings
    assert (warning.kind, warning.count) == ("spike", length)
    assert warning.first == "sample 200 of axis_d"
    assert motion.time.size == TIME.size - length
    np.testing.assert_allclose(peaks(motion), TRUE_PEAKS, rtol=2e-3)


def test_a_drop_out_is_left_out_by_name() -> None:
    frozen = MOVED.copy()
    frozen[100:220] = frozen[100]
    motion = a5.trajectory.motion(TIME, frozen)
    assert kinds(motion) == {"drop_out", "gap"}
    assert motion.time.size == TIME.size - 119
    np.testing.assert_allclose(peaks(motion), TRUE_PEAKS, rtol=0.1)


def test_a_jump_makes_no_torque() -> None:
    offset = MOVED.copy()
    offset[300:, 0] += 1.0  # about a vertical axis, which gravity does not load
    motion = a5.trajectory.motion(TIME, offset)
    assert kinds(motion) == {"jump"}
    np.testing.assert_allclose(peaks(motion), TRUE_PEAKS, rtol=0.02, atol=1e-3)


def test_rest_before_a_jump_is_no_drop_out() -> None:
    resting = np.repeat(MOVED[:1], 600, axis=0)
    resting[300:, 0] += 1.0
    motion = a5.trajectory.motion(TIME, resting)
    assert kinds(motion) == {"jump"}
    assert motion.time.size == 600


def test_rows_of_one_joint_each_are_joined(tmp_path: Path) -> None:
    rows = rows_of(MOVED)
    for k, row in enumerate(rows):
        for column in range(1, 5):
            if column != 1 + k % 4:
                row[column] = ""
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", header(), rows))
    assert kinds(motion) == {"joined"}
    np.testing.assert_array_equal(motion.time, TIME[3:-3])
    np.testing.assert_allclose(motion.position, MOVED[3:-3], atol=1e-3)
    np.testing.assert_allclose(peaks(motion), TRUE_PEAKS, rtol=0.01)


def clock(seconds: float, start: float = 0.0) -> str:
    minutes, rest = divmod(round(start + seconds, 6), 60.0)
    return f"{int(minutes) // 60:02d}:{int(minutes) % 60:02d}:{rest:09.6f}"


CLOCKS: dict[str, Callable[[float], str]] = {
    "hh:mm:ss": clock,
    "past an hour": lambda t: clock(t, 3595.0),
    "past midnight": lambda t: clock((t + 86395.0) % 86400.0),
    "pandas": lambda t: f"0 days {clock(t)}",
    "MATLAB": lambda t: f"{t:.17g} sec",
    "minutes": lambda t: f"{t / 60:.17g} min",
}


@pytest.mark.parametrize("form", CLOCKS)
def test_times_of_clocks(form: str, tmp_path: Path) -> None:
    rows = [[CLOCKS[form](float(row[0])), *row[1:]] for row in rows_of(MOVED)]
    path = write(tmp_path / "m.csv", header(time="time"), rows)
    time = a5.trajectory.read_motion(path).time
    np.testing.assert_allclose(time - time[0], TIME, atol=1e-9)


def test_date_and_time_in_two_columns(tmp_path: Path) -> None:
    rows = []
    for row in rows_of(MOVED):
        past_midnight = float(row[0]) >= 5.0
        day = "2024-03-01" if past_midnight else "2024-02-29"
        rows.append([day, clock((float(row[0]) + 86395.0) % 86400.0), *row[1:]])
    path = write(tmp_path / "m.csv", ["Date", *header(time="Time")], rows)
    time = a5.trajectory.read_motion(path).time
    np.testing.assert_allclose(time - time[0], TIME, atol=1e-6)
    assert time[0] == 1709251195.0  # date -d '2024-02-29 23:59:55Z' +%s


def test_windows_1252(tmp_path: Path) -> None:
    rows = rows_of(np.degrees(MOVED))
    path = write(tmp_path / "m.csv", header("_pos [°]"), rows, encoding="cp1252")
    np.testing.assert_allclose(
        a5.trajectory.read_motion(path).position, MOVED, atol=1e-9
    )


def test_the_time_by_name(tmp_path: Path) -> None:
    rows = [[f"{1e3 * float(row[0]):.6f}", *row[1:]] for row in rows_of(MOVED)]
    path = write(tmp_path / "m.csv", header(time="tick"), rows)
    with pytest.raises(FileFormatError, match="--time"):
        a5.trajectory.read_motion(path)
    motion = a5.trajectory.read_motion(path, time="tick:ms")
    np.testing.assert_allclose(motion.time, TIME, atol=1e-9)
    for wrong in ("tock", "tick:hours"):
        with pytest.raises(InputError) as refusal:
            a5.trajectory.read_motion(path, time=wrong)
        assert refusal.value.name == "time"


def test_a_joint_that_turns_the_other_way(tmp_path: Path) -> None:
    turned = MOVED * [1, 1, 1, -1]
    path = write(tmp_path / "m.csv", header(), rows_of(turned))
    joints = {"axis_b": "-axis_b"}
    motion = a5.trajectory.read_motion(path, joints=joints)
    np.testing.assert_allclose(motion.position, MOVED, atol=1e-9)


def test_columns_that_are_not_used_are_named(tmp_path: Path) -> None:
    names = header()
    names += [f"{joint}_vel_rad_s" for joint in JOINTS]
    names += [f"{joint}_torque" for joint in JOINTS]
    slope = np.gradient(MOVED, TIME, axis=0)
    rows = [
        row + [f"{x:.9f}" for x in v] + ["0.1"] * 4
        for row, v in zip(rows_of(MOVED), slope.tolist(), strict=True)
    ]
    motion = a5.trajectory.read_motion(write(tmp_path / "m.csv", names, rows))
    np.testing.assert_allclose(motion.velocity, slope, atol=1e-9)
    [warning] = motion.warnings
    assert (warning.kind, warning.count) == ("not_used", 4)
    assert "axis_e_torque" in warning.text


def test_an_error_names_the_columns_of_the_file(tmp_path: Path) -> None:
    names = ["time_secs", "j1", "j2", "j3", "j4"]
    rows = rows_of(MOVED)
    for row in rows[:20]:
        row[2] = "off"
    path = write(tmp_path / "m.csv", names, rows)
    joints = dict(zip(JOINTS, names[1:], strict=True))
    with pytest.raises(FileFormatError, match=r"line 2, column 3 \(j2\)"):
        a5.trajectory.read_motion(path, joints=joints)


def test_what_ros2_topic_echo_prints_is_named(tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text("header:\n  stamp:\n    sec: 1\n    nanosec: 0\nname:\n- axis_e\n")
    with pytest.raises(FileFormatError, match="--csv"):
        a5.trajectory.read_motion(path)


def test_the_payload_is_in_the_answer() -> None:
    motion = a5.trajectory.motion(TIME, MOVED)
    arm = a5.load()
    held = arm.with_payload(0.5, volume=1e-4).with_payload(0.25)
    for model, mass, words in ((arm, 0.0, "none"), (held, 0.75, "0.75 kg")):
        analysis = a5.trajectory.analyse(motion, model)
        assert a5.trajectory.summary(analysis)["model"]["payload_kg"] == mass
        assert model.payload_mass == mass
        assert f"payload: {words}" in a5.trajectory.text(analysis)
