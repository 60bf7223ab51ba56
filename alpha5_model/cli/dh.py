"""``alpha5 dh``: the Denavit-Hartenberg description of this arm or of another one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from typer import Argument, Option

from alpha5_model._support.text import table
from alpha5_model.cli import options, printing, values
from alpha5_model.errors import InputError
from alpha5_model.theory.dh import DHChain, DHLink
from alpha5_model.theory.dh.types_and_tasks import classify, task_capability

_LINK = "'THETA D A ALPHA SIGMA'"
_ANSWER = {True: "yes", False: "no"}


def dh(
    q: Annotated[
        list[str] | None, Argument(help=options.HELP["position"], metavar="[Q]...")
    ] = None,
    link: Annotated[
        list[str] | None, Option("--link", help=options.HELP["link"])
    ] = None,
    urdf: Annotated[
        Path | None, Option(help="Assign the frames to the arm of this URDF.")
    ] = None,
    frame: Annotated[str | None, Option(help="End effector in the URDF.")] = None,
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> None:
    """Standard Denavit-Hartenberg table and frames: of the Alpha 5, or of any serial arm.

    Example: alpha5 dh 0.5 1.2 1 0
    Example: alpha5 dh --link '0 0.1 0.2 1.5708 0' --link '0 0 0.3 0 0' -0.4 0.2
    """  # noqa: E501 (a line of the help)
    chain = _chain(link, urdf, frame, arm_file)
    record = _record(chain, _position(chain, q))
    printing.show(as_json, record, _text(chain, record))


def _chain(
    link: list[str] | None, urdf: Path | None, frame: str | None, arm_file: Path | None
) -> DHChain:
    """The arm that the options describe; the Alpha 5 without any."""
    chosen = {"--link": link, "--urdf": urdf, "--arm": arm_file}
    given = {name: value for name, value in chosen.items() if value}
    if len(given) > 1:
        both = [
            value if name == "--link" else str(value) for name, value in given.items()
        ]
        raise InputError(", ".join(given), both, "one of the two")
    if frame is not None and urdf is None:
        raise InputError("--frame", frame, "--urdf with it")

    if urdf is not None:
        return DHChain.from_urdf(urdf, frame)
    if not link:
        return DHChain.alpha5(arm=values.arm_record(arm_file))
    rows = [values.numbers("--link", text, (), "rad or m", _LINK) for text in link]
    return DHChain(tuple(DHLink.from_vector(row) for row in rows))


def _position(chain: DHChain, q: list[str] | None) -> Any:
    """The joint position that was given; the chain's home without one."""
    if not q:
        return chain.home
    expected = f"one number for each of {', '.join(chain.joint_names)}"
    return values.numbers("q", " ".join(q), (chain.n,), "rad or m", expected)


def _record(chain: DHChain, q: Any) -> dict[str, Any]:
    names = [*(f"{{{j}}}" for j in range(chain.n + 1)), "tool"]
    links = zip(chain.joint_names, chain.links, strict=True)
    return {
        "name": chain.name,
        "links": [{"joint": name, **vars(link)} for name, link in links],
        "base": chain.base,
        "tool": chain.tool,
        "type": classify(chain),
        "tasks": task_capability(chain),
        "q": q,
        "frames": dict(zip(names, chain.frames(q), strict=True)),
    }


def _text(chain: DHChain, record: dict[str, Any]) -> printing.Lines:
    yield from _links(chain)

    arm_type = record["type"]
    task = record["tasks"]
    yield f"\n{arm_type.joints}, type {arm_type.kind}: {arm_type.reason}"
    yield f"general tasks: {_ANSWER[task.general]}, {task.general_reason}"
    insertion = _ANSWER[task.vertical_insertion]
    yield f"vertical insertion: {insertion}, {task.insertion_reason}"

    position = ", ".join(f"{x:.6g}" for x in record["q"])
    yield f"\nframes at q = ({position}): axes x, y, z and origin (m)"
    yield from _frames(record["frames"])


def _links(chain: DHChain) -> list[str]:
    """The table of the links; a joint's variable is q plus its offset."""
    lengths = ["theta (rad)", "d (m)", "a (m)", "alpha (rad)"]
    rows = [["joint", *lengths, "sigma", "lower", "upper"]]
    for name, link in zip(chain.joint_names, chain.links, strict=True):
        cells = [f"{x:.6f}" for x in (link.theta, link.d, link.a, link.alpha)]
        variable = 0 if link.revolute else 1
        cells[variable] = f"q{link.offset:+.6f}" if link.offset else "q"
        limits = [f"{link.lower:.5g}", f"{link.upper:.5g}"]
        rows.append([name, *cells, str(link.sigma), *limits])
    return table(rows)


def _frames(frames: dict[str, Any]) -> list[str]:
    rows = []
    for name, matrix in frames.items():
        for title, row in zip((name, "", ""), matrix[:3], strict=True):
            rows.append([title, *(f"{x:z.6f}" for x in row)])
    return table(rows)
