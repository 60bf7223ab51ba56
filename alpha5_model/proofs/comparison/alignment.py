"""How another model's joint coordinates and base frame relate to ours."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import AS_IT_IS, DIMENSIONS

#: A smaller zero counts as ours.
SAME_ZERO = 0.005  # [rad]
#: Smaller differences of axes and of their angles are no findings. The angle moves the
#: tip by 0.03 mm.
LENGTH_TOLERANCE, ANGLE_TOLERANCE = 1e-5, 1e-4  # [m], [rad]


@dataclass(frozen=True, eq=False)
class Alignment:
    """Another model's coordinates in ours: ``q_theirs = sign * q_ours + zero``.

    Attributes:
        base: transform_theirs_to_ours of the root frames, (4, 4).
        sign: +1 or -1 per joint, (4,).
        zero: Position of the other joint at our zero, (4,) [rad].
        dimensions: Theirs minus ours, (8,) [m, rad]: a_0, a_1, a_2, d_1, alpha_0,
            alpha_1, alpha_2 and the elbow's tilt beta_1; zero for those not fitted.
        residual: How far their axes remain from ours, root mean square over positions
            and axes: the entries of the lines (moment [m] and direction), and the angle
            between the lines [rad].
        base_link: Their link whose frame comes closest to our base_link.
        stands: Pose of that link's frame in our base_link, (4, 4).
        same_base: Whether that frame was meant to be our base_link.
        exact: The alignment with all dimensions fitted, even those that differ only by
            their printed digits; None in such an alignment itself.
    """

    base: FloatArray = field(default_factory=lambda: np.eye(4))
    sign: FloatArray = field(default_factory=lambda: np.ones(4))
    zero: FloatArray = field(default_factory=lambda: np.zeros(4))
    dimensions: FloatArray = field(default_factory=AS_IT_IS.copy)
    residual: tuple[float, float] = (math.nan, math.nan)
    base_link: str = ""
    stands: FloatArray = field(default_factory=lambda: np.eye(4))
    same_base: bool = False
    exact: Alignment | None = None

    @property
    def oddities(self) -> int:
        """Number of reversed joints and shifted zeros."""
        is_reversed = np.signbit(self.sign)
        is_shifted = np.abs(self.zero) > SAME_ZERO
        return int(is_reversed.sum() + is_shifted.sum())

    def changes(self) -> dict[str, float]:
        """The dimensions that differ, theirs minus ours [m, rad]."""
        found = zip(DIMENSIONS, self.dimensions.tolist(), strict=True)
        return {name: change for name, change in found if change}

    def theirs(self, q: FloatArray) -> FloatArray:
        """The other model's joint positions for ours."""
        return self.sign * q + self.zero


class Tolerance(NamedTuple):
    """Differences that are no findings: of lengths [m] and of angles [rad]."""

    length: float
    angle: float


def allowed(
    parameters: Alpha5Parameters, theirs: FourJointArm, short_pi: bool = False
) -> Tolerance:
    """Differences that the printed digits and the tolerances allow.

    Rounded lengths turn the axes by their error over the length of the upper arm.

    Args:
        parameters: Our arm.
        theirs: The other arm.
        short_pi: Allow the error of a pi that is cut short as well: it may hide in
            angles that were computed from it.
    """
    upper_arm = parameters.dh[1].a
    digits = theirs.digits
    pi = 2 * digits.pi if short_pi else 0.0
    turns = math.hypot(digits.angle, digits.length / upper_arm, pi)
    return Tolerance(
        length=max(LENGTH_TOLERANCE, digits.length, upper_arm * pi),
        angle=max(ANGLE_TOLERANCE, turns),
    )
