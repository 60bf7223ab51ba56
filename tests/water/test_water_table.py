"""The table of the water's effects gives the torques of the arm in water."""

from __future__ import annotations

import json

import current_load
import numpy as np
import pinocchio as pin
import pytest
from own_arm_dynamics import RECORDS

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.water_table import WaterOptions, water_files
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.jaws import GRIPPERS

STRAIGHT = {f"link_{i}": f"link_{i}" for i in range(5)}


def table(**options) -> dict:
    return json.loads(water_files(WaterOptions(**options))["water.json"])


def jacobian_at_com(
    arm: a5.Arm, q: np.ndarray, name: str, com: list[float]
) -> tuple[np.ndarray, np.ndarray]:
    """Jacobian of a link's twist at its COM, in its axes, and its orientation."""
    model = arm.model
    data = model.createData()
    frame = model.getFrameId(name)
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)
    jacobian = pin.getFrameJacobian(model, data, frame, pin.ReferenceFrame.LOCAL)
    linear = jacobian[:3] + np.cross(jacobian[3:], com, axisa=0).T
    return np.vstack([linear, jacobian[3:]]), data.oMf[frame].rotation


def buoyancy_torque(arm: a5.Arm, q: np.ndarray, found: dict) -> np.ndarray:
    """As a simulator has it that applies a force and a moment at each COM."""
    torque = np.zeros(arm.model.nv)
    for name, row in found["links"].items():
        jacobian, rotation = jacobian_at_com(arm, q, name, row["com"])
        weight = found["fluid_density"] * row["volume"] * found["gravity"][2]
        force = rotation.T @ [0.0, 0.0, -weight]
        moment = np.cross(row["center_of_buoyancy_from_com"], force)
        torque += jacobian.T @ np.concatenate([force, moment])
    return torque


def random_states(arm: a5.Arm, count: int) -> np.ndarray:
    rng = np.random.default_rng(5)
    lower = arm.limits.lower
    upper = arm.limits.upper
    return rng.uniform(lower, upper, (count, lower.size))


@pytest.mark.parametrize("gripper", GRIPPERS)
@pytest.mark.parametrize("density", [1025.0, 1000.0])
def test_buoyancy_at_the_coms_is_the_arms_buoyancy_torque(gripper, density):
    arm = a5.load(density, gripper=gripper)
    found = table(gripper=gripper, fluid_density=density)
    for q in random_states(arm, 20):
        torque = buoyancy_torque(arm, q, found)
        np.testing.assert_allclose(torque, arm.buoyancy_torque(q), atol=1e-12)


def test_a_centre_from_the_frame_instead_of_the_com_is_seen():
    arm = a5.load()
    found = table()
    for row in found["links"].values():
        row["center_of_buoyancy_from_com"] = row["center_of_buoyancy"]
    q = a5.named_pose("reach")
    wrong = buoyancy_torque(arm, q, found) - arm.buoyancy_torque(q)
    assert np.abs(wrong).max() > 0.1


@pytest.mark.parametrize("gripper", GRIPPERS)
@pytest.mark.parametrize("level", LEVELS)
def test_added_mass_about_the_coms_is_that_of_the_arm(gripper, level):
    arm = a5.load(1000.0, gripper=gripper)
    wet = arm.with_hydrodynamics(level=level)
    found = table(gripper=gripper, fluid_density=1000.0)
    for q in random_states(arm, 10):
        added = np.zeros((arm.model.nv, arm.model.nv))
        for name, row in found["links"].items():
            if row["added_mass"]:
                jacobian, _ = jacobian_at_com(arm, q, name, row["com"])
                added += jacobian.T @ row["added_mass"][level] @ jacobian
        expected = wet.mass_matrix(q) - arm.mass_matrix(q)
        np.testing.assert_allclose(added, expected, atol=1e-12)


def test_an_added_mass_about_the_frame_is_seen():
    arm = a5.load(1000.0)
    wet = arm.with_hydrodynamics()
    q = a5.named_pose("home")
    added = np.zeros((4, 4))
    for name, row in table()["links"].items():
        jacobian, _ = jacobian_at_com(arm, q, name, row["com"])
        added += jacobian.T @ wet.added_mass(name) @ jacobian
    expected = wet.mass_matrix(q) - arm.mass_matrix(q)
    assert np.abs(added - expected).max() > 0.1 * np.abs(expected).max()


def strip_wrench(row: dict, com: np.ndarray, nu: np.ndarray, level: int) -> np.ndarray:
    """Drag of a link's strips about its COM, where its twist is nu."""
    total = np.zeros(6)
    for strip in row["strips"]:
        points, force = current_load.strip_drag(
            strip, level, lambda p: -(nu[:3] + np.cross(nu[3:], p - com)), 1025.0
        )
        moments = np.cross(points - com, force)
        total += np.concatenate([force.sum(axis=0), moments.sum(axis=0)])
    return total


