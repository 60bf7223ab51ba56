"""What differs in axes, limits, mount and files, what that costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.alignment import (
    ANGLE_TOLERANCE,
    DIMENSIONS,
    LENGTH_TOLERANCE,
    Alignment,
    allowed,
    bodies_in_our_frames,
    their_tips,
    without_zero,
)
from alpha5_model.comparison.arm import FourJointArm, our_arm, our_tips, with_dimensions
from alpha5_model.comparison.reading import AXES
from alpha5_model.comparison.records import Finding, finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.parameters import parameters
from alpha5_model.spatial import rotation_about, rpy_from_rotation, wrap

#: Limits are printed here to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)
#: Of Table 3's whole volume; its digits allow 5 * 0.5 mL of 573 mL.
VOLUME_TOLERANCE = 5e-3
#: A COM of link_0 this close to ours settles the zero of axis_e.
SAME_COM = 1e-3  # [m]


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
        words = dict(zip("xyz", shift * 1e3, strict=True), turned=math.degrees(angle))
        yield finding("mount" if alignment.same_base else "mount.or_zero", root=other.root, **words)
    masses = {name: mass for name in theirs.carried if (mass := other.links[name].mass)}
    if total := sum(masses.values()):
        heavy = sorted(masses, key=lambda n: -masses[n])
        names = ", ".join(f"{n} ({masses[n]:.5g} kg)" for n in heavy[:3])
        names += f" and {len(heavy) - 3} more, {total:.5g} kg in all" if len(heavy) > 3 else ""
        excess = total + theirs.mass[0] - parameters().links[0].mass
        yield finding("carried", names=names, excess=excess)


def _shoulder(theirs: FourJointArm, alignment: Alignment) -> Iterator[Finding]:
    """Where the link that was meant to be base_link stands below the shoulder."""
    if not alignment.same_base:
        return
    length, angle = allowed(theirs, short_pi=True)
    (x, y, z), link = alignment.stands[:3, 3] * 1e3, alignment.base_link
    beside, tilt = math.hypot(x, y), math.acos(min(1.0, alignment.stands[2, 2]))
    if abs(z) > length * 1e3:
        d, joint = parameters().dh[0].d * 1e3, theirs.joints[1].name
        words = {"link": link, "joint": joint, "way": "lower" if z < 0 else "higher"}
        yield finding("height", d=d, above=d - z, off=abs(z), **words)
    if beside > length * 1e3 or tilt > angle:
        yield finding("beside", beside=beside, link=link, tilt=math.degrees(tilt))


def _torque_change(arm: FourJointArm, there: FloatArray, q: FloatArray) -> float:
    """How far an arm's gravity torques in air are at most from ours, at its and our q [N m]."""
    return float(np.abs(arm.gravity_torque(there) - our_arm().gravity_torque(q)).max())


def _zeros(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)[1]
    for j, (axis, joint) in enumerate(zip(AXES, theirs.joints, strict=True)):
        here, zero = np.arange(4) == j, float(alignment.zero[j])
        if alignment.sign[j] < 0:
            cost = round(_torque_change(our_arm(), np.where(here, -q, q), q), 9)
            yield finding("reversed", axis, cost, joint=joint.name, axis=_numbers(-joint.axis))
        if abs(zero) <= within:
            continue
        name, words = "zero", {"joint": joint.name, "shift": math.degrees(zero)}
        if j in (1, 2):
            words |= {"fit": _fit(alignment), "without": without_zero(theirs, alignment, j) * 1e3}
            name = "zero.fitted"
        elif j == 0:
            com = bodies_in_our_frames(theirs, alignment)[0][0]
            if np.linalg.norm(com - our_arm().com[0]) >= SAME_COM:
                name = "zero.or_base"
        turned = joint.transform[:3, :3] @ rotation_about(joint.axis, zero)
        words["xyz"] = _numbers(joint.transform[:3, 3])
        words["rpy"] = _numbers(rpy_from_rotation(turned))
        cost = round(_torque_change(our_arm(), q - alignment.sign * zero * here, q), 9)
        yield finding(name, axis, cost, **words)


