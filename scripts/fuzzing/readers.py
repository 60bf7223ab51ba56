"""Files that somebody hands in: URDF, recordings, studies, ..., damaged or hostile."""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fuzzing import folders, hostile, names, own_arms, quantities
from fuzzing.cases import Case, Target
from fuzzing.damage import damage
from fuzzing.values import TEXTS, Rng, pick, spoil

import alpha5_model as a5
from alpha5_model.description.reading import read_urdf, urdf_shapes
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.verification import verify_urdf
from alpha5_model.numbers.parameters import parameters_from_tables
from alpha5_model.numbers.reading import parse
from alpha5_model.studies.sweep.study import read_study


@cache
def _urdf(k: int) -> str:
    gripper = ("locked", "jaws")[k % 2]
    on_vehicle = k // 2 % 2
    variant = Variant(
        gripper,
        prefix="left_" if on_vehicle else "",
        parent="rov" if on_vehicle else "",
        ros2_control=k > 2,
    )
    return urdf(variant)


def _recording(rng: Rng) -> str:
    rows = int(rng.integers(0, 12))
    time = np.arange(rows) * 0.05
    names = ["time_secs", *(f"axis_{j}_pos" for j in "edcb")]
    columns = [time, *rng.uniform(0.5, 1.5, (4, rows))]
    if rng.integers(2):
        names += [f"axis_{j}_vel" for j in "edcb"]
        columns += list(rng.normal(0, 0.1, (4, rows)))

    lines = [",".join(names)]
    for row in np.transpose(columns):
        lines.append(",".join(f"{x:.6g}" for x in row))
    return "\n".join(lines) + "\n"


def _file(
    text: Callable[[Rng], str],
    suffix: str,
    reads: dict[Callable[..., Any], int],
) -> Target:
    """A target that writes a damaged text and has it read by one of the functions.

    Args:
        text: Draws the text.
        suffix: Of the file.
        reads: Function -> its weight.
    """
    functions = _repeated(reads)

    def target(rng: Rng, folder: Path) -> Case:
        path = folder / f"damaged{suffix}"
        content = damage(rng, text(rng))
        path.write_bytes(content)
        return Case(pick(rng, functions), {"path": path}, size=len(content))

    return target


def _repeated(reads: dict[Callable[..., Any], int]) -> list[Callable[..., Any]]:
    """Each function as often as its weight says."""
    functions: list[Callable[..., Any]] = []
    for read, weight in reads.items():
        functions += [read] * weight
    return functions


def _compare(path: Path) -> Any:
    return a5.compare(path, samples=2).as_dict()


def _verify(path: Path) -> Any:
    return verify_urdf(path, samples=2)


def _frames(path: Path) -> Any:
    chain = a5.dh.DHChain.from_urdf(path)
    return chain.frames(chain.home)


def _analyse(path: Path) -> Any:
    motion = a5.trajectory.read_motion(path)
    analysis = a5.trajectory.analyse(motion)
    return a5.trajectory.summary(analysis)


def _tables(rng: Rng, folder: Path) -> Case:
    texts = list(_published())
    k = int(rng.integers(2))
    texts[k] = damage(rng, texts[k]).decode("utf-8", "replace")

    def call(document: str, supplementary: str) -> Any:
        return parameters_from_tables(parse(document, supplementary), ("base_frame",))

    return Case(call, {"document": texts[0], "supplementary": texts[1]})


@cache
def _published() -> tuple[str, str]:
    folder = Path(a5.__file__).parent / "numbers"
    document = folder / "reach_alpha_mk2_v7.toml"
    supplementary = folder / "supplementary.toml"
    return document.read_text("utf-8"), supplementary.read_text("utf-8")


def _variant(rng: Rng, folder: Path) -> Case:
    chosen: dict[str, Any] = {
        "gripper": pick(rng, ("locked", "jaws")),
        "prefix": "a_",
        "parent": "rov",
        "xyz": rng.normal(size=3),
        "rpy": rng.normal(size=3),
        "mesh_prefix": "m/",
        "collision": "none",
        "dh_frames": True,
        "ros2_control": True,
        "ros2_control_hardware": "blue_reach_5",
        "ros2_control_plugin": "x/Y",
        "corrections": (),
    }
    arguments = {name: chosen[name] for name in chosen if rng.integers(3) == 0}
    if arguments:
        name = pick(rng, list(arguments))
        arguments[name] = (
            pick(rng, TEXTS)
            if isinstance(chosen[name], str)
            else spoil(rng, chosen[name])[0]
        )
    return Case(lambda **given: urdf(Variant(**given)), arguments)


def _hostile(
    suffixes: tuple[str, ...],
    text: Callable[[Rng], str | bytes],
    reads: dict[Callable[..., Any], int],
) -> Target:
    """A target that writes a text under one of the endings and has it read.

    Args:
        suffixes: Of the file.
        text: Draws the text.
        reads: Function -> its weight.
    """
    functions = _repeated(reads)

    def target(rng: Rng, folder: Path) -> Case:
        made = text(rng)
        content = made if isinstance(made, bytes) else made.encode("utf-8", "replace")
        path = folder / f"hostile{pick(rng, suffixes)}"
        path.write_bytes(content)
        return Case(pick(rng, functions), {"path": path}, size=len(content))

    return target


