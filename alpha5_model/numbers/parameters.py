"""Where a value of an arm of your own comes from, and how exact it is."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cache, cached_property
from os import PathLike
from typing import Any

import numpy as np

from alpha5_model._support.checks import (
    FloatArray,
    array,
    fill,
    frozen,
    instance,
    listed,
    plain_name,
    real,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers import arm_checks, plausibility, tables
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.inertia import flip_products
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.pose import Pose, printed_tool
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.rigid_body import AttachedBody, RigidBody


@dataclass(frozen=True)
class Measurement:
    """Source and half width of one value of an arm file.

    Attributes:
        key: Of the value in the arm file, for example ``links.link_2.mass``. A value
            for all motors has a measurement of each, as ``motors.friction.axis_e``.
        source: Where it comes from; empty if not given.
        half_width: The true value is within this of the given one, in SI units; None
            if not given. For a vector or tensor, it holds for each of its numbers.

    Raises:
        InputError: A half width below 0.
    """

    key: str
    source: str = ""
    half_width: float | None = None

    def __post_init__(self) -> None:
        if self.half_width is not None:
            name = f"{self.key}.half_width"
            width = real(name, self.half_width, minimum=0.0)
            fill(self, half_width=width)


@dataclass(frozen=True, eq=False)
class DHParameters:
    """A row of Table 1.

    ``A = Rz(theta) Tz(d) Tx(a) Rx(alpha)`` with ``theta = q + theta_offset``.

    Attributes:
        d: Offset along the previous z [m].
        theta_offset: Constant part of theta [rad].
        a: Length of the common normal [m].
        alpha: Angle about the common normal [rad].
        variable: Name of the joint variable in the document; None for the fixed last
            row.

    Raises:
        InputError: Not finite numbers.

    Warns:
        ImplausibleWarning: Lengths or angles that seem to be in mm or degrees.
    """

    d: float
    theta_offset: float
    a: float
    alpha: float
    variable: str | None

    def __post_init__(self) -> None:
        for name in ("d", "theta_offset", "a", "alpha"):
            number = real(name, getattr(self, name))
            fill(self, **{name: number})
            limits = plausibility.POSITION if name in ("d", "a") else plausibility.ANGLE
            plausibility.check(name, number, limits)


@dataclass(frozen=True, eq=False)
class LinkParameters(RigidBody):
    """One link, ``link_0`` to ``link_4``, in its inertial frame.

    Attributes:
        bounds: Outer bounds of the body, (3, 2) [m].

    Raises:
        InputError: Also bounds whose ends are in the wrong order, or a COM far
            outside of them.
    """

    bounds: FloatArray

    @property
    def _place(self) -> str:
        """Its key in an arm file, ``links.link_2``; errors name it."""
        return f"links.{self.name}"

    def __post_init__(self) -> None:
        bounds = frozen(array(f"{self._place}.bounds", self.bounds, 3, 2))
        if (bounds[:, 0] > bounds[:, 1]).any():
            expected = "the lower end of each axis before the upper one"
            raise InputError(f"{self._place}.bounds", bounds.tolist(), expected)
        com = array(f"{self._place}.com", self.com, 3)
        arm_checks.check_inside(f"{self._place}.com", com, bounds)
        super().__post_init__()
        farthest = bounds.ravel()[np.abs(bounds).argmax()]
        plausibility.check(f"{self._place}.bounds", farthest, plausibility.POSITION)
        fill(self, bounds=bounds)


#: Largest acceleration of a joint for which nobody names one [rad/s^2], of the jaw rod
#: [m/s^2]. It is a choice; none is published.
DEFAULT_ACCELERATION = 1.0


@dataclass(frozen=True, eq=False)
class JointRange:
    """Limits of a joint [rad, rad/s, N m], of the jaw rod [m, m/s, N].

    Attributes:
        name: ``axis_e`` (base) to ``axis_b`` (wrist), ``axis_a`` (jaw rod),
            ``finger_1_joint``, ``finger_2_joint``.
        lower, upper: Ends of the range.
        velocity: Largest speed; 0 for a joint that does not move.
        effort: A placeholder that every public model copies; no rating is published.
        acceleration, jerk: Largest ones [rad/s^2, rad/s^3], of the jaw rod [m/s^2,
            m/s^3]; None if they are not known. None is published.

    Raises:
        InputError: A range that ends before it starts, a range of a full turn, in which
            a pose would have two joint positions, a negative speed, or another limit
            not above 0.

    Warns:
        ImplausibleWarning: A limit that seems to be in degrees or mm.
    """

    name: str
    lower: float
    upper: float
    velocity: float
    effort: float
    acceleration: float | None = field(default=None, kw_only=True)
    jerk: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        lower = real(f"{self.name}.lower", self.lower)
        upper = real(f"{self.name}.upper", self.upper)
        fill(self, lower=lower, upper=upper)
        velocity = real(f"{self.name}.velocity", self.velocity, minimum=0.0)
        effort = real(f"{self.name}.effort", self.effort, minimum=0.0, strict=True)
        fill(self, velocity=velocity, effort=effort)
        for name in ("acceleration", "jerk"):
            given = getattr(self, name)
            if given is not None:
                number = real(f"{self.name}.{name}", given, minimum=0.0, strict=True)
                fill(self, **{name: number})

        largest = plausibility.JOINT if self.kind == "revolute" else plausibility.ROD
        for name, limits in largest.items():
            given = getattr(self, name)
            if given is not None:
                plausibility.check(f"{self.name}.{name}", given, limits)
        if not lower < upper:
            expected = "an upper end above the lower one"
            raise InputError(f"{self.name}.range", (lower, upper), expected)
        if self.kind == "revolute" and upper - lower >= math.tau:
            expected = "less than a full turn, 2 pi"
            raise InputError(f"{self.name}.range", (lower, upper), expected)

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
        sign: 1, or -1 if the driver counts in the other direction than this model.
            Limits, zeros and joint positions are the model's. The sign is used where
            the driver's numbers come in or go out: recordings, `devices_from_q` and
            `q_from_devices`, files of motions and of calibrations.

    Raises:
        InputError: Also a sign that is neither 1 nor -1.
    """

    dh_variable: str
    device_id: int
    sign: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.sign, bool) or self.sign not in (1, -1):
            raise InputError(f"{self.name}.sign", self.sign, "1 or -1")
        fill(self, sign=int(self.sign))


