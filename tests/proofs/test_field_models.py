"""`compare` on models as public reports describe them, and others of their kind.

Principal moments whose rotation was lost, tensors in another order or without their
parallel-axis terms, mixed units are named and mended. Fixed links that are split, and
frames that are chosen otherwise, are no differences.
"""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import damaged_models as dm
import numpy as np
import pinocchio as pin
import pytest
import shared_recordings as recordings

import alpha5_model as a5
from alpha5_model.proofs.comparison.result import Comparison

LOCKED = Path(a5.URDF_PATH).read_text("utf-8")
JAWS = Path(a5.URDF_PATH).with_name("alpha5_jaws.urdf").read_text("utf-8")
FIELD = recordings.RECORDINGS / "field"
needs_field = pytest.mark.skipif(
    not FIELD.is_dir(),
    reason="no recordings: the folder shared/data beside the checkout is absent",
)


def compared(text: str, folder: Path) -> Comparison:
    path = folder / "other.urdf"
    path.write_text(text, encoding="utf-8")
    return a5.compare(path, samples=20)


def named(result: Comparison) -> set[tuple[str, str]]:
    """Where each serious finding is, and the id of the mistake that explains it.

    That a program refuses such a tensor is another finding of the same mistake.
    """
    serious = [f for f in result.findings if f.serious and f.id != "lint.impossible"]
    return {(f.where, f.mistake) for f in serious}


def mended(text: str, result: Comparison) -> str:
    return dm.apply(text, itertools.chain(*(f.corrections for f in result.findings)))


def check(text: str, expected: set[tuple[str, str]], folder: Path) -> None:
    """The file has these mistakes and no others, and agrees once they are mended."""
    result = compared(text, folder)
    assert named(result) == expected
    assert compared(mended(text, result), folder).agrees


def body_of(text: str, link: str) -> dm.Inertial:
    body = dm.inertial(dm.named(ET.fromstring(text), "link", link))
    assert body is not None
    return body


def wrong_tensors(text: str, make: dict[str, np.ndarray]) -> str:
    damages = [dm.Damage("", link, "inertia", tensor) for link, tensor in make.items()]
    return dm.damaged(text, *damages)


# ---------------------------------------------------------------- the reported files


@needs_field
@pytest.mark.parametrize(
    ("file", "expected"),
    [
        ("02_rotated_inertial/principal_lost.urdf", {("link_2", "principal")}),
        ("03_fused_fixed_links/split.urdf", set()),
        ("04_row_major_slip/ixy_ixz_swapped.urdf", {("link_2", "order")}),
        (
            "05_no_parallel_axes/arm.urdf",
            {(f"link_{k}", "no_parallel_axis") for k in range(5)},
        ),
        (
            "20_units/grams_g_mm2.urdf",
            {(f"link_{k}", unit) for k in range(5) for unit in ("grams", "g_mm2")},
        ),
        (
            "20_units/joints_mm.urdf",
            {
                (joint, "millimetres")
                for joint in ("axis_d", "axis_c", "axis_b", "tcp_fixed")
            },
        ),
    ],
)
def test_a_reported_file(
    file: str, expected: set[tuple[str, str]], tmp_path: Path
) -> None:
    check((FIELD / file).read_text("utf-8"), expected, tmp_path)


# ------------------------------------------------------------------ others of the kind


