"""Joint limits of the user's own, through plain xacro."""

from __future__ import annotations

import math
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.errors import FileFormatError

XACRO = Path(XACRO_PATH).parent
PLAIN = [
    sys.executable,
    "-c",
    "import sys; sys.path.pop(0); import xacro; xacro.main()",
]
ROBOT = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="vehicle">
  <xacro:include filename="{folder}/alpha5_macro.xacro"/>
  <link name="vehicle"/>
  <xacro:alpha5 parameters="${{xacro.load_yaml('{folder}/parameters.yaml')}}"
                parent="vehicle" prefix="left_" gripper="jaws" limits_file="own.yaml">
    <origin xyz="0.2 0 -0.1" rpy="0 0 0"/>
  </xacro:alpha5>
</robot>
"""


def joints(text: str, prefix: str = "") -> dict[str, dict[str, float]]:
    return {
        joint.get("name", "").removeprefix(prefix): {
            k: float(v) for k, v in joint.find("limit").attrib.items()
        }
        for joint in ET.fromstring(text).iter("joint")
        if joint.find("limit") is not None
    }


def ranges_of_interfaces(text: str) -> dict[str | None, list[float]]:
    """Name of a joint -> the ends of the ranges of its command interfaces."""
    ranges: dict[str | None, list[float]] = {}
    for joint in ET.fromstring(text).iter("joint"):
        for interface in joint.findall("command_interface"):
            limits = [p for p in interface if p.get("name") in ("min", "max")]
            ends = [float(limit.text or "") for limit in limits]
            ranges.setdefault(joint.get("name"), []).extend(ends)
    return ranges


def test_the_example_changes_what_it_names_and_nothing_else() -> None:
    arguments = ["alpha5.urdf.xacro", "gripper:=jaws", "ros2_control:=true"]
    plain, own = (
        subprocess.run(
            [*PLAIN, *arguments, *more],
            check=True,
            capture_output=True,
            text=True,
            cwd=XACRO,
        ).stdout
        for more in ([], ["limits_file:=limits_example.yaml"])
    )
    expected = joints(plain)
    expected["axis_e"] |= {"lower": math.radians(100), "upper": math.radians(260)}
    expected["axis_d"]["velocity"] = 0.2
    expected["axis_a"] |= {"upper": 0.010, "effort": 5.0}
    for finger in ("finger_1_joint", "finger_2_joint"):  # 51 rad/m, closed at 1.3 mm
        expected[finger]["upper"] = pytest.approx(51 * (0.010 - 0.0013))
        expected[finger]["effort"] = pytest.approx(5.0 / 51)
    assert joints(own) == expected
    ranges = ranges_of_interfaces(own)
    for name, (low, high, slow, fast) in ranges.items():
        j = expected[name]
        assert (low, high, slow, fast) == (
            j["lower"],
            j["upper"],
            -j["velocity"],
            j["velocity"],
        )
    assert len(ranges) == 5
    # What is no limit is untouched.
    pairs = zip(plain.splitlines(), own.splitlines(), strict=True)
    different = sum(a != b for a, b in pairs)
    # Five limits, the ends of two interfaces' ranges, and one interface's speed.
    assert different == 5 + 5


def test_a_robots_own_xacro_and_a_start_within_the_limits(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(
        "joint_limits:\n"
        "  axis_c: {min_position: 0.5, max_position: 2.0, max_effort: 3}\n"
        "  axis_a: {min_position: 0.002, max_velocity: 0.001}\n"
    )
    (tmp_path / "robot.xacro").write_text(ROBOT.format(folder=XACRO))
    done = subprocess.run(
        [*PLAIN, str(tmp_path / "robot.xacro")],
        check=True,
        capture_output=True,
        text=True,
    )
    limits = joints(done.stdout, "left_")
    assert limits["axis_c"]["upper"] == 2.0
    assert limits["axis_c"]["effort"] == 3.0
    assert limits["finger_1_joint"]["lower"] == pytest.approx(51 * (0.002 - 0.0013))
    assert limits["finger_2_joint"]["velocity"] == pytest.approx(0.051)
    options = {
        "limits_file": str(tmp_path / "own.yaml"),
        "ros2_control": "true",
        "gripper": "jaws",
    }
    control = ET.fromstring(expand_xacro(XACRO_PATH, options)).find("ros2_control")
    starts = {
        joint.get("name"): float(
            joint.find("state_interface[@name='position']/param").text
        )
        for joint in control.findall("joint")
    }
    assert starts["axis_c"] == 2.0  # home is at 2.356
    assert starts["axis_a"] == 0.002
    assert starts["axis_d"] == pytest.approx(math.pi / 4)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected one key, joint_limits"),
        ("limits: {}", "expected one key, joint_limits"),
        ("joint_limits: {}\ndefault: 1", "expected one key, joint_limits"),
        ("joint_limits: [axis_e]", "expected joints, each with its limits"),
        (
            "joint_limits: {axis_f: {max_velocity: 1}}",
            (
                "no joint 'axis_f'; joints are axis_e, axis_d, axis_c, axis_b, axis_a, "
                "without prefix"
            ),
        ),
        ("joint_limits: {left_axis_e: {max_velocity: 1}}", "no joint 'left_axis_e'"),
        ("joint_limits: {axis_d: 0.2}", "axis_d: expected limits by name, not '0.2'"),
        (
            "joint_limits: {axis_d: {velocity: 0.2}}",
            (
                "axis_d: no limit 'velocity'; limits are min_position, max_position, "
                "max_velocity, max_effort"
            ),
        ),
        (
            "joint_limits: {axis_d: {has_position_limits: false}}",
            "no limit 'has_position_limits'",
        ),
        (
            "joint_limits: {axis_d: {max_velocity: fast}}",
            "max_velocity must be a finite number, not 'fast'",
        ),
        (
            "joint_limits: {axis_d: {max_velocity: true}}",
            "must be a finite number, not 'True'",
        ),
        (
            "joint_limits: {axis_d: {max_position: .inf}}",
            "must be a finite number, not 'inf'",
        ),
        (
            "joint_limits: {axis_d: {max_position: .nan}}",
            "must be a finite number, not 'nan'",
        ),
        (
            "joint_limits: {axis_d: {max_position: }}",
            "must be a finite number, not 'None'",
        ),
        (
            "joint_limits: {axis_d: {max_velocity: 0}}",
            "max_velocity must be above 0, not 0",
        ),
        (
            "joint_limits: {axis_d: {max_effort: -1}}",
            "max_effort must be above 0, not -1",
        ),
        (
            "joint_limits: {axis_e: {min_position: 100, max_position: 260}}",
            "axis_e: min_position 100 is too large; if it is in degrees, write "
            "!degrees 100",
        ),
        ("joint_limits: {axis_d: {max_velocity: 30}}", "write !degrees 30"),
        ("joint_limits: {axis_a: {max_position: 10}}", "write !millimeters 10"),
        (
            "joint_limits: {axis_d: {min_position: 3.5}}",
            "axis_d: min_position 3.5 is not below max_position 3.40339",
        ),
        (
            "joint_limits: {axis_e: {max_velocity: 1}, axis_d: {max_position: -1}}",
            "axis_d: min_position 0.01745 is not below max_position -1",
        ),
    ],
)
def test_what_is_wrong_is_said(text: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "own.yaml"
    path.write_text(text)
    with pytest.raises(FileFormatError) as caught:
        expand_xacro(XACRO_PATH, {"limits_file": str(path)})
    assert words in str(caught.value)
    assert "own.yaml" in str(caught.value)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match=r"absent\.yaml"):
        expand_xacro(XACRO_PATH, {"limits_file": str(tmp_path / "absent.yaml")})
