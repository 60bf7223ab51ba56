"""Dynamics, buoyancy and mount load agree with four independent routes."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import (
    PAYLOAD,
    TILTED,
    make,
    payload_of_net_weight,
    random_q,
    random_v,
)
from loops import each
from newton_euler import COB, COM, MASS, VOLUME, newton_euler

import alpha5_model as a5

N = 2000
EXACT = 1e-12


@pytest.fixture(scope="module")
def states():
    rng = np.random.default_rng(20220801)
    return rng.uniform(-np.pi, np.pi, (N, 4)), *rng.normal(scale=3.0, size=(2, N, 4))


@each("density", [0.0, 1000.0, 1025.0, 1340.0])
@each("gravity", [(0.0, 0.0, -9.81), TILTED])
def test_inverse_dynamics_equals_own_newton_euler(states, density, gravity):
    q, v, a = states
    tau, force, moment = newton_euler(q, v, a, density, gravity)
    arm = a5.load(density, gravity=gravity)
    assert np.abs(arm.inverse_dynamics_batch(q, v, a) - tau).max() < EXACT
    wrench = arm.base_wrench_batch(q, v, a)
    assert np.abs(wrench - np.hstack([force, moment])).max() < 1e-11
    for i in range(0, N, 20):
        assert np.abs(arm.inverse_dynamics(q[i], v[i], a[i]) - tau[i]).max() < EXACT
        single = arm.base_wrench(q[i], v[i], a[i])
        assert np.abs(single.linear - force[i]).max() < 1e-11
        assert np.abs(single.angular - moment[i]).max() < 1e-11


@pytest.mark.parametrize("variant", ["link3_cob", "mass", "sign of products"])
def test_own_newton_euler_sees_a_wrong_model(states, variant, monkeypatch):
    q, v, a = states
    wrong = {"mass": MASS.copy(), "cob": COB.copy()}
    if variant == "link3_cob":
        wrong["cob"][3] = [0.018, -0.0172, -0.004]
    elif variant == "mass":
        wrong["mass"][4] += 0.001
    else:
        import newton_euler as module

        flipped = module.PRINTED.copy()
        flipped[:, 3:] *= -1
        monkeypatch.setattr(module, "PRINTED", flipped)
    tau, _, _ = newton_euler(q, v, a, 1025.0, **wrong)
    assert np.abs(a5.load().inverse_dynamics_batch(q, v, a) - tau).max() > 1e-3


def arm_that_holds(ratio, density):
    """An arm in tilted gravity with a payload, and the payload for `newton_euler`."""
    payload = payload_of_net_weight(ratio, density) | {"inertia": PAYLOAD["inertia"]}
    arm = a5.load(density, gravity=TILTED).with_payload(**payload)
    names = ("mass", "com", "inertia", "volume", "cob")
    return arm, tuple(np.array(payload[name]) for name in names)


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@each("density", [0.0, 1025.0, 2e4])
@each("ratio", [-5.0, -1.0, -1e-9, 0.0, 1.0, 5.0])
def test_what_the_arm_holds_may_float(states, density, ratio):
    q, v, a = (x[:100] for x in states)
    arm, held = arm_that_holds(ratio, density)
    tau, force, moment = newton_euler(q, v, a, density, TILTED, held=held)
    scale = max(1.0, np.abs(tau).max())
    assert np.abs(arm.inverse_dynamics_batch(q, v, a) - tau).max() < EXACT * scale
    wrench = np.hstack([force, moment])
    for i in range(100):
        single = arm.base_wrench(q[i], v[i], a[i]).vector
        assert np.abs(single - wrench[i]).max() < 1e-11 * scale
        acceleration = arm.forward_dynamics(q[i], v[i], tau[i])
        assert np.abs(acceleration - a[i]).max() < 1e-9


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@each("density", [0.0, 1025.0, 2e4])
@each("ratio", [-5.0, -1.0, -1e-9, 0.0, 1.0, 5.0])
def test_what_the_arm_holds_at_rest_may_float(states, density, ratio):
    q = states[0][:100]
    arm, held = arm_that_holds(ratio, density)

    def torque_at_rest(positions):
        still = 0 * positions
        return newton_euler(positions, still, still, density, TILTED, held=held)[0]

    moving = newton_euler(*(x[:100] for x in states), density, TILTED, held=held)[0]
    scale = max(1.0, np.abs(moving).max())
    expected = torque_at_rest(q)
    step = 1e-5
    for i in range(0, 100, 10):
        hydrostatic = arm.hydrostatic_torque(q[i])
        assert np.abs(hydrostatic - expected[i]).max() < EXACT * scale
        ahead = torque_at_rest(q[i] + step * np.eye(4))
        behind = torque_at_rest(q[i] - step * np.eye(4))
        slope = (ahead - behind).T / (2 * step)
        derivative = arm.hydrostatic_torque_derivative(q[i])
        assert np.abs(derivative - slope).max() < 1e-8 * scale


def test_the_correction_of_the_base_frame_turns_only_link_0(states):
    """Without it, link_0 lies on the +x side and turns the mount the other way."""
    q, v, a = (x[:50] for x in states)
    printed = a5.load(corrections=())
    corrected = a5.load()
    torque = printed.inverse_dynamics_batch(q, v, a)
    corrected_torque = corrected.inverse_dynamics_batch(q, v, a)
    assert np.abs(torque - corrected_torque).max() < 1e-12
    net = (MASS[0] * COM[0, 0] - 1025.0 * VOLUME[0] * COB[0, 0]) * 9.81
    wrench = printed.base_wrench_batch(q, v, a)
    change = wrench[:, 4] - corrected.base_wrench_batch(q, v, a)[:, 4]
    assert np.abs(change + 2 * net).max() < 1e-12


def test_the_correction_of_link_3s_centre_of_buoyancy_moves_it(states):
    q, v, a = (x[:50] for x in states)
    cob = COB.copy()
    cob[3] = [0.02 - 0.002, 0.029 - 0.0462, -0.004]
    tau, _, _ = newton_euler(q, v, a, 1025.0, cob=cob)
    moved = a5.load(corrections=("base_frame", "link3_cob"))
    assert np.abs(moved.inverse_dynamics_batch(q, v, a) - tau).max() < EXACT


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.81), TILTED])
def test_buoyancy_four_ways(states, gravity):
    q = states[0]
    still = np.zeros((N, 4))
    arm = a5.load(gravity=gravity)
    air = a5.load(a5.AIR, gravity=gravity)
    fourth = (
        newton_euler(q, still, still, 0.0, gravity)[0]
        - newton_euler(q, still, still, a5.SEA_WATER, gravity)[0]
    )
    frames = [arm.model.getFrameId(f"link_{i}") for i in range(5)]
    up = -np.asarray(gravity)
    worst = 0.0
    for i in range(N):
        first = arm.buoyancy_torque(q[i])
        # Second: J^T f at each centre of buoyancy.
        pin.framesForwardKinematics(arm.model, arm.data, q[i])
        second = np.zeros(4)
        for frame, volume, cob in zip(frames, VOLUME, COB, strict=True):
            jacobian = pin.computeFrameJacobian(
                arm.model, arm.data, q[i], frame, pin.LOCAL_WORLD_ALIGNED
            )
            lever = arm.data.oMf[frame].rotation @ cob
            at_cob = jacobian[:3] - pin.skew(lever) @ jacobian[3:]
            second += at_cob.T @ (a5.SEA_WATER * volume * up)
        # Third: explicit wrenches through RNEA.
        third = air.inverse_dynamics(q[i], still[i], still[i]) - air.inverse_dynamics(
            q[i], still[i], still[i], fext=arm.buoyancy_wrenches(q[i])
        )
        worst = max(
            worst,
            *(np.abs(first - other).max() for other in (second, third, fourth[i])),
        )
    assert worst < EXACT
    assert np.abs(fourth).max() > 0.3  # there is something to agree on


def test_wrenches_at_the_base_are_those_of_the_free_flyer():
    rng = np.random.default_rng(5)
    for gripper in ("locked", "jaws"):
        fixed = a5.load(gripper=gripper, gravity=TILTED)
        free = a5.load(gripper=gripper, gravity=TILTED, floating_base=True)
        still = np.zeros(6)
        for _ in range(50):
            q = random_q(fixed, rng)
            v = random_v(fixed, rng)
            a = random_v(fixed, rng)
            pose = np.concatenate([still, [1.0], q])
            tau = free.inverse_dynamics(
                pose, np.concatenate([still, v]), np.concatenate([still, a])
            )
            wrench = fixed.base_wrench(q, v, a).vector
            assert np.abs(wrench + tau[:6]).max() < 1e-12
            assert np.abs(fixed.inverse_dynamics(q, v, a) - tau[6:]).max() < 1e-12
            assert np.abs(fixed.base_wrench_batch(q, v, a)[0] - wrench).max() < 1e-12
            # and of a base that moves
            q = random_q(free, rng)
            v = random_v(free, rng)
            a = random_v(free, rng)
            tau = free.inverse_dynamics(q, v, a)
            assert np.abs(free.base_wrench(q, v, a).vector + tau[:6]).max() < 1e-12
            assert np.abs(free.base_wrench_batch(q, v, a)[0] + tau[:6]).max() < 1e-12


@pytest.mark.parametrize(
    "variant", ["locked, payload, tilted", "jaws, payload", "to the letter"]
)
def test_at_rest_the_mount_carries_weight_minus_buoyancy(variant):
    arm = make(variant)
    rng = np.random.default_rng(6)
    g = arm.model.gravity.linear
    mass = sum(inertia.mass for inertia in arm.model.inertias)
    volume = sum(body.volume for body in arm.displacements)
    payload = 0.6 if "payload" in variant else 0.0
    assert mass == pytest.approx(MASS.sum() + payload, abs=1e-11)
    assert volume == pytest.approx(
        VOLUME.sum() + (2.3e-4 if payload else 0.0), abs=1e-15
    )
    for _ in range(50):
        q = random_q(arm, rng)
        still = np.zeros(arm.model.nv)
        weight = mass * g
        lift = -arm.fluid_density * volume * g
        wrench = arm.base_wrench(q, still, still)
        moment = np.cross(arm.center_of_mass(q), weight) + np.cross(
            arm.center_of_buoyancy(q), lift
        )
        assert np.abs(wrench.linear - (weight + lift)).max() < 1e-12
        assert np.abs(wrench.angular - moment).max() < 1e-12


def test_center_of_mass_and_buoyancy_do_not_follow_the_vehicle():
    fixed = a5.load()
    free = a5.load(floating_base=True)
    rng = np.random.default_rng(7)
    for _ in range(20):
        q = random_q(free, rng)
        given = q.copy()
        difference = free.center_of_mass(q) - fixed.center_of_mass(q[7:])
        assert np.abs(difference).max() < 1e-15
        difference = free.center_of_buoyancy(q) - fixed.center_of_buoyancy(q[7:])
        assert np.abs(difference).max() < 1e-15
        assert np.array_equal(q, given)


def test_external_force_on_link_0_reaches_the_mount():
    fixed = a5.load()
    free = a5.load(floating_base=True)
    rng = np.random.default_rng(8)
    q, v, a = rng.normal(size=(3, 4))
    forces = [pin.Force(rng.normal(size=6)) for _ in range(5)]
    wrench = fixed.base_wrench(q, v, a, fext=forces).vector
    still = np.zeros(6)
    tau = free.inverse_dynamics(
        np.concatenate([still, [1.0], q]),
        np.concatenate([still, v]),
        np.concatenate([still, a]),
        fext=[pin.Force.Zero(), *forces],
    )
    assert np.abs(wrench + tau[:6]).max() < 1e-12
    air = a5.load(a5.AIR)
    by_wrenches = air.base_wrench(q, v, a, fext=fixed.buoyancy_wrenches(q)).vector
    assert np.abs(by_wrenches - fixed.base_wrench(q, v, a).vector).max() < 1e-12


def test_air_is_plain_pinocchio_bit_for_bit():
    arm = a5.load(a5.AIR)
    rng = np.random.default_rng(9)
    model = pin.buildModelFromUrdf(a5.URDF_PATH)
    data = model.createData()
    for _ in range(200):
        q, v, a = rng.normal(size=(3, 4))
        assert np.array_equal(
            arm.inverse_dynamics(q, v, a), pin.rnea(model, data, q, v, a)
        )
        assert np.array_equal(
            arm.forward_dynamics(q, v, a), pin.aba(model, data, q, v, a)
        )
        assert np.array_equal(arm.mass_matrix(q), pin.crba(model, data, q))
        gravity = pin.computeGeneralizedGravity(model, data, q)
        assert np.array_equal(arm.hydrostatic_torque(q), gravity)
        assert np.array_equal(arm.gravity_torque(q), gravity)
        assert not arm.buoyancy_torque(q).any()
        effects = pin.nonLinearEffects(model, data, q, v)
        assert np.array_equal(arm.nonlinear_effects(q, v), effects)
        for ours, theirs in zip(
            arm.inverse_dynamics_derivatives(q, v, a),
            pin.computeRNEADerivatives(model, data, q, v, a),
            strict=True,
        ):
            assert np.array_equal(ours, theirs)
        derivative = pin.computeGeneralizedGravityDerivatives(model, data, q)
        assert np.array_equal(arm.hydrostatic_torque_derivative(q), derivative)


def test_neutral_buoyancy_of_every_link_leaves_no_torque():
    from dataclasses import replace

    plain = a5.load()
    inertias = {f"link_{i}": (MASS[i], COM[i]) for i in range(5)}
    weightless = []
    for body in plain.displacements:
        mass, com = inertias[body.body]
        weightless.append(replace(body, volume=mass / 1025.0, cob=com))
    neutral = a5.Arm(plain.model, weightless, 1025.0)
    rng = np.random.default_rng(10)
    for _ in range(100):
        q = rng.uniform(-np.pi, np.pi, 4)
        assert np.abs(neutral.hydrostatic_torque(q)).max() < 1e-15
        difference = neutral.gravity_torque(q) - neutral.buoyancy_torque(q)
        assert np.abs(difference).max() < 1e-15
        wrench = neutral.base_wrench(q, np.zeros(4), np.zeros(4))
        assert np.abs(wrench.vector).max() < 1e-14
        assert np.abs(plain.hydrostatic_torque(q)).max() > 1e-4


def test_a_link_that_only_feels_a_couple_is_not_lost():
    """Weight equals buoyancy, but at different points: no force, yet a moment."""
    from dataclasses import replace

    plain = a5.load()
    heavy = [
        replace(body, volume=float(MASS[i]) / 1000.0) if i else body
        for i, body in enumerate(plain.displacements)
    ]
    arm = a5.Arm(plain.model, heavy, 1000.0)
    rng = np.random.default_rng(11)
    for _ in range(100):
        q = rng.uniform(-np.pi, np.pi, 4)
        both = arm.gravity_torque(q) - arm.buoyancy_torque(q)
        assert np.abs(arm.hydrostatic_torque(q) - both).max() < 1e-14
        assert np.abs(both).max() > 1e-3
