"""Checksums: of files of results, of recordings, and of arm files."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path

from alpha5_model._support.files import errors_of

#: A line of a checksum file, as ``sha256sum`` writes and checks it.
_LINE = re.compile(r"([0-9a-f]{64})  ([^\n]+)\n")


def digest(content: bytes) -> str:
    """SHA-256 of some bytes, as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


def digest_of_file(path: Path) -> str | None:
    """SHA-256 of a file, or of all files in a folder with their names.

    None if there is nothing that can be read.
    """
    try:
        if not path.is_dir():
            with path.open("rb") as stream:
                return hashlib.file_digest(stream, "sha256").hexdigest()
        inside = sorted(file for file in path.rglob("*") if file.is_file())
        lines = [f"{digest_of_file(file)} {file.relative_to(path)}" for file in inside]
        return digest("\n".join(lines).encode("utf-8", "surrogateescape"))
    except (OSError, ValueError):
        return None


def checksum_text(digests: Mapping[str, str]) -> str:
    """The text of a checksum file.

    Args:
        digests: Path in the folder of the results -> SHA-256.
    """
    return "".join(f"{value}  {path}\n" for path, value in digests.items())


def read_checksums(text: bytes) -> dict[str, str]:
    """Path -> SHA-256 of a checksum file; empty if it is damaged."""
    decoded = text.decode("utf-8", "replace")
    lines = _LINE.findall(decoded)
    digests = {path: value for value, path in lines}
    return digests if checksum_text(digests) == decoded else {}


def remove(path: Path) -> None:
    """Remove a file, if it is there.

    Raises:
        OutputError: It cannot be removed.
    """
    with errors_of(path):
        path.unlink(missing_ok=True)
