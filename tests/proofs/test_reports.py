"""Reports of whole models and the figures of the audit, as files that a person reads.

Other tests compare parts of them with Pinocchio and the tables. These hold all figures
and words at once: a change of one is seen in review. After a change that you meant, run
``ALPHA5_UPDATE_PRINTED=1 python -m pytest tests/proofs/test_reports.py`` and read the
difference.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import known_mistakes
import model_defects
import numpy as np
import pinocchio as pin
import pytest
import shared_recordings as recordings
from committed_texts import check_committed
from urdf_edits import OWN

from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.proofs.comparison.arm_of_model import arm_of_robot, arm_text
from alpha5_model.proofs.comparison.findings import finding_ids
from alpha5_model.proofs.comparison.junit import junit_report
from alpha5_model.proofs.comparison.measure import compare_robots
from alpha5_model.proofs.comparison.records import Comparison, Finding

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
FOLDER = Path(__file__).parent / "reports"
MODELS = recordings.RECORDINGS / "models"
NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]\d+)?|-?\d+e[-+]\d+")
Change = Callable[[ET.Element], None]


def short(value: float) -> str:
    """A number without what rounding leaves of it."""
    return f"{value:.6g}" if abs(value) > 1e-9 else "0"


def shortened(text: str) -> str:
    """A text with short numbers."""
    return NUMBER.sub(lambda found: short(float(found[0])), text)


def numbers(values: Any) -> str:
    return " ".join(short(value) for value in np.ravel(values))


# --- models


def report(lines: Iterable[str]) -> str:
    return shortened("\n".join(lines)).rstrip() + "\n"


def lines_of(comparison: Comparison) -> Iterator[str]:
    yield comparison.verdict
    yield ", ".join(f"{own} = {name}" for own, name in comparison.joints.items())
    for found in comparison.findings:
        yield from lines_of_finding(found)
    if not comparison.joints:
        return
    alignment = comparison.alignment
    yield f"base {numbers(alignment.base)}"
    yield f"base_link {alignment.base_link} {alignment.same_base}"
    yield f"stands {numbers(alignment.stands)}"
    yield f"sign {numbers(alignment.sign)}; zero {numbers(alignment.zero)}"
    yield f"residual {numbers(alignment.residual)}"
    for name, change in alignment.changes().items():
        yield f"{name} {short(change)}"
    if comparison.tool is not None:
        for name, value in comparison.tool.as_dict().items():
            yield f"tool {name} {value if isinstance(value, str) else short(value)}"
    yield f"gravity {numbers(comparison.gravity_error)}"
    yield f"mass matrix {short(comparison.mass_matrix_error)}"
    yield f"volume {short(comparison.volume)}; carried {comparison.carried}"
    for body in comparison.bodies:
        yield f"{body.name}: {', '.join(body.links)}: {short(body.mass)}"
        yield f"  com {numbers(body.com)}; slack {short(body.slack)}"
        yield f"  inertia {numbers(body.inertia)}"


def lines_of_finding(found: Finding) -> Iterator[str]:
    kind = "serious" if found.serious else "remark"
    yield f"- {found.where} ({found.id}, {kind}, {short(found.cost)} N m)"
    yield f"  {found.text}"
    if found.instead:
        yield f"  write {found.instead}"


PUBLIC = ("evan_palmer_alpha", "hkolano_blue_rov", "diff_uvms")


# --- an example of every finding


def defects(*names: str) -> Change:
    """Defects that other tests measure one at a time."""

    def change(root: ET.Element) -> None:
        for name in names:
            model_defects.DEFECTS[name](root)

    return change


def add_link(root: ET.Element, name: str, mass: float, inertia: float = 1e-3) -> None:
    link = ET.SubElement(root, "link", name=name)
    body = ET.SubElement(link, "inertial")
    ET.SubElement(body, "origin", xyz="0.01 0 0.02", rpy="0 0 0")
    ET.SubElement(body, "mass", value=str(mass))
    moments = dict.fromkeys(("ixx", "iyy", "izz"), str(inertia))
    ET.SubElement(body, "inertia", moments | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))


def add_joint(root: ET.Element, parent: str, child: str, xyz: str = "0 0 0") -> None:
    joint = ET.SubElement(root, "joint", name=f"{parent}_{child}", type="fixed")
    ET.SubElement(joint, "origin", xyz=xyz, rpy="0.2 0.1 -0.4")
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)


def on_a_vehicle(root: ET.Element) -> None:
    add_link(root, "hull", 9.5)
    for name, mass, xyz in (
        ("plate", 0.4, "0.3 -0.1 0.2"),
        ("camera", 1.2, "0.1 0 0"),
        ("left_lamp", 0.3, "0.2 0.1 0"),
        ("right_lamp", 0.3, "0.2 -0.1 0"),
    ):
        add_link(root, name, mass)
        add_joint(root, "hull", name, xyz)
    add_joint(root, "plate", "base_link", "0 0 0.05")


def without_a_known_base(root: ET.Element) -> None:
    """The links before axis_e have other names, weigh nothing and lie elsewhere."""
    model_defects.without("link_0", "inertial")(root)
    for name, new in (("base_link", "platform"), ("link_0", "turret")):
        root.find(f"link[@name='{name}']").set("name", new)
        for end in root.iter():
            if end.get("link") == name:
                end.set("link", new)
    defects("link_0 elsewhere")(root)
    model_defects.shift("axis_e", 0.1, 0.2, -0.1)(root)


def endless_and_weightless(root: ET.Element) -> None:
    joint = root.find("joint[@name='axis_b']")
    joint.remove(joint.find("limit"))
    joint.set("type", "continuous")
    model_defects.inertial("link_3", "mass", value="0")(root)


def with_dummies(root: ET.Element) -> None:
    for name, mass in (("rod", 1e-4), ("shell", 1e-4), ("motor", 0.05)):
        add_link(root, name, mass, inertia=0.04)
        add_joint(root, "link_4", name)


def with_lost_meshes(root: ET.Element) -> None:
    for kind in ("visual", "collision"):
        shape = ET.SubElement(root.find("link[@name='link_2']"), kind)
        geometry = ET.SubElement(shape, "geometry")
        ET.SubElement(geometry, "mesh", filename=f"{kind}.stl")


def in_the_vehicle_itself(root: ET.Element) -> None:
    model_defects.inertial("link_0", "mass", value="11.5")(root)


def with_few_digits(root: ET.Element) -> None:
    for origin in root.findall("joint/origin"):
        xyz = model_defects.vector(origin.get("xyz")).round(3)
        rpy = model_defects.vector(origin.get("rpy")).round(3)
        origin.set("xyz", model_defects.written(xyz))
        origin.set("rpy", model_defects.written(rpy))


def twisted_axes(root: ET.Element) -> None:
    model_defects.turn("axis_d", 0.0, 0.05, 0.0)(root)
    origin = model_defects.origin_of(root, "axis_b")
    untwisted = model_defects.rotation(model_defects.vector(origin.get("rpy")))
    twisted = model_defects.rotation((0.03, 0.0, 0.0)) @ untwisted
    origin.set("rpy", model_defects.written(pin.rpy.matrixToRpy(twisted)))


def two_arms(root: ET.Element) -> None:
    """Two equal arms on a plate; the names of the second one begin with another_."""
    copies = [element for element in root if element.tag in ("link", "joint")]
    text = "".join(ET.tostring(one, encoding="unicode") for one in copies)
    text = re.sub('(name|link)="', r'\1="another_', text)
    root.extend(ET.fromstring(f"<arm>{text}</arm>"))
    add_link(root, "plate", 0.6)
    add_joint(root, "plate", "base_link", "0.2 0 0")
    add_joint(root, "plate", "another_base_link", "-0.2 0 0")


def longer_arm(root: ET.Element) -> None:
    defects("elbow too far", "elbow tilted")(root)
    model_defects.shift("axis_b", 0.2, 0.1, 0.0)(root)


def frozen_elbow(root: ET.Element) -> None:
    root.find("joint[@name='axis_c']").set("type", "fixed")


MODELS_OF_DEFECTS: dict[str, list[Change]] = {
    "far_tool": [
        defects("tool too far", "shoulder aside", "zero of axis_b", "axis_c reversed"),
        defects("mass", "limits in degrees"),
    ],
    "skew_elbow": [
        defects("tool at the finger tips", "base aside", "elbow too far"),
        defects("elbow tilted", "COM on the other side", "limits"),
    ],
    "turned_tool": [
        defects("tool turned", "base high", "wrist too far", "wrist tilted"),
        defects("axis_d reversed", "tensor"),
    ],
    "other_side": [
        defects("no tool", "shoulder on the other side", "zero of axis_c"),
        defects("turned tensor", "link without inertial", "mounted"),
    ],
    "short_pi": [
        defects("zero of axis_e", "wrist on the other side", "elbow off the plane"),
        defects("short pi", "link_0 elsewhere"),
    ],
    "upside_down": [
        defects("axis_e turned about x", "no inertials", "other frames"),
        defects("limits of all in degrees"),
    ],
    "vehicle": [on_a_vehicle, defects("axis_b reversed", "base tilted")],
    "no_base": [without_a_known_base, defects("zero of axis_d")],
    "endless": [endless_and_weightless, with_dummies, with_lost_meshes],
    "no_link_0": [in_the_vehicle_itself, known_mistakes.too_much_water],
    "few_digits": [with_few_digits, known_mistakes.greedy_mimic],
    "twisted": [twisted_axes, known_mistakes.solidworks_sign],
    "two_arms": [two_arms],
    "longer": [longer_arm],
    "frozen": [frozen_elbow],
}


def example(name: str) -> UrdfRobot:
    root = ET.fromstring(OWN)
    for change in MODELS_OF_DEFECTS[name]:
        change(root)
    return parse_urdf(ET.tostring(root))


@pytest.mark.parametrize("name", ["far_tool", "vehicle"])
def test_reports_of_examples(name: str) -> None:
    lines = list(lines_of(compare_robots(example(name), samples=20, folder=FOLDER)))
    check_committed(FOLDER / f"{name}.txt", report(lines))


def test_an_arm_file_of_an_example() -> None:
    described = arm_of_robot(example("vehicle"))
    text = arm_text(described, "vehicle.urdf")
    check_committed(FOLDER / "vehicle.toml", shortened(text))


def test_a_junit_report_of_an_example() -> None:
    comparison = compare_robots(example("vehicle"), samples=20, folder=FOLDER)
    text = shortened(junit_report(comparison, "vehicle"))
    check_committed(FOLDER / "vehicle.xml", text)


#: The words that all findings about dimensions share; what remains if no other finding
#: explains a joint, which no known model has; and those of public models alone.
WITHOUT_EXAMPLE = {"dimension", "misplaced", "volume"}


@pytest.mark.slow
def test_every_finding_has_an_example() -> None:
    shown = set()
    for name in MODELS_OF_DEFECTS:
        found = compare_robots(example(name), samples=5, folder=FOLDER).findings
        shown |= {one.id for one in found}
    assert shown == set(finding_ids()) - WITHOUT_EXAMPLE
