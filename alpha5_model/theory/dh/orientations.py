"""Estimate the dexterous workspace of any arm.

There is no closed form. The estimate solves the inverse kinematics numerically for
orientations spread evenly over SO(3), from several starts. It counts only orientations
that are reached, but may miss some that could be.

References:
    [Lecture7.1] Describing Robot Arms, section "Dexterous Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, sections 3.5 and 3.7.3 (orientation
        error).
    [Kumar1981] Kumar, Waldron: The workspaces of a mechanical manipulator, J. Mech.
        Design 103, 1981.
    [Gupta1982] Gupta, Roth: Design considerations for manipulator workspace, J. Mech.
        Design 104, 1982.
    [Alexa2022] Alexa: Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3),
        CVPR 2022.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    float_array,
    generator,
    instance,
)
from alpha5_model._support.checks import count as whole_number
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.sampling import (
    jacobian_scale,
    matrix_rank,
    sample_configurations,
)
from alpha5_model.theory.dh.tasks import task_capability

#: A pose counts as reached within this share of the arm's size, and this angle [rad].
POSE_TOLERANCE = 1e-6
#: Largest step of a joint [rad, or the arm's size].
_LONGEST_STEP = 0.8
#: The constant psi of [Alexa2022], the positive root of psi^4 = psi + 4.
_PSI = 1.533751168755204288118041


@dataclass(frozen=True, eq=False)
class DexterityEstimate:
    """The orientations that an arm was found to reach at points.

    Attributes:
        share: Share of the orientations reached, 0 to 1, (...); a lower bound up to the
            spacing of the orientations. 1 marks a point as dexterous.
        reached: Which ones, (..., K).
        rotations: The orientations, (K, 3, 3).
        interior: Whether the dexterous workspace can have an interior at all: rank 6.
        reason: Why, or why not.
    """

    share: FloatArray
    reached: BoolArray
    rotations: FloatArray
    interior: bool
    reason: str


def orientation_freedom(chain: DHChain, q: ArrayLike) -> NDArray[np.int64]:
    """Dimensions in which the tool can turn while its origin stays, to first order.

    It is the rank of the Jacobian's angular rows on the null space of its linear rows.
    At almost all configurations of a point inside the dexterous workspace it is 3.

    Args:
        chain: The arm.
        q: (..., N) [rad or m].

    Returns:
        0 to 3, (...).
    """
    jacobian = instance("chain", chain, DHChain).jacobian(q) / jacobian_scale(chain)
    # rank [J_v; J_w] = rank J_v + rank of J_w on the null space of J_v.
    return np.asarray(matrix_rank(jacobian) - matrix_rank(jacobian[..., :3, :]))


def spatial_dexterity(
    chain: DHChain,
    positions: ArrayLike,
    orientations: int = 60,
    starts: int = 12,
    steps: int = 60,
    seed: int = 0,
) -> DexterityEstimate:
    """Estimate which orientations an arm reaches at points, joint limits included.

    Args:
        chain: The arm.
        positions: Of the tool, in the world, (..., 3) [m].
        orientations: How many, spread evenly over SO(3).
        starts: Random starts per orientation.
        steps: Damped least-squares steps per start.
        seed: Of the starts.
    """
    p = float_array("positions", positions, (3,))
    instance("chain", chain, DHChain)
    starts = whole_number("starts", starts)
    steps = whole_number("steps", steps)
    rotations = even_rotations(whole_number("orientations", orientations))
    rng = generator(seed)
    points = p.reshape(-1, 3)
    where = np.repeat(points, orientations, axis=0)
    turned = np.tile(rotations, (len(points), 1, 1))

    reached = np.zeros(len(where), dtype=bool)
    for _ in range(starts):
        left = np.flatnonzero(~reached)
        if left.size == 0:
            break
        q = sample_configurations(chain, left.size, rng)
        # Points may be so far away that squares overflow.
        with np.errstate(over="ignore", invalid="ignore"):
            reached[left] = _solve(chain, q, where[left], turned[left], steps)

    table = reached.reshape(*p.shape[:-1], orientations)
    capability = task_capability(chain)
    return DexterityEstimate(
        share=np.asarray(table.mean(axis=-1)),
        reached=table,
        rotations=rotations,
        interior=capability.general,
        reason=capability.general_reason,
    )


def even_rotations(number: int) -> FloatArray:
    """Rotations spread evenly over SO(3), (number, 3, 3).

    They are a super-Fibonacci spiral [Alexa2022].
    """
    s = np.arange(whole_number("number", number)) + 0.5
    r = np.sqrt(s / number)
    big_r = np.sqrt(1 - s / number)
    first = 2 * math.pi * s / math.sqrt(2)
    second = 2 * math.pi * s / _PSI
    x = r * np.sin(first)
    y = r * np.cos(first)
    z = big_r * np.sin(second)
    w = big_r * np.cos(second)
    k = cross_matrix(np.stack([x, y, z], axis=-1))
    return np.asarray(np.eye(3) + 2 * (w[:, None, None] * k + k @ k))


def _solve(
    chain: DHChain,
    q: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    steps: int,
) -> BoolArray:
    """Solve for poses by Levenberg-Marquardt steps, clipped to the limits.

    Args:
        chain: The arm.
        q: Where to start, (M, N), changed in place.
        position: (M, 3) [m].
        rotation: (M, 3, 3).
        steps: Number of steps.

    Returns:
        Which poses are reached in the end, (M,) bool.
    """
    scale = jacobian_scale(chain)[:, 0]
    done = np.zeros(len(q), dtype=bool)
    active = np.arange(len(q))
    for _ in range(steps):
        pose = chain.forward_kinematics(q[active])
        error, turned_over = _pose_error(pose, position[active], rotation[active])
        error = error / scale
        met = (np.abs(error).max(axis=1) < POSE_TOLERANCE) & ~turned_over
        done[active[met]] = True
        active = active[~met]
        error = error[~met]
        if active.size == 0:
            break
        jacobian = chain.jacobian(q[active]) / scale[:, None]
        step = _damped_step(jacobian, error)
        q[active] = np.clip(q[active] + step, chain.lower, chain.upper)
    return done


def _pose_error(
    pose: FloatArray, position: FloatArray, rotation: FloatArray
) -> tuple[FloatArray, BoolArray]:
    """Error of poses [Siciliano2009, 3.7.3].

    Returns:
        Translation [m], and the rotation's axis times the sine of its angle, (M, 6);
        whether that angle exceeds 90 deg, so that its sine does not measure it, (M,).
    """
    turned = pose[:, :3, :3]
    cross = np.cross(turned, rotation, axisa=1, axisb=1, axisc=1)
    turn = cross.sum(axis=2) / 2
    error = np.hstack([position - pose[:, :3, 3], turn])
    cosine = (np.einsum("mij,mij->m", turned, rotation) - 1) / 2
    return error, ~(cosine > 0)


def _damped_step(jacobian: FloatArray, error: FloatArray) -> FloatArray:
    """Damped least squares; no joint moves farther than `_LONGEST_STEP`, (M, N)."""
    transposed = np.swapaxes(jacobian, 1, 2)
    square = jacobian @ transposed
    damping = 1e-3 * np.einsum("mi,mi->m", error, error) + 1e-9
    square += damping[:, None, None] * np.eye(6)
    step = transposed @ np.linalg.solve(square, error[:, :, None])
    longest = np.abs(step).max(axis=(1, 2), keepdims=True)
    step *= np.minimum(1.0, _LONGEST_STEP / np.maximum(longest, 1e-12))
    return np.asarray(step[:, :, 0])
