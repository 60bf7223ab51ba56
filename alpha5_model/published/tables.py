"""The document's tables as frozen records in printed units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

from alpha5_model.published.quantity import Quantity

Triple = tuple[Quantity, Quantity, Quantity]
Tensor = tuple[Triple, Triple, Triple]
RowT = TypeVar("RowT")

STATUSES = ("supplementary", "measured", "placeholder", "estimated")
JOINT_NAMES = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
BODY_NAMES = ("link_0", "link_1", "link_2", "link_3", "link_4")


@dataclass(frozen=True, slots=True)
class Source:
    """Where a table stands in the document."""

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
    """A printed table: its source and its rows, base to tip."""

    source: Source
    rows: tuple[RowT, ...]


@dataclass(frozen=True, slots=True)
class DHRow:
    """A row of Table 1. Expressions such as ``pi/2`` and ``a_1`` are kept as printed."""

    link: str
    d: Quantity
    theta: str
    a: Quantity | str
    alpha: str


@dataclass(frozen=True, slots=True)
class Elbow:
    """The two lengths in Table 1's caption that define theta_c and a_1."""

    opposite: Quantity
    adjacent: Quantity


@dataclass(frozen=True, slots=True)
class WorkspaceNumbers:
    """The numbers that Section 1.2 prints in its torus formulas instead of symbols."""

    source: Source
    inner_offset: Quantity
    inner_length: Quantity
    downward_drop: Quantity


@dataclass(frozen=True, slots=True)
class InertialRow:
    """A row of Table 2, SolidWorks convention: products of inertia are +(integral of x y dm)."""

    link: str
    mass: Quantity
    com: Triple
    inertia_com: Tensor
    inertia_link: Tensor


@dataclass(frozen=True, slots=True)
class BuoyancyRow:
    """A row of Table 3: displaced volume and centre of buoyancy in the link's inertial frame."""

    link: str
    volume: Quantity
    cob: Triple


@dataclass(frozen=True, slots=True)
class ActuatorRow:
    """A row of Table 4. ``friction`` is printed with its tolerance, 3.752 Nmm +- 10 %."""

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
    """A number from outside the document, with its status (see ``STATUSES``) and its source."""

    quantity: Quantity
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class JointRow:
    """Range, speed and effort of a joint, none of which the document prints."""

    name: str
    dh_variable: str
    device_id: int
    lower: SourcedQuantity
    upper: SourcedQuantity
    velocity: SourcedQuantity
    effort: SourcedQuantity


@dataclass(frozen=True, slots=True)
class BodyBounds:
    """Outer bounds of a body in its inertial frame: one (min, max) pair per axis."""

    name: str
    bounds: tuple[tuple[Quantity, Quantity], tuple[Quantity, Quantity], tuple[Quantity, Quantity]]
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class Supplementary:
    """Everything that is not in the document: joints base to tip, jaw geometry, body bounds."""

    joints: tuple[JointRow, ...]
    jaws: dict[str, SourcedQuantity]
    bodies: tuple[BodyBounds, ...]


@dataclass(frozen=True, slots=True)
class Published:
    """Tables 1-4 as printed, the numbers of Section 1.2, and the supplementary values."""

    table_1: Table[DHRow]
    elbow: Elbow
    workspace: WorkspaceNumbers
    table_2: Table[InertialRow]
    table_3: Table[BuoyancyRow]
    table_4: Table[ActuatorRow]
    supplementary: Supplementary
