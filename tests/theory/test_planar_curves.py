"""Arcs and segments by their points: parts, motions, areas, and where they meet."""

from __future__ import annotations

import math

import numpy as np
import pytest
from loops import each

from alpha5_model.theory.arcs import (
    Arc,
    Circles,
    Lines,
    Segment,
    crossings,
    enclosed_area,
    outline,
)

Curve = Arc | Segment
TINY = 1e-9


def random_curve(rng: np.random.Generator, kind: type[Curve]) -> Curve:
    point = tuple(rng.uniform(-2, 2, 2).tolist())
    if kind is Arc:
        span = rng.uniform(0.5, 6.0)
        return Arc(
            center=point,
            radius=rng.uniform(0.5, 2.0),
            start=rng.uniform(-7, 7),
            span=span,
        )
    return Segment(start=point, angle=rng.uniform(-7, 7), length=rng.uniform(0.5, 2.0))


def points_of(curve: Curve, count: int = 2001) -> np.ndarray:
    return curve.point(np.linspace(*curve.interval, count))


CURVES = [
    random_curve(np.random.default_rng(seed), kind)
    for seed in range(8)
    for kind in (Arc, Segment)
]


@each("curve", CURVES)
def test_length_area_and_normal_are_those_of_the_points(curve: Curve) -> None:
    points = points_of(curve)
    step = np.diff(points, axis=0)
    assert np.linalg.norm(step, axis=1).sum() == pytest.approx(curve.length, rel=1e-5)
    x, y = points.T
    area = (x[:-1] * y[1:] - y[:-1] * x[1:]).sum() / 2
    assert curve.area_integral() == pytest.approx(area, abs=1e-5)
    low, high = curve.interval
    for share in (0.0, 0.3, 1.0):
        at = low + share * (high - low)
        ahead = curve.point(at + 1e-6) - curve.point(at - 1e-6)
        ahead /= np.linalg.norm(ahead)
        assert curve.left(at) == pytest.approx([-ahead[1], ahead[0]], abs=1e-8)


@each("curve", CURVES)
def test_a_parameter_gives_its_point_back(curve: Curve) -> None:
    low, high = curve.interval
    t = np.linspace(low, high, 21)
    found = curve.parameter(curve.point(t), TINY)
    assert found == pytest.approx(t, abs=1e-12)
    ahead = curve.point(np.array([low - 0.1, high + 0.1]))
    assert np.isnan(curve.parameter(ahead, TINY)).all()
    # Beyond an end by less than the tolerance, it is the end.
    per_unit = curve.radius if isinstance(curve, Arc) else 1.0
    for off, kept in ((0.9, True), (1.1, False)):
        near = np.array([low, high]) + np.array([-off, off]) * TINY / per_unit
        ends = curve.parameter(curve.point(near), TINY)
        if kept:
            assert ends == pytest.approx([low, high], abs=1e-12)
        else:
            assert np.isnan(ends).all()


@each("curve", CURVES)
def test_a_part_and_a_moved_curve_have_the_points(curve: Curve) -> None:
    low, high = curve.interval
    part = curve.piece(low + 0.1, high - 0.2)
    expected = curve.point(np.linspace(low + 0.1, high - 0.2, 11))
    assert points_of(part, 11) == pytest.approx(expected, abs=1e-12)
    angle, shift = 0.7, (0.3, -0.4)
    turn = np.array([[math.cos(0.7), -math.sin(0.7)], [math.sin(0.7), math.cos(0.7)]])
    moved = (points_of(curve, 11) + shift) @ turn.T
    assert points_of(curve.moved(angle, shift), 11) == pytest.approx(moved, abs=1e-12)


def crossings_of_circle(curve: Curve, center: np.ndarray, radius: float) -> np.ndarray:
    """Points of a curve next to the sign changes of its distance from a circle."""
    t = np.linspace(*curve.interval, 20_001)
    gap = np.linalg.norm(curve.point(t) - center, axis=1) - radius
    return curve.point(t[:-1][np.diff(np.sign(gap)) != 0])


def crossings_of_line(curve: Curve, start: np.ndarray, along: np.ndarray) -> np.ndarray:
    t = np.linspace(*curve.interval, 20_001)
    off = curve.point(t) - start
    gap = along[0] * off[:, 1] - along[1] * off[:, 0]
    return curve.point(t[:-1][np.diff(np.sign(gap)) != 0])


def assert_same_points(found: np.ndarray, expected: np.ndarray) -> None:
    found = found[~np.isnan(found).any(axis=-1)]
    assert len(found) == len(expected)
    for point in expected:
        assert np.linalg.norm(found - point, axis=1).min() < 1e-3


