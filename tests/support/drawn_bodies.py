"""The committed drawings, read by a parser of the tests, and where their bodies are."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from reference import inertial_frames, rotation_x, rotation_z

from alpha5_model._support.paths import REPOSITORY_PATH

MESHES = Path(REPOSITORY_PATH) / "meshes"
LINKS = ("link_0", "link_1", "link_2", "link_3", "link_4")
BODIES = (*LINKS, "finger_1", "finger_2")
#: Pivots of the fingers in link_4 [m].
PIVOT_X = 0.0155
PIVOT_Z = -(0.13275 + 0.0069)


class Mesh:
    """An OBJ file: vertices (n, 3) [m], faces (m, 3), normals of corners (m, 3, 3)."""

    def __init__(self, text: str) -> None:
        rows = [line.split() for line in text.splitlines() if line and line[0] in "vf"]
        self.v = np.array([row[1:] for row in rows if row[0] == "v"], float)
        normals = np.array([row[1:] for row in rows if row[0] == "vn"], float)
        corners = [[c.split("//") for c in row[1:]] for row in rows if row[0] == "f"]
        index = np.array(corners, int) - 1
        self.f = index[..., 0]
        self.normals = normals[index[..., 1]]

    @property
    def corners(self) -> np.ndarray:
        return self.v[self.f]

    def volume_and_centroid(self) -> tuple[float, np.ndarray]:
        """Litres and mm: sums over the tetrahedra from the origin to each triangle."""
        c = self.corners * 1e3
        six = np.einsum("fi,fi->f", c[:, 0], np.cross(c[:, 1], c[:, 2]))
        return six.sum() / 6e6, np.einsum("f,fi->i", six, c.sum(1)) / (4 * six.sum())


def finger_pose(name: str, angle: float = 0.0) -> np.ndarray:
    """Frame of a finger in link_4 [m]."""
    side = -1 if name == "finger_1" else 1
    pose = rotation_x(side * math.pi / 2) @ rotation_z(angle)
    pose[:3, 3] = (side * PIVOT_X, 0.0, PIVOT_Z)
    return pose


def link_poses(q: np.ndarray) -> dict[str, np.ndarray]:
    """Inertial frames in the base frame by link [m]."""
    return dict(zip(LINKS, inertial_frames(np.asarray(q, float)), strict=True))


def placed(solid, pose: np.ndarray):
    in_mm = pose[:3].copy()
    in_mm[:, 3] *= 1e3
    return solid.transform(in_mm)
