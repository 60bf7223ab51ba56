"""Workspaces of planar arms agree with closed forms, enumeration and a solver."""

from __future__ import annotations

import math

import numpy as np
import pytest
from loops import each

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    InputError,
    MissingParameterError,
    NonFiniteError,
    ShapeError,
)
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.planar import (
    Arc,
    PlanarArm,
    Segment,
    Workspace,
)
from alpha5_model.theory.planar.arm import annulus

TURN = 2 * math.pi
QUARTER = math.pi / 2

LIMITED = {
    "RR": PlanarArm((5, 4), [(0, 2), (0.3, 2.5)]),
    "RR, elbow through zero": PlanarArm((5, 4), [(-1, 2), (-2.5, 1.0)]),
    "RR, first free": PlanarArm((5, 4), [None, (-2.5, 2.5)]),
    "RR, second free": PlanarArm((5, 4), [(-1, 2), None]),
    "RR, almost free": PlanarArm((5, 4), [(-3.1, 3.1), (-3.0, 3.0)]),
    "RR, equal links": PlanarArm((3, 3), [(-2, 2), (0.5, 3.0)]),
    "RRR": PlanarArm((5, 4, 3), [(-1, 2), (-1, 2.5), (-1, 1)]),
    "RRR, narrow": PlanarArm((2, 3, 1), [(0, 0.3), (1, 1.4), (-2, -1)]),
    "RRRR": PlanarArm((5, 4, 3, 1), [(-1, 2), (-1, 1.5), (-1, 1), (-1, 2)]),
    "RP": PlanarArm((1, 0), [(-1, 2), (1, 3)], "RP"),
    "RP, sideways": PlanarArm((1, 0.5), [(-1, 2), (0, 2)], "RP", (0, QUARTER)),
    "PR": PlanarArm((1, 2), [(0, 3), None], "PR"),
    "PR, limited": PlanarArm((1, 2), [(0, 3), (0, 2)], "PR"),
    "PP": PlanarArm((0, 0), [(1, 4), (0, 2)], "PP", (0, QUARTER)),
    "PP, oblique": PlanarArm((0.2, 0.1), [(0, 1), (0, 2)], "PP", (0.3, 1.0)),
    "RPR": PlanarArm((1, 1, 0.5), [(0, 2), (0, 1), (-1, 1)], "RPR", (0, 0.5, 0)),
    "PRR": PlanarArm((0, 2, 1), [(0, 2), (-1, 1), (0.2, 2)], "PRR"),
    "RRP": PlanarArm((2, 1, 0), [(-1, 1), (0, 2), (0.5, 1)], "RRP"),
    "RPRR, curves that touch": PlanarArm(
        (1, 3, 1, 1),
        [
            (-2 * math.pi / 3, -math.pi / 6),
            (0, 1),
            (-QUARTER, math.pi / 6),
            (-5 * math.pi / 6, 0),
        ],
        "RPRR",
        (0, QUARTER, QUARTER, 0),
    ),
    # The second joint passes the slide at right angles, inside its range. The foot of
    # the perpendicular from that joint sweeps a part of the boundary.
    "RRP, across the slide": PlanarArm(
        (0.4, 1.1, 0), [(0.4, 2.8), (0.7, 2.1), (-0.8, 0.4)], "RRP", (0.1, -0.5, 0.9)
    ),
    "PRP, across the slide": PlanarArm(
        (0, 1.6, 0), [(-0.9, -0.4), (-2.0, -0.3), (-1.0, 1.4)], "PRP", (0.5, 0.9, -1.8)
    ),
    "RRR, middle locked": PlanarArm((2, 1, 1.5), [(-1, 1), (0.7, 0.7), (0, 2)]),
}
FREE = [
    (5,),
    (5, 4),
    (5, 5),
    (4, 5),
    (5, 4, 1),
    (9, 2, 1),
    (1, 2, 9),
    (3, 3, 3),
    (1, 1, 1, 8),
    (2, 3, 4, 5, 6),
]


def bounds(arm: PlanarArm) -> tuple[np.ndarray, np.ndarray]:
    pairs = [(-math.pi, math.pi) if r is None else r for r in arm.limits]
    return np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])


