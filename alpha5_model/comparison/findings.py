"""What is wrong with axes, limits, mount, files and bodies, what it costs, what to write instead."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray
from alpha5_model.comparison import alignment as aligned
from alpha5_model.comparison import diagnosis, reading
from alpha5_model.comparison.alignment import ANGLE_TOLERANCE, LENGTH_TOLERANCE, Alignment, allowed
from alpha5_model.comparison.arm import FourJointArm, our_arm, our_tips, with_dimensions
from alpha5_model.comparison.diagnosis import Inertial
from alpha5_model.comparison.records import BodyDifference, Finding
from alpha5_model.description.urdf_reading import UrdfRobot
from alpha5_model.inertia import inconsistencies, rotate_tensor
from alpha5_model.parameters import LinkParameters, parameters
from alpha5_model.spatial import moved, rotation_about, rpy_from_rotation, wrap

FINDINGS: Any = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: Limits are printed here to a tenth of a degree.
LIMIT_TOLERANCE = math.radians(0.1)
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
    text = {"where": where, **FINDINGS[topic], **FINDINGS[topic].get(subject, {}), **words}
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
    yield from _mount(other, theirs, alignment)
    yield from _shoulder(theirs, alignment)
    yield from _zeros(theirs, alignment, q)
    yield from _dimensions(theirs, alignment, q)
    apart = aligned.their_tips(theirs, alignment, q) - aligned.their_tips(written, alignment, q)
    yield from _digits(theirs, alignment, apart)
    yield from _limits(theirs, alignment)
    yield from _mimics(other)
    transforms = aligned.body_transforms(theirs, alignment)
    regressor = our_arm().gravity_regressor(q)

    def cost(body: int, mass: float, moment: FloatArray) -> float:
        # no joint carries the base: it costs nothing
        return float(np.abs(regressor[:, :, body - 1] @ [mass, *moment]).max()) if body else 0.0

    for i, body in enumerate(bodies):
        placed = [(other.links[n], transforms[i] @ theirs.link_poses[n]) for n in body.links]
        by_link = [Inertial(x.name, x.mass or 0.0, x.com, x.inertia, pose) for x, pose in placed]
        # on a root, nothing is what KDL wants
        links = [name for name in body.links if name != other.root or not body.mass]
        bare = [name for name in links if other.links[name].mass is None]
        yield from _of_body(i, body, by_link, bare, cost)
    yield from _files(other, theirs, folder)


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
    for j, (axis, joint) in enumerate(zip(reading.AXES, theirs.joints, strict=True)):
        here, zero = np.arange(4) == j, float(alignment.zero[j])
        if alignment.sign[j] < 0:
            cost = round(_torque_change(our_arm(), np.where(here, -q, q), q), 9)
            yield finding("reversed", axis, cost, joint=joint.name, axis=_numbers(-joint.axis))
        if abs(zero) <= within:
            continue
        name, words = "zero", {"joint": joint.name, "shift": math.degrees(zero)}
        if j in (1, 2):
            name, words["fit"] = "zero.fitted", _fit(alignment)
            words["without"] = aligned.without_zero(theirs, alignment, j) * 1e3
        elif j == 0:
            com = aligned.bodies_in_our_frames(theirs, alignment)[0][0]
            if np.linalg.norm(com - our_arm().com[0]) >= SAME_COM:
                name = "zero.or_base"
        turned = rpy_from_rotation(joint.transform[:3, :3] @ rotation_about(joint.axis, zero))
        words["xyz"], words["rpy"] = _numbers(joint.transform[:3, 3]), _numbers(turned)
        cost = round(_torque_change(our_arm(), q - alignment.sign * zero * here, q), 9)
        yield finding(name, axis, cost, **words)


def _dimensions(theirs: FourJointArm, alignment: Alignment, q: FloatArray) -> Iterator[Finding]:
    within = allowed(theirs, short_pi=True)
    for k, (name, change) in enumerate(zip(aligned.DIMENSIONS, alignment.dimensions, strict=True)):
        if abs(change) <= within[k >= 4]:
            continue
        only = np.where(np.arange(len(aligned.DIMENSIONS)) == k, change, 0.0)
        off = np.linalg.norm(our_tips(q, only) - our_tips(q), axis=1).max() * 1e3
        kind, _, index = name.partition("_")
        scale, unit = (1e3, "mm") if k < 4 else (180 / math.pi, "deg")
        ours = getattr(parameters().dh[int(index)], kind, 0.0) * scale
        words = {"theirs": ours + change * scale, "ours": ours, "unit": unit, "off": off}
        cost = _torque_change(with_dimensions(only), q, q)
        yield finding(f"dimension.{name}", "", cost, name=name, **words)


def _digits(theirs: FourJointArm, alignment: Alignment, apart: FloatArray) -> Iterator[Finding]:
    """What the number of printed digits does to the axes and tips (N, 3) [m]: remarks only."""
    if (off := float(np.linalg.norm(apart, axis=1).max())) > LENGTH_TOLERANCE:
        yield finding("digits.of_pi", off=off * 1e3)
    length, angle = allowed(theirs, short_pi=True)
    pairs = zip(reading.AXES[1:3], alignment.zero[1:3], strict=True)
    seen = [(axis, math.degrees(x)) for axis, x in pairs if ANGLE_TOLERANCE < abs(x) <= angle]
    zeros = "".join(f", zero of {axis} {zero:.2f} deg" for axis, zero in seen)
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
        name, words = "limits.none", dict[str, FloatArray]()
        printed = np.array([ours.lower, ours.upper])
        meant = np.sort(zero + sign * printed)
        if joint.lower is not None and joint.upper is not None:
            ends = np.sort(sign * (np.array([joint.lower, joint.upper]) - zero))
            # Their range lies within a turn of ours, whatever turn its zero was counted in.
            turns = float(wrap(ends.mean(), printed.mean()) - ends.mean())
            ends, meant = ends + turns, meant - sign * turns
            if np.abs(ends - printed).max() <= LIMIT_TOLERANCE:
                continue
            name, words = "limits", {"theirs": np.degrees(ends), "ours": np.degrees(printed)}
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


def _files(other: UrdfRobot, theirs: FourJointArm, folder: Path | None) -> Iterator[Finding]:
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


def _of_body(
    index: int, body: BodyDifference, written: list[Inertial], bare: list[str], cost: Cost
) -> Iterator[Finding]:
    link, name = body.ours, body.name
    mass_cost = cost(index, body.mass_error, body.mass_error * link.com)
    yield from _dummies(name, written)
    if not written:
        yield finding("body.missing", name, mass_cost)
        return
    mass, com, inertia = _instead(link, written)
    why = partial(diagnosis.reason, link, written)
    if body.mass == 0.0:
        everything = " ".join((mass, com.partition(": ")[2], inertia.partition(": ")[2]))
        words = {"links": ", ".join(bare), "ours": link.mass, "everything": everything}
        key = "body.without_inertial" if bare else "body.without_mass"
        yield finding(key, name, mass_cost, tag=mass, **words)
        return
    if bare:
        yield finding("body.partly", name, links=", ".join(bare))
    wrong_mass = abs(body.mass_error) > MASS_TOLERANCE * link.mass
    if wrong_mass:
        reason = why(diagnosis.explain_mass)
        twice = ": the jaws are counted twice" * (index == 4 and "; beside it" in reason)
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
        words = {"links": ", ".join(links), "s": "s" * (len(links) > 1), "grams": mass * 1e3}
        words |= {"have": "have" if len(links) > 1 else "has", "inertia": largest}
        yield finding(key, name, radius=math.sqrt(largest / mass), **words)


def _instead(link: LinkParameters, written: list[Inertial]) -> tuple[str, ...]:
    """Mass, COM and tensor of Table 2 as URDF, in the frame of the other model's heaviest link."""
    main = max(written, key=lambda w: abs(w.mass))
    rest = [w.link for w in written if w is not main and w.mass]
    alone = f" (nothing in {', '.join(rest)})" if rest else ""
    back = np.asarray(np.linalg.inv(main.pose), np.float64)
    # Table 2 prints 1e-6 m and 1e-9 kg m^2; a frame written with fewer digits adds noise beyond.
    xyz = " ".join(f"{x + 0.0:.6g}" for x in moved(back, link.com).round(6))
    tensor = rotate_tensor(back[:3, :3], link.inertia).round(9) + 0.0
    upper = zip(*np.triu_indices(3), strict=True)
    entries = " ".join(f'i{"xyz"[i]}{"xyz"[j]}="{tensor[i, j]:.6g}"' for i, j in upper)
    tags = f'mass value="{link.mass:g}"', f'origin xyz="{xyz}" rpy="0 0 0"', f"inertia {entries}"
    return tuple([f"{main.link}: <{tag}/>{alone}" for tag in tags])
