"""The committed URDF files and their variants against the document, by other tools.

`test_urdf` has the frames, tensors and jaws of the committed files. Here are the rest
of their numbers, and the same promises for the variants that the generator offers.
"""

from __future__ import annotations

import math
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import reference

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH
from alpha5_model.description.urdf import Variant, urdf

COMMITTED = {
    "locked": Path(a5.URDF_PATH).read_text(encoding="utf-8"),
    "jaws": Path(JAWS_URDF_PATH).read_text(encoding="utf-8"),
}
VARIANTS = {
    "on a vehicle": Variant(
        prefix="left_",
        gripper="jaws",
        parent="vehicle",
        xyz=(0.1, 0.2, 0.3),
        rpy=(1, 2, 3),
    ),
    "with DH frames": Variant(dh_frames=True, collision="none"),
    "with ros2_control": Variant(ros2_control=True, parent="world"),
}
TEXTS = COMMITTED | {name: urdf(variant) for name, variant in VARIANTS.items()}
every_text = pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)

#: Joint -> child, speed [rad/s or m/s], effort [N m or N]; limits are in `reference`.
JOINTS = {
    "axis_e": ("link_1", math.radians(30), 9.0),
    "axis_d": ("link_2", math.radians(30), 9.0),
    "axis_c": ("link_3", math.radians(30), 9.0),
    "axis_b": ("link_4", math.radians(50), 9.0),
}
ROD = {"lower": 0.0013, "upper": 0.0133, "velocity": 0.003, "effort": 10.0}


def prefix_of(text: str) -> str:
    return "left_" if "left_base_link" in text else ""


def corners() -> np.ndarray:
    """Every corner of the limits, and positions within them."""
    ends = np.stack([reference.LOWER, reference.UPPER], axis=-1)
    grid = np.meshgrid(*ends, indexing="ij")
    inside = list(reference.configurations(30, seed=6))
    return np.vstack([np.stack(grid, axis=-1).reshape(-1, 4), inside])


def frame_error(text: str) -> float:
    """Largest difference of a link's pose in base_link from the document's."""
    prefix = prefix_of(text)
    model = pin.buildModelFromXML(text)
    data = model.createData()
    names = [*(f"link_{i}" for i in range(5)), "tcp"]
    ids = [model.getFrameId(prefix + name, pin.FrameType.BODY) for name in names]
    base = model.getFrameId(prefix + "base_link", pin.FrameType.BODY)
    columns = [model.joints[model.getJointId(prefix + j)].idx_q for j in JOINTS]
    worst = 0.0
    position = pin.neutral(model)
    for q in corners():
        position[columns] = q
        pin.framesForwardKinematics(model, data, position)
        expected = [*reference.inertial_frames(q), reference.dh_frames(q)[5]]
        for frame, pose in zip(ids, expected, strict=True):
            found = (data.oMf[base].inverse() * data.oMf[frame]).homogeneous
            worst = max(worst, np.abs(found - pose).max())
    return worst


@every_text
def test_every_frame_is_where_the_document_puts_it(text: str) -> None:
    assert frame_error(text) < 1e-12


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('xyz="0.02 0.0 0.0462"', 'xyz="0.02 0.0 0.047"'),
        ('1.3021582029078473 0.0"', '1.3021582039078473 0.0"'),
    ],
)
def test_a_joint_that_is_elsewhere_is_found(old: str, new: str) -> None:
    for text in COMMITTED.values():
        assert text.count(old) >= 1
        assert frame_error(text.replace(old, new, 1)) > 1e-10


def test_the_letter_of_the_document_turns_the_base() -> None:
    """Without the correction base_frame link_0 is turned by pi, and nothing else."""
    letter = urdf(Variant(corrections=()))
    turned = pin.buildModelFromXML(letter)
    ours = pin.buildModelFromXML(COMMITTED["locked"])
    frames = [(m, m.getFrameId("link_0")) for m in (turned, ours)]
    there, here = (m.frames[k].placement.rotation for m, k in frames)
    np.testing.assert_allclose(there, here @ np.diag([-1, -1, 1]), atol=1e-15)
    assert [*turned.jointPlacements] == [*ours.jointPlacements]


