"""Every public name with its parameters, and the command line: `public_api.txt`.

After a change that you meant, run this file as a script: it rewrites the list.
"""

from __future__ import annotations

import dataclasses
import inspect
import pkgutil
import re
import sys
from collections.abc import Iterator, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

import alpha5_model as a5

LIST = Path(__file__).parents[1] / "public_api.txt"
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


def every_class() -> dict[str, type]:
    """Name -> class of the package, which functions may return."""
    found = {}
    for info in pkgutil.walk_packages(a5.__path__, "alpha5_model."):
        if not info.name.endswith("__main__"):
            found.update(vars(import_module(info.name)))
    return {name: value for name, value in found.items() if is_ours(value)}


def is_ours(value: Any) -> bool:
    return inspect.isclass(value) and value.__module__.startswith("alpha5_model")


def public(module: Any) -> list[str]:
    if hasattr(module, "__all__"):
        return list(module.__all__)
    own = {
        name: value
        for name, value in vars(module).items()
        if getattr(value, "__module__", module.__name__) == module.__name__
    }
    return [
        name
        for name, value in own.items()
        if not name.startswith("_")
        and name != "annotations"
        and not inspect.ismodule(value)
    ]


def parameters(function: Any) -> str:
    """Names of the parameters; those with a default end in ``=...``."""
    found = [
        p.replace(annotation=p.empty, default=p.empty if p.default is p.empty else ...)
        for p in inspect.signature(function).parameters.values()
    ]
    return str(inspect.Signature(found)).replace("=Ellipsis", "=...")


class Names:
    """Collects a line for each public name, also of what functions return."""

    def __init__(self) -> None:
        self.lines: set[str] = set()
        self._classes = every_class()
        self._shown: set[type] = set()
        self._returned: list[type] = []

    def show(self, name: str, value: Any) -> None:
        """Add a public name, and all names below it."""
        if inspect.ismodule(value):
            for member in public(value):
                self.show(f"{name}.{member}", getattr(value, member))
        elif inspect.isclass(value) and issubclass(value, Exception):
            bases = ", ".join(base.__name__ for base in value.__bases__)
            self.lines.add(f"{name}: {bases}")
        elif inspect.isclass(value):
            self.lines.add(f"{name}{parameters(value)}")
            self._show_members(name, value)
        elif callable(value):
            self.lines.add(f"{name}{parameters(value)}")
            self._note_result(value)
        else:
            self.lines.add(name)

    def show_returned(self) -> None:
        """Add the members of the classes that were not shown by a name of their own."""
        while self._returned:
            record = self._returned.pop()
            if record not in self._shown:
                self._show_members(f"-> {record.__name__}", record)

    def _show_members(self, name: str, value: type) -> None:
        self._shown.add(value)
        fields = dataclasses.fields(value) if dataclasses.is_dataclass(value) else ()
        for field in fields:
            if field.name.startswith("_"):
                continue
            self.lines.add(f"{name}.{field.name}")
            self._note(field.type, vars(sys.modules[value.__module__]))
        for base in filter(is_ours, value.__mro__):
            for member, held in vars(base).items():
                function = getattr(held, "__func__", held)
                if member.startswith("_"):
                    continue
                if inspect.isfunction(function):
                    self.show(f"{name}.{member}", function)
                else:
                    self.lines.add(f"{name}.{member}")
                    self._note_result(getattr(held, "fget", None))

    def _note_result(self, function: Any) -> None:
        hints = getattr(function, "__annotations__", {})
        self._note(hints.get("return"), getattr(function, "__globals__", {}))

    def _note(self, annotation: Any, names: Mapping[str, Any]) -> None:
        """Remember our classes that an annotation names."""
        for word in re.findall(r"(?<![\w.])\w+", str(annotation)):
            record = names.get(word, self._classes.get(word))
            if is_ours(record):
                self._returned.append(record)


def command_line() -> Iterator[str]:
    import typer.main

    from alpha5_model.cli import COMMANDS, application

    commands: Any = typer.main.get_command(application(*COMMANDS))
    for name, command in commands.commands.items():
        yield f"alpha5 {name}"
        for parameter in command.params:
            yield from (f"alpha5 {name} {option}" for option in parameter.opts)


def listed() -> list[str]:
    names = Names()
    for name in a5.__all__:
        names.show(f"a5.{name}", getattr(a5, name))
    for name, module in MODULES.items():
        names.show(name, import_module(f"alpha5_model.{module}"))
    names.show_returned()
    return sorted(names.lines | set(command_line()))


@pytest.mark.slow
def test_no_public_name_is_lost_or_added_unseen() -> None:
    recorded = LIST.read_text("utf-8").splitlines()
    current = listed()
    assert len(current) > 500
    assert sorted(set(recorded) - set(current)) == []
    assert sorted(set(current) - set(recorded)) == []


if __name__ == "__main__":
    LIST.write_text("\n".join(listed()) + "\n", "utf-8")
