"""MuJoCo: a folder in the style of MuJoCo Menagerie, with the buoyancy of Table 3."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from alpha5_model._support.checks import choice
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.collision.link_pairs import disabled_pairs
from alpha5_model.description.assets import mesh_assets, template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.frames import mount_placement, tcp_placement
from alpha5_model.description.mjcf_bodies import BodyWriter, float_density
from alpha5_model.description.options import SimulationOptions
from alpha5_model.description.srdf import named_poses
from alpha5_model.description.xml import Value, add, document, provenance, serialized
from alpha5_model.errors import InputError
from alpha5_model.geometry.collision_shapes import collision_capsules
from alpha5_model.geometry.materials import MATERIALS
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.hydrodynamics import hydrodynamics
from alpha5_model.numbers.jaws import FingerJoint, Gripper
from alpha5_model.numbers.motors import joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange

#: Capsules, one for each link, are for MJX.
COLLISIONS = ("primitives", "capsules", "none")
BUOYANCIES = ("bodies", "none")
ACTUATORS = ("position", "velocity", "motor")
#: Servo stiffness [N m/rad, N/m]: tuned, not from the document.
_STIFFNESS = {
    "axis_e": 200.0,
    "axis_d": 200.0,
    "axis_c": 200.0,
    "axis_b": 5.0,
    "axis_a": 500.0,
}
#: Damping of the rod's servo [N s/m]. MuJoCo would take the critical damping from the
#: rod alone; the fingers weigh more.
_ROD_DAMPING = 8.0
#: Kind of actuator -> attribute of a keyframe that holds the targets of its servos.
_TARGETS = {"position": "ctrl", "velocity": "act"}

#: Of the sea bed below base_link [m].
_DEPTH = 0.6
#: What the README says of the servos.
_TUNED = "are tuned to hold the arm within 0.02 rad under water, nothing more"
_DESIGNED = (
    "are those of a controller that adds the torque which holds weight and buoyancy: "
    "add it to `qfrc_applied`"
)


class Servo(NamedTuple):
    """Gains of a joint's servo.

    Attributes:
        stiffness: ``kp`` [N m/rad, N/m].
        damping: ``kv`` [N m s/rad, N s/m].
    """

    stiffness: float
    damping: float


@dataclass(frozen=True)
class MjcfOptions(SimulationOptions):
    """Options of the MuJoCo model, beside those of `SimulationOptions`.

    The density can be changed at run time too, see the folder's README. The mount is a
    body that carries base_link, or the pose of base_link if the parent is ``world``.

    Attributes:
        actuators: ``position``, ``velocity`` or ``motor``.
        collision: ``primitives``, ``capsules`` or ``none``. One capsule stands
            for each link in MJX, which has no contact between cylinders and boxes;
            with locked jaws.
        buoyancy: ``bodies``, or ``none`` for tools without ``gravcomp``, such as brax.
        servos: Joint -> gains of its servo; None, and for joints that it lacks, tuned
            ones that hold the weight as well.
    """

    actuators: str = "position"
    collision: str = "primitives"
    buoyancy: str = "bodies"
    servos: Mapping[str, Servo] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        choice("actuators", self.actuators, ACTUATORS)
        choice("collision", self.collision, COLLISIONS)
        if self.collision == "capsules" and self.gripper != "locked":
            raise InputError("collision", "capsules", "primitives or none, with jaws")
        choice("buoyancy", self.buoyancy, BUOYANCIES)


def mjcf_files(options: MjcfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``alpha5.xml`` (the model), ``scene.xml`` (with light and sea bed), ``assets/``
    (meshes), ``README.md``, ``CHANGELOG.md``, ``LICENSE``.

    Raises:
        Alpha5Error: See `MjcfOptions`.
    """
    chosen = options or MjcfOptions()
    assets = mesh_assets(".obj")
    return {
        "alpha5.xml": mjcf(chosen, assets).encode(),
        "scene.xml": mjcf_scene(chosen).encode(),
        "README.md": mjcf_readme(chosen).encode(),
        "CHANGELOG.md": template("mjcf_changelog.md").encode(),
        "LICENSE": (Path(REPOSITORY_PATH) / "LICENSE").read_bytes(),
        **{f"assets/{name}": data for name, data in assets.items()},
    }


