"""A picture of a scene as PNG, by a small software renderer: triangles to pixels with NumPy.

It needs no graphics card, browser or window system, and gives the same pixels everywhere.
"""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from alpha5_model._support.checks import FloatArray, real
from alpha5_model._support.files import PathLike, atomic_write, output_format
from alpha5_model.errors import InputError, needing
from alpha5_model.viewer.scene import (
    ARROWS,
    SEE_THROUGH,
    Camera,
    Scene,
    Shape,
    check_size,
)
from alpha5_model.viewer.shapes import Mesh

VIDEO_FORMATS = (".mp4", ".gif")
IntArray = NDArray[np.int64]
Pixels = NDArray[np.uint8]
#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2
#: Pixels processed at once.
_BLOCK = 1 << 21
_INK = (38, 43, 51)
#: Least distance from an edge that counts, in pixels, and twice the least area of a triangle.
_EDGE, _SLIVER = 1e-7, 1e-9
#: Towards the lights, in the camera's axes (right, up, backwards), and their strengths.
_LIGHTS, _STRENGTHS = (
    np.array([[-0.35, 0.75, 0.56], [0.85, 0.1, 0.52]]),
    np.array([0.80, 0.45]),
)
_AMBIENT = 0.68


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


def picture(scene: Scene, size: tuple[int, int] = (1600, 1000)) -> Pixels:
    """The scene as pixels, (height, width, 3)."""
    width, height = check_size(size)
    canvas, layer = Canvas(scene.camera, _FINER * width, _FINER * height), 0
    veiled = "bodies" if "see-through" in scene.show else None
    there, poses = [s for s in scene.shapes if s.group in scene.show], scene.poses
    shown = [
        (s, s.placed(poses), SEE_THROUGH if s.group == veiled else s.opacity)
        for s in there
    ]

    def order(entry: tuple[Shape, Mesh, float]) -> tuple[float, ...]:
        """Layers on top last; bodies before the rest of what is seen through, from far to near."""
        shape, mesh, opacity = entry
        distance = (
            float(canvas.project(mesh.vertices)[:, 2].mean()) if opacity < 1.0 else 0.0
        )
        return shape.on_top, opacity < 1.0, shape.group != "bodies", -distance

    for shape, mesh, opacity in sorted(shown, key=order):
        if shape.on_top > layer:
            layer = shape.on_top
            canvas.clear_depth()
        own = shape.color if mesh.colors is None else mesh.colors
        color = np.broadcast_to(np.asarray(own, np.float64), mesh.vertices.shape)
        if not shape.flat:
            color = shade(mesh.normals, color, canvas.axes, shape.shine)
        canvas.draw(mesh.vertices, color, mesh.faces, opacity, two_sided=shape.flat)
    rows = canvas.color.reshape(height, _FINER, -1).sum(axis=1)
    fine = rows.reshape(height, width, _FINER, 3).sum(axis=2)
    pixels: Pixels = (fine * (255.0 / _FINER**2) + 0.5).astype(np.uint8)
    return _labelled(pixels, canvas, scene) if "labels" in scene.show else pixels


@contextmanager
def video(
    path: PathLike, fps: float
) -> Iterator[tuple[float, Callable[[Pixels], None]]]:
    """Frames per second, and a function that adds pictures to a video; it is there whole, or not at all.

    Args:
        path: ``.mp4`` (H.264) or ``.gif``.
        fps: Frames per second; GIF counts hundredths of a second and takes the nearest.

    Raises:
        UnknownNameError, InputError: Another suffix; a rate or number of frames that makes no video.
        MissingDependencyError: imageio or imageio-ffmpeg is not installed.
        OutputError: It cannot be written.
    """
    gif = output_format("video format", path, VIDEO_FORMATS) == ".gif"
    rate = real("fps", fps, minimum=1.0)
    rate = 100 / max(1, round(100 / rate)) if gif else rate
    # Of the whole, H.264 takes even sizes only.
    form: Any = (
        {"duration": 1e3 / rate, "loop": 0}
        if gif
        else {"fps": rate, "macro_block_size": 2}
    )
    with needing("a video", "pip install 'alpha5-model[video]'"):
        import imageio_ffmpeg  # noqa: F401 (what imageio writes MP4 with)
        from imageio.v2 import get_writer
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder, "video").with_suffix(".gif" if gif else ".mp4")
        with get_writer(whole, **form) as writer:
            yield rate, writer.append_data  # type: ignore[attr-defined]
        if not whole.exists():
            raise InputError("video", str(path), "at least one frame: play a motion")
        atomic_write(path, whole.read_bytes())


