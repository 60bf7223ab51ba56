"""What is wrong with axes, limits, mount, files and bodies, what it costs, what to write instead."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, rotation_about, wrap
from alpha5_model.description.reading import UrdfRobot
from alpha5_model.numbers.inertia import inconsistencies, rotate_tensor
from alpha5_model.numbers.parameters import LinkParameters, parameters
from alpha5_model.proofs.comparison import alignment as aligned
from alpha5_model.proofs.comparison import diagnosis, reading
from alpha5_model.proofs.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    Alignment,
    allowed,
)
from alpha5_model.proofs.comparison.arm import (
    FourJointArm,
    Z,
    carried,
    our_arm,
    our_tips,
    with_dimensions,
)
from alpha5_model.proofs.comparison.correction import (
    LEVER,
    LIMIT_TOLERANCE,
    JointCorrection,
    angle_between,
    in_degrees,
    joint_corrections,
    our_tool,
    tool_correction,
    tool_pose,
)
from alpha5_model.proofs.comparison.diagnosis import Inertial
from alpha5_model.proofs.comparison.records import BodyDifference, Finding

FINDINGS: Any = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: The collar of the jaws begins this far from axis_c, by the manufacturer's CAD; a tool frame between
#: it and the finger tips, this close to the axis and with axes this close to ours, is a choice.
JAWS_FROM, BESIDE, TURNED = 0.13275, 0.002, math.radians(0.5)  # [m], [m], [rad]
#: Of Table 3's whole volume; its digits allow 5 * 0.5 mL of 573 mL.
VOLUME_TOLERANCE = 5e-3
#: A COM of link_0 this close to ours settles the zero of axis_e.
SAME_COM = 1e-3  # [m]
#: What still agrees with the tables, as a model may print fewer digits: of the mass; [m]; of the
#: largest moment.
MASS_TOLERANCE, COM_TOLERANCE, INERTIA_TOLERANCE = 1e-3, 1e-4, 5e-3
#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]

#: What an error of a body's mass [kg] and first moment (3,) [kg m] is worth in gravity torque
#: [N m].
Cost = Callable[[int, float, FloatArray], float]


def finding(key: str, where: str = "", cost: float = 0.0, /, **words: Any) -> Finding:
    """A finding in the words of ``findings.toml``, under ``topic`` or ``topic.subject``."""
    topic, _, subject = key.partition(".")
    text = {
        "where": where,
        **FINDINGS[topic],
        **FINDINGS[topic].get(subject, {}),
        **words,
    }
    said, instead = (text.get(k, "").format_map(text) for k in ("text", "instead"))
    return Finding(text["where"], said, text.get("serious", True), cost, instead)


def all_findings(
    other: UrdfRobot,
    theirs: FourJointArm,
    written: FourJointArm,
    alignment: Alignment,
    bodies: tuple[BodyDifference, ...],
    folder: Path | None,
    q: FloatArray,
) -> Iterator[Finding]:
    """Everything that is wrong or odd, from the base on.

    Args:
        other: The other model as read.
        theirs, written: Its arm as meant, with exact multiples of pi, and as written.
        alignment: Of theirs.
        bodies: The bodies compared with the tables.
        folder: Where its meshes are, if it has one.
        q: Our joint positions, (N, 4), at which costs are taken [rad].
    """
    corrections = joint_corrections(written, theirs, alignment)
    lines = [correction.text for correction in corrections]
    axes = [*_shoulder(theirs, alignment, lines)]
    axes += _zeros(theirs, alignment, q, lines)
    axes += _dimensions(theirs, alignment, q, lines)
    tool = [tool_correction(other, theirs, alignment)] if theirs.tool else []
    axes += _tool(theirs, alignment, tool)
    rest = [
        one
        for one in (*corrections, *tool)
        if not any(one.text in found.instead for found in axes)
    ]
    yield from _mount(other, theirs, alignment)
    yield from axes
    yield from _rest(theirs, written, alignment, q, rest)
    yield from _limits(corrections, alignment)
    yield from _mimics(other)
    transforms = aligned.body_transforms(theirs, alignment)
    mended = aligned.mended_transforms(theirs, alignment)
    mended_com = carried(theirs, mended)[1]
    regressor = our_arm().gravity_regressor(q)

    def cost(body: int, mass: float, moment: FloatArray) -> float:
        # no joint carries the base: it costs nothing
        return (
            float(np.abs(regressor[:, :, body - 1] @ [mass, *moment]).max())
            if body
            else 0.0
        )

    def seen(body: BodyDifference, transform: FloatArray) -> list[Inertial]:
        placed = [
            (other.links[n], transform @ theirs.link_poses[n]) for n in body.links
        ]
        return [
            Inertial(x.name, x.mass or 0.0, x.com, x.inertia, pose)
            for x, pose in placed
        ]

    for i, body in enumerate(bodies):
        by_link = seen(body, transforms[i])
        # on a root, nothing is what KDL wants
        links = [name for name in body.links if name != other.root or not body.mass]
        bare = [name for name in links if other.links[name].mass is None]
        instead = (
            _instead(body.ours, seen(body, mended[i])) if by_link else ("", "", "")
        )
        found = list(_of_body(i, body, by_link, instead, bare, cost))
        yield from found
        off = float(np.linalg.norm(mended_com[i] - body.ours.com))
        if (
            body.mass
            and off > COM_TOLERANCE
            and not any("<origin" in f.instead for f in found)
        ):
            yield finding("digits.of_body", body.name, off=off * 1e3, line=instead[1])
    yield from _files(other, theirs, folder)


def _mount(
    other: UrdfRobot, theirs: FourJointArm, alignment: Alignment
) -> Iterator[Finding]:
    shift, rotation = alignment.base[:3, 3], alignment.base[:3, :3]
    angle = math.acos(float(np.clip((np.trace(rotation) - 1) / 2, -1, 1)))
    mount = theirs.link_poses[alignment.base_link]
    at_base = alignment.same_base and np.allclose(
        mount, np.eye(4), atol=LENGTH_TOLERANCE
    )
    elsewhere = np.linalg.norm(shift) > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE
    if elsewhere and not at_base:
        words = dict(zip("xyz", shift * 1e3, strict=True), turned=math.degrees(angle))
        yield finding(
            "mount" if alignment.same_base else "mount.or_zero",
            root=other.root,
            **words,
        )
    masses = {name: mass for name in theirs.carried if (mass := other.links[name].mass)}
    if total := sum(masses.values()):
        heavy = sorted(masses, key=lambda n: -masses[n])
        names = ", ".join(f"{n} ({masses[n]:.5g} kg)" for n in heavy[:3])
        names += (
            f" and {len(heavy) - 3} more, {total:.5g} kg in all"
            if len(heavy) > 3
            else ""
        )
        excess = total + theirs.mass[0] - parameters().links[0].mass
        yield finding("carried", names=names, excess=excess)


def _shoulder(
    theirs: FourJointArm, alignment: Alignment, lines: Sequence[str]
) -> Iterator[Finding]:
    """Where the link that was meant to be base_link stands below the shoulder."""
    if not alignment.same_base:
        return
    length, angle = allowed(theirs, short_pi=True)
    (x, y, z), link = alignment.stands[:3, 3] * 1e3, alignment.base_link
    beside = math.hypot(x, y)
    tilt = math.acos(np.clip(alignment.stands[2, 2], -1.0, 1.0))
    instead = "; ".join(filter(None, lines[:2]))
    if beside > length * 1e3 or tilt > angle:
        words = {"link": link, "tilt": math.degrees(tilt), "line": instead}
        yield finding("beside", beside=beside, **words)
    elif abs(z) > length * 1e3:
        d = parameters().dh[0].d * 1e3
        words = {"link": link, "way": "lower" if z < 0 else "higher", "line": instead}
        yield finding("height", d=d, above=d - z, off=abs(z), **words)


def _torque_change(arm: FourJointArm, there: FloatArray, q: FloatArray) -> float:
    """How far an arm's gravity torques in air are at most from ours, at its and our q [N m]."""
    return float(np.abs(arm.gravity_torque(there) - our_arm().gravity_torque(q)).max())


