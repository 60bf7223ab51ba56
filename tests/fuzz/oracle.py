"""Judges a call with any input: an answer, or the package's own error in one line.

These are failures: another exception, a refusal of several lines or one that a pickle
changes, NaN in an answer, an answer to an input without meaning, a warning that is not
the package's own, a program that is started or a file that is opened because an input
says so, and a time that does not fit the size of a file.
"""

from __future__ import annotations

import dataclasses
import os
import pickle
import signal
import time
import warnings
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any, NoReturn

import numpy as np
import watch
from hypothesis import HealthCheck, settings

from alpha5_model.errors import Alpha5Error

#: Inputs of each test: a few, always the same, or as many new ones as `make fuzz` asks.
EXAMPLES = os.environ.get("ALPHA5_FUZZ_EXAMPLES")
fuzzed = settings(
    max_examples=int(EXAMPLES or 25),
    derandomize=not EXAMPLES,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
#: Processor time that is too long for any input, and for each 100 kB of a file [s].
LONGEST, LONGEST_OF_FILES = 60, 5.0


class WrongOutcomeError(AssertionError):
    """What no input may lead to."""


def answer(
    call: Callable[[], Any],
    *,
    hopeless: bool = False,
    size: int | None = None,
    infinite: frozenset[str] = frozenset(),
    silent: bool = True,
) -> Any:
    """The answer of a call, or the package's refusal.

    Args:
        call: To be made.
        hopeless: Whether only a refusal is right.
        size: Of the file that is read, bytes.
        infinite: Parts of the answer that may be NaN or infinite, as documented.
        silent: Whether an answer without a warning of the package is right.

    Raises:
        WrongOutcomeError: See the top of this file.
    """
    with warnings.catch_warnings(record=True) as caught, watch.watching() as misdeeds:
        warnings.simplefilter("always")
        warnings.filterwarnings("ignore", "(overflow|underflow)", RuntimeWarning)
        signal.signal(signal.SIGPROF, _too_long)
        signal.setitimer(signal.ITIMER_PROF, LONGEST)
        begun = time.process_time()
        try:
            found = call()
        except Alpha5Error as error:
            found = error
        except (Exception, SystemExit) as error:
            raise WrongOutcomeError(f"{type(error).__name__}: {error}") from error
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
        spent = time.process_time() - begun

    if misdeeds:
        raise WrongOutcomeError(f"did what no input may make it do: {misdeeds[0]}")
    if size is not None and spent > LONGEST_OF_FILES * max(1.0, size / 1e5):
        raise WrongOutcomeError(f"{spent:.1f} s for {size} bytes")
    own = [w for w in caught if w.category.__module__.startswith("alpha5_model")]
    for warning in caught:
        if warning not in own:
            raise WrongOutcomeError(f"{warning.category.__name__}: {warning.message}")
    if isinstance(found, Alpha5Error):
        _check_refusal(found)
        return found
    if hopeless:
        raise WrongOutcomeError("accepted what has no meaning")
    if not silent and not own:
        raise WrongOutcomeError("accepted what is not plausible without a word")
    wrong = [place for place in _not_finite(found, infinite) if place]
    if wrong:
        raise WrongOutcomeError(f"not finite: {', '.join(wrong[:3])}")
    return found


def _too_long(number: int, frame: FrameType | None) -> NoReturn:
    raise TimeoutError(f"longer than {LONGEST} s")


def _check_refusal(error: Alpha5Error) -> None:
    if len(str(error).splitlines()) != 1:
        raise WrongOutcomeError(f"{type(error).__name__}: not one line: {error}")
    try:
        again = pickle.loads(pickle.dumps(error))
    except Exception as problem:
        raise WrongOutcomeError(
            f"{type(error).__name__} does not pickle: {problem}"
        ) from None
    if str(again) != str(error):
        raise WrongOutcomeError(f"{type(error).__name__} changes in a pickle")


def _not_finite(found: Any, infinite: frozenset[str]) -> Iterator[str]:
    """Places of NaN or infinity in an answer."""
    for place, numbers in leaves(found):
        names = {part.partition("[")[0] for part in place.split(".")}
        if numbers.dtype.kind in "fc" and not names & infinite:
            yield "" if np.isfinite(numbers).all() else place


def leaves(found: Any, place: str = "answer") -> Iterator[tuple[str, np.ndarray]]:
    """All arrays and numbers of an answer, with their places."""
    if isinstance(found, np.ndarray | float | int | bool):
        yield place, np.asarray(found)
    elif hasattr(found, "homogeneous"):
        yield place, np.asarray(found.homogeneous)
    elif type(found).__name__ in ("Force", "Motion") and hasattr(found, "vector"):
        yield place, np.asarray(found.vector)
    elif hasattr(found, "_asdict"):
        yield from leaves(found._asdict(), place)
    elif dataclasses.is_dataclass(found) and not isinstance(found, type):
        for field in dataclasses.fields(found):
            yield from leaves(getattr(found, field.name), f"{place}.{field.name}")
    elif isinstance(found, dict):
        for key, value in found.items():
            yield from leaves(value, f"{place}.{key}")
    elif isinstance(found, tuple | list):
        for k, value in enumerate(found):
            yield from leaves(value, f"{place}[{k}]")
