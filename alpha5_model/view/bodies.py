"""The bodies that a URDF shows: its visual meshes and its collision primitives, link by link."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from alpha5_model.errors import FileFormatError
from alpha5_model.files import read_named
from alpha5_model.spatial import pose
from alpha5_model.view.shapes import Mesh, box, lathe

#: Colour of an element that has none of its own.
_COLOR = "0.95 0.55 0.1 1"


@dataclass(frozen=True, eq=False)
class LinkMesh:
    """One visual or collision element.

    Attributes:
        link: Name of the link that carries it.
        index: Its number among the link's elements of its kind.
        mesh: In the link's frame.
        color: Red, green, blue, each 0 to 1.
    """

    link: str
    index: int
    mesh: Mesh
    color: tuple[float, float, float]


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
    for link in ElementTree.fromstring(urdf).findall("link"):
        for index, item in enumerate(link.findall(element)):
            material, origin, shape = (
                item.find(path) for path in ("material/color", "origin", "geometry/*")
            )
            if shape is None:
                continue
            placed = {} if origin is None else origin.attrib
            xyz, rpy = (_numbers(placed.get(name, "0 0 0")) for name in ("xyz", "rpy"))
            r, g, b, _ = _numbers(_COLOR if material is None else material.attrib["rgba"])
            mesh = _geometry(shape, folder).moved(pose(xyz, rpy))
            bodies.append(LinkMesh(link.attrib["name"], index, mesh, (r, g, b)))
    return tuple(bodies)


def _numbers(text: str) -> list[float]:
    return [float(part) for part in text.split()]


def _geometry(shape: ElementTree.Element, folder: str) -> Mesh:
    """Mesh of one of the shapes that the arm's URDF is made of."""
    if shape.tag == "mesh":
        return read_obj(str(Path(folder, shape.attrib["filename"]).resolve()))
    if shape.tag == "cylinder":
        r, half = float(shape.attrib["radius"]), float(shape.attrib["length"]) / 2
        return lathe([(0.0, -half), (r, -half), (r, half), (0.0, half)])
    if shape.tag == "box":
        return box(_numbers(shape.attrib["size"]))
    raise FileFormatError("URDF", f"cannot draw a {shape.tag}")


@cache
def read_obj(path: str) -> Mesh:
    """Read an OBJ of triangles with normals.

    Raises:
        MissingFileError, FileFormatError: Not there, or not made of triangles with normals.
    """
    lines = read_named(path, "a mesh named by the URDF").decode("utf-8", "replace").splitlines()
    vertices, normals = (
        np.array([line.split()[1:4] for line in lines if line.startswith(tag)], float)
        for tag in ("v ", "vn ")
    )
    corners = [line.split()[1:] for line in lines if line.startswith("f ")]
    try:
        index = np.array([[part.split("//") for part in corner] for corner in corners], int) - 1
    except ValueError:
        index = np.empty(0)
    if index.ndim != 3 or index.shape[1:] != (3, 2):
        raise FileFormatError(path, "expected triangles with normals, f a//n b//n c//n")
    pairs, inverse = np.unique(index.reshape(-1, 2), axis=0, return_inverse=True)
    faces = inverse.reshape(-1, 3).astype(np.uint32)
    return Mesh(vertices[pairs[:, 0]], normals[pairs[:, 1]], faces)
