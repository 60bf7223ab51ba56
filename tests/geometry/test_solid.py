"""Solids whose areas are known by the shoelace formula."""

from __future__ import annotations

import numpy as np
import pytest

from alpha5_model.geometry.solid import loft

#: Each has one corner inside the triangle of the others: it has one diagonal only, and
#: not the same.
LOWER = np.array([(0.0, 0.0), (2.0, 0.0), (0.3, 0.3), (0.0, 2.0)])
UPPER = np.array([(0.0, 0.0), (0.5, 0.8), (2.0, 2.0), (0.0, 2.0)])


def enclosed_area(outline: np.ndarray) -> float:
    """The shoelace formula."""
    x, y = outline.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


@pytest.mark.parametrize("outlines", [(LOWER, UPPER), (UPPER, LOWER)])
def test_a_loft_is_closed_by_its_own_outlines(outlines: tuple[np.ndarray, ...]) -> None:
    heights = (1.0, 4.0)
    mesh = loft(outlines, heights).to_mesh64()
    points = np.asarray(mesh.vert_properties)[:, :3]
    triangles = points[np.asarray(mesh.tri_verts).astype(int)]
    edges = np.diff(triangles, axis=1)
    normals = np.cross(edges[:, 0], edges[:, 1])
    for outline, height, outward in zip(outlines, heights, (-1.0, 1.0), strict=True):
        flat = (triangles[:, :, 2] == height).all(axis=1)
        areas = outward * normals[flat, 2] / 2
        assert (areas > 0).all()
        assert areas.sum() == pytest.approx(enclosed_area(outline))
