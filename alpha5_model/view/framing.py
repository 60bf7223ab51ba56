"""Where the camera stands so that all that is shown fits the frame."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.view.scene import Camera, Scene, Shape

#: Direction from which the arm is seen: the side on which Figure 1 shows it, a little from above.
_SIGHT = np.array([0.35, -1.0, 0.42])
#: Share of the frame's half-width and half-height that is used.
_MARGIN = 0.86


def framing(
    shapes: Iterable[Shape],
    poses: Mapping[str, FloatArray],
    show: Collection[str],
    aspect: float = 1.15,
) -> Camera:
    """The nearest camera that sees every corner of the bodies and of what is shown.

    Args:
        shapes: What there is.
        poses: Pose of every link, (4, 4).
        show: Groups that are shown; the bodies count in any case.
        aspect: Width over height of the part of the frame that may be used.
    """
    seen = [shape.placed(poses) for shape in shapes if shape.group in {"bodies", *show}]
    points = np.concatenate([mesh.vertices for mesh in seen])
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    camera = Camera(center + _SIGHT, center)
    half = _MARGIN * np.tan(np.deg2rad(camera.field_of_view) / 2)
    distance = 0.0
    # The middle of the corners in space is not their middle in the picture: move it there.
    for _ in range(4):
        right, up, back = ((points - center) @ camera.axes().T).T
        distance = float(np.max(back + np.maximum(np.abs(up), np.abs(right) / aspect) / half))
        ahead = distance - back
        for coordinate, axis in ((right, camera.axes()[0]), (up, camera.axes()[1])):
            tangent = coordinate / ahead
            center = center + (tangent.max() + tangent.min()) / 2 * distance * axis
    return Camera(center + distance * _SIGHT / np.linalg.norm(_SIGHT), center)


def check_size(size: tuple[int, int]) -> tuple[int, int]:
    """Check width and height of a picture, 16 to 8000 pixels each.

    Raises:
        InputError: Anything else.
    """
    if len(size) != 2 or not all(isinstance(n, int) and 16 <= n <= 8000 for n in size):
        raise InputError("size", size, "width and height from 16 to 8000 pixels")
    return size


def framed(scene: Scene, size: tuple[int, int]) -> Scene:
    """A scene whose camera fits a picture of this size."""
    check_size(size)
    camera = framing(scene.shapes, scene.poses, scene.show, 0.95 * size[0] / size[1])
    return replace(scene, camera=camera)
