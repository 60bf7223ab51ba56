"""What a target draws: one call, and how its outcome is judged."""

from __future__ import annotations

import pickle
import signal
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

from alpha5_model.errors import Alpha5Error, ImplausibleWarning
from fuzzing.values import Rng, wrong_answers

#: An input that takes longer is a failure [s].
LIMIT = 30


@dataclass(frozen=True)
class Case:
    """One call.

    Attributes:
        call: To be called with ``arguments``.
        arguments: By name; printed if the case fails.
        hopeless: Only a refusal is right.
    """

    call: Callable[..., Any]
    arguments: dict[str, Any]
    hopeless: bool = False


#: Draws a case; the folder is its own, to read from and write into.
Target = Callable[[Rng, Path], Case]


class TooLongError(Exception):
    """Raised by the alarm."""


def outcome(case: Case, endless: frozenset[str] = frozenset()) -> str:
    """``"ok"``, ``"refused"``, or what is wrong; parts named in ``endless`` need not be finite."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Most of what is drawn is implausible; that it raises nothing else is the point.
        warnings.simplefilter("ignore", ImplausibleWarning)
        warnings.filterwarnings("ignore", "(overflow|underflow)", RuntimeWarning)
        signal.signal(signal.SIGALRM, _alarm)
        signal.alarm(LIMIT)
        try:
            result = case.call(**case.arguments)
        except Alpha5Error as error:
            return _judged(error)
        except (Exception, SystemExit) as error:
            return f"{type(error).__name__}: {error}"
        finally:
            signal.alarm(0)
    if case.hopeless:
        return "accepted what has no meaning"
    wrong = list(wrong_answers(result, endless))
    return f"not finite: {', '.join(wrong[:3])}" if wrong else "ok"


def _judged(error: Alpha5Error) -> str:
    if len(str(error).splitlines()) != 1:
        return f"{type(error).__name__}: not one line: {error}"
    try:
        again = pickle.loads(pickle.dumps(error))
    except Exception as problem:
        return f"{type(error).__name__} does not pickle: {problem}"
    return "refused" if str(again) == str(error) else f"{type(error).__name__} changes in a pickle"


def _alarm(number: int, frame: FrameType | None) -> NoReturn:
    raise TooLongError(f"longer than {LIMIT} s")
