"""An arrangement of curves: overlapping ones united, all cut where they meet, pieces joined again."""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import pairwise

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.kinematics.planar.curves import (
    TURN,
    Arc,
    Curve,
    Segment,
    circle_hits,
    line_hits,
)

#: Whether the workspace lies to the left and to the right of a piece.
Sides = tuple[bool, bool]


def united(curves: list[Curve], tolerance: float) -> list[Curve]:
    """The same point set with every circle and every line covered once."""
    groups: dict[tuple[object, ...], list[Curve]] = defaultdict(list)
    for curve in curves:
        key = next((k for k in groups if _same_carrier(groups[k][0], curve, tolerance)), None)
        groups[key or (len(groups),)].append(curve)
    out: list[Curve] = []
    for members in groups.values():
        first = members[0]
        spans = sorted(_span_on(first, member) for member in members)
        slack = tolerance / (first.radius if isinstance(first, Arc) else 1.0)
        merged = [list(spans[0])]
        for low, high in spans[1:]:
            if low <= merged[-1][1] + slack:
                merged[-1][1] = max(merged[-1][1], high)
            else:
                merged.append([low, high])
        if isinstance(first, Arc):
            if len(merged) > 1 and merged[-1][1] >= merged[0][0] + TURN - slack:
                merged[-1][1] = max(merged[-1][1], merged[0][1] + TURN)
                del merged[0]
            for low, high in merged:
                span = TURN if high - low >= TURN - slack else high - low
                out.append(Arc(first.center, first.radius, low, span))
        else:
            out += [first.piece(low, high) for low, high in merged]
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


def cut(curves: list[Curve], tolerance: float, step: float) -> tuple[list[Curve], list[int]]:
    """Cut curves where they meet.

    Args:
        curves: No two of them share a stretch (`united`).
        tolerance: Distance up to which curves count as touching [m].
        step: Pieces shorter than this are left out [m].

    Returns:
        The pieces, curve by curve and in order, and for each the number of its curve.
    """
    pieces: list[Curve] = []
    origin: list[int] = []
    for number, (curve, cuts) in enumerate(
        zip(curves, _cuts(curves, tolerance, step), strict=True)
    ):
        for low, high in pairwise(cuts):
            if (high - low) * _per_parameter(curve) > step:
                pieces.append(curve.piece(low, high))
                origin.append(number)
    return pieces, origin


def _cuts(curves: list[Curve], tolerance: float, step: float) -> list[list[float]]:
    """Parameters at which each curve begins, meets another, and ends."""
    cuts: list[list[float]] = [list(c.interval) for c in curves]
    arcs = [(i, c) for i, c in enumerate(curves) if isinstance(c, Arc)]
    lines = [(i, c) for i, c in enumerate(curves) if isinstance(c, Segment)]
    centers = np.array([c.center for _, c in arcs])
    radii = np.array([c.radius for _, c in arcs])
    starts = np.array([c.start for _, c in lines])
    along = np.array([(math.cos(c.angle), math.sin(c.angle)) for _, c in lines])
    for j, other in enumerate(curves):
        hits: list[tuple[int, Curve, FloatArray]] = []
        if arcs:
            found = circle_hits(centers, radii, other, tolerance)
            hits += [(i, c, p) for (i, c), p in zip(arcs, found, strict=True)]
        if lines:
            found = line_hits(starts, along, other, tolerance)
            hits += [(i, c, p) for (i, c), p in zip(lines, found, strict=True)]
        for i, curve, points in hits:
            if i != j:
                t = curve.parameter(points, tolerance)
                cuts[i] += t[~np.isnan(t)].tolist()
    return [_merged(sorted(c), step / _per_parameter(k)) for c, k in zip(cuts, curves, strict=True)]


def _merged(cuts: list[float], width: float) -> list[float]:
    """Cuts closer together than `width` become one, at their mean; the first and last stay.

    Where curves touch, rounding makes two cuts of one, some 1e-8 to either side; the mean is exact.
    """
    groups = [[cuts[0]]]
    for t in cuts[1:]:
        if t - groups[-1][-1] <= width:
            groups[-1].append(t)
        else:
            groups.append([t])
    means = [math.fsum(g) / len(g) for g in groups]
    if len(means) == 1:
        return [cuts[0], cuts[-1]]
    return [cuts[0], *means[1:-1], cuts[-1]]


def _per_parameter(curve: Curve) -> float:
    """Length per unit of the curve's parameter [m]."""
    return curve.radius if isinstance(curve, Arc) else 1.0


def joined(
    pieces: list[Curve],
    origin: list[int],
    kinds: list[Sides],
    critical: list[Curve],
) -> list[tuple[Curve, Sides]]:
    """Neighbouring pieces of one curve and one kind, put together again."""
    out: list[tuple[Curve, Sides]] = []
    last: int | None = None
    first_of: dict[int, int] = {}
    for piece, number, kind in zip(pieces, origin, kinds, strict=True):
        if number == last and out[-1][1] == kind:
            out[-1] = (
                (critical[number].piece(out[-1][0].interval[0], piece.interval[1]), kind)
                if (isinstance(piece, Arc))
                else (_longer(out[-1][0], piece), kind)
            )
        else:
            first_of.setdefault(number, len(out))
            out.append((piece, kind))
        last = number
        source = critical[number]
        begin = first_of[number]
        closes = source.closed and piece.interval[1] >= source.interval[1] - 1e-12
        if closes and begin < len(out) - 1 and out[begin][1] == kind:
            end, start = out[-1][0].interval[0], out[begin][0].interval[1]
            out[begin] = (source.piece(end, start + TURN), kind)
            out.pop()
    return out


def _longer(a: Curve, b: Curve) -> Curve:
    assert isinstance(a, Segment)
    assert isinstance(b, Segment)
    return Segment(a.start, a.angle, math.dist(a.start, b.point(b.length).tolist()))
