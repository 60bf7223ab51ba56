"""What differs in axes, limits and mount, what that costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    allowed,
    bodies_in_our_frames,
    their_tips,
    without_zero,
)
from alpha5_model.comparison.arm import FourJointArm, our_arm, our_tips, with_dimensions
from alpha5_model.comparison.reading import AXES
from alpha5_model.comparison.records import DIMENSIONS, Alignment, Finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.parameters import parameters
from alpha5_model.spatial import rotation_about, rpy_from_rotation, wrap

#: Limits are printed here to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)
#: A COM of link_0 this close to ours settles the zero of axis_e.
SAME_COM = 1e-3  # [m]
#: Dimension -> the axis that lies elsewhere by it, and what it is.
DIMENSION_WORDS = {
    "a_0": ("axis_d", "from axis_e"),
    "a_1": ("axis_c", "from axis_d"),
    "a_2": ("axis_b", "from axis_c"),
    "d_1": ("axis_c", "beside the plane of the arm"),
    "alpha_0": ("axis_d", "to axis_e"),
    "alpha_1": ("axis_c", "to axis_d, about the upper arm"),
    "alpha_2": ("axis_b", "to axis_c"),
    "beta_1": ("axis_c", "to axis_d, in the plane of the arm"),
}


def geometry_findings(
    other: UrdfRobot,
    theirs: FourJointArm,
    written: FourJointArm,
    alignment: Alignment,
    q: FloatArray,
) -> Iterator[Finding]:
    """Everything about frames, axes, zeros and limits.

    Args:
        other: The other model.
        theirs, written: Its arm as meant, with exact multiples of pi, and as written.
        alignment: Of theirs.
        q: Our joint positions, (N, 4), at which costs are taken [rad].
    """
    yield from _mount(other, theirs, alignment)
    yield from _shoulder(theirs, alignment)
    yield from _zeros(theirs, alignment, q)
    yield from _dimensions(theirs, alignment, q)
    yield from _digits(theirs, written, alignment, q)
    yield from _limits(theirs, alignment)
    yield from _mimics(other)


def _mount(other: UrdfRobot, theirs: FourJointArm, alignment: Alignment) -> Iterator[Finding]:
    shift, rotation = alignment.base[:3, 3], alignment.base[:3, :3]
    angle = math.acos(float(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
    mount = theirs.link_poses[alignment.base_link]
    at_base = alignment.same_base and np.allclose(mount, np.eye(4), atol=LENGTH_TOLERANCE)
    elsewhere = np.linalg.norm(shift) > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE
    if elsewhere and not at_base:
        x, y, z = shift * 1e3
        text = (
            f"its root {other.root} stands at ({x:z.2f}, {y:z.2f}, {z:z.2f}) mm in our base_link, turned by "
            f"{math.degrees(angle):.2f} deg: another mount"
        )
        text += "" if alignment.same_base else ", or for a yaw a shifted zero of axis_e"
        yield Finding("base", text, serious=False)
    masses = {name: other.links[name].mass or 0.0 for name in theirs.carried}
    if total := sum(masses.values()):
        heavy = sorted((n for n in masses if masses[n]), key=lambda n: -masses[n])
        names = ", ".join(f"{n} ({masses[n]:.5g} kg)" for n in heavy[:3])
        names += f" and {len(heavy) - 3} more, {total:.5g} kg in all" if len(heavy) > 3 else ""
        excess = total + theirs.mass[0] - parameters().links[0].mass
        text = (
            f"carried with the base and left out of link_0: {names}; with it link_0 would be "
            f"{excess:.1f} kg too heavy"
        )
        yield Finding("base", text, serious=False)


def _shoulder(theirs: FourJointArm, alignment: Alignment) -> Iterator[Finding]:
    """Where the link that was meant to be base_link stands below the shoulder."""
    if not alignment.same_base:
        return
    length, angle = allowed(theirs, short_pi=True)
    (x, y, z), link = alignment.stands[:3, 3] * 1e3, alignment.base_link
    beside, tilt = math.hypot(x, y), math.acos(min(1.0, alignment.stands[2, 2]))
    if abs(z) > length * 1e3:
        d, way = parameters().dh[0].d * 1e3, "lower" if z < 0 else "higher"
        text = (
            f"lies {d - z:.2f} mm above {link} where d_0 is {d:.2f} mm: the base stands {abs(z):.2f} mm "
            f"{way}, from here on the tip is up to {abs(z):.2f} mm off"
        )
        instead = f"{d:g} mm from {link} to the origin of {theirs.joints[1].name}"
        yield Finding("axis_d", text, instead=instead)
    if beside > length * 1e3 or tilt > angle:
        degrees = math.degrees(tilt)
        text = f"passes {beside:.2f} mm beside the origin of {link}, tilted by {degrees:.3f} deg"
        yield Finding("axis_e", text)


def _torque_change(torque: FloatArray, q: FloatArray) -> float:
    """How far gravity torques in air are at most from ours at q [N m]."""
    return float(np.abs(torque - our_arm().gravity_torque(q)).max())


def _zeros(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)[1]

    def worth(there: FloatArray) -> float:
        return round(_torque_change(our_arm().gravity_torque(there), q), 9)

    for j, (axis, joint) in enumerate(zip(AXES, theirs.joints, strict=True)):
        here, zero = np.arange(4) == j, float(alignment.zero[j])
        if alignment.sign[j] < 0:
            instead = f'{joint.name}: <axis xyz="{_numbers(-joint.axis)}"/> and its limits reversed'
            cost = worth(np.where(here, -q, q))
            yield Finding(axis, "turns the other way", cost=cost, instead=instead)
        if abs(zero) <= within:
            continue
        text, serious = f"its zero is shifted by {math.degrees(zero):.2f} deg", True
        if j in (1, 2):
            text += f" ({_fits(alignment)}; {without_zero(theirs, alignment, j) * 1e3:.2f} mm without it)"
        elif j == 0:
            com = bodies_in_our_frames(theirs, alignment)[0][0]
            serious = bool(np.linalg.norm(com - our_arm().com[0]) < SAME_COM)
            text += "" if serious else ", or else the base body stands turned: the axes cannot tell"
        turned = joint.transform[:3, :3] @ rotation_about(joint.axis, zero)
        xyz, rpy = _numbers(joint.transform[:3, 3]), _numbers(rpy_from_rotation(turned))
        instead = f'{joint.name}: <origin xyz="{xyz}" rpy="{rpy}"/>'
        yield Finding(axis, text, serious, worth(q - alignment.sign * zero * here), instead)


def _dimensions(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Iterator[Finding]:
    tips, within = our_tips(q), allowed(theirs, short_pi=True)
    for k, (name, change) in enumerate(zip(DIMENSIONS, alignment.dimensions, strict=True)):
        if abs(change) <= within[k >= 4]:
            continue
        axis, words = DIMENSION_WORDS[name]
        only = np.where(np.arange(len(DIMENSIONS)) == k, change, 0.0)
        off = np.linalg.norm(our_tips(q, only) - tips, axis=1).max() * 1e3
        kind, _, index = name.partition("_")
        scale, unit = (1e3, "mm") if k < 4 else (180 / math.pi, "deg")
        ours = getattr(parameters().dh[int(index)], kind, 0.0) * scale
        text = (
            f"stands {ours + change * scale:.2f} {unit} {words} where ours stands {ours:.2f} {unit}: "
            f"from here on the tip is up to {off:.2f} mm off"
        )
        cost = _torque_change(with_dimensions(only).gravity_torque(q), q)
        yield Finding(axis, text, cost=cost, instead=f"{name} = {ours:.6g} {unit}")


def _digits(
    theirs: FourJointArm, written: FourJointArm, alignment: Alignment, q: FloatArray
) -> Iterator[Finding]:
    """What the number of printed digits does to the axes: remarks only."""
    pairs = [their_tips(arm, alignment, q) for arm in (theirs, written)]
    if (off := float(np.linalg.norm(pairs[0] - pairs[1], axis=1).max())) > LENGTH_TOLERANCE:
        text = (
            f"multiples of pi are cut short: the tip lies up to {off * 1e3:.2f} mm beside what is "
            "meant; all that is said here is about what is meant"
        )
        yield Finding("digits", text, serious=False, instead="angles with 15 digits")
    length, angle = allowed(theirs, short_pi=True)
    zeros = "".join(
        f", zero of {axis} {math.degrees(zero):.2f} deg"
        for axis, zero in zip(AXES[1:3], alignment.zero[1:3], strict=True)
        if ANGLE_TOLERANCE < abs(zero) <= angle
    )
    if alignment.residual[0] > LENGTH_TOLERANCE or zeros:
        text = (
            f"the axes lie as ours within what the printed digits allow, {length * 1e3:.2g} mm and "
            f"{math.degrees(angle):.2g} deg: {_fits(alignment)}{zeros}"
        )
        yield Finding("digits", text, serious=False)


def _fits(alignment: Alignment) -> str:
    mm, deg = alignment.residual[0] * 1e3, math.degrees(alignment.residual[1])
    return f"residual {mm:.2f} mm, {deg:.4f} deg rms"


def _numbers(values: Sequence[float] | FloatArray) -> str:
    return " ".join(f"{x + 0.0:.7g}" for x in np.round(np.asarray(values), 7))


def _limits(theirs: FourJointArm, alignment: Alignment) -> Iterator[Finding]:
    rows = zip(parameters().joints, theirs.joints, alignment.sign, alignment.zero, strict=False)
    for ours, joint, sign, zero in rows:
        printed, text = np.array([ours.lower, ours.upper]), "has no limits"
        low, high = np.sort(zero + sign * printed)
        if joint.lower is not None and joint.upper is not None:
            ends = np.sort(sign * (np.array([joint.lower, joint.upper]) - zero))
            # Their range lies within a turn of ours, whatever turn its zero was counted in.
            turns = float(wrap(ends.mean(), printed.mean()) - ends.mean())
            ends, low, high = ends + turns, low - sign * turns, high - sign * turns
            if np.abs(ends - printed).max() <= LIMIT_TOLERANCE:
                continue
            (first, last), (lower, upper) = np.degrees(ends), np.degrees(printed)
            text = (
                f"range {first:z.1f} to {last:z.1f} deg in place of {lower:.1f} to {upper:.1f} deg"
            )
        instead = f'{joint.name}: <limit lower="{low:.5g}" upper="{high:.5g}"/>'
        yield Finding(ours.name, text, serious=False, instead=instead)


def _mimics(other: UrdfRobot) -> Iterator[Finding]:
    """Joints that their leader drives beyond their own limits."""
    for joint in other.joints.values():
        leader = other.joints.get(joint.mimic or "")
        if leader is None or None in (leader.lower, leader.upper, joint.lower, joint.upper):
            continue
        travel = np.array([leader.lower, leader.upper], float)
        low, high = np.sort(joint.multiplier * travel + joint.offset)
        beyond = max((joint.lower or 0.0) - low, high - (joint.upper or 0.0))
        if beyond > ANGLE_TOLERANCE:
            text = f"mimics {leader.name} {beyond:.4g} beyond its own limit"
            instead = f'{joint.name}: <limit lower="{low:.5g}" upper="{high:.5g}"/>'
            yield Finding(joint.name, text, instead=instead)
