"""Building blocks of drawn bodies, on the solids of manifold3d [mm]."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import needing

#: A manifold3d solid: closed, outward, exact in its booleans.
Solid = Any
#: Corners of a full circle of 20 mm radius; the chord stays within 0.04 mm of the arc.
SEGMENTS = 56
#: Where what cuts a part ends, outside of it [mm].
FAR = 100.0
#: Smaller edges are broken by one chamfer; larger ones are rounded in at least three
#: steps [mm].
_ROUND = 1.0
#: Roll, pitch, yaw [deg] that turn z to an axis.
AXES = {"x": (0.0, 90.0, 0.0), "y": (-90.0, 0.0, 0.0), "z": (0.0, 0.0, 0.0)}


def kernel() -> Any:
    """The manifold3d module.

    Raises:
        MissingDependencyError: It is not installed; only drawing new meshes needs it.
    """
    with needing("drawing the meshes", "pip install manifold3d"):
        import manifold3d
    return manifold3d


class Groove(NamedTuple):
    """A ring groove of a cylinder; its walls slope by 30 deg from the radius.

    Attributes:
        middle: Height of its middle.
        width: At the surface.
        depth: Below the surface.
    """

    middle: float
    width: float
    depth: float

    def outline(self, radius: float) -> list[tuple[float, float]]:
        """Points (r, h) on a cylinder of a radius, from the bottom up."""
        half = self.width / 2
        slope = self.depth * math.tan(math.pi / 6)
        floor = radius - self.depth
        return [
            (radius, self.middle - half),
            (floor, self.middle - half + slope),
            (floor, self.middle + half - slope),
            (radius, self.middle + half),
        ]


def cylinder(
    radius: float,
    low: float,
    high: float,
    axis: str = "z",
    edges: tuple[float, float] = (0.0, 0.0),
    grooves: Iterable[Groove] = (),
    segments: int = SEGMENTS,
) -> Solid:
    """A cylinder on an axis through the origin, with rounded edges and ring grooves.

    Args:
        radius: Outer radius.
        low, high: Heights of its faces.
        edges: Rounding at the low and the high face.
        grooves: Ring grooves.
    """
    low_edge, high_edge = edges
    outline = [(0.0, low), *_corner(radius, low, low_edge, -1.0)]
    for groove in sorted(grooves):
        outline += groove.outline(radius)
    outline += reversed(_corner(radius, high, high_edge, 1.0))
    outline.append((0.0, high))

    section = kernel().CrossSection([np.array(outline)])
    return section.revolve(segments).rotate(AXES[axis])


def _corner(
    radius: float, height: float, edge: float, side: float
) -> list[tuple[float, float]]:
    """Points (r, h) of the outline's corner, from the face outwards.

    Args:
        radius: Of the cylinder.
        height: Of its face.
        edge: Rounding of the corner.
        side: -1 for the lower face, 1 for the upper one.
    """
    if edge == 0.0:
        return [(radius, height)]
    steps = 1 if edge <= _ROUND else max(3, round(edge / 2.4))
    centre_r = radius - edge
    centre_h = height - side * edge
    points = []
    for i in range(steps + 1):
        angle = math.pi / 2 * i / steps
        r = centre_r + edge * math.sin(angle)
        h = centre_h + side * edge * math.cos(angle)
        points.append((r, h))
    return points


def box(low: Sequence[float], high: Sequence[float]) -> Solid:
    """A box between two corners."""
    return kernel().Manifold.cube(np.subtract(high, low)).translate(low)


def loft(outlines: Sequence[FloatArray], heights: Sequence[float]) -> Solid:
    """The solid through outlines at heights.

    Args:
        outlines: Each of the same number of (x, y) points, counter-clockwise, (n, 2).
        heights: Of the outlines.
    """
    k = kernel()
    n = len(outlines[0])
    last = len(outlines) - 1
    vertices = np.column_stack([np.vstack(outlines), np.repeat(heights, n)])

    bottom = np.asarray(k.triangulate([outlines[0]]))
    top = np.asarray(k.triangulate([outlines[last]])) + n * last

    here = np.arange(n)
    there = (here + 1) % n
    # Two triangles for each edge of an outline and the same edge of the next one.
    corners = [here, there, there + n, here, there + n, here + n]
    side = np.column_stack(corners).reshape(-1, 3)
    sides = [side + n * i for i in range(last)]

    downward_bottom = bottom[:, ::-1]
    faces = np.vstack([downward_bottom, top, *sides])
    return k.Manifold(k.Mesh64(vertices, faces.astype(np.uint64)))


def union(solids: Iterable[Solid]) -> Solid:
    """The union of all solids."""
    k = kernel()
    return k.Manifold.batch_boolean(list(solids), k.OpType.Add)


def circle_of(solid: Solid, count: int, radius: float, start: float = 0.0) -> Solid:
    """Copies of a solid, equally spaced on a circle about z; ``start`` in degrees."""
    first = solid.translate([radius, 0, 0])
    angles = [start + 360.0 * i / count for i in range(count)]
    return union(first.rotate([0, 0, angle]) for angle in angles)
