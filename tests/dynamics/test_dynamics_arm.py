"""An arm as an object: its input, ownership, threads, copies, payload and loading."""

from __future__ import annotations

import copy
import math
import pickle
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import PAYLOAD, VARIANTS, make, random_q, random_v
from loops import each
from pinocchio_collision import CollisionModel
from reference import MASS, VOLUME

import alpha5_model as a5
from alpha5_model._support.checks import LARGEST
from alpha5_model.dynamics import load as dynamics
from alpha5_model.dynamics.load import arm_of
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.errors import (
    InputError,
    MissingFileError,
    NonFiniteError,
    ShapeError,
    UnknownNameError,
)

OF_Q = (
    "forward_kinematics",
    "jacobian",
    "mass_matrix",
    "gravity_torque",
    "buoyancy_torque",
    "hydrostatic_torque",
    "hydrostatic_torque_derivative",
    "buoyancy_wrenches",
    "potential_energy",
    "center_of_mass",
    "center_of_buoyancy",
)
OF_QV = ("coriolis_matrix", "nonlinear_effects", "kinetic_energy")
OF_QVX = (
    "inverse_dynamics",
    "forward_dynamics",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "base_wrench",
    "base_wrench_derivatives",
    "inverse_dynamics_batch",
    "forward_dynamics_batch",
    "base_wrench_batch",
)
METHODS = {
    **dict.fromkeys(OF_Q, 1),
    **dict.fromkeys(OF_QV, 2),
    **dict.fromkeys(OF_QVX, 3),
}
KINDS = ("locked", "floating", "jaws")


def numbers(result):
    """A result as one flat array."""
    if isinstance(result, pin.SE3):
        return result.homogeneous.ravel()
    if isinstance(result, pin.Force):
        return result.vector
    if isinstance(result, tuple):
        return np.concatenate([r.ravel() for r in result])
    if isinstance(result, pin.StdVec_Force):
        return np.concatenate([f.vector for f in result])
    return np.ravel(result)


def inputs(arm, count, seed=0):
    rng = np.random.default_rng(seed)
    return [random_q(arm, rng), random_v(arm, rng), random_v(arm, rng)][:count]


@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_nothing_that_is_not_finite_gets_through(kind, method, count):
    """A bad number at any place of any argument is refused with its place."""
    arm = make(kind)
    clean = inputs(arm, count)
    for which in range(count):
        for place in range(len(clean[which])):
            for bad in (math.nan, math.inf, -math.inf):
                given = [x.copy() for x in clean]
                given[which][place] = bad
                with pytest.raises(NonFiniteError) as error:
                    getattr(arm, method)(*given)
                assert error.value.index[-1] == place
                with pytest.raises(NonFiniteError):
                    getattr(arm, method)(*[x.tolist() for x in given])


@pytest.mark.parametrize(
    "variant", ["locked", "locked, air, tilted", "locked, payload, tilted"]
)
def test_the_fast_path_finds_each_bad_place_in_special_poses_too(variant):
    arm = make(variant)
    for q in (np.zeros(4), np.full(4, np.pi / 2), np.array([0.0, 1.3, 1.3, 0.0])):
        for which in range(3):
            for place in range(4):
                for bad in (math.nan, math.inf):
                    given = [q.copy(), np.zeros(4), np.zeros(4)]
                    given[which][place] = bad
                    with pytest.raises(NonFiniteError):
                        arm.inverse_dynamics(*given)


