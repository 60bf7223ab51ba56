"""Files that lie beside others: data sets, results of sweeps, obstacles with meshes."""

from __future__ import annotations

import json
import re
import shutil
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fuzzing import hostile
from fuzzing.cases import Case, Target
from fuzzing.damage import damage
from fuzzing.values import Rng, pick
from fuzzing.watch import CANARY

import alpha5_model as a5
from alpha5_model.planning.obstacle_file import read_obstacles
from alpha5_model.planning.surroundings import Surroundings

JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


class WrongAnswerError(Exception):
    """An answer that is not what the good part of the files says."""


def _fresh(folder: Path, name: str) -> Path:
    """An empty folder of this name."""
    made = folder / name
    shutil.rmtree(made, ignore_errors=True)
    made.mkdir()
    return made


def _put(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


# --- LeRobot --------------------------------------------------------------------------

#: What may stand for the names of a feature.
NAMES: tuple[Any, ...] = (
    list(JOINTS),
    {"motors": list(JOINTS)},
    {"motors": list(JOINTS), "others": list(JOINTS)},
    list(JOINTS[:3]),
    [*JOINTS[:3], "axis_e"],
    ["axis_e"] * 4,
    [f"{name}.pos" for name in JOINTS],
    [f"{name}_torque" for name in JOINTS],
    list(reversed(JOINTS)),
    ["", "", "", ""],
    [1, 2, 3, 4],
    [None] * 4,
    [[name] for name in JOINTS],
    "axis_e",
    {},
    None,
    5,
    ["axis_e"] * 400,
    list(hostile.TRAPS[:4]),
)


def lerobot(rng: Rng, folder: Path) -> Case:
    """A data set whose columns of lists are named by ``meta/info.json``, or not."""
    root = _fresh(folder, "set")
    count = int(rng.integers(3, 16))
    width = 4 if rng.integers(5) else int(pick(rng, (1, 5, 300)))
    state = rng.uniform(0.5, 1.5, (count, width))
    names = pick(rng, NAMES) if rng.integers(3) == 0 else list(JOINTS)
    info = {"features": {"observation.state": {"shape": [width], "names": names}}}
    text = json.dumps(info)
    content = text.encode()
    if rng.integers(3) == 0:
        content = _bad_info(rng, text)

    within = rng.integers(4) == 0
    metadata = {pick(rng, (b"lerobot", b"huggingface")): content} if within else {}
    path = root / "data" / "chunk-000" / "episode.parquet"
    _put(path, _list_table(rng, state, metadata))
    place = pick(rng, ("meta/info.json",) * 4 + ("data/meta/info.json", "info.json"))
    _put(root / place, content)

    def call(path: Path) -> Any:
        motion = a5.trajectory.read_motion(path)
        _check_columns(motion.position, state)
        return motion

    return Case(call, {"path": path}, size=len(content))


def _bad_info(rng: Rng, text: str) -> bytes:
    """Metadata that is damaged, garbled or made to harm."""
    ways: tuple[Callable[[], bytes], ...] = (
        lambda: damage(rng, text),
        lambda: hostile.garbled(rng, text.encode()),
        lambda: hostile.repeated(rng).encode(),
        lambda: b"[" * 50_000,
        lambda: b'{"features": {"observation.state": 3}}',
        lambda: b'{"features": []}',
        lambda: text.replace('"features"', '"features": 1, "features"').encode(),
        lambda: text.encode("utf-16"),
        lambda: b"",
    )
    return pick(rng, ways)()


def _list_table(rng: Rng, state: np.ndarray, metadata: dict[bytes, bytes]) -> bytes:
    """A Parquet table with a column of lists, of fixed or of any length."""
    import pyarrow
    from pyarrow import parquet

    width = state.shape[1]
    numbers = pyarrow.array(state.ravel())
    if rng.integers(2):
        lists = pyarrow.FixedSizeListArray.from_arrays(numbers, width)
    else:
        offsets = np.arange(0, state.size + 1, width)
        if rng.integers(8) == 0:
            offsets[1] = offsets[0]
        lists = pyarrow.ListArray.from_arrays(pyarrow.array(offsets, "int32"), numbers)
    columns = {
        pick(rng, ("timestamp",) * 8 + ("time_secs", "frame_index")): (
            pyarrow.array(np.arange(len(state)) * 0.05)
        ),
        "observation.state": lists,
    }
    table = pyarrow.table(columns)
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(table.replace_schema_metadata(metadata), sink)
    return bytes(sink.getvalue())


def _check_columns(position: np.ndarray, state: np.ndarray) -> None:
    """Raise an error unless each column of positions is one of the state."""
    for column in position.T:
        if not any(np.array_equal(column, own) for own in state.T):
            raise WrongAnswerError(f"read {column[:3]}, which no column is")


# --- sweeps ---------------------------------------------------------------------------

_STUDY = """
seed = 7
samples = 4
[axes]
axis_e_pos = 0.1
axis_d_pos = {random = [0, 200], unit = "deg"}
axis_c_pos = {values = [0.3, 1.7]}
axis_b_pos = {from = 0, to = 1, count = 3}
[outputs.peak]
quantity = "torque"
as = "peak"
[outputs.bars]
quantity = "torque"
as = "histogram"
range = [-1, 1]
bins = 8
[outputs.all]
quantity = "torque"
as = "table"
"""
#: Names of files that the folder of a sweep may hold besides its own.
_FOREIGN = (
    "notes.txt",
    "parts/part-000001.parquet",
    "parts/part-999999.parquet",
    "parts/part-x.parquet",
    "parts/.part-000000.parquet",
    "rows/part-000007.parquet",
    "rows/x/y.parquet",
    f"{CANARY}/parts",
)


@cache
def _results() -> tuple[dict[str, bytes], Any]:
    """The files of a sweep, and its outputs."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.toml").write_text(_STUDY, encoding="utf-8")
        made = a5.sweep(folder / "study.toml", folder / "out", rows=8)
        files = {
            path.relative_to(folder / "out").as_posix(): path.read_bytes()
            for path in sorted((folder / "out").rglob("*"))
            if path.is_file()
        }
        return files, made.outputs


def sweep_folder(rng: Rng, folder: Path) -> Case:
    """A sweep that goes on in its folder, in which some files are not as it left them.

    The results must be those of the first time, to the byte.
    """
    files, outputs = _results()
    out = _fresh(folder, "out")
    study = folder / "study.toml"
    study.write_text(_STUDY, encoding="utf-8")
    for name, content in files.items():
        _put(out / name, content)
    for _ in range(int(rng.integers(1, 4))):
        _disturb(rng, out, files)

    def call(folder: str) -> Any:
        again = a5.sweep(study, folder, rows=8)
        for name, columns in outputs.items():
            for column, values in columns.items():
                if not np.array_equal(again.outputs[name][column], values):
                    raise WrongAnswerError(f"{name}.{column} has other numbers")
        for name, content in files.items():
            if name != "summary.json" and (out / name).read_bytes() != content:
                raise WrongAnswerError(f"{name} has other bytes")
        return again.repaired, again.foreign

    return Case(call, {"folder": str(out)})


def _disturb(rng: Rng, out: Path, files: dict[str, bytes]) -> None:
    """Damage, exchange, remove or add a file."""
    names = sorted(files)
    name = pick(rng, names)
    path = out / name
    way = int(rng.integers(8))
    if not path.is_file() or path.is_symlink():
        return
    if way < 3:
        path.write_bytes(hostile.garbled(rng, files[name]))
    elif way == 3:
        path.write_bytes(files[pick(rng, names)])
    elif way == 4:
        path.unlink()
    elif way == 5:
        path.unlink()
        path.mkdir()
    elif way == 6:
        path.write_bytes(b"")
    else:
        foreign = out / pick(rng, _FOREIGN)
        if not foreign.exists():
            _put(foreign, pick(rng, (b"", b"x", files[name])))


# --- obstacles ------------------------------------------------------------------------

OBSTACLES = """
[hull]
box = [0.457, 0.338, 0.254]
xyz = [-0.2, 0.0, -0.14]
rpy = [0.0, 0.0, 0.1]

[post]
cylinder = [0.03, 1.0]
xyz = [0.4, 0.1, 0.0]

[buoy]
sphere = 0.08
xyz = [0.5, 0.0, 0.4]

[frame]
mesh = "frame.stl"
scale = 0.001
"""


def stl(rng: Rng) -> bytes:
    """A binary STL of a few triangles, good or bad."""
    count = int(rng.integers(1, 6)) if rng.integers(8) else 0
    numbers = rng.normal(0, 300, (count, 12)).astype("<f4")
    if rng.integers(4) == 0 and count:
        numbers[0, 3:] = pick(rng, (np.nan, np.inf, 0.0, 3e38, 1e-40))
    body = b"".join(row.tobytes() + b"\0\0" for row in numbers)
    stated = pick(rng, (count,) * 8 + (2**32 - 1, count + 1))
    content = b"solid".ljust(80) + int(stated).to_bytes(4, "little") + body
    return hostile.garbled(rng, content) if rng.integers(6) == 0 else content


def obstacles(rng: Rng, folder: Path) -> Case:
    """A file of obstacles with a mesh beside it."""
    place = _fresh(folder, "obstacles")
    (place / "frame.stl").write_bytes(stl(rng))
    way = int(rng.integers(3))
    if way == 0:
        content = damage(rng, OBSTACLES)
    elif way == 1:
        made = hostile.study_of_anything(rng, OBSTACLES)
        # The mesh that a file names is read, whatever its name.
        made = re.sub("^mesh = .*$", 'mesh = "frame.stl"', made, flags=re.MULTILINE)
        content = made.encode("utf-8", "replace")
    else:
        content = OBSTACLES.encode()
    path = place / "obstacles.toml"
    path.write_bytes(content)
    return Case(_distances, {"path": path}, size=len(content))


def _distances(path: Path) -> Any:
    """How far the arm is from the obstacles, and whether it touches one."""
    found = read_obstacles(path)
    around = Surroundings(a5.parameters(), found)
    q = a5.named_pose("home")
    distance, names = around.nearest(q)
    touches = bool(around.touches(q[None])[0])
    if touches != (distance <= 0):
        raise WrongAnswerError(f"{names} {distance} m apart, touching: {touches}")
    return distance


TARGETS: dict[str, Target] = {
    "lerobot": lerobot,
    "sweep folder": sweep_folder,
    "obstacles": obstacles,
}
