"""Obstacles from a TOML file.

Each table is one obstacle, and its name is the table's::

    [hull]
    box = [0.457, 0.338, 0.254]   # edges [m]
    xyz = [-0.2, 0.0, -0.14]      # centre in base_link [m]
    rpy = [0.0, 0.0, 0.0]         # [rad]

    [post]
    cylinder = [0.03, 1.0]        # radius, length [m]

    [buoy]
    sphere = 0.08                 # radius [m]

    [frame]
    mesh = "frame.stl"            # binary STL, beside this file
    scale = 0.001                 # from the mesh's unit to m
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, array, float_array, real
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.planning.obstacles import Obstacle

#: Kind -> other keys that its table may have.
KINDS = {
    "box": ("xyz", "rpy"),
    "cylinder": ("xyz", "rpy"),
    "sphere": ("xyz",),
    "mesh": ("xyz", "rpy", "scale"),
}
#: Bytes of a binary STL: its head, the number of triangles, and each of these.
_STL_HEAD = 80
_TRIANGLE = np.dtype([("numbers", "<f4", (4, 3)), ("attribute", "<u2")])
#: Largest file of obstacles, and of a mesh [bytes].
_LARGEST = 1 << 20
_LARGEST_MESH = 1 << 28


def read_obstacles(path: PathLike) -> tuple[Obstacle, ...]:
    """The obstacles of a file, in its order.

    Args:
        path: TOML, as the docstring of this module shows.

    Raises:
        MissingFileError: The file, or that of a mesh, is not there.
        FileFormatError: Not TOML, or a mesh that is no binary STL.
        InputError: A value that no obstacle can have; UnknownNameError: another key.
    """
    content = read_named(path, "a TOML file of obstacles", _LARGEST)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "is not UTF-8 text, TOML is expected") from None
    tables = toml_tables(text, str(path))
    folder = Path(path).parent
    return tuple(_obstacle(name, table, folder) for name, table in tables.items())


def _obstacle(name: str, table: Any, folder: Path) -> Obstacle:
    if not isinstance(table, Mapping):
        raise InputError(name, table, f"a table such as [{name}]")
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        raise InputError(name, sorted(table), f"one of {', '.join(KINDS)}")
    (kind,) = kinds
    for key in table:
        if key != kind and key not in KINDS[kind]:
            raise UnknownNameError(f"key of {name}", key, (kind, *KINDS[kind]))

    try:
        return _made(kind, name, table, folder)
    except InputError as error:
        place = f"{name}.{error.name}"
        raise InputError(place, error.value, error.expected) from None


def _made(kind: str, name: str, table: Mapping[str, Any], folder: Path) -> Obstacle:
    placed = {key: table[key] for key in ("xyz", "rpy") if key in table}
    value = table[kind]
    if kind == "box":
        return Obstacle.box(name, value, **placed)
    if kind == "cylinder":
        radius, length = array("cylinder", value, 2).tolist()
        return Obstacle.cylinder(name, radius, length, **placed)
    if kind == "sphere":
        return Obstacle.sphere(name, value, **placed)
    if not isinstance(value, str):
        raise InputError("mesh", value, "the name of a binary STL file")
    scale = real("scale", table.get("scale", 1.0), minimum=0.0, strict=True)
    vertices = scale * _stl_vertices(folder / value)
    triangles = np.arange(len(vertices)).reshape(-1, 3)
    return Obstacle.mesh(name, vertices, triangles, **placed)


def _stl_vertices(path: Path) -> FloatArray:
    """The corners of a binary STL's triangles, three by three, (3 T, 3).

    Raises:
        FileFormatError: Another kind of file.
    """
    content = read_named(path, "a binary STL file", _LARGEST_MESH)
    body = content[_STL_HEAD + 4 :]
    count = int.from_bytes(content[_STL_HEAD : _STL_HEAD + 4], "little")
    if not count or len(body) != count * _TRIANGLE.itemsize:
        raise FileFormatError(path, "is no binary STL file with triangles")
    triangles = np.frombuffer(body, _TRIANGLE)["numbers"][:, 1:]
    return float_array("vertices", triangles.reshape(-1, 3), (3,))
