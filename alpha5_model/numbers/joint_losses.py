"""Armature, friction and damping of the joints, as simulators take them."""

from __future__ import annotations

from typing import NamedTuple

from alpha5_model.numbers.parameters import Alpha5Parameters, parameters


class JointLosses(NamedTuple):
    """What a motor adds to a joint.

    Attributes:
        armature: Rotor inertia at the joint [kg m^2].
        friction: Coulomb friction at the joint, the mean of both directions [N m].
        damping: Viscous friction at the joint [N m s/rad].
    """

    armature: float
    friction: float
    damping: float


def joint_losses(arm: Alpha5Parameters) -> dict[str, JointLosses]:
    """Joint -> what its motor adds, for the joints of which something was measured.

    Table 4's friction is left out: it is not measured, and a public driver contradicts
    it. The jaw rod is left out, whose screw lead is not known.
    """
    found = {}
    printed = parameters(arm.corrections).actuators
    for k, joint in enumerate(arm.joints[:4]):
        actuator = arm.actuators[k]
        backward = arm.motors.backward_frictions[k]
        is_own = backward is not None or actuator.friction != printed[k].friction
        other = actuator.friction if backward is None else backward
        friction = (actuator.friction + other) / 2 if is_own else 0.0

        gear = actuator.gear_ratio
        losses = JointLosses(
            armature=(arm.motors.rotor_inertias[k] or 0.0) * gear**2,
            friction=friction * gear,
            damping=(arm.motors.viscous_frictions[k] or 0.0) * gear**2,
        )
        if any(losses):
            found[joint.name] = losses
    return found