def test_circles_and_lines_meet_curves_where_the_distance_changes_sign() -> None:
    rng = np.random.default_rng(20)
    met = 0
    for curve in CURVES:
        centers = rng.uniform(-2, 2, (12, 2))
        radii = rng.uniform(0.3, 3.0, 12)
        directions = rng.normal(size=(12, 2))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        on_circles = crossings(Circles(centers, radii), curve, TINY)
        on_lines = crossings(Lines(centers, directions), curve, TINY)
        for k in range(12):
            expected = crossings_of_circle(curve, centers[k], radii[k])
            assert_same_points(on_circles[k], expected)
            met += len(expected)
            assert_same_points(
                on_lines[k], crossings_of_line(curve, centers[k], directions[k])
            )
        hits = on_circles[~np.isnan(on_circles).any(axis=-1)]
        assert not np.isnan(curve.parameter(hits, TINY)).any()
    assert met > 50


def test_a_square_of_lines_with_a_hole_and_a_hair() -> None:
    """Edges have the set on the left; a line that the set has on no side is thin."""
    square = [
        Segment(start=(0.0, 0.0), angle=0.0, length=4.0),
        Segment(start=(4.0, 0.0), angle=math.pi / 2, length=4.0),
        Segment(start=(4.0, 4.0), angle=math.pi, length=4.0),
        Segment(start=(0.0, 4.0), angle=-math.pi / 2, length=4.0),
    ]
    hole = Arc(center=(2.0, 2.0), radius=1.0)
    hair = Segment(start=(4.0, 1.0), angle=0.0, length=2.0)
    inside_only = Segment(start=(0.5, 0.5), angle=0.0, length=3.0)

    def contains(points: np.ndarray) -> np.ndarray:
        x, y = points.T
        box = (np.abs(x - 2.0) <= 2.0) & (np.abs(y - 2.0) <= 2.0)
        return np.asarray(box & (np.hypot(x - 2.0, y - 2.0) >= 1.0))

    curves: list[Curve] = [*square, hole, hair, inside_only]
    edges, thin = outline(curves, contains, size=10.0)
    assert enclosed_area(edges) == pytest.approx(16 - math.pi)
    length = sum(edge.curve.length for edge in edges)
    assert length == pytest.approx(16 + 2 * math.pi)
    assert len(thin) == 1
    assert thin[0].length == pytest.approx(2.0)
    assert points_of(thin[0], 2) == pytest.approx(np.array([[4.0, 1.0], [6.0, 1.0]]))


@pytest.mark.parametrize("radius", [0.01, 1.0, 300.0])
def test_parts_of_a_circle_are_one_edge_whatever_their_overlap(radius: float) -> None:
    """Their order, their turns and gaps within the tolerance make no difference."""
    rng = np.random.default_rng(3)

    def contains(points: np.ndarray) -> np.ndarray:
        return np.asarray(np.linalg.norm(points, axis=1) <= radius)

    for _ in range(50):
        count = rng.integers(1, 5)
        cuts = np.sort(rng.uniform(0.0, 2 * math.pi, count))
        spans = np.diff([*cuts, cuts[0] + 2 * math.pi]) - 1e-10
        overlap = rng.uniform(0.0, 1.0, count) * rng.integers(0, 2, count)
        turns = math.tau * rng.integers(-2, 3, count)
        rows = list(
            zip(cuts + turns, np.minimum(spans + overlap, math.tau), strict=True)
        )
        parts = [Arc((0.0, 0.0), radius, start, span) for start, span in rows]
        rng.shuffle(parts)
        (edge,), thin = outline(parts, contains, size=radius)
        assert thin == ()
        assert edge.inside_left
        assert edge.curve.length == pytest.approx(2 * math.pi * radius)
        assert enclosed_area([edge]) == pytest.approx(math.pi * radius**2)


def test_a_gap_wider_than_the_tolerance_stays() -> None:
    """A quarter of a circle in two parts, and the straight sides of the quarter."""
    for gap, count in ((0.5e-9, 1), (1e-6, 2)):
        parts: list[Curve] = [
            Arc((0.0, 0.0), 1.0, 0.0, 0.7),
            Arc((0.0, 0.0), 1.0, 0.7 + gap, math.pi / 2 - 0.7 - gap),
            Segment((0.0, 0.0), 0.0, 1.0),
            Segment((0.0, 0.0), math.pi / 2, 1.0),
        ]
        edges, _ = outline(
            parts,
            lambda p: (np.linalg.norm(p, axis=1) <= 1) & (p >= 0).all(axis=1),
            size=1.0,
        )
        assert sum(isinstance(edge.curve, Arc) for edge in edges) == count
        assert enclosed_area(edges) == pytest.approx(math.pi / 4, abs=1e-6)