@pytest.mark.parametrize("level", LEVELS)
def test_drag_of_one_component_is_that_of_the_strips(level):
    found = table()["links"]
    for name in STRAIGHT:
        com = np.array(found[name]["com"])
        row = current_load.bodies()[name]
        matrix = np.array(found[name]["quadratic_drag"][level])
        for j, speed in ((0, 0.5), (1, -1.2), (2, 0.3), (3, 2.0), (4, -0.7), (5, 3.0)):
            nu = np.zeros(6)
            nu[j] = speed
            expected = strip_wrench(row, com, nu, LEVELS.index(level))
            drag = -matrix @ (np.abs(nu) * nu)
            # The plain sum has 400 pieces; |u| u has a kink on a turning strip.
            np.testing.assert_allclose(drag, expected, rtol=3e-2, atol=2e-4 * speed**2)


def test_strips_of_the_table_are_those_of_the_file():
    for name in STRAIGHT:
        found = table()["links"][name]
        strips = current_load.bodies()[name]["strips"]
        for row, strip in zip(found["strips"], strips, strict=True):
            for key in ("start", "end"):
                at = np.array(row[f"{key}_from_com"]) + found["com"]
                np.testing.assert_allclose(at * 1000, np.array(strip[key], float))
            for key in ("across", "along"):
                assert list(row[key].values()) == [float(text) for text in strip[key]]


def test_drag_of_a_slanting_current_is_a_quarter_off():
    """As the guide says: the matrix knows components, the strips the speed."""
    rng = np.random.default_rng(4)
    for name in STRAIGHT:
        found = table()["links"][name]
        com = np.array(found["com"])
        row = current_load.bodies()[name]
        matrix = np.array(found["quadratic_drag"]["nominal"])
        differences = []
        forces = []
        for current in rng.normal(size=(200, 3)):
            nu = np.concatenate([current, np.zeros(3)])
            exact = strip_wrench(row, com, nu, level=1)[:3]
            differences.append((-matrix @ (np.abs(nu) * nu))[:3] - exact)
            forces.append(exact)
        error = np.linalg.norm(differences) / np.linalg.norm(forces)
        assert 0.18 < error < 0.27


def test_drag_takes_energy_in_any_motion():
    rng = np.random.default_rng(2)
    nu = rng.normal(size=(5000, 6)) * [0.5, 0.5, 0.5, 3.0, 3.0, 3.0]
    nu *= rng.uniform(size=(5000, 6)) < 0.6  # some with few components
    for gripper in GRIPPERS:
        for row in table(gripper=gripper)["links"].values():
            for matrix in row["quadratic_drag"].values():
                drag = -(np.abs(nu) * nu) @ np.transpose(matrix)
                assert (drag * nu).sum(axis=1).max() < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("record", RECORDS[:4], ids=range(4))
def test_the_table_of_an_arm_of_your_own_has_what_is_attached(record):
    found = table(arm=record)
    arm = a5.load(arm=record)
    assert found["model"] == record.name
    unmounted = {**found, "gravity": arm.model.gravity.linear.tolist()}
    for q in random_states(arm, 5):
        torque = np.zeros(4)
        for name, row in unmounted["links"].items():
            jacobian, rotation = jacobian_at_com(arm, q, name, row["com"])
            up = -np.array(unmounted["gravity"])
            force = rotation.T @ (1025.0 * row["volume"] * up)
            moment = np.cross(row["center_of_buoyancy_from_com"], force)
            torque += jacobian.T @ np.concatenate([force, moment])
        np.testing.assert_allclose(torque, arm.buoyancy_torque(q), atol=1e-11)


def test_the_arm_weighs_in_water_what_it_should():
    """The volumes that others guess make it weightless."""
    found = table(fluid_density=1025.0)
    displaced = sum(row["volume"] for row in found["links"].values())
    weight = 9.81 * (1.272 - found["fluid_density"] * displaced)
    assert weight == pytest.approx(6.7, abs=0.05)


# --- The command ----------------------------------------------------------------------


def test_the_command_writes_the_table(tmp_path, capsys):
    file = tmp_path / "mine.json"
    arguments = ["generate", "water", "--fluid", "fresh"]
    assert main([*arguments, "--output", str(file)]) == 0
    assert "mine.json" in capsys.readouterr().out
    assert main(arguments) == 0
    assert capsys.readouterr().out == file.read_text(encoding="utf-8")
    assert [path.name for path in tmp_path.iterdir()] == ["mine.json"]


def test_the_command_refuses_in_one_line(tmp_path, capsys):
    for arguments in (
        ["water", "--prefix", "left_"],
        ["water", "--fluid", "-1"],
        ["water", "--output", str(tmp_path)],
    ):
        assert main(["generate", *arguments]) == 2
        assert capsys.readouterr().err.count("\n") == 1


def test_bad_options_are_refused():
    with pytest.raises(InputError):
        WaterOptions(fluid_density=-1.0)
    with pytest.raises(UnknownNameError):
        WaterOptions(gripper="open")
