"""Our URDF with one mistake that people make, at every place where it can be made.

The mistakes are made in the XML by formulas of their own; nothing comes from the
package. `single_mistakes` lists them for a URDF. What changes no number beyond the
file's digits is no mistake, and is left out.
"""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
import reference

ARM_JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
#: The arm's links; those of opened jaws are parts of the last one.
LINKS = tuple(f"link_{k}" for k in range(5))
#: Half of the last digit of Table 2: kg, m, kg m^2.
HALF_DIGITS = {"mass": 5e-4, "com": 5e-7, "inertia": 5e-10}

#: The earlier revision's tables, typed: kg, mm, kg mm^2 (xx, yy, zz, xy, xz, yz with
#: the document's sign), L, mm.
OLD_MASS = [0.341, 0.194, 0.429, 0.115, 0.333]
OLD_COM = [(-75, -6, -3), (5, -1, 16), (73, 0, 0), (17, -26, 2), (0, -3, -98)]
OLD_INERTIA = [
    (83.66, 998.81, 1003.60, -14.45, 38.27, -3.14),
    (139.10, 158.49, 61.96, 5.97, 38.48, 6.10),
    (86.77, 868.23, 891.46, -73.13, 13.16, -0.03),
    (41.80, 28.30, 45.02, -10.17, -4.91, 5.98),
    (507.87, 535.87, 76.00, 1.97, -4.98, -97.90),
]


class Damage(NamedTuple):
    """One mistake at one place.

    Attributes:
        id: Of the mistake.
        where: Name of the link or joint in the file.
        quantity: ``mass``, ``com``, ``inertia``, ``xyz``, ``rpy`` or ``axis``.
        value: What is written there: (), (3,), (3, 3).
        names: All mistakes that write this value, which nobody can tell apart.
    """

    id: str
    where: str
    quantity: str
    value: np.ndarray
    names: frozenset[str] = frozenset()

    @property
    def label(self) -> str:
        return f"{self.where}.{self.quantity}.{self.id}"

    @property
    def place(self) -> tuple[str, str]:
        return self.where, self.quantity


# ------------------------------------------------------------------------ the elements


class Inertial(NamedTuple):
    mass: float
    com: np.ndarray
    inertia: np.ndarray


def numbers(text: str) -> np.ndarray:
    return np.array(text.split(), float)


def text_of(values: Iterable[float]) -> str:
    return " ".join(repr(float(x)) for x in np.atleast_1d(values))


def inertial(link: ET.Element) -> Inertial | None:
    """The inertial of a link with a mass, whose origin is not turned."""
    element = link.find("inertial")
    if element is None or not float(element.find("mass").get("value")):
        return None
    assert not numbers(element.find("origin").get("rpy")).any()
    xx, xy, xz, yy, yz, zz = (
        float(element.find("inertia").get(f"i{name}"))
        for name in ("xx", "xy", "xz", "yy", "yz", "zz")
    )
    return Inertial(
        mass=float(element.find("mass").get("value")),
        com=numbers(element.find("origin").get("xyz")),
        inertia=np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]),
    )


def named(root: ET.Element, tag: str, name: str) -> ET.Element:
    (element,) = (one for one in root.findall(tag) if one.get("name") == name)
    return element


def damaged(text: str, *damages: Damage) -> str:
    """The URDF with these mistakes."""
    root = ET.fromstring(text)
    for damage in damages:
        _write(root, damage)
    return ET.tostring(root, encoding="unicode")


def _write(root: ET.Element, damage: Damage) -> None:
    value = damage.value
    if damage.quantity in ("xyz", "rpy"):
        origin = named(root, "joint", damage.where).find("origin")
        origin.set(damage.quantity, text_of(value))
    elif damage.quantity == "axis":
        named(root, "joint", damage.where).find("axis").set("xyz", text_of(value))
    else:
        element = named(root, "link", damage.where).find("inertial")
        if damage.quantity == "mass":
            element.find("mass").set("value", text_of(value))
        elif damage.quantity == "com":
            element.find("origin").set("xyz", text_of(value))
        else:
            for i, j in itertools.combinations_with_replacement(range(3), 2):
                name = f"i{'xyz'[i]}{'xyz'[j]}"
                element.find("inertia").set(name, repr(float(value[i, j])))


def apply(text: str, corrections: Iterable) -> str:
    """The URDF after the corrections of some findings: objects, no text is read."""
    root = ET.fromstring(text)
    for one in corrections:
        element = named(root, one.kind, one.name)
        for tag, attributes in one.elements.items():
            _correct(element, one.kind, tag, attributes)
    return ET.tostring(root, encoding="unicode")


