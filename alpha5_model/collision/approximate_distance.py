"""An approximate distance of an arm from itself, smooth, for optimisers.

It is the least distance of links that can touch within the joint limits, for an arm
that moves as the catalogue's of shapes that can (`alpha5_model.collision.link_pairs`).
Others pass each other at a joint, always some millimetres apart, and would hide all
larger distances: with lengths of its own, an arm has at most about 10 mm. If the arm
touches itself, the result approximates `Arm.collision_distance`; if it is free, that
may be smaller.

The shapes of the link farther out are replaced by spheres
(`alpha5_model.collision.spheres`), and the distances of their centres from the boxes
and cylinders of the other link are formulas. A soft minimum joins these numbers x_k:

    -s log(sum_k exp(-x_k / s)),

which is below the least x_k by at most ``s log(number of x_k)``. It has no branches, so
that JAX and CasADi differentiate it. Its gradient is continuous as long as no centre is
in a shape, which is deeper than the sphere's radius.

``tests/collision/test_approximate_distance.py`` measures how far it is off.

References:
    [Ratliff2009] CHOMP: Gradient optimization techniques for efficient motion planning,
        ICRA 2009 (spheres on the links).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, reduce
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, real
from alpha5_model._support.spatial import pose
from alpha5_model.collision.bodies import CollisionBodies, collision_bodies
from alpha5_model.collision.link_pairs import disabled_pairs, meeting_shapes
from alpha5_model.collision.spheres import Spheres, spheres_for
from alpha5_model.collision.turning_radii import joints_between
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters

#: Of the soft minimum [m].
SMOOTHING = 0.001
#: By how much a distance is rounded off at an edge [m].
_ROUNDED = 1e-4
#: A turn about z is ``cos * _ACROSS + sin * _AROUND + _ALONG``.
_ACROSS = np.diag([1.0, 1.0, 0.0, 0.0])
_AROUND = np.array([[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]], float)
_ALONG = np.diag([0.0, 0.0, 1.0, 1.0])


class Operations(NamedTuple):
    """How a library computes with matrices, element by element if not said otherwise.

    Attributes:
        constant: A matrix of the library, of a NumPy one.
        cos, sin, absolute, sqrt: Of one matrix.
        maximum: Of two, or of one and a number.
        side_by_side: A matrix with the columns of a list of matrices.
        soft_minimum: Of a list of matrices and s, see above: a number.
    """

    constant: Callable[[FloatArray], Any]
    cos: Callable[[Any], Any]
    sin: Callable[[Any], Any]
    absolute: Callable[[Any], Any]
    sqrt: Callable[[Any], Any]
    maximum: Callable[[Any, Any], Any]
    side_by_side: Callable[[list[Any]], Any]
    soft_minimum: Callable[[list[Any], float], Any]


class _Turn(NamedTuple):
    """A joint: its place in q, and the pose of its frame in the one before, (4, 4)."""

    joint: int
    placement: FloatArray


class _LinkSpheres(NamedTuple):
    """Spheres of a link, as seen from another one.

    Attributes:
        turns: The joints from the other link to this one.
        centres: In this link, with ones below, (4, n).
    """

    turns: tuple[_Turn, ...]
    centres: FloatArray


class _Couples(NamedTuple):
    """K boxes or cylinders, each beside a sphere.

    Attributes:
        sphere: Number of the sphere among those of all links, (K,).
        into: From the link that the sphere is seen from into the shape's frame: the
            rows that make x, y and z, (3, 4, K).
        half: Half edges, (3, K); radius and half length of cylinders, (2, K).
        radius: Of the sphere, (K,).
    """

    sphere: list[int]
    into: FloatArray
    half: FloatArray
    radius: FloatArray


class SpheresAndShapes(NamedTuple):
    """What the approximate distance of an arm is made of.

    Attributes:
        spheres: Of the links farther out, for each two links.
        boxes, cylinders: Of the links nearer to the base; None if there are none.
    """

    spheres: tuple[_LinkSpheres, ...]
    boxes: _Couples | None
    cylinders: _Couples | None


def checked_smoothing(smoothing: float) -> float:
    """The s of the soft minimum.

    Raises:
        InputError: Not a number above 0.
    """
    return real("smoothing", smoothing, minimum=0.0, strict=True)


def approximate_distance(
    parts: SpheresAndShapes, angles: list[Any], smoothing: float, ops: Operations
) -> Any:
    """The approximate distance [m].

    Args:
        parts: Of the arm.
        angles: theta_0 to theta_3 [rad], each a number of the library.
        smoothing: s of the soft minimum [m].
        ops: Of the library.
    """
    placed = [
        _pose(link.turns, angles, ops) @ ops.constant(link.centres)
        for link in parts.spheres
    ]
    centres = ops.side_by_side(placed)
    found = []
    if parts.boxes is not None:
        found.append(_from_boxes(parts.boxes, centres, ops))
    if parts.cylinders is not None:
        found.append(_from_cylinders(parts.cylinders, centres, ops))
    return ops.soft_minimum(found, smoothing)


def _pose(turns: tuple[_Turn, ...], angles: list[Any], ops: Operations) -> Any:
    """Pose of the second link in the first, (4, 4)."""
    placed = ops.constant(np.eye(4))
    for turn in turns:
        angle = angles[turn.joint]
        across = ops.cos(angle) * ops.constant(_ACROSS)
        around = ops.sin(angle) * ops.constant(_AROUND)
        turned = across + around + ops.constant(_ALONG)
        placed = placed @ ops.constant(turn.placement) @ turned
    return placed


def _from_boxes(boxes: _Couples, centres: Any, ops: Operations) -> Any:
    """Signed distances of the spheres from the boxes, (1, K)."""
    seen = _in_shapes(boxes, centres, ops)
    beyond = [
        ops.absolute(along) - ops.constant(half[None])
        for along, half in zip(seen, boxes.half, strict=True)
    ]
    return _from_faces(beyond, ops) - ops.constant(boxes.radius[None])


def _from_cylinders(cylinders: _Couples, centres: Any, ops: Operations) -> Any:
    """Signed distances of the spheres from the cylinders, (1, K)."""
    x, y, z = _in_shapes(cylinders, centres, ops)
    radius, half_length = (ops.constant(half[None]) for half in cylinders.half)
    across = ops.sqrt(x * x + y * y + _ROUNDED**2) - radius
    beyond = [across, ops.absolute(z) - half_length]
    return _from_faces(beyond, ops) - ops.constant(cylinders.radius[None])


def _in_shapes(couples: _Couples, centres: Any, ops: Operations) -> list[Any]:
    """x, y and z of the spheres' centres in the frames of the shapes, (1, K) each."""
    chosen = centres[:, couples.sphere]
    x, y, z = (chosen[row, :] for row in range(3))
    seen = []
    for of_x, of_y, of_z, offset in couples.into[:, :, None]:
        turned = ops.constant(of_x) * x + ops.constant(of_y) * y
        seen.append(turned + ops.constant(of_z) * z + ops.constant(offset))
    return seen


