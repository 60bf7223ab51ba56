"""The two data files read into the records of `alpha5_model.published.tables`, field by field."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

from alpha5_model.errors import PublishedDataError
from alpha5_model.published import tables as t
from alpha5_model.published.quantity import Quantity

if TYPE_CHECKING:
    from alpha5_model.published import water_tables as w

_DOCUMENT, _SUPPLEMENTARY = "reach_alpha_mk2_v7.toml", "supplementary.toml"
_EARLIER = "earlier_revision.toml"
_HEAD = ("title", "publisher", "version", "date")


@cache
def load() -> t.Published:
    """The two data files of this folder; see `alpha5_model.published`."""
    return parse(_text(_DOCUMENT), _text(_SUPPLEMENTARY))


def _text(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def parse(document_text: str, supplementary_text: str) -> t.Published:
    """Read the texts of the two data files.

    Raises:
        PublishedDataError: Not TOML, duplicate, missing or unknown key, wrong unit, not a number,
            asymmetric tensor, rows out of order, unknown status, empty source.
    """
    tables = ("table_1", "workspace", "table_2", "table_3", "table_4")
    document = _root(_DOCUMENT, document_text).table("document", *tables)
    head = document["document"].table(*_HEAD)
    one = _table(head, document["table_1"], t.DHRow, "elbow")
    numbers = document["workspace"].table("number", "section", "caption", "units", "values")
    _check_units(_units(t.WorkspaceNumbers), numbers["units"])
    return t.Published(
        table_1=one,
        elbow=_record(t.Elbow, document["table_1"]["elbow"]),
        workspace=_record(t.WorkspaceNumbers, numbers["values"], source=_source(head, numbers)),
        table_2=_table(head, document["table_2"], t.InertialRow),
        table_3=_table(head, document["table_3"], t.BuoyancyRow),
        table_4=_table(head, document["table_4"], t.ActuatorRow, "origins"),
        supplementary=_supplementary(_root(_SUPPLEMENTARY, supplementary_text)),
    )


def earlier_revision() -> tuple[t.EarlierRow, ...]:
    """The earlier revision's rows, from ``earlier_revision.toml``; supplementary, see there."""
    root = _root(_EARLIER, _text(_EARLIER)).table("status", "source", "table")
    _status(root), root["source"].text()
    table = root["table"].table("units", "rows")
    _check_units(_units(t.EarlierRow), table["units"])
    return _rows(t.EarlierRow, table["rows"])


@cache
def hydrodynamics(numbers: str) -> dict[str, w.HydrodynamicRow]:
    """The bodies of ``estimated_hydrodynamics.toml`` or ``supplementary_hydrodynamics.toml``.

    Raises:
        PublishedDataError: As of `parse`; also a matrix that is not symmetric, or an interval out of order.
    """
    file = f"{numbers}_hydrodynamics.toml"
    return parse_hydrodynamics(file, _text(file))


def parse_hydrodynamics(file: str, text: str) -> dict[str, w.HydrodynamicRow]:
    """Read the text of a file of moving water."""
    from alpha5_model.published import water_tables as w

    root = _root(file, text).table("units", "bodies")
    units = {**_units(w.HydrodynamicRow), **_units(w.StripRow)}
    _check_units({name: unit for name, unit in units.items() if unit}, root["units"])
    given, rows = root["bodies"].value, {}
    known = [n for n in w.HYDRODYNAMIC_NAMES if isinstance(given, dict) and n in given]
    bodies = root["bodies"].table(*known)
    for name in known:
        rows[name] = _record(w.HydrodynamicRow, bodies[name], name=name)
        _status(bodies[name])
    return rows