def mjcf_scene(options: MjcfOptions, model_file: str = "alpha5.xml") -> str:
    """Text of a scene: the model's file with light, and a sea bed below base_link."""
    mount = options.mount
    height = 0.0 if mount is None else float(mount.position[2])
    return template("scene.xml").format(
        name=options.record.name, model_file=model_file, sea_bed=height - _DEPTH
    )


def mjcf_readme(
    options: MjcfOptions, picture: str = "", others: Iterable[MjcfOptions] = ()
) -> str:
    """Text of the folder's README.

    Args:
        options: Of the model that it describes.
        picture: Lines below its title.
        others: Options of other models in the folder. What a scene may set holds for
            all of them.
    """
    arm = options.record
    density = float_density(arm_bodies(arm, options.gripper))
    moving_water = template("mjcf_moving_water.md") if options.hydrodynamics else ""
    models = [ET.fromstring(mjcf(one)) for one in (options, *others)]
    inertials = [inertial for model in models for inertial in model.iter("inertial")]
    masses = [float(inertial.attrib["mass"]) for inertial in inertials]
    moments = [
        min(map(float, inertial.attrib["diaginertia"].split()))
        for inertial in inertials
    ]
    words = {
        **vars(options),
        **provenance(arm),
        "picture": picture,
        "drag": "estimated strips" if options.hydrodynamics else "none",
        "moving_water": moving_water,
        "jaws": template(f"mjcf_gripper_{options.gripper}.md").rstrip(),
        "float_density": f"{density:g}",
        "servos": _TUNED if options.servos is None else _DESIGNED,
        "least_mass": _first_digit(min(masses)),
        "least_moment": _first_digit(min(moments)),
    }
    return template("mjcf_readme.md").format(**words)


def _first_digit(number: float) -> str:
    """Text of a positive number, rounded down to its first digit."""
    unit = 10.0 ** math.floor(math.log10(number))
    return f"{math.floor(number / unit) * unit:.0e}"


