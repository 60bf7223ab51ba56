"""The program ``alpha5``: it runs one command, and prints one line for every error."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Sequence
from typing import Any

import typer

from alpha5_model._support.text import printable
from alpha5_model.cli.commands import COMMANDS, application
from alpha5_model.cli.syntax import one_syntax
from alpha5_model.cli.values import hints
from alpha5_model.errors import Alpha5Error, ImplausibleWarning

#: click's ClickException, the base class of all errors of the parser. It cannot be
#: imported from click, because some versions of typer have a copy of click inside. But
#: BadParameter derives from UsageError, and that from ClickException.
_PARSER_ERROR: Any = typer.BadParameter.__mro__[2]


def run() -> None:
    """Entry point of the ``alpha5`` program."""
    sys.exit(main())


def main(args: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        args: Arguments without the program's name; ``sys.argv`` if None.

    Returns:
        Exit status: 0, 1 if a check failed, 2 if the input cannot be used or the output
        cannot be written (one line on stderr), 130 if interrupted.
    """
    hints.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("always", ImplausibleWarning)
        warnings.showwarning = _one_line_warnings(warnings.showwarning)
        return _status(sys.argv[1:] if args is None else args)


def _one_line_warnings(show_others: Callable[..., None]) -> Callable[..., None]:
    """A replacement for `warnings.showwarning`.

    It prints a warning of this package as one line, and each text only once.

    Args:
        show_others: Shows the warnings of other packages.
    """
    printed: set[str] = set()

    def show(message: Any, category: type[Warning], *place: Any, **more: Any) -> None:
        text = str(message)
        if not issubclass(category, ImplausibleWarning):
            show_others(message, category, *place, **more)
        elif text not in printed:
            printed.add(text)
            print("alpha5: warning:", printable(text), file=sys.stderr)

    return show


def _status(args: Sequence[str]) -> int:
    """Run the command; report user errors as one line and return the exit status."""
    try:
        status = _run_command(args)
    except (Alpha5Error, OSError, SystemExit) as error:
        # `alpha5 ... | head` closes the pipe: the parser exits with 1, as a failed
        # check does.
        if isinstance(error.__context__, BrokenPipeError):
            return 0
        if isinstance(error, SystemExit):
            raise
        return _complain(str(error))
    except UnicodeEncodeError as error:
        unknown = error.object[error.start : error.end]
        remedy = "try PYTHONIOENCODING=utf-8:backslashreplace"
        return _complain(f"{error.encoding} output cannot hold {unknown!a}: {remedy}")
    except _PARSER_ERROR as error:
        message = error.format_message()
        # Without arguments the help has just been printed, and the message is empty.
        return _complain(f"{message} (see --help)") if message else 2

    for hint in hints[:1]:
        print(f"alpha5: warning: {hint}", file=sys.stderr)
    return status if isinstance(status, int) else 0


def _run_command(args: Sequence[str]) -> Any:
    """What the command's function returns: a status, or None."""
    words = one_syntax(args)
    # Only the command that is called is loaded: each brings what it needs.
    called = [word for word in words[:1] if word in COMMANDS]
    return application(*called)(args=words, standalone_mode=False)


def _complain(message: str) -> int:
    """Print an error as one line, with the first hint if there is one."""
    sentence = "; ".join([message, *hints[:1]])
    line = printable(" ".join(sentence.split()))
    # A file name may hold bytes that are not UTF-8, which stderr may refuse.
    print("alpha5:", line.encode(errors="backslashreplace").decode(), file=sys.stderr)
    return 2