@dataclass(frozen=True)
class _Node:
    """A value of a data file, with its place for messages."""

    value: Any
    place: str

    def fail(self, problem: str) -> PublishedDataError:
        return PublishedDataError(self.place, problem)

    def __getitem__(self, key: str) -> _Node:
        joint = ": " if self.place.endswith(".toml") else "."
        return _Node(self.value.get(key), f"{self.place}{joint}{key}")

    def table(self, *keys: str) -> _Node:
        """Itself, if it is a table with exactly these keys, so that a misspelt one is noticed."""
        if not isinstance(self.value, dict):
            raise self.fail(f"expected a table, got {self.value!r}")
        for key in (*keys, *self.value):
            if key not in self.value or key not in keys:
                raise self[key].fail("unknown key" if key in self.value else "missing")
        return self

    def items(self, count: int, what: str) -> list[_Node]:
        if not isinstance(self.value, list) or len(self.value) != count:
            raise self.fail(f"expected {what}, got {self.value!r}")
        return [_Node(item, f"{self.place}[{i}]") for i, item in enumerate(self.value)]

    def text(self) -> str:
        if not isinstance(self.value, str) or not self.value.strip():
            raise self.fail(f"expected a text, got {self.value!r}")
        return self.value

    def expect(self, wanted: str, why: str = "") -> None:
        if self.value != wanted:
            raise self.fail(f"expected {wanted!r}{why}, got {self.value!r}")


def _root(file: str, text: str) -> _Node:
    try:
        return _Node(tomllib.loads(text), file)
    except ValueError as error:  # TOMLDecodeError, or an integer of more than 4300 digits
        raise PublishedDataError(file, str(error)) from None


def _units(record: type[Any]) -> dict[str, Any]:
    """Field -> printed unit of a record; two units where the jaw rod has its own."""
    return {f.name: f.metadata["unit"] for f in fields(record) if f.metadata}


def _record(record: type[Any], node: _Node, rod: bool = False, **known: Any) -> Any:
    """A record from a table, each field by its type and unit; ``known`` ones are given."""
    units, types = _units(record), {f.name: str(f.type) for f in fields(record)}
    names = [name for name in types if name not in known]
    node.table(*names)
    for name in names:
        unit = units.get(name)
        known[name] = _READ[types[name]](node[name], unit[rod] if isinstance(unit, tuple) else unit)
    return record(**known)


def _number(node: _Node, unit: str) -> Quantity:
    return Quantity.parse(node.value, unit, node.place)


def _triple(node: _Node, unit: str) -> t.Triple:
    x, y, z = (_number(item, unit) for item in node.items(3, "three numbers"))
    return x, y, z


def _tensor(node: _Node, unit: str) -> t.Tensor:
    x, y, z = (_triple(row, unit) for row in node.items(3, "three rows"))
    _symmetric(node, (x, y, z))
    return x, y, z


def _symmetric(node: _Node, rows: w.Matrix) -> None:
    for i, j in combinations(range(len(rows)), 2):
        one, other = rows[i][j], rows[j][i]
        if one.value != other.value:
            problem = f"the tensor is not symmetric: {one.text} against {other.text}"
            raise PublishedDataError(f"{node.place}[{i}][{j}]", problem)


def _interval(node: _Node, unit: str) -> w.Interval:
    low, nominal, high = _triple(node, unit)
    if not 0 <= low.value <= nominal.value <= high.value:
        raise node.fail("expected low, nominal, high, none below 0 and in this order")
    return low, nominal, high


def _matrix(node: _Node, unit: str) -> w.Matrix:
    from alpha5_model.published.water_tables import ADDED_MASS_UNITS

    rows = tuple(
        tuple(
            _number(item, ADDED_MASS_UNITS[(i > 2) + (j > 2)])
            for j, item in enumerate(row.items(6, "six numbers"))
        )
        for i, row in enumerate(node.items(6, "six rows"))
    )
    _symmetric(node, rows)
    return rows


def _strips(node: _Node, unit: None) -> tuple[w.StripRow, ...]:
    from alpha5_model.published.water_tables import StripRow

    count = len(node.value) if isinstance(node.value, list) else 1
    return tuple(_record(StripRow, item) for item in node.items(count, "a list of strips"))


