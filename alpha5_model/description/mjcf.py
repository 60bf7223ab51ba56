"""MuJoCo: a folder in the style of MuJoCo Menagerie, with the buoyancy of Table 3.

MuJoCo has no hydrostatics, but it can compensate a body's weight: a body of mass m with
``gravcomp = k`` feels ``-k m g`` at its centre of mass. Each link therefore carries, at its centre of
buoyancy, a child body whose mass is the displaced volume over `DILUTION`; with
``gravcomp = fluid_density * DILUTION + 1`` its own weight is cancelled and the weight of the displaced
fluid added, upwards. The mass matrix changes by less than 1e-13 kg m^2: the child's `INERTIA`, which
Newton wants, is taken off the link.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, flag
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.spatial import Placement, quaternion_from_rpy
from alpha5_model.description.assets import mesh_assets, template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.frames import tcp_placement
from alpha5_model.description.origin import provenance
from alpha5_model.description.srdf import NAMED_POSES, UNCHECKED_PAIRS
from alpha5_model.description.urdf import COLLISIONS
from alpha5_model.description.xml import Value, add, document, serialized
from alpha5_model.errors import InputError
from alpha5_model.geometry.materials import MATERIALS, material_of
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, density_of
from alpha5_model.numbers.hydrodynamics import DragStrip, hydrodynamics
from alpha5_model.numbers.jaws import GRIPPERS, FingerJoint
from alpha5_model.numbers.parameters import JointRange, parameters

ACTUATORS = ("position", "velocity", "motor")
BUOYANCIES = ("bodies", "none")
#: Servo stiffness [N m/rad, N/m]: tuned, not from the document.
_STIFFNESS = {
    "axis_e": 200.0,
    "axis_d": 200.0,
    "axis_c": 200.0,
    "axis_b": 5.0,
    "axis_a": 500.0,
}
#: MuJoCo would take the critical damping of the rod from the rod alone; the fingers weigh more [N s/m].
_ROD_DAMPING = 8.0
#: Displaced volume over mass of a buoyancy body [m^3/kg]: large enough not to be felt, small enough to
#: keep every mass above the least that MuJoCo knows, 1e-15 kg.
DILUTION = 1e9
#: Moment of inertia of a buoyancy body [kg m^2]: Newton replaces any below 1e-10 by 1e-6.
INERTIA = 2e-10
#: Dynamic viscosity of sea water at 20 C for MuJoCo's drag [Pa s] [ITTC 7.5-02-01-03].
VISCOSITY = 1.08e-3
#: Boxes and cylinders are given by half their lengths.
_HALVES = {"box": (0.5, 0.5, 0.5), "cylinder": (1.0, 0.5), "sphere": (1.0,)}
_UNTOUCHED = {"contype": "0", "conaffinity": "0"}
#: Pieces of a strip in MuJoCo; radii of their ellipsoids over their length, so small that no added mass is felt.
_PIECES, _FLAT_RADIUS, _NEEDLE_RADIUS = 4, 0.1, 0.02
#: Half axes of the flat ellipsoid, one over the other, and the best share of ``sin x cos x`` in ``sin^2 x cos x``
#: over directions from all around, 15 pi / 64.
_FLATNESS, _LIFT = 0.8, 15 * np.pi / 64


@dataclass(frozen=True)
class MjcfOptions:
    """What can be chosen about the MuJoCo model.

    Attributes:
        gripper: ``locked`` or ``jaws``.
        fluid_density: [kg/m^3]; 0 is air. Adjustable at run time too, see the folder's README.
        actuators: ``position``, ``velocity`` or ``motor``.
        drag: Turns MuJoCo's own fluid model on. Its forces are not from the document.
        collision: ``primitives`` or ``none``.
        buoyancy: ``bodies``, or ``none`` for tools without ``gravcomp``, such as brax.
        corrections: Recorded corrections to apply.
        hydrodynamics: Adds drag by strips, which is estimated, not published; instead of ``drag``.
    """

    gripper: str = "locked"
    fluid_density: float = SEA_WATER
    actuators: str = "position"
    drag: bool = False
    collision: str = "primitives"
    buoyancy: str = "bodies"
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    hydrodynamics: bool = False

    def __post_init__(self) -> None:
        flag("hydrodynamics", self.hydrodynamics)
        if self.drag and self.hydrodynamics:
            raise InputError("drag", self.drag, "hydrodynamics or drag, not both")
        choice("gripper", self.gripper, GRIPPERS)
        choice("actuators", self.actuators, ACTUATORS)
        choice("collision", self.collision, COLLISIONS)
        choice("buoyancy", self.buoyancy, BUOYANCIES)
        density_of(self.fluid_density)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))


def mjcf_files(options: MjcfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``alpha5.xml`` (the model), ``scene.xml`` (with light and sea bed), ``assets/`` (meshes), ``README.md``,
    ``CHANGELOG.md``, ``LICENSE``.

    Raises:
        Alpha5Error: See `MjcfOptions`.
    """
    chosen = options or MjcfOptions()
    assets = mesh_assets(".obj")
    return {
        "alpha5.xml": mjcf(chosen, assets).encode(),
        "scene.xml": template("scene.xml").encode(),
        "README.md": _readme(chosen).encode(),
        "CHANGELOG.md": template("mjcf_changelog.md").encode(),
        "LICENSE": (Path(REPOSITORY_PATH) / "LICENSE").read_bytes(),
        **{f"assets/{name}": data for name, data in assets.items()},
    }


