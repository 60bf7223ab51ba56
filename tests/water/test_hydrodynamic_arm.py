"""An arm in moving water obeys the laws of dynamics, closed forms and MuJoCo."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import (
    VARIANTS,
    central_difference,
    close,
    make,
    moved,
    random_q,
    random_v,
)
from loops import each

import alpha5_model as a5
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.errors import InputError
from alpha5_model.numbers.hydrodynamics import BodyHydrodynamics, hydrodynamics
from alpha5_model.water.arm import HydrodynamicArm, joint_water

CURRENT = (0.4, -0.6, 0.8)
RHO = a5.SEA_WATER
FLOATING = [name for name, choices in VARIANTS.items() if choices.get("floating_base")]


def definite(rng, n=6, scale=0.1):
    a = rng.normal(size=(n, n))
    return scale * (a @ a.T)


every_arm = each("variant", list(VARIANTS))
made = cache(make)


@cache
def wetted(variant):
    """An arm and a body with added mass of its own, which couples all joints."""
    strip = a5.DragStrip([0.0, 0.0, 0.0], [0.02, 0.05, -0.1], 0.05, 1.1, 0.2)
    added = definite(np.random.default_rng(7), scale=0.02)
    return (
        made(variant)
        .with_hydrodynamics(CURRENT)
        .with_payload(
            0.2, volume=1e-4, frame="link_2", added_mass=added, strips=[strip]
        )
    )


@pytest.fixture
def rng():
    return np.random.default_rng(11)


@every_arm
def test_forward_and_inverse_dynamics_undo_each_other(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    for _ in range(10):
        q = random_q(wet, rng)
        v = random_v(wet, rng)
        a = random_v(wet, rng)
        fext = [pin.Force(rng.normal(size=6)) for _ in range(wet.model.njoints)]
        for outside in (None, fext):
            tau = wet.inverse_dynamics(q, v, a, fext=outside)
            close(wet.forward_dynamics(q, v, tau, fext=outside), a, 1e-10)


@every_arm
def test_terms_add_up_in_still_water(variant) -> None:
    """Nonlinear effects are Coriolis, weight less buoyancy, and drag."""
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    still = np.zeros(3)
    for _ in range(5):
        q = random_q(wet, rng)
        v = random_v(wet, rng)
        a = random_v(wet, rng)
        inertia = wet.inverse_dynamics(q, v, a) - wet.nonlinear_effects(q, v)
        close(inertia, wet.mass_matrix(q) @ a, 1e-11)
        effects = wet.nonlinear_effects(q, v, water_velocity=still)
        drag = effects - wet.coriolis_matrix(q, v) @ v - wet.hydrostatic_torque(q)
        dissipated = wet.dissipated_power(q, v, water_velocity=still)
        assert drag @ v == pytest.approx(dissipated, rel=1e-9, abs=1e-12)


@every_arm
def test_rate_of_the_mass_matrix_less_twice_coriolis_is_skew(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    for _ in range(3):
        q = random_q(wet, rng)
        v = random_v(wet, rng, 0.5)
        rate = rate_of(wet.mass_matrix, wet, q, v)
        skew = rate - 2 * wet.coriolis_matrix(q, v)
        close(skew + skew.T, np.zeros_like(skew), 1e-9)
        assert np.array_equal(wet.mass_matrix(q), wet.mass_matrix(q).T)
        assert np.linalg.eigvalsh(wet.mass_matrix(q)).min() > 0


def rate_of(function, arm, q, v):
    """The rate of a function of q along v, by differences of order 6."""
    h = 4e-3
    f = {k: function(moved(arm, q, k * h * v)) for k in (-3, -2, -1, 1, 2, 3)}
    return (45 * (f[1] - f[-1]) - 9 * (f[2] - f[-2]) + (f[3] - f[-3])) / (60 * h)


@every_arm
def test_power_balance(variant) -> None:
    """In still water, the joints' power is the energies' rate and what drag takes."""
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    none = np.zeros(3)
    for _ in range(5):
        q = random_q(wet, rng)
        v = random_v(wet, rng, 0.5)
        a = random_v(wet, rng, 0.5)
        rate = rate_of(wet.potential_energy, wet, q, v)
        rate += rate_of(lambda x, v=v: wet.kinetic_energy(x, v, none), wet, q, v)
        rate += v @ wet.mass_matrix(q) @ a
        power = wet.inverse_dynamics(q, v, a, water_velocity=none) @ v
        lost = wet.dissipated_power(q, v, water_velocity=none)
        assert power == pytest.approx(rate + lost, rel=1e-8, abs=1e-8)


@every_arm
def test_drag_never_adds_energy(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    for _ in range(20):
        q = random_q(wet, rng)
        v = random_v(wet, rng, 3.0)
        assert wet.dissipated_power(q, v) >= 0
        assert wet.dissipated_power(q, 0 * v, water_velocity=np.zeros(3)) == 0


@pytest.mark.parametrize("variant", FLOATING)
def test_moving_with_the_water_takes_no_force(variant, rng):
    arm = make(variant)
    wet = arm.with_hydrodynamics(CURRENT)
    for _ in range(5):
        q = random_q(arm, rng)
        v = np.zeros(arm.model.nv)
        rotation = pin.XYZQUATToSE3(q[:7]).rotation
        v[:3] = rotation.T @ CURRENT
        close(wet.inverse_dynamics(q, v, 0 * v), arm.hydrostatic_torque(q), 1e-12)
        assert wet.dissipated_power(q, v) < 1e-24
        # Any motion, seen from the water: as in still water.
        v = random_v(arm, rng)
        a = random_v(arm, rng)
        stream = rotation.T @ np.array(CURRENT)
        drifting = v.copy()
        rate = a.copy()
        drifting[:3] += stream
        rate[:3] -= np.cross(v[3:6], stream)
        ours = wet.inverse_dynamics(q, drifting, rate)
        close(ours, wet.inverse_dynamics(q, v, a, water_velocity=np.zeros(3)), 1e-12)


def check_derivatives(function, wet, state, derivatives):
    """Derivatives by q, v and a agree with differences of a function."""
    q, v, a = state
    by_q, by_v, by_a = derivatives
    h = 1e-6
    close(by_q, central_difference(function, wet, q, h, v, a), 1e-6)
    for i, e in enumerate(np.eye(wet.model.nv)):
        rate = (function(q, v + h * e, a) - function(q, v - h * e, a)) / (2 * h)
        close(by_v[:, i], rate, 1e-6)
        close(by_a[:, i], function(q, v, a + e) - function(q, v, a), 1e-9)


def random_state(wet, rng):
    q = random_q(wet, rng)
    v = random_v(wet, rng)
    a = random_v(wet, rng)
    return q, v, a


@every_arm
def test_inverse_dynamics_derivatives(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    for _ in range(2):
        state = random_state(wet, rng)
        derivatives = wet.inverse_dynamics_derivatives(*state)
        check_derivatives(wet.inverse_dynamics, wet, state, derivatives)
        close(derivatives[2], wet.mass_matrix(state[0]), 1e-12)
        by_current = wet.inverse_dynamics_current_derivative(*state)
        for i, e in enumerate(1e-6 * np.eye(3)):
            ahead = wet.inverse_dynamics(*state, water_velocity=CURRENT + e)
            behind = wet.inverse_dynamics(*state, water_velocity=CURRENT - e)
            close(by_current[:, i], (ahead - behind) / 2e-6, 1e-6)


@every_arm
def test_base_wrench_derivatives(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)

    def wrench(q, v, a, water_velocity=None):
        return wet.base_wrench(q, v, a, water_velocity=water_velocity).vector

    for _ in range(2):
        state = random_state(wet, rng)
        derivatives = wet.base_wrench_derivatives(*state)
        check_derivatives(wrench, wet, state, derivatives)


@every_arm
def test_forward_dynamics_derivatives(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    q = random_q(wet, rng)
    v = random_v(wet, rng, 0.5)
    a = random_v(wet, rng, 0.5)
    tau = wet.inverse_dynamics(q, v, a)
    dq, dv, dtau = wet.forward_dynamics_derivatives(q, v, tau)
    close(dq, central_difference(wet.forward_dynamics, wet, q, 1e-6, v, tau), 1e-6)
    h = 1e-5
    for i, e in enumerate(np.eye(wet.model.nv)):
        rate = wet.forward_dynamics(q, v + h * e, tau) - wet.forward_dynamics(
            q, v - h * e, tau
        )
        close(dv[:, i], rate / (2 * h), 1e-6)
        one = wet.forward_dynamics(q, v, tau + e) - wet.forward_dynamics(q, v, tau)
        close(dtau[:, i], one, 1e-8)


@every_arm
def test_batches_are_the_single_calls(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    n = 7
    q = np.array([random_q(wet, rng) for _ in range(n)])
    v, a = (np.array([random_v(wet, rng) for _ in range(n)]) for _ in range(2))
    flows = rng.normal(size=(n, 3))
    for current in (None, flows[0], flows):
        tau = wet.inverse_dynamics_batch(q, v, a, water_velocity=current)
        load = wet.base_wrench_batch(q, v, a, water_velocity=current)
        back = wet.forward_dynamics_batch(q, v, tau, water_velocity=current)
        for i in range(n):
            one = current[i] if current is flows else current
            close(
                tau[i],
                wet.inverse_dynamics(q[i], v[i], a[i], water_velocity=one),
                1e-12,
            )
            close(
                load[i],
                wet.base_wrench(q[i], v[i], a[i], water_velocity=one).vector,
                1e-12,
            )
        close(back, a, 1e-9)
    assert wet.inverse_dynamics_batch(q[:0], v[:0], a[:0]).shape == (0, wet.model.nv)
    assert wet.forward_dynamics_batch(q[:0], v[:0], a[:0]).shape == (0, wet.model.nv)


@each("call", ["inverse_dynamics", "inverse_dynamics_batch", "forward_dynamics_batch"])
@each(
    "wrong",
    [
        {"q": np.full(4, np.nan)},
        {"v": np.full(4, 1e300)},
        {"water_velocity": [0, 0, np.inf]},
        {"water_velocity": "x"},
    ],
)
def test_what_cannot_be_computed_is_told(call, wrong):
    given = {
        "q": np.zeros(4),
        "v": np.zeros(4),
        "tau" if "for" in call else "a": np.zeros(4),
    } | wrong
    with pytest.raises(a5.Alpha5Error, match=next(iter(wrong))):
        getattr(make("locked").with_hydrodynamics(), call)(**given)


@every_arm
def test_without_moving_water_it_is_the_arm(variant) -> None:
    arm = made(variant)
    rng = np.random.default_rng(11)
    dry = HydrodynamicArm(arm, ())
    q = random_q(arm, rng)
    v = random_v(arm, rng)
    a = random_v(arm, rng)
    close(dry.inverse_dynamics(q, v, a), arm.inverse_dynamics(q, v, a), 1e-12)
    close(dry.mass_matrix(q), arm.mass_matrix(q), 1e-13)
    close(dry.coriolis_matrix(q, v), arm.coriolis_matrix(q, v), 1e-12)
    close(dry.base_wrench(q, v, a).vector, arm.base_wrench(q, v, a).vector, 1e-12)
    assert dry.kinetic_energy(q, v) == pytest.approx(
        arm.kinetic_energy(q, v), rel=1e-12
    )
    fext = [pin.Force(rng.normal(size=6)) for _ in range(arm.model.njoints)]
    ours, theirs = (x.base_wrench(q, v, a, fext=fext).vector for x in (dry, arm))
    close(ours, theirs, 1e-12)
    assert dry.forward_kinematics(q) == arm.forward_kinematics(q)
    assert dry.joint_names == arm.joint_names


def test_what_is_asked_of_the_arm_in_still_water():
    """Moving water changes none of these; the arm in water has the rest of its own."""
    public = {name for name in dir(Arm) if not name.startswith("_")}
    passed_on = public - set(vars(HydrodynamicArm))
    assert passed_on == {
        "approach_directions",
        "buoyancy_torque",
        "buoyancy_wrenches",
        "center_of_buoyancy",
        "center_of_mass",
        "closest_links",
        "collision_distance",
        "collision_distance_gradient",
        "data",
        "displaced_volume",
        "forward_kinematics",
        "gravity_torque",
        "gripper",
        "hydrostatic_torque",
        "hydrostatic_torque_derivative",
        "in_collision",
        "jacobian",
        "joint_names",
        "limits",
        "payload_mass",
        "potential_energy",
        "total_mass",
    }


def test_an_arm_in_moving_water_has_no_methods_of_still_water_only():
    wet = a5.load().with_hydrodynamics()
    assert isinstance(wet, a5.Arm)
    assert wet.fluid_density == RHO
    with pytest.raises(InputError, match="arm"):
        wet.regressor(*np.zeros((3, 4)))


def test_what_knows_still_water_only_refuses_it():
    """It would leave out its water, or count a current twice."""
    wet = a5.load().with_hydrodynamics(CURRENT)
    q = np.array([1.0, 1.6, 1.5, 0.2])
    state = (q[None], np.ones((1, 4)), np.ones((1, 4)))
    for ask in (
        lambda: torque_terms(wet, *state),
        lambda: a5.uncertainty.bounds(*state, arm=wet),
        lambda: a5.plan(q, q + 0.1, arm=wet),
    ):
        with pytest.raises(InputError, match=r"arm: .* in still water"):
            ask()


@pytest.mark.tools
def test_jax_and_casadi_refuse_it():
    import alpha5_model.casadi as in_casadi
    import alpha5_model.jax as in_jax

    wet = a5.load().with_hydrodynamics(CURRENT)
    for library in (in_casadi, in_jax):
        with pytest.raises(InputError, match=r"arm: .* in still water"):
            library.load(wet)


def test_other_water_replaces_that_of_an_arm():
    arm = a5.load()
    wet = arm.with_hydrodynamics(CURRENT).with_hydrodynamics(level="high")
    state = np.array([3.0, 1.0, 2.0, 0.5]), np.ones(4), np.ones(4)
    expected = arm.with_hydrodynamics(level="high").inverse_dynamics(*state)
    assert np.array_equal(wet.inverse_dynamics(*state), expected)


def test_added_mass_scales_with_the_fluid():
    fresh, sea, air = (a5.load(rho).with_hydrodynamics() for rho in (1000.0, RHO, 0.0))
    kept = hydrodynamics()["link_2"].added_mass
    assert np.array_equal(fresh.added_mass("link_2"), kept)
    close(sea.added_mass("link_2"), 1.025 * kept, 1e-15)
    assert not air.added_mass("link_2").any()
    q = np.array([3.0, 1.0, 2.0, 0.5])
    assert np.array_equal(air.mass_matrix(q), a5.load(0.0).mass_matrix(q))
    load = air.current_load(q, CURRENT)
    assert not any(part.any() for part in load)


def test_levels_are_in_order():
    q = np.array([3.0, 1.0, 2.0, 0.5])
    arm = a5.load()
    low, nominal, high = (
        arm.with_hydrodynamics(CURRENT, level) for level in ("low", "nominal", "high")
    )
    for matrix in (
        nominal.mass_matrix(q) - low.mass_matrix(q),
        high.mass_matrix(q) - nominal.mass_matrix(q),
    ):
        assert np.linalg.eigvalsh(matrix).min() > 0
    loads = [np.linalg.norm(x.current_load(q)[1][:3]) for x in (low, nominal, high)]
    assert loads == sorted(loads)
    other = arm.with_hydrodynamics(CURRENT, numbers="supplementary")
    assert (
        np.linalg.norm(other.added_mass("link_4") - nominal.added_mass("link_4")) > 0.01
    )


@every_arm
def test_current_load_is_what_the_current_adds_at_rest(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    q = random_q(wet, rng)
    still = np.zeros(wet.model.nv)
    torque, wrench = wet.current_load(q)
    close(
        torque, wet.inverse_dynamics(q, still, still) - wet.hydrostatic_torque(q), 1e-12
    )
    at_rest = wet.base_wrench(q, still, still, water_velocity=np.zeros(3)).vector
    close(wrench, wet.base_wrench(q, still, still).vector - at_rest, 1e-12)
    assert not wet.current_load(q, np.zeros(3))[0].any()
    # Drag is quadratic in the current.
    close(wet.current_load(q, 2 * np.array(CURRENT))[0], 4 * torque, 1e-12)


def test_energy_of_an_undamped_run_is_kept():
    """With added mass and without drag, a free motion keeps its energy."""
    arm = a5.load()
    bodies = {k: BodyHydrodynamics(b.added_mass) for k, b in hydrodynamics().items()}
    wet = HydrodynamicArm(arm, [joint_water(arm, k, b) for k, b in bodies.items()])
    x = np.array([3.0, 1.0, 2.0, 0.5, 0.3, -0.4, 0.6, 0.8])
    tau = np.zeros(4)
    h = 5e-4

    def energy(x):
        return wet.kinetic_energy(x[:4], x[4:]) + wet.potential_energy(x[:4])

    def rate(x):
        return np.concatenate([x[4:], wet.forward_dynamics(x[:4], x[4:], tau)])

    start = energy(x)
    for _ in range(200):
        k_1 = rate(x)
        k_2 = rate(x + h / 2 * k_1)
        k_3 = rate(x + h / 2 * k_2)
        k_4 = rate(x + h * k_3)
        x = x + h / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)
    assert abs(energy(x) - start) < 1e-8


# --- a single cylinder: R, L, along x of its frame, on a hinge about z or afloat

R, L, CD = 0.02, 0.4, 0.8
SIDE = np.pi * R**2 * 1000.0  # added mass across, for each metre


def cylinder_water(cd=CD, along=0.0):
    """Slender-body added mass about the end, and a strip."""
    added = np.zeros((6, 6))
    added[1, 1] = added[2, 2] = SIDE * L
    added[4, 4] = added[5, 5] = SIDE * L**3 / 3
    added[1, 5] = added[5, 1] = SIDE * L**2 / 2
    added[2, 4] = added[4, 2] = -SIDE * L**2 / 2
    strip = a5.DragStrip([0, 0, 0], [L, 0, 0], 2 * R, cd, along)
    return BodyHydrodynamics(added, (strip,))


def cylinder(
    joint, mass=1.5, cd=CD, gravity=(0.0, -9.81, 0.0), water_velocity=(0.0, 0.0, 0.0)
):
    model = pin.Model()
    model.gravity.linear = np.array(gravity)
    model.addJoint(0, joint, pin.SE3.Identity(), "hinge")
    body = pin.Inertia(
        mass,
        np.array([L / 2, 0, 0]),
        np.diag([1e-4, mass * L**2 / 12, mass * L**2 / 12]),
    )
    model.appendBodyToJoint(1, body, pin.SE3.Identity())
    model.addFrame(pin.Frame("rod", 1, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    volume = np.pi * R**2 * L
    arm = Arm(
        model, [Displacement("rod", "hinge", volume, np.array([L / 2, 0, 0]))], 1000.0
    )
    water = [joint_water(arm, "rod", cylinder_water(cd))]
    return HydrodynamicArm(arm, water, water_velocity)


def test_pendulum_in_water_has_its_closed_period():
    rod = cylinder(pin.JointModelRZ(), cd=0.0)
    down = np.array([-np.pi / 2])
    mass = 1.5
    inertia = (mass + SIDE * L) * L**2 / 3
    stiffness = (mass - 1000.0 * np.pi * R**2 * L) * 9.81 * L / 2
    dq, _, _ = rod.forward_dynamics_derivatives(down, np.zeros(1), np.zeros(1))
    assert -dq[0, 0] == pytest.approx(stiffness / inertia, rel=1e-12)


def test_drag_of_a_turning_cylinder():
    """The torque is the integral of rho/2 Cd D (w x)^2 x dx = rho/8 Cd D w^2 L^4."""
    rod = cylinder(pin.JointModelRZ(), gravity=(0, 0, 0))
    for speed in (1.7, -0.6):
        torque = rod.inverse_dynamics([0.3], [speed], [0.0])[0]
        expected = 1000.0 / 8 * CD * 2 * R * L**4 * speed * abs(speed)
        assert torque == pytest.approx(expected, rel=1e-12)
        assert rod.dissipated_power([0.3], [speed]) == pytest.approx(
            expected * speed, rel=1e-12
        )


def test_cross_flow_at_an_angle():
    """Drag counts the velocity across, U^2 sin^2, and added mass adds Munk's moment."""
    speed, angle = 0.9, 0.7
    rod = cylinder(pin.JointModelRZ(), gravity=(0, 0, 0), water_velocity=(speed, 0, 0))
    torque, wrench = rod.current_load([angle])
    across = speed * np.sin(angle)
    force = 1000.0 / 2 * CD * 2 * R * L * across**2
    munk = SIDE * L * speed**2 * np.sin(angle) * np.cos(angle)
    assert torque[0] == pytest.approx(force * L / 2 - munk, rel=1e-12)
    # The stream along +x pushes the cylinder that leans to +y down its slope.
    expected = force * np.array([np.sin(angle), -np.cos(angle), 0])
    assert wrench[:3] == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("pitch", [0.05, -1e-6])