def _bounds(node: _Node, unit: str) -> Any:
    pairs = []
    for item in node.items(3, "three [min, max] pairs"):
        low, high = (_number(end, unit) for end in item.items(2, "a [min, max] pair"))
        if low.value >= high.value:
            raise item.fail("min must be below max")
        pairs.append((low, high))
    return tuple(pairs)


def _sourced(node: _Node, unit: str) -> t.SourcedQuantity:
    node.table("value", "unit", "status", "source")["unit"].expect(unit)
    return t.SourcedQuantity(_number(node["value"], unit), _status(node), node["source"].text())


def _status(node: _Node) -> str:
    if (status := node["status"].text()) not in t.STATUSES:
        choices = ", ".join(t.STATUSES)
        raise node["status"].fail(f"unknown status {status!r}; choose from {choices}")
    return status


def _integer(node: _Node, unit: None) -> int:
    if type(node.value) is not int:
        raise node.fail(f"expected an integer, got {node.value!r}")
    return node.value


#: Type of a field, as annotated -> how it is read.
_READ: dict[str, Callable[[_Node, Any], Any]] = {
    "Quantity": _number,
    "Quantity | str": lambda node, unit: "a_1" if node.value == "a_1" else _number(node, unit),
    "Triple": _triple,
    "Tensor": _tensor,
    "Interval": _interval,
    "Matrix": _matrix,
    "tuple[StripRow, ...]": _strips,
    "SourcedQuantity": _sourced,
    "int": _integer,
    "str": lambda node, unit: node.text(),
}


def _table(head: _Node, node: _Node, record: type[Any], *more: str) -> t.Table[Any]:
    node.table("number", "section", "caption", "units", "rows", *more)
    units, origins = _units(record), {}
    _check_units(units, node["units"])
    rows = _rows(record, node["rows"])
    if "origins" in more:
        origins = {name: node["origins"].table(*units)[name].text() for name in units}
    return t.Table(_source(head, node), rows, origins)


def _rows(record: type[Any], node: _Node) -> tuple[Any, ...]:
    rows, number = [], fields(record)[0].name
    for i, row in enumerate(node.items(5, "5 rows")):
        rows.append(_record(record, row))
        row[number].expect(str(i), " (rows from base to tip)")
    return tuple(rows)


def _check_units(units: dict[str, Any], node: _Node) -> None:
    node.table(*units)
    for name, unit in units.items():
        node[name].expect(unit)


def _source(head: _Node, node: _Node) -> t.Source:
    title, publisher, version, date = (head[key].text() for key in _HEAD)
    number, section, caption = node["number"], node["section"].text(), node["caption"].text()
    table = "" if number.value == "" else number.text()
    return t.Source(title, publisher, version, date, section, table, caption)


def _supplementary(root: _Node) -> t.Supplementary:
    root.table("joints", "jaws", "bodies")
    joints, jaws = root["joints"].table(*t.JOINT_NAMES), root["jaws"].table(*t.JAW_UNITS)
    rows = []
    for name in t.JOINT_NAMES:
        row: t.JointRow = _record(t.JointRow, joints[name], rod=name == "axis_a", name=name)
        lower, upper = row.lower.quantity, row.upper.quantity
        if lower.value >= upper.value:
            raise joints[name]["upper"].fail(f"{upper} is not above lower, {lower}")
        rows.append(row)
    bodies = root["bodies"].table("unit", "status", "source", *t.BODY_NAMES)
    bodies["unit"].expect("mm")
    return t.Supplementary(
        joints=tuple(rows),
        jaws={key: _sourced(jaws[key], unit) for key, unit in t.JAW_UNITS.items()},
        bodies=tuple(
            t.BodyBounds(n, _bounds(bodies[n], "mm"), _status(bodies), bodies["source"].text())
            for n in t.BODY_NAMES
        ),
    )
