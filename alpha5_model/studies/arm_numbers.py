"""The uncertain numbers of an arm, and how its loads change with them.

Every arm has the same numbers, the catalogue's too. They have the names of an arm file.
A value with a half width in the arm file lies within it. Any other keeps the half width
of the printed digits, about the arm's own value. A calibrated arm has a covariance: the
numbers that it names lie in an ellipsoid whose half widths are those of the arm file.

Loads are linear in the base parameters, and these and the dimensions of the arm are
functions of the numbers. `base_slopes` has their derivatives, `load_slopes` those of
the loads. They serve bounds, sensitivities and fits.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model._support.spatial import rotation_from_rpy, rpy_from_rotation
from alpha5_model.codegen.regrouping import moments, regrouped
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.kernels import choice as kernels
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import DRIVE_FIELDS, LIMIT_FIELDS, NUMBERS
from alpha5_model.numbers.covariance import WIDTH
from alpha5_model.numbers.jaws import loaded_links
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters
from alpha5_model.numbers.pose import has_own_tool_point, tool_of
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES
from alpha5_model.studies.printed_digits import SYMMETRIC, UPPER, printed_numbers

#: Numbers of a body in the order of `NUMBERS`: mass, com, inertia, volume, cob.
PER_BODY = 14
#: The first numbers are those of the five links.
OF_BODIES = PER_BODY * len(BODY_NAMES)
#: Numbers of base parameters.
_BASE = 38
#: Dimensions that loads depend on, the first ones of `Geometry.dimensions`. The others
#: are the tool's.
_DIMENSIONS = 12
#: Steps of central differences: by numbers, in half widths; by dimensions [m and 1].
_STEP = 0.01
_DIMENSION_STEP = 1e-5


@dataclass(frozen=True, eq=False)
class ArmNumbers:
    """The uncertain numbers of an arm; make them with `arm_numbers`.

    Attributes:
        arm: The record.
        names: Key of an arm file and component, (K,): ``links.link_2.com.x``,
            ``zeros.axis_d``, ``lengths.a_1``, ``motors.friction.axis_e``. First are
            `NUMBERS`. Then follow ``elbow.opposite`` and ``elbow.adjacent``, the two
            printed lengths that give a_1 and the elbow's angle; the motors of Table 4;
            and whatever else has a half width in the arm file.
        middle: Their values in the record, (K,), SI units, as an arm file has them: a
            zero is what is added to Table 1's angle, products of inertia have URDF's
            sign.
        half_width: Each true value is within this of the middle, (K,); 0 for what is
            known.
        root: Of the numbers that a calibration knows together, (K, r), with zeros in
            the rows of all others: they are ``middle + root @ u`` with ``|u| <= 1``,
            so the lengths of the rows are their half widths. None if there are none.
    """

    arm: Alpha5Parameters
    names: tuple[str, ...]
    middle: FloatArray
    half_width: FloatArray
    root: FloatArray | None = None

    def record(self, values: FloatArray) -> Alpha5Parameters:
        """The arm with other values (K,) of its numbers.

        A tool at Table 1's point stays at the end of the arm, and the corrected centre
        of buoyancy of link 3 follows the lengths that it was computed from.

        Raises:
            InputError: Numbers that no arm has.
        """
        change = zip(self.names, (values - self.middle).tolist(), strict=True)
        changes = {name: by for name, by in change if by}
        if not changes:
            return self.arm
        arm = self.arm
        tree: dict[Any, Any] = {}
        for name, by in _with_dependent(arm, changes).items():
            *path, leaf = _path(arm, name)
            branch = tree
            for step in path:
                branch = branch.setdefault(step, {})
            branch[leaf] = by
        with plausibility.silenced():
            fields = {name: _changed(_top(arm, name), by) for name, by in tree.items()}
            return replace(arm, **fields)

    def at(self, values: FloatArray) -> ArmNumbers:
        """The same numbers with other values (K,) as their middle."""
        return replace(self, arm=self.record(values), middle=values)

    def leading(self, half_width: FloatArray) -> ArmNumbers:
        """Only the first of the numbers, with other half widths (k,), each by itself.

        The others are known. Slopes of numbers whose half width is 0 are zeros, and
        cost no time.

        Args:
            half_width: Of at least all numbers of links.
        """
        first = slice(len(half_width))
        return ArmNumbers(
            arm=self.arm,
            names=self.names[first],
            middle=self.middle[first],
            half_width=half_width,
        )

    def half_width_of(self, slopes: FloatArray) -> FloatArray:
        """How far the numbers move quantities to first order, (...).

        Numbers that are known one by one count with their half widths all at once, the
        worst case. Those of a calibration count with the farthest point of their
        ellipsoid.

        Args:
            slopes: Derivatives of the quantities by the numbers, (..., K).
        """
        if self.root is None:
            return np.asarray(np.abs(slopes) @ self.half_width)
        alone = np.where(self.root.any(axis=1), 0.0, self.half_width)
        together = np.linalg.norm(slopes @ self.root, axis=-1)
        return np.asarray(np.abs(slopes) @ alone + together)


@lru_cache(maxsize=64)
def arm_numbers(arm: Alpha5Parameters) -> ArmNumbers:
    """The uncertain numbers of an arm, those of one record made once."""
    half_widths = {**dict.fromkeys(NUMBERS, 0.0), **_of_digits(arm), **_measured(arm)}
    if arm.covariance is not None and "zeros.axis_d" in arm.covariance.names:
        # The zeros have absorbed the elbow's angle, and a_1 is a number of its own.
        half_widths["elbow.opposite"] = half_widths["elbow.adjacent"] = 0.0
    names = tuple(half_widths)
    half_width = np.array([*half_widths.values()])
    root = None
    if arm.covariance is not None:
        known = arm.covariance
        rows = [names.index(name) for name in known.names]
        root = np.zeros((len(names), len(rows)))
        root[rows] = WIDTH * known.deviation[:, None] * known.root
        half_width[rows] = np.linalg.norm(root[rows], axis=1)
    return ArmNumbers(
        arm=arm,
        names=names,
        middle=np.array([_value(arm, name) for name in names]),
        half_width=half_width,
        root=root,
    )


def by_body(values: FloatArray) -> FloatArray:
    """The numbers of the links, (..., 5, 14), of values (..., K)."""
    shape = (*values.shape[:-1], len(BODY_NAMES), PER_BODY)
    return np.asarray(values[..., :OF_BODIES]).reshape(shape)


# --- loads and their derivatives ------------------------------------------------------


def loads(
    record: Alpha5Parameters,
    density: float,
    gravity: FloatArray,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    carried: FloatArray | None = None,
) -> FloatArray:
    """Joint torques, then force and moment on the mount in base_link, (N, 10).

    Args:
        record: Of the arm, with its attached bodies.
        density: Of the fluid [kg/m^3].
        gravity: In base_link, (3,) [m/s^2].
        q, v, a: (N, 4) each.
        carried: Moments of what the links carry beyond the record, (5, 2, 4, 4), see
            `alpha5_model.codegen.regrouping.moments`; it stays where it is on its link.
    """
    bodies = moments_of_record(record, density)
    if carried is not None:
        bodies = bodies + carried
    at = _kernel_numbers(record, bodies)
    return _rows(at, gravity, q, v, a)


def load_slopes(
    numbers: ArmNumbers,
    density: float,
    gravity: FloatArray,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    carried: FloatArray | None = None,
) -> FloatArray:
    """Derivatives of `loads` by the numbers at their middle, (N, 10, K).

    Numbers without a half width have zeros.

    Args:
        numbers: Of the arm. `ArmNumbers.at` moves them to where the slopes are wanted.
        density, gravity, q, v, a, carried: As of `loads`.
    """
    slopes = base_slopes(numbers, density)
    bodies = moments_of_record(numbers.arm, density)
    if carried is not None:
        bodies = bodies + carried
        slopes = slopes + _slopes_of_carried(numbers, carried)

    at = _kernel_numbers(numbers.arm, bodies)
    by_base = regressor_rows(q, v, a, gravity, at[_BASE:])
    by_dimensions = []
    for step in _DIMENSION_STEP * np.eye(_DIMENSIONS, len(at) - _BASE):
        longer, shorter = at.copy(), at.copy()
        longer[_BASE:] += step
        shorter[_BASE:] -= step
        change = _rows(longer, gravity, q, v, a) - _rows(shorter, gravity, q, v, a)
        by_dimensions.append(change / (2 * _DIMENSION_STEP))
    by_numbers = np.concatenate([by_base, np.stack(by_dimensions, axis=-1)], axis=-1)
    return by_numbers @ slopes[:, : _BASE + _DIMENSIONS].T


def gravity_slopes(numbers: ArmNumbers, gravity: FloatArray) -> FloatArray:
    """Derivatives of gravity in base_link, (3,) [m/s^2], by the numbers, (K, 3).

    They are of the turn of the mount, which all other slopes take as known.
    """
    own = numbers.arm.mount
    if own is None:
        return np.zeros((len(numbers.names), 3))
    return _differences(
        numbers,
        lambda arm: arm.mount.rotation.T @ own.rotation @ gravity,
        [k for k in _rows_of(numbers, "mount") if ".rpy." in numbers.names[k]],
    )


@lru_cache(maxsize=64)
def base_slopes(numbers: ArmNumbers, density: float) -> FloatArray:
    """Derivatives of base parameters and dimensions at the middle, (K, 38 + 24).

    They are central differences, made once. Numbers without a half width, and those
    that no load depends on, have zeros. See `alpha5_model.dynamics.regression.NAMES`
    and `alpha5_model.kinematics.geometry.Geometry.dimensions`.
    """
    bodies = moments_of_record(numbers.arm, density)

    def moved(arm: Any) -> FloatArray:
        # Lengths and zeros leave the bodies as they are.
        same = (arm.links, arm.attached) == (numbers.arm.links, numbers.arm.attached)
        own = bodies if same else moments_of_record(arm, density)
        return _kernel_numbers(arm, own)

    others = _rows_of(numbers, "zeros", "lengths", "elbow", "attached")
    out = _differences(numbers, moved, others)

    # Those of the links without a record for each. What is attached to a link, and the
    # jaws that a spacer moves, are sums with the link, and do not change its slopes.
    links = by_body(numbers.middle)
    for k in _rows_of(numbers, "links"):
        link, number = divmod(k, PER_BODY)
        # Moments are quadratic in each number, so a step of any size is exact.
        step = numbers.half_width[k] * np.eye(PER_BODY)[number]
        more = _moments(links[link] + step, density)
        less = _moments(links[link] - step, density)
        slope = np.zeros((len(links), 2, 4, 4))
        slope[link] = np.subtract(more, less) / (2 * step[number])
        out[k, :_BASE] = regrouped(slope, np.zeros(3), numbers.arm)[:_BASE]
    return frozen(out)


def _rows_of(numbers: ArmNumbers, *tables: str) -> list[int]:
    """The numbers of some tables of an arm file that are not known."""
    return [
        k
        for k, name in enumerate(numbers.names)
        if numbers.half_width[k] and name.partition(".")[0] in tables
    ]


def _slopes_of_carried(numbers: ArmNumbers, carried: FloatArray) -> FloatArray:
    """What `base_slopes` are of a load on the links, which lengths move."""
    lengths = _rows_of(numbers, "lengths", "elbow")
    out = _differences(numbers, lambda arm: _kernel_numbers(arm, carried), lengths)
    out[:, _BASE:] = 0.0  # dimensions count with the arm's own bodies
    return out


def _differences(
    numbers: ArmNumbers, quantity: Callable[[Any], FloatArray], rows: Sequence[int]
) -> FloatArray:
    """Derivatives of quantities (m,) of a record by some of the numbers, (K, m).

    Args:
        numbers: Of the arm.
        quantity: Function of the record.
        rows: The numbers that it depends on.
    """
    out = np.zeros((len(numbers.names), len(quantity(numbers.arm))))
    for k in rows:
        more, less = numbers.middle.copy(), numbers.middle.copy()
        more[k] += _STEP * numbers.half_width[k]
        less[k] -= _STEP * numbers.half_width[k]
        change = quantity(numbers.record(more)) - quantity(numbers.record(less))
        out[k] = change / (more[k] - less[k])
    return out


def _moments(body: FloatArray, density: float) -> tuple[FloatArray, FloatArray]:
    """Moments of a body by its numbers, (14,)."""
    inertia = body[4:10][SYMMETRIC]
    return moments(body[0], body[1:4], inertia, body[10], body[11:], density)


def moments_of_record(record: Alpha5Parameters, density: float) -> FloatArray:
    """Moments of the links with all that is attached, (5, 2, 4, 4)."""
    return np.array(
        [
            moments(body.mass, body.com, body.inertia, body.volume, body.cob, density)
            for body in loaded_links(record)
        ]
    )


def _kernel_numbers(record: Alpha5Parameters, bodies: FloatArray) -> FloatArray:
    """Base parameters of moments on the links (5, 2, 4, 4), and dimensions, (62,)."""
    base_parameters = regrouped(bodies, np.zeros(3), record)[:_BASE]
    return np.concatenate([base_parameters, Geometry.of(record).dimensions])


def _rows(
    at: FloatArray, gravity: FloatArray, q: FloatArray, v: FloatArray, a: FloatArray
) -> FloatArray:
    """Loads of `_kernel_numbers`, (N, 10)."""
    given = np.concatenate([at[:_BASE], gravity, at[_BASE:]])
    return np.hstack(kernels.rows("inverse_dynamics_with_base_wrench", given, q, v, a))


# --- numbers of a record --------------------------------------------------------------


def _of_digits(arm: Alpha5Parameters) -> dict[str, float]:
    """Name -> half width by the printed digits."""
    found = {name: number.half_width for name, number in printed_numbers().items()}
    for joint, own in zip(JOINT_NAMES, arm.actuators, strict=True):
        name = f"motors.friction.{joint}"
        rounding = printed_numbers()[name].printed.rounding
        found[name] = max(rounding, own.friction * own.friction_tolerance)
    return found


def _measured(arm: Alpha5Parameters) -> dict[str, float]:
    """Name -> half width by the arm file."""
    found = {}
    for one in arm.measurements:
        if one.half_width is not None:
            for name in _components(one.key):
                if _value(arm, name) is not None:
                    found[name] = one.half_width
    return found


def _components(key: str) -> list[str]:
    """The numbers of a key of an arm file."""
    field = key.rpartition(".")[2]
    if field in ("com", "cob", "at", "xyz", "rpy"):
        return [f"{key}.{axis}" for axis in "xyz"]
    if field == "inertia":
        return [f"{key}.{axes}" for axes in UPPER]
    return [key]


def _is_measured(arm: Alpha5Parameters, key: str) -> bool:
    """Whether the arm file gives a half width."""
    return any(
        one.key == key and one.half_width is not None for one in arm.measurements
    )


def _value(arm: Alpha5Parameters, name: str) -> Any:
    """A number of a record; None if it has none."""
    if name.startswith("elbow."):
        return printed_numbers()[name].value
    first, *path = _path(arm, name)
    part = _top(arm, first)
    for step in path:
        if part is not None:
            part = _part(part, step)
    if name.startswith("zeros."):
        catalogue = parameters(arm.corrections)
        part = part - catalogue.dh[JOINT_NAMES.index(name[6:])].theta_offset
    return part


def _path(arm: Alpha5Parameters, name: str) -> tuple[Any, ...]:
    """Where a number is in a record: fields and places, one in the other."""
    match name.split("."):
        case ["links", link, field, *axes]:
            return ("links", BODY_NAMES.index(link), field, *_place(axes))
        case ["attached", body, field, *axes]:
            bodies = [one.name for one in arm.attached]
            own_field = "position" if field == "at" else field
            return ("attached", bodies.index(body), own_field, *_place(axes))
        case ["zeros", joint]:
            return ("dh", JOINT_NAMES.index(joint), "theta_offset")
        case ["lengths", length]:
            return ("dh", *LENGTHS[length])
        case ["theta_c"]:
            return ("theta_c",)
        case ["joint_limits", joint, limit]:
            return ("joints", JOINT_NAMES.index(joint), LIMIT_FIELDS[limit])
        case ["tool" | "mount" as frame, field, *axes]:
            return (frame, "position" if field == "xyz" else field, *_place(axes))
        case ["motors", "supply_voltage"]:
            return ("motors", "supply_voltage")
        case ["motors", drive, joint] if drive in DRIVE_FIELDS:
            return ("motors", DRIVE_FIELDS[drive], JOINT_NAMES.index(joint))
        case ["motors", field, joint]:
            return ("actuators", JOINT_NAMES.index(joint), field)
    raise KeyError(name)


def _place(axes: list[str]) -> list[tuple[int, ...]]:
    """The place of a component in its array; none of a number."""
    return [tuple("xyz".index(axis) for axis in one) for one in axes]


def _top(arm: Alpha5Parameters, field: str) -> Any:
    """A field of an arm; Table 1's tool if it has none of its own."""
    return tool_of(arm) if field == "tool" else getattr(arm, field)


