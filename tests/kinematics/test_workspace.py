"""The workspace's boundary, distances and sizes agree with sampling and search."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fk import FOLDED, STRETCHED, WEDGE, fk, sample, tip
from reach_by_minimising import L_1, L_2, numerical_distance, squared
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.errors import UnknownNameError
from alpha5_model.kinematics.half_plane import Arc, first_moment

space = a5.workspace
#: Box around everything that can be reached [m].
BOX = np.array([[-0.36, 0.36], [-0.36, 0.36], [-0.30, 0.39]])


def test_the_minimised_function_is_the_retyped_table() -> None:
    for q in sample(20, seed=49):
        value, slope = squared(q[:3], [0.1, 0.2, 0.3])
        assert value == pytest.approx(
            ((tip(q) - [0.1, 0.2, 0.3]) ** 2).sum(), abs=1e-15
        )
        for j in range(3):
            step = 1e-6 * np.eye(3)[j]
            change = (
                squared(q[:3] + step, [0.1, 0.2, 0.3])[0]
                - squared(q[:3] - step, [0.1, 0.2, 0.3])[0]
            )
            assert change / 2e-6 == pytest.approx(slope[j], abs=1e-9)


def test_distance_is_the_least_over_all_joint_positions() -> None:
    rng = np.random.default_rng(50)
    target = rng.uniform(BOX[:, 0] - 0.1, BOX[:, 1] + 0.1, (400, 3))
    target = target[~a5.reachable(target)][:3]
    distance = a5.distance_to_reach(target)
    numerical = np.array([numerical_distance(t) for t in target])
    np.testing.assert_allclose(distance, numerical, rtol=0, atol=1e-13)


@pytest.mark.slow
def test_distance_in_the_closed_wedges_and_near_the_axis() -> None:
    rng = np.random.default_rng(51)
    azimuth = np.concatenate(
        [rng.uniform(-0.1402, 0.0174, 40), math.pi + rng.uniform(-0.1402, 0.0174, 40)]
    )
    radius = rng.uniform(0.0, 0.36, 80) ** 1.5 * 1.6
    z = rng.uniform(-0.3, 0.4, 80)
    target = np.stack([radius * np.cos(azimuth), radius * np.sin(azimuth), z], axis=-1)
    target = target[~a5.reachable(target)][::8][:5]
    numerical = np.array([numerical_distance(t) for t in target])
    np.testing.assert_allclose(
        a5.distance_to_reach(target), numerical, rtol=0, atol=1e-7
    )


def test_a_wedge_is_not_the_solid_of_revolution() -> None:
    """A point in the wedge that other azimuths reach is some distance from its face."""
    near_the_shoulder = ((0.165, 0.045), (0.155, 0.04))  # Only one pose gets there.
    for R, z in near_the_shoulder:
        turned = [R * math.cos(1.0), R * math.sin(1.0), z]
        closed = [R * math.cos(-0.06), R * math.sin(-0.06), z]
        assert a5.reachable(turned)
        assert not a5.reachable(closed)
        gap = float(a5.distance_to_reach(closed))
        assert gap > 1e-4
        assert numerical_distance(np.array(closed)) == pytest.approx(gap, abs=1e-7)
    over = [0.05 * math.cos(-0.06), 0.05 * math.sin(-0.06), 0.0]
    assert not a5.reachable(over)
    assert a5.reachable([0.05 * math.cos(1.0), 0.05 * math.sin(1.0), 0.0])
    gap = float(a5.distance_to_reach(over))
    assert numerical_distance(np.array(over)) == pytest.approx(gap, abs=1e-7)


@pytest.mark.slow
def test_nearest_point_is_reachable_and_at_the_distance() -> None:
    rng = np.random.default_rng(52)
    target = rng.uniform(-0.6, 0.6, (20_000, 3))
    nearest = a5.nearest_reachable(target)
    distance = a5.distance_to_reach(target)
    assert a5.reachable(nearest).all()
    np.testing.assert_allclose(
        np.linalg.norm(target - nearest, axis=-1), distance, atol=1e-15
    )
    inside = a5.reachable(target)
    assert np.array_equal(distance == 0.0, inside)
    assert np.array_equal(nearest[inside], target[inside])
    # Nothing that the arm does reach is nearer.
    cloud = tip(sample(200_000, seed=53))
    for i in np.flatnonzero(~inside)[:100]:
        assert np.linalg.norm(cloud - target[i], axis=-1).min() >= distance[i] - 1e-12


@pytest.mark.parametrize("limits", [True, False])
def test_points_very_far_away_have_a_nearest_point(limits: bool) -> None:
    """Squares of their distances would overflow."""
    direction = np.random.default_rng(48).normal(size=(30, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    for far in (1e9, 1e99, 1e150, 1e300):
        found = a5.nearest_reachable(far * direction, limits)
        assert a5.reachable(found, limits).all()
        distance = a5.distance_to_reach(far * direction, limits)
        assert distance == pytest.approx(np.full(30, far), rel=1e-9)


@pytest.mark.parametrize(
    "side", ["underarm", "overarm", pytest.param("both", marks=pytest.mark.slow)]
)
def test_both_sides_of_every_arc(side: str) -> None:
    """A point 1e-6 m inside an arc is reached, and one 1e-6 m outside is not.

    In the middle of each arc, a minimiser that knows the joint limits only agrees.
    """
    azimuth = 1.0
    pairs = []
    for arc in space.boundary(side):
        for share in (0.1, 0.5, 0.9):
            at = arc.start + share * (arc.end - arc.start)
            for step, filled in ((-1e-6, 1), (1e-6, -1)):
                R = arc.center[0] + (arc.radius + step) * math.cos(at)
                z = arc.center[1] + (arc.radius + step) * math.sin(at)
                point = np.array([R * math.cos(azimuth), R * math.sin(azimuth), z])
                pairs.append((point, arc.filled == filled, (R, z), share == 0.5))
    for point, inside, (R, z), middle in pairs:
        assert bool(space.in_half_plane(np.array(R), np.array(z), side)) == inside
        if side == "both":
            assert bool(a5.reachable(point)) == inside
        if side == "both" and middle:
            gap = numerical_distance(point)
            assert (gap < 1e-8) if inside else (gap == pytest.approx(1e-6, abs=1e-8))


def test_the_boundary_is_closed_and_every_kind_of_limit_is_in_it() -> None:
    for side in space.SIDES:
        ends = []
        for arc in space.boundary(side):
            ends += arc.points([arc.start, arc.end]).tolist()
        for r, z in ends:
            if abs(r) > 1e-9:
                twins = sum(math.hypot(r - x, z - y) < 1e-9 for x, y in ends)
                assert twins == 2, (side, r, z)
    causes = {arc.cause for side in space.SIDES for arc in space.boundary(side)}
    assert causes == {
        "stretched",
        "theta_1 at its lower limit",
        "theta_1 at its upper limit",
        "theta_2 at its lower limit",
        "theta_2 at its upper limit",
    }


def test_reachable_agrees_with_forward_kinematics() -> None:
    assert a5.reachable(tip(sample(50_000, seed=54))).all()
    # Without limits every angle counts, and the set is a full solid of revolution.
    free = np.random.default_rng(55).uniform(-math.pi, math.pi, (50_000, 4))
    assert a5.reachable(tip(free), limits=False).all()
    assert a5.reachable(tip(free)).mean() < 0.8


def test_distance_without_limits_is_to_two_tori() -> None:
    rng = np.random.default_rng(56)
    p = rng.uniform(-0.6, 0.6, (5000, 3))
    R = np.hypot(p[:, 0], p[:, 1])
    l_1 = math.hypot(0.04, 0.1453)
    l_2 = math.hypot(0.02, 0.18)
    gaps = []
    for center in (0.02, -0.02):
        rho = np.hypot(R - center, p[:, 2] - 0.0462)
        outside = rho - (l_1 + l_2)
        within = abs(l_1 - l_2) - rho
        gaps.append(np.maximum(np.maximum(outside, within), 0.0))
    np.testing.assert_allclose(
        a5.distance_to_reach(p, limits=False), np.minimum(*gaps), atol=1e-14
    )


@pytest.mark.parametrize("limits", [True, False])
def test_area_and_volume_by_monte_carlo(limits: bool) -> None:
    rng = np.random.default_rng(57)
    n = 300_000
    R = rng.uniform(0.0, 0.36, n)
    z = rng.uniform(-0.30, 0.39, n)
    box = 0.36 * 0.69
    for side in space.SIDES:
        share = space.in_half_plane(R, z, side, limits).mean()
        sigma = box * math.sqrt(share * (1 - share) / n)
        assert abs(space.cross_section_area(side, limits) - share * box) < 4 * sigma
    p = rng.uniform(BOX[:, 0], BOX[:, 1], (n, 3))
    size = float(np.prod(BOX[:, 1] - BOX[:, 0]))
    share = a5.reachable(p, limits).mean()
    assert abs(space.volume(limits) - share * size) < 4 * size * math.sqrt(
        share * (1 - share) / n
    )


@pytest.mark.parametrize("side", ["underarm", "overarm"])
def test_a_pose_reaches_what_a_planar_arm_with_limits_reaches(side: str) -> None:
    """The half-plane is what the planar arm reaches in front of the yaw axis."""
    lift = math.atan2(0.040, 0.1453) - math.pi / 2
    first = (LOWER[1] + lift, UPPER[1] + lift)
    second = (STRETCHED - UPPER[2], STRETCHED - LOWER[2])
    region = a5.planar.PlanarArm((L_1, L_2), [first, second]).workspace()
    sign = 1 if side == "underarm" else -1

    def held(R: np.ndarray, z: np.ndarray) -> np.ndarray:
        return region.contains(np.stack([sign * R - 0.020, z - 0.0462], axis=-1))

    rng = np.random.default_rng(66)
    R = rng.uniform(0.0, 0.36, 20_000)
    z = rng.uniform(-0.30, 0.39, 20_000)
    assert np.array_equal(held(R, z), space.in_half_plane(R, z, side))
    # The area behind the axis is counted in squares that are small enough for 5e-5.
    x = np.linspace(0.0, 0.36, 721)[1:] - 0.36 / 1440
    z = np.linspace(-0.30, 0.39, 691)[1:] - 0.69 / 1380
    behind = held(*np.meshgrid(-x, z)).mean() * 0.36 * 0.69
    assert region.area - behind == pytest.approx(
        space.cross_section_area(side), abs=5e-5
    )


def test_volume_without_limits_by_pappus() -> None:
    """The volume is that of the spindle torus which two mirrored rings sweep."""
    l_1 = math.hypot(0.04, 0.1453)
    l_2 = math.hypot(0.02, 0.18)
    outer = l_1 + l_2
    inner = abs(l_1 - l_2)
    z = outer * np.sin(np.linspace(-math.pi / 2, math.pi / 2, 200_001))
    half = np.sqrt(np.maximum(outer**2 - z**2, 0.0))
    far = 0.02 + half
    # Above and below, the torus has a dimple around the axis.
    dimple = np.maximum(0.02 - half, 0.0)
    # The holes of both discs meet in the hole of the body.
    hole = np.maximum(np.sqrt(np.maximum(inner**2 - z**2, 0.0)) - 0.02, 0.0)
    area = math.pi * (far**2 - hole**2 - dimple**2)
    volume = ((area[1:] + area[:-1]) / 2 * np.diff(z)).sum()
    assert space.volume(limits=False) == pytest.approx(volume, rel=1e-6)


def test_volume_lost_to_the_wedges() -> None:
    """If theta_0 were free, the wedges would be as full as the rest."""
    moment = {side: first_moment(space.boundary(side)) for side in space.SIDES}
    lost = WEDGE * (2 * moment["both"] - moment["underarm"] - moment["overarm"])
    assert space.volume() == pytest.approx(
        2 * math.pi * moment["both"] - lost, rel=1e-12
    )
    assert lost > 1e-4


def test_published_tori_as_printed() -> None:
    outer, inner, downward = space.published_tori()
    assert outer.radius == pytest.approx(
        math.hypot(0.04, 0.1453) + math.hypot(0.18, 0.02), abs=1e-15
    )
    assert inner.radius == pytest.approx(
        math.hypot(0.03994 + 0.02, 0.1453 - 0.18), abs=1e-15
    )
    assert downward.radius == pytest.approx(0.18, abs=1e-15)
    assert downward.center == pytest.approx((0.02, 0.0462 - 0.1453), abs=1e-15)
    p = np.random.default_rng(58).uniform(-0.4, 0.4, (20_000, 3))
    s = (np.hypot(p[:, 0], p[:, 1]) - 0.02) ** 2
    d = p[:, 2] - 0.0462
    printed = (
        (s + d**2 <= (math.hypot(0.04, 0.1453) + math.hypot(0.18, 0.02)) ** 2)
        & (s + d**2 >= 0.05994**2 + (0.1453 - 0.18) ** 2)
        & (s + (d + 0.1453) ** 2 >= 0.18**2)
    )
    assert np.array_equal(space.published_reachable(p), printed)


def test_errors_of_the_published_region_by_monte_carlo() -> None:
    e = space.published_errors()
    rng = np.random.default_rng(59)
    n = 400_000
    p = rng.uniform(BOX[:, 0], BOX[:, 1], (n, 3))
    size = float(np.prod(BOX[:, 1] - BOX[:, 0]))
    said = space.published_reachable(p)
    is_so = a5.reachable(p)
    for exact, mask in (
        (e.published_volume, said),
        (e.reachable_volume, is_so),
        (e.unreachable_volume, said & ~is_so),
        (e.missed_volume, is_so & ~said),
    ):
        share = mask.mean()
        assert abs(exact - share * size) < 4 * size * math.sqrt(share * (1 - share) / n)
    assert e.published_area - e.unreachable_area == pytest.approx(
        e.reachable_area - e.missed_area, abs=1e-12
    )
    assert e.published_volume - e.unreachable_volume == pytest.approx(
        e.reachable_volume - e.missed_volume, abs=1e-12
    )
    assert 0.05 < e.unreachable_area / e.published_area < 0.15


def test_manipulability_is_the_determinant_of_the_jacobian() -> None:
    q = sample(2000, seed=60)
    jacobian = a5.dh.DHChain.alpha5().jacobian(q)[:, :3, :]
    yoshikawa = np.sqrt(
        np.maximum(np.linalg.det(jacobian @ np.swapaxes(jacobian, 1, 2)), 0.0)
    )
    np.testing.assert_allclose(space.manipulability(q), yoshikawa, rtol=0, atol=1e-10)
    assert space.manipulability(q[0]).shape == ()


def test_singular_sets() -> None:
    q = sample(3000, seed=61)
    s = space.singularities(q)
    np.testing.assert_allclose(s.stretched, q[:, 2] - STRETCHED, atol=1e-12)
    np.testing.assert_allclose(np.cos(s.folded), np.cos(q[:, 2] - FOLDED), atol=1e-12)
    p = tip(q)
    np.testing.assert_allclose(
        np.abs(s.yaw_axis), np.hypot(p[:, 0], p[:, 1]), atol=1e-15
    )
    facing = np.cos(np.arctan2(p[:, 1], p[:, 0]) - q[:, 0] - math.pi)
    assert np.array_equal(np.sign(s.yaw_axis), np.sign(facing))
    angles = space.singular_elbow_angles()
    assert angles["stretched"] == pytest.approx(STRETCHED, abs=1e-15)
    assert angles["folded"] == pytest.approx(FOLDED, abs=1e-15)
    for name, value in angles.items():
        on = q.copy()
        on[:, 2] = value
        assert space.singularities(on).near().all(), name
        assert space.manipulability(on).max() < 1e-16
        jacobian = a5.dh.DHChain.alpha5().jacobian(on)[:, :3]
        assert np.linalg.matrix_rank(jacobian, tol=1e-9).max() <= 2
    assert not s.near().all()


def test_how_near_is_near() -> None:
    """A millionth of a radian, or a thousandth of a millimetre; or as you say."""
    q = np.array([3.0, 1.6, 1.0, 0.5])
    for off in (0.9e-6, -0.9e-6, 1.1e-6, -1.1e-6):
        for angle in (STRETCHED, FOLDED):
            q[2] = angle + off
            assert space.singularities(q).near() == (abs(off) < 1e-6)
            assert not space.singularities(q).near(angle=0.5e-6)
            assert space.singularities(q).near(angle=2e-6)
    to_axis = a5.inverse_kinematics([0.0, 0.0, 0.3]).best([3.0, 1.0, 1.0, 0.0])
    turned = to_axis + np.array([0.0, 1e-3, 0.0, 0.0])
    distance = abs(float(space.singularities(turned).yaw_axis))
    assert 1e-5 < distance < 1e-3
    assert space.singularities(turned).near(distance=1.01 * distance)
    assert not space.singularities(turned).near(distance=0.99 * distance)
    assert not space.singularities(turned).near()
    for bad in ({"angle": -0.5}, {"distance": -0.5}):
        with pytest.raises(a5.Alpha5Error, match="at least 0"):
            space.singularities(q).near(**bad)


def test_the_moment_of_arcs_is_that_of_their_points() -> None:
    """The integral of R^2 / 2 dz over a polygon of many points."""
    rng = np.random.default_rng(63)
    for _ in range(10):
        start = rng.uniform(-4.0, 4.0)
        arc = Arc(
            center=(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)),
            radius=rng.uniform(0.1, 0.4),
            start=start,
            end=start + rng.uniform(0.2, 6.0),
            filled=int(rng.choice([-1, 1])),
            cause="any",
            side="underarm",
        )
        r, z = arc.points(np.linspace(arc.start, arc.end, 20_001)).T
        # Simpson's rule for R^2 on straight pieces.
        square = (r[1:] ** 2 + r[1:] * r[:-1] + r[:-1] ** 2) / 3
        expected = arc.filled * (square / 2 * np.diff(z)).sum()
        assert first_moment([arc]) == pytest.approx(expected, abs=1e-8)
    assert first_moment([]) == 0.0


def test_the_middle_of_each_arc_is_within_a_half_turn() -> None:
    for side in space.SIDES:
        for limits in (True, False):
            for arc in space.boundary(side, limits):
                assert abs(arc.start + arc.end) / 2 <= math.pi + 1e-12
                assert 0.0 < arc.end - arc.start <= math.tau
                assert arc.filled in (-1, 1)


def test_yaw_axis_singularity() -> None:
    best = a5.inverse_kinematics([0.0, 0.0, 0.3]).best([3.0, 1.0, 1.0, 0.0])
    assert space.singularities(best).near()
    assert space.manipulability(best) < 1e-16


@pytest.mark.parametrize("shape", [(), (0,), (4,), (2, 3)])
def test_shapes(shape: tuple[int, ...]) -> None:
    p = np.full((*shape, 3), 0.5)
    assert a5.reachable(p).shape == shape
    assert a5.distance_to_reach(p).shape == shape
    assert a5.nearest_reachable(p).shape == (*shape, 3)
    assert space.published_reachable(p).shape == shape


@pytest.mark.parametrize(
    "bad", [[0.1, 0.2], "abc", [np.nan, 0, 0], [[0, 0, 0], [0, np.inf, 0]], [1j, 0, 0]]
)
def test_bad_input(bad: object) -> None:
    for function in (
        a5.reachable,
        a5.distance_to_reach,
        a5.nearest_reachable,
        space.published_reachable,
    ):
        with pytest.raises(a5.Alpha5Error):
            function(bad)  # type: ignore[operator]


def test_unknown_side() -> None:
    with pytest.raises(UnknownNameError, match="underarm, overarm, both"):
        space.boundary("left")


def test_retyped_kinematics_is_rigid() -> None:
    r = fk(sample(10, seed=62))[:, :3, :3]
    np.testing.assert_allclose(
        r @ np.swapaxes(r, 1, 2), np.broadcast_to(np.eye(3), (10, 3, 3)), atol=1e-14
    )


@pytest.mark.parametrize(
    "limits",
    [(LOWER[2], UPPER[2]), (0.5, STRETCHED - 0.3), (STRETCHED + 0.2, 3.0), (1.0, 2.5)],
)
def test_the_outer_torus_is_measured_within_the_limits_of_theta_2(
    limits: tuple[float, float],
) -> None:
    """The audit's longest distance from shoulder to tcp obeys the law of cosines."""
    from dataclasses import replace

    from alpha5_model.proofs.audit import geometry

    p = a5.parameters()
    joints = list(p.joints)
    joints[2] = replace(joints[2], lower=limits[0], upper=limits[1])
    limited = replace(p, joints=tuple(joints))
    found = {row.claim: row for row in geometry.rows(a5.published(), limited)}
    nearest = min(max(STRETCHED, limits[0]), limits[1])
    bend = math.pi - abs(nearest - STRETCHED)
    longest = math.sqrt(L_1**2 + L_2**2 - 2 * L_1 * L_2 * math.cos(bend))
    measured = found["workspace.outer_torus"].measured
    assert measured == pytest.approx(1e3 * longest, abs=1e-6)


def test_half_planes_take_shapes_that_broadcast() -> None:
    radius = np.linspace(0, 0.4, 5)
    z = np.linspace(-0.2, 0.3, 4)[:, None]
    for function in (a5.workspace.in_half_plane, a5.workspace.in_tori):
        table = function(radius, z)
        assert table.shape == (4, 5)
        for i, j in np.ndindex(4, 5):
            assert table[i, j] == function(radius[j], z[i, 0])
        with pytest.raises(a5.errors.InputError, match="radius, z"):
            function(radius, z[:, 0])
