"""Arguments and attributes with a new name, whose old one still works for a while."""

from __future__ import annotations

import functools
import inspect
import warnings
from collections.abc import Callable
from typing import Any, TypeVar

from alpha5_model.errors import InputError

Named = TypeVar("Named", bound=Callable[..., Any])


def renamed(old: str, new: str) -> Callable[[Named], Named]:
    """Decorator that lets the old name of an argument stand for the new one.

    Of a class, it decorates all methods that have the argument, and lets an attribute
    with the new name be read by the old one.

    Warns:
        DeprecationWarning: The old name is used.
    """

    def decorated(named: Named) -> Named:
        if isinstance(named, type):
            for name, method in list(vars(named).items()):
                public = not name.startswith("_") or name == "__init__"
                if public and inspect.isfunction(method) and new in _arguments(method):
                    setattr(named, name, decorated(method))
            setattr(named, old, property(read_by_old_name))
            return named

        @functools.wraps(named)
        def call(*args: Any, **keywords: Any) -> Any:
            if old in keywords:
                is_positional = _arguments(named).index(new) < len(args)
                if new in keywords or is_positional:
                    raise InputError(old, keywords[old], f"only {new}, its new name")
                warn()
                keywords[new] = keywords.pop(old)
            return named(*args, **keywords)

        return call  # type: ignore[return-value]

    def read_by_old_name(self: Any) -> Any:
        """The attribute by its old name."""
        warn()
        return getattr(self, new)

    def warn() -> None:
        text = f"{old} is deprecated; its name is {new}"
        warnings.warn(text, DeprecationWarning, stacklevel=3)

    return decorated


def _arguments(function: Callable[..., Any]) -> tuple[str, ...]:
    code = function.__code__
    return tuple(code.co_varnames[: code.co_argcount + code.co_kwonlyargcount])
