"""The inertias of a URDF's text against the digits of Table 2."""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_text import InertialText, UrdfText, pose
from alpha5_model.inertia import inconsistencies, pseudo_inertia, rotate_tensor
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published import published

_JAWS = ("link_4", "jaw_rod", "finger_1", "finger_2")


def inertial_differences(text: UrdfText, jaws: bool) -> list[str]:
    """Masses, COMs and tensors that are not Table 2's, to the last bit.

    Read from the printed digits and not from the SI record that the generator uses: SolidWorks prints
    ``+(integral of x y dm)``, the format wants the negative. With jaws, link 4 is in four parts and
    `closed_jaws` compares their sum.
    """
    found = []
    for row in published().table_2.rows[: 4 if jaws else 5]:
        name = f"{text.prefix}link_{row.link}"
        given = text.links.get(name)
        if given is None:
            found.append(f"{name}: no inertial")
            continue
        com = [c.si for c in row.com]
        tensor = [
            [x.si if i == j else -x.si for j, x in enumerate(line)]
            for i, line in enumerate(row.inertia_com)
        ]
        if given.rpy.any():
            found.append(f"{name}: inertial origin is turned by {given.rpy.tolist()} rad")
        if given.mass != row.mass.si:
            found.append(f"{name}: mass {given.mass!r} kg, expected {row.mass.si!r}")
        if given.xyz.tolist() != com:
            away = float(np.linalg.norm(given.xyz - com)) * 1e3
            found.append(f"{name}: COM {given.xyz.tolist()} m, {away:.3g} mm from Table 2's")
        if given.inertia.tolist() != tensor:
            found.append(
                f"{name}: {_tensor_words(given.inertia, row.inertia_link, np.array(tensor))}"
            )
    return found


def _tensor_words(given: FloatArray, at_link: object, expected: FloatArray) -> str:
    """What is wrong with a tensor, with the two usual mistakes by name."""
    mirrored = np.where(np.eye(3, dtype=bool), expected, -expected)
    origin = np.array([[x.si for x in line] for line in at_link])  # type: ignore[attr-defined]
    away = float(np.abs(given - expected).max()) * 1e6
    words = f"inertia is {away:.3g} kg mm^2 from Table 2's I_COM"
    if np.allclose(given, mirrored, rtol=1e-3, atol=1e-12):
        words += " (products of inertia with SolidWorks' sign)"
    elif np.allclose(np.abs(given), np.abs(origin), rtol=1e-3, atol=1e-12):
        words += " (it is I_Link)"
    return words


def stray_masses(text: UrdfText, jaws: bool) -> list[str]:
    """Links beside the arm's that weigh something, and massless frames that do not say so."""
    heavy = {text.prefix + f"link_{i}" for i in range(5)}
    heavy |= {text.prefix + name for name in _JAWS} if jaws else set()
    found = []
    for name in _below(text, text.prefix + "base_link") - heavy:
        given = text.links.get(name)
        if given is None:
            # PyBullet gives a link without an inertial element a mass of 1 kg.
            found.append(f"{name}: no inertial element")
        elif given.mass or given.inertia.any():
            found.append(f"{name}: mass {given.mass:g} kg where there is no body")
    return sorted(found)


def _below(text: UrdfText, root: str) -> set[str]:
    """The link and everything that it carries: what it is mounted on is not the arm's."""
    names, fresh = set(), {root}
    while fresh:
        names |= fresh
        fresh = {joint.child for joint in text.joints.values() if joint.parent in fresh} - names
    return names


def impossible_links(text: UrdfText) -> list[str]:
    """Links that cannot be bodies [see `alpha5_model.inertia.inconsistencies`]."""
    found = []
    for name, given in text.links.items():
        if given is not None and (given.mass or given.inertia.any()):
            problems = inconsistencies(given.mass, given.xyz, given.inertia)
            found += [f"{name}: {problem}" for problem in problems]
    return found


