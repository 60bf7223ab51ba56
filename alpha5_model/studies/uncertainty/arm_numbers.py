"""The uncertain numbers of an arm: printed ones, and measured ones of an arm file.

A value with a half width in the arm file lies within it. Any other number of an arm of
your own keeps the half width of the printed digits, about the arm's own value.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.inertia import second_moments
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    LinkParameters,
    is_catalogue,
    parameters,
)
from alpha5_model.numbers.pose import has_own_tool_point, printed_tool
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.calibrated import (
    Calibrated,
    calibrated_rows,
    spread_of,
)
from alpha5_model.studies.uncertainty.linear_maps import (
    SYMMETRIC,
    UPPER,
    grouping,
    link_map,
    numbers_of_body,
    possible,
    split,
)
from alpha5_model.studies.uncertainty.measured import (
    half_widths,
    other_numbers,
    with_changes,
)

#: Quantity in the name of a printed number -> key of the arm file.
_KEYS = {
    "mass": "mass",
    "com": "com",
    "inertia_com": "inertia",
    "volume": "volume",
    "cob": "cob",
}
#: Quantities of an attached body that torques are linear in, one after the other.
_OF_BODY = ("mass", "com", "inertia", "volume", "cob", "at")


@dataclass(frozen=True, eq=False)
class ArmNumbers:
    """The uncertain numbers of an arm.

    Attributes:
        arm: The record.
        alternatives: Names of `ALTERNATIVES` that are believed.
        names: Of the numbers, (K,): the printed ones, then those that are only
            measured, by their keys in the arm file.
        middle, half_width: Of their intervals, (K,) each, SI units. Signs and frames
            are those of the printed tables.
        to_bodies: Derivatives of the bodies by the numbers, (K, B, 14), see
            `LinkNumbers`.
        offset: Of the bodies, if they are not ``values @ to_bodies``, (B, 14).
        carriers: The link that each body is fixed to, (B,): first the five links.
        calibrated: Numbers that are known together; None if there are none.
    """

    arm: Alpha5Parameters
    alternatives: tuple[str, ...]
    names: tuple[str, ...]
    middle: FloatArray
    half_width: FloatArray
    to_bodies: FloatArray
    offset: FloatArray | None
    carriers: tuple[int, ...]
    calibrated: Calibrated | None = None

    def spread(self, drawn: FloatArray) -> FloatArray:
        """Changes of the numbers from independent draws in -1 to 1, (..., K)."""
        change = self.half_width * drawn
        known = self.calibrated
        if known is not None:
            change[..., known.rows] = spread_of(
                known, self.middle, drawn[..., known.rows]
            )
        return np.asarray(change)

    def bodies(self, values: FloatArray) -> FloatArray:
        """Numbers of the bodies, (..., B, 14), for values (..., K)."""
        linear = np.tensordot(values, self.to_bodies, 1)
        return linear if self.offset is None else linear + self.offset

    def possible(self, values: FloatArray) -> Any:
        """Which sets (n, K) are possible bodies with their COM inside, (n,)."""
        links = self.bodies(values)[:, :5]
        found = possible(links)
        for i, link in enumerate(self.arm.links):
            com = split(links[:, i]).com
            lower, upper = link.bounds.T
            found &= ((lower <= com) & (com <= upper)).all(axis=1)
        return found

    def grouping(self, density: float) -> FloatArray:
        """Map from moments of the bodies to the base parameters, (B, 14, 38)."""
        return grouping(density, self.arm)[list(self.carriers)]

    def parameters(self, values: FloatArray) -> Alpha5Parameters:
        """The arm with other values (K,) of its numbers."""
        if self.offset is None:
            return self._printed_set(values)

        change = values - self.middle
        moved = {
            name: by for name, by in zip(self.names, change.tolist(), strict=True) if by
        }
        known = printed.numbers(())
        arm = replace(
            self.arm,
            dh=_with_lengths(self.arm, moved),
            links=self._links(change),
            actuators=_with_actuators(self.arm, moved),
            tool=None,
        )
        arm = replace(arm, tool=_tool(self.arm, arm))
        others = {name: by for name, by in moved.items() if name not in known}
        return with_changes(arm, others)

    def _printed_set(self, values: FloatArray) -> Alpha5Parameters:
        """The arm with other values (K,) of the printed numbers."""
        given = dict(zip(self.names, values.tolist(), strict=True))
        own = self.arm
        arm = printed.parameter_set(given, self.alternatives, own.corrections)
        if is_catalogue(own):
            return arm
        return replace(
            arm,
            joints=own.joints,
            jaws=own.jaws,
            tool=own.tool,
            mount=own.mount,
            motors=own.motors,
            name=own.name,
            measurements=own.measurements,
        )

    def _links(self, change: FloatArray) -> tuple[LinkParameters, ...]:
        """The links with their numbers changed."""
        by_number = split(np.tensordot(change, self.to_bodies[:, :5], 1))
        links = []
        for i, link in enumerate(self.arm.links):
            second = by_number.second[i][SYMMETRIC]
            own = replace(
                link,
                mass=link.mass + float(by_number.mass[i]),
                com=link.com + by_number.com[i],
                inertia=link.inertia + np.trace(second) * np.eye(3) - second,
                volume=link.volume + float(by_number.volume[i]),
                cob=link.cob + by_number.cob[i],
            )
            links.append(own)
        return tuple(links)


def are_lengths(names: Iterable[str]) -> NDArray[np.bool_]:
    """Which numbers are lengths of Table 1 or of an arm file, (K,) bool."""
    of_rows = {f"link_{i}.{field}" for i in range(5) for field in ("a", "d")}
    return np.array(
        [name in of_rows or name.startswith(("elbow.", "lengths.")) for name in names],
        dtype=bool,
    )


def arm_numbers(
    arm: Alpha5Parameters, alternatives: tuple[str, ...] = ()
) -> ArmNumbers:
    """The uncertain numbers of an arm.

    Args:
        arm: The record.
        alternatives: Checked names of `ALTERNATIVES`.

    Raises:
        InputError: Alternatives for an arm with own numbers.
    """
    catalogue = parameters(arm.corrections)
    if arm is catalogue or _is_as_printed(arm, catalogue):
        return _printed_numbers(arm, alternatives)
    if alternatives:
        expected = "none beside an arm of your own, whose record says what holds"
        raise InputError("alternatives", alternatives, expected)
    return _own_numbers(arm)


def _is_as_printed(arm: Alpha5Parameters, catalogue: Alpha5Parameters) -> bool:
    """Whether all numbers of Tables 1 to 4 are the printed ones."""
    if arm.attached or half_widths(arm) or arm.covariance:
        return False
    same_links = np.array_equal(_link_numbers(arm), _link_numbers(catalogue))
    rows = zip(
        (*arm.dh, *arm.actuators), (*catalogue.dh, *catalogue.actuators), strict=True
    )
    return same_links and all(vars(own) == vars(other) for own, other in rows)


def _printed_numbers(
    arm: Alpha5Parameters, alternatives: tuple[str, ...]
) -> ArmNumbers:
    """The numbers of the catalogue's arm."""
    middle, half_width = printed.intervals(alternatives)
    return ArmNumbers(
        arm=arm,
        alternatives=alternatives,
        names=tuple(printed.numbers(alternatives)),
        middle=middle,
        half_width=half_width,
        to_bodies=link_map(alternatives, arm.corrections),
        offset=None,
        carriers=(0, 1, 2, 3, 4),
    )


