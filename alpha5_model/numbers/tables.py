"""Frozen records of all tables, in printed units: the document's and moving water's."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

from alpha5_model.numbers.quantity import Quantity

Triple = tuple[Quantity, Quantity, Quantity]
Tensor = tuple[Triple, Triple, Triple]
Interval = tuple[Quantity, Quantity, Quantity]
Matrix = tuple[tuple[Quantity, ...], ...]
Motions = tuple[Quantity, ...]
RowT = TypeVar("RowT")

STATUSES = ("supplementary", "measured", "placeholder", "estimated")
JOINT_NAMES = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
_LENGTHS = (
    "collar_base",
    "pivot_height",
    "pivot_offset",
    "finger_length",
    "finger_width",
)
#: Quantity of the jaws -> its unit.
JAW_UNITS: dict[str, str] = {
    **dict.fromkeys((*_LENGTHS, "rod_length", "rod_diameter"), "mm"),
    **dict.fromkeys(("finger_density", "rod_density"), "kg/m^3"),
    **dict.fromkeys(("finger_volume", "second_finger_volume"), "L"),
    "finger_turn": "rad/m",
    "sdk_plane": "deg",
}
BODY_NAMES = ("link_0", "link_1", "link_2", "link_3", "link_4")
#: Units of the blocks of an added mass: both indices linear, one angular, both angular.
ADDED_MASS_UNITS = ("kg", "kg.m", "kg.m^2")


def printed(unit: str | None = None, of_rod: str | None = None) -> Any:
    """A field of a printed row.

    Args:
        unit: Of its printed numbers, empty for pure ones; None for text.
        of_rod: The unit in the jaw rod's row, if that is another.
    """
    return field(metadata={} if unit is None else {"units": (unit, of_rod or unit)})


@dataclass(frozen=True, slots=True)
class Source:
    """The source of a table in the document.

    Attributes:
        document, publisher, version, date: Of the document.
        section: Its number.
        table: Its number; empty for numbers in the text.
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
        edition = (
            f"{self.publisher}, {self.document}, version {self.version}, {self.date}"
        )
        return f"{edition}, Section {self.section}{table}"


@dataclass(frozen=True, slots=True)
class Table(Generic[RowT]):
    """A printed table: its source and its rows, base to tip.

    Attributes:
        source: Its place in the document.
        rows: One record per printed row.
        origins: Column -> how the document obtained it, quoted; empty if it does not
            say.
    """

    source: Source
    rows: tuple[RowT, ...]
    origins: dict[str, str] = field(default_factory=dict)


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
    d: Quantity = printed("mm")
    theta: str = printed()
    a: Quantity | str = printed("mm")
    alpha: str = printed()


@dataclass(frozen=True, slots=True)
class Elbow:
    """The two lengths in Table 1's caption that define theta_c and a_1.

    Attributes:
        opposite: 40 in ``arctan(40 / 145.3)`` [mm].
        adjacent: 145.3 in it [mm].
    """

    opposite: Quantity = printed("mm")
    adjacent: Quantity = printed("mm")


@dataclass(frozen=True, slots=True)
class WorkspaceNumbers:
    """The numbers that Section 1.2 prints in its torus formulas instead of symbols.

    Attributes:
        source: Their place in the document.
        inner_offset: 39.94, added to a_2 in the inner torus [mm].
        inner_length: 145.3, added to d_3 in the inner torus [mm].
        downward_drop: 145.3, from the shoulder to the centre of the downward torus
            [mm].
    """

    source: Source
    inner_offset: Quantity = printed("mm")
    inner_length: Quantity = printed("mm")
    downward_drop: Quantity = printed("mm")


@dataclass(frozen=True, slots=True)
class InertialRow:
    """A row of Table 2; SolidWorks' products of inertia are +(integral of x y dm).

    Attributes:
        link: Number of the link, as printed.
        mass: [kg].
        com: x, y, z in the link's inertial frame [mm].
        inertia_com: 3x3 at the COM, in the axes of that frame [kg mm^2].
        inertia_link: 3x3 at the origin of that frame [kg mm^2].
    """

    link: str
    mass: Quantity = printed("kg")
    com: Triple = printed("mm")
    inertia_com: Tensor = printed("kg.mm^2")
    inertia_link: Tensor = printed("kg.mm^2")


@dataclass(frozen=True, slots=True)
class BuoyancyRow:
    """A row of Table 3: volume and centre of buoyancy in the link's inertial frame.

    Attributes:
        link: Number of the link, as printed.
        volume: [L].
        cob: x, y, z [mm].
    """

    link: str
    volume: Quantity = printed("L")
    cob: Triple = printed("mm")


@dataclass(frozen=True, slots=True)
class EarlierRow(InertialRow):
    """A row of the earlier revision: `InertialRow` and `BuoyancyRow` in one."""

    volume: Quantity = printed("L")
    cob: Triple = printed("mm")


