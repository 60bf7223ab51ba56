"""Models made from the arm's: the fluid that it displaces, one more body, a free-flyer for its base, a vehicle on it.

Buoyancy is a second model: the fluid that the arm displaces, carried by the same joints.

Archimedes: the fluid presses on a body with the weight of the displaced fluid, upwards, at the
centroid of its volume. A model whose bodies are point masses rho V at the centres of buoyancy has
exactly that weight, so its generalized gravity is the generalized force that the fluid applies to
the arm.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    float_array,
    frozen,
    instance,
    real,
    rigid_transform,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.hydrodynamics import added_mass
from alpha5_model.numbers.inertia import check_possible
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters

#: How far below zero, relative to the largest, rounding may take a second moment of mass that is 0.
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
        InputError: A negative volume, or numbers that cannot be computed with.
    """

    body: str
    joint: str
    volume: float
    cob: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "volume", real("volume", self.volume, minimum=0.0))
        object.__setattr__(self, "cob", frozen(array("cob", self.cob, 3)))


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


def displacement(
    model: Any, body: str, frame: str, volume: float, cob: FloatArray
) -> Displacement:
    """A volume whose centre is given in a frame, moved to the joint that carries the frame."""
    carrier = model.frames[model.getFrameId(frame)]
    return Displacement(
        body, model.names[carrier.parentJoint], volume, carrier.placement.act(cob)
    )


def displaced_fluid_model(
    model: Any, displaced: Iterable[Displacement], density: float
) -> Any:
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
            fluid.appendBodyToJoint(
                fluid.getJointId(body.joint), point, pin.SE3.Identity()
            )
    return fluid


def check_inertias(model: Any) -> None:
    """Check that the bodies on each joint of a pin.Model are possible; point masses are.

    Raises:
        InputError: A negative mass, or an inertia that no body can have.
    """
    inertias = list(model.inertias)
    masses = [inertia.mass for inertia in inertias]
    tensors = np.array([inertia.inertia for inertia in inertias])
    # Principal moments, ascending; half of the first two less the third is a second moment.
    small, middle, large = np.linalg.eigvalsh(tensors).T
    least = (small + middle - large) / 2
    rounding = POINT_TOLERANCE * np.abs(large)
    for k, joint in enumerate(model.names):
        if masses[k] < 0:
            raise InputError(f"mass on {joint}", masses[k], "at least 0")
        if least[k] < -rounding[k]:
            expected = "an inertia that a body can have"
            raise InputError(f"inertia on {joint}", tensors[k].tolist(), expected)


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


def with_body(
    model: Any, frame: str, *body: Any, name: str = "payload"
) -> tuple[Any, Displacement]:
    """A copy of a pin.Model with a rigid body fixed to a frame, and its volume on the joint below.

    Its mass, COM, inertia, volume and COB, and the errors, are those of `alpha5_model.dynamics.arm.Arm.with_payload`.
    """
    mass, com, inertia, volume, cob = body
    m, centre = real("mass", mass, minimum=0.0), array("com", com, 3)
    tensor = np.zeros((3, 3))
    if inertia is not None:
        tensor = array("inertia", inertia, 3, 3)
        check_possible("inertia", m, centre, tensor)
    displaced = real("volume", volume, minimum=0.0)
    centroid = centre if cob is None else array("cob", cob, 3)
    if name == "payload":
        plausibility.check_body(m, centre, tensor, displaced, centroid)
    loaded, names = model.copy(), [f.name for f in model.frames]
    index = loaded.getFrameId(choice("frame", frame, names))
    carrier = loaded.frames[index]
    count = 1 + sum(known.startswith(name) for known in names)
    name = name if count == 1 else f"{name}_{count}"
    solid, kind = pin.Inertia(m, centre, tensor), pin.FrameType.BODY
    # This adds the inertia to the joint, too.
    loaded.addFrame(
        pin.Frame(name, carrier.parentJoint, index, carrier.placement, kind, solid)
    )
    return loaded, displacement(loaded, name, name, displaced, centroid)


def on_free_flyer(model: Any) -> Any:
    """A pin.Model with its base on a free-flyer joint, whose six torques are those of the mount."""
    free = pin.Model()
    root = free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    out = pin.appendModel(free, model, free.addJointFrame(root), pin.SE3.Identity())
    out.gravity = model.gravity
    return out


