"""An arm of your own from a TOML file: the catalogue's arm with other values."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, plain_name
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import FARTHEST_TOOL, LENGTHS, check_inside
from alpha5_model.numbers.arm_oddities import warn_of_oddities
from alpha5_model.numbers.arm_values import (
    ArmFileError,
    Value,
    one_of,
    shown,
    table,
    value,
    values,
)
from alpha5_model.numbers.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.covariance_table import read_covariance
from alpha5_model.numbers.inertia import inconsistencies
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.motors import CONSTANTS, Motors
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    LinkParameters,
    parameters,
)
from alpha5_model.numbers.pose import Pose, printed_tool, tool_of
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

#: Of the file: its largest size, its most attached bodies.
MOST_BYTES = 64 * 1024
MOST_ATTACHED = 32
#: Difference of orientations that is rounding.
_SAME_ROTATION = 1e-12


def arm_file(path: PathLike) -> Alpha5Parameters:
    """The arm that a TOML file describes.

    What the file leaves out is as printed. A number is in SI units, or a table with
    ``value``, ``unit``, ``source`` and ``half_width``, which has the value's unit. The
    guide "Your own arm" names all keys.

    Args:
        path: Of the file.

    Returns:
        The same kind of record as `alpha5_model.parameters`.

    Raises:
        MissingFileError: No such file.
        FileFormatError: Not TOML, an unknown key or unit, or a value that no arm of
            this kind has. The message names file, key and value.

    Warns:
        ImplausibleWarning: Values that are possible, but odd.
    """
    content = read_named(path, "an arm file (TOML)", MOST_BYTES)
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FileFormatError(path, "expected TOML, which is UTF-8 text") from None
    tables = toml_tables(text, str(path), _decimal)
    try:
        with plausibility.prefixed(f"{path}: "):
            return arm_of_tables(tables)
    except ArmFileError as error:
        raise FileFormatError(path, error.problem, error.key) from None
    except InputError as error:  # of a record that no table above has refused
        raise FileFormatError(path, str(error)) from None


def arm_of_tables(given: dict[str, Any]) -> Alpha5Parameters:
    """The arm that the tables of a file describe.

    Args:
        given: As `tomllib` returns them, with floats as Decimal.

    Raises:
        ArmFileError: What `arm_file` refuses.
    """
    table("", given, schema.TOP)
    _check_format(given)
    base = parameters(_corrections(given))
    reader = _Reader(given, base)
    own = replace(
        base,
        dh=reader.dh(),
        links=reader.links(),
        joints=reader.joints(),
        attached=reader.attached(),
        **reader.motors(),
        mount=reader.mount(),
        name=_checked("name", given.get("name", base.name)),
    )
    own = replace(
        own,
        tool=reader.tool(own),
        measurements=tuple(reader.measurements),
        covariance=reader.covariance(),
    )
    _check_wrist(own)
    warn_of_oddities(own, base, set(reader.keys))
    return own


def _check_wrist(arm: Alpha5Parameters) -> None:
    """Refuse a link 4 that is no possible body without the jaws."""
    try:
        split_link_4(arm)
    except InputError as error:
        problem = f"{error.value}; expected {error.expected}"
        raise ArmFileError("links.link_4", problem) from None


class _Reader:
    """Reads the tables of a file and remembers the keys that it has read."""

    def __init__(self, given: dict[str, Any], base: Alpha5Parameters) -> None:
        self.given = given
        self.base = base
        self.keys: list[str] = []
        self.measurements: list[Any] = []

    def dh(self) -> tuple[Any, ...]:
        """The rows of Table 1 with own lengths and zeros."""
        rows = list(self.base.dh)
        for name, length in self._values("lengths", schema.LENGTHS).items():
            i, field = LENGTHS[name]
            printed = getattr(rows[i], field)
            own = float(length.number)
            if own * printed <= 0:
                side = "above 0" if printed > 0 else "below 0"
                problem = f"{length.written}; expected a length {side}, as Table 1's"
                raise ArmFileError(f"lengths.{name}", f"{problem} {printed:g} m")
            change: dict[str, Any] = {field: own}
            rows[i] = replace(rows[i], **change)

        for name, zero in self._values("zeros", schema.ZEROS).items():
            i = JOINT_NAMES.index(name)
            offset = rows[i].theta_offset + float(zero.number)
            rows[i] = replace(rows[i], theta_offset=offset)
        return tuple(rows)

    def joints(self) -> tuple[JointParameters, ...]:
        """The joints with own limits."""
        tables = table("joint_limits", self._part("joint_limits"), JOINT_NAMES)
        joints = []
        for joint in self.base.joints:
            keys = schema.JOINT_LIMITS[joint.name]
            key = f"joint_limits.{joint.name}"
            given = table(key, tables.get(joint.name, {}), keys)
            found = self._kept(values(key, given, keys))
            joints.append(_limited(key, joint, found))
        return tuple(joints)

    def links(self) -> tuple[LinkParameters, ...]:
        """The links with own masses and volumes."""
        tables = table("links", self._part("links"), BODY_NAMES)
        links = []
        for link in self.base.links:
            key = f"links.{link.name}"
            keys = schema.LINKS[link.name]
            given = table(key, tables.get(link.name, {}), keys)
            own = _numbers(self._kept(values(key, given, keys)))
            if own:
                _check_body(key, {**vars(link), **own}, link.bounds)
            links.append(replace(link, **own) if own else link)
        return tuple(links)

    def attached(self) -> tuple[AttachedBody, ...]:
        """The bodies that are attached to links."""
        given = self.given.get("attached", [])
        if not isinstance(given, list) or len(given) > MOST_ATTACHED:
            expected = f"at most {MOST_ATTACHED} tables [[attached]]"
            raise ArmFileError("attached", f"{shown(given)}; expected {expected}")
        bodies: list[AttachedBody] = []
        for i, body in enumerate(given):
            place = f"attached[{i}]"
            table(place, body, ("name", "link", *schema.ATTACHED))
            for key in ("name", "link", "at", "mass"):
                if key not in body:
                    raise ArmFileError(f"{place}.{key}", "missing")
            name = _checked(f"{place}.name", body["name"])
            if name in (*BODY_NAMES, *(other.name for other in bodies)):
                problem = f"{name!r}; expected a name that no other body has"
                raise ArmFileError(f"{place}.name", problem)
            found = self._kept(values(f"attached.{name}", body, schema.ATTACHED))
            bodies.append(_attached(f"attached.{name}", name, body["link"], found))
        return tuple(bodies)

    def mount(self) -> Pose | None:
        """Where the arm is mounted; None if the file does not say."""
        if "mount" not in self.given:
            return None
        given = table("mount", self.given["mount"], ("parent", *schema.MOUNT))
        found = self._kept(values("mount", given, schema.MOUNT))
        return Pose(
            parent=_checked("mount.parent", given.get("parent", "world")),
            position=_array(found, "xyz"),
            rotation=_rotation(found),
        )

    def tool(self, own: Alpha5Parameters) -> Pose | None:
        """The tool of the arm; None for Table 1's.

        Args:
            own: The arm with all but the tool.
        """
        found = self._values("tool", schema.TOOL)
        printed = tool_of(own)
        position = printed.position
        rotation = printed.rotation
        if "xyz" in found:
            _check_tool_point(found["xyz"], own)
            position = found["xyz"].number
        if "rpy" in found:
            given = _rotation(found)
            if np.abs(given - rotation).max() > _SAME_ROTATION:
                rotation = given

        as_before = np.array_equal(position, printed.position)
        if as_before and rotation is printed.rotation:
            return own.tool
        return Pose(position=position, rotation=rotation)

    def motors(self) -> dict[str, Any]:
        """The fields ``motors`` and ``actuators``."""
        per_joint = {**schema.DRIVES, **schema.ACTUATORS}
        names = ("supply_voltage", "constants", *per_joint)
        given = table("motors", self._part("motors"), names)
        supply = self._kept(
            values("motors", given, {"supply_voltage": schema.SUPPLY_VOLTAGE})
        )
        found = {
            name: self._of_joints(f"motors.{name}", given[name], key)
            for name, key in per_joint.items()
            if name in given
        }
        actuators = []
        for i, row in enumerate(self.base.actuators):
            own = {n: found[n][i] for n in schema.ACTUATORS if i in found.get(n, {})}
            actuators.append(replace(row, **own) if own else row)
        return {
            "motors": _motors(given, supply, found),
            "actuators": tuple(actuators),
        }

    def covariance(self) -> Covariance | None:
        """How well a calibration knows the numbers that were read before."""
        if "covariance" not in self.given:
            return None
        measured = {one.key for one in self.measurements if one.half_width is not None}
        return read_covariance(self.given["covariance"], measured)

    def _of_joints(self, key: str, given: Any, of_one: schema.Key) -> dict[int, float]:
        """Index of a joint -> its value: one for all, or a table by joint."""
        is_one = not isinstance(given, dict) or "value" in given
        if is_one:
            whole = self._kept({"": value(key, given, of_one)})[""]
            return dict.fromkeys(range(len(JOINT_NAMES)), float(whole.number))
        table(key, given, JOINT_NAMES)
        found = self._kept(values(key, given, dict.fromkeys(JOINT_NAMES, of_one)))
        return {JOINT_NAMES.index(n): float(v.number) for n, v in found.items()}

    def _part(self, name: str) -> Any:
        return self.given.get(name, {})

    def _values(self, name: str, keys: Any) -> dict[str, Value]:
        """The values of one of the file's tables."""
        given = table(name, self._part(name), keys)
        return self._kept(values(name, given, keys))

    def _kept(self, found: dict[str, Value]) -> dict[str, Value]:
        """The same values, their keys and measurements remembered."""
        for each in found.values():
            self.keys.append(each.key)
            if each.measurement:
                self.measurements.append(each.measurement)
        return found


