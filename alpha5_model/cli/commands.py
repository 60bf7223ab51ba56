"""The commands of ``alpha5``, and the typer application that is made of them."""

from __future__ import annotations

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from alpha5_model import __version__

#: In the order of ``alpha5 --help``; each is a function in the module of its name.
COMMANDS = (
    "demo",
    "generate",
    "check",
    "arm",
    "compare",
    "torque",
    "trajectory",
    "fk",
    "ik",
    "move",
    "workspace",
    "dh",
    "planar",
    "view",
    "sweep",
    "calibrate",
)
#: Commands whose arguments are numbers. A word such as -0.1 is an argument there, not
#: an unknown option.
_WITH_NUMBERS = ("fk", "ik", "move", "dh", "planar")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"{__version__}, kernels: {_kernels()}")
        raise typer.Exit


def _kernels() -> str:
    """Which kernels run, so that an install without a compiler is visible."""
    from alpha5_model.kernels.choice import backend

    return backend()


_VERSION = typer.Option(
    "--version",
    callback=_print_version,
    help="Print the version, and which kernels run.",
)


def _root(version: Annotated[bool, _VERSION] = False) -> None:
    """The Reach Alpha 5 arm: generate, check, solve, compute, look."""


def application(*commands: str) -> typer.Typer:
    """The application with these commands.

    Args:
        commands: Names from `COMMANDS`. Without any, the application has all commands,
            but only their help: this loads none of their modules.
    """
    app = typer.Typer(
        name="alpha5",
        add_completion=False,
        context_settings={"help_option_names": ["-h", "--help"]},
    )
    app.callback(no_args_is_help=True)(_root)

    for name in commands or COMMANDS:
        function = command_function(name) if commands else _outline(name)
        settings = {"ignore_unknown_options": True} if name in _WITH_NUMBERS else None
        app.command(name, context_settings=settings)(function)
    return app


def command_function(name: str) -> Callable[..., Any]:
    """The function of a command; this loads its module and what that needs."""
    module = import_module(f"alpha5_model.cli.{name}")
    function: Callable[..., Any] = getattr(module, name)
    return function


def _outline(name: str) -> Callable[[], None]:
    """A function that does nothing and has a command's help, read without an import."""
    source = Path(__file__).with_name(f"{name}.py").read_text(encoding="utf-8")
    (command,) = (
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef) and node.name == name
    )

    def outline() -> None: ...

    outline.__doc__ = ast.get_docstring(command)
    return outline
