"""The collections' own loaders load the arm, from modules and folders of their shape."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from reference import LOWER, UPPER
from water_reference import Reference

import alpha5_model as a5
from alpha5_model.errors import MissingDependencyError
from alpha5_model.files import atomic_write
from alpha5_model.loaders import alpha5_description, loader_class, robot_files


def same_arm(model: pin.Model) -> None:
    """Equal to the committed URDF in the mass matrix and the bias, within rounding."""
    reference, data = Reference(), model.createData()
    rng = np.random.default_rng(1)
    for _ in range(10):
        q, v = rng.uniform(LOWER, UPPER), rng.uniform(-1, 1, 4)
        upper = np.triu(pin.crba(model, data, q))
        mass = upper + np.triu(upper, 1).T
        np.testing.assert_allclose(mass, reference.mass_matrix(q), atol=1e-15)
        bias = pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(bias, reference.bias(q, v), atol=1e-14)


def test_paths_lead_somewhere():
    for name in ("URDF_PATH", "JAWS_URDF_PATH", "XACRO_PATH", "SRDF_PATH"):
        path = Path(getattr(alpha5_description, name))
        assert path.is_file()
        assert Path(alpha5_description.PACKAGE_PATH) in path.parents
    assert alpha5_description.URDF_PATH == a5.URDF_PATH


def test_postures_are_those_of_the_srdf_and_within_the_limits():
    model = pin.buildModelFromUrdf(alpha5_description.URDF_PATH)
    pin.loadReferenceConfigurations(model, alpha5_description.SRDF_PATH, False)
    postures = alpha5_description.REFERENCE_POSTURES
    assert set(postures) == {"stow", "home", "reach"}
    for name, q in postures.items():
        np.testing.assert_array_equal(model.referenceConfigurations[name], q)
        assert np.all(model.lowerPositionLimit <= q)
        assert np.all(q <= model.upperPositionLimit)


def test_metadata_is_true():
    metadata = alpha5_description.DESCRIPTION
    text = (Path(a5.REPOSITORY_PATH) / str(metadata["license_file"])).read_text("utf-8")
    assert "BSD 3-Clause" in text
    assert metadata["license_spdx"] == "BSD-3-Clause"
    assert metadata["dof"] == pin.buildModelFromUrdf(a5.URDF_PATH).nv


def test_robot_descriptions_loads_the_module(monkeypatch):
    loaders = pytest.importorskip(
        "robot_descriptions.loaders.pinocchio", reason="robot_descriptions is not installed"
    )
    monkeypatch.setitem(sys.modules, "robot_descriptions.alpha5_description", alpha5_description)
    robot = loaders.load_robot_description("alpha5_description")
    same_arm(robot.model)
    assert robot.visual_model.ngeoms == 7
    index = pytest.importorskip("robot_descriptions._descriptions")
    metadata = dict(alpha5_description.DESCRIPTION)
    formats = {index.Format[name] for name in metadata.pop("formats")}
    assert not index.Description(formats=formats, **metadata).has_mjcf


def test_example_robot_data_loads_the_folder(tmp_path):
    pytest.importorskip("example_robot_data.utils", reason="its loaders are not installed")
    robots = tmp_path / "example-robot-data" / "robots"
    for path, content in robot_files().items():
        atomic_write(robots / path, content)
    loader = loader_class()
    # The base class looks for the folder in its own installation, and at its end once more.
    loader.model_path = str(robots)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("example_robot_data.utils.getModelPath", lambda *_: str(robots))
        robot = loader().robot
    same_arm(robot.model)
    np.testing.assert_array_equal(robot.q0, alpha5_description.REFERENCE_POSTURES["home"])
    assert robot.visual_model.ngeoms == 7
    assert not pin.computeCollisions(
        robot.model, robot.data, robot.collision_model, robot.collision_data, robot.q0, False
    )


def test_a_missing_collection_is_one_clear_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "example_robot_data.utils", None)
    with pytest.raises(MissingDependencyError) as caught:
        loader_class()
    assert "\n" not in str(caught.value)
