"""The arm on its vehicle is a floating arm; its momentum, reaction, trim and input."""

from __future__ import annotations

import importlib.util
import pickle
import sys
import warnings
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import PAYLOAD, close, random_q, random_v
from loops import each
from shared_recordings import RECORDINGS, needs_recordings

import alpha5_model as a5
from alpha5_model.water.carrier import read_carrier

SCRIPT = (
    Path(__file__).resolve().parents[2]
    / "scripts"
    / "identification"
    / "validate_recordings.py"
)
CURRENT = (0.3, -0.2, 0.1)
Q = np.array([3.0, 0.9, 2.1, 0.4])


def pose(xyz, rpy):
    out = np.eye(4)
    out[:3, :3] = pin.rpy.rpyToMatrix(*rpy)
    out[:3, 3] = xyz
    return out


#: Pose of the vehicle's frame in base_link.
VEHICLE_IN_BASE = pose([-0.2, 0.0, 0.15], [np.pi, 0.0, 0.3])


def vehicle(**changes):
    values = {
        "mass": 13.5,
        "com": [0.0, 0.0, -0.01],
        "inertia": np.diag([0.26, 0.23, 0.37]),
        "volume": 0.0134,
        "cob": [0.0, 0.0, 0.02],
        "added_mass": [6.36, 7.12, 18.68, 0.189, 0.135, 0.222],
        "linear_damping": [13.7, 0.0, 33.0, 0.0, 0.8, 0.0],
        "quadratic_damping": [141.0, 217.0, 190.0, 1.19, 0.47, 1.5],
        "mount": np.linalg.inv(VEHICLE_IN_BASE),
    }
    return a5.Vehicle(**(values | changes))


BODY = {
    "mass": 13.5,
    "com": np.array([0.01, 0.02, -0.03]),
    "inertia": np.diag([0.26, 0.23, 0.37]),
    "volume": 0.0134,
    "cob": np.array([0.0, -0.01, 0.02]),
}
NOTHING = {
    "mass": 0.0,
    "com": np.zeros(3),
    "inertia": np.zeros((3, 3)),
    "volume": 0.0,
    "cob": np.zeros(3),
}


@pytest.fixture
def rng():
    return np.random.default_rng(5)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_nothing_as_a_vehicle_leaves_the_floating_arm(gripper, rng):
    free = a5.load(gripper=gripper, floating_base=True)
    system = a5.load(gripper=gripper).on_vehicle(a5.Vehicle(**NOTHING))
    for _ in range(5):
        q = random_q(free, rng)
        v = random_v(free, rng)
        a = random_v(free, rng)
        close(system.inverse_dynamics(q, v, a), free.inverse_dynamics(q, v, a), 1e-12)
        close(system.mass_matrix(q), free.mass_matrix(q), 1e-12)
        ours = system.forward_kinematics(q)
        theirs = free.forward_kinematics(q)
        assert ours.isApprox(theirs, 1e-12)
        close(system.center_of_buoyancy(q), free.center_of_buoyancy(q), 1e-13)
        assert system.potential_energy(q) == pytest.approx(
            free.potential_energy(q), abs=1e-12
        )
        close(
            system.mount_load(q, v, a).vector, free.base_wrench(q, v, a).vector, 1e-12
        )
    assert system.joint_names == free.joint_names


def test_the_mount_of_a_fixed_arm_becomes_the_vehicle(rng):
    """On a vehicle at rest, mount load and joint torques are those of the fixed arm."""
    fixed = a5.load().with_hydrodynamics()
    system = fixed.on_vehicle(vehicle())
    v = random_v(fixed, rng)
    a = random_v(fixed, rng)
    q = system.configuration(VEHICLE_IN_BASE, Q)
    assert q == pytest.approx([0, 0, 0, 0, 0, 0, 1, *Q], abs=1e-15)
    still = np.zeros(6)
    v_all = np.concatenate([still, v])
    a_all = np.concatenate([still, a])
    load = system.mount_load(q, v_all, a_all).vector
    close(load, fixed.base_wrench(Q, v, a).vector, 1e-12)
    of_thrusters, of_joints = np.split(system.inverse_dynamics(q, v_all, a_all), [6])
    close(of_joints, fixed.inverse_dynamics(Q, v, a), 1e-12)
    # The thrusters carry the mount's load and the vehicle's own weight.
    own = fixed.on_vehicle(vehicle()).still.model.gravity.linear
    to_base = pin.SE3(VEHICLE_IN_BASE)
    weight = pin.Force.Zero()
    for amount, at in ((13.5, [0, 0, -0.01]), (-1025.0 * 0.0134, [0, 0, 0.02])):
        point = to_base.act(np.array(at, dtype=float))
        weight += pin.Force(amount * own, np.cross(point, amount * own))
    close(of_thrusters, -load - weight.vector, 1e-11)