@lru_cache(maxsize=64)
def _own_numbers(arm: Alpha5Parameters) -> ArmNumbers:
    """The numbers of an arm with values of its own."""
    names = tuple(printed.numbers(()))
    others = other_numbers(arm)
    to_links = _own_link_map(arm, names)
    to_bodies = np.zeros((len(names) + len(others), 5 + len(arm.attached), 14))
    to_bodies[: len(names), :5] = to_links
    for row, other in enumerate(others, len(names)):
        key = other.name.split(".")
        if key[0] == "attached" and key[2] in _OF_BODY:
            at = [body.name for body in arm.attached].index(key[1])
            to_bodies[row, 5 + at] = _slope(arm.attached[at], key[2:])

    middle = np.concatenate(
        [_own_values(arm, names, to_links), [other.value for other in others]]
    )
    bodies = [*_link_numbers(arm), *map(_attached_numbers, arm.attached)]
    own_half_widths = [*_own_half_widths(arm), *(other.half_width for other in others)]
    own_names = (*names, *(other.name for other in others))
    half_width = np.array(own_half_widths)
    calibrated = calibrated_rows(arm, own_names)
    if calibrated is not None:
        half_width[calibrated.rows] = calibrated.half_width
        if arm.covariance and "zeros.axis_d" in arm.covariance.names:
            # The zeros have absorbed the elbow's angle, and a_1 is a number of its own.
            half_width[[name.startswith("elbow.") for name in own_names]] = 0.0
    return ArmNumbers(
        arm=arm,
        alternatives=(),
        names=own_names,
        middle=middle,
        half_width=half_width,
        to_bodies=to_bodies,
        offset=np.array(bodies) - np.tensordot(middle, to_bodies, 1),
        carriers=(0, 1, 2, 3, 4, *(int(body.link[-1]) for body in arm.attached)),
        calibrated=calibrated,
    )


