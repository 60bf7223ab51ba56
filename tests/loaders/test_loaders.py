"""The loaders of robot collections load the arm from modules and folders of theirs."""

from __future__ import annotations

import importlib.util
import os
import runpy
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from reference import LOWER, UPPER
from water_reference import Reference

import alpha5_model as a5
from alpha5_model import loaders

SCRIPT = (
    Path(__file__).resolve().parents[2]
    / "scripts"
    / "robots"
    / "add_to_example_robot_data.py"
)
#: What that collection's tests of loading look like.
LOADING = """\
import unittest

import numpy as np
from example_robot_data import load_full


class Loading(unittest.TestCase):
    def check(self, name, nq, nv):
        robot, q0, urdf, srdf = load_full(name)
        self.assertEqual((robot.model.nq, robot.model.nv), (nq, nv))
        np.testing.assert_array_equal(robot.model.referenceConfigurations["home"], q0)
        self.assertEqual(robot.visual_model.ngeoms, 7)
        self.assertIn("/example-robot-data/robots/alpha5_description/", urdf)


    def test_anymal(self):
        self.skipTest("another robot")


unittest.main()
"""


def same_arm(model: pin.Model) -> None:
    """Equal to the committed URDF in the mass matrix and the bias, within rounding."""
    reference = Reference()
    data = model.createData()
    rng = np.random.default_rng(1)
    for _ in range(10):
        q = rng.uniform(LOWER, UPPER)
        v = rng.uniform(-1, 1, 4)
        upper = np.triu(pin.crba(model, data, q))
        mass = upper + np.triu(upper, 1).T
        np.testing.assert_allclose(mass, reference.mass_matrix(q), atol=1e-15)
        bias = pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(bias, reference.bias(q, v), atol=1e-14)


def test_paths_lead_somewhere():
    for name in ("URDF_PATH", "JAWS_URDF_PATH", "XACRO_PATH", "SRDF_PATH", "MJCF_PATH"):
        path = Path(getattr(loaders, name))
        assert path.is_file()
        assert Path(loaders.REPOSITORY_PATH) in path.parents
    assert Path(loaders.PACKAGE_PATH) == Path(loaders.URDF_PATH).parent
    assert loaders.URDF_PATH == a5.URDF_PATH


def test_postures_are_those_of_the_srdf_and_within_the_limits():
    model = pin.buildModelFromUrdf(loaders.URDF_PATH)
    pin.loadReferenceConfigurations(model, loaders.SRDF_PATH, False)
    postures = loaders.REFERENCE_POSTURES
    assert set(postures) == {"stow", "home", "reach"}
    for name, q in postures.items():
        np.testing.assert_array_equal(model.referenceConfigurations[name], q)
        assert np.all(model.lowerPositionLimit <= q)
        assert np.all(q <= model.upperPositionLimit)


@pytest.fixture
def loader(monkeypatch):
    """robot_descriptions' loader of a tool, with our modules among its own."""
    pytest.importorskip(
        "robot_descriptions", reason="robot_descriptions is not installed"
    )
    name = "robot_descriptions.alpha5_description"
    monkeypatch.setitem(sys.modules, name, loaders)

    def of(tool: str) -> Callable[..., Any]:
        if importlib.util.find_spec(tool) is None:
            pytest.skip(f"{tool} is not installed")
        module = importlib.import_module(f"robot_descriptions.loaders.{tool}")
        return module.load_robot_description

    return of


def test_robot_descriptions_loads_the_module(loader):
    robot = loader("pinocchio")("alpha5_description")
    same_arm(robot.model)
    assert robot.visual_model.ngeoms == 7
    index = pytest.importorskip("robot_descriptions._descriptions")
    known = index.Format.__members__
    metadata = dict(loaders.DESCRIPTION)
    # Version 2 has no name for SRDF.
    formats = [name for name in metadata.pop("formats") if name in known]
    entry = index.Description(formats={known[name] for name in formats}, **metadata)
    assert entry.has_urdf
    assert entry.has_mjcf
    assert getattr(entry, "has_srdf", True)
    assert entry.dof == robot.model.nv
    text = (Path(a5.REPOSITORY_PATH) / entry.license_file).read_text("utf-8")
    assert "BSD 3-Clause" in text


