"""What a target draws: one call, and how its outcome is judged."""

from __future__ import annotations

import pickle
import signal
import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import FrameType
from typing import Any, NamedTuple, NoReturn

from fuzzing import watch
from fuzzing.values import Rng, wrong_answers

from alpha5_model.errors import Alpha5Error

#: An input that takes more processor time is a failure: a busy machine is none [s].
LIMIT = 30
#: So is a file that takes more processor time for each 100 kB, or for less [s].
LIMIT_OF_FILES = 2.0


@dataclass(frozen=True)
class Case:
    """One call.

    Attributes:
        call: To be called with ``arguments``.
        arguments: By name; printed if the case fails.
        hopeless: Only a refusal is right.
        size: Of the file that it reads, bytes; None if it reads none.
        told: Whether a warning of the package's own, or a refusal, is due.
    """

    call: Callable[..., Any]
    arguments: dict[str, Any]
    hopeless: bool = False
    size: int | None = None
    told: bool = False


#: Draws a case; the folder is its own, to read from and write into.
Target = Callable[[Rng, Path], Case]


class TooLongError(Exception):
    """Raised by the alarm."""


def outcome(case: Case, endless: frozenset[str] = frozenset()) -> str:
    """``"ok"``, ``"refused"``, or what is wrong.

    Args:
        case: Is called.
        endless: Parts of the answer that need not be finite.
    """
    try:
        run = _watched(case)
    except (Exception, SystemExit) as error:
        return f"{type(error).__name__}: {error}"

    foreign = [w for w in run.caught if not _own(w.category)]
    if run.misdeeds:
        return f"did what no file may make it do: {run.misdeeds[0]}"
    if case.size is not None and run.spent > LIMIT_OF_FILES * max(1.0, case.size / 1e5):
        return f"{run.spent:.1f} s for {case.size} bytes"
    if foreign:
        return f"{foreign[0].category.__name__}: {foreign[0].message}"
    if isinstance(run.answer, Alpha5Error):
        return _judged(run.answer)
    if case.hopeless:
        return "accepted what has no meaning"
    if case.told and not run.caught:
        return "accepted what is not plausible without a word"
    wrong = list(wrong_answers(run.answer, endless))
    return f"not finite: {', '.join(wrong[:3])}" if wrong else "ok"


class _Run(NamedTuple):
    """What happened during a call.

    Attributes:
        answer: The result, or the package's refusal.
        spent: Processor time [s].
        caught: Warnings.
        misdeeds: What no input may make the package do.
    """

    answer: Any
    spent: float
    caught: list[warnings.WarningMessage]
    misdeeds: list[str]


def _watched(case: Case) -> _Run:
    """Make the call; raises any error that is not the package's own."""
    with warnings.catch_warnings(record=True) as caught, watch.watching() as misdeeds:
        warnings.simplefilter("always")
        warnings.filterwarnings("ignore", "(overflow|underflow)", RuntimeWarning)
        signal.signal(signal.SIGPROF, _alarm)
        signal.setitimer(signal.ITIMER_PROF, LIMIT)
        begun = time.process_time()
        try:
            answer: Any = case.call(**case.arguments)
        except Alpha5Error as error:
            answer = error
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        spent = time.process_time() - begun
    return _Run(answer=answer, spent=spent, caught=caught, misdeeds=misdeeds)


def _own(category: type[Warning]) -> bool:
    """Whether it is a warning of the package's own."""
    return category.__module__.startswith("alpha5_model")


def _judged(error: Alpha5Error) -> str:
    if len(str(error).splitlines()) != 1:
        return f"{type(error).__name__}: not one line: {error}"
    try:
        again = pickle.loads(pickle.dumps(error))
    except Exception as problem:
        return f"{type(error).__name__} does not pickle: {problem}"
    if str(again) != str(error):
        return f"{type(error).__name__} changes in a pickle"
    return "refused"


def _alarm(number: int, frame: FrameType | None) -> NoReturn:
    raise TooLongError(f"longer than {LIMIT} s")
