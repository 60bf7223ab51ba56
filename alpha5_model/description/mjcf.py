"""MuJoCo: a folder in the style of MuJoCo Menagerie, with the buoyancy of Table 3.

MuJoCo has no hydrostatics, but it can compensate a body's weight: a body of mass m with
``gravcomp = k`` feels ``-k m g`` at its centre of mass. Each link therefore carries, at its centre of
buoyancy, a child body without inertia whose mass is the displaced volume over `DILUTION`; with
``gravcomp = fluid_density * DILUTION + 1`` its own weight is cancelled and the weight of the displaced
fluid added, upwards. The mass matrix changes by less than 1e-13 kg m^2.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies import Body, Mesh, arm_bodies, provenance
from alpha5_model.description.frames import Placement, base_placement, tcp_placement
from alpha5_model.description.mesh_assets import mesh_assets
from alpha5_model.description.mjcf_control import (
    add_actuators,
    add_equality,
    add_keyframes,
)
from alpha5_model.description.mjcf_options import MjcfOptions
from alpha5_model.description.mjcf_texts import SCENE, mjcf_readme
from alpha5_model.description.number_text import numbers_text
from alpha5_model.description.poses import (
    ADJACENT_PAIRS,
    CLOSING_PAIRS,
    NEVER_PAIRS,
)
from alpha5_model.fluids import GRAVITY
from alpha5_model.jaws import FingerJoint
from alpha5_model.meshing.materials import MATERIALS
from alpha5_model.meshing.primitive import Primitive
from alpha5_model.parameters import parameters

#: Displaced volume over mass of a buoyancy body [m^3/kg]: large enough not to be felt, small enough to
#: keep every mass above the least that MuJoCo knows, 1e-15 kg.
DILUTION = 1e9
#: Dynamic viscosity of sea water at 20 C for MuJoCo's drag [Pa s] [ITTC 7.5-02-01-03].
VISCOSITY = 1.08e-3


def mjcf_files(options: MjcfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``alpha5.xml`` (the model), ``scene.xml`` (with light and sea bed), ``assets/`` (meshes), ``README.md``.

    Raises:
        Alpha5Error: See `MjcfOptions`.
    """
    chosen = options or MjcfOptions()
    assets = mesh_assets(".obj")
    return {
        "alpha5.xml": mjcf(chosen, assets).encode(),
        "scene.xml": SCENE.encode(),
        "README.md": mjcf_readme(chosen, DILUTION).encode(),
        **{f"assets/{name}": data for name, data in assets.items()},
    }


