"""``alpha5 ik``: every joint position that puts the tcp at a point."""

from __future__ import annotations

from typing import Annotated

import typer
from rich import box
from rich.console import Console
from rich.table import Column, Table

from alpha5_model.cli.options import print_json
from alpha5_model.kinematics.ik import BRANCHES, Solutions, inverse_kinematics
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.parameters import parameters


def ik(
    x: Annotated[float, typer.Argument(help="tcp in base_link (m).")],
    y: Annotated[float, typer.Argument(help="(m)")],
    z: Annotated[float, typer.Argument(help="(m)")],
    wrist: Annotated[float, typer.Option(help="Wrist angle theta_3 (rad).")] = 0.0,
    as_json: Annotated[bool, typer.Option("--json", help="Everything as JSON.")] = False,
) -> None:
    """All inverse kinematics solutions of a tcp position.

    Exit status: 0 solved, 2 out of reach within the joint limits.

    Example: alpha5 ik 0.25 -0.1 0.05 --wrist 1.57
    """
    solutions = inverse_kinematics([x, y, z], wrist)
    best = solutions.best(arm_plane().middle)
    if as_json:
        print_json(_as_dict(solutions, best.tolist()))
    else:
        _print(solutions, best.tolist())


def _as_dict(solutions: Solutions, best: list[float]) -> dict[str, object]:
    return {
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


def _print(solutions: Solutions, best: list[float]) -> None:
    heads = (Column(joint.name, justify="right") for joint in parameters().joints[:4])
    table = Table(
        Column("branch", no_wrap=True),
        *heads,
        "in limits",
        box=box.SIMPLE_HEAD,
        title="joint positions (rad)",
        title_justify="left",
    )
    for i, name in enumerate(BRANCHES):
        if solutions.exists[i]:
            angles = (f"{angle:.6f}" for angle in solutions.q[i])
            table.add_row(name, *angles, "yes" if solutions.within_limits[i] else "no")
        else:
            table.add_row(name, *["-"] * 4, "out of reach")
    console = Console()
    console.print(table)
    nearest = " ".join(f"{angle:.9g}" for angle in best)
    console.print(
        f"nearest to the middle of the ranges: {nearest}", highlight=False, soft_wrap=True
    )
    if solutions.singular:
        console.print("The target is singular: on the yaw axis, or the arm is stretched or folded.")