def _labelled(pixels: Pixels, canvas: Canvas, scene: Scene) -> Pixels:
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
                top = other_top + step
        placed.append((left, right, top))
        box = (left - 4, top, right + 4, top + step - 2)
        draw.rounded_rectangle(box, radius=4, fill=(255, 255, 255, 205))
        color = tuple(round(255 * c) for c in label.color)
        draw.text(
            (left, top + step / 2 - 1), label.text, fill=color, font=font, anchor="lm"
        )
    # How long things are, at the distance of the point that is looked at.
    size = (
        canvas.focal
        / float(np.linalg.norm(scene.camera.eye - scene.camera.target))
        / _FINER
    )
    bars = {"100 mm": 0.1}
    if {"weight", "buoyancy"} & {*scene.show}:
        bars["force 5 N"] = 5 * ARROWS["force"]
    if "current" in scene.show:
        bars["current 1 m/s"] = ARROWS["current"]
    for row, (text, length) in enumerate(bars.items()):
        x, y = step, canvas.height / _FINER - step * (len(bars) - row)
        draw.line(
            (x, y, x + length * size, y), fill=_INK, width=max(2, text_height // 6)
        )
        for end in (x, x + length * size):
            draw.line((end, y - step / 4, end, y + step / 4), fill=_INK, width=2)
        draw.text(
            (x + length * size + step / 2, y), text, fill=_INK, font=font, anchor="lm"
        )
    return np.asarray(image)


class Canvas:
    """Pixels seen through a camera, with a depth for each.

    Args:
        camera: Where it is seen from.
        width, height: In pixels.
    """

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._camera, self.axes = camera, camera.axes()
        self.focal = height / 2 / np.tan(np.deg2rad(camera.field_of_view) / 2)
        backdrop = np.linspace(
            (1.0, 1.0, 1.0), (0.80, 0.86, 0.90), height, dtype=np.float32
        )
        self.color = np.repeat(backdrop, width, axis=0)
        self._depth = np.full(width * height, np.inf, dtype=np.float32)

    def project(self, points: FloatArray) -> FloatArray:
        """Points (N, 3) in the world to (N, 3): pixel column, pixel row, distance ahead [m]."""
        local = (points - self._camera.eye) @ self.axes.T
        ahead = -local[:, 2]
        scale = self.focal / ahead
        column, row = (
            self.width / 2 + local[:, 0] * scale,
            self.height / 2 - local[:, 1] * scale,
        )
        return np.stack([column, row, ahead], axis=1)

    def clear_depth(self) -> None:
        """Let what follows be drawn over everything so far."""
        self._depth[:] = np.inf

    def draw(
        self,
        points: FloatArray,
        colors: FloatArray,
        faces: NDArray[np.uint32],
        opacity: float = 1.0,
        two_sided: bool = False,
    ) -> None:
        """Draw triangles.

        Args:
            points: Corners in the world, (V, 3) [m].
            colors: Of the corners, (V, 3), 0 to 1.
            faces: (F, 3).
            opacity: Below 1 the background shines through, once, however many layers there are.
            two_sided: Whether triangles are seen from behind too.
        """
        screen = self.project(points)
        top, bottom = _spans(screen[:, 1].min(), screen[:, 1].max(), self.height)
        part = slice(int(top) * self.width, max(int(top), int(bottom)) * self.width)
        depth, layer = self._depth[part], self.color[part]
        if opacity < 1.0:
            depth, layer = depth.copy(), layer.copy()
        for pixel, distance, corner, weight in self._fragments(
            screen, faces, two_sided
        ):
            at = pixel - part.start
            np.minimum.at(depth, at, distance)
            seen = depth[at] == distance
            layer[at[seen]] = np.einsum(
                "kn,nkc->nc", weight[:, seen], colors[corner[seen]]
            )
        if opacity < 1.0:
            self.color[part] += (layer - self.color[part]) * np.float32(opacity)

    def _fragments(
        self, screen: FloatArray, faces: NDArray[np.uint32], two_sided: bool
    ) -> Iterator[tuple[IntArray, FloatArray, NDArray[np.uint32], FloatArray]]:
        """Pixels inside the triangles: index, distance, corners (N, 3) and their weights (3, N)."""
        corners = screen[faces]
        affine = np.concatenate(
            [corners[..., :2], np.ones_like(corners[..., :1])], axis=2
        )
        area = np.linalg.det(affine)
        # Rows grow downwards: a triangle seen from outside has a negative area.
        wanted = (np.abs(area) if two_sided else -area) > _SLIVER
        wanted &= corners[..., 2].min(axis=1) > 0.0
        faces, corners = faces[wanted], corners[wanted]
        # The weight of a corner grows evenly over the screen: by x, by y, and from what at (0, 0).
        by_x, by_y, still = np.linalg.inv(affine[wanted]).swapaxes(0, 1)
        nearness = 1.0 / corners[..., 2]
        # Every row of pixels that a triangle crosses, and what it covers of it.
        low, high = _spans(
            corners[..., 1].min(axis=1), corners[..., 1].max(axis=1), self.height
        )
        t, row = _counted(low, high)
        rest = still[t] + by_y[t] * (row + 0.5)[:, None]
        slope = by_x[t]
        with np.errstate(divide="ignore", invalid="ignore"):
            edge = -rest / slope
        left = np.where(slope > 0.0, edge, -np.inf).max(axis=1)
        right = np.where(slope < 0.0, edge, np.inf).min(axis=1)
        outside = ((slope == 0.0) & (rest < -1e-9)).any(axis=1)
        first, last = _spans(left, np.where(outside, -np.inf, right), self.width)
        blocks = np.cumsum(np.maximum(last - first, 0)) // _BLOCK
        for block in np.unique(blocks):
            line = np.flatnonzero(blocks == block)
            span, column = _counted(first[line], last[line])
            span = line[span]
            x = column + 0.5
            weight = np.stack([rest[span, k] + slope[span, k] * x for k in range(3)])
            # 1/distance is linear on the screen
            inverse = sum(weight[k] * nearness[t[span], k] for k in range(3))
            distance = (1.0 / inverse).astype(np.float32)
            yield (row[span] * self.width + column, distance, faces[t[span]], weight)


def _spans(low: ArrayLike, high: ArrayLike, limit: int) -> tuple[IntArray, IntArray]:
    """First pixel whose centre is at or beyond ``low``, and first beyond ``high``, 0 to limit."""
    # A centre on a shared edge belongs to both sides, however it is rounded.
    first, last = (
        np.ceil(np.subtract(low, 0.5 + _EDGE)),
        np.floor(np.add(high, 0.5 + _EDGE)),
    )
    return np.clip(first, 0, limit).astype(np.int64), np.clip(last, 0, limit).astype(
        np.int64
    )


def _counted(first: IntArray, last: IntArray) -> tuple[IntArray, IntArray]:
    """Every number from first (N,) up to last, each with the index of its range."""
    size = np.maximum(last - first, 0)
    which = np.repeat(np.arange(len(size)), size)
    return which, np.arange(len(which)) + np.repeat(
        first - np.cumsum(size) + size, size
    )


def shade(
    normals: FloatArray, colors: FloatArray, axes: FloatArray, shine: float
) -> FloatArray:
    """Colours (N, 3) of lit surfaces: ambient, diffuse and a highlight after Blinn and Phong.

    Args:
        normals: Unit, in the world, (N, 3).
        colors: Of the surface, (N, 3).
        axes: The camera's axes in rows.
        shine: Strength of the highlight, 0 to 1.
    """
    towards = _LIGHTS / np.linalg.norm(_LIGHTS, axis=1, keepdims=True)
    halfway = np.add(towards, (0.0, 0.0, 1.0))
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    light, facing = (
        np.maximum(normals @ axes.T @ v.T, 0.0) for v in (towards, halfway)
    )
    lit = colors * (_AMBIENT + light @ _STRENGTHS)[:, None]
    return np.asarray(
        np.clip(lit + 0.5 * shine * (facing**24 @ _STRENGTHS)[:, None], 0.0, 1.0)
    )