def mjcf(options: MjcfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``assets/``; others are left out.
    """
    chosen = options or MjcfOptions()
    values = parameters(chosen.corrections)
    bodies = arm_bodies(values, chosen.gripper)
    files = {name.removesuffix(".obj") for name in meshes}
    shown = [mesh for body in bodies for mesh in body.meshes if mesh.name in files]
    joints = [body.joint for body in bodies if body.joint is not None]

    root = ET.Element("mujoco", model="alpha5")
    source = provenance(values)
    root.append(ET.Comment(f" Generated from: {source['document']}. "))
    root.append(ET.Comment(f" By: {source['package']}. Corrections: {source['corrections']}. "))
    ET.SubElement(
        root,
        "compiler",
        # Capital letters are rotations about fixed axes: URDF's roll, pitch, yaw, digit for digit.
        {"angle": "radian", "eulerseq": "XYZ", "autolimits": "true", "meshdir": "assets"},
    )
    fluid = {"density": numbers_text(chosen.fluid_density), "viscosity": numbers_text(VISCOSITY)}
    if chosen.drag:
        root.append(ET.Comment(" Density and viscosity: MuJoCo's drag, not from the document. "))
    ET.SubElement(
        root,
        "option",
        {
            "integrator": "implicitfast",
            "gravity": numbers_text(*GRAVITY),
            **(fluid if chosen.drag else {}),
        },
    )
    _defaults(root)
    _assets(root, shown)
    _worldbody(root, values, bodies, files, chosen)
    if chosen.collision == "primitives" and any(body.shapes for body in bodies):
        _contact(root, bodies)
    if chosen.gripper == "jaws":
        add_equality(root, joints)
    add_actuators(root, joints, chosen.actuators)
    add_keyframes(root, joints, chosen.actuators)
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def _defaults(root: ET.Element) -> None:
    top = ET.SubElement(ET.SubElement(root, "default"), "default", {"class": "alpha5"})
    visual = ET.SubElement(top, "default", {"class": "visual"})
    ET.SubElement(
        visual, "geom", type="mesh", contype="0", conaffinity="0", group="2", mass="0", density="0"
    )
    collision = ET.SubElement(top, "default", {"class": "collision"})
    ET.SubElement(collision, "geom", group="3", mass="0")
    # Without a geom of its own, MuJoCo's drag would take a buoyancy body for a box of decimetres.
    no_drag = ET.SubElement(top, "default", {"class": "no_drag"})
    ET.SubElement(
        no_drag,
        "geom",
        {
            "type": "sphere",
            "size": "1e-6",
            "fluidshape": "ellipsoid",
            "fluidcoef": "0 0 0 0 0",
            "contype": "0",
            "conaffinity": "0",
            "group": "4",
            "mass": "0",
        },
    )


def _assets(root: ET.Element, shown: list[Mesh]) -> None:
    asset = ET.SubElement(root, "asset")
    for material in MATERIALS:
        rgba, metallic = numbers_text(*material.rgba), numbers_text(material.metallic)
        roughness = numbers_text(material.roughness)
        ET.SubElement(
            asset,
            "material",
            name=material.name,
            rgba=rgba,
            metallic=metallic,
            roughness=roughness,
        )
    for mesh in shown:
        ET.SubElement(asset, "mesh", name=mesh.name, file=f"{mesh.name}.obj")


def _worldbody(
    root: ET.Element, values: Any, bodies: tuple[Body, ...], files: set[str], options: MjcfOptions
) -> None:
    world = ET.SubElement(root, "worldbody")
    base = ET.SubElement(world, "body", {"name": "base_link", "childclass": "alpha5"})
    elements = {base_placement(values).parent: base}
    for body in bodies:
        element = ET.SubElement(
            elements[body.placement.parent], "body", {"name": body.name, **_pose(body.placement)}
        )
        elements[body.name] = element
        if body.joint is not None:
            attributes = {"name": body.joint.name, "axis": "0 0 1"}
            attributes["type"] = "hinge" if body.joint.kind == "revolute" else "slide"
            if not isinstance(
                body.joint, FingerJoint
            ):  # limits of a follower would fight its equality
                attributes["range"] = numbers_text(body.joint.lower, body.joint.upper)
            ET.SubElement(element, "joint", attributes)
        moments, quaternion = _principal(body.inertia)
        ET.SubElement(
            element,
            "inertial",
            pos=numbers_text(*body.com),
            quat=numbers_text(*quaternion),
            mass=numbers_text(body.mass),
            diaginertia=numbers_text(*moments),
        )
        for mesh in body.meshes:
            if mesh.name in files:
                _visual(element, mesh)
        if options.collision == "primitives":
            for shape in body.shapes:
                _collision(element, shape)
        if body.volume > 0:
            _buoyancy(element, body, options)
    tip = tcp_placement(values)
    ET.SubElement(
        elements[tip.parent], "site", {"name": "tcp", "size": "0.005", "group": "4", **_pose(tip)}
    )


def _visual(element: ET.Element, mesh: Mesh) -> None:
    pose = _pose(mesh.placement)
    attributes = {"class": "visual", "mesh": mesh.name, "material": mesh.material.name, **pose}
    ET.SubElement(element, "geom", attributes)


def _collision(element: ET.Element, shape: Primitive) -> None:
    # Boxes and cylinders are given by half their lengths.
    halves = {
        "box": (0.5, 0.5, 0.5),
        "cylinder": (1.0, 0.5),
        "sphere": (1.0,),
        "capsule": (1.0, 0.5),
    }
    size = numbers_text(*(s * h for s, h in zip(shape.size, halves[shape.kind], strict=True)))
    pose = _pose(shape)
    ET.SubElement(element, "geom", {"class": "collision", "type": shape.kind, "size": size, **pose})


def _buoyancy(element: ET.Element, body: Body, options: MjcfOptions) -> None:
    compensation = options.fluid_density * DILUTION + 1.0
    child = ET.SubElement(
        element,
        "body",
        name=f"{body.name}_buoyancy",
        pos=numbers_text(*body.cob),
        gravcomp=numbers_text(compensation),
    )
    mass = numbers_text(body.volume / DILUTION)
    ET.SubElement(child, "inertial", pos="0 0 0", mass=mass, diaginertia="0 0 0")
    if options.drag:
        ET.SubElement(child, "geom", {"class": "no_drag"})


def _contact(root: ET.Element, bodies: tuple[Body, ...]) -> None:
    contact = ET.SubElement(root, "contact")
    names = {body.name for body in bodies}
    for one, other in (*ADJACENT_PAIRS, *CLOSING_PAIRS, *NEVER_PAIRS):
        if {one, other} <= names:
            ET.SubElement(contact, "exclude", body1=one, body2=other)


def _principal(inertia: FloatArray) -> tuple[list[float], list[float]]:
    """Principal moments [kg m^2] and the quaternion (w, x, y, z) of their axes in the body.

    MuJoCo 3.5 finds them from a full tensor to about 4e-10 kg m^2 only.
    """
    moments, axes = np.linalg.eigh(inertia)
    r = axes if np.linalg.det(axes) > 0 else -axes
    # Of the four expressions for the quaternion, the one with the largest component [Shepperd1978].
    squares = np.array([np.trace(r), *np.diag(r)])
    outer = np.empty((4, 4))
    outer[0, 0] = 1 + np.trace(r)
    outer[0, 1:] = outer[1:, 0] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    outer[1:, 1:] = r + r.T + (1 - np.trace(r)) * np.eye(3)
    quaternion = outer[np.argmax(squares)]
    unit = quaternion / np.linalg.norm(quaternion)
    return moments.tolist(), (unit if unit[0] >= 0 else -unit).tolist()


def _pose(placement: Placement | Primitive) -> dict[str, str]:
    pose = {"pos": placement.xyz, "euler": placement.rpy}
    return {name: numbers_text(*values) for name, values in pose.items() if any(values)}
