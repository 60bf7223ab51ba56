"""Labels and scale bars over a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model.viewer.canvas import Canvas
from alpha5_model.viewer.scene import ARROWS, Label, Scene

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw

#: Colour of the scale bars.
_INK = (38, 43, 51)
#: Colour behind a label, and its opacity.
_PAPER = (255, 255, 255, 205)


class _Box(NamedTuple):
    """Where a label stands, in pixels."""

    left: float
    right: float
    top: float


class _Pen:
    """Draws texts and lines over a picture.

    Attributes:
        draw: Pillow's drawing of the picture.
        font: Of all texts.
        text_height: In pixels.
        step: From one line of text to the next, in pixels.
    """

    def __init__(self, draw: ImageDraw, picture_height: int) -> None:
        from PIL import ImageFont

        self.draw = draw
        self.text_height = max(11, round(picture_height / 62))
        self.font: ImageFont.ImageFont | ImageFont.FreeTypeFont = (
            ImageFont.load_default(size=self.text_height)
        )
        self.step = 1.35 * self.text_height


def annotated(
    pixels: NDArray[np.uint8], scene: Scene, canvas: Canvas, finer: int
) -> NDArray[np.uint8]:
    """A picture with its labels and scale bars.

    Args:
        pixels: The picture, (height, width, 3).
        scene: What it shows.
        canvas: On which it was drawn.
        finer: Pixels of the canvas per pixel of the picture, along a side.
    """
    from PIL import Image, ImageDraw

    image = Image.fromarray(pixels)
    pen = _Pen(ImageDraw.Draw(image, "RGBA"), len(pixels))
    _draw_labels(pen, scene, canvas, finer)
    _draw_scale_bars(pen, scene, canvas, finer)
    return np.asarray(image)


def _draw_labels(pen: _Pen, scene: Scene, canvas: Canvas, finer: int) -> None:
    """Labels beside their points, from the top down, none over another."""
    labels = [label for label in scene.labels if label.group in scene.show]
    points = np.array([label.anchor.transform(scene.poses)[:3, 3] for label in labels])
    places = canvas.project(points.reshape(len(labels), 3))[:, :2] / finer
    boxes: list[_Box] = []
    for i in np.lexsort(places.T):
        x, y = places[i].tolist()
        left = x + 0.8 * pen.text_height
        right = left + pen.draw.textlength(labels[i].text, font=pen.font)
        top = _free_top(left, right, y - pen.step / 2, pen.step, boxes)
        box = _Box(left=left, right=right, top=top)
        boxes.append(box)
        _draw_label(pen, labels[i], box)


def _free_top(
    left: float, right: float, top: float, step: float, boxes: list[_Box]
) -> float:
    """Top of a label, moved below the labels that it would cover."""
    for other in boxes:
        if left < other.right and other.left < right and top < other.top + step:
            top = other.top + step
    return top


def _draw_label(pen: _Pen, label: Label, box: _Box) -> None:
    outline = (box.left - 4, box.top, box.right + 4, box.top + pen.step - 2)
    pen.draw.rounded_rectangle(outline, radius=4, fill=_PAPER)
    middle = (box.left, box.top + pen.step / 2 - 1)
    color = tuple(round(255 * part) for part in label.color)
    pen.draw.text(middle, label.text, fill=color, font=pen.font, anchor="lm")


def _draw_scale_bars(pen: _Pen, scene: Scene, canvas: Canvas, finer: int) -> None:
    """Scales of lengths and arrows, at the distance of the camera's target."""
    distance = float(np.linalg.norm(scene.camera.eye - scene.camera.target))
    pixels_per_metre = canvas.focal / distance / finer
    bars = _scale_bars(scene)
    bottom = canvas.height / finer
    for i, (text, length) in enumerate(bars.items()):
        start = pen.step
        end = start + length * pixels_per_metre
        y = bottom - pen.step * (len(bars) - i)
        _draw_scale_bar(pen, start, end, y)
        beside = (end + pen.step / 2, y)
        pen.draw.text(beside, text, fill=_INK, font=pen.font, anchor="lm")


def _scale_bars(scene: Scene) -> dict[str, float]:
    """Text -> length [m] of the scale bars of what is shown."""
    bars = {"100 mm": 0.1}
    if "weight" in scene.show or "buoyancy" in scene.show:
        bars["force 5 N"] = 5 * ARROWS["force"]
    if "current" in scene.show:
        bars["current 1 m/s"] = ARROWS["current"]
    return bars


def _draw_scale_bar(pen: _Pen, start: float, end: float, y: float) -> None:
    pen.draw.line((start, y, end, y), fill=_INK, width=max(2, pen.text_height // 6))
    tick = pen.step / 4
    for x in (start, end):
        pen.draw.line((x, y - tick, x, y + tick), fill=_INK, width=2)