def _correct(element: ET.Element, kind: str, tag: str, attributes) -> None:
    if tag == kind:
        element.attrib.update(attributes)
        return
    parent = element
    if kind == "link" and tag != "inertial":
        parent = element.find("inertial")
        if parent is None:
            parent = ET.SubElement(element, "inertial")
    child = parent.find(tag)
    if attributes is None:
        if child is not None:
            parent.remove(child)
        return
    if child is None:
        child = ET.SubElement(parent, tag)
    child.attrib.update(attributes)


# --------------------------------------------------------------- mistakes with a body


def tensor(elements: Iterable[float], sign: float = 1.0) -> np.ndarray:
    """Of xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = elements
    xy, xz, yz = sign * xy, sign * xz, sign * yz
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def six(matrix: np.ndarray) -> np.ndarray:
    return matrix[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def steiner(mass: float, p: np.ndarray) -> np.ndarray:
    x, y, z = p
    return mass * np.array(
        [
            [y * y + z * z, -x * y, -x * z],
            [-x * y, x * x + z * z, -y * z],
            [-x * z, -y * z, x * x + y * y],
        ]
    )


def masses(body: Inertial) -> Iterator[tuple[str, float]]:
    yield "grams", body.mass * 1000
    yield "pounds", body.mass / 0.45359237
    yield "thousandth", body.mass / 1000


def coms(body: Inertial) -> Iterator[tuple[str, np.ndarray]]:
    x, y, z = body.com
    yield "com_sign_x", np.array([-x, y, z])
    yield "com_sign_y", np.array([x, -y, z])
    yield "com_sign_z", np.array([x, y, -z])
    yield "com_mirrored", -body.com
    yield "turned_x", np.array([x, -y, -z])
    yield "turned_y", np.array([-x, y, -z])
    yield "turned_z", np.array([-x, -y, z])
    yield "zero", np.zeros(3)
    yield "millimetres", body.com * 1000
    yield "centimetres", body.com * 100
    yield "inches", body.com / 0.0254
    yield "thousandth", body.com / 1000
    yield "axes", np.array([y, x, z])
    yield "axes", np.array([z, x, y])
    yield "axes", np.array([x, -z, y])


def inertias(
    body: Inertial, rng: np.random.Generator
) -> Iterator[tuple[str, np.ndarray]]:
    xx, yy, zz, xy, xz, yz = six(body.inertia)
    yield "sign_ixy", tensor((xx, yy, zz, -xy, xz, yz))
    yield "sign_ixz", tensor((xx, yy, zz, xy, -xz, yz))
    yield "sign_iyz", tensor((xx, yy, zz, xy, xz, -yz))
    yield "solidworks", tensor((xx, yy, zz, -xy, -xz, -yz))
    yield "products_zeroed", np.diag([xx, yy, zz])
    yield "turned_x", tensor((xx, yy, zz, -xy, -xz, yz))
    yield "turned_y", tensor((xx, yy, zz, -xy, xz, -yz))
    yield "turned_z", tensor((xx, yy, zz, xy, -xz, -yz))
    yield "axes", tensor((yy, xx, zz, xy, yz, xz))
    yield "axes", tensor((zz, xx, yy, xz, yz, xy))
    yield "zero", np.zeros((3, 3))

    moments = np.sort(np.linalg.eigvalsh(body.inertia))
    for order in itertools.permutations(moments):
        yield "principal", np.diag(order)

    yield "order", tensor((xx, yy, zz, xz, xy, yz))
    yield "order", tensor((xx, yy, zz, yz, xz, xy))
    yield "order", tensor((xx, yy, zz, xy, yz, xz))
    yield "order", tensor((xx, zz, yy, xy, xz, yz))
    rows = (xx, xy, xz, yy, yz, zz)
    columns = (xx, xy, yy, xz, yz, zz)
    yield "order", tensor(rows)
    yield "order", tensor(columns)
    yield "order", tensor((rows[0], rows[2], rows[5], rows[1], rows[3], rows[4]))

    term = steiner(body.mass, body.com)
    yield "i_link", body.inertia + term
    sx = tensor(six(body.inertia + term) * [1, 1, 1, -1, -1, -1])
    yield "i_link_solidworks", sx
    yield "term_subtracted", body.inertia - term

    yield "no_parallel_axis", body.inertia - of_two_parts(body, rng)
    far = rng.uniform(-0.05, 0.05, 3)
    yield "wrong_point", body.inertia + steiner(body.mass, far)

    for name, factor in (
        ("g_mm2", 1e9),
        ("kg_mm2", 1e6),
        ("g_cm2", 1e7),
        ("g_m2", 1e3),
        ("thousandth", 1e-3),
        ("millionth", 1e-6),
        ("scaled", rng.uniform(1.2, 3.0)),
    ):
        yield name, body.inertia * factor


def of_two_parts(body: Inertial, rng: np.random.Generator) -> np.ndarray:
    """The parallel-axis terms of two parts that lie along the body's longest extent."""
    moments, axes = np.linalg.eigh(body.inertia)
    spread = (moments.sum() / 2 - moments[0]) / body.mass
    share = rng.uniform(0.3, 0.7)
    apart = math.sqrt(rng.uniform(0.5, 0.9) * spread / (share * (1 - share)))
    first = axes[:, 0] * apart * (1 - share)
    second = -axes[:, 0] * apart * share
    return steiner(share * body.mass, first) + steiner((1 - share) * body.mass, second)


