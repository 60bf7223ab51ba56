"""``alpha5 demo``: describe, check, solve, compute and draw the arm in one run."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Annotated

import numpy as np
from typer import Option

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import atomic_write, is_stream
from alpha5_model._support.text import table
from alpha5_model.cli.options import say
from alpha5_model.cli.proofs import alike, documents, sentence
from alpha5_model.description import srdf, verification
from alpha5_model.description import urdf as variants
from alpha5_model.description.bodies import mesh_assets
from alpha5_model.dynamics.load import load
from alpha5_model.errors import OutputError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.proofs.audit.run import audit
from alpha5_model.viewer import build, page, picture, scene

#: A point that all four branches reach within the limits, in base_link [m].
TARGET = (0.06, 0.05, 0.36)


def demo(
    output: Annotated[Path, Option(help="Folder to write into.")] = Path("demo"),
) -> int:
    """Generate the arm, check it, solve it, compute with water, and draw it.

    Example: alpha5 demo --output /tmp/alpha5
    """
    if is_stream(output):
        raise OutputError(output, "it is no folder")
    passed = _describe(output)
    _audit()
    solution = _solve()
    _compute(solution)
    made = _show(output, solution)
    say(
        f"\nMade in {output}: alpha5.urdf, alpha5_jaws.urdf, meshes/, {', '.join(made)}."
    )
    say(
        "In the page sliders move the arm, play runs a motion.",
        f"Open {output / made[0]}",
    )
    return 0 if passed else 1


def _describe(output: Path) -> bool:
    say("1. Description: the document's tables become URDF")
    for name, content in mesh_assets(".obj", ".mtl", ".glb").items():
        atomic_write(output / "meshes" / name, content)
    failed = 0
    for gripper, name in (("locked", "alpha5.urdf"), ("jaws", "alpha5_jaws.urdf")):
        text = variants.urdf(variants.Variant(gripper=gripper, mesh_prefix="meshes/"))
        rows = verification.verify_urdf(atomic_write(output / name, text))
        count = Counter(row.verdict.replace("failed", "FAILED") for row in rows)
        found = ", ".join(f"{n} {verdict}" for verdict, n in count.items())
        say(f"   {name}: checks against the tables: {found}")
        for row in rows:
            if row.verdict == "failed":
                say(f"     {row.check}: {row.finding}")
            if row.measured is not None:
                off = f"{row.measured:.1e} {row.unit}".rstrip()
                say(f"     {row.check}: off by {off} at most")
        failed += count["FAILED"]
    return not failed


def _audit() -> None:
    rows = audit()
    errors = [
        row for row in rows if row.category == "error" and row.verdict != "agrees"
    ]
    say("2. The documents against themselves")
    say(f"   {documents(rows)}")
    say("   The errors; `alpha5 check` says more:")
    for topic in dict.fromkeys(row.topic for row in errors):
        same, *others = alike(row for row in errors if row.topic == topic)
        more = sum(map(len, others))
        say(f"     {sentence(same)}" + (f" ({more} more like it)" if more else ""))


def _solve() -> FloatArray:
    arm = load()
    solutions = inverse_kinematics(TARGET)
    x, y, z = (1e3 * c for c in TARGET)
    say(f"3. Inverse kinematics of the tcp at ({x:g}, {y:g}, {z:g}) mm")
    rows = []
    for i, (branch, q) in enumerate(zip(BRANCHES, solutions.q, strict=True)):
        error = abs(arm.forward_kinematics(q).translation - TARGET).max()
        said = f"{'within' if solutions.within_limits[i] else 'beyond'} limits"
        angles = (f"{angle:.4f}" for angle in q)
        rows.append([branch, *angles, f"rad, {said}, back to {error:.0e} m"])
    say(*table(rows, "<>>>><", 3))
    return solutions.best(srdf.named_pose("home"))


def _compute(q: FloatArray) -> None:
    water, air = load(), load(fluid_density=0.0)
    say(
        f"4. Torque that holds the arm there, sea water ({water.fluid_density:g} kg/m^3)"
    )
    rows = [["joint", "weight", "buoyancy", "in water", "in air"], ["", *["N m"] * 4]]
    weight, lift = water.gravity_torque(q), water.buoyancy_torque(q)
    columns = (weight, lift, water.hydrostatic_torque(q), air.hydrostatic_torque(q))
    for name, *row in zip(water.joint_names, *columns, strict=True):
        rows.append([name, *(f"{x:z.4f}" for x in row)])
    say(*table(rows, "<>", 3))


def _show(output: Path, q: FloatArray) -> list[str]:
    say("5. Pictures")
    arm = load(gripper="jaws")
    poses = build.named_poses(arm)
    there, opened = (
        np.append(q, poses["home"][-1]),
        np.append(q, 0.008),
    )  # last is axis_a
    motion = build.tour(
        [poses["stow"], poses["home"], there, opened, there, poses["stow"]]
    )
    show = ("bodies", "labels", "com", "cob", "weight", "buoyancy", "workspace")
    shown = build.build_scene(arm, there, target=TARGET, motion=motion, show=show)
    size = (1400, 1000)
    image = picture.picture_png(scene.framed(shown, size), size)
    made: dict[str, str | bytes] = {
        "alpha5.html": page.static_page(shown),
        "alpha5.png": image,
    }
    for name, content in made.items():
        path = atomic_write(output / name, content)
        say(f"   {path} ({path.stat().st_size / 1e6:.1f} MB)")
    return [*made]
