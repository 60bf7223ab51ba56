"""Joint positions in degrees or millimetres cause a warning, in every door."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import ImplausibleWarning
from alpha5_model.kinematics.workspace import manipulability, singularities

DEGREES = np.array([180.0, 70.0, 90.0, 0.0])
Q = np.radians(DEGREES)
ZERO = np.zeros(4)

DOORS = {
    "forward_kinematics": lambda arm, q: arm.forward_kinematics(q),
    "jacobian": lambda arm, q: arm.jacobian(q),
    "hydrostatic_torque": lambda arm, q: arm.hydrostatic_torque(q),
    "inverse_dynamics": lambda arm, q: arm.inverse_dynamics(q, ZERO, ZERO),
    "base_wrench": lambda arm, q: arm.base_wrench(q, ZERO, ZERO),
    "linearized": lambda arm, q: arm.linearized(q, ZERO, ZERO),
    "in_collision": lambda arm, q: arm.in_collision(q),
    "batch": lambda arm, q: arm.inverse_dynamics_batch([Q, q], [ZERO], [ZERO]),
    "in_collision of many": lambda arm, q: arm.in_collision([Q, q]),
    "best": lambda arm, q: a5.inverse_kinematics([0.25, 0.1, 0.1]).best(q),
    "wrist": lambda arm, q: a5.inverse_kinematics([0.25, 0.1, 0.1], wrist=q[2]),
    "without_self_collision": lambda arm, q: a5.without_self_collision(q),
    "manipulability": lambda arm, q: manipulability(q),
    "singularities": lambda arm, q: singularities(q),
}


@pytest.fixture(scope="module")
def arm() -> a5.Arm:
    return a5.load()


@pytest.mark.parametrize("door", DOORS)
def test_degrees_are_noticed_and_radians_are_not(door: str, arm: a5.Arm) -> None:
    with pytest.warns(ImplausibleWarning, match=r"deg, write (3\.14159|1\.5708)"):
        DOORS[door](arm, DEGREES)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        DOORS[door](arm, Q)


def test_millimetres_of_the_rod_are_noticed() -> None:
    jaws = a5.load(gripper="jaws")
    with pytest.warns(ImplausibleWarning, match=r"mm, write 0\.006"):
        jaws.forward_kinematics([*Q, 6.0], "tip")
    with pytest.warns(ImplausibleWarning, match="mm"):
        jaws.inverse_dynamics_batch([[*Q, 6.0]], np.zeros((1, 5)), np.zeros((1, 5)))


def test_a_place_of_a_floating_base_is_no_angle() -> None:
    floating = a5.load(floating_base=True)
    far = [300.0, -20.0, -90.0, 0.0, 0.0, 0.0, 1.0]
    still = np.zeros(10)
    floating.inverse_dynamics(np.array([*far, *Q]), still, still)
    with pytest.warns(ImplausibleWarning, match="deg"):
        floating.inverse_dynamics(np.array([*far, *DEGREES]), still, still)


def test_the_answer_is_that_of_the_number_given(arm: a5.Arm) -> None:
    """A warning is no error: a turn more is the same place."""
    with pytest.warns(ImplausibleWarning):
        turned = arm.forward_kinematics(Q + 4 * np.pi)
    assert turned.isApprox(arm.forward_kinematics(Q), 1e-9)