def of_the_document(k: int, body: Inertial) -> Iterator[tuple[str, str, np.ndarray]]:
    """Mistakes with the frames and tables of the document: id, quantity, value."""
    here = reference.inertial_frames(np.zeros(4))
    chain = reference.dh_frames(np.zeros(4))
    frames = {f"dh_{i}": frame for i, frame in enumerate(chain)}
    frames |= {f"frame_{i}": here[i] for i in range(5) if i != k}
    for name, frame in frames.items():
        to_frame = np.linalg.inv(frame) @ here[k]
        turn = to_frame[:3, :3]
        yield name, "com", turn @ body.com + to_frame[:3, 3]
        yield name, "inertia", turn @ body.inertia @ turn.T

    for i in range(5):
        if i != k:
            yield f"link_{i}", "mass", np.array(reference.MASS[i])
            yield f"link_{i}", "com", np.array(reference.COM[i]) / 1e3
            other = tensor(np.array(reference.INERTIA[i]) / 1e6, -1)
            yield f"link_{i}", "inertia", other
    yield "cob", "com", np.array(reference.COB[k]) / 1e3
    yield "water", "mass", np.array(reference.VOLUME[k])
    yield "earlier_revision", "mass", np.array(OLD_MASS[k])
    yield "earlier_revision", "com", np.array(OLD_COM[k]) / 1e3
    old = tensor(np.array(OLD_INERTIA[k]) / 1e6, -1)
    yield "earlier_revision", "inertia", old


# ------------------------------------------------------------------- mistakes in joints


def of_joints(root: ET.Element) -> Iterator[Damage]:
    """Millimetres and degrees in every joint, and axes of the arm's four."""
    for joint in root.iter("joint"):
        name = joint.get("name")
        if name == "mount":  # where an arm is mounted is not the arm's
            continue
        origin = joint.find("origin")
        xyz = numbers(origin.get("xyz"))
        rpy = numbers(origin.get("rpy"))
        yield Damage("millimetres", name, "xyz", xyz * 1000)
        yield Damage("degrees", name, "rpy", np.degrees(rpy))
        if name.endswith(ARM_JOINTS):
            x, y, z = numbers(joint.find("axis").get("xyz"))
            yield Damage("reversed", name, "axis", np.array([-x, -y, -z]))
            yield Damage("exchanged_axis", name, "axis", np.array([z, x, y]))
            yield Damage("exchanged_axis", name, "axis", np.array([y, z, x]))


# ----------------------------------------------------------------------------- the list


def single_mistakes(text: str, *, of_document: bool) -> list[Damage]:
    """Every single mistake at every place of a URDF.

    Args:
        text: The URDF.
        of_document: Whether its links carry Table 2's numbers, so that frames and
            tables of the document lead to mistakes, too.
    """
    root = ET.fromstring(text)
    rng = np.random.default_rng(43)
    found = list(of_joints(root))
    for link in root.iter("link"):
        body = inertial(link)
        if body is None:
            continue
        name = link.get("name")
        made = [(one, "mass", np.array(value)) for one, value in masses(body)]
        made += [(one, "com", value) for one, value in coms(body)]
        made += [(one, "inertia", value) for one, value in inertias(body, rng)]
        if of_document and name in LINKS:
            made += of_the_document(LINKS.index(name), body)
        found += [Damage(one, name, what, value) for one, what, value in made]
    return [
        damage._replace(names=frozenset(_same(damage, found)))
        for damage in found
        if _changes(root, damage)
    ]


def _changes(root: ET.Element, damage: Damage) -> bool:
    """Whether a number changes by more than the file's digits."""
    if damage.quantity in HALF_DIGITS:
        body = inertial(named(root, "link", damage.where))
        right = getattr(body, damage.quantity)
        off = float(np.abs(damage.value - right).max())
        # Half a digit of the file, and half of one of Table 2.
        return off > 2 * HALF_DIGITS[damage.quantity]
    joint = named(root, "joint", damage.where)
    if damage.quantity == "axis":
        return True
    right = numbers(joint.find("origin").get(damage.quantity))
    return float(np.abs(damage.value - right).max()) > 1e-6


def _same(damage: Damage, others: Iterable[Damage]) -> Iterator[str]:
    """Ids of the mistakes that write the same number, to the file's digits."""
    for other in others:
        if other.place == damage.place:
            digits = HALF_DIGITS.get(damage.quantity, 1e-6)
            size = max(1.0, float(np.abs(damage.value).max()))
            if np.abs(other.value - damage.value).max() <= 4 * digits * size:
                yield other.id
