"""What an arm is and can do: its type, and the tasks that its poses allow.

References:
    [Lecture7.1] Describing Robot Arms, sections "Joint Types", "Arm Types", "Task
        requirements" and "Dexterous Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, section 1.2.1 (manipulator structures).
    [Lynch2017] Lynch, Park: Modern Robotics, sections 2.5 (task space) and 5.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray, instance
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.planar import Conditions

#: Angles below this count as zero when axes are compared [rad].
ANGLE_TOLERANCE = 1e-9
#: Dimension of SE(3), and of vertical insertion, SE(2) x I.
GENERAL, INSERTION = 6, 4
#: Configurations at which ranks are computed.
_SAMPLES = 64
#: Singular values below this count as zero; lengths are divided by the arm's size
#: first.
_RANK = 1e-8
#: A horizontal part of the tool axis below this counts as none.
_VERTICAL = 1e-12
#: Configurations with a vertical tool axis that are examined.
_STARTS = 16
#: Singular values below this leave the tool axis vertical.
_MOVES = 1e-6
_NEWTON_STEPS = 40
#: The vertical, and two horizontal directions.
UP = np.array([0.0, 0.0, 1.0])
_HORIZONTAL = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


# Types
# --------------------------------------------------------------------------------------


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


def classify(chain: DHChain) -> ArmType:
    """The type of an arm, from the directions of its axes at home.

    Only facts that hold at every configuration count: whether all revolute joints are
    parallel, and the directions of prismatic joints before the first revolute joint.

    - revolute: all joints are revolute;
    - scara: at least two revolute joints whose axes are vertical, parallel and apart,
      so that the major links move in a horizontal plane, and a prismatic joint along
      them;
    - cartesian: the first three joints are prismatic and perpendicular to one another.

    Args:
        chain: The arm. Its base places it: the world's z axis is vertical.
    """
    points, z = instance("chain", chain, DHChain).joint_axes(chain.home)
    vertical_axes = np.linalg.norm(np.cross(z, UP), axis=1) <= ANGLE_TOLERANCE
    turning = np.array(chain.sigma) == 0
    # The major links are those up to the first joint that tilts: a wrist may follow.
    major = chain.n if vertical_axes.all() else int(np.argmin(vertical_axes))
    upright = points[:major][turning[:major]]
    apart = np.linalg.norm(np.cross(upright - upright[:1], UP), axis=1).any()

    kind = "other"
    if turning.all():
        kind, reason = "revolute", "all joints are revolute"
    elif chain.n >= 3 and not turning[:3].any():
        reason = "the first three joints slide, but not along perpendicular axes"
        if np.allclose(z[:3] @ z[:3].T, np.eye(3), rtol=0, atol=ANGLE_TOLERANCE):
            kind = "cartesian"
            reason = "the first three joints slide along perpendicular axes"
    elif apart and not turning[:major].all():
        kind = "scara"
        reason = (
            f"{len(upright)} vertical revolute axes apart and a vertical "
            "prismatic one: the major links move in a horizontal plane"
        )
    elif not turning.any():
        reason = f"{chain.n} prismatic joints, not three perpendicular ones"
    elif major == 0:
        reason = "a prismatic joint, and the first axis is not vertical"
    else:
        reason = (
            f"a prismatic joint, and only {len(upright)} vertical revolute axes "
            "before one that is not vertical"
        )
    return ArmType(
        kind=kind,
        joints="".join("RP"[sigma] for sigma in chain.sigma),
        horizontal=bool(vertical_axes.all()),
        reason=reason,
    )


# Tasks
# --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class TaskCapability:
    """Tasks that the set of reachable end-effector poses allows.

    Attributes:
        dimension: Dimension of that set: the largest rank of the Jacobian, 0 to 6.
        position_dimension: Dimension of the set of reachable positions, 0 to 3.
        orientation_dimension: Dimension of the set of reachable orientations, 0 to 3.
        insertion_dimension: Dimension of the set of poses whose tool axis stays
            vertical, 0 to 4; 0 also if no sample could be brought to a vertical tool
            axis.
        general: Whether it serves general tasks: a 6-D subset of SE(3).
        general_reason: Why, or why not.
        vertical_insertion: Whether it serves vertical insertion: a 4-D subset of SE(2)
            x I.
        insertion_reason: Why, or why not.
    """

    dimension: int
    position_dimension: int
    orientation_dimension: int
    insertion_dimension: int
    general: bool
    general_reason: str
    vertical_insertion: bool
    insertion_reason: str


def task_capability(chain: DHChain) -> TaskCapability:
    """Which tasks an arm can serve, from Jacobian ranks over sampled configurations.

    The map from joint positions to poses is analytic. So the rank is largest almost
    everywhere, and the set of poses has that dimension. The tool axis is the last
    joint's. Random samples do not have it vertical, so Newton steps bring it there. A
    direction of motion keeps it vertical if a finite step along it needs only a
    second-order correction.

    Args:
        chain: The arm; joints without limits are sampled over a turn (revolute) or over
            the arm's own size (prismatic). Its base places it: the world's z axis is
            vertical.
    """
    rng = np.random.default_rng(0)
    q = _sampled(instance("chain", chain, DHChain), rng)

    jacobian = chain.jacobian(q) / _scale(chain)
    dimension = _rank(jacobian)
    if dimension == GENERAL:
        general_reason = (
            "the Jacobian has rank 6, so the poses fill an open set of SE(3)"
        )
    elif chain.n < GENERAL:
        general_reason = (
            f"{chain.n} joints reach at most {chain.n} of the 6 dimensions of SE(3); "
            f"the Jacobian has rank {dimension}"
        )
    else:
        general_reason = (
            f"{chain.n} joints, but the Jacobian never has more than rank {dimension}"
        )

    insertion = _insertion_dimension(chain, q, rng)
    insertion_reason = f"with its tool axis vertical it moves in {insertion} dimensions"
    if insertion == INSERTION:
        insertion_reason += ": x, y, z and the turn about it"
    elif insertion:
        insertion_reason += " where 4 are needed"
    else:
        insertion_reason = "the tool axis could not be brought to the vertical"
    return TaskCapability(
        dimension=dimension,
        position_dimension=_rank(jacobian[:, :3]),
        orientation_dimension=_rank(jacobian[:, 3:]),
        insertion_dimension=insertion,
        general=dimension == GENERAL,
        general_reason=general_reason,
        vertical_insertion=insertion == INSERTION,
        insertion_reason=insertion_reason,
    )


def _sampled(chain: DHChain, rng: np.random.Generator) -> FloatArray:
    """Uniform joint positions within the limits, (M, N)."""
    span = np.where(np.array(chain.sigma) == 0, math.pi, _size(chain))
    # A joint with one limit is sampled over the same width from that limit.
    least = np.where(np.isfinite(chain.upper), chain.upper - 2 * span, -span)
    lower = np.where(np.isfinite(chain.lower), chain.lower, least)
    upper = np.where(np.isfinite(chain.upper), chain.upper, lower + 2 * span)
    return np.asarray(rng.uniform(lower, upper, (_SAMPLES, chain.n)))


def _size(chain: DHChain) -> float:
    """A length of the order of the arm's reach [m]."""
    total = float(np.linalg.norm(chain.tool[:3, 3]))
    for link in chain.links:
        travel = (link.lower, link.upper, link.d) if link.sigma else (link.d,)
        farthest = max(abs(x) for x in travel if math.isfinite(x))
        total += abs(link.a) + farthest
    return total or 1.0