@every_text
def test_joints_are_the_arms(text: str) -> None:
    """Parents, children, axes, limits, speeds and efforts."""
    prefix = prefix_of(text)
    root = ET.fromstring(text)
    for i, (name, (child, speed, effort)) in enumerate(JOINTS.items()):
        joint = root.find(f"joint[@name='{prefix}{name}']")
        assert joint.get("type") == "revolute"
        assert joint.find("parent").get("link") == f"{prefix}link_{i}"
        assert joint.find("child").get("link") == prefix + child
        assert [float(x) for x in joint.find("axis").get("xyz").split()] == [0, 0, 1]
        limit = {key: float(x) for key, x in joint.find("limit").attrib.items()}
        assert limit == {
            "lower": reference.LOWER[i],
            "upper": reference.UPPER[i],
            "velocity": pytest.approx(speed, rel=1e-15),
            "effort": effort,
        }
    rod = root.find(f"joint[@name='{prefix}axis_a']")
    if rod is not None:
        assert rod.get("type") == "prismatic"
        assert rod.find("parent").get("link") == f"{prefix}link_4"
        limit = {key: float(x) for key, x in rod.find("limit").attrib.items()}
        assert limit == pytest.approx(ROD, rel=1e-15)


@every_text
def test_links_before_the_jaws_are_table_2s(text: str) -> None:
    """Masses, COMs and tensors of links 0 to 3, or 0 to 4, to the last digit."""
    prefix = prefix_of(text)
    root = ET.fromstring(text)
    for i in range(4 if f"{prefix}jaw_rod" in text else 5):
        inertial = root.find(f"link[@name='{prefix}link_{i}']/inertial")
        assert float(inertial.find("mass").get("value")) == reference.MASS[i]
        com = [float(x) for x in inertial.find("origin").get("xyz").split()]
        assert com == pytest.approx(np.array(reference.COM[i]) / 1e3, rel=1e-15)
        tensor = {k: float(x) for k, x in inertial.find("inertia").attrib.items()}
        xx, yy, zz, xy, xz, yz = np.array(reference.INERTIA[i]) * 1e-6
        expected = {"ixx": xx, "iyy": yy, "izz": zz, "ixy": -xy, "ixz": -xz, "iyz": -yz}
        assert tensor == pytest.approx(expected, rel=1e-15)


@every_text
def test_the_whole_arm_weighs_what_the_table_says(text: str) -> None:
    """No link has a mass beside Table 2's, whatever its name."""
    masses = [float(mass.get("value")) for mass in ET.fromstring(text).iter("mass")]
    assert sum(masses) == pytest.approx(sum(reference.MASS), abs=1e-12)


@every_text
def test_every_link_is_a_possible_body_or_says_that_it_is_massless(text: str) -> None:
    """PyBullet gives a link without an inertial element a mass of 1 kg."""
    root = ET.fromstring(text)
    carried = {joint.find("child").get("link") for joint in root.findall("joint")}
    for link in root.findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            assert link.get("name") not in carried
            continue
        mass = float(inertial.find("mass").get("value"))
        t = {k: float(x) for k, x in inertial.find("inertia").attrib.items()}
        if mass == 0:
            assert set(t.values()) == {0.0}
            continue
        a, b, c = np.linalg.eigvalsh(
            [
                [t["ixx"], t["ixy"], t["ixz"]],
                [t["ixy"], t["iyy"], t["iyz"]],
                [t["ixz"], t["iyz"], t["izz"]],
            ]
        )
        assert mass > 0
        assert a > 0
        assert a + b > c


@pytest.mark.tools
@every_text
def test_check_urdf_reads_it(text: str, tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(text, encoding="utf-8")
    program = Path(sys.executable).with_name("check_urdf")  # the pin wheel brings it
    done = subprocess.run(
        [program, file], capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert "Successfully Parsed XML" in done.stdout
