"""Inverse kinematics of the tcp position in closed form, with all solutions.

The plane of the arm (`alpha5_model.kinematics.plane`) can face the target or face away
from it, and in the plane two links reach a point with the elbow on either side: four
branches. The document prints the first two (Sections 1.3 and 1.4;
`published_inverse_kinematics`), by arccos. With half angles no digits are lost at the
edge of reach (alpha is by the law of tangents). With R = hypot(x, y), f = +1 if the
plane faces the target and -1 if it faces away, e = +1 and -1 for the flipped elbow:

    r = f R - a_0,  rho^2 = r^2 + (z - d_0)^2
    t = sqrt((rho^2 - (l_1 - l_2)^2) / ((l_1 + l_2)^2 - rho^2))
    gamma = 2 e atan(t)
    phi = atan2(z - d_0, r) - e alpha
    alpha = pi/2 - atan(t) + atan(k / t),  k = (l_2 - l_1) / (l_2 + l_1)

The kernel, made from `alpha5_model.codegen.inverse_kinematics`, computes the same for
any lengths and any tool point, and also at every edge: of the yaw axis, of reach, of a
joint's range.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.12.2.
"""

from __future__ import annotations

from numpy.typing import ArrayLike

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics import published_formulas, solver
from alpha5_model.kinematics.catalogue_arm import catalogue, kinematics_of
from alpha5_model.kinematics.solutions import BRANCHES, SolutionArrays
from alpha5_model.numbers.parameters import Alpha5Parameters

__all__ = [
    "BRANCHES",
    "ArmSolutions",
    "Solutions",
    "inverse_kinematics",
    "published_inverse_kinematics",
]


class Solutions(SolutionArrays):
    """All solutions of a set of targets. Arrays are read-only.

    Attributes:
        q: Joint positions, (..., 4, 4): branch axis (`BRANCHES`), joint axis [rad]; NaN
            if the branch does not reach the target. Angles are shifted by full turns
            into the joint's range, or as near to its middle as possible.
        exists: The branch reaches the target, limits aside, (..., 4).
        within_limits: It exists and respects all four joint limits, (..., 4).
        singular: The target lies on the yaw axis, or at the edge of a branch that
            reaches it: arm stretched or folded, where the two elbows coincide, (...).
        position: The targets, (..., 3) [m].
    """

    __slots__ = ()

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4).

        The jaws are closed, and bodies are as in `Arm.in_collision`.
        """
        return catalogue().collides(self)

    def best(self, q_reference: ArrayLike, allow_collision: bool = False) -> FloatArray:
        """The solution nearest to a joint position, within limits and free.

        Nearest means the least Euclidean norm of the four joint differences [rad]. On
        the yaw axis theta_0 is free: the reference's is taken, clipped to its range. If
        the arm touches itself there, the nearest theta_0 at which it does not is taken.

        Args:
            q_reference: (4,) or (..., 4) [rad].
            allow_collision: Choose also among the solutions that collide.

        Returns:
            (..., 4) [rad].

        Raises:
            UnreachableError: A target that no branch reaches within the limits, with
                the distance to the nearest point that is reached and that point.
            SelfCollisionError: A kind of `UnreachableError`: all branches within the
                limits collide. It names the links and what would free the target.
            JointLimitError: The given wrist angle is beyond the limits of axis_b.
        """
        return catalogue().best(self, q_reference, allow_collision)


class ArmSolutions(Solutions):
    """The same of an arm other than the catalogue's.

    Attributes:
        arm: Its record, to which `best` refers.
    """

    arm: Alpha5Parameters

    @property
    def collides(self) -> BoolArray:
        """It is within the limits, and the arm touches itself there, (..., 4)."""
        return kinematics_of(self.arm).collides(self)

    def best(self, q_reference: ArrayLike, allow_collision: bool = False) -> FloatArray:
        """The solution nearest to a joint position, within limits and free.

        As `Solutions.best`. With a tool beside the wrist axis, the error of a target
        that is out of reach does not know the nearest point.
        """
        return kinematics_of(self.arm).best(self, q_reference, allow_collision)


def inverse_kinematics(
    position: ArrayLike,
    wrist: ArrayLike = 0.0,
    *,
    arm: Alpha5Parameters | None = None,
) -> Solutions:
    """Every joint position that puts the tcp at a point.

    On the yaw axis (within 1e-9 m of it) theta_0 is free: the middle of its range is
    returned, the tcp is put on the axis itself and ``singular`` is set. A batch of N
    targets needs memory for its output, 137 bytes per target, and a scratch that does
    not grow with N.

    An arm of your own has its lengths, zeros, limits and tool point. If the tool point
    is beside the wrist axis, theta_3 moves it: a target may be out of reach at one
    wrist angle, and within reach at another.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].
        wrist: theta_3, which moves no point of the wrist axis; it broadcasts against
            ``position``'s leading axes [rad].
        arm: Record of the arm; None is the catalogue's.

    Returns:
        Four branches per target, whether each exists and respects the limits.

    Raises:
        InputError: Not real numbers, or shapes that do not fit; `NonFiniteError` names
            a bad row.
    """
    if arm is not None:
        of_arm = kinematics_of(arm)
        answer = solver.solve(ArmSolutions, position, wrist, of_arm.shape)
        answer.arm = arm
        return answer

    return solver.solve(Solutions, position, wrist, catalogue().shape)


def published_inverse_kinematics(position: ArrayLike) -> FloatArray:
    """The two poses that the document solves, by its formulas to the letter.

    The formulas wrap no angle, check no limit and leave out the wrist.
    `inverse_kinematics` gives all four solutions with flags.

    Args:
        position: tcp in ``base_link``, (..., 3) [m].

    Returns:
        theta_0, theta_1, theta_2 of the underarm pose (Section 1.3) and the overarm
        pose (Section 1.4), (..., 2, 3) [rad]; NaN if the formulas have no value.

    Raises:
        InputError: Not real numbers of that shape; `NonFiniteError` names a bad row.
    """
    return published_formulas.published_inverse_kinematics(
        catalogue().parameters, position
    )