@dataclass(frozen=True, eq=False)
class ActuatorParameters:
    """A row of Table 4.

    Attributes:
        resistance: [Ohm].
        inductance: [H].
        friction: At the motor shaft [N m].
        friction_tolerance: Printed relative tolerance of the friction, 0.1 for 10 %.
        efficiency: eta_max, of the gearbox or of the motor: Table 4 does not say; 0
            to 1.
        torque_constant: [N m/A].
        voltage_constant: [V s/rad].
        gear_ratio: Motor turns per output turn.

    Raises:
        InputError: A negative number, a resistance, constant or ratio of zero, or an
            efficiency that is not above 0 and at most 1.

    Warns:
        ImplausibleWarning: Numbers that seem to be in another unit.
    """

    resistance: float
    inductance: float
    friction: float
    friction_tolerance: float
    efficiency: float
    torque_constant: float
    voltage_constant: float
    gear_ratio: float

    def __post_init__(self) -> None:
        for name in (f.name for f in fields(self)):
            may_vanish = name in ("inductance", "friction", "friction_tolerance")
            number = real(name, getattr(self, name), minimum=0.0, strict=not may_vanish)
            fill(self, **{name: number})
        for name in ("friction_tolerance", "efficiency"):
            if getattr(self, name) > 1:
                raise InputError(name, getattr(self, name), "at most 1 (86 % is 0.86)")
        plausibility.check("resistance", self.resistance, plausibility.RESISTANCE)
        plausibility.check("inductance", self.inductance, plausibility.INDUCTANCE)
        plausibility.check("friction", self.friction, plausibility.MOTOR_FRICTION)
        for name in ("torque_constant", "voltage_constant"):
            plausibility.check(name, getattr(self, name), plausibility.MOTOR_CONSTANT)


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
        sdk_plane: Plane of the fingers in the SDK's URDF, from x of link_4 [rad]; not
            used here.

    Raises:
        InputError: A length, volume, density or turn that is not above 0.

    Warns:
        ImplausibleWarning: Numbers that seem to be in another unit.
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

    def __post_init__(self) -> None:
        for name in (f.name for f in fields(self)):
            least = None if name == "sdk_plane" else 0.0
            number = real(name, getattr(self, name), minimum=least, strict=True)
            fill(self, **{name: number})
            if name.endswith("volume"):
                plausibility.check(name, number, plausibility.VOLUME)
            elif name.endswith("density"):
                plausibility.check(name, number, plausibility.SOLID_DENSITY)
            elif name not in ("finger_turn", "sdk_plane"):
                plausibility.check(name, number, plausibility.JAW_LENGTH)


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
        base_yaw: Rotation about z from link_0 to base_link [rad]: 0, or pi without
            ``base_frame``.
        corrections: Names of the corrections applied.
        tool: Pose of the tcp in link_4; None for Table 1's, DH frame {5}. With a
            spacer, None becomes Table 1's tool, moved by it. To take the spacer away
            with `dataclasses.replace`, set ``tool=None`` too.
        mount: Where base_link is fixed; None if nothing is known of it.
        attached: Bodies that are fixed to links.
        motors: What Table 4 does not print of the motors.
        name: Of the arm, for example in its URDF.
        measurements: Sources and half widths of the values of an arm file.
        covariance: How well a calibration knows the numbers together; None without.

    Raises:
        InputError: Not the records of this arm: five rows, links, joints and
            actuators. Also a length whose sign differs from Table 1's, twisted axes, a
            tool point more than 0.3 m from Table 1's or one that a spacer should have
            moved, and names of attached bodies that are taken.
    """

    dh: tuple[DHParameters, ...]
    theta_c: float
    links: tuple[LinkParameters, ...]
    joints: tuple[JointParameters, ...]
    actuators: tuple[ActuatorParameters, ...]
    jaws: JawParameters
    base_yaw: float
    corrections: tuple[str, ...]
    tool: Pose | None = None
    mount: Pose | None = None
    attached: tuple[AttachedBody, ...] = ()
    motors: Motors = field(default_factory=Motors)
    name: str = "alpha5"
    measurements: tuple[Measurement, ...] = ()
    covariance: Covariance | None = None

    def __post_init__(self) -> None:
        self._check_parts()
        table_1 = _table_1()
        arm_checks.check_dh(self.dh, table_1)
        arm_checks.check_attached(self.attached)
        self._check_tool()

    @property
    def signs(self) -> FloatArray:
        """Of the joints, (5,): see `JointParameters.sign`."""
        return np.array([float(joint.sign) for joint in self.joints])

    @property
    def spacer(self) -> float:
        """How far spacers move jaws and tool along -z of link_4 [m]."""
        return sum((body.spacer for body in self.attached), 0.0)

    @cached_property
    def _values(self) -> tuple[Any, ...]:
        """All numbers and texts of the record in nested tuples, for comparisons."""
        return tuple(_values_of(getattr(self, f.name)) for f in fields(self))

    def __getstate__(self) -> dict[str, Any]:
        # Equal records have equal pickles, whether they were compared before or not.
        return {f.name: getattr(self, f.name) for f in fields(self)}

    def _check_parts(self) -> None:
        """Check the type of each field."""
        parts = {
            "dh": DHParameters,
            "links": LinkParameters,
            "joints": JointParameters,
            "actuators": ActuatorParameters,
        }
        for name, kind in parts.items():
            records = tuple(listed(name, getattr(self, name), f"5 {kind.__name__}"))
            if len(records) != 5:
                raise InputError(name, len(records), f"5 {kind.__name__}")
            for record in records:
                instance(name, record, kind)
            fill(self, **{name: records})

        lists = {"attached": AttachedBody, "measurements": Measurement}
        for name, kind in lists.items():
            expected = f"a tuple of {kind.__name__}"
            records = tuple(listed(name, getattr(self, name), expected))
            for record in records:
                instance(name, record, kind)
            fill(self, **{name: records})

        instance("jaws", self.jaws, JawParameters)
        instance("motors", self.motors, Motors)
        if self.tool is not None:
            instance("tool", self.tool, Pose)
            _check_near("tool", self.tool, plausibility.POSITION)
        if self.mount is not None:
            instance("mount", self.mount, Pose)
            plain_name("mount.parent", self.mount.parent)
            arm_checks.check_parent(self.mount.parent)
            _check_near("mount", self.mount, plausibility.VEHICLE_POSITION)
        if self.covariance is not None:
            instance("covariance", self.covariance, Covariance)
        plain_name("name", self.name)
        fill(self, corrections=check_corrections(self.corrections))
        for name in ("theta_c", "base_yaw"):
            fill(self, **{name: real(name, getattr(self, name))})
            plausibility.check(name, getattr(self, name), plausibility.ANGLE)

    def _check_tool(self) -> None:
        """Check the tool; move Table 1's if there is a spacer."""
        if self.tool is None and not self.spacer:
            return
        printed = printed_tool(self.dh[3], self.dh[4])
        if self.tool is None:
            position = printed.position - [0.0, 0.0, self.spacer]
            tool = Pose(position=position, rotation=printed.rotation)
            fill(self, tool=tool)
        assert self.tool is not None
        arm_checks.check_tool(self.tool, printed, self.spacer)


