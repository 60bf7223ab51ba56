"""Building blocks on the solids of manifold3d. Lengths in mm."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.errors import MissingDependencyError

#: A manifold3d solid: closed, outward, exact in its booleans.
Solid = Any
#: Corners of a full circle of 20 mm radius; the chord stays within 0.04 mm of the arc.
SEGMENTS = 56
_ROUND = 1.0  # smaller edges are broken by one chamfer, larger ones rounded in three steps

_AXES = {"x": (0.0, 90.0, 0.0), "y": (-90.0, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def kernel() -> Any:
    """The manifold3d module.

    Raises:
        MissingDependencyError: It is not installed; only drawing new meshes needs it.
    """
    try:
        import manifold3d
    except ImportError:
        raise MissingDependencyError(
            "manifold3d", "drawing the meshes", "pip install manifold3d"
        ) from None
    return manifold3d


def turned(outline: ArrayLike, axis: str = "z", segments: int = SEGMENTS) -> Solid:
    """Turn an outline of (radius, height) points, counter-clockwise, about an axis."""
    k = kernel()
    return k.CrossSection([np.asarray(outline, float)]).revolve(segments).rotate(_AXES[axis])


def cylinder(
    radius: float,
    low: float,
    high: float,
    axis: str = "z",
    edges: tuple[float, float] = (0.0, 0.0),
    grooves: Iterable[tuple[float, float, float]] = (),
    segments: int = SEGMENTS,
) -> Solid:
    """A cylinder on an axis through the origin, with rounded edges and ring grooves.

    Args:
        radius: Outer radius.
        low, high: Heights of its faces.
        edges: Rounding at the low and the high face.
        grooves: Each (height of its middle, width, depth), walls sloped by 30 deg from the radius.
    """
    outline = [(0.0, low), *_corner(radius, low, edges[0], -1.0)]
    for middle, width, depth in sorted(grooves):
        slope = depth * math.tan(math.pi / 6)
        for height, r in (
            (middle - width / 2, radius),
            (middle - width / 2 + slope, radius - depth),
            (middle + width / 2 - slope, radius - depth),
            (middle + width / 2, radius),
        ):
            outline.append((r, height))
    outline += [*reversed(_corner(radius, high, edges[1], 1.0)), (0.0, high)]
    return turned(outline, axis, segments)


def _corner(radius: float, height: float, edge: float, side: float) -> list[tuple[float, float]]:
    """Points of the outline's corner, from the face outwards."""
    if edge == 0.0:
        return [(radius, height)]
    steps = 3 if edge > _ROUND else 1
    angles = [math.pi / 2 * i / steps for i in range(steps + 1)]
    return [
        (
            radius - edge + edge * math.sin(angle),
            height - side * edge + side * edge * math.cos(angle),
        )
        for angle in angles
    ]


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A box between two corners."""
    size = [b - a for a, b in zip(low, high, strict=True)]
    return kernel().Manifold.cube(size).translate(list(low))


def prism(outline: ArrayLike, low: float, high: float, edge: float = 0.0) -> Solid:
    """A convex outline of (x, y) points between two heights, its long edges broken by ``edge``."""
    k = kernel()
    section = k.CrossSection([np.asarray(outline, float)])
    outer = section.extrude(high - low - 2 * edge).translate([0, 0, low + edge])
    if edge == 0.0:
        return outer
    inner = section.offset(-edge, k.JoinType.Miter, 2.0)
    return k.Manifold.batch_hull([outer, inner.extrude(high - low).translate([0, 0, low])])


def loft(outlines: Sequence[ArrayLike], heights: Sequence[float]) -> Solid:
    """The solid through outlines with the same number of (x, y) points, counter-clockwise."""
    k = kernel()
    layers = [np.asarray(o, float) for o in outlines]
    n = len(layers[0])
    vertices = np.vstack(
        [np.column_stack([o, np.full(n, h)]) for o, h in zip(layers, heights, strict=True)]
    )
    caps = np.asarray(k.triangulate([layers[0]]))
    top = np.asarray(k.triangulate([layers[-1]])) + n * (len(layers) - 1)
    i = np.arange(n)
    j = (i + 1) % n
    sides = [
        block
        for layer in range(len(layers) - 1)
        for a in (n * layer,)
        for block in (
            np.column_stack([i + a, j + a, j + a + n]),
            np.column_stack([i + a, j + a + n, i + a + n]),
        )
    ]
    faces = np.vstack([caps[:, ::-1], top, *sides])
    return k.Manifold(k.Mesh64(vertices, faces.astype(np.uint64)))


def union(solids: Iterable[Solid]) -> Solid:
    """All of them together."""
    k = kernel()
    return k.Manifold.batch_boolean(list(solids), k.OpType.Add)


def circle_of(solid: Solid, count: int, radius: float, start: float = 0.0) -> Solid:
    """Copies of a solid, equally spaced on a circle about z; ``start`` in degrees."""
    return union(
        solid.translate([radius, 0, 0]).rotate([0, 0, start + 360.0 * i / count])
        for i in range(count)
    )
