"""Where circles and straight lines meet a curve of the plane."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.theory.planar.curves import Arc, Curve, unit_vector

#: Sine of the angle between two lines that count as parallel.
_PARALLEL = 1e-12


def circle_hits(
    centers: FloatArray, radii: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Points in which circles meet a curve; touching counts.

    Args:
        centers: (M, 2), or (1, 2) for all [m].
        radii: (M,) [m].
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points (M, K, 2) [m], K up to 4; NaN for those that do not exist. For a circle
        that runs along the curve, they are the ends of the curve.
    """
    if isinstance(curve, Arc):
        center = np.array(curve.center)
        crossings = _circle_circle(centers, radii, center, curve.radius, tolerance)
    else:
        start = np.array(curve.start)
        along = unit_vector(curve.angle)
        crossings = _line_circle(start, along, centers, radii, tolerance)

    ends = curve.point(np.array(curve.interval))
    from_centers = np.linalg.norm(ends - centers[:, None], axis=-1)
    return _on_curve(crossings, from_centers - radii[:, None], curve, tolerance)


def line_hits(
    starts: FloatArray, directions: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """Points in which straight lines meet a curve; touching counts.

    Args:
        starts: A point of each line, (M, 2) [m].
        directions: Unit vectors, (M, 2), or (1, 2) for all.
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        Points as of `circle_hits`.
    """
    if isinstance(curve, Arc):
        center = np.array(curve.center)
        radius = np.array(curve.radius)
        crossings = _line_circle(starts, directions, center, radius, tolerance)
    else:
        start = np.array(curve.start)
        along = unit_vector(curve.angle)
        crossings = _line_line(starts, directions, start, along)

    ends = curve.point(np.array(curve.interval))
    from_lines = _cross(directions[:, None], ends - starts[:, None])
    return _on_curve(crossings, from_lines, curve, tolerance)


def _on_curve(
    crossings: FloatArray, end_distances: FloatArray, curve: Curve, tolerance: float
) -> FloatArray:
    """The crossings that lie on a curve, and its ends if they are touched.

    Args:
        crossings: With the whole circle or line that carries the curve, (M, K, 2) [m].
        end_distances: Of both ends from each circle or line, (M, 2) [m].
        curve: The curve.
        tolerance: Distance up to which they count as touching [m].

    Returns:
        (M, K, 2) or (M, K + 2, 2) [m]; NaN for points beyond the ends.
    """
    touches = np.abs(end_distances) <= tolerance
    if touches.any():
        ends = curve.point(np.array(curve.interval))
        touched = np.where(touches[..., None], ends, np.nan)
        crossings = np.concatenate([crossings, touched], axis=1)
    if curve.closed:
        return crossings

    beyond = np.isnan(curve.parameter(crossings, tolerance))
    return np.where(beyond[..., None], np.nan, crossings)


def _circle_circle(
    c1: FloatArray, r1: FloatArray, c2: FloatArray, r2: float, tolerance: float
) -> FloatArray:
    """Intersections of circles (c1, r1) with one circle (c2, r2).

    Returns:
        (M, 2, 2) [m]; NaN if there are none.
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

    # Two circles that are points meet if they are the same point.
    same = (distance <= tolerance) & (r1 <= tolerance) & (r2 <= tolerance)
    return np.where(same[:, None, None], c1[:, None], crossings)


def _line_circle(
    starts: FloatArray,
    along: FloatArray,
    centers: FloatArray,
    radii: FloatArray,
    tolerance: float,
) -> FloatArray:
    """Intersections of lines with circles, (M, 2, 2) [m]; NaN if there are none.

    There may be one line for all circles, or one circle for all lines.
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
    """Intersections of lines (p1, e1) with one line (p2, e2).

    Returns:
        (M, 1, 2) [m]; NaN for parallel lines.
    """
    sine = _cross(e1, e2)
    sine = np.where(np.abs(sine) <= _PARALLEL, np.nan, sine)
    t = _cross(p2 - p1, e2) / sine
    return np.asarray((p1 + t[:, None] * e1)[:, None])


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Cross product of vectors of the plane, a number."""
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
