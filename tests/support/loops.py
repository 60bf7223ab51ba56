"""Long lists of cases in one test, which says of each case that failed why."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any


def each(
    names: str | tuple[str, ...], cases: Iterable[Any]
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call a test for each case, as one test; pytest's parametrize makes many.

    Args:
        names: Of the arguments, one as text, several as a tuple.
        cases: Values of the one argument, or tuples of those of several.
    """
    cases = list(cases)
    assert cases
    keys = (names,) if isinstance(names, str) else names

    def of(test: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(test)
        def run(*args: Any, **kwargs: Any) -> None:
            failures: list[Exception] = []
            for case in cases:
                values = (case,) if isinstance(names, str) else case
                given = dict(zip(keys, values, strict=True))
                try:
                    test(*args, **kwargs, **given)
                except Exception as error:  # any failure is collected
                    error.add_note(f"case: {case!r:.200}")
                    failures.append(error)
            if failures:
                raise ExceptionGroup(f"{len(failures)} of {len(cases)}", failures)

        signature = inspect.signature(test)
        rest = [p for name, p in signature.parameters.items() if name not in keys]
        run.__signature__ = signature.replace(parameters=rest)  # type: ignore[attr-defined]
        return run

    return of
