"""An arrangement of curves: united where they overlap, cut where they meet; what bounds a set."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.planar.curves import TURN, Arc, Curve, Segment, circle_hits, line_hits

#: Points (N, 2) [m] -> whether they belong to a set, (N,).
Contains = Callable[[FloatArray], BoolArray]


@dataclass(frozen=True)
class Edge:
    """A piece of boundary with the workspace on one side.

    Attributes:
        curve: The piece.
        inside_left: Whether the workspace lies to the left of the curve's sense.
    """

    curve: Curve
    inside_left: bool


def _united(curves: list[Curve], tolerance: float) -> list[Curve]:
    """The same point set with every circle and every line covered once."""
    groups: dict[int, list[Curve]] = {}
    for number, curve in enumerate(curves):
        same = (g for g in groups if _same_carrier(curves[g], curve, tolerance))
        groups.setdefault(next(same, number), []).append(curve)
    out: list[Curve] = []
    for members in groups.values():
        first = members[0]
        spans = sorted(_span_on(first, member) for member in members)
        slack = tolerance / _per_parameter(first)
        merged = [list(spans[0])]
        for low, high in spans[1:]:
            if low <= merged[-1][1] + slack:
                merged[-1][1] = max(merged[-1][1], high)
            else:
                merged.append([low, high])
        whole = TURN if isinstance(first, Arc) else math.inf
        if len(merged) > 1 and merged[-1][1] >= merged[0][0] + whole - slack:
            merged[-1][1] = max(merged[-1][1], merged[0][1] + TURN)
            del merged[0]
        for low, high in merged:
            piece = first.piece(low, high)
            if isinstance(piece, Arc) and piece.span >= TURN - slack:
                piece = replace(piece, span=TURN)
            out.append(piece)
    return out


def _same_carrier(a: Curve, b: Curve, tolerance: float) -> bool:
    if isinstance(a, Arc) and isinstance(b, Arc):
        return math.dist(a.center, b.center) <= tolerance and abs(a.radius - b.radius) <= tolerance
    if isinstance(a, Segment) and isinstance(b, Segment):
        ends = b.point(np.array(b.interval)) - np.asarray(a.start)
        return bool((np.abs(ends @ a.left(0.0)) <= tolerance).all())
    return False


def _span_on(first: Curve, member: Curve) -> tuple[float, float]:
    """Parameter range of `member` in the parameter of a curve on the same circle or line."""
    if isinstance(first, Arc) and isinstance(member, Arc):
        start = member.start % TURN
        return start, start + member.span
    assert isinstance(first, Segment)
    ends = member.point(np.array(member.interval)) - np.asarray(first.start)
    along = np.array([math.cos(first.angle), math.sin(first.angle)])
    low, high = sorted((ends @ along).tolist())
    return low, high


def bounds(
    curves: list[Curve], contains: Contains, tolerance: float, step: float
) -> tuple[tuple[Edge, ...], tuple[Curve, ...]]:
    """The boundary of a set that is known to lie on some curves.

    The curves are cut where they meet. A piece with the set on one side only is an edge.

    Args:
        curves: They may overlap.
        contains: Whether points (N, 2) belong to the set, (N,).
        tolerance: Distance up to which curves count as touching [m].
        step: Distance to either side at which `contains` is asked; shorter pieces are left out [m].

    Returns:
        The edges, and the pieces with nothing of the set on either side.
    """
    curves = _united(curves, tolerance)
    parts = [
        (number, low, high)
        for number, cuts in enumerate(_cuts(curves, tolerance, step))
        for low, high in pairwise(cuts)
        if (high - low) * _per_parameter(curves[number]) > step
    ]
    middles = [(curves[number], (low + high) / 2) for number, low, high in parts]
    at = np.array([curve.point(t) for curve, t in middles])
    normal = np.array([curve.left(t) for curve, t in middles])
    left, right = contains(at + step * normal), contains(at - step * normal)
    # Neighbouring pieces of one curve and one kind are one again: curve, start, end, sides.
    runs: list[list[tuple[float, float, bool, bool]]] = [[] for _ in curves]
    for (number, low, high), *sides in zip(parts, left.tolist(), right.tolist(), strict=True):
        run = runs[number]
        start = run.pop()[0] if run and [*run[-1][2:]] == sides else low
        run.append((start, high, *sides))
    edges, thin = [], []
    for curve, run in zip(curves, runs, strict=True):
        if curve.closed and len(run) > 1 and run[0][2:] == run[-1][2:]:
            run[0] = (run.pop()[0], run[0][1] + TURN, *run[0][2:])
        for start, end, inside_left, inside_right in run:
            piece = curve.piece(start, end)
            if inside_left != inside_right:
                edges.append(Edge(piece, inside_left))
            elif not inside_left:
                thin.append(piece)
    return tuple(edges), tuple(thin)


def _cuts(curves: list[Curve], tolerance: float, step: float) -> list[list[float]]:
    """Parameters at which each curve begins, meets another, and ends."""
    cuts: list[list[float]] = [list(c.interval) for c in curves]
    arcs = [(i, c) for i, c in enumerate(curves) if isinstance(c, Arc)]
    lines = [(i, c) for i, c in enumerate(curves) if isinstance(c, Segment)]
    centers = np.array([c.center for _, c in arcs]).reshape(-1, 2)
    radii = np.array([c.radius for _, c in arcs])
    starts = np.array([c.start for _, c in lines]).reshape(-1, 2)
    along = np.array([(math.cos(c.angle), math.sin(c.angle)) for _, c in lines]).reshape(-1, 2)
    cutters: list[tuple[int, Curve]] = [*arcs, *lines]
    for j, other in enumerate(curves):
        hits = [
            *circle_hits(centers, radii, other, tolerance),
            *line_hits(starts, along, other, tolerance),
        ]
        for (i, curve), points in zip(cutters, hits, strict=True):
            if i != j:
                t = curve.parameter(points, tolerance)
                cuts[i] += t[~np.isnan(t)].tolist()
    return [_merged(sorted(c), step / _per_parameter(k)) for c, k in zip(cuts, curves, strict=True)]


def _merged(cuts: list[float], width: float) -> list[float]:
    """Cuts closer together than `width` become one, at their mean; the first and last stay.

    Where curves touch, rounding makes two cuts of one, some 1e-8 to either side; the mean is exact.
    """
    groups = np.split(cuts, np.flatnonzero(np.diff(cuts) > width) + 1)
    means = [math.fsum(g) / len(g) for g in groups]
    return [cuts[0], *means[1:-1], cuts[-1]]


def _per_parameter(curve: Curve) -> float:
    """Length per unit of the curve's parameter [m]."""
    return curve.radius if isinstance(curve, Arc) else 1.0
