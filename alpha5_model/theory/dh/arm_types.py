"""What kind of arm a chain is, which tasks it can serve, and its dexterous workspace.

For the dexterous workspace of arms in general there is no closed form. The estimate solves the inverse kinematics numerically
for orientations spread evenly over SO(3), from several starts: every orientation counted is
reached, some that could be reached may be missed.

References:
    [Lecture7.1] Describing Robot Arms, sections "Joint Types", "Arm Types", "Task requirements",
        "Dexterous Workspace".
    [Siciliano2009] Siciliano et al.: Robotics, sections 1.2.1 (manipulator structures), 3.5 and
        3.7.3 (orientation error).
    [Lynch2017] Lynch, Park: Modern Robotics, sections 2.5 (task space) and 5.1.
    [Kumar1981] Kumar, Waldron: The workspaces of a mechanical manipulator, J. Mech. Design 103,
        1981.
    [Gupta1982] Gupta, Roth: Design considerations for manipulator workspace, J. Mech. Design 104,
        1982.
    [Alexa2022] Alexa: Super-Fibonacci spirals: fast, low-discrepancy sampling of SO(3), CVPR 2022.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray, float_array, generator, instance
from alpha5_model._support.checks import count as whole_number
from alpha5_model._support.spatial import cross_matrix
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.link import unit_vectors
from alpha5_model.theory.planar import Conditions

#: Singular values below this count as zero; lengths are divided by the arm's size first.
RANK_TOLERANCE = 1e-8
#: Angles below this count as zero when axes are compared [rad].
ANGLE_TOLERANCE = 1e-9
#: A pose counts as reached within this share of the arm's size, and this angle [rad].
POSE_TOLERANCE = 1e-6
#: Dimension of the rigid motions, and of SE(2) x I.
GENERAL, INSERTION = 6, 4


@dataclass(frozen=True)
class ArmType:
    """Classification of a chain.

    Attributes:
        kind: ``revolute`` (all joints are), ``scara``, ``cartesian`` or ``other``.
        joints: One letter per joint, R or P, base to tip.
        horizontal: Whether all axes are vertical, so that all links move in horizontal planes.
        reason: The geometry that decided, in one sentence.
    """

    kind: str
    joints: str
    horizontal: bool
    reason: str


@dataclass(frozen=True)
class TaskCapability:
    """What the set of reachable end-effector poses allows.

    Attributes:
        dimension: Dimension of that set: the largest rank of the Jacobian, 0 to 6.
        position_dimension: Dimension of the set of reachable positions, 0 to 3.
        orientation_dimension: Dimension of the set of reachable orientations, 0 to 3.
        insertion_dimension: Dimension of the set of poses whose tool axis stays vertical, 0 to 4;
            0 also where no sample could be brought to a vertical tool axis.
        general: Whether it serves general tasks: a 6-D subset of SE(3).
        general_reason: Why, or why not.
        vertical_insertion: Whether it serves vertical insertion: a 4-D subset of SE(2) x I.
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


def classify(chain: DHChain, vertical: ArrayLike = (0.0, 0.0, 1.0)) -> ArmType:
    """The type of an arm, from the directions of its axes at home.

    Only what holds at every configuration is used: whether all revolute joints are parallel, and
    the directions of prismatic joints that no revolute joint precedes.

    - revolute: all joints are revolute;
    - scara: at least two revolute joints whose axes are vertical, parallel and apart, so that the
      major links move in a horizontal plane, and a prismatic joint along them;
    - cartesian: the first three joints are prismatic and perpendicular to one another.

    Args:
        chain: The arm.
        vertical: Direction of the vertical in the world, (3,).
    """
    up = unit_vectors("vertical", vertical)
    points, z = instance("chain", chain, DHChain).joint_axes(chain.home)
    along = np.linalg.norm(np.cross(z, up), axis=1) <= ANGLE_TOLERANCE
    turning = np.array(chain.sigma) == 0
    sliding = ~turning
    # The major links are those up to the first joint that tilts: a wrist may follow.
    major = chain.n if along.all() else int(np.argmin(along))
    axes = points[:major][turning[:major]]
    apart = (
        len(axes) >= 2
        and (np.linalg.norm(np.cross(axes - axes[0], up), axis=1) > 0).any()
    )
    kind = "other"
    if turning.all():
        kind, reason = "revolute", "all joints are revolute"
    elif chain.n >= 3 and sliding[:3].all():
        reason = "the first three joints slide, but not along perpendicular axes"
        if np.allclose(z[:3] @ z[:3].T, np.eye(3), rtol=0, atol=ANGLE_TOLERANCE):
            kind, reason = (
                "cartesian",
                "the first three joints slide along perpendicular axes",
            )
    elif apart and sliding[:major].any():
        kind = "scara"
        reason = f"{len(axes)} vertical revolute axes apart and a vertical prismatic one: the major links move in a horizontal plane"
    elif sliding.all():
        reason = f"{chain.n} prismatic joints, not three perpendicular ones"
    elif major == 0:
        reason = "a prismatic joint, and the first axis is not vertical"
    else:
        reason = f"a prismatic joint, and only {len(axes)} vertical revolute axes before one that is not vertical"
    joints = "".join("RP"[s] for s in chain.sigma)
    return ArmType(kind, joints, bool(along.all()), reason)


