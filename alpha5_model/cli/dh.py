"""``alpha5 dh``: a standard DH table and the frames at a joint position."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from alpha5_model.cli.options import Lines, numbers, show
from alpha5_model.dh import DHChain, DHLink
from alpha5_model.dh.arm_types import classify, task_capability
from alpha5_model.errors import InputError, ShapeError

_LINK = "'THETA D A ALPHA SIGMA'"


def dh(
    q: Annotated[
        list[float] | None,
        Argument(help="Joint position (rad or m); the drawn one if left out.", metavar="[Q]..."),
    ] = None,
    link: Annotated[
        list[str] | None, Option("--link", help=f"{_LINK} of another arm, once per link.")
    ] = None,
    urdf: Annotated[Path | None, Option(help="Assign the frames to the arm of this URDF.")] = None,
    frame: Annotated[str | None, Option(help="End effector in the URDF.")] = None,
    as_json: Annotated[bool, Option("--json", help="Print JSON.")] = False,
) -> None:
    """Standard Denavit-Hartenberg table and frames: of the Alpha 5, or of any serial arm.

    Example: alpha5 dh 0.5 1.2 1 0
    Example: alpha5 dh --link '0 0.1 0.2 1.5708 0' --link '0 0 0.3 0 0' -0.4 0.2
    """
    chain = _chain(link, urdf, frame)
    if q and len(q) != chain.n:
        raise ShapeError("q", (len(q),), f"one number for each of {', '.join(chain.joint_names)}")
    position = q or chain.home
    frames = chain.frames(position)
    kind, task = classify(chain), task_capability(chain)
    names = [*(f"{{{j}}}" for j in range(chain.n + 1)), "tool"]
    record: dict[str, Any] = {
        "name": chain.name,
        "links": [  # JSON has no infinity: no limit is null
            {"joint": name, **{k: v if math.isfinite(v) else None for k, v in vars(row).items()}}
            for name, row in zip(chain.joint_names, chain.links, strict=True)
        ],
        "base": chain.base.tolist(),
        "tool": chain.tool.tolist(),
        "type": vars(kind),
        "tasks": vars(task),
        "q": [*map(float, position)],
        "frames": {name: f.tolist() for name, f in zip(names, frames, strict=True)},
    }
    show(as_json, record, _text(chain, record))


def _chain(link: list[str] | None, urdf: Path | None, frame: str | None) -> DHChain:
    if link and urdf is not None:
        raise InputError("--link, --urdf", (link, str(urdf)), "one of the two")
    if frame is not None and urdf is None:
        raise InputError("--frame", frame, "--urdf with it")
    if urdf is not None:
        return DHChain.from_urdf(urdf, frame)
    if link:
        return DHChain(tuple(DHLink.from_vector(numbers("--link", text, _LINK)) for text in link))
    return DHChain.alpha5()


def _text(chain: DHChain, record: dict[str, Any]) -> Lines:
    width = max(len("joint"), *map(len, chain.joint_names))
    heads = ("theta", "d", "a", "alpha", "sigma", "lower", "upper")
    yield " ".join([f"{'joint':{width}s}", *(f"{head:>11s}" for head in heads)])
    for name, row in zip(chain.joint_names, chain.links, strict=True):
        cells = [*(f"{x:.6f}" for x in (row.theta, row.d, row.a, row.alpha)), str(row.sigma)]
        cells[0 if row.revolute else 1] = f"q{row.offset:+.6f}" if row.offset else "q"
        cells += f"{row.lower:.5g}", f"{row.upper:.5g}"
        yield " ".join([f"{name:{width}s}", *(f"{cell:>11s}" for cell in cells)])
    kind, task, answer = record["type"], record["tasks"], {True: "yes", False: "no"}
    yield f"\n{kind['joints']}, type {kind['kind']}: {kind['reason']}"
    yield f"general tasks: {answer[task['general']]}, {task['general_reason']}"
    insertion = task["vertical_insertion"]
    yield f"vertical insertion: {answer[insertion]}, {task['insertion_reason']}"
    yield f"\nframes at q = ({', '.join(f'{x:.6g}' for x in record['q'])})"
    for name, matrix in record["frames"].items():
        for i, row in enumerate(matrix[:3]):
            yield " ".join([f"{'' if i else name:5s}", *(f"{x:z10.6f}" for x in row)])
