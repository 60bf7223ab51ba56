"""The repository as a ROS 2 package, as far as it can be checked without ROS.

Checked: the manifest, what CMake installs, the launch file with stand-ins for
``launch``, plain xacro on the installed tree, and that every URI resolves there. Not
run: colcon, robot_state_publisher, RViz.
"""

from __future__ import annotations

import runpy
import shlex
import shutil
import subprocess
import sys
import types
import xml.etree.ElementTree as ET
from pathlib import Path

import pinocchio as pin
import pytest
import yaml

import alpha5_model as a5

#: CMake installs the package.
pytestmark = pytest.mark.tools

REPOSITORY = Path(__file__).resolve().parents[2]
NAME = "alpha5_description"
XACRO = [
    sys.executable,
    "-c",
    "import sys; sys.path.pop(0); import xacro; xacro.main()",
]


@pytest.fixture(scope="module")
def share(tmp_path_factory) -> Path:
    """Install with CMake, with a stand-in for ``ament_cmake`` that does nothing."""
    cmake = shutil.which("cmake")
    if cmake is None:
        pytest.skip("no cmake here")
    build = tmp_path_factory.mktemp("build")
    stub = build / "stub"
    stub.mkdir()
    (stub / "ament_cmakeConfig.cmake").write_text(
        "macro(ament_package)\nendmacro()\n", "utf-8"
    )
    configure = [
        f"-Dament_cmake_DIR={stub}",
        f"-DCMAKE_INSTALL_PREFIX={build / 'install'}",
    ]
    for command in (
        [cmake, "-S", str(REPOSITORY), "-B", str(build / "tree"), *configure],
        [cmake, "--install", str(build / "tree")],
    ):
        subprocess.run(command, check=True, capture_output=True)
    return build / "install" / "share" / NAME


def test_manifest_has_what_rep_149_asks_for():
    root = ET.parse(REPOSITORY / "package.xml").getroot()
    assert root.tag == "package"
    assert root.get("format") == "3"
    for required in ("name", "version", "description", "maintainer", "license"):
        assert len(root.findall(required)) == 1
        assert root.find(required).text.strip()
    assert root.find("name").text == NAME
    assert root.find("version").text == a5.__version__
    assert "@" in root.find("maintainer").get("email")
    assert (REPOSITORY / root.find("license").get("file")).is_file()
    assert root.find("export/build_type").text == "ament_cmake"
    assert "ament_cmake" in [e.text for e in root.findall("buildtool_depend")]


def test_manifest_passes_catkin_pkg():
    package = pytest.importorskip(
        "catkin_pkg.package", reason="catkin_pkg is not installed"
    )
    parsed = package.parse_package(str(REPOSITORY / "package.xml"))
    parsed.validate()
    assert parsed.name == NAME


def test_manifest_names_every_package_that_the_launch_file_uses():
    depends = {
        e.text
        for e in ET.parse(REPOSITORY / "package.xml").getroot().findall("exec_depend")
    }
    nodes, _ = launched({})
    used = {node["package"] for node in nodes} | {"launch", "launch_ros", "xacro"}
    assert used == depends


class Recorder:
    """Stands in for any class of ``launch``: keeps what it was made with."""

    def __init__(self, *args: object, **kwargs: object) -> None:
        self.args, self.kwargs, self.kind = args, kwargs, type(self).__name__


LAUNCH_FILE = REPOSITORY / "launch" / "display.launch.py"


def launch_entities() -> list[Recorder]:
    """What the launch file describes, with recorders in place of ROS's classes."""
    modules: dict[str, types.ModuleType] = {}
    for line in LAUNCH_FILE.read_text("utf-8").splitlines():
        if line.startswith("from launch"):
            modules[line.split()[1]] = types.ModuleType(line.split()[1])
    for module in modules.values():
        # Each imported name becomes a class that records.
        module.__getattr__ = lambda name: type(name, (Recorder,), {})
    modules.setdefault("launch_ros", types.ModuleType("launch_ros"))

    with pytest.MonkeyPatch.context() as patch:
        for name, module in modules.items():
            patch.setitem(sys.modules, name, module)
        script = runpy.run_path(str(LAUNCH_FILE))
        (entities,) = script["generate_launch_description"]().args
    return entities


def performed(part: object, arguments: dict[str, str], share: Path) -> str:
    """The text that ROS makes of a substitution or of a list of them."""
    if isinstance(part, str):
        return part
    if isinstance(part, list):
        return "".join(performed(each, arguments, share) for each in part)
    if part.kind == "LaunchConfiguration":
        return arguments[part.args[0]]
    if part.kind == "FindPackageShare":
        assert part.args == (NAME,)
        return str(share)
    if part.kind == "PathJoinSubstitution":
        return "/".join(performed(each, arguments, share) for each in part.args[0])
    assert part.kind == "FindExecutable"
    return part.kwargs["name"]