@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_wrong_input_is_one_clear_error(kind, method, count):
    arm = make(kind)
    clean = inputs(arm, count)
    for which in range(count):
        n = len(clean[which])
        wrong_shapes = [
            np.ones(n + 1),
            np.ones(n - 1),
            np.float64(1.0),
            np.ones((n, 2)),
        ]
        if not method.endswith("_batch"):
            wrong_shapes += [
                np.ones((n, 1)),
                np.ones((1, n)),
                np.ones((n, n)),
                np.ones((0, n)),
            ]
        for bad in wrong_shapes:
            given = list(clean)
            given[which] = bad
            with pytest.raises(ShapeError):
                getattr(arm, method)(*given)
        for bad in (
            "abcd",
            None,
            np.ones(n) * 1j,
            [[1.0], [1.0, 2.0]],
            np.array(["a"] * n),
            {},
        ):
            given = list(clean)
            given[which] = bad
            with pytest.raises(InputError):
                getattr(arm, method)(*given)


def largest_inputs(clean, kind):
    """The largest magnitude at each place of each argument."""
    bounds = [np.full(len(x), LARGEST) for x in clean]
    if kind == "jaws":
        # The fingers turn 51 rad per metre of the rod, and their angles are bounded.
        for bound in bounds:
            bound[-1] /= 51.0
    return bounds


def bounded_places(arm, clean):
    """Number of the argument and place in it; a quaternion has its norm instead."""
    places = [(which, k) for which, x in enumerate(clean) for k in range(len(x))]
    quaternion = {(0, k) for k in range(3, 7)} if arm.floating_base else set()
    return [place for place in places if place not in quaternion]


def acceleration_is_beyond_the_bound(method):
    """Whether finite input gives a method an acceleration that it refuses."""
    return method.startswith("forward_dynamics_d")


def is_finite(compute, given):
    """Whether an answer is finite; a rod 1e51 m out may leave no mass matrix."""
    try:
        return np.isfinite(numbers(compute(*given))).all()
    except InputError as error:
        return error.name == "q" and "singular" in str(error)


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_numbers_that_would_overflow_are_refused_and_no_others(kind, method, count):
    """Up to the bound every result is finite; beyond it there is none."""
    arm = make(kind)
    compute = getattr(arm, method)
    clean = inputs(arm, count)
    bounds = largest_inputs(clean, kind)
    for which, place in bounded_places(arm, clean):
        for sign in (1.0, -1.0):
            given = [x.copy() for x in clean]
            given[which][place] = sign * bounds[which][place] * (1 - 1e-12)
            if not acceleration_is_beyond_the_bound(method):
                assert is_finite(compute, given)
            for bad in (LARGEST * (1 + 1e-12), 1e200, 1.7e308):
                given[which][place] = sign * bad
                with pytest.raises(InputError, match="overflow"):
                    compute(*given)
    if not arm.floating_base and not acceleration_is_beyond_the_bound(method):
        extreme = [0.4 * x for x in bounds]
        assert is_finite(compute, extreme)


@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_masks_and_units_are_not_lost(kind, method, count):
    arm = make(kind)
    clean = inputs(arm, count)
    for which, x in enumerate(clean):
        given = list(clean)
        for bad in (np.ma.masked_array(x), np.ma.masked_less(x, 0.0)):
            given[which] = bad
            with pytest.raises(InputError, match="without mask or unit"):
                getattr(arm, method)(*given)


def test_records_that_hold_arrays_compare_by_identity():
    arm = a5.load()
    q = np.ones((1, 4))
    for record in (
        arm.displacements[0],
        torque_terms(arm, q, q, q),
        CollisionModel(arm.model).clearance(q[0]),
    ):
        twin = copy.copy(record)
        assert record == record
        assert record != twin
        assert len({record, twin}) == 2


