"""``alpha5 dh``: the Denavit-Hartenberg description of this arm or of another one."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import Any

from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE_OR_LENGTH, Vector
from alpha5_model.errors import InputError
from alpha5_model.theory.dh import DHChain, DHLink
from alpha5_model.theory.dh.types_and_tasks import classify, task_capability

_ANSWER = {True: "yes", False: "no"}


HELP = """
Without --link and --urdf, those of the Alpha 5.

Example: alpha5 dh 0.5 1.2 1 0
Example: alpha5 dh --link '0 0.1 0.2 1.5708 0' --link '0 0 0.3 0 0' -0.4 0.2
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "q",
        nargs="?",
        type=Vector(ANGLE_OR_LENGTH, counts=None),
        metavar="Q",
        help="joint position (rad or m). Default: THETA or D of each --link; without "
        "--link, zero",
    )
    parser.add_argument(
        "--link",
        action="append",
        type=Vector(*[ANGLE_OR_LENGTH] * 5, expected="THETA D A ALPHA SIGMA"),
        metavar="LINK",
        help="'THETA D A ALPHA SIGMA' (rad, m, m, rad; SIGMA 0 turns, 1 slides), once "
        "per link",
    )
    parser.add_argument(
        "--urdf", type=Path, help="assign the frames to the arm of this URDF"
    )
    parser.add_argument("--frame", help="end effector in the URDF")
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    chain = _chain(given)
    q = chain.home if given.q is None else given.q
    if len(q) != chain.n:
        names = ", ".join(chain.joint_names)
        raise InputError("q", q, f"one number for each of {names}")
    record = _record(chain, q)
    printing.show(given.json, record, _text(chain, record))


def _chain(given: Namespace) -> DHChain:
    """The arm that the options describe; the Alpha 5 without any."""
    chosen = {"--link": given.link, "--urdf": given.urdf, "--arm": given.arm}
    named = [name for name, value in chosen.items() if value]
    if len(named) > 1:
        raise InputError(" and ".join(named), None, "one of them")
    if given.frame is not None and given.urdf is None:
        raise InputError("--frame", given.frame, "--urdf with it")

    if given.urdf is not None:
        return DHChain.from_urdf(given.urdf, given.frame)
    if not given.link:
        return DHChain.alpha5(arm=common.record_of(given))
    return DHChain(tuple(DHLink.from_vector(row) for row in given.link))


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
