"""What the text of a URDF says against the printed tables: names, joints, inertias and jaws."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.description.urdf_reading import LIMITS, UrdfJoint, UrdfRobot, read_urdf
from alpha5_model.inertia import inconsistencies, pseudo_inertia
from alpha5_model.parameters import Alpha5Parameters, in_si
from alpha5_model.published import published
from alpha5_model.published.tables import BODY_NAMES

JAW_LINKS = ("jaw_rod", "finger_1", "finger_2")


@dataclass(frozen=True, eq=False)
class Subject(UrdfRobot):
    """A URDF file that is checked.

    Attributes:
        path: The file.
        prefix: What stands before ``base_link`` in it.
        expected: What it should say.
    """

    path: Path
    prefix: str
    expected: Alpha5Parameters

    @classmethod
    def read(cls, path: str | os.PathLike[str], expected: Alpha5Parameters) -> Subject:
        """Read a file; see `read_urdf` for what it raises."""
        robot = read_urdf(Path(path))
        base = [name for name in robot.links if name.endswith("base_link")]
        prefix = base[0].removesuffix("base_link") if len(base) == 1 else ""
        return cls(**vars(robot), path=Path(path), prefix=prefix, expected=expected)

    @property
    def jaws(self) -> bool:
        """Whether there is a link of moving jaws."""
        return any(self.prefix + name in self.links for name in JAW_LINKS)

    @property
    def turning(self) -> list[str]:
        """Names of the arm's four joints, without prefix."""
        return [joint.name for joint in self.expected.joints[:4]]

    @property
    def carriers(self) -> dict[str, UrdfJoint]:
        """Link -> the joint that carries it."""
        return {joint.child: joint for joint in self.joints.values()}


@cache
def _table_2() -> tuple[tuple[float, list[float], FloatArray, FloatArray], ...]:
    """Mass, COM, I_COM in URDF sign and I_Link as printed, in SI.

    From the printed digits and not from the SI record that the generator uses: SolidWorks prints
    ``+(integral of x y dm)`` off the diagonal, the format wants the negative.
    """
    rows = []
    for row in published().table_2.rows:
        at_com, at_link = np.array(in_si((row.inertia_com, row.inertia_link)))
        rows.append((row.mass.si, in_si(row.com), _opposite_products(at_com), at_link))
    return tuple(rows)


def _opposite_products(tensor: FloatArray) -> FloatArray:
    return np.where(np.eye(3, dtype=bool), tensor, -tensor)


def _missing_names(text: Subject) -> list[str]:
    """Links and joints of the arm that are not there."""
    links = ["base_link", *BODY_NAMES, "tcp", *(JAW_LINKS if text.jaws else ())]
    joints = [joint.name for joint in text.expected.joints[: 5 if text.jaws else 4]]
    return [
        *(f"no link {text.prefix}{n}" for n in links if text.prefix + n not in text.links),
        *(f"no joint {text.prefix}{n}" for n in joints if text.prefix + n not in text.joints),
    ]


def _joint_differences(text: Subject) -> list[str]:
    """Types, parents, children, axes and limits that are not the arm's."""
    found = []
    for i, joint in enumerate(text.expected.joints):
        given = text.joints.get(text.prefix + joint.name)
        if given is None:
            continue
        child = "jaw_rod" if joint.name == "axis_a" else f"link_{i + 1}"
        for what, ours, theirs in (
            ("type", joint.kind, given.kind),
            ("parent", text.prefix + f"link_{i}", given.parent),
            ("child", text.prefix + child, given.child),
            ("axis", [0.0, 0.0, 1.0], given.axis.tolist()),
            ("limits", *({k: getattr(j, k) for k in LIMITS} for j in (joint, given))),
        ):
            if ours != theirs:
                found.append(f"{given.name}: {what} {theirs}, expected {ours}")
    return found


def _inertial_differences(text: Subject) -> list[str]:
    """Masses, COMs and tensors that are not Table 2's, to the last bit.

    With jaws, link 4 is in four parts and `closed_jaws` compares their sum.
    """
    found = []
    for i, (mass, com, tensor, at_link) in enumerate(_table_2()[: 4 if text.jaws else 5]):
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
    alike = partial(np.allclose, rtol=1e-3, atol=1e-12)
    if alike(given, _opposite_products(tensor)):
        return " (products of inertia with SolidWorks' sign)"
    return " (it is I_Link)" if alike(np.abs(given), np.abs(at_link)) else ""


