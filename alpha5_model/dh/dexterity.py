"""Dexterous workspace of spatial arms: necessary conditions, and a numerical estimate.

There is no closed form for arms in general. The estimate solves the inverse kinematics numerically
for orientations spread evenly over SO(3), from several starts: every orientation counted is
reached, some that could be reached may be missed.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace".
    [Kumar1981] Kumar, Waldron: The workspaces of a mechanical manipulator, J. Mech. Design 103,
        1981.
    [Gupta1982] Gupta, Roth: Design considerations for manipulator workspace, J. Mech. Design 104,
        1982.
    [Alexa2022] Alexa: Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3), CVPR 2022.
    [Siciliano2009] Siciliano et al.: Robotics, sections 3.7.3 (orientation error) and 3.5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model.checks import FloatArray, count, float_array, generator, instance
from alpha5_model.dh.arm_types import (
    GENERAL,
    matrix_rank,
    row_scale,
    sample_configurations,
    task_capability,
)
from alpha5_model.dh.chain import DHChain
from alpha5_model.planar import Conditions

#: A pose counts as reached within this share of the arm's size, and this angle [rad].
POSE_TOLERANCE = 1e-6


@dataclass(frozen=True, eq=False)
class DexterityEstimate:
    """Which orientations an arm was seen to reach at points.

    Attributes:
        share: Share of the orientations reached, 0 to 1, (...); a lower bound up to the spacing of
            the orientations. 1 marks a point as dexterous.
        reached: Which ones, (..., K).
        rotations: The orientations, (K, 3, 3).
        interior: Whether the dexterous workspace can have an interior at all: rank 6.
        reason: Why, or why not.
    """

    share: FloatArray
    reached: np.ndarray
    rotations: FloatArray
    interior: bool
    reason: str


def spatial_conditions(chain: DHChain) -> Conditions:
    """The notes' necessary conditions for a dexterous workspace with an interior.

    Three revolute joints to turn the end effector and three more joints to place it. Without the
    second, single points can still be dexterous: three axes through the tool's origin.
    """
    revolute = instance("chain", chain, DHChain).sigma.count(0)
    reasons = []
    if revolute < 3:
        reasons.append(f"{revolute} revolute where turning the end effector takes three")
    others = chain.n - min(revolute, 3)
    if others < 3:
        reasons.append(f"{others} more, beside them, where placing the end effector takes three")
    return Conditions(not reasons, tuple(reasons))


def orientation_freedom(chain: DHChain, q: ArrayLike) -> NDArray[np.int64]:
    """Dimensions in which the tool can turn while its origin stays, to first order.

    The rank of the Jacobian's angular rows on the null space of its linear rows. Where a point is
    dexterous in the interior sense this is 3 almost everywhere above it.

    Args:
        chain: The arm.
        q: (..., N) [rad or m].

    Returns:
        0 to 3, (...).
    """
    jacobian = instance("chain", chain, DHChain).jacobian(q) / row_scale(chain)
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
    starts, steps = count("starts", starts), count("steps", steps)
    rotations = even_rotations(count("orientations", orientations))
    rng = generator(seed)
    where = np.repeat(p.reshape(-1, 3), orientations, axis=0)
    turned = np.tile(rotations, (len(where) // orientations, 1, 1))
    reached = np.zeros(len(where), dtype=bool)
    for _ in range(starts):
        left = np.flatnonzero(~reached)
        if left.size == 0:
            break
        q = sample_configurations(chain, left.size, rng)
        with np.errstate(over="ignore", invalid="ignore"):  # so far away that squares overflow
            reached[left] = _solve(chain, q, where[left], turned[left], steps)
    table = reached.reshape(*p.shape[:-1], orientations)
    capability = task_capability(chain)
    return DexterityEstimate(
        share=np.asarray(table.mean(axis=-1)),
        reached=table,
        rotations=rotations,
        interior=capability.dimension == GENERAL,
        reason=capability.general_reason,
    )


def even_rotations(number: int) -> FloatArray:
    """Rotations spread evenly over SO(3), (number, 3, 3): a super-Fibonacci spiral [Alexa2022]."""
    s = np.arange(count("number", number)) + 0.5
    r, big_r = np.sqrt(s / number), np.sqrt(1 - s / number)
    first, second = 2 * math.pi * s / math.sqrt(2), 2 * math.pi * s / 1.533751168755204288118041
    x, y = r * np.sin(first), r * np.cos(first)
    z, w = big_r * np.sin(second), big_r * np.cos(second)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.ascontiguousarray(np.moveaxis(np.array(rows), -1, 0))


def _solve(
    chain: DHChain, q: FloatArray, position: FloatArray, rotation: FloatArray, steps: int
) -> np.ndarray:
    """Levenberg-Marquardt steps from q, clipped to the limits; which targets are met in the end."""
    scale = row_scale(chain)[:, 0]
    done = np.zeros(len(q), dtype=bool)
    active = np.arange(len(q))
    for _ in range(steps):
        pose = chain.forward_kinematics(q[active])
        turned, wanted = pose[:, :3, :3], rotation[active]
        cross = np.cross(turned, wanted, axisa=1, axisb=1, axisc=1)
        turn = cross.sum(axis=2) / 2  # axis times the sine of the angle
        error = np.hstack([position[active] - pose[:, :3, 3], turn]) / scale
        cosine = (np.einsum("mij,mij->m", turned, wanted) - 1) / 2
        met = (np.abs(error).max(axis=1) < POSE_TOLERANCE) & (cosine > 0)
        done[active[met]] = True
        active, error = active[~met], error[~met]
        if active.size == 0:
            break
        jacobian = chain.jacobian(q[active]) / scale[:, None]
        square = jacobian @ np.swapaxes(jacobian, 1, 2)
        damping = 1e-3 * np.einsum("mi,mi->m", error, error) + 1e-9
        square += damping[:, None, None] * np.eye(6)
        step = np.swapaxes(jacobian, 1, 2) @ np.linalg.solve(square, error[:, :, None])
        longest = np.abs(step).max(axis=(1, 2), keepdims=True)
        step *= np.minimum(1.0, 0.8 / np.maximum(longest, 1e-12))
        q[active] = np.clip(q[active] + step[:, :, 0], chain.lower, chain.upper)
    return done
