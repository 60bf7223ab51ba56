"""TOML from other people: read in linear time, with one line for every mistake."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from typing import Any

from alpha5_model.errors import FileFormatError

#: A dotted key with more parts than any file has; ``tomllib`` takes minutes for a long
#: one.
_LONG_KEY = re.compile(
    r"""(?<![\w.-])(?:(?:[\w-]+|"[^"\n]*"|'[^'\n]*')[ \t]*\.[ \t]*){20}"""
)
#: A number with a unit behind it, which TOML has not; 0x, 0o and 0b are numbers.
_NUMBER_AND_UNIT = re.compile(
    r"^[^=#\n]+=[ \t]*([-+]?[\d.]+(?:e[-+]?\d+)?)[ \t]*"
    r"((?![xob])[a-z][\w/^*]*(?: [\w/^*]+)*)",
    re.MULTILINE | re.IGNORECASE,
)


def toml_tables(
    text: str, source: str, parse_float: Callable[[str], Any] = float
) -> dict[str, Any]:
    """The tables of a TOML text.

    Args:
        text: TOML.
        source: Name of its file, for messages.
        parse_float: Makes a number of each written float.

    Raises:
        FileFormatError: Not TOML, or keys or brackets nested too deep.
    """
    text = text.replace("\r\n", "\n")
    long_key = _LONG_KEY.search(text)
    if long_key:
        line = text.count("\n", 0, long_key.start()) + 1
        raise FileFormatError(source, "a key of more than 20 parts", f"line {line}")
    try:
        return tomllib.loads(text, parse_float=parse_float)
    except ValueError as error:
        # A TOMLDecodeError, or an integer of more than 4300 digits.
        written = _NUMBER_AND_UNIT.search(text)
        if written is None:
            raise FileFormatError(source, str(error)) from None
        number, unit = written.groups()
        problem = (
            f"expected {number} without its unit; an arm file also takes "
            f'{{value = {number}, unit = "{unit}"}}'
        )
        line = text.count("\n", 0, written.start(1)) + 1
        raise FileFormatError(source, problem, f"line {line}") from None
    except RecursionError:
        problem = "expected fewer brackets inside one another"
        raise FileFormatError(source, problem) from None