def link_4_is_split(text: UrdfText) -> bool:
    """Whether wrist, rod and both fingers are there, with the joints that carry them."""
    bodies = all(text.links.get(text.prefix + name) is not None for name in _JAWS)
    joints = {
        joint.child for joint in text.joints.values() if joint.parent == text.prefix + "link_4"
    }
    return bodies and joints >= {text.prefix + name for name in _JAWS[1:]}


def closed_jaws(text: UrdfText) -> float:
    """Largest relative error of the assembly's pseudo-inertia about the origin of link 4.

    The 4x4 pseudo-inertia holds mass, first and second moments, and adds up over the bodies, so the
    sum needs no parallel-axis theorem. Each entry is compared with the size of its block.
    """
    link = published().table_2.rows[4]
    tensor = np.array(
        [
            [x.si if i == j else -x.si for j, x in enumerate(line)]
            for i, line in enumerate(link.inertia_com)
        ]
    )
    printed = pseudo_inertia(link.mass.si, [c.si for c in link.com], tensor)
    total = np.zeros((4, 4))
    for name in _JAWS:
        body = text.links[text.prefix + name]
        assert body is not None  # link_4_is_split
        placed = np.eye(4)
        if name != "link_4":
            joint = next(j for j in text.joints.values() if j.child == text.prefix + name)
            closed = _position_when_closed(text, joint.name)
            motion = np.eye(4)
            if joint.kind == "prismatic":
                motion[:3, 3] = closed * joint.axis
            else:
                motion[:3, :3] = _rotation(joint.axis, closed)
            placed = joint.origin @ motion
        total += placed @ _pseudo(body) @ placed.T
    scale = np.empty((4, 4))
    scale[:3, :3] = np.abs(printed[:3, :3]).max()
    scale[:3, 3] = scale[3, :3] = np.abs(printed[:3, 3]).max()
    scale[3, 3] = printed[3, 3]
    return float((np.abs(total - printed) / scale).max())


def _pseudo(body: InertialText) -> FloatArray:
    rotation = pose(np.zeros(3), body.rpy)[:3, :3]
    return pseudo_inertia(body.mass, body.xyz, rotate_tensor(rotation, body.inertia))


def _rotation(axis: FloatArray, angle: float) -> FloatArray:
    """Rodrigues' formula, (3, 3)."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out: FloatArray = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)
    return out


def _position_when_closed(text: UrdfText, joint: str) -> float:
    """Position of a jaw joint with the rod at its lower limit."""
    given = text.joints[joint]
    if given.mimic is None:
        return given.limits.get("lower", 0.0)
    leader, multiplier, offset = given.mimic
    follows = text.joints.get(leader)
    return multiplier * (follows.limits.get("lower", 0.0) if follows else 0.0) + offset


def jaw_limit_differences(text: UrdfText, p: Alpha5Parameters) -> list[str]:
    """Fingers whose range or speed is not what the rod's range and speed make of them."""
    rod = text.joints.get(text.prefix + "axis_a")
    if rod is None or not {"lower", "upper", "velocity"} <= rod.limits.keys():
        return ["axis_a: no limits"]
    found = []
    for number in (1, 2):
        child = f"{text.prefix}finger_{number}"
        finger = next((j for j in text.joints.values() if j.child == child), None)
        if finger is None or finger.mimic is None or finger.mimic[0] != rod.name:
            found.append(f"{child}: no joint that follows {rod.name}")
            continue
        _, multiplier, offset = finger.mimic
        if abs(multiplier) != p.jaws.finger_turn:
            found.append(
                f"{finger.name}: {multiplier:g} rad/m, expected {p.jaws.finger_turn:g} rad/m"
            )
        ends = sorted(multiplier * rod.limits[side] + offset for side in ("lower", "upper"))
        made = {
            "lower": ends[0],
            "upper": ends[1],
            "velocity": abs(multiplier) * rod.limits["velocity"],
        }
        for key, value in made.items():
            if abs(finger.limits.get(key, np.nan) - value) > 1e-12 or key not in finger.limits:
                found.append(
                    f"{finger.name}: {key} {finger.limits.get(key)}, the rod makes it {value:.12g}"
                )
    return found
