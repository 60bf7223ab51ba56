"""The primitives that URDF knows: box, cylinder and sphere."""

from __future__ import annotations

from dataclasses import dataclass, replace

from alpha5_model._support.checks import FloatArray, rigid_transform
from alpha5_model._support.spatial import pose, rpy_from_rotation


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
