"""Whether the parts of an arm's record fit together, and fit Table 1."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from collections.abc import Set as AbstractSet
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import excess_of_box
from alpha5_model.errors import InputError
from alpha5_model.numbers.inertia import inconsistencies
from alpha5_model.numbers.plausibility import warn
from alpha5_model.numbers.pose import Pose
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

#: Length of Table 1 -> its row and its field.
LENGTHS = {
    "a_0": (0, "a"),
    "d_0": (0, "d"),
    "a_1": (1, "a"),
    "a_2": (2, "a"),
    "d_3": (3, "d"),
}
#: Largest distance of a tool point from Table 1's [m].
FARTHEST_TOOL = 0.3
#: Difference of a twist that is rounding [rad].
_SAME_TWIST = 1e-9
#: Difference of a moved tool point that is rounding [m].
_SAME_POINT = 1e-12
#: No body of the arm is that long [m].
_LONGEST_BODY = 0.5
#: Two arms of one kind do not differ by more: a length [m], a zero [rad].
_LENGTH = 0.02
_ZERO = math.radians(10)
#: A mass that is off by more makes an inertia of before wrong by as much.
_MASS = 0.2
#: Bodies that the arm has already.
TAKEN = ("base_link", *BODY_NAMES, "tcp", "jaw_rod", "finger_1", "finger_2")


def check_dh(dh: Sequence[Any], table_1: Sequence[Any]) -> None:
    """Refuse lengths of the other sign, and axes that are not parallel as printed.

    The closed form of the inverse kinematics needs Table 1's twists.

    Args:
        dh: The rows of the arm, records of `DHParameters`.
        table_1: The rows as printed.

    Raises:
        InputError: A length or a twist that no arm of this kind has.
    """
    for name, (i, field) in LENGTHS.items():
        own = getattr(dh[i], field)
        printed = getattr(table_1[i], field)
        if own * printed <= 0:
            side = "above 0" if printed > 0 else "below 0"
            expected = f"a length {side}, as Table 1's {printed:g} m"
            raise InputError(f"lengths.{name}", own, expected)
    for i in range(4):
        if abs(dh[i].alpha - table_1[i].alpha) > _SAME_TWIST:
            expected = (
                f"Table 1's {table_1[i].alpha:g} rad: "
                "the closed-form inverse kinematics has no twisted axes"
            )
            raise InputError(f"dh[{i}].alpha", dh[i].alpha, expected)


def check_attached(attached: Iterable[AttachedBody]) -> None:
    """Refuse names that the arm has already, or that two bodies share.

    Raises:
        InputError: Such a name.
    """
    taken = set(TAKEN)
    for i, body in enumerate(attached):
        if body.name in taken:
            expected = "a name that no other body or frame has"
            raise InputError(f"attached[{i}].name", body.name, expected)
        taken.add(body.name)


def check_parent(parent: str) -> None:
    """Refuse a mount on a link or frame of the arm itself.

    Raises:
        InputError: Such a name.
    """
    if parent in TAKEN:
        raise InputError("mount.parent", parent, "a name that is none of the arm's")


def check_tool(tool: Pose, printed: Pose, spacer: float) -> None:
    """Refuse a tool point far from Table 1's, or one that a spacer should have moved.

    Args:
        tool: Of the arm.
        printed: Table 1's, with the arm's own lengths.
        spacer: Sum of the spacers [m].

    Raises:
        InputError: Such a tool point.
    """
    away = tool.position - printed.position
    if float(np.linalg.norm(away)) > FARTHEST_TOOL:
        point = ", ".join(f"{x:g}" for x in printed.position)
        expected = f"a point within {FARTHEST_TOOL:g} m of Table 1's ({point})"
        raise InputError("tool.position", tool.position.tolist(), expected)

    # Table 1's point on the wrist axis, not moved, or by a shorter spacer of before.
    on_axis = np.abs(away[:2]).max() <= _SAME_POINT
    if on_axis and -spacer + _SAME_POINT < away[2] <= _SAME_POINT:
        moved = ", ".join(f"{x:g}" for x in printed.position - [0.0, 0.0, spacer])
        expected = (
            f"a point beyond the spacer of {spacer:g} m, which moves Table 1's to "
            f"({moved}); that is the tool if none is given"
        )
        raise InputError("tool.position", tool.position.tolist(), expected)


def check_inside(name: str, com: FloatArray, bounds: FloatArray) -> None:
    """Warn of a COM outside a body, and refuse one that no body of the arm can have.

    Args:
        name: Of the COM, for the message.
        com: (3,) [m].
        bounds: Outer bounds of the body, (3, 2) [m].

    Raises:
        InputError: It is farther off than any body is long; the message suggests mm if
            it would be inside then.

    Warns:
        ImplausibleWarning: It is outside. Models of real arms have such COMs.
    """

    def is_inside(point: FloatArray) -> bool:
        return bool(((bounds[:, 0] <= point) & (point <= bounds[:, 1])).all())

    if is_inside(com):
        return
    expected = f"a point inside the body's bounds, {bounds.tolist()} m"
    if np.abs(com).max() <= _LONGEST_BODY:
        warn(f"{name}: expected {expected}, got {com.tolist()}")
        return
    if is_inside(com / 1000):
        expected += "; is it in mm?"
    raise InputError(name, com.tolist(), expected)


def warn_of_oddities(own: Any, printed: Any, given: AbstractSet[str]) -> None:
    """Warn of values that are far from the printed ones, or contradict each other.

    Args:
        own: The arm of a file, an `Alpha5Parameters`.
        printed: The catalogue's.
        given: Keys of the values in the file.

    Warns:
        ImplausibleWarning: Each of them, with its key.
    """
    _lengths_and_zeros(own, printed)
    for joint, published in zip(own.joints, printed.joints, strict=True):
        _limits(joint, published)
    half_widths = {one.key: one.half_width for one in own.measurements}
    for link, published_link in zip(own.links, printed.links, strict=True):
        if any(key.startswith(f"links.{link.name}.") for key in given):
            cob = f"links.{link.name}.cob"
            _link(link, published_link, given, half_widths.get(cob) or 0.0)
    for body in own.attached:
        if body.mass and not body.volume:
            key = f"attached.{body.name}.volume"
            warn(f"{key}: not given, so the body displaces no water")


def _lengths_and_zeros(own: Any, printed: Any) -> None:
    """Warn of lengths and zeros far from the printed ones."""
    for name, (i, field) in LENGTHS.items():
        length = getattr(own.dh[i], field)
        published = getattr(printed.dh[i], field)
        if abs(length - published) > _LENGTH:
            off = abs(length - published) * 1e3
            warn(f"lengths.{name}: {length:g} m is {off:.0f} mm off the printed one")

    for name, row, published_row in zip(
        JOINT_NAMES[:4], own.dh, printed.dh, strict=False
    ):
        zero = row.theta_offset - published_row.theta_offset
        if abs(zero) > _ZERO:
            warn(f"zeros.{name}: {zero:.4g} rad is more than 10 deg off the printed 0")


def _limits(joint: Any, published: Any) -> None:
    """Warn of limits beyond the published ones."""
    unit = "rad" if joint.kind == "revolute" else "m"
    key = f"joint_limits.{joint.name}"
    span = f"beyond the published {published.lower:g} to {published.upper:g} {unit}"
    if joint.lower < published.lower:
        warn(f"{key}.min_position: {joint.lower:g} {unit} is {span}")
    if joint.upper > published.upper:
        warn(f"{key}.max_position: {joint.upper:g} {unit} is {span}")
    if joint.velocity > published.velocity:
        rated = f"faster than the rated {published.velocity:.4g} {unit}/s"
        warn(f"{key}.max_velocity: {joint.velocity:.4g} {unit}/s is {rated}")


def _link(
    link: Any,
    published: Any,
    given: AbstractSet[str],
    half_width: float,
) -> None:
    """Warn of a body that does not fit its bounds, or its own inertia."""
    key = f"links.{link.name}"
    ratio = link.mass / published.mass
    if abs(ratio - 1) > _MASS and f"{key}.inertia" not in given:
        remedy = f"give an inertia too, for example the printed one times {ratio:.3g}"
        warn(f"{key}.mass: {link.mass:g} kg with the printed inertia; {remedy}")

    # Link 1 as printed spreads beyond its bounds already. Of a COM that is outside the
    # record warns.
    if not excess_of_box(link.com, link.bounds) and not inconsistencies(
        published.mass, published.com, published.inertia, published.bounds
    ):
        for problem in inconsistencies(link.mass, link.com, link.inertia, link.bounds):
            warn(f"{key}: {problem}")
    # Link 3's as printed is outside already.
    outside = excess_of_box(link.cob, link.bounds)
    printed = excess_of_box(published.cob, published.bounds)
    if outside > printed + half_width:
        at = ", ".join(f"{x:g}" for x in link.cob)
        warn(f"{key}.cob: ({at}) m is outside the body's bounds")
