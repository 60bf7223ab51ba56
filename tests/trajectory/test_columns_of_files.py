"""Rows about one joint, units, names of files, and what is refused with its place."""

from __future__ import annotations

import io
import math
import zipfile
from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag
from short_recording import JOINTS, POSITION, STALLED, TIME, csv, kinds, positions

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError

LONG = ["time_secs", "joint", "position", "velocity", "effort"]
VELOCITY = np.gradient(POSITION, TIME, axis=0)


def long_rows() -> list[list[str]]:
    """One joint a row, by time."""
    return [
        [f"{t!r}", joint, f"{q!r}", f"{v!r}", f"{0.1 * q!r}"]
        for t, qs, vs in zip(
            TIME.tolist(), POSITION.tolist(), VELOCITY.tolist(), strict=True
        )
        for joint, q, v in zip(JOINTS, qs, vs, strict=True)
    ]


def written(path: Path, header: list[str], rows: list[list[str]]) -> Path:
    path.write_text("\n".join(",".join(row) for row in [header, *rows]), "utf-8")
    return path


def check_long(motion: a5.trajectory.Motion) -> None:
    np.testing.assert_array_equal(motion.time, TIME)
    np.testing.assert_array_equal(motion.position, POSITION)
    np.testing.assert_array_equal(motion.velocity, VELOCITY)
    np.testing.assert_array_equal(motion.effort, [0.1 * q for q in POSITION])
    assert "joined" in kinds(motion)


def test_rows_about_one_joint_each(tmp_path: Path) -> None:
    check_long(
        a5.trajectory.read_motion(written(tmp_path / "m.csv", LONG, long_rows()))
    )
    # As pandas' melt writes them: all rows of a joint, then all of the next.
    rows = sorted(long_rows(), key=lambda row: row[1])
    check_long(a5.trajectory.read_motion(written(tmp_path / "m.csv", LONG, rows)))
    # The joints by their numbers on the bus, with a map.
    numbers = dict(zip(JOINTS, "5432", strict=True))
    for row in rows:
        row[1] = numbers[row[1]]
    path = written(tmp_path / "m.csv", LONG, rows)
    with pytest.raises(FileFormatError, match="--map"):
        a5.trajectory.read_motion(path)
    check_long(a5.trajectory.read_motion(path, joints=numbers))


def test_rows_about_joints_of_another_thing_are_left_out(tmp_path: Path) -> None:
    rows = long_rows()
    count = len(JOINTS)
    with_camera = []
    for start in range(0, len(rows), count):
        camera = [rows[start][0], "camera_tilt", "0.3", "0.0", "0.0"]
        with_camera += [*rows[start : start + count], camera]
    path = written(tmp_path / "m.csv", LONG, with_camera)
    motion = a5.trajectory.read_motion(path)
    check_long(motion)
    [found] = [w for w in motion.warnings if "camera_tilt" in w.text]
    assert found.count == len(rows) // count
    assert f"line {count + 2}" in found.first


def test_rows_about_one_joint_with_a_time_of_another_name(tmp_path: Path) -> None:
    header = ["tick", "axis", "angle_deg", "temperature", "state"]
    rows = [
        [f"{1e3 * float(t)!r}", joint, f"{math.degrees(float(q))!r}", "20", "on"]
        for t, joint, q, *_ in long_rows()
    ]
    path = written(tmp_path / "m.csv", header, rows)
    motion = a5.trajectory.read_motion(path, time="tick:ms")
    np.testing.assert_allclose(motion.time, TIME, atol=1e-12)
    np.testing.assert_allclose(motion.position, POSITION, rtol=1e-14)
    assert {"temperature", "state"} <= {*motion.ignored}


def test_a_name_beside_columns_of_joints_is_no_joint(tmp_path: Path) -> None:
    rows = [
        [f"{t!r}", "abcde"[k % 5], *map(repr, q)]
        for k, (t, q) in enumerate(zip(TIME.tolist(), POSITION.tolist(), strict=True))
    ]
    path = written(tmp_path / "m.csv", ["time", "name", *JOINTS], rows)
    np.testing.assert_array_equal(a5.trajectory.read_motion(path).position, POSITION)


