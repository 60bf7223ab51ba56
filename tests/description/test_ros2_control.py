"""The ros2_control block: its layouts against the demands of public hardware plugins.

The demands were read in the sources of the plugins, at the commits that
``xacro/ros2_control_hardware.yaml`` names, and are written down here a second time.
"""

from __future__ import annotations

import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from functools import cache
from pathlib import Path

import pytest
import yaml

from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.cli import main
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingFileError,
    UnknownNameError,
)
from alpha5_model.numbers.parameters import parameters

LAYOUTS = Path(XACRO_PATH).with_name("ros2_control_hardware.yaml")
PLAIN = [
    sys.executable,
    "-c",
    "import sys; sys.path.pop(0); import xacro; xacro.main()",
]
DEVICES = {joint.name: joint.device_id for joint in parameters().joints}
OWN = """\
plugin: my_lab/Driver
parameters: {port: /dev/ttyS0, rate: 50}
joints: [axis_c, axis_e]
command_interfaces: [effort, velocity]
state_interfaces: [position]
joint_parameters:
  all: {id: =device_id, top: =upper, gear: 1}
  axis_e: {gear: 120}
"""


class RefusedError(Exception):
    """A plugin would not take the block."""


class Control:
    """A ``<ros2_control>`` block as ros2_control hands it to a plugin."""

    def __init__(self, text: str) -> None:
        block = ET.fromstring(text).find("ros2_control")
        assert block is not None
        self.plugin = block.findtext("hardware/plugin")
        self.parameters = self._parameters(block.find("hardware"))
        self.joints = [joint.get("name", "") for joint in block.findall("joint")]
        self.joint_parameters = {}
        self.interfaces = {}
        for component in [*block.findall("joint"), *block.findall("gpio")]:
            name = component.get("name", "")
            self.joint_parameters[name] = self._parameters(component)
            for kind in ("command", "state"):
                names = [e.get("name") for e in component.findall(f"{kind}_interface")]
                self.interfaces[name, kind] = names
        self.gpios = [gpio.get("name", "") for gpio in block.findall("gpio")]

    @staticmethod
    def _parameters(element: ET.Element | None) -> dict[str, str]:
        assert element is not None
        return {p.get("name", ""): p.text or "" for p in element.findall("param")}


def control(**options: object) -> Control:
    # Without shapes xacro takes a quarter of the time.
    variant = Variant(ros2_control=True, collision="none", **options)  # type: ignore[arg-type]
    return Control(urdf(variant))


@cache
def reach_text() -> str:
    options = {"gripper": "jaws", "ros2_control_hardware": "blue_reach_5"}
    return urdf(Variant(ros2_control=True, collision="none", **options))  # type: ignore[arg-type]


def stoi(text: str | None) -> int:
    """C++'s ``std::stoi`` of a parameter, which is empty if it is not there."""
    try:
        return int(text or "")
    except ValueError:
        raise RefusedError(f"stoi of {text!r}") from None


def alpha_hardware(block: Control) -> dict[int, str]:
    """What ``AlphaHardware::on_init`` asks for; device -> joint that it moves."""
    if not block.parameters.get("serial_port"):
        raise RefusedError("no serial_port")
    if stoi(block.parameters.get("state_update_frequency")) < 1:
        raise RefusedError("a division by zero")
    for joint in block.joints:
        for kind in ("command", "state"):
            names = block.interfaces[joint, kind]
            if len(names) != 2:
                raise RefusedError(f"{len(names)} {kind} interfaces")
            if names[0] not in ("position", "velocity"):
                raise RefusedError(f"{kind} interface {names[0]}")
    if len(block.joints) < 5:
        raise RefusedError("the packet of device 5 is written behind the vector's end")
    return dict(enumerate(block.joints, 1))


REACH_JOINT_NUMBERS = (
    "home",
    "max_effort",
    "min_position",
    "max_position",
    "max_velocity",
    "soft_k_position",
    "soft_k_velocity",
    "soft_min_position",
    "soft_max_position",
    "kt",
    "forward_I_static",
    "backward_I_static",
)


def reach_system(block: Control) -> dict[int, str]:
    """What ``ReachSystemMultiInterfaceHardware`` asks for; device -> joint."""
    for name in ("prefix", "serial_port", "state_update_frequency"):
        if name not in block.parameters:
            raise RefusedError(f"no {name}")
    if stoi(block.parameters["state_update_frequency"]) < 1:
        raise RefusedError("a division by zero")
    if not block.gpios or len(block.interfaces[block.gpios[0], "state"]) != 4:
        raise RefusedError("no gpio with the payload")
    return {reach_joint(block, joint): joint for joint in block.joints}


