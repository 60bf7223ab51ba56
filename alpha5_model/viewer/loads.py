"""What acts on the bodies of an arm: weight, buoyancy, and drag of a current."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import displaced_fluid_model
from alpha5_model.numbers.hydrodynamics import WATER_DENSITY, DragStrip, hydrodynamics
from alpha5_model.viewer.scene import Load, Stream, StripDrag


def loads_of(arm: Arm, tree: Sequence[UrdfJoint]) -> Iterator[Load]:
    """Weight and buoyancy on each joint of the arm's model, payloads included."""
    base = tree[0].parent
    carrier = {joint.name: joint.child for joint in tree}
    strength = float(np.linalg.norm(arm.model.gravity.linear))
    # With a fluid of density 1 the masses of the displaced fluid are volumes.
    water = displaced_fluid_model(arm.model, arm.displacements, 1.0)
    bodies = zip(arm.model.names, arm.model.inertias, water.inertias, strict=True)
    for joint, body, fluid in bodies:
        if not (body.mass or fluid.mass):
            continue
        yield Load(
            # Bodies of the universe and of the free-flyer belong to the base.
            link=carrier.get(joint, base),
            mass=body.mass,
            com=body.lever.copy(),
            volume=fluid.mass,
            cob=fluid.lever.copy(),
            weight=strength * body.mass,
            buoyancy=strength * arm.fluid_density * fluid.mass,
        )


def streams_of(arm: Arm, level: str) -> Iterator[Stream]:
    """Added mass and drag of each link, per density, at a level of the estimates."""
    for link, water in hydrodynamics(arm.gripper, level).items():
        strips = [_strip_drag(strip) for strip in water.strips]
        added_mass = water.added_mass[:3, :3] / WATER_DENSITY
        yield Stream(link=link, strips=tuple(strips), added_mass=added_mass)


def _strip_drag(strip: DragStrip) -> StripDrag:
    line = strip.end - strip.start
    length = float(np.linalg.norm(line))
    drag_area = strip.diameter * length / 2
    return StripDrag(
        middle=(strip.start + strip.end) / 2,
        axis=line / length,
        across=drag_area * strip.across,
        along=drag_area * strip.along,
    )