def test_whole_nanoseconds_are_the_same_in_csv_and_parquet(tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(positions())
    frame.insert(0, "time_ns", 1_760_000_000_123_456_789 + 50_000_000 * np.arange(80))
    frame.to_csv(tmp_path / "m.csv", index=False)
    frame.to_parquet(tmp_path / "m.parquet")
    one = a5.trajectory.read_motion(tmp_path / "m.csv")
    other = a5.trajectory.read_motion(tmp_path / "m.parquet")
    np.testing.assert_array_equal(one.time, other.time)
    np.testing.assert_array_equal(one.position, other.position)


def test_rows_about_one_joint_in_parquet(tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    columns = dict(zip(LONG, zip(*long_rows(), strict=True), strict=True))
    table = {
        name: list(values) if name == "joint" else [float(x) for x in values]
        for name, values in columns.items()
    }
    parquet.write_table(pyarrow.table(table), tmp_path / "m.parquet")
    check_long(a5.trajectory.read_motion(tmp_path / "m.parquet"))


def test_rows_about_one_joint_whose_clock_was_set_back(tmp_path: Path) -> None:
    rows = long_rows()
    for row in rows[100:]:
        row[0] = repr(float(row[0]) - 1.0)
    path = written(tmp_path / "m.csv", LONG, rows)
    with pytest.raises(FileFormatError, match=r"line 102, .*run back"):
        a5.trajectory.read_motion(path)


def test_waypoints_of_a_planner_are_refused_with_what_is_missing(
    tmp_path: Path,
) -> None:
    columns = {f"q_ref_{joint}": POSITION[:2, k] for k, joint in enumerate(JOINTS)}
    path = csv(tmp_path / "m.csv", {"time_sec": TIME[:2], **columns})
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    for words in ("q_ref_axis_e is a command", "prefix ref_", "2 rows are no motion"):
        assert words in str(caught.value)
    with pytest.raises(InputError, match="at least 5 samples"):
        a5.trajectory.read_motion(path, prefix="ref_")


def named(pattern: str, values: np.ndarray) -> dict[str, np.ndarray]:
    return {pattern.replace("*", joint): values[:, k] for k, joint in enumerate(JOINTS)}


@pytest.mark.parametrize(
    ("pattern", "per_radian"),
    [
        *((x, 180 / math.pi) for x in ("*_pos [deg]", "*_deg", "q_* (Degrees)")),
        ("*_pos [°]", 180 / math.pi),
        *((x, 1.0) for x in ("*_pos [rad]", "*_rad", "* (radians)", "*")),
    ],
)
def test_units_of_positions(pattern: str, per_radian: float, tmp_path: Path) -> None:
    path = csv(
        tmp_path / "m.csv", {"time": TIME, **named(pattern, POSITION * per_radian)}
    )
    motion = a5.trajectory.read_motion(path)
    np.testing.assert_allclose(motion.position, POSITION, rtol=1e-14)
    assert motion.warnings == ()


def test_each_quantity_has_its_own_units(tmp_path: Path) -> None:
    degrees = 180 / math.pi
    rod = 0.005 + 0.0001 * TIME
    table = {"time [ms]": TIME * 1e3, **named("*_pos [rad]", POSITION)}
    table |= {"axis_a_pos [mm]": rod * 1e3, "axis_a_vel [mm/s]": rod * 1e3}
    table |= named("*_vel_deg/s", VELOCITY * degrees)
    table |= named("*_effort [Nm]", POSITION)
    motion = a5.trajectory.read_motion(csv(tmp_path / "m.csv", table))
    np.testing.assert_allclose(motion.time, TIME, rtol=1e-14)
    np.testing.assert_allclose(motion.position[:, 4], rod, rtol=1e-14)
    np.testing.assert_allclose(motion.velocity[:, 4], rod, rtol=1e-14)
    np.testing.assert_allclose(motion.velocity[:, :4], VELOCITY, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(motion.effort[:, :4], POSITION)


@pytest.mark.parametrize("unit", [" [mm]", " [Nm]", " [deg/s]", " [mA]", " [x]"])
def test_a_unit_of_another_quantity_is_refused(unit: str, tmp_path: Path) -> None:
    path = csv(tmp_path / "m.csv", {"time": TIME, **named(f"*_pos{unit}", POSITION)})
    with pytest.raises(FileFormatError, match="the position of axis_e"):
        a5.trajectory.read_motion(path)


@pytest.mark.parametrize("joint", [None, 2])
def test_degrees_read_as_radians_are_refused(joint: int | None, tmp_path: Path) -> None:
    angles = POSITION.copy()
    angles[:, slice(None) if joint is None else joint] *= 180 / math.pi
    path = csv(tmp_path / "m.csv", {"time": TIME, **positions(angles)})
    with pytest.raises(FileFormatError, match="--degrees"):
        a5.trajectory.read_motion(path)
    with pytest.raises(InputError, match="in degrees"):
        a5.trajectory.motion(TIME, angles)
    if joint is None:
        motion = a5.trajectory.read_motion(path, degrees=True)
        np.testing.assert_allclose(motion.position, POSITION, rtol=1e-14)


#: What is done to the text of a file, and the place that the refusal names.
BAD = {
    "text": (lambda rows: rows[4].__setitem__(2, "high"), "line 6, column 3"),
    "empty": (lambda rows: rows[0].__setitem__(1, ""), "line 2, column 2"),
    "NaN": (lambda rows: rows[7].__setitem__(4, "nan"), "line 9, column 5"),
    "infinity": (lambda rows: rows[7].__setitem__(4, "-inf"), "line 9, column 5"),
    "underscore": (lambda rows: rows[7].__setitem__(4, "1_0"), "line 9, column 5"),
    "no time": (lambda rows: rows[3].__setitem__(0, "nan"), "line 5, column 1"),
    "short": (lambda rows: rows[5].pop(), "line 7: 4 fields, expected 5"),
    "long": (lambda rows: rows[5].append("1"), "line 7: 6 fields, expected 5"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_row_is_refused_with_its_place(name: str, tmp_path: Path) -> None:
    change, place = BAD[name]
    rows = [
        [repr(x) for x in row] for row in np.column_stack([TIME, POSITION]).tolist()
    ]
    header = ["time", *JOINTS]
    change(rows)
    one = a5.trajectory.read_motion(written(tmp_path / "m.csv", header, rows))
    assert kinds(one) == ["bad_row"]
    assert place.partition(":")[0] in one.warnings[0].first
    rows[-1] = ["?"] * 5  # of 80 rows, a single one may be bad
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(written(tmp_path / "m.csv", header, rows))
    assert place in str(caught.value)
    assert "\n" not in str(caught.value)


HEADERS = {
    "time,axis_b,axis_e,x,axis_d": "axis_c_pos",
    "tt,axis_b,axis_e,axis_c,axis_d": "no column for the time",
    "time,time_secs,axis_e,axis_c,axis_d": "two columns for the time",
    "time,axis_b,axis_e,axis_c,axis_b": "'axis_b' stands twice",
    "time,axis_e,axis_e_pos,axis_c,axis_b": "two columns for the position of axis_e",
    "time,axis_e,axis_d,axis_c,axis_b_vel": "axis_b_vel is a velocity",
    "time|axis_e|axis_d|axis_c|axis_b": "no column for the time",
    "time,tau_axis_e,tau_axis_d,tau_axis_c,tau_axis_b": "tau_axis_e is a torque",
}


@pytest.mark.parametrize("header", HEADERS)
def test_names_that_are_refused(header: str, tmp_path: Path) -> None:
    path = tmp_path / "m.csv"
    path.write_text(header + "\n" + "1,1,1,1,1\n" * 9)
    with pytest.raises(FileFormatError) as caught:
        a5.trajectory.read_motion(path)
    assert HEADERS[header] in str(caught.value)
    assert "line 1" in str(caught.value)


def test_other_formats_are_refused_in_one_line(tmp_path: Path) -> None:
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as opened:
        opened.writestr("m.csv", "time")
    array = io.BytesIO()
    np.save(array, POSITION)
    contents = {
        "ZIP": archive.getvalue(),
        "NumPy": array.getvalue(),
        "JSON": b'{"time": [0.0, 0.1]}',
        "XML": b"<table><row/></table>",
        "Parquet": b"PAR1" + bytes(range(256)),
    }
    for suffix in (".csv", ".parquet", ".mcap", ".bag", ".db3"):
        for name, content in contents.items():
            path = tmp_path / f"m{suffix}"
            path.write_bytes(content)
            with pytest.raises(Alpha5Error) as caught:
                a5.trajectory.read_motion(path)
            assert "\n" not in str(caught.value), name
            assert len(str(caught.value)) < 600, name


@pytest.mark.parametrize("named_numbers", [True, False])
def test_a_data_set_with_several_episodes(named_numbers: bool, tmp_path: Path) -> None:
    import json

    import pyarrow
    from pyarrow import parquet

    kind = pyarrow.list_(pyarrow.float64(), 4)
    table = {
        "observation.state": pyarrow.array([*POSITION.tolist()] * 2, kind),
        "action": pyarrow.array([*POSITION.tolist()] * 2, kind),
        "timestamp": [*TIME, *TIME],
        "episode_index": [0] * TIME.size + [7] * TIME.size,
    }
    path = tmp_path / "data" / "chunk-000" / "file-000.parquet"
    path.parent.mkdir(parents=True)
    parquet.write_table(pyarrow.table(table), path)
    names = {f"axis_{x}": f"observation.state[{k}]" for k, x in enumerate("edcb")}
    if named_numbers:
        info = {"features": {"observation.state": {"names": [*names]}}}
        (tmp_path / "meta").mkdir()
        (tmp_path / "meta" / "info.json").write_text(json.dumps(info))
        names = {}
    with pytest.raises(FileFormatError, match=r"2 episodes \(0, 7\).*--episode"):
        a5.trajectory.read_motion(path, joints=names)
    motion = a5.trajectory.read_motion(path, episode=7, joints=names)
    np.testing.assert_array_equal(motion.position, POSITION)
    for wrong in (1, -1):
        with pytest.raises(InputError) as refusal:
            a5.trajectory.read_motion(path, episode=wrong, joints=names)
        assert refusal.value.name == "episode"


def test_sizes_that_would_overflow_are_refused(tmp_path: Path) -> None:
    for name in ("position", "velocity", "effort"):
        arrays = {"position": POSITION.copy(), name: POSITION.copy()}
        arrays[name][6, 2] = -1.01e9
        with pytest.raises(InputError) as refusal:
            a5.trajectory.motion(TIME, **arrays)
        assert refusal.value.name == "axis_c[6]"
    time = TIME.copy()
    time[-1] = 1e300
    with pytest.raises(InputError) as refusal:
        a5.trajectory.motion(time, POSITION)
    assert refusal.value.name == f"time[{TIME.size - 1}]"
    path = csv(tmp_path / "m.csv", {"time": time, **positions()})
    with pytest.raises(FileFormatError):
        a5.trajectory.read_motion(path)


@pytest.mark.parametrize("milli", [False, True])
def test_currents_beyond_a_stalled_motor_are_milliamperes(
    milli: bool, tmp_path: Path
) -> None:
    current = np.full_like(POSITION, 0.05)
    current[4:7, 2] = STALLED / 1e3 * (1.001 if milli else 0.999)
    table = {"time": TIME, **positions(), **named("*_current", current)}
    motion = a5.trajectory.read_motion(csv(tmp_path / "m.csv", table))
    np.testing.assert_allclose(motion.current, current * (1e-3 if milli else 1.0))
    assert kinds(motion) == ["current_unit"] * milli
    if milli:
        with pytest.raises(InputError, match="milliamperes"):
            a5.trajectory.motion(TIME, POSITION, current=current)


def test_publishers_in_a_bag_that_state_other_joints_are_no_fault(
    tmp_path: Path,
) -> None:
    rows = []
    for k, (t, q) in enumerate(zip(TIME, POSITION, strict=True)):
        stamp = 10**18 + round(t * 1e9)
        rows.append(State(stamp, JOINTS, q.tolist()))
        rows.append(State(stamp, ["thruster"], [k], publisher="/thrusters"))
    motion = a5.trajectory.read_motion(write_bag(tmp_path, ".bag", rows))
    np.testing.assert_array_equal(motion.position, POSITION)
    assert kinds(motion) == ["missing_joints"]
    assert motion.ignored == ("thruster",)


def test_a_record_is_shown_in_ten_lines() -> None:
    arm = a5.load().with_payload(0.5)
    motion = a5.trajectory.motion(TIME, POSITION)
    analysis = a5.trajectory.analyse(motion, arm)
    planned = a5.plan(a5.named_pose("home"), a5.named_pose("reach"))
    one = a5.inverse_kinematics([0.15, 0.2, 0.1])
    many = a5.inverse_kinematics(np.tile([0.15, 0.2, 0.1], (500, 1)))
    for shown in (motion, analysis, analysis.smooth, arm, planned, one, many):
        assert repr(shown).count("\n") < 10
        assert len(repr(shown)) < 1500


def test_texts_in_parquet_are_refused_by_name(tmp_path: Path) -> None:
    arrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    texts = arrow.table({"time_secs": ["0.0"], "axis_e_pos": ["3.1"]})
    parquet.write_table(texts, tmp_path / "m.parquet")
    with pytest.raises(FileFormatError, match="time_secs, axis_e_pos"):
        a5.trajectory.read_motion(tmp_path / "m.parquet")
