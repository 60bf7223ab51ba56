"""The arm on its vehicle: a floating arm whose base carries the vehicle's body."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, bounded, frozen, instance, real, rigid_transform, shaped
from alpha5_model.dynamics.hydrostatics import on_free_flyer, with_body
from alpha5_model.errors import InputError
from alpha5_model.hydrodynamics import added_mass


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
        InputError: Negative damping, mass or volume, an added mass that is not symmetric or has a negative
            eigenvalue, no rigid transform; ShapeError: wrong shapes.
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
            name: real(name, getattr(self, name), minimum=0.0) for name in ("mass", "volume")
        }
        shapes = {"com": (3,), "cob": (3,), "inertia": (3, 3)}
        shapes |= {"linear_damping": (6,), "quadratic_damping": (6,)}
        for name, shape in shapes.items():
            clean[name] = frozen(bounded(name, shaped(name, getattr(self, name), shape)))
            if name.endswith("damping") and clean[name].min() < 0:
                raise InputError(name, clean[name].tolist(), "no negative damping")
        given = np.asarray(self.added_mass)
        matrix = np.diag(given) if given.shape == (6,) and given.dtype.kind in "fiu" else given
        clean["added_mass"] = frozen(added_mass(matrix))
        placement = rigid_transform("transform_vehicle_to_base", self.transform_vehicle_to_base)
        clean["transform_vehicle_to_base"] = placement
        for name, value in clean.items():
            object.__setattr__(self, name, value)


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
    model, volumes, *rest = still._arguments
    volumes = [replace(v, joint="root_joint") if v.joint == "universe" else v for v in volumes]
    return getattr(still, "_afloat", type(still))(on_free_flyer(model), volumes, *rest)


def carrying(still: Any, vehicle: Vehicle) -> Any:
    """The floating arm with the vehicle's body at its base, in a new frame ``vehicle``."""
    instance("vehicle", vehicle, Vehicle)
    model, volumes, *rest = still._arguments
    placement = pin.SE3(np.array(vehicle.transform_vehicle_to_base))
    model, base = model.copy(), model.getFrameId("base_link")
    at = model.frames[base].placement * placement
    joint = model.frames[base].parentJoint
    model.addFrame(pin.Frame("vehicle", joint, base, at, pin.FrameType.OP_FRAME))
    # A vehicle without mass has no inertia to check.
    inertia = vehicle.inertia if vehicle.mass or vehicle.inertia.any() else None
    body = vehicle.mass, vehicle.com, inertia, vehicle.volume, vehicle.cob
    model, displaced = with_body(model, "vehicle", *body, name="vehicle_body")
    return type(still)(model, (*volumes, displaced), *rest)


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
        raise InputError(
            "vehicle", "a centre of buoyancy at the centre of mass", "a righting moment"
        )
    x, y, z = righting / moment * -np.sign(gravity[2])
    roll, pitch = math.atan2(y, z), math.asin(-min(1.0, max(-1.0, x)))
    rotation = pin.rpy.rpyToMatrix(roll, pitch, 0.0)
    return Trim(roll, pitch, rotation, strength * (mass - displaced), moment)