def task_capability(
    chain: DHChain,
    tool_axis: ArrayLike | None = None,
    vertical: ArrayLike = (0.0, 0.0, 1.0),
    samples: int = 64,
    seed: int = 0,
) -> TaskCapability:
    """Which tasks an arm can serve, from Jacobian ranks over sampled configurations.

    The map from joint positions to poses is analytic, so the rank is largest almost everywhere and
    the set of poses has that dimension. Poses with a vertical tool axis are few: samples are
    brought there by Newton steps, and a direction of motion counts as tangent to them only if a
    finite step along it, brought back, stays in that direction.

    Args:
        chain: The arm; joints without limits are sampled over a turn (revolute) or over the arm's
            own size (prismatic).
        tool_axis: Axis that is to stay vertical, (3,) in the tool frame; by default the axis of the
            last joint.
        vertical: Direction of the vertical in the world, (3,).
        samples: Number of configurations.
        seed: Of the samples.
    """
    up = unit_vectors("vertical", vertical)
    instance("chain", chain, DHChain)
    if tool_axis is None:  # of the last joint, the same at every joint position
        frames = chain.frames(chain.home)
        tool_axis = frames[-1, :3, :3].T @ frames[chain.n - 1, :3, 2]
    axis = unit_vectors("tool_axis", tool_axis)
    rng = generator(seed)
    q = sample_configurations(chain, whole_number("samples", samples), rng)
    jacobian, rows = (
        chain.jacobian(q) / row_scale(chain),
        (slice(6), slice(3), slice(3, 6)),
    )
    dimension, place, turn = (
        int(matrix_rank(jacobian[:, part]).max()) for part in rows
    )
    insertion = _insertion_dimension(chain, axis, up, q, rng)
    if dimension == GENERAL:
        general = "the Jacobian has rank 6, so the poses fill an open set of SE(3)"
    elif chain.n < GENERAL:
        general = f"{chain.n} joints reach at most {chain.n} of the 6 dimensions of SE(3); the Jacobian has rank {dimension}"
    else:
        general = (
            f"{chain.n} joints, but the Jacobian never has more than rank {dimension}"
        )
    moves = f"with its tool axis vertical it moves in {insertion} dimensions"
    if insertion == INSERTION:
        insert = f"{moves}: x, y, z and the turn about it"
    elif insertion:
        insert = f"{moves} where 4 are needed"
    else:
        insert = "the tool axis could not be brought to the vertical"
    answers = dimension == GENERAL, general, insertion == INSERTION, insert
    return TaskCapability(dimension, place, turn, insertion, *answers)


def sample_configurations(
    chain: DHChain, count: int, rng: np.random.Generator
) -> FloatArray:
    """Uniform joint positions within the limits, (count, N); see `task_capability`."""
    whole_number("count", count)
    instance("rng", rng, np.random.Generator)
    size = chain_size(chain)
    span = np.where(np.array(chain.sigma) == 0, math.pi, size)
    # A joint limited on one side is sampled over the same width from that side.
    least = np.where(np.isfinite(chain.upper), chain.upper - 2 * span, -span)
    lower = np.where(np.isfinite(chain.lower), chain.lower, least)
    upper = np.where(np.isfinite(chain.upper), chain.upper, lower + 2 * span)
    return np.asarray(rng.uniform(lower, upper, (count, chain.n)))


