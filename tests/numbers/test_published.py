"""Every printed digit arrives, every value has a source, the data files are sound."""

from __future__ import annotations

import dataclasses
import os
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import alpha5_model as a5
from alpha5_model.numbers import tables
from alpha5_model.numbers.printed import earlier_revision, parse
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import (
    STATUSES,
    BodyBounds,
    Driver,
    Source,
    SourcedQuantity,
)

ROOT = Path(__file__).resolve().parents[2]
SEEDS = Path(os.environ.get("ALPHA5_SEEDS", ROOT.parent / "shared" / "seeds"))
SEED = SEEDS / "reach_alpha_mk2_kinematic_and_dynamic_properties_v7.md"
DATA = ROOT / "alpha5_model" / "numbers"
DOCUMENT = (DATA / "reach_alpha_mk2_v7.toml").read_text(encoding="utf-8")
SUPPLEMENTARY = (DATA / "supplementary.toml").read_text(encoding="utf-8")

needs_seed = pytest.mark.skipif(
    not SEED.is_file(), reason=f"the manufacturer's document is not at {SEED}"
)
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


# --- every digit, read from the document's own text -----------------------------------


def printed_rows(header: str) -> list[list[str]]:
    """Cells of the document's table whose head starts with ``header``."""
    lines = SEED.read_text(encoding="utf-8").splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(header))
    rows = []
    for line in lines[start + 1 :]:
        if not re.match(r"\d\t", line):
            break
        rows.append(line.split("\t"))
    return rows


def matrix(cell: str) -> list[list[str]]:
    body = re.search(r"\\begin\{pmatrix\}(.*)\\end\{pmatrix\}", cell)
    assert body is not None
    return [[x.strip() for x in row.split("&")] for row in body.group(1).split(r"\\")]


@needs_seed
def test_table_1_arrived() -> None:
    rows = printed_rows("Link\t$d$ (mm)")
    assert len(rows) == 5

    def plain(cell: str) -> str:
        return cell.strip("$").replace("\\", "")

    for cells, row in zip(rows, a5.published().table_1.rows, strict=True):
        a = row.a if isinstance(row.a, str) else row.a.text
        assert [row.link, row.d.text, row.theta, a, row.alpha] == [
            plain(c) for c in cells
        ]


@needs_seed
def test_caption_and_torus_numbers_arrived() -> None:
    text = SEED.read_text(encoding="utf-8")
    printed = a5.published()
    caption = next(line for line in text.splitlines() if line.startswith("Table 1:"))
    opposite = printed.elbow.opposite.text
    adjacent = printed.elbow.adjacent.text
    assert rf"\frac{{{opposite}}}{{{adjacent}}}" in caption
    assert rf"\sqrt{{{opposite}^2 + ({adjacent})^2}}" in caption
    numbers = printed.workspace
    assert f"({numbers.inner_offset.text} + a_2)^2" in text
    assert f"({numbers.inner_length.text} + d_3)^2" in text
    assert f"(z - d_0 + {numbers.downward_drop.text})^2" in text


@needs_seed
def test_table_2_arrived() -> None:
    rows = printed_rows("Link\tMass (kg)")
    assert len(rows) == 5
    for cells, row in zip(rows, a5.published().table_2.rows, strict=True):
        assert [row.link, row.mass.text] == cells[:2]
        assert [c.text for c in row.com] == cells[2].strip("() ").split()
        assert [[x.text for x in r] for r in row.inertia_com] == matrix(cells[3])
        assert [[x.text for x in r] for r in row.inertia_link] == matrix(cells[4])


@needs_seed
def test_table_3_arrived() -> None:
    rows = printed_rows("Link\tVolume (L)")
    assert len(rows) == 5
    for cells, row in zip(rows, a5.published().table_3.rows, strict=True):
        assert [row.link, row.volume.text] == cells[:2]
        assert [c.text for c in row.cob] == cells[2].strip("() ").split()


@needs_seed
def test_table_4_arrived() -> None:
    rows = printed_rows("Actuator\tR")
    assert len(rows) == 5
    for cells, row in zip(rows, a5.published().table_4.rows, strict=True):
        friction, tolerance = cells[3].removesuffix("%").split("±")
        assert [
            row.actuator,
            row.resistance.text,
            row.inductance.text,
            row.friction.text,
            row.friction_tolerance.text,
            row.efficiency.text,
            row.torque_constant.text,
            row.voltage_constant.text,
            row.gear_ratio.text,
        ] == [*cells[:3], friction, tolerance, *cells[4:]]