def test_its_loaders_of_the_urdf_read_the_same_arm(loader):
    robot = loader("yourdfpy")("alpha5_description")
    assert len(robot.scene.geometry) == 7
    assert robot.actuated_joint_names == ["axis_e", "axis_d", "axis_c", "axis_b"]
    reference = pin.buildModelFromUrdf(a5.URDF_PATH)
    data = reference.createData()
    tcp = reference.getFrameId("tcp")
    rng = np.random.default_rng(2)
    for _ in range(5):
        q = rng.uniform(LOWER, UPPER)
        pin.framesForwardKinematics(reference, data, q)
        robot.update_cfg(q)
        np.testing.assert_allclose(
            robot.get_transform("tcp"), data.oMf[tcp].homogeneous, atol=1e-14
        )


def test_mujocos_loader_takes_each_variant(loader):
    load = loader("mujoco")
    for variant, joints in (
        (None, 4),
        ("alpha5_jaws", 7),
        ("scene", 4),
        ("scene_jaws", 7),
    ):
        model = load("alpha5_description", variant=variant)
        assert model.njnt == joints
        assert model.nkey >= 3


@pytest.fixture
def checkout(tmp_path):
    """A folder like a checkout of example-robot-data, with its own Python files."""
    utils = pytest.importorskip(
        "example_robot_data.utils", reason="its loaders are not installed"
    )
    folder = tmp_path / "example-robot-data"
    shutil.copytree(
        Path(utils.__file__).parent,
        folder / "python" / "example_robot_data",
        ignore=shutil.ignore_patterns("path.py*", "__pycache__"),
    )
    tests = folder / "unittest" / "test_load.py"
    tests.parent.mkdir()
    tests.write_text(LOADING)
    return folder


@pytest.mark.slow
def test_example_robot_data_takes_the_patch(checkout, monkeypatch, capsys):
    """The patched checkout passes the tests of its own kind, in another process."""
    package = checkout / "python" / "example_robot_data"
    tests = checkout / "unittest" / "test_load.py"
    script = runpy.run_path(str(SCRIPT))
    monkeypatch.setattr(sys, "argv", ["add", str(checkout)])
    # The second time, the lines are there already.
    for _ in range(2):
        script["main"]()
        assert f"wrote {package / 'alpha5.py'}\n" in capsys.readouterr().out
    assert tests.read_text().count("alpha5_jaws") == 2
    assert (package / "robots_loader.py").read_text().count('"alpha5": ') == 1
    environment = {**os.environ, "PYTHONPATH": str(package.parent)}
    command = [sys.executable, str(tests), "-v"]
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert "Ran 3 tests" in done.stderr
    assert "skipped=1" in done.stderr


def test_a_folder_that_is_no_checkout_is_not_patched(checkout):
    package = checkout / "python" / "example_robot_data"
    tests = checkout / "unittest" / "test_load.py"
    script = runpy.run_path(str(SCRIPT))
    script["patch"](checkout)
    for broken in (package / "robots_loader.py", tests):
        broken.write_text("")
        with pytest.raises(SystemExit, match=rf"{broken.name}: no '"):
            script["patch"](checkout)
        broken.unlink()
        with pytest.raises(
            SystemExit, match="expected a checkout of example-robot-data"
        ):
            script["patch"](checkout)
        broken.write_text('from .human import Human\nROBOTS = {\n    "b1": None,\n}\n')


def test_a_checkout_of_version_4_is_refused(checkout):
    """Its loaders are in one file, which has the base class, too."""
    (checkout / "python" / "example_robot_data" / "utils.py").unlink()
    script = runpy.run_path(str(SCRIPT))
    with pytest.raises(SystemExit, match="older than version 5, which is expected"):
        script["patch"](checkout)
