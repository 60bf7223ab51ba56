"""``alpha5 ik``: all joint positions that put the tcp at a point."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import wrap
from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE, LENGTH, Scalar, Vector
from alpha5_model.errors import SelfCollisionError
from alpha5_model.kinematics.ik import BRANCHES, Solutions, inverse_kinematics
from alpha5_model.numbers.parameters import parameters

#: Angles that differ by less belong to branches that meet [rad].
_SAME = 1e-6


HELP = """
Exit status: 0 solved, 2 no branch is within the joint limits and free of
self-collision. In the column limits, collides means: within the limits, but
in self-collision.

Example: alpha5 ik 0.25 -0.1 0.05 --wrist 90deg
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "point",
        type=Vector(LENGTH, LENGTH, LENGTH),
        metavar="X Y Z",
        help="point of the tcp in base_link (m)",
    )
    parser.add_argument(
        "--wrist",
        type=Scalar(ANGLE),
        default=0.0,
        help="angle of axis_b, theta_3 (rad). Default: 0",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    own = common.record_of(given)
    joints = (own or parameters()).joints[:4]
    middle = [(joint.lower + joint.upper) / 2 for joint in joints]

    solutions = inverse_kinematics(given.point, given.wrist, arm=own)
    best, collision = _best(solutions, middle)
    record: dict[str, Any] = {
        "position": given.point,
        "singular": solutions.singular,
        "best": best,
        "branches": [_branch(solutions, index) for index in range(len(BRANCHES))],
    }
    names = [joint.name for joint in joints]
    printing.show(given.json, record, _text(record, names))
    if collision is not None:
        raise collision


def _best(
    solutions: Solutions, q_reference: list[float]
) -> tuple[FloatArray | None, SelfCollisionError | None]:
    """The best solution, or the error of a target whose solutions all collide."""
    try:
        return solutions.best(q_reference), None
    except SelfCollisionError as error:
        return None, error


def _branch(solutions: Solutions, index: int) -> dict[str, Any]:
    exists = solutions.exists[index]
    return {
        "name": BRANCHES[index],
        "exists": exists,
        "within_limits": solutions.within_limits[index],
        "collides": solutions.collides[index],
        "q": solutions.q[index] if exists else None,
        "same_as": _met_branch(solutions, index) if exists else None,
    }


def _met_branch(solutions: Solutions, index: int) -> str | None:
    """The first earlier branch with the same solution, as at singular targets."""
    apart = np.abs(wrap(solutions.q[index] - solutions.q[:index]))
    same = apart.max(axis=1) < _SAME
    return BRANCHES[int(same.argmax())] if same.any() else None


def _text(record: dict[str, Any], joints: list[str]) -> printing.Lines:
    rows = [["branch", *joints, "limits"]]
    rows += [[branch["name"], *_cells(branch)] for branch in record["branches"]]
    yield "joint positions (rad)"
    yield from table(rows, "<>>>><")

    if record["best"] is not None:
        best = ",".join(f"{angle:.9g}" for angle in record["best"])
        yield f"nearest to mid-range: --q={best}"
    if record["singular"]:
        yield (
            "The target is singular: "
            "on the yaw axis, or the arm is stretched or folded."
        )


def _cells(branch: dict[str, Any]) -> list[str]:
    """The angles of a branch, how they stand to the limits, and whether it collides."""
    if not branch["exists"]:
        return [*["-"] * 4, "out of reach"]

    angles = [f"{angle:.6f}" for angle in branch["q"]]
    limits = "within" if branch["within_limits"] else "beyond"
    if branch["collides"]:
        limits = "collides"
    if branch["same_as"] is not None:
        limits += f", as row {BRANCHES.index(branch['same_as']) + 1}"
    return [*angles, limits]
