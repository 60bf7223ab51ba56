"""Files that somebody names: read, or written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alpha5_model.errors import FileFormatError, InputError, MissingFileError, OutputError


def read_named(path: Any, expected: str) -> bytes:
    """Content of a file that the caller named.

    Args:
        path: What was given, of any type.
        expected: What should be there, for the message: ``"a URDF file"``.

    Raises:
        InputError: Not a path: another type, a zero byte.
        MissingFileError: Nothing is there.
        FileFormatError: A folder, a loop of links, no permission, too long a name.
    """
    try:
        return Path(path).read_bytes()
    except (FileNotFoundError, NotADirectoryError):
        raise MissingFileError(path, expected) from None
    except IsADirectoryError:
        raise FileFormatError(path, f"is a folder, {expected} is expected") from None
    except OSError as error:
        problem = (error.strerror or str(error)).lower()
        raise FileFormatError(path, f"{problem}, {expected} is expected") from None
    except (TypeError, ValueError):  # a zero byte; a character that no file name can have
        raise InputError("path", path, f"the path of {expected}") from None


def atomic_write(path: str | os.PathLike[str], content: str | bytes) -> Path:
    """Write a file through a temporary one beside it, then rename.

    Args:
        path: Target; its folder is made if missing.
        content: Text (written as UTF-8, newlines as they are) or bytes.

    Returns:
        The target's path.

    Raises:
        OutputError: The target cannot be written; what stood there before is untouched.
    """
    target = Path(path)
    atomic_write_all({target: content})
    return target


def atomic_write_all(files: Mapping[Path, str | bytes]) -> None:
    """Write files that belong together: none is renamed before all are on the disk.

    Args:
        files: Target -> content, as in `atomic_write`.

    Raises:
        OutputError: A target cannot be written; what stood there before is untouched.
    """
    for target in files:
        if target.is_dir():
            raise OutputError(target, "it is a folder")
    staged: dict[Path, Path] = {}
    try:
        for target, content in files.items():
            with _speaking_of(target):
                staged[target] = _stage(target, content)
        for target, temporary in staged.items():
            with _speaking_of(target):
                temporary.replace(target)
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)


def _stage(target: Path, content: str | bytes) -> Path:
    """The content in a temporary file beside the target."""
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    temporary = Path(name)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content.encode("utf-8") if isinstance(content, str) else content)
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return temporary


@contextmanager
def _speaking_of(target: Path) -> Iterator[None]:
    """Errors of the system as one line about the target."""
    try:
        yield
    except (FileExistsError, NotADirectoryError):
        raise OutputError(target, "a part of its path is a file, not a folder") from None
    except OSError as error:
        raise OutputError(target, error.strerror or str(error)) from None
