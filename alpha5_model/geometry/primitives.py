"""The primitives that URDF knows: box, cylinder and sphere."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from alpha5_model._support.checks import FloatArray, rigid_transform
from alpha5_model._support.spatial import Triple, pose, rpy_from_rotation
from alpha5_model.geometry.solid import AXES


@dataclass(frozen=True)
class Primitive:
    """One collision shape in its link's frame.

    Attributes:
        kind: ``box``, ``cylinder`` (along its own z) or ``sphere``.
        size: Edges x, y, z; radius and length; or radius [m].
        xyz: Its centre [m].
        rpy: Fixed-axis roll, pitch, yaw [rad].
    """

    kind: str
    size: tuple[float, ...]
    xyz: tuple[float, ...]
    rpy: tuple[float, ...] = (0.0, 0.0, 0.0)

    def moved(self, frame: FloatArray) -> Primitive:
        """The shape in another frame, to which ``frame`` maps, (4, 4).

        Raises:
            InputError: Not a rigid transform.
        """
        placed = rigid_transform("frame", frame)[:3] @ pose(self.xyz, self.rpy)
        return replace(
            self,
            xyz=tuple(placed[:3, 3].tolist()),
            rpy=rpy_from_rotation(placed[:3, :3]),
        )

    def as_written(self) -> Primitive:
        """The shape from mm in metres, to a nanometre and 1e-12 rad.

        A URDF does not show the last bits of a sine.
        """
        return Primitive(
            kind=self.kind,
            size=tuple(round(c * 1e-3, 9) + 0.0 for c in self.size),
            xyz=tuple(round(c * 1e-3, 9) + 0.0 for c in self.xyz),
            rpy=tuple(round(angle, 12) + 0.0 for angle in self.rpy),
        )


def cylinder(
    radius: float, low: float, high: float, axis: str, at: Triple = (0, 0, 0)
) -> Primitive:
    """A cylinder between two heights along x, y or z through a point."""
    middle = (low + high) / 2
    xyz = (c + middle * (name == axis) for c, name in zip(at, "xyz", strict=True))
    return Primitive(
        kind="cylinder",
        size=(radius, high - low),
        xyz=tuple(xyz),
        rpy=tuple(np.radians(AXES[axis]).tolist()),
    )


def box(low: Triple, high: Triple) -> Primitive:
    """A box between two corners."""
    ends = list(zip(low, high, strict=True))
    return Primitive(
        kind="box",
        size=tuple(b - a for a, b in ends),
        xyz=tuple((a + b) / 2 for a, b in ends),
    )


def box_around(
    outline: FloatArray,
    span: tuple[float, float],
    direction: FloatArray,
    margin: float,
) -> Primitive:
    """A box around an outline in the x-y plane, its long side in a direction.

    Args:
        outline: Points, (n, 2).
        span: Heights of the lower and the upper face.
        direction: (2,).
        margin: Added on each side in the plane.
    """
    along = direction / np.linalg.norm(direction)
    axes = np.array([along, [-along[1], along[0]]])
    points = outline @ axes.T
    low = points.min(0) - margin
    high = points.max(0) + margin

    bottom, top = span
    return Primitive(
        kind="box",
        size=(*(high - low).tolist(), top - bottom),
        xyz=(*((low + high) / 2 @ axes).tolist(), (bottom + top) / 2),
        rpy=(0.0, 0.0, math.atan2(along[1], along[0])),
    )
