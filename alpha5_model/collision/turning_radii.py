"""How far a joint can move one body against another: proved bounds of distances.

If only joint j turns by an angle, a point of a body that j carries moves, as seen from
a body that j does not carry, by at most its distance from the axis of j times the
angle. Seen from the other body, the same holds of that one's points. So the distance of
two bodies changes by at most

    min(r, s) * angle,

where r is the largest distance of the carried body's points from the axis, and s that
of the other body's, over all positions of the joints between. Joints that move one
after the other add up: the distance is a Lipschitz function of the joint positions.

The largest distances are bounds from above: a cylinder is enclosed in a prism, and the
circle that a joint between moves a point on in a polygon. Joints between are free to
turn all the way round.
"""

from __future__ import annotations

import math

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import inverse, moved, pose
from alpha5_model.collision.bodies import Body, CollisionBodies, carriers
from alpha5_model.geometry.primitives import Primitive

#: Sides of the polygons that enclose circles, so many that they are hardly wider.
_SIDES = 72


def distance_rates(bodies: CollisionBodies, pair: tuple[int, int]) -> FloatArray:
    """How fast each joint changes the distance of two bodies at most, (B-1,) [m/rad].

    Args:
        bodies: Of an arm.
        pair: Numbers of two bodies, of which the first carries the second.

    Returns:
        For the joint of each body but the first; 0 for joints that do not move the two
        against each other.
    """
    one, other = pair
    rates = np.zeros(len(bodies.bodies) - 1)
    for joint in joints_between(bodies, pair):
        carried = carried_radius(bodies, other, joint)
        left_behind = _left_behind_radius(bodies, one, joint)
        rates[joint - 1] = min(carried, left_behind)
    return rates


def joints_between(bodies: CollisionBodies, pair: tuple[int, int]) -> list[int]:
    """Numbers of the bodies whose joints move the second against the first.

    Args:
        bodies: Of an arm.
        pair: Numbers of two bodies, of which the first carries the second.
    """
    one, other = pair
    return sorted(set(carriers(bodies, other)) - set(carriers(bodies, one)))


def carried_radius(bodies: CollisionBodies, body: int, joint: int) -> float:
    """Largest distance of a body's points from the axis of a joint that carries it [m].

    Args:
        bodies: Of an arm.
        body: Number of the body.
        joint: Number of the body whose joint it is: ``body``, or one that carries it.
    """
    points = _corners(bodies.bodies[body])
    while body != joint:
        points = _turned_all_round(points)
        points = moved(bodies.bodies[body].placement, points)
        body = bodies.bodies[body].parent
    return _largest_radius(points)


def _left_behind_radius(bodies: CollisionBodies, body: int, joint: int) -> float:
    """Largest distance of a body's points from the axis of a joint further out [m]."""
    points = _corners(bodies.bodies[body])
    between = [number for number in carriers(bodies, joint) if number > body]
    for number in reversed(between):
        points = moved(inverse(bodies.bodies[number].placement), points)
        if number != joint:
            points = _turned_all_round(points)
    return _largest_radius(points)


def _largest_radius(points: FloatArray) -> float:
    """Largest distance from the z axis [m]."""
    return float(np.hypot(points[:, 0], points[:, 1]).max())


def _corners(body: Body) -> FloatArray:
    """Points whose convex hull encloses the shapes of a body, (N, 3)."""
    corners = [corners_around(shape) for shape in body.shapes]
    return np.vstack(corners)


def corners_around(shape: Primitive) -> FloatArray:
    """Points of a body whose convex hull encloses a shape of it, (N, 3)."""
    if shape.kind == "cylinder":
        radius, length = shape.size
        circle = _polygon(radius)
        ends = [np.column_stack([circle, np.full(_SIDES, z)]) for z in (-0.5, 0.5)]
        local = np.vstack(ends) * (1.0, 1.0, length)
    else:
        signs = np.array(np.meshgrid(*[(-0.5, 0.5)] * 3)).reshape(3, -1).T
        local = signs * shape.size
    return moved(pose(shape.xyz, shape.rpy), local)


def _polygon(radius: float) -> FloatArray:
    """Corners of a regular polygon that encloses a circle, (`_SIDES`, 2)."""
    angle = math.tau * np.arange(_SIDES) / _SIDES
    wide = radius / math.cos(math.pi / _SIDES)
    return wide * np.column_stack([np.cos(angle), np.sin(angle)])


def _turned_all_round(points: FloatArray) -> FloatArray:
    """Points whose convex hull encloses others at every angle about z, (N, 3)."""
    profile = np.column_stack([points[:, 2], np.hypot(points[:, 0], points[:, 1])])
    rings = []
    for height, radius in _outline(profile):
        circle = _polygon(radius)
        rings.append(np.column_stack([circle, np.full(_SIDES, height)]))
    return np.vstack(rings)


def _outline(profile: FloatArray) -> list[tuple[float, float]]:
    """The corners of the convex hull of (height, radius) and their mirror images.

    Only those with a radius of at least 0, by the monotone chain of [Andrew1979]:
    Another efficient algorithm for convex hulls in two dimensions.
    """
    mirrored = np.vstack([profile, profile * (1.0, -1.0)])
    hull: list[tuple[float, float]] = []
    for point in sorted(map(tuple, mirrored.tolist()), key=lambda p: (p[0], -p[1])):
        while len(hull) > 1 and _turns_left(hull[-2], hull[-1], point):
            hull.pop()
        hull.append(point)
    return [point for point in hull if point[1] >= 0.0]


def _turns_left(
    one: tuple[float, float], two: tuple[float, float], three: tuple[float, float]
) -> bool:
    """Whether the way over three points turns left, or goes straight on."""
    first = (two[0] - one[0], two[1] - one[1])
    second = (three[0] - two[0], three[1] - two[1])
    return first[0] * second[1] - first[1] * second[0] >= 0.0
