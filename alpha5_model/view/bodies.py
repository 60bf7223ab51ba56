"""The bodies that a URDF shows: its visual meshes and its collision primitives, link by link."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import FileFormatError
from alpha5_model.files import read_named
from alpha5_model.spatial import pose
from alpha5_model.view.shapes import Mesh, lathe


@dataclass(frozen=True, eq=False)
class LinkMesh:
    """One visual or collision element.

    Attributes:
        link: Name of the link that carries it.
        mesh: In the link's frame.
        color: Red, green, blue, opacity, each 0 to 1.
    """

    link: str
    mesh: Mesh
    color: tuple[float, float, float, float]


def urdf_bodies(urdf: str, folder: str, element: str = "visual") -> tuple[LinkMesh, ...]:
    """Bodies of a URDF text.

    Args:
        urdf: The text.
        folder: Folder that relative mesh names start from.
        element: ``visual`` or ``collision``.

    Raises:
        MissingFileError, FileFormatError: A mesh that is not there or not a triangle OBJ.
    """
    bodies = []
    root = ElementTree.fromstring(urdf)
    for link in root.findall("link"):
        for item in link.findall(element):
            geometry = item.find("geometry")
            shape = None if geometry is None else next(iter(geometry), None)
            if shape is None:
                continue
            color = item.find("material/color")
            rgba = (
                [0.95, 0.55, 0.1, 1.0]
                if color is None
                else [float(v) for v in color.attrib["rgba"].split()]
            )
            origin = item.find("origin")
            at = {} if origin is None else origin.attrib
            xyz, rpy = ([float(v) for v in at.get(k, "0 0 0").split()] for k in ("xyz", "rpy"))
            mesh = _geometry(shape, folder).moved(pose(xyz, rpy))
            r, g, b, a = rgba
            bodies.append(LinkMesh(link.attrib["name"], mesh, (r, g, b, a)))
    return tuple(bodies)


def _geometry(shape: ElementTree.Element, folder: str) -> Mesh:
    if shape.tag == "mesh":
        return read_obj(str(Path(folder, shape.attrib["filename"]).resolve()))
    if shape.tag == "cylinder":
        r, half = float(shape.attrib["radius"]), float(shape.attrib["length"]) / 2
        return lathe([(0.0, -half), (r, -half), (r, half), (0.0, half)])
    if shape.tag == "capsule":
        r, half = float(shape.attrib["radius"]), float(shape.attrib["length"]) / 2
        return _capsule(r, half)
    if shape.tag == "sphere":
        return _capsule(float(shape.attrib["radius"]), 0.0)
    if shape.tag == "box":
        return _box(np.array([float(v) for v in shape.attrib["size"].split()]))
    raise FileFormatError("URDF", f"cannot draw a {shape.tag}")


def _capsule(radius: float, half: float) -> Mesh:
    angle = np.linspace(-np.pi / 2, np.pi / 2, 12)
    lift = np.where(angle < 0, -half, half)
    return lathe(np.column_stack([radius * np.cos(angle), radius * np.sin(angle) + lift]))


def _box(size: FloatArray) -> Mesh:
    vertices: list[FloatArray] = []
    normals: list[FloatArray] = []
    faces: list[list[int]] = []
    for axis in range(3):
        for side in (-0.5, 0.5):
            normal = np.zeros(3)
            normal[axis] = np.sign(side)
            u, v = np.eye(3)[(axis + 1) % 3] / 2, np.eye(3)[(axis + 2) % 3] / 2
            u = u * np.sign(side)
            start = len(vertices) * 4
            vertices.append(normal / 2 + np.array([-u - v, u - v, u + v, v - u]))
            normals.append(np.tile(normal, (4, 1)))
            faces += [[start, start + 1, start + 2], [start, start + 2, start + 3]]
    return Mesh(
        np.concatenate(vertices) * size, np.concatenate(normals), np.array(faces, dtype=np.uint32)
    )


@cache
def read_obj(path: str) -> Mesh:
    """Read an OBJ of triangles with normals.

    Raises:
        MissingFileError, FileFormatError: Not there, or not made of triangles with normals.
    """
    lines = read_named(path, "a mesh named by the URDF").decode("utf-8", "replace").splitlines()
    vertices = np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)
    normals = np.array([line.split()[1:4] for line in lines if line.startswith("vn ")], float)
    corners = [line.split()[1:] for line in lines if line.startswith("f ")]
    try:
        index = np.array([[part.split("//") for part in corner] for corner in corners], int) - 1
    except ValueError:
        index = np.empty(0)
    if index.ndim != 3 or index.shape[1:] != (3, 2):
        raise FileFormatError(path, "expected triangles with normals, f a//n b//n c//n")
    pairs, inverse = np.unique(index.reshape(-1, 2), axis=0, return_inverse=True)
    return Mesh(
        vertices[pairs[:, 0]], normals[pairs[:, 1]], inverse.reshape(-1, 3).astype(np.uint32)
    )