@dataclass(frozen=True, eq=False)
class Vehicle:
    """A rigid vehicle, in a frame of its own.

    Added mass and damping hold for water of 1000 kg/m^3; the arm's fluid scales them.

    Attributes:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
        added_mass: Linear before angular, about the frame's origin, (6, 6), or its diagonal, (6,) [kg, kg m^2].
        linear_damping, quadratic_damping: Of each component of the velocity relative to the water at the
            origin, (6,) [N s/m, N m s] and [N s^2/m^2, N m s^2].
        transform_vehicle_to_base: Pose of the vehicle's frame in base_link, (4, 4).

    Raises:
        InputError: Negative damping, mass or volume, an inertia that no body can have, an added mass that is
            not symmetric or has a negative eigenvalue, no rigid transform; ShapeError: wrong shapes.

    Warns:
        ImplausibleWarning: A mass, volume, density or distance that no vehicle has.
    """

    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray
    added_mass: FloatArray = field(default_factory=lambda: np.zeros((6, 6)))
    linear_damping: FloatArray = field(default_factory=lambda: np.zeros(6))
    quadratic_damping: FloatArray = field(default_factory=lambda: np.zeros(6))
    transform_vehicle_to_base: FloatArray = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        clean: dict[str, Any] = {
            k: real(k, getattr(self, k), 0.0) for k in ("mass", "volume")
        }
        shapes = {"com": (3,), "cob": (3,), "inertia": (3, 3), "linear_damping": (6,)}
        for name, shape in (shapes | {"quadratic_damping": (6,)}).items():
            clean[name] = frozen(array(name, getattr(self, name), *shape))
            if name.endswith("damping") and clean[name].min() < 0:
                raise InputError(name, clean[name].tolist(), "no negative damping")
        given = float_array("added_mass", self.added_mass, ())
        matrix = np.diag(given) if given.shape == (6,) else given
        clean["added_mass"] = frozen(added_mass(matrix))
        placement = rigid_transform(
            "transform_vehicle_to_base", self.transform_vehicle_to_base
        )
        clean["transform_vehicle_to_base"] = placement
        for name, value in clean.items():
            object.__setattr__(self, name, value)

        check_possible("inertia", self.mass, self.com, self.inertia)
        body = self.mass, self.com, self.inertia, self.volume, self.cob
        plausibility.check_body(*body, on_vehicle=True)
        distance = placement[:3, 3]
        limits = plausibility.VEHICLE_POSITION
        plausibility.check("transform_vehicle_to_base", distance, limits)


@dataclass(frozen=True, eq=False)
class Trim:
    """How a free vehicle hangs in still water.

    Attributes:
        roll, pitch: Of the vehicle's frame, fixed axes of the world, yaw 0 [rad].
        rotation_vehicle_to_world: The same, (3, 3).
        net_weight: Weight less buoyancy of vehicle and arm [N]; what a vertical force has to make up for.
        righting_moment: For each radian off the trim [N m]; above 0, the trim is stable.
    """

    roll: float
    pitch: float
    rotation_vehicle_to_world: FloatArray
    net_weight: float
    righting_moment: float


def afloat(still: Any) -> Any:
    """The arm on a floating base."""
    if still.floating_base:
        return still
    volumes = [
        replace(v, joint="root_joint") if v.joint == "universe" else v
        for v in still.displacements
    ]
    return still._afloat(on_free_flyer(still._arguments[0]), volumes)


def carrying(still: Any, vehicle: Vehicle) -> Any:
    """The floating arm with the vehicle's body at its base, in a new frame ``vehicle``."""
    instance("vehicle", vehicle, Vehicle)
    model = still._arguments[0]
    placement = pin.SE3(np.array(vehicle.transform_vehicle_to_base))
    model, base = model.copy(), model.getFrameId("base_link")
    at = model.frames[base].placement * placement
    joint = model.frames[base].parentJoint
    model.addFrame(pin.Frame("vehicle", joint, base, at, pin.FrameType.OP_FRAME))
    body = vehicle.mass, vehicle.com, vehicle.inertia, vehicle.volume, vehicle.cob
    model, displaced = with_body(model, "vehicle", *body, name="vehicle_body")
    return still._made_of(model, (*still.displacements, displaced))


def trim(still: Any, vehicle: Vehicle, q: ArrayLike) -> Trim:
    """Static trim of an arm that carries a vehicle, see `ArmOnVehicle.trim`."""
    gravity = still._model.gravity.linear
    if gravity[0] or gravity[1] or not gravity[2]:
        raise InputError("gravity", gravity.tolist(), "gravity along the world's z")
    strength = abs(gravity[2])
    mass = pin.computeTotalMass(still._model)
    displaced = still.fluid_density * still._volume
    to_vehicle = np.linalg.inv(vehicle.transform_vehicle_to_base)
    points = np.array([still.center_of_mass(q), still.center_of_buoyancy(q)])
    com, cob = points @ to_vehicle[:3, :3].T + to_vehicle[:3, 3]
    # The moment about the vehicle's origin vanishes where this points up.
    righting = strength * (displaced * cob - mass * com)
    moment = float(np.linalg.norm(righting))
    if moment < 1e-9 * strength * mass:
        without = "a centre of buoyancy at the centre of mass"
        raise InputError("vehicle", without, "a righting moment")
    x, y, z = righting / moment * -np.sign(gravity[2])
    roll, pitch = math.atan2(y, z), math.asin(-min(1.0, max(-1.0, x)))
    rotation = pin.rpy.rpyToMatrix(roll, pitch, 0.0)
    return Trim(roll, pitch, rotation, strength * (mass - displaced), moment)
