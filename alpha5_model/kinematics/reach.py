"""What the tcp can reach, exactly: its boundary as arcs, and how far off a point is.

A half-plane through the yaw axis, R >= 0 outwards and z up, is reached from its front by the arm
that faces it (underarm) and from its back by the arm that turns away (overarm, the plane of the arm
mirrored). In the plane the arm is a planar arm of two links. Where one of its joints is at the end
of its range, or the arm is stretched or folded, the other joint moves the tcp on an arc, and the
boundary of the reachable set lies on these arcs [Siciliano2009, 2.10.4; Gupta1986].

Within the limits the reachable set is no full solid of revolution: theta_0 turns 350.97 degrees, so
a wedge of azimuths is closed to the underarm pose and the opposite wedge to the overarm pose. The
set is the union of the two poses, each turned through the azimuths that it can face. A point in the
closed wedge of one pose may still be reached by the other, and the nearest point of a pose to a
target in its wedge lies in the wedge's face.

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.10.4 (workspace).
    [Gupta1986] K. C. Gupta: On the nature of robot workspace, Int. J. Robotics Research 5(2).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    choice,
    flag,
    float_array,
    together,
)
from alpha5_model._support.spatial import wrap
from alpha5_model.errors import InputError
from alpha5_model.kinematics.plane import BLOCK, arm_plane, on_axis, solve_batch
from alpha5_model.theory import planar
from alpha5_model.theory.planar.arm import RELATIVE_STEP, RELATIVE_TOLERANCE
from alpha5_model.theory.planar.boundary import bounds

#: How a half-plane is reached: by one pose, or by either.
SIDES = ("underarm", "overarm", "both")
#: Joint positions (M, 4) -> whether each is accepted, (M,).
Accept = Callable[[FloatArray], BoolArray]
#: Points of the half-plane R (M,), z (M,) -> whether each belongs to a region, (M,).
Region = Callable[[FloatArray, FloatArray], BoolArray]
#: Values of theta_0 that are tried on the yaw axis, where it is free.
_YAWS = 36
#: From here on only the direction of a point matters [m].
_FAR = 1e100


class Arc(NamedTuple):
    """A circular arc in the half-plane, from ``start`` counter-clockwise to ``end``.

    Attributes:
        center: (R, z) [m].
        radius: [m].
        start, end: Angle from the R axis, ``start < end <= start + 2 pi`` [rad].
        filled: +1 if the region is on the centre's side, -1 if on the other, 0 where not known.
        cause: What bounds the region there, for example ``"theta_1 at its upper limit"``.
        side: ``"underarm"`` or ``"overarm"``, the pose that runs along it; ``"published"``.
    """

    center: tuple[float, float]
    radius: float
    start: float
    end: float
    filled: int
    cause: str
    side: str

    def points(self, angle: ArrayLike) -> FloatArray:
        """(R, z) at angles, (..., 2) [m]."""
        return planar_arc(self).point(float_array("angle", angle, ()))


def boundary(side: str = "both", limits: bool = True) -> tuple[Arc, ...]:
    """Boundary arcs of the reachable part of a half-plane.

    The yaw axis, which closes the region at R = 0, is not listed: it is no boundary of the
    reachable set, which goes on beyond it.

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union, which holds at all
            azimuths where the range of theta_0 allows both.
        limits: Respect the limits of theta_1 and theta_2.

    Raises:
        UnknownNameError: Another side.
        InputError: Limits that are neither True nor False.
    """
    return _boundary(choice("side", side, SIDES), flag("limits", limits))


@cache
def _boundary(side: str, limits: bool) -> tuple[Arc, ...]:
    sides = SIDES[:2] if side == "both" else (side,)
    arcs = [arc for name in sides for arc in critical_arcs(name, limits)]
    return trace(arcs, lambda radius, z: in_half_plane(radius, z, side, limits))


def in_half_plane(
    radius: FloatArray, z: FloatArray, side: str = "both", limits: bool = True
) -> BoolArray:
    """Which points of a half-plane can be reached, theta_0 aside.

    Args:
        radius: Distance from the yaw axis, (...) [m].
        z: Height, (...) [m].
        side, limits: As for `boundary`.
    """
    choice("side", side, SIDES)
    limits = flag("limits", limits)
    radius, z = together(radius=radius, z=z)
    out = np.zeros(radius.shape, np.bool_)
    for pair, name in enumerate(SIDES[:2]):
        if side in (name, "both"):
            azimuth = _middle_azimuth(name)
            target = np.stack(
                [radius * math.cos(azimuth), radius * math.sin(azimuth), z], axis=-1
            )
            out |= _solved(target, limits)[1][..., pair::2].any(axis=-1)
    return out


def critical_arcs(side: str, limits: bool = True) -> list[Arc]:
    """Arcs that the boundary can lie on: where the tcp goes with one of the two joints held."""
    g = arm_plane()
    turn = -math.pi, math.pi
    held = [("stretched", turn, (0.0, 0.0)), ("folded", turn, (math.pi, math.pi))]
    if limits:
        phi = g.lower[1] + g.phi_offset, g.upper[1] + g.phi_offset
        bend = (
            math.pi - (g.upper[2] + g.gamma_offset),
            math.pi - (g.lower[2] + g.gamma_offset),
        )
        held = [("stretched", phi, (0.0, 0.0))]
        for name, first, still in zip(("lower", "upper"), phi, bend[::-1], strict=True):
            held.append((f"theta_2 at its {name} limit", phi, (still, still)))
            held.append((f"theta_1 at its {name} limit", (first, first), bend))
    out = []
    for cause, *ranges in held:
        (curve,) = planar.PlanarArm((g.l_1, g.l_2), ranges).workspace().thin
        assert isinstance(curve, planar.Arc)
        (x, z), (start, end) = curve.center, curve.interval
        x += g.a_0
        if side == "overarm":  # the same at -R
            x, start, end = -x, math.pi - end, math.pi - start
        out.append(Arc((x, z + g.d_0), curve.radius, start, end, 0, cause, side))
    return out


def trace(arcs: Sequence[Arc], contains: Region) -> tuple[Arc, ...]:
    """The boundary of a region of the half-plane that is known to lie on some arcs.

    Args:
        arcs: Where two are of one circle, the boundary is said to lie on the first.
        contains: Which points belong to the region.

    Returns:
        Arcs with R > 0; the axis itself, which may close the region, is not listed.
    """
    size = 2 * arm_plane().longest
    tolerance, step = RELATIVE_TOLERANCE * size, RELATIVE_STEP * size
    curves: list[planar.Curve] = [*map(planar_arc, arcs)]
    curves.append(planar.Segment((0.0, -size), math.pi / 2, 2 * size))
    edges, _ = bounds(
        curves, lambda p: (p[:, 0] > 0.0) & contains(*p.T), tolerance, step
    )
    out = []
    for edge in edges:
        if isinstance(curve := edge.curve, planar.Arc):
            ring, near = (*curve.center, curve.radius), 2 * tolerance
            arc = next(
                a for a in arcs if math.dist((*a.center, a.radius), ring) <= near
            )
            start, end = curve.interval
            turn = math.tau * round((start + end) / (2 * math.tau))
            filled = 1 if edge.inside_left else -1
            out.append(arc._replace(start=start - turn, end=end - turn, filled=filled))
    return tuple(out)


def planar_arc(arc: Arc) -> planar.Arc:
    """The same arc of plane geometry."""
    return planar.Arc(arc.center, arc.radius, arc.start, arc.end - arc.start)


def reachable(
    positions: ArrayLike, limits: bool = True, accept: Accept | None = None
) -> BoolArray:
    """Whether the tcp reaches a point: any branch of the inverse kinematics does.

    The wrist angle moves no point and plays no part.

    Args:
        positions: In ``base_link``, (..., 3) [m].
        limits: Respect the limits of theta_0, theta_1 and theta_2; without, all angles are free.
        accept: Counts a branch only if this returns True for its joint position: a function of
            (M, 4) [rad], (M,) bool, such as `alpha5_model.without_self_collision`. theta_3 is the
            middle of its range, and on the yaw axis theta_0 is tried every 10 degrees.

    Returns:
        (...) bool; the boundary belongs to the set.

    Raises:
        InputError: Not real numbers of that shape (`NonFiniteError` names a bad row), or limits
            that are neither True nor False.
    """
    target, limits = float_array("positions", positions, (3,)), flag("limits", limits)
    if accept is not None and not callable(accept):
        raise InputError("accept", accept, "a function of joint positions")
    if accept is None:
        four = _solved(target, limits)[1].view(np.uint32)  # truth values as one number
        return np.asarray(four[..., 0] != 0)
    blocks = np.split(target.reshape(-1, 3), range(BLOCK, target.size // 3, BLOCK))
    out = np.concatenate([_accepted(rows, limits, accept) for rows in blocks])
    return out.reshape(target.shape[:-1])


def _accepted(rows: FloatArray, limits: bool, accept: Accept) -> BoolArray:
    """Which points (N, 3) a branch reaches in an accepted joint position."""
    g, (q, flags) = arm_plane(), _solved(rows, limits, angles=True)
    yaws = np.linspace(g.lower[0], g.upper[0], _YAWS)
    free = on_axis(rows)
    found = np.zeros(len(rows), np.bool_)
    for branch, yaw in product(range(q.shape[1]), (None, *yaws)):
        left = np.flatnonzero(flags[:, branch] & ~found & (free | (yaw is None)))
        trial = q[left, branch]
        if yaw is not None:
            trial[:, 0] = yaw
        if len(left):
            answer = np.asarray(accept(trial))
            if answer.shape != (len(left),) or answer.dtype != np.bool_:
                raise InputError("accept", answer, f"{len(left)} times True or False")
            found[left] = answer
    return found


def _solved(
    target: FloatArray, limits: bool, angles: bool = False
) -> tuple[FloatArray, BoolArray]:
    """q (..., 4, 4) if asked for, theta_3 in mid-range, and which branches reach, (..., 4)."""
    q, exists, within, _ = solve_batch(
        target, np.asarray(arm_plane().middle[3]), angles
    )
    return q, within if limits else exists


def distance_to_reach(positions: ArrayLike, limits: bool = True) -> FloatArray:
    """Distance to the nearest reachable point, exactly 0 inside.

    Args:
        positions, limits: As for `reachable`.

    Returns:
        (...) [m].
    """
    target, nearest = _nearest(positions, limits)
    x, y, z = np.moveaxis(target - nearest, -1, 0)
    with np.errstate(over="ignore"):
        distance = np.asarray(np.hypot(np.hypot(x, y), z))
    if not np.isfinite(distance).all():
        raise InputError(
            "positions", float(np.abs(target).max()), "a distance that is a number"
        )
    return distance


def nearest_reachable(positions: ArrayLike, limits: bool = True) -> FloatArray:
    """The nearest reachable point; a reachable one is returned as it is.

    Args:
        positions, limits: As for `reachable`.

    Returns:
        (..., 3) [m].
    """
    return _nearest(positions, limits)[1]


def _nearest(positions: ArrayLike, limits: bool) -> tuple[FloatArray, FloatArray]:
    target, limits = float_array("positions", positions, (3,)), flag("limits", limits)
    out = target.reshape(-1, 3).copy()
    outside = np.flatnonzero(~reachable(out, limits))
    for start in range(0, len(outside), BLOCK):
        part = outside[start : start + BLOCK]
        # Very far points come nearer along their ray: squares of their distances overflow.
        far = np.maximum(np.abs(out[part]).max(axis=-1, keepdims=True) / _FAR, 1.0)
        out[part] = _project(out[part] / far, limits)
    return target, out.reshape(target.shape)


def _project(points: FloatArray, limits: bool) -> FloatArray:
    """Nearest reachable point of points that are outside, (N, 3)."""
    feet, distances = [], []
    for side in SIDES[:2]:
        azimuth = np.arctan2(points[:, 1], points[:, 0])
        if limits:
            azimuth -= azimuth_beyond(azimuth, side)
        cos, sin, z = np.cos(azimuth), np.sin(azimuth), points[:, 2]
        # Coordinates in the half-plane at that azimuth, and the distance across it.
        radius = points[:, 0] * cos + points[:, 1] * sin
        beside = points[:, 1] * cos - points[:, 0] * sin
        found = [np.stack([radius, z], axis=-1)]
        for arc in boundary(side, limits):
            offset, span = found[0] - arc.center, arc.end - arc.start
            along = (np.arctan2(offset[:, 1], offset[:, 0]) - arc.start) % math.tau
            # Beyond the arc: its nearer end.
            along = np.where(
                along - span < math.tau - along, np.minimum(along, span), 0.0
            )
            found.append(arc.points(arc.start + along))
        R, up = np.moveaxis(np.array(found), -1, 0)
        distance = (R - radius) ** 2 + (up - z) ** 2 + beside**2
        distance[0, ~in_half_plane(np.maximum(radius, 0.0), z, side, limits)] = np.inf
        feet.append(np.stack([R * cos, R * sin, up], axis=-1))
        distances.append(distance)
    least = np.concatenate(distances).argmin(axis=0)
    nearest: FloatArray = np.concatenate(feet)[least, np.arange(len(points))]
    return nearest


def _middle_azimuth(side: str) -> float:
    """Azimuth that a pose faces with theta_0 in the middle of its range [rad]."""
    g = arm_plane()
    return g.middle[0] + g.azimuth_offset - SIDES.index(side) * math.pi


def azimuth_beyond(azimuth: FloatArray | float, side: str) -> FloatArray:
    """How far azimuths (...) are beyond the nearest one that a pose can face, (...) [rad]."""
    g = arm_plane()
    half = (g.upper[0] - g.lower[0]) / 2
    off = wrap(azimuth - _middle_azimuth(side))
    return off - np.clip(off, -half, half)
