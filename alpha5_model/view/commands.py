"""A scene as meshcat commands: the same ones for the live viewer and for the page on disk."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import FloatArray
from alpha5_model.view.scene import DRAWN, Scene, Shape

#: Root of the arm in meshcat's scene tree.
ROOT = "/meshcat/alpha5"
#: MessagePack extension codes by which meshcat sends typed arrays.
_CODES = {"f": ("Float32Array", 0x17), "u": ("Uint32Array", 0x16)}
#: Path, property and value: the backdrop; more light than meshcat's own scene, for dark bodies.
_SURROUNDINGS: tuple[tuple[str, str, Any], ...] = (
    ("/Background", "top_color", [1.0, 1.0, 1.0]),
    ("/Background", "bottom_color", [0.80, 0.86, 0.90]),
    ("/Lights/AmbientLight/<object>", "intensity", 0.75),
    ("/Lights/PointLightNegativeX/<object>", "intensity", 0.5),
    ("/Lights/PointLightPositiveX/<object>", "intensity", 0.5),
    ("/Lights/FillLight/<object>", "intensity", 0.5),
    ("/Grid", "visible", False),
    ("/Axes", "visible", False),
)


class Command(dict[str, Any]):
    """One meshcat command, ready for MessagePack."""

    def lower(self) -> Command:
        """Itself: what meshcat's window sends."""
        return self

    def packed(self) -> bytes:
        """The message as the browser reads it."""
        import umsgpack  # type: ignore[import-untyped]

        return bytes(umsgpack.packb(self))


def shape_path(shape: Shape) -> str:
    """Node of a shape in meshcat's scene tree."""
    return f"{ROOT}/{shape.group}/{shape.name}"


def link_path(link: str) -> str:
    """Node that carries the bodies of a link."""
    return f"{ROOT}/bodies/{link}"


def scene_commands(scene: Scene) -> Iterator[Command]:
    """Commands that build a scene from nothing.

    A mesh that several shapes share is sent with the first of them; the page remembers it.
    """
    sent: dict[int, str] = {}
    for shape in scene.shapes:
        yield _set_object(shape, sent)
    yield from pose_commands(scene)
    for group in DRAWN:
        yield set_visible(group, group in scene.show)
    for path, name, value in _SURROUNDINGS:
        yield _set_property(path, name, value)


def pose_commands(scene: Scene) -> Iterator[Command]:
    """Commands that move everything to where the scene has it."""
    for link, pose in scene.poses.items():
        yield set_transform(link_path(link), pose)
    for shape in scene.shapes:
        if shape.group != "bodies":
            yield set_transform(shape_path(shape), shape.anchor.transform(scene.poses))


def set_transform(path: str, matrix: FloatArray) -> Command:
    """Place a node by a (4, 4) pose in its parent."""
    return Command(type="set_transform", path=path, matrix=matrix.T.ravel().tolist())


def set_visible(group: str, visible: bool) -> Command:
    """Show or hide a group."""
    return _set_property(f"{ROOT}/{group}", "visible", visible)


def _set_property(path: str, name: str, value: Any) -> Command:
    return Command(type="set_property", path=path, property=name, value=value)


def _set_object(shape: Shape, sent: dict[int, str]) -> Command:
    # Names, not random identifiers: the same scene gives the same bytes.
    name = f"{shape.group}/{shape.name}"
    content = {} if id(shape.mesh) in sent else {"data": _geometry(shape)}
    geometry = sent.setdefault(id(shape.mesh), f"{name}:geometry")
    material = {
        "uuid": f"{name}:material",
        "type": "MeshBasicMaterial" if shape.flat else "MeshPhongMaterial",
        "color": 0xFFFFFF if shape.mesh.colors is not None else _hex(shape.color),
        "specular": _hex((0.55 * shape.shine,) * 3),
        "shininess": 40.0,
        # three.js: 0 front only, 2 both sides. Closed bodies need their front only.
        "side": 2 if shape.flat else 0,
        "transparent": shape.on_top > 0 or shape.opacity < 1.0,
        "opacity": shape.opacity,
        "depthTest": shape.on_top == 0,
        "depthWrite": shape.opacity == 1.0,
        "vertexColors": shape.mesh.colors is not None,
    }
    mesh = {"uuid": name, "type": "Mesh", "geometry": geometry, "material": material["uuid"]}
    parts = {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": geometry, "type": "BufferGeometry", **content}],
        "materials": [material],
        "object": {**mesh, "renderOrder": shape.on_top},
    }
    return Command(type="set_object", path=shape_path(shape), object=parts)


def _geometry(shape: Shape) -> dict[str, Any]:
    mesh = shape.mesh
    normals = None if shape.flat else mesh.normals
    corners = {"position": mesh.vertices, "normal": normals, "color": mesh.colors}
    return {
        "attributes": {
            name: _typed(values.astype("<f4"), 3)
            for name, values in corners.items()
            if values is not None
        },
        "index": _typed(mesh.faces.ravel().astype("<u4"), 1),
    }


def _typed(array: NDArray[Any], item_size: int) -> dict[str, Any]:
    import umsgpack

    name, code = _CODES[array.dtype.kind]
    return {
        "itemSize": item_size,
        "type": name,
        "array": umsgpack.Ext(code, np.ascontiguousarray(array).tobytes()),
        "normalized": False,
    }


def _hex(color: tuple[float, ...]) -> int:
    return int.from_bytes(bytes(round(255 * c) for c in color))
