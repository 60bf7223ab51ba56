"""The ``alpha5`` command: one module per subcommand, no physics in here.

This file has what they share: the application, its version, and one line for every error.
"""

from __future__ import annotations

import ast
import sys
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from alpha5_model import __version__
from alpha5_model._support.text import printable
from alpha5_model.cli.options import hints, one_syntax
from alpha5_model.errors import Alpha5Error, ImplausibleWarning

#: Command -> module of this package with its function, in the order of ``alpha5 --help``.
COMMANDS = {
    "demo": "demo",
    "generate": "generate",
    "check": "proofs",
    "compare": "proofs",
}
COMMANDS |= {
    "torque": "state",
    "trajectory": "trajectory",
    "fk": "state",
    "ik": "state",
}
COMMANDS |= {
    "workspace": "geometry",
    "dh": "geometry",
    "planar": "geometry",
    "view": "view",
}
COMMANDS |= {"sweep": "trajectory"}
#: With numbers as arguments, which may be negative: what is no option is an argument.
_NUMBERS = {
    name: {"ignore_unknown_options": True} for name in ("fk", "ik", "dh", "planar")
}

#: Root of the errors that the parser raises (click's own, which typer may carry inside).
_PARSER_ERROR: Any = typer.BadParameter.__mro__[2]


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(__version__)
        raise typer.Exit


_VERSION = typer.Option(
    "--version", callback=_print_version, is_eager=True, help="Print it."
)


def _root(version: Annotated[bool, _VERSION] = False) -> None:
    """The Reach Alpha 5 arm: generate, check, solve, compute, look."""


def application(*commands: str) -> typer.Typer:
    """The application with these commands; without any, all of them in outline, for the help."""
    settings = {"help_option_names": ["-h", "--help"]}
    app = typer.Typer(name="alpha5", add_completion=False, context_settings=settings)
    app.callback(no_args_is_help=True)(_root)
    for name in commands or COMMANDS:
        function = _loaded(name) if commands else _outline(name)
        app.command(name, context_settings=_NUMBERS.get(name))(function)
    return app


def _loaded(name: str) -> Any:
    return getattr(import_module(f"alpha5_model.cli.{COMMANDS[name]}"), name)


def _outline(name: str) -> Callable[[], None]:
    """A function with a command's help, made without loading what the command needs."""
    module = ast.parse(
        Path(__file__).with_name(f"{COMMANDS[name]}.py").read_text(encoding="utf-8")
    )
    (command,) = (
        n for n in module.body if isinstance(n, ast.FunctionDef) and n.name == name
    )

    def outline() -> None: ...

    outline.__doc__ = ast.get_docstring(command)
    return outline


def main(args: Sequence[str] | None = None) -> int:
    """Run the command line.

    Args:
        args: Arguments without the program's name; ``sys.argv`` if None.

    Returns:
        Exit status: 0, 1 if a check failed, 2 if the input cannot be used or the output cannot be
        written (one line on stderr), 130 if interrupted.
    """
    hints.clear()
    with warnings.catch_warnings():
        warnings.simplefilter("always", ImplausibleWarning)
        warnings.showwarning = _warner(warnings.showwarning)
        return _main(args)


def _warner(otherwise: Any) -> Any:
    """Prints a warning of ours as one line, each only once, and leaves others to Python."""
    printed: set[str] = set()

    def show(message: Any, category: type[Warning], *place: Any, **more: Any) -> None:
        if not issubclass(category, ImplausibleWarning):
            otherwise(message, category, *place, **more)
        elif str(message) not in printed:
            printed.add(str(message))
            print("alpha5: warning:", printable(str(message)), file=sys.stderr)

    return show


def _main(args: Sequence[str] | None) -> int:
    try:
        words = one_syntax(sys.argv[1:] if args is None else args)
        # One command is loaded, not all of them: each brings what it needs.
        app = application(*(word for word in words[:1] if word in COMMANDS))
        status = app(args=words, standalone_mode=False)
    except (Alpha5Error, OSError, SystemExit) as error:
        # A reader that left (`alpha5 ... | head`), where the parser exits with 1: no check failed.
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
        # Without any argument the help has just been printed: nothing to complain about.
        return _complain(f"{message} (see --help)") if message else 2
    for hint in hints[:1]:
        print(f"alpha5: warning: {hint}", file=sys.stderr)
    return status if isinstance(status, int) else 0


def run() -> None:
    """Entry point of the ``alpha5`` program."""
    sys.exit(main())


def _complain(message: str) -> int:
    # A file name may hold bytes that are not UTF-8, which stderr may refuse.
    line = printable(" ".join("; ".join([message, *hints[:1]]).split()))
    print("alpha5:", line.encode(errors="backslashreplace").decode(), file=sys.stderr)
    return 2
