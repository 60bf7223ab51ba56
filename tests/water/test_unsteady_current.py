"""A current that accelerates: the load by a frame that moves with the water."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import reference
from loops import each

import alpha5_model as a5

G = np.array([0.0, 0.0, -9.81])
RATE = np.array([0.7, -0.4, 0.3])
CURRENT = np.array([0.3, 0.6, -0.2])


def state(seed: int, arm: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Any q, v, a of a floating arm."""
    rng = np.random.default_rng(seed)
    base = pin.SE3ToXYZQUAT(pin.SE3.Random())
    q = np.concatenate([base, rng.uniform(0.2, 2.5, arm.model.nq - 7)])
    return q, rng.normal(size=arm.model.nv), rng.normal(size=arm.model.nv)


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@each("seed", range(4))
@each("gripper", ["locked", "jaws"])
def test_in_the_frame_of_the_water_gravity_is_another(seed: int, gripper: str) -> None:
    """In the frame that accelerates with the water, the water is steady.

    There, gravity is ``g - du/dt``, for the arm and for the pressure in the water, and
    the base accelerates by du/dt less.
    """
    pin.seed(seed)
    options = {"floating_base": True, "gripper": gripper}
    world = a5.load(gravity=G, **options).with_hydrodynamics(CURRENT)
    moving = a5.load(gravity=G - RATE, **options).with_hydrodynamics(CURRENT)
    q, v, a = state(seed, world)
    torque, wrench = world.current_acceleration_load(q, RATE)

    slower = a.copy()
    slower[:3] -= pin.XYZQUATToSE3(q[:7]).rotation.T @ RATE
    expected = moving.inverse_dynamics(q, v, slower)
    found = world.inverse_dynamics(q, v, a) + torque
    assert found == pytest.approx(expected, rel=1e-10, abs=1e-10)
    load = world.base_wrench(q, v, a).vector + wrench
    expected_load = moving.base_wrench(q, v, slower).vector
    assert load == pytest.approx(expected_load, rel=1e-10, abs=1e-10)
    assert np.abs(torque[6:]).max() > 0.01


def test_the_push_on_the_whole_arm_is_morisons() -> None:
    """Added mass by the matrices of the links, displaced water by Table 3."""
    wet = a5.load().with_hydrodynamics(level="high")
    q = np.array([0.7, 1.1, 2.0, -0.4])
    _, wrench = wet.current_acceleration_load(q, RATE)
    force = np.zeros(3)
    moment = np.zeros(3)
    for i, frame in enumerate(reference.inertial_frames(q)):
        turn = frame[:3, :3]
        rate = turn.T @ RATE
        link = a5.parameters().links[i]
        displaced = 1025.0 * link.volume
        matrix = wet.added_mass(link.name)
        push = turn @ (matrix[:3, :3] @ rate + displaced * rate)
        spin = matrix[3:, :3] @ rate + np.cross(link.cob, displaced * rate)
        force += push
        moment += turn @ spin + np.cross(frame[:3, 3], push)
    assert wrench == pytest.approx(np.concatenate([force, moment]), rel=1e-9)


def test_a_neutral_arm_without_added_mass_goes_with_the_water() -> None:
    """It is water itself: its base and joints need no force to accelerate with it."""
    still = a5.load(floating_base=True)
    wet = still.with_hydrodynamics()
    wet = type(wet)(still, [])
    q, _, _ = state(3, still)
    torque, _ = wet.current_acceleration_load(q, RATE)
    fluid = still.fluid_model
    data = fluid.createData()
    along = np.zeros(still.model.nv)
    along[:3] = pin.XYZQUATToSE3(q[:7]).rotation.T @ RATE
    mass = pin.crba(fluid, data, q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    assert torque + mass @ along == pytest.approx(np.zeros(len(along)), abs=1e-12)


def test_a_bad_acceleration_is_refused() -> None:
    wet = a5.load().with_hydrodynamics()
    with pytest.raises(a5.errors.ShapeError, match="acceleration"):
        wet.current_acceleration_load(np.zeros(4), [1.0, 2.0])
