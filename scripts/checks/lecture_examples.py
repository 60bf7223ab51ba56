"""Walk through the lecture notes "7.1 Describing Robot Arms" with the package.

    python scripts/checks/lecture_examples.py [FOLDER]

Prints every example of the notes, in their order, beside what the package computes, and
writes the pictures to FOLDER (by default ``lecture_examples``). Exit status 1 if a
printed number differs.

The notes call the workspace of a 2R arm with joint limits a disc. That is topology: a
region without a hole, bounded by arcs; and with a free first joint it keeps its hole.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

import numpy as np

import alpha5_model as a5
from alpha5_model.errors import OutputError
from alpha5_model.kinematics.pose import approach_directions
from alpha5_model.proofs.audit.lecture import PRINTED_TABLE
from alpha5_model.theory.dh.types_and_tasks import (
    classify,
    spatial_conditions,
    task_capability,
)
from alpha5_model.viewer.planar_plot import new_axes, plot_planar, save

QUARTER = math.pi / 2
#: Arms of the section "Workspace", one to four joints, without and with limits.
PLANAR = {
    "1R": a5.planar.PlanarArm((5,)),
    "1R, limits": a5.planar.PlanarArm((5,), [(-1, 2)]),
    "1P": a5.planar.PlanarArm((1,), [(0, 4)], "P"),
    "2R": a5.planar.PlanarArm((5, 4)),
    "2R, limits": a5.planar.PlanarArm((5, 4), [(0, 2), (0.3, 2.5)]),
    "2R, elbow limits": a5.planar.PlanarArm((5, 5), [None, (-2.5, 2.5)]),
    "3R": a5.planar.PlanarArm((5, 4, 1)),
    "3R, limits": a5.planar.PlanarArm((5, 4, 3), [(-1, 2), (-1, 2.5), (-1, 1)]),
    "RP": a5.planar.PlanarArm((1, 0), [(-1, 2), (1, 3)], "RP"),
    "PR": a5.planar.PlanarArm((1, 2), [(0, 3), None], "PR"),
    "PP": a5.planar.PlanarArm((0, 0), [(1, 4), (0, 2)], "PP", (0, QUARTER)),
    "4R, limits": a5.planar.PlanarArm(
        (5, 4, 3, 1), [(-1, 2), (-1, 1.5), (-1, 1), (-1, 2)]
    ),
}
#: Arms of the section on dexterous workspaces: the notes' own, and where the theorem
#: falls short.
DEXTEROUS = {
    "the notes' arm": a5.planar.PlanarArm((5, 4, 1)),
    "the theorem leaves out 0 to 3": a5.planar.PlanarArm((5, 5, 3)),
    "2R of equal links: a point": a5.planar.PlanarArm((5, 5)),
    "a length that varies": a5.planar.PlanarArm((1, 0, 1), [None, (0, 4), None], "RPR"),
    "elbow limited to 2.5 rad": a5.planar.PlanarArm(
        (5, 4, 1), [None, (-2.5, 2.5), None]
    ),
    "last joint limited to 3 rad": a5.planar.PlanarArm(
        (5, 4, 1), [None, None, (-3, 3)]
    ),
}
#: Arms of the sections "Arm Types" and "Task requirements"; rows [theta, d, a, alpha,
#: sigma].
ARMS = {
    "SCARA": a5.dh.DHChain.from_table(
        [
            [0, 0.4, 0.3, 0, 0],
            [0, 0, 0.25, math.pi, 0],
            [0, 0, 0, 0, 1],
            [0, 0, 0, 0, 0],
        ]
    ),
    "six joints (Puma 560)": a5.dh.DHChain.from_table(
        [
            [0, 0, 0, QUARTER, 0],
            [0, 0, 0.4318, 0, 0],
            [0, 0.15005, 0.0203, -QUARTER, 0],
            [0, 0.4318, 0, QUARTER, 0],
            [0, 0, 0, -QUARTER, 0],
            [0, 0, 0, 0, 0],
        ]
    ),
    "Reach Alpha 5": a5.dh.DHChain.alpha5(),
}


def main(arguments: list[str] | None = None) -> int:
    """Print all examples and write the pictures; 0 if the notes' numbers are
    reproduced.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument(
        "folder", nargs="?", type=Path, default=Path("lecture_examples")
    )
    out = parser.parse_args(arguments).folder
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(out, str(error.strerror)) from None
    arm_types()
    workspaces(out)
    dexterous_workspaces(out)
    same = theorem_table()
    link()
    print(f"\npictures: {', '.join(sorted(str(p) for p in out.glob('*.png')))}")
    return 0 if same else 1


