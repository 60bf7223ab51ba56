"""The document's tables as frozen records in printed units, read from the two data files."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Generic, TypeVar

from alpha5_model.errors import PublishedDataError
from alpha5_model.published.quantity import Quantity

Triple = tuple[Quantity, Quantity, Quantity]
Tensor = tuple[Triple, Triple, Triple]
RowT = TypeVar("RowT")

STATUSES = ("supplementary", "measured", "placeholder", "estimated")
JOINT_NAMES = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
BODY_NAMES = ("link_0", "link_1", "link_2", "link_3", "link_4")


@dataclass(frozen=True, slots=True)
class Source:
    """Where a table stands in the document.

    Attributes:
        document, publisher, version, date: Of the document.
        section: Its number.
        table: Its number; empty for numbers that stand in the text.
        caption: As printed.
    """

    document: str
    publisher: str
    version: str
    date: str
    section: str
    table: str
    caption: str

    def __str__(self) -> str:
        table = f", Table {self.table}" if self.table else ""
        return (
            f"{self.publisher}, {self.document}, version {self.version}, {self.date}, "
            f"Section {self.section}{table}"
        )


@dataclass(frozen=True, slots=True)
class Table(Generic[RowT]):
    """A printed table: its source and its rows, base to tip.

    Attributes:
        source: Where it stands.
        rows: One record per printed row.
    """

    source: Source
    rows: tuple[RowT, ...]


@dataclass(frozen=True, slots=True)
class DHRow:
    """A row of Table 1. Expressions such as ``pi/2`` and ``a_1`` are kept as printed.

    Attributes:
        link: Number of the link, as printed.
        d: Offset along z [mm].
        theta: Joint angle, an expression [rad].
        a: Length along x [mm], or an expression.
        alpha: Twist about x, an expression [rad].
    """

    link: str
    d: Quantity
    theta: str
    a: Quantity | str
    alpha: str


@dataclass(frozen=True, slots=True)
class Elbow:
    """The two lengths in Table 1's caption that define theta_c and a_1.

    Attributes:
        opposite: 40 in ``arctan(40 / 145.3)`` [mm].
        adjacent: 145.3 in it [mm].
    """

    opposite: Quantity
    adjacent: Quantity


@dataclass(frozen=True, slots=True)
class WorkspaceNumbers:
    """The numbers that Section 1.2 prints in its torus formulas instead of symbols.

    Attributes:
        source: Where they stand.
        inner_offset: 39.94, added to a_2 in the inner torus [mm].
        inner_length: 145.3, added to d_3 in the inner torus [mm].
        downward_drop: 145.3, from the shoulder to the centre of the downward torus [mm].
    """

    source: Source
    inner_offset: Quantity
    inner_length: Quantity
    downward_drop: Quantity


@dataclass(frozen=True, slots=True)
class InertialRow:
    """A row of Table 2, SolidWorks convention: products of inertia are +(integral of x y dm).

    Attributes:
        link: Number of the link, as printed.
        mass: [kg].
        com: x, y, z in the link's inertial frame [mm].
        inertia_com: 3x3 at the COM, in the axes of that frame [kg mm^2].
        inertia_link: 3x3 at the origin of that frame [kg mm^2].
    """

    link: str
    mass: Quantity
    com: Triple
    inertia_com: Tensor
    inertia_link: Tensor


@dataclass(frozen=True, slots=True)
class BuoyancyRow:
    """A row of Table 3: displaced volume and centre of buoyancy in the link's inertial frame.

    Attributes:
        link: Number of the link, as printed.
        volume: [L].
        cob: x, y, z [mm].
    """

    link: str
    volume: Quantity
    cob: Triple


@dataclass(frozen=True, slots=True)
class ActuatorRow:
    """A row of Table 4. ``friction`` is printed with its tolerance, 3.752 Nmm +- 10 %.

    Attributes:
        actuator: Number of the actuator, as printed.
        resistance, inductance: Of the winding [Ohm], [uH].
        friction, friction_tolerance: At the motor shaft [N mm], [%].
        efficiency: Highest, of the gearbox [%].
        torque_constant, voltage_constant: K_t [N m/A], K_v [V s/rad].
        gear_ratio: Motor turns per turn of the output.
    """

    actuator: str
    resistance: Quantity
    inductance: Quantity
    friction: Quantity
    friction_tolerance: Quantity
    efficiency: Quantity
    torque_constant: Quantity
    voltage_constant: Quantity
    gear_ratio: Quantity


@dataclass(frozen=True, slots=True)
class SourcedQuantity:
    """A number from outside the document, with its status (see ``STATUSES``) and its source.

    Attributes:
        quantity: The number and its unit.
        status: One of ``STATUSES``.
        source: Who says so.
    """

    quantity: Quantity
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class JointRow:
    """Range, speed and effort of a joint, none of which the document prints.

    Attributes:
        name: ``axis_e`` (base) to ``axis_a`` (jaw rod).
        dh_variable: The document's name of the same coordinate.
        device_id: Address of the actuator on the arm's bus.
        lower, upper: Ends of the range [rad], jaw rod [m].
        velocity: Largest speed, in the unit of its source.
        effort: Largest torque [N m], jaw rod [N]; a placeholder.
    """

    name: str
    dh_variable: str
    device_id: int
    lower: SourcedQuantity
    upper: SourcedQuantity
    velocity: SourcedQuantity
    effort: SourcedQuantity


@dataclass(frozen=True, slots=True)
class BodyBounds:
    """Outer bounds of a body in its inertial frame: one (min, max) pair per axis.

    Attributes:
        name: ``link_0`` to ``link_4``.
        bounds: Pairs for x, y, z [mm].
        status: One of ``STATUSES``.
        source: Who says so.
    """

    name: str
    bounds: tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity], tuple[Quantity, Quantity]]
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class Supplementary:
    """Everything that is not in the document: joints base to tip, jaw geometry, body bounds.

    Attributes:
        joints: Base to tip, the jaw rod last.
        jaws: Name of a quantity -> its value.
        bodies: Base to tip.
    """

    joints: tuple[JointRow, ...]
    jaws: dict[str, SourcedQuantity]
    bodies: tuple[BodyBounds, ...]


@dataclass(frozen=True, slots=True)
class Published:
    """Tables 1-4 as printed, the numbers of Section 1.2, and the supplementary values.

    Attributes:
        table_1: DH parameters.
        elbow: The lengths in Table 1's caption.
        workspace: The numbers of Section 1.2.
        table_2: Masses, COMs and inertias.
        table_3: Volumes and centres of buoyancy.
        table_4: Actuators.
        supplementary: What the document does not print.
    """

    table_1: Table[DHRow]
    elbow: Elbow
    workspace: WorkspaceNumbers
    table_2: Table[InertialRow]
    table_3: Table[BuoyancyRow]
    table_4: Table[ActuatorRow]
    supplementary: Supplementary


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
    document = _Node.root("reach_alpha_mk2_v7.toml", document_text)
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
        ),
        supplementary=_supplementary(_Node.root("supplementary.toml", supplementary_text)),
    )
    document.finish()
    return result


def _source(head: _Node, table: _Node) -> Source:
    return Source(
        document=head.text("title"),
        publisher=head.text("publisher"),
        version=head.text("version"),
        date=head.text("date"),
        section=table.text("section"),
        table=table.text("number"),
        caption=table.text("caption"),
    )


def _supplementary(root: _Node) -> Supplementary:
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


class _Node:
    """A TOML table that knows its place and which of its keys were read."""

    def __init__(self, content: dict[str, Any], path: str) -> None:
        self.content, self.path = content, path
        self.used: set[str] = set()
        self.children: dict[str, _Node] = {}

    @classmethod
    def root(cls, file: str, text: str) -> _Node:
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

    def table(self, key: str) -> _Node:
        if key not in self.children:
            value = self.get(key)
            if not isinstance(value, dict):
                raise PublishedDataError(self.place(key), f"expected a table, got {value!r}")
            self.children[key] = _Node(value, self.place(key))
        return self.children[key]

    def rows(self, count: int) -> list[_Node]:
        value = self.get("rows")
        if not isinstance(value, list) or len(value) != count:
            raise PublishedDataError(self.place("rows"), f"expected {count} rows")
        for i, row in enumerate(value):
            if not isinstance(row, dict):
                raise PublishedDataError(self.place(f"rows[{i}]"), f"expected a table, got {row!r}")
            self.children[f"rows[{i}]"] = _Node(row, self.place(f"rows[{i}]"))
        return [self.children[f"rows[{i}]"] for i in range(count)]

    def quantity(self, key: str, table: _Node, unit: str) -> Quantity:
        return Quantity.parse(self.get(key), table.column_unit(key, unit), self.place(key))

    def expression(self, key: str, table: _Node, unit: str) -> str:
        table.column_unit(key, unit)
        return self.text(key)

    def column_unit(self, key: str, expected: str) -> str:
        units = self.table("units")
        if (given := units.get(key)) != expected:
            raise PublishedDataError(units.place(key), f"expected {expected!r}, got {given!r}")
        return expected

    def triple(self, key: str, table: _Node, unit: str) -> Triple:
        return _triple(self.get(key), table.column_unit(key, unit), self.place(key))

    def tensor(self, key: str, table: _Node, unit: str) -> Tensor:
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