def _zeros(
    theirs: FourJointArm, alignment: Alignment, q: FloatArray, lines: Sequence[str]
) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)[1]
    for j, axis in enumerate(reading.AXES):
        here, zero = np.arange(4) == j, float(alignment.zero[j])
        if alignment.sign[j] < 0:
            cost = round(_torque_change(our_arm(), np.where(here, -q, q), q), 9)
            yield finding("reversed", axis, cost, line=lines[j])
        if abs(zero) <= within:
            continue
        name, words = "zero", {"line": lines[j], "shift": math.degrees(zero)}
        if j in (1, 2):
            name, words["fit"] = "zero.fitted", _fit(alignment)
            words["without"] = aligned.without_zero(theirs, alignment, j) * 1e3
        elif j == 0 and not _base_is_known(theirs, alignment):
            name = "zero.or_base"
        cost = round(_torque_change(our_arm(), q - alignment.sign * zero * here, q), 9)
        yield finding(name, axis, cost, **words)


def _base_is_known(theirs: FourJointArm, alignment: Alignment) -> bool:
    """Whether link_0 fits to the base frame far better than to one that is turned by the zero."""
    com = aligned.bodies_in_our_frames(theirs, alignment)[0][0]
    turned = rotation_about(Z, alignment.sign[0] * alignment.zero[0]) @ com
    here, there = (float(np.linalg.norm(at - our_arm().com[0])) for at in (com, turned))
    return bool(theirs.mass[0]) and (here < SAME_COM or 3 * here < there)


