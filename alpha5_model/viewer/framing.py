"""Where to put the camera so that a whole scene is in the picture."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.viewer.scene import VIEWS, Camera, Poses, Scene, Size

#: Share of the picture's height that is used.
_USED_HEIGHT = 0.86
#: Share of the picture's width that is used, times `_USED_HEIGHT`.
_USED_WIDTH = 0.95
#: Steps in which the camera is centred.
_STEPS = 4


def framed(
    scene: Scene,
    size: Size = (1150, 950),
    view: str = "home",
    also: Iterable[Poses] = (),
) -> Scene:
    """The scene with the nearest camera that sees all that is shown, but for obstacles.

    Args:
        scene: The scene.
        size: Of the picture, in pixels; by default the free area of a page.
        view: One of `VIEWS`.
        also: Further poses of the links, as in a motion, which the camera sees too.
    """
    check_size(size)
    points = _corners(scene, (scene.poses, *also))
    direction = VIEWS[view] / np.linalg.norm(VIEWS[view])
    aspect = _USED_WIDTH * size[0] / size[1]
    return replace(scene, camera=_nearest_camera(points, direction, aspect))


def check_size(size: Size) -> Size:
    """Check width and height of a picture, 16 to 8000 pixels each.

    Raises:
        InputError: Anything else.
    """
    if len(size) != 2 or not all(isinstance(n, int) and 16 <= n <= 8000 for n in size):
        raise InputError("size", size, "width and height from 16 to 8000 pixels")
    return size


def _corners(scene: Scene, places: Iterable[Poses]) -> FloatArray:
    """Corners (N, 3) of the bodies and of what is shown, at several poses."""
    # The sea bed is too wide to be seen whole.
    seen = {"bodies", *scene.show} - {"obstacles"}
    shapes = [shape for shape in scene.shapes if shape.group in seen]
    corners: list[FloatArray] = []
    for poses in places:
        corners += [shape.placed(poses).vertices for shape in shapes]
    return np.concatenate(corners)


def _nearest_camera(points: FloatArray, direction: FloatArray, aspect: float) -> Camera:
    """The nearest camera in a direction that has all points in its picture.

    Args:
        points: (N, 3) [m].
        direction: From the points to the camera, of unit length, (3,).
        aspect: Usable width of the picture per usable height.
    """
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    camera = Camera(eye=center + direction, target=center)
    axes = camera.axes()
    tangent_of_half_height = _USED_HEIGHT * np.tan(np.deg2rad(camera.field_of_view) / 2)
    # Near points look larger, so the middle of the points in space is not their middle
    # in the picture. It is corrected in steps.
    for _ in range(_STEPS):
        right, up, back = ((points - center) @ axes.T).T
        half_height = np.maximum(np.abs(up), np.abs(right) / aspect)
        distance = float(np.max(back + half_height / tangent_of_half_height))
        ahead = distance - back
        for coordinate, axis in ((right, axes[0]), (up, axes[1])):
            tangent = coordinate / ahead
            middle = (tangent.max() + tangent.min()) / 2
            center = center + middle * distance * axis
    return Camera(eye=center + distance * direction, target=center)
