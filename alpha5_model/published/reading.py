"""The two data files read into the records of `alpha5_model.published.tables`."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from alpha5_model.errors import PublishedDataError
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import (
    BODY_NAMES,
    JOINT_NAMES,
    ActuatorRow,
    BodyBounds,
    BuoyancyRow,
    DHRow,
    Elbow,
    InertialRow,
    JointRow,
    Published,
    Source,
    Supplementary,
    Table,
    WorkspaceNumbers,
)
from alpha5_model.published.toml_table import TomlTable


@cache
def load() -> Published:
    """The two data files of this folder; see `alpha5_model.published`."""
    folder = Path(__file__).parent
    return parse(
        (folder / "reach_alpha_mk2_v7.toml").read_text(encoding="utf-8"),
        (folder / "supplementary.toml").read_text(encoding="utf-8"),
    )


def parse(document_text: str, supplementary_text: str) -> Published:
    """Read the texts of the two data files.

    Raises:
        PublishedDataError: Not TOML, duplicate, missing or unknown key, wrong unit, not a number,
            asymmetric tensor, rows out of order, unknown status, empty source.
    """
    document = TomlTable.root("reach_alpha_mk2_v7.toml", document_text)
    head = document.table("document")
    one, workspace = document.table("table_1"), document.table("workspace")
    two, three, four = (document.table(f"table_{n}") for n in (2, 3, 4))
    elbow, values = one.table("elbow"), workspace.table("values")
    result = Published(
        table_1=Table(
            _source(head, one),
            tuple(
                DHRow(
                    link=row.name("link", i),
                    d=row.quantity("d", one, "mm"),
                    theta=row.expression("theta", one, "rad"),
                    a=(row.text("a") if row.get("a") == "a_1" else row.quantity("a", one, "mm")),
                    alpha=row.expression("alpha", one, "rad"),
                )
                for i, row in enumerate(one.rows(5))
            ),
        ),
        elbow=Elbow(
            *(Quantity.parse(elbow.get(k), "mm", elbow.place(k)) for k in ("opposite", "adjacent"))
        ),
        workspace=WorkspaceNumbers(
            _source(head, workspace),
            *(
                values.quantity(k, workspace, "mm")
                for k in ("inner_offset", "inner_length", "downward_drop")
            ),
        ),
        table_2=Table(
            _source(head, two),
            tuple(
                InertialRow(
                    link=row.name("link", i),
                    mass=row.quantity("mass", two, "kg"),
                    com=row.triple("com", two, "mm"),
                    inertia_com=row.tensor("inertia_com", two, "kg.mm^2"),
                    inertia_link=row.tensor("inertia_link", two, "kg.mm^2"),
                )
                for i, row in enumerate(two.rows(5))
            ),
        ),
        table_3=Table(
            _source(head, three),
            tuple(
                BuoyancyRow(
                    link=row.name("link", i),
                    volume=row.quantity("volume", three, "L"),
                    cob=row.triple("cob", three, "mm"),
                )
                for i, row in enumerate(three.rows(5))
            ),
        ),
        table_4=Table(
            _source(head, four),
            tuple(
                ActuatorRow(
                    actuator=row.name("actuator", i),
                    resistance=row.quantity("resistance", four, "Ohm"),
                    inductance=row.quantity("inductance", four, "uH"),
                    friction=row.quantity("friction", four, "Nmm"),
                    friction_tolerance=row.quantity("friction_tolerance", four, "%"),
                    efficiency=row.quantity("efficiency", four, "%"),
                    torque_constant=row.quantity("torque_constant", four, "Nm/A"),
                    voltage_constant=row.quantity("voltage_constant", four, "V/rad/s"),
                    gear_ratio=row.quantity("gear_ratio", four, ""),
                )
                for i, row in enumerate(four.rows(5))
            ),
            {key: four.table("origins").text(key) for key in four.table("units").content},
        ),
        supplementary=_supplementary(TomlTable.root("supplementary.toml", supplementary_text)),
    )
    document.finish()
    return result


def _source(head: TomlTable, table: TomlTable) -> Source:
    return Source(
        document=head.text("title"),
        publisher=head.text("publisher"),
        version=head.text("version"),
        date=head.text("date"),
        section=table.text("section"),
        table=table.text("number"),
        caption=table.text("caption"),
    )


def _supplementary(root: TomlTable) -> Supplementary:
    joints = root.table("joints")
    joint_rows = []
    for name in JOINT_NAMES:
        joint, unit = joints.table(name), "m" if name == "axis_a" else "rad"
        device_id = joint.get("device_id")
        if type(device_id) is not int:
            raise PublishedDataError(
                joint.place("device_id"), f"expected an integer, got {device_id!r}"
            )
        lower, upper = joint.sourced("lower", unit), joint.sourced("upper", unit)
        if lower.quantity.value >= upper.quantity.value:
            raise PublishedDataError(
                joint.place("upper"), f"{upper.quantity} is not above lower, {lower.quantity}"
            )
        joint_rows.append(
            JointRow(
                name=name,
                dh_variable=joint.text("dh_variable"),
                device_id=device_id,
                lower=lower,
                upper=upper,
                velocity=joint.sourced("velocity", "mm/s" if unit == "m" else "deg/s"),
                effort=joint.sourced("effort", "N" if unit == "m" else "Nm"),
            )
        )
    jaws = root.table("jaws")
    jaw_units = {
        "collar_base": "mm",
        "pivot_height": "mm",
        "pivot_offset": "mm",
        "finger_length": "mm",
        "finger_width": "mm",
        "finger_volume": "L",
        "finger_density": "kg/m^3",
        "rod_length": "mm",
        "rod_diameter": "mm",
        "rod_density": "kg/m^3",
        "finger_turn": "rad/m",
    }
    bodies = root.table("bodies")
    unit = bodies.text("unit")
    if unit != "mm":
        raise PublishedDataError(bodies.place("unit"), f"expected 'mm', got {unit!r}")
    result = Supplementary(
        joints=tuple(joint_rows),
        jaws={key: jaws.sourced(key, unit) for key, unit in jaw_units.items()},
        bodies=tuple(
            BodyBounds(name, bodies.bounds(name, unit), bodies.status(), bodies.text("source"))
            for name in BODY_NAMES
        ),
    )
    root.finish()
    return result
