"""Linear models agree with finite differences, with integration and with MuJoCo."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dynamics_cases import VARIANTS, central_difference, close, make, moved
from dynamics_cases import random_q as q_of
from dynamics_cases import random_v as v_of
from lazily import Lazy
from loops import each

import alpha5_model as a5
from alpha5_model.description.mjcf import MjcfOptions, mjcf
from alpha5_model.errors import (
    ImplausibleWarning,
    InputError,
    NonFiniteError,
    ShapeError,
)

mujoco = Lazy("mujoco")

WATER = (0.4, -0.6, 0.8)
POSE = np.array([3.0, 1.2, 1.8, 0.5])
#: Of measured motors, at the shaft: kg m^2, N m s/rad.
ROTOR, VISCOUS = 3e-8, 2e-7


def state(arm, seed=5):
    rng = np.random.default_rng(seed)
    q, v = q_of(arm, rng), v_of(arm, rng, 0.5)
    return q, v, rng.normal(scale=0.3, size=arm.model.nv)


def by_differences(arm, q, v, tau):
    """da/dq, da/dv and da/dtau by central differences."""
    n = len(v)
    of_q = central_difference(arm.forward_dynamics, arm, q, 1e-6, v, tau)
    steps = 1e-6 * np.eye(n)
    of_v = [
        (arm.forward_dynamics(q, v + d, tau) - arm.forward_dynamics(q, v - d, tau))
        / 2e-6
        for d in steps
    ]
    of_tau = [
        (arm.forward_dynamics(q, v, tau + d) - arm.forward_dynamics(q, v, tau - d))
        / 2e-6
        for d in steps
    ]
    return of_q, np.transpose(of_v), np.transpose(of_tau)


@each("wet", [False, True])
@each("variant", list(VARIANTS))
def test_the_accelerations_are_those_of_finite_differences(variant, wet):
    arm = make(variant)
    if wet:
        arm = arm.with_hydrodynamics(WATER)
    q, v, tau = state(arm)
    n = len(v)
    A, B = arm.linearized(q, v, tau)
    of_q, of_v, of_tau = by_differences(arm, q, v, tau)
    close(A[n:, :n], of_q, 1e-6)
    close(A[n:, n:], of_v, 1e-6)
    close(B[n:], of_tau, 1e-6)
    assert not B[:n].any()


def flown(arm, q, v, tau, h):
    """q and v after h, by many steps of the classical Runge-Kutta method."""
    steps = 40
    d = h / steps
    for _ in range(steps):
        rate = [v, v, v, v]
        slope = [arm.forward_dynamics(q, v, tau)] * 4
        for i, share in ((1, 0.5), (2, 0.5), (3, 1.0)):
            rate[i] = v + share * d * slope[i - 1]
            place = moved(arm, q, share * d * rate[i - 1])
            slope[i] = arm.forward_dynamics(place, rate[i], tau)
        q = moved(arm, q, d / 6 * (rate[0] + 2 * rate[1] + 2 * rate[2] + rate[3]))
        v = v + d / 6 * (slope[0] + 2 * slope[1] + 2 * slope[2] + slope[3])
    return q, v


@pytest.mark.parametrize("wet", [False, True])
def test_held_at_rest_the_sampled_model_is_the_arm_integrated_over_the_step(wet):
    arm = a5.load().with_hydrodynamics(WATER) if wet else a5.load()
    tau = arm.nonlinear_effects(POSE, np.zeros(4))
    h = 0.05
    A, B = arm.linearized(POSE, np.zeros(4), tau, dt=h)
    rng = np.random.default_rng(1)
    dq, dv, u = 1e-6 * rng.normal(size=(3, 4))
    ends = []
    for sign in (1, -1):
        args = (POSE + sign * dq, sign * dv, tau + sign * u)
        ends.append(np.concatenate(flown(arm, *args, h)))
    found = (ends[0] - ends[1]) / 2
    departure = A @ np.concatenate([dq, dv]) + B @ u
    assert np.abs(departure - found).max() < 1e-5 * np.abs(found).max()
    # and so are two steps in a row
    A2, B2 = arm.linearized(POSE, np.zeros(4), tau, dt=2 * h)
    close(A2, A @ A, 1e-12)
    close(B2, A @ B + B, 1e-12)


def test_a_floating_base_that_moves_turns_its_own_axes():
    """The first rows, against Pinocchio's manifold: without -v x dq they differ."""
    import pinocchio as pin

    arm = a5.load(floating_base=True)
    q, v, tau = state(arm, 2)
    n = len(v)
    A, _ = arm.linearized(q, v, tau)
    h = 1e-5

    def later(dq, dv):
        start = pin.integrate(arm.model, q, dq)
        end = pin.integrate(arm.model, start, h * (v + dv))
        return pin.difference(arm.model, pin.integrate(arm.model, q, h * v), end)

    step = 1e-6
    columns = [
        (later(s, 0 * v) - later(-s, 0 * v)) / (2 * step) for s in step * np.eye(n)
    ]
    rate = (np.transpose(columns) - np.eye(n)) / h
    close(A[:n, :n], rate, 1e-4)
    assert np.abs(rate[:6, :6]).max() > 0.1
    columns = [
        (later(0 * v, s) - later(0 * v, -s)) / (2 * step) for s in step * np.eye(n)
    ]
    close(A[:n, n:], np.transpose(columns) / h, 1e-4)


