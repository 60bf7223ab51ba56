"""Both arms, aligned and measured: what the findings are taken from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.alignment import Alignment, Tolerance, allowed
from alpha5_model.proofs.comparison.correction import (
    JointCorrection,
    joint_corrections,
    tool_correction,
)
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.records import BodyDifference


@dataclass(frozen=True, eq=False)
class Evidence:
    """Both arms, aligned and measured.

    Attributes:
        ours: Our arm.
        other: The other model as read.
        theirs: Its arm as it is meant, with exact multiples of pi.
        written: Its arm as it is written.
        alignment: The alignment of ``theirs``.
        bodies: Its bodies, compared with the tables.
        folder: Where its meshes are; None if unknown.
        q: Our joint positions at which costs are evaluated, (N, 4) [rad].
    """

    ours: OwnArm
    other: UrdfRobot
    theirs: FourJointArm
    written: FourJointArm
    alignment: Alignment
    bodies: tuple[BodyDifference, ...]
    folder: Path | None
    q: FloatArray

    @property
    def parameters(self) -> Alpha5Parameters:
        """The numbers of our arm."""
        return self.ours.parameters

    @cached_property
    def tolerance(self) -> Tolerance:
        """Differences of the axes that are no findings."""
        return allowed(self.parameters, self.theirs, short_pi=True)

    @cached_property
    def corrections(self) -> tuple[JointCorrection, ...]:
        """Corrections of the four joints, base to tip."""
        return joint_corrections(self.ours, self.written, self.theirs, self.alignment)

    @cached_property
    def joint_replacements(self) -> list[str]:
        """What to write in place of each of the four joints; "" if it is right."""
        return [correction.text for correction in self.corrections]

    @cached_property
    def tool_correction(self) -> JointCorrection | None:
        """Correction of the joint that carries their tool frame, if they have one."""
        if not self.theirs.tool:
            return None
        return tool_correction(self.ours, self.other, self.theirs, self.alignment)

    def torque_change(self, arm: FourJointArm, q: FloatArray) -> float:
        """Largest difference of gravity torques in air from our arm's [N m].

        Args:
            arm: The arm to compare with ours.
            q: Its joint positions; ours are at ``self.q``, (N, 4) [rad].
        """
        ours = self.ours.reduced.gravity_torque(self.q)
        return float(np.abs(arm.gravity_torque(q) - ours).max())
