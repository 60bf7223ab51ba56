"""``alpha5 dh``: a standard DH table and the frames at a joint position."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from alpha5_model.cli.options import numbers, print_json
from alpha5_model.dh import DHChain, DHLink
from alpha5_model.dh.arm_types import classify, task_capability
from alpha5_model.errors import InputError, ShapeError

_LINK = "'THETA D A ALPHA SIGMA'"


def dh(
    q: Annotated[
        list[float] | None,
        typer.Argument(
            help="Joint position (rad or m); the drawn one if left out.", metavar="[Q]..."
        ),
    ] = None,
    link: Annotated[
        list[str] | None,
        typer.Option("--link", help=f"{_LINK} of another arm, once per link."),
    ] = None,
    urdf: Annotated[
        Path | None, typer.Option(help="Assign the frames to the arm of this URDF.")
    ] = None,
    frame: Annotated[str | None, typer.Option(help="End effector in the URDF.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
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
    names = [f"{{{j}}}" for j in range(chain.n + 1)] + ["tool"]
    if as_json:
        result: dict[str, Any] = {
            "name": chain.name,
            "links": [  # JSON has no infinity: no limit is null
                {
                    "joint": name,
                    **{k: v if math.isfinite(v) else None for k, v in vars(row).items()},
                }
                for name, row in zip(chain.joint_names, chain.links, strict=True)
            ],
            "base": chain.base.tolist(),
            "tool": chain.tool.tolist(),
            "type": vars(kind),
            "tasks": vars(task),
            "q": list(map(float, position)),
            "frames": {name: f.tolist() for name, f in zip(names, frames, strict=True)},
        }
        print_json(result)
        return
    typer.echo("\n".join(_table(chain)))
    typer.echo(f"\n{kind.joints}, type {kind.kind}: {kind.reason}")
    typer.echo(f"general tasks: {_yes(task.general)}, {task.general_reason}")
    typer.echo(f"vertical insertion: {_yes(task.vertical_insertion)}, {task.insertion_reason}")
    typer.echo(f"\nframes at q = ({', '.join(f'{x:.6g}' for x in position)})")
    for name, matrix in zip(names, frames, strict=True):
        for i, row in enumerate(matrix[:3]):
            cells = " ".join(f"{x:z10.6f}" for x in row)
            typer.echo(f"{name if i == 0 else '':5s} {cells}")


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


def _table(chain: DHChain) -> list[str]:
    width = max(len("joint"), *map(len, chain.joint_names))
    heads = ("theta", "d", "a", "alpha", "sigma", "lower", "upper")
    lines = [f"{'joint':{width}s} " + " ".join(f"{h:>11s}" for h in heads)]
    for name, row in zip(chain.joint_names, chain.links, strict=True):
        cells = [*(f"{x:.6f}" for x in (row.theta, row.d, row.a, row.alpha)), str(row.sigma)]
        cells[0 if row.revolute else 1] = f"q{row.offset:+.6f}" if row.offset else "q"
        cells += f"{row.lower:.5g}", f"{row.upper:.5g}"
        lines.append(f"{name:{width}s} " + " ".join(f"{x:>11s}" for x in cells))
    return lines


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"
