"""An arm of your own from a TOML file: the catalogue's arm with other values.

The reader turns keys into records, which check themselves. An error of a record is
given the key of the file that it is about.
"""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from decimal import Context, Decimal
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model._support.toml import toml_tables
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.numbers import arm_schema as schema
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import LENGTHS, warn_of_oddities
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.covariance import Covariance, key_of
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import (
    ActuatorParameters,
    Alpha5Parameters,
    DHParameters,
    JointParameters,
    LinkParameters,
    Measurement,
    parameters,
)
from alpha5_model.numbers.pose import Pose, tool_of
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

#: Of the file: its largest size, its most attached bodies.
MOST_BYTES = 64 * 1024
MOST_ATTACHED = 32
#: Largest magnitude of a written number.
_LARGEST = 1e12
#: Difference of orientations that is rounding.
_SAME_ROTATION = 1e-12
#: Enough digits that a product of decimals is rounded once, to a double.
_EXACT = Context(prec=40)


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
            this kind has. ``place`` is the key.

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
        with plausibility.of_file(path):
            return _Reader(tables).arm()
    except UnknownNameError as error:
        problem = f"expected one of {', '.join(error.choices)}, got {error.name!r}"
        raise FileFormatError(path, problem, error.kind) from None
    except InputError as error:
        raise FileFormatError(path, error.problem, error.name) from None


