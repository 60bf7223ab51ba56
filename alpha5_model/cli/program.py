"""The program ``alpha5``: it runs one command, and prints one line for every error."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from alpha5_model import __version__
from alpha5_model.errors import Alpha5Error, ImplausibleWarning, UnknownNameError

if TYPE_CHECKING:
    from alpha5_model.cli.parsing import Parser

#: Command -> what it does; each is a module of its name with ``options`` and ``run``.
#: Only the module of the command that is called is imported.
COMMANDS = {
    "demo": "Generate the arm, check it, solve it, compute, and draw it.",
    "generate": "Write the description of any variant of the arm.",
    "check": "Check the documents against themselves, or a URDF against them.",
    "arm": "Your own arm in a file: write one, say what it changes, print it.",
    "compare": "Compare a URDF of this arm with the printed tables, or your arm.",
    "torque": "Joint torques by cause, motor currents and the load on the mount.",
    "gains": "Gains of a first controller, and a simulated step as the proof.",
    "trajectory": "Torques, motor currents, power and loads of a recorded motion.",
    "fk": "Where the tcp and the links are at a joint position, in base_link.",
    "ik": "All inverse kinematics solutions of a tcp position.",
    "move": "Move between two places without collision, within all limits.",
    "park": "Where to put the vehicle so that the arm reaches some points.",
    "jaws": "What the jaws hold: opening, gap between the blades, grip force.",
    "workspace": "The exact workspace, and how much of the published one is wrong.",
    "dh": "Standard Denavit-Hartenberg table and frames, of any serial arm.",
    "planar": "Workspace and dexterous workspace of a planar arm, and the theorem.",
    "view": "Look at the arm: live in a browser, or as a page or a picture.",
    "sweep": "Torques, currents and loads over many states: extremes, maps.",
    "calibrate": "Weigh your own arm: poses to take, and an arm file of the readings.",
}


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
    with warnings.catch_warnings():
        warnings.simplefilter("always", ImplausibleWarning)
        warnings.showwarning = _one_line_warnings(warnings.showwarning)
        return _status(sys.argv[1:] if args is None else list(args))


def parser_of(name: str) -> Parser:
    """The parser of a command; this imports the command's module."""
    from alpha5_model.cli.parsing import Parser

    parser = Parser(prog=f"alpha5 {name}")
    module = import_module(f"alpha5_model.cli.{name}")
    parser.description = f"{COMMANDS[name]}\n\n{module.HELP.strip()}"
    module.options(parser)
    return parser


def _one_line_warnings(show_others: Callable[..., None]) -> Callable[..., None]:
    """A replacement for `warnings.showwarning`.

    It prints a warning of this package as one line, and each text only once. Of a
    number of which a hint said "if 170 is in deg, ..." nothing more is said.

    Args:
        show_others: Shows the warnings of other packages.
    """
    printed: set[str] = set()
    hinted: set[str] = set()

    def show(message: Any, category: type[Warning], *place: Any, **more: Any) -> None:
        text = str(message)
        if not issubclass(category, ImplausibleWarning):
            show_others(message, category, *place, **more)
            return
        if text.startswith("if "):
            hinted.add(text.split()[1])
        elif any(f": {number} " in text for number in hinted):
            return
        if text not in printed:
            printed.add(text)
            print("alpha5: warning:", _line(text), file=sys.stderr)

    return show


def _status(args: list[str]) -> int:
    """Run the command; report user errors as one line and return the exit status."""
    try:
        status = _run_command(args)
        # A reader that has left is noticed here, and not at exit.
        sys.stdout.flush()
    except (Alpha5Error, OSError) as error:
        # `alpha5 ... | head` closes the pipe, which is no failed check.
        if isinstance(error, BrokenPipeError) or isinstance(
            error.__context__, BrokenPipeError
        ):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
        return _complain(str(error))
    except ModuleNotFoundError as error:
        remedy = "python -m pip install alpha5-model, without --no-deps"
        needs = f"needs {error.name}, which is not installed: {remedy}"
        return _complain(f"the command line {needs}")
    except UnicodeEncodeError as error:
        unknown = error.object[error.start : error.end]
        remedy = "try PYTHONIOENCODING=utf-8:backslashreplace"
        return _complain(f"{error.encoding} output cannot hold {unknown!a}: {remedy}")
    except KeyboardInterrupt:
        return 130
    except SystemExit:
        # argparse has printed a help.
        return 0
    return status or 0


def _run_command(args: list[str]) -> int | None:
    """What the command's function returns: a status, or None."""
    name = args[0] if args else ""
    if name in COMMANDS:
        given = parser_of(name).parse_args(args[1:])
        module = import_module(f"alpha5_model.cli.{name}")
        status: int | None = module.run(given)
        return status

    if name == "--version":
        from alpha5_model.kernels.choice import backend

        print(f"{__version__}, kernels: {backend()}")
        return 0
    if name in ("", "-h", "--help"):
        print(_help())
        return 0 if name else 2
    raise UnknownNameError("command", name, COMMANDS)


def _help() -> str:
    lines = [
        "usage: alpha5 [-h] [--version] COMMAND ...",
        "",
        "The Reach Alpha 5 arm: generate, check, solve, compute, look.",
        "",
        *(f"  {name:11}{summary}" for name, summary in COMMANDS.items()),
        "",
        "alpha5 COMMAND --help explains a command; --version also names the kernels.",
    ]
    return "\n".join(lines)


def _complain(message: str) -> int:
    """Print an error as one line."""
    print("alpha5:", _line(message), file=sys.stderr)
    return 2


def _line(message: str) -> str:
    """A message on one line; it may hold names from a file."""
    from alpha5_model._support.text import printable

    line = printable(" ".join(message.split()))
    # A file name may hold bytes that are not UTF-8, which stderr may refuse.
    return line.encode(errors="backslashreplace").decode()