def _readme(options: MjcfOptions) -> str:
    source = provenance(parameters(options.corrections))
    drag = (
        "estimated strips" if options.hydrodynamics else "on" if options.drag else "off"
    )
    water = template("mjcf_moving_water.md") if options.hydrodynamics else ""
    jaws = template(f"mjcf_gripper_{options.gripper}.md").rstrip()
    said = {
        **vars(options),
        **source,
        "drag": drag,
        "moving_water": water,
        "jaws": jaws,
    }
    dilution = f"{DILUTION:.0e}".replace("+0", "")
    return template("mjcf_readme.md").format(**said, inertia=INERTIA, dilution=dilution)


def mjcf(options: MjcfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``assets/``; others are left out.
    """
    chosen = options or MjcfOptions()
    values = parameters(chosen.corrections)
    bodies = arm_bodies(values, chosen.gripper, meshes)
    joints = [body.joint for body in bodies if body.joint is not None]
    root = document(values, "mujoco", model="alpha5")
    compiler, visual, defaults = ET.fromstring(template("model.xml"))
    root.append(compiler)
    fluid: dict[str, Value] = {}
    if chosen.drag:
        root.append(
            ET.Comment(" Density and viscosity: MuJoCo's drag, not from the document. ")
        )
        fluid = {"density": chosen.fluid_density, "viscosity": VISCOSITY}
    if chosen.hydrodynamics:
        root.append(
            ET.Comment(" Density: drag of the strips, estimated, not published. ")
        )
        fluid = {"density": chosen.fluid_density}
    # Alike without forces that depend on speed, and brax knows no other.
    integrator = (
        "Euler" if chosen.actuators == "motor" and not fluid else "implicitfast"
    )
    add(root, "option", integrator=integrator, gravity=GRAVITY, **fluid)
    root.extend([visual, defaults])
    asset = add(root, "asset")
    for material in MATERIALS:
        add(asset, "material", **vars(material))
    for mesh in chain(*(body.meshes for body in bodies)):
        add(asset, "mesh", name=mesh, file=f"{mesh}.obj")
    _worldbody(root, bodies, chosen)
    if chosen.collision == "primitives":
        contact, names = add(root, "contact"), {body.name for body in bodies}
        for one, other in chain(*UNCHECKED_PAIRS.values()):
            if {one, other} <= names:
                add(contact, "exclude", body1=one, body2=other)
    if chosen.gripper == "jaws":
        equality = add(root, "equality")
        for joint in joints:
            if isinstance(joint, FingerJoint):
                line = (joint.offset, joint.multiplier, 0.0, 0.0, 0.0)
                pair = {"joint1": joint.name, "joint2": joint.leader}
                # stiffer than MuJoCo's default, with which servo and fingers excite each other
                add(equality, "joint", **pair, polycoef=line, solref="0.005 1")
    _actuators(root, joints, chosen.actuators)
    return serialized(root)


def _worldbody(root: ET.Element, bodies: Iterable[Body], options: MjcfOptions) -> None:
    water = hydrodynamics(options.gripper) if options.hydrodynamics else {}
    base = add(add(root, "worldbody"), "body", name="base_link", childclass="alpha5")
    elements = {"base_link": base}
    for body in bodies:
        parent = elements[body.placement.parent]
        element = elements[body.name] = add(
            parent, "body", name=body.name, **_pose(body.placement)
        )
        if (joint := body.joint) is not None:
            # limits of a follower would fight its equality
            limits = (
                None if isinstance(joint, FingerJoint) else (joint.lower, joint.upper)
            )
            kind = "hinge" if joint.kind == "revolute" else "slide"
            add(
                element, "joint", name=joint.name, axis="0 0 1", type=kind, range=limits
            )
        buoyant = body.volume > 0 and options.buoyancy == "bodies"
        moments, quat = _principal(body.inertia)
        inertial: dict[str, Value] = {"pos": body.com, "quat": quat, "mass": body.mass}
        if joint is None and options.buoyancy == "none":
            # brax melts a body without joint into the world, which must not have an inertial
            size = np.sqrt(1.5 / body.mass * (moments.sum() - 2.0 * moments))
            add(
                element,
                "geom",
                **_UNTOUCHED,
                type="box",
                size=size,
                group="4",
                **inertial,
            )
        else:
            own = moments - INERTIA if buoyant else moments
            add(element, "inertial", **inertial, diaginertia=own)
        for mesh, at in body.meshes.items():
            look = {"mesh": mesh, "material": material_of(mesh).name}
            add(element, "geom", "visual", **look, **_pose(at))
        for shape in body.shapes if options.collision == "primitives" else ():
            size = [s * h for s, h in zip(shape.size, _HALVES[shape.kind], strict=True)]
            add(
                element, "geom", "collision", type=shape.kind, size=size, **_pose(shape)
            )
        for piece in chain(
            *map(ellipsoids, water[body.name].strips if body.name in water else ())
        ):
            add(element, "geom", "strip", **piece)
        if water and body.name not in water:
            add(element, "geom", "no_drag")
        if buoyant:
            compensation, name = (
                options.fluid_density * DILUTION + 1.0,
                f"{body.name}_buoyancy",
            )
            child = add(element, "body", name=name, pos=body.cob, gravcomp=compensation)
            mass = body.volume / DILUTION
            add(child, "inertial", pos="0 0 0", mass=mass, diaginertia=[INERTIA] * 3)
            add(child, "geom", "no_drag")
    tip = tcp_placement(parameters(options.corrections))
    add(elements[tip.parent], "site", name="tcp", size="0.005", group="4", **_pose(tip))


def _actuators(root: ET.Element, joints: list[JointRange], kind: str) -> None:
    """One actuator per joint that has its own, and the named poses, jaws closed, servos at rest."""
    actuator, keyframe = add(root, "actuator"), add(root, "keyframe")
    own = [joint for joint in joints if not isinstance(joint, FingerJoint)]
    for joint in own:
        limits, effort = (joint.lower, joint.upper), (-joint.effort, joint.effort)
        speed = -joint.velocity, joint.velocity
        ranges = {"motor": effort, "position": limits, "velocity": speed}
        servo: dict[str, Value] = {"kp": _STIFFNESS[joint.name], "forcerange": effort}
        servo |= (
            {"kv": _ROD_DAMPING} if joint.kind == "prismatic" else {"dampratio": "1"}
        )
        # A position servo whose target moves at the speed asked for: it holds against weight.
        tag, within = ("intvelocity", limits) if kind == "velocity" else (kind, None)
        given = {"name": joint.name, "joint": joint.name} | (
            {} if kind == "motor" else servo
        )
        add(actuator, tag, **given, ctrlrange=ranges[kind], actrange=within)
    target = {"position": "ctrl", "velocity": "act"}.get(kind)
    for name, pose in sorted(NAMED_POSES.items()):  # home first: tools take the first
        # The jaws are closed at their lower limits.
        at = {joint.name: joint.lower for joint in joints}
        at |= zip(at, pose, strict=False)
        # servos start at rest: their targets are where the joints are
        rest = {target: [at[joint.name] for joint in own]} if target else {}
        add(keyframe, "key", name=name, qpos=at.values(), **rest)


def _principal(inertia: FloatArray) -> tuple[FloatArray, list[float]]:
    """Principal moments [kg m^2] and the quaternion (w, x, y, z) of their axes in the body.

    MuJoCo 3.5 finds them from a full tensor to about 4e-10 kg m^2 only.
    """
    from scipy.spatial.transform import Rotation

    moments, axes = np.linalg.eigh(inertia)
    right_handed = axes * np.sign(np.linalg.det(axes))
    x, y, z, w = Rotation.from_matrix(right_handed).as_quat(canonical=True).tolist()
    return moments, [c + 0.0 for c in (w, x, y, z)]  # no negative zeros


def _pose(placement: Placement | Primitive) -> dict[str, tuple[float, ...] | None]:
    """Not ``euler``: readers other than MuJoCo take its sequence for another one."""
    x, y, z, w = quaternion_from_rpy(placement.rpy)
    turned = any(placement.rpy)
    return {
        "pos": placement.xyz if any(placement.xyz) else None,
        "quat": (w + 0.0, x + 0.0, y + 0.0, z + 0.0) if turned else None,
    }


def ellipsoids(strip: DragStrip) -> Iterator[dict[str, Any]]:
    """Geoms that drag in MuJoCo as a strip does: a flat ellipsoid and a needle on each of its pieces.

    At an angle x to the axis MuJoCo takes for the shadow of an ellipsoid with half axes k r, r, r
    ``pi r^2 sqrt((cos^2 + k^4 sin^2) / (cos^2 + k^2 sin^2))``. With k = 0.8 its slender drag goes within 0.04 like the
    strip's, ``sin^3 x``. The needle has the strip's lift, ``sin^2 x cos x`` against its ``sin x cos x``, and its turning.
    """
    points = np.linspace(strip.start, strip.end, _PIECES + 1)
    for start, end in pairwise(points):
        half, middle = (end - start) / 2, (start + end) / 2
        length = 2 * float(np.linalg.norm(half))
        radius, needle = _FLAT_RADIUS * length, _NEEDLE_RADIUS * length
        share = strip.diameter * length / 2 / (np.pi * radius**2)
        blunt, slender = (
            strip.along,
            (strip.across - _FLATNESS * strip.along) / (1 - _FLATNESS),
        )
        short = 2 * _FLATNESS * _FLAT_RADIUS * half
        flat = np.concatenate([middle - short, middle + short])
        drag = share * blunt, share * slender, 0.0, 0.0, 0.0
        yield {"fromto": flat, "size": radius, "fluidcoef": drag}
        share = strip.diameter / (np.pi * needle)
        turning, lift = 15 / 32 * strip.across, _LIFT * (strip.across - strip.along)
        turn = 0.0, 0.0, share * turning, share * lift, 0.0
        yield {
            "fromto": np.concatenate([start, end]),
            "size": needle,
            "fluidcoef": turn,
        }
