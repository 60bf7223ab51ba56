"""Files that somebody hands in: robots, recordings, tables; damaged or hostile."""

from __future__ import annotations

import dataclasses
import io
import itertools
import json
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import oracle
import pytest
import yaml
from damage import damaged, garbled
from good_files import ARM, JOINTS, OBSTACLES, STUDY, table
from hypothesis import given
from hypothesis import strategies as st

import alpha5_model as a5
from alpha5_model._support.text import plain
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import Alpha5Error
from alpha5_model.planning import read_waypoints
from alpha5_model.planning.obstacle_file import read_obstacles
from alpha5_model.proofs.comparison.as_arm import arm_of_model, arm_text
from alpha5_model.studies.sweep.study import read_study

pytestmark = pytest.mark.slow


class WrongAnswerError(AssertionError):
    """An answer that is not what the good part of a file says."""


@cache
def robot(jaws: bool, on_vehicle: bool) -> str:
    return urdf(
        Variant(
            gripper="jaws" if jaws else "locked",
            prefix="left_" if on_vehicle else "",
            parent="rov" if on_vehicle else "",
            ros2_control=on_vehicle,
        )
    )


@cache
def parquet() -> bytes:
    import pyarrow
    from pyarrow import parquet

    columns = {"time_secs": np.arange(8) * 0.1}
    columns |= {f"{joint}_pos": np.linspace(0.5, 1.0, 8) for joint in JOINTS}
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(columns), sink)
    return bytes(sink.getvalue())


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


def read(path: Path, content: bytes, call: Callable[[Path], Any], **given: Any) -> Any:
    """What a function answers to a file with this content."""
    path.write_bytes(content)
    return oracle.answer(lambda: call(path), size=len(content), **given)


def compared(path: Path) -> Any:
    return a5.compare(path, samples=2).as_dict()


def chain(path: Path) -> Any:
    found = a5.dh.DHChain.from_urdf(path)
    return found.frames(found.home)


def robot_of(path: Path) -> Any:
    return parse_urdf(path.read_bytes(), str(path))


@oracle.fuzzed
@given(
    text=st.builds(robot, st.booleans(), st.booleans()).flatmap(
        lambda text: damaged(text, "xml")
    ),
    suffix=st.sampled_from((".urdf", ".urdf", ".xacro", ".xml")),
    call=st.sampled_from((robot_of, robot_of, chain, compared)),
)
def test_robots(folder: Path, text: bytes, suffix: str, call: Any) -> None:
    # A volume of no digits is NaN.
    read(folder / f"arm{suffix}", text, call, infinite=frozenset({"volume"}))


def analysed(path: Path) -> Any:
    analysis = a5.trajectory.analyse(a5.trajectory.read_motion(path))
    return a5.trajectory.summary(analysis)


@oracle.fuzzed
@given(
    text=st.deferred(lambda: damaged(table(), "table")),
    suffix=st.sampled_from((".csv", ".csv", ".txt", ".tsv", "", ".parquet", ".mcap")),
    call=st.sampled_from((a5.trajectory.read_motion, analysed)),
)
def test_tables_of_a_recording(
    folder: Path, text: bytes, suffix: str, call: Any
) -> None:
    read(folder / f"recording{suffix}", text, call)


@pytest.fixture(scope="module", params=[".parquet", ".mcap", ".db3", ".bag"])
def container(request: pytest.FixtureRequest, folder: Path) -> tuple[str, bytes]:
    """Ending and content of a small recording."""
    from bag_writer import State, write_bag

    kind = request.param
    if kind == ".parquet":
        return kind, parquet()
    states = [
        State(10**18 + k * 10**8, JOINTS, (1.0, 1.0 + 0.01 * k, 1.0, 0.5))
        for k in range(12)
    ]
    place = folder / kind[1:]
    place.mkdir()
    return kind, write_bag(place, kind, states).read_bytes()


