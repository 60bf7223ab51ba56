"""Obstacles from TOML and STL files."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    InputError,
    MissingFileError,
    UnknownNameError,
)
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.planning.obstacle_file import read_obstacles
from alpha5_model.planning.obstacles import Mesh

TEXT = """
[hull]
box = [0.4, 0.3, 0.2]
xyz = [-0.2, 0, -0.1]
rpy = [0, 0, 0.5]
[post]
cylinder = [0.03, 1]
[buoy]
sphere = 0.08
xyz = [0.1, 0.2, 0.3]
[frame]
mesh = "frame.stl"
scale = 0.001
xyz = [0, 0, 1]
"""
CORNERS = np.array(
    [[[0, 0, 0], [100, 0, 0], [0, 100, 0]], [[0, 0, 5], [1, 0, 5], [0, 1, 5]]]
)


def stl(corners: np.ndarray) -> bytes:
    """A binary STL of triangles (T, 3, 3)."""
    rows = [struct.pack("<12fH", 0, 0, 1, *row.ravel(), 0) for row in corners]
    return b"solid by hand".ljust(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def written(folder: Path, text: str) -> Path:
    (folder / "frame.stl").write_bytes(stl(CORNERS))
    path = folder / "scene.toml"
    path.write_text(text, "utf-8")
    return path


def test_every_kind_is_read(tmp_path: Path) -> None:
    hull, post, buoy, frame = read_obstacles(written(tmp_path, TEXT))
    assert hull.shape == Primitive(
        kind="box", size=(0.4, 0.3, 0.2), xyz=(-0.2, 0.0, -0.1), rpy=(0.0, 0.0, 0.5)
    )
    assert post.shape == Primitive(kind="cylinder", size=(0.03, 1.0), xyz=(0.0,) * 3)
    assert buoy.shape == Primitive(kind="sphere", size=(0.08,), xyz=(0.1, 0.2, 0.3))
    names = [obstacle.name for obstacle in (hull, post, buoy, frame)]
    assert names == ["hull", "post", "buoy", "frame"]
    assert isinstance(frame.shape, Mesh)
    vertices = frame.shape.vertices[frame.shape.triangles]
    assert vertices == pytest.approx(CORNERS / 1000 + [0, 0, 1], abs=1e-7)


def test_a_file_without_obstacles_is_refused(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text("# none\n", "utf-8")
    with pytest.raises(FileFormatError) as error:
        read_obstacles(path)
    assert str(error.value.path) == str(path)


BAD = [
    ("box = 1", InputError, r"box: expected a table such as \[box\]"),
    ("[a]\nxyz = [0, 0, 0]", InputError, "a: expected one of box, cylinder"),
    ("[a]\nbox = [1, 1, 1]\nsphere = 1", InputError, "a: expected one of"),
    ("[a]\nbox = [1, 1]", InputError, "a.box"),
    ("[a]\nbox = [1, 1, -1]", InputError, "a.edges"),
    ("[a]\ncylinder = [1]", InputError, "a.cylinder"),
    ("[a]\nsphere = '1'", InputError, "a.sphere"),
    (
        "[a]\nsphere = 1\nrpy = [0, 0, 0]",
        UnknownNameError,
        r"key of a in .*scene.toml 'rpy'",
    ),
    ("[a]\nmesh = 3", InputError, "a.mesh"),
    ("[a]\nmesh = 'frame.stl'\nscale = 0", InputError, "a.scale"),
    ("[a]\nmesh = 'missing.stl'", MissingFileError, "file of triangles"),
    ("[a]\nmesh = 'scene.toml'", FileFormatError, "scene.toml"),
    ("[a", FileFormatError, "scene.toml"),
    ("[a]\nbox = [1, 1, nan]", InputError, "a.box"),
]


@pytest.mark.parametrize(("text", "kind", "message"), BAD, ids=range(len(BAD)))
def test_bad_files(
    text: str, kind: type[Alpha5Error], message: str, tmp_path: Path
) -> None:
    with pytest.raises(kind, match=message):
        read_obstacles(written(tmp_path, text))


def test_a_file_that_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileFormatError, match="UTF-8"):
        read_obstacles(path)


def test_a_file_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match="TOML file of obstacles"):
        read_obstacles(tmp_path / "none.toml")


def test_a_mesh_that_is_cut_off(tmp_path: Path) -> None:
    (tmp_path / "cut.stl").write_bytes(stl(CORNERS)[:-1])
    with pytest.raises(FileFormatError, match=r"cut\.stl"):
        read_obstacles(written(tmp_path, "[a]\nmesh = 'cut.stl'"))


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_meshes_of_another_writer(suffix: str, tmp_path: Path) -> None:
    """pymeshlab writes a box of known corners; the reader is trimesh."""
    pymeshlab = pytest.importorskip("pymeshlab")
    meshes = pymeshlab.MeshSet()
    meshes.create_cube(size=0.5)
    meshes.save_current_mesh(str(tmp_path / f"cube.{suffix}"))
    path = tmp_path / "scene.toml"
    path.write_text(f"[cube]\nmesh = 'cube.{suffix}'\nscale = 2", "utf-8")
    (cube,) = read_obstacles(path)
    assert isinstance(cube.shape, Mesh)
    corners = cube.shape.vertices[cube.shape.triangles]
    assert np.ptp(corners.reshape(-1, 3), axis=0) == pytest.approx([1.0, 1.0, 1.0])
    sides = np.diff(corners[:, [0, 1, 2]], axis=1)
    areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    assert areas.sum() == pytest.approx(6.0)


def test_a_mesh_with_a_signalling_nan_is_refused(tmp_path: Path) -> None:
    content = bytearray(stl(CORNERS))
    content[-14:-10] = b"\x00\x00\xa0\x7f"
    file = written(tmp_path, "[a]\nmesh = 'frame.stl'")
    (tmp_path / "frame.stl").write_bytes(content)
    with np.errstate(invalid="ignore"), pytest.raises(Alpha5Error):
        read_obstacles(file)


def test_files_that_are_too_large(tmp_path: Path) -> None:
    """1 MiB of obstacles, 256 MiB of a mesh."""
    path = tmp_path / "scene.toml"
    text = "[a]\nbox = [1, 1, 1]\n#"
    path.write_text(text.ljust(1 << 20, "-"), "utf-8")
    assert len(read_obstacles(path)) == 1
    path.write_text(text.ljust((1 << 20) + 1, "-"), "utf-8")
    with pytest.raises(FileFormatError):
        read_obstacles(path)
    path.write_text("[a]\nmesh = 'big.stl'", "utf-8")
    with (tmp_path / "big.stl").open("wb") as file:
        file.truncate((1 << 28) + 1)
    with pytest.raises(FileFormatError, match=r"big\.stl"):
        read_obstacles(path)