def _check_near(name: str, pose: Pose, limits: plausibility.Plausible) -> None:
    """Warn of a pose that seems to be in mm."""
    farthest = pose.position[np.abs(pose.position).argmax()]
    plausibility.check(f"{name}.position", farthest, limits)


def parameters(corrections: Iterable[str] = DEFAULT_CORRECTIONS) -> Alpha5Parameters:
    """The arm's parameters in SI units and URDF convention.

    Args:
        corrections: Names of recorded corrections
            (`alpha5_model.numbers.corrections.CORRECTIONS`); ``()`` is the document to
            the letter.

    Returns:
        A frozen record, the same object for the same corrections.

    Raises:
        UnknownNameError: A correction that is not recorded.
    """
    return _converted(check_corrections(corrections))


_converted = cache(lambda corrections: parameters_from_tables(published(), corrections))


def parameters_from_tables(
    printed: tables.Published, corrections: tuple[str, ...]
) -> Alpha5Parameters:
    """The arm's parameters from printed tables.

    Printed units become SI units, and the document's sign of products of inertia
    becomes URDF's.

    Args:
        printed: The tables.
        corrections: Checked names of the corrections to apply.
    """
    extra = printed.supplementary
    links = link_numbers(printed, corrections)
    actuators = printed.table_4.rows
    jaws = {name: in_si(value) for name, value in extra.jaws.items()}
    return Alpha5Parameters(
        dh=_dh(printed),
        theta_c=_theta_c(printed),
        links=tuple(LinkParameters(**numbers) for numbers in links),
        joints=tuple(_record(JointParameters, row) for row in extra.joints),
        actuators=tuple(_record(ActuatorParameters, row) for row in actuators),
        jaws=JawParameters(**jaws),
        base_yaw=0.0 if "base_frame" in corrections else math.pi,
        corrections=corrections,
    )


