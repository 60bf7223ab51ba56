"""Types of arms, their task capability, and the Alpha 5's approach directions."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest
from literature import PUMA_560, STANFORD
from loops import each

import alpha5_model as a5
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.kinematics.pose import approach_directions
from alpha5_model.theory.dh import DHChain, DHLink
from alpha5_model.theory.dh.types_and_tasks import (
    classify,
    spatial_conditions,
    task_capability,
)

Q = math.pi / 2
X, Y, Z = np.eye(3)

SCARA = [
    [0, 0.4, 0.3, 0, 0],
    [0, 0, 0.25, math.pi, 0],
    [0, 0, 0, 0, 1],
    [0, 0, 0, 0, 0],
]
#: A five-joint arm such as the youBot's: yaw, three parallel pitch joints, roll.
FIVE = [
    [0, 0.147, 0.033, Q, 0],
    [0, 0, 0.155, 0, 0],
    [0, 0, 0.135, 0, 0],
    [Q, 0, 0, Q, 0],
    [0, 0.2, 0, 0, 0],
]


def axes_chain(
    rows: list[tuple[np.ndarray, np.ndarray, int]], tool: np.ndarray | None = None
) -> DHChain:
    """A chain from points, directions and types of its axes."""
    return DHChain.from_axes(
        [p for p, _, _ in rows], [z for _, z, _ in rows], [s for _, _, s in rows], tool
    )


ORIGIN = np.zeros(3)
#: Six axes anywhere: with its tool upright it moves on a curved set.
SKEW = axes_chain(
    [(*pair, 0) for pair in np.random.default_rng(3).normal(size=(6, 2, 3))]
)
GANTRY = axes_chain([(ORIGIN, X, 1), (ORIGIN, Y, 1), (ORIGIN, Z, 1)])
GANTRY_ROLL = axes_chain(
    [(ORIGIN, X, 1), (ORIGIN, Y, 1), (ORIGIN, Z, 1), (ORIGIN, Z, 0)]
)
OBLIQUE = axes_chain([(ORIGIN, X, 1), (ORIGIN, X + Y, 1), (ORIGIN, Z, 1)])
PRRR_SCARA = axes_chain([(ORIGIN, Z, 1), (ORIGIN, Z, 0), (X, Z, 0), (2 * X, Z, 0)])
FALLEN_SCARA = axes_chain([(ORIGIN, X, 0), (Y, X, 0), (2 * Y, X, 1)])
SPHERICAL = axes_chain([(ORIGIN, Z, 0), (ORIGIN, Y, 0), (ORIGIN, X, 1)])
WRIST_SCARA = axes_chain([(ORIGIN, Z, 0), (X, Z, 0), (2 * X, Z, 1), (2 * X, Y, 0)])


@each(
    ("chain", "kind", "joints", "horizontal"),
    [
        (DHChain.alpha5(), "revolute", "RRRR", False),
        (DHChain.from_table(PUMA_560), "revolute", "RRRRRR", False),
        (DHChain.from_table([[0, 0, 1, 0, 0]] * 3), "revolute", "RRR", True),
        (DHChain.from_table(SCARA), "scara", "RRPR", True),
        (PRRR_SCARA, "scara", "PRRR", True),
        (WRIST_SCARA, "scara", "RRPR", False),
        (FALLEN_SCARA, "other", "RRP", False),
        (GANTRY, "cartesian", "PPP", False),
        (GANTRY_ROLL, "cartesian", "PPPR", False),
        (OBLIQUE, "other", "PPP", False),
        (SPHERICAL, "other", "RRP", False),
        (DHChain.from_table(STANFORD), "other", "RRPRRR", False),
        (
            axes_chain([(ORIGIN, Z, 0), (ORIGIN, Z, 0), (ORIGIN, Z, 1)]),
            "other",
            "RRP",
            True,
        ),
        (axes_chain([(ORIGIN, X, 1), (ORIGIN, Y, 1)]), "other", "PP", False),
    ],
)
def test_classification(
    chain: DHChain, kind: str, joints: str, horizontal: bool
) -> None:
    found = classify(chain)
    assert (found.kind, found.joints, found.horizontal) == (kind, joints, horizontal)
    assert found.reason
    assert "\n" not in found.reason


def test_a_fallen_scara_stands_up_on_another_base() -> None:
    links = FALLEN_SCARA.links
    base = np.eye(4)
    base[:3, :3] = [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    standing = base @ FALLEN_SCARA.base
    for turned in (standing, base @ standing):
        up = abs(turned[2, 2]) > 0.5
        kind = classify(DHChain(links, base=turned)).kind
        assert kind == ("scara" if up else "other")


@each(
    ("chain", "dimension", "position", "orientation", "insertion"),
    [
        (DHChain.alpha5(), 4, 3, 3, 3),
        (DHChain.from_table(PUMA_560), 6, 3, 3, 4),
        (DHChain.from_table(STANFORD), 6, 3, 3, 4),
        (DHChain.from_table(SCARA), 4, 3, 1, 4),
        (PRRR_SCARA, 4, 3, 1, 4),
        (GANTRY, 3, 3, 0, 3),
        (GANTRY_ROLL, 4, 3, 1, 4),
        (DHChain.from_table(FIVE), 5, 3, 3, 4),
        (SKEW, 6, 3, 3, 4),
        (DHChain.from_table([[0, 0, 1, 0, 0]] * 3), 3, 2, 1, 3),
        (
            DHChain.from_table([[0, 0, 1, 0, 0]] * 7),
            3,
            2,
            1,
            3,
        ),  # seven joints, still a plane
        (axes_chain([(ORIGIN, Z, 0), (ORIGIN, Y, 0), (ORIGIN, X, 0)]), 3, 0, 3, 1),
        (DHChain.from_table([[0, 0, 1, 0, 0]]), 1, 1, 1, 1),
    ],
)
def test_task_capability(chain, dimension, position, orientation, insertion) -> None:
    task = task_capability(chain)
    assert task.dimension == dimension
    assert task.position_dimension == position
    assert task.orientation_dimension == orientation
    assert task.insertion_dimension == insertion
    assert task.general == (dimension == 6)
    assert task.vertical_insertion == (insertion == 4)
    assert task.general_reason
    assert task.insertion_reason


@pytest.mark.parametrize(("middle", "dimension"), [(0.0, 4), (0.4, 0)])
def test_joint_limits_decide_whether_the_tool_gets_upright(
    middle: float, dimension: int
) -> None:
    """At zero the hand points down; three pitch joints at 0.4 rad keep it 0.9 rad off.

    Each pitch joint may turn 0.1 rad to either side.
    """
    low = middle - 0.1
    high = middle + 0.1
    links = [DHLink(*row[:4]) for row in FIVE]
    links[1:4] = [
        DHLink(0, x.d, x.a, x.alpha, lower=low, upper=high) for x in links[1:4]
    ]
    task = task_capability(DHChain(tuple(links)))
    assert task.insertion_dimension == dimension


@pytest.mark.slow
@pytest.mark.parametrize(
    "chain", [DHChain.alpha5(), DHChain.from_table(SCARA), DHChain.from_table(PUMA_560)]
)
def test_dimension_by_counting_boxes(chain: DHChain) -> None:
    """The dimension of the pose set is the number of directions that nearby poses fill.

    The poses come from joint positions near one position. The share of the variance
    beyond the first `dimension` principal directions falls with the square of the
    neighbourhood's size.
    """
    rng = np.random.default_rng(0)
    q = rng.uniform(0.5, 1.5, chain.n)
    dimension = task_capability(chain).dimension
    rest = []
    for size in (1e-2, 1e-3):
        near = chain.forward_kinematics(q + size * rng.normal(size=(4000, chain.n)))
        entries = near[:, :3, :].reshape(4000, 12)
        values = np.linalg.svd(entries - entries.mean(0))[1]
        assert values[dimension - 1] / values[0] > 1e-4
        rest.append(values[dimension] / values[0])
    assert rest[1] < 0.2 * rest[0]


def test_bad_input() -> None:
    for function in (classify, task_capability, spatial_conditions):
        with pytest.raises(InputError, match="chain"):
            function(None)
    with pytest.raises(ShapeError, match="position"):
        approach_directions([0.1, 0.2])


# --- the Alpha 5's dexterous workspace is empty; what it has instead


def test_the_notes_conditions_for_spatial_arms() -> None:
    assert spatial_conditions(DHChain.from_table(PUMA_560)).satisfied
    assert spatial_conditions(DHChain.from_table(STANFORD)).satisfied
    missing = spatial_conditions(DHChain.alpha5())
    assert not missing.satisfied
    assert missing.reasons == (
        "1 more, beside them, where placing the end effector takes three",
    )
    slides = [[0, 0, 0, Q, 1]] * 3 + [[0, 0, 1, Q, 0]] * 2
    assert spatial_conditions(DHChain.from_table(slides)).reasons == (
        "2 revolute where turning the end effector takes three",
    )
    enough = spatial_conditions(DHChain.from_table(slides + slides[-1:]))
    assert enough.satisfied
    assert enough.reasons == ()
    assert len(spatial_conditions(GANTRY).reasons) == 1
    assert (
        len(spatial_conditions(DHChain.from_table([[0, 0, 1, 0, 0]] * 2)).reasons) == 2
    )


#: The residuals (2, ...) of an arm in a vertical plane for its angles (2, ...)
Residuals = Callable[[np.ndarray], np.ndarray]


def residuals_in_plane(chain: DHChain, point: np.ndarray, yaw: float) -> Residuals:
    """How far the tcp is off a point, along and up the plane of the yaw."""
    inwards = np.array([math.cos(yaw), math.sin(yaw), 0.0])

    def residuals(angles: np.ndarray) -> np.ndarray:
        first, second = angles
        q = np.stack([np.full_like(first, yaw), first, second, 0 * first], axis=-1)
        tip = chain.forward_kinematics(q)[..., :3, 3]
        radial = tip @ inwards - point @ inwards
        height = tip[..., 2] - point[2]
        return np.array([radial, height])

    return residuals


def starts_on_grid(residuals: Residuals) -> np.ndarray:
    """The pairs of angles, (M, 2), that are local minima of a fine grid."""
    grid = np.linspace(0, 2 * math.pi, 360, endpoint=False)
    angles = np.array(np.meshgrid(grid, grid, indexing="ij"))
    distance = np.hypot(*residuals(angles))
    start = distance < 0.02
    for axis in (0, 1):
        for shift in (-1, 1):
            start &= distance <= np.roll(distance, shift, axis=axis)
    return angles[:, start].T


def newton_root(residuals: Residuals, angles: np.ndarray) -> np.ndarray:
    """The pair of angles after fifty Newton steps, derivatives by differences."""
    h = 1e-7
    for _ in range(50):
        value = residuals(angles)
        moved = [residuals(angles + h * unit) for unit in np.eye(2)]
        slope = np.stack([(x - value) / h for x in moved], axis=1)
        angles = angles - np.linalg.lstsq(slope, value, rcond=None)[0]
    return angles


def enumerate_directions(chain: DHChain, point: np.ndarray) -> list[np.ndarray]:
    """All approach directions at a point by root finding over joint angles.

    The yaw points at the target or away from it. In its plane, Newton's method starts
    from every minimum of a grid over the two pitch angles.
    """
    bearing = math.atan2(point[1], point[0])
    found: list[np.ndarray] = []
    for yaw in (bearing + math.pi, bearing):
        residuals = residuals_in_plane(chain, point, yaw)
        for start in starts_on_grid(residuals):
            angles = newton_root(residuals, start)
            if np.abs(residuals(angles)).max() >= 1e-9:
                continue
            q = np.array([yaw, *angles, 0.0])
            tip = chain.forward_kinematics(q, "tool")[:3, 3]
            elbow = chain.forward_kinematics(q, 3)[:3, 3]
            direction = (tip - elbow) / np.linalg.norm(tip - elbow)
            if not any(np.abs(direction - other).max() < 1e-6 for other in found):
                found.append(direction)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    "point", [(0.2, 0.1, 0.1), (-0.15, 0.12, 0.25), (0.3, 0, -0.05), (0.05, -0.2, 0.0)]
)
def test_approach_directions_against_enumeration(point) -> None:
    ways = approach_directions(point)
    assert ways.directions.shape == (4, 3)
    ours = ways.directions[ways.exists]
    theirs = enumerate_directions(DHChain.alpha5(), np.array(point))
    assert len(ours) == len(theirs) > 0
    for direction in ours:
        assert min(np.abs(direction - other).max() for other in theirs) < 1e-6
    assert not ways.any_azimuth


def test_approach_directions_of_sampled_poses() -> None:
    """The direction of a sampled configuration is one of those found at its tcp."""
    model = pin.buildModelFromUrdf(a5.URDF_PATH)
    data = model.createData()
    rng = np.random.default_rng(2)
    tcp = model.getFrameId("tcp")
    q = rng.uniform(model.lowerPositionLimit, model.upperPositionLimit, (300, 4))
    points = []
    directions = []
    for x in q:
        pin.framesForwardKinematics(model, data, x)
        tip = data.oMf[tcp].translation.copy()
        # The frame of joint 4 lies on the hand's axis.
        line = tip - data.oMi[4].translation
        points.append(tip)
        directions.append(line / np.linalg.norm(line))
    ways = approach_directions(np.array(points))
    gap = np.linalg.norm(ways.directions - np.array(directions)[:, None], axis=-1)
    gap = np.where(ways.within_limits, gap, np.inf)
    assert gap.min(axis=1).max() < 1e-7
    lengths = np.linalg.norm(ways.directions[ways.exists], axis=-1)
    assert np.abs(lengths - 1).max() < 1e-12


def test_approach_directions_out_of_reach_and_as_a_method() -> None:
    ways = approach_directions([[1.0, 1.0, 1.0], [0.2, 0.1, 0.1]])
    assert np.isnan(ways.directions[0]).all()
    assert not ways.exists[0].any()
    arm = a5.load()
    same = arm.approach_directions([0.2, 0.1, 0.1])
    assert np.allclose(same.directions, ways.directions[1], rtol=0, atol=1e-14)


# --- spatial arms
