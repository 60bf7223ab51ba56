"""Files that somebody hands in: URDF, recordings, tables, xacro arguments; all of them damaged at random."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.description.urdf_reading import read_urdf
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.description.verification import verify_urdf
from alpha5_model.parameters import convert
from alpha5_model.published.reading import parse
from fuzzing.cases import Case, Target
from fuzzing.values import TEXTS, Rng, pick, spoil

#: In place of a number in a text.
NUMBERS = (
    "nan",
    "inf",
    "-inf",
    "1e400",
    "1e308",
    "1e-320",
    "-1",
    "0",
    "",
    "x",
    "1,5",
    "0x10",
    "1_0",
    "٣",
    "1e",
    "--1",
    "9" * 5000,
)
#: In place of a character.
CHARACTERS = "<>&\"'/=,;\t\n\r\0 \ufeff\u2028é9-eE.#${}[]"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def damage(rng: Rng, text: str) -> bytes:
    """The text with one to three things wrong, in some encoding."""
    for _ in range(int(rng.integers(1, 4))):
        way = int(rng.integers(8))
        start = int(rng.integers(len(text) + 1))
        end = min(start + int(rng.integers(1, 60)), len(text))
        if way < 3 and (numbers := list(NUMBER.finditer(text))):
            found = pick(rng, numbers)
            text = text[: found.start()] + pick(rng, NUMBERS) + text[found.end() :]
        elif way == 3:
            text = text[:start] + text[end:]
        elif way == 4:
            text = text[:end] + text[start:]
        elif way == 5:
            text = text[:start] + pick(rng, CHARACTERS) + text[start + 1 :]
        elif way == 6:
            lines = text.split("\n")
            k, j = (int(rng.integers(len(lines))) for _ in range(2))
            lines[k], lines[j] = lines[j], lines[k] if rng.integers(2) else ""
            text = "\n".join(lines)
        elif rng.integers(4) == 0:
            text = text[:start]
    content = text.encode(pick(rng, ("utf-8",) * 9 + ("utf-16", "latin-1", "utf-8-sig")), "replace")
    if rng.integers(10) == 0:
        raw = np.frombuffer(content, np.uint8).copy()
        raw[rng.integers(len(raw) or 1, size=min(3, len(raw)))] = rng.integers(256)
        content = raw.tobytes()
    return content


@cache
def _urdf(k: int) -> str:
    gripper = ("locked", "jaws")[k % 2]
    return urdf(
        Variant(
            gripper, prefix="left_" * (k // 2 % 2), parent="rov" * (k // 2 % 2), ros2_control=k > 2
        )
    )


def _recording(rng: Rng) -> str:
    rows = int(rng.integers(0, 12))
    time = np.arange(rows) * 0.05
    names = ["time_secs", *(f"axis_{j}_pos" for j in "edcb")]
    columns = [time, *rng.uniform(0.5, 1.5, (4, rows))]
    if rng.integers(2):
        names += [f"axis_{j}_vel" for j in "edcb"]
        columns += list(rng.normal(0, 0.1, (4, rows)))
    lines = [",".join(names), *(",".join(f"{x:.6g}" for x in row) for row in np.transpose(columns))]
    return "\n".join(lines) + "\n"


def _file(
    text: Callable[[Rng], str],
    suffix: str,
    reads: dict[Callable[..., Any], int],
) -> Target:
    """A target that writes a damaged text and has it read by one of the functions, with these weights."""
    functions = [read for read, weight in reads.items() for _ in range(weight)]

    def target(rng: Rng, folder: Path) -> Case:
        path = folder / f"damaged{suffix}"
        path.write_bytes(damage(rng, text(rng)))
        return Case(pick(rng, functions), {"path": path})

    return target


def _compare(path: Path) -> Any:
    return a5.compare(path, samples=2).as_dict()


def _verify(path: Path) -> Any:
    return verify_urdf(path, samples=2)


def _frames(path: Path) -> Any:
    chain = a5.dh.DHChain.from_urdf(path)
    return chain.frames(chain.home)


def _analyse(path: Path) -> Any:
    return a5.trajectory.summary(a5.trajectory.analyse(a5.trajectory.read_motion(path)))


def _tables(rng: Rng, folder: Path) -> Case:
    texts = list(_published())
    k = int(rng.integers(2))
    texts[k] = damage(rng, texts[k]).decode("utf-8", "replace")

    def call(document: str, supplementary: str) -> Any:
        return convert(parse(document, supplementary), ("base_frame",))

    return Case(call, {"document": texts[0], "supplementary": texts[1]})


@cache
def _published() -> tuple[str, str]:
    folder = Path(a5.__file__).parent / "published"
    first, second = (folder / f"{n}.toml" for n in ("reach_alpha_mk2_v7", "supplementary"))
    return first.read_text(encoding="utf-8"), second.read_text(encoding="utf-8")


def _variant(rng: Rng, folder: Path) -> Case:
    chosen: dict[str, Any] = {
        "gripper": pick(rng, ("locked", "jaws")), "prefix": "a_", "parent": "rov", "xyz": rng.normal(size=3), "rpy": rng.normal(size=3),
        "mesh_prefix": "m/", "collision": "none", "dh_frames": True, "ros2_control": True, "ros2_control_plugin": "x/Y", "corrections": (),
    }  # fmt: skip
    arguments = {name: chosen[name] for name in chosen if rng.integers(3) == 0}
    if arguments:
        name = pick(rng, list(arguments))
        arguments[name] = (
            pick(rng, TEXTS) if isinstance(chosen[name], str) else spoil(rng, chosen[name])[0]
        )
    return Case(lambda **given: urdf(Variant(**given)), arguments)


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
}