def launched(
    values: dict[str, str], share: Path = Path("/share")
) -> tuple[list[dict[str, object]], list[str]]:
    """The nodes of the launch file, and the command of the robot description."""
    entities = launch_entities()
    declared = [e for e in entities if "Declare" in e.kind]
    defaults = {e.args[0]: e.kwargs["default_value"] for e in declared}
    assert set(values) <= set(defaults)
    nodes = [e.kwargs for e in entities if e.kind == "Node"]
    arguments = {**defaults, **values}

    def perform(part: object) -> str:
        return performed(part, arguments, share)

    (publisher,) = (n for n in nodes if n["package"] == "robot_state_publisher")
    (parameter,) = publisher["parameters"]
    (command,) = parameter["robot_description"].args
    assert parameter["robot_description"].kwargs == {"value_type": str}
    (viewer,) = (n for n in nodes if n["package"] == "rviz2")
    assert Path(perform(viewer["arguments"][1])).relative_to(share) == Path(
        "rviz/alpha5.rviz"
    )
    return nodes, shlex.split(perform(command.args[0]))


@pytest.mark.parametrize(
    "values",
    [
        {},
        {"gripper": "jaws", "prefix": "left_"},
        {"ros2_control": "true", "dh_frames": "true", "collision": "none"},
    ],
    ids=["default", "jaws", "control"],
)
def test_the_launch_file_describes_the_robot(share, tmp_path, values):
    _, (program, *arguments) = launched(values, share)
    assert program == "xacro"
    done = subprocess.run(
        [*XACRO, *arguments], check=True, capture_output=True, text=True, cwd=tmp_path
    )
    root = ET.fromstring(done.stdout)
    model = pin.buildModelFromXML(done.stdout)
    assert model.nq == (7 if "gripper" in values else 4)
    assert model.existFrame(values.get("prefix", "") + "tcp")
    assert (root.find("ros2_control") is not None) == ("ros2_control" in values)
    assert model.existFrame("dh_3") == ("dh_frames" in values)
    assert (root.find(".//collision") is None) == ("collision" in values)
    uris = {mesh.get("filename") for mesh in root.iter("mesh")}
    assert len(uris) == 7
    for uri in uris:
        package, _, path = uri.removeprefix("package://").partition("/")
        assert package == NAME
        assert (share / path).is_file()


def test_every_launch_argument_is_one_of_xacros(share):
    _, arguments = launched({}, share)
    names = {a.partition(":=")[0] for a in arguments if ":=" in a}
    root = ET.parse(REPOSITORY / "xacro" / "alpha5.urdf.xacro").getroot()
    declared = {e.get("name") for e in root if e.tag.endswith("}arg")}
    assert names < declared


def test_a_wrong_argument_stops_the_launch(share, tmp_path):
    _, (_, *arguments) = launched({"gripper": "none"}, share)
    done = subprocess.run(
        [*XACRO, *arguments], check=False, capture_output=True, text=True, cwd=tmp_path
    )
    assert done.returncode != 0
    assert "gripper must be" in done.stderr


def test_the_installed_urdf_finds_its_meshes_as_a_package(share):
    """RViz resolves package URIs only; in the repository the paths are relative."""
    for name in ("alpha5.urdf", "alpha5_jaws.urdf"):
        text = (share / "urdf" / name).read_text("utf-8")
        uris = [mesh.get("filename") for mesh in ET.fromstring(text).iter("mesh")]
        assert len(uris) == 7
        for uri in uris:
            package, _, path = uri.removeprefix("package://").partition("/")
            assert uri.startswith("package://")
            assert package == NAME
            assert (share / path).is_file()
        committed = (REPOSITORY / "urdf" / name).read_text("utf-8")
        assert text.replace(f"package://{NAME}/meshes/", "../meshes/") == committed
    assert not list(share.rglob("__pycache__"))


def test_rviz_looks_at_links_that_exist():
    settings = yaml.safe_load((REPOSITORY / "rviz" / "alpha5.rviz").read_text("utf-8"))
    manager = settings["Visualization Manager"]
    links = {e.get("name") for e in ET.parse(a5.URDF_PATH).getroot().iter("link")}
    assert manager["Global Options"]["Fixed Frame"] in links
    topics = [
        d["Description Topic"]["Value"]
        for d in manager["Displays"]
        if "Robot" in d["Name"]
    ]
    assert topics == ["/robot_description"]


def test_document_numbers_map_to_the_arms_names():
    """The document counts from the base, the arm's bus and names from the tip."""
    joints = a5.parameters().joints
    assert [joint.name[-1] for joint in joints] == ["e", "d", "c", "b", "a"]
    assert [joint.device_id for joint in joints] == [5, 4, 3, 2, 1]
    text = (REPOSITORY / "docs" / "guides" / "ros.md").read_text("utf-8")
    for number, joint in enumerate(joints):
        assert f"| {number} | `{joint.name}` | {joint.device_id} |" in text
