"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from alpha5_model.errors import OutputError


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
    data = content.encode("utf-8") if isinstance(content, str) else content
    temporary = None
    try:
        if target.is_dir():
            raise OutputError(target, "it is a folder")
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        umask = os.umask(0)
        os.umask(umask)
        Path(temporary).chmod(0o666 & ~umask)
        Path(temporary).replace(target)
    except OSError as error:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
        if isinstance(error, OutputError):
            raise
        raise OutputError(target, error.strerror or str(error)) from None
    return target