@oracle.fuzzed
@given(data=st.data())
def test_containers(
    folder: Path, container: tuple[str, bytes], data: st.DataObject
) -> None:
    suffix, content = container
    changed = data.draw(garbled(content))
    read(folder / f"garbled{suffix}", changed, a5.trajectory.read_motion)


#: Ending -> the text of a file of waypoints.
WAYPOINTS: dict[str, Callable[[], str]] = {
    ".csv": table,
    ".txt": lambda: "x [mm];y;z;roll [deg];pitch;yaw\n200;0.1;0.1;0;1,5;0\n" * 2,
    ".json": lambda: json.dumps(GOAL),
    ".yaml": lambda: yaml.safe_dump(GOAL),
}
POINTS = [{"positions": [1.0, 1.2, 1.0, 0.5]}, {"positions": [1.5, 1.0, 1.0, 0.5]}]
GOAL = {"trajectory": {"joint_names": [*JOINTS], "points": POINTS}}


@oracle.fuzzed
@given(data=st.data())
def test_waypoints(folder: Path, data: st.DataObject) -> None:
    suffix = data.draw(st.sampled_from([*WAYPOINTS]))
    kind = "table" if suffix in (".csv", ".txt") else "toml"
    content = data.draw(damaged(WAYPOINTS[suffix](), kind))
    read(folder / f"waypoints{suffix}", content, read_waypoints)


def study(path: Path) -> Any:
    found = read_study(path)
    return found.cases, found.states


def obstacles(path: Path) -> Any:
    """The shapes, beside a mesh of one triangle."""
    triangle = np.zeros(12, "<f4")
    triangle[6], triangle[10] = 100.0, 100.0
    mesh = b"solid".ljust(80) + (1).to_bytes(4, "little") + triangle.tobytes() + b"\0\0"
    path.with_name("frame.stl").write_bytes(mesh)
    return len(read_obstacles(path))


def arm_template() -> str:
    return a5.arm_file_text(a5.parameters(), every_key=True)


def session_text() -> str:
    session = a5.calibrate.session(a5.calibrate.weight(), np.full((3, 4), 1.0))
    return a5.calibrate.session_text(session)


def written_again(path: Path) -> Any:
    """The arm of a file, which must say the same after it was written and read."""
    arm = a5.arm_file(path)
    check_written(a5.arm_file_text(arm), arm, path.with_name("again.toml"))
    return arm


def check_written(text: str, arm: Any, path: Path) -> None:
    path.write_text(text, encoding="utf-8")
    try:
        again = a5.arm_file(path)
    except Alpha5Error as error:
        raise WrongAnswerError(f"cannot be read: {error}") from None
    pairs = itertools.zip_longest(values(plain(arm)), values(plain(again)))
    for before, after in pairs:
        numbers = isinstance(before, float) and isinstance(after, float)
        # At a pitch of 90 degrees, roll and yaw are rounded to 2e-9.
        if before != after and not (
            numbers and np.isclose(before, after, rtol=1e-9, atol=2e-9)
        ):
            raise WrongAnswerError(f"{after!r} instead of {before!r}")


def values(record: Any) -> list[Any]:
    """All values of nested dictionaries and lists, one after the other."""
    if isinstance(record, dict):
        return [x for key in record for x in values(record[key])]
    if isinstance(record, list):
        return [x for part in record for x in values(part)]
    return [record]


#: Kind of file -> its text, and what reads it.
TOML: dict[str, tuple[Callable[[], str], Callable[[Path], Any]]] = {
    "study": (lambda: STUDY, study),
    "obstacles": (lambda: OBSTACLES, obstacles),
    "readings": (session_text, a5.calibrate.read_session),
    "arm": (lambda: ARM, written_again),
    "arm template": (arm_template, written_again),
}
#: What a reading is that nobody has taken yet.
MISSING = frozenset({"readings", "joints", "loads"})