def test_a_screw_is_refused_where_only_turning_and_sliding_are_computed(pitch):
    rod = cylinder(pin.JointModelHZ(pitch))
    with pytest.raises(InputError, match="JointModelHZ"):
        rod.inverse_dynamics_batch([[0.3]], [[0.7]], [[0.2]])


@pytest.mark.parametrize("joint", [pin.JointModelRZ(), pin.JointModelPX()])
def test_a_batch_of_one_joint_is_its_single_calls(joint, rng):
    rod = cylinder(joint, water_velocity=(0.4, -0.6, 0.8))
    q, v, a = rng.normal(size=(3, 5, 1))
    single = [rod.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)]
    close(rod.inverse_dynamics_batch(q, v, a), np.array(single), 1e-12)


def test_munk_moment():
    """A body drifting at an angle is turned broadside by Munk's moment.

    It is (m_across - m_along) U^2 sin cos about the body's middle.
    """
    rod = cylinder(pin.JointModelFreeFlyer(), cd=0.0, gravity=(0, 0, 0))
    q = np.concatenate([np.zeros(6), [1.0]])
    v = np.array([0.8, 0.5, 0, 0, 0, 0])
    tau = rod.inverse_dynamics(q, v, np.zeros(6))
    assert tau[:3] == pytest.approx(np.zeros(3), abs=1e-15)
    # The velocity is the body's, not the water's, and the joint holds against the
    # moment: both turn the sign.
    assert tau[5] == pytest.approx(SIDE * L * v[0] * v[1], rel=1e-12)


