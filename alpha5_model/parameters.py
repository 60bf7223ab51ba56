"""The published numbers in SI units and URDF convention, frozen.

Everything that computes takes its numbers from `parameters`.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, fields
from functools import cache
from typing import Any

from alpha5_model.checks import FloatArray, frozen
from alpha5_model.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.errors import PublishedDataError
from alpha5_model.inertia import flip_products
from alpha5_model.published import published, tables
from alpha5_model.published.quantity import Quantity


@dataclass(frozen=True, eq=False)
class DHParameters:
    """A row of Table 1: ``A = Rz(theta) Tz(d) Tx(a) Rx(alpha)``, ``theta = q + theta_offset``.

    Attributes:
        d: Offset along the previous z [m].
        theta_offset: Constant part of theta [rad].
        a: Length of the common normal [m].
        alpha: Angle about the common normal [rad].
        variable: Name of the joint variable in the document; None for the fixed last row.
    """

    d: float
    theta_offset: float
    a: float
    alpha: float
    variable: str | None


@dataclass(frozen=True, eq=False)
class RigidBody:
    """Mass and displaced water of one body, in its own frame.

    Attributes:
        name: As the link of the URDF.
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
    """

    name: str
    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray


@dataclass(frozen=True, eq=False)
class LinkParameters(RigidBody):
    """One link, ``link_0`` to ``link_4``, in its inertial frame.

    Attributes:
        bounds: Outer bounds of the body, (3, 2) [m].
    """

    bounds: FloatArray


@dataclass(frozen=True, eq=False)
class JointRange:
    """Range, speed and effort of a joint; [rad, rad/s, N m], for the jaw rod [m, m/s, N].

    Attributes:
        name: ``axis_e`` (base) to ``axis_b`` (wrist), ``axis_a`` (jaw rod), ``finger_1_joint``,
            ``finger_2_joint``.
        lower, upper: Ends of the range.
        velocity: Largest speed.
        effort: A placeholder that every public model copies; no rating is published.
    """

    name: str
    lower: float
    upper: float
    velocity: float
    effort: float

    @property
    def kind(self) -> str:
        """``revolute`` or ``prismatic``."""
        return "prismatic" if self.name == "axis_a" else "revolute"


@dataclass(frozen=True, eq=False)
class JointParameters(JointRange):
    """A joint with an actuator of its own.

    Attributes:
        dh_variable: The document's name of the same coordinate.
        device_id: Address of the actuator on the arm's bus.
    """

    dh_variable: str
    device_id: int


@dataclass(frozen=True, eq=False)
class ActuatorParameters:
    """A row of Table 4.

    Attributes:
        resistance: [Ohm].
        inductance: [H].
        friction: At the motor shaft [N m].
        friction_tolerance: Printed relative tolerance of the friction, 0.1 for 10 %.
        efficiency: Highest efficiency of the gearbox, 0 to 1.
        torque_constant: [N m/A].
        voltage_constant: [V s/rad].
        gear_ratio: Motor turns per output turn.
    """

    resistance: float
    inductance: float
    friction: float
    friction_tolerance: float
    efficiency: float
    torque_constant: float
    voltage_constant: float
    gear_ratio: float


@dataclass(frozen=True, eq=False)
class JawParameters:
    """Geometry of the jaws along -z of link_4 (supplementary and estimated values).

    Attributes:
        collar_base: Distance of the jaw collar's base from the elbow axis [m].
        pivot_height: Pivots above the collar's base [m].
        pivot_offset: Pivots to either side of the wrist axis [m].
        finger_length, finger_width: [m].
        finger_volume, second_finger_volume: Of finger_1 and of finger_2 [m^3].
        finger_density: Estimated [kg/m^3].
        rod_length, rod_diameter: Estimated [m].
        rod_density: Estimated [kg/m^3].
        finger_turn: Turn of each finger per rod travel [rad/m].
        sdk_plane: Plane of the fingers in the SDK's URDF, from x of link_4 [rad]; not used here.
    """

    collar_base: float
    pivot_height: float
    pivot_offset: float
    finger_length: float
    finger_width: float
    finger_volume: float
    second_finger_volume: float
    finger_density: float
    rod_length: float
    rod_diameter: float
    rod_density: float
    finger_turn: float
    sdk_plane: float


@dataclass(frozen=True, eq=False)
class Alpha5Parameters:
    """The arm in SI units, base to tip. Arrays are read-only.

    Attributes:
        dh: The five rows of Table 1.
        theta_c: Elbow angle of Table 1's caption [rad].
        links: ``link_0`` to ``link_4``, Tables 2 and 3.
        joints: ``axis_e, axis_d, axis_c, axis_b`` and the jaw rod ``axis_a``.
        actuators: Actuators 0 to 4 of Table 4; number 4 drives the jaw rod.
        jaws: Geometry of the jaws.
        base_yaw: Rotation about z from link_0 to base_link [rad]: 0, or pi without ``base_frame``.
        corrections: Names of the corrections applied.
    """

    dh: tuple[DHParameters, ...]
    theta_c: float
    links: tuple[LinkParameters, ...]
    joints: tuple[JointParameters, ...]
    actuators: tuple[ActuatorParameters, ...]
    jaws: JawParameters
    base_yaw: float
    corrections: tuple[str, ...]


def parameters(corrections: Iterable[str] = DEFAULT_CORRECTIONS) -> Alpha5Parameters:
    """The arm's parameters in SI units and URDF convention.

    Args:
        corrections: Names of recorded corrections (`alpha5_model.corrections.CORRECTIONS`);
            ``()`` is the document to the letter.

    Returns:
        A frozen record, the same object for the same corrections.

    Raises:
        UnknownNameError: A correction that is not recorded.
    """
    return _converted(check_corrections(corrections))


_converted = cache(lambda corrections: convert(published(), corrections))


def convert(printed: tables.Published, corrections: tuple[str, ...]) -> Alpha5Parameters:
    """Printed tables to SI units and URDF convention, with the named corrections."""
    opposite, adjacent = printed.elbow.opposite, printed.elbow.adjacent
    theta_c = math.atan2(opposite.value, adjacent.value)
    angles = {"theta_c": theta_c, "pi": math.pi, "pi/2": math.pi / 2, "0": 0.0}
    a_1, extra = math.hypot(opposite.si, adjacent.si), printed.supplementary
    dh = tuple(_dh_row(row, angles, a_1) for row in printed.table_1.rows)
    bodies = zip(printed.table_2.rows, printed.table_3.rows, extra.bodies, strict=True)
    return Alpha5Parameters(
        dh=dh,
        theta_c=theta_c,
        links=tuple(_link(rows, dh, corrections) for rows in bodies),
        joints=tuple(_record(JointParameters, row) for row in extra.joints),
        actuators=tuple(_record(ActuatorParameters, row) for row in printed.table_4.rows),
        jaws=JawParameters(**{name: in_si(value) for name, value in extra.jaws.items()}),
        base_yaw=0.0 if "base_frame" in corrections else math.pi,
        corrections=corrections,
    )


def _dh_row(row: tables.DHRow, angles: dict[str, float], a_1: float) -> DHParameters:
    place = f"Table 1, link {row.link}"
    variable, offset = _split_angle(row.theta, angles, place)
    _, alpha = _split_angle(row.alpha, angles, place)
    a = a_1 if isinstance(row.a, str) else row.a.si
    return DHParameters(row.d.si, offset, a, alpha, variable)


def _split_angle(expression: str, angles: dict[str, float], place: str) -> tuple[str | None, float]:
    """Split ``theta_1 + theta_c - pi/2`` into its joint variable and its constant part [rad]."""
    variable, constant = None, 0.0
    for term in expression.replace("-", "+-").replace(" ", "").strip("+").split("+"):
        name, sign = term.removeprefix("-"), -1.0 if term.startswith("-") else 1.0
        if name in angles:
            constant += sign * angles[name]
        elif name.startswith("theta_") and variable is None and sign > 0:
            variable = name
        else:
            problem = f"cannot read {term!r} in {expression!r}; known are {', '.join(angles)}"
            raise PublishedDataError(place, problem)
    return variable, constant


def _link(rows: Any, dh: Sequence[DHParameters], corrections: tuple[str, ...]) -> LinkParameters:
    """From its rows of Tables 2 and 3 and its bounds."""
    inertial, buoyancy, body = rows
    cob = in_si(buoyancy.cob)
    if body.name == "link_3" and "link3_cob" in corrections:
        # Links 1 and 3 carry the same kind of part. In {1} its second axis passes through
        # (a_0, ., d_0); in {3} that axis is z_3, and the first one lies a_2 along x_3.
        x, y, z = cob
        cob = [dh[2].a - x, z - dh[0].d, y]
    com, tensor, bounds = map(in_si, (inertial.com, inertial.inertia_com, body.bounds))
    heavy = inertial.mass.si, frozen(com), frozen(flip_products(tensor))
    return LinkParameters(body.name, *heavy, buoyancy.volume.si, frozen(cob), frozen(bounds))


def _record(kind: type[Any], row: Any) -> Any:
    """A record from the printed row, whose fields have the same names."""
    return kind(**{f.name: in_si(getattr(row, f.name)) for f in fields(kind)})


def in_si(value: Any) -> Any:
    """Numbers in SI units, at any depth; what is no printed number as it is."""
    if isinstance(value, tuple):
        return [in_si(item) for item in value]
    if isinstance(value, tables.SourcedQuantity):
        return value.quantity.si
    return value.si if isinstance(value, Quantity) else value
