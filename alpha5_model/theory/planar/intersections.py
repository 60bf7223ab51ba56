"""Where circles and straight lines meet a curve of the plane."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.theory.planar.curves import Arc, Curve, unit_vector

#: Sine of the angle between two lines that count as parallel.
_PARALLEL = 1e-12


def hits(
    at: FloatArray, size: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Points in which circles or straight lines meet a curve; touching counts.

    Args:
        at: Centres of the circles, or a point of each line, (M, 2), or (1, 2) for all
            [m].
        size: Radii of the circles (M,) [m], or unit vectors along the lines, (M, 2) or
            (1, 2).
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points (M, K, 2) [m], K up to 4; NaN for those that do not exist. For a circle
        or line that runs along the curve, the points are the ends of the curve.
    """
    meet = _with_carrier(at, size, curve, tolerance)

    ends = curve.point(np.array(curve.interval))
    on_ends = np.abs(_distance(at, size, ends)) <= tolerance
    if on_ends.any():
        touched = np.where(on_ends[..., None], ends, np.nan)
        meet = np.concatenate([meet, touched], axis=1)
    if curve.closed:
        return meet

    off = np.isnan(curve.parameter(meet, tolerance))
    return np.where(off[..., None], np.nan, meet)


def _with_carrier(
    at: FloatArray, size: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Points in which they meet the whole circle or line that carries the curve."""
    circles = size.ndim == 1
    if isinstance(curve, Arc):
        center = np.array(curve.center)
        if circles:
            return _circle_circle(at, size, center, curve.radius, tolerance)
        return _line_circle(at, size, center, np.array(curve.radius), tolerance)

    start = np.array(curve.start)
    along = unit_vector(curve.angle)
    if circles:
        return _line_circle(start, along, at, size, tolerance)
    return _line_line(at, size, start, along)


def _distance(at: FloatArray, size: FloatArray, points: FloatArray) -> FloatArray:
    """Signed distance of points (K, 2) from each circle or line, (M, K) [m]."""
    away = points - at[:, None]
    if size.ndim == 1:
        return np.asarray(np.linalg.norm(away, axis=-1) - size[:, None])
    return _cross(size[:, None], away)


def _circle_circle(
    c1: FloatArray, r1: FloatArray, c2: FloatArray, r2: float, tolerance: float
) -> FloatArray:
    """Intersections of circles (c1, r1) with one circle (c2, r2), (M, 2, 2); NaN if
    none.
    """
    between = c2 - c1
    distance = np.linalg.norm(between, axis=1)
    apart = np.maximum(distance - (r1 + r2), np.abs(r1 - r2) - distance)
    with np.errstate(invalid="ignore", divide="ignore"):
        along = np.clip((distance**2 + r1**2 - r2**2) / (2 * distance), -r1, r1)
        e = between / distance[:, None]

    height = np.sqrt(r1**2 - along**2)
    height[(apart > tolerance) | (distance <= tolerance)] = np.nan
    foot = c1 + along[:, None] * e
    side = height[:, None] * np.stack([-e[:, 1], e[:, 0]], axis=-1)
    crossings = np.stack([foot + side, foot - side], axis=1)

    # Two circles about one point, both no larger than a point, meet in that point.
    same = (distance <= tolerance) & (r1 <= tolerance) & (r2 <= tolerance)
    return np.where(same[:, None, None], c1[:, None], crossings)


def _line_circle(
    starts: FloatArray,
    along: FloatArray,
    centers: FloatArray,
    radii: FloatArray,
    tolerance: float,
) -> FloatArray:
    """Intersections of lines with circles, (M, 2, 2); NaN if none.

    Either the lines or the circles may be a single one.
    """
    to_center = centers - starts
    s = (to_center * along).sum(axis=-1)
    off = np.linalg.norm(to_center - s[:, None] * along, axis=1)
    half = np.sqrt(np.maximum(radii**2 - off**2, 0.0))
    half = np.where(off > radii + tolerance, np.nan, half)
    t = np.stack([s - half, s + half], axis=1)
    return np.asarray(starts[..., None, :] + t[..., None] * along[..., None, :])


def _line_line(
    p1: FloatArray, e1: FloatArray, p2: FloatArray, e2: FloatArray
) -> FloatArray:
    """Intersections of lines (p1, e1) with one line (p2, e2), (M, 1, 2); NaN if
    parallel.
    """
    sine = _cross(e1, e2)
    sine = np.where(np.abs(sine) <= _PARALLEL, np.nan, sine)
    t = _cross(p2 - p1, e2) / sine
    return np.asarray((p1 + t[:, None] * e1)[:, None])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