def _shapes(path: Path) -> Any:
    return [urdf_shapes(path.read_bytes(), kind) for kind in ("visual", "collision")]


def _published_tables(path: Path) -> Any:
    """The tables of the documents, from another text."""
    text = path.read_text("utf-8", "replace")
    return parameters_from_tables(parse(text, _published()[1]), ("base_frame",))


@cache
def _bag(kind: str) -> bytes:
    """A small bag of joint states."""
    sys.path.append(str(Path(__file__).resolve().parents[2] / "tests" / "support"))
    from bag_writer import State, write_bag

    joints = [f"axis_{x}" for x in "edcb"]
    states = [
        State(
            stamp=10**18 + k * 10**8,
            names=joints,
            position=(1.0, 1.0 + 0.01 * k, 1.0, 0.5),
        )
        for k in range(12)
    ]
    with tempfile.TemporaryDirectory() as folder:
        return write_bag(Path(folder), kind, states).read_bytes()


def _garbled_bag(kind: str) -> Target:
    return _hostile(
        (kind,),
        lambda rng: hostile.garbled(rng, _bag(kind)),
        {a5.trajectory.read_motion: 1},
    )


@cache
def _parquet() -> bytes:
    """A small table of joint positions."""
    import pyarrow
    from pyarrow import parquet

    columns = {"time_secs": np.arange(8) * 0.1}
    columns |= {f"axis_{x}_pos": np.linspace(0.5, 1.0, 8) for x in "edcb"}
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(pyarrow.table(columns), sink)
    return bytes(sink.getvalue())


STUDY = """
seed = 7
samples = 10
[axes]
axis_e_pos = 0.1
axis_d_pos = {random = [0, 200], unit = "deg"}
axis_c_pos = {values = [0.3, 1.7]}
axis_b_pos = {from = 0, to = 1, count = 3}
payload_mass = {values = [0, 250], unit = "g"}
fluid_density = [1000, 1025]
level = ["low", "high"]
vehicle = "small"
trim = [true, false]
arm = "catalogue"
in_collision = [false, true]
[vehicles.small]
mass = 13.5
com = [0.0, 0.0, 0.0]
volume = 0.0134
cob = [0.0, 0.0, 0.01]
rpy = [3.1, 0.0, 0.0]
[outputs.peak]
quantity = "torque"
as = "peak"
by = ["fluid_density"]
[outputs.spread]
quantity = "torque"
as = "quantile"
levels = [0.001, 0.5, 1]
[outputs.bars]
quantity = "torque"
as = "histogram"
range = [-1, 1]
bins = 8
"""


def _study_as_read(path: Path) -> Any:
    study = read_study(path)
    return study.cases, study.states, study.sizes()


def _hostile_study(rng: Rng) -> str:
    if rng.integers(2):
        return hostile.repeated(rng)
    made = hostile.study_of_anything(rng, STUDY)
    # The files that a study names are read, whatever their names.
    return re.sub("^(arm|recordings) = .*$", r'\1 = "none"', made, flags=re.MULTILINE)


TARGETS: dict[str, Target] = {
    "urdf": _file(
        lambda rng: _urdf(int(rng.integers(4))),
        ".urdf",
        {read_urdf: 60, _frames: 30, _compare: 9, _verify: 1},
    ),
    "recording": _file(
        _recording,
        ".csv",
        {a5.trajectory.read_motion: 8, _analyse: 2},
    ),
    "tables": _tables,
    "variant": _variant,
    "hostile urdf": _hostile(
        (".urdf", ".xacro", ".urdf.xacro", ".xml"),
        lambda rng: pick(rng, hostile.XML)(rng, _urdf(int(rng.integers(4)))),
        {read_urdf: 20, _frames: 10, _compare: 12, _shapes: 5, _verify: 1},
    ),
    "hostile recording": _hostile(
        (".csv", ".csv", ".txt", ".tsv", "", ".parquet", ".bag", ".mcap", ".db3"),
        lambda rng: pick(rng, hostile.TABLES)(rng),
        {a5.trajectory.read_motion: 8, _analyse: 2},
    ),
    "hostile study": _hostile(
        (".toml",),
        _hostile_study,
        {_study_as_read: 1},
    ),
    "study": _file(lambda rng: STUDY, ".toml", {_study_as_read: 1}),
    "hostile tables": _hostile(
        (".toml",),
        lambda rng: hostile.study_of_anything(rng, _published()[0]),
        {_published_tables: 1},
    ),
    "garbled mcap": _garbled_bag(".mcap"),
    "garbled db3": _garbled_bag(".db3"),
    "garbled bag": _garbled_bag(".bag"),
    "garbled parquet": _hostile(
        (".parquet",),
        lambda rng: hostile.garbled(rng, _parquet()),
        {a5.trajectory.read_motion: 1},
    ),
    "columns": names.target,
    "quantities": quantities.target,
    **folders.TARGETS,
    **own_arms.TARGETS,
}
