"""Every printed digit arrives, every value has a source, malformed data is refused."""

from __future__ import annotations

import dataclasses
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import alpha5_model as a5
from alpha5_model.errors import Alpha5Error, PublishedDataError
from alpha5_model.numbers.printed import parse
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


def test_the_origins_of_table_4_must_be_those_of_its_columns() -> None:
    for old, new in (
        ('friction = "approximated from the current-velocity profile"\n', ""),
        ("[table_4.origins]", '[table_4.origins]\ncolour = "guess"'),
    ):
        assert DOCUMENT.count(old) == 1
        with pytest.raises(PublishedDataError, match=r"table_4\.origins"):
            parse(DOCUMENT.replace(old, new), SUPPLEMENTARY)


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


# --- malformed data -------------------------------------------------------------------

TABLE_2 = "reach_alpha_mk2_v7.toml: table_2"
MALFORMED = {
    "not TOML": ('mass = "0.234"', "mass = ", "reach_alpha_mk2_v7.toml", "line"),
    "missing key": ('mass = "0.234"\n', "", f"{TABLE_2}.rows[0].mass", "missing"),
    "missing table": (
        "[document]",
        "[documents]",
        "reach_alpha_mk2_v7.toml: document",
        "missing",
    ),
    "duplicate key": (
        'mass = "0.161"\n',
        'mass = "0.161"\nmass = "0.161"\n',
        "reach_alpha_mk2_v7.toml",
        "line",
    ),
    "wrong unit": (
        'com = "mm"',
        'com = "m"',
        f"{TABLE_2}.units.com",
        "expected 'mm', got 'm'",
    ),
    "missing unit": ('com = "mm"\n', "", f"{TABLE_2}.units.com", "missing"),
    "unknown unit column": (
        'com = "mm"\n',
        'com = "mm"\ncolour = "mm"\n',
        f"{TABLE_2}.units.colour",
        "unknown",
    ),
    "bare number": (
        'mass = "0.161"',
        "mass = 0.161",
        f"{TABLE_2}.rows[1].mass",
        "in quotes",
    ),
    "not a number": (
        'mass = "0.161"',
        'mass = "O.161"',
        f"{TABLE_2}.rows[1].mass",
        "'O.161'",
    ),
    "infinite": ('mass = "0.161"', 'mass = "inf"', f"{TABLE_2}.rows[1].mass", "'inf'"),
    "asymmetric tensor": (
        '["2.832", "393.932", "-0.010"]',
        '["2.823", "393.932", "-0.010"]',
        f"{TABLE_2}.rows[0].inertia_com[0][1]",
        "not symmetric: 2.832 against 2.823",
    ),
    "asymmetric the other way": (
        '["2.832", "393.932", "-0.010"]',
        '["2.841", "393.932", "-0.010"]',
        f"{TABLE_2}.rows[0].inertia_com[0][1]",
        "not symmetric: 2.832 against 2.841",
    ),
    "short tensor": (
        '  ["2.832", "393.932", "-0.010"],\n',
        "",
        f"{TABLE_2}.rows[0].inertia_com",
        "three rows",
    ),
    "short vector": (
        '["7.746", "0.112", "25.038"]',
        '["7.746", "0.112"]',
        f"{TABLE_2}.rows[1].com",
        "three numbers",
    ),
    "unknown key": (
        'mass = "0.161"\n',
        'mass = "0.161"\nmas = "1"\n',
        f"{TABLE_2}.rows[1].mas",
        "unknown key",
    ),
    "rows out of order": (
        'link = "1"\nmass',
        'link = "2"\nmass',
        f"{TABLE_2}.rows[1].link",
        "base to tip",
    ),
    "a row too few": (
        '[[table_3.rows]]\nlink = "4"\nvolume = "0.134"\ncob = ["0", "0", "-97"]\n',
        "",
        "reach_alpha_mk2_v7.toml: table_3.rows",
        "expected 5 rows",
    ),
    "empty source": (
        'publisher = "Reach Robotics"',
        'publisher = " "',
        "reach_alpha_mk2_v7.toml: document.publisher",
        "a text",
    ),
}
MALFORMED_SUPPLEMENTARY = {
    "unknown status": (
        'finger_density = { value = "2700", unit = "kg/m^3", status = "estimated"',
        'finger_density = { value = "2700", unit = "kg/m^3", status = "guessed"',
        "supplementary.toml: jaws.finger_density.status",
        "choose from supplementary, measured",
    ),
    "no source": (
        ', source = "manufacturer\'s public CAD: volume of one finger"',
        "",
        "supplementary.toml: jaws.finger_volume.source",
        "missing",
    ),
    "wrong unit": (
        'value = "0.0133", unit = "m"',
        'value = "0.0133", unit = "mm"',
        "supplementary.toml: joints.axis_a.upper.unit",
        "expected 'm', got 'mm'",
    ),
    "range upside down": (
        'value = "6.143"',
        'value = "0.001"',
        "supplementary.toml: joints.axis_e.upper",
        "not above lower",
    ),
    "device id": (
        "device_id = 5",
        "device_id = true",
        "joints.axis_e.device_id",
        "an integer",
    ),
    "bounds upside down": (
        'link_0 = [["-126.65", "20"]',
        'link_0 = [["26.65", "20"]',
        "supplementary.toml: bodies.link_0[0]",
        "min must be below max",
    ),
    "bounds without width": (
        'link_0 = [["-126.65", "20"]',
        'link_0 = [["20", "20"]',
        "supplementary.toml: bodies.link_0[0]",
        "min must be below max",
    ),
    "a range without width": (
        'value = "6.143"',
        'value = "0.01745"',
        "supplementary.toml: joints.axis_e.upper",
        "not above lower",
    ),
    "unknown joint": (
        "[joints.axis_e]",
        "[joints.axis_f]",
        "supplementary.toml: joints.axis_e",
        "missing",
    ),
    "not a table": (
        "[bodies]\n",
        "[jaws.bodies]\n",
        "supplementary.toml: bodies",
        "missing",
    ),
    "a current that is no number": (
        'axis_b = { forward = "10"',
        'axis_b = { forward = "ten"',
        "supplementary.toml: drivers.uvms_simulator.axis_b.forward",
        "expected a printed decimal number, got 'ten'",
    ),
    "unknown driver": (
        "[drivers.reach_alpha_sim]",
        "[drivers.somebody]",
        "supplementary.toml: drivers.reach_alpha_sim",
        "missing",
    ),
}


