"""A table of a data file that knows its place and refuses what nobody asked it for."""

from __future__ import annotations

import tomllib
from typing import Any

from alpha5_model.errors import PublishedDataError
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import STATUSES, SourcedQuantity, Tensor, Triple


class TomlTable:
    """A TOML table that knows its place and which of its keys were read."""

    def __init__(self, content: dict[str, Any], path: str) -> None:
        self.content, self.path = content, path
        self.used: set[str] = set()
        self.children: dict[str, TomlTable] = {}

    @classmethod
    def root(cls, file: str, text: str) -> TomlTable:
        try:
            return cls(tomllib.loads(text), file)
        except tomllib.TOMLDecodeError as error:
            raise PublishedDataError(file, str(error)) from None

    def place(self, key: str) -> str:
        return f"{self.path}: {key}" if self.path.endswith(".toml") else f"{self.path}.{key}"

    def get(self, key: str) -> Any:
        if key not in self.content:
            raise PublishedDataError(self.place(key), "missing")
        self.used.add(key)
        return self.content[key]

    def text(self, key: str) -> str:
        value = self.get(key)
        if not isinstance(value, str) or (not value.strip() and key != "number"):
            raise PublishedDataError(self.place(key), f"expected a text, got {value!r}")
        return value

    def name(self, key: str, index: int) -> str:
        if self.text(key) != str(index):
            raise PublishedDataError(
                self.place(key),
                f"expected {str(index)!r} (rows from base to tip), got {self.get(key)!r}",
            )
        return str(index)

    def table(self, key: str) -> TomlTable:
        if key not in self.children:
            value = self.get(key)
            if not isinstance(value, dict):
                raise PublishedDataError(self.place(key), f"expected a table, got {value!r}")
            self.children[key] = TomlTable(value, self.place(key))
        return self.children[key]

    def rows(self, count: int) -> list[TomlTable]:
        value = self.get("rows")
        if not isinstance(value, list) or len(value) != count:
            raise PublishedDataError(self.place("rows"), f"expected {count} rows")
        for i, row in enumerate(value):
            if not isinstance(row, dict):
                raise PublishedDataError(self.place(f"rows[{i}]"), f"expected a table, got {row!r}")
            self.children[f"rows[{i}]"] = TomlTable(row, self.place(f"rows[{i}]"))
        return [self.children[f"rows[{i}]"] for i in range(count)]

    def quantity(self, key: str, table: TomlTable, unit: str) -> Quantity:
        return Quantity.parse(self.get(key), table.column_unit(key, unit), self.place(key))

    def expression(self, key: str, table: TomlTable, unit: str) -> str:
        table.column_unit(key, unit)
        return self.text(key)

    def column_unit(self, key: str, expected: str) -> str:
        units = self.table("units")
        if (given := units.get(key)) != expected:
            raise PublishedDataError(units.place(key), f"expected {expected!r}, got {given!r}")
        return expected

    def triple(self, key: str, table: TomlTable, unit: str) -> Triple:
        return _triple(self.get(key), table.column_unit(key, unit), self.place(key))

    def tensor(self, key: str, table: TomlTable, unit: str) -> Tensor:
        value, place = self.get(key), self.place(key)
        unit = table.column_unit(key, unit)
        if not isinstance(value, list) or len(value) != 3:
            raise PublishedDataError(place, f"expected three rows, got {value!r}")
        tensor = tuple(_triple(row, unit, f"{place}[{i}]") for i, row in enumerate(value))
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if tensor[i][j].value != tensor[j][i].value:
                raise PublishedDataError(
                    f"{place}[{i}][{j}]",
                    f"the tensor is not symmetric: {tensor[i][j].text} against {tensor[j][i].text}",
                )
        return tensor  # type: ignore[return-value]  # three rows, checked above

    def sourced(self, key: str, unit: str) -> SourcedQuantity:
        node = self.table(key)
        if (given := node.text("unit")) != unit:
            raise PublishedDataError(node.place("unit"), f"expected {unit!r}, got {given!r}")
        quantity = Quantity.parse(node.get("value"), unit, node.place("value"))
        return SourcedQuantity(quantity, node.status(), node.text("source"))

    def status(self) -> str:
        status = self.text("status")
        if status not in STATUSES:
            raise PublishedDataError(
                self.place("status"),
                f"unknown status {status!r}; choose from {', '.join(STATUSES)}",
            )
        return status

    def bounds(self, key: str, unit: str) -> Any:
        value, place = self.get(key), self.place(key)
        if not isinstance(value, list) or [len(p) for p in value if isinstance(p, list)] != [2] * 3:
            raise PublishedDataError(place, f"expected three [min, max] pairs, got {value!r}")
        pairs = tuple(
            tuple(Quantity.parse(x, unit, f"{place}[{i}]") for x in pair)
            for i, pair in enumerate(value)
        )
        for i, (low, high) in enumerate(pairs):
            if low.value >= high.value:
                raise PublishedDataError(f"{place}[{i}]", "min must be below max")
        return pairs

    def finish(self) -> None:
        """Refuse keys that nobody read: a misspelt key must not vanish silently."""
        for key in self.content:
            if key not in self.used:
                raise PublishedDataError(self.place(key), "unknown key")
        for child in self.children.values():
            child.finish()


def _triple(value: Any, unit: str, place: str) -> Triple:
    if not isinstance(value, list) or len(value) != 3:
        raise PublishedDataError(place, f"expected three numbers, got {value!r}")
    x, y, z = (Quantity.parse(v, unit, f"{place}[{i}]") for i, v in enumerate(value))
    return x, y, z
