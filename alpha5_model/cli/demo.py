"""``alpha5 demo``: describe, check, solve, compute and draw the arm in one run."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import is_stream
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import audit_text
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.printing import say
from alpha5_model.cli.view import PICTURE_SIZE
from alpha5_model.description import srdf
from alpha5_model.description import urdf as variants
from alpha5_model.description.assets import mesh_assets
from alpha5_model.dynamics.load import load
from alpha5_model.errors import OutputError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.numbers.jaws import Gripper
from alpha5_model.proofs.audit import audit
from alpha5_model.proofs.audit.row import AuditRow
from alpha5_model.proofs.comparison import compare
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.picture import picture_png
from alpha5_model.viewer.poses import named_poses
from alpha5_model.viewer.scene import Scene
from alpha5_model.viewer.tracks import tour

#: A point that all four branches reach within the limits, in base_link [m].
TARGET = (0.06, 0.05, 0.36)
#: Travel of the jaw rod at which the page shows the jaws open [m].
_OPENED = 0.008


HELP = "Example: alpha5 demo --output /tmp/alpha5"


def options(parser: Parser) -> None:
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("demo"),
        metavar="FOLDER",
        help="folder to write into. Default: %(default)s",
    )


def run(given: Namespace) -> int:
    output: Path = given.output
    if is_stream(output):
        raise OutputError(output, "it is no folder")
    agree = _describe(output)
    _audit()
    solution = _solve()
    _compute(solution)
    page_name, *others = _draw(output, solution)

    made = ", ".join([page_name, *others])
    say(f"\nMade in {output}: alpha5.urdf, alpha5_jaws.urdf, meshes/, {made}.")
    say("In the page sliders move the arm, play runs a motion.")
    say(f"Open {output / page_name}")
    return 0 if agree else 1


def _describe(output: Path) -> bool:
    """Write both URDFs and their meshes; whether both agree with the tables."""
    say("1. Description: the document's tables become URDF")
    for name, content in mesh_assets(".obj", ".mtl", ".glb").items():
        atomic_write(output / "meshes" / name, content)

    agree = True
    files: dict[Gripper, str] = {"locked": "alpha5.urdf", "jaws": "alpha5_jaws.urdf"}
    for gripper, name in files.items():
        text = variants.urdf(variants.Variant(gripper=gripper, mesh_prefix="meshes/"))
        comparison = compare(atomic_write(output / name, text))
        say(f"   {name}: {comparison.verdict}")
        for found in comparison.findings:
            say(f"     {found.where}: {found.text}")
        agree &= comparison.agrees
    return agree


def _audit() -> None:
    rows = audit()
    say("2. The documents against themselves")
    say(f"   {audit_text.counts(rows)}")
    say("   The errors; `alpha5 check` says more:")

    errors = [
        row for row in rows if row.category == "error" and row.verdict != "agrees"
    ]
    for same_topic in audit_text.grouped(errors, lambda row: row.topic).values():
        say(f"     {_first_error(same_topic)}")


def _first_error(rows: Sequence[AuditRow]) -> str:
    first, *others = audit_text.alike(rows)
    more = sum(len(group) for group in others)
    hint = f" ({more} more like it)" if more else ""
    return audit_text.sentence(first) + hint


def _solve() -> FloatArray:
    """Print all solutions for `TARGET`; the one that is nearest to home."""
    arm = load()
    solutions = inverse_kinematics(TARGET)
    millimetres = ", ".join(f"{1e3 * coordinate:g}" for coordinate in TARGET)
    say(f"3. Inverse kinematics of the tcp at ({millimetres}) mm")

    rows = []
    branches = zip(BRANCHES, solutions.q, solutions.within_limits, strict=True)
    for branch, q, within in branches:
        error = abs(arm.forward_kinematics(q).translation - TARGET).max()
        angles = [f"{angle:.4f}" for angle in q]
        limits = "within limits" if within else "beyond limits"
        rows.append([branch, *angles, f"rad, {limits}, back to {error:.0e} m"])
    say(*table(rows, "<>>>><", 3))
    return solutions.best(srdf.named_pose("home"))


def _compute(q: FloatArray) -> None:
    water = load()
    air = load(fluid_density=0.0)
    density = f"{water.fluid_density:g} kg/m^3"
    say(f"4. Torque that holds the arm there, sea water ({density})")

    rows = [["joint", "weight", "buoyancy", "in water", "in air"], ["", *["N m"] * 4]]
    columns = (
        water.gravity_torque(q),
        water.buoyancy_torque(q),
        water.hydrostatic_torque(q),
        air.hydrostatic_torque(q),
    )
    for name, *row in zip(water.joint_names, *columns, strict=True):
        rows.append([name, *(f"{torque:z.4f}" for torque in row)])
    say(*table(rows, "<>", 3))


def _draw(output: Path, q: FloatArray) -> list[str]:
    """Write a page and a picture of the arm at a position of its turning joints.

    Returns:
        The names of the files.
    """
    say("5. Pictures")
    shown = _scene(q)
    image = picture_png(framed(shown, PICTURE_SIZE), PICTURE_SIZE)
    files: dict[str, str | bytes] = {
        "alpha5.html": static_page(shown),
        "alpha5.png": image,
    }
    for name, content in files.items():
        path = atomic_write(output / name, content)
        say(f"   {path} ({path.stat().st_size * 1e-6:.1f} MB)")
    return list(files)


def _scene(q: FloatArray) -> Scene:
    """The arm at the target, with a motion that goes there and opens the jaws."""
    arm = load(gripper="jaws")
    poses = named_poses(arm)
    closed = np.append(q, poses["home"][-1])
    opened = np.append(q, _OPENED)
    stops = [poses["stow"], poses["home"], closed, opened, closed, poses["stow"]]
    return build_scene(
        arm,
        closed,
        target=TARGET,
        motion=tour(stops, arm.parameters),
        show=("bodies", "labels", "com", "cob", "weight", "buoyancy", "workspace"),
    )
