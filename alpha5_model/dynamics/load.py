"""From the shipped URDF to an arm in the water: `load` and `robot_wrapper`."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import array, choice, flag, instance
from alpha5_model._support.files import read_named
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model._support.spatial import pose
from alpha5_model.description.frames import (
    base_placement,
    joint_placements,
    tcp_placement,
)
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import Displacement, displacements
from alpha5_model.dynamics.joint_tree import mimicking
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, Fluid, density_of
from alpha5_model.numbers.jaws import GRIPPERS, Gripper, loaded_links
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue

#: What can compute single calls.


def load(
    fluid_density: Fluid = SEA_WATER,
    gripper: Gripper = "locked",
    floating_base: bool = False,
    gravity: ArrayLike = GRAVITY,
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
    arm: Alpha5Parameters | None = None,
) -> Arm:
    """The arm in a fluid, from the shipped URDF, or one of your own.

    Args:
        fluid_density: [kg/m^3], or ``sea`` (1025), ``fresh`` (1000) or ``air`` (0).
        gripper: ``locked`` (4 joints) or ``jaws`` (adds axis_a, the jaw rod, which the
            fingers follow).
        floating_base: Puts base_link on Pinocchio's free-flyer joint, ``root_joint``.
        gravity: In the world, (3,) [m/s^2]; the world is base_link if the base is
            fixed, so for a tilted mount pass ``gravity_in_base(rotation)``. If the
            record of a fixed ``arm`` has a mount, the world is the mount's parent, and
            gravity is turned into base_link.
        corrections: Recorded corrections to the document. For other than the default
            ones, the URDF is generated in memory.
        arm: Record of an arm of your own, such as from `alpha5_model.arm_file`; None
            for the catalogue's. Its URDF is generated in memory. It has its own
            corrections.

    Returns:
        An arm, independent of every other one.

    Raises:
        InputError: A density below 0, gravity that is not three finite numbers, or an
            ``arm`` together with corrections that it does not have.
        UnknownNameError: No such gripper or correction.

    Warns:
        ImplausibleWarning: A density that no fluid has, gravity of an implausible
            strength, or a tuple or list of gravity that points straight up. What
            `gravity_in_base` returns may point anywhere.
    """
    record = chosen_arm(arm, corrections)
    choice("gripper", gripper, GRIPPERS)
    density = density_of(fluid_density)
    checked_gravity = array("gravity", gravity, 3)
    plausibility.check_gravity(gravity, checked_gravity)
    flag("floating_base", floating_base)

    parsed = _parsed(gripper, floating_base, record)
    tree = parsed.tree.copy()
    tree.gravity.linear = checked_gravity
    if record.mount is not None and not floating_base:
        tree.gravity.linear = record.mount.rotation.T @ checked_gravity
    volumes = parsed.displacements
    return Arm(tree, volumes, density, parsed.mimics, parameters=record)


def loaded(arm: Alpha5Parameters | Arm | None, **options: Any) -> Arm:
    """The arm that an argument ``arm`` means: itself, or its record loaded.

    Args:
        arm: An arm, or the record of one; None for the catalogue's.
        options: Of `load`, for a record.

    Raises:
        InputError: Neither.
    """
    if arm is None or isinstance(arm, Alpha5Parameters):
        return load(arm=arm, **options)
    return instance("arm", arm, Arm)


def arm_of(
    parameters: Alpha5Parameters,
    fluid_density: Fluid = SEA_WATER,
    gravity: ArrayLike = GRAVITY,
) -> Arm:
    """The arm of a parameter set, on a fixed base with locked jaws.

    Dimensions, limits, tool and attached bodies are those of the set, too. Its URDF is
    not generated, so this is faster than `load`.

    Args:
        parameters: From `alpha5_model.numbers.parameters`, or a set of
            `alpha5_model.uncertainty.sample`.
        fluid_density: See `alpha5_model.load`.
        gravity: In base_link, whatever the mount of the set, (3,) [m/s^2].
    """
    catalogue = load(fluid_density, gravity=gravity)
    model = catalogue.model
    _set_placements(model, parameters)
    for number, joint in enumerate(parameters.joints[:4]):
        model.lowerPositionLimit[number] = joint.lower
        model.upperPositionLimit[number] = joint.upper
        model.velocityLimit[number] = joint.velocity
        model.effortLimit[number] = joint.effort
    for link in loaded_links(parameters):
        frame = model.frames[model.getFrameId(link.name)]
        body = pin.Inertia(link.mass, link.com, link.inertia)
        model.inertias[frame.parentJoint] = frame.placement.act(body)
    volumes = displacements(model, parameters, "locked")
    return Arm(model, volumes, catalogue.fluid_density, parameters=parameters)


def _set_placements(model: pin.Model, parameters: Alpha5Parameters) -> None:
    """Move the joints, link_0 and the tcp of a pin.Model to their places."""
    placements = [
        base_placement(parameters),
        *joint_placements(parameters),
        tcp_placement(parameters),
    ]
    base, first, *others, tip = (pin.SE3(pose(at.xyz, at.rpy)) for at in placements)
    for number, placement in enumerate((base * first, *others), 1):
        model.jointPlacements[number] = placement
    model.frames[model.getFrameId("link_0")].placement = base
    model.frames[model.getFrameId("tcp")].placement = tip


def robot_wrapper(
    gripper: Gripper = "locked",
    floating_base: bool = False,
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
    arm: Alpha5Parameters | None = None,
) -> Any:
    """The arm with its meshes as Pinocchio's RobotWrapper.

    This is what the loaders of example-robot-data return.

    Water is left out: see `load`. With ``gripper="jaws"`` the fingers are mimic joints.

    Args:
        gripper, floating_base, corrections, arm: As in `load`.

    Returns:
        pin.RobotWrapper.

    Raises:
        InputError: An ``arm`` together with corrections that it does not have.
        UnknownNameError: No such gripper or correction.
    """
    from pinocchio.robot_wrapper import RobotWrapper

    record = chosen_arm(arm, corrections)
    choice("gripper", gripper, GRIPPERS)
    text = arm_urdf(gripper, record)
    flag("floating_base", floating_base)
    parsed = _parsed(gripper, floating_base, record)
    model = mimicking(parsed.tree, parsed.mimics)

    def geometry(kind: Any) -> Any:
        folder = str(Path(URDF_PATH).parent)
        return pin.buildGeomFromUrdfString(model, text, kind, package_dirs=[folder])

    return RobotWrapper(
        model,
        collision_model=geometry(pin.GeometryType.COLLISION),
        visual_model=geometry(pin.GeometryType.VISUAL),
    )


class _Parsed(NamedTuple):
    """What a URDF says.

    Attributes:
        tree: pin.Model with every joint free to move.
        mimics: The joints that follow others.
        displacements: The volumes on the joints.
    """

    tree: pin.Model
    mimics: tuple[UrdfJoint, ...]
    displacements: tuple[Displacement, ...]


@lru_cache(maxsize=64)
def _parsed(
    gripper: Gripper, floating_base: bool, parameters: Alpha5Parameters
) -> _Parsed:
    """Read the URDF of an arm."""
    text = arm_urdf(gripper, parameters)
    root = [pin.JointModelFreeFlyer()] if floating_base else []
    tree = pin.buildModelFromXML(text, *root)
    joints = parse_urdf(text).joints.values()
    return _Parsed(
        tree=tree,
        mimics=tuple(joint for joint in joints if joint.mimic is not None),
        displacements=displacements(tree, parameters, gripper),
    )


@lru_cache(maxsize=64)
def arm_urdf(gripper: Gripper, parameters: Alpha5Parameters) -> str:
    """Text of the URDF: the shipped one, or generated for another record.

    Its root is base_link: a mount would put a link of the vehicle there.
    """
    corrections = parameters.corrections
    shipped = is_catalogue(parameters) and corrections == DEFAULT_CORRECTIONS
    if shipped:
        path = JAWS_URDF_PATH if gripper == "jaws" else URDF_PATH
        return read_named(path, "the generated URDF (alpha5 generate)").decode()
    # The shipped file needs no writer.
    from alpha5_model.description.urdf import Variant, urdf

    if is_catalogue(parameters):
        return urdf(Variant(gripper=gripper, corrections=corrections))
    unmounted = replace(parameters, mount=None)
    return urdf(Variant(gripper=gripper, arm=unmounted))
