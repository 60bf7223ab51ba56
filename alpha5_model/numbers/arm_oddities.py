"""Warnings of what is possible, but odd, in an arm of your own."""

from __future__ import annotations

import math
from collections.abc import Set as AbstractSet

from alpha5_model._support.spatial import excess_of_box
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.arm_schema import ZEROS
from alpha5_model.numbers.inertia import inconsistencies
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    LinkParameters,
)
from alpha5_model.numbers.plausibility import warn

#: Two arms of one kind do not differ by more: a length [m], a zero [rad].
_LENGTH = 0.02
_ZERO = math.radians(10)
#: A mass that is off by more makes an inertia of before wrong by as much.
_MASS = 0.2


def warn_of_oddities(
    own: Alpha5Parameters, printed: Alpha5Parameters, given: AbstractSet[str]
) -> None:
    """Warn of values that are far from the printed ones, or contradict each other.

    Args:
        own: The arm of a file.
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


def _lengths_and_zeros(own: Alpha5Parameters, printed: Alpha5Parameters) -> None:
    """Warn of lengths and zeros far from the printed ones."""
    for name, (i, field) in LENGTHS.items():
        length = getattr(own.dh[i], field)
        published = getattr(printed.dh[i], field)
        if abs(length - published) > _LENGTH:
            off = abs(length - published) * 1e3
            warn(f"lengths.{name}: {length:g} m is {off:.0f} mm off the printed one")

    for name, row, published_row in zip(ZEROS, own.dh, printed.dh, strict=False):
        zero = row.theta_offset - published_row.theta_offset
        if abs(zero) > _ZERO:
            warn(f"zeros.{name}: {zero:.4g} rad is more than 10 deg off the printed 0")


def _limits(joint: JointParameters, published: JointParameters) -> None:
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
    link: LinkParameters,
    published: LinkParameters,
    given: AbstractSet[str],
    half_width: float,
) -> None:
    """Warn of a body that does not fit its bounds, or its own inertia."""
    key = f"links.{link.name}"
    ratio = link.mass / published.mass
    if abs(ratio - 1) > _MASS and f"{key}.inertia" not in given:
        remedy = f"give an inertia too, for example the printed one times {ratio:.3g}"
        warn(f"{key}.mass: {link.mass:g} kg with the printed inertia; {remedy}")

    # Link 1 as printed spreads beyond its bounds already.
    if not inconsistencies(
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