def chain_size(chain: DHChain) -> float:
    """A length of the order of the arm's reach, to compare metres with radians [m]."""
    total = float(np.linalg.norm(instance("chain", chain, DHChain).tool[:3, 3]))
    for link in chain.links:
        travel = (link.lower, link.upper, link.d) if link.sigma else (link.d,)
        total += abs(link.a) + max(abs(x) for x in travel if math.isfinite(x))
    return total or 1.0


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
    good = np.abs(_to_vertical(chain, axis, across, q)).max(axis=1) < 1e-12
    good &= ((q >= chain.lower) & (q <= chain.upper)).all(axis=1)
    best = 0
    for start in q[good][:16]:
        jacobian = chain.jacobian(start) / row_scale(chain)
        _, s, vt = np.linalg.svd(across @ jacobian[3:])
        tangents = vt[int((s > 1e-6).sum()) :]
        rank = int(matrix_rank(jacobian @ tangents.T)) if len(tangents) else 0
        if rank <= best:
            continue
        # Is every tangent a true motion? After a step of size h the way back is of order h^2.
        weights = rng.normal(size=len(tangents))
        step = weights @ tangents / np.linalg.norm(weights)
        gaps = []
        for h in (1e-2, 1e-3):
            moved = (start + h * step)[None]
            _to_vertical(chain, axis, across, moved)
            gaps.append(float(np.linalg.norm(moved[0] - start - h * step)) / h)
        if gaps[1] < 0.2 * gaps[0] or gaps[1] < 1e-6:
            best = rank
    return best


def _to_vertical(
    chain: DHChain, axis: FloatArray, across: FloatArray, q: FloatArray
) -> FloatArray:
    """Newton steps on the tool axis's horizontal part, in place; what is left of it, (M, 2)."""
    for left in reversed(range(41)):
        direction = chain.forward_kinematics(q)[:, :3, :3] @ axis
        tilt: FloatArray = direction @ across.T
        if not left or np.abs(tilt).max(initial=0.0) < 1e-14:
            break
        columns = np.cross(chain.jacobian(q)[:, 3:], direction[:, :, None], axis=1)
        rate = np.einsum("ki,mij->mkj", across, columns)
        correction = np.linalg.pinv(rate, rcond=1e-4) @ tilt[:, :, None]
        q -= np.clip(correction[:, :, 0], -0.5, 0.5)
    return tilt


def row_scale(chain: DHChain) -> FloatArray:
    """Divides the Jacobian's linear rows by the arm's size, (6, 1)."""
    return np.array([chain_size(chain)] * 3 + [1.0] * 3)[:, None]


#: Numerical rank of (..., m, n) whose entries are of order 1.
matrix_rank = partial(np.linalg.matrix_rank, tol=RANK_TOLERANCE)


def spatial_conditions(chain: DHChain) -> Conditions:
    """The notes' necessary conditions for a dexterous workspace with an interior.

    Three revolute joints to turn the end effector and three more joints to place it. Without the
    second, single points can still be dexterous: three axes through the tool's origin.
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
    starts, steps = whole_number("starts", starts), whole_number("steps", steps)
    rotations = even_rotations(whole_number("orientations", orientations))
    rng = generator(seed)
    where = np.repeat(p.reshape(-1, 3), orientations, axis=0)
    turned = np.tile(rotations, (len(where) // orientations, 1, 1))
    reached = np.zeros(len(where), dtype=bool)
    for _ in range(starts):
        left = np.flatnonzero(~reached)
        if left.size == 0:
            break
        q = sample_configurations(chain, left.size, rng)
        with np.errstate(
            over="ignore", invalid="ignore"
        ):  # so far away that squares overflow
            reached[left] = _solve(chain, q, where[left], turned[left], steps)
    table = reached.reshape(*p.shape[:-1], orientations)
    capability = task_capability(chain)
    interior, reason = capability.general, capability.general_reason
    return DexterityEstimate(
        np.asarray(table.mean(axis=-1)), table, rotations, interior, reason
    )


def even_rotations(number: int) -> FloatArray:
    """Rotations spread evenly over SO(3), (number, 3, 3): a super-Fibonacci spiral [Alexa2022]."""
    s = np.arange(whole_number("number", number)) + 0.5
    r, big_r = np.sqrt(s / number), np.sqrt(1 - s / number)
    first, second = (
        2 * math.pi * s / math.sqrt(2),
        2 * math.pi * s / 1.533751168755204288118041,
    )
    x, y = r * np.sin(first), r * np.cos(first)
    z, w = big_r * np.sin(second), big_r * np.cos(second)
    k = cross_matrix(np.stack([x, y, z], axis=-1))
    return np.asarray(np.eye(3) + 2 * (w[:, None, None] * k + k @ k))


def _solve(
    chain: DHChain,
    q: FloatArray,
    position: FloatArray,
    rotation: FloatArray,
    steps: int,
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
