"""The example package of a vehicle with the arm, installed and expanded elsewhere.

ROS finds packages by the ament index: a file in ``share/ament_index`` of each prefix in
AMENT_PREFIX_PATH. A stand-in for ``ament_index_python`` that follows these rules
resolves ``$(find ...)`` here; everything else is plain xacro.
"""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
import yaml
from fk import fk

import alpha5_model as a5

#: CMake installs the package.
pytestmark = pytest.mark.tools

REPOSITORY = Path(__file__).resolve().parents[2]
EXAMPLE = REPOSITORY / "examples" / "my_rov_description"
PLAIN = [
    sys.executable,
    "-c",
    "import sys; sys.path.pop(0); import xacro; xacro.main()",
]
INDEX = """
import os

def get_package_share_directory(name):
    for prefix in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep):
        index = os.path.join(prefix, "share/ament_index/resource_index/packages")
        if os.path.isfile(os.path.join(index, name)):
            return os.path.join(prefix, "share", name)
    raise LookupError(name)
"""
#: What ament_package() does for the index, in the words of CMake.
AMENT = """
macro(ament_package)
  file(WRITE ${CMAKE_BINARY_DIR}/${PROJECT_NAME} "")
  install(FILES ${CMAKE_BINARY_DIR}/${PROJECT_NAME}
          DESTINATION share/ament_index/resource_index/packages)
endmacro()
"""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory) -> Path:
    """A folder with both packages, each installed into a prefix of its own."""
    cmake = shutil.which("cmake")
    if cmake is None:
        pytest.skip("no cmake here")
    folder = tmp_path_factory.mktemp("workspace")
    shutil.copytree(EXAMPLE, folder / "src" / EXAMPLE.name)
    (folder / "ament_index_python").mkdir()
    (folder / "ament_index_python" / "packages.py").write_text(INDEX, "utf-8")
    (folder / "cmake").mkdir()
    (folder / "cmake" / "ament_cmakeConfig.cmake").write_text(AMENT, "utf-8")
    for source in (REPOSITORY, folder / "src" / EXAMPLE.name):
        build = folder / "build" / source.name
        configure = [
            f"-Dament_cmake_DIR={folder / 'cmake'}",
            f"-DCMAKE_INSTALL_PREFIX={folder / 'install' / source.name}",
        ]
        for command in (
            [cmake, "-S", str(source), "-B", str(build), *configure],
            [cmake, "--install", str(build)],
        ):
            subprocess.run(command, check=True, capture_output=True)
    return folder


def expanded(workspace: Path, cwd: Path, *arguments: str) -> str:
    """The vehicle's URDF by plain xacro, from another folder."""
    prefixes = [str(path) for path in (workspace / "install").iterdir()]
    share = workspace / "install" / EXAMPLE.name / "share" / EXAMPLE.name
    done = subprocess.run(
        [*PLAIN, str(share / "urdf" / "my_rov.urdf.xacro"), *arguments],
        check=True,
        capture_output=True,
        text=True,
        cwd=cwd,
        env={
            **os.environ,
            "AMENT_PREFIX_PATH": os.pathsep.join(prefixes),
            "PYTHONPATH": str(workspace),
        },
    )
    return done.stdout


@pytest.fixture(scope="module")
def vehicle(workspace, tmp_path_factory) -> str:
    return expanded(workspace, tmp_path_factory.mktemp("elsewhere"))


def test_the_arm_hangs_where_the_example_says(vehicle):
    """The tool in the vehicle's frame is the package's own, moved by the mount."""
    model = pin.buildModelFromXML(vehicle)
    assert model.nq == 7
    data = model.createData()
    own = a5.named_pose("home")
    q = pin.neutral(model)
    for name, angle in zip("edcb", own, strict=True):
        q[model.joints[model.getJointId(f"arm_axis_{name}")].idx_q] = angle
    pin.framesForwardKinematics(model, data, q)
    tool = data.oMf[model.getFrameId("arm_tcp")].translation
    x, y, z = fk(own)[:3, 3]
    # half a turn about x, then the place of the mount
    np.testing.assert_allclose(tool, [0.15 + x, -y, -0.14 - z], atol=1e-12)


def test_the_vehicle_keeps_its_mass_and_the_arm_its_own(vehicle):
    model = pin.buildModelFromXML(vehicle)
    arm = pin.buildModelFromUrdf(str(REPOSITORY / "urdf" / "alpha5_jaws.urdf"))
    total = pin.computeTotalMass(model) + model.inertias[0].mass
    carried = pin.computeTotalMass(arm) + arm.inertias[0].mass
    assert total == pytest.approx(13.5 + carried, abs=1e-12)


def test_a_launch_file_may_read_it_as_yaml(vehicle):
    assert isinstance(yaml.safe_load(vehicle), str)