def random_tips(arm: PlanarArm, count: int, rng: np.random.Generator) -> np.ndarray:
    """Tips of random configurations; 15 % of the joint values sit at a limit."""
    low, high = bounds(arm)
    share = rng.random((count, arm.n))
    at_limit = rng.random(share.shape) < 0.15
    share = np.where(at_limit, rng.integers(0, 2, share.shape), share)
    return arm.forward_kinematics(low + share * (high - low))[:, :2]


def derivative(arm: PlanarArm, q: np.ndarray) -> np.ndarray:
    """Of the tip's place, (..., 2, N): a lever turned by a right angle, or a way."""
    poses = arm.poses(q)
    lever = poses[..., -1:, :2] - poses[..., :-1, :2]
    heading = poses[..., 1:, 2]
    turns = np.array([kind == "R" for kind in arm.joints])
    x = np.where(turns, -lever[..., 1], np.cos(heading))
    y = np.where(turns, lever[..., 0], np.sin(heading))
    return np.stack([x, y], axis=-2)


def distances(
    arm: PlanarArm, points: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """The least distances from points (M, 2) to the tip, by damped least squares.

    Each point has the 32 nearest of many random starts. A joint that is pushed against
    its limit does not take part in a step.
    """
    low, high = bounds(arm)
    starts = low + rng.random((3000, arm.n)) * (high - low)
    tips = arm.forward_kinematics(starts)[:, :2]
    gaps = np.linalg.norm(tips - points[:, None], axis=-1)
    nearest = np.argsort(gaps, axis=1)[:, :32]
    q = starts[nearest]
    best = np.full(len(points), np.inf)
    for step in range(90):
        error = points[:, None] - arm.forward_kinematics(q)[..., :2]
        best = np.minimum(best, np.linalg.norm(error, axis=-1).min(axis=1))
        jacobian = derivative(arm, q)
        pull = np.einsum("...ij,...i->...j", jacobian, error)
        stuck = ((q <= low) & (pull < 0)) | ((q >= high) & (pull > 0))
        jacobian = np.where(stuck[..., None, :], 0.0, jacobian)
        transposed = np.swapaxes(jacobian, -1, -2)
        damping_factor = 1e-3 if step < 45 else 1e-7
        squared_error = np.einsum("...i,...i->...", error, error)
        damping = damping_factor * squared_error + 1e-12
        square = jacobian @ transposed + damping[..., None, None] * np.eye(2)
        move = transposed @ np.linalg.solve(square, error[..., None])
        q = np.clip(q + np.clip(move[..., 0], -0.5, 0.5), low, high)
    return best


def general_route(arm: PlanarArm, monkeypatch: pytest.MonkeyPatch) -> Workspace:
    """The workspace by critical curves, without the closed form of unlimited arms."""
    monkeypatch.setattr(PlanarArm, "length_ranges", None)
    return arm.workspace()


@pytest.mark.slow
@each("name", LIMITED)
def test_every_enumerated_point_is_inside(name: str) -> None:
    arm = LIMITED[name]
    tips = random_tips(arm, 20000, np.random.default_rng(1))
    assert arm.workspace().contains(tips).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", LIMITED)
def test_the_boundary_divides_reachable_from_unreachable(name: str) -> None:
    """A solver reaches the points just inside each edge and none just outside."""
    arm = LIMITED[name]
    rng = np.random.default_rng(2)
    space = arm.workspace()
    assert space.edges
    step = 2e-3 * arm.reach
    on = []
    normal = []
    for edge in space.edges:
        low, high = edge.curve.interval
        t = low + (high - low) * rng.uniform(0.3, 0.7)
        on.append(edge.curve.point(t))
        normal.append(edge.curve.left(t) * (1 if edge.inside_left else -1))
    on = np.array(on)
    normal = np.array(normal)
    assert space.contains(on).all()
    # On the boundary itself the arm is singular: convergence is slow there.
    assert (distances(arm, on, rng) < 1e-5 * arm.reach).all()
    within = on + step * normal
    beyond = on - step * normal
    # The step may cross a part of the workspace that is thinner than the step.
    within = within[space.contains(within)]
    beyond = beyond[~space.contains(beyond)]
    assert len(within) > 0.7 * len(on)
    assert len(beyond) > 0.7 * len(on)
    assert (distances(arm, within, rng) < 1e-6 * arm.reach).all()
    assert (distances(arm, beyond, rng) > 0.02 * step).all()


@pytest.mark.slow
@pytest.mark.parametrize("name", LIMITED)
def test_points_inside_are_reached_and_points_outside_are_not(name: str) -> None:
    arm = LIMITED[name]
    rng = np.random.default_rng(3)
    points = rng.uniform(-1, 1, (30, 2)) * arm.reach
    reached = distances(arm, points, rng) < 1e-6 * arm.reach
    assert np.array_equal(reached, arm.workspace().contains(points))


@pytest.mark.slow
@each("name", LIMITED)
def test_area_is_that_of_a_fine_grid(name: str) -> None:
    """The area is the number of squares whose centre is inside, times their area."""
    arm = LIMITED[name]
    space = arm.workspace()
    cells = 200
    width = 2 * arm.reach / cells
    x = -arm.reach + width * (np.arange(cells) + 0.5)
    grid = np.stack(np.meshgrid(x, x), axis=-1)
    counted = float(space.contains(grid).sum()) * width**2
    length = sum(
        c.span * c.radius if isinstance(c, Arc) else c.length for c in space.curves
    )
    half_a_square_along_the_boundary = 0.5 * width * length
    assert abs(counted - space.area) < half_a_square_along_the_boundary
    assert space.area > 0


def test_area_of_two_revolute_joints_with_the_elbow_on_one_side() -> None:
    """The integral of the Jacobian's determinant, l_1 l_2 sin(q_2), over the limits.

    It is the area as long as no point is reached twice.
    """
    arm = PlanarArm((5, 4), [(0, 2), (0.3, 2.5)])
    area = 20 * (math.cos(0.3) - math.cos(2.5)) * 2
    assert arm.workspace().area == pytest.approx(area, rel=1e-13)


def test_area_of_a_turning_slide_is_a_sector_of_an_annulus() -> None:
    arm = PlanarArm((1, 0), [(-1, 2), (1, 3)], "RP")
    assert arm.workspace().area == pytest.approx(3 * (16 - 4) / 2, rel=1e-13)


def test_area_of_two_slides_is_a_parallelogram() -> None:
    assert LIMITED["PP"].workspace().area == pytest.approx(6, rel=1e-13)
    oblique = 1 * 2 * math.sin(1.0)
    assert LIMITED["PP, oblique"].workspace().area == pytest.approx(oblique, rel=1e-13)


def test_area_of_a_circle_that_slides() -> None:
    """A circle of radius 2 slides by 3: a stadium without the lens it never touches."""
    lens = 2 * 4 * math.acos(3 / 4) - 1.5 * math.sqrt(16 - 9)
    stadium = 4 * math.pi + 3 * 4
    assert LIMITED["PR"].workspace().area == pytest.approx(stadium - lens, rel=1e-12)


@each("lengths", FREE)
def test_area_of_an_arm_without_limits_is_an_annulus(lengths) -> None:
    inner = max(0, 2 * max(lengths) - sum(lengths))
    area = math.pi * (sum(lengths) ** 2 - inner**2)
    wanted = area if len(lengths) > 1 else 0.0
    assert PlanarArm(lengths).workspace().area == pytest.approx(wanted, rel=1e-13)


@each(
    ("arm", "shape"),
    [
        (PlanarArm((5,)), "circle"),
        (PlanarArm((5,), [(0, 1)]), "arc"),
        (PlanarArm((5,), [(1, 1)]), "point"),
        (PlanarArm((5,), [(1, 1 + 1e-12)]), "point"),
        (PlanarArm((5, 5), [(0, 1), (math.pi, math.pi)]), "point"),
        (PlanarArm((5, 4), [(0, 1e-12), (0, 1)]), "arc"),
        (PlanarArm((0,), [(1, 2)], "P"), "interval"),
        (PlanarArm((1,), [(2, 2)], "P"), "point"),
        (PlanarArm((5, 4)), "annulus"),
        (PlanarArm((5, 5)), "disc"),
        (PlanarArm((5, 4, 1)), "disc"),
        (PlanarArm((9, 2, 1)), "annulus"),
        (PlanarArm((1, 0), [None, (1, 3)], "RP"), "annulus"),
        (PlanarArm((1, 0), [None, (-1, 3)], "RP"), "disc"),
        (PlanarArm((5, 4), [None, (0.5, 0.5)]), "circle"),
        (PlanarArm((5, 4), [None, (-2.5, 2.5)]), "annulus"),
        (PlanarArm((5, 4), [(0, 2), (0.3, 2.5)]), "region"),
        (PlanarArm((1, 1), [(0, 1), (0, 1)], "PP"), "interval"),
        (PlanarArm((3, 5, 4), [(1, 1), None, None]), "annulus"),
        (PlanarArm((3, 5, 5), [(1, 1), None, None]), "disc"),
    ],
)
def test_shapes(arm: PlanarArm, shape: str) -> None:
    space = arm.workspace()
    assert space.shape == shape
    assert space.contains(random_tips(arm, 500, np.random.default_rng(4))).all()


@pytest.mark.parametrize("lengths", FREE)
def test_without_limits_two_routes_agree(
    lengths, monkeypatch: pytest.MonkeyPatch
) -> None:
    arm = PlanarArm(lengths)
    exact = arm.workspace()
    tips = np.linalg.norm(random_tips(arm, 20000, np.random.default_rng(5)), axis=1)
    low, high = exact.radii
    assert low - 1e-12 <= tips.min()
    assert tips.max() <= high + 1e-12
    assert high == pytest.approx(sum(lengths))
    general = general_route(arm, monkeypatch)
    assert (general.shape, len(general.edges)) == (exact.shape, len(exact.edges))
    assert general.area == pytest.approx(exact.area, rel=1e-12)
    radii = np.linspace(0, 1.1 * high, 200)
    ring = np.stack([radii * math.cos(0.3), radii * math.sin(0.3)], axis=-1)
    away = (np.abs(radii - low) > 1e-6) & (np.abs(radii - high) > 1e-6)
    assert np.array_equal(general.contains(ring)[away], exact.contains(ring)[away])


def test_annulus_of_varying_lengths_by_enumeration() -> None:
    rng = np.random.default_rng(6)
    for _ in range(300):
        count = int(rng.integers(1, 5))
        ranges = np.sort(rng.uniform(0, 3, (count, 2)), axis=1)
        lengths = ranges[:, 0] + rng.random((4000, count)) * np.diff(ranges).T
        corners = np.stack(np.meshgrid(*ranges), axis=-1).reshape(-1, count)
        lengths = np.vstack([lengths, corners])
        inner = np.maximum(0, 2 * lengths.max(axis=1) - lengths.sum(axis=1))
        low, high = annulus([tuple(r) for r in ranges])
        assert high == pytest.approx(lengths.sum(axis=1).max())
        assert low <= inner.min() + 1e-12
        assert low == pytest.approx(inner.min(), abs=0.35)
        if low > 0:  # the formula's own corner is among the samples
            assert low == pytest.approx(inner.min(), abs=1e-12)


def test_forward_kinematics_is_that_of_the_dh_chain() -> None:
    lengths = (5, 4, 1)
    rng = np.random.default_rng(7)
    chain = DHChain.from_table([[0, 0, a, 0, 0] for a in lengths])
    q = rng.uniform(-3, 3, (50, 3))
    pose = chain.forward_kinematics(q)
    tip = PlanarArm(lengths).forward_kinematics(q)
    assert np.abs(tip[:, :2] - pose[:, :2, 3]).max() < 1e-14
    assert np.abs(np.cos(tip[:, 2]) - pose[:, 0, 0]).max() < 1e-14


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_boundary_counts_to_a_billionth_of_the_reach(scale: float) -> None:
    space = PlanarArm((5 * scale, 4 * scale)).workspace()
    for radius, outwards in ((9 * scale, 1), (1 * scale, -1)):
        off = outwards * 9 * scale * np.array([-1e-9, 0.5e-9, 2e-9])
        found = space.contains(np.stack([np.zeros(3), radius + off], axis=-1))
        assert found.tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("arm", "reach"),
    [
        (PlanarArm((5, 4), [(-3, 3), None]), 9.0),
        (PlanarArm((1, 0.5), [None, (-3, 2)], "RP"), 1 + 0.5 + 3),
        (PlanarArm((0, 2), [(1, 4), (-0.5, 0.5)], "PR"), 4 + 2),
    ],
)
def test_the_reach_is_the_sum_of_the_longest_links(
    arm: PlanarArm, reach: float
) -> None:
    assert arm.reach == reach