class _Reader:
    """Reads the tables of a file.

    Attributes:
        given: As `tomllib` returns them, with floats as Decimal.
        base: The catalogue's arm with the corrections of the file.
        keys: Of the values that have been read.
        measurements: Of these values.
    """

    def __init__(self, given: dict[str, Any]) -> None:
        self.given = _table("", given, schema.TOP)
        version = given.get("format")
        if type(version) is not int or version != schema.FORMAT:
            expected = f"format = {schema.FORMAT}, the version of the keys"
            raise InputError("format", _shown(version), expected)
        self.base = parameters(_corrections(given))
        self.keys: set[str] = set()
        self.measurements: list[Measurement] = []

    def arm(self) -> Alpha5Parameters:
        """The record of the arm."""
        with _named({"mount.position": "mount.xyz", "tool.position": "tool.xyz"}):
            own = replace(
                self.base,
                dh=self._dh(),
                links=self._links(),
                joints=self._joints(),
                attached=self._attached(),
                actuators=self._actuators(),
                motors=self._motors(),
                mount=self._mount(),
                name=self.given.get("name", self.base.name),
            )
            own = replace(
                own,
                tool=self._tool(own),
                measurements=tuple(self.measurements),
                covariance=self._covariance(),
            )
        split_link_4(own)  # refuses a link 4 without a possible wrist
        warn_of_oddities(own, self.base, self.keys)
        return own

    # --- parts of the record ----------------------------------------------------------

    def _dh(self) -> tuple[DHParameters, ...]:
        """The rows of Table 1 with own lengths and zeros."""
        rows = list(self.base.dh)
        for name, length in self._part("lengths", schema.LENGTHS).items():
            i, field = LENGTHS[name]
            with _named({field: f"lengths.{name}"}):
                rows[i] = replace(rows[i], **{field: length})
        for name, zero in self._part("zeros", schema.ZEROS).items():
            plausibility.check(f"zeros.{name}", zero, plausibility.ANGLE)
            i = JOINT_NAMES.index(name)
            rows[i] = replace(rows[i], theta_offset=rows[i].theta_offset + zero)
        return tuple(rows)

    def _joints(self) -> tuple[JointParameters, ...]:
        """The joints with own limits and directions."""
        limits = _table("joint_limits", self.given.get("joint_limits", {}), JOINT_NAMES)
        signs = _table("signs", self.given.get("signs", {}), JOINT_NAMES)
        joints = []
        for joint in self.base.joints:
            key = f"joint_limits.{joint.name}"
            keys = schema.JOINT_LIMITS[joint.name]
            found = self._values(key, limits.get(joint.name, {}), keys)
            changes = {schema.LIMIT_FIELDS[name]: x for name, x in found.items()}
            if joint.name in signs:
                changes["sign"] = _shown(signs[joint.name])
            names = {
                f"{joint.name}.{field}": f"{key}.{name}"
                for name, field in schema.LIMIT_FIELDS.items()
            }
            names[f"{joint.name}.range"] = key
            names[f"{joint.name}.sign"] = f"signs.{joint.name}"
            with _named(names):
                joints.append(replace(joint, **changes) if changes else joint)
        return tuple(joints)

    def _links(self) -> tuple[LinkParameters, ...]:
        """The links with own masses and volumes."""
        given = _table("links", self.given.get("links", {}), BODY_NAMES)
        links = []
        for link in self.base.links:
            key = f"links.{link.name}"
            own = self._values(key, given.get(link.name, {}), schema.LINKS[link.name])
            links.append(replace(link, **own) if own else link)
        return tuple(links)

    def _attached(self) -> tuple[AttachedBody, ...]:
        """The bodies that are attached to links."""
        given = self.given.get("attached", [])
        if not isinstance(given, list) or len(given) > MOST_ATTACHED:
            expected = f"at most {MOST_ATTACHED} tables [[attached]]"
            raise InputError("attached", _shown(given), expected)
        bodies = []
        for i, body in enumerate(given):
            _table(f"attached[{i}]", body, ("name", "link", *schema.ATTACHED))
            for key in ("name", "link", "at", "mass"):
                _required(f"attached[{i}]", body, key)
            with _named({"attached.name": f"attached[{i}].name"}):
                bodies.append(self._attached_body(body))
        return tuple(bodies)

    def _attached_body(self, given: dict[str, Any]) -> AttachedBody:
        """One of them."""
        key = f"attached.{given['name']}"
        found = self._values(key, given, schema.ATTACHED, also=("name", "link"))
        with _named({f"{key}.position": f"{key}.at"}):
            return AttachedBody(
                name=given["name"],
                link=given["link"],
                position=found["at"],
                rotation=_rotation(key, found),
                spacer=found.get("spacer", 0.0),
                mass=found["mass"],
                com=found.get("com", np.zeros(3)),
                inertia=found.get("inertia", np.zeros((3, 3))),
                volume=found.get("volume", 0.0),
                cob=found.get("cob", found.get("com", np.zeros(3))),
            )

    def _mount(self) -> Pose | None:
        """Where the arm is mounted; None if the file does not say."""
        if "mount" not in self.given:
            return None
        given = self.given["mount"]
        found = self._values("mount", given, schema.MOUNT, also=("parent",))
        return Pose(
            position=found.get("xyz", np.zeros(3)),
            rotation=_rotation("mount", found),
            parent=given.get("parent", "world"),
        )

    def _tool(self, own: Alpha5Parameters) -> Pose | None:
        """The tool of the arm; None for Table 1's.

        Args:
            own: The arm with all but the tool.
        """
        found = self._part("tool", schema.TOOL)
        printed = tool_of(own)
        position = found.get("xyz", printed.position)
        rotation = _rotation("tool", found) if "rpy" in found else printed.rotation
        if np.abs(rotation - printed.rotation).max() <= _SAME_ROTATION:
            rotation = printed.rotation
            if np.array_equal(position, printed.position):
                return own.tool
        return Pose(position=position, rotation=rotation)

    def _actuators(self) -> tuple[ActuatorParameters, ...]:
        """The rows of Table 4 with own numbers."""
        found = self._of_joints(schema.ACTUATORS)
        actuators = []
        for i, row in enumerate(self.base.actuators):
            own: dict[str, Any] = {name: of[i] for name, of in found.items()}
            own = {name: number for name, number in own.items() if number is not None}
            names = {name: self._key_of_joint(name, i) for name in own}
            with _named(names):
                actuators.append(replace(row, **own) if own else row)
        return tuple(actuators)

    def _motors(self) -> Motors:
        """Supply, drivers and rotors."""
        given = self.given.get("motors", {})
        fields: dict[str, Any] = {}
        if "supply_voltage" in given:
            key = "motors.supply_voltage"
            supply = self._value(key, given["supply_voltage"], schema.SUPPLY_VOLTAGE)
            fields["supply_voltage"] = supply
        if "constants" in given:
            fields["constants"] = given["constants"]
        names = {"supply_voltage": "motors.supply_voltage"}
        for name, by_joint in self._of_joints(schema.DRIVES).items():
            field = schema.DRIVE_FIELDS[name]
            fields[field] = tuple(by_joint)
            for i in range(len(JOINT_NAMES)):
                names[f"{field}[{i}]"] = self._key_of_joint(name, i)
        with _named(names):
            return Motors(**fields)

    def _covariance(self) -> Covariance | None:
        """How well a calibration knows the numbers that were read before."""
        if "covariance" not in self.given:
            return None
        given = _table("covariance", self.given["covariance"], schema.COVARIANCE)
        for key in schema.COVARIANCE:
            _required("covariance", given, key)
        names = given["names"]
        if not isinstance(names, list) or len(names) > len(schema.NUMBERS):
            expected = "a list of names such as links.link_2.com.x"
            raise InputError("covariance.names", _shown(names), expected)
        measured = {one.key for one in self.measurements if one.half_width is not None}
        _known("covariance.names", names, schema.NUMBERS)
        for name in names:
            if key_of(name) not in measured:
                expected = f"a half_width of {key_of(name)} in this file"
                raise InputError("covariance.names", name, expected)

        rows = given["factor"]
        rank = len(rows[0]) if _is_list(rows) and _is_list(rows[0]) else 0
        shape = (len(names), rank)
        return Covariance(
            names=tuple(names),
            deviation=_array("covariance.deviation", given["deviation"], shape[:1]),
            factor=_array("covariance.factor", rows, shape),
        )

    # --- values -----------------------------------------------------------------------

    def _part(self, name: str, keys: Mapping[str, schema.Key]) -> dict[str, Any]:
        """The values of one of the file's tables."""
        return self._values(name, self.given.get(name, {}), keys)

    def _values(
        self,
        table: str,
        given: Any,
        keys: Mapping[str, schema.Key],
        also: tuple[str, ...] = (),
    ) -> dict[str, Any]:
        """The values of a table, in SI units.

        Args:
            table: Its key.
            given: What the file has there.
            keys: The schema of its values; those that are not given are left out.
            also: Keys of other things.
        """
        _table(table, given, (*also, *keys))
        return {
            name: self._value(f"{table}.{name}", given[name], key)
            for name, key in keys.items()
            if name in given
        }

    def _value(self, key: str, given: Any, of: schema.Key) -> Any:
        """A value in SI units; its source and half width are kept.

        Args:
            key: Its key.
            given: A number, a nested list of numbers, or a table with ``value``.
            of: Its schema.
        """
        whole = given if isinstance(given, dict) else {"value": given}
        _table(key, whole, ("value", "unit", "source", "half_width"))
        _required(key, whole, "value")
        written = whole.get("unit", of.unit)
        unit = of.unit_of(written) if isinstance(written, str) else None
        if unit is None:
            expected = f"a unit, one of {', '.join(of.units)}"
            raise InputError(key, _shown(written), expected)
        size = of.units[unit]
        number = _array(key, whole["value"], of.shape, size)

        source = whole.get("source", "")
        half_width = None
        if not isinstance(source, str):
            raise InputError(f"{key}.source", _shown(source), "a text")
        if "half_width" in whole:
            name = f"{key}.half_width"
            half_width = float(_array(name, whole["half_width"], (), size))
            if of.positive and half_width > number:
                expected = "0 to the value, whose unit it has"
                raise InputError(name, _shown(whole["half_width"]), expected)
        if source or half_width is not None:
            self.measurements.append(Measurement(key, source, half_width))
        self.keys.add(key)
        return number if of.shape else float(number)

    def _of_joints(
        self, keys: Mapping[str, schema.Key]
    ) -> dict[str, list[float | None]]:
        """Key of ``[motors]`` -> its value for each joint, None if not given.

        The file gives one value for all joints, which is a value of each, or a table
        by joint.
        """
        known = ("supply_voltage", "constants", *schema.DRIVES, *schema.ACTUATORS)
        tables = _table("motors", self.given.get("motors", {}), known)
        found: dict[str, list[float | None]] = {}
        for name, key in keys.items():
            given = tables.get(name, {})
            if _is_one_value(given):
                one = self._value(f"motors.{name}", given, key)
                found[name] = [one] * len(JOINT_NAMES)
                self._measured_by_joint(f"motors.{name}")
            elif given:
                of_joint = dict.fromkeys(JOINT_NAMES, key)
                values = self._values(f"motors.{name}", given, of_joint)
                found[name] = [values.get(joint) for joint in JOINT_NAMES]
        return found

    def _measured_by_joint(self, key: str) -> None:
        """Turn the last measurement, of a value for all joints, into one of each."""
        if self.measurements and self.measurements[-1].key == key:
            shared = self.measurements.pop()
            self.measurements += [
                replace(shared, key=f"{key}.{joint}") for joint in JOINT_NAMES
            ]

    def _key_of_joint(self, name: str, i: int) -> str:
        """The key of a joint's value in ``[motors]``."""
        one_for_all = _is_one_value(self.given["motors"][name])
        return f"motors.{name}" if one_for_all else f"motors.{name}.{JOINT_NAMES[i]}"


