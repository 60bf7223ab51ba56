"""The arm of a case, in the water and with the payload of that case, and its motors."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import SEA_WATER, gravity_in_base
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.studies.sweep.study import Study
from alpha5_model.studies.sweep.trimmed_arm import ArmInTrim, TrimOfVehicle
from alpha5_model.studies.uncertainty.sampling import sample

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.water.arm import HydrodynamicArm

#: The sampled parameter sets of the last study, for some arms.
_sample = lru_cache(maxsize=8)(sample)


class ArmOfCase(NamedTuple):
    """The arm and the motors that all states of a case share.

    Attributes:
        arm: An `Arm`, a `HydrodynamicArm` in moving water, or an `ArmInTrim`.
        motors: Of the four joints.
        trim: Of its vehicle; None without one.
    """

    arm: Arm | HydrodynamicArm | ArmInTrim
    motors: list[Actuator]
    trim: TrimOfVehicle | None


@lru_cache(maxsize=64)
def arm_of_case(study: Study, case_index: tuple[tuple[str, int], ...]) -> ArmOfCase:
    """The arm of a case.

    Args:
        study: The study.
        case_index: Axis and index of its value, for all axes of cases.

    Raises:
        Alpha5Error: Impossible values of an arm.
    """
    values: dict[str, Any] = {name: study.cases[name][i] for name, i in case_index}
    record = _parameters(study, values, study.arm_of(dict(case_index)))
    with plausibility.silenced():  # reading the study gave the warnings
        return _arm(study, values, record)


def _arm(study: Study, case: dict[str, Any], record: Alpha5Parameters) -> ArmOfCase:
    """The arm for the values of a case by axis."""

    def arm_in(gravity: FloatArray) -> Arm:
        return _with_payload(arm_of(record, density, gravity), case)

    density = case.get("fluid_density", SEA_WATER)
    trim = None
    if "vehicle" in case:
        trim = TrimOfVehicle(study.vehicles[case["vehicle"]], arm_in, density)
    motors = [actuator(joint.name, arm=record) for joint in record.joints[:4]]
    arm: Arm | HydrodynamicArm | ArmInTrim
    if trim is not None and case.get("trim", True):
        moving = _in_water(arm_in(np.zeros(3)), case, np.eye(3))
        arm = ArmInTrim(moving, trim)
    else:
        rotation = _mount(study, case, record)
        arm = _in_water(arm_in(gravity_in_base(rotation)), case, rotation)
    return ArmOfCase(arm=arm, motors=motors, trim=trim)


def _in_water(arm: Arm, case: dict[str, Any], rotation: FloatArray) -> Any:
    """The arm in moving water, if a case has a current or a level.

    Args:
        arm: In still water.
        case: Axis -> value.
        rotation: Of base_link in the world.
    """
    if not {"current_speed", "level"} & {*case}:
        return arm
    current = rotation.T @ _current(case)
    return arm.with_hydrodynamics(current, case.get("level", "nominal"))


def _mount(study: Study, case: dict[str, Any], record: Alpha5Parameters) -> FloatArray:
    """Attitude of base_link in the world.

    That of its vehicle's mount, the vehicle level; of the axes; or of the own mount of
    an arm of one's own.
    """
    if "vehicle" in case:
        return study.vehicles[case["vehicle"]].mount[:3, :3]
    angles = ("mount_roll", "mount_pitch", "mount_yaw")
    if record.mount is not None and not {*angles} & {*case}:
        return record.mount.rotation
    return rotation_from_rpy([case.get(angle, 0.0) for angle in angles])


def _parameters(
    study: Study, case: dict[str, Any], own: Alpha5Parameters | None
) -> Alpha5Parameters:
    """The parameter set of a case: with its corrections, or one of the samples.

    Args:
        study: The study.
        case: Axis -> value.
        own: Record of the case's arm of one's own; None for the catalogue's.
    """
    if "parameters" in case:
        samples = _sample(len(study.cases["parameters"]), study.seed, arm=own)
        return samples.parameters(case["parameters"])
    if own is not None:
        return own
    joined = case.get("corrections", "+".join(DEFAULT_CORRECTIONS))
    names = joined.replace("none", "").split("+")
    return parameters(filter(None, names))


def _with_payload(arm: Arm, case: dict[str, Any]) -> Arm:
    """The arm with the payload of a case, if it has one."""
    if not any(name.startswith("payload_") for name in case):
        return arm
    com = [
        case.get("payload_x", 0.0),
        case.get("payload_y", 0.0),
        case.get("payload_z", 0.0),
    ]
    mass = case.get("payload_mass", 0.0)
    return arm.with_payload(mass, com, volume=case.get("payload_volume", 0.0))


def _current(case: dict[str, Any]) -> FloatArray:
    """Velocity of the water in the world, (3,) [m/s]."""
    elevation = case.get("current_elevation", 0.0)
    azimuth = case.get("current_azimuth", 0.0)
    direction = rotation_from_rpy([0.0, -elevation, azimuth])[:, 0]
    velocity: FloatArray = case.get("current_speed", 0.0) * direction
    return velocity