def _dimensions(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)
    for k, (name, change) in enumerate(zip(DIMENSIONS, alignment.dimensions, strict=True)):
        if abs(change) <= within[k >= 4]:
            continue
        only = np.where(np.arange(len(DIMENSIONS)) == k, change, 0.0)
        off = np.linalg.norm(our_tips(q, only) - our_tips(q), axis=1).max() * 1e3
        kind, _, index = name.partition("_")
        scale, unit = (1e3, "mm") if k < 4 else (180 / math.pi, "deg")
        ours = getattr(parameters().dh[int(index)], kind, 0.0) * scale
        words = {"theirs": ours + change * scale, "ours": ours, "unit": unit, "off": off}
        cost = _torque_change(with_dimensions(only), q, q)
        yield finding(f"dimension.{name}", "", cost, name=name, **words)


def _digits(
    theirs: FourJointArm, written: FourJointArm, alignment: Alignment, q: FloatArray
) -> Iterator[Finding]:
    """What the number of printed digits does to the axes: remarks only."""
    apart = their_tips(theirs, alignment, q) - their_tips(written, alignment, q)
    if (off := float(np.linalg.norm(apart, axis=1).max())) > LENGTH_TOLERANCE:
        yield finding("digits.of_pi", off=off * 1e3)
    length, angle = allowed(theirs, short_pi=True)
    zeros = "".join(
        f", zero of {axis} {math.degrees(zero):.2f} deg"
        for axis, zero in zip(AXES[1:3], alignment.zero[1:3], strict=True)
        if ANGLE_TOLERANCE < abs(zero) <= angle
    )
    if alignment.residual[0] > LENGTH_TOLERANCE or zeros:
        words = {"length": length * 1e3, "angle": math.degrees(angle), "zeros": zeros}
        yield finding("digits", fit=_fit(alignment), **words)


def _fit(alignment: Alignment) -> FloatArray:
    """What is left between the axes, [mm] and [deg] rms."""
    return np.multiply(alignment.residual, (1e3, 180 / math.pi))


def _numbers(values: ArrayLike) -> str:
    return " ".join(f"{x + 0.0:.7g}" for x in np.round(np.asarray(values), 7))


def _limits(theirs: FourJointArm, alignment: Alignment) -> Iterator[Finding]:
    rows = zip(parameters().joints, theirs.joints, alignment.sign, alignment.zero, strict=False)
    for ours, joint, sign, zero in rows:
        name, words = "limits.none", {}
        printed = np.array([ours.lower, ours.upper])
        meant = np.sort(zero + sign * printed)
        if joint.lower is not None and joint.upper is not None:
            ends = np.sort(sign * (np.array([joint.lower, joint.upper]) - zero))
            # Their range lies within a turn of ours, whatever turn its zero was counted in.
            turns = float(wrap(ends.mean(), printed.mean()) - ends.mean())
            ends, meant = ends + turns, meant - sign * turns
            if np.abs(ends - printed).max() <= LIMIT_TOLERANCE:
                continue
            values = np.degrees([*ends, *printed])
            name, words = (
                "limits",
                dict(zip(("first", "last", "lower", "upper"), values, strict=True)),
            )
        yield finding(name, ours.name, joint=joint.name, low=meant[0], high=meant[1], **words)


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
            words = {"leader": leader.name, "joint": joint.name, "low": low, "high": high}
            yield finding("mimic", joint.name, beyond=beyond, **words)


def file_findings(other: UrdfRobot, theirs: FourJointArm, folder: Path | None) -> Iterator[Finding]:
    """What does not count, or is missing, in its collision shapes and files: remarks only."""
    if meshes := sum(len(other.links[name].meshes) for names in theirs.links for name in names):
        yield finding("volume.meshes", meshes=meshes)
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    printed, volume = sum(link.volume for link in parameters().links), theirs.volume
    near = VOLUME_TOLERANCE * printed
    if volume and all(abs(volume - ours) > near for ours in (printed, our_arm().volume)):
        yield finding("volume", theirs=volume * 1e3, ours=printed * 1e3)
    for name in sorted({file for link in other.links.values() for file in link.files}):
        if folder and "://" not in name and not (folder / name).is_file():
            yield finding("file", name)