def _is_one_value(given: Any) -> bool:
    """Whether it is a value and not a table by joint."""
    return not isinstance(given, dict) or "value" in given


def _decimal(text: str) -> Decimal:
    """A written float, exact; 0 or infinity if its exponent is beyond all bounds."""
    try:
        return Decimal(text)
    except ArithmeticError:
        return Decimal("0" if "e-" in text.lower() else "inf")


def _corrections(given: dict[str, Any]) -> tuple[str, ...]:
    """The names of the corrections."""
    try:
        return check_corrections(given.get("corrections", DEFAULT_CORRECTIONS))
    except UnknownNameError as error:
        raise UnknownNameError("corrections", error.name, error.choices) from None


@contextmanager
def _named(keys: Mapping[str, str]) -> Iterator[None]:
    """A context in which an error about a field of a record names a key of the file.

    Args:
        keys: Name in errors of the record -> key.
    """
    try:
        yield
    except InputError as error:
        name = keys.get(error.name, error.name)
        raise InputError(name, error.value, error.expected) from None


def _table(key: str, given: Any, names: Iterable[str]) -> dict[str, Any]:
    """A table without unknown keys.

    Args:
        key: Its own key; empty for the file.
        given: What the file has there.
        names: The keys that it may have.
    """
    if not isinstance(given, dict):
        raise InputError(key, _shown(given), "a table")
    _known(key, given, tuple(names))
    return given


