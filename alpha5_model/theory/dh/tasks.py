"""Which tasks an arm can do, by the dimension of the set of poses that it reaches.

References:
    [Lecture7.1] Describing Robot Arms, sections "Task requirements" and "Dexterous
        Workspace".
    [Lynch2017] Lynch, Park: Modern Robotics, sections 2.5 (task space) and 5.1.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, generator, instance
from alpha5_model._support.checks import count as whole_number
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.frame_assignment import unit_vectors
from alpha5_model.theory.dh.sampling import (
    jacobian_scale,
    matrix_rank,
    sample_configurations,
)
from alpha5_model.theory.planar import Conditions

#: Dimension of SE(3), and of vertical insertion, SE(2) x I.
GENERAL, INSERTION = 6, 4
#: A horizontal part of the tool axis below this counts as none.
_VERTICAL = 1e-12
#: Configurations with a vertical tool axis that are examined.
_STARTS = 16
#: Singular values below this leave the tool axis vertical.
_MOVES = 1e-6
_NEWTON_STEPS = 40


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


def task_capability(
    chain: DHChain,
    tool_axis: ArrayLike | None = None,
    vertical: ArrayLike = (0.0, 0.0, 1.0),
    samples: int = 64,
    seed: int = 0,
) -> TaskCapability:
    """Which tasks an arm can serve, from Jacobian ranks over sampled configurations.

    The map from joint positions to poses is analytic. So the rank is largest almost
    everywhere, and the set of poses has that dimension. Random samples have no vertical
    tool axis, so Newton steps bring them there. A direction of motion keeps the axis
    vertical if a finite step along it needs only a second-order correction.

    Args:
        chain: The arm; joints without limits are sampled over a turn (revolute) or over
            the arm's own size (prismatic).
        tool_axis: Axis that is to stay vertical, (3,) in the tool frame; by default the
            axis of the last joint.
        vertical: Direction of the vertical in the world, (3,).
        samples: Number of configurations.
        seed: Of the samples.
    """
    up = unit_vectors("vertical", vertical)
    instance("chain", chain, DHChain)
    if tool_axis is None:
        tool_axis = _last_axis(chain)
    axis = unit_vectors("tool_axis", tool_axis)
    rng = generator(seed)
    q = sample_configurations(chain, whole_number("samples", samples), rng)

    jacobian = chain.jacobian(q) / jacobian_scale(chain)
    dimension = int(matrix_rank(jacobian).max())
    insertion = _insertion_dimension(chain, axis, up, q, rng)
    return TaskCapability(
        dimension=dimension,
        position_dimension=int(matrix_rank(jacobian[:, :3]).max()),
        orientation_dimension=int(matrix_rank(jacobian[:, 3:]).max()),
        insertion_dimension=insertion,
        general=dimension == GENERAL,
        general_reason=_general_reason(chain, dimension),
        vertical_insertion=insertion == INSERTION,
        insertion_reason=_insertion_reason(insertion),
    )


def _last_axis(chain: DHChain) -> FloatArray:
    """Axis of the last joint in the tool frame, where it is constant, (3,)."""
    frames = chain.frames(chain.home)
    return np.asarray(frames[-1, :3, :3].T @ frames[chain.n - 1, :3, 2])


def _general_reason(chain: DHChain, dimension: int) -> str:
    """Why an arm serves general tasks, or why not."""
    if dimension == GENERAL:
        return "the Jacobian has rank 6, so the poses fill an open set of SE(3)"
    if chain.n < GENERAL:
        return (
            f"{chain.n} joints reach at most {chain.n} of the 6 dimensions of SE(3); "
            f"the Jacobian has rank {dimension}"
        )
    return f"{chain.n} joints, but the Jacobian never has more than rank {dimension}"


def _insertion_reason(dimension: int) -> str:
    """Why an arm serves vertical insertion, or why not."""
    moves = f"with its tool axis vertical it moves in {dimension} dimensions"
    if dimension == INSERTION:
        return f"{moves}: x, y, z and the turn about it"
    if dimension:
        return f"{moves} where 4 are needed"
    return "the tool axis could not be brought to the vertical"


def _insertion_dimension(
    chain: DHChain,
    axis: FloatArray,
    up: FloatArray,
    q: FloatArray,
    rng: np.random.Generator,
) -> int:
    """Dimension of the set of poses whose tool axis is vertical."""
    q = q.copy()
    across = np.linalg.svd(up[None])[2][1:]  # two horizontal directions
    good = np.abs(_to_vertical(chain, axis, across, q)).max(axis=1) < _VERTICAL
    good &= ((q >= chain.lower) & (q <= chain.upper)).all(axis=1)
    best = 0
    for start in q[good][:_STARTS]:
        jacobian = chain.jacobian(start) / jacobian_scale(chain)
        _, s, vt = np.linalg.svd(across @ jacobian[3:])
        tangents = vt[int((s > _MOVES).sum()) :]
        rank = int(matrix_rank(jacobian @ tangents.T)) if len(tangents) else 0
        if rank <= best:
            continue
        weights = rng.normal(size=len(tangents))
        step = weights @ tangents / np.linalg.norm(weights)
        if _stays_vertical(chain, axis, across, start, step):
            best = rank
    return best


def _stays_vertical(
    chain: DHChain,
    axis: FloatArray,
    across: FloatArray,
    start: FloatArray,
    step: FloatArray,
) -> bool:
    """Whether the tool axis can stay vertical in a motion along a tangent.

    Then the correction after a step of size h is of order h^2.
    """
    gaps = []
    for h in (1e-2, 1e-3):
        moved = (start + h * step)[None]
        _to_vertical(chain, axis, across, moved)
        gaps.append(float(np.linalg.norm(moved[0] - start - h * step)) / h)
    return gaps[1] < 0.2 * gaps[0] or gaps[1] < 1e-6


def _to_vertical(
    chain: DHChain, axis: FloatArray, across: FloatArray, q: FloatArray
) -> FloatArray:
    """Bring the tool axis to the vertical by Newton steps.

    Args:
        chain: The arm.
        axis: In the tool frame, (3,).
        across: Two horizontal directions, (2, 3).
        q: Joint positions (M, N), changed in place.

    Returns:
        The horizontal part of the axis that remains, (M, 2).
    """
    for left in reversed(range(_NEWTON_STEPS + 1)):
        direction = chain.forward_kinematics(q)[:, :3, :3] @ axis
        tilt: FloatArray = direction @ across.T
        if not left or np.abs(tilt).max(initial=0.0) < 1e-14:
            break
        columns = np.cross(chain.jacobian(q)[:, 3:], direction[:, :, None], axis=1)
        rate = np.einsum("ki,mij->mkj", across, columns)
        correction = np.linalg.pinv(rate, rcond=1e-4) @ tilt[:, :, None]
        q -= np.clip(correction[:, :, 0], -0.5, 0.5)
    return tilt


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
