"""A picture of a scene as PNG, by a small software renderer: triangles to pixels with NumPy.

It needs no graphics card, browser or window system, and gives the same pixels everywhere.
"""

from __future__ import annotations

import io
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import FloatArray
from alpha5_model.view.scene import SEE_THROUGH, Camera, Scene, Shape, check_size
from alpha5_model.view.shapes import Mesh

#: Drawn this much finer, then averaged, so that edges are smooth.
_FINER = 2
#: Pixels processed at once.
_BLOCK = 1 << 21
#: Towards the lights, in the camera's axes (right, up, backwards), and their strengths.
_LIGHTS = ((np.array([-0.35, 0.75, 0.56]), 0.80), (np.array([0.85, 0.1, 0.52]), 0.45))
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

    Opaque shapes first, then transparent ones, bodies before the rest, from far to near; layers on
    top last.
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
                top = other_top + step
        placed.append((left, right, top))
        box = (left - 4, top, right + 4, top + step - 2)
        draw.rounded_rectangle(box, radius=4, fill=(255, 255, 255, 205))
        color = tuple(round(255 * c) for c in label.color)
        draw.text((left, top + step / 2 - 1), label.text, fill=color, font=font, anchor="lm")
    return np.asarray(image)


class Canvas:
    """Pixels seen through a camera, with a depth for each.

    Args:
        camera: Where it is seen from.
        width, height: In pixels.
    """

    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._camera = camera
        self.axes = camera.axes()
        self._focal = height / 2 / np.tan(np.deg2rad(camera.field_of_view) / 2)
        self.color = _backdrop(width, height)
        self._depth = np.full(width * height, np.inf, dtype=np.float32)

    def project(self, points: FloatArray) -> FloatArray:
        """Points (N, 3) in the world to (N, 3): pixel column, pixel row, distance ahead [m]."""
        local = (points - self._camera.eye) @ self.axes.T
        ahead = -local[:, 2]
        scale = self._focal / ahead
        column, row = self.width / 2 + local[:, 0] * scale, self.height / 2 - local[:, 1] * scale
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
        depth = self._depth if opacity == 1.0 else self._depth.copy()
        layer = self.color if opacity == 1.0 else self.color.copy()
        for pixel, distance, corner, weight in self._fragments(screen, faces, two_sided):
            np.minimum.at(depth, pixel, distance)
            seen = depth[pixel] == distance
            mixed = np.einsum("nk,nkc->nc", weight[seen], colors[corner[seen]])
            layer[pixel[seen]] = mixed
        if opacity < 1.0:
            self.color += (layer - self.color) * np.float32(opacity)

    def _fragments(
        self, screen: FloatArray, faces: NDArray[np.uint32], two_sided: bool
    ) -> Iterator[tuple[NDArray[np.intp], FloatArray, NDArray[np.uint32], FloatArray]]:
        """Pixels inside the triangles: index, distance, corners (N, 3) and their weights (N, 3)."""
        a, b, c = (screen[faces[:, k]] for k in range(3))
        area = _cross(b - a, c - a)
        # Rows grow downwards: a triangle seen from outside has a negative area.
        wanted = (area != 0.0) if two_sided else (area < 0.0)
        wanted &= np.minimum(np.minimum(a[:, 2], b[:, 2]), c[:, 2]) > 0.0
        corners = np.stack([a, b, c], axis=1)[..., :2]
        limit = np.array([self.width, self.height])
        low = np.clip(np.ceil(corners.min(axis=1) - 0.5), 0, limit).astype(np.int64)
        high = np.clip(np.floor(corners.max(axis=1) + 0.5), 0, limit).astype(np.int64)
        size = np.maximum(high - low, 0)
        count = np.where(wanted, size[:, 0] * size[:, 1], 0)
        which = np.flatnonzero(count)
        blocks = np.cumsum(count[which]) // _BLOCK
        for block in np.unique(blocks):
            triangles = which[blocks == block]
            repeat = count[triangles]
            t = np.repeat(triangles, repeat)
            k = np.arange(len(t)) - np.repeat(np.cumsum(repeat) - repeat, repeat)
            column, row = low[t, 0] + k % size[t, 0], low[t, 1] + k // size[t, 0]
            p = np.stack([column + 0.5, row + 0.5], axis=1)
            wa = _cross(b[t, :2] - p, c[t, :2] - p) / area[t]
            wb = _cross(c[t, :2] - p, a[t, :2] - p) / area[t]
            wc = 1.0 - wa - wb
            # A pixel centre on a shared edge belongs to both sides, however it is rounded.
            inside = np.minimum(np.minimum(wa, wb), wc) >= -1e-9
            t, wa, wb, wc = t[inside], wa[inside], wb[inside], wc[inside]
            weight = np.stack([wa, wb, wc], axis=1)
            # 1/distance is linear on the screen
            inverse = wa / a[t, 2] + wb / b[t, 2] + wc / c[t, 2]
            distance = (1.0 / inverse).astype(np.float32)
            yield (row[inside] * self.width + column[inside], distance, faces[t], weight)


def shade(normals: FloatArray, colors: FloatArray, axes: FloatArray, shine: float) -> FloatArray:
    """Colours (N, 3) of lit surfaces: ambient, diffuse and a highlight after Blinn and Phong.

    Args:
        normals: Unit, in the world, (N, 3).
        colors: Of the surface, (N, 3).
        axes: The camera's axes in rows.
        shine: Strength of the highlight, 0 to 1.
    """
    seen = normals @ axes.T
    light = np.full(len(seen), _AMBIENT)
    highlight = np.zeros(len(seen))
    for towards, strength in _LIGHTS:
        direction = towards / np.linalg.norm(towards)
        light += strength * np.maximum(seen @ direction, 0.0)
        halfway = direction + np.array([0.0, 0.0, 1.0])
        facing = np.maximum(seen @ (halfway / np.linalg.norm(halfway)), 0.0)
        highlight += strength * facing**24
    out: FloatArray = np.clip(colors * light[:, None] + 0.5 * shine * highlight[:, None], 0.0, 1.0)
    return out


def _backdrop(width: int, height: int) -> NDArray[np.float32]:
    down = np.linspace(0.0, 1.0, height)[:, None]
    column = (1.0 - down) * np.array([1.0, 1.0, 1.0]) + down * np.array([0.80, 0.86, 0.90])
    return np.repeat(column[:, None, :], width, axis=1).reshape(-1, 3).astype(np.float32)


def _cross(u: FloatArray, v: FloatArray) -> FloatArray:
    out: FloatArray = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
    return out
