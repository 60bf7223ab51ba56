"""From the shipped URDF to an arm in the water: `load` and `robot_wrapper`."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import array, choice, flag
from alpha5_model._support.files import read_named
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model._support.spatial import pose
from alpha5_model.description.frames import (
    base_placement,
    joint_placements,
    tcp_placement,
)
from alpha5_model.description.reading import UrdfJoint, parse_urdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import Displacement, displacements
from alpha5_model.dynamics.jaw_arm import JawArm, mimicking
from alpha5_model.dynamics.kernel_arm import KernelArm
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, density_of
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

#: What can compute single calls.
BACKENDS = ("pinocchio", "kernels")


def load(
    fluid_density: float = SEA_WATER,
    gripper: str = "locked",
    floating_base: bool = False,
    gravity: ArrayLike = GRAVITY,
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
    backend: str = "pinocchio",
) -> Arm:
    """The arm in a fluid, from the shipped URDF.

    Args:
        fluid_density: [kg/m^3]; ``SEA_WATER``, ``FRESH_WATER``, ``AIR`` or any other.
        gripper: ``locked`` (4 joints) or ``jaws`` (adds axis_a, the jaw rod, which the fingers
            follow).
        floating_base: Puts base_link on Pinocchio's free-flyer joint, ``root_joint``.
        gravity: In the world, (3,) [m/s^2]; the world is base_link if the base is fixed, so for a
            tilted mount pass ``gravity_in_base(rotation)``.
        corrections: Recorded corrections to the document. Other than the default ones, the URDF is
            generated in memory.
        backend: What computes single calls: ``pinocchio``, or ``kernels`` that are generated from the
            same equations, see `alpha5_model.backend`. Batches run on kernels in any case; a floating
            base, jaws and external forces are Pinocchio's in any case.

    Returns:
        An arm, independent of every other one.

    Raises:
        InputError: A density below 0, or gravity that is not three finite numbers.
        UnknownNameError: No such gripper, correction or backend.

    Warns:
        ImplausibleWarning: A density that no fluid has, gravity of an implausible strength, or a
            tuple or list of gravity that points straight up. What `gravity_in_base` returns may
            point anywhere.
    """
    chosen = check_corrections(corrections)
    choice("gripper", gripper, GRIPPERS)
    on_kernels = choice("backend", backend, BACKENDS) == "kernels" and not floating_base
    density = density_of(fluid_density)
    g = array("gravity", gravity, 3)
    plausibility.check_gravity(gravity, g)
    parsed, mimics, displaced = _parsed(
        gripper, flag("floating_base", floating_base), chosen
    )
    tree = parsed.copy()
    tree.gravity.linear = g
    record = parameters(chosen)
    if mimics:
        return JawArm(tree, displaced, density, mimics, parameters=record)
    kind = KernelArm if on_kernels else Arm
    return kind(tree, displaced, density, parameters=record)


def arm_of(
    parameters: Alpha5Parameters,
    fluid_density: float = SEA_WATER,
    gravity: ArrayLike = GRAVITY,
) -> Arm:
    """The arm of a parameter set, Table 1 and limits included, on a fixed base with locked jaws.

    Args:
        parameters: From `alpha5_model.numbers.parameters`, or a set of
            `alpha5_model.uncertainty.sample`.
        fluid_density, gravity: See `alpha5_model.load`.
    """
    model, p = load(fluid_density, gravity=gravity).model, parameters
    frames = base_placement(p), *joint_placements(p), tcp_placement(p)
    base, first, *places, tip = (pin.SE3(pose(at.xyz, at.rpy)) for at in frames)
    for joint, place in enumerate((base * first, *places), 1):
        model.jointPlacements[joint] = place
    for at, own in enumerate(p.joints[:4]):
        model.lowerPositionLimit[at] = own.lower
        model.upperPositionLimit[at] = own.upper
        model.velocityLimit[at] = own.velocity
        model.effortLimit[at] = own.effort
    for name, place in (("link_0", base), ("tcp", tip)):
        model.frames[model.getFrameId(name)].placement = place
    for link in p.links:
        frame = model.frames[model.getFrameId(link.name)]
        body = pin.Inertia(link.mass, link.com, link.inertia)
        model.inertias[frame.parentJoint] = frame.placement.act(body)
    displaced = displacements(model, p, "locked")
    return Arm(model, displaced, fluid_density, parameters=p)


def robot_wrapper(
    gripper: str = "locked",
    floating_base: bool = False,
    corrections: Iterable[str] = DEFAULT_CORRECTIONS,
) -> Any:
    """The arm with its meshes as Pinocchio's RobotWrapper, as example-robot-data returns robots.

    Water is left out: see `load`. With ``gripper="jaws"`` the fingers are mimic joints.

    Args:
        gripper, floating_base, corrections: As in `load`.

    Returns:
        pin.RobotWrapper.

    Raises:
        UnknownNameError: No such gripper or correction.
    """
    from pinocchio.robot_wrapper import RobotWrapper

    chosen = check_corrections(corrections)
    choice("gripper", gripper, GRIPPERS)
    text, folder = _urdf(gripper, chosen), str(Path(URDF_PATH).parent)
    model = mimicking(
        *_parsed(gripper, flag("floating_base", floating_base), chosen)[:2]
    )
    collision, visual = (
        pin.buildGeomFromUrdfString(model, text, kind, package_dirs=[folder])
        for kind in (pin.GeometryType.COLLISION, pin.GeometryType.VISUAL)
    )
    return RobotWrapper(model, collision_model=collision, visual_model=visual)


@cache
def _parsed(
    gripper: str, floating_base: bool, corrections: tuple[str, ...]
) -> tuple[Any, tuple[UrdfJoint, ...], tuple[Displacement, ...]]:
    """The URDF's tree with every joint free to move, which joints follow which, and the volumes."""
    text = _urdf(gripper, corrections)
    root = [pin.JointModelFreeFlyer()] if floating_base else []
    tree = pin.buildModelFromXML(text, *root)
    mimics = tuple(j for j in parse_urdf(text).joints.values() if j.mimic is not None)
    return tree, mimics, displacements(tree, parameters(corrections), gripper)


def _urdf(gripper: str, corrections: tuple[str, ...]) -> str:
    if corrections == DEFAULT_CORRECTIONS:
        path = JAWS_URDF_PATH if gripper == "jaws" else URDF_PATH
        return read_named(path, "the generated URDF (alpha5 generate)").decode()
    return urdf(Variant(gripper=gripper, corrections=corrections))
