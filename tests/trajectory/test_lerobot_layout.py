"""Recordings in LeRobot's layout: lists of numbers, with names in the metadata.

The files are written by pyarrow as LeRobot's library writes them.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError

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
    import pyarrow

    kind = pyarrow.list_(pyarrow.float32(), len(values[0]) if fixed else -1)
    return pyarrow.array([[*map(float, row)] for row in values], kind)


def columns(fixed: bool = True) -> dict[str, Any]:
    import pyarrow

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
    import pyarrow
    from pyarrow import parquet

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


@pytest.mark.parametrize("fixed", [True, False], ids=["fixed", "open"])
def test_names_are_those_of_the_data_set(fixed: bool, tmp_path: Path) -> None:
    path = data_set(tmp_path, columns(fixed), [f"{name}.pos" for name in NAMES])
    motion = a5.trajectory.read_motion(path)
    check(motion)
    assert [warning.kind for warning in motion.warnings] == ["command"]


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


def several_episodes() -> dict[str, Any]:
    import pyarrow

    return columns() | {"episode_index": pyarrow.array([0] * 20 + [1] * 10)}


def one_short_list() -> dict[str, Any]:
    import pyarrow

    rows = [[*map(float, row)] for row in STATE]
    rows[7] = rows[7][:4]
    state = pyarrow.array(rows, pyarrow.list_(pyarrow.float32()))
    return columns() | {"observation.state": state}


def no_number() -> dict[str, Any]:
    import pyarrow

    rows: list[list[float | None]] = [[*map(float, row)] for row in STATE]
    rows[7][2] = None
    rows[9][1] = None
    rows[12][3] = None
    state = pyarrow.array(rows, pyarrow.list_(pyarrow.float32(), 5))
    return columns() | {"observation.state": state}


def test_what_is_refused_is_named(tmp_path: Path) -> None:
    for table, words in (
        (several_episodes(), r"2 episodes \(0, 1\): choose one by --episode"),
        (one_short_list(), "a list of 4 numbers, expected 5"),
        (no_number(), "axis_c"),
    ):
        with pytest.raises(FileFormatError, match=words):
            a5.trajectory.read_motion(data_set(tmp_path, table, NAMES))


def test_a_damaged_info_names_nothing(tmp_path: Path) -> None:
    path = data_set(tmp_path, columns(), NAMES)
    for info in ("", "{", "[" * 100_000, '{"features": {"x": 0}}', "\xff"):
        (tmp_path / "meta" / "info.json").write_text(info, "latin-1")
        with pytest.raises(FileFormatError, match=r"got observation\.state\[0\]"):
            a5.trajectory.read_motion(path)


def test_an_episode_of_several(tmp_path: Path) -> None:
    path = data_set(tmp_path, several_episodes(), NAMES)
    first = a5.trajectory.read_motion(path, episode=0)
    second = a5.trajectory.read_motion(path, episode=1)
    np.testing.assert_array_equal(
        np.concatenate([first.position, second.position]), STATE[:, ::-1]
    )
    with pytest.raises(InputError) as refusal:
        a5.trajectory.read_motion(path, episode=2)
    assert refusal.value.name == "episode"
