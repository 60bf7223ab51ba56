"""Tables 1-4 verbatim, in printed units: the data files, read field by field."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

from alpha5_model.errors import PublishedDataError
from alpha5_model.numbers import tables as t
from alpha5_model.numbers.quantity import Quantity

_DOCUMENT = "reach_alpha_mk2_v7.toml"
_SUPPLEMENTARY = "supplementary.toml"
_HEAD = ("title", "publisher", "version", "date")


@cache
def published() -> t.Published:
    """The manufacturer's tables as printed, in printed units, each with its source.

    Raises:
        PublishedDataError: A data file is malformed; the message names the place.
    """
    return parse(_text(_DOCUMENT), _text(_SUPPLEMENTARY))


def _text(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def parse(document_text: str, supplementary_text: str) -> t.Published:
    """Read the texts of the two data files.

    Raises:
        PublishedDataError: Not TOML, duplicate, missing or unknown key, wrong unit, not
            a number, asymmetric tensor, rows out of order, unknown status, empty
            source.
    """
    document = _root(_DOCUMENT, document_text)
    document.table("document", "table_1", "workspace", "table_2", "table_3", "table_4")
    head = document["document"].table(*_HEAD)
    numbers = document["workspace"].table(
        "number", "section", "caption", "units", "values"
    )
    _check_units(numbers["units"], _units(t.WorkspaceNumbers))
    return t.Published(
        table_1=_table(head, document["table_1"], t.DHRow, "elbow"),
        elbow=_record(t.Elbow, document["table_1"]["elbow"]),
        workspace=_record(
            t.WorkspaceNumbers, numbers["values"], source=_source(head, numbers)
        ),
        table_2=_table(head, document["table_2"], t.InertialRow),
        table_3=_table(head, document["table_3"], t.BuoyancyRow),
        table_4=_table(head, document["table_4"], t.ActuatorRow, "origins"),
        supplementary=_supplementary(_root(_SUPPLEMENTARY, supplementary_text)),
    )


def earlier_revision() -> tuple[t.EarlierRow, ...]:
    """Rows of ``earlier_revision.toml``; they are supplementary, as it explains."""
    name = "earlier_revision.toml"
    root = _root(name, _text(name)).table("status", "source", "table")
    _status(root["status"])
    root["source"].text()
    table = root["table"].table("units", "rows")
    _check_units(table["units"], _units(t.EarlierRow))
    return _rows(t.EarlierRow, table["rows"])


@cache
def hydrodynamics(numbers: str) -> dict[str, t.HydrodynamicRow]:
    """The bodies of the estimated or the supplementary hydrodynamics.

    Raises:
        PublishedDataError: As of `parse`; also a matrix that is not symmetric, or an
            interval out of order.
    """
    file = f"{numbers}_hydrodynamics.toml"
    return parse_hydrodynamics(file, _text(file))


def parse_hydrodynamics(file: str, text: str) -> dict[str, t.HydrodynamicRow]:
    """Read the text of a file of hydrodynamics."""
    root = _root(file, text).table("units", "bodies")
    _check_units(root["units"], _units(t.HydrodynamicRow) | _units(t.StripRow))
    bodies = root["bodies"]
    given = bodies.value if isinstance(bodies.value, dict) else {}
    known = [name for name in t.HYDRODYNAMIC_NAMES if name in given]
    bodies.table(*known)
    return {name: _record(t.HydrodynamicRow, bodies[name], name=name) for name in known}


@dataclass(frozen=True, eq=False)
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
        """Itself, if it is a table with exactly these keys, none misspelt."""
        if not isinstance(self.value, dict):
            raise self.fail(f"expected a table, got {self.value!r}")
        for key in (*keys, *self.value):
            if key not in self.value or key not in keys:
                raise self[key].fail("unknown key" if key in self.value else "missing")
        return self

    def items(self, what: str, count: int | None = None) -> list[_Node]:
        if not isinstance(self.value, list) or count not in (None, len(self.value)):
            raise self.fail(f"expected {what}, got {self.value!r}")
        return [_Node(item, f"{self.place}[{i}]") for i, item in enumerate(self.value)]

    def numbers(self, unit: str, *levels: tuple[int, str]) -> Any:
        """A printed number, or nested lists of them.

        ``levels`` holds, from outside, the length of each list and what errors call it.
        """
        if not levels:
            return Quantity.parse(self.value, unit, self.place)
        count, what = levels[0]
        return tuple(
            item.numbers(unit, *levels[1:]) for item in self.items(what, count)
        )

    def text(self) -> str:
        if not isinstance(self.value, str) or not self.value.strip():
            raise self.fail(f"expected a text, got {self.value!r}")
        return self.value

    def expect(self, wanted: str, why: str = "") -> None:
        if self.value != wanted:
            raise self.fail(f"expected {wanted!r}{why}, got {self.value!r}")


def _root(file: str, text: str) -> _Node:
    """The tables of a file."""
    try:
        return _Node(tomllib.loads(text), file)
    except ValueError as error:
        # A TOMLDecodeError, or an integer of more than 4300 digits.
        raise PublishedDataError(file, str(error)) from None
    except RecursionError:
        problem = "expected fewer brackets inside one another"
        raise PublishedDataError(file, problem) from None


def _units(record: type[Any], rod: bool = False) -> dict[str, str]:
    """Field -> printed unit of a record; ``rod`` selects those of the jaw rod."""
    return {f.name: f.metadata["units"][rod] for f in fields(record) if f.metadata}


def _check_units(node: _Node, units: dict[str, str]) -> None:
    node.table(*units)
    for name, unit in units.items():
        node[name].expect(unit)


def _record(record: type[Any], node: _Node, rod: bool = False, **known: Any) -> Any:
    """A record from a table.

    Args:
        record: Its class; each field is read by its type and unit.
        node: The table.
        rod: Whether the units are those of the jaw rod.
        known: Values of fields that the table does not have.
    """
    units = _units(record, rod)
    types = {f.name: str(f.type) for f in fields(record) if f.name not in known}
    node.table(*types)
    for name, kind in types.items():
        known[name] = _READ[kind](node[name], units.get(name))
    return record(**known)


def _symmetric(node: _Node, unit: str, size: int, word: str) -> t.Matrix:
    rows: t.Matrix = node.numbers(
        unit, (size, f"{word} rows"), (size, f"{word} numbers")
    )
    for i, j in combinations(range(size), 2):
        one, other = rows[i][j], rows[j][i]
        if one.value != other.value:
            problem = f"the tensor is not symmetric: {one.text} against {other.text}"
            raise PublishedDataError(f"{node.place}[{i}][{j}]", problem)
    return rows


def _added_mass(node: _Node, unit: str) -> t.Matrix:
    """A symmetric 6x6 matrix whose blocks have different units."""
    rows = []
    for i, row in enumerate(_symmetric(node, "kg", 6, "six")):
        quantities = []
        for j, entry in enumerate(row):
            angular = (i > 2) + (j > 2)
            quantities.append(Quantity(entry.text, t.ADDED_MASS_UNITS[angular]))
        rows.append(tuple(quantities))
    return tuple(rows)


def _interval(node: _Node, unit: None) -> t.Interval:
    low, nominal, high = node.numbers("", _THREE)
    if not 0 <= low.value <= nominal.value <= high.value:
        raise node.fail("expected low, nominal, high, none below 0 and in this order")
    return low, nominal, high


def _motions(node: _Node, unit: None) -> t.Motions:
    shares: t.Motions = node.numbers("", (6, "six numbers"))
    if min(share.value for share in shares) <= 0:
        raise node.fail("expected numbers above 0")
    return shares


def _bounds(node: _Node) -> Any:
    pairs = node.numbers("mm", (3, "three [min, max] pairs"), (2, "a [min, max] pair"))
    for i, (low, high) in enumerate(pairs):
        if low.value >= high.value:
            raise PublishedDataError(f"{node.place}[{i}]", "min must be below max")
    return pairs


def _sourced(node: _Node, unit: str) -> t.SourcedQuantity:
    node.table("value", "unit", "status", "source")
    node["unit"].expect(unit)
    return t.SourcedQuantity(
        quantity=node["value"].numbers(unit),
        status=_status(node["status"]),
        source=node["source"].text(),
    )


def _status(node: _Node, unit: None = None) -> str:
    status = node.text()
    if status not in t.STATUSES:
        choices = ", ".join(t.STATUSES)
        raise node.fail(f"unknown status {status!r}; choose from {choices}")
    return status


def _integer(node: _Node, unit: None) -> int:
    if type(node.value) is not int:
        raise node.fail(f"expected an integer, got {node.value!r}")
    return node.value


def _strips(node: _Node) -> tuple[t.StripRow, ...]:
    items = node.items("a list of strips")
    return tuple(_record(t.StripRow, item) for item in items)


_THREE = (3, "three numbers")
#: Type of a field, as annotated -> how it is read.
_READ: dict[str, Callable[[_Node, Any], Any]] = {
    "Quantity": _Node.numbers,
    "Quantity | str": lambda node, unit: (
        "a_1" if node.value == "a_1" else node.numbers(unit)
    ),
    "Triple": lambda node, unit: node.numbers(unit, _THREE),
    "Tensor": lambda node, unit: _symmetric(node, unit, 3, "three"),
    "Interval": _interval,
    "Matrix": _added_mass,
    "Motions": _motions,
    "tuple[StripRow, ...]": lambda node, unit: _strips(node),
    "SourcedQuantity": _sourced,
    "Status": _status,
    "int": _integer,
    "str": lambda node, unit: node.text(),
}


def _table(head: _Node, node: _Node, record: type[Any], *more: str) -> t.Table[Any]:
    """A printed table; ``more`` names the keys that it has besides the usual ones."""
    node.table("number", "section", "caption", "units", "rows", *more)
    units = _units(record)
    _check_units(node["units"], units)
    rows = _rows(record, node["rows"])
    origins = {}
    if "origins" in more:
        for name in units:
            origins[name] = node["origins"].table(*units)[name].text()
    return t.Table(source=_source(head, node), rows=rows, origins=origins)


def _rows(record: type[Any], node: _Node) -> tuple[Any, ...]:
    """Five records, whose first field is their number from base to tip."""
    number = fields(record)[0].name
    rows = []
    for i, row in enumerate(node.items("5 rows", 5)):
        rows.append(_record(record, row))
        row[number].expect(str(i), " (rows from base to tip)")
    return tuple(rows)


def _source(head: _Node, node: _Node) -> t.Source:
    """Source of a table of the document."""
    title, publisher, version, date = (head[key].text() for key in _HEAD)
    numbered = node["number"].value != ""
    table = node["number"].text() if numbered else ""
    return t.Source(
        document=title,
        publisher=publisher,
        version=version,
        date=date,
        section=node["section"].text(),
        table=table,
        caption=node["caption"].text(),
    )


def _supplementary(root: _Node) -> t.Supplementary:
    root.table("joints", "jaws", "bodies", "drivers")
    joints = root["joints"].table(*t.JOINT_NAMES)
    jaws = root["jaws"].table(*t.JAW_UNITS)
    rows = [_joint(name, joints[name]) for name in t.JOINT_NAMES]

    bodies = root["bodies"].table("unit", "status", "source", *t.BODY_NAMES)
    bodies["unit"].expect("mm")
    status = _status(bodies["status"])
    source = bodies["source"].text()
    quantities = {key: _sourced(jaws[key], unit) for key, unit in t.JAW_UNITS.items()}
    bounds = []
    for name in t.BODY_NAMES:
        bounds.append(
            t.BodyBounds(
                name=name,
                bounds=_bounds(bodies[name]),
                status=status,
                source=source,
            )
        )
    drivers = root["drivers"].table(*t.DRIVER_NAMES)
    return t.Supplementary(
        joints=tuple(rows),
        jaws=quantities,
        bodies=tuple(bounds),
        drivers={name: _driver(name, drivers[name]) for name in t.DRIVER_NAMES},
    )


def _driver(name: str, node: _Node) -> t.Driver:
    """The motor currents that a public driver assumes."""
    turning = t.JOINT_NAMES[:4]
    node.table("unit", "status", "source", *turning)
    node["unit"].expect("mA")
    joints = [_record(t.DriverCurrents, node[joint], name=joint) for joint in turning]
    return t.Driver(
        name=name,
        joints=tuple(joints),
        status=_status(node["status"]),
        source=node["source"].text(),
    )


def _joint(name: str, node: _Node) -> t.JointRow:
    row: t.JointRow = _record(t.JointRow, node, rod=name == "axis_a", name=name)
    lower = row.lower.quantity
    upper = row.upper.quantity
    if lower.value >= upper.value:
        raise node["upper"].fail(f"{upper} is not above lower, {lower}")
    return row
