"""The numbers of the file against the printed digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.description.reading import LIMITS
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfLink
from alpha5_model.description.verification.subject import JAW_LINKS, Subject
from alpha5_model.numbers.inertia import inconsistencies
from alpha5_model.numbers.parameters import JointRange, in_si
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import BODY_NAMES, JOINT_NAMES

Finder = Callable[[Subject], Iterator[str]]
#: Links that the joints of the arm carry.
_CHILDREN = (*BODY_NAMES[1:], "jaw_rod")


class PrintedBody(NamedTuple):
    """A row of Table 2 in SI units.

    Attributes:
        mass: [kg].
        com: (3,) [m].
        at_com: I_COM in URDF sign, (3, 3) [kg m^2].
        at_link: I_Link as printed, (3, 3) [kg m^2].
    """

    mass: float
    com: list[float]
    at_com: FloatArray
    at_link: FloatArray


def table_2() -> list[PrintedBody]:
    """Table 2, from the printed digits and not from the record that the generator uses.

    SolidWorks prints ``+(integral of x y dm)`` off the diagonal, the format wants the
    negative.
    """
    bodies = []
    for row in published().table_2.rows:
        at_com = np.array(in_si(row.inertia_com))
        body = PrintedBody(
            mass=row.mass.si,
            com=in_si(row.com),
            at_com=_opposite_products(at_com),
            at_link=np.array(in_si(row.inertia_link)),
        )
        bodies.append(body)
    return bodies


def _opposite_products(tensor: FloatArray) -> FloatArray:
    return np.where(np.eye(3, dtype=bool), tensor, -tensor)


def _missing_names(text: Subject) -> Iterator[str]:
    """Links and joints of the arm that are not there."""
    links = ["base_link", *BODY_NAMES, "tcp"]
    joints = list(JOINT_NAMES[:4])
    if text.jaws:
        links += JAW_LINKS
        joints.append(JOINT_NAMES[4])

    for link in links:
        if text.prefix + link not in text.links:
            yield f"no link {text.prefix}{link}"
    for joint in joints:
        if text.prefix + joint not in text.joints:
            yield f"no joint {text.prefix}{joint}"


def _joint_differences(text: Subject) -> Iterator[str]:
    """Types, parents, children, axes and limits that are not the arm's."""
    for i, joint in enumerate(text.expected.joints):
        given = text.joints.get(text.prefix + joint.name)
        if given is None:
            continue
        expected = {
            "type": joint.kind,
            "parent": f"{text.prefix}link_{i}",
            "child": text.prefix + _CHILDREN[i],
            "axis": [0.0, 0.0, 1.0],
            "limits": _limits(joint),
        }
        found = {
            "type": given.kind,
            "parent": given.parent,
            "child": given.child,
            "axis": given.axis.tolist(),
            "limits": _limits(given),
        }
        for what, ours in expected.items():
            if found[what] != ours:
                yield f"{given.name}: {what} {found[what]}, expected {ours}"


def _limits(joint: JointRange | UrdfJoint) -> dict[str, Any]:
    return {name: getattr(joint, name) for name in LIMITS}


def _inertial_differences(text: Subject) -> Iterator[str]:
    """Masses, COMs and tensors that are not Table 2's, to the last bit.

    With jaws, link 4 is in four parts, and the check of the closed jaws compares their
    sum.
    """
    count = 4 if text.jaws else 5
    for i, printed in enumerate(table_2()[:count]):
        name = f"{text.prefix}link_{i}"
        given = text.links.get(name)
        if given is None or given.mass is None:
            yield f"{name}: no inertial"
        else:
            for difference in _inertial_difference(given, printed):
                yield f"{name}: {difference}"


def _inertial_difference(given: UrdfLink, printed: PrintedBody) -> Iterator[str]:
    if given.mass != printed.mass:
        yield f"mass {given.mass!r} kg, expected {printed.mass!r}"
    com = given.com.tolist()
    if com != printed.com:
        away = float(np.linalg.norm(given.com - printed.com)) * 1e3
        yield f"COM {com} m, {away:.3g} mm from Table 2's"
    if given.inertia.tolist() != printed.at_com.tolist():
        away = float(np.abs(given.inertia - printed.at_com).max()) * 1e6
        mistake = _usual_mistake(given.inertia, printed)
        yield f"inertia is {away:.3g} kg mm^2 from Table 2's I_COM{mistake}"


def _usual_mistake(given: FloatArray, printed: PrintedBody) -> str:
    """The name of a mistake that public models make; ``""`` if it is none of them."""
    if _alike(given, _opposite_products(printed.at_com)):
        return " (products of inertia with SolidWorks' sign)"
    if _alike(np.abs(given), np.abs(printed.at_link)):
        return " (it is I_Link)"
    return ""


def _alike(one: FloatArray, other: FloatArray) -> bool:
    return np.allclose(one, other, rtol=1e-3, atol=1e-12)


def _stray_masses(text: Subject) -> Iterator[str]:
    """Other links with a mass, and massless frames without an inertial element."""
    heavy = {text.prefix + name for name in BODY_NAMES}
    if text.jaws:
        heavy |= {text.prefix + name for name in JAW_LINKS}
    for name in sorted(_carried_by_base(text) - heavy):
        given = text.links.get(name)
        if given is None or given.mass is None:
            # PyBullet gives such a link a mass of 1 kg; on a root KDL warns about any
            # inertial element.
            if name in text.carriers:
                yield f"{name}: no inertial element"
        elif given.mass or given.inertia.any():
            yield f"{name}: mass {given.mass:g} kg where there is no body"


def _carried_by_base(text: Subject) -> set[str]:
    """base_link and all links that it carries, not those that it is mounted on."""
    carried = {text.prefix + "base_link"}
    for joint in text.joints.values():  # from the root outwards
        if joint.parent in carried:
            carried.add(joint.child)
    return carried


def _impossible_links(text: Subject) -> Iterator[str]:
    """Links that cannot be bodies; see `inconsistencies`."""
    for name, given in text.links.items():
        if given.mass is not None and (given.mass or given.inertia.any()):
            for problem in inconsistencies(given.mass, given.com, given.inertia):
                yield f"{name}: {problem}"


#: Check -> function that yields differences, and the finding if there are none.
CHECKS: dict[str, tuple[Finder, str]] = {
    "names": (_missing_names, "links and joints of the arm"),
    "joints": (_joint_differences, "parents, axes, types and limits"),
    "inertias": (
        _inertial_differences,
        "masses, COMs and tensors are Table 2's, to the last bit",
    ),
    "stray masses": (_stray_masses, "massless frames say that they are massless"),
    "physics": (_impossible_links, "every link with mass is a possible body"),
}
