"""Dexterous workspaces agree with the theorem, brute force and the notes' table."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from loops import each

from alpha5_model.errors import Alpha5Error, InputError
from alpha5_model.theory.planar import (
    PlanarArm,
    dexterity,
    dexterity_map,
    dexterous_area,
    dexterous_radii,
    lecture_theorem,
    necessary_conditions,
    theorem_radii,
    theorem_row,
    turns_fully,
)

#: The notes' experiment with l = (5, 4, 1): l_4, sum of the pair, half the total.
NOTES = [
    (10, 9, 10),
    (9, 9, 9.5),
    (8, 9, 9),
    (7, 9, 8.5),
    (6, 9, 8),
    (5, 9, 7.5),
    (4, 8, 7),
    (3, 7, 6.5),
    (2, 6, 6),
    (1.9, 5.9, 5.95),
]


def brute_force(
    lengths: np.ndarray, radius: np.ndarray, turns: int = 720
) -> np.ndarray:
    """Whether 3R arms reach a point at each of many angles of the last link.

    Args:
        lengths: (M, 3).
        radius: Distance of the pinned tip from the base, (M,).

    Returns:
        Whether the law of cosines has a solution at every step, (M,).
    """
    # An even number of turns includes both critical directions, 0 and pi.
    phi = np.arange(turns) * (2 * math.pi / turns)
    l_1, l_2, l_3 = lengths.T[..., None]
    wrist_x = radius[:, None] - l_3 * np.cos(phi)
    wrist_y = -l_3 * np.sin(phi)
    cosine = (wrist_x**2 + wrist_y**2 - l_1**2 - l_2**2) / (2 * l_1 * l_2)
    return (np.abs(cosine) <= 1 + 1e-12).all(axis=1)


def literal_theorem(l_1: float, l_2: float, l_3: float, l_4: float) -> bool:
    half = (l_1 + l_2 + l_3 + l_4) / 2
    lengths = {1: l_1, 2: l_2, 4: l_4}
    return all(
        lengths[i] + lengths[j] >= half for i in lengths for j in lengths if i != j
    )


def test_the_table_of_the_notes() -> None:
    for l_4, pair, half in NOTES:
        row = theorem_row(5, 4, 1, l_4)
        assert (row.l_4, row.pair, row.half) == pytest.approx(
            (l_4, pair, half), abs=1e-12
        )
        assert row.theorem == (pair >= half) == (2 <= l_4 <= 8)
        assert row.exact == row.theorem
    assert theorem_radii(5, 4, 1) == (2, 8)
    assert dexterous_radii(PlanarArm((5, 4, 1))) == ((0, 0), (2, 8))


def test_with_equal_indices_the_theorem_would_contradict_the_table() -> None:
    """2 l_4 >= L/2 fails for l_4 = 2, which the notes count as satisfied.

    So the indices i and j of the theorem differ.
    """
    assert lecture_theorem(5, 4, 1, 2)
    assert 2 * 2 < (5 + 4 + 1 + 2) / 2


def test_the_cases_where_theorem_and_truth_differ() -> None:
    assert not lecture_theorem(5, 5, 3, 1)
    assert turns_fully(PlanarArm((5, 5, 3)), 1)
    assert not lecture_theorem(5, 4, 1, 0)
    assert turns_fully(PlanarArm((5, 4, 1)), 0)
    assert dexterous_radii(PlanarArm((5, 5, 3))) == ((0, 7),)
    assert theorem_radii(5, 5, 3) == (3, 7)


@pytest.mark.parametrize("integers", [False, True])
def test_theorem_and_exact_condition_against_brute_force(integers: bool) -> None:
    """The exact condition is brute force's; the theorem is sufficient, not necessary.

    Small integers hit every equality, zero radius included.
    """
    rng = np.random.default_rng(int(integers))
    count = 3000
    if integers:
        lengths = rng.integers(1, 7, (count, 3)) * 1.0
        radius = rng.integers(0, 12, count) * 1.0
    else:
        lengths = rng.uniform(0.1, 3, (count, 3))
        radius = rng.uniform(0, 6, count)
    truth = brute_force(lengths, radius)
    cases = list(zip(lengths, radius, strict=True))
    exact = np.array([turns_fully(PlanarArm(ls), r) for ls, r in cases])
    theorem = np.array([lecture_theorem(*ls, r) for ls, r in cases])
    literal = np.array([literal_theorem(*ls, r) for ls, r in cases])
    assert np.array_equal(exact, truth)
    assert np.array_equal(theorem, literal)
    assert not (theorem & ~truth).any()  # sufficient
    missed = truth & ~theorem
    assert missed.sum() > count / 100  # and not necessary
    # Wherever it misses, l_4 is the shortest link, and shorter than l_3.
    assert (radius[missed] <= lengths[missed].min(axis=1)).all()
    assert (radius[missed] < lengths[missed, 2]).all()


def test_intervals_against_brute_force() -> None:
    rng = np.random.default_rng(2)
    for k in range(150):
        lengths = rng.integers(1, 7, 3) * 1.0 if k % 2 else rng.uniform(0.1, 3, 3)
        intervals = dexterous_radii(PlanarArm(lengths))
        ends = [x for interval in intervals for x in interval]
        assert ends == sorted(ends)
        radius = np.concatenate([np.linspace(0, lengths.sum(), 60), ends])
        near = np.abs(radius[:, None] - np.array([*ends, -1.0])).min(axis=1) < 1e-9
        inside = np.array([any(a <= r <= b for a, b in intervals) for r in radius])
        truth = brute_force(np.broadcast_to(lengths, (len(radius), 3)), radius)
        assert np.array_equal((inside | near)[~near], truth[~near])
        assert truth[near].all()
        area = sum(math.pi * (b * b - a * a) for a, b in intervals)
        assert dexterous_area(PlanarArm(lengths)) == pytest.approx(area)
        theorem = theorem_radii(*lengths)
        if theorem is not None:
            assert lecture_theorem(*lengths, theorem[0])
            assert lecture_theorem(*lengths, theorem[1])
            assert not lecture_theorem(*lengths, theorem[1] + 1e-6)
            assert theorem[0] < 1e-6 or not lecture_theorem(*lengths, theorem[0] - 1e-6)
        else:
            assert not any(lecture_theorem(*lengths, r) for r in radius)


@pytest.mark.parametrize(
    "lengths", [(4, 2, 1, 1), (1, 1, 1, 1), (6, 1, 2, 2), (1, 2, 3, 7), (2, 2, 3, 3, 1)]
)
def test_more_joints_by_enumeration(lengths) -> None:
    """A point is dexterous if the sampled wrist reaches its whole circle around it."""
    rng = np.random.default_rng(3)
    arm = PlanarArm(lengths)
    q = rng.uniform(-math.pi, math.pi, (200000, arm.n - 1))
    q[:5000] = rng.choice([0, math.pi], (5000, arm.n - 1))
    wrist = np.linalg.norm(arm.part(0, arm.n - 1).forward_kinematics(q)[:, :2], axis=1)
    low = wrist.min()
    high = wrist.max()
    phi = np.arange(360) * math.pi / 180
    for r in np.linspace(0, sum(lengths), 101):
        circle = np.hypot(r - lengths[-1] * np.cos(phi), lengths[-1] * np.sin(phi))
        if min(abs(circle.min() - low), abs(circle.max() - high)) > 0.05:
            assert turns_fully(arm, r) == (circle.min() >= low and circle.max() <= high)


def each_orientation_is_reached(
    low: np.ndarray, high: np.ndarray, last_link: np.ndarray, r: float
) -> bool:
    """Whether at each of 72 orientations some lengths reach a point.

    Args:
        low: The least reach of the first two links, one for each pair of lengths.
        high: Their largest reach.
        last_link: The lengths of the last link.
        r: The distance of the point from the base.
    """
    phi = np.arange(72) * (2 * math.pi / 72)
    x = r - last_link[:, None] * np.cos(phi)
    y = last_link[:, None] * np.sin(phi)
    distance = np.hypot(x, y)[..., None]
    hit = ((distance >= low) & (distance <= high)).any(axis=-1)
    return bool(hit.any(axis=0).all())


@pytest.mark.slow
def test_lengths_that_vary_by_enumeration() -> None:
    """With prismatic joints, each orientation may have another set of lengths."""
    rng = np.random.default_rng(4)
    slack = 0.1
    for _ in range(60):
        travel = [tuple(np.sort(rng.uniform(0, 3, 2))) for _ in range(3)]
        arm = PlanarArm(
            rng.uniform(0.2, 2, 6),
            [limit for t in travel for limit in (None, t)],
            "RPRPRP",
        )
        first, second, link = (np.linspace(a, b, 41) for a, b in arm.length_ranges)
        l_1, l_2 = np.meshgrid(first, second, indexing="ij")
        # With any lengths, the first two links reach a union of annuli.
        low = np.abs(l_1 - l_2).ravel()
        high = (l_1 + l_2).ravel()
        for r in rng.uniform(0, 4, 4):
            if each_orientation_is_reached(low, high, link, r):
                assert turns_fully(arm, r)
            else:
                outer = r + link[0] <= high.max() - slack
                farthest = max(abs(r - link[0]), abs(r - link[-1]))
                inner = farthest >= low.min() + slack
                clearly_inside = outer and inner
                assert not turns_fully(arm, r) or not clearly_inside


def limited_brute_force(arm: PlanarArm, point: np.ndarray, turns: int) -> float:
    """The share of orientations that a 3R arm with limits has at a point."""
    orientations = [2 * math.pi * k / turns for k in range(turns)]
    reached = [
        any(within_limits(arm, q) for q in both_elbows(arm, point, phi))
        for phi in orientations
    ]
    return sum(reached) / turns


def both_elbows(arm: PlanarArm, point: np.ndarray, phi: float) -> list[Sequence[float]]:
    """The joint positions of a 3R arm at a point and an angle, elbow up and down."""
    l_1, l_2, l_3 = arm.lengths
    x = point[0] - l_3 * math.cos(phi)
    y = point[1] - l_3 * math.sin(phi)
    cosine = (x * x + y * y - l_1**2 - l_2**2) / (2 * l_1 * l_2)
    if abs(cosine) > 1:
        return []
    solutions = []
    for elbow in (math.acos(cosine), -math.acos(cosine)):
        inner_angle = math.atan2(l_2 * math.sin(elbow), l_1 + l_2 * math.cos(elbow))
        first = math.atan2(y, x) - inner_angle
        solutions.append((first, elbow, phi - first - elbow))
    return solutions


def within_limits(arm: PlanarArm, q: Sequence[float]) -> bool:
    """Whether each angle, shifted by full turns, has a value within its limits."""
    return all(
        limit is None or turn_within(angle, *limit)
        for angle, limit in zip(q, arm.limits, strict=True)
    )


def turn_within(angle: float, low: float, high: float) -> bool:
    return any(low <= angle + 2 * math.pi * turn <= high for turn in range(-3, 4))


def test_joint_limits_against_brute_force() -> None:
    rng = np.random.default_rng(5)
    for _ in range(25):
        limits = [
            None if rng.random() < 0.4 else tuple(np.sort(rng.uniform(-4, 4, 2)))
            for _ in range(3)
        ]
        arm = PlanarArm(rng.uniform(0.5, 3, 3), limits)
        points = rng.uniform(-1, 1, (6, 2)) * arm.reach
        share = dexterity(arm, points, orientations=45)
        wanted = [limited_brute_force(arm, p, 45) for p in points]
        assert np.abs(share - wanted).max() < 1e-12


def test_without_limits_the_map_is_the_exact_region() -> None:
    for lengths in [(5, 4, 1), (5, 5, 3), (2, 3, 4)]:
        arm = PlanarArm(lengths)
        radius = np.linspace(0.013, sum(lengths), 80)
        share = dexterity(
            arm, np.stack([radius, 0 * radius], axis=-1), orientations=360
        )
        exact = np.array([turns_fully(arm, r) for r in radius])
        assert np.array_equal(share == 1, exact)


@each("kinds", ["RPR", "PRR", "PPR", "RRR", "RRRR", "PRRR", "RPRR"])
def test_reached_orientations_are_reached(kinds: str) -> None:
    """`dexterity` counts the orientation of each sampled configuration."""
    rng = np.random.default_rng(6)
    n = len(kinds)
    limits = [(-1.0, 1.5) if k == "R" else (0.2, 2.0) for k in kinds]
    arm = PlanarArm(rng.uniform(0.5, 2, n), limits, kinds, rng.uniform(-1, 1, n))
    low, high = np.array(limits).T
    for q in low + rng.random((12, n)) * (high - low):
        if n > 3:
            # `dexterity` samples the first joint, which must stand at a sample.
            q[0] = np.linspace(low[0], high[0], 101)[47]
        # With one orientation, `dexterity` looks at zero. The first constant angle
        # turns this configuration there.
        heading = arm.forward_kinematics(q)[2]
        turned = PlanarArm(
            arm.lengths, limits, kinds, (arm.angles[0] - heading, *arm.angles[1:])
        )
        point = turned.forward_kinematics(q)[:2]
        assert dexterity(turned, point, orientations=1, samples=101) == 1


def test_a_wrist_stretched_or_folded_to_rounding_is_reached() -> None:
    rng = np.random.default_rng(10)
    for bend in (0.0, math.pi):
        for lengths in rng.uniform(0.5, 2, (40, 3)):
            arm = PlanarArm(lengths)
            q = np.array([rng.uniform(-3, 3), bend, 0.0])
            q[2] = -q[:2].sum()  # the orientation that is asked for
            assert dexterity(arm, arm.forward_kinematics(q)[:2], orientations=1) == 1


@pytest.mark.parametrize("kinds", ["RRR", "RPR", "PRR", "PPR"])
def test_the_mirror_image_reaches_as_much(kinds: str) -> None:
    rng = np.random.default_rng(9)
    some = 0
    for _ in range(10):
        lengths = rng.uniform(0.5, 2, 3)
        angles = rng.uniform(-1, 1, 3)
        limits = np.sort(rng.uniform(-2, 2, (3, 2)))
        slides = np.array([k == "P" for k in kinds])
        limits[slides] = np.abs(limits[slides].sum(axis=1))[:, None] + [0.1, 1.0]
        image = np.where(slides[:, None], limits, -limits[:, ::-1])
        arm = PlanarArm(lengths, limits, kinds, angles)
        mirrored = PlanarArm(lengths, image, kinds, -angles)
        points = arm.forward_kinematics(rng.uniform(*limits.T, (20, 3)))[:, :2]
        share = dexterity(arm, points, orientations=72)
        assert share == pytest.approx(
            dexterity(mirrored, points * (1, -1), orientations=72)
        )
        some += (share > 0).sum()
    assert some > 50


def test_the_map_has_the_exact_area() -> None:
    arm = PlanarArm((5, 4, 1))
    found = dexterity_map(arm, resolution=81, orientations=120)
    assert found.share.shape == (len(found.y), len(found.x))
    assert found.spacing == pytest.approx(20 / 80)
    circles = 2 * math.pi * (2 + 8)  # half a square along either circle
    assert abs(found.area - dexterous_area(arm)) < 0.5 * found.spacing * circles
    limited = dexterity_map(PlanarArm((5, 4, 1), [None, None, (-3, 3)]), 41)
    assert 0 < limited.area < dexterous_area(arm)
    i, j = 12, 20
    point = np.array([limited.x[i], limited.y[j]])
    arm = PlanarArm((5, 4, 1), [None, None, (-3, 3)])
    assert limited.share[j, i] == pytest.approx(limited_brute_force(arm, point, 120))


@pytest.mark.parametrize("kinds", ["RRR", "RPR", "PRR", "PPR", "RRRR"])
def test_nothing_is_reached_where_squares_overflow(kinds: str) -> None:
    limits = [(-1.0, 1.0)] * len(kinds)
    arm = PlanarArm((2, 1, 1, 0.5)[: len(kinds)], limits, kinds, (0.5,) * len(kinds))
    points = [
        [-1e300, 1e300],
        [1e160, 0],
        arm.forward_kinematics(np.zeros(len(kinds)))[:2],
    ]
    assert (dexterity(arm, points, orientations=36, samples=3) > 0).tolist() == [
        False,
        False,
        True,
    ]


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_stretched_arm_reaches_in_one_direction(scale: float) -> None:
    arm = PlanarArm((5 * scale, 4 * scale, 1 * scale))
    assert dexterity(arm, [10 * scale, 0.0], orientations=4) == 0.25
    assert dexterity(arm, [0.0, -10 * scale], orientations=4) == 0.25
    assert dexterity(arm, [10.001 * scale, 0.0], orientations=4) == 0.0


def test_necessary_conditions() -> None:
    assert necessary_conditions(PlanarArm((5, 4, 1))).satisfied
    slides = PlanarArm((1, 1, 1), [(0, 1), (0, 1), None], "PPR")
    assert necessary_conditions(slides).satisfied
    two = necessary_conditions(PlanarArm((5, 5)))
    assert not two.satisfied
    assert "takes two" in two.reasons[0]
    limited = necessary_conditions(PlanarArm((5, 4, 1), [(0, 1)] * 3))
    assert [*limited.reasons] == [
        "the revolute joints together turn 3 rad, less than 2 pi: "
        "not every orientation occurs"
    ]


@pytest.mark.parametrize("limit", [0.9, 1.0, math.pi / 3, 2.2, 2.967, 3.2])
def test_conditions_never_deny_an_orientation_that_occurs(limit: float) -> None:
    """The notes ask for a joint without limits; the orientations say otherwise."""
    arm = PlanarArm((5, 4, 1), [(-limit, limit)] * 3)
    turn = np.linspace(-limit, limit, 61)
    # Sums of three ranges: the widest gap between orientations, round the circle.
    seen = np.sort(
        np.mod(np.add.outer(np.add.outer(turn, turn), turn).ravel(), 2 * math.pi)
    )
    gap = np.diff(np.append(seen, seen[0] + 2 * math.pi)).max()
    assert necessary_conditions(arm).satisfied == (gap < 0.25)
    found = dexterity_map(arm, resolution=21, orientations=60)
    assert necessary_conditions(arm).satisfied or found.area == 0


def test_limits_short_of_a_turn_leave_a_dexterous_workspace() -> None:
    """With all joints limited to 170 degrees either way, 155.8 stay dexterous."""
    arm = PlanarArm((5, 4, 1), [(-2.967, 2.967)] * 3)
    assert dexterity_map(arm).area == pytest.approx(155.8, abs=0.05)
    assert necessary_conditions(arm).satisfied


def test_the_slide_of_a_prismatic_joint_is_no_turn() -> None:
    sliding = PlanarArm((1, 1, 1), [(0, 9), (0, 9), (0, 1)], "PPR")
    assert "turn 1 rad" in necessary_conditions(sliding).reasons[0]


@pytest.mark.parametrize(
    ("lengths", "radii"),
    [
        ((3,), ()),
        ((5, 5), ((0, 0),)),
        ((1, 1, 2), ((0, 0),)),
        ((1, 1, 3), ()),
        ((3, 1, 1), ((3, 3),)),  # hand and elbow: r + 1 <= 4 and |r - 1| >= 2
        ((0.3, 0.2, 0.1), ((0, 0), (0.2, 0.4))),
    ],
)
def test_isolated_radii(lengths, radii) -> None:
    got = dexterous_radii(PlanarArm(lengths))
    assert len(got) == len(radii)
    for ours, wanted in zip(got, radii, strict=True):
        assert ours == pytest.approx(wanted, abs=1e-15)
    if all(a == b for a, b in radii):
        assert dexterous_area(PlanarArm(lengths)) == 0


@each(
    ("call", "words"),
    [
        (lambda: lecture_theorem(0, 1, 1, 1), "l_1"),
        (lambda: lecture_theorem(1, -1, 1, 1), "l_2"),
        (lambda: lecture_theorem(1, 1, math.nan, 1), "l_3"),
        (lambda: lecture_theorem(1, 1, 1, -0.1), "l_4"),
        (lambda: theorem_radii(1, 1, 0), "l_3"),
        (lambda: turns_fully(PlanarArm((1, 1)), -1), "radius"),
        (lambda: turns_fully(PlanarArm((1, 1), [(0, 1), None]), 1), "without limits"),
        (
            lambda: dexterous_radii(PlanarArm((1, 1), [(0, 1), None], "PR")),
            "without limits",
        ),
        (lambda: dexterity(PlanarArm((1, 1)), [0, 0]), "three joints"),
        (
            lambda: dexterity(
                PlanarArm((1, 1, 1), [None, None, (0, 1)], "RRP"), [0, 0]
            ),
            "last one R",
        ),
        (lambda: dexterity(PlanarArm((1, 1, 1)), [0, 0, 0]), "points"),
        (
            lambda: dexterity(PlanarArm((1, 1, 1)), [0, 0], orientations=0),
            "orientations",
        ),
        (lambda: dexterity(PlanarArm((1, 1, 1)), [0, 0], samples=1.5), "samples"),
        (lambda: dexterity_map(PlanarArm((1, 1, 1)), resolution=1), "resolution"),
        (lambda: dexterity_map(PlanarArm((1, 1))), "three joints"),
    ],
)
def test_bad_input(call, words) -> None:
    with pytest.raises(InputError, match=words) as caught:
        call()
    assert isinstance(caught.value, Alpha5Error)