def _own_link_map(arm: Alpha5Parameters, names: tuple[str, ...]) -> FloatArray:
    """`link_map`, in which a measured centre of buoyancy needs no length."""
    to_links = np.array(link_map((), arm.corrections))
    for i, link in enumerate(BODY_NAMES):
        if f"links.{link}.cob" in half_widths(arm):
            others = [k for k, name in enumerate(names) if ".cob." not in name]
            to_links[others, i, 11:] = 0.0
    return to_links


def _own_values(
    arm: Alpha5Parameters, names: tuple[str, ...], to_links: FloatArray
) -> FloatArray:
    """The arm's values of the printed numbers, (K,)."""
    values = np.array([number.value for number in printed.numbers(()).values()])
    catalogue = _link_numbers(parameters(arm.corrections))
    change = _link_numbers(arm) - catalogue
    for i, link in enumerate(BODY_NAMES):
        # 14 printed numbers make the 14 numbers of a link, one for one.
        own = [k for k, name in enumerate(names) if _link_key(name, link)]
        values[own] += np.linalg.solve(to_links[own, i].T, change[i])
    for row, field in LENGTHS.values():
        name = f"link_{row}.{field}"
        if name in names:
            values[names.index(name)] = getattr(arm.dh[row], field)
    for i, actuator in enumerate(arm.actuators):
        for k, name in _of_actuator(names, i):
            values[k] = getattr(actuator, name)
    return values


def _link_key(name: str, link: str) -> str:
    """The key in an arm file of a printed number of a link; empty if it has none."""
    body, quantity, *_ = name.split(".")
    return (
        f"links.{link}.{_KEYS[quantity]}" if body == link and quantity in _KEYS else ""
    )


def _of_actuator(names: tuple[str, ...], i: int) -> Iterator[tuple[int, str]]:
    """Index and quantity of the printed numbers of an actuator."""
    for k, name in enumerate(names):
        row, _, quantity = name.partition(".")
        if row == f"actuator_{i}":
            yield k, quantity


def _own_half_widths(arm: Alpha5Parameters) -> list[float]:
    """Half widths of the printed numbers, of an arm with measured ones."""
    measured = half_widths(arm)
    found = []
    for name, number in printed.numbers(()).items():
        half_width = (number.upper - number.lower) / 2
        row, _, quantity = name.partition(".")
        if row.startswith("actuator_"):
            half_width = _of_motor(arm, int(row[-1]), quantity, half_width)
        for key in _keys(name):
            half_width = measured.get(key, half_width)
        found.append(half_width)
    return found


def _of_motor(arm: Alpha5Parameters, i: int, quantity: str, half_width: float) -> float:
    """The half width of a motor's number; friction has a tolerance of its own."""
    if quantity != "friction":
        return half_width
    actuator = arm.actuators[i]
    tolerance = actuator.friction * actuator.friction_tolerance
    rounding = printed.numbers(())[f"actuator_{i}.friction"].printed.rounding
    return max(rounding, tolerance)


