"""A small picture of each kind of thing, beside the committed ``snapshots/pixels.png``.

After a change that you meant, run ``ALPHA5_UPDATE_PRINTED=1 python -m pytest
tests/viewer/test_view_pixels.py`` and look at both.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import alpha5_model as a5
from alpha5_model.viewer import picture as pictures
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.canvas import Canvas
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.picture import picture
from alpha5_model.viewer.scene import GROUPS, Camera, Payload

COMMITTED = Path(__file__).parent / "snapshots" / "pixels.png"
SIZE = (180, 150)
#: What is shown in each column. Texts are left out, which other releases of Pillow set
#: otherwise.
COLUMNS = (
    ("bodies",),
    ("bodies", "see-through", "frames", "com", "cob", "weight", "buoyancy"),
    ("workspace", "surface", "collision", "ghosts", "payload", "current"),
)


CAMERAS = {
    "far": Camera(np.array([0.3, -4.0, 0.5]), np.zeros(3)),
    "near, beyond all edges": Camera(np.array([0.1, -0.3, 0.1]), np.zeros(3), 20.0),
    "right and down": Camera(np.array([0.0, -1.5, 0.0]), np.array([-0.3, 0.0, 0.3])),
    "left and up": Camera(np.array([0.0, -1.5, 0.0]), np.array([0.4, 0.0, -0.3])),
    "past the arm": Camera(np.array([0.0, -1.5, 0.0]), np.array([2.0, 0.5, 0.1])),
}


@pytest.mark.parametrize("view", CAMERAS)
def test_only_where_the_arm_is_is_drawn_and_nothing_is_missing(
    view: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    size = (64, 40)
    scene = replace(build_scene(a5.load()), camera=CAMERAS[view], show=("bodies",))
    found = picture(scene, size)
    part = pictures._canvas(scene.camera, pictures._items(scene), 128, 80)
    assert len(part.color) < 128 * 80 or view == "near, beyond all edges"

    def whole(camera: Camera, items: object, width: int, height: int) -> Canvas:
        return Canvas(camera, width, height)

    monkeypatch.setattr(pictures, "_canvas", whole)
    np.testing.assert_array_equal(found, picture(scene, size))


def test_a_picture_of_nothing_is_its_ground() -> None:
    """White at the top and light blue at the bottom, the same in each column."""
    scene = replace(build_scene(a5.load()), show=())
    pixels = picture(scene, (24, 16)).astype(int)
    assert pixels.shape == (16, 24, 3)
    assert (pixels == pixels[:, :1]).all()
    assert (np.diff(pixels, axis=0) <= 0).all()
    assert pixels[0, 0].min() > 250
    assert pixels[-1, 0].tolist() == [205, 220, 230]


def drawn() -> np.ndarray:
    """The pictures beside one another, (height, 3 width, 3)."""
    held = Payload(mass=0.3, com=(0.0, 0.01, 0.02), volume=1e-4)
    scene = build_scene(
        a5.load(),
        target=[0.06, 0.05, 0.36],
        current=(0.5, 0.2, 0.1),
        payload=held,
    )
    columns = [framed(replace(scene, show=show), SIZE) for show in COLUMNS]
    return np.hstack([picture(column, SIZE) for column in columns])


def test_every_group_looks_as_in_the_committed_picture() -> None:
    """To half a step of 255 in the mean of each square of ten pixels."""
    assert {group for column in COLUMNS for group in column} == {*GROUPS} - {"labels"}
    pixels = drawn()
    if os.environ.get("ALPHA5_UPDATE_PRINTED"):
        Image.fromarray(pixels).save(COMMITTED, optimize=True)
    with Image.open(COMMITTED) as image:
        committed = np.asarray(image)
    assert pixels.shape == committed.shape

    off = pixels.astype(float) - committed
    squares = off.reshape(15, 10, -1, 10, 3).mean(axis=(1, 3))
    assert np.abs(squares).max() < 0.5
    # Rounding may decide otherwise at a few edges.
    assert (np.abs(off).max(axis=2) > 2).mean() < 0.001