def test_an_arm_cannot_be_made_of_what_is_none():
    arm = a5.load()
    body = arm.displacements[1]
    for model, bodies in (
        (None, []),
        (pin.Model(), []),
        ("arm.urdf", arm.displacements),
        (arm.model, None),
        (arm.model, "bodies"),
        (arm.model, [*arm.displacements, 1]),
    ):
        with pytest.raises(InputError):
            a5.Arm(model, bodies)
    with pytest.raises(UnknownNameError, match="unknown joint 'axis_z'"):
        a5.Arm(arm.model, [replace(body, joint="axis_z")])
    for wrong in (
        {"volume": -1e-9},
        {"volume": math.nan},
        {"volume": 1e60},
        {"volume": True},
        {"cob": (0.0, 0.0)},
        {"cob": np.zeros((1, 3))},
        {"cob": (0.0, 0.0, math.inf)},
    ):
        with pytest.raises(InputError, match=next(iter(wrong))):
            replace(body, **wrong)
    with pytest.raises(InputError, match="volume above 0"):
        a5.Arm(arm.model, []).center_of_buoyancy(np.zeros(4))
    dry = a5.Arm(arm.model, [])
    assert np.array_equal(
        dry.hydrostatic_torque(np.ones(4)), arm.gravity_torque(np.ones(4))
    )


@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_input_and_output_belong_to_the_caller(kind, method, count):
    arm = make(kind)
    given = inputs(arm, count)
    before = [x.copy() for x in given]
    for x in given:
        x.flags.writeable = False
    call = getattr(arm, method)
    first = call(*given)
    kept = numbers(first).copy()
    for x, y in zip(given, before, strict=True):
        assert np.array_equal(x, y)
    # Another computation does not change the first result.
    call(*inputs(arm, count, seed=1))
    assert np.array_equal(numbers(first), kept)
    if isinstance(first, np.ndarray):
        first += 1.0
        assert np.array_equal(numbers(call(*given)), kept)


@each("kind", KINDS)
@each(("method", "count"), METHODS.items())
def test_lists_and_strided_arrays_give_the_same(kind, method, count):
    arm = make(kind)
    call = getattr(arm, method)
    given = inputs(arm, count)
    expected = numbers(call(*given))
    lists = [x.tolist() for x in given]
    assert np.array_equal(numbers(call(*lists)), expected)
    strided = [np.repeat(x, 2)[::2] for x in given]
    assert np.array_equal(numbers(call(*strided)), expected)


@each(("method", "count"), METHODS.items())
def test_arrays_of_other_types_stand_for_their_numbers(method, count):
    call = getattr(make("locked"), method)
    expected = numbers(call(*[np.ones(4)] * count))
    whole = [np.ones(4, dtype=t) for t in (int, np.float32, np.int8)][:count]
    assert np.array_equal(numbers(call(*whole)), expected)
    for place in range(count):
        for other in (np.longdouble, ">f8", ">i4"):
            mixed = [np.ones(4) for _ in range(count)]
            mixed[place] = np.ones(4, dtype=other)
            assert np.array_equal(numbers(call(*mixed)), expected)


def test_the_arm_does_not_follow_changes_of_the_model_it_hands_out():
    arm = a5.load()
    q = np.array([0.1, 0.2, 0.3, 0.4])
    before = arm.hydrostatic_torque(q), arm.base_wrench(q, 0 * q, 0 * q).vector
    arm.model.gravity.linear = np.zeros(3)
    arm.model.inertias[2].mass = 7.0
    arm.fluid_model.gravity.linear = np.zeros(3)
    assert np.array_equal(arm.hydrostatic_torque(q), before[0])
    assert np.array_equal(arm.base_wrench(q, 0 * q, 0 * q).vector, before[1])
    assert np.array_equal(a5.load().hydrostatic_torque(q), before[0])


def test_no_method_touches_the_caller_s_data():
    arm = a5.load()
    q, v, a = inputs(arm, 3)
    pin.rnea(arm.model, arm.data, q, v, a)
    tau = arm.data.tau.copy()
    force = arm.data.f[1].vector.copy()
    for method, count in METHODS.items():
        getattr(arm, method)(*inputs(arm, count, seed=3))
    assert np.array_equal(arm.data.tau, tau)
    assert np.array_equal(arm.data.f[1].vector, force)


