"""A vehicle that carries an arm, and the static trim of both in still water."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    float_array,
    frozen,
    instance,
    real,
    rigid_transform,
)
from alpha5_model.dynamics.model_changes import added_body, on_free_flyer, with_body
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.hydrodynamics import added_mass
from alpha5_model.numbers.inertia import check_possible
from alpha5_model.water.carrier import Carrier, read_carrier

#: With a shorter lever between weight and buoyancy, a vehicle has no trim [m].
_LEAST_LEVER = 1e-9


@dataclass(frozen=True, eq=False)
class Vehicle:
    """A rigid vehicle, with all quantities in its own frame.

    Added mass and damping are given for water of 1000 kg/m^3, and scaled with the
    density of the arm's fluid.

    Attributes:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
        added_mass: Linear before angular, about the frame's origin, (6, 6), or its
            diagonal, (6,) [kg, kg m^2].
        linear_damping: Of each component of the velocity relative to the water at the
            origin, (6,) [N s/m, N m s].
        quadratic_damping: The same, by the square of the component, (6,)
            [N s^2/m^2, N m s^2].
        mount: Pose of base_link in the vehicle's frame, (4, 4), as xacro, the command
            line and arm files take it.

    Raises:
        InputError: Negative damping, mass or volume, an inertia that no body can have,
            an added mass that is not symmetric or has a negative eigenvalue, or a
            transform that is not rigid; ShapeError: wrong shapes.

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
    mount: FloatArray = field(default_factory=lambda: np.eye(4), kw_only=True)

    def __post_init__(self) -> None:
        for name, value in self._checked().items():
            object.__setattr__(self, name, value)

        check_possible("inertia", self.mass, self.com, self.inertia)
        plausibility.check_body(
            self.mass, self.com, self.inertia, self.volume, self.cob, on_vehicle=True
        )
        plausibility.check("mount", self.mount[:3, 3], plausibility.VEHICLE_POSITION)

    def _checked(self) -> dict[str, Any]:
        """Every attribute, converted and read-only."""
        return {
            "mass": real("mass", self.mass, 0.0),
            "volume": real("volume", self.volume, 0.0),
            "com": frozen(array("com", self.com, 3)),
            "cob": frozen(array("cob", self.cob, 3)),
            "inertia": frozen(array("inertia", self.inertia, 3, 3)),
            "linear_damping": _damping("linear_damping", self.linear_damping),
            "quadratic_damping": _damping("quadratic_damping", self.quadratic_damping),
            "added_mass": _added_mass(self.added_mass),
            "mount": rigid_transform("mount", self.mount),
        }


def carrier_of(name: str, given: Vehicle | Mapping[str, Any]) -> Carrier:
    """What the trim of a vehicle depends on.

    Args:
        name: Of the argument, for messages.
        given: A vehicle, or a table as `read_carrier` has it.

    Raises:
        InputError, UnknownNameError: A table that `read_carrier` refuses.
    """
    if isinstance(given, Vehicle):
        return Carrier(
            mass=given.mass,
            com=given.com,
            volume=given.volume,
            cob=given.cob,
            mount=given.mount,
        )
    return read_carrier(name, dict(given) if isinstance(given, Mapping) else given)


def _damping(name: str, value: ArrayLike) -> FloatArray:
    damping = frozen(array(name, value, 6))
    if damping.min() < 0:
        raise InputError(name, damping.tolist(), "no negative damping")
    return damping


def _added_mass(value: ArrayLike) -> FloatArray:
    """The matrix (6, 6) of an added mass that may be given by its diagonal (6,)."""
    given = float_array("added_mass", value, ())
    matrix = np.diag(given) if given.shape == (6,) else given
    return frozen(added_mass(matrix))


@dataclass(frozen=True, eq=False)
class Trim:
    """Static trim of a free vehicle in still water.

    Attributes:
        roll, pitch: Of the vehicle's frame, fixed axes of the world, yaw 0 [rad].
        rotation_vehicle_to_world: The same, (3, 3).
        net_weight: Weight less buoyancy of vehicle and arm [N], which a vertical force
            has to balance.
        righting_moment: Righting moment for each radian off the trim [N m]; positive
            for a stable trim.
    """

    roll: float
    pitch: float
    rotation_vehicle_to_world: FloatArray
    net_weight: float
    righting_moment: float


def on_floating_base(still: Any) -> Any:
    """The arm on a floating base."""
    if still.floating_base:
        return still
    volumes = [
        replace(volume, joint="root_joint") if volume.joint == "universe" else volume
        for volume in still.displacements
    ]
    return still._rebuilt(on_free_flyer(still._joint_tree.model), volumes)


def with_vehicle(still: Any, vehicle: Vehicle) -> Any:
    """The floating arm with the vehicle at its base, in a new frame ``vehicle``."""
    instance("vehicle", vehicle, Vehicle)
    model = still._joint_tree.model.copy()
    base = model.getFrameId("base_link")
    carrier = model.frames[base]
    placement = carrier.placement * pin.SE3(np.array(vehicle.mount)).inverse()
    frame = pin.Frame(
        "vehicle", carrier.parentJoint, base, placement, pin.FrameType.OP_FRAME
    )
    model.addFrame(frame)

    body = added_body(
        vehicle.mass, vehicle.com, vehicle.inertia, vehicle.volume, vehicle.cob
    )
    loaded, displaced = with_body(model, "vehicle", body, "vehicle_body")
    return still._rebuilt(loaded, (*still.displacements, displaced))


def trim_angles(upward: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Roll and pitch at which vectors of the vehicle point up, (...) each [rad].

    Args:
        upward: In the vehicle's frame, (..., 3), not zero.
    """
    x, y, z = np.moveaxis(upward, -1, 0)
    roll = np.arctan2(y, z)
    pitch = np.arctan2(-x, np.hypot(y, z))
    return roll, pitch


def warn_upside_down() -> None:
    """Warn of a vehicle that turns over."""
    plausibility.warn(
        "vehicle: at its trim it is upside down; is its cob, in the vehicle's frame "
        "with z up, below its com?"
    )


def static_trim(still: Any, vehicle: Vehicle, q: ArrayLike) -> Trim:
    """Static trim of an arm that carries a vehicle; see `ArmOnVehicle.trim`."""
    gravity = still._model.gravity.linear
    if gravity[0] or gravity[1] or not gravity[2]:
        raise InputError("gravity", gravity.tolist(), "gravity along the world's z")
    g = abs(gravity[2])
    mass = still.total_mass
    displaced_mass = still.fluid_density * still.displaced_volume

    centres = np.array([still.center_of_mass(q), still.center_of_buoyancy(q)])
    com, cob = centres @ vehicle.mount[:3, :3].T + vehicle.mount[:3, 3]

    # At the trim, this vector points up: then weight and buoyancy have no moment about
    # the vehicle's origin.
    righting = g * (displaced_mass * cob - mass * com)
    moment = float(np.linalg.norm(righting))
    if moment < _LEAST_LEVER * g * mass:
        without = "a centre of buoyancy at the centre of mass"
        raise InputError("vehicle", without, "a righting moment")

    roll, pitch = trim_angles(righting * -np.sign(gravity[2]))
    rotation = pin.rpy.rpyToMatrix(roll, pitch, 0.0)
    if righting[2] < 0.0:
        warn_upside_down()
    return Trim(
        roll=float(roll),
        pitch=float(pitch),
        rotation_vehicle_to_world=rotation,
        net_weight=float(g * (mass - displaced_mass)),
        righting_moment=moment,
    )
