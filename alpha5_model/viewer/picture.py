"""A picture of a scene, drawn without a graphics card, browser or window system.

The pixels are the same everywhere.
"""

from __future__ import annotations

import io
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.viewer.annotations import annotated
from alpha5_model.viewer.canvas import Canvas, shade
from alpha5_model.viewer.framing import check_size
from alpha5_model.viewer.scene import SEE_THROUGH, Scene, Shape, Size
from alpha5_model.viewer.shapes import Mesh

Pixels = NDArray[np.uint8]
#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2


class _Item(NamedTuple):
    """A shape to draw, its mesh in the world, and its opacity in this scene."""

    shape: Shape
    mesh: Mesh
    opacity: float


def picture_png(scene: Scene, size: Size = (1600, 1000)) -> bytes:
    """The scene as a PNG file.

    Args:
        scene: What to draw.
        size: Width and height in pixels, 16 to 8000 each.
    """
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(picture(scene, size)).save(buffer, format="PNG")
    return buffer.getvalue()


def picture(scene: Scene, size: Size = (1600, 1000)) -> Pixels:
    """The scene as pixels, (height, width, 3)."""
    width, height = check_size(size)
    canvas = Canvas(scene.camera, _FINER * width, _FINER * height)
    layer = 0
    for item in _in_drawing_order(_items(scene), canvas):
        if item.shape.on_top > layer:
            layer = item.shape.on_top
            canvas.clear_depth()
        _draw(item, canvas)
    pixels = _averaged(canvas.color, width, height)
    if "labels" in scene.show:
        return annotated(pixels, scene, canvas, _FINER)
    return pixels


def _items(scene: Scene) -> list[_Item]:
    """The shapes that are shown, in the world."""
    see_through = "see-through" in scene.show
    items = []
    for shape in scene.shapes:
        if shape.group in scene.show:
            veiled = see_through and shape.group == "bodies"
            opacity = SEE_THROUGH if veiled else shape.opacity
            items.append(_Item(shape, shape.placed(scene.poses), opacity))
    return items


def _in_drawing_order(items: list[_Item], canvas: Canvas) -> list[_Item]:
    """Lower layers first; then solid ones; then bodies; then from far to near."""

    def order(item: _Item) -> tuple[float, ...]:
        transparent = item.opacity < 1.0
        distance = _mean_distance(item.mesh, canvas) if transparent else 0.0
        in_front = item.shape.group != "bodies"
        return item.shape.on_top, transparent, in_front, -distance

    return sorted(items, key=order)


def _mean_distance(mesh: Mesh, canvas: Canvas) -> float:
    ahead = canvas.project(mesh.vertices)[:, 2]
    return float(ahead.mean())


def _draw(item: _Item, canvas: Canvas) -> None:
    shape, mesh, opacity = item
    own = shape.color if mesh.colors is None else mesh.colors
    color: FloatArray = np.broadcast_to(
        np.asarray(own, np.float64), mesh.vertices.shape
    )
    if not shape.flat:
        color = shade(mesh.normals, color, canvas.axes, shape.shine)
    canvas.draw(mesh.vertices, color, mesh.faces, opacity, two_sided=shape.flat)


def _averaged(color: NDArray[np.float32], width: int, height: int) -> Pixels:
    """The means of squares of `_FINER` by `_FINER` fine pixels."""
    rows = color.reshape(height, _FINER, -1).sum(axis=1)
    squares = rows.reshape(height, width, _FINER, 3).sum(axis=2)
    pixels: Pixels = (squares * (255.0 / _FINER**2) + 0.5).astype(np.uint8)
    return pixels