def principal(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    return np.diag(rng.permutation(np.linalg.eigvalsh(body.inertia)))


def column_by_column(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    xx, yy, zz, xy, xz, yz = dm.six(body.inertia)
    return dm.tensor((xx, xy, yy, xz, yz, zz))


def row_by_row(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    xx, yy, zz, xy, xz, yz = dm.six(body.inertia)
    return dm.tensor((xx, xy, xz, yy, yz, zz))


def voigt(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    xx, yy, zz, xy, xz, yz = dm.six(body.inertia)
    return dm.tensor((xx, yy, zz, yz, xz, xy))


def of_two_parts(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    return body.inertia - dm.of_two_parts(body, rng)


def of_three_parts(body: dm.Inertial, rng: np.random.Generator) -> np.ndarray:
    """Less the terms of three parts in a plane through the COM."""
    moments, axes = np.linalg.eigh(body.inertia)
    spread = np.sqrt((moments.sum() / 2 - moments) / body.mass)
    corners = np.array([[1, 0.2], [-0.4, 0.7], [-0.6, -0.9]])
    corners *= rng.uniform(0.3, 0.6)
    terms = np.zeros((3, 3))
    for along, across in corners:
        place = along * spread[0] * axes[:, 0] + across * spread[1] * axes[:, 1]
        terms += dm.steiner(body.mass / 3, place)
    return body.inertia - terms


@pytest.mark.parametrize(
    ("make", "mistake"),
    [
        (principal, "principal"),
        (row_by_row, "order"),
        (column_by_column, "order"),
        (voigt, "order"),
        (of_two_parts, "no_parallel_axis"),
        (of_three_parts, "no_parallel_axis"),
    ],
)
@pytest.mark.parametrize("seed", range(4))
def test_wrong_tensors_of_some_links_are_named(
    make: Callable[[dm.Inertial, np.random.Generator], np.ndarray],
    mistake: str,
    seed: int,
    tmp_path: Path,
) -> None:
    rng = np.random.default_rng(seed)
    links = rng.choice(dm.LINKS, rng.integers(1, 6), replace=False).tolist()
    wrong = {link: make(body_of(LOCKED, link), rng) for link in links}
    check(wrong_tensors(LOCKED, wrong), {(link, mistake) for link in links}, tmp_path)


#: Unit of a link -> factors of mass, COM and tensor, and the mistakes that they are.
UNITS = {
    "grams": (1e3, 1, 1, {"grams"}),
    "grams, g mm^2": (1e3, 1, 1e9, {"grams", "g_mm2"}),
    "millimetres, kg mm^2": (1, 1e3, 1e6, {"millimetres", "kg_mm2"}),
    "centimetres": (1, 1e2, 1, {"centimetres"}),
    "grams, millimetres, g cm^2": (1e3, 1e3, 1e7, {"grams", "millimetres", "g_cm2"}),
}


@pytest.mark.parametrize("seed", range(8))
def test_units_that_differ_from_link_to_link_are_named(
    seed: int, tmp_path: Path
) -> None:
    rng = np.random.default_rng(seed)
    text = JAWS if seed % 4 == 3 else LOCKED
    damages = []
    expected = set()
    for link in rng.choice(dm.LINKS, rng.integers(1, 6), replace=False):
        body = body_of(text, link)
        *factors, mistakes = UNITS[rng.choice(list(UNITS))]
        for what, factor in zip(("mass", "com", "inertia"), factors, strict=True):
            if factor != 1:
                value = np.array(getattr(body, what)) * factor
                damages.append(dm.Damage("", link, what, value))
        expected |= {(str(link), mistake) for mistake in mistakes}

    every = [d for d in dm.of_joints(ET.fromstring(text)) if d.value.any()]
    for kind in ("millimetres", "degrees"):
        joints = [d for d in every if d.id == kind]
        for k in rng.choice(len(joints), rng.integers(0, 4), replace=False):
            damages.append(joints[k])
            expected.add((joints[k].where, kind))
    check(dm.damaged(text, *damages), expected, tmp_path)


# ------------------------------------------------------- no differences: other frames


def random_frame(rng: np.random.Generator, size: float = 0.1) -> pin.SE3:
    return pin.SE3(pin.exp3(rng.uniform(-2, 2, 3)), rng.uniform(-size, size, 3))


def write_origin(element: ET.Element, frame: pin.SE3) -> None:
    element.set("xyz", dm.text_of(frame.translation))
    element.set("rpy", dm.text_of(pin.rpy.matrixToRpy(frame.rotation)))


def read_origin(element: ET.Element) -> pin.SE3:
    rpy = dm.numbers(element.get("rpy"))
    return pin.SE3(pin.rpy.rpyToMatrix(rpy), dm.numbers(element.get("xyz")))


def write_inertial(link: ET.Element, body: pin.Inertia) -> None:
    for old in link.findall("inertial"):
        link.remove(old)
    element = ET.SubElement(link, "inertial")
    ET.SubElement(element, "origin", xyz=dm.text_of(body.lever), rpy="0 0 0")
    ET.SubElement(element, "mass", value=repr(float(body.mass)))
    entries = zip(("ixx", "ixy", "iyy", "ixz", "iyz", "izz"), lower(body), strict=True)
    ET.SubElement(element, "inertia", {name: repr(x) for name, x in entries})


def lower(body: pin.Inertia) -> list[float]:
    matrix = body.inertia
    return [float(matrix[i, j]) for i in range(3) for j in range(i + 1)]


def pin_inertia(link: ET.Element) -> pin.Inertia:
    body = dm.inertial(link)
    assert body is not None
    return pin.Inertia(body.mass, body.com, body.inertia)


def split(root: ET.Element, link: str, rng: np.random.Generator) -> str:
    """Give a part of a link to a new one that is fixed to it; return its name."""
    parent = dm.named(root, "link", link)
    whole = pin_inertia(parent)
    while True:
        part = pin.Inertia(
            whole.mass * rng.uniform(0.05, 0.4),
            whole.lever + rng.uniform(-0.01, 0.01, 3),
            rng.uniform(0.05, 0.2) * whole.inertia,
        )
        rest = whole - part
        moments = np.linalg.eigvalsh(rest.inertia)
        if moments[0] > 0 and moments[2] < moments[0] + moments[1]:
            break
    frame = random_frame(rng)
    name = f"{link}_part_{rng.integers(10**6)}"
    child = ET.SubElement(root, "link", name=name)
    write_inertial(child, frame.actInv(part))
    write_inertial(parent, rest)
    joint = ET.SubElement(root, "joint", name=f"{name}_joint", type="fixed")
    write_origin(ET.SubElement(joint, "origin"), frame)
    ET.SubElement(joint, "parent", link=link)
    ET.SubElement(joint, "child", link=name)
    return name


def split_at_random(rng: np.random.Generator) -> str:
    root = ET.fromstring(LOCKED)
    links = list(dm.LINKS)
    for _ in range(rng.integers(1, 6)):
        links.append(split(root, str(rng.choice(links)), rng))
    return ET.tostring(root, encoding="unicode")


def with_other_frames(text: str, rng: np.random.Generator) -> str:
    """The same arm, with another frame in each moving link: only text changes."""
    root = ET.fromstring(text)
    for link in dm.LINKS[1:]:
        frame = random_frame(rng, 0.05)
        carrier = next(
            j for j in root.iter("joint") if j.find("child").get("link") == link
        )
        axis = dm.numbers(carrier.find("axis").get("xyz"))
        # A revolute joint turns about its child's origin, which stays on the axis.
        along = pin.SE3(frame.rotation, axis * frame.translation[0])
        write_origin(
            carrier.find("origin"), read_origin(carrier.find("origin")) * along
        )
        carrier.find("axis").set("xyz", dm.text_of(along.rotation.T @ axis))
        for joint in root.iter("joint"):
            if joint.find("parent").get("link") == link:
                origin = joint.find("origin")
                write_origin(origin, along.inverse() * read_origin(origin))
        element = dm.named(root, "link", link)
        write_inertial(element, along.actInv(pin_inertia(element)))
        for shape in (*element.findall("visual"), *element.findall("collision")):
            origin = shape.find("origin")
            write_origin(origin, along.inverse() * read_origin(origin))
    return ET.tostring(root, encoding="unicode")


@pytest.mark.parametrize("seed", range(6))
def test_split_links_agree(seed: int, tmp_path: Path) -> None:
    text = split_at_random(np.random.default_rng(seed))
    assert compared(text, tmp_path).agrees


@pytest.mark.parametrize("seed", range(6))
def test_other_frames_agree(seed: int, tmp_path: Path) -> None:
    text = with_other_frames(LOCKED, np.random.default_rng(seed))
    assert compared(text, tmp_path).agrees


@pytest.mark.parametrize("seed", range(6))
def test_a_split_link_with_another_mass_differs(seed: int, tmp_path: Path) -> None:
    rng = np.random.default_rng(seed)
    root = ET.fromstring(LOCKED)
    link = str(rng.choice(dm.LINKS))
    part = split(root, link, rng)
    text = ET.tostring(root, encoding="unicode")
    body = body_of(text, part)
    mass = dm.Damage("", part, "mass", np.array(body.mass * 1000))
    check(dm.damaged(text, mass), {(link, "grams")}, tmp_path)


@pytest.mark.parametrize("seed", range(6))
def test_mistakes_in_other_frames_are_named(seed: int, tmp_path: Path) -> None:
    """A mistake is made in the frame of the link that says the number."""
    rng = np.random.default_rng(seed)
    text = with_other_frames(LOCKED, rng)
    link = f"link_{rng.integers(1, 5)}"
    body = body_of(text, link)
    made = [d for d in dm.inertias(body, rng) if d[0] not in ("zero", "axes")]
    name, value = made[rng.integers(len(made))]
    expected = {one for one, other in made if np.allclose(other, value, atol=1e-9)}
    wrong = wrong_tensors(text, {link: value})
    result = compared(wrong, tmp_path)
    assert {f.mistake for f in result.findings if f.where == link} & expected, name
    assert compared(mended(wrong, result), tmp_path).agrees
    assert math.isclose(sum(result.gravity_error), 0.0, abs_tol=1e-6)


def fused_base(rng: np.random.Generator) -> str:
    """link_0 and base_link as one link."""
    root = ET.fromstring(LOCKED)
    base, link_0 = dm.named(root, "link", "base_link"), dm.named(root, "link", "link_0")
    base.extend(list(link_0))
    root.remove(link_0)
    root.remove(dm.named(root, "joint", "link_0_fixed"))
    dm.named(root, "joint", "axis_e").find("parent").set("link", "base_link")
    return ET.tostring(root, encoding="unicode")


def part_to(link: str, joint: str, other: str, rng: np.random.Generator) -> str:
    """A part of a link given to the one at the other end of a fixed joint."""
    root = ET.fromstring(LOCKED)
    whole = pin_inertia(dm.named(root, "link", link))
    shift = whole.lever + rng.uniform(-0.01, 0.01, 3)
    part = pin.Inertia(0.1 * whole.mass, shift, 0.05 * whole.inertia)
    to_parent = read_origin(dm.named(root, "joint", joint).find("origin"))
    is_parent = dm.named(root, "joint", joint).find("parent").get("link") == other
    frame = to_parent if is_parent else to_parent.inverse()
    write_inertial(dm.named(root, "link", other), frame.act(part))
    write_inertial(dm.named(root, "link", link), whole - part)
    return ET.tostring(root, encoding="unicode")


def part_in_base(rng: np.random.Generator) -> str:
    return part_to("link_0", "link_0_fixed", "base_link", rng)


def part_in_tool(rng: np.random.Generator) -> str:
    return part_to("link_4", "tcp_fixed", "tcp", rng)


@pytest.mark.parametrize("make", [fused_base, part_in_base, part_in_tool])
def test_bodies_that_are_shared_out_otherwise_agree(
    make: Callable[[np.random.Generator], str], tmp_path: Path
) -> None:
    text = make(np.random.default_rng(1))
    assert compared(text, tmp_path).agrees
    renamed = text.replace('"link_', '"body_').replace('"axis_', '"joint_')
    assert compared(renamed, tmp_path).agrees


@pytest.mark.parametrize("on_vehicle", [False, True])
@pytest.mark.parametrize(
    ("length", "mass", "units"),
    [
        (1e3, 1, ("millimetres", None, "kg_mm2")),
        (1e3, 1e3, ("millimetres", "grams", "g_mm2")),
        (1e2, 1, ("centimetres", None, "kg_cm2")),
    ],
)
def test_a_file_in_other_units_is_named_and_mended(
    on_vehicle: bool,
    length: float,
    mass: float,
    units: tuple[str, str | None, str],
    tmp_path: Path,
) -> None:
    root = ET.fromstring(LOCKED)
    if on_vehicle:
        vehicle = ET.SubElement(root, "link", name="vehicle")
        write_inertial(vehicle, pin.Inertia(11.0, np.zeros(3), 0.3 * np.eye(3)))
        joint = ET.SubElement(root, "joint", name="mount", type="fixed")
        ET.SubElement(joint, "origin", xyz="0.3 -0.2 0.5", rpy="0 0 0")
        ET.SubElement(joint, "parent", link="vehicle")
        ET.SubElement(joint, "child", link="base_link")
    for element in root.iter("origin"):
        element.set("xyz", dm.text_of(dm.numbers(element.get("xyz")) * length))
    for element in root.iter("mass"):
        element.set("value", repr(float(element.get("value")) * mass))
    for element in root.iter("inertia"):
        for name, value in element.attrib.items():
            element.set(name, repr(float(value) * mass * length**2))

    expected = {(f"link_{k}", unit) for k in range(5) for unit in units if unit}
    expected |= {(j, units[0]) for j in ("axis_d", "axis_c", "axis_b", "tcp_fixed")}
    check(ET.tostring(root, encoding="unicode"), expected, tmp_path)
