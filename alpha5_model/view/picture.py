"""A picture of a scene as PNG, without a screen."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from alpha5_model.view.framing import check_size
from alpha5_model.view.raster import Canvas, shade
from alpha5_model.view.scene import SEE_THROUGH, Scene, Shape
from alpha5_model.view.shapes import Mesh

#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2


def picture_png(scene: Scene, size: tuple[int, int] = (1600, 1000)) -> bytes:
    """The scene as a PNG file.

    Args:
        scene: What to draw.
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
    layer = 0
    for shape, mesh, opacity in _in_order(canvas, scene):
        if shape.on_top > layer:
            layer = shape.on_top
            canvas.clear_depth()
        own = shape.color if mesh.colors is None else mesh.colors
        color = np.broadcast_to(np.asarray(own, np.float64), mesh.vertices.shape)
        if not shape.flat:
            color = shade(mesh.normals, color, canvas.axes, shape.shine)
        canvas.draw(mesh.vertices, color, mesh.faces, opacity, two_sided=shape.flat)
    fine = canvas.color.reshape(height, _FINER, width, _FINER, 3).mean(axis=(1, 3))
    pixels: NDArray[np.uint8] = np.clip(fine * 255.0 + 0.5, 0, 255).astype(np.uint8)
    return _labelled(pixels, canvas, scene) if "labels" in scene.show else pixels


def _in_order(canvas: Canvas, scene: Scene) -> list[tuple[Shape, Mesh, float]]:
    """What is shown, in the world, with its opacity.

    Solid things first, then what is seen through, bodies before the rest, from far to near; layers on top last.
    """
    found = []
    for shape in scene.shapes:
        if shape.group not in scene.show:
            continue
        mesh = shape.placed(scene.poses)
        veiled = shape.group == "bodies" and "see-through" in scene.show
        opacity = SEE_THROUGH if veiled else shape.opacity
        distance = float(canvas.project(mesh.vertices)[:, 2].mean()) if opacity < 1.0 else 0.0
        key = (shape.on_top, opacity < 1.0, shape.group != "bodies", -distance)
        found.append((key, (shape, mesh, opacity)))
    return [entry for _, entry in sorted(found, key=lambda item: item[0])]


def _labelled(pixels: NDArray[np.uint8], canvas: Canvas, scene: Scene) -> NDArray[np.uint8]:
    """Labels beside their points, from the top down, each below those that it would cover."""
    from PIL import Image, ImageDraw, ImageFont

    text_height = max(11, round(len(pixels) / 62))
    font = ImageFont.load_default(size=text_height)
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image, "RGBA")
    placed: list[tuple[float, float, float]] = []
    step = 1.35 * text_height
    labels = [label for label in scene.labels if label.group in scene.show]
    points = np.array([label.anchor.transform(scene.poses)[:3, 3] for label in labels])
    at = canvas.project(points.reshape(-1, 3))[:, :2] / _FINER
    for i in np.lexsort(at.T):
        label, (x, y) = labels[i], at[i].tolist()
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
