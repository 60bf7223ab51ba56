"""Every public name of the package, with what it names."""

from __future__ import annotations

import dataclasses
import inspect
import pkgutil
import re
import sys
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from typing import Any

import alpha5_model as a5

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


class PublicNames:
    """Collects public names, also those of what functions return.

    Attributes:
        lines: One for each name, with its parameters.
        functions: Name -> function, method or class.
    """

    def __init__(self) -> None:
        self.lines: set[str] = set()
        self.functions: dict[str, Any] = {}
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
            self.functions[name] = value
            self.lines.add(f"{name}{parameters(value)}")
            self._show_members(name, value)
        elif callable(value):
            self.functions[name] = value
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
        for member in dir(value):
            # None takes a method away that a base class has.
            held = inspect.getattr_static(value, member)
            owner = next(base for base in value.__mro__ if member in vars(base))
            if member.startswith("_") or not is_ours(owner) or held is None:
                continue
            function = getattr(held, "__func__", held)
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


@cache
def public_names() -> PublicNames:
    """All of them; a name of what a function returns starts with ``->``."""
    names = PublicNames()
    for name in a5.__all__:
        names.show(f"a5.{name}", getattr(a5, name))
    for name, module in MODULES.items():
        names.show(name, import_module(f"alpha5_model.{module}"))
    names.show_returned()
    return names