def _dimensions(
    theirs: FourJointArm, alignment: Alignment, q: FloatArray, lines: Sequence[str]
) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)
    for k, (name, change) in enumerate(
        zip(aligned.DIMENSIONS, alignment.dimensions, strict=True)
    ):
        if abs(change) <= within[k >= 4]:
            continue
        only = np.where(np.arange(len(aligned.DIMENSIONS)) == k, change, 0.0)
        off = np.linalg.norm(our_tips(q, only) - our_tips(q), axis=1).max() * 1e3
        kind, _, index = name.partition("_")
        scale, unit = (1e3, "mm") if k < 4 else (180 / math.pi, "deg")
        ours = getattr(parameters().dh[int(index)], kind, 0.0) * scale
        seen = ours + change * scale
        if k >= 4:
            seen = float(wrap(math.radians(seen), math.radians(ours)) * scale)
        words = {"theirs": seen, "ours": ours, "unit": unit, "off": off}
        cost = _torque_change(with_dimensions(only), q, q)
        yield finding(
            f"dimension.{name}", "", cost, line=lines[int(index) + 1], **words
        )


def _rest(
    theirs: FourJointArm,
    written: FourJointArm,
    alignment: Alignment,
    q: FloatArray,
    rest: Sequence[JointCorrection],
) -> Iterator[Finding]:
    """What the number of printed digits does, and joints that no other finding mends.

    Args:
        rest: Of the joints that no other finding mends.
    """
    length, angle = allowed(theirs, short_pi=True)
    moved = [one for one in rest if one.off > LENGTH_TOLERANCE]
    for one in [one for one in moved if one.off > 3 * (length + LEVER * angle)]:
        moved.remove(one)
        axis = one.ours.name if one.ours else "tool"
        yield finding("misplaced", axis, off=one.off * 1e3, line=one.text)
    instead = "; ".join(one.text for one in moved)

    there = alignment.theirs(q)
    tips = (arm.poses(there)[:, 4, :3, 3] for arm in (theirs, written))
    off = float(np.linalg.norm(np.subtract(*tips), axis=1).max())
    if off > LENGTH_TOLERANCE:
        yield finding("digits.of_pi", off=off * 1e3, line=instead)
    pairs = zip(reading.AXES[1:3], alignment.zero[1:3], strict=True)
    seen = [
        (axis, math.degrees(x))
        for axis, x in pairs
        if ANGLE_TOLERANCE < abs(x) <= angle
    ]
    zeros = "".join(f", zero of {axis} {zero:.2f} deg" for axis, zero in seen)
    if (
        alignment.residual[0] > LENGTH_TOLERANCE
        or zeros
        or (moved and off <= LENGTH_TOLERANCE)
    ):
        words = {"length": length * 1e3, "angle": math.degrees(angle), "zeros": zeros}
        line = "" if off > LENGTH_TOLERANCE else instead
        yield finding("digits", fit=_fit(alignment), line=line, **words)


def _tool(
    theirs: FourJointArm, alignment: Alignment, corrections: Sequence[JointCorrection]
) -> Iterator[Finding]:
    """Where the frame of their tool stands in link_4, if they have one.

    Args:
        corrections: Of the joint that carries it, if there is one.
    """
    if not corrections:
        return
    ours, seen = our_tool(), tool_pose(theirs, alignment)
    relative = np.linalg.inv(ours) @ seen
    off, turned = float(np.linalg.norm(relative[:3, 3])), angle_between(ours, seen)
    length, angle = allowed(theirs, short_pi=True)
    if off <= length and turned <= angle:
        return
    at = seen[:3, 3]
    # Another point of the gripper, and axes that are named otherwise, are a choice.
    ends = parameters().links[4].bounds[2, 0], -JAWS_FROM
    on_gripper = math.hypot(*at[:2]) < BESIDE + length and ends[0] <= at[2] <= ends[1]
    choice = (on_gripper or off <= length) and _axes_are_a_choice(seen, TURNED + angle)
    words = {"x": at[0] * 1e3, "y": at[1] * 1e3, "z": at[2] * 1e3, "frame": theirs.tool}
    yield finding(
        "tool.choice" if choice else "tool",
        off=off * 1e3,
        turned=math.degrees(turned),
        line=corrections[0].text,
        **words,
    )