@pytest.mark.parametrize("kind", KINDS)
def test_one_arm_in_many_threads(kind):
    arm = make(kind)
    rng = np.random.default_rng(4)
    work = [
        (random_q(arm, rng), random_v(arm, rng), random_v(arm, rng)) for _ in range(200)
    ]

    def job(states):
        q, v, a = states
        own = id(arm.data)
        assert own == id(arm.data)
        many = np.tile(q, (30, 1)), np.tile(v, (30, 1)), np.tile(a, (30, 1))
        return np.concatenate(
            [
                arm.inverse_dynamics(q, v, a),
                arm.base_wrench(q, v, a).vector,
                arm.forward_kinematics(q).translation,
                arm.center_of_buoyancy(q),
                arm.inverse_dynamics_batch(*many, threads=2)[-1],
            ]
        )

    alone = [job(states) for states in work]
    with ThreadPoolExecutor(8) as pool:
        together = list(pool.map(job, work))
        data = set(pool.map(lambda _: id(arm.data), range(64)))
    assert np.array_equal(alone, together)
    assert id(arm.data) not in data


@each("variant", VARIANTS)
def test_pickle(variant):
    arm = make(variant)
    twin = pickle.loads(pickle.dumps(arm))
    assert type(twin) is type(arm)
    assert repr(twin) == repr(arm)
    for method, count in METHODS.items():
        given = inputs(arm, count)
        assert np.array_equal(
            numbers(getattr(twin, method)(*given)),
            numbers(getattr(arm, method)(*given)),
        )


def test_quaternion_must_have_unit_norm():
    arm = a5.load(floating_base=True)
    q, v, a = inputs(arm, 3)
    q[3:7] *= 1.001
    for call in (lambda: arm.inverse_dynamics(q, v, a), lambda: arm.mass_matrix(q)):
        with pytest.raises(InputError, match="unit quaternion"):
            call()
    good, _, _ = inputs(arm, 3)
    with pytest.raises(InputError, match=r"q\[1, 3:7\]"):
        arm.inverse_dynamics_batch([good, q], [v, v], [a, a])
    q[3:7] = 0.0
    with pytest.raises(InputError, match="norm 0"):
        arm.forward_kinematics(q)


def test_frames_and_reference_frames():
    arm = a5.load()
    q = np.zeros(4)
    with pytest.raises(
        UnknownNameError, match=r"unknown frame 'gripper'; choose from .*tcp, tip"
    ):
        arm.forward_kinematics(q, frame="gripper")
    for bad in ("gripper", None, 3, ["tcp"]):
        with pytest.raises(UnknownNameError):
            arm.jacobian(q, bad)
        with pytest.raises(UnknownNameError):
            arm.forward_kinematics(q, bad)
        with pytest.raises(UnknownNameError):
            arm.with_payload(1.0, frame=bad)
    with pytest.raises(InputError, match="reference_frame"):
        arm.jacobian(q, reference_frame="local")
    assert not np.array_equal(
        arm.jacobian(q), arm.jacobian(q, reference_frame=pin.LOCAL)
    )


def test_external_forces_are_checked():
    arm = a5.load()
    q, v, a = inputs(arm, 3)
    zero = [pin.Force.Zero()] * arm.model.njoints
    assert np.array_equal(
        arm.inverse_dynamics(q, v, a, fext=zero), arm.inverse_dynamics(q, v, a)
    )
    bad = pin.Force(np.array([0, 0, math.nan, 0, 0, 0]))
    for method in ("inverse_dynamics", "forward_dynamics", "base_wrench"):
        call = getattr(arm, method)
        for fext in (
            zero[:-1],
            [*zero, zero[0]],
            3,
            "fext",
            [np.zeros(6)] * 5,
            np.zeros((5, 6)),
        ):
            with pytest.raises(InputError, match="fext"):
                call(q, v, a, fext=fext)
        with pytest.raises(NonFiniteError):
            call(q, v, a, fext=[*zero[:-1], bad])
        with pytest.raises(InputError, match=r"fext\[4\].* overflow"):
            call(q, v, a, fext=[*zero[:-1], pin.Force(np.full(6, 1e60))])


