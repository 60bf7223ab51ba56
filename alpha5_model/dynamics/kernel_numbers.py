"""The numbers of an arm for the generated kernels: base parameters and dimensions.

The kernels know the joints of the Reach Alpha 5 on a fixed base with locked jaws.
Bodies, payloads included, fluid, gravity, lengths, zeros and tool are parameters.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, moments, regrouped
from alpha5_model.description.frames import (
    base_placement,
    joint_placements,
    tcp_placement,
)
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.errors import InputError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.parameters import Alpha5Parameters

if TYPE_CHECKING:
    import pinocchio as pin

#: How far a frame may be from where the kernels have it [m and rad]. Kernels replace
#: Pinocchio unnoticed, so only the rounding of a URDF's numbers is allowed; what
#: refuses an arm openly allows `dimensions.EXACT`.
SAME_FRAME = 1e-14


def arm_parameters(arm: Any) -> FloatArray:
    """Base parameters of an arm, its fluid, gravity and payloads, (41,).

    Raises:
        InputError: The kernels do not know its joints: a floating base, jaws that move,
            or joints that are not where the arm's record has them.
    """
    return _numbers(arm)[: len(BASE_PARAMETERS)]


def arm_dimensions(arm: Any) -> FloatArray:
    """The ``dimensions`` of an arm's `Geometry`, (24,).

    Raises:
        InputError: As of `arm_parameters`.
    """
    return _numbers(arm)[len(BASE_PARAMETERS) :]


def _numbers(arm: Any) -> FloatArray:
    """A copy of the arm's `kernel_parameters`."""
    if arm.has_hydrodynamics:
        expected = "an arm in still water: there is no added mass and no drag here"
        raise InputError("arm", arm, expected)
    if arm._kernel_parameters is None:
        if not arm.floating_base and len(arm.joint_names) == 4:
            needed_for = "the generated formulas"
            check_dimensions(arm._model, needed_for, SAME_FRAME, arm.parameters)
        raise InputError("arm", arm, "one on a fixed base with its jaws locked")
    return np.array(arm._kernel_parameters)


def kernel_parameters(arm: Any) -> FloatArray | None:
    """Base parameters of an arm in its fluid, then its dimensions, (65,).

    None for unknown joints: the kernels know those of a Reach Alpha 5 on a fixed base
    with locked jaws, at the dimensions of the arm's record.
    """
    model = arm._model
    record = arm.parameters
    try:
        geometry = Geometry.of(record)
    except InputError:
        return None
    if not _has_the_joints_of(record, model):
        return None

    base_parameters = regrouped(moments_of_links(arm), model.gravity.linear, record)
    return np.concatenate([base_parameters, geometry.dimensions])


def moments_of_links(arm: Any) -> FloatArray:
    """Moments of what each link carries, with its displaced water, (5, 2, 4, 4).

    See `alpha5_model.codegen.regrouping.moments`.

    Args:
        arm: On a fixed base with locked jaws.
    """
    model = arm._model
    nowhere = np.zeros(3)
    weightless = np.zeros((3, 3))
    density = arm.fluid_density
    bodies = [
        moments(body.mass, body.lever, body.inertia, 0.0, nowhere, density)
        for body in model.inertias
    ]
    found = np.array(bodies)
    for displaced in arm.displacements:
        link = model.getJointId(displaced.joint)
        found[link] += moments(
            0.0,
            nowhere,
            weightless,
            displaced.volume,
            displaced.cob,
            density,
        )
    return found


def _has_the_joints_of(parameters: Alpha5Parameters, model: pin.Model) -> bool:
    """Whether a pin.Model has the joints and the tcp of a record, and no others."""
    kinds = [joint.shortname() for joint in list(model.joints)[1:]]
    if kinds != ["JointModelRZ"] * 4 or list(model.parents) != [0, 0, 1, 2, 3]:
        return False
    tip = model.getFrameId("tcp")
    if tip == model.nframes or model.frames[tip].parentJoint != 4:
        return False
    if np.any([*model.armature, *model.gravity.angular]):
        return False

    placements = [
        base_placement(parameters),
        *joint_placements(parameters),
        tcp_placement(parameters),
    ]
    base, first, *others = (pose(at.xyz, at.rpy) for at in placements)
    ours = [base @ first, *others]
    theirs = [at.homogeneous for at in list(model.jointPlacements)[1:]]
    theirs.append(model.frames[tip].placement.homogeneous)
    return bool(np.abs(np.subtract(ours, theirs)).max() < SAME_FRAME)
