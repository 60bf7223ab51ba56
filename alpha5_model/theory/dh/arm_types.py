"""Classify a chain as a revolute, SCARA, cartesian or other arm.

References:
    [Lecture7.1] Describing Robot Arms, sections "Joint Types" and "Arm Types".
    [Siciliano2009] Siciliano et al.: Robotics, section 1.2.1 (manipulator structures).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.frame_assignment import unit_vectors

#: Angles below this count as zero when axes are compared [rad].
ANGLE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class ArmType:
    """Classification of a chain.

    Attributes:
        kind: ``revolute`` (all joints are), ``scara``, ``cartesian`` or ``other``.
        joints: One letter per joint, R or P, base to tip.
        horizontal: Whether all axes are vertical, so that all links move in horizontal
            planes.
        reason: The geometry that decided, in one sentence.
    """

    kind: str
    joints: str
    horizontal: bool
    reason: str


def classify(chain: DHChain, vertical: ArrayLike = (0.0, 0.0, 1.0)) -> ArmType:
    """The type of an arm, from the directions of its axes at home.

    Only facts that hold at every configuration count: whether all revolute joints are
    parallel, and the directions of prismatic joints before the first revolute joint.

    - revolute: all joints are revolute;
    - scara: at least two revolute joints whose axes are vertical, parallel and apart,
      so that the major links move in a horizontal plane, and a prismatic joint along
      them;
    - cartesian: the first three joints are prismatic and perpendicular to one another.

    Args:
        chain: The arm.
        vertical: Direction of the vertical in the world, (3,).
    """
    up = unit_vectors("vertical", vertical)
    points, z = instance("chain", chain, DHChain).joint_axes(chain.home)
    vertical_axes = np.linalg.norm(np.cross(z, up), axis=1) <= ANGLE_TOLERANCE
    turning = np.array(chain.sigma) == 0
    # The major links are those up to the first joint that tilts: a wrist may follow.
    major = chain.n if vertical_axes.all() else int(np.argmin(vertical_axes))
    revolute_points = points[:major][turning[:major]]

    if turning.all():
        kind, reason = "revolute", "all joints are revolute"
    elif chain.n >= 3 and not turning[:3].any():
        kind, reason = _of_three_sliding(z[:3])
    elif _apart(revolute_points, up) and not turning[:major].all():
        kind = "scara"
        reason = (
            f"{len(revolute_points)} vertical revolute axes apart and a vertical "
            "prismatic one: the major links move in a horizontal plane"
        )
    else:
        kind, reason = "other", _why_other(chain, major, len(revolute_points))
    return ArmType(
        kind=kind,
        joints="".join("RP"[sigma] for sigma in chain.sigma),
        horizontal=bool(vertical_axes.all()),
        reason=reason,
    )


def _of_three_sliding(z: FloatArray) -> tuple[str, str]:
    """Kind and reason of an arm whose first three joints slide along z, (3, 3)."""
    if np.allclose(z @ z.T, np.eye(3), rtol=0, atol=ANGLE_TOLERANCE):
        return "cartesian", "the first three joints slide along perpendicular axes"
    return "other", "the first three joints slide, but not along perpendicular axes"


def _apart(points: FloatArray, up: FloatArray) -> bool:
    """Whether vertical axes through points (N, 3) include two different ones."""
    if len(points) < 2:
        return False
    distance = np.linalg.norm(np.cross(points - points[0], up), axis=1)
    return bool((distance > 0).any())


def _why_other(chain: DHChain, major: int, vertical: int) -> str:
    """Why an arm is none of the kinds that have a name.

    Args:
        chain: The arm, with a prismatic joint.
        major: Number of joints before the first whose axis is not vertical.
        vertical: Number of revolute joints among them.
    """
    if all(chain.sigma):
        return f"{chain.n} prismatic joints, not three perpendicular ones"
    if major == 0:
        return "a prismatic joint, and the first axis is not vertical"
    return (
        f"a prismatic joint, and only {vertical} vertical revolute axes "
        "before one that is not vertical"
    )
