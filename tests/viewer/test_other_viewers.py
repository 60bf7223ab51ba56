"""The arm in the viewers of Pinocchio, as docs/guides/viewers.md shows it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import alpha5_model as a5
from alpha5_model.description.reading import urdf_shapes

REPOSITORY = Path(__file__).parents[2]
URDFS = [Path(a5.URDF_PATH), Path(a5.paths.JAWS_URDF_PATH)]
Models = tuple[pin.Model, pin.GeometryModel, pin.GeometryModel]


def built(urdf: Path, *folders: Path) -> Models:
    """Pinocchio's model of a file, its collision and its visual shapes."""
    names = [str(folder) for folder in folders]
    return pin.buildModelsFromUrdf(str(urdf), package_dirs=names)


def obj_faces(path: Path) -> int:
    """Triangles of an OBJ file, counted line by line."""
    return sum(line.startswith("f ") for line in path.read_text().splitlines())


@pytest.mark.parametrize("urdf", URDFS, ids=lambda path: path.stem)
def test_plain_pinocchio_finds_the_meshes_in_the_folder_of_the_urdf(urdf: Path) -> None:
    _, _, visual = built(urdf, urdf.parent)
    found = [Path(shape.meshPath).resolve() for shape in visual.geometryObjects]
    assert {path.parent for path in found} == {(REPOSITORY / "meshes").resolve()}
    for path, shape in zip(found, visual.geometryObjects, strict=True):
        assert obj_faces(path) == shape.geometry.num_tris > 100


@contextmanager
def viser_of(models: Models) -> Iterator[Any]:
    """Pinocchio's viewer with a server of viser, models loaded."""
    viser = pytest.importorskip("viser")
    from pinocchio.visualize import ViserVisualizer

    visualizer = ViserVisualizer(*models)
    # The next free port is taken if another program has this one.
    server = viser.ViserServer(host="127.0.0.1", port=8570, verbose=False)
    try:
        visualizer.initViewer(viewer=server, loadModel=True)
        yield visualizer
    finally:
        server.stop()


def test_viser_shows_each_body_where_our_kinematics_have_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """All triangles of each body of the URDF, at the arm's own frames."""
    urdf = Path(a5.URDF_PATH)
    shapes = list(urdf_shapes(urdf.read_text("utf-8"), "visual"))
    arm = a5.load()
    q = np.array([3.0, 1.1, 2.0, -0.4])

    with viser_of(built(urdf, urdf.parent)) as visualizer:
        visualizer.display(q)
        for shape in shapes:
            node = visualizer.frames[f"pinocchio/visual/{shape.link}_{shape.index}"]
            assert len(node.faces) == obj_faces(urdf.parent / shape.file)

            w, x, y, z = node.wxyz
            rotation = pin.Quaternion(w, x, y, z).toRotationMatrix()
            placed = arm.forward_kinematics(q, frame=shape.link).homogeneous
            expected = placed @ shape.placement
            np.testing.assert_allclose(rotation, expected[:3, :3], atol=1e-6)
            np.testing.assert_allclose(node.position, expected[:3, 3], atol=1e-7)
    assert len(shapes) == 7
    capsys.readouterr()