def measured_arm():
    record = a5.parameters()
    motors = replace(
        record.motors,
        rotor_inertias=(ROTOR,) * 4 + (None,),
        viscous_frictions=(VISCOUS, None, VISCOUS, None, None),
    )
    return replace(record, motors=motors)


@pytest.mark.parametrize("own", [False, True])
def test_mujoco_differentiates_its_step_to_the_same(own):
    record = measured_arm() if own else None
    options = MjcfOptions(collision="none", actuators="motor", arm=record)
    model = mujoco.MjModel.from_xml_string(mjcf(options))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.actuator_ctrllimited[:] = 0
    h = model.opt.timestep = 1e-3
    v, tau = np.array([0.3, -0.2, 0.4, 0.6]), np.array([0.1, 0.7, -0.2, 0.02])
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:], data.ctrl[:] = POSE, v, tau
    theirs_A, theirs_B = np.zeros((8, 8)), np.zeros((8, 4))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, theirs_A, theirs_B, None, None)

    arm = a5.load(arm=record)
    A, B = arm.linearized(POSE, v, tau, motors=own)
    # Semi-implicit Euler: v+ = v + h a, q+ = q + h v+.
    slope, gain = h * A[4:] + np.eye(8)[4:], h * B[4:]
    close(theirs_A, np.vstack([np.eye(8)[:4] + h * slope, slope]), 1e-7)
    close(theirs_B, np.vstack([h * gain, gain]), 1e-7)

    # Exact sampling differs by second order of the step alone.
    exact_A, exact_B = arm.linearized(POSE, v, tau, dt=h, motors=own)
    largest = h**2 * max(np.abs(A @ A).max(), 1.0)
    assert np.abs(exact_A - theirs_A).max() < largest
    assert np.abs(exact_B - theirs_B).max() < h**2 * np.abs(B).max() * (
        1 + np.abs(A).max()
    )
    if own:  # the motors are seen
        without, _ = arm.linearized(POSE, v, tau)
        assert np.abs(without - A).max() > 1


def test_what_cannot_be_used_is_named():
    arm, rest = a5.load(), np.zeros(4)
    wrong = {
        "v": (ShapeError, (POSE, np.zeros(3), rest), {}),
        "tau": (NonFiniteError, (POSE, rest, [np.nan, 0, 0, 0]), {}),
        "dt": (InputError, (POSE, rest, rest), {"dt": 0.0}),
        "motors": (InputError, (POSE, rest, rest), {"motors": "yes"}),
    }
    for name, (kind, args, more) in wrong.items():
        for one in (arm, arm.with_hydrodynamics()):
            with pytest.raises(kind) as error:
                one.linearized(*args, **more)
            assert error.value.name == name
    for dt in (np.nan, 1e4, -0.1, "1 ms"):
        with pytest.raises(InputError) as error:
            arm.linearized(POSE, rest, rest, dt=dt)
        assert error.value.name == "dt"


def test_motors_that_were_not_measured_and_milliseconds_are_named() -> None:
    arm = a5.load()
    rest = np.zeros(4)
    with pytest.warns(ImplausibleWarning, match="motors"):
        arm.linearized(POSE, rest, rest, motors=True)
    with pytest.warns(ImplausibleWarning, match="dt"):
        arm.linearized(POSE, rest, rest, dt=10.0)