def momentum(system, q, v):
    """Linear and angular momentum of the whole in the world, about its origin."""
    own = (system.mass_matrix(q) @ v)[:6]
    return pin.XYZQUATToSE3(q[:7]).act(pin.Force(own)).vector


def exponential_rate(u, w):
    """The rate of exponential coordinates u at the velocity w, to order 4."""
    rate = w.copy()
    twist = pin.Motion(u[:6])
    velocity = pin.Motion(w[:6])
    bracket = twist.cross(velocity)
    rate[:6] = (velocity + 0.5 * bracket + (1 / 12) * twist.cross(bracket)).vector
    return rate


def munthe_kaas_step(model, rate, q, v, h):
    """Position and velocity after a step of the Runge-Kutta-Munthe-Kaas method.

    It has order 4; the increments of a step are exponential coordinates.
    """
    positions = []  # rates of the exponential coordinates
    velocities = []
    u = np.zeros_like(v)
    w = v
    for share in (0.5, 0.5, 1.0, None):
        positions.append(exponential_rate(u, w))
        velocities.append(rate(pin.integrate(model, q, u), w))
        if share is not None:
            u = share * h * positions[-1]
            w = v + share * h * velocities[-1]
    weights = h / 6 * np.array([1, 2, 2, 1])
    return pin.integrate(model, q, weights @ positions), v + weights @ velocities


def test_momentum_of_the_free_system_is_kept():
    """Without drag and gravity, joint torques keep the momentum of body and water."""
    bare = a5.load(gravity=(0, 0, 0)).with_hydrodynamics()
    bodies = [
        b.__class__(b.body, b.joint, b.action, type(b.data)(b.data.added_mass))
        for b in bare.bodies
    ]
    arm = type(bare)(bare.still, bodies)
    system = arm.on_vehicle(
        vehicle(linear_damping=np.zeros(6), quadratic_damping=np.zeros(6))
    )
    q = system.configuration(pose([0.3, 0.1, -2.0], [0.2, -0.1, 0.5]), Q)
    v = np.array([0.2, -0.1, 0.3, 0.4, -0.2, 0.3, 0.5, -0.4, 0.3, 0.6])
    start = momentum(system, q, v)
    tau = np.concatenate([np.zeros(6), [0.1, -0.2, 0.15, 0.02]])

    def rate(q, v):
        return system.forward_dynamics(q, v, tau)

    before = q
    for _ in range(60):
        q, v = munthe_kaas_step(system.model, rate, q, v, h=1e-3)
    assert np.abs(q - before).max() > 0.02
    close(momentum(system, q, v), start, 1e-9)
    assert np.abs(start).max() > 1.0


def test_reaction_leaves_the_thrusters_without_force(rng):
    system = a5.load().with_hydrodynamics(CURRENT).on_vehicle(vehicle())
    for _ in range(5):
        q = random_q(system, rng)
        v = random_v(system, rng, 0.3)
        joints = rng.normal(size=4)
        base, torque = system.reaction(q, v, joints)
        tau = system.inverse_dynamics(q, v, np.concatenate([base, joints]))
        close(tau, np.concatenate([np.zeros(6), torque]), 1e-11)
        close(system.forward_dynamics(q, v, tau), np.concatenate([base, joints]), 1e-9)


def test_a_drifting_vehicle_comes_to_rest_with_the_water(rng):
    """Damping depends on the velocity relative to the water, in the vehicle's axes."""
    system = a5.load().on_vehicle(vehicle())
    q = system.configuration(np.eye(4), Q)
    to_base = pin.SE3(VEHICLE_IN_BASE)
    nu = rng.normal(size=6)
    v = np.concatenate([to_base.act(pin.Motion(nu)).vector, np.zeros(4)])
    linear = vehicle().linear_damping
    quadratic = vehicle().quadratic_damping
    expected = 1.025 * (linear * nu**2 + quadratic * np.abs(nu) ** 3).sum()
    assert system.dissipated_power(q, v) == pytest.approx(expected, rel=1e-12)
    rotation = pin.XYZQUATToSE3(q[:7]).rotation
    v = np.zeros(10)
    v[:3] = rotation.T @ CURRENT
    power = system.dissipated_power(q, v, water_velocity=CURRENT)
    assert power == pytest.approx(0.0, abs=1e-20)


