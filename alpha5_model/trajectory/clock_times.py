"""Times that are written as text: dates, times of day and durations, in seconds."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import date, datetime, timedelta, timezone

import numpy as np

from alpha5_model._support.checks import FloatArray

_FRACTION = r"(?:[.,](\d{1,30}))?"
_DATE = r"(\d{4})[-/](\d\d)[-/](\d\d)"
_TIME_OF_DAY = rf"(\d\d):(\d\d):(\d\d){_FRACTION}"
_ZONE = r"(?:(Z|UTC)|([+-])(\d\d):?(\d\d))?"
_ISO_TIME = re.compile(rf"{_DATE}[T ]{_TIME_OF_DAY} ?{_ZONE}", re.IGNORECASE)
_ISO_DATE = re.compile(_DATE)
#: ``11/27/2026`` or ``27/11/2026``: nobody can tell which of them is the month.
_SLASHED_DATE = re.compile(r"\d\d?/\d\d?/\d{2,4}(?!\d)")
_DOTTED_DATE = re.compile(r"(\d\d?)\.(\d\d?)\.(\d{4})")
#: ``10:00:00.02``, ``10:00:00.02 PM``, and pandas' ``0 days 00:00:00.020000``.
_CLOCK = re.compile(
    rf"(?:(-?\d{{1,6}}) days? \+?)?(\d{{1,4}}):(\d\d):(\d\d){_FRACTION}(?: ?([ap])m)?",
    re.IGNORECASE,
)
#: MATLAB's durations: ``0.02 sec``, ``1.5 min``.
_DURATION = re.compile(r"([+-]?\d{1,30}(?:\.\d{0,30})?) ?(sec|min|hr|day|s|h)s?", re.I)
_SECONDS_IN = {"s": 1, "sec": 1, "min": 60, "h": 3600, "hr": 3600, "day": 86400}
_DAY = 86400.0
_DATE_NAMES = ("date", "datum", "day")


@dataclass(frozen=True, eq=False)
class Clock:
    """How a column writes its times.

    Attributes:
        what: What a text of it is, for messages.
        seconds: Reads a text [s]; raises ValueError for another one.
        time_of_day: Whether the texts start again at midnight.
    """

    what: str
    seconds: Callable[[str], float]
    time_of_day: bool = False

    def without_midnight(self, time: FloatArray) -> FloatArray:
        """Times (N,) [s] that go on at midnight; NaN stays NaN."""
        if not self.time_of_day:
            return time
        known = np.flatnonzero(np.isfinite(time))
        days = np.cumsum(np.diff(time[known], prepend=time[known][:1]) < -_DAY / 2)
        going_on = time.copy()
        going_on[known] += _DAY * days
        return going_on


def clock_of(text: str) -> Clock | None:
    """How a text writes a time; None if it is no time."""
    clocks = (
        Clock("date and time", iso_seconds),
        Clock("time hh:mm:ss", _clock_seconds, time_of_day=True),
        Clock("duration", _duration_seconds),
    )
    for clock in clocks:
        try:
            clock.seconds(text)
        except ValueError:
            continue
        return clock
    return None


def is_slashed_date(text: str) -> bool:
    """Whether a text begins with a date whose day and month may be exchanged."""
    return _SLASHED_DATE.match(text.strip()) is not None


def is_date(name: str) -> bool:
    """Whether a column of this name holds dates."""
    return name.strip().lower() in _DATE_NAMES


def date_seconds(text: str) -> float:
    """Seconds from 1970 to a date, ``2026-11-27`` or ``27.11.2026``.

    Raises:
        ValueError: No such text, or a date that does not exist.
    """
    iso = _ISO_DATE.fullmatch(text.strip())
    dotted = _DOTTED_DATE.fullmatch(text.strip())
    if iso:
        year, month, day = map(int, iso.groups())
    elif dotted:
        day, month, year = map(int, dotted.groups())
    else:
        message = f"expected a date, got {text[:40]!r}"
        raise ValueError(message)
    return _DAY * (date(year, month, day) - date(1970, 1, 1)).days


def iso_seconds(text: str) -> float:
    """Seconds since 1970 of ``2026-11-23T18:53:54.25Z`` and the like.

    A blank may stand for the ``T`` and slashes for the hyphens. Times without a zone
    are read as UTC: a motion depends on their differences only.

    Raises:
        ValueError: No such text, or a date that does not exist.
    """
    match = _ISO_TIME.fullmatch(text.strip())
    if match is None:
        message = f"expected a date and a time, got {text[:40]!r}"
        raise ValueError(message)

    *date_and_time, fraction, _, sign, hours, minutes = match.groups()
    zone = timedelta(0)
    if sign:
        zone = timedelta(hours=int(hours), minutes=int(minutes))
        zone = -zone if sign == "-" else zone
    moment = datetime(*map(int, date_and_time), tzinfo=timezone(zone))  # type: ignore[arg-type,misc]
    return moment.timestamp() + float(f"0.{fraction or 0}")


def _clock_seconds(text: str) -> float:
    """Seconds of a time of day, or of a duration written like one."""
    match = _CLOCK.fullmatch(text.strip())
    if match is None or int(match[3]) > 59 or int(match[4]) > 60:
        message = f"expected hh:mm:ss, got {text[:40]!r}"
        raise ValueError(message)
    days, hours, minutes, whole, fraction, half = match.groups()
    hour = int(hours)
    if half:
        hour = hour % 12 + (12 if half in "pP" else 0)
    seconds = int(days or 0) * 86400 + hour * 3600 + int(minutes) * 60 + int(whole)
    return seconds + float(f"0.{fraction or 0}")


def _duration_seconds(text: str) -> float:
    """Seconds of a number with a unit of time."""
    match = _DURATION.fullmatch(text.strip())
    if match is None:
        message = f"expected a duration, got {text[:40]!r}"
        raise ValueError(message)
    return float(match[1]) * _SECONDS_IN[match[2].lower()]