def mjcf(options: MjcfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``assets/``; others are left
            out.
    """
    chosen = options or MjcfOptions()
    arm = chosen.record
    bodies = arm_bodies(arm, chosen.gripper, meshes)
    joints = [body.joint for body in bodies if body.joint is not None]
    floats = float_density(bodies) if chosen.buoyancy == "bodies" else None
    writer = BodyWriter(
        fluid_density=chosen.fluid_density,
        float_density=floats,
        collisions=chosen.collision == "primitives",
        capsules=collision_capsules(arm.spacer)
        if chosen.collision == "capsules"
        else {},
        water=hydrodynamics(chosen.gripper) if chosen.hydrodynamics else {},
        losses=joint_losses(arm),
    )

    root = document(arm, "mujoco", model=arm.name)
    compiler, visual, defaults = ET.fromstring(template("model.xml"))
    root.append(compiler)
    _add_option(root, chosen)
    root.append(visual)
    root.append(defaults)
    _add_assets(root, bodies)
    chosen.check_parent(["base_link", *(body.name for body in bodies)])
    mount = mount_placement(chosen.mount) if chosen.mount else None
    writer.add_worldbody(root, bodies, tcp_placement(arm), mount)
    if chosen.collision != "none":
        _add_contact(root, arm, chosen.gripper)
    if chosen.gripper == "jaws":
        _add_equality(root, joints)
    _add_actuators(root, joints, chosen.actuators, chosen.servos or {})
    _add_keyframes(root, joints, chosen.actuators)
    return serialized(root)


def _add_option(root: ET.Element, options: MjcfOptions) -> None:
    """Add gravity, the integrator, and the fluid if strips drag."""
    fluid: dict[str, Value] = {}
    if options.hydrodynamics:
        comment = "Density: drag of the strips, estimated, not published."
        root.append(ET.Comment(f" {comment} "))
        fluid = {"density": options.fluid_density}

    # Both integrators agree if no force depends on velocity, and brax has only Euler.
    no_damping = options.actuators == "motor" and not fluid
    integrator = "Euler" if no_damping else "implicitfast"
    add(root, "option", integrator=integrator, gravity=GRAVITY, **fluid)


def _add_assets(root: ET.Element, bodies: Iterable[Body]) -> None:
    asset = add(root, "asset")
    for material in MATERIALS:
        add(asset, "material", **vars(material))
    for body in bodies:
        for mesh in body.meshes:
            add(asset, "mesh", name=mesh, file=f"{mesh}.obj")


def _add_contact(root: ET.Element, arm: Alpha5Parameters, gripper: Gripper) -> None:
    """Pairs of bodies whose contact is not checked."""
    contact = add(root, "contact")
    for pairs in disabled_pairs(arm, gripper).values():
        for one, other in pairs:
            add(contact, "exclude", body1=one, body2=other)


def _add_equality(root: ET.Element, joints: Iterable[JointRange]) -> None:
    """Let the fingers follow the rod."""
    equality = add(root, "equality")
    for joint in joints:
        if isinstance(joint, FingerJoint):
            add(
                equality,
                "joint",
                joint1=joint.name,
                joint2=joint.leader,
                polycoef=(joint.offset, joint.multiplier, 0.0, 0.0, 0.0),
                # With MuJoCo's default, which is softer, servo and fingers excite each
                # other.
                solref="0.005 1",
            )


def _add_actuators(
    root: ET.Element,
    joints: Sequence[JointRange],
    kind: str,
    servos: Mapping[str, Servo],
) -> None:
    """One actuator for each joint that has its own."""
    actuator = add(root, "actuator")
    for joint in _driven(joints):
        servo = _servo(joint, servos.get(joint.name))
        limits = (joint.lower, joint.upper)
        speed = (-joint.velocity, joint.velocity)
        effort = (-joint.effort, joint.effort)
        names = {"name": joint.name, "joint": joint.name}
        if kind == "motor":
            add(actuator, "motor", **names, ctrlrange=effort)
        elif kind == "position":
            add(actuator, "position", **names, **servo, ctrlrange=limits)
        else:
            # A position servo whose target moves at the commanded speed, so that it
            # holds the weight.
            add(
                actuator,
                "intvelocity",
                **names,
                **servo,
                ctrlrange=speed,
                actrange=limits,
            )


def _servo(joint: JointRange, gains: Servo | None) -> dict[str, Value]:
    """Stiffness, largest force and damping of a joint's servo."""
    servo: dict[str, Value] = {
        "kp": _STIFFNESS[joint.name] if gains is None else gains.stiffness,
        "forcerange": (-joint.effort, joint.effort),
    }
    if gains is not None:
        servo["kv"] = gains.damping
    elif joint.kind == "prismatic":
        servo["kv"] = _ROD_DAMPING
    else:
        servo["dampratio"] = "1"
    return servo


def _add_keyframes(root: ET.Element, joints: Sequence[JointRange], kind: str) -> None:
    """The named poses with closed jaws and servos at rest.

    ``home`` comes first, because tools take the first one.
    """
    keyframe = add(root, "keyframe")
    driven = [joint.name for joint in _driven(joints)]
    for name, pose in sorted(named_poses(joints).items()):
        # The jaws are closed at their lower limits.
        positions = {joint.name: joint.lower for joint in joints}
        positions |= zip(positions, pose, strict=False)

        key: dict[str, Value] = {"name": name, "qpos": positions.values()}
        if kind in _TARGETS:
            # Servos are at rest if their targets are where the joints are.
            key[_TARGETS[kind]] = [positions[joint] for joint in driven]
        add(keyframe, "key", **key)


def _driven(joints: Sequence[JointRange]) -> list[JointRange]:
    """Joints with an actuator of their own."""
    return [joint for joint in joints if not isinstance(joint, FingerJoint)]