def arm_types() -> None:
    print("Arm types and task requirements")
    for name, chain in ARMS.items():
        kind = classify(chain)
        task = task_capability(chain)
        insertion = _yes(task.vertical_insertion)
        print(f"  {name}: {kind.joints}, {kind.kind} ({kind.reason})")
        print(f"    general tasks {_yes(task.general)}: {task.general_reason}")
        print(f"    vertical insertion {insertion}: {task.insertion_reason}")
        conditions = spatial_conditions(chain)
        missing = "; ".join(conditions.reasons) or "necessary conditions hold"
        print(f"    dexterous workspace with an interior: {missing}")
    point = (0.25, 0.1, 0.1)
    ways = approach_directions(point)
    allowed = ways.directions[ways.within_limits]
    print(
        f"  the Alpha 5 at {point} m instead has {len(allowed)} approach direction(s):"
    )
    for direction in allowed:
        numbers = ", ".join(f"{x:.4f}" for x in direction)
        print(f"    ({numbers}), any wrist roll in its range")


def workspaces(out: Path) -> None:
    print("\nWorkspace")
    axes = new_axes(4, 3, 4.0)
    for (name, arm), ax in zip(PLANAR.items(), axes.flat, strict=True):
        space = arm.workspace()
        low, high = space.radii
        print(
            f"  {name}: {space.shape}, {low:.4g} to {high:.4g} m from the base, "
            f"{space.area:.6g} m^2"
        )
        drawn = plot_planar(arm, axes=ax, dexterous=False)
        drawn.set_title(f"{name}: {space.shape}", fontsize=10)
    save(axes, out / "workspaces.png")


def dexterous_workspaces(out: Path) -> None:
    print("\nDexterous workspace")
    axes = new_axes(3, 2, 4.6)
    for (name, arm), ax in zip(DEXTEROUS.items(), axes.flat, strict=True):
        drawn = plot_planar(arm, axes=ax)
        drawn.set_title(f"{arm.joints} {arm.lengths}\n{name}", fontsize=10)
        if arm.length_ranges is None:
            print(f"  {name}: by enumeration, see the picture")
            continue
        radii = a5.planar.dexterous_radii(arm)
        text = " and ".join(f"{a:g}" if a == b else f"{a:g} to {b:g}" for a, b in radii)
        print(f"  {name}, l = {arm.lengths}: {text or 'none'} m from the base")
    save(axes, out / "dexterous.png")


def theorem_table() -> bool:
    """The notes' experiment row by row."""
    print("\nThe theorem, l = (5, 4, 1)")
    print("     l_4   l_i+l_j      L/2   printed           theorem   turns fully")
    same = True
    for l_4, pair, half in PRINTED_TABLE:
        row = a5.planar.theorem_row(5, 4, 1, l_4)
        computed = (row.pair, row.half)
        equal = bool(np.allclose(computed, (pair, half), rtol=0, atol=1e-12))
        same &= equal
        verdict = "" if equal else "DIFFERS"
        print(
            f"  {l_4:6g} {row.pair:9g} {row.half:8g}   {pair:5g} {half:6g} "
            f"{verdict:8s}  {_yes(row.theorem):7s}   {_yes(row.exact)}"
        )
    low, high = a5.planar.theorem_radii(5, 4, 1) or (math.nan, math.nan)
    print(
        f"  the theorem holds for {low:g} <= l_4 <= {high:g}; "
        "the exact condition adds l_4 = 0"
    )
    row = a5.planar.theorem_row(5, 5, 3, 1)
    print(
        f"  l = (5, 5, 3), l_4 = 1: theorem {_yes(row.theorem)}, "
        f"turns fully {_yes(row.exact)}"
    )
    return same


def link() -> None:
    print("\nL = Link([0, 0.1, 0.2, pi/2, 0])")
    example = a5.dh.DHLink.from_vector([0, 0.1, 0.2, QUARTER, 0])
    for row in example.transform(0.3):
        print("  " + " ".join(f"{x + 0.0:9.5f}" for x in row.round(12)))
    print("Reach Alpha 5, Table 1, at q = 0: the tool's place")
    tip = a5.dh.DHChain.alpha5().forward_kinematics(np.zeros(4))[:3, 3]
    print("  " + " ".join(f"{x + 0.0:9.5f}" for x in tip.round(12)))


def _yes(answer: bool) -> str:
    return "yes" if answer else "no"


if __name__ == "__main__":
    sys.exit(main())