ELLIPSOID = """
<mujoco>
  <option density="1000" gravity="0 0 0"/>
  <worldbody>
    <body>
      <freejoint/>
      <geom type="ellipsoid" size="0.1 0.05 0.03" mass="1"
            fluidshape="ellipsoid" fluidcoef="0 0 0 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_mujoco_turns_an_ellipsoid_by_the_same_moment():
    """MuJoCo's ellipsoid without lift and drag has Kirchhoff's velocity terms.

    Its mass matrix has no added mass.
    """
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(ELLIPSOID)
    data = mujoco.MjData(model)
    # Its virtual masses and inertias, for each unit of density.
    added = 1000.0 * np.diag(model.geom_fluid[0][6:12])
    assert added[0, 0] > 0.05
    free = pin.Model()
    free.gravity.linear = np.zeros(3)
    free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    free.appendBodyToJoint(
        1, pin.Inertia(1.0, np.zeros(3), 1e-3 * np.eye(3)), pin.SE3.Identity()
    )
    free.addFrame(pin.Frame("ball", 1, 0, pin.SE3.Identity(), pin.FrameType.BODY))
    arm = Arm(free, [], 1000.0)
    wet = HydrodynamicArm(arm, [joint_water(arm, "ball", BodyHydrodynamics(added))])
    rng = np.random.default_rng(2)
    for _ in range(20):
        q = np.concatenate([np.zeros(3), rng.normal(size=4)])
        q[3:] /= np.linalg.norm(q[3:])
        rotation = pin.XYZQUATToSE3(q).rotation
        nu = rng.normal(size=6)
        data.qpos[:] = [0, 0, 0, q[6], *q[3:6]]
        data.qvel[:] = [*(rotation @ nu[:3]), *nu[3:]]
        mujoco.mj_forward(model, data)
        # MuJoCo gives the force in the world's axes and the moment in the body's.
        force, moment = np.split(data.qfrc_passive, 2)
        theirs = np.concatenate([rotation.T @ force, moment])
        still = arm.inverse_dynamics(q, nu, np.zeros(6))
        close(still - wet.inverse_dynamics(q, nu, np.zeros(6)), theirs, 1e-7)


# --- payloads, copies, wrong input


def test_a_payload_brings_its_own_water(rng):
    arm = a5.load().with_hydrodynamics(CURRENT)
    added = definite(rng)
    loaded = arm.with_payload(0.3, added_mass=added)
    q = np.array([3.0, 1.0, 2.0, 0.5])
    jacobian = arm.jacobian(q, "tcp", pin.LOCAL)
    extra = loaded.mass_matrix(q) - arm.mass_matrix(q)
    weight = a5.load().with_payload(0.3).mass_matrix(q) - a5.load().mass_matrix(q)
    close(extra - weight, 1.025 * jacobian.T @ added @ jacobian, 1e-13)
    assert np.array_equal(loaded.added_mass("payload"), added * 1.025)
    bare = arm.with_payload(0.3)
    close(bare.current_load(q)[0], arm.current_load(q)[0], 1e-14)


@every_arm
def test_it_can_be_pickled_and_printed(variant) -> None:
    wet = wetted(variant)
    rng = np.random.default_rng(11)
    again = pickle.loads(pickle.dumps(wet))
    q = random_q(wet, rng)
    v = random_v(wet, rng)
    a = random_v(wet, rng)
    assert np.array_equal(
        again.inverse_dynamics(q, v, a), wet.inverse_dynamics(q, v, a)
    )
    assert "[0.4, -0.6, 0.8] m/s" in repr(wet)
    assert {"jacobian", "inverse_dynamics"} <= set(dir(wet))
    assert [name for name in dir(wet) if not hasattr(wet, name)] == []


INDEFINITE = np.diag([1.0, 1, 1, 1, 1, -1e-3])
SKEWED = np.eye(6) + np.eye(6, k=1) * 1e-3


@each(
    "mistake",
    [
        lambda arm: arm.with_hydrodynamics(level="medium"),
        lambda arm: arm.with_hydrodynamics(numbers="guessed"),
        lambda arm: arm.with_hydrodynamics(water_velocity=(1.0, 0.0)),
        lambda arm: arm.with_hydrodynamics(water_velocity=(1.0, 0.0, np.nan)),
        lambda arm: arm.with_hydrodynamics(water_velocity="fast"),
        lambda arm: arm.with_hydrodynamics(water_velocity=(1e200, 0, 0)),
        lambda arm: arm.with_hydrodynamics().added_mass("link_9"),
        lambda arm: arm.with_hydrodynamics().inverse_dynamics(
            [0] * 4, [0] * 4, [0] * 3
        ),
        lambda arm: arm.with_hydrodynamics().inverse_dynamics(
            [0] * 4, [0] * 4, [0] * 4, water_velocity=[1]
        ),
        lambda arm: arm.with_hydrodynamics().inverse_dynamics_batch(
            np.zeros((5, 4)), np.zeros(4), np.zeros(4), water_velocity=np.zeros((4, 3))
        ),
        lambda arm: arm.with_hydrodynamics().with_payload(1.0, added_mass=INDEFINITE),
        lambda arm: arm.with_hydrodynamics().with_payload(1.0, added_mass=SKEWED),
        lambda arm: arm.with_hydrodynamics().with_payload(1.0, added_mass=np.eye(3)),
        lambda arm: arm.with_hydrodynamics().with_payload(1.0, strips=[3]),
        lambda arm: arm.with_hydrodynamics().with_payload(1.0, strips=3),
        lambda arm: arm.with_hydrodynamics().with_payload(-1.0),
        lambda arm: a5.DragStrip([0, 0, 0], [0, 0, 1], 0.1, -0.1),
        lambda arm: a5.DragStrip([0, 0, 0], [0, 0, 0], 0.1, 1.0),
        lambda arm: a5.DragStrip([0, 0], [0, 0, 1], 0.1, 1.0),
    ],
)
def test_wrong_input_is_told(mistake):
    with pytest.raises(a5.Alpha5Error):
        mistake(a5.load())


def test_the_arms_mass_with_bodies_of_another_shape_is_in_the_interval():
    """At random poses, the diagonal of M and a push along each axis of the base."""
    import tomllib
    from pathlib import Path

    scripts = Path(__file__).parents[2] / "scripts"
    text = (scripts / "hydrodynamics" / "other_bodies.toml").read_text("utf-8")
    others = tomllib.loads(text)
    still = a5.load(floating_base=True)
    levels = [still.with_hydrodynamics(level=x) for x in ("low", "nominal", "high")]
    bodies = [
        replace(
            body,
            data=BodyHydrodynamics(np.array(others[body.body]["added_mass"], float)),
        )
        for body in levels[1].bodies
    ]
    other = HydrodynamicArm(still, bodies)
    rng = np.random.default_rng(5)
    for joints in rng.uniform([0, 0, 0, -3], [6, 3.4, 3.4, 3], (40, 4)):
        q = np.concatenate([[0, 0, 0, 0, 0, 0, 1], joints])
        rigid = still.mass_matrix(q)
        low, nominal, high = (np.diag(arm.mass_matrix(q) - rigid) for arm in levels)
        found = np.diag(other.mass_matrix(q) - rigid)
        assert (low < nominal).all()
        assert (nominal < high).all()
        assert (low < found).all()
        assert (found < high).all()
