"""Dates with a time of day, as ISO 8601 writes them, in seconds."""

from __future__ import annotations

import re
from datetime import datetime, timedelta, timezone

_DATE = r"(\d{4})[-/](\d\d)[-/](\d\d)"
_TIME_OF_DAY = r"(\d\d):(\d\d):(\d\d)(?:[.,](\d{1,30}))?"
_ZONE = r"(?:(Z|UTC)|([+-])(\d\d):?(\d\d))?"
_ISO_TIME = re.compile(rf"{_DATE}[T ]{_TIME_OF_DAY} ?{_ZONE}", re.IGNORECASE)


def is_iso_time(text: str) -> bool:
    """Whether a text is a date and a time of day."""
    try:
        iso_seconds(text)
    except ValueError:
        return False
    return True


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
