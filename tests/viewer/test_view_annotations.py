"""Labels and scale bars over a picture, by the strokes that Pillow is asked for.

The strokes are in files of ``snapshots``. After a change that you meant, run
``ALPHA5_UPDATE_PRINTED=1 python -m pytest tests/viewer/test_view_annotations.py``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from committed_texts import check_committed
from descriptions import inline

import alpha5_model as a5
from alpha5_model.viewer.annotations import _Box, _free_top, annotated
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.canvas import Canvas, Window

SNAPSHOTS = Path(__file__).parent / "snapshots"


class Recorder:
    """Stands in for Pillow's drawing: notes each stroke; letters are 0.6 em wide."""

    def __init__(self, image: Any, mode: str) -> None:
        self.lines = [f"image {image.size}, drawn in {mode}"]

    def textlength(self, text: str, font: Any) -> float:
        return 0.6 * font.size * len(text)

    def text(self, place: Any, text: str, fill: Any, font: Any, anchor: str) -> None:
        self._note("text", place, f"{text!r} {fill} size {font.size} {anchor}")

    def line(self, ends: Any, fill: Any, width: int) -> None:
        self._note("line", ends, f"{fill} width {width}")

    def rounded_rectangle(self, corners: Any, radius: float, fill: Any) -> None:
        self._note("box", corners, f"{fill} radius {radius}")

    def _note(self, kind: str, numbers: Any, look: str) -> None:
        self.lines.append(f"{kind} {inline([float(x) for x in numbers])} {look}")


@pytest.mark.parametrize("height", [100, 1270, 1272])
def test_labels_and_bars_are_drawn_by_these_strokes(
    height: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Texts grow with the picture, by whole pixels, from a least size on."""
    path = SNAPSHOTS / f"annotations_{height}.txt"
    pens = []

    def pen(image: Any, mode: str) -> Recorder:
        pens.append(Recorder(image, mode))
        return pens[-1]

    monkeypatch.setattr("PIL.ImageDraw.Draw", pen)
    show = ["labels", "bodies", "frames", "com", "cob", "buoyancy", "current"]
    scene = build_scene(a5.load(), [0.0, 1.2, 2.2, 1.5], show=show)
    window = Window(left=0, top=0, right=0, bottom=0)
    canvas = Canvas(scene.camera, 320, 2 * height, window)
    annotated(np.zeros((height, 160, 3), np.uint8), scene, canvas, finer=2)
    check_committed(path, "\n".join(pens[0].lines) + "\n")


def test_a_label_moves_below_those_that_it_would_cover() -> None:
    boxes = [_Box(left=10, right=20, top=0), _Box(left=12, right=30, top=8)]
    beside = [(0, 10), (30, 40)]  # touching is not covering
    for left, right in beside:
        assert _free_top(left, right, 1.0, 8.0, boxes) == 1.0
    assert _free_top(0, 11, 1.0, 8.0, boxes) == 8.0
    assert _free_top(0, 13, 1.0, 8.0, boxes) == 16.0  # below both
    assert _free_top(25, 40, 9.0, 8.0, boxes) == 16.0
    assert _free_top(25, 40, 17.0, 8.0, boxes) == 17.0
