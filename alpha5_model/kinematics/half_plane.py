"""What the arm reaches of a half-plane through the yaw axis, and its boundary as arcs.

The half-plane has R >= 0 outwards and z up. The arm that faces it reaches it from its
front (underarm). The arm that turns away reaches it from its back (overarm, the plane
of the arm mirrored).

In its plane the arm has two links. If one of its joints is at the end of its range, or
the arm is stretched or folded, the other joint moves the tcp on an arc. The boundary of
the reachable set lies on these arcs [Siciliano2009, 2.10.4; Gupta1986].

References:
    [Siciliano2009] Siciliano, Sciavicco, Villani, Oriolo: Robotics, section 2.10.4
        (workspace).
    [Gupta1986] K. C. Gupta: On the nature of robot workspace, Int. J. Robotics
        Research 5(2).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
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
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.solver import solve
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.theory import arcs

#: How a half-plane is reached: by one pose, or by either.
SIDES = ("underarm", "overarm", "both")
#: The two poses.
POSES = SIDES[:2]
#: Points of the half-plane R (M,), z (M,) -> whether each belongs to a region, (M,).
Region = Callable[[FloatArray, FloatArray], BoolArray]


class Arc(NamedTuple):
    """A circular arc in the half-plane, from ``start`` counter-clockwise to ``end``.

    Attributes:
        center: (R, z) [m].
        radius: [m].
        start, end: Angle from the R axis, ``start < end <= start + 2 pi`` [rad].
        filled: +1 if the region is on the centre's side, -1 if on the other, 0 if not
            known.
        cause: What bounds the region there, for example
            ``"theta_1 at its upper limit"``.
        side: ``"underarm"`` or ``"overarm"``, the pose that runs along it;
            ``"published"``.
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
        return self.curve.point(float_array("angle", angle, ()))

    @property
    def curve(self) -> arcs.Arc:
        """The same arc of plane geometry."""
        return arcs.Arc(self.center, self.radius, self.start, self.end - self.start)


def in_half_plane(
    radius: FloatArray,
    z: FloatArray,
    side: str = "both",
    limits: bool = True,
    *,
    arm: Alpha5Parameters | None = None,
) -> BoolArray:
    """Which points of a half-plane can be reached, theta_0 aside.

    Args:
        radius: Distance from the yaw axis, (...) [m].
        z: Height, (...) [m].
        side, limits, arm: As for `boundary`.
    """
    geometry = bounded_geometry(arm)
    choice("side", side, SIDES)
    limits = flag("limits", limits)
    radius, z = together(radius=radius, z=z)
    return contains(geometry, radius, z, side, limits)


def bounded_geometry(arm: Alpha5Parameters | None) -> Geometry:
    """The geometry of an arm whose reach arcs bound.

    Raises:
        InputError: Not a record, or a tool point beside the wrist axis.
    """
    geometry = Geometry.of(chosen_arm(arm))
    geometry.require_tool_on_axis("exact reach and workspace")
    return geometry


def contains(
    geometry: Geometry, radius: FloatArray, z: FloatArray, side: str, limits: bool
) -> BoolArray:
    """`in_half_plane` for checked numbers."""
    reached = np.zeros(radius.shape, np.bool_)
    for branch, pose in enumerate(POSES):
        if side not in (pose, "both"):
            continue
        azimuth = middle_azimuth(geometry, pose)
        x = radius * math.cos(azimuth)
        y = radius * math.sin(azimuth)
        branches = branches_reaching(geometry, np.stack([x, y, z], axis=-1), limits)
        reached |= branches[..., branch::2].any(axis=-1)  # with either elbow
    return reached


def branches_reaching(
    geometry: Geometry, target: FloatArray, limits: bool
) -> BoolArray:
    """Which branches reach targets (..., 3), with theta_3 in mid-range, (..., 4)."""
    solved = solve(geometry, target, geometry.middle[3], angles=False)
    return solved.within_limits if limits else solved.exists


def middle_azimuth(geometry: Geometry, pose: str) -> float:
    """Azimuth that a pose faces with theta_0 in the middle of its range [rad]."""
    turned = POSES.index(pose) * math.pi
    return geometry.middle[0] + geometry.azimuth_offset - turned


def azimuth_beyond(
    geometry: Geometry, azimuth: FloatArray | float, pose: str
) -> FloatArray:
    """Azimuths minus the nearest ones that a pose can face, (...) [rad]."""
    half = (geometry.upper[0] - geometry.lower[0]) / 2
    off = wrap(azimuth - middle_azimuth(geometry, pose))
    return off - np.clip(off, -half, half)


def boundary(
    side: str = "both", limits: bool = True, *, arm: Alpha5Parameters | None = None
) -> tuple[Arc, ...]:
    """Boundary arcs of the reachable part of a half-plane.

    The yaw axis, which closes the region at R = 0, is not listed: it is no boundary of
    the reachable set, which goes on beyond it.

    Args:
        side: ``"underarm"``, ``"overarm"``, or ``"both"`` for their union, which holds
            at all azimuths where the range of theta_0 allows both.
        limits: Respect the limits of theta_1 and theta_2.
        arm: Record of the arm; None is the catalogue's.

    Raises:
        UnknownNameError: Another side.
        InputError: Limits that are neither True nor False, or a tool point beside the
            wrist axis.
    """
    geometry = bounded_geometry(arm)
    return boundary_of(geometry, choice("side", side, SIDES), flag("limits", limits))