def _keys(name: str) -> list[str]:
    """The keys of an arm file that stand for a printed number, the nearest last."""
    row, _, quantity = name.partition(".")
    if row.startswith("actuator_"):
        key = f"motors.{quantity}"
        return [key, f"{key}.{JOINT_NAMES[int(row[-1])]}"]
    lengths = {f"link_{i}.{field}": key for key, (i, field) in LENGTHS.items()}
    if name in lengths:
        return [f"lengths.{lengths[name]}"]
    key = _link_key(name, row)
    return [key] if key else []


def _with_lengths(arm: Alpha5Parameters, moved: dict[str, float]) -> tuple[Any, ...]:
    """The rows of Table 1 with printed numbers changed."""
    known = printed.numbers(())
    lengths = {
        name: known[name].value + by
        for name, by in moved.items()
        if name in known and name.endswith((".a", ".d", "opposite", "adjacent"))
    }
    if not lengths:
        return arm.dh
    before = parameters(arm.corrections).dh
    after = printed.parameter_set(lengths, (), arm.corrections).dh
    a_1_is_measured = "lengths.a_1" in half_widths(arm)
    rows = []
    for i, (own, old, new) in enumerate(zip(arm.dh, before, after, strict=True)):
        a = own.a if i == 1 and a_1_is_measured else own.a + (new.a - old.a)
        offset = own.theta_offset + (new.theta_offset - old.theta_offset)
        d = own.d + (new.d - old.d)
        rows.append(replace(own, a=a, d=d, theta_offset=offset))
    return tuple(rows)


def _with_actuators(arm: Alpha5Parameters, moved: dict[str, float]) -> tuple[Any, ...]:
    """The actuators with printed numbers changed."""
    actuators = []
    for i, actuator in enumerate(arm.actuators):
        own: dict[str, Any] = {}
        for name, by in moved.items():
            row, _, quantity = name.partition(".")
            if row == f"actuator_{i}":
                own[quantity] = getattr(actuator, quantity) + by
        actuators.append(replace(actuator, **own) if own else actuator)
    return tuple(actuators)


def _tool(arm: Alpha5Parameters, changed: Alpha5Parameters) -> Any:
    """The tool of an arm whose lengths have changed: a spacer keeps it at the jaws."""
    if arm.tool is None or not arm.spacer or has_own_tool_point(arm):
        return arm.tool
    wrist = printed_tool(changed.dh[3], changed.dh[4]).position
    position = wrist - np.array([0.0, 0.0, arm.spacer])
    return replace(arm.tool, position=position)


def _link_numbers(arm: Alpha5Parameters) -> FloatArray:
    """The 14 numbers of each link, (5, 14)."""
    return np.array([numbers_of_body(vars(link)) for link in arm.links])


def _attached_numbers(body: AttachedBody) -> list[float]:
    """The 14 numbers of an attached body in the axes of its link."""
    return numbers_of_body(vars(body.in_link()))


def _slope(body: AttachedBody, key: list[str]) -> FloatArray:
    """Derivative of an attached body's 14 numbers by one of its values, (14,).

    Args:
        body: The body.
        key: Quantity of `_OF_BODY`, and the component, if it has some.
    """
    quantity, *axes = key
    slope = np.zeros(14)
    of = split(slope)
    if quantity in ("mass", "volume"):
        slope[0 if quantity == "mass" else 10] = 1.0
        return slope

    at = ["xyz".index(axis) for axis in axes[0]]
    if quantity == "inertia":
        unit = np.zeros((3, 3))
        unit[at[0], at[1]] = 1.0
        unit[at[1], at[0]] = 1.0
        turned = body.rotation @ unit @ body.rotation.T
        of.second[:] = second_moments(turned)[UPPER]
        return slope

    direction = np.eye(3)[at[0]]
    if quantity != "at":
        direction = body.rotation @ direction
    if quantity in ("com", "at"):
        of.com[:] = direction
    if quantity in ("cob", "at"):
        of.cob[:] = direction
    return slope
