"""Files named by the user: read, or written as a whole or not at all; only plain ones replaced."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import choice
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingFileError,
    OutputError,
)

PathLike = str | os.PathLike[str]
#: The path that means standard output.
STDOUT = "-"


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
    except (
        TypeError,
        ValueError,
    ):  # a zero byte; a character that no file name can have
        raise InputError("path", path, f"the path of {expected}") from None


def atomic_write(path: PathLike, content: str | bytes) -> Path:
    """Write one file, as `atomic_write_all` does.

    Returns:
        The target's path.

    Raises:
        OutputError: The target cannot be written; a plain file that stood there is untouched.
    """
    target = Path(path)
    atomic_write_all({target: content})
    return target


def atomic_write_all(files: Mapping[Path, str | bytes]) -> None:
    """Write files that belong together: none is renamed before all are on the disk.

    A plain file is written through a temporary one beside it, which is synchronised with the disk
    as its folder is, and a rename; after a loss of power there is the old file or the new one. It
    keeps its mode, and its folder is made if missing. A symlink is followed. Devices, pipes and
    ``-``, standard output, are written into.

    Args:
        files: Target -> text (written as UTF-8, newlines as they are) or bytes.

    Raises:
        OutputError: A target cannot be written, is a folder or a socket, or stands for the same
            file as another one; plain files that stood there are untouched.
    """
    data: dict[Path, bytes] = {}
    plain: dict[Path, Path] = {}
    for target, content in files.items():
        with _errors_of(target):
            data[target] = (
                content.encode("utf-8") if isinstance(content, str) else content
            )
            if (real := _plain_file(target)) is not None:
                if real in plain.values():
                    raise OutputError(
                        target, "it is another name of a file written with it"
                    )
                plain[target] = real
    staged: dict[Path, Path] = {}
    folders: set[Path] = set()
    undo: list[Callable[[], object]] = []
    try:
        for target, real in plain.items():
            with _errors_of(target):
                folders.update(_made(real.parent))
                temporary = real.with_name(f".alpha5-{os.urandom(8).hex()}")
                with temporary.open("xb") as stream:
                    staged[real] = temporary
                    if real.exists():  # its mode, before there is anything to read
                        temporary.chmod(stat.S_IMODE(real.stat().st_mode))
                    stream.write(data[target])
                    stream.flush()
                    os.fsync(stream.fileno())
        _synchronise(folders)
        for target in (t for t in files if t not in plain):
            with _errors_of(target):
                _write_into(target, data[target])
        for target, real in plain.items():
            with _errors_of(target):
                if len(plain) > 1:
                    undo.append(_undo(real, Path(f"{staged[real]}~")))
                staged[real].replace(real)
        _synchronise(folders)
    except BaseException:
        for put_back in undo:
            with suppress(OSError):
                put_back()
        raise
    finally:
        for leftover in staged.values():
            leftover.unlink(missing_ok=True)
            Path(f"{leftover}~").unlink(missing_ok=True)


def _made(folder: Path) -> set[Path]:
    """Make a folder if it is missing.

    Returns:
        The folder, and those in which a new one stands.
    """
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return {folder, *(path.parent for path in missing)}


def _synchronise(folders: Iterable[Path]) -> None:
    """Bring the names in folders to the disk, if the system has a way to."""
    for folder in folders:
        with suppress(OSError):  # Windows, and disks of a network
            descriptor = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)


def _undo(real: Path, spare: Path) -> Callable[[], object]:
    """Puts back the file that is there now; keeps it by a hard link, where the system has them."""
    if not real.exists():
        return partial(real.unlink, missing_ok=True)
    with suppress(OSError):
        os.link(real, spare)
    return partial(spare.replace, real)


def is_stream(path: PathLike) -> bool:
    """Whether a path is ``-``, a device or a pipe, which is written into and has nothing beside it.

    Raises:
        OutputError: A socket, or a path that cannot be one.
    """
    target = Path(path)
    with _errors_of(target):
        return not target.is_dir() and _plain_file(target) is None


def is_stdout(path: PathLike) -> bool:
    """Whether a path is ``-`` or leads to standard output, as ``/dev/stdout`` does."""
    with suppress(OSError, ValueError):
        return str(path) == STDOUT or _descriptor(Path(path).stat()) == 1
    return False


def output_format(kind: str, path: PathLike, formats: Sequence[str]) -> str:
    """Suffix of a path to write, one of ``formats``; the first one for ``-``, devices and pipes.

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
    """Refuse, before the work, what must not be written; every command calls this.

    Args:
        read: Paths that are read; None is skipped.
        written: Option -> path, None if not given, and the suffixes it may have.

    Raises:
        InputError: A file that is also read, or two outputs into one, under any of its names.
        UnknownNameError: A path with another suffix.
        OutputError: A folder, a socket, a read-only file.
    """
    taken = [
        (path, "another file than the one that is read")
        for path in read
        if path is not None
    ]
    for option, (path, formats) in written.items():
        if path is None:
            continue
        with _errors_of(Path(path)):
            _plain_file(Path(path))
        output_format(f"format for --{option}", path, formats)
        for other, expected in taken:
            if _same(path, other):
                raise InputError(option, str(path), expected)
        taken.append((path, f"another file than --{option}"))


def _same(a: PathLike, b: PathLike) -> bool:
    """One file, through symlinks and hard links; devices and pipes are no files."""
    if STDOUT in (str(a), str(b)):
        return is_stdout(a) and is_stdout(b)
    try:
        return Path(a).samefile(b) and Path(a).is_file()
    except (OSError, ValueError):  # at least one is not there yet
        with suppress(OSError, ValueError):
            return os.path.realpath(a) == os.path.realpath(b)
        return False


def _plain_file(target: Path) -> Path | None:
    """The plain file that a path stands for, there or not; None for what is written into."""
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
    if not stat.S_ISREG(state.st_mode) or _descriptor(state) is not None:
        return None
    if os.path.realpath(target.parent).startswith(
        "/proc/"
    ):  # a file open already, as /dev/fd/3
        return None
    if not os.access(real, os.W_OK):
        raise OutputError(target, "it is read-only")
    return real


def _descriptor(state: os.stat_result) -> int | None:
    """Number of the standard stream that a file is, which must not be truncated."""
    for number in (1, 2):
        with suppress(OSError):
            if os.path.samestat(os.fstat(number), state):
                return number
    return None


def _write_into(target: Path, content: bytes) -> None:
    """Into a device, a pipe or a standard stream, without making or replacing anything."""
    if str(target) == STDOUT:
        if sys.stdout is None:
            raise OSError("it is closed")
        sys.stdout.flush()
        try:
            descriptor = os.dup(sys.stdout.fileno())
        except OSError:  # replaced in Python, by a notebook or a test
            sys.stdout.write(content.decode("utf-8", "replace"))
            return
    else:
        number = _descriptor(target.stat())
        descriptor = (
            os.open(target, os.O_WRONLY | os.O_TRUNC)
            if number is None
            else os.dup(number)
        )
    with os.fdopen(descriptor, "wb") as stream:
        stream.write(content)


@contextmanager
def _errors_of(target: Path) -> Iterator[None]:
    """Errors of the system as one line about the target."""
    shown = "standard output" if str(target) == STDOUT else target
    try:
        yield
    except OutputError:
        raise
    except (FileExistsError, NotADirectoryError):
        raise OutputError(shown, "a part of its path is a file, not a folder") from None
    except (
        OSError,
        ValueError,
    ) as error:  # a null byte in the path, a lone surrogate in the text
        problem = error.strerror if isinstance(error, OSError) else None
        raise OutputError(shown, problem or str(error)) from None
