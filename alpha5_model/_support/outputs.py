"""Checks of the files that a command will write, before it does its work."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path

from alpha5_model._support.checks import choice
from alpha5_model._support.files import (
    STDOUT,
    PathLike,
    errors_of,
    is_stdout,
    is_stream,
    plain_file,
)
from alpha5_model.errors import InputError


def output_format(kind: str, path: PathLike, formats: Sequence[str]) -> str:
    """Suffix of a path to write, one of ``formats``.

    The first one for ``-``, devices and pipes.

    Raises:
        UnknownNameError: Another suffix, or none.
    """
    suffix = Path(path).suffix.lower()
    if not suffix and is_stream(path):
        return formats[0]
    return choice(kind, suffix, formats)


def check_outputs(
    read: Iterable[PathLike | None], **written: tuple[PathLike | None, Sequence[str]]
) -> None:
    """Refuse outputs that must not be written; every command calls this first.

    Args:
        read: Paths that are read; None is skipped.
        written: Option -> its path, or None, and the suffixes that it may have.

    Raises:
        InputError: A file that is also read, or two outputs into one, under any of its
            names.
        UnknownNameError: A path with another suffix.
        OutputError: A folder, a socket, a read-only file.
    """
    # Path that is used already -> what to give instead of it.
    taken = [
        (path, "another file than the one that is read")
        for path in read
        if path is not None
    ]
    for option, (path, formats) in written.items():
        if path is None:
            continue

        with errors_of(Path(path)):
            plain_file(Path(path))
        output_format(f"format for --{option}", path, formats)
        for other, expected in taken:
            if _same(path, other):
                raise InputError(option, str(path), expected)
        taken.append((path, f"another file than --{option}"))


def _same(a: PathLike, b: PathLike) -> bool:
    """Whether two paths are one file, through links; devices and pipes never are."""
    if STDOUT in (str(a), str(b)):
        return is_stdout(a) and is_stdout(b)
    try:
        return Path(a).samefile(b) and Path(a).is_file()
    except (OSError, ValueError):
        # At least one is not there yet.
        with suppress(OSError, ValueError):
            return os.path.realpath(a) == os.path.realpath(b)
        return False
