"""Recordings in LeRobot's layout: lists of numbers, with names in the metadata.

The files are written by pyarrow as LeRobot's library writes them.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

import alpha5_model as a5
from alpha5_model.cli.program import main
from alpha5_model.errors import FileFormatError

#: As a driver of this arm names them, from the jaws to the base.
NAMES = [f"axis_{letter}" for letter in "abcde"]
COUNT = 30
TIME = np.arange(COUNT) / 32
#: (30, 5) [m], [rad]; each number is exact as float32.
STATE = np.column_stack(
    [
        np.full(COUNT, 0.0078125),
        *(1 + 0.25 * k + 0.015625 * np.arange(COUNT) for k in range(4)),
    ]
)


def lists(values: Any, fixed: bool = True) -> Any:
    kind = pyarrow.list_(pyarrow.float32(), len(values[0]) if fixed else -1)
    return pyarrow.array([[*map(float, row)] for row in values], kind)


def columns(fixed: bool = True) -> dict[str, Any]:
    return {
        "observation.state": lists(STATE, fixed),
        "action": lists(STATE + 0.125, fixed),
        "timestamp": pyarrow.array(TIME, pyarrow.float32()),
        "frame_index": pyarrow.array(range(COUNT)),
        "episode_index": pyarrow.array([0] * COUNT),
    }


def features(names: Any) -> dict[str, Any]:
    state = {"dtype": "float32", "shape": [5], "names": names}
    return {"observation.state": state, "action": state, "timestamp": {"names": None}}


def data_set(
    folder: Path, table: dict[str, Any], names: Any, chunk: str = "data/chunk-000"
) -> Path:
    """A data set with one file, and the file."""
    path = folder / chunk / "episode_000000.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    parquet.write_table(pyarrow.table(table), path)
    if names is not None:
        info = folder / "meta" / "info.json"
        info.parent.mkdir(exist_ok=True)
        info.write_text(json.dumps({"fps": 32, "features": features(names)}), "utf-8")
    return path


def check(motion: a5.trajectory.Motion) -> None:
    np.testing.assert_array_equal(motion.time, TIME)
    assert motion.joints == tuple(reversed(NAMES))
    np.testing.assert_array_equal(motion.position, STATE[:, ::-1])


STATED = {
    "list": NAMES,
    "object of older versions": {"motors": NAMES},
    "with the quantity": [f"{name}.pos" for name in NAMES],
    "with the robot": [f"follower_{name}.pos" for name in NAMES],
}


@pytest.mark.parametrize("fixed", [True, False], ids=["fixed", "open"])
@pytest.mark.parametrize("names", STATED.values(), ids=STATED)
def test_names_are_those_of_the_data_set(
    names: Any, fixed: bool, tmp_path: Path
) -> None:
    motion = a5.trajectory.read_motion(data_set(tmp_path, columns(fixed), names))
    check(motion)
    assert [warning.kind for warning in motion.warnings] == ["command"]


@pytest.mark.parametrize("key", ["huggingface", "lerobot"])
@pytest.mark.parametrize("inner", [True, False])
def test_names_may_be_in_the_metadata_of_the_file(
    key: str, inner: bool, tmp_path: Path
) -> None:
    record: Any = {"features": features(NAMES)}
    if inner:
        record = {"info": record}
    metadata = {"pandas": "{}", key: json.dumps(record)}
    table = pyarrow.table(columns()).replace_schema_metadata(metadata)
    parquet.write_table(table, tmp_path / "m.parquet")
    check(a5.trajectory.read_motion(tmp_path / "m.parquet"))


def test_other_names_are_mapped(tmp_path: Path) -> None:
    others = ["gripper.pos", *(f"joint_{k}.pos" for k in (4, 3, 2, 1))]
    joints = {f"axis_{x}": f"joint_{k}" for k, x in enumerate("edcb", start=1)}
    joints["axis_a"] = "gripper"
    path = data_set(tmp_path, columns(), others)
    check(a5.trajectory.read_motion(path, joints=joints))


def test_without_names_the_places_are_mapped(tmp_path: Path) -> None:
    path = data_set(tmp_path, columns(), None)
    with pytest.raises(FileFormatError, match=r"got observation\.state\[0\], "):
        a5.trajectory.read_motion(path)
    joints = {name: f"observation.state[{k}]" for k, name in enumerate(NAMES)}
    check(a5.trajectory.read_motion(path, joints=joints))


def test_velocities_and_efforts_have_columns_of_their_own(tmp_path: Path) -> None:
    table = columns()
    table["observation.velocity"] = lists(STATE / 2)
    table["observation.effort"] = lists(STATE / 4)
    path = data_set(tmp_path, table, None)
    info = {"features": {key: {"names": NAMES} for key in table}}
    (tmp_path / "meta").mkdir()
    (tmp_path / "meta" / "info.json").write_text(json.dumps(info), "utf-8")
    motion = a5.trajectory.read_motion(path)
    check(motion)
    np.testing.assert_array_equal(motion.velocity, STATE[:, ::-1] / 2)
    np.testing.assert_array_equal(motion.effort, STATE[:, ::-1] / 4)


def test_degrees_are_refused_unless_they_are_said(tmp_path: Path) -> None:
    turned = STATE.copy()
    turned[:, 1:] = np.degrees(STATE[:, 1:])
    table = columns() | {"observation.state": lists(turned)}
    path = data_set(tmp_path, table, NAMES)
    with pytest.raises(FileFormatError, match="--degrees"):
        a5.trajectory.read_motion(path)
    motion = a5.trajectory.read_motion(path, degrees=True)
    np.testing.assert_allclose(motion.position, STATE[:, ::-1], rtol=1e-6)


def several_episodes() -> dict[str, Any]:
    return columns() | {"episode_index": pyarrow.array([0] * 20 + [1] * 10)}


def one_short_list() -> dict[str, Any]:
    rows = [[*map(float, row)] for row in STATE]
    rows[7] = rows[7][:4]
    state = pyarrow.array(rows, pyarrow.list_(pyarrow.float32()))
    return columns() | {"observation.state": state}


def no_number() -> dict[str, Any]:
    rows: list[list[float | None]] = [[*map(float, row)] for row in STATE]
    rows[7][2] = None
    rows[9][1] = None
    rows[12][3] = None
    state = pyarrow.array(rows, pyarrow.list_(pyarrow.float32(), 5))
    return columns() | {"observation.state": state}


REFUSED = {
    "several episodes": (
        several_episodes(),
        NAMES,
        r"2 episodes \(episode_index 0, 1, \.\.\.\)",
    ),
    "a short list": (one_short_list(), NAMES, "a list of 4 numbers, expected 5"),
    "no number": (no_number(), NAMES, r"row 8 \(axis_c\): expected a finite number"),
    "names of another robot": (columns(), ["a", "b", "c", "d", "e"], "got a, b, c"),
    "too few names": (columns(), NAMES[:4], r"got observation\.state\[0\]"),
    "names that are no texts": (columns(), [1, 2, 3, 4, 5], "no column for the pos"),
    "an open list without names": (columns(fixed=False), None, "no column for the pos"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_is_one_clear_line(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table, names, words = REFUSED[name]
    path = data_set(tmp_path, table, names)
    with pytest.raises(FileFormatError, match=words):
        a5.trajectory.read_motion(path)
    assert main(["trajectory", str(path)]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)


@pytest.mark.parametrize(
    "info",
    ["", "[]", "{", "[" * 100_000, '{"features": 3}', '{"features": {"x": 0}}', "\xff"],
)
def test_a_damaged_info_names_nothing(info: str, tmp_path: Path) -> None:
    path = data_set(tmp_path, columns(), NAMES)
    (tmp_path / "meta" / "info.json").write_text(info, "latin-1")
    with pytest.raises(FileFormatError, match=r"got observation\.state\[0\]"):
        a5.trajectory.read_motion(path)


def test_the_info_of_another_folder_does_not_count(tmp_path: Path) -> None:
    path = data_set(tmp_path, columns(), NAMES, chunk="a/b/c")
    with pytest.raises(FileFormatError, match=r"got observation\.state\[0\]"):
        a5.trajectory.read_motion(path)


def test_long_lists_are_no_columns(tmp_path: Path) -> None:
    path = tmp_path / "m.parquet"
    image = lists(np.zeros((COUNT, 300)))
    parquet.write_table(pyarrow.table(columns() | {"image": image}), path)
    joints = {name: f"observation.state[{k}]" for k, name in enumerate(NAMES)}
    motion = a5.trajectory.read_motion(path, joints=joints)
    check(motion)
    assert "image" in motion.ignored
