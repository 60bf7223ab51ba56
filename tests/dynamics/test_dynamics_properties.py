"""Every kind of arm obeys the laws of dynamics: identities, energy, derivatives."""

from __future__ import annotations

from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import (
    FLOATING,
    VARIANTS,
    central_difference,
    make,
    moved,
    random_q,
    random_v,
)
from loops import each

import alpha5_model as a5

# Laws hold for any fluid, however unlikely.
pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)


every_arm = each("variant", [*VARIANTS, *FLOATING])
made = cache(make)


@pytest.fixture
def rng():
    return np.random.default_rng(42)


def close(ours, reference, relative):
    scale = max(1.0, float(np.abs(reference).max()))
    assert np.abs(ours - reference).max() < relative * scale


@every_arm
def test_terms_add_up(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(50):
        q = random_q(arm, rng)
        v = random_v(arm, rng, 2.0)
        a = random_v(arm, rng, 5.0)
        tau = arm.inverse_dynamics(q, v, a)
        hydrostatic = arm.hydrostatic_torque(q)
        effects = arm.coriolis_matrix(q, v) @ v + hydrostatic
        close(arm.mass_matrix(q) @ a + effects, tau, 1e-12)
        close(effects, arm.nonlinear_effects(q, v), 1e-12)
        close(hydrostatic, arm.gravity_torque(q) - arm.buoyancy_torque(q), 1e-13)
        close(hydrostatic, arm.inverse_dynamics(q, 0 * v, 0 * v), 1e-13)


@every_arm
def test_forward_and_inverse_dynamics_undo_each_other(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(50):
        q = random_q(arm, rng)
        v = random_v(arm, rng)
        a = random_v(arm, rng)
        fext = [pin.Force(rng.normal(size=6)) for _ in range(arm.model.njoints)]
        for outside in (None, fext, pin.StdVec_Force(fext)):
            tau = arm.inverse_dynamics(q, v, a, fext=outside)
            difference = arm.forward_dynamics(q, v, tau, fext=outside) - a
            assert np.abs(difference).max() < 1e-10
        bare = arm.inverse_dynamics(q, v, a)
        assert np.abs(tau - bare).max() > 1e-2


@every_arm
def test_mass_matrix_is_symmetric_positive_definite(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(50):
        q = random_q(arm, rng)
        mass = arm.mass_matrix(q)
        assert np.array_equal(mass, mass.T)
        assert np.linalg.eigvalsh(mass)[0] > 0
        v = random_v(arm, rng)
        assert arm.kinetic_energy(q, v) == pytest.approx(v @ mass @ v / 2, rel=1e-12)


@every_arm
def test_mass_rate_minus_twice_coriolis_is_skew(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(10):
        q = random_q(arm, rng)
        v = random_v(arm, rng)
        h = 1e-5
        ahead, behind = (arm.mass_matrix(moved(arm, q, s * h * v)) for s in (1.0, -1.0))
        rate = (ahead - behind) / (2 * h)
        coriolis = arm.coriolis_matrix(q, v)
        skew = rate - 2 * coriolis
        assert np.abs(skew + skew.T).max() < 1e-8
        assert np.abs(rate).max() > 1e-4


@every_arm
def test_hydrostatic_torque_is_the_gradient_of_potential_energy(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(20):
        q = random_q(arm, rng)
        gradient = central_difference(
            lambda x: np.array(arm.potential_energy(x)), arm, q, 1e-4
        )
        close(gradient, arm.hydrostatic_torque(q), 1e-7)


def test_potential_energy_counts_link_0_on_either_base():
    fixed = a5.load(gravity=(1.0, 2.0, -9.0))
    free = a5.load(floating_base=True, gravity=(1.0, 2.0, -9.0))
    q = np.array([0.3, 1.0, 2.0, 0.5])
    pose = np.concatenate([np.zeros(6), [1.0], q])
    assert fixed.potential_energy(q) == pytest.approx(
        free.potential_energy(pose), abs=1e-14
    )


@each("variant", [v for v, c in VARIANTS.items() if not c.get("floating_base")])
def test_energy_is_kept_to_the_order_of_the_integrator(variant, rng):
    """A free swing drifts by 1/4^4 if a Runge-Kutta of order 4 takes a quarter step."""
    arm = make(variant)
    n = arm.model.nv
    start = np.concatenate([random_q(arm, rng), random_v(arm, rng, 0.3)])
    tau = np.zeros(n)

    def energy(x):
        return arm.kinetic_energy(x[:n], x[n:]) + arm.potential_energy(x[:n])

    def rate(x):
        return np.concatenate([x[n:], arm.forward_dynamics(x[:n], x[n:], tau)])

    def drift(step):
        x = start
        worst = 0.0
        for _ in range(round(0.24 / step)):
            k_1 = rate(x)
            k_2 = rate(x + step / 2 * k_1)
            k_3 = rate(x + step / 2 * k_2)
            k_4 = rate(x + step * k_3)
            x = x + step / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)
            worst = max(worst, abs(energy(x) - energy(start)))
        return worst

    coarse = drift(8e-3)
    fine = drift(2e-3)
    assert coarse / fine > 150
    assert fine < 1e-6


@every_arm
def test_power_of_the_torques_is_the_rate_of_energy(variant) -> None:
    """d(kinetic + potential)/dt = tau . v along any motion, on a moving base too."""
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(20):
        q = random_q(arm, rng)
        v = random_v(arm, rng)
        a = random_v(arm, rng)
        h = 1e-5
        ahead, behind = (
            arm.kinetic_energy(x, v + s * h * a) + arm.potential_energy(x)
            for s in (1.0, -1.0)
            for x in [moved(arm, q, s * h * v)]
        )
        power = arm.inverse_dynamics(q, v, a) @ v
        assert (ahead - behind) / (2 * h) == pytest.approx(power, rel=1e-7, abs=1e-7)


@every_arm
def test_inverse_dynamics_derivatives(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(3):
        q = random_q(arm, rng)
        v = random_v(arm, rng)
        a = random_v(arm, rng)
        dq, dv, da = arm.inverse_dynamics_derivatives(q, v, a)
        close(dq, central_difference(arm.inverse_dynamics, arm, q, 1e-5, v, a), 1e-6)
        eye = np.eye(arm.model.nv)
        # tau is quadratic in v, so central differences of any step are exact.
        for i, unit in enumerate(eye):
            ahead = arm.inverse_dynamics(q, v + unit, a)
            behind = arm.inverse_dynamics(q, v - unit, a)
            close(dv[:, i], (ahead - behind) / 2, 1e-10)
        assert np.array_equal(da, da.T)
        close(da, arm.mass_matrix(q), 1e-13)


@every_arm
def test_hydrostatic_derivative(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(3):
        q = random_q(arm, rng)
        ours = arm.hydrostatic_torque_derivative(q)
        close(ours, central_difference(arm.hydrostatic_torque, arm, q, 1e-5), 1e-6)
        still = np.zeros(arm.model.nv)
        close(ours, arm.inverse_dynamics_derivatives(q, still, still)[0], 1e-12)


@every_arm
def test_forward_dynamics_derivatives(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(3):
        q = random_q(arm, rng)
        v = random_v(arm, rng, 0.5)
        a = random_v(arm, rng, 0.5)
        tau = arm.inverse_dynamics(q, v, a)
        dq, dv, dtau = arm.forward_dynamics_derivatives(q, v, tau)
        close(dq, central_difference(arm.forward_dynamics, arm, q, 1e-6, v, tau), 1e-6)
        for i, column in enumerate(np.eye(arm.model.nv)):
            h = 1e-4
            rate = arm.forward_dynamics(q, v + h * column, tau)
            rate = (rate - arm.forward_dynamics(q, v - h * column, tau)) / (2 * h)
            close(dv[:, i], rate, 1e-6)
            one = arm.forward_dynamics(q, v, tau + column) - arm.forward_dynamics(
                q, v, tau
            )
            close(dtau[:, i], one, 1e-9)


def vector_of_base_wrench(q, v, a, arm):
    return arm.base_wrench(q, v, a).vector


@every_arm
def test_base_wrench_derivatives(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for _ in range(3):
        q = random_q(arm, rng)
        v = random_v(arm, rng)
        a = random_v(arm, rng)
        dq, dv, da = arm.base_wrench_derivatives(q, v, a)
        close(
            dq, central_difference(vector_of_base_wrench, arm, q, 1e-5, v, a, arm), 1e-6
        )
        for i, column in enumerate(np.eye(arm.model.nv)):
            ahead, behind = (arm.base_wrench(q, v + s * column, a) for s in (1.0, -1.0))
            close(dv[:, i], (ahead - behind).vector / 2, 1e-10)
            ahead, behind = (arm.base_wrench(q, v, a + s * column) for s in (1.0, -1.0))
            close(da[:, i], (ahead - behind).vector / 2, 1e-10)


def test_derivatives_without_the_water_would_be_wrong(rng):
    arm = a5.load()
    air = a5.load(a5.AIR)
    q = random_q(arm, rng)
    gap = arm.hydrostatic_torque_derivative(q) - air.hydrostatic_torque_derivative(q)
    assert np.abs(gap).max() > 1e-2


def origin(q, arm, frame):
    return arm.forward_kinematics(q, frame).translation


@every_arm
def test_jacobian_is_a_derivative_too(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    for frame in ("tcp", "link_2", "base_link"):
        q = random_q(arm, rng)
        jacobian = arm.jacobian(q, frame)
        linear = central_difference(origin, arm, q, 1e-5, arm, frame)
        close(jacobian[:3], linear, 1e-8)
        local = arm.jacobian(q, frame, pin.LOCAL)
        here = arm.forward_kinematics(q, frame)
        for i in range(arm.model.nv):
            h = 1e-6
            dq = np.zeros(arm.model.nv)
            dq[i] = h
            there = arm.forward_kinematics(moved(arm, q, dq), frame)
            twist = pin.log6(here.actInv(there)).vector / h
            close(local[:, i], twist, 1e-4)


@every_arm
def test_batches_are_the_single_calls(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(42)
    n = 37
    q = np.array([random_q(arm, rng) for _ in range(n)])
    v, a = (np.array([random_v(arm, rng) for _ in range(n)]) for _ in range(2))
    for threads in (None, 1, 2):
        tau = arm.inverse_dynamics_batch(q, v, a, threads=threads)
        back = arm.forward_dynamics_batch(q, v, tau, threads=threads)
        wrench = arm.base_wrench_batch(q, v, a, threads=threads)
        assert tau.shape == v.shape
        assert wrench.shape == (n, 6)
        for i in range(n):
            close(tau[i], arm.inverse_dynamics(q[i], v[i], a[i]), 1e-13)
            close(wrench[i], arm.base_wrench(q[i], v[i], a[i]).vector, 1e-12)
        assert np.abs(back - a).max() < 1e-9
    still = arm.inverse_dynamics_batch(
        q, np.zeros(arm.model.nv), np.zeros((1, arm.model.nv))
    )
    close(still, np.array([arm.hydrostatic_torque(row) for row in q]), 1e-13)
    empty = arm.inverse_dynamics_batch(q[:0], v[:0], a[:0])
    assert empty.shape == (0, arm.model.nv)
