"""Paths given by the user: reading them, and what kind of file they are."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO

from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingFileError,
    OutputError,
)

PathLike = str | os.PathLike[str]
#: The path that means standard output.
STDOUT = "-"


def read_named(path: Any, expected: str, most: int | None = None) -> bytes:
    """Content of a file that the caller named.

    Args:
        path: What was given, of any type.
        expected: What should be there, for the message: ``"a URDF file"``.
        most: Largest size in bytes; None for any.

    Raises:
        InputError: Not a path: another type, a zero byte.
        MissingFileError: Nothing is there.
        FileFormatError: A folder, a loop of links, no permission, too long a name,
            more than ``most`` bytes, or a device without this bound: some are endless.
    """
    try:
        with Path(path).open("rb") as stream:
            if most is None and _is_device(stream):
                raise FileFormatError(path, f"is a device, {expected} is expected")
            content = stream.read(-1 if most is None else most + 1)
    except FileFormatError:
        raise
    except (FileNotFoundError, NotADirectoryError):
        raise MissingFileError(path, expected) from None
    except IsADirectoryError:
        raise FileFormatError(path, f"is a folder, {expected} is expected") from None
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise FileFormatError(path, f"{problem}, {expected} is expected") from None
    except (TypeError, ValueError):
        # A zero byte, or a character that no file name can have.
        raise InputError("path", path, f"the path of {expected}") from None
    if most is not None and len(content) > most:
        problem = f"more than {most // 1024} KiB, {expected} is expected"
        raise FileFormatError(path, problem)
    return content


def _is_device(stream: BinaryIO) -> bool:
    """Whether a stream is a device, and no terminal at which somebody types."""
    mode = os.fstat(stream.fileno()).st_mode
    return (stat.S_ISCHR(mode) or stat.S_ISBLK(mode)) and not stream.isatty()


def is_stream(path: PathLike) -> bool:
    """Whether a path is ``-``, a device or a pipe.

    These are written into, and get no other files beside them.

    Raises:
        OutputError: A socket, or a path that cannot be one.
    """
    target = Path(path)
    with errors_of(target):
        return not target.is_dir() and plain_file(target) is None


def is_stdout(path: PathLike) -> bool:
    """Whether a path is ``-`` or leads to standard output, as ``/dev/stdout`` does."""
    with suppress(OSError, ValueError):
        return str(path) == STDOUT or standard_stream(Path(path).stat()) == 1
    return False


def plain_file(target: Path) -> Path | None:
    """The plain file to write for a path, with links resolved; it need not exist.

    None for a device, a pipe or a standard stream, which are written into.

    Raises:
        OutputError: A folder, a socket, a read-only file.
    """
    if str(target) == STDOUT:
        return None
    real = Path(os.path.realpath(target))
    try:
        state = target.stat()
    except FileNotFoundError:
        return real

    if stat.S_ISDIR(state.st_mode):
        raise OutputError(target, "it is a folder")
    if stat.S_ISSOCK(state.st_mode):
        raise OutputError(target, "it is a socket")
    is_device = not stat.S_ISREG(state.st_mode)
    if is_device or standard_stream(state) is not None or _is_open_file(target):
        return None
    if not os.access(real, os.W_OK):
        raise OutputError(target, "it is read-only")
    return real


def standard_stream(state: os.stat_result) -> int | None:
    """1 or 2 if a file is standard output or standard error, which are not replaced."""
    for number in (1, 2):
        with suppress(OSError):
            if os.path.samestat(os.fstat(number), state):
                return number
    return None


def _is_open_file(target: Path) -> bool:
    """Whether a path names a file that is open already, as ``/dev/fd/3`` does."""
    return os.path.realpath(target.parent).startswith("/proc/")


@contextmanager
def errors_of(target: Path) -> Iterator[None]:
    """Turn errors of the system into one line about the target.

    Raises:
        OutputError: In place of each of them.
    """
    shown = "standard output" if str(target) == STDOUT else target
    try:
        yield
    except OutputError:
        raise
    except (FileExistsError, NotADirectoryError):
        raise OutputError(shown, "a part of its path is a file, not a folder") from None
    except OSError as error:
        raise OutputError(shown, error.strerror or str(error)) from None
    except ValueError as error:
        # A null byte in the path, or a lone surrogate in the text.
        raise OutputError(shown, str(error)) from None