@each(
    ("call", "error", "words"),
    [
        (lambda: PlanarArm(()), ShapeError, "at least one"),
        (lambda: PlanarArm(3), ShapeError, "lengths"),
        (lambda: PlanarArm((1, -2)), InputError, "positive, got -2"),
        (lambda: PlanarArm((1, 0)), InputError, "positive, got 0"),
        (lambda: PlanarArm((1, math.nan)), NonFiniteError, r"lengths\[1\]"),
        (lambda: PlanarArm((1, math.inf)), NonFiniteError, r"lengths\[1\]"),
        (lambda: PlanarArm(("a",)), InputError, "lengths"),
        (lambda: PlanarArm((1, 2), [(1, 0), None]), InputError, "lower <= upper"),
        (lambda: PlanarArm((1, 2), [(0, 1)]), ShapeError, "limits"),
        (lambda: PlanarArm((1, 2), [(0, math.nan), None]), NonFiniteError, "limits"),
        (lambda: PlanarArm((1, 2), [(0, 1, 2), None]), ShapeError, "limits"),
        (lambda: PlanarArm((1, 2), None, "RX"), InputError, "joints"),
        (lambda: PlanarArm((1, 2), None, "R"), InputError, "joints"),
        (lambda: PlanarArm((1, 2), None, "RP"), MissingParameterError, "prismatic"),
        (lambda: PlanarArm((1, -1), [None, (0, 1)], "RP"), InputError, "not negative"),
        (lambda: PlanarArm((1, 2), angles=(0,)), ShapeError, "angles"),
        (lambda: PlanarArm((1, 2), angles=[[0, 0]]), ShapeError, "angles"),
        (lambda: PlanarArm((1, 2), [[[0, 1]], None]), ShapeError, "a pair"),
        (lambda: PlanarArm([[1, 2]]), ShapeError, "at least one"),
        (lambda: PlanarArm((1, 2)).forward_kinematics([1]), ShapeError, "q"),
        (
            lambda: PlanarArm((1, 2)).workspace().contains([1, 2, 3]),
            ShapeError,
            "points",
        ),
    ],
)
def test_bad_input(call, error, words) -> None:
    with pytest.raises(error, match=words) as caught:
        call()
    assert isinstance(caught.value, Alpha5Error)


def test_public_names_and_ranges_of_a_turn() -> None:
    assert a5.planar.PlanarArm is PlanarArm
    assert PlanarArm((1,), [(-math.pi, math.pi)]).limits == (None,)
    assert isinstance(PlanarArm((0,), [(1, 2)], "P").workspace().thin[0], Segment)
    assert PlanarArm((1, 2)) == PlanarArm((1, 2), [None, (0, TURN)])


@pytest.mark.parametrize("lengths", [(1.0, 1e-12), (1e10, 1.0, 1e-3), (1.0, 1e-17)])
def test_a_link_too_short_to_matter_is_no_error(lengths: tuple[float, ...]) -> None:
    region = PlanarArm(lengths).workspace()
    assert region.contains([lengths[0], 0.0])
    assert not region.contains([1.01 * lengths[0], 0.0])
    assert region.area == pytest.approx(
        math.pi * (sum(lengths) ** 2 - (lengths[0] - sum(lengths[1:])) ** 2),
        abs=1e-8 * lengths[0] ** 2,  # a ring thinner than the tolerance is a circle
    )


def test_an_arm_whose_area_overflows_is_refused() -> None:
    with pytest.raises(InputError, match="finite"):
        PlanarArm((1e308, 1e308))
