"""Records do not change, and those that hold arrays are not compared entry by entry."""

from __future__ import annotations

import dataclasses
import re
from importlib import import_module
from pathlib import Path

import pytest

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf

PACKAGE = Path(a5.__file__).parent


def records() -> list[type]:
    found: dict[str, type] = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
        if parts[-1] == "__main__" or "_data" in parts:
            continue
        module = import_module(".".join(parts).removesuffix(".__init__"))
        for value in vars(module).values():
            if isinstance(value, type) and dataclasses.is_dataclass(value):
                found[f"{value.__module__}.{value.__qualname__}"] = value
    return [found[name] for name in sorted(found) if name.startswith("alpha5_model.")]


@pytest.mark.slow
def test_every_record_is_frozen() -> None:
    every = records()
    assert every
    assert [r for r in every if not r.__dataclass_params__.frozen] == []


def compared_by_identity(every: list[type]) -> set[type]:
    """Records that hold an array, a function or anything, or another such record.

    Options name an arm, which is compared by identity, and are compared by content.
    """
    words = {"Callable", "Any"}

    def holds_one(record: type) -> bool:
        types = " ".join(str(field.type) for field in dataclasses.fields(record))
        names = re.findall(r"\w+", types)
        return any(name in words or name.endswith("Array") for name in names)

    while True:
        found = {record for record in every if holds_one(record)}
        names = {record.__name__ for record in found}
        if names - {"Alpha5Parameters"} <= words:
            return found
        words |= names - {"Alpha5Parameters"}


@pytest.mark.slow
def test_records_of_arrays_have_no_equality() -> None:
    """``==`` of two arrays is an array; as records they would raise."""
    of_arrays = compared_by_identity(records())
    assert of_arrays
    assert [r for r in of_arrays if r.__dataclass_params__.eq] == []


def test_robots_as_read_are_told_apart_and_hashed_by_identity() -> None:
    """Their records of arrays compare by identity, they themselves by content."""
    text = Path(a5.URDF_PATH).read_bytes()
    one, other = parse_urdf(text), parse_urdf(text)
    assert one != other
    assert len({one, other, one}) == 2
