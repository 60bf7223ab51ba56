"""A picture of a scene as PNG, without a screen."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from alpha5_model.view.framing import check_size
from alpha5_model.view.raster import Canvas, shade
from alpha5_model.view.scene import SEE_THROUGH, Label, Scene, Shape

#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2


def picture_png(scene: Scene, size: tuple[int, int] = (1600, 1000)) -> bytes:
    """The scene as a PNG file.

    Args:
        scene: What to see.
        size: Width and height in pixels, 16 to 8000 each.
    """
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(picture(scene, size)).save(buffer, format="PNG")
    return buffer.getvalue()


def picture(scene: Scene, size: tuple[int, int] = (1600, 1000)) -> NDArray[np.uint8]:
    """The scene as pixels, (height, width, 3)."""
    width, height = check_size(size)
    canvas = Canvas(scene.camera, _FINER * width, _FINER * height)
    shown = [shape for shape in scene.shapes if shape.group in scene.show]
    see_through = "see-through" in scene.show
    solid = [s for s in shown if s.opacity == 1.0 and not s.on_top]
    if see_through:
        solid = [s for s in solid if s.group != "bodies"]
    for shape in solid:
        _draw(canvas, scene, shape, 1.0)
    if see_through:
        for shape in _far_to_near(canvas, scene, [s for s in shown if s.group == "bodies"]):
            _draw(canvas, scene, shape, SEE_THROUGH)
    for shape in _far_to_near(canvas, scene, [s for s in shown if s.opacity < 1.0]):
        _draw(canvas, scene, shape, shape.opacity)
    for layer in sorted({s.on_top for s in shown} - {0}):
        canvas.clear_depth()
        for shape in shown:
            if shape.on_top == layer:
                _draw(canvas, scene, shape, 1.0)
    fine = canvas.color.reshape(height, _FINER, width, _FINER, 3).mean(axis=(1, 3))
    pixels: NDArray[np.uint8] = np.clip(fine * 255.0 + 0.5, 0, 255).astype(np.uint8)
    if "labels" not in scene.show:
        return pixels
    labels = [label for label in scene.labels if label.group in scene.show]
    return _write(pixels, canvas, scene, labels)


def _draw(canvas: Canvas, scene: Scene, shape: Shape, opacity: float) -> None:
    mesh = shape.mesh.moved(shape.anchor.transform(scene.poses))
    colors = np.tile(shape.color, (len(mesh.vertices), 1)) if mesh.colors is None else mesh.colors
    if not shape.flat:
        colors = shade(mesh.normals, colors, canvas.axes, shape.shine)
    canvas.draw(mesh.vertices, colors, mesh.faces, opacity, two_sided=shape.flat)


def _far_to_near(canvas: Canvas, scene: Scene, shapes: Sequence[Shape]) -> list[Shape]:
    def distance(shape: Shape) -> float:
        points = shape.mesh.moved(shape.anchor.transform(scene.poses)).vertices
        return float(canvas.project(points)[:, 2].mean())

    return sorted(shapes, key=distance, reverse=True)


def _write(
    pixels: NDArray[np.uint8], canvas: Canvas, scene: Scene, labels: Sequence[Label]
) -> NDArray[np.uint8]:
    from PIL import Image, ImageDraw, ImageFont

    text_height = max(11, round(len(pixels) / 62))
    font = ImageFont.load_default(size=text_height)
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image, "RGBA")
    placed: list[tuple[float, float, float]] = []
    step = 1.35 * text_height

    def where(label: Label) -> tuple[float, float]:
        x, y, _ = canvas.project(label.anchor.transform(scene.poses)[None, :3, 3])[0] / _FINER
        return float(y), float(x)

    for (y, x), label in sorted(((where(label), label) for label in labels), key=lambda e: e[0]):
        left, top = x + 0.8 * text_height, y - step / 2
        right = left + draw.textlength(label.text, font=font)
        for other_left, other_right, other_top in placed:
            if left < other_right and other_left < right and top < other_top + step:
                top = max(top, other_top + step)
        placed.append((left, right, top))
        box = (left - 4, top, right + 4, top + step - 2)
        draw.rounded_rectangle(box, radius=4, fill=(255, 255, 255, 205))
        color = tuple(round(255 * c) for c in label.color)
        draw.text((left, top + step / 2 - 1), label.text, fill=color, font=font, anchor="lm")
    return np.asarray(image)
