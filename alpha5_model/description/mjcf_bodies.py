"""The bodies of the MuJoCo model, with the buoyancy of Table 3.

MuJoCo has no hydrostatics, but it can compensate a body's weight: a body of mass m with
``gravcomp = k`` feels ``-k m g`` at its centre of mass. Each link therefore carries, at
its centre of buoyancy, a child body whose mass is the displaced volume over `DILUTION`;
with ``gravcomp = fluid_density * DILUTION + 1`` its own weight is cancelled and the
weight of the displaced fluid added, upwards. The mass matrix changes by less than 1e-13
kg m^2. The child needs some `INERTIA` for the simulator Newton, which is subtracted
from the link's.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from alpha5_model._support.spatial import Placement, quaternion_from_rpy
from alpha5_model.description.bodies import Body
from alpha5_model.description.digits import DIGITS, rounded
from alpha5_model.description.mjcf_drag import ellipsoids
from alpha5_model.description.principal_axes import principal_axes
from alpha5_model.description.xml import Value, add
from alpha5_model.geometry.collision_capsules import Capsule
from alpha5_model.geometry.materials import material_of
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.hydrodynamics import BodyHydrodynamics
from alpha5_model.numbers.jaws import FingerJoint
from alpha5_model.numbers.motors import JointLosses
from alpha5_model.numbers.parameters import JointRange

#: Displaced volume over mass of a buoyancy body [m^3/kg]. It is large, so that the mass
#: is negligible, and still keeps every mass above MuJoCo's least, 1e-15 kg.
DILUTION = 1e9
#: Moment of inertia of a buoyancy body [kg m^2]. The simulator Newton replaces moments
#: below 1e-10 by 1e-6.
INERTIA = 2e-10
#: Boxes and cylinders are given by half their lengths.
_HALVES = {"box": (0.5, 0.5, 0.5), "cylinder": (1.0, 0.5), "sphere": (1.0,)}


@dataclass(frozen=True, eq=False)
class BodyWriter:
    """Writes the tree of bodies.

    Attributes:
        fluid_density: [kg/m^3].
        buoyancy: Adds the buoyancy bodies.
        collisions: Adds the collision shapes.
        capsules: Link -> the capsule that takes the place of its shapes.
        water: Link -> its drag strips; empty for a model without drag by strips.
        losses: Joint -> what its motor adds, if it was measured.
    """

    fluid_density: float
    buoyancy: bool
    collisions: bool
    capsules: Mapping[str, Capsule]
    water: Mapping[str, BodyHydrodynamics]
    losses: Mapping[str, JointLosses]

    def add_worldbody(
        self,
        root: ET.Element,
        bodies: Iterable[Body],
        tcp: Placement,
        mount: Placement | None,
    ) -> None:
        """Add base_link on its mount, the bodies that it carries, and the TCP."""
        world = add(root, "worldbody")
        base = _add_base(world, mount)
        elements = {"base_link": base}
        for body in bodies:
            parent = elements[body.placement.parent]
            elements[body.name] = self._add_body(parent, body)
        add(
            elements[tcp.parent],
            "site",
            name="tcp",
            size="0.005",
            group="4",
            **_pose(tcp),
        )

    def _add_body(self, parent: ET.Element, body: Body) -> ET.Element:
        element = add(parent, "body", name=body.name, **_pose(body.placement))
        if body.joint is not None:
            _add_joint(element, body.joint, self.losses.get(body.joint.name))
        self._add_inertial(element, body)
        _add_visuals(element, body)
        if self.collisions:
            _add_collisions(element, body)
        if body.name in self.capsules:
            _add_capsule(element, self.capsules[body.name])
        self._add_drag(element, body)
        if self._floats(body):
            self._add_buoyancy(element, body)
        return element

    def _floats(self, body: Body) -> bool:
        """Whether it has a buoyancy body."""
        return self.buoyancy and body.volume > 0

    def _add_inertial(self, element: ET.Element, body: Body) -> None:
        # MuJoCo 3.5 finds them from a full tensor to about 4e-10 kg m^2 only.
        moments, axes = principal_axes(body.inertia)
        inertial: dict[str, Value] = {
            "pos": body.com,
            "quat": axes,
            "mass": body.mass,
        }
        if body.joint is None and not self.buoyancy:
            # brax merges a body without a joint into the world, which must not have an
            # inertial. A box of the same mass and moments takes its place.
            squares = 1.5 / body.mass * (moments.sum() - 2.0 * moments)
            sizes = [float(rounded(math.sqrt(square))) for square in squares]
            add(
                element,
                "geom",
                contype="0",
                conaffinity="0",
                type="box",
                size=sizes,
                group="4",
                **inertial,
            )
            return
        if self._floats(body):
            moments = rounded(moments - INERTIA)
        add(element, "inertial", **inertial, diaginertia=moments)

    def _add_drag(self, element: ET.Element, body: Body) -> None:
        """Ellipsoids for the strips; a body without strips must not drag either."""
        if body.name in self.water:
            for strip in self.water[body.name].strips:
                for ellipsoid in ellipsoids(strip):
                    add(element, "geom", "strip", **ellipsoid)
        elif self.water:
            add(element, "geom", "no_drag")

    def _add_buoyancy(self, element: ET.Element, body: Body) -> None:
        child = add(
            element,
            "body",
            name=f"{body.name}_buoyancy",
            pos=body.cob,
            gravcomp=self.fluid_density * DILUTION + 1.0,
        )
        add(
            child,
            "inertial",
            pos="0 0 0",
            mass=float(rounded(body.volume / DILUTION)),
            diaginertia=[INERTIA] * 3,
        )
        add(child, "geom", "no_drag")


def _add_base(world: ET.Element, mount: Placement | None) -> ET.Element:
    """Add base_link: to the parent of the mount, which is a body, or to the world."""
    carrier = world
    pose: dict[str, Value] = {}
    if mount is not None:
        pose = _pose(mount)
        if mount.parent != "world":
            carrier = add(world, "body", name=mount.parent)
    return add(carrier, "body", name="base_link", childclass="alpha5", **pose)


def _add_joint(
    element: ET.Element, joint: JointRange, losses: JointLosses | None
) -> None:
    limits = (joint.lower, joint.upper)
    of_motor: dict[str, Value] = {}
    if losses is not None:
        of_motor = {
            "armature": losses.armature,
            "frictionloss": losses.friction,
            "damping": losses.damping,
        }
    add(
        element,
        "joint",
        name=joint.name,
        axis="0 0 1",
        type="hinge" if joint.kind == "revolute" else "slide",
        # A finger follows the rod by an equality, with which own limits would conflict.
        range=None if isinstance(joint, FingerJoint) else limits,
        **of_motor,
    )


def _add_visuals(element: ET.Element, body: Body) -> None:
    for mesh, placement in body.meshes.items():
        material = material_of(mesh).name
        pose = _pose(placement)
        add(element, "geom", "visual", mesh=mesh, material=material, **pose)


def _add_collisions(element: ET.Element, body: Body) -> None:
    for shape in body.shapes:
        halves = _HALVES[shape.kind]
        size = [length * half for length, half in zip(shape.size, halves, strict=True)]
        pose = _pose(shape)
        add(element, "geom", "collision", type=shape.kind, size=size, **pose)


def _add_capsule(element: ET.Element, capsule: Capsule) -> None:
    add(
        element,
        "geom",
        "collision",
        type="capsule",
        fromto=(*capsule.start, *capsule.end),
        size=capsule.radius,
    )


def _pose(placement: Placement | Primitive) -> dict[str, Value]:
    """Attributes ``pos`` and ``quat``; None instead of a zero translation or rotation.

    ``euler`` is avoided, because some readers take its angles in another order.
    """
    x, y, z, w = quaternion_from_rpy(placement.rpy)
    moved = any(placement.xyz)
    turned = any(placement.rpy)
    return {
        "pos": placement.xyz if moved else None,
        "quat": rounded([w, x, y, z], largest_digits=DIGITS) if turned else None,
    }
