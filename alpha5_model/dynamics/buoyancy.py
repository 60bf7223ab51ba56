"""Buoyancy as a second model: the displaced fluid on the same joints.

By Archimedes' principle, the fluid pushes a body upwards with the weight of the
displaced fluid, at the centroid of its volume. A model whose bodies are point masses
rho V at the centres of buoyancy has exactly this weight, so its generalized gravity is
the generalized force that the fluid applies to the arm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from alpha5_model._support.checks import FloatArray, array, choice, frozen, real
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import Gripper, loaded_links, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody

#: Rounding of a second moment of mass that is 0, relative to the largest one.
POINT_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class Displacement:
    """The volume that one body displaces.

    Attributes:
        body: Name of the body.
        joint: Name of the joint that carries it; ``universe`` for a fixed base.
        volume: [m^3].
        cob: Centre of buoyancy in the joint's frame, (3,) [m].

    Raises:
        InputError: A negative volume, or numbers that are not finite or too large.
    """

    body: str
    joint: str
    volume: float
    cob: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "volume", real("volume", self.volume, minimum=0.0))
        object.__setattr__(self, "cob", frozen(array("cob", self.cob, 3)))


def displacements(
    model: pin.Model, parameters: Alpha5Parameters, gripper: Gripper
) -> tuple[Displacement, ...]:
    """The volumes of Table 3, and of attached bodies, on the joints of a model.

    With jaws, link 4's volume is split between its bodies.

    Args:
        model: pin.Model with a frame for every body.
        parameters: The arm's parameters.
        gripper: ``locked`` or ``jaws``.
    """
    bodies: Sequence[RigidBody] = loaded_links(parameters)
    if gripper == "jaws":
        bodies = [*bodies[:4], *split_link_4(parameters).bodies]
    return tuple(
        displacement(model, body.name, body.name, body.volume, body.cob)
        for body in bodies
    )


def displacement(
    model: pin.Model, body: str, frame: str, volume: float, cob: FloatArray
) -> Displacement:
    """A volume on the joint that carries a frame; ``cob`` is given in that frame."""
    carrier = model.frames[model.getFrameId(frame)]
    return Displacement(
        body=body,
        joint=model.names[carrier.parentJoint],
        volume=volume,
        cob=carrier.placement.act(cob),
    )


def displaced_fluid_model(
    model: pin.Model, displaced: Iterable[Displacement], density: float
) -> Any:
    """The displaced-fluid model: point masses ``rho V`` at the centres of buoyancy.

    ``pin.computeGeneralizedGravity`` of it is the torque that the water applies. It has
    no rotational inertia, so its forward dynamics has no meaning (``pin.aba`` gives
    NaN).

    Args:
        model: pin.Model of the arm; it is not changed.
        displaced: The volumes on its joints.
        density: Of the fluid [kg/m^3].

    Returns:
        pin.Model with the arm's joints, frames and gravity.

    Raises:
        UnknownNameError: No such joint in the model.
    """
    fluid = model.copy()
    for joint in range(fluid.njoints):
        fluid.inertias[joint] = pin.Inertia.Zero()
    for frame in fluid.frames:
        frame.inertia = pin.Inertia.Zero()

    for body in displaced:
        choice("joint", body.joint, fluid.names)
        mass = density * body.volume
        if mass:
            point = pin.Inertia(mass, np.array(body.cob), np.zeros((3, 3)))
            joint = fluid.getJointId(body.joint)
            fluid.appendBodyToJoint(joint, point, pin.SE3.Identity())
    return fluid


def check_inertias(model: pin.Model) -> None:
    """Check that the bodies on the joints of a pin.Model are possible, or points.

    Raises:
        InputError: A negative mass, or an inertia that no body can have.
    """
    inertias = list(model.inertias)
    masses = [inertia.mass for inertia in inertias]
    tensors = np.array([inertia.inertia for inertia in inertias])

    # With ascending principal moments I_1, I_2, I_3, the least second moment of mass is
    # (I_1 + I_2 - I_3) / 2.
    small, middle, large = np.linalg.eigvalsh(tensors).T
    least_second_moments = (small + middle - large) / 2
    rounding = POINT_TOLERANCE * np.abs(large)

    for k, joint in enumerate(model.names):
        if masses[k] < 0:
            raise InputError(f"mass on {joint}", masses[k], "at least 0")
        if least_second_moments[k] < -rounding[k]:
            expected = "an inertia that a body can have"
            raise InputError(f"inertia on {joint}", tensors[k].tolist(), expected)