def _decimal(text: str) -> Decimal:
    """A written float, exact; 0 or infinity if its exponent is beyond all bounds."""
    try:
        return Decimal(text)
    except ArithmeticError:
        return Decimal("0" if "e-" in text.lower() else "inf")


def _check_format(given: dict[str, Any]) -> None:
    """Refuse a file of another format."""
    if "format" not in given:
        raise ArmFileError("format", f"missing; write format = {schema.FORMAT}")
    if type(given["format"]) is not int or given["format"] != schema.FORMAT:
        problem = (
            f"{shown(given['format'])}; this version reads format = {schema.FORMAT}"
        )
        raise ArmFileError("format", problem)


def _corrections(given: dict[str, Any]) -> tuple[str, ...]:
    """The names of the corrections."""
    names = given.get("corrections", list(DEFAULT_CORRECTIONS))
    if not isinstance(names, list):
        expected = f"a list of names, such as {list(DEFAULT_CORRECTIONS)}"
        raise ArmFileError("corrections", f"{shown(names)}; expected {expected}")
    return tuple(one_of("corrections", name, CORRECTIONS) for name in names)


def _checked(key: str, given: Any) -> str:
    """A plain name."""
    try:
        return plain_name(key, given)
    except InputError as error:
        problem = f"{shown(given)}; expected {error.expected}"
        raise ArmFileError(key, problem) from None


