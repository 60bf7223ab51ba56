"""The jaw variant is the locked arm when closed, and the chain rule's when open."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import random_q, random_v

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH

CLOSED = 0.0013


@pytest.fixture(scope="module")
def arms():
    return a5.load(gripper="jaws", gravity=(1.0, 2.0, -9.0)), a5.load(
        gravity=(1.0, 2.0, -9.0)
    )


def test_five_coordinates(arms):
    jaws, _ = arms
    assert (jaws.model.nq, jaws.model.nv) == (5, 5)
    assert jaws.joint_names == ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")


@pytest.mark.parametrize("floating", [False, True])
def test_closed_jaws_are_the_locked_arm(floating):
    jaws, locked = (
        a5.load(gripper=g, floating_base=floating) for g in ("jaws", "locked")
    )
    rng = np.random.default_rng(1)
    for _ in range(100):
        q = random_q(locked, rng)
        v = random_v(locked, rng)
        a = random_v(locked, rng)
        closed = [np.append(q, CLOSED), np.append(v, 0.0), np.append(a, 0.0)]
        pairs = [
            (jaws.inverse_dynamics(*closed)[:-1], locked.inverse_dynamics(q, v, a)),
            (jaws.mass_matrix(closed[0])[:-1, :-1], locked.mass_matrix(q)),
            (jaws.hydrostatic_torque(closed[0])[:-1], locked.hydrostatic_torque(q)),
            (jaws.buoyancy_torque(closed[0])[:-1], locked.buoyancy_torque(q)),
            (jaws.nonlinear_effects(*closed[:2])[:-1], locked.nonlinear_effects(q, v)),
            (
                jaws.coriolis_matrix(*closed[:2])[:-1, :-1] @ v,
                locked.coriolis_matrix(q, v) @ v,
            ),
            (jaws.base_wrench(*closed).vector, locked.base_wrench(q, v, a).vector),
            (jaws.center_of_mass(closed[0]), locked.center_of_mass(q)),
            (jaws.center_of_buoyancy(closed[0]), locked.center_of_buoyancy(q)),
            (jaws.potential_energy(closed[0]), locked.potential_energy(q)),
            (jaws.kinetic_energy(*closed[:2]), locked.kinetic_energy(q, v)),
            (
                jaws.forward_kinematics(closed[0]).homogeneous,
                locked.forward_kinematics(q).homogeneous,
            ),
            (jaws.jacobian(closed[0])[:, :-1], locked.jacobian(q)),
        ]
        pairs += [
            (ours[:-1, :-1], theirs)
            for ours, theirs in zip(
                jaws.inverse_dynamics_derivatives(*closed),
                locked.inverse_dynamics_derivatives(q, v, a),
                strict=True,
            )
        ]
        for ours, theirs in pairs:
            assert np.abs(ours - theirs).max() < 1e-11
        opened = [np.append(q, 0.0133), *closed[1:]]
        difference = jaws.mass_matrix(opened[0])[:-1, :-1] - locked.mass_matrix(q)
        assert np.abs(difference).max() > 1e-6


def test_open_jaws_are_the_tree_with_its_fingers_driven(arms):
    """The torques are those of Pinocchio's seven free joints, pulled back by G^T."""
    jaws, _ = arms
    tree = pin.buildModelFromUrdf(JAWS_URDF_PATH)
    tree.gravity.linear = jaws.model.gravity.linear
    data = tree.createData()
    pulled = np.zeros((7, 5))
    pulled[:5, :5] = np.eye(5)
    pulled[5:, 4] = 51.0
    offset = np.array([0, 0, 0, 0, 0, -51.0 * CLOSED, -51.0 * CLOSED])
    rng = np.random.default_rng(2)
    for _ in range(100):
        q = random_q(jaws, rng)
        v = random_v(jaws, rng)
        a = random_v(jaws, rng)
        q_7 = pulled @ q + offset
        v_7 = pulled @ v
        a_7 = pulled @ a
        dry = pulled.T @ pin.rnea(tree, data, q_7, v_7, a_7)
        wet = jaws.inverse_dynamics(q, v, a) + jaws.buoyancy_torque(q)
        assert np.abs(dry - wet).max() < 1e-12
        lift = buoyancy_of_tree(tree, data, q_7, jaws)
        assert np.abs(pulled.T @ lift - jaws.buoyancy_torque(q)).max() < 1e-12


def buoyancy_of_tree(tree, data, q_7, jaws):
    """The sum of J^T f over the displaced bodies, for the tree's seven joints, (7,)."""
    pin.computeJointJacobians(tree, data, q_7)
    pin.updateFramePlacements(tree, data)
    lift = np.zeros(7)
    for body in jaws.displacements:
        if body.joint == "universe":
            continue
        joint = tree.getJointId(body.joint)
        jacobian = pin.getJointJacobian(tree, data, joint, pin.LOCAL_WORLD_ALIGNED)
        lever = data.oMi[joint].rotation @ body.cob
        force = -1025.0 * body.volume * jaws.model.gravity.linear
        lift += jacobian[:3].T @ force + jacobian[3:].T @ np.cross(lever, force)
    return lift


def test_pinocchio_s_own_coriolis_matrix_of_mimic_joints_is_not_used(arms):
    jaws, _ = arms
    rng = np.random.default_rng(3)
    q = random_q(jaws, rng)
    v = random_v(jaws, rng)
    exact = jaws.nonlinear_effects(q, v) - jaws.hydrostatic_torque(q)
    assert np.abs(jaws.coriolis_matrix(q, v) @ v - exact).max() < 1e-12


def test_holding_the_jaws_costs_little_but_something(arms):
    jaws, _ = arms
    q = np.array([0.3, 1.0, 2.0, 0.5, 0.008])
    force = jaws.hydrostatic_torque(q)[4]
    assert 1e-4 < abs(force) < 5.0