def test_limits_and_interfaces_are_the_examples(vehicle):
    root = ET.fromstring(vehicle)
    limit = root.find("joint[@name='arm_axis_e']/limit")
    ends = [float(limit.get(name)) for name in ("lower", "upper")]
    assert ends == pytest.approx([math.radians(60), math.radians(300)], abs=1e-12)
    path = "ros2_control/joint[@name='arm_axis_e']/command_interface[@name='position']"
    interface = [float(p.text) for p in root.find(path)]
    assert interface == ends


def test_every_mesh_is_found_through_the_index(workspace, vehicle):
    uris = {mesh.get("filename") for mesh in ET.fromstring(vehicle).iter("mesh")}
    assert len(uris) == 7
    for uri in uris:
        package, _, path = uri.removeprefix("package://").partition("/")
        assert package == "alpha5_description"
        share = workspace / "install" / REPOSITORY.name / "share" / package
        assert (share / path).is_file()


def test_the_example_takes_hardware(workspace, tmp_path):
    arguments = ("hardware:=alpha_hardware", "serial_port:=/dev/ttyUSB7")
    root = ET.fromstring(expanded(workspace, tmp_path, *arguments))
    hardware = root.find("ros2_control/hardware")
    assert hardware.findtext("plugin") == "alpha_hardware/AlphaHardware"
    assert hardware.findtext("param[@name='serial_port']") == "/dev/ttyUSB7"
    names = [joint.get("name") for joint in root.findall("ros2_control/joint")]
    assert names == [f"arm_axis_{letter}" for letter in "abcde"]


def test_a_package_that_is_not_installed_is_named(workspace, tmp_path):
    prefix = workspace / "install" / REPOSITORY.name
    index = prefix / "share/ament_index/resource_index/packages/alpha5_description"
    hidden = index.with_name("hidden")
    index.rename(hidden)
    try:
        with pytest.raises(subprocess.CalledProcessError) as caught:
            expanded(workspace, tmp_path)
    finally:
        hidden.rename(index)
    assert "alpha5_description" in caught.value.stderr


def test_the_manifest_names_the_packages_that_the_example_finds():
    text = (EXAMPLE / "urdf" / "my_rov.urdf.xacro").read_text("utf-8")
    root = ET.parse(EXAMPLE / "package.xml").getroot()
    found = set(re.findall(r"\$\(find (\w+)\)", text))
    depends = {e.text for e in root.findall("exec_depend")}
    assert found == (depends - {"xacro"}) | {root.findtext("name")}


def test_the_vehicle_is_the_one_of_the_python_example():
    """The numbers stand in examples/arm_on_bluerov2.py with their source."""
    python = (REPOSITORY / "examples" / "arm_on_bluerov2.py").read_text("utf-8")
    link = ET.parse(EXAMPLE / "urdf" / "my_rov.urdf.xacro").getroot().find("link")
    mass = link.find("inertial/mass").get("value")
    inertia = link.find("inertial/inertia")
    moments = ", ".join(inertia.get(name) for name in ("ixx", "iyy", "izz"))
    assert f"mass={mass}," in python
    assert f"np.diag([{moments}])" in python
    assert "MOUNT[:3, 3] = 0.15, 0.0, -0.14" in python


def test_a_plain_urdf_carries_the_arm_on_a_machine_without_ros(tmp_path: Path) -> None:
    """The guide's way: include the vehicle's URDF, and write paths for packages."""
    urdf = '<robot name="rov"><link name="hull"/></robot>'
    (tmp_path / "vehicle.urdf").write_text(urdf, "utf-8")
    there = os.path.relpath(REPOSITORY / "xacro", tmp_path)
    numbers = f"xacro.load_yaml('{there}/parameters.yaml')"
    (tmp_path / "rov.urdf.xacro").write_text(
        f"""
        <robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="rov">
          <xacro:include filename="vehicle.urdf"/>
          <xacro:include filename="{there}/alpha5_macro.xacro"/>
          <xacro:property name="alpha5" value="${{{numbers}}}"/>
          <xacro:alpha5 parameters="${{alpha5}}" prefix="arm_" parent="hull">
            <origin xyz="0.15 0 -0.14" rpy="${{pi}} 0 0"/>
          </xacro:alpha5>
        </robot>
        """,
        "utf-8",
    )
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    command = [*PLAIN, str(tmp_path / "rov.urdf.xacro")]
    done = subprocess.run(
        command, check=True, capture_output=True, text=True, cwd=elsewhere
    )
    model = pin.buildModelFromXML(done.stdout)
    assert model.existFrame("hull")
    q = a5.named_pose("reach")
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    mount = pin.SE3(pin.utils.rotate("x", math.pi), np.array([0.15, 0.0, -0.14]))
    expected = mount * a5.load().forward_kinematics(q)
    found = data.oMf[model.getFrameId("arm_tcp")]
    np.testing.assert_allclose(found.homogeneous, expected.homogeneous, atol=1e-12)
