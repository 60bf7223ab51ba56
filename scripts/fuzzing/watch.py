"""What a file makes this process do: programs started, connections made, other files opened, code run.

Python's audit hooks report it. A hook cannot be taken away, so that this one is switched on and off.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

#: In the name of every file that must not be opened, and in all code that must not run.
CANARY = "xcanaryx"
#: Events that no input of this package may cause.
FORBIDDEN = {
    "os.system",
    "os.exec",
    "os.fork",
    "os.forkpty",
    "os.posix_spawn",
    "os.spawn",
    "os.startfile",
    "pty.spawn",
    "subprocess.Popen",
    "socket.connect",
    "socket.getaddrinfo",
    "urllib.Request",
    "pickle.find_class",
}
#: Programs that the package itself starts: ``alpha5 check`` asks liburdfdom's own.
OWN_PROGRAMS = {"check_urdf"}
#: Events that are forbidden if their first argument holds the canary's name.
SUSPECT = {
    "open",
    "sqlite3.connect",
    "os.listdir",
    "os.scandir",
    "glob.glob",
    "compile",
    "exec",
    "os.remove",
}

_misdeeds: list[str] | None = None
_installed = False


def _hook(event: str, args: tuple[Any, ...]) -> None:
    if _misdeeds is None:
        return
    if event == "subprocess.Popen" and Path(str(args[0])).name in OWN_PROGRAMS:
        return
    if event in FORBIDDEN or (
        event in SUSPECT and CANARY in _text(args[0] if args else "")
    ):
        _misdeeds.append(f"{event} {str(args)[:200]}")


def _text(value: Any) -> str:
    """A path, a source or a code object as text."""
    if hasattr(value, "co_consts"):
        return f"{value.co_filename} {value.co_names} {value.co_consts}"
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, str | os.PathLike):
        return os.fspath(value) if isinstance(value, os.PathLike) else value
    return ""


@contextmanager
def watching() -> Iterator[list[str]]:
    """What is done in the meantime that must not be done."""
    global _misdeeds, _installed
    if not _installed:
        sys.addaudithook(_hook)
        _installed = True
    before, _misdeeds = _misdeeds, []
    try:
        yield _misdeeds
    finally:
        _misdeeds = before
