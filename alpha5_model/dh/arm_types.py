"""What kind of arm a chain is, and which tasks it can serve.

References:
    [Lecture7.1] Describing Robot Arms, sections "Joint Types", "Arm Types", "Task requirements".
    [Siciliano2009] Siciliano et al.: Robotics, section 1.2.1 (manipulator structures).
    [Lynch2017] Lynch, Park: Modern Robotics, sections 2.5 (task space) and 5.1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model.checks import FloatArray, float_array, generator, instance
from alpha5_model.checks import count as whole_number
from alpha5_model.dh.chain import DHChain
from alpha5_model.errors import InputError

#: Singular values below this count as zero; lengths are divided by the arm's size first.
RANK_TOLERANCE = 1e-8
#: Angles below this count as zero when axes are compared [rad].
ANGLE_TOLERANCE = 1e-9
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
    up = _unit_vector("vertical", vertical)
    points, z = instance("chain", chain, DHChain).joint_axes(chain.home)
    along = np.linalg.norm(np.cross(z, up), axis=1) <= ANGLE_TOLERANCE
    turning = np.array(chain.sigma) == 0
    sliding = ~turning
    # The major links are those up to the first joint that tilts: a wrist may follow.
    major = chain.n if along.all() else int(np.argmin(along))
    axes = points[:major][turning[:major]]
    apart = len(axes) >= 2 and (np.linalg.norm(np.cross(axes - axes[0], up), axis=1) > 0).any()
    kind = "other"
    if turning.all():
        kind, reason = "revolute", "all joints are revolute"
    elif chain.n >= 3 and sliding[:3].all():
        reason = "the first three joints slide, but not along perpendicular axes"
        if np.allclose(z[:3] @ z[:3].T, np.eye(3), rtol=0, atol=ANGLE_TOLERANCE):
            kind, reason = "cartesian", "the first three joints slide along perpendicular axes"
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
    up = _unit_vector("vertical", vertical)
    instance("chain", chain, DHChain)
    axis = _last_axis(chain) if tool_axis is None else _unit_vector("tool_axis", tool_axis)
    rng = generator(seed)
    q = sample_configurations(chain, whole_number("samples", samples), rng)
    jacobian = chain.jacobian(q) / row_scale(chain)
    dimension = int(matrix_rank(jacobian).max())
    position, orientation = (
        int(matrix_rank(jacobian[:, r]).max()) for r in (slice(3), slice(3, 6))
    )
    insertion = _insertion_dimension(chain, axis, up, q, rng)
    if dimension == GENERAL:
        general = "the Jacobian has rank 6, so the poses fill an open set of SE(3)"
    elif chain.n < GENERAL:
        general = f"{chain.n} joints reach at most {chain.n} of the 6 dimensions of SE(3); the Jacobian has rank {dimension}"
    else:
        general = f"{chain.n} joints, but the Jacobian never has more than rank {dimension}"
    moves = f"with its tool axis vertical it moves in {insertion} dimensions"
    if insertion == INSERTION:
        insert = f"{moves}: x, y, z and the turn about it"
    elif insertion:
        insert = f"{moves} where 4 are needed"
    else:
        insert = "the tool axis could not be brought to the vertical"
    return TaskCapability(
        dimension=dimension,
        position_dimension=position,
        orientation_dimension=orientation,
        insertion_dimension=insertion,
        general=dimension == GENERAL,
        general_reason=general,
        vertical_insertion=insertion == INSERTION,
        insertion_reason=insert,
    )


def sample_configurations(chain: DHChain, count: int, rng: np.random.Generator) -> FloatArray:
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
    chain: DHChain, axis: FloatArray, up: FloatArray, q: FloatArray, rng: np.random.Generator
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
    chain: DHChain, axis: FloatArray, across: FloatArray, q: FloatArray, steps: int = 40
) -> FloatArray:
    """Newton steps on the tool axis's horizontal part, in place; what is left of it, (M, 2)."""
    for left in reversed(range(steps + 1)):
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


def matrix_rank(matrix: FloatArray) -> NDArray[np.int64]:
    """Numerical rank of (..., m, n) whose entries are of order 1."""
    s = np.linalg.svd(matrix, compute_uv=False)
    return np.asarray((s > RANK_TOLERANCE).sum(axis=-1))


def _last_axis(chain: DHChain) -> FloatArray:
    """Axis of the last joint in the tool frame, which no joint position changes."""
    frames = chain.frames(chain.home)
    return np.asarray(frames[-1, :3, :3].T @ frames[chain.n - 1, :3, 2])


def _unit_vector(name: str, value: ArrayLike) -> FloatArray:
    v = float_array(name, value, (3,))
    largest = float(np.abs(v).max(initial=0.0))
    if v.ndim != 1 or largest == 0:
        raise InputError(name, value, "one direction that is not zero")
    v = v / largest  # squares of large numbers overflow
    return np.asarray(v / np.linalg.norm(v))
