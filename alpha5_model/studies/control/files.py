"""Gains in the files of other programs: ros2_control and MuJoCo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import instance
from alpha5_model.description.mjcf import MjcfOptions, Servo, mjcf_files
from alpha5_model.errors import InputError
from alpha5_model.studies.control.pd_gains import Gains


def ros2_control(found: Gains) -> str:
    """YAML of a JointTrajectoryController that commands torques [N m].

    Its law is ``p (q_goal - q) + d (v_goal - v)``. The torque that holds weight and
    buoyancy is not part of it: see the comment in the file.

    Raises:
        InputError: A rate that is not a whole number, which the controller manager
            cannot have.
    """
    rate = instance("found", found, Gains).rate
    if not rate.is_integer():
        raise InputError("rate", rate, "a whole number of samples per second")
    import yaml

    joints = found.arm.joint_names
    controller = {
        "joints": list(joints),
        "command_interfaces": ["effort"],
        "state_interfaces": ["position", "velocity"],
        "gains": {
            joint: {"p": _rounded(p), "i": 0.0, "d": _rounded(d)}
            for joint, p, d in zip(joints, found.stiffness, found.damping, strict=True)
        },
    }
    settings = {
        "controller_manager": {
            "ros__parameters": {
                "update_rate": int(rate),
                "arm_controller": {
                    "type": "joint_trajectory_controller/JointTrajectoryController"
                },
            }
        },
        "arm_controller": {"ros__parameters": controller},
    }
    rotors = ", ".join(f"{inertia:.3g}" for inertia in found.armature)
    comment = (
        f"# Bandwidth {found.bandwidth:.4g} rad/s, delay {1e3 * found.delay:.4g} ms, "
        f"payload up to {found.payload:g} kg,\n"
        f"# inertia of the rotors at the joints {rotors} kg m^2.\n"
        "# p [N m/rad] and d [N m s/rad] are torques at the joints, not motor "
        "currents.\n"
        "# The hardware, or a node of yours, must add the torque that holds weight "
        "and\n"
        "# buoyancy (arm.hydrostatic_torque): without it the arm sags.\n"
    )
    return comment + yaml.safe_dump(settings, sort_keys=False)


def mujoco_files(found: Gains) -> dict[str, bytes]:
    """The folder of ``alpha5 generate mjcf`` whose position servos have these gains.

    They know no weight: add ``arm.hydrostatic_torque(q)`` to ``qfrc_applied``. The
    joints have the rotor inertia of the gains, and the measured friction of the arm's
    record. Gravity is MuJoCo's own, along -z of the world, in which the arm stands as
    the mount of its record says: a ``gravity=`` that the arm was loaded with is not
    carried, nor are delay, rate and moving water.
    """
    instance("found", found, Gains)
    servos = {
        joint: Servo(float(p), float(d))
        for joint, p, d in zip(
            found.arm.joint_names, found.stiffness, found.damping, strict=True
        )
    }
    record = found.arm.parameters
    gears = [motor.gear_ratio for motor in record.actuators[:4]]
    rotors = tuple((found.armature / np.square(gears)).tolist())
    motors = replace(record.motors, rotor_inertias=(*rotors, None))
    options = MjcfOptions(
        arm=replace(record, motors=motors),
        fluid_density=found.arm.fluid_density,
        servos=servos,
    )
    return mjcf_files(options)


def _rounded(number: float) -> float:
    """A gain to four digits, which is closer than anything it is computed from."""
    return float(f"{number:.4g}")
