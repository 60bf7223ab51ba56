"""A case of a study: the arm in the water with its payload, and what it computes."""

from __future__ import annotations

from collections.abc import Set
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.dynamics import batch
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import SEA_WATER, gravity_in_base
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.studies.sweep.states import States
from alpha5_model.studies.sweep.study import Study
from alpha5_model.studies.uncertainty.sampling import sample
from alpha5_model.trajectory.motors import motor_columns
from alpha5_model.water.trimmed_arm import TrimmedArm

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: The sampled parameter sets of the last study, for some arms.
_sample = lru_cache(maxsize=8)(sample)
_OF_MOTORS = {"current", "power"}
_OF_TORQUE = {"torque", "margin"} | _OF_MOTORS
_OF_MOUNT = {"mount_force", "mount_moment"}


class Case(NamedTuple):
    """What all states of a case share.

    Attributes:
        axes: Axis of the cases -> index of its value.
        arm: An `Arm`, a `HydrodynamicArm` in moving water, or a `TrimmedArm`.
        motors: Of the four joints.
        on_vehicle: The arm in the trim of its vehicle; None without one.
    """

    axes: dict[str, int]
    arm: Any
    motors: list[Actuator]
    on_vehicle: TrimmedArm | None


def case_values(study: Study, number: int) -> tuple[dict[str, int], dict[str, Any]]:
    """Axis -> index, and axis -> value, in a case; the last axis runs fastest."""
    axes = study.axes.cases
    shape = [len(values) for values in axes.values()]
    at = map(int, np.unravel_index(number, shape)) if shape else ()
    index = dict(zip(axes, at, strict=True))
    return index, {name: axes[name][i] for name, i in index.items()}


@lru_cache(maxsize=64)
def case_of(study: Study, number: int) -> Case:
    """A case of a study.

    Raises:
        Alpha5Error: Impossible values of an arm.
    """
    index, values = case_values(study, number)
    own = study.arm_of(values)
    record = _record(study, values, own)
    density = values.get("fluid_density", SEA_WATER)

    def arm_in(gravity: FloatArray) -> Arm:
        return _with_payload(arm_of(record, density, gravity), values)

    arm: Any
    on_vehicle = None
    with plausibility.silenced():  # reading the study gave the warnings
        if "vehicle" in values:
            vehicle = study.vehicles[values["vehicle"]]
            moving = _in_water(arm_in(np.zeros(3)), values, np.eye(3))
            on_vehicle = TrimmedArm(vehicle, density, arm_in, moving)
        if on_vehicle is not None and values.get("trim", True):
            arm = on_vehicle
        else:
            rotation = _mount(study, values, record)
            arm = _in_water(arm_in(gravity_in_base(rotation)), values, rotation)
        motors = [actuator(joint.name, arm=record) for joint in record.joints[:4]]
    return Case(axes=index, arm=arm, motors=motors, on_vehicle=on_vehicle)


def _record(
    study: Study, values: dict[str, Any], own: Alpha5Parameters | None
) -> Alpha5Parameters:
    """The record of a case: with its corrections, or one of the samples.

    Args:
        study: The study.
        values: Axis -> value.
        own: Record of the case's arm of one's own; None for the catalogue's.
    """
    if "parameters" in values:
        samples = _sample(len(study.axes.cases["parameters"]), study.seed, arm=own)
        return samples.parameters(values["parameters"])
    if own is not None:
        return own
    corrections = values.get("corrections", "+".join(DEFAULT_CORRECTIONS))
    return parameters(() if corrections == "none" else corrections.split("+"))


def _with_payload(arm: Arm, values: dict[str, Any]) -> Arm:
    """The arm with the payload of a case, if it has one."""
    if not any(name.startswith("payload_") for name in values):
        return arm
    com = [values.get(f"payload_{axis}", 0.0) for axis in "xyz"]
    volume = values.get("payload_volume", 0.0)
    return arm.with_payload(values.get("payload_mass", 0.0), com, volume=volume)


def _in_water(arm: Arm, values: dict[str, Any], rotation: FloatArray) -> Any:
    """The arm in moving water, if a case has a current or a level.

    Args:
        arm: In still water.
        values: Axis -> value.
        rotation: Of base_link in the world.
    """
    if not {"current_speed", "level"} & {*values}:
        return arm
    azimuth = values.get("current_azimuth", 0.0)
    elevation = values.get("current_elevation", 0.0)
    direction = rotation_from_rpy([0.0, -elevation, azimuth])[:, 0]
    water_velocity = rotation.T @ (values.get("current_speed", 0.0) * direction)
    return arm.with_hydrodynamics(water_velocity, values.get("level", "nominal"))


def _mount(
    study: Study, values: dict[str, Any], record: Alpha5Parameters
) -> FloatArray:
    """Attitude of base_link in the world.

    That of its vehicle's mount, the vehicle level; of the axes; or of the own mount of
    an arm of one's own.
    """
    if "vehicle" in values:
        return np.asarray(study.vehicles[values["vehicle"]].mount[:3, :3])
    angles = ("mount_roll", "mount_pitch", "mount_yaw")
    if record.mount is not None and not {*angles} & {*values}:
        return record.mount.rotation
    return rotation_from_rpy([values.get(angle, 0.0) for angle in angles])


def quantities_of(case: Case, states: States, wanted: Set[str]) -> dict[str, Any]:
    """Quantities by name, (n, columns) each: those that are wanted, and perhaps more.

    Args:
        case: The arm and its motors.
        states: n states.
        wanted: Names of the quantities.
    """
    arm = case.arm
    motion = (states.position, states.velocity, states.acceleration)
    found: dict[str, FloatArray] = {}
    if wanted & _OF_TORQUE:
        torque = arm.inverse_dynamics_batch(*motion, 1)
        found["torque"] = torque
        if "margin" in wanted:
            # No rating is published; this is the placeholder of public models.
            found["margin"] = arm.limits.effort - np.abs(torque)
        if wanted & _OF_MOTORS:
            of_motors = motor_columns(case.motors, states, torque)
            found["current"] = of_motors["current"]
            found["power"] = of_motors["electrical_power"]
    if wanted & _OF_MOUNT:
        wrench = arm.base_wrench_batch(*motion, 1)
        found["mount_force"] = _with_norm(wrench[:, :3])
        found["mount_moment"] = _with_norm(wrench[:, 3:])
    if "reach" in wanted:
        still = getattr(arm, "still", arm)
        found["reach"] = _with_norm(batch.frame_positions(still, states.position))
    if "trim" in wanted and case.on_vehicle is not None:
        found["trim"] = case.on_vehicle.trim(states.position)
    return found


def _with_norm(vectors: FloatArray) -> FloatArray:
    """Vectors (n, 3) and their norms, (n, 4)."""
    norm = np.sqrt((vectors**2).sum(axis=1))
    return np.column_stack([vectors, norm])
