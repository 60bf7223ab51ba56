"""``alpha5 ik``: every joint position that puts the tcp at a point."""

from __future__ import annotations

from typing import Annotated

from rich import box
from rich.table import Column, Table
from rich.text import Text
from typer import Argument, Option

from alpha5_model.cli.options import Lines, show
from alpha5_model.kinematics.ik import BRANCHES, Solutions, inverse_kinematics
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.parameters import parameters


def ik(
    x: Annotated[float, Argument(help="tcp in base_link (m).")],
    y: Annotated[float, Argument(help="(m)")],
    z: Annotated[float, Argument(help="(m)")],
    wrist: Annotated[float, Option(help="Wrist angle theta_3 (rad).")] = 0.0,
    as_json: Annotated[bool, Option("--json", help="Everything as JSON.")] = False,
) -> None:
    """All inverse kinematics solutions of a tcp position.

    Exit status: 0 solved, 2 out of reach within the joint limits.

    Example: alpha5 ik 0.25 -0.1 0.05 --wrist 1.57
    """
    solutions = inverse_kinematics([x, y, z], wrist)
    best = solutions.best(arm_plane().middle).tolist()
    record = {
        "position": solutions.position.tolist(),
        "singular": bool(solutions.singular),
        "best": best,
        "branches": [
            {
                "name": name,
                "exists": bool(solutions.exists[i]),
                "within_limits": bool(solutions.within_limits[i]),
                "q": solutions.q[i].tolist() if solutions.exists[i] else None,
            }
            for i, name in enumerate(BRANCHES)
        ],
    }
    show(as_json, record, _text(solutions, best))


def _text(solutions: Solutions, best: list[float]) -> Lines:
    heads = (Column(joint.name, justify="right") for joint in parameters().joints[:4])
    table = Table(Column("branch", no_wrap=True), *heads, "in limits", box=box.SIMPLE_HEAD)
    table.title, table.title_justify = "joint positions (rad)", "left"
    for i, name in enumerate(BRANCHES):
        if solutions.exists[i]:
            angles = (f"{angle:.6f}" for angle in solutions.q[i])
            table.add_row(name, *angles, "yes" if solutions.within_limits[i] else "no")
        else:
            table.add_row(name, *["-"] * 4, "out of reach")
    yield table
    nearest = " ".join(f"{angle:.9g}" for angle in best)
    yield f"nearest to the middle of the ranges: {nearest}"
    if solutions.singular:
        yield Text("The target is singular: on the yaw axis, or the arm is stretched or folded.")