def link_numbers(
    printed: tables.Published, corrections: tuple[str, ...]
) -> list[dict[str, Any]]:
    """Fields of `LinkParameters` of each link, not checked.

    So they may be numbers that no body can have.
    """
    bodies = printed.table_2.rows, printed.table_3.rows, printed.supplementary.bodies
    dh = _dh(printed)
    return [_link(rows, dh, corrections) for rows in zip(*bodies, strict=True)]


def _theta_c(printed: tables.Published) -> float:
    return math.atan2(printed.elbow.opposite.value, printed.elbow.adjacent.value)


@cache
def _table_1() -> tuple[DHParameters, ...]:
    """Table 1 as printed, which every arm is compared with."""
    return _dh(published())


def _dh(printed: tables.Published) -> tuple[DHParameters, ...]:
    angles = {
        "theta_c": _theta_c(printed),
        "pi": math.pi,
        "pi/2": math.pi / 2,
        "0": 0.0,
    }
    a_1 = math.hypot(printed.elbow.opposite.si, printed.elbow.adjacent.si)
    return tuple(_dh_row(row, angles, a_1) for row in printed.table_1.rows)


def _dh_row(row: tables.DHRow, angles: dict[str, float], a_1: float) -> DHParameters:
    place = f"Table 1, link {row.link}"
    variable, offset = _split_angle(row.theta, angles, place)
    _, alpha = _split_angle(row.alpha, angles, place)
    return DHParameters(
        d=row.d.si,
        theta_offset=offset,
        a=a_1 if isinstance(row.a, str) else row.a.si,
        alpha=alpha,
        variable=variable,
    )