def _stray_masses(text: Subject) -> list[str]:
    """Links beside the arm's that weigh something, and massless frames that do not say so."""
    mine = {text.prefix + "base_link"}  # and what it carries, not what it is mounted on
    for joint in text.joints.values():  # from the root outwards
        if joint.parent in mine:
            mine.add(joint.child)
    heavy = {text.prefix + name for name in (*BODY_NAMES, *(JAW_LINKS if text.jaws else ()))}
    children = {joint.child for joint in text.joints.values()}
    found = []
    for name in mine - heavy:
        given = text.links.get(name)
        if given is None or given.mass is None:
            # PyBullet gives such a link a mass of 1 kg; on a root KDL warns about any inertial element.
            found += [f"{name}: no inertial element"] if name in children else []
        elif given.mass or given.inertia.any():
            found.append(f"{name}: mass {given.mass:g} kg where there is no body")
    return sorted(found)


def _impossible_links(text: Subject) -> list[str]:
    """Links that cannot be bodies; see `alpha5_model.inertia.inconsistencies`."""
    return [
        f"{name}: {problem}"
        for name, given in text.links.items()
        if given.mass is not None and (given.mass or given.inertia.any())
        for problem in inconsistencies(given.mass, given.com, given.inertia)
    ]


#: Check -> what it finds, and what it claims if that is nothing.
CHECKS: dict[str, tuple[Callable[[Subject], list[str]], str]] = {
    "names": (_missing_names, "links and joints of the arm"),
    "joints": (_joint_differences, "parents, axes, types and limits"),
    "inertias": (_inertial_differences, "masses, COMs and tensors are Table 2's, to the last bit"),
    "stray masses": (_stray_masses, "massless frames say that they are massless"),
    "physics": (_impossible_links, "every link with mass is a possible body"),
}


def closed_jaws(text: Subject) -> float | None:
    """Largest relative error of the assembly's pseudo-inertia about the origin of link 4.

    The 4x4 pseudo-inertia holds mass, first and second moments, and adds up over the bodies, so the
    sum needs no parallel-axis theorem. Each entry is compared with the size of its block.

    Returns:
        The error; None if wrist, rod and fingers are not all there, with the joints that carry them.
    """
    wrist = text.prefix + "link_4"
    total = np.zeros((4, 4))
    for name in (wrist, *(text.prefix + name for name in JAW_LINKS)):
        body, joint = text.links.get(name), text.carriers.get(name)
        if body is None or body.mass is None:
            return None
        placed = np.eye(4)
        if name != wrist:
            if joint is None or joint.parent != wrist:
                return None
            leader = text.joints.get(joint.source)
            closed = 0.0 if leader is None else leader.lower or 0.0
            placed = joint.transform @ joint.motion(joint.multiplier * closed + joint.offset)
        total += placed @ pseudo_inertia(body.mass, body.com, body.inertia) @ placed.T
    mass, com, tensor, _ = _table_2()[4]
    printed = pseudo_inertia(mass, com, tensor)
    blocks = np.s_[:3, :3], np.s_[:3, 3], np.s_[3, 3]
    return max(float(np.abs((total - printed)[b]).max() / np.abs(printed[b]).max()) for b in blocks)


def jaw_limit_differences(text: Subject) -> list[str]:
    """Fingers whose range or speed is not what the rod's range and speed make of them."""
    rod = text.joints.get(text.prefix + "axis_a")
    if rod is None or rod.lower is None or rod.upper is None or rod.velocity is None:
        return ["axis_a: no limits"]
    found, nominal = [], text.expected.jaws.finger_turn
    for child in (text.prefix + "finger_1", text.prefix + "finger_2"):
        finger = text.carriers.get(child)
        if finger is None or finger.mimic != rod.name:
            found.append(f"{child}: no joint that follows {rod.name}")
            continue
        turn = finger.multiplier
        if abs(turn) != nominal:
            found.append(f"{finger.name}: {turn:g} rad/m, expected {nominal:g} rad/m")
        ends = sorted(turn * end + finger.offset for end in (rod.lower, rod.upper))
        made = {"lower": ends[0], "upper": ends[1], "velocity": abs(turn) * rod.velocity}
        for key, value in made.items():
            given = getattr(finger, key)
            if given is None or not math.isclose(given, value, rel_tol=0, abs_tol=1e-12):
                found.append(f"{finger.name}: {key} {given}, the rod makes it {value:.12g}")
    return found