@lru_cache(maxsize=256)
def boundary_of(geometry: Geometry, side: str, limits: bool) -> tuple[Arc, ...]:
    """`boundary` for checked arguments."""
    critical = []
    for pose in POSES if side == "both" else (side,):
        critical += critical_arcs(geometry, pose, limits)
    return trace(
        geometry,
        critical,
        lambda radius, z: contains(geometry, radius, z, side, limits),
    )


def critical_arcs(geometry: Geometry, pose: str, limits: bool = True) -> list[Arc]:
    """The arcs of a pose that the boundary can lie on."""
    l_1 = geometry.l_1
    l_2 = geometry.l_2
    shoulder = complex(geometry.a_0, geometry.d_0)

    def turned_at_shoulder(cause: str, phi: tuple[float, float], bend: float) -> Arc:
        """The first link turns, the second one is bent from it by a fixed angle."""
        tip = l_1 + l_2 * cmath.exp(1j * bend)
        start, end = (angle + cmath.phase(tip) for angle in phi)
        return _arc(cause, pose, shoulder, abs(tip), start, end)

    def turned_at_elbow(cause: str, phi: float, bend: tuple[float, float]) -> Arc:
        """The first link stands still, the second one turns."""
        elbow = shoulder + l_1 * cmath.exp(1j * phi)
        start, end = (phi + angle for angle in bend)
        return _arc(cause, pose, elbow, l_2, start, end)

    if not limits:
        turn = (-math.pi, math.pi)
        return [
            turned_at_shoulder("stretched", turn, 0.0),
            turned_at_shoulder("folded", turn, math.pi),
        ]

    lower = geometry.lower[1] + geometry.phi_offset
    upper = geometry.upper[1] + geometry.phi_offset
    # The second link bends from the first by pi - gamma: less for a greater theta_2.
    most = math.pi - (geometry.lower[2] + geometry.gamma_offset)
    least = math.pi - (geometry.upper[2] + geometry.gamma_offset)
    return [
        turned_at_shoulder("stretched", (lower, upper), 0.0),
        turned_at_shoulder("theta_2 at its lower limit", (lower, upper), most),
        turned_at_elbow("theta_1 at its lower limit", lower, (least, most)),
        turned_at_shoulder("theta_2 at its upper limit", (lower, upper), least),
        turned_at_elbow("theta_1 at its upper limit", upper, (least, most)),
    ]


def _arc(
    cause: str, pose: str, center: complex, radius: float, start: float, end: float
) -> Arc:
    """An arc that the tcp draws; the overarm pose draws it at -R."""
    x = center.real
    if pose == "overarm":
        x = -x
        start, end = math.pi - end, math.pi - start
    return Arc(
        center=(x, center.imag),
        radius=radius,
        start=start,
        end=end,
        filled=0,
        cause=cause,
        side=pose,
    )


def trace(
    geometry: Geometry, critical: Sequence[Arc], region: Region
) -> tuple[Arc, ...]:
    """The boundary of a region of the half-plane that is known to lie on some arcs.

    Args:
        geometry: Its longest reach sets the scale of the search.
        critical: If two lie on one circle, the boundary there is attributed to the
            first.
        region: Which points belong to the region.

    Returns:
        Arcs with R > 0; the axis itself, which may close the region, is not listed.
    """
    size = 2 * geometry.longest
    axis = arcs.Segment((0.0, -size), math.pi / 2, 2 * size)
    edges, _ = arcs.outline(
        [*(arc.curve for arc in critical), axis],
        lambda points: (points[:, 0] > 0.0) & region(points[:, 0], points[:, 1]),
        size,
    )

    traced = []
    for edge in edges:
        if not isinstance(edge.curve, arcs.Arc):
            continue
        arc = _on_same_circle(critical, edge.curve)
        start, end = edge.curve.interval
        turn = math.tau * round((start + end) / (2 * math.tau))
        filled = 1 if edge.inside_left else -1
        traced.append(arc._replace(start=start - turn, end=end - turn, filled=filled))
    return tuple(traced)


def _on_same_circle(critical: Sequence[Arc], found: arcs.Arc) -> Arc:
    """The arc with the centre and radius of another."""
    circle = (*found.center, found.radius)
    return min(critical, key=lambda arc: math.dist((*arc.center, arc.radius), circle))


def area(bounding: Iterable[Arc]) -> float:
    """Area of the region between arcs and the axis R = 0, by Green's theorem [m^2]."""
    return sum(arc.filled * arc.curve.area_integral() for arc in bounding)


def first_moment(bounding: Iterable[Arc]) -> float:
    """Integral of R over the region, ``oint R^2 / 2 dz`` [m^3].

    Times 2 pi it is the volume of the solid of revolution (Pappus).
    """
    # On an arc R = c + r cos(t) and dz = r cos(t) dt. Each end gives r / 2 times the
    # antiderivative of R^2 cos(t).
    total = 0.0
    for arc in bounding:
        c = arc.center[0]
        r = arc.radius
        t = np.array([arc.start, arc.end])
        s = np.sin(t)
        start, end = c * c * s + c * r * (t + s * np.cos(t)) + r * r * (s - s**3 / 3)
        total += arc.filled * r / 2 * float(end - start)
    return total