def _split_angle(
    expression: str, angles: dict[str, float], place: str
) -> tuple[str | None, float]:
    """Split ``theta_1 + theta_c - pi/2`` into joint variable and constant [rad]."""
    variable = None
    constant = 0.0
    # Each term with its sign, separated by "+".
    terms = expression.replace("-", "+-").replace(" ", "").strip("+")
    for term in terms.split("+"):
        name = term.removeprefix("-")
        sign = -1.0 if term.startswith("-") else 1.0
        if name in angles:
            constant += sign * angles[name]
        elif name.startswith("theta_") and variable is None and sign > 0:
            variable = name
        else:
            known = ", ".join(angles)
            problem = f"cannot read {term!r} in {expression!r}; known are {known}"
            raise ValueError(f"{place}: {problem}")
    return variable, constant


def _link(
    rows: Any, dh: Sequence[DHParameters], corrections: tuple[str, ...]
) -> dict[str, Any]:
    """Fields of a link from its rows of Tables 2 and 3 and its bounds."""
    inertial, buoyancy, body = rows
    cob = in_si(buoyancy.cob)
    if body.name == "link_3" and "link3_cob" in corrections:
        # Links 1 and 3 carry the same kind of part. In {1} its second axis passes
        # through (a_0, ., d_0); in {3} that axis is z_3, and the first one lies a_2
        # along x_3.
        x, y, z = cob
        cob = [dh[2].a - x, z - dh[0].d, y]
    return {
        "name": body.name,
        "mass": inertial.mass.si,
        "com": np.array(in_si(inertial.com)),
        "inertia": flip_products(in_si(inertial.inertia_com)),
        "volume": buoyancy.volume.si,
        "cob": np.array(cob),
        "bounds": np.array(in_si(body.bounds)),
    }


def _record(kind: type[Any], row: Any) -> Any:
    """A record in SI units from a printed row with fields of the same names."""
    names = (f.name for f in fields(kind) if hasattr(row, f.name))
    return kind(**{name: in_si(getattr(row, name)) for name in names})


def in_si(value: Any) -> Any:
    """Printed numbers in SI units, in tuples of any depth; other values unchanged."""
    if isinstance(value, tuple):
        return [in_si(item) for item in value]
    if isinstance(value, tables.SourcedQuantity):
        return value.quantity.si
    return value.si if isinstance(value, Quantity) else value


def chosen_arm(
    arm: Alpha5Parameters | None, corrections: Iterable[str] = DEFAULT_CORRECTIONS
) -> Alpha5Parameters:
    """The record of an arm, which already has its corrections.

    Args:
        arm: A record; None for the catalogue's with these corrections.
        corrections: With a record, the default ones, which then mean nothing, or the
            record's own.

    Raises:
        InputError: Not a record, or a record together with other corrections.
        UnknownNameError: A correction that is not recorded.
    """
    chosen = DEFAULT_CORRECTIONS
    if corrections is not DEFAULT_CORRECTIONS:
        chosen = check_corrections(corrections)
    if arm is None:
        return _of_catalogue(chosen)
    if isinstance(arm, str | PathLike):
        expected = "an Alpha5Parameters, as alpha5_model.arm_file(FILE) returns"
        raise InputError("arm", arm, expected)
    record = instance("arm", arm, Alpha5Parameters)
    if chosen not in (DEFAULT_CORRECTIONS, record.corrections):
        own = ", ".join(record.corrections) or "none"
        expected = f"no corrections beside an arm, which has its own ({own})"
        raise InputError("corrections", chosen, expected)
    return record


#: `parameters` without its checks, which take longer than an inverse kinematics.
_of_catalogue = cache(parameters)


def is_catalogue(arm: Alpha5Parameters) -> bool:
    """Whether a record is the catalogue's, with any corrections.

    A copy is, too, and the arm of a file that changes nothing.
    """
    catalogue = _of_catalogue(arm.corrections)
    return arm is catalogue or arm._values == catalogue._values


def _values_of(value: Any) -> Any:
    """The numbers and texts of a record in tuples, which can be compared."""
    if is_dataclass(value):
        return tuple(_values_of(getattr(value, f.name)) for f in fields(value))
    if isinstance(value, tuple):
        return tuple(map(_values_of, value))
    return tuple(value.ravel().tolist()) if isinstance(value, np.ndarray) else value