def _scale(chain: DHChain) -> FloatArray:
    """By which to divide the rows of a Jacobian, (6, 1): metres become radians."""
    return np.array([_size(chain)] * 3 + [1.0] * 3)[:, None]


def _rank(matrices: FloatArray) -> int:
    """The largest rank of matrices (..., m, n) whose entries are of order 1."""
    return int(np.linalg.matrix_rank(matrices, tol=_RANK).max())


def _insertion_dimension(
    chain: DHChain, q: FloatArray, rng: np.random.Generator
) -> int:
    """Dimension of the set of poses whose tool axis is vertical.

    Args:
        chain: The arm.
        q: Joint positions from which to bring the axis there, (M, N).
        rng: Of the directions of motion that are tried.
    """
    q, tilt = _to_vertical(chain, q)
    good = np.abs(tilt).max(axis=1) < _VERTICAL
    good &= ((q >= chain.lower) & (q <= chain.upper)).all(axis=1)
    best = 0
    for start in q[good][:_STARTS]:
        jacobian = chain.jacobian(start) / _scale(chain)
        _, s, vt = np.linalg.svd(_HORIZONTAL @ jacobian[3:])
        tangents = vt[int((s > _MOVES).sum()) :]
        rank = _rank(jacobian @ tangents.T) if len(tangents) else 0
        if rank <= best:
            continue
        weights = rng.normal(size=len(tangents))
        step = weights @ tangents / np.linalg.norm(weights)

        # If the axis can stay vertical along the step, the correction after a step of
        # size h is of order h^2.
        gaps = []
        for h in (1e-2, 1e-3):
            along = start + h * step
            moved, _ = _to_vertical(chain, along[None])
            gaps.append(float(np.linalg.norm(moved[0] - along)) / h)
        if gaps[1] < 0.2 * gaps[0] or gaps[1] < 1e-6:
            best = rank
    return best


def _to_vertical(chain: DHChain, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bring the tool axis to the vertical by Newton steps.

    Args:
        chain: The arm.
        q: Joint positions to start from, (M, N).

    Returns:
        Joint positions (M, N), and the horizontal part of the axis there, (M, 2).
    """
    # The last joint's axis, which is constant in the tool frame.
    frames = chain.frames(chain.home)
    axis = frames[-1, :3, :3].T @ frames[chain.n - 1, :3, 2]
    q = q.copy()
    for left in reversed(range(_NEWTON_STEPS + 1)):
        direction = chain.forward_kinematics(q)[:, :3, :3] @ axis
        tilt: FloatArray = direction @ _HORIZONTAL.T
        if not left or np.abs(tilt).max(initial=0.0) < 1e-14:
            break
        columns = np.cross(chain.jacobian(q)[:, 3:], direction[:, :, None], axis=1)
        rate = np.einsum("ki,mij->mkj", _HORIZONTAL, columns)
        correction = np.linalg.pinv(rate, rcond=1e-4) @ tilt[:, :, None]
        q -= np.clip(correction[:, :, 0], -0.5, 0.5)
    return q, tilt


def spatial_conditions(chain: DHChain) -> Conditions:
    """The notes' necessary conditions for a dexterous workspace with an interior.

    Three revolute joints must turn the end effector, and three more joints must place
    it. Without the latter, single points can still be dexterous: for example the point
    in which three axes intersect.
    """
    revolute = instance("chain", chain, DHChain).sigma.count(0)
    reasons = []
    if revolute < 3:
        reasons.append(
            f"{revolute} revolute where turning the end effector takes three"
        )
    others = chain.n - min(revolute, 3)
    if others < 3:
        reasons.append(
            f"{others} more, beside them, where placing the end effector takes three"
        )
    return Conditions(satisfied=not reasons, reasons=tuple(reasons))