def _from_faces(beyond: list[Any], ops: Operations) -> Any:
    """Signed distances, from how far points are beyond perpendicular faces."""
    squares = _ROUNDED**2
    for one in beyond:
        outside = ops.maximum(one, 0.0)
        squares = squares + outside * outside
    most = reduce(ops.maximum, beyond)
    inside = -ops.maximum(-most, 0.0)
    return ops.sqrt(squares) - _ROUNDED + inside


@lru_cache(maxsize=16)
def spheres_and_shapes(arm: Alpha5Parameters) -> SpheresAndShapes:
    """What the distance of an arm with closed jaws is made of.

    Args:
        arm: Record of the arm.
    """
    bodies = collision_bodies(arm)
    links = []
    couples: dict[str, list[_Couples]] = {"box": [], "cylinder": []}
    count = 0
    apart = {frozenset(pair) for pair in disabled_pairs(arm, "locked").get("Never", ())}
    for pair in bodies.pairs:
        first, second = (bodies.bodies[number] for number in pair)
        if {first.name, second.name} in apart:
            continue
        meeting = meeting_shapes(arm, (first.name, second.name))
        shapes = tuple(second.shapes[i] for i in meeting) or second.shapes
        spheres = spheres_for(shapes)
        for shape in first.shapes:
            couples[shape.kind].append(_couples(shape, spheres, count))
        count += len(spheres.radii)
        links.append(_link_spheres(bodies, pair, spheres.centres))
    return SpheresAndShapes(
        spheres=tuple(links),
        boxes=_joined(couples["box"]),
        cylinders=_joined(couples["cylinder"]),
    )


def _link_spheres(
    bodies: CollisionBodies, pair: tuple[int, int], centres: FloatArray
) -> _LinkSpheres:
    turns = [
        _Turn(joint=number - 1, placement=bodies.bodies[number].placement)
        for number in joints_between(bodies, pair)
    ]
    ones = np.ones(len(centres))
    return _LinkSpheres(turns=tuple(turns), centres=np.vstack([centres.T, ones]))


def _couples(shape: Primitive, spheres: Spheres, first: int) -> _Couples:
    """A shape beside each of some spheres, whose numbers begin with the first."""
    count = len(spheres.radii)
    into = np.linalg.inv(pose(shape.xyz, shape.rpy))[:3]
    half = np.array(shape.size) / 2
    if shape.kind == "cylinder":
        half[0] = shape.size[0]
    return _Couples(
        sphere=[*range(first, first + count)],
        into=np.repeat(into[:, :, None], count, axis=2),
        half=np.repeat(half[:, None], count, axis=1),
        radius=spheres.radii,
    )


def _joined(couples: list[_Couples]) -> _Couples | None:
    """All of them as one; None if there are none."""
    if not couples:
        return None
    return _Couples(
        sphere=[number for part in couples for number in part.sphere],
        into=np.concatenate([part.into for part in couples], axis=2),
        half=np.concatenate([part.half for part in couples], axis=1),
        radius=np.concatenate([part.radius for part in couples]),
    )
