"""What a format has no place for: lines for its file, and for who writes one."""

from __future__ import annotations

from alpha5_model.numbers.motors import joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters


def without_armature(file_format: str, arm: Alpha5Parameters) -> list[str]:
    """A line about rotor inertia, which URDF and SDF cannot hold; none without any.

    Args:
        file_format: Its name.
        arm: Record of the arm.
    """
    rotors = []
    for joint, losses in joint_losses(arm).items():
        if losses.armature:
            rotors.append(f"{joint} {losses.armature:.3g} kg m^2")
    if not rotors:
        return []
    return [f"{file_format} has no rotor inertia; left out: {', '.join(rotors)}."]
