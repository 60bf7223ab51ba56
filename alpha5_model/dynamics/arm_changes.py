"""What an arm of your own changes against the catalogue's, and what each change costs.

The costs are the largest change of the hydrostatic torque of a joint, and the largest
distance that the tcp moves, over all positions within the limits of your arm. They are
searched on a grid, which is then refined around its largest value.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from itertools import product, zip_longest
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.load import arm_of
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER, gravity_in_base
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import Pose, has_own_tool_point, printed_tool
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.theory.dh import DHChain

#: Points of the grid for each joint, and how often it is refined around its best one.
_POINTS = (9, 13, 13, 13)
_REFINEMENTS = 6
#: Each refined grid is this much smaller.
_SHRINKING = 0.3
#: Fields of a record on which torque and tcp depend; their records are compared by
#: identity.
_AT_WORK = ("dh", "links", "base_yaw", "tool", "mount", "attached")
#: Numbers that differ by less than this are the same; it is below all that is measured.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Difference:
    """One number, vector or name of the record that differs.

    Attributes:
        name: Of the field, for example ``mass``.
        printed: Of the catalogue's arm; None if it has none.
        own: Of your arm.
    """

    name: str
    printed: Any
    own: Any


@dataclass(frozen=True, eq=False)
class ArmChange:
    """What one part of an arm changes.

    Attributes:
        key: Of the part in an arm file, for example ``links.link_2``.
        differences: Its fields that differ.
        torque: Largest change of a joint's hydrostatic torque [N m].
        tcp: Largest distance that the tcp moves in base_link [m].
    """

    key: str
    differences: tuple[Difference, ...]
    torque: float
    tcp: float


def arm_changes(
    own: Alpha5Parameters,
    printed: Alpha5Parameters,
    fluid_density: float = SEA_WATER,
) -> tuple[ArmChange, ...]:
    """The changes of an arm, each with its costs alone, and ``all`` of them together.

    Args:
        own: Your arm.
        printed: The catalogue's.
        fluid_density: [kg/m^3].

    Returns:
        In the order of an arm file; the last one, ``all``, has no differences. Empty
        if nothing differs. A mount counts as its tilt in a parent whose z is up.
    """
    found = []
    with plausibility.silenced():  # making the arm gave the warnings
        for key, alone, differences in _parts(own, printed):
            costs = _costs(alone, printed, own, fluid_density)
            found.append(ArmChange(key=key, differences=differences, **costs))
        if found:
            costs = _costs(own, printed, own, fluid_density)
            found.append(ArmChange(key="all", differences=(), **costs))
    return tuple(found)


def changed_keys(own: Alpha5Parameters, printed: Alpha5Parameters) -> tuple[str, ...]:
    """The keys of `arm_changes`, without the costs and ``all``."""
    with plausibility.silenced():
        return tuple(key for key, _, _ in _parts(own, printed))


def _parts(
    own: Alpha5Parameters, printed: Alpha5Parameters
) -> Iterator[tuple[str, Alpha5Parameters, tuple[Difference, ...]]]:
    """Key, the catalogue's arm with this part alone, and its differences."""
    for key, change in _candidates(own, printed):
        alone = replace(printed, **change)
        differences = tuple(_differences(printed, alone, [*change]))
        if differences:
            yield key, alone, differences


