"""ROS bags and Parquet agree with CSV; untidy recordings and efforts are understood."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bag_writer import KINDS, State, write_bag

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingDependencyError,
    MissingFileError,
    UnknownNameError,
)

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
START = 1_690_000_000_123_456_789


def samples(count: int = 40) -> list[State]:
    """A moving arm with noise in every digit, steps uneven by nanoseconds."""
    rng = np.random.default_rng(4)
    stamps = START + np.cumsum(rng.integers(19_000_000, 21_000_000, count))
    phase = np.linspace(0, 2, count)[:, None]
    middle = (3.0, 1.5, 1.4, 1.2, 0.007)
    swing = np.array((0.3, 0.2, 0.2, 0.4, 0.001))
    q = middle + swing * np.sin(phase) + 1e-6 * rng.normal(size=(count, 5))
    v = 2.5 * swing * np.cos(phase) + 1e-6 * rng.normal(size=(count, 5))
    effort = rng.normal(size=(count, 5))
    order = [2, 0, 4, 3, 1]
    names = [JOINTS[k] for k in order]
    return [
        State(int(t), names, *(x[k, order].tolist() for x in (q, v, effort)))
        for k, t in enumerate(stamps)
    ]


def write_csv(
    path: Path, states: Sequence[State], time: Callable[[State], int]
) -> Path:
    """The same numbers as text; times with all nine decimals."""
    names = states[0].names
    header = [
        "time_secs",
        *(f"{n}_{kind}" for kind in ("pos", "vel", "effort") for n in names),
    ]
    lines = [",".join(header)]
    for s in states:
        seconds, rest = divmod(time(s), 10**9)
        values = [repr(float(x)) for x in (*s.position, *s.velocity, *s.effort)]
        lines.append(",".join([f"{seconds}.{rest:09d}", *values]))
    path.write_text("\n".join(lines) + "\n", "utf-8")
    return path


def write_parquet(path: Path, states: Sequence[State]) -> Path:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    columns = {
        "time": pyarrow.array([s.stamp for s in states], pyarrow.timestamp("ns"))
    }
    for kind in ("pos", "vel", "effort"):
        field = {"pos": "position", "vel": "velocity"}.get(kind, kind)
        for k, name in enumerate(states[0].names):
            columns[f"{name}_{kind}"] = [getattr(s, field)[k] for s in states]
    parquet.write_table(pyarrow.table(columns), path)
    return path


def analysis_of(path: Path, **options: str) -> tuple[dict, dict]:
    r = a5.trajectory.analyse(a5.trajectory.read_motion(path, **options))
    record = {**a5.trajectory.summary(r), "source": ""}
    return record, {k: v.tolist() for k, v in a5.trajectory.columns(r).items()}


@pytest.mark.parametrize("kind", [*KINDS, ".parquet"])
def test_every_kind_gives_the_analysis_of_the_csv_to_the_last_digit(
    kind: str, tmp_path: Path
) -> None:
    states = samples()
    csv = write_csv(tmp_path / "m.csv", states, lambda s: s.stamp)
    other = tmp_path / "m.parquet"
    path = (
        write_parquet(other, states)
        if kind == ".parquet"
        else write_bag(tmp_path, kind, states)
    )
    expected = analysis_of(csv)
    got = analysis_of(path)
    assert got == expected
    assert expected[0]["joints"]["axis_a"]["effort"]["samples"] == len(states)
    # One bit of one number, and it is another analysis.
    states[20].effort[1] = float(np.nextafter(states[20].effort[1], 9))
    assert (
        analysis_of(write_csv(tmp_path / "n.csv", states, lambda s: s.stamp))
        != expected
    )


# --- which topic, which joints --------------------------------------------------------


def renamed(states: Sequence[State], topic: str, prefix: str = "") -> list[State]:
    return [
        replace(s, topic=topic, names=[prefix + n for n in s.names]) for s in states
    ]


def test_the_only_topic_that_names_the_joints_is_found(tmp_path: Path) -> None:
    states = samples()
    vehicle = [
        State(s.stamp, ["thruster_1"], [0.0], topic="/vehicle/joint_states")
        for s in states
    ]
    path = write_bag(
        tmp_path, ".mcap", [*vehicle, *renamed(states, "/arm/joint_states", "left_")]
    )
    motion = a5.trajectory.read_motion(path)
    assert motion.joints == JOINTS
    assert motion.position[3, 0] == states[3].position[1]
    with pytest.raises(
        FileFormatError, match=r"no message has all of axis_e, .*thruster_1"
    ):
        a5.trajectory.read_motion(path, topic="/vehicle/joint_states")
    with pytest.raises(
        UnknownNameError, match="/arm/joint_states, /vehicle/joint_states"
    ):
        a5.trajectory.read_motion(path, topic="/tf")
    with pytest.raises(FileFormatError, match=r"all of right_axis_e.*left_axis_e"):
        a5.trajectory.read_motion(path, prefix="right_")


def test_several_topics_or_prefixes_are_a_choice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    states = samples()
    moved = [replace(s, position=[x + 1e-4 for x in s.position]) for s in states]
    path = write_bag(tmp_path, ".db3", [*renamed(states, "/a"), *renamed(moved, "/b")])
    with pytest.raises(InputError, match="topic: expected one of /a, /b"):
        a5.trajectory.read_motion(path)
    assert (
        a5.trajectory.read_motion(path, topic="/b").position[0, 0]
        == moved[0].position[1]
    )
    assert main(["trajectory", str(path)]) == 2
    assert "topic: expected one of /a, /b" in capsys.readouterr().err
    assert main(["trajectory", str(path), "--topic", "/b", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["samples"] == len(states)
    both = []
    for s in states:
        left = [f"left_{name}" for name in s.names]
        right = [f"right_{name}" for name in s.names]
        both.append(replace(s, names=left + right))
    for s, m in zip(both, moved, strict=True):
        s.position, s.velocity, s.effort = (
            [*s.position, *m.position],
            [*s.velocity] * 2,
            [],
        )
    (tmp_path / "two").mkdir()
    path = write_bag(tmp_path / "two", ".bag", both)
    with pytest.raises(InputError, match="prefix: expected one of left_, right_"):
        a5.trajectory.read_motion(path)
    motion = a5.trajectory.read_motion(path, prefix="right_")
    assert motion.position[0, 0] == moved[0].position[1]
    assert motion.effort is None
    assert "left_axis_e" in motion.ignored
    assert main(["trajectory", str(path), "--prefix", "left_"]) == 0
    capsys.readouterr()
    path = write_csv(tmp_path / "m.csv", states, lambda s: s.stamp)
    assert main(["trajectory", str(path), "--topic", "/a"]) == 2
    assert "only a ROS bag has topics" in capsys.readouterr().err


def test_prefixes_in_a_csv(tmp_path: Path) -> None:
    states = samples()
    plain = write_csv(tmp_path / "m.csv", states, lambda s: s.stamp)
    text = plain.read_text()
    (tmp_path / "p.csv").write_text(text.replace("axis_", "alpha/axis_"))
    assert analysis_of(tmp_path / "p.csv") == analysis_of(plain)
    header, *rows = text.splitlines()
    twice = [header + header.removeprefix("time_secs").replace("axis", "cmd_axis")]
    twice += [row + "," + row.partition(",")[2] for row in rows]
    (tmp_path / "c.csv").write_text("\n".join(twice))
    # The joints' own names come first; with two prefixes somebody has to choose.
    motion = a5.trajectory.read_motion(tmp_path / "c.csv")
    assert len(motion.ignored) == 15
    (tmp_path / "d.csv").write_text("\n".join(twice).replace(",axis", ",left_axis"))
    motion = a5.trajectory.read_motion(tmp_path / "d.csv")
    assert motion.ignored[0] == "cmd_axis_c_pos"
    (tmp_path / "e.csv").write_text(
        (tmp_path / "d.csv").read_text().replace("cmd_", "right_")
    )
    with pytest.raises(InputError, match="prefix: expected one of left_, right_"):
        a5.trajectory.read_motion(tmp_path / "e.csv")
    for prefix, file in (("cmd_", "d.csv"), ("right_", "e.csv")):
        motion = a5.trajectory.read_motion(tmp_path / file, prefix=prefix)
        assert motion.ignored[0] == "left_axis_c_pos"
    with pytest.raises(
        FileFormatError, match="expected x_axis_e_pos or x_axis_e_position"
    ):
        a5.trajectory.read_motion(tmp_path / "d.csv", prefix="x_")


# --- untidy ---------------------------------------------------------------------------


def found(motion: a5.trajectory.Motion) -> dict[str, tuple[int, str]]:
    return {w.kind: (w.count, w.first.partition(" of ")[0]) for w in motion.warnings}


@pytest.mark.parametrize("kind", [".bag", ".mcap"])
def test_without_a_stamp_the_times_of_recording_count(
    kind: str, tmp_path: Path
) -> None:
    states = [replace(s, received=s.stamp + k % 3) for k, s in enumerate(samples())]
    for s in states[7:]:
        s.stamp = 0
    motion = a5.trajectory.read_motion(write_bag(tmp_path, kind, states))
    assert motion.time.tolist() == [
        float(f"{s.received // 10**9}.{s.received % 10**9:09d}") for s in states
    ]
    assert found(motion) == {"no_stamp": (33, "message 8")}


def test_messages_out_of_order_are_sorted_by_their_stamps(tmp_path: Path) -> None:
    states = samples()
    mixed = [replace(s, received=START + k) for k, s in enumerate(states)]
    mixed[10].stamp = states[11].stamp
    mixed[11].stamp = states[10].stamp
    mixed[10].position = states[11].position
    mixed[11].position = states[10].position
    motion = a5.trajectory.read_motion(write_bag(tmp_path, ".bag", mixed))
    assert motion.position[:, 0].tolist() == [s.position[1] for s in states]
    assert (np.diff(motion.time) > 0).all()
    assert found(motion) == {"out_of_order": (1, "message 12")}


def test_messages_of_other_joints_and_without_numbers_are_left_out(
    tmp_path: Path,
) -> None:
    states = samples()
    states[4] = replace(
        states[4], names=["thruster"], position=[1.0], velocity=[], effort=[]
    )
    states[5] = replace(states[5], position=states[5].position[:3])
    states[9] = replace(states[9], names=states[9].names[:4])
    states[20].position[3] = float("nan")
    states[21].position[0] = float("inf")
    motion = a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", states))
    kept = [s for k, s in enumerate(states) if k not in (4, 5, 9, 20, 21)]
    assert motion.position[:, 2].tolist() == [s.position[0] for s in kept]
    assert found(motion) == {"missing_joints": (5, "message 5")}
    nothing = [replace(s, position=[float("nan")] * 5) for s in samples()]
    for few, left in ((samples(4), 4), (nothing, 0)):
        (tmp_path / f"{left}").mkdir()
        path = write_bag(tmp_path / f"{left}", ".bag", few)
        with pytest.raises(
            InputError, match=f"at least 5 samples .*got {left}"
        ) as caught:
            a5.trajectory.read_motion(path)
        assert ("message left out" in str(caught.value)) == (left == 0)


@pytest.mark.parametrize("kind", [".bag", ".mcap"])
def test_a_gripper_without_a_sensor_leaves_the_arm_alone(
    kind: str, tmp_path: Path
) -> None:
    states = samples()
    for s in states:
        s.position[0] = s.position[s.names.index("axis_a")] = float("nan")
    with pytest.raises(InputError, match=r"no position of axis_c, axis_a.*: 40 x"):
        a5.trajectory.read_motion(write_bag(tmp_path, kind, states))
    for s, whole in zip(states, samples(), strict=True):
        s.position[0] = whole.position[0]
    (tmp_path / "rod").mkdir()
    motion = a5.trajectory.read_motion(write_bag(tmp_path / "rod", kind, states))
    assert (motion.joints, motion.warnings) == (JOINTS[:4], ())
    assert "axis_a" in motion.ignored
    place = states[0].names.index("axis_b")
    assert motion.position[:, 3].tolist() == [s.position[place] for s in states]
    assert motion.velocity is not None
    assert motion.velocity.shape == motion.effort.shape == (40, 4)


def test_a_gripper_of_its_own_leaves_the_arm_alone(tmp_path: Path) -> None:
    """If the jaw has messages of its own on the topic, the arm has four joints."""
    states = samples()
    messages = []
    for s in states:
        without_jaw = replace(
            s,
            names=s.names[:2] + s.names[3:],
            position=s.position[:2] + s.position[3:],
            velocity=[],
            effort=[],
        )
        jaw = State(s.stamp + 5, ["axis_a"], [s.position[2]], publisher="/gripper")
        messages += [without_jaw, jaw]
    path = write_bag(tmp_path, ".bag", messages)
    motion = a5.trajectory.read_motion(path)
    assert motion.joints == JOINTS[:4]
    assert motion.velocity is None
    assert found(motion) == {"missing_joints": (40, "message 2")}


def fresh(parent: Path, name: str) -> Path:
    folder = parent / name
    folder.mkdir()
    return folder


def test_each_joint_in_a_message_of_its_own_is_joined(tmp_path: Path) -> None:
    alone = []
    for s in samples():
        for name, position in zip(s.names, s.position, strict=True):
            alone.append(
                State(s.stamp, [name], [position], received=START + len(alone))
            )
    for kind in (".bag", ".mcap"):
        motion = a5.trajectory.read_motion(
            write_bag(fresh(tmp_path, kind), kind, alone)
        )
        assert set(found(motion)) == {"joined"}
        whole = a5.trajectory.read_motion(
            write_bag(fresh(tmp_path, f"whole{kind}"), kind, samples())
        )
        np.testing.assert_array_equal(motion.position, whole.position)
        np.testing.assert_array_equal(motion.time, whole.time)


@pytest.mark.parametrize("back", [30, 41, 200, 2300])
def test_a_clock_that_was_set_back_is_refused(back: int, tmp_path: Path) -> None:
    """Back by milliseconds, in steps of 19 to 21 ms."""
    states = samples(400)
    received = [s.stamp for s in states]
    for s, recorded in zip(states, received, strict=True):
        s.received = recorded
    for s in states[200:]:
        s.stamp -= back * 10**6
    with pytest.raises(FileFormatError, match=r"message 201 of .*time runs back"):
        a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", states))


def json_mcap(path: Path, messages: Sequence[bytes]) -> Path:
    from mcap.writer import CompressionType, Writer

    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channel = writer.register_channel("/joints", "json", schema)
        for k, message in enumerate(messages):
            writer.add_message(channel, START + k, message, START + k)
        writer.finish()
    return path


def test_json_messages_of_mcap(tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    messages = [
        json.dumps(
            {
                "header": {
                    "stamp": {"sec": s.stamp // 10**9, "nanosec": s.stamp % 10**9}
                },
                "name": s.names,
                "position": s.position,
                "velocity": s.velocity,
                "effort": s.effort,
            }
        ).encode()
        for s in samples()
    ]
    motion = a5.trajectory.read_motion(json_mcap(tmp_path / "j.mcap", messages))
    bag = a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", samples()))
    for name in ("time", "position", "velocity", "effort"):
        np.testing.assert_array_equal(getattr(motion, name), getattr(bag, name))


@pytest.mark.parametrize(
    "message",
    [
        b"[" * 100_000,
        b"[1]",
        b'{"name": 1}',
        b'{"name": ["axis_e"], "position": "a"}',
        b'{"name": ["axis_e"], "position": [[1], [1, 2]]}',
        b'{"name": ["axis_e"], "header": {"stamp": {"sec": []}}}',
        b"\xff",
    ],
)
def test_other_json_messages_are_refused(message: bytes, tmp_path: Path) -> None:
    pytest.importorskip("mcap")
    with pytest.raises(FileFormatError) as refusal:
        a5.trajectory.read_motion(json_mcap(tmp_path / "j.mcap", [message] * 9))
    assert "j.mcap" in str(refusal.value)


def test_publishers_of_the_same_joints_are_said(tmp_path: Path) -> None:
    states = samples()
    for s in states[1::2]:
        s.publisher = "/joint_state_publisher_gui"
    motion = a5.trajectory.read_motion(write_bag(tmp_path, ".bag", states))
    [warning] = motion.warnings
    assert (warning.kind, warning.count) == ("publishers", 1)
    assert warning.text == "publishers: /driver, /joint_state_publisher_gui"


def test_velocities_in_some_messages_only_are_not_used(tmp_path: Path) -> None:
    states = samples()
    states[11].velocity = []
    states[12].velocity = [float("nan")] * 5
    states[13].effort = []
    motion = a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", states))
    assert motion.velocity is None
    assert found(motion) == {"velocity": (2, "message 12")}
    assert motion.effort is not None
    assert np.isnan(motion.effort).all(axis=1).nonzero()[0].tolist() == [13]
    jump = samples()
    jump[30].position[1] += 1.0
    (tmp_path / "jump").mkdir()
    motion = a5.trajectory.read_motion(write_bag(tmp_path / "jump", ".mcap", jump))
    assert motion.warnings[0].first == "message 31 of /joint_states (axis_e)"


@pytest.mark.parametrize("kind", [".bag", ".db3", ".mcap"])
def test_a_bag_cut_off_is_one_line_with_what_to_do(kind: str, tmp_path: Path) -> None:
    path = write_bag(tmp_path, kind, samples())
    whole = path.read_bytes()
    for size in (0, 10, len(whole) // 3, len(whole) * 2 // 3):
        path.write_bytes(whole[:size])
        with pytest.raises(FileFormatError, match="mcap recover") as caught:
            a5.trajectory.read_motion(path)
        assert "\n" not in str(caught.value)


def test_no_bag_no_joint_states_and_no_reader(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(MissingFileError):
        a5.trajectory.read_motion(tmp_path / "absent.mcap")
    with pytest.raises(FileFormatError, match="no sensor_msgs/JointState, but nothing"):
        a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", []))
    for module, extra, name in (
        ("rosbags", "bags", "m.bag"),
        ("pyarrow", "parquet", "m.parquet"),
    ):
        monkeypatch.setitem(sys.modules, module, None)
        with pytest.raises(
            MissingDependencyError, match=rf"pip install 'alpha5-model\[{extra}\]'"
        ):
            a5.trajectory.read_motion(tmp_path / name)
        assert main(["trajectory", str(tmp_path / name)]) == 2
        assert capsys.readouterr().err.count("\n") == 1


# --- Parquet --------------------------------------------------------------------------


def test_what_a_parquet_file_may_hold(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    count = 8
    good = {"time_ms": pyarrow.array(range(0, 20 * count, 20), pyarrow.int64())}
    good |= {
        f"axis_{x}": pyarrow.array([1.0] * count, pyarrow.float32()) for x in "edcb"
    }

    def read(**changed: object) -> a5.trajectory.Motion:
        parquet.write_table(pyarrow.table({**good, **changed}), tmp_path / "m.parquet")
        return a5.trajectory.read_motion(tmp_path / "m.parquet")

    motion = read(note=["x"] * count)
    assert (motion.time_unit, motion.ignored) == ("ms", ("note",))
    np.testing.assert_allclose(motion.time, 0.02 * np.arange(count))
    for unit, per_second in (("s", 1), ("ms", 10**3), ("us", 10**6)):
        kind = pyarrow.duration(unit)
        whole = [k * per_second for k in range(count)]
        del good[next(iter(good))]
        good = {"time": pyarrow.array(whole, kind), **good}
        assert read().time.tolist() == list(range(count))
    for bad, words in (
        (
            {"axis_c": [1.0, None] * 4},
            r"row 2 \(axis_c\): expected a finite number",
        ),
        ({"axis_c": ["high"] * 8}, "no column for the position of axis_c"),
        ({"axis_c": [[1.0]] * 8}, "no column for the position of axis_c"),
        ({"axis_c_pos": [1.0] * 8}, "two columns for the position of axis_c"),
    ):
        with pytest.raises(FileFormatError, match=words) as caught:
            read(**bad)
        assert "\n" not in str(caught.value)
    with pytest.raises(MissingFileError):
        a5.trajectory.read_motion(tmp_path / "absent.pq")
    (tmp_path / "m.parquet").write_bytes(b"PAR1 no table")
    with pytest.raises(FileFormatError, match="table of numbers"):
        a5.trajectory.read_motion(tmp_path / "m.parquet")


# --- efforts --------------------------------------------------------------------------


@dataclass(frozen=True)
class EffortRecording:
    """A recording whose effort is made from the torque computed without it."""

    path: Path
    torque: np.ndarray  # (60, 5)
    analysis: a5.trajectory.Analysis


@pytest.fixture
def effort_recording(tmp_path: Path) -> EffortRecording:
    """Effort = 2 torque + 0.25, without axis_b, and axis_d in one sample only."""
    states = samples(60)
    bare = write_csv(tmp_path / "m.csv", states, lambda s: s.stamp)
    torque = a5.trajectory.analyse(a5.trajectory.read_motion(bare)).torque
    place = [JOINTS.index(name) for name in states[0].names]
    for k, s in enumerate(states):
        s.effort = (2 * torque[k, place] + 0.25).tolist()
        s.effort[place.index(1)] = float("nan") if k != 5 else 1.0
        s.effort[place.index(3)] = float("nan")
    path = write_csv(tmp_path / "e.csv", states, lambda s: s.stamp)
    analysis = a5.trajectory.analyse(a5.trajectory.read_motion(path))
    return EffortRecording(path=path, torque=torque, analysis=analysis)


def efforts_of_joints(analysis: a5.trajectory.Analysis) -> dict[str, Any]:
    joints = a5.trajectory.summary(analysis)["joints"]
    return {name: joint["effort"] for name, joint in joints.items()}


def test_recorded_effort_against_the_torque(effort_recording: EffortRecording) -> None:
    """A known gain and offset give figures that are known beforehand."""
    r = effort_recording.analysis
    torque = effort_recording.torque
    e = efforts_of_joints(r)["axis_c"]
    difference = torque[:, 2] + 0.25
    assert e["samples"] == 60
    assert e["difference_mean"] == pytest.approx(difference.mean())
    assert e["difference_rms"] == pytest.approx(np.sqrt((difference**2).mean()))
    assert e["difference_peak"]["value"] == pytest.approx(
        difference[np.abs(difference).argmax()]
    )
    effort = 2 * torque[:, 2] + 0.25
    assert e["rms"] == pytest.approx(np.sqrt((effort**2).mean()))
    assert e["correlation"] == pytest.approx(1.0)
    left = difference - r.friction[:, 2]
    assert e["difference_rms_with_friction"] == pytest.approx(np.sqrt((left**2).mean()))


def test_recorded_effort_with_holes(effort_recording: EffortRecording) -> None:
    """One sample has no correlation, and a joint without effort has no figures."""
    r = effort_recording.analysis
    efforts = efforts_of_joints(r)
    assert (efforts["axis_d"]["samples"], efforts["axis_d"]["correlation"]) == (1, None)
    assert efforts["axis_d"]["difference_peak"]["time_s"] == r.smooth.time[5]
    assert efforts["axis_b"] is None
    # Without the screw's lead the rod's friction is unknown.
    assert efforts["axis_a"]["difference_rms_with_friction"] is None
