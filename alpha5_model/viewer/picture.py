"""A picture of a scene, drawn without a graphics card, browser or window system.

The pixels are the same everywhere.
"""

from __future__ import annotations

import io
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.viewer.annotations import annotated
from alpha5_model.viewer.canvas import Canvas, Window, backdrop, project, shade
from alpha5_model.viewer.framing import check_size
from alpha5_model.viewer.scene import SEE_THROUGH, Camera, Scene, Shape, Size
from alpha5_model.viewer.shapes import Mesh

Pixels = NDArray[np.uint8]
#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2


class _Item(NamedTuple):
    """A shape to draw, its mesh in the world, and its opacity in this scene."""

    shape: Shape
    mesh: Mesh
    opacity: float


def picture_png(scene: Scene, size: Size) -> bytes:
    """The scene as a PNG file.

    Args:
        scene: What to draw.
        size: Width and height in pixels, 16 to 8000 each.
    """
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(picture(scene, size)).save(buffer, format="PNG")
    return buffer.getvalue()


def picture(scene: Scene, size: Size) -> Pixels:
    """The scene as pixels, (height, width, 3)."""
    width, height = check_size(size)
    items = _items(scene)
    canvas = _canvas(scene.camera, items, _FINER * width, _FINER * height)
    layer = 0
    for alike in _batches(_in_drawing_order(items, canvas)):
        if alike[0].shape.on_top > layer:
            layer = alike[0].shape.on_top
            canvas.clear_depth()
        _draw(alike, canvas)
    pixels = _averaged(canvas)
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


def _canvas(camera: Camera, items: list[_Item], width: int, height: int) -> Canvas:
    """An empty canvas; only the part in which the items are can be drawn into."""
    if not items:
        return Canvas(camera, width, height)
    vertices = np.concatenate([item.mesh.vertices for item in items])
    points = project(camera, width, height, vertices)
    if points[:, 2].min() <= 0.0:
        return Canvas(camera, width, height)

    # A pixel of the picture is in the window with all of its fine pixels.
    limits = (width, height)
    low = np.floor(points[:, :2].min(axis=0) / _FINER) * _FINER
    high = np.ceil(points[:, :2].max(axis=0) / _FINER) * _FINER
    left, top = np.clip(low, 0, limits).astype(int).tolist()
    right, bottom = np.clip(high, 0, limits).astype(int).tolist()
    window = Window(left=left, top=top, right=right, bottom=bottom)
    return Canvas(camera, width, height, window)


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


def _batches(items: list[_Item]) -> list[list[_Item]]:
    """Items in their order; those that may be drawn at once are together."""
    batches: list[list[_Item]] = []
    kinds = [_kind(item) for item in items]
    for number, item in enumerate(items):
        solid = item.opacity == 1.0
        if solid and number and kinds[number] == kinds[number - 1]:
            batches[-1].append(item)
        else:
            batches.append([item])
    return batches


def _kind(item: _Item) -> tuple[float, ...]:
    return item.shape.on_top, item.opacity, item.shape.flat


def _draw(items: list[_Item], canvas: Canvas) -> None:
    """Draw items that differ in their meshes and colours only."""
    sizes = [len(item.mesh.vertices) for item in items]
    firsts = np.cumsum([0, *sizes[:-1]])
    faces = [item.mesh.faces + first for item, first in zip(items, firsts, strict=True)]
    canvas.draw(
        np.concatenate([item.mesh.vertices for item in items]),
        np.concatenate([_colors(item, canvas) for item in items]),
        np.concatenate(faces),
        opacity=items[0].opacity,
        two_sided=items[0].shape.flat,
    )


def _colors(item: _Item, canvas: Canvas) -> FloatArray:
    """Colours of the corners of a mesh, lit unless it is flat, (V, 3)."""
    shape, mesh, _ = item
    own = shape.color if mesh.colors is None else mesh.colors
    color: FloatArray = np.broadcast_to(
        np.asarray(own, np.float64), mesh.vertices.shape
    )
    if shape.flat:
        return color
    return shade(mesh.normals, color, canvas.axes, shape.shine)


def _averaged(canvas: Canvas) -> Pixels:
    """The means of squares of `_FINER` by `_FINER` fine pixels, (height, width, 3)."""
    behind = np.repeat(backdrop(canvas.height), _FINER, axis=0)
    column = _mean_colors(behind.reshape(canvas.height, _FINER, 3))
    shape = (canvas.height // _FINER, canvas.width // _FINER, 3)
    pixels = np.broadcast_to(column, shape).copy()

    left, top, right, bottom = canvas.window
    drawn = canvas.color.reshape(bottom - top, right - left, 3)
    rows = slice(top // _FINER, bottom // _FINER)
    columns = slice(left // _FINER, right // _FINER)
    pixels[rows, columns] = _mean_colors(drawn)
    return pixels


def _mean_colors(fine: NDArray[np.float32]) -> Pixels:
    """Means of squares of fine pixels (h, w, 3), as bytes."""
    rows = reduce(np.add, [fine[k::_FINER] for k in range(_FINER)])
    squares = reduce(np.add, [rows[:, k::_FINER] for k in range(_FINER)])
    squares *= np.float32(255.0 / _FINER**2)
    squares += np.float32(0.5)
    pixels: Pixels = squares.astype(np.uint8)
    return pixels
