"""The tables of an arm file, checked key by key."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers import arm_schema
from alpha5_model.numbers.arm_schema import Key
from alpha5_model.numbers.parameters import Measurement

#: Largest magnitude of a written number.
_LARGEST = 1e12
#: Most characters of a foreign text in a message.
_LONGEST = 40
_NUMBER = re.compile(r"\d[\d.]*")
_WHOLE = ("value", "unit", "source", "half_width")


class ArmFileError(Exception):
    """What is wrong with a value; the reader adds the file's name.

    Attributes:
        key: Of the value, for example ``links.link_2.mass``; empty for the whole file.
        problem: What was given, what was expected.
    """

    def __init__(self, key: str, problem: str) -> None:
        self.key = key
        self.problem = problem
        super().__init__(f"{key}: {problem}" if key else problem)


@dataclass(frozen=True, eq=False)
class Value:
    """A value in SI units.

    Attributes:
        key: Its key in the file, for example ``links.link_2.mass``.
        number: A number, (3,) or (3, 3), in SI units.
        written: The same as in the file, with its unit, for messages.
        measurement: Its source and half width; None without both.
    """

    key: str
    number: FloatArray
    written: str
    measurement: Measurement | None


def table(key: str, given: Any, names: Iterable[str]) -> dict[str, Any]:
    """A table without unknown keys.

    Args:
        key: Its own key; empty for the file.
        given: What the file has there.
        names: The keys that it may have.

    Raises:
        ArmFileError: Not a table, or an unknown key, with the nearest known one.
    """
    if not isinstance(given, dict):
        raise ArmFileError(key, f"{shown(given)}; expected a table")
    known = tuple(names)
    for name in given:
        if name not in known:
            raise ArmFileError(key, _unknown(name, known))
    return given


def one_of(key: str, given: Any, names: Iterable[str]) -> str:
    """A text that is one of some names.

    Raises:
        ArmFileError: Anything else.
    """
    known = tuple(names)
    if not isinstance(given, str):
        problem = f"{shown(given)}; expected a text, one of {', '.join(known)}"
        raise ArmFileError(key, problem)
    if given not in known:
        raise ArmFileError(key, _unknown(given, known))
    return given


def values(
    key: str, given: Mapping[str, Any], keys: Mapping[str, Key]
) -> dict[str, Value]:
    """The values of a table, by name; keys that are not there are left out.

    Args:
        key: Of the table.
        given: The table, without unknown keys.
        keys: The schema of the table.
    """
    return {
        name: value(f"{key}.{name}", given[name], schema)
        for name, schema in keys.items()
        if name in given
    }


def value(key: str, given: Any, schema: Key) -> Value:
    """A value: a number or nested list of them, or a table with ``value``.

    Raises:
        ArmFileError: Anything else, another unit, an impossible number.
    """
    whole = given
    if not isinstance(given, dict):
        whole = {"value": given}
    table(key, whole, _WHOLE)
    if "value" not in whole:
        raise ArmFileError(key, f"no value; write {key} = {{value = ...}}")

    unit = _unit(key, whole, schema)
    numbers = _numbers(key, whole["value"], schema.shape)
    in_si = [schema.dimension.in_si(number, unit) for number in numbers]
    array = np.array(in_si).reshape(schema.shape)
    written = f"{_as_written(whole['value'])} {unit}".removesuffix(" 1")
    _check_size(key, array, written, unit, schema)
    if schema.shape == (3, 3) and not np.array_equal(array, array.T):
        raise ArmFileError(key, f"{written}; expected a symmetric tensor")
    return Value(
        key=key,
        number=array,
        written=written,
        measurement=_measurement(key, whole, unit, array, schema),
    )


def shown(given: Any) -> str:
    """A foreign value on one line, cut."""
    text = repr(str(given) if isinstance(given, Decimal) else given)
    text = text.strip("'") if isinstance(given, Decimal) else text
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _unknown(name: str, known: tuple[str, ...]) -> str:
    """The problem of an unknown key or name, and what may be meant."""
    problem = f"unknown {shown(name)}"
    if name in arm_schema.HINTS:
        return f"{problem}; {arm_schema.HINTS[name]}"
    if name.startswith(arm_schema.TWISTS):
        return (
            f"{problem}; axes are parallel or square as in Table 1, because the "
            "closed-form inverse kinematics has no twisted or shifted ones"
        )
    near = difflib.get_close_matches(name[:_LONGEST], known, n=1)
    if near:
        return f"{problem}, did you mean {near[0]!r}?"
    return f"{problem}; choose from {', '.join(known)}"


def _unit(key: str, whole: Mapping[str, Any], schema: Key) -> str:
    """The unit of a value, one of its dimension's."""
    dimension = schema.dimension
    if "unit" not in whole:
        return dimension.si
    given = whole["unit"]
    found = dimension.unit(given) if isinstance(given, str) else None
    if found is None:
        units = ", ".join(dimension.units)
        raise ArmFileError(key, f"unit {shown(given)}; expected one of {units}")
    return found


