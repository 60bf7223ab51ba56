"""Every public name and signature, command line included, against the committed list `public_api.txt`.

Names may be added, and parameters that have a default; none may be lost or changed. After an addition run
this file as a script: it rewrites the list.
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
#: Modules whose names people use, beside what `alpha5_model` itself exports: name -> where it is.
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
    """Name -> class, of the whole package: what annotations may name without importing it."""
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


def surface() -> list[str]:
    """One line for every public name, sorted."""
    lines: dict[str, None] = {}
    classes = own_classes()
    results: list[type] = []
    shown: set[type] = set()

    def returned(value: Any) -> None:
        spaces = {**classes, **getattr(value, "__globals__", {})}
        hints = getattr(value, "__annotations__", {})
        if "return" in hints:
            results.extend(mentioned(eval(hints["return"], spaces)))

    def show_class(name: str, value: type, constructed: bool) -> None:
        shown.add(value)
        if constructed:
            lines[f"{name}{signature(value)}"] = None
        fields = (
            [f.name for f in dataclasses.fields(value)]
            if dataclasses.is_dataclass(value)
            else []
        )
        for member in sorted({*fields, *dir(value)}):
            if member.startswith("_"):
                continue
            held = inspect.getattr_static(value, member, None)
            owner = next((c for c in value.__mro__ if member in vars(c)), value)
            if not owner.__module__.startswith("alpha5_model"):
                continue
            if isinstance(held, staticmethod | classmethod):
                held = held.__func__
            if isinstance(held, types.FunctionType):
                lines[f"{name}.{member}{signature(held)}"] = None
                returned(held)
            else:
                lines[f"{name}.{member}"] = None
                if isinstance(held, property):
                    returned(held.fget)
        for field in dataclasses.fields(value) if fields else ():
            spaces = {**classes, **vars(sys.modules[value.__module__])}
            results.extend(mentioned(eval(str(field.type), spaces)))

    def show(name: str, value: Any) -> None:
        if inspect.ismodule(value):
            lines[name] = None
            for member in public(value):
                show(f"{name}.{member}", getattr(value, member))
        elif inspect.isclass(value) and issubclass(value, Exception):
            lines[f"{name}: {', '.join(base.__name__ for base in value.__bases__)}"] = (
                None
            )
        elif inspect.isclass(value):
            show_class(name, value, constructed=True)
        elif callable(value):
            lines[f"{name}{signature(value)}"] = None
            returned(value)
        else:
            lines[name] = None

    for name in a5.__all__:
        show(f"a5.{name}", getattr(a5, name))
    for name, module in MODULES.items():
        show(name, import_module(f"alpha5_model.{module}"))
    while results:
        record = results.pop()
        if record not in shown:
            show_class(f"-> {record.__name__}", record, constructed=False)
    lines.update(dict.fromkeys(command_line()))
    return sorted(lines)


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
