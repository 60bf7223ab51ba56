"""The data files of this folder as the records of `tables`, in printed units.

The files are part of the package, and the tests check them: keys, units, symmetric
tensors, statuses and sources.
"""

from __future__ import annotations

import tomllib
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import Any

from alpha5_model.numbers import tables as t
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import Published


def published() -> Published:
    """The manufacturer's tables as printed, in printed units, each with its source."""
    return _published()


@cache
def _published() -> Published:
    return parse(_text("reach_alpha_mk2_v7.toml"), _text("supplementary.toml"))


@cache
def earlier_revision() -> tuple[t.EarlierRow, ...]:
    """Rows of ``earlier_revision.toml``; they are supplementary, as it explains."""
    rows = tomllib.loads(_text("earlier_revision.toml"))["table"]["rows"]
    return tuple(_record(t.EarlierRow, row) for row in rows)


@cache
def hydrodynamics(numbers: str) -> dict[str, t.HydrodynamicRow]:
    """The bodies of the ``estimated`` or the ``supplementary`` hydrodynamics."""
    return parse_hydrodynamics(_text(f"{numbers}_hydrodynamics.toml"))


def parse(document_text: str, supplementary_text: str) -> Published:
    """Tables 1-4 and the supplementary values from the texts of their files."""
    document = tomllib.loads(document_text)
    head = document["document"]
    numbers = document["workspace"]
    return Published(
        table_1=_table(head, document["table_1"], t.DHRow),
        elbow=_record(t.Elbow, document["table_1"]["elbow"]),
        workspace=_record(
            t.WorkspaceNumbers, numbers["values"], source=_source(head, numbers)
        ),
        table_2=_table(head, document["table_2"], t.InertialRow),
        table_3=_table(head, document["table_3"], t.BuoyancyRow),
        table_4=_table(head, document["table_4"], t.ActuatorRow),
        supplementary=_supplementary(tomllib.loads(supplementary_text)),
    )


def parse_hydrodynamics(text: str) -> dict[str, t.HydrodynamicRow]:
    """The bodies in the text of a file of hydrodynamics."""
    return {
        name: _record(
            t.HydrodynamicRow,
            body,
            name=name,
            added_mass=_added_mass(body["added_mass"]),
            strips=tuple(_record(t.StripRow, strip) for strip in body["strips"]),
        )
        for name, body in tomllib.loads(text)["bodies"].items()
    }


def _text(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _record(
    kind: type[Any], given: dict[str, Any], *, rod: bool = False, **known: Any
) -> Any:
    """A record of a table of a file; each number gets the unit of its field.

    Args:
        kind: Class of the record.
        given: Name of a field -> text, number or lists of numbers.
        rod: Whether it is of the jaw rod, which has units of its own.
        known: Fields that are already made.
    """
    made = dict(known)
    for field in fields(kind):
        if field.name not in known:
            value = given[field.name]
            units = field.metadata.get("units")
            made[field.name] = value if units is None else _quantity(value, units[rod])
    return kind(**made)


def _quantity(given: Any, unit: str) -> Any:
    """A printed number, one with status and source, or lists of numbers as tuples."""
    if isinstance(given, list):
        return tuple(_quantity(item, unit) for item in given)
    if isinstance(given, dict):
        return t.SourcedQuantity(
            quantity=Quantity(given["value"], unit),
            status=given["status"],
            source=given["source"],
        )
    # Table 1 prints a symbol for one length.
    return given if given == "a_1" else Quantity(given, unit)


def _table(head: dict[str, str], given: dict[str, Any], kind: type[Any]) -> Any:
    """A printed table."""
    return t.Table(
        source=_source(head, given),
        rows=tuple(_record(kind, row) for row in given["rows"]),
        origins=given.get("origins", {}),
    )


def _source(head: dict[str, str], given: dict[str, Any]) -> t.Source:
    """The source of a table of the document."""
    return t.Source(
        document=head["title"],
        publisher=head["publisher"],
        version=head["version"],
        date=head["date"],
        section=given["section"],
        table=given["number"],
        caption=given["caption"],
    )


def _supplementary(root: dict[str, Any]) -> t.Supplementary:
    bodies = root["bodies"]
    return t.Supplementary(
        joints=tuple(
            _record(t.JointRow, root["joints"][name], rod=name == "axis_a", name=name)
            for name in t.JOINT_NAMES
        ),
        jaws={
            name: _quantity(root["jaws"][name], unit)
            for name, unit in t.JAW_UNITS.items()
        },
        bodies=tuple(
            t.BodyBounds(
                name=name,
                bounds=_quantity(bodies[name], bodies["unit"]),
                status=bodies["status"],
                source=bodies["source"],
            )
            for name in t.BODY_NAMES
        ),
        drivers={
            name: _driver(name, driver) for name, driver in root["drivers"].items()
        },
    )


def _driver(name: str, given: dict[str, Any]) -> t.Driver:
    """The motor currents that a public driver assumes."""
    return t.Driver(
        name=name,
        joints=tuple(
            _record(t.DriverCurrents, given[joint], name=joint)
            for joint in t.JOINT_NAMES[:4]
        ),
        status=given["status"],
        source=given["source"],
    )


def _added_mass(rows: list[list[str]]) -> t.Matrix:
    """A 6x6 matrix whose blocks have different units."""
    return tuple(
        tuple(
            Quantity(entry, t.ADDED_MASS_UNITS[(i > 2) + (j > 2)])
            for j, entry in enumerate(row)
        )
        for i, row in enumerate(rows)
    )
