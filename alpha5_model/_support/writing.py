"""Writing files completely or not at all. Only plain files are replaced."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Mapping
from pathlib import Path

from alpha5_model._support.files import (
    STDOUT,
    PathLike,
    errors_of,
    plain_file,
    standard_stream,
)
from alpha5_model.errors import OutputError


def atomic_write(path: PathLike, content: str | bytes) -> Path:
    """Write one file, as `atomic_write_all` does.

    Returns:
        The target's path.

    Raises:
        OutputError: The target cannot be written. An existing plain file is then
            unchanged.
    """
    target = Path(path)
    atomic_write_all({target: content})
    return target


def atomic_write_all(files: Mapping[Path, str | bytes]) -> None:
    """Write files that belong together: none is replaced before all are written.

    The content of a plain file goes to a temporary file beside it, which then takes its
    place. A file keeps its mode, a missing folder is made, and symlinks are followed.
    Devices, pipes and standard output, ``-``, are written into.

    Args:
        files: Target -> text (written as UTF-8, newlines as they are) or bytes.

    Raises:
        OutputError: A target cannot be written, is a folder, or is the same file as
            another target.
    """
    #: Plain file, links resolved -> its temporary one.
    staged: dict[Path, Path] = {}
    streams: dict[Path, bytes] = {}
    try:
        for target, given in files.items():
            with errors_of(target):
                content = given.encode("utf-8") if isinstance(given, str) else given
                real = plain_file(target)
                if real is None:
                    streams[target] = content
                    continue
                if real in staged:
                    problem = "it is another name of a file written with it"
                    raise OutputError(target, problem)
                real.parent.mkdir(parents=True, exist_ok=True)
                staged[real] = real.with_name(f".alpha5-{os.urandom(8).hex()}")
                _stage(staged[real], real, content)
        for target, content in streams.items():
            with errors_of(target):
                _write_into(target, content)
        for real, temporary in staged.items():
            with errors_of(real):
                temporary.replace(real)
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)


def _stage(temporary: Path, real: Path, content: bytes) -> None:
    """Write the new content of a file beside it."""
    with temporary.open("xb") as stream:
        # The mode is set before there is anything to read.
        if real.exists():
            temporary.chmod(stat.S_IMODE(real.stat().st_mode))
        stream.write(content)


def _write_into(target: Path, content: bytes) -> None:
    """Write into a device, a pipe or a standard stream; nothing is made or replaced."""
    descriptor = _stdout() if str(target) == STDOUT else _opened(target)
    if descriptor is None:
        # Standard output was replaced in Python, by a notebook or a test.
        sys.stdout.write(content.decode("utf-8", "replace"))
        return
    with os.fdopen(descriptor, "wb") as stream:
        stream.write(content)


def _stdout() -> int | None:
    """A descriptor of standard output; None if it has none."""
    if sys.stdout is None:
        raise OSError("it is closed")
    sys.stdout.flush()
    try:
        return os.dup(sys.stdout.fileno())
    except OSError:
        return None


def _opened(target: Path) -> int:
    """A descriptor of a device, a pipe or a standard stream."""
    number = standard_stream(target.stat())
    if number is None:
        return os.open(target, os.O_WRONLY | os.O_TRUNC)
    return os.dup(number)