def reach_joint(block: Control, joint: str) -> int:
    """What this plugin asks of a joint; its device."""
    given = block.joint_parameters[joint]
    for name in ("device_id", "has_position_limits", *REACH_JOINT_NUMBERS):
        if name not in given:
            raise RefusedError(f"no {name}")
    for name in REACH_JOINT_NUMBERS:
        float(given[name])
    assert stoi(given["has_position_limits"]) == 1
    for kind, count in (("command", 6), ("state", 27)):
        if len(block.interfaces[joint, kind]) != count:
            raise RefusedError(f"not {count} {kind} interfaces")
    return int(given["device_id"], 16)


PLUGINS = {"alpha_hardware": alpha_hardware, "blue_reach_5": reach_system}
CLASSES = {
    "alpha_hardware": "alpha_hardware/AlphaHardware",
    "blue_reach_5": "ros2_control_blue_reach_5/ReachSystemMultiInterfaceHardware",
}


@pytest.mark.parametrize("prefix", ["", "left_"])
@pytest.mark.parametrize("hardware", list(PLUGINS))
def test_each_plugin_takes_its_layout_and_moves_the_right_devices(hardware, prefix):
    block = control(gripper="jaws", prefix=prefix, ros2_control_hardware=hardware)
    assert block.plugin == CLASSES[hardware]
    moved = PLUGINS[hardware](block)
    assert moved == {device: prefix + name for name, device in DEVICES.items()}


def test_the_plugins_refuse_the_layout_of_mock_hardware():
    """What a user of the public plugins met before there were layouts for them."""
    block = control(gripper="jaws")
    with pytest.raises(RefusedError, match="serial_port"):
        alpha_hardware(block)
    block.parameters["serial_port"] = "/dev/ttyUSB0"
    with pytest.raises(RefusedError, match="stoi"):
        alpha_hardware(block)
    block.parameters["state_update_frequency"] = "250"
    with pytest.raises(RefusedError, match="3 state interfaces"):
        alpha_hardware(block)
    for joint in block.joints:
        block.interfaces[joint, "state"].remove("effort")
    # The plugin now starts, and sends the angle of axis_e to the jaws as metres.
    assert alpha_hardware(block)[1] == "axis_e"
    with pytest.raises(RefusedError, match="no prefix"):
        reach_system(block)


def test_the_order_of_the_reach_interfaces_is_the_one_that_it_exports():
    """The plugin takes names 22 to 27 by their place, the others by their names."""
    block = Control(reach_text())
    for joint in block.joints:
        last = block.interfaces[joint, "state"][21:]
        kinds = ("gravity_force", "gravity_torque")
        assert last == [f"{kind}.{axis}" for kind in kinds for axis in "xyz"]
    # Its forward kinematics takes the first four joints, from the base.
    assert block.joints == ["axis_e", "axis_d", "axis_c", "axis_b", "axis_a"]
    del block.joint_parameters["axis_b"]["kt"]
    with pytest.raises(RefusedError):
        reach_system(block)


def test_the_reach_layout_has_the_arms_limits_and_home():
    block = Control(reach_text())
    homes = [*NAMED_POSES["home"], parameters().joints[4].lower]
    for joint, home in zip(parameters().joints, homes, strict=True):
        given = block.joint_parameters[joint.name]
        assert float(given["home"]) == home
        for prefix in ("", "soft_"):
            assert float(given[f"{prefix}min_position"]) == joint.lower
            assert float(given[f"{prefix}max_position"]) == joint.upper
        assert float(given["max_velocity"]) == joint.velocity


def test_locked_jaws_are_refused_or_left_out():
    with pytest.raises(FileFormatError):
        control(ros2_control_hardware="alpha_hardware")
    # This plugin looks joints up by their device, and does not need all of them.
    block = control(ros2_control_hardware="blue_reach_5")
    turning = {device: name for name, device in DEVICES.items() if device > 1}
    assert reach_system(block) == turning


def test_parameters_replace_those_of_the_layout_or_are_added(capsys):
    options = "--gripper jaws --collision none --ros2-control"
    options += " --ros2-control-hardware alpha_hardware"
    own = ["serial_port=/dev/tty=1", "heartbeat_timeout=3"]
    for pair in own:
        options += f" --ros2-control-param {pair}"
    assert main(["generate", "urdf", *options.split()]) == 0
    written = capsys.readouterr().out
    assert Control(written).parameters == {
        "serial_port": "/dev/tty=1",
        "state_update_frequency": "250",
        "heartbeat_timeout": "3",
    }
    plain = subprocess.run(
        [
            *PLAIN,
            XACRO_PATH,
            "collision:=none",
            "gripper:=jaws",
            "ros2_control:=true",
            "ros2_control_hardware:=alpha_hardware",
            f"ros2_control_parameters:={' '.join(own)}",
        ],
        check=True,
        capture_output=True,
        text=True,
    )
    assert vars(Control(plain.stdout)) == vars(Control(written))


