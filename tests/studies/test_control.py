"""Gains keep what they promise: by frequency response, in MuJoCo and by brute force."""

from __future__ import annotations

import json
import re
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
import yaml
from lazily import Lazy

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.description.mjcf import MjcfOptions, mjcf
from alpha5_model.errors import (
    ImplausibleWarning,
    InputError,
    MissingParameterError,
    NonFiniteError,
    ShapeError,
)

mujoco = Lazy("mujoco")

HARDWARE = {"rate": 200.0, "delay": 0.01, "rotor_inertias": 5e-8}
HOME, REACH = a5.named_pose("home"), a5.named_pose("reach")
DEGREE = np.pi / 180


def random_poses(arm, count, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(arm.limits.lower, arm.limits.upper, (count, 4))


# --- margins --------------------------------------------------------------------------


def response(stiffness, damping, inertia, delay, w):
    s = 1j * w
    return (stiffness + damping * s) * np.exp(-s * delay) / (inertia * s**2)


@pytest.mark.parametrize("seed", range(5))
def test_margins_are_those_of_the_frequency_response(seed):
    rng = np.random.default_rng(seed)
    K, D, M = np.exp(rng.uniform(-2, 3, 3))
    T = rng.uniform(0.1, 2.5) * min(1.0, M / D, D / K / 3)
    found = a5.control.margins(K, D, M, T)

    highest = max(1.2 * found.crossover, np.pi / T)
    w = np.geomspace(1e-6 * highest, highest, 200_001)
    loop = response(K, D, M, T, w)
    crossed = int(np.flatnonzero(np.abs(loop) > 1)[-1])
    assert found.crossover == pytest.approx(w[crossed], rel=2e-4)
    phase = np.unwrap(np.angle(loop))
    # -180 deg at low frequency
    phase += 2 * np.pi * np.round((-np.pi - phase[0]) / (2 * np.pi))
    assert found.phase == pytest.approx(np.pi + phase[crossed], abs=2e-3)
    first_below = int(np.flatnonzero(phase < -np.pi - 1e-9)[0])
    assert found.gain == pytest.approx(1 / abs(loop[first_below]), rel=1e-3)

    # One more delay of that size takes all phase.
    worn = a5.control.margins(K, D, M, T + found.delay)
    assert worn.phase == pytest.approx(0.0, abs=1e-9)


def test_margins_without_delay_or_without_lead():
    free = a5.control.margins(10.0, 1.0, 0.03, 0.0)
    assert np.isinf(free.gain)
    assert free.phase > 0
    late = a5.control.margins(10.0, 1.0, 0.03, 0.2)
    assert late.phase < 0
    assert late.gain == 0


# --- gains ----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def found():
    return a5.control.gains(12.0, **HARDWARE)


def matrices(arm, poses, armature):
    return np.array([arm.mass_matrix(q) for q in poses]) + np.diag(armature)


def phase_by_characteristic_loci(g, matrix):
    """Least phase margin of the coupled loops, with the eigenvalues of L(jw)."""
    w = np.geomspace(0.3, 60, 3000) * g.bandwidth
    s = 1j * w
    controller = g.stiffness + g.damping * s[:, None]
    delay = np.exp(-s * (g.delay + 1 / g.rate)) / s**2
    loops = np.linalg.inv(matrix) * (controller * delay[:, None])[:, None, :]
    loci = np.linalg.eigvals(loops)
    near = np.abs(np.log(np.abs(loci))) < 0.01
    return (np.pi + np.angle(loci[near]) + np.pi) % (2 * np.pi) - np.pi


@pytest.mark.parametrize("payload", [0.0, 0.5])
def test_no_pose_and_payload_has_less_margin(payload):
    g = a5.control.gains(8.0, payload=payload, **HARDWARE)
    least = np.inf
    for mass in {0.0, payload / 2, payload}:
        arm = g.arm.with_payload(mass) if mass else g.arm
        poses = random_poses(arm, 400)
        many = matrices(arm, poses, g.armature)
        diagonal = np.diagonal(many, axis1=1, axis2=2)
        assert (diagonal < 1.005 * g.inertia).all()
        # Of the poses, the loops of the worst.
        ratio = [
            np.linalg.eigvals(np.linalg.inv(m) * g.inertia).real.max() for m in many
        ]
        worst = many[int(np.argmax(ratio))]
        least = min(least, phase_by_characteristic_loci(g, worst).min())
    assert g.margins.phase - 0.5 * DEGREE < least < g.margins.phase + 4 * DEGREE


@pytest.mark.parametrize(
    ("bandwidth", "hardware"),
    [
        (1.0, HARDWARE),
        (0.3, {"rate": 1e3, "delay": 0, "rotor_inertias": 1e-8, "payload": 0.5}),
    ],
)
def test_at_low_bandwidth_the_worst_loop_is_that_of_joints_that_turn_together(
    bandwidth, hardware
):
    g = a5.control.gains(bandwidth, **hardware)
    least = np.inf
    for mass in {0.0, g.payload}:
        arm = g.arm.with_payload(mass) if mass else g.arm
        for matrix in matrices(arm, random_poses(arm, 300), g.armature):
            ratios = np.linalg.eigvals(np.linalg.inv(matrix) * g.inertia).real
            w = np.geomspace(0.2, 20, 2000)[:, None] * bandwidth
            delay = g.delay + 1 / g.rate
            loop = response(bandwidth**2, 2 * bandwidth, 1 / ratios, delay, w)
            crossed = np.abs(loop) < 1
            angles = np.angle(-np.take_along_axis(loop, crossed.argmax(0)[None], 0))
            least = min(least, angles.min())
    assert g.margins.phase - 0.2 * DEGREE < least < g.margins.phase + 2 * DEGREE


@pytest.mark.parametrize("rotor", [0.0, 1e-9, 5e-8])
def test_each_loop_settles_in_the_settling_time(rotor):
    """By the poles of ``M e'' + D e' + K e = 0`` at random poses."""
    g = a5.control.gains(0.05, rate=1000, delay=0, rotor_inertias=rotor)
    time = np.linspace(0, 2 * g.settling_time, 4000)
    slowest = 0.0
    for matrix in matrices(g.arm, random_poses(g.arm, 200), g.armature):
        for r in np.linalg.eigvals(np.linalg.inv(matrix) * g.inertia).real:
            w = g.bandwidth
            a, b = np.roots([1, 2 * w * r, w**2 * r]).astype(complex)
            error = (b * np.exp(a * time) - a * np.exp(b * time)) / (b - a)
            slowest = max(slowest, time[np.flatnonzero(np.abs(error) > 0.02)[-1]])
    assert 0.75 * g.settling_time < slowest < 1.001 * g.settling_time
    again = {"rate": 1000, "delay": 0, "rotor_inertias": rotor}
    back = a5.control.gains(settling_time=g.settling_time, **again)
    assert back.bandwidth == pytest.approx(0.05)


def test_the_fastest_bandwidth_keeps_45_degrees(found):
    fastest = a5.control.gains(0.9999 * found.fastest, **HARDWARE)
    assert fastest.margins.phase == pytest.approx(45 * DEGREE, abs=0.01 * DEGREE)
    with pytest.raises(InputError) as error:
        a5.control.gains(1.0001 * found.fastest, **HARDWARE)
    assert error.value.name == "bandwidth"
    # What the message calls possible is so.
    possible = float(error.value.expected.split()[2])
    assert a5.control.gains(possible, **HARDWARE).bandwidth == possible
    with pytest.raises(InputError) as error:
        a5.control.gains(settling_time=0.1, **HARDWARE)
    assert error.value.name == "settling_time"
    possible = float(error.value.expected.split()[2])
    a5.control.gains(settling_time=possible, **HARDWARE)


def test_rotors_behind_gears_make_loops_alike():
    """By the definition n^2 J; without motors the folded arm turns almost nothing."""
    gear = np.array([1754.4, 1754.4, 1754.4, 340.4])
    geared = a5.control.gains(1.0, rate=200, delay=0.01, rotor_inertias=1e-7)
    np.testing.assert_allclose(geared.armature, gear**2 * 1e-7)
    bare = a5.control.gains(0.05, rate=200, delay=0.01, rotor_inertias=0)
    assert bare.ratio > 100
    assert geared.ratio < 1.2
    assert geared.fastest > 100 * bare.fastest


def test_the_digits_move_the_margin_as_far_as_samples_do():
    poses = [REACH, HOME, [3.0, 1.5, 0.6, 1.0]]
    g = a5.control.gains(0.5, rate=200, delay=0.01, rotor_inertias=0, q=poses)
    drawn = a5.uncertainty.sample(40, seed=3)
    ratios = []
    for k in range(40):
        arm = a5.uncertainty.arm(drawn.parameters(k))
        each = [np.linalg.inv(arm.mass_matrix(q)) * g.inertia for q in poses]
        ratios.append(max(np.linalg.eigvals(m).real.max() for m in each))
    off = np.abs(np.array(ratios) - g.ratio).max()
    assert 0.2 * g.ratio_of_digits < off < 1.02 * g.ratio_of_digits


def test_sag_is_what_an_unknown_payload_and_the_digits_leave():
    g = a5.control.gains(8.0, payload=0.4, **HARDWARE)
    heavy = g.arm.with_payload(0.4)
    poses, still = random_poses(g.arm, 300), np.zeros(4)
    torque = a5.uncertainty.bounds(poses, still, still, g.arm).torque
    wrong = (torque.upper - torque.lower) / 2
    for k, q in enumerate(poses):
        wrong[k] += np.abs(heavy.hydrostatic_torque(q) - g.arm.hydrostatic_torque(q))
    largest = (wrong / g.stiffness).max(axis=0)
    assert (largest < 1.03 * g.sag + 1e-12).all()
    assert (largest[1:3] > 0.9 * g.sag[1:3]).all()


def test_moving_water_adds_its_mass(found):
    wet = a5.control.gains(8.0, arm=a5.load().with_hydrodynamics(), **HARDWARE)
    poses = random_poses(wet.arm, 200)
    diagonal = np.diagonal(matrices(wet.arm, poses, wet.armature), axis1=1, axis2=2)
    assert (diagonal < 1.005 * wet.inertia).all()
    assert (wet.inertia > found.inertia).all()


def test_measured_motors_are_used():
    record = a5.parameters()
    own = tuple(replace(a, friction=2e-3) for a in record.actuators)
    motors = replace(
        record.motors,
        rotor_inertias=(5e-8,) * 5,
        viscous_frictions=(2e-7, None, None, None, None),
    )
    arm = a5.load(arm=replace(record, actuators=own, motors=motors))
    mine = a5.control.gains(12.0, rate=200, delay=0.01, arm=arm)
    plain = a5.control.gains(12.0, **HARDWARE)
    np.testing.assert_allclose(mine.stiffness, plain.stiffness)
    viscous = [2e-7 * 1754.4**2, 0, 0, 0]
    np.testing.assert_allclose(plain.damping - mine.damping, viscous, atol=1e-12)
    np.testing.assert_allclose(mine.friction[:3], 2e-3 * 1754.4)
    assert not plain.friction.any()
    # While the goal moves, friction is part of the torque.
    still = mine.torque(HOME, np.zeros(4), HOME)
    moving = mine.torque(HOME, np.zeros(4), HOME, [0, -0.1, 0, 0])
    change = moving - still
    assert change[1] == pytest.approx(-0.1 * mine.damping[1] - mine.friction[1])


def test_the_torque_is_pd_and_what_holds_the_arm(found):
    q, v = HOME + 0.1, np.array([0.1, -0.2, 0.3, 0.4])
    expected = (
        -0.1 * found.stiffness - found.damping * v + a5.load().hydrostatic_torque(q)
    )
    np.testing.assert_allclose(found.torque(q, v, HOME), expected)


# --- the simulated step ---------------------------------------------------------------


def test_mujocos_servos_move_as_the_simulated_step(tmp_path):
    """Position servos, friction loss and armature; fast samples and no delay."""
    g = a5.control.gains(12.0, rate=1000, delay=0.0, rotor_inertias=5e-8)
    friction = np.array([0.3, 0.4, 0.3, 0.02])
    goal = HOME + np.array([0.2, 0.15, -0.2, 0.3])
    ours = a5.control.step(
        g, HOME, goal, current_limit=0.08, friction=friction, duration=0.8
    )

    files = a5.control.mujoco_files(g)
    text = files.pop("alpha5.xml").decode()
    assets = {name.rpartition("/")[2]: data for name, data in files.items()}
    model = mujoco.MjModel.from_xml_string(text, assets)
    model.opt.timestep = 1e-3
    model.dof_frictionloss[:] = friction
    data = mujoco.MjData(model)
    data.qpos[:] = HOME
    limit = 0.08 * g.torque_per_ampere
    theirs = []
    lead = g.damping / g.stiffness
    for k in range(len(ours.time)):
        theirs.append(data.qpos.copy())
        rate = np.sign(goal - ours.goal[k]) * g.arm.limits.velocity
        data.ctrl[:] = ours.goal[k] + lead * rate  # what D does with the goal's rate
        hold = g.arm.hydrostatic_torque(data.qpos)
        # The driver's limit is that of the whole torque.
        model.actuator_forcerange[:, 0] = -limit - hold
        model.actuator_forcerange[:, 1] = limit - hold
        data.qfrc_applied[:] = hold
        mujoco.mj_step(model, data)
    apart = np.abs(np.array(theirs) - ours.position)
    assert apart.max() < 0.01
    assert ours.holds
    assert np.abs(ours.position[-1] - goal).max() < 0.02
    assert (ours.limited[:2] > 0).all()  # and the limit was reached


def test_a_goal_that_has_arrived_stands_still():
    """To the last bit: a rate that stays would hold the joint off its goal."""
    g = a5.control.gains(8.0, **HARDWARE)
    start, goal = [0.97, 1.99, 1.41, 0.87], [4.49, 0.84, 1.25, 5.48]
    done = a5.control.step(g, start, goal, current_limit=0.6, friction=0.0)
    assert (done.goal[-1] == goal).all()
    assert done.error.max() < 0.03


def swing(g, arm, pose, extra):
    """How much a push grows within 3 s in MuJoCo, under g and a further delay."""
    record = arm.parameters
    gear2 = np.array([a.gear_ratio for a in record.actuators[:4]]) ** 2
    rotors = (*(g.armature / gear2).tolist(), None)
    motors = replace(record.motors, rotor_inertias=rotors)
    options = MjcfOptions(
        arm=replace(record, motors=motors), collision="none", actuators="motor"
    )
    model = mujoco.MjModel.from_xml_string(mjcf(options))
    model.opt.timestep = 5e-4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    model.actuator_ctrllimited[:] = 0
    data = mujoco.MjData(model)
    data.qpos[:] = pose + 1e-4
    hold = arm.hydrostatic_torque(pose)
    every = round(1 / g.rate / model.opt.timestep)
    queue = deque([hold] * max(1, round((g.delay + extra) / model.opt.timestep)))
    seen_before = data.qpos.copy()
    command = hold
    errors = []
    for k in range(6000):
        if k % every == 0:
            rate = (data.qpos - seen_before) * g.rate
            seen_before = data.qpos.copy()
            command = g.torque(data.qpos, rate, pose)
            errors.append(np.abs(data.qpos - pose).max())
        queue.append(command)
        data.ctrl[:] = queue.popleft()
        mujoco.mj_step(model, data)
        if not np.abs(data.qpos).max() < 100:
            return np.inf
    return max(errors[-50:]) / errors[0]


@pytest.mark.slow
def test_a_further_delay_up_to_the_margin_is_stable_in_mujoco_and_beyond_not():
    g = a5.control.gains(10.0, **HARDWARE)
    arm = g.arm
    poses = random_poses(arm, 400)
    ratio = [
        np.linalg.eigvals(np.linalg.inv(m) * g.inertia).real.max()
        for m in matrices(arm, poses, g.armature)
    ]
    worst = poses[int(np.argmax(ratio))]
    margin = float(g.margins.delay)
    assert swing(g, arm, worst, 0.0) < 0.01
    assert swing(g, arm, worst, 0.85 * margin) < 0.5
    assert swing(g, arm, worst, 1.25 * margin) > 2


@pytest.mark.slow
def test_it_settles_in_the_time_that_was_asked_for():
    g = a5.control.gains(settling_time=0.9, rate=200, delay=0.002, rotor_inertias=2e-8)
    for pose in random_poses(g.arm, 4, seed=5):
        middle = 0.8 * pose + 0.2 * HOME
        goal = middle + 0.05
        done = a5.control.step(
            g,
            middle,
            np.clip(goal, g.arm.limits.lower, g.arm.limits.upper),
            current_limit=2.0,
            friction=0.0,
            tolerance=0.02 * 0.05,
            duration=2.0,
        )
        arrived = 0.05 / g.arm.limits.velocity.min()
        assert (done.settled < arrived + g.settling_time).all()


@pytest.mark.slow
def test_what_no_controller_can_do_does_not_pass():
    """Too late, too weak, stuck: and the same step holds with none of these."""
    g = a5.control.gains(10.0, quantisation=2e-4, **HARDWARE)
    goal = HOME + np.array([0.1, 0.1, -0.1, 0.1])

    def holds(gains=g, current_limit=0.5, friction=(0.05, 0.05, 0.05, 5e-3), **more):
        try:
            done = a5.control.step(
                gains,
                HOME,
                goal,
                current_limit=current_limit,
                friction=friction,
                duration=1.2,
                tolerance=0.03,
                **more,
            )
        except InputError:  # thrown about
            return False
        return done.holds

    assert holds()
    assert not holds(friction=6.58)  # by Table 4
    assert not holds(current_limit=0.01)  # 0.2 N m hold nothing
    assert not holds(arm=g.arm.with_payload(1.5))
    assert not holds(gains=replace(g, quantisation=0.2))
    late = replace(g, delay=g.delay + 3 * float(g.margins.delay))
    assert not holds(gains=late, friction=0.0)


# --- files and the command ------------------------------------------------------------


def test_ros2_control_has_the_gains_in_torque(found):
    settings = yaml.safe_load(a5.control.ros2_control(found))
    controller = settings["arm_controller"]["ros__parameters"]
    assert controller["command_interfaces"] == ["effort"]
    assert controller["joints"] == list(found.arm.joint_names)
    rows = [controller["gains"][joint] for joint in found.arm.joint_names]
    np.testing.assert_allclose([r["p"] for r in rows], found.stiffness, rtol=1e-3)
    np.testing.assert_allclose([r["d"] for r in rows], found.damping, rtol=1e-3)
    manager = settings["controller_manager"]["ros__parameters"]
    assert manager["update_rate"] == found.rate


COMMAND = ("gains", "--rate", "200", "--delay", "0.01", "--rotor-inertia", "5e-8")


def test_the_command_says_what_the_function_does(found, capsys, tmp_path):
    file = tmp_path / "gains.yaml"
    words = (*COMMAND, "--bandwidth", "12", "--json", "--ros2-control", str(file))
    assert main(words) == 0
    record = json.loads(capsys.readouterr().out)
    np.testing.assert_allclose(record["stiffness"], found.stiffness)
    per_ampere = np.array([0.0134 * 1754.4 * 0.86] * 3 + [0.0271 * 340.4 * 0.77])
    np.testing.assert_allclose(
        record["stiffness_of_current"], found.stiffness / per_ampere
    )
    assert file.read_text("utf-8") == a5.control.ros2_control(found)


def test_the_command_fails_if_the_step_does_not_hold(capsys):
    assert main((*COMMAND, "--bandwidth", "12", "--current-limit", "0.005")) == 1
    assert "failed" in capsys.readouterr().out


def test_the_command_refuses_what_it_would_leave_out(capsys, tmp_path):
    words = (*COMMAND, "--bandwidth", "8")
    folder = ("--mjcf", str(tmp_path / "servos"))
    for name, more in {
        "mount": (*folder, "--mount", "3.14159", "0", "0"),
        "gravity": (*folder, "--gravity", "0", "0", "9.81"),
        "tolerance": ("--tolerance", "0.1"),
        "friction": ("--friction", "1"),
    }.items():
        assert main((*words, *more)) == 2
        assert name in capsys.readouterr().err
    assert not (tmp_path / "servos").exists()


def test_the_command_skips_a_step_that_is_too_long_to_simulate(capsys):
    command = (*COMMAND, "--bandwidth", "0.1", "--current-limit", "0.6")
    assert main(command) == 1
    assert "no step is simulated" in capsys.readouterr().out
    assert main((*command, "--json")) == 1
    answer = json.loads(capsys.readouterr().out)
    assert "no step is simulated" in answer["skipped"]
    assert answer["steps"] == {}


def test_the_command_says_which_bandwidth_overcomes_friction(capsys):
    command = (*COMMAND, "--current-limit", "0.6", "--friction", "1", "--bandwidth")
    assert main((*command, "8")) == 1
    (enough,) = re.findall(r"at least ([\d.]+) rad/s", capsys.readouterr().out)
    assert main((*command, str(1.01 * float(enough)))) == 0


def test_what_cannot_be_used_is_named(found):
    good = {"bandwidth": 5.0, **HARDWARE}
    wrong = {
        "bandwidth": (NonFiniteError, {"bandwidth": np.nan}),
        "rate": (InputError, {"rate": 0.005}),  # seconds for Hz
        "delay": (InputError, {"delay": 10}),  # milliseconds
        "quantisation": (InputError, {"quantisation": 0.5}),
        "payload": (InputError, {"payload": -0.1}),
        "rotor_inertias": (InputError, {"rotor_inertias": [1e-8, 1e-8]}),
        "q": (ShapeError, {"q": [[1.0, 2.0]]}),
        "arm": (InputError, {"arm": a5.load(gripper="jaws")}),
    }
    for name, (kind, change) in wrong.items():
        with pytest.raises(kind) as error:
            a5.control.gains(**{**good, **change})
        assert error.value.name == name
    with pytest.raises(InputError) as error:
        a5.control.gains(**{**good, "q": np.zeros((0, 4))})
    assert error.value.name == "q"
    with pytest.raises(InputError) as error:
        a5.control.gains(**{**good, "q": [[180.0, 45.0, 135.0, 90.0]]})  # degrees
    assert error.value.name == "q"
    with pytest.raises(InputError) as error:
        found.torque(HOME, HOME, HOME, [0.1, 0.1])
    assert error.value.name == "v_goal"
    with pytest.raises(InputError) as error:
        a5.control.ros2_control(replace(found, rate=62.5))
    assert error.value.name == "rate"
    for times in ({}, {"bandwidth": 5.0, "settling_time": 1.0}):
        with pytest.raises(InputError) as error:
            a5.control.gains(**times, **HARDWARE)
        assert error.value.name == "bandwidth"
    with pytest.raises(MissingParameterError) as missing:
        a5.control.gains(5.0, rate=200, delay=0.01)
    assert missing.value.parameter == "rotor_inertias"

    steps = {
        "start": {"start": [0, 0, 0, 0]},
        "current_limit": {"current_limit": 0.0},
        "arm": {"arm": a5.load(gripper="jaws")},
        "friction": {"friction": [1.0, -1.0, 1.0, 1.0]},
        "tolerance": {"tolerance": 0.0},
        "duration": {"duration": 1e6},
    }
    for name, change in steps.items():
        given = {"start": HOME, "goal": REACH, "current_limit": 0.5, **change}
        with pytest.raises(InputError) as error:
            a5.control.step(found, given.pop("start"), given.pop("goal"), **given)
        assert error.value.name == name
    with pytest.raises(InputError) as error:
        a5.control.step("gains", HOME, REACH, current_limit=0.5)
    assert error.value.name == "found"
    with pytest.warns(ImplausibleWarning, match="mA"):
        a5.control.step(found, HOME, HOME, current_limit=600, duration=0.01)
    for name in ("stiffness", "damping", "inertia", "delay"):
        loop = {"stiffness": 1.0, "damping": 1.0, "inertia": 1.0, "delay": 0.01}
        for wrong in (-1.0, 1e200, 1e-200):
            with pytest.raises(InputError) as error:
                a5.control.margins(**{**loop, name: wrong})
            assert error.value.name == name
    for asked in ({"bandwidth": 1e-200}, {"settling_time": 1e40}):
        with pytest.raises(InputError) as error:
            a5.control.gains(**asked, **HARDWARE)
        assert error.value.name == next(iter(asked))


@pytest.mark.parametrize(
    ("name", "ask"),
    [
        ("delay", lambda: a5.control.margins(10, 1, 0.3, 40)),  # ms
        ("settling_time", lambda: a5.control.gains(settling_time=1600, **HARDWARE)),
        (
            "rotor_inertias",  # a maker's 0.5 g cm^2
            lambda: a5.control.gains(0.1, **{**HARDWARE, "rotor_inertias": 0.5}),
        ),
    ],
)
def test_other_units_are_named(name, ask):
    with pytest.warns(ImplausibleWarning, match=name):
        ask()