def _limited(key: str, joint: JointParameters, found: dict[str, Value]) -> Any:
    """A joint with its own limits."""
    own: dict[str, Any] = {
        schema.LIMIT_FIELDS[name]: float(limit.number) for name, limit in found.items()
    }
    lower = own.get("lower", joint.lower)
    upper = own.get("upper", joint.upper)
    unit = "rad" if joint.kind == "revolute" else "m"
    if not lower < upper:
        problem = f"min_position {lower:.4g} is not below max_position {upper:.4g}"
        raise ArmFileError(key, f"{problem} {unit}")
    if joint.kind == "revolute" and upper - lower >= 2 * np.pi:
        problem = f"min_position {lower:.4g} to max_position {upper:.4g} rad"
        raise ArmFileError(key, f"{problem}; expected less than a full turn")
    return replace(joint, **own) if own else joint


def _numbers(found: dict[str, Value]) -> dict[str, Any]:
    """Name -> number or array."""
    return {
        name: each.number if each.number.ndim else float(each.number)
        for name, each in found.items()
    }


def _array(found: dict[str, Value], name: str) -> FloatArray:
    """Three numbers, zeros if they are not given."""
    return found[name].number if name in found else np.zeros(3)


def _rotation(found: dict[str, Value]) -> FloatArray:
    """The rotation of ``rpy``."""
    return rotation_from_rpy(_array(found, "rpy"))