def test_a_layout_of_ones_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("own.yaml").write_text(OWN, encoding="utf-8")
    block = control(prefix="l_", ros2_control_hardware="own.yaml")
    assert block.plugin == "my_lab/Driver"
    assert block.joints == ["l_axis_c", "l_axis_e"]
    assert block.parameters == {"port": "/dev/ttyS0", "rate": "50"}
    joints = {joint.name: joint for joint in parameters().joints}
    assert block.joint_parameters == {
        "l_axis_c": {"id": "3", "top": str(joints["axis_c"].upper), "gear": "1"},
        "l_axis_e": {"id": "5", "top": str(joints["axis_e"].upper), "gear": "120"},
    }
    for joint in block.joints:
        assert block.interfaces[joint, "command"] == ["effort", "velocity"]
        assert block.interfaces[joint, "state"] == ["position"]
    other = control(ros2_control_hardware="own.yaml", ros2_control_plugin="a/B")
    assert other.plugin == "a/B"


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("plugin: my_lab/Driver\n", ""),
        ("joints: [axis_c", "joint: [axis_c"),
        ("[axis_c, axis_e]", "axis_c"),
        ("[axis_c, axis_e]", "[axis_f]"),
        ("[axis_c, axis_e]", "[axis_e, axis_e]"),
        ("[axis_c, axis_e]", "[axis_a]"),
        ("{port: /dev/ttyS0, rate: 50}", "50"),
        ("=upper", "=uper"),
        ("  axis_e: {gear", "  axis_g: {gear"),
        ("{gear: 120}", "120"),
    ],
)
def test_a_wrong_layout_is_one_clear_line(tmp_path, old, new):
    path = tmp_path / "own.yaml"
    assert old in OWN
    path.write_text(OWN.replace(old, new), encoding="utf-8")
    with pytest.raises(FileFormatError, match=r"own\.yaml") as caught:
        control(ros2_control_hardware=str(path))
    assert "xacro.fatal" not in str(caught.value)


@pytest.mark.parametrize(
    "content",
    [
        "plugin: [",
        "a: &x [1]\nb: [*x, *x]\nc: *x\n",
        "[" * 8 + "]" * 8 + "\n" + "[" * 100000,
        " " * 300000,
    ],
)
def test_a_hostile_layout_is_refused(tmp_path, content):
    path = tmp_path / "own.yaml"
    path.write_text(content, encoding="utf-8")
    with pytest.raises(FileFormatError) as caught:
        Variant(ros2_control=True, ros2_control_hardware=str(path))
    assert caught.value.path == str(path)


def test_what_does_not_exist_is_named(tmp_path):
    with pytest.raises(UnknownNameError) as caught:
        control(ros2_control_hardware="alpha")
    assert caught.value.choices == ("mock", *PLUGINS)
    with pytest.raises(MissingFileError):
        control(ros2_control_hardware=os.fspath(tmp_path / "none.yaml"))
    with pytest.raises(FileFormatError):
        expand_xacro(XACRO_PATH, {"ros2_control": "true", "ros2_control_hardware": "x"})


@pytest.mark.parametrize(
    "given",
    [
        {"a": "b c"},
        {"a b": "c"},
        {"": "c"},
        {"a": 3},
        ["a=b"],
        {"a=b": "c"},
        {"a": "${1}"},
    ],
)
def test_parameters_that_xacro_cannot_take_apart_are_refused(given):
    with pytest.raises(InputError) as caught:
        control(ros2_control_parameters=given)
    assert caught.value.name == "ros2_control_parameters"


@pytest.mark.parametrize(
    "option",
    [
        {"ros2_control_hardware": "alpha_hardware"},
        {"ros2_control_parameters": {"a": "b"}},
        {"ros2_control_plugin": "a/B"},
    ],
)
def test_options_of_ros2_control_want_ros2_control(option):
    with pytest.raises(InputError) as caught:
        Variant(gripper="jaws", **option)
    assert caught.value.name in option


def test_every_layout_of_the_file_is_written():
    names = yaml.safe_load(LAYOUTS.read_text("utf-8"))
    assert set(names) == {"mock", *PLUGINS}
    mock = control(gripper="jaws")
    assert mock.plugin == "mock_components/GenericSystem"
    assert mock.joints == [joint.name for joint in parameters().joints]