@pytest.mark.parametrize("options", [{}, {"gripper": "jaws"}])
def test_an_arm_keeps_its_record(options: dict[str, str]) -> None:
    corrections = ("base_frame", "link3_cob")
    record = a5.parameters(corrections)
    arm = a5.load(corrections=corrections, **options)
    vehicle = a5.Vehicle(10.0, np.zeros(3), np.eye(3), 0.01, np.zeros(3))
    wet = arm.with_hydrodynamics()
    for made in (
        arm,
        arm.with_payload(0.1).with_payload(0.2),
        copy.copy(arm),
        wet,
        wet.with_payload(0.1),
        arm.on_vehicle(vehicle),
        wet.on_vehicle(vehicle).on_vehicle(vehicle).with_payload(0.1),
    ):
        assert made.parameters is record
    for again in (copy.deepcopy(arm), pickle.loads(pickle.dumps(arm))):
        assert again.parameters.corrections == corrections
        np.testing.assert_array_equal(
            again.with_payload(0.1).parameters.links[3].cob, record.links[3].cob
        )
    made_by_hand = a5.Arm(a5.load().model, a5.load().displacements)
    assert made_by_hand.parameters is a5.parameters()
    sampled = a5.uncertainty.sample(1).parameters(0)
    assert arm_of(sampled).parameters is sampled
    with pytest.raises(InputError, match="parameters"):
        a5.Arm(made_by_hand.model, (), parameters=corrections)


def test_batch_arguments():
    arm = a5.load()
    ones = np.ones((3, 4))
    for threads in (0, -1, 1.5, True, "2"):
        with pytest.raises(InputError, match="threads"):
            arm.inverse_dynamics_batch(ones, ones, ones, threads=threads)
    with pytest.raises(ShapeError, match="3 rows"):
        arm.inverse_dynamics_batch(ones, ones[:2], ones)
    with pytest.raises(ShapeError):
        arm.inverse_dynamics_batch(ones[None], ones, ones)
    fortran = np.asfortranarray(np.random.default_rng(0).normal(size=(3, 4)))
    plain = np.ascontiguousarray(fortran)
    assert np.array_equal(
        arm.inverse_dynamics_batch(fortran, fortran, fortran),
        arm.inverse_dynamics_batch(plain, plain, plain),
    )


# --- payload --------------------------------------------------------------------------


def payload_wrench(
    rotation: np.ndarray, twist: pin.Motion, rate: pin.Motion, gravity: np.ndarray
) -> np.ndarray:
    """Force and moment at the TCP that move PAYLOAD, in the world's axes, (6,).

    Args:
        rotation: The TCP's, (3, 3).
        twist: Its velocity.
        rate: Its classical acceleration.
        gravity: (3,).
    """
    lever = rotation @ np.array(PAYLOAD["com"])
    omega = twist.angular
    alpha = rate.angular
    centripetal = np.cross(omega, np.cross(omega, lever))
    acceleration = rate.linear + np.cross(alpha, lever) + centripetal
    inertia = rotation @ np.array(PAYLOAD["inertia"]) @ rotation.T
    at_com = PAYLOAD["mass"] * (acceleration - gravity)
    lift = -1025.0 * PAYLOAD["volume"] * gravity
    cob = rotation @ np.array(PAYLOAD["cob"])
    moment = (
        np.cross(lever, at_com)
        - np.cross(cob, lift)
        + inertia @ alpha
        + np.cross(omega, inertia @ omega)
    )
    return np.concatenate([at_com - lift, moment])


