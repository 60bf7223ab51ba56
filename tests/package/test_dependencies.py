"""What is imported is declared, and what is declared is imported."""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterable
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
#: Import name -> distribution, where they differ.
DISTRIBUTION = {
    "PIL": "pillow",
    "adam": "adam-robotics",
    "catkin_pkg": "catkin-pkg",
    "example_robot_data": "example-robot-data-loaders",
    "mcap_ros2": "mcap-ros2-support",
    "mpl_toolkits": "matplotlib",
    "pink": "pin-pink",
    "pinocchio": "pin",
    "pydrake": "drake",
    "pxr": "usd-core",
    "roboticstoolbox": "roboticstoolbox-python",
    "spatialmath": "spatialmath-python",
    "warp": "warp-lang",
    "umsgpack": "u-msgpack-python",
    "yaml": "pyyaml",
    "zmq": "pyzmq",
}
#: Declared though nobody imports it: by whom it is used.
USED_WITHOUT_IMPORT = {
    "simcheck": "run by scripts/conformance/linters.py",
    "truerig": "run by scripts/conformance/linters.py",
    "example-robot-data": "the data that its loaders load",
    "mujoco-mjx": "imported as mujoco.mjx",
    "newton-usd-schemas": "imported by newton, to read USD",
    "daqp": "pink's solver, chosen by name",
    "pytest-xdist": "make test",
    "ruff": "make lint",
    "mypy": "make lint",
    "types-pyyaml": "make lint",
    "uv": "make lowest",
    "ipykernel": "runs the notebooks",
    "myst-nb": "docs/conf.py, by name",
    "furo": "docs/conf.py, by name",
}
#: Folder -> extras that stand behind it, beside the dependencies of everyone.
FOLDERS = {
    "alpha5_model": (
        "plot",
        "mesh",
        "usd",
        "check",
        "line",
        "symbolic",
        "jax",
        "bags",
        "sweep",
        "video",
    ),
    "tests": ("test", "conformance"),
    "scripts": ("bench", "conformance", "hydrodynamics", "mutation"),
    "examples": ("test",),
    "docs": ("docs",),
}
#: Not on Python's index: ROS 2, declared in package.xml.
ROS = {"launch", "launch_ros"}
#: Of ROS 1, by the names of Debian's packages without their python3-.
#: scripts/conformance/real_tools.sh installs them.
ROS_1 = {"rospy", "sensor-msgs", "tf2-ros"}
#: In an environment of its own, which the script that runs it names.
ITS_OWN_ENVIRONMENT = {"figaroh"}


def normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def declared() -> dict[str, set[str]]:
    """Distributions that the package ("") and each extra need, own extras resolved."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras: dict[str, set[str]] = {}

    def resolve(requirements: Iterable[str]) -> set[str]:
        found = set()
        for requirement in requirements:
            if own := re.match(r"alpha5-model\[(.+?)\]", requirement):
                for extra in own[1].split(","):
                    found |= resolve(project["optional-dependencies"][extra])
            else:
                found.add(normal(re.match(r"[\w.-]+", requirement)[0]))
        return found

    extras[""] = resolve(project["dependencies"])
    for extra, requirements in project["optional-dependencies"].items():
        extras[extra] = resolve(requirements)
    return extras


def imported(source: str) -> set[str]:
    """Top-level names that a source imports, also by `pytest.importorskip("name")`."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and not node.level:
            found.add(str(node.module).partition(".")[0])
        elif (
            isinstance(node, ast.Call)
            and ast.unparse(node.func) == "pytest.importorskip"
            and isinstance(
                node.args[0], ast.Constant
            )  # a variable names modules of our own
        ):
            found.add(str(node.args[0].value).partition(".")[0])
    return found - set(sys.stdlib_module_names) - {"alpha5_model"}


def distributions(folder: str) -> dict[str, str]:
    """Distribution -> one file of the folder that imports it, without our modules."""
    files = sorted((ROOT / folder).rglob("*.py"))
    ours = {
        p.stem
        for f in ("tests", "scripts", "examples", "docs")
        for p in (ROOT / f).rglob("*.py")
    }
    ours |= {p.name for p in (ROOT / "scripts").iterdir() if p.is_dir()}
    return {
        normal(DISTRIBUTION.get(name, name)): file.name
        for file in files
        for name in imported(file.read_text("utf-8")) - ours
    }


@pytest.mark.slow
@pytest.mark.parametrize("folder", FOLDERS)
def test_what_is_imported_is_declared(folder: str) -> None:
    known = declared()
    allowed = known[""].union(*(known[extra] for extra in FOLDERS[folder]))
    used = distributions(folder)
    if folder == "alpha5_model":
        allowed.add("example-robot-data-loaders")  # whoever asks for its loader has it
        assert len(used) > 10
    if folder == "scripts":
        installer = (ROOT / "scripts" / "conformance" / "real_tools.sh").read_text(
            "utf-8"
        )
        assert all(f"python3-{name}" in installer for name in ROS_1)
        allowed |= ROS_1 | ITS_OWN_ENVIRONMENT
    assert {name: file for name, file in used.items() if name not in allowed} == {}


def test_the_launch_file_imports_ros_only() -> None:
    launch = {
        n
        for f in (ROOT / "launch").glob("*.py")
        for n in imported(f.read_text("utf-8"))
    }
    assert launch == ROS
    assert all(
        f"<exec_depend>{n}</exec_depend>" in (ROOT / "package.xml").read_text()
        for n in ROS
    )


@pytest.mark.slow
def test_what_is_declared_is_imported() -> None:
    known = declared()
    package = set(distributions("alpha5_model"))
    everywhere = package.union(*(distributions(folder) for folder in FOLDERS))
    assert known[""] - package == set()
    extras = set().union(*known.values())
    assert extras - everywhere - set(USED_WITHOUT_IMPORT) == set()
    assert set(USED_WITHOUT_IMPORT) <= extras - everywhere, (
        "an exception that is none any more"
    )


def test_the_names_are_those_of_the_installed_distributions() -> None:
    installed = packages_distributions()
    checked = {name: d for name, d in DISTRIBUTION.items() if name in installed}
    assert len(checked) > 4
    for name, distribution in checked.items():
        assert normal(distribution) in {normal(d) for d in installed[name]}, name


def test_an_import_in_disguise_is_seen() -> None:
    source = (
        "def f():\n  from trimesh.exchange import gltf\n"
        "pytest.importorskip('mujoco.mjx')\nimport os"
    )
    assert imported(source) == {"trimesh", "mujoco"}