def test_derivatives_with_the_vehicle(rng):
    system = a5.load().with_hydrodynamics(CURRENT).on_vehicle(vehicle())
    q = random_q(system, rng)
    v = random_v(system, rng, 0.5)
    a = random_v(system, rng, 0.5)
    _, dv, da = system.inverse_dynamics_derivatives(q, v, a)
    h = 1e-6
    for i, e in enumerate(np.eye(10)):
        rate = system.inverse_dynamics(q, v + h * e, a) - system.inverse_dynamics(
            q, v - h * e, a
        )
        close(dv[:, i], rate / (2 * h), 1e-6)
    close(da, system.mass_matrix(q), 1e-12)


def test_trim_is_an_equilibrium_and_stable(rng):
    system = a5.load().on_vehicle(vehicle())
    level = system.on_vehicle(vehicle(cob=[0.0, 0.0, 0.05]))
    for one in (system, level):
        for _ in range(5):
            joints = rng.uniform(0.1, 3.0, 4)
            trim = one.trim(joints)
            at = np.eye(4)
            at[:3, :3] = trim.rotation_vehicle_to_world
            q = one.configuration(at, joints)
            load = pin.Force(one.hydrostatic_torque(q)[:6])
            at_vehicle = pin.SE3(np.array(one.vehicle.mount)).act(load)
            world = trim.rotation_vehicle_to_world
            assert world @ at_vehicle.linear == pytest.approx(
                [0, 0, trim.net_weight], abs=1e-9
            )
            assert at_vehicle.angular == pytest.approx(np.zeros(3), abs=1e-10)
            assert world == pytest.approx(
                pin.rpy.rpyToMatrix(trim.roll, trim.pitch, 0.0)
            )
            # Rolled by a little more, the water rights it.
            at[:3, :3] = pin.rpy.rpyToMatrix(1e-4, 0.0, 0.0) @ world
            load = pin.Force(one.hydrostatic_torque(one.configuration(at, joints))[:6])
            held = pin.SE3(np.array(one.vehicle.mount)).act(load).angular
            assert (at[:3, :3] @ held)[0] == pytest.approx(
                1e-4 * trim.righting_moment, rel=1e-3
            )
    weights = [one.trim(Q).righting_moment for one in (system, level)]
    assert weights[1] > weights[0]


def test_trim_follows_the_arm():
    """Reaching forward pitches the vehicle nose down, reaching left rolls it left."""
    mounted = vehicle(com=[0, 0, -0.02], mount=pose([0, 0, -0.1], [0, 0, 0]))
    system = a5.load().on_vehicle(mounted)
    reach = a5.named_pose("reach")  # along +x of base_link
    ahead = system.trim(reach)
    assert ahead.pitch > 0.02  # about +y: x down
    left = reach.copy()
    left[0] += np.pi / 2
    turned = system.trim(left)
    tip = system.forward_kinematics(system.configuration(np.eye(4), left)).translation
    assert np.sign(turned.roll) == np.sign(tip[1]) * -1
    assert abs(turned.pitch) < ahead.pitch


def test_it_carries_payloads_and_is_copied(rng):
    system = a5.load().with_hydrodynamics(CURRENT).on_vehicle(vehicle())
    loaded = system.with_payload(**PAYLOAD, added_mass=0.1 * np.eye(6))
    q = random_q(system, rng)
    v = random_v(system, rng)
    a = random_v(system, rng)
    again = pickle.loads(pickle.dumps(loaded))
    assert np.array_equal(
        again.inverse_dynamics(q, v, a), loaded.inverse_dynamics(q, v, a)
    )
    extra = loaded.mass_matrix(q) - system.mass_matrix(q)
    assert np.linalg.eigvalsh(extra).min() > -1e-12
    assert loaded.vehicle is system.vehicle
    batch = loaded.inverse_dynamics_batch(q[None], v[None], a[None])
    close(batch[0], loaded.inverse_dynamics(q, v, a), 1e-12)
    # Other water: what a payload and the vehicle carry along stays theirs.
    built = a5.load().with_hydrodynamics([0.0, 0.1, 0.0], "high")
    built = built.with_payload(**PAYLOAD, added_mass=0.1 * np.eye(6))
    other = loaded.with_hydrodynamics([0.0, 0.1, 0.0], "high")
    close(
        other.inverse_dynamics(q, v, a),
        built.on_vehicle(vehicle()).inverse_dynamics(q, v, a),
        1e-12,
    )