def test_payload_is_a_body_of_its_own():
    """A payload adds its Newton-Euler forces at the TCP to the joint torques."""
    arm = a5.load(gravity=(1.0, 2.0, -9.0))
    loaded = arm.with_payload(**PAYLOAD)
    model = arm.model
    data = arm.data
    tcp = model.getFrameId("tcp")
    axes = pin.LOCAL_WORLD_ALIGNED
    rng = np.random.default_rng(5)
    for _ in range(50):
        q, v, a = rng.normal(size=(3, 4))
        pin.forwardKinematics(model, data, q, v, a)
        pin.updateFramePlacements(model, data)
        wrench = payload_wrench(
            data.oMf[tcp].rotation,
            pin.getFrameVelocity(model, data, tcp, axes),
            pin.getFrameClassicalAcceleration(model, data, tcp, axes),
            model.gravity.linear,
        )
        jacobian = pin.computeFrameJacobian(model, data, q, tcp, axes)
        extra = jacobian.T @ wrench
        gap = loaded.inverse_dynamics(q, v, a) - arm.inverse_dynamics(q, v, a) - extra
        assert np.abs(gap).max() < 1e-12
        assert np.abs(extra).max() > 0.01


def test_payload_leaves_the_arm_as_it_was_and_adds_up():
    arm = a5.load()
    q, v, a = inputs(arm, 3)
    before = arm.inverse_dynamics(q, v, a)
    once = arm.with_payload(0.2, (0.0, 0.0, 0.01), volume=1e-4)
    twice = once.with_payload(0.2, (0.0, 0.0, 0.01), volume=1e-4)
    whole = arm.with_payload(0.4, (0.0, 0.0, 0.01), volume=2e-4)
    assert np.array_equal(arm.inverse_dynamics(q, v, a), before)
    difference = twice.inverse_dynamics(q, v, a) - whole.inverse_dynamics(q, v, a)
    assert np.abs(difference).max() < 1e-13
    assert [f.name for f in twice.model.frames][-2:] == ["payload", "payload_2"]
    difference = (
        twice.forward_kinematics(q, "payload_2").homogeneous
        - arm.forward_kinematics(q).homogeneous
    )
    assert np.abs(difference).max() < 1e-15
    on_base = arm.with_payload(1.0, (0.1, 0.0, 0.0), volume=1e-3, frame="base_link")
    assert np.array_equal(on_base.inverse_dynamics(q, v, a), before)
    load = on_base.base_wrench(q, v, a) - arm.base_wrench(q, v, a)
    assert load.linear == pytest.approx([0, 0, (1.025 - 1.0) * 9.81], abs=1e-12)
    assert load.angular == pytest.approx([0, -0.1 * (1.025 - 1.0) * 9.81, 0], abs=1e-12)


def test_payload_defaults_are_a_point_at_the_tcp_that_displaces_nothing():
    arm = a5.load()
    zero = (0.0, 0.0, 0.0)
    spelt = {"com": zero, "inertia": None, "volume": 0.0, "cob": zero, "frame": "tcp"}
    for given, same in (
        ({}, spelt),
        ({"com": (0.01, 0.02, 0.03)}, spelt | {"com": (0.01, 0.02, 0.03)}),
        (
            {"com": (0.01, 0.02, 0.03), "volume": 1e-4},
            spelt
            | {"com": (0.01, 0.02, 0.03), "volume": 1e-4, "cob": (0.01, 0.02, 0.03)},
        ),
    ):
        one = arm.with_payload(0.3, **given)
        two = arm.with_payload(0.3, **same)
        for method, count in METHODS.items():
            state = inputs(arm, count)
            ours, theirs = (numbers(getattr(x, method)(*state)) for x in (one, two))
            assert np.array_equal(ours, theirs)
        tip = arm.center_of_mass(np.zeros(4)) * sum(MASS)
        tip += 0.3 * arm.forward_kinematics(np.zeros(4)).act(
            np.array(given.get("com", zero))
        )
        assert one.center_of_mass(np.zeros(4)) == pytest.approx(
            tip / (sum(MASS) + 0.3), abs=1e-14
        )


