"""How results and progress are printed."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import (
    AbstractContextManager,
    contextmanager,
    nullcontext,
    redirect_stdout,
)
from pathlib import Path
from shutil import get_terminal_size
from typing import Any, TypeAlias, TypeVar

from alpha5_model._support.files import is_stdout
from alpha5_model._support.text import plain, printable, readable, wrapped

Item = TypeVar("Item")
#: Lines that a command prints for people.
Lines: TypeAlias = Iterable[str]
#: Verdict at the beginning of a line -> its colour on a terminal.
_COLOURS = {
    "agrees": "green",
    "passed": "green",
    "differs": "yellow",
    "not run": "yellow",
    "impossible": "red",
    "failed": "red",
    "✗": "red",
    "·": "yellow",
}
_ANSI = {"red": "\x1b[31m", "green": "\x1b[32m", "yellow": "\x1b[33m"}
_VERDICT = re.compile(rf"\A( *)({'|'.join(_COLOURS)})(?= )")
#: The sign of a negative number, but not the hyphen of a word or an option.
_MINUS = re.compile(r"(?<![\w.,=-])-(?=[\d.])")


def show(as_json: bool, record: Any, text: Lines, *written: Path | None) -> None:
    """Print a result for scripts or for people.

    Args:
        as_json: Print the record, and nothing else.
        record: The result: numbers, texts, arrays, records and collections of them.
        text: The same for people, see `say`.
        written: Files of this result, each named in a line of its own; None is skipped.
    """
    files = [path for path in written if path is not None]
    with apart_from(*files):
        if as_json:
            print(json.dumps(plain(record), indent=2))
            return
        if text:
            say(*text)
        for path in files:
            print(f"wrote {path}")


def apart_from(*written: Path | None) -> AbstractContextManager[object]:
    """If a file goes to standard output, what is printed goes to standard error."""
    taken = any(path is not None and is_stdout(path) for path in written)
    return redirect_stdout(sys.stderr) if taken else nullcontext()


def say(*lines: str) -> None:
    """Print lines for people, wrapped; on a terminal with minus signs and colours."""
    for line in "\n".join(lines).split("\n"):
        shown = readable(printable(line))
        if sys.stdout.isatty():
            shown = _MINUS.sub("−", shown)
        for part in wrapped(shown, width()):
            print(_VERDICT.sub(_coloured, part))


def _coloured(match: re.Match[str]) -> str:
    indent, verdict = match.groups()
    return indent + styled(verdict, _COLOURS[verdict])


def styled(text: str, colour: str) -> str:
    """A text in a colour, on a terminal; else the text."""
    return f"{_ANSI[colour]}{text}\x1b[0m" if sys.stdout.isatty() else text


def width() -> int:
    """Columns of the terminal, or those that the environment asks for."""
    return get_terminal_size().columns


def spinner(words: str) -> AbstractContextManager[object]:
    """A spinner on stderr, on a terminal only."""
    from rich.console import Console

    console = Console(stderr=True)
    return console.status(words) if console.is_terminal else nullcontext()


@contextmanager
def progress_bars() -> Iterator[Callable[[str, float], None]]:
    """A function that draws progress bars on a terminal.

    It takes the name of a stage and the part done, 0 to 1.
    """
    from rich.console import Console
    from rich.progress import Progress

    console = Console(stderr=True)
    if not console.is_terminal:
        # Before 14.3, Rich ends even disabled bars with an empty line.
        yield lambda stage, done: None
        return

    with Progress(console=console, transient=True) as bars:

        def progress(stage: str, done: float) -> None:
            if stage not in [task.description for task in bars.tasks]:
                bars.add_task(stage, total=1.0)
            bars.update(bars.tasks[-1].id, completed=done)

        yield progress


def progress_over(items: Iterable[Item], words: str, count: int) -> Iterable[Item]:
    """The items one by one, with a bar on stderr; ``count`` is how many there are."""
    from rich.console import Console
    from rich.progress import track

    return track(items, words, count, console=Console(stderr=True), transient=True)


def payload(mass: float) -> str:
    """What the arm holds [kg], which every torque depends on."""
    return f"payload: {mass:g} kg" if mass else "payload: none"
