"""Pictures as a video file."""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import real
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import InputError, needing
from alpha5_model.viewer.picture import Pixels

VIDEO_FORMATS = (".mp4", ".gif")


@contextmanager
def film(
    path: PathLike, fps: float
) -> Iterator[tuple[float, Callable[[Pixels], None]]]:
    """Write a video: yields its rate [1/s], and a function that adds a picture.

    The file is written whole when the block ends, or not at all.

    Args:
        path: ``.mp4`` (H.264) or ``.gif``.
        fps: Frames per second; GIF counts hundredths of a second and takes the nearest.

    Raises:
        UnknownNameError, InputError: Another suffix; a rate or number of frames that
            makes no video.
        MissingDependencyError: imageio or imageio-ffmpeg is not installed.
        OutputError: It cannot be written.
    """
    suffix = output_format("video format", path, VIDEO_FORMATS)
    rate = real("fps", fps, minimum=1.0)
    options: dict[str, Any]
    if suffix == ".gif":
        # A frame lasts a whole number of hundredths of a second.
        hundredths = max(1, round(100 / rate))
        rate = 100 / hundredths
        options = {"duration": 10 * hundredths, "loop": 0}
    else:
        # H.264 takes even sizes only.
        options = {
            "fps": rate,
            "macro_block_size": 2,
            "output_params": ["-preset", "veryfast"],
        }

    with needing("a video", "pip install 'alpha5-model[video]'"):
        importlib.import_module("imageio_ffmpeg")  # imageio writes MP4 with it
        from imageio.v2 import get_writer
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder, "video").with_suffix(suffix)
        with get_writer(whole, **options) as writer:
            yield rate, writer.append_data  # type: ignore[attr-defined]
        if not whole.exists():
            raise InputError("video", str(path), "at least one frame: play a motion")
        atomic_write(path, whole.read_bytes())
