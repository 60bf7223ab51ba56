"""The bodies of the MuJoCo model, with the buoyancy of Table 3.

MuJoCo has no hydrostatics, but it can compensate a body's weight: a body of mass m with
``gravcomp = k`` feels ``-k m g`` at its centre of mass. Each link therefore carries a
float, a child body at its centre of buoyancy: a ball of the displaced volume and of
`FLOAT_DENSITIES`, with ``gravcomp = fluid_density / float_density``. The float's mass
is taken out of the link, so that both together have the link's mass, centre of mass and
inertia. A float weighs grams, because scenes raise masses to the ``boundmass`` of their
compiler, and its force with them.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import permutations, product
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import Placement, quaternion_from_rpy
from alpha5_model.description.bodies import Body
from alpha5_model.description.digits import DIGITS, quaternion, rounded
from alpha5_model.description.mjcf_drag import ellipsoids
from alpha5_model.description.xml import Value, add
from alpha5_model.geometry.collision_shapes import Capsule
from alpha5_model.geometry.materials import material_of
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.hydrodynamics import BodyHydrodynamics
from alpha5_model.numbers.jaws import FingerJoint
from alpha5_model.numbers.motors import JointLosses
from alpha5_model.numbers.parameters import JointRange

#: Of a float [kg/m^3]: the first with which every link keeps a possible inertia. The
#: catalogue's arm has 250, so that each float weighs more than a gram.
FLOAT_DENSITIES = (250.0, 25.0, 2.5, 0.25, 0.025, 0.0025)
#: `gravcomp` in air [1]: MuJoCo leaves the floats out if none has any.
_IN_AIR = 1e-15
#: Rotations that differ by less, as a difference of traces, are equally near.
_SAME_TURN = 1e-9
#: Boxes and cylinders are given by half their lengths.
_HALVES = {"box": (0.5, 0.5, 0.5), "cylinder": (1.0, 0.5), "sphere": (1.0,)}


@dataclass(frozen=True, eq=False)
class Inertial:
    """Mass distribution of a body of MuJoCo.

    Attributes:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the centre of mass, (3, 3) [kg m^2].
    """

    mass: float
    com: FloatArray
    inertia: FloatArray

    def is_possible(self) -> bool:
        """Whether the mass and the moments are those of a body."""
        moments = np.linalg.eigvalsh(self.inertia)
        return self.mass > 0 and moments[0] > 0 and moments[:2].sum() > moments[2]


def float_of(body: Body, density: float) -> Inertial:
    """The float of a body: a ball of its displaced volume and of a density [kg/m^3]."""
    mass = density * body.volume
    radius = (3 * body.volume / (4 * math.pi)) ** (1 / 3)
    return Inertial(mass, body.cob, 0.4 * mass * radius**2 * np.eye(3))


def without(body: Body, part: Inertial) -> Inertial:
    """What is left of a body if a part of it is a body of its own."""
    mass = body.mass - part.mass
    if mass <= 0:
        return Inertial(mass, body.com, np.zeros((3, 3)))
    between = part.com - body.com
    apart = np.eye(3) * (between @ between) - np.outer(between, between)
    return Inertial(
        mass=mass,
        com=body.com - part.mass / mass * between,
        inertia=body.inertia - part.inertia - part.mass * body.mass / mass * apart,
    )


def float_density(bodies: Iterable[Body]) -> float:
    """Density of the floats of an arm, see `FLOAT_DENSITIES` [kg/m^3]."""
    floating = [body for body in bodies if body.volume > 0]
    for density in FLOAT_DENSITIES:
        rests = [without(body, float_of(body, density)) for body in floating]
        if all(rest.is_possible() for rest in rests):
            return density
    # MuJoCo refuses a body that is impossible by itself.
    return FLOAT_DENSITIES[-1]


def principal_axes(inertia: FloatArray) -> tuple[FloatArray, list[float]]:
    """Principal moments [kg m^2], and the quaternion (w, x, y, z) of their axes.

    Of the 24 rotations to principal axes it is the nearest to the body's own axes; of
    several that are equally near, the one whose first axis is nearest to x, and then
    the one whose second axis is nearest to y. Both have 12 digits.
    """
    _, axes = np.linalg.eigh(inertia)

    def nearness(rotation: FloatArray) -> tuple[float, ...]:
        parts = np.array([np.trace(rotation), *rotation.ravel()])
        return tuple(np.round(parts / _SAME_TURN).tolist())

    candidates = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            rotation = axes[:, order] * signs
            if np.linalg.det(rotation) > 0:
                candidates.append(rotation)
    nearest = max(candidates, key=nearness)
    return rounded(np.diag(nearest.T @ inertia @ nearest)), quaternion(nearest)


@dataclass(frozen=True, eq=False)
class BodyWriter:
    """Writes the tree of bodies.

    Attributes:
        fluid_density: [kg/m^3].
        float_density: Of the floats [kg/m^3]; None for a model without buoyancy.
        collisions: Adds the collision shapes.
        capsules: Link -> the capsule that takes the place of its shapes.
        water: Link -> its drag strips; empty for a model without drag by strips.
        losses: Joint -> what its motor adds, if it was measured.
    """

    fluid_density: float
    float_density: float | None
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
        own = Inertial(body.mass, body.com, body.inertia)
        density = self.float_density if body.volume > 0 else None
        if density is not None:
            own = without(body, float_of(body, density))

        if body.joint is None and self.float_density is None:
            _add_massive_box(element, own)
        else:
            _add_inertial(element, own)
        _add_visuals(element, body)
        if self.collisions:
            _add_collisions(element, body)
        if body.name in self.capsules:
            _add_capsule(element, self.capsules[body.name])
        self._add_drag(element, body)
        if density is not None:
            factor = gravcomp(self.fluid_density, density)
            _add_float(element, body, float_of(body, density), factor)
        return element

    def _add_drag(self, element: ET.Element, body: Body) -> None:
        """Ellipsoids for the strips; a body without strips must not drag either."""
        if body.name in self.water:
            for strip in self.water[body.name].strips:
                for ellipsoid in ellipsoids(strip):
                    add(element, "geom", "strip", **ellipsoid)
        elif self.water:
            add(element, "geom", "no_drag")


def gravcomp(fluid_density: float, float_density: float) -> float:
    """Compensation by which a float has the buoyancy of its link, not its own weight.

    The float's weight stays: it is a part of the link's.
    """
    return _fifteen_digits(fluid_density / float_density) or _IN_AIR


def _fifteen_digits(values: Any) -> Any:
    """Numbers without the noise of a difference or quotient.

    Such are the same on every processor, so that they need not be `rounded`.
    """
    if isinstance(values, float):
        return float(f"{values:.15g}")
    return [float(f"{value:.15g}") for value in values]


def _add_inertial(element: ET.Element, own: Inertial) -> None:
    # MuJoCo 3.5 finds axes from a full tensor to about 4e-10 kg m^2 only.
    moments, axes = principal_axes(own.inertia)
    add(
        element,
        "inertial",
        pos=_fifteen_digits(own.com),
        quat=axes,
        mass=_fifteen_digits(own.mass),
        diaginertia=moments,
    )


def _add_massive_box(element: ET.Element, own: Inertial) -> None:
    """A box with mass, centre and moments of a body.

    brax merges a body without a joint into the world, which must not have an inertial.
    """
    moments, axes = principal_axes(own.inertia)
    squares = 1.5 / own.mass * (moments.sum() - 2.0 * moments)
    add(
        element,
        "geom",
        contype="0",
        conaffinity="0",
        type="box",
        size=[float(rounded(math.sqrt(square))) for square in squares],
        group="4",
        pos=_fifteen_digits(own.com),
        quat=axes,
        mass=_fifteen_digits(own.mass),
    )


def _add_float(
    element: ET.Element, body: Body, floating: Inertial, factor: float
) -> None:
    """The float, a body that is fixed in the link's at its centre of buoyancy."""
    child = add(
        element,
        "body",
        name=f"{body.name}_buoyancy",
        pos=floating.com,
        gravcomp=factor,
    )
    add(
        child,
        "inertial",
        pos="0 0 0",
        mass=_fifteen_digits(floating.mass),
        diaginertia=rounded(np.diag(floating.inertia)),
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