@pytest.mark.parametrize("kind", MALFORMED)
def test_malformed_document_is_refused(kind: str) -> None:
    old, new, place, problem = MALFORMED[kind]
    assert DOCUMENT.count(old) == 1, f"{old!r} must stand once in the data"
    refuse(DOCUMENT.replace(old, new), SUPPLEMENTARY, place, problem)


@pytest.mark.parametrize("kind", MALFORMED_SUPPLEMENTARY)
def test_malformed_supplementary_is_refused(kind: str) -> None:
    old, new, place, problem = MALFORMED_SUPPLEMENTARY[kind]
    assert SUPPLEMENTARY.count(old) == 1, f"{old!r} must stand once in the data"
    refuse(DOCUMENT, SUPPLEMENTARY.replace(old, new), place, problem)


def refuse(document: str, supplementary: str, place: str, problem: str) -> None:
    with pytest.raises(PublishedDataError) as caught:
        parse(document, supplementary)
    assert caught.value.place.endswith(place)
    assert problem in str(caught.value)
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, Alpha5Error)
    assert isinstance(caught.value, ValueError)


def test_an_unreadable_expression_is_refused() -> None:
    from alpha5_model.numbers.parameters import parameters_from_tables

    for wrong, term in (
        ("theta_3 + tau/4", "'tau/4'"),
        ("pi/2 - theta_3", "'-theta_3'"),  # it turns the other way
        ("theta_3 + theta_2", "'theta_2'"),
    ):
        printed = parse(DOCUMENT.replace("theta_3 + pi/2", wrong), SUPPLEMENTARY)
        with pytest.raises(PublishedDataError, match=f"Table 1, link 3.*{term}"):
            parameters_from_tables(printed, ())