def _numbers(key: str, given: Any, shape: tuple[int, ...]) -> list[Decimal]:
    """The numbers of a nested list of a shape, in one list."""
    if not shape:
        return [_number(key, given)]
    what = "3 numbers" if len(shape) == 1 else "3 rows of 3 numbers"
    if not isinstance(given, list) or len(given) != shape[0]:
        raise ArmFileError(key, f"{shown(given)}; expected {what}")
    found = []
    for i, item in enumerate(given):
        found += _numbers(f"{key}[{i}]", item, shape[1:])
    return found


def _number(key: str, given: Any) -> Decimal:
    """A finite number of a usual size."""
    if isinstance(given, bool) or not isinstance(given, int | Decimal):
        raise ArmFileError(key, f"{shown(given)}; expected a number")
    number = Decimal(given)
    if not number.is_finite() or number.copy_abs() > _LARGEST:
        raise ArmFileError(key, f"{shown(given)}; expected a number below 1e12")
    return number


def _check_size(
    key: str, number: FloatArray, written: str, unit: str, schema: Key
) -> None:
    """Refuse numbers that are too small, or that no arm of this size has."""
    dimension = schema.dimension
    least = schema.least
    low = float(number.min())
    if least is not None and (low < least or (schema.above and low == least)):
        bound = "more than" if schema.above else "at least"
        expected = f"{bound} {least:g} {dimension.si}".removesuffix(" 1")
        raise ArmFileError(key, f"{written}; expected {expected}")

    largest = float(np.abs(number).max())
    plausible = dimension.plausible
    if plausible is None or plausible.holds(largest):
        return
    # "at most 2 on this arm" becomes "at most 2 m on this arm".
    bound = _NUMBER.sub(rf"\g<0> {plausible.unit}", plausible.expected)
    problem = f"{written}; expected {bound}".rstrip()
    likely = dimension.likely_unit(largest)
    if likely not in (None, unit):
        problem += f": is it in {likely}?"
    raise ArmFileError(key, problem)


def _measurement(
    key: str, whole: Mapping[str, Any], unit: str, number: FloatArray, schema: Key
) -> Measurement | None:
    """Source and half width of a value."""
    source = whole.get("source", "")
    if not isinstance(source, str):
        raise ArmFileError(f"{key}.source", f"{shown(source)}; expected a text")
    half_width = None
    if "half_width" in whole:
        place = f"{key}.half_width"
        written = _number(place, whole["half_width"])
        half_width = schema.dimension.in_si(written, unit)
        largest = float(np.abs(number).max())
        if half_width < 0 or (schema.least is not None and half_width > largest):
            problem = f"{shown(written)} {unit}; expected 0 to the value"
            raise ArmFileError(place, f"{problem} (it has the value's unit)")
    if not source and half_width is None:
        return None
    return Measurement(key=key, source=source, half_width=half_width)


def _as_written(given: Any) -> str:
    """Numbers as in the file, in brackets if there are several."""
    if isinstance(given, list):
        return f"[{', '.join(map(_as_written, given))}]"
    return shown(given)