def test_table_4_says_where_each_column_comes_from() -> None:
    """Section 2.2.1: friction is from the current-velocity profile, the rest is not."""
    table = a5.published().table_4
    origins = dict(table.origins)
    columns = {field.name for field in dataclasses.fields(table.rows[0])}
    columns.remove("actuator")
    assert set(origins) == columns
    friction = {origins.pop("friction"), origins.pop("friction_tolerance")}
    assert friction == {"approximated from the current-velocity profile"}
    assert set(origins.values()) == {"motor/gearbox data sheet"}


@needs_seed
def test_the_origins_are_the_documents_words() -> None:
    text = SEED.read_text(encoding="utf-8")
    assert "are approximated from the current-velocity profile" in text
    assert (
        "All other properties are taken from the motor/gearbox manufacture data-sheets"
        in text
    )


@needs_seed
def test_head_arrived() -> None:
    text = SEED.read_text(encoding="utf-8")
    source = a5.published().table_1.source
    assert " ".join(text.split()).startswith(
        f"{source.document} Version {source.version} {source.date}"
    )
    for table in (getattr(a5.published(), f"table_{n}") for n in (1, 2, 3, 4)):
        heading = rf"^#+ {re.escape(table.source.section)} "
        assert re.search(heading, text, re.M), f"no Section {table.source.section}"
        assert f"Table {table.source.table}: {table.source.caption}" in text


@needs_seed
def test_a_lost_digit_is_seen() -> None:
    """The comparison above can fail: it finds a digit that is dropped from the data."""
    rows = printed_rows("Link\tMass (kg)")
    mutilated = parse(DOCUMENT.replace('"-7.120"', '"-7.12"'), SUPPLEMENTARY)
    com = mutilated.table_2.rows[0].com
    assert [number.text for number in com] != rows[0][2].strip("() ").split()
    complete = a5.published().table_2.rows[0].com
    assert com[1].si == complete[1].si


# --- every value has a source ---------------------------------------------------------


def walk(record: object) -> Iterator[object]:
    yield record
    if dataclasses.is_dataclass(record):
        for field in dataclasses.fields(record):
            yield from walk(getattr(record, field.name))
    elif isinstance(record, tuple):
        for item in record:
            yield from walk(item)
    elif isinstance(record, dict):
        yield from walk(tuple(record.values()))


def test_every_table_names_document_version_date_section() -> None:
    sources = [x for x in walk(a5.published()) if isinstance(x, Source)]
    assert len(sources) == 5  # four tables and the torus numbers
    for source in sources:
        assert str(source).startswith(
            "Reach Robotics, Reach Alpha MKII Kinematic and Dynamic"
        )
        assert "version 7, August 2022, Section " in str(source)
        named = f", Table {source.table}" if source.table else source.section
        assert str(source).endswith(named)


def test_every_supplementary_value_has_unit_status_source() -> None:
    extra = a5.published().supplementary
    kinds = SourcedQuantity | BodyBounds | Driver
    sourced = [x for x in walk(extra) if isinstance(x, kinds)]
    assert len(sourced) == 5 * 4 + len(extra.jaws) + 5 + len(extra.drivers)
    for value in sourced:
        assert value.status in STATUSES
        assert len(value.source) > 10
    # No number stands in the record outside a value that carries its source.
    held = {id(q) for s in sourced for q in walk(s) if isinstance(q, Quantity)}
    assert {id(q) for q in walk(extra) if isinstance(q, Quantity)} == held


def test_efforts_are_called_placeholders() -> None:
    assert {j.effort.status for j in a5.published().supplementary.joints} == {
        "placeholder"
    }


def test_records_are_frozen_and_read_once() -> None:
    printed = a5.published()
    assert printed is a5.published()
    with pytest.raises(dataclasses.FrozenInstanceError):
        printed.table_2.rows[0].mass.text = "1"  # type: ignore[misc]


# --- the data files -------------------------------------------------------------------

FILES = {
    path.name: tomllib.loads(path.read_text("utf-8")) for path in DATA.glob("*.toml")
}
#: A number as printed: no exponent, no sign of a thousand, no infinity.
PRINTED = re.compile(r"[+-]?[0-9]{1,20}(\.[0-9]{1,20})?")


