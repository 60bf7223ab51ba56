"""A scene as commands of meshcat's protocol, for live pages and pages on disk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import umsgpack  # type: ignore[import-untyped]
from numpy.typing import NDArray

from alpha5_model.viewer.scene import (
    MADE_BY_PAGE,
    Color,
    Mean,
    Rigid,
    Scene,
    Shape,
)

#: Root of the arm in meshcat's scene tree.
ROOT = "/meshcat/alpha5"
#: NumPy's name of a type -> JavaScript's typed array, and the MessagePack extension
#: code by which meshcat sends it.
_TYPED_ARRAYS = {"<f4": ("Float32Array", 0x17), "<u4": ("Uint32Array", 0x16)}
_WHITE = 0xFFFFFF
#: three.js's numbers for the sides of a triangle that are drawn.
_FRONT_SIDE = 0
_BOTH_SIDES = 2
#: Brightness of the strongest highlight, 0 to 1.
_HIGHLIGHT = 0.55


class Command(dict[str, Any]):
    """One meshcat command, ready for MessagePack."""

    def lower(self) -> Command:
        """Itself; meshcat's window asks for what it is to send."""
        return self

    def packed(self) -> bytes:
        """The message as the browser reads it."""
        return bytes(umsgpack.packb(self))


def scene_commands(scene: Scene) -> Iterator[Command]:
    """The commands that build a scene from nothing.

    A mesh that several shapes share is sent with the first of them, and the page
    remembers it. Groups of `MADE_BY_PAGE` are not sent. The page puts everything where
    its joint positions have it.
    """
    sent: dict[int, str] = {}
    for shape in scene.shapes:
        if shape.group not in MADE_BY_PAGE:
            yield _set_object(shape, sent)


def pose_message(scene: Scene) -> Command:
    """The command with the joint positions and the poses of links without a joint.

    A pose has three rows.
    """
    carried = {joint.child for joint in scene.tree}
    fixed = {
        link: pose[:3].tolist()
        for link, pose in scene.poses.items()
        if link not in carried
    }
    return Command(type="pose", q=scene.q.tolist(), root=fixed)


def shape_path(shape: Shape) -> str:
    """Path of a shape in meshcat's scene tree."""
    return f"{ROOT}/{shape.group}/{shape.name}"


def link_path(link: str) -> str:
    """Path of a link's bodies in meshcat's scene tree."""
    return f"{ROOT}/bodies/{link}"


def anchors(scene: Scene) -> dict[str, Rigid | Mean]:
    """Path -> anchor of every shape that does not move with the node of its link."""
    return {
        shape_path(shape): shape.anchor
        for shape in scene.shapes
        if shape.group not in ("bodies", *MADE_BY_PAGE)
    }


def _set_object(shape: Shape, sent: dict[int, str]) -> Command:
    """The command that makes a shape.

    Args:
        shape: What to make.
        sent: Identity of a mesh -> name of the geometry that was sent of it; added to.
    """
    # The identifiers are names, not random: the same scene gives the same bytes.
    name = f"{shape.group}/{shape.name}"
    content = {} if id(shape.mesh) in sent else {"data": _geometry(shape)}
    geometry = sent.setdefault(id(shape.mesh), f"{name}:geometry")
    material = _material(shape)
    mesh = {
        "uuid": name,
        "type": "Mesh",
        "geometry": geometry,
        "material": material["uuid"],
        "renderOrder": shape.on_top,
    }
    parts = {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": geometry, "type": "BufferGeometry", **content}],
        "materials": [material],
        "object": mesh,
    }
    return Command(type="set_object", path=shape_path(shape), object=parts)


def _material(shape: Shape) -> dict[str, Any]:
    colored = shape.mesh.colors is not None
    return {
        "uuid": f"{shape.group}/{shape.name}:material",
        "type": "MeshBasicMaterial" if shape.flat else "MeshPhongMaterial",
        "color": _WHITE if colored else _hex(shape.color),
        "specular": _hex((_HIGHLIGHT * shape.shine,) * 3),
        "shininess": 40.0,
        # Nobody sees a closed body from behind.
        "side": _BOTH_SIDES if shape.flat else _FRONT_SIDE,
        "transparent": shape.on_top > 0 or shape.opacity < 1.0,
        "opacity": shape.opacity,
        "depthTest": shape.on_top == 0,
        "depthWrite": shape.opacity == 1.0,
        "vertexColors": colored,
    }


def _geometry(shape: Shape) -> dict[str, Any]:
    mesh = shape.mesh
    attributes = {"position": _typed_array(mesh.vertices, "<f4", 3)}
    if not shape.flat:
        attributes["normal"] = _typed_array(mesh.normals, "<f4", 3)
    if mesh.colors is not None:
        attributes["color"] = _typed_array(mesh.colors, "<f4", 3)
    index = _typed_array(mesh.faces.ravel(), "<u4", 1)
    return {"attributes": attributes, "index": index}


def _typed_array(array: NDArray[Any], kind: str, item_size: int) -> dict[str, Any]:
    """An array as meshcat sends it, of numbers of a kind, so many for each vertex."""
    name, code = _TYPED_ARRAYS[kind]
    packed = umsgpack.Ext(code, array.astype(kind).tobytes())
    return {"itemSize": item_size, "type": name, "array": packed, "normalized": False}


def _hex(color: Color) -> int:
    """A colour as one number, 0xrrggbb."""
    return int.from_bytes(bytes(round(255 * part) for part in color))