def _candidates(
    own: Alpha5Parameters, printed: Alpha5Parameters
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Key of each part that may differ, and the fields of the record that it sets."""
    yield "name", {"name": own.name}
    if own.corrections != printed.corrections:
        # They are in the links already; base_yaw turns link_0.
        yield (
            "corrections",
            {"corrections": own.corrections, "base_yaw": own.base_yaw},
        )
    yield "mount", {"mount": own.mount}
    for name, (i, field) in LENGTHS.items():
        yield f"lengths.{name}", {"dh": _with_row(printed, own, i, field)}
    for i, name in enumerate(JOINT_NAMES[:4]):
        yield f"zeros.{name}", {"dh": _with_row(printed, own, i, "theta_offset")}
    for i, joint in enumerate(own.joints):
        joints = _with_item(printed.joints, i, joint)
        yield f"joint_limits.{joint.name}", {"joints": joints}
    for i, link in enumerate(own.links):
        yield f"links.{link.name}", {"links": _with_item(printed.links, i, link)}
    for body in own.attached:
        yield f"attached.{body.name}", {"attached": (body,)}
    yield "tool", {"tool": _tool_alone(own, printed)}
    yield "motors", {"motors": own.motors, "actuators": own.actuators}


def _tool_alone(own: Alpha5Parameters, printed: Alpha5Parameters) -> Pose | None:
    """The tool without what a spacer moves it by; None for Table 1's."""
    if own.tool is None:
        return None
    before = _tool_of_table_1(printed)
    follows = own.spacer and not has_own_tool_point(own)
    position = before.position if follows else own.tool.position
    same_point = np.array_equal(position, before.position)
    if same_point and np.array_equal(own.tool.rotation, before.rotation):
        return None
    return Pose(position=position, rotation=own.tool.rotation)


def _tool_of_table_1(printed: Alpha5Parameters) -> Pose:
    *_, wrist, tip = printed.dh
    return printed_tool(wrist, tip)


def _with_row(
    printed: Alpha5Parameters, own: Alpha5Parameters, i: int, field: str
) -> tuple[Any, ...]:
    """The printed rows of Table 1 with one own number."""
    change: dict[str, Any] = {field: getattr(own.dh[i], field)}
    return _with_item(printed.dh, i, replace(printed.dh[i], **change))


def _with_item(items: tuple[Any, ...], i: int, item: Any) -> tuple[Any, ...]:
    return (*items[:i], item, *items[i + 1 :])


def _differences(
    printed: Alpha5Parameters, own: Alpha5Parameters, names: Iterable[str]
) -> Iterator[Difference]:
    """What differs in some fields of two records."""
    for name in names:
        if name == "tool":
            yield from _of_tools(printed, own)
        else:
            yield from _of_fields(name, getattr(printed, name), getattr(own, name))


def _of_tools(printed: Alpha5Parameters, own: Alpha5Parameters) -> Iterator[Difference]:
    if own.tool is not None:
        yield from _of_records("", _tool_of_table_1(printed), own.tool)


def _of_fields(name: str, one: Any, other: Any) -> Iterator[Difference]:
    """What differs in a field of two records: in each record of it, if it has some."""
    if not isinstance(other, tuple) or name == "corrections":
        yield from _of_values(name, one, other)
        return
    for i, (first, second) in enumerate(zip_longest(one, other)):
        prefix = f"{JOINT_NAMES[i]} " if name == "actuators" else ""
        yield from _of_records(prefix, first, second)


def _of_values(name: str, one: Any, other: Any) -> Iterator[Difference]:
    """What differs in a field: of records its fields, else the field."""
    if is_dataclass(one) or is_dataclass(other):
        yield from _of_records("", one, other)
    elif not _same(one, other):
        yield Difference(name=name, printed=one, own=other)


def _of_records(prefix: str, one: Any, other: Any) -> Iterator[Difference]:
    """The fields that differ in two records; None is a record without any."""
    if one is other:
        return
    for field in fields(other if one is None else one):
        first = getattr(one, field.name, None)
        second = getattr(other, field.name, None)
        if not _same(first, second):
            yield Difference(name=f"{prefix}{field.name}", printed=first, own=second)


def _same(one: Any, other: Any) -> bool:
    """Whether two values of a record are equal."""
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return False
    return bool(one == other)


def _costs(
    arm: Alpha5Parameters,
    printed: Alpha5Parameters,
    own: Alpha5Parameters,
    fluid_density: float,
) -> dict[str, float]:
    """Largest changes of torque and tcp.

    Args:
        arm: With some changes.
        printed: Without any.
        own: With the limits to search within.
        fluid_density: [kg/m^3].
    """
    if all(getattr(arm, name) == getattr(printed, name) for name in _AT_WORK):
        return {"torque": 0.0, "tcp": 0.0}
    lower = np.array([joint.lower for joint in own.joints[:4]])
    upper = np.array([joint.upper for joint in own.joints[:4]])
    torque_of_arm = _hydrostatic(arm, fluid_density)
    torque_of_printed = _hydrostatic(printed, fluid_density)
    tcp_of_arm = _tcp(arm)
    tcp_of_printed = _tcp(printed)

    def torque(q: FloatArray) -> FloatArray:
        change = torque_of_arm(q) - torque_of_printed(q)
        return np.asarray(np.abs(change).max(axis=-1))

    def distance(q: FloatArray) -> FloatArray:
        change = tcp_of_arm(q) - tcp_of_printed(q)
        return np.asarray(np.linalg.norm(change, axis=-1))

    return {
        "torque": largest(torque, lower, upper),
        "tcp": largest(distance, lower, upper),
    }


def _hydrostatic(
    parameters: Alpha5Parameters, fluid_density: float
) -> Callable[[FloatArray], FloatArray]:
    """Hydrostatic torques (N, 4) of positions (N, 4)."""
    gravity = np.array(GRAVITY)
    if parameters.mount is not None:
        gravity = gravity_in_base(parameters.mount.rotation)
    arm = arm_of(parameters, fluid_density, gravity)

    def torque(q: FloatArray) -> FloatArray:
        rest = np.zeros_like(q)
        return arm.inverse_dynamics_batch(q, rest, rest)

    return torque


def _tcp(parameters: Alpha5Parameters) -> Callable[[FloatArray], FloatArray]:
    """Positions of the tcp in base_link (N, 3) at joint positions (N, 4)."""
    chain = DHChain.alpha5(arm=parameters)
    return lambda q: chain.forward_kinematics(q)[..., :3, 3]


def largest(
    function: Callable[[FloatArray], FloatArray], lower: FloatArray, upper: FloatArray
) -> float:
    """The largest value of a smooth function of four joint positions.

    Args:
        function: Of positions (N, 4), values (N,).
        lower, upper: Limits of the positions, (4,).

    Returns:
        The largest value on a grid that is refined around its largest value; 0 if it
        is rounding.
    """
    low = lower
    high = upper
    best = 0.0
    for _ in range(_REFINEMENTS):
        axes = [
            np.linspace(start, end, points)
            for start, end, points in zip(low, high, _POINTS, strict=True)
        ]
        grid = np.array([*product(*axes)])
        values = function(grid)
        top = int(values.argmax())
        best = max(best, float(values[top]))
        half = (high - low) * _SHRINKING / 2
        low = np.maximum(lower, grid[top] - half)
        high = np.minimum(upper, grid[top] + half)
    return best if best > _ROUNDING else 0.0
