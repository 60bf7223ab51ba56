"""The inertias of a URDF's text against the digits of Table 2."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.description.verification_frames import Subject
from alpha5_model.inertia import inconsistencies, pseudo_inertia
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published import published

_JAWS = ("link_4", "jaw_rod", "finger_1", "finger_2")


@cache
def _table_2() -> tuple[tuple[float, list[float], FloatArray, FloatArray], ...]:
    """Mass, COM, I_COM in URDF sign and I_Link as printed, in SI.

    From the printed digits and not from the SI record that the generator uses: SolidWorks prints
    ``+(integral of x y dm)`` off the diagonal, the format wants the negative.
    """
    rows = []
    for row in published().table_2.rows:
        at_com, at_link = (
            np.array([[x.si for x in line] for line in tensor])
            for tensor in (row.inertia_com, row.inertia_link)
        )
        rows.append((row.mass.si, [c.si for c in row.com], _opposite_products(at_com), at_link))
    return tuple(rows)


def _opposite_products(tensor: FloatArray) -> FloatArray:
    return np.where(np.eye(3, dtype=bool), tensor, -tensor)


def inertial_differences(text: Subject, jaws: bool) -> list[str]:
    """Masses, COMs and tensors that are not Table 2's, to the last bit.

    With jaws, link 4 is in four parts and `closed_jaws` compares their sum.
    """
    found = []
    for i, (mass, com, tensor, at_link) in enumerate(_table_2()[: 4 if jaws else 5]):
        name = f"{text.prefix}link_{i}"
        given = text.links.get(name)
        if given is None or given.mass is None:
            found.append(f"{name}: no inertial")
            continue
        if given.mass != mass:
            found.append(f"{name}: mass {given.mass!r} kg, expected {mass!r}")
        if given.com.tolist() != com:
            away = float(np.linalg.norm(given.com - com)) * 1e3
            found.append(f"{name}: COM {given.com.tolist()} m, {away:.3g} mm from Table 2's")
        if given.inertia.tolist() != tensor.tolist():
            away = float(np.abs(given.inertia - tensor).max()) * 1e6
            words = _usual_mistake(given.inertia, tensor, at_link)
            found.append(f"{name}: inertia is {away:.3g} kg mm^2 from Table 2's I_COM{words}")
    return found


def _usual_mistake(given: FloatArray, tensor: FloatArray, at_link: FloatArray) -> str:
    """The two mistakes that public models make, by name."""

    def alike(a: FloatArray, b: FloatArray) -> bool:
        return np.allclose(a, b, rtol=1e-3, atol=1e-12)

    if alike(given, _opposite_products(tensor)):
        return " (products of inertia with SolidWorks' sign)"
    return " (it is I_Link)" if alike(np.abs(given), np.abs(at_link)) else ""


def stray_masses(text: Subject, jaws: bool) -> list[str]:
    """Links beside the arm's that weigh something, and massless frames that do not say so."""
    heavy = {text.prefix + f"link_{i}" for i in range(5)}
    heavy |= {text.prefix + name for name in _JAWS} if jaws else set()
    found = []
    for name in _below(text, text.prefix + "base_link") - heavy:
        given = text.links.get(name)
        if given is None or given.mass is None:
            # PyBullet gives a link without an inertial element a mass of 1 kg.
            found.append(f"{name}: no inertial element")
        elif given.mass or given.inertia.any():
            found.append(f"{name}: mass {given.mass:g} kg where there is no body")
    return sorted(found)


def _below(text: Subject, root: str) -> set[str]:
    """The link and all links that it carries, without what it is mounted on."""
    names = {root}
    for joint in text.joints.values():  # from the root outwards
        if joint.parent in names:
            names.add(joint.child)
    return names


def impossible_links(text: Subject) -> list[str]:
    """Links that cannot be bodies; see `alpha5_model.inertia.inconsistencies`."""
    found = []
    for name, given in text.links.items():
        if given.mass is not None and (given.mass or given.inertia.any()):
            problems = inconsistencies(given.mass, given.com, given.inertia)
            found += [f"{name}: {problem}" for problem in problems]
    return found


def link_4_is_split(text: Subject) -> bool:
    """Whether wrist, rod and both fingers are there, with the joints that carry them."""
    names = {text.prefix + name for name in _JAWS}
    bodies = {name for name, link in text.links.items() if link.mass is not None}
    wrist = text.prefix + "link_4"
    carried = {joint.child for joint in text.joints.values() if joint.parent == wrist}
    return names <= bodies and names - {wrist} <= carried


def closed_jaws(text: Subject) -> float:
    """Largest relative error of the assembly's pseudo-inertia about the origin of link 4.

    The 4x4 pseudo-inertia holds mass, first and second moments, and adds up over the bodies, so the
    sum needs no parallel-axis theorem. Each entry is compared with the size of its block.
    """
    mass, com, tensor, _ = _table_2()[4]
    printed = pseudo_inertia(mass, com, tensor)
    total = np.zeros((4, 4))
    for name in _JAWS:
        body = text.links[text.prefix + name]
        placed = np.eye(4)
        for joint in text.joints.values():
            if name != "link_4" and joint.child == text.prefix + name:
                placed = joint.transform @ joint.motion(_position_when_closed(text, joint))
        own = pseudo_inertia(body.mass or 0.0, body.com, body.inertia)
        total += placed @ own @ placed.T
    scale = np.empty((4, 4))
    scale[:3, :3] = np.abs(printed[:3, :3]).max()
    scale[:3, 3] = scale[3, :3] = np.abs(printed[:3, 3]).max()
    scale[3, 3] = printed[3, 3]
    return float((np.abs(total - printed) / scale).max())


def _position_when_closed(text: Subject, joint: UrdfJoint) -> float:
    """Position of a jaw joint with the rod at its lower limit."""
    leader = joint if joint.mimic is None else text.joints.get(joint.mimic)
    lower = 0.0 if leader is None or leader.lower is None else leader.lower
    return lower if joint.mimic is None else joint.multiplier * lower + joint.offset


def jaw_limit_differences(text: Subject, p: Alpha5Parameters) -> list[str]:
    """Fingers whose range or speed is not what the rod's range and speed make of them."""
    rod = text.joints.get(text.prefix + "axis_a")
    if rod is None or rod.lower is None or rod.upper is None or rod.velocity is None:
        return ["axis_a: no limits"]
    found = []
    for number in (1, 2):
        child = f"{text.prefix}finger_{number}"
        finger = next((j for j in text.joints.values() if j.child == child), None)
        if finger is None or finger.mimic != rod.name:
            found.append(f"{child}: no joint that follows {rod.name}")
            continue
        turn = finger.multiplier
        if abs(turn) != p.jaws.finger_turn:
            found.append(f"{finger.name}: {turn:g} rad/m, expected {p.jaws.finger_turn:g} rad/m")
        ends = sorted(turn * end + finger.offset for end in (rod.lower, rod.upper))
        made = {"lower": ends[0], "upper": ends[1], "velocity": abs(turn) * rod.velocity}
        for key, value in made.items():
            given = getattr(finger, key)
            if given is None or not math.isclose(given, value, rel_tol=0, abs_tol=1e-12):
                found.append(f"{finger.name}: {key} {given}, the rod makes it {value:.12g}")
    return found
