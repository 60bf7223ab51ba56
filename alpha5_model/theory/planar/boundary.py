"""The boundary of a set of the plane, from the curves that it lies on.

Curves that overlap are united, then cut where they meet. A piece belongs to the
boundary if the set lies on one side of it only.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.theory.planar.curves import (
    TURN,
    Arc,
    Curve,
    Edge,
    Segment,
    unit_vector,
)
from alpha5_model.theory.planar.intersections import circle_hits, line_hits

#: Whether points (N, 2) belong to the set, (N,).
Contains = Callable[[FloatArray], BoolArray]


class _Piece(NamedTuple):
    """Part of a curve between two of its cuts.

    Attributes:
        number: Of the curve.
        start, end: Parameters of its ends.
    """

    number: int
    start: float
    end: float


class _Run(NamedTuple):
    """Neighbouring pieces of a curve with the set on the same sides.

    Attributes:
        start, end: Parameters of its ends.
        left, right: Whether the set lies on that side.
    """

    start: float
    end: float
    left: bool
    right: bool

    @property
    def sides(self) -> tuple[bool, bool]:
        return self.left, self.right


def bounds(
    curves: list[Curve], contains: Contains, tolerance: float, step: float
) -> tuple[tuple[Edge, ...], tuple[Curve, ...]]:
    """The boundary of a set that lies on known curves.

    Args:
        curves: They may overlap.
        contains: Whether points (N, 2) belong to the set, (N,).
        tolerance: Distance up to which curves count as touching [m].
        step: Distance to either side of a curve at which `contains` is evaluated;
            shorter pieces are left out [m].

    Returns:
        The edges, and the pieces that have the set on neither side.
    """
    curves = _united(curves, tolerance)
    pieces = _pieces(curves, tolerance, step)
    left, right = _sides(curves, pieces, contains, step)

    edges: list[Edge] = []
    thin: list[Curve] = []
    for curve, runs in zip(curves, _runs(curves, pieces, left, right), strict=True):
        for run in runs:
            piece = curve.piece(run.start, run.end)
            if run.left != run.right:
                edges.append(Edge(curve=piece, inside_left=run.left))
            elif not run.left:
                thin.append(piece)
    return tuple(edges), tuple(thin)


def _pieces(curves: list[Curve], tolerance: float, step: float) -> list[_Piece]:
    """The pieces between the cuts of each curve, if longer than a step."""
    pieces = []
    for number, cuts in enumerate(_cuts(curves, tolerance, step)):
        unit = _per_parameter(curves[number])
        for start, end in pairwise(cuts):
            if (end - start) * unit > step:
                pieces.append(_Piece(number=number, start=start, end=end))
    return pieces


def _sides(
    curves: list[Curve], pieces: list[_Piece], contains: Contains, step: float
) -> tuple[list[bool], list[bool]]:
    """Whether the set lies to the left and to the right of the middle of each piece."""
    middles = [
        (curves[piece.number], (piece.start + piece.end) / 2) for piece in pieces
    ]
    at = np.array([curve.point(t) for curve, t in middles])
    normal = np.array([curve.left(t) for curve, t in middles])
    left = contains(at + step * normal)
    right = contains(at - step * normal)
    return left.tolist(), right.tolist()


def _runs(
    curves: list[Curve], pieces: list[_Piece], left: list[bool], right: list[bool]
) -> list[list[_Run]]:
    """The runs of each curve: neighbouring pieces with the same sides are one."""
    runs: list[list[_Run]] = [[] for _ in curves]
    for piece, *sides in zip(pieces, left, right, strict=True):
        run = runs[piece.number]
        start = piece.start
        if run and [*run[-1].sides] == sides:
            start = run.pop().start
        run.append(_Run(start, piece.end, *sides))

    for curve, run in zip(curves, runs, strict=True):
        # On a closed curve the last piece is the first one's neighbour.
        if curve.closed and len(run) > 1 and run[0].sides == run[-1].sides:
            last = run.pop()
            run[0] = run[0]._replace(start=last.start, end=run[0].end + TURN)
    return runs


# United curves
# --------------------------------------------------------------------------


def _united(curves: list[Curve], tolerance: float) -> list[Curve]:
    """The same set of points without any overlap."""
    united: list[Curve] = []
    for members in _grouped(curves, tolerance):
        first = members[0]
        slack = tolerance / _per_parameter(first)
        spans = sorted(_span_on(first, member) for member in members)
        for low, high in _merged(spans, slack, isinstance(first, Arc)):
            piece = first.piece(low, high)
            if isinstance(piece, Arc) and piece.span >= TURN - slack:
                piece = replace(piece, span=TURN)
            united.append(piece)
    return united


def _grouped(curves: list[Curve], tolerance: float) -> list[list[Curve]]:
    """Curves on the same circle or line together, in the order of the first ones."""
    groups: list[list[Curve]] = []
    for curve in curves:
        for group in groups:
            if _same_carrier(group[0], curve, tolerance):
                group.append(curve)
                break
        else:
            groups.append([curve])
    return groups


def _merged(
    spans: list[tuple[float, float]], slack: float, circular: bool
) -> list[list[float]]:
    """The union of ascending ranges of a parameter, as ranges that do not overlap."""
    merged: list[list[float]] = []
    for low, high in spans:
        if merged and low <= merged[-1][1] + slack:
            merged[-1][1] = max(merged[-1][1], high)
        else:
            merged.append([low, high])

    # On a circle the last range may reach the first ones, a turn later.
    while circular and len(merged) > 1 and merged[-1][1] >= merged[0][0] + TURN - slack:
        merged[-1][1] = max(merged[-1][1], merged[0][1] + TURN)
        del merged[0]
    return merged


def _same_carrier(a: Curve, b: Curve, tolerance: float) -> bool:
    """Whether two curves lie on one circle or one line."""
    if isinstance(a, Arc) and isinstance(b, Arc):
        same_center = math.dist(a.center, b.center) <= tolerance
        return same_center and abs(a.radius - b.radius) <= tolerance
    if isinstance(a, Segment) and isinstance(b, Segment):
        ends = b.point(np.array(b.interval)) - np.asarray(a.start)
        return bool((np.abs(ends @ a.left(0.0)) <= tolerance).all())
    return False


def _span_on(first: Curve, member: Curve) -> tuple[float, float]:
    """Range of a curve in the parameter of another one on the same circle or line."""
    if isinstance(first, Arc) and isinstance(member, Arc):
        start = member.start % TURN
        return start, start + member.span
    assert isinstance(first, Segment)
    ends = member.point(np.array(member.interval)) - np.asarray(first.start)
    low, high = sorted((ends @ unit_vector(first.angle)).tolist())
    return low, high


# Cuts
# -----------------------------------------------------------------------------------


def _cuts(curves: list[Curve], tolerance: float, step: float) -> list[list[float]]:
    """Ascending parameters at which each curve begins, meets another, and ends."""
    cuts = [list(curve.interval) for curve in curves]
    arcs = {i: c for i, c in enumerate(curves) if isinstance(c, Arc)}
    lines = {i: c for i, c in enumerate(curves) if isinstance(c, Segment)}
    centers = np.array([c.center for c in arcs.values()]).reshape(-1, 2)
    radii = np.array([c.radius for c in arcs.values()])
    starts = np.array([c.start for c in lines.values()]).reshape(-1, 2)
    headings = [unit_vector(c.angle) for c in lines.values()]
    directions = np.array(headings).reshape(-1, 2)

    for j, other in enumerate(curves):
        on_arcs = circle_hits(centers, radii, other, tolerance)
        on_lines = line_hits(starts, directions, other, tolerance)
        meeting = [*zip(arcs, on_arcs, strict=True), *zip(lines, on_lines, strict=True)]
        for i, points in meeting:
            if i != j:
                t = curves[i].parameter(points, tolerance)
                cuts[i] += t[~np.isnan(t)].tolist()
    return [
        _distinct(curve, sorted(parameters), step)
        for curve, parameters in zip(curves, cuts, strict=True)
    ]


def _distinct(curve: Curve, parameters: list[float], step: float) -> list[float]:
    """Ascending parameters, those closer together than a step replaced by their mean.

    If curves touch, rounding splits one cut into two, some 1e-8 to either side: their
    mean is exact.
    """
    apart = np.flatnonzero(np.diff(parameters) * _per_parameter(curve) > step) + 1
    means = [math.fsum(group) / len(group) for group in np.split(parameters, apart)]
    return [parameters[0], *means[1:-1], parameters[-1]]


def _per_parameter(curve: Curve) -> float:
    """Length per unit of the curve's parameter [m]."""
    return curve.radius if isinstance(curve, Arc) else 1.0