def _fit(alignment: Alignment) -> FloatArray:
    """What is left between the axes, [mm] and [deg] rms."""
    return np.multiply(alignment.residual, (1e3, 180 / math.pi))


def _axes_are_a_choice(tool: FloatArray, within: float) -> bool:
    """Whether one axis of a frame in link_4 lies along the wrist, at a roll of n * 30 deg."""
    along = np.abs(tool[2, :3])
    axis = int(along.argmax())
    other = tool[:3, (axis + 1) % 3]
    roll = math.atan2(other[1], other[0])
    step = math.radians(30)
    straight = math.acos(min(1.0, float(along[axis]))) < within
    return straight and abs(roll - step * round(roll / step)) < within


def _limits(
    corrections: Sequence[JointCorrection], alignment: Alignment
) -> Iterator[Finding]:
    for one, sign, zero in zip(
        corrections, alignment.sign, alignment.zero, strict=True
    ):
        joint, ours = one.joint, one.ours
        if ours is None:
            continue
        words: dict[str, Any] = {"line": one.text}
        lower, upper = joint.lower, joint.upper
        if in_degrees(joint.velocity, ours.velocity):
            words |= {"theirs": joint.velocity, "ours": math.degrees(ours.velocity)}
            yield finding("limits.velocity_in_degrees", ours.name, **words)
        if lower is None or upper is None:
            yield finding("limits.none", ours.name, **words)
            continue
        if in_degrees(upper - lower, ours.upper - ours.lower):
            words |= {
                "theirs": (lower, upper),
                "ours": np.degrees([ours.lower, ours.upper]),
            }
            yield finding("limits.in_degrees", ours.name, **words)
            continue
        printed = np.array([ours.lower, ours.upper])
        ends = np.sort(sign * (np.array([lower, upper]) - zero))
        # Their range lies within a turn of ours, whatever turn its zero was counted in.
        ends = ends + float(wrap(ends.mean(), printed.mean()) - ends.mean())
        if np.abs(ends - printed).max() > LIMIT_TOLERANCE:
            words |= {"theirs": np.degrees(ends), "ours": np.degrees(printed)}
            yield finding("limits", ours.name, **words)


def _mimics(other: UrdfRobot) -> Iterator[Finding]:
    """Joints that their leader drives beyond their own limits."""
    advised: dict[str, FloatArray] = {}
    for joint in other.joints.values():
        leader = other.joints.get(joint.mimic or "")
        if leader is None or None in (
            leader.lower,
            leader.upper,
            joint.lower,
            joint.upper,
        ):
            continue
        travel = advised.get(leader.name, np.array([leader.lower, leader.upper], float))
        low, high = np.sort(joint.multiplier * travel + joint.offset)
        beyond = max((joint.lower or 0.0) - low, high - (joint.upper or 0.0))
        if beyond > ANGLE_TOLERANCE:
            advised[joint.name] = np.array([low, high])
            words = {
                "leader": leader.name,
                "joint": joint.name,
                "low": low,
                "high": high,
            }
            yield finding("mimic", joint.name, beyond=beyond, **words)


def _files(
    other: UrdfRobot, theirs: FourJointArm, folder: Path | None
) -> Iterator[Finding]:
    """What does not count, or is missing, in its collision shapes and files: remarks only."""
    if meshes := sum(
        len(other.links[name].meshes) for names in theirs.links for name in names
    ):
        yield finding("volume.meshes", meshes=meshes)
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    printed, volume = sum(link.volume for link in parameters().links), theirs.volume
    near = VOLUME_TOLERANCE * printed
    if volume and all(
        abs(volume - ours) > near for ours in (printed, our_arm().volume)
    ):
        yield finding("volume", theirs=volume * 1e3, ours=printed * 1e3)
    for name in sorted({file for link in other.links.values() for file in link.files}):
        if folder and "://" not in name and not (folder / name).is_file():
            yield finding("file", name)


