"""Meshes from files, joined ones, and lines with doubled points."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from alpha5_model.viewer.shapes import join, lathe, read_obj, sphere, tube


def test_colours_of_a_meshs_vertices_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "colours.obj"
    path.write_text(
        "v 1 2 3 0.5 0.6 0.7\nv 4 5 6 0.5 0.6 0.7\nv 7 8 8 0.5 0.6 0.7\n"
        "vn 0 0 1\nf 1//1 2//1 3//1\n"
    )
    np.testing.assert_array_equal(
        read_obj(str(path)).vertices, [[1, 2, 3], [4, 5, 6], [7, 8, 8]]
    )


def test_meshes_are_joined_with_their_colours_or_without() -> None:
    red = sphere(0.1).painted((1.0, 0.0, 0.0))
    both = join([red, sphere(0.2)])
    assert both.colors is None
    radii = np.linalg.norm(both.vertices[both.faces.ravel()], axis=1)
    count = red.faces.size
    np.testing.assert_allclose(radii[:count], 0.1)
    np.testing.assert_allclose(radii[count:], 0.2)
    assert len(radii) == 2 * count
    np.testing.assert_array_equal(join([red, red]).colors[:, 0], 1.0)


def test_a_doubled_point_of_a_line_draws_nothing_more() -> None:
    line = np.array([[0.1, 0, 0], [0.2, 0, 0.1], [0.1, 0, 0.3]])
    doubled = line[[0, 1, 1, 2]]
    np.testing.assert_array_equal(
        tube(doubled, 0.01).vertices, tube(line, 0.01).vertices
    )
    np.testing.assert_array_equal(
        lathe(doubled[:, [0, 2]]).vertices, lathe(line[:, [0, 2]]).vertices
    )