def _part(part: Any, step: Any) -> Any:
    """A field of a record, or a place of an array or tuple."""
    if step == "rpy":
        return np.array(rpy_from_rotation(part.rotation))
    return getattr(part, step) if isinstance(step, str) else part[step]


def _changed(part: Any, by: Any) -> Any:
    """A part of a record with its numbers changed.

    Args:
        part: A number, array, tuple or record.
        by: What is added to the number, or a mapping of places or fields to that.
    """
    if not isinstance(by, Mapping):
        return part + by
    if isinstance(part, np.ndarray):
        array = part.copy()
        for at, change in by.items():
            for place in {at, at[::-1]}:  # both halves of a tensor
                array[place] += change
        return array
    if isinstance(part, tuple):
        return tuple(
            _changed(one, by[k]) if k in by else one for k, one in enumerate(part)
        )
    fields = {name: _changed(_part(part, name), change) for name, change in by.items()}
    if "rpy" in fields:
        fields["rotation"] = rotation_from_rpy(fields.pop("rpy"))
    return replace(part, **fields)


def _with_dependent(
    arm: Alpha5Parameters, changes: Mapping[str, float]
) -> dict[str, float]:
    """Changes of numbers, with those that follow from them."""
    found = dict(changes)

    def add(name: str, by: float) -> None:
        if by:
            found[name] = found.get(name, 0.0) + by

    sides = np.array([_value(arm, f"elbow.{s}") for s in ("opposite", "adjacent")])
    moved = sides + [found.pop(f"elbow.{s}", 0.0) for s in ("opposite", "adjacent")]
    if not np.array_equal(sides, moved):
        turned = float(np.arctan2(*moved) - np.arctan2(*sides))
        for name in ("theta_c", "zeros.axis_d", "zeros.axis_c"):
            add(name, turned)
        if not _is_measured(arm, "lengths.a_1"):
            add("lengths.a_1", float(np.hypot(*moved) - np.hypot(*sides)))

    if "link3_cob" in arm.corrections and not _is_measured(arm, "links.link_3.cob"):
        add("links.link_3.cob.x", found.get("lengths.a_2", 0.0))
        add("links.link_3.cob.y", -found.get("lengths.d_0", 0.0))

    follows = not has_own_tool_point(arm)
    if follows and (arm.tool is not None or any(n.startswith("tool.") for n in found)):
        spacers = [f"attached.{body.name}.spacer" for body in arm.attached]
        longer = sum(found.get(name, 0.0) for name in spacers)
        add("tool.xyz.z", found.get("lengths.d_3", 0.0) - longer)
    return found
