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
    mesh = "frame.stl"            # STL, OBJ or PLY, beside this file
    scale = 0.001                 # from the mesh's unit to m
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import array, real
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
#: Argument of an obstacle -> the key that has it.
_KEYS = {"edges": "box", "radius": "sphere", "vertices": "mesh", "triangles": "mesh"}
#: Formats of meshes, by the end of the file's name.
_MESHES = (".stl", ".obj", ".ply")
#: Largest file of obstacles, and of a mesh [bytes].
_LARGEST = 1 << 20
_LARGEST_MESH = 1 << 28


def read_obstacles(path: PathLike) -> tuple[Obstacle, ...]:
    """The obstacles of a file, in its order.

    Args:
        path: TOML, as the docstring of this module shows.

    Raises:
        MissingFileError: The file, or that of a mesh, is not there.
        FileFormatError: Not TOML, no obstacle in it, or a mesh that cannot be read.
        InputError: A value that no obstacle can have; UnknownNameError: another key.
    """
    content = read_named(path, "a TOML file of obstacles", _LARGEST)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "is not UTF-8 text, TOML is expected") from None
    tables = toml_tables(text, str(path))
    if not tables:
        raise FileFormatError(path, "has no obstacles, a table for each is expected")
    folder = Path(path).parent
    return tuple(_obstacle(path, name, table, folder) for name, table in tables.items())


def _obstacle(path: PathLike, name: str, table: Any, folder: Path) -> Obstacle:
    if not isinstance(table, Mapping):
        raise InputError(name, table, f"a table such as [{name}]")
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        raise InputError(name, sorted(table), f"one of {', '.join(KINDS)}")
    (kind,) = kinds
    for key in table:
        if key != kind and key not in KINDS[kind]:
            raise UnknownNameError(
                f"key of {name} in {path}", key, (kind, *KINDS[kind])
            )

    try:
        return _made(kind, name, table, folder)
    except InputError as error:
        place = f"{name}.{_KEYS.get(error.name, error.name)}"
        raise InputError(place, error.value, error.expected) from None


def _made(kind: str, name: str, table: Mapping[str, Any], folder: Path) -> Obstacle:
    placed = {key: table[key] for key in ("xyz", "rpy") if key in table}
    value = table[kind]
    if kind == "box":
        return Obstacle.box(name, value, **placed)
    if kind == "cylinder":
        sizes = array("cylinder", value, 2)
        if not (sizes > 0.0).all():
            raise InputError("cylinder", sizes.tolist(), "radius and length above 0")
        return Obstacle.cylinder(name, *sizes.tolist(), **placed)
    if kind == "sphere":
        return Obstacle.sphere(name, value, **placed)
    if not isinstance(value, str):
        raise InputError("mesh", value, "the name of a file of triangles")
    scale = real("scale", table.get("scale", 1.0), minimum=0.0, strict=True)
    mesh = _mesh(folder / value)
    return Obstacle.mesh(name, scale * mesh.vertices, mesh.faces, **placed)


def _mesh(path: Path) -> Any:
    """The triangles of a file, by trimesh; its materials are not looked for.

    Raises:
        FileFormatError: No mesh of a format that is read here.
    """
    if path.suffix.lower() not in _MESHES:
        raise FileFormatError(path, f"is no mesh; write it as {', '.join(_MESHES)}")
    content = read_named(path, "a file of triangles", _LARGEST_MESH)
    # trimesh takes half a second to import, and most obstacles are no meshes.
    import trimesh

    try:
        mesh = trimesh.load_mesh(
            io.BytesIO(content), file_type=path.suffix[1:].lower(), process=False
        )
    except Exception as error:  # trimesh promises no type
        what = f"{type(error).__name__}: {error}"
        raise FileFormatError(path, f"cannot be read as a mesh ({what})") from None
    if not isinstance(mesh, trimesh.Trimesh) or not len(mesh.faces):
        raise FileFormatError(path, "has no triangles")
    return mesh
