"""Buoyancy as a second model: the fluid that the arm displaces, carried by the same joints.

Archimedes: the fluid presses on a body with the weight of the displaced fluid, upwards, at the
centroid of its volume. A model whose bodies are point masses rho V at the centres of buoyancy has
exactly that weight, so its generalized gravity is the generalized force that the fluid applies to
the arm.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from alpha5_model.checks import FloatArray, choice, frozen, real
from alpha5_model.dynamics.states import vector
from alpha5_model.jaws import split_link_4
from alpha5_model.parameters import Alpha5Parameters


@dataclass(frozen=True, eq=False)
class Displacement:
    """The volume that one body displaces.

    Attributes:
        body: Name of the body.
        joint: Name of the joint that carries it; ``universe`` for a fixed base.
        volume: [m^3].
        cob: Centre of buoyancy in the joint's frame, (3,) [m].

    Raises:
        InputError: A negative volume, or numbers that cannot be computed with.
    """

    body: str
    joint: str
    volume: float
    cob: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "volume", real("volume", self.volume, minimum=0.0))
        object.__setattr__(self, "cob", frozen(vector("cob", self.cob, 3)))


def displacements(
    model: Any, parameters: Alpha5Parameters, gripper: str
) -> tuple[Displacement, ...]:
    """Table 3 on the joints of a model; with jaws, link 4's volume is split between its bodies.

    Args:
        model: pin.Model with a frame for every body.
        parameters: The arm's parameters.
        gripper: ``locked`` or ``jaws``.
    """
    bodies: list[Any] = list(parameters.links)
    if gripper == "jaws":
        bodies[4:] = split_link_4(parameters).bodies
    return tuple(displacement(model, b.name, b.name, b.volume, b.cob) for b in bodies)


def displacement(model: Any, body: str, frame: str, volume: float, cob: FloatArray) -> Displacement:
    """A volume whose centre is given in a frame, moved to the joint that carries the frame."""
    carrier = model.frames[model.getFrameId(frame)]
    return Displacement(body, model.names[carrier.parentJoint], volume, carrier.placement.act(cob))


def displaced_fluid_model(model: Any, displaced: Iterable[Displacement], density: float) -> Any:
    """The displaced-fluid model: point masses ``rho V`` at the centres of buoyancy.

    ``pin.computeGeneralizedGravity`` of it is the torque that the water applies. It has no
    rotational inertia: its forward dynamics has no meaning (``pin.aba`` gives NaN).

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
            fluid.appendBodyToJoint(fluid.getJointId(body.joint), point, pin.SE3.Identity())
    return fluid


def net_weight_model(model: Any, fluid: Any) -> Any:
    """The arm as its joints feel it at rest in the fluid: weight less buoyancy, in one body each.

    A body of mass ``m - rho V`` at ``(m c - rho V b) / (m - rho V)`` has the force and the moment
    of both, so one pass over this model gives the hydrostatic torque and the potential energy. A
    body that floats has a negative mass: valid in sums of forces and energies only, not for
    algorithms that join bodies, as those of derivatives, inertia and centre of mass do. Joints that
    displace nothing keep their body.

    Args:
        model: pin.Model of the arm; it is not changed.
        fluid: Its displaced-fluid model.

    Returns:
        pin.Model with the arm's joints, frames and gravity.
    """
    net = model.copy()
    for joint in range(net.njoints):
        body, water = model.inertias[joint], fluid.inertias[joint]
        if water.mass:
            # Neutral buoyancy leaves a pure moment: a mass too small to weigh anything carries it.
            mass = (body.mass - water.mass) or 1e-30
            point = pin.Inertia.Zero()
            point.mass = mass
            point.lever = (body.mass * body.lever - water.mass * water.lever) / mass
            net.inertias[joint] = point
    return net
