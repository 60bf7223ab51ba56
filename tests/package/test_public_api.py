"""Every public name and signature, and the command line, as in `public_api.txt`.

Names may be added, and parameters that have a default; none may be lost or changed.
After an addition run this file as a script: it rewrites the list.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import pkgutil
import re
import sys
import types
import typing
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import alpha5_model as a5

SNAPSHOT = Path(__file__).parents[1] / "public_api.txt"
#: Name -> where it is, of the modules that people use besides `alpha5_model` itself.
MODULES = {
    "errors": "errors",
    "inertia": "numbers.inertia",
    "corrections": "numbers.corrections",
    "fluids": "numbers.fluids",
    "paths": "_support.paths",
    "casadi": "casadi",
    "jax": "jax",
}


def own_classes() -> dict[str, Any]:
    """Name -> class of the whole package, which annotations may name unimported."""
    found = {}
    for info in pkgutil.walk_packages(a5.__path__, "alpha5_model."):
        if not info.name.endswith("__main__"):
            found.update(vars(import_module(info.name)))
    return {name: value for name, value in found.items() if inspect.isclass(value)}


def public(module: Any) -> list[str]:
    if hasattr(module, "__all__"):
        return sorted(module.__all__)
    return sorted(
        name
        for name, value in vars(module).items()
        if not name.startswith("_")
        and not inspect.ismodule(value)
        and getattr(value, "__module__", module.__name__) == module.__name__
        and name != "annotations"
    )


def signature(value: Any) -> str:
    parameters = [
        p.replace(
            annotation=p.empty,
            default=p.default
            if p.default is p.empty or re.fullmatch(r"[-\w.,'()\s/]+", repr(p.default))
            else ...,
        )
        for p in inspect.signature(value).parameters.values()
    ]
    text = str(inspect.Signature(parameters))
    return text.replace("=Ellipsis", "=...").replace("='nan'", "=nan")


def mentioned(annotation: Any) -> Iterator[type]:
    if inspect.isclass(annotation) and annotation.__module__.startswith("alpha5_model"):
        yield annotation
    for part in typing.get_args(annotation):
        yield from mentioned(part)


class Surface:
    """Collects one line for every public name, and the records that are returned."""

    def __init__(self) -> None:
        self.lines: set[str] = set()
        self._classes = own_classes()
        self._results: list[type] = []
        self._shown: set[type] = set()

    def show(self, name: str, value: Any) -> None:
        """Add a public name, and all names below it."""
        if inspect.ismodule(value):
            self.lines.add(name)
            for member in public(value):
                self.show(f"{name}.{member}", getattr(value, member))
        elif inspect.isclass(value) and issubclass(value, Exception):
            bases = ", ".join(base.__name__ for base in value.__bases__)
            self.lines.add(f"{name}: {bases}")
        elif inspect.isclass(value):
            self.lines.add(f"{name}{signature(value)}")
            self._show_class(name, value)
        elif callable(value):
            self.lines.add(f"{name}{signature(value)}")
            self._follow_result(value)
        else:
            self.lines.add(name)

    def show_results(self) -> None:
        """Add the classes that functions return and that have no name of their own."""
        while self._results:
            record = self._results.pop()
            if record not in self._shown:
                self._show_class(f"-> {record.__name__}", record)

    def _show_class(self, name: str, value: type) -> None:
        self._shown.add(value)
        is_record = dataclasses.is_dataclass(value)
        fields = dataclasses.fields(value) if is_record else ()
        for member in sorted({*(field.name for field in fields), *dir(value)}):
            if not member.startswith("_"):
                self._show_member(name, value, member)
        spaces = {**self._classes, **vars(sys.modules[value.__module__])}
        for field in fields:
            self._results.extend(mentioned(eval(str(field.type), spaces)))

    def _show_member(self, name: str, value: type, member: str) -> None:
        owner = next((c for c in value.__mro__ if member in vars(c)), value)
        if not owner.__module__.startswith("alpha5_model"):
            return
        held = inspect.getattr_static(value, member, None)
        if isinstance(held, staticmethod | classmethod):
            held = held.__func__
        if isinstance(held, types.FunctionType):
            self.lines.add(f"{name}.{member}{signature(held)}")
            self._follow_result(held)
            return
        self.lines.add(f"{name}.{member}")
        if isinstance(held, property):
            self._follow_result(held.fget)

    def _follow_result(self, function: Any) -> None:
        """Note the classes of the package that a function returns."""
        spaces = {**self._classes, **getattr(function, "__globals__", {})}
        hints = getattr(function, "__annotations__", {})
        if "return" in hints:
            self._results.extend(mentioned(eval(hints["return"], spaces)))


def surface() -> list[str]:
    """One line for every public name, sorted."""
    found = Surface()
    for name in a5.__all__:
        found.show(f"a5.{name}", getattr(a5, name))
    for name, module in MODULES.items():
        found.show(name, import_module(f"alpha5_model.{module}"))
    found.show_results()
    return sorted(found.lines | set(command_line()))


def command_line() -> Iterator[str]:
    import typer.main

    from alpha5_model.cli import COMMANDS, application

    app = application(*COMMANDS)

    for name, command in typer.main.get_command(app).commands.items():  # type: ignore[attr-defined]
        yield f"alpha5 {name}"
        for parameter in command.params:
            yield from (f"alpha5 {name} {option}" for option in parameter.opts)


def lost(recorded: list[str], current: list[str]) -> list[str]:
    """Recorded lines that no current line keeps."""
    now = {line.partition("(")[0]: line for line in current}
    return [
        line
        for line in recorded
        if not keeps(line, now.get(line.partition("(")[0], ""))
    ]


def keeps(before: str, now: str) -> bool:
    if before == now or "(" not in before or "(" not in now:
        return before == now
    old, new = arguments(before), arguments(now)
    positional = [entry for entry in old if entry[0] == "positional"]
    return (
        new[: len(positional)] == positional
        and set(old) <= set(new)
        and all(entry[2] for entry in set(new) - set(old))
    )


def arguments(line: str) -> list[tuple[str, str, str]]:
    """Kind, name and default (empty if there is none) of every parameter, in order."""
    definition = ast.parse(f"def f({line.partition('(')[2]}: ...").body[0]
    assert isinstance(definition, ast.FunctionDef)
    a = definition.args
    names = [*a.posonlyargs, *a.args]
    defaults = [None] * (len(names) - len(a.defaults)) + list(a.defaults)
    found = [
        ("positional", n.arg, ast.unparse(d) if d else "")
        for n, d in zip(names, defaults, strict=True)
    ]
    found += [
        ("keyword", n.arg, ast.unparse(d) if d else "")
        for n, d in zip(a.kwonlyargs, a.kw_defaults, strict=True)
    ]
    for kind, rest in (("*", a.vararg), ("**", a.kwarg)):
        found += [(kind, rest.arg, "any")] if rest else []
    return found


def test_no_public_name_or_signature_is_lost() -> None:
    recorded = SNAPSHOT.read_text("utf-8").splitlines()
    assert len(recorded) > 500
    assert lost(recorded, surface()) == []


@pytest.mark.parametrize(
    ("before", "now", "kept"),
    [
        ("f(a, b=1)", "f(a, b=1, c=2)", True),
        ("f(a, *, b=1)", "f(a, *, c=2, b=1)", True),
        ("f(a)", "f(a, b)", False),
        ("f(a, b=1)", "f(a, b=2)", False),
        ("f(a, b)", "f(b, a)", False),
        ("f(a, b=1)", "f(a, *, b=1)", False),
        ("f(a)", "f()", False),
        ("f(a)", "g(a)", False),
        ("f(a, /)", "f", False),
        ("f", "g", False),
    ],
)
def test_what_counts_as_lost(before: str, now: str, kept: bool) -> None:
    assert (lost([before], [now]) == []) == kept


if __name__ == "__main__":
    SNAPSHOT.write_text("\n".join(surface()) + "\n", "utf-8")