@oracle.fuzzed
@given(data=st.data())
def test_toml(folder: Path, data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from([*TOML]))
    text, call = TOML[kind]
    content = data.draw(damaged(text(), "toml"))
    # The mesh that a file names is read, whatever its name.
    content = re.sub(rb"(?m)^mesh *=.*$", b'mesh = "frame.stl"', content)
    read(folder / f"{kind}.toml", content, call, infinite=MISSING)


def model_as_arm(path: Path) -> Any:
    """What ``compare --write-arm`` writes of a model, read again."""
    made = arm_of_model(path)
    check_written(arm_text(made, path.name), made.record, path.with_name("made.toml"))
    return made.record


@oracle.fuzzed
@given(data=st.data())
def test_models_as_arm_files(folder: Path, data: st.DataObject) -> None:
    text = robot(data.draw(st.booleans()), on_vehicle=False)
    body = data.draw(st.sampled_from(("", "a&#10;mass = 3", "&quot;x", "x]]", "é")))
    if body:
        text = text.replace('name="link_2"', f'name="{body}"')
        text = text.replace('link="link_2"', f'link="{body}"')
    read(folder / "model.urdf", data.draw(damaged(text, "xml")), model_as_arm)


def test_another_arm_is_seen(folder: Path) -> None:
    arm = a5.parameters()
    check_written(a5.arm_file_text(arm), arm, folder / "same.toml")
    other = dataclasses.replace(arm, name="other")
    with pytest.raises(WrongAnswerError):
        check_written(a5.arm_file_text(arm), other, folder / "other.toml")


# --- columns: only positions are read as positions ------------------------------------

#: Words for anything but a measured position; a column with one of them holds none.
OTHERS = (
    *("tau", "torque", "effort", "force", "current", "amps", "voltage", "power"),
    *("temperature", "vel", "velocity", "dq", "qdot", "speed", "omega", "rpm", "acc"),
    *("ddq", "jerk", "cmd", "command", "desired", "reference", "target", "goal"),
    *("setpoint", "error", "std", "var", "min", "max", "limit", "kp", "pwm", "counts"),
    *("raw", "status", "mode", "load", "mass", "stamp", "delay", "residual", "offset"),
)


@st.composite
def columns(draw: st.DrawFn) -> tuple[dict[str, np.ndarray], np.ndarray | None]:
    """Columns of a table, and the positions among them, if there are any."""
    rng = np.random.default_rng(draw(st.integers(0, 99)))
    positions = rng.uniform(0.5, 1.5, (8, 4))
    suffix = draw(st.sampled_from(("", "_pos", "_position")))
    found = {"time_secs": np.arange(8) * 0.05}
    is_there = draw(st.booleans())
    if is_there:
        found |= {f"{j}{suffix}": positions[:, k] for k, j in enumerate(JOINTS)}
    for word in draw(st.lists(st.sampled_from(OTHERS), min_size=1, max_size=3)):
        separator = draw(st.sampled_from(("_", ".", "/", " ")))
        robot = draw(st.sampled_from(("", "alpha_", "left_", "/joint_states/")))
        styled = draw(st.sampled_from((word, word.upper(), word.capitalize())))
        first = draw(st.booleans())
        for joint in JOINTS:
            name = f"{styled}{separator}{robot}{joint}"
            name = name if first else f"{robot}{joint}{separator}{styled}"
            # Out of any range, in degrees, too: whoever reads them is seen.
            found[name] = rng.uniform(5000, 6000, 8)
    names = draw(st.permutations(sorted(found)))
    return {name: found[name] for name in names}, positions if is_there else None


@oracle.fuzzed
@given(drawn=columns())
def test_columns(folder: Path, drawn: Any) -> None:
    found, positions = drawn
    text = io.StringIO()
    rows = np.transpose([*found.values()])
    np.savetxt(text, rows, "%.17g", ",", header=",".join(found), comments="")
    motion = read(
        folder / "columns.csv",
        text.getvalue().encode(),
        a5.trajectory.read_motion,
        hopeless=positions is None,
    )
    # Two columns for one effort are refused.
    if not isinstance(motion, Alpha5Error):
        assert np.array_equal(motion.position, positions)