def tables_of(data: Any) -> Iterator[dict[str, Any]]:
    """Every table of a file, whatever is around it."""
    if isinstance(data, dict):
        yield data
        data = list(data.values())
    if isinstance(data, list):
        for item in data:
            yield from tables_of(item)


def check_units(given: dict[str, str], *kinds: type[Any]) -> None:
    """The units that a file names are those that its numbers are read in."""
    fields = [field for kind in kinds for field in dataclasses.fields(kind)]
    read = {f.name: f.metadata["units"][0] for f in fields if f.metadata}
    for name, unit in given.items():
        if name in read:
            assert read[name] == unit, name
    assert {name for name, unit in read.items() if unit} <= given.keys()


def test_units_are_those_of_the_files() -> None:
    document = FILES["reach_alpha_mk2_v7.toml"]
    kinds = (tables.DHRow, tables.InertialRow, tables.BuoyancyRow, tables.ActuatorRow)
    for number, kind in enumerate(kinds, 1):
        check_units(document[f"table_{number}"]["units"], kind)
    check_units(document["workspace"]["units"], tables.WorkspaceNumbers)
    check_units(FILES["earlier_revision.toml"]["table"]["units"], tables.EarlierRow)
    for name in ("estimated", "supplementary"):
        units = FILES[f"{name}_hydrodynamics.toml"]["units"]
        assert units.pop("added_mass") == ", ".join(tables.ADDED_MASS_UNITS)
        check_units(units, tables.HydrodynamicRow, tables.StripRow)
    extra = FILES["supplementary.toml"]
    for name, unit in tables.JAW_UNITS.items():
        assert extra["jaws"][name]["unit"] == unit, name
    rows = {f.name: f.metadata for f in dataclasses.fields(tables.JointRow)}
    for joint, row in extra["joints"].items():
        for name in ("lower", "upper", "velocity", "effort"):
            assert row[name]["unit"] == rows[name]["units"][joint == "axis_a"]
    assert extra["jaws"].keys() == tables.JAW_UNITS.keys()
    assert extra["joints"].keys() == {*tables.JOINT_NAMES}
    assert all(driver["unit"] == "mA" for driver in extra["drivers"].values())


def test_wrong_units_would_be_seen() -> None:
    with pytest.raises(AssertionError, match="com"):
        check_units({"mass": "kg", "com": "m"}, tables.InertialRow)


@pytest.mark.parametrize("name", FILES)
def test_tables_have_equal_keys_statuses_and_printed_numbers(name: str) -> None:
    for table in tables_of(FILES[name]):
        rows = table.get("rows", [])
        assert len({tuple(row) for row in rows}) <= 1
        assert len(rows) in (0, 5)
        for number, row in enumerate(rows):
            assert str(number) in row.values()  # base to tip
        if "status" in table:
            assert table["status"] in STATUSES
            assert len(table["source"]) > 10
        if "value" in table:
            assert PRINTED.fullmatch(table["value"])
    for value in walk((a5.published(), earlier_revision())):
        assert not isinstance(value, Quantity) or PRINTED.fullmatch(value.text)


def test_tensors_are_symmetric_and_ranges_upright() -> None:
    printed = a5.published()
    for row in (*printed.table_2.rows, *earlier_revision()):
        for tensor in (row.inertia_com, row.inertia_link):
            values = [[number.value for number in line] for line in tensor]
            assert values == [list(column) for column in zip(*values, strict=True)]
    for joint in printed.supplementary.joints:
        assert joint.lower.quantity.value < joint.upper.quantity.value
    for body in printed.supplementary.bodies:
        assert all(low.value < high.value for low, high in body.bounds)
    columns = {field.name for field in dataclasses.fields(tables.ActuatorRow)}
    assert printed.table_4.origins.keys() == columns - {"actuator"}


def test_an_unreadable_expression_is_refused() -> None:
    from alpha5_model.numbers.parameters import parameters_from_tables

    for wrong, term in (
        ("theta_3 + tau/4", "'tau/4'"),
        ("pi/2 - theta_3", "'-theta_3'"),  # it turns the other way
        ("theta_3 + theta_2", "'theta_2'"),
    ):
        printed = parse(DOCUMENT.replace("theta_3 + pi/2", wrong), SUPPLEMENTARY)
        with pytest.raises(ValueError, match=f"Table 1, link 3.*{term}"):
            parameters_from_tables(printed, ())