def _of_body(
    index: int,
    body: BodyDifference,
    written: list[Inertial],
    instead: tuple[str, str, str],
    bare: list[str],
    cost: Cost,
) -> Iterator[Finding]:
    link, name = body.ours, body.name
    mass_cost = cost(index, body.mass_error, body.mass_error * link.com)
    yield from _dummies(name, written)
    if not written:
        yield finding("body.missing", name, mass_cost)
        return
    mass, com, inertia = instead
    why = partial(diagnosis.reason, link, written)
    if body.mass == 0.0:
        everything = mass if mass == com else f"{mass} {com.partition(': ')[2]}"
        words = {"links": ", ".join(bare), "ours": link.mass, "everything": everything}
        key = "body.without_inertial" if bare else "body.without_mass"
        yield finding(key, name, mass_cost, tag=mass, **words)
        return
    if bare:
        yield finding("body.partly", name, links=", ".join(bare))
    wrong_mass = abs(body.mass_error) > MASS_TOLERANCE * link.mass
    if wrong_mass:
        reason = why(diagnosis.explain_mass)
        twice = ": the jaws are counted twice" * (
            index == 4 and "; beside it" in reason
        )
        reason = (reason or f" ({body.mass / link.mass:.3g} times)") + twice
        words = {"mass": body.mass, "ours": link.mass, "reason": reason}
        yield finding("body.mass", name, mass_cost, tag=mass, **words)
    wrong_com = body.com_error > COM_TOLERANCE + body.slack
    if wrong_com:
        key = "body.com_beyond" if index == 4 and body.com[2] > 0 else "body.com"
        com_cost = cost(index, 0.0, link.mass * (body.com - link.com))
        words = {"reason": why(diagnosis.explain_com), "z": body.com[2] * 1e3}
        yield finding(key, name, com_cost, tag=com, off=body.com_error * 1e3, **words)
    wrong_inertia = body.inertia_error > INERTIA_TOLERANCE * np.abs(link.inertia).max()
    if wrong_inertia:
        guess = diagnosis.explain_guess(link, written)
        reason = why(diagnosis.explain_inertia) or (f": {guess}" if guess else "")
        times = np.diag(body.inertia) / np.diag(link.inertia)
        key = "body.inertia_of_wrist" if index == 4 else "body.inertia"
        yield finding(key, name, tag=inertia, times=times, reason=reason)
    if wrong_mass or wrong_com or wrong_inertia:
        # Table 2 itself breaks one body's bounds: the other model is not asked to keep those.
        own = inconsistencies(link.mass, link.com, link.inertia, link.bounds)
        bounds = None if own else link.bounds
        for problem in inconsistencies(body.mass, body.com, body.inertia, bounds):
            yield finding("body.impossible", name, problem=problem)


def _dummies(name: str, written: list[Inertial]) -> Iterator[Finding]:
    """Links with an inertia that is far too large for their mass, alike ones together."""
    alike: dict[tuple[float, float], list[str]] = {}
    for w in written:
        largest = float(np.abs(w.inertia).max())
        if w.mass > 0 and largest / w.mass > REACH**2:
            alike.setdefault((w.mass, largest), []).append(w.link)
    for (mass, largest), links in alike.items():
        # a body with a mass of its own needs its tensor, not none: that is another finding
        key = "dummy" if mass <= diagnosis.TOKEN_MASS else "dummy.heavy"
        words = {
            "links": ", ".join(links),
            "s": "s" * (len(links) > 1),
            "grams": mass * 1e3,
        }
        words |= {"have": "have" if len(links) > 1 else "has", "inertia": largest}
        yield finding(key, name, radius=math.sqrt(largest / mass), **words)


def _instead(link: LinkParameters, written: list[Inertial]) -> tuple[str, str, str]:
    """Mass, COM and tensor of Table 2 as URDF, in the frame of the other model's heaviest link.

    Each is whole: the COM comes with the tensor, whose axes its origin turns, and everything with
    everything if other links of the body have a mass.
    """
    main = max(written, key=lambda w: abs(w.mass))
    rest = [w.link for w in written if w is not main and w.mass]
    back = np.asarray(np.linalg.inv(main.pose), np.float64)
    # Table 2 prints 1e-6 m and 1e-9 kg m^2; a frame written with fewer digits adds noise beyond.
    xyz = " ".join(f"{x + 0.0:.6g}" for x in moved(back, link.com).round(6))
    tensor = rotate_tensor(back[:3, :3], link.inertia).round(9) + 0.0
    upper = zip(*np.triu_indices(3), strict=True)
    entries = " ".join(f'i{"xyz"[i]}{"xyz"[j]}="{tensor[i, j]:.6g}"' for i, j in upper)
    mass = f'<mass value="{link.mass:g}"/>'
    placed = f'<origin xyz="{xyz}" rpy="0 0 0"/> <inertia {entries}/>'
    if rest:
        everything = f"{main.link}: {mass} {placed} (nothing in {', '.join(rest)})"
        return everything, everything, everything
    return f"{main.link}: {mass}", f"{main.link}: {placed}", f"{main.link}: {placed}"
