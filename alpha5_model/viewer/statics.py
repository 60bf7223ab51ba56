"""Numbers for the torques on the page: weight, buoyancy and current on bodies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import regrouped
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import displaced_fluid_model
from alpha5_model.numbers.hydrodynamics import WATER_DENSITY, DragStrip, hydrodynamics
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.viewer.scene import Load, Statics, Stream, StripDrag


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


def statics_of(arm: Arm, loads: Sequence[Load], base: str) -> Statics:
    """Numbers from which the page computes the torque that holds the arm still.

    Args:
        arm: The arm.
        loads: Weight and buoyancy of its bodies.
        base: Name of its base link.
    """
    links = [base, *(f"link_{i}" for i in range(1, 5))]
    moments = np.zeros((5, 2, 4, 4))
    beyond = []
    for load in loads:
        displaced = arm.fluid_density * load.volume * np.append(load.cob, 1.0)
        net = load.mass * np.append(load.com, 1.0) - displaced
        if load.link in links:
            moments[links.index(load.link), 1, :, 3] += net
        else:
            beyond.append((load.link, net))
    return Statics(
        parameters=regrouped(moments, arm.model.gravity.linear, arm.parameters),
        share=_share_of_link_4(arm.parameters),
        beyond=tuple(beyond),
    )


def _share_of_link_4(parameters: Alpha5Parameters) -> FloatArray:
    """Derivatives of the base parameters for a body in link_4, (41, 4).

    They are taken with respect to its first moment and mass.
    """
    units = np.zeros((4, 5, 2, 4, 4))
    for component in range(4):
        units[component, 4, 1, component, 3] = 1.0
    columns = [regrouped(unit, np.zeros(3), parameters) for unit in units]
    return np.stack(columns, axis=-1)


def streams_of(arm: Arm) -> Iterator[Stream]:
    """Added mass and drag of each link, at the arm's fluid density."""
    gripper = "jaws" if "axis_a" in arm.joint_names else "locked"
    for link, water in hydrodynamics(gripper).items():
        strips = [_strip_drag(strip, arm.fluid_density) for strip in water.strips]
        translations = water.added_mass[:3, :3]
        added_mass = translations * (arm.fluid_density / WATER_DENSITY)
        yield Stream(link=link, strips=tuple(strips), added_mass=added_mass)


def _strip_drag(strip: DragStrip, fluid_density: float) -> StripDrag:
    line = strip.end - strip.start
    length = float(np.linalg.norm(line))
    drag_area = fluid_density / 2 * strip.diameter * length
    return StripDrag(
        middle=(strip.start + strip.end) / 2,
        axis=line / length,
        across=drag_area * strip.across,
        along=drag_area * strip.along,
    )