def test_payload_of_any_neutral_body_weighs_nothing():
    arm = a5.load(1000.0)
    loaded = arm.with_payload(0.5, (0.01, 0.02, 0.03), volume=0.5e-3)
    for seed in range(20):
        q = inputs(arm, 1, seed)[0]
        difference = loaded.hydrostatic_torque(q) - arm.hydrostatic_torque(q)
        assert np.abs(difference).max() < 1e-14
        assert np.abs(loaded.mass_matrix(q) - arm.mass_matrix(q)).max() > 1e-4


def test_impossible_payloads():
    arm = a5.load()
    for bad in (
        {"mass": -1.0},
        {"mass": math.nan},
        {"mass": "heavy"},
        {"mass": 1.0, "volume": -1e-3},
        {"mass": 1e60},
        {"mass": 1.0, "volume": 1e60},
        {"mass": 1.0, "com": (1e60, 0.0, 0.0)},
        {"mass": 1.0, "cob": (1e60, 0.0, 0.0)},
        {"mass": 1.0, "inertia": 1e60 * np.eye(3)},
        {"mass": 1.0, "com": (0.0, 0.0)},
        {"mass": 1.0, "com": (0.0, 0.0, math.inf)},
        {"mass": 1.0, "cob": (0.0, 0.0, 0.0, 0.0)},
        {"mass": 1.0, "inertia": np.eye(2)},
        {"mass": 1.0, "inertia": "eye"},
        {"mass": 1.0, "inertia": np.diag([1.0, 1.0, 3.0])},
        {"mass": 1.0, "inertia": -np.eye(3)},
        {"mass": 1.0, "inertia": np.full((3, 3), math.nan)},
        {"mass": 0.0, "inertia": np.eye(3)},
    ):
        with pytest.raises(InputError):
            arm.with_payload(**bad)
    # Of two errors, the worse one is reported.
    with pytest.raises(InputError, match="the smallest principal moment -2"):
        arm.with_payload(1.0, inertia=np.diag([1.0, -2.0, 30.0]))


# --- loading --------------------------------------------------------------------------


def test_load_refuses_what_it_cannot_use():
    for bad in (-1.0, math.nan, "brine", None, [1000.0, 1025.0], 1e60):
        with pytest.raises(InputError):
            a5.load(bad)
    with pytest.raises(UnknownNameError, match="locked, jaws"):
        a5.load(gripper="claw")
    with pytest.raises(UnknownNameError):
        a5.load(corrections=("base",))
    for gravity in ((0.0, -9.81), 9.81, (0.0, 0.0, math.inf), "down", (0.0, 0.0, 1e60)):
        with pytest.raises(InputError):
            a5.load(gravity=gravity)
    with pytest.raises(InputError, match="floating_base"):
        a5.load(floating_base="yes")


def test_a_missing_urdf_says_how_to_make_it(monkeypatch, tmp_path):
    monkeypatch.setattr(dynamics, "URDF_PATH", str(tmp_path / "alpha5.urdf"))
    dynamics._parsed.cache_clear()
    dynamics.arm_urdf.cache_clear()
    with pytest.raises(
        MissingFileError, match=r"alpha5\.urdf: no such file.*alpha5 generate"
    ):
        a5.load()


def test_loaded_arms_are_independent():
    one = a5.load()
    two = a5.load()
    assert one.model is not two.model
    one.model.gravity.linear = np.zeros(3)
    assert two.model.gravity.linear[2] == -9.81