@needs_recordings
@pytest.mark.parametrize("name", ["traj019-2", "traj024-1", "traj_alt_009-0"])
def test_trim_follows_the_recorded_tilt(name):
    """Roll and pitch of a BlueROV2 in a pool follow the arm, 0.4 s behind it.

    The mount's place is from the URDF of the recordings' repository. The ballast is
    unknown: here it trims the mean pose. The height of the centre of buoyancy gives the
    stiffness that the recordings show.
    """
    spec = importlib.util.spec_from_file_location("validate_recordings", SCRIPT)
    script = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = script
    spec.loader.exec_module(script)
    (found,) = (r for r in script.read(RECORDINGS)[0] if r.name == name)
    at = found.grid[::20]
    motion = found.motion
    columns = [np.interp(at - 0.4, motion.time, x) for x in motion.position.T]
    joints = np.stack(columns, 1)
    recorded = script._average(at, found.time, found.tilt)
    mount = pose([0.25, -0.10965, 0.005], [0.0, 0.0, 0.0])

    def system(com):
        body = vehicle(com=com, cob=[0, 0, 0.035], mount=mount)
        return a5.load(a5.FRESH_WATER).on_vehicle(body)

    mean = system(np.zeros(3)).trim(joints.mean(axis=0)[:4])
    up = mean.rotation_vehicle_to_world[2]
    lever = mean.righting_moment / (9.81 * 13.5)
    ballasted = system(lever * np.array([up[0], up[1], 0.0]))
    trims = [ballasted.trim(q[:4]) for q in joints]
    ours = np.array([[trim.roll, trim.pitch] for trim in trims])
    for k in (0, 1):
        assert np.corrcoef(ours[:, k], recorded[:, k])[0, 1] > 0.9
        assert 0.5 < ours[:, k].std() / recorded[:, k].std() < 1.5


@each(
    "changes",
    [
        {"mass": -1.0},
        {"volume": np.nan},
        {"com": [0.0, 0.0]},
        {"inertia": np.eye(2)},
        {"added_mass": np.diag([1.0, 1, 1, 1, 1, -1])},
        {"added_mass": [1.0, 1, 1, 1, 1, -1]},
        {"added_mass": np.eye(6) + np.eye(6, k=1)},
        {"added_mass": "much"},
        {"linear_damping": [1.0, 1, 1, 1, 1, -0.1]},
        {"quadratic_damping": [-1.0, 1, 1, 1, 1, 0.1]},
        {"quadratic_damping": np.eye(6)},
        {"mount": np.diag([1.0, 1, -1, 1])},
    ],
)
def test_wrong_vehicles_are_refused(changes):
    with pytest.raises(a5.Alpha5Error):
        vehicle(**changes)


def test_the_mount_is_that_of_the_command_line_and_of_xacro():
    """The arm on a level vehicle weighs on its base as under --mount with the pose."""
    rotation = pin.rpy.rpyToMatrix(0.4, -0.7, 1.1)
    mount = pose([0.15, -0.1, -0.14], [0.4, -0.7, 1.1])
    system = a5.load().on_vehicle(vehicle(mount=mount))
    q = system.configuration(np.eye(4), Q)
    gravity = rotation.T @ [0.0, 0.0, -9.81]
    alone = a5.load(gravity=gravity).base_wrench(Q, np.zeros(4), np.zeros(4))
    still = np.zeros(10)
    close(system.mount_load(q, still, still).vector, alone.vector, 1e-12)
    np.testing.assert_allclose(q[:3], [0.15, -0.1, -0.14], atol=1e-15)