def _check_body(key: str, body: dict[str, Any], bounds: FloatArray | None) -> None:
    """Refuse a body that cannot exist."""
    if bounds is not None:
        try:
            check_inside("com", body["com"], bounds)
        except InputError as error:
            problem = f"{np.round(body['com'], 6).tolist()} m; expected"
            raise ArmFileError(f"{key}.com", f"{problem} {error.expected}") from None
    wrong = inconsistencies(body["mass"], body["com"], body["inertia"])
    if wrong and np.any(body["inertia"]):
        expected = "at the COM, products as in URDF, in kg m^2"
        problem = f"no body has it: {wrong[0]}; expected it {expected}"
        raise ArmFileError(f"{key}.inertia", problem)


def _attached(key: str, name: str, link: Any, found: dict[str, Value]) -> AttachedBody:
    """A body that is attached to a link."""
    numbers = _numbers(found)
    body: dict[str, Any] = {
        "mass": numbers["mass"],
        "com": numbers.get("com", np.zeros(3)),
        "inertia": numbers.get("inertia", np.zeros((3, 3))),
        "volume": numbers.get("volume", 0.0),
    }
    _check_body(key, body, None)
    carrier = one_of(f"{key}.link", link, BODY_NAMES)
    spacer = numbers.get("spacer", 0.0)
    if spacer and carrier != "link_4":
        problem = f"{found['spacer'].written} on {carrier}; only link_4 has jaws"
        raise ArmFileError(f"{key}.spacer", problem)
    return AttachedBody(
        name=name,
        **body,
        cob=numbers.get("cob", body["com"]),
        link=carrier,
        position=numbers["at"],
        rotation=_rotation(found),
        spacer=spacer,
    )


def _check_tool_point(point: Value, own: Alpha5Parameters) -> None:
    """Refuse a tool point beside a spacer, or far from Table 1's."""
    if own.spacer:
        problem = (
            f"{point.written} together with a spacer, which moves the tool: give one"
        )
        raise ArmFileError("tool.xyz", problem)
    printed = printed_tool(own.dh[3], own.dh[4]).position
    if np.linalg.norm(point.number - printed) > FARTHEST_TOOL:
        problem = (
            f"{point.written}; expected a point within {FARTHEST_TOOL:g} m of the "
            f"published one, {printed.tolist()} m: is the unit right?"
        )
        raise ArmFileError("tool.xyz", problem)


def _motors(
    given: dict[str, Any],
    supply: dict[str, Value],
    found: dict[str, dict[int, float]],
) -> Motors:
    """Supply, drivers and rotors."""

    def of_joints(name: str) -> tuple[float | None, ...]:
        get: Callable[[int], float | None] = found.get(name, {}).get
        return tuple(get(i) for i in range(len(JOINT_NAMES)))

    voltage = supply.get("supply_voltage")
    constants = given.get("constants", "printed")
    return Motors(
        supply_voltage=None if voltage is None else float(voltage.number),
        current_limits=of_joints("current_limit"),
        rotor_inertias=of_joints("rotor_inertia"),
        backward_frictions=of_joints("friction_backward"),
        viscous_frictions=of_joints("viscous_friction"),
        constants=one_of("motors.constants", constants, CONSTANTS),
    )