def test_constants_do_not_load_pinocchio():
    code = (
        "import sys, alpha5_model as a5; "
        "a5.gravity_in_base([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);"
        "sys.exit('pinocchio' in sys.modules or a5.SEA_WATER != 1025.0)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_public_types_and_constants():
    assert (a5.SEA_WATER, a5.FRESH_WATER, a5.AIR) == (1025.0, 1000.0, 0.0)
    named = [a5.load(name).fluid_density for name in ("sea", "fresh", "air")]
    assert named == [1025.0, 1000.0, 0.0]
    arm = a5.load()
    assert isinstance(arm, a5.Arm)
    assert isinstance(arm.model, pin.Model)
    assert isinstance(arm.data, pin.Data)
    assert isinstance(arm.fluid_model, pin.Model)
    masses = [inertia.mass for inertia in arm.fluid_model.inertias]
    assert masses == pytest.approx(1025.0 * np.array(VOLUME) / 1000)
    assert (
        repr(arm)
        == "Arm(axis_e, axis_d, axis_c, axis_b; fixed base, fluid 1025 kg/m^3)"
    )


def test_gravity_in_base_is_a_tilted_world():
    """A fixed base in turned gravity is a floating base with that attitude."""
    rng = np.random.default_rng(6)
    free = a5.load(floating_base=True)
    for _ in range(20):
        pose = random_q(free, rng)
        rotation = pin.Quaternion(pose[3:7]).toRotationMatrix()
        fixed = a5.load(gravity=a5.gravity_in_base(rotation))
        q = pose[7:]
        still = np.zeros(4)
        of_base, of_joints = np.split(free.hydrostatic_torque(pose), [6])
        assert np.abs(fixed.hydrostatic_torque(q) - of_joints).max() < 1e-12
        wrench = fixed.base_wrench(q, still, still).vector
        assert np.abs(wrench + of_base).max() < 1e-12


def test_gravity_in_base_by_hand():
    nose_down = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    assert a5.gravity_in_base(nose_down) == pytest.approx([9.81, 0.0, 0.0])
    upwards = (0, 0, 9.81)
    assert a5.gravity_in_base(np.eye(3), gravity=upwards) == pytest.approx([0, 0, 9.81])


@pytest.mark.parametrize(
    "bad",
    [
        np.eye(2),
        2 * np.eye(3),
        np.diag([1.0, 1.0, -1.0]),
        np.zeros((3, 3)),
        "north",
        [np.eye(3)],
    ],
)
def test_what_is_no_rotation_of_the_base_is_refused(bad):
    with pytest.raises(InputError):
        a5.gravity_in_base(bad)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
@pytest.mark.parametrize("corrections", [("base_frame",), ()])
def test_robot_wrapper(gripper, corrections):
    robot = a5.robot_wrapper(gripper=gripper, corrections=corrections)
    arm = a5.load(a5.AIR, gripper=gripper, corrections=corrections)
    assert isinstance(robot, pin.RobotWrapper)
    assert robot.model == arm.model
    q, v, a = inputs(arm, 3)
    assert np.array_equal(
        pin.rnea(robot.model, robot.data, q, v, a), arm.inverse_dynamics(q, v, a)
    )
    assert np.array_equal(robot.mass(q), arm.mass_matrix(q))
    floating = a5.robot_wrapper(gripper=gripper, floating_base=True)
    assert floating.nv == robot.nv + 6
    with pytest.raises(UnknownNameError):
        a5.robot_wrapper(gripper="claw")


@pytest.mark.parametrize("place", range(3))
def test_truth_values_are_no_numbers_in_the_fast_call_either(place: int) -> None:
    states = [np.zeros(4), np.zeros(4), np.zeros(4)]
    states[place] = np.array([True, False, True, False])
    with pytest.raises(InputError, match="real numbers"):
        a5.load().inverse_dynamics(*states)


def test_a_pool_has_a_thread_for_each_that_is_asked_for() -> None:
    arm = a5.load()
    of_one, of_three, of_two = (
        arm._scratch.pool(arm.model, threads) for threads in (1, 3, 2)
    )
    assert of_one.size() >= 1
    assert of_three.size() >= 3
    assert of_two is of_three