def _known(key: str, given: Iterable[Any], names: Collection[str]) -> None:
    """Refuse names that do not exist, with the nearest one that does."""
    for name in given:
        if name not in names:
            near = difflib.get_close_matches(str(name)[:40], names, n=1)
            expected = f"one of {', '.join(names)}"
            if near:
                expected = f"a known key, perhaps {near[0]!r}"
            raise InputError(key, _shown(name), expected)


def _required(table: str, given: dict[str, Any], key: str) -> None:
    if key not in given:
        raise InputError(f"{table}.{key}", None, "a value")


def _array(
    key: str, given: Any, shape: tuple[int, ...], size: Decimal | float = 1.0
) -> FloatArray:
    """Numbers in a nested list of a shape.

    Args:
        key: Their key.
        given: What the file has there.
        shape: Of the result.
        size: Of their unit, in SI units.
    """
    numbers = _numbers(key, given, shape)
    if isinstance(size, Decimal):
        found = [float(_EXACT.multiply(number, size)) for number in numbers]
    else:
        found = [float(number) * size for number in numbers]
    return np.array(found).reshape(shape)


def _numbers(key: str, given: Any, shape: tuple[int, ...]) -> list[Decimal]:
    """The numbers of a nested list of a shape, in one list."""
    if not shape:
        if isinstance(given, bool) or not isinstance(given, int | Decimal):
            raise InputError(key, _shown(given), "a number")
        number = Decimal(given)
        if not number.is_finite() or number.copy_abs() > _LARGEST:
            expected = f"a finite number of at most {_LARGEST:g}"
            raise InputError(key, float(number), expected)
        return [number]
    if not isinstance(given, list) or len(given) != shape[0]:
        what = "numbers" if len(shape) == 1 else f"rows of {shape[1]} numbers"
        raise InputError(key, _shown(given), f"{shape[0]} {what}")
    found = []
    for item in given:
        found += _numbers(key, item, shape[1:])
    return found


def _rotation(table: str, found: Mapping[str, Any]) -> FloatArray:
    """The rotation of ``rpy`` in a table; none if it is not given."""
    rpy = found.get("rpy", np.zeros(3))
    plausibility.check(f"{table}.rpy", np.abs(rpy).max(), plausibility.ANGLE)
    return rotation_from_rpy(rpy)


def _is_list(given: Any) -> bool:
    return isinstance(given, list) and bool(given)


def _shown(given: Any) -> Any:
    """A value of a file for a message: decimals as they are written."""
    if isinstance(given, list):
        return [_shown(item) for item in given]
    if isinstance(given, dict):
        return {key: _shown(item) for key, item in given.items()}
    return float(given) if isinstance(given, Decimal) else given
