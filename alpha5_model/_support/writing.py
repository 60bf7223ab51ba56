"""Writing files completely or not at all. Only plain files are replaced."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
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
    """Write files that belong together: none is renamed before all are on the disk.

    The content of a plain file goes to a temporary file beside it, which is then
    renamed. File and folder are synchronised with the disk, so that a loss of power
    leaves the old file or the new one. A file keeps its mode, and a missing folder is
    made. Symlinks are followed. Devices, pipes and standard output, ``-``, are written
    into.

    Args:
        files: Target -> text (written as UTF-8, newlines as they are) or bytes.

    Raises:
        OutputError: A target cannot be written, is a folder or a socket, or is the same
            file as another target. Existing plain files are then unchanged.
    """
    contents, plain = _prepared(files)
    streams = [target for target in files if target not in plain]
    replacement = _Replacement()
    try:
        for target, real in plain.items():
            with errors_of(target):
                replacement.stage(real, contents[target])
        replacement.synchronise()

        for target in streams:
            with errors_of(target):
                _write_into(target, contents[target])

        for target, real in plain.items():
            with errors_of(target):
                replacement.rename(real)
        replacement.synchronise()
    except BaseException:
        replacement.undo()
        raise
    finally:
        replacement.remove_leftovers()


def _prepared(
    files: Mapping[Path, str | bytes],
) -> tuple[dict[Path, bytes], dict[Path, Path]]:
    """The content of each target, and the resolved path of each plain file."""
    contents: dict[Path, bytes] = {}
    plain: dict[Path, Path] = {}
    for target, content in files.items():
        with errors_of(target):
            contents[target] = (
                content.encode("utf-8") if isinstance(content, str) else content
            )
            real = plain_file(target)
            if real is None:
                continue
            if real in plain.values():
                problem = "it is another name of a file written with it"
                raise OutputError(target, problem)
            plain[target] = real
    return contents, plain


class _Replacement:
    """Replaces plain files: new ones are staged beside the old ones, then renamed."""

    def __init__(self) -> None:
        #: File -> the temporary one with its new content.
        self._staged: dict[Path, Path] = {}
        #: Folders in which files were made or renamed.
        self._folders: set[Path] = set()
        #: Functions that put back the replaced files.
        self._undo: list[Callable[[], object]] = []

    def stage(self, file: Path, content: bytes) -> None:
        """Write the new content beside a file."""
        self._folders.update(_made(file.parent))
        temporary = file.with_name(f".alpha5-{os.urandom(8).hex()}")
        with temporary.open("xb") as stream:
            self._staged[file] = temporary
            # The mode is set before there is anything to read.
            if file.exists():
                temporary.chmod(stat.S_IMODE(file.stat().st_mode))
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())

    def synchronise(self) -> None:
        """Synchronise the folders of the files with the disk."""
        _synchronise(self._folders)

    def rename(self, file: Path) -> None:
        """Put the new content in a file's place."""
        temporary = self._staged[file]
        self._undo.append(_restorer(file, _spare(temporary)))
        temporary.replace(file)

    def undo(self) -> None:
        """Put back the files that have been replaced."""
        for put_back in self._undo:
            with suppress(OSError):
                put_back()

    def remove_leftovers(self) -> None:
        """Remove the temporary files that are still there."""
        for temporary in self._staged.values():
            temporary.unlink(missing_ok=True)
            _spare(temporary).unlink(missing_ok=True)


def _spare(temporary: Path) -> Path:
    """The name under which the old file is kept."""
    return Path(f"{temporary}~")


def _restorer(file: Path, spare: Path) -> Callable[[], object]:
    """A function that puts back the present file, which is kept by a hard link."""
    if not file.exists():
        return file.unlink
    with suppress(OSError):
        os.link(file, spare)
    return partial(spare.replace, file)


def _made(folder: Path) -> set[Path]:
    """Make a folder if it is missing.

    Returns:
        The folder, and the folders that contain a new one.
    """
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    return {folder, *(path.parent for path in missing)}


def _synchronise(folders: Iterable[Path]) -> None:
    """Synchronise folders with the disk, if the system can."""
    for folder in folders:
        with suppress(OSError):  # Windows, and disks of a network
            descriptor = os.open(folder, os.O_RDONLY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)


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
