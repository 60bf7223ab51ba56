"""What is wrong with another model's bodies, what it costs, what to write instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.inertia import inconsistencies, rotate_tensor
from alpha5_model.proofs.comparison.corrections import (
    LEVER,
    angle_between,
    token_inertial,
)
from alpha5_model.proofs.comparison.described import describe_like
from alpha5_model.proofs.comparison.differences import Evidence
from alpha5_model.proofs.comparison.digits import rounded_origins
from alpha5_model.proofs.comparison.mistakes import Body, Part
from alpha5_model.proofs.comparison.result import (
    BodyDifference,
    Correction,
    Finding,
    differing_texts,
    finding,
    some_names,
)
from alpha5_model.proofs.comparison.tolerance import MOST, Digits, digits_of
from alpha5_model.proofs.comparison.wrong_numbers import WrongNumber, wrong_numbers

#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]
#: A lighter link is a dummy: some tools ask for a mass on every link.
LIGHT = 1e-3  # [kg]
#: With more joints in the arm's way, the sum of their rounding is taken.
MOST_JOINTS = 20
#: Joint origins that are rounded by less misplace no body [m].
NEGLIGIBLE = 1e-7

#: Errors of mass [kg] and first moment (3,) [kg m] -> the gravity torque that they
#: cause [N m].
Cost = Callable[[float, FloatArray], float]


def bodies_of(evidence: Evidence) -> tuple[BodyDifference, ...]:
    """The bodies of the other arm, each with ours."""
    described = evidence.described
    return tuple(
        BodyDifference(
            name=link.name,
            links=evidence.meant.links[k],
            mass=float(evidence.meant.mass[k]),
            com=described.coms[k],
            inertia=described.inertias[k],
            ours=link,
        )
        for k, link in enumerate(evidence.record.links)
    )


def findings_of_bodies(evidence: Evidence) -> Iterator[Finding]:
    """What is wrong with the bodies, base to tip."""
    written = digits_of(evidence.other)
    lengths, angles = _misplaced_by_rounding(evidence)
    regressor = evidence.ours.gravity_regressor(evidence.q)
    for k, body in enumerate(bodies_of(evidence)):
        digits = written._replace(length=lengths[k], angle=angles[k])
        yield from _findings_of_body(evidence, k, body, digits, regressor)


def _misplaced_by_rounding(evidence: Evidence) -> tuple[list[float], list[float]]:
    """By how much rounded joint origins shift [m] and turn [rad] the five bodies.

    Each number of an origin is changed by half of its last decimal place, and what that
    does to the bodies is added in quadrature. The error of a pi that is cut short may
    hide in angles that were computed from it. Origins that are right are not rounded,
    whatever their digits.
    """
    lengths = np.zeros(5)
    angles = np.full(5, (2 * evidence.meant.digits.pi) ** 2)
    if len(evidence.meant.way) > MOST_JOINTS:
        lengths += evidence.rounding.length**2
        angles += evidence.rounding.angle**2
    elif evidence.meant.digits.length > NEGLIGIBLE:
        like = evidence.described
        for joint in rounded_origins(evidence.meant.way):
            rounded = evidence.reduced_with(joint)
            placed = describe_like(rounded, evidence.record, like).placed
            shift = placed[:, :3, 3] - like.placed[:, :3, 3]
            lengths += np.square(shift).sum(axis=1)
            turned = [
                angle_between(*poses) for poses in zip(placed, like.placed, strict=True)
            ]
            angles += np.square(turned)
    shifts = []
    turns = []
    for right in evidence.right_joints:
        written = right.joint.transform
        shifts.append(float(np.linalg.norm(written[:3, 3] - right.origin[:3, 3])))
        turns.append(angle_between(written, right.origin))
    # An error of one joint moves the bodies by as much, or by its angle times a lever.
    farthest = 2 * (max(shifts) + LEVER * max(turns))
    most_turned = 2 * max(turns)
    return (
        np.minimum(np.sqrt(lengths), farthest).tolist(),
        np.minimum(np.sqrt(angles), most_turned).tolist(),
    )


def _findings_of_body(
    evidence: Evidence,
    k: int,
    body: BodyDifference,
    digits: Digits,
    regressor: FloatArray,
) -> Iterator[Finding]:
    """What is wrong with one body.

    Args:
        evidence: Both arms.
        k: 0 for link_0 to 4 for link_4.
        body: Theirs, compared with ours.
        digits: Of the file's inertials.
        regressor: See `FourJoints.gravity_regressor`.
    """

    def cost(mass: float, first_moment: FloatArray) -> float:
        if k == 0:  # no joint carries the base
            return 0.0
        torques = regressor[:, :, k - 1] @ [mass, *first_moment]
        return round(float(np.abs(torques).max()), 9)

    missing_cost = cost(body.mass_error, body.mass_error * body.ours.com)
    if not body.links:
        yield finding("body.missing", where=body.name, cost=missing_cost)
        return

    parts = _parts(evidence, k, body.links)
    joints = evidence.other.joints.values()
    moving = {joint.child for joint in joints if joint.kind != "fixed"}
    bare = _bare_links(evidence, body)
    if not sum(part.body.mass for part in parts):
        yield _without_mass(evidence, k, body, digits, missing_cost)
        return
    if bare:
        yield finding("body.partly", where=body.name, links=some_names(bare))

    dummies = _dummies_of(parts)
    yield from _dummies(body.name, dummies, moving)
    names = [part.link for part in dummies]
    parts = [part for part in parts if part.link not in names]
    wrong = wrong_numbers(evidence.arm, k, parts, digits)
    by_link = {part.link: part for part in parts}
    several = sum(part.body.mass > 0 for part in parts) > 1
    for number in wrong:
        part = by_link[number.link]
        yield _wrong(body, number, part, several, moving, digits, cost)
    is_negative = body.mass < 0 and any(one.quantity == "mass" for one in wrong)
    is_known = [one.mistake or not one.right.mass for one in wrong]
    if not is_negative and not all(is_known):
        yield from _impossible(body)


def _parts(evidence: Evidence, k: int, names: Sequence[str]) -> list[Part]:
    """The links of a body that have an ``<inertial>``."""
    parts = []
    for name in names:
        link = evidence.other.links[name]
        if link.mass is not None:
            parts.append(
                Part(
                    link=name,
                    body=Body(mass=link.mass, com=link.com, inertia=link.inertia),
                    pose=evidence.described.placed[k] @ evidence.meant.link_poses[name],
                )
            )
    return parts


def _bare_links(evidence: Evidence, body: BodyDifference) -> list[str]:
    """Names of the links of a body without an inertial.

    KDL allows none on the root, so the root counts only if the body has no mass at all.
    """
    links = evidence.other.links
    bare = [name for name in body.links if links[name].mass is None]
    if body.mass:
        bare = [name for name in bare if name != evidence.other.root]
    return bare


# --- Dummies --------------------------------------------------------------------------


def _dummies_of(parts: Sequence[Part]) -> list[Part]:
    """Links of hardly any mass that have the inertia of a large ball, beside real ones.

    People write such inertials in frames. Another mistake with a light link, such as
    its tensor in other units, gives no ball.
    """
    dummies = []
    for part in parts:
        mass = part.body.mass
        moment = float(part.body.inertia[0, 0])
        is_ball = np.allclose(part.body.inertia, moment * np.eye(3), rtol=1e-6)
        if is_ball and 0 < mass <= LIGHT and moment > REACH**2 * mass:
            dummies.append(part)
    names = [part.link for part in dummies]
    masses = [part.body.mass for part in parts if part.link not in names]
    return dummies if any(masses) else []


def _dummies(name: str, dummies: Sequence[Part], moving: set[str]) -> Iterator[Finding]:
    """Dummies, equal ones together.

    Args:
        name: Of the body.
        dummies: Its links that are dummies.
        moving: Links that a joint moves.
    """
    equal: dict[tuple[float, float], list[str]] = {}
    for part in dummies:
        size = (part.body.mass, float(part.body.inertia[0, 0]))
        equal.setdefault(size, []).append(part.link)
    for (mass, moment), links in equal.items():
        several = len(links) > 1
        yield finding(
            "dummy",
            where=name,
            links=some_names(links),
            s="s" if several else "",
            have="have" if several else "has",
            grams=mass * 1e3,
            inertia=moment,
            radius=math.sqrt(moment / mass),
            corrections=[_emptied(link, link in moving) for link in links],
        )


# --- Wrong numbers --------------------------------------------------------------------


def _wrong(
    body: BodyDifference,
    number: WrongNumber,
    part: Part,
    is_part: bool,
    moving: set[str],
    digits: Digits,
    cost: Cost,
) -> Finding:
    """The finding of one wrong number.

    Args:
        body: The body.
        number: What is wrong.
        part: Its link as it is written.
        is_part: Whether other links belong to the body, too.
        moving: Links that a joint moves.
        digits: Of the file.
        cost: Gravity torque of errors of mass and first moment.
    """
    right = number.right
    written = part.body
    reason = f": {number.mistake.words}" if number.mistake else ""
    link = f" of {number.link}" if is_part else ""
    if right.mass:
        correction = _right_inertial(number.link, right, digits, number.quantity)
    else:
        correction = _emptied(number.link, number.link in moving)
    common: dict[str, Any] = {
        "where": body.name,
        "corrections": [correction],
        "mistake": number.mistake.id if number.mistake else "",
        "link": link,
    }
    if number.quantity == "mass":
        error = written.mass - right.mass
        at = right.com if right.mass else written.com
        if right.mass and not reason:
            reason = f" ({written.mass / right.mass:.3g} times)"
        theirs, ours = differing_texts(written.mass, right.mass)
        return finding(
            "body.mass",
            **common,
            cost=cost(error, error * moved(part.pose, at)),
            mass=theirs,
            ours=ours,
            reason=reason,
        )
    if number.quantity == "com":
        shift = part.pose[:3, :3] @ (written.com - right.com)
        return finding(
            "body.com",
            **common,
            cost=cost(0.0, right.mass * shift),
            off=float(np.linalg.norm(shift)) * 1e3,
            reason=reason,
        )
    difference = np.abs(written.inertia - right.inertia)
    i, j = sorted(np.unravel_index(difference.argmax(), (3, 3)))
    theirs, ours = differing_texts(written.inertia[i, j], right.inertia[i, j])
    return finding(
        "body.inertia",
        **common,
        element=f"i{'xyz'[i]}{'xyz'[j]}",
        theirs=theirs,
        ours=ours,
        reason=reason,
    )


def _right_inertial(
    link: str, right: Body, digits: Digits, quantity: str = ""
) -> Correction:
    """A link's inertial, or its mass, or COM with tensor, to write in its place.

    COM and tensor come together, since the axes of the origin turn the tensor.

    Args:
        link: Its name.
        right: In its own frame.
        digits: Of the file, to which the numbers are rounded.
        quantity: ``mass``, ``com`` or ``inertia``; everything if empty.
    """
    elements: dict[str, Mapping[str, str] | None] = {}
    if quantity in ("", "mass"):
        mass = digits.mass.rounded(right.mass, MOST["mass"])
        elements["mass"] = {"value": f"{mass:.9g}"}
    if quantity != "mass":
        com = digits.com.rounded(right.com, MOST["com"])
        tensor = digits.inertia.rounded(right.inertia, MOST["inertia"])
        xyz = " ".join(f"{x:.9g}" for x in com)
        elements["origin"] = {"xyz": xyz, "rpy": "0 0 0"}
        upper_half = zip(*np.triu_indices(3), strict=True)
        elements["inertia"] = {
            f"i{'xyz'[i]}{'xyz'[j]}": f"{tensor[i, j]:.9g}" for i, j in upper_half
        }
    return Correction("link", link, elements)


def _emptied(link: str, moves: bool) -> Correction:
    """A link that has no body: a joint still needs an inertia to move."""
    if moves:
        return token_inertial(link)
    return Correction("link", link, {"inertial": None})


def _without_mass(
    evidence: Evidence,
    k: int,
    body: BodyDifference,
    digits: Digits,
    cost: float,
) -> Finding:
    """A body without mass, or without any inertial."""
    ours = body.ours
    moved_by_joint = evidence.meant.joints[k - 1].child if k else ""
    turned_in = evidence.meant.base_path[-1]
    candidates = (moved_by_joint, turned_in, *body.links)
    link = next(name for name in candidates if name in body.links)
    pose = evidence.described.placed[k] @ evidence.meant.link_poses[link]
    to_link = np.linalg.inv(pose)
    right = Body(
        mass=ours.mass,
        com=moved(to_link, ours.com),
        inertia=rotate_tensor(to_link[:3, :3], ours.inertia),
    )
    is_bare = evidence.other.links[link].mass is None
    return finding(
        "body.without_inertial" if is_bare else "body.without_mass",
        where=body.name,
        cost=cost,
        links=link,
        ours=ours.mass,
        corrections=[_right_inertial(link, right, digits)],
    )


def _impossible(body: BodyDifference) -> Iterator[Finding]:
    """What makes a body impossible that no known mistake explains."""
    ours = body.ours
    # One body of Table 2 breaks its own bounds: the other model may do so, too.
    ours_breaks = inconsistencies(ours.mass, ours.com, ours.inertia, ours.bounds)
    bounds = None if ours_breaks else ours.bounds
    for problem in inconsistencies(body.mass, body.com, body.inertia, bounds):
        yield finding("body.impossible", where=body.name, problem=problem)
