"""The arm of a case, in the water and with the payload of that case, and its motors."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import SEA_WATER, gravity_in_base
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.studies.sweep.study import Study
from alpha5_model.studies.uncertainty.sampling import sample

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.water.arm import HydrodynamicArm

#: The sampled parameter sets of the last study.
_sample = lru_cache(maxsize=1)(sample)


class ArmOfCase(NamedTuple):
    """The arm and the motors that all states of a case share.

    Attributes:
        arm: An `Arm`, or a `HydrodynamicArm` if there is a current.
        motors: Of the four joints.
    """

    arm: Arm | HydrodynamicArm
    motors: list[Actuator]


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
    with plausibility.silenced():  # reading the study gave the warnings
        return _arm(study, values)


def _arm(study: Study, case: dict[str, Any]) -> ArmOfCase:
    """The arm for the values of a case by axis."""
    rotation = _mount(study, case)
    density = case.get("fluid_density", SEA_WATER)
    record = _parameters(study, case)
    arm = arm_of(record, density, gravity_in_base(rotation))
    motors = [actuator(joint, arm=record) for joint in arm.joint_names]

    arm = _with_payload(arm, case)
    if "current_speed" in case:
        current = rotation.T @ _current(case)
        return ArmOfCase(arm=arm.with_hydrodynamics(current), motors=motors)
    return ArmOfCase(arm=arm, motors=motors)


def _mount(study: Study, case: dict[str, Any]) -> FloatArray:
    """Attitude of base_link in the world: of the axes, or of the arm's own mount."""
    angles = ("mount_roll", "mount_pitch", "mount_yaw")
    own = None if study.arm is None else study.arm.mount
    if own is not None and not {*angles} & {*case}:
        return own.rotation
    return rotation_from_rpy([case.get(angle, 0.0) for angle in angles])


def _parameters(study: Study, case: dict[str, Any]) -> Alpha5Parameters:
    """The parameter set of a case: with its corrections, or one of the samples."""
    if "parameters" in case:
        samples = _sample(len(study.cases["parameters"]), study.seed, arm=study.arm)
        return samples.parameters(case["parameters"])
    if study.arm is not None:
        return study.arm
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
    velocity: FloatArray = case["current_speed"] * direction
    return velocity