@pytest.mark.parametrize(
    "mistake",
    [
        lambda arm: arm.on_vehicle(13.5),
        lambda arm: arm.on_vehicle(vehicle(inertia=np.diag([1.0, 0.1, 0.1]))),
        lambda arm: arm.on_vehicle(vehicle()).trim([0.0, 0.0]),
        lambda arm: arm.on_vehicle(vehicle()).configuration(np.eye(3), Q),
        lambda arm: a5.load(gravity=(1.0, 0.0, -9.0)).on_vehicle(vehicle()).trim(Q),
        lambda arm: arm.on_vehicle(vehicle()).reaction(
            np.zeros(11), np.zeros(10), np.zeros(4)
        ),
    ],
)
def test_wrong_use_is_told(mistake):
    with pytest.raises(a5.Alpha5Error):
        mistake(a5.load())


def test_a_table_of_a_vehicle() -> None:
    table = {"mass": 11.5, "com": [0, 0, -0.02], "volume": 0.0115, "cob": [0, 0, 0.03]}
    found = read_carrier("rov", table)
    np.testing.assert_array_equal(found.mount, np.eye(4))
    assert (found.mass, found.volume) == (11.5, 0.0115)
    for key, wrong in (
        ("mass", -0.5),
        ("volume", -0.5),
        ("com", [0, 0]),
        ("cob", [0, 0, np.nan]),
        ("xyz", [0, 0]),
        ("rpy", [0, 0, 0, 0]),
    ):
        with pytest.raises(a5.errors.InputError, match=f"rov.{key}"):
            read_carrier("rov", {**table, key: wrong})


# --- trim -----------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore:gravity")
def test_a_trim_where_z_points_down() -> None:
    """In a world whose gravity is along +z, the vehicle rests upside down."""
    for gravity in (-9.81, 9.81):
        system = a5.load(gravity=(0.0, 0.0, gravity)).on_vehicle(a5.Vehicle(**BODY))
        trim = system.trim(Q)
        world = np.eye(4)
        world[:3, :3] = trim.rotation_vehicle_to_world
        load = pin.Force(system.hydrostatic_torque(system.configuration(world, Q))[:6])
        np.testing.assert_allclose(load.angular, np.zeros(3), atol=1e-10)
        held = trim.rotation_vehicle_to_world @ load.linear
        weight = -np.sign(gravity) * trim.net_weight
        np.testing.assert_allclose(held, [0.0, 0.0, weight], atol=1e-10)
        assert trim.righting_moment > 0


def test_a_vehicle_that_turns_over_is_warned_of() -> None:
    """A float below the centre of mass turns up; above it, it stays there."""
    for height, upside_down in ((0.3, False), (-0.3, True)):
        body = {**BODY, "com": np.zeros(3), "cob": np.array([0.0, 0.0, height])}
        system = a5.load().on_vehicle(a5.Vehicle(**body))
        with warnings.catch_warnings(record=True) as given:
            warnings.simplefilter("always")
            trim = system.trim(Q)
        assert (trim.rotation_vehicle_to_world[2, 2] < 0.0) == upside_down
        said = [str(w.message) for w in given if "upside down" in str(w.message)]
        assert bool(said) == upside_down


@pytest.mark.parametrize("gravity", [(1.0, 0, -9.0), (0, 1.0, -9.0), (0, 0, 0)])
def test_a_trim_needs_gravity_along_z(gravity: tuple[float, ...]) -> None:
    system = a5.load(gravity=gravity).on_vehicle(a5.Vehicle(**BODY))
    with pytest.raises(a5.errors.InputError, match="gravity along the world's z"):
        system.trim(Q)


def test_a_vehicle_without_a_righting_moment() -> None:
    """Its centre of mass is moved until the moment is gone."""
    system = a5.load().on_vehicle(a5.Vehicle(**BODY))
    trim = system.trim(Q)
    lever = trim.righting_moment * trim.rotation_vehicle_to_world[2] / 9.81
    for rest, refused in ((0.0, True), (1e-5, False)):
        com = BODY["com"] + (1.0 - rest) * lever / BODY["mass"]
        system = a5.load().on_vehicle(a5.Vehicle(**{**BODY, "com": com}))
        if refused:
            with pytest.raises(
                a5.errors.InputError, match="expected a righting moment"
            ):
                system.trim(Q)
            continue
        moment = system.trim(Q).righting_moment
        assert moment == pytest.approx(rest * trim.righting_moment, rel=1e-3)
