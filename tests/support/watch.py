"""What a file makes this process do: start programs, connect, open files, run code.

Python's audit hooks report it. A hook cannot be taken away, so this one is switched on
and off.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
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
#: Modules whose classes the package unpickles: a study keeps its arm's record so.
OWN_RECORDS = ("alpha5_model.numbers.", "numpy")
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

#: What has been done that must not be done, for each `watching`, the current one last.
_watches: list[list[str]] = []


def _hook(event: str, args: tuple[Any, ...]) -> None:
    if _watches and _is_misdeed(event, args):
        _watches[-1].append(f"{event} {str(args)[:200]}")


def _is_misdeed(event: str, args: tuple[Any, ...]) -> bool:
    if event == "subprocess.Popen" and Path(str(args[0])).name in OWN_PROGRAMS:
        return False
    if event == "pickle.find_class" and str(args[0]).startswith(OWN_RECORDS):
        return False
    if event in FORBIDDEN:
        return True
    return event in SUSPECT and CANARY in _text(args[0] if args else "")


@cache
def _install() -> None:
    sys.addaudithook(_hook)


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
    _install()
    misdeeds: list[str] = []
    _watches.append(misdeeds)
    try:
        yield misdeeds
    finally:
        _watches.pop()