@dataclass(frozen=True, slots=True)
class ActuatorRow:
    """A row of Table 4. ``friction`` is printed with its tolerance, 3.752 Nmm +- 10 %.

    Attributes:
        actuator: Number of the actuator, as printed.
        resistance: Of the winding [Ohm].
        inductance: Of the winding [uH].
        friction: At the motor shaft [N mm].
        friction_tolerance: Of the friction [%].
        efficiency: eta_max, of the gearbox or of the motor: the table does not say [%].
        torque_constant: K_t [N m/A].
        voltage_constant: K_v [V s/rad].
        gear_ratio: Motor turns per turn of the output.
    """

    actuator: str
    resistance: Quantity = printed("Ohm")
    inductance: Quantity = printed("uH")
    friction: Quantity = printed("Nmm")
    friction_tolerance: Quantity = printed("%")
    efficiency: Quantity = printed("%")
    torque_constant: Quantity = printed("Nm/A")
    voltage_constant: Quantity = printed("V/rad/s")
    gear_ratio: Quantity = printed("")


@dataclass(frozen=True, slots=True)
class SourcedQuantity:
    """A number from outside the document, with its status and its source.

    Attributes:
        quantity: The number and its unit.
        status: One of ``STATUSES``.
        source: Its source, in words.
    """

    quantity: Quantity
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class JointRow:
    """Range, speed and effort of a joint; the document prints none of them.

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
    lower: SourcedQuantity = printed("rad", "m")
    upper: SourcedQuantity = printed("rad", "m")
    velocity: SourcedQuantity = printed("deg/s", "mm/s")
    effort: SourcedQuantity = printed("Nm", "N")


@dataclass(frozen=True, slots=True)
class BodyBounds:
    """Outer bounds of a body in its inertial frame: one (min, max) pair per axis.

    Attributes:
        name: ``link_0`` to ``link_4``.
        bounds: Pairs for x, y, z [mm].
        status: One of ``STATUSES``.
        source: Its source, in words.
    """

    name: str
    bounds: tuple[
        tuple[Quantity, Quantity], tuple[Quantity, Quantity], tuple[Quantity, Quantity]
    ]
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class DriverCurrents:
    """Motor currents of a joint that a public driver assumes.

    Attributes:
        name: ``axis_e`` (base) to ``axis_b``.
        forward, backward: That overcome friction, in each direction [mA].
        cap: Largest that the driver commands [mA].
    """

    name: str
    forward: Quantity = printed("mA")
    backward: Quantity = printed("mA")
    cap: Quantity = printed("mA")


@dataclass(frozen=True, slots=True)
class Driver:
    """A public driver of the arm, and the motor currents that it assumes.

    Attributes:
        name: A key of `Supplementary.drivers`.
        joints: Base to tip, without the jaw rod.
        status: One of ``STATUSES``.
        source: Its source, in words.
    """

    name: str
    joints: tuple[DriverCurrents, ...]
    status: str
    source: str


@dataclass(frozen=True, slots=True)
class Supplementary:
    """Values that the document does not print: joints, jaws, body bounds, drivers.

    Attributes:
        joints: Base to tip, the jaw rod last.
        jaws: Name of a quantity -> its value.
        bodies: Base to tip.
        drivers: Name -> currents; for the audit, the model does not use them.
    """

    joints: tuple[JointRow, ...]
    jaws: dict[str, SourcedQuantity]
    bodies: tuple[BodyBounds, ...]
    drivers: dict[str, Driver]


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
        supplementary: Values that the document does not print.
    """

    table_1: Table[DHRow]
    elbow: Elbow
    workspace: WorkspaceNumbers
    table_2: Table[InertialRow]
    table_3: Table[BuoyancyRow]
    table_4: Table[ActuatorRow]
    supplementary: Supplementary


@dataclass(frozen=True, slots=True)
class StripRow:
    """A strip of a body along which the water drags; see `DragStrip`.

    Attributes:
        start, end: In the body's frame [mm].
        diameter: [mm].
        across, along: Drag coefficients: low, nominal, high.
    """

    start: Triple = printed("mm")
    end: Triple = printed("mm")
    diameter: Quantity = printed("mm")
    across: Interval = printed("")
    along: Interval = printed("")


@dataclass(frozen=True, slots=True)
class HydrodynamicRow:
    """Added mass and drag of a body; no document publishes them.

    Attributes:
        name: ``link_0`` to ``link_4`` (closed jaws), ``link_4_open``, ``wrist`` (link 4
            without its fingers), ``finger_1``, ``finger_2``.
        added_mass: 6x6, linear before angular, about and in the link's frame, for 1000
            kg/m^3.
        added_mass_factor: Of all its entries: low, nominal, high.
        shape_low, shape_high: Factors by which the shape, which no document prints, can
            change the added mass of a motion along and about each axis at its centre.
        strips: Along which the water drags.
        status: One of ``STATUSES``.
        source: Its source, in words.
        method: How it was computed.
    """

    name: str
    added_mass: Matrix
    added_mass_factor: Interval = printed("")
    shape_low: Motions = printed("")
    shape_high: Motions = printed("")
    strips: tuple[StripRow, ...] = ()
    status: str = ""
    source: str = ""
    method: str = ""
