"""The kernels of the dynamics against Pinocchio, a Newton-Euler of the tests' own, and the ungrouped equations."""

from __future__ import annotations

import copy
import hashlib
import inspect
import os
import pickle
import re
import subprocess
import sys
import weakref
from functools import cache
from importlib import import_module
from itertools import product
from typing import Any

import casadi
import numpy as np
import pinocchio as pin
import pytest
import reference
from casadi import SX
from dynamics_cases import PAYLOAD, TILTED
from fk import STRETCHED, fk
from newton_euler import link_frames, newton_euler, rotation_x
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.codegen.base_parameters import BASE_PARAMETERS, base_parameters
from alpha5_model.codegen.casadi_functions import folded
from alpha5_model.codegen.functions import functions
from alpha5_model.codegen.program import program
from alpha5_model.codegen.sources import generated_sources
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.kernel_arm import KernelArm
from alpha5_model.errors import InputError, UnknownNameError
from alpha5_model.numbers.parameters import RigidBody

# The formulas hold for any bodies, however unlikely.
pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)

#: Kernel, named as the method of `Arm` -> how far from it, as a share of the largest entry or of 1.
ONE = {
    "jacobian": 1e-14,
    "gravity_torque": 1e-13,
    "buoyancy_torque": 1e-13,
    "hydrostatic_torque": 1e-13,
    "hydrostatic_torque_derivative": 1e-13,
    "mass_matrix": 1e-13,
    "coriolis_matrix": 1e-13,
    "nonlinear_effects": 1e-13,
    "inverse_dynamics": 1e-13,
    "inverse_dynamics_derivatives": 1e-9,
    "base_wrench": 1e-13,
    "base_wrench_derivatives": 1e-9,
    "forward_dynamics": 1e-9,
    "forward_dynamics_derivatives": 1e-9,
}
SETS, STATES = 20, 1000


@pytest.fixture(params=["numpy_kernels", "_compiled"])
def kernels(request: pytest.FixtureRequest) -> Any:
    try:
        return import_module(f"alpha5_model.codegen.kernels.{request.param}")
    except ImportError:
        pytest.skip("the kernels are not compiled here")


@cache
def states() -> np.ndarray:
    """q, v, a, (3, 20 000, 4): anywhere, and at limits, stretched, with the tcp on the yaw axis, at right angles."""
    rng = np.random.default_rng(3)
    out = rng.normal(size=(3, SETS * STATES, 4)) * [[[1.0]], [[2.0]], [[5.0]]]
    out[0] = rng.uniform(-np.pi, np.pi, out[0].shape)
    on_axis = a5.inverse_kinematics((0.0, 0.0, 0.35)).q
    special = [
        *product(*zip(LOWER, UPPER, strict=True)),
        *on_axis[np.isfinite(on_axis).all(axis=1)],
    ]
    special += [(yaw, 1.0, STRETCHED, 0.5) for yaw in (0.0, 2.0)]
    special += [*product(*[(0.0, np.pi / 2, np.pi)] * 4)]
    out[0].reshape(SETS, STATES, 4)[:, : len(special)] = special
    return out


def body(rng: np.random.Generator, name: str) -> RigidBody:
    """Eight mass points, and a volume anywhere: any body that can be."""
    mass, at = rng.uniform(0.0, 0.2, 8), rng.normal(scale=0.1, size=(8, 3))
    com = mass @ at / mass.sum()
    arms = at - com
    second = np.einsum("i,ij,ik", mass, arms, arms)
    inertia = np.trace(second) * np.eye(3) - second
    volume, cob = rng.uniform(0.0, 1e-3), rng.normal(scale=0.1, size=3)
    return RigidBody(name, mass.sum(), com, inertia, volume, cob)


@cache
def random_arm(seed: int) -> tuple[a5.Arm, list[RigidBody]]:
    """Any bodies on the arm's joints, in any fluid and gravity; seed 0 is the arm itself."""
    rng = np.random.default_rng(seed)
    if not seed:
        return a5.load(), [*a5.parameters().links]
    gravity = rng.normal(scale=6.0, size=3)
    model, links = a5.load(gravity=gravity).model, []
    for name, joint in zip(
        ("link_0", "link_1", "link_2", "link_3", "link_4"), range(5), strict=True
    ):
        links.append(body(rng, name))
        one = links[-1]
        model.inertias[joint] = pin.Inertia(one.mass, one.com, one.inertia)
    volumes = [
        Displacement(one.name, joint, one.volume, one.cob)
        for one, joint in zip(links, model.names, strict=True)
    ]
    return a5.Arm(model, volumes, rng.uniform(0.0, 2e4)), links


def flat(result: Any) -> np.ndarray:
    parts = (
        result if isinstance(result, tuple) else (getattr(result, "vector", result),)
    )
    return np.concatenate([np.ravel(part) for part in parts])


def inputs(name: str) -> int:
    """Of q, v and a third one."""
    return len(
        [
            given
            for given in functions(a5.parameters())[name].name_in()
            if given != "parameters"
        ]
    )


@cache
def expected(name: str) -> np.ndarray:
    """What Pinocchio gives for every state, each thousand of another arm, (SETS, STATES, n)."""
    blocks = states()[: inputs(name)].reshape(-1, SETS, STATES, 4)
    return np.array(
        [
            [flat(getattr(random_arm(seed)[0], name)(*state)) for state in rows]
            for seed, rows in enumerate(blocks.transpose(1, 2, 0, 3))
        ]
    )


@cache
def shapes(name: str) -> list[tuple[int, ...]]:
    return [slot.shape for slot in program(functions(a5.parameters())[name]).outputs]


def by_kernel(
    kernels: Any, name: str, parameters: np.ndarray, *given: np.ndarray
) -> np.ndarray:
    """Its outputs, one after the other, (N, n)."""
    outputs = [
        np.empty((len(given[0]), *slot.shape))
        for slot in program(functions(a5.parameters())[name]).outputs
    ]
    assert kernels.batch(name, parameters, *map(np.ascontiguousarray, given), *outputs)
    return np.concatenate([out.reshape(len(out), -1) for out in outputs], axis=1)


@pytest.mark.parametrize("name", ONE)
def test_kernels_are_pinocchio_s_for_any_bodies_fluid_and_gravity(
    name: str, kernels: Any
) -> None:
    theirs = expected(name)
    for seed, rows in enumerate(
        states()[: inputs(name)].reshape(-1, SETS, STATES, 4).swapaxes(0, 1)
    ):
        arm, links = random_arm(seed)
        parameters = base_parameters(
            links,
            arm.fluid_density,
            arm.model.gravity.linear,
            parameters=a5.parameters(),
        )
        ours = by_kernel(
            kernels, name, parameters if name != "jacobian" else np.empty(0), *rows
        )
        scale = np.maximum(1.0, np.abs(theirs[seed]).max(axis=1))
        assert (np.abs(ours - theirs[seed]).max(axis=1) / scale).max() < ONE[name]
        wrong = (
            by_kernel(kernels, name, parameters * 1.001, *rows)
            if name != "jacobian"
            else -ours
        )
        assert (np.abs(wrong - theirs[seed]).max(axis=1) / scale).max() > 1e-5


@pytest.mark.parametrize(
    ("density", "gravity"), [(1025.0, (0.0, 0.0, -9.81)), (0.0, TILTED)]
)
def test_kernels_are_our_own_newton_euler(
    density: float, gravity: Any, kernels: Any
) -> None:
    q, v, a = states()
    held = [
        np.asarray(PAYLOAD[name])
        for name in ("mass", "com", "inertia", "volume", "cob")
    ]
    bare = a5.load(density, gravity=gravity)
    for arm, load in ((bare, None), (bare.with_payload(**PAYLOAD), held)):
        expected = newton_euler(q, v, a, density, gravity, held=load)
        parameters = arm._kernel_parameters
        ours = by_kernel(
            kernels, "inverse_dynamics_with_base_wrench", parameters, q, v, a
        )
        gap = np.abs(ours - np.concatenate(expected, axis=1))
        assert gap[:, :4].max() < 1e-13
        assert gap.max() < 1e-12
        assert np.array_equal(
            ours[:, :4], by_kernel(kernels, "inverse_dynamics", parameters, q, v, a)
        )
        still = 0.0 * v
        coriolis = newton_euler(q, v, still, 0.0, (0.0, 0.0, 0.0), held=load)[0]
        assert (
            np.abs(
                by_kernel(kernels, "coriolis_torque", parameters, q, v) - coriolis
            ).max()
            < 1e-13
        )


def test_frames_are_those_of_table_1(kernels: Any) -> None:
    q = states()[0]
    none = np.empty(0)
    tcp = by_kernel(kernels, "forward_kinematics", none, q).reshape(-1, 4, 4)
    assert np.abs(tcp - fk(q)).max() < 1e-15 * 5
    links = (
        by_kernel(kernels, "link_poses", none, q).reshape(-1, 4, 4, 4).swapaxes(0, 1)
    )
    rotations, origins = link_frames(q)
    assert np.abs(links[..., :3, :3] - rotations[1:]).max() < 1e-15 * 5
    assert np.abs(links[..., :3, 3] - origins[1:]).max() < 1e-15
    assert np.array_equal(
        links[..., 3, :], np.broadcast_to([0.0, 0.0, 0.0, 1.0], (4, len(q), 4))
    )


def textbook() -> tuple[casadi.Function, SX]:
    """Torques and load on the mount by Newton and Euler, link by link, of all 14 numbers of each body."""
    q, v, a, bodies, g = (
        SX.sym(*one) for one in (("q", 4), ("v", 4), ("a", 4), ("b", 14, 5), ("g", 3))
    )
    cross = casadi.cross

    def turn_z(angle: Any) -> SX:
        c, s = casadi.cos(angle), casadi.sin(angle)
        return casadi.vertcat(
            casadi.horzcat(c, -s, 0), casadi.horzcat(s, c, 0), SX([[0, 0, 1]])
        )

    omega, alpha, acceleration, down = SX.zeros(3), SX.zeros(3), -g, g
    steps, loads, origin, bend = [], [], SX.zeros(3), np.eye(3)
    for i in range(5):
        mass, com, xx, yy, zz, xy, xz, yz, net, cob = casadi.vertsplit(
            bodies[:, i], [0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 14]
        )
        if i:
            rotation = SX(bend) @ turn_z(q[i - 1] + reference.DH[i - 1][1])
            acceleration += cross(alpha, origin) + cross(omega, cross(omega, origin))
            acceleration, omega, alpha = (
                rotation.T @ x for x in (acceleration, omega, alpha)
            )
            z = casadi.DM([0, 0, 1])
            alpha = alpha + cross(omega, z * v[i - 1]) + z * a[i - 1]
            omega = omega + z * v[i - 1]
            steps.append((rotation, origin))
            down = rotation.T @ down
            d, _, length, twist = reference.DH[i - 1]
            origin = casadi.DM([length / 1e3, 0, d / 1e3])
            bend = np.round(rotation_x(twist))
        rows = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
        inertia = casadi.vertcat(*(casadi.horzcat(*row) for row in rows))
        at_com = acceleration + cross(alpha, com) + cross(omega, cross(omega, com))
        force, lift = mass * at_com, net * down
        moment = (
            inertia @ alpha
            + cross(omega, inertia @ omega)
            + cross(com, force)
            + cross(cob, lift)
        )
        loads.append((force + lift, moment))
    force, moment, torques = SX.zeros(3), SX.zeros(3), []
    for i in (4, 3, 2, 1):
        force, moment = loads[i][0] + force, loads[i][1] + moment
        torques.insert(0, moment[2])
        rotation, origin = steps[i - 1]
        force = rotation @ force
        moment = rotation @ moment + cross(origin, force)
    wrench = casadi.vertcat(-force - loads[0][0], -moment - loads[0][1])
    return casadi.Function(
        "textbook",
        [q, v, a, bodies, g],
        [casadi.vertcat(*torques), wrench],
        ["q", "v", "a", "bodies", "gravity"],
        ["tau", "wrench"],
    )


def test_regrouped_parameters_give_what_all_numbers_of_the_bodies_give() -> None:
    function, ours = (
        textbook(),
        functions(a5.parameters())["inverse_dynamics_with_base_wrench"],
    )
    rng = np.random.default_rng(8)
    for _ in range(500):
        q, v, a = rng.normal(size=(3, 4)) * [[3.0], [2.0], [5.0]]
        gravity, density = rng.normal(scale=6.0, size=3), rng.uniform(0.0, 2e4)
        links = [body(rng, "link") for _ in range(5)]
        numbers = []
        for one in links:
            moments = one.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            numbers.append(
                [one.mass, *one.com, *moments, density * one.volume, *one.cob]
            )
        expected = flat(
            tuple(map(np.array, function(q, v, a, np.array(numbers).T, gravity)))
        )
        got = flat(
            tuple(
                map(
                    np.array,
                    ours(
                        q,
                        v,
                        a,
                        base_parameters(
                            links, density, gravity, parameters=a5.parameters()
                        ),
                    ),
                )
            )
        )
        assert np.abs(got - expected).max() < 1e-13 * max(1.0, np.abs(expected).max())


def test_regrouping_saves_operations() -> None:
    """Of the real arm with gravity along z: 0.71 of the operations, as the study of the kernels found."""
    p = a5.parameters()
    columns = []
    for one in p.links:
        moments = one.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        columns.append([one.mass, *one.com, *moments, 1025.0 * one.volume, *one.cob])
    full = folded(
        textbook(), bodies=np.array(columns).T, gravity=np.array([0.0, 0.0, -9.81])
    )
    ours = folded(
        functions(a5.parameters())["inverse_dynamics_with_base_wrench"],
        parameters=base_parameters(p.links, parameters=p),
    )
    assert program(ours).flops < 0.9 * program(full).flops
    torque = folded(
        functions(a5.parameters())["inverse_dynamics"],
        parameters=base_parameters(p.links, parameters=p),
    )
    assert program(torque).flops < 330


def test_no_base_parameter_is_too_many() -> None:
    """Torques and load on the mount are linear in all but gravity; no parameter is a combination of others."""
    function = functions(a5.parameters())["inverse_dynamics_with_base_wrench"]
    given = [SX.sym(name, function.size1_in(name)) for name in function.name_in()]
    out = casadi.vertcat(*function(*given))
    regressor = casadi.Function("r", given, [casadi.jacobian(out, given[-1])])
    rng = np.random.default_rng(9)
    parameters = rng.normal(size=len(BASE_PARAMETERS))
    rows = []
    for _ in range(60):
        q, v, a = rng.normal(size=(3, 4))
        parameters[-3:] = rng.normal(size=3)
        rows.append(np.array(regressor(q, v, a, parameters))[:, :-3])
        linear = rows[-1] @ parameters[:-3] - np.concatenate(
            [np.array(x).ravel() for x in function(q, v, a, parameters)]
        )
        assert np.abs(linear).max() < 1e-12
    singular = np.linalg.svd(np.concatenate(rows), compute_uv=False)
    assert singular[-1] > 1e-3 * singular[0]


def test_parameters_of_the_arm_are_those_of_its_tables_and_payload() -> None:
    arm = a5.load(1000.0, gravity=TILTED)
    by_table = base_parameters(
        a5.parameters().links, 1000.0, TILTED, parameters=a5.parameters()
    )
    assert np.abs(arm._kernel_parameters - by_table).max() < 1e-15
    loaded = arm.with_payload(**PAYLOAD)._kernel_parameters
    change = dict(zip(BASE_PARAMETERS, loaded - by_table, strict=True))
    assert (
        abs(change["link_0.n"] - (PAYLOAD["mass"] - 1000.0 * PAYLOAD["volume"])) < 1e-15
    )


@pytest.mark.parametrize(
    "change",
    ["placement", "armature", "tcp", "tcp's joint", "joint", "jaws", "floating"],
)
def test_arms_that_the_kernels_do_not_know_stay_on_pinocchio(change: str) -> None:
    arm = a5.load(
        floating_base=change == "floating",
        gripper="jaws" if change == "jaws" else "locked",
    )
    if change not in ("jaws", "floating"):
        model = arm.model
        if change == "placement":
            model.jointPlacements[3].translation[0] += 1e-6
        elif change == "armature":
            model.armature[2] = 0.1
        elif change == "tcp":
            model.frames[model.getFrameId("tcp")].placement.translation[0] += 1e-6
        elif change == "tcp's joint":
            model.frames[model.getFrameId("tcp")].parentJoint = 3
        else:
            model = pin.buildSampleModelManipulator()
        arm = a5.Arm(model, arm.displacements if change != "joint" else [])
    assert arm._kernel_parameters is None
    state = [np.full((3, n), 0.1) for n in (arm.model.nq, arm.model.nv, arm.model.nv)]
    if arm.floating_base:
        state[0][:, 3:7] = 0.5
    single = arm.inverse_dynamics(*(x[0] for x in state))
    assert np.abs(arm.inverse_dynamics_batch(*state) - single).max() < 1e-12
    if not arm.floating_base:
        with pytest.raises(InputError, match="joints of a Reach Alpha 5"):
            KernelArm(arm.model, [], 0.0)


def test_an_arm_on_kernels_stays_one() -> None:
    arm = a5.load(backend="kernels")
    assert repr(arm).startswith("KernelArm(")
    for other in (arm.with_payload(0.1), copy.copy(arm), copy.deepcopy(arm)):
        assert type(other) is KernelArm
    assert type(arm.with_hydrodynamics().still) is KernelArm
    vehicle = a5.Vehicle(10.0, (0, 0, 0), np.eye(3), 0.01, (0, 0, 0.1))
    assert type(arm.on_vehicle(vehicle).still) is a5.Arm
    assert type(a5.load(backend="kernels", floating_base=True)) is a5.Arm
    assert a5.load(backend="kernels", gripper="jaws").inverse_dynamics(
        *np.zeros((3, 5))
    ).shape == (5,)
    with pytest.raises(
        UnknownNameError,
        match="unknown backend 'numpy'; choose from pinocchio, kernels",
    ):
        a5.load(backend="numpy")


def test_methods_of_an_arm_on_kernels_look_like_those_of_any_arm() -> None:
    ours, theirs = a5.load(backend="kernels"), a5.load()
    state = dict(
        zip(("q", "v", "a"), np.random.default_rng(2).normal(size=(3, 4)), strict=True)
    )
    for name in ONE:
        one, other = getattr(ours, name), getattr(theirs, name)
        assert inspect.signature(one) == inspect.signature(other)
        assert (one.__doc__, one.__name__) == (
            other.__doc__,
            other.__name__,
        ) or name == "base_wrench"
        given = dict(
            zip(
                list(inspect.signature(one).parameters)[: inputs(name)],
                state.values(),
                strict=False,
            )
        )
        plain = flat(one(*given.values()))
        assert np.array_equal(flat(one(**given)), plain)
        first, *rest = given
        assert np.array_equal(
            flat(one(given[first], **{key: given[key] for key in rest})), plain
        )
        assert np.array_equal(
            flat(pickle.loads(pickle.dumps(one))(*given.values())), plain
        )
        for wrong, named in (
            ((), {}),
            ((), given | {"other": 1}),
            ((*given.values(),) * 4, {}),
        ):
            with pytest.raises(TypeError) as expected:
                other(*wrong, **named)
            with pytest.raises(
                TypeError, match=re.escape(str(expected.value).partition(".")[2])
            ):
                one(*wrong, **named)


def test_an_arm_on_kernels_is_freed_at_once() -> None:
    arm = a5.load(backend="kernels")
    method, gone = arm.inverse_dynamics, weakref.ref(arm)
    del arm
    assert gone() is None
    assert np.array_equal(method(*np.ones((3, 4))), method(*np.ones((3, 4)).tolist()))


def test_external_forces_and_other_frames_stay_on_pinocchio() -> None:
    ours, theirs = a5.load(backend="kernels"), a5.load()
    q, v, a = np.random.default_rng(1).normal(size=(3, 4))
    outside = theirs.buoyancy_wrenches(q)
    for name in ("inverse_dynamics", "forward_dynamics", "base_wrench"):
        one, other = (
            flat(getattr(arm, name)(q, v, a, outside)) for arm in (ours, theirs)
        )
        assert np.array_equal(one, other)
        assert np.abs(one - flat(getattr(ours, name)(q, v, a))).max() > 1e-3
    for arguments in (("link_2",), ("tcp", pin.LOCAL), ("tcp", pin.WORLD)):
        assert np.array_equal(
            ours.jacobian(q, *arguments), theirs.jacobian(q, *arguments)
        )
    with pytest.raises(UnknownNameError, match="frame"):
        ours.jacobian(q, "hand")


def test_sources_are_the_same_in_every_process() -> None:
    script = (
        "import hashlib; from alpha5_model.codegen.sources import generated_sources as g\n"
        "print(hashlib.sha256(repr(g()).encode()).hexdigest())"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "12345"}
    there = subprocess.run(
        [sys.executable, "-c", script],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    )
    assert (
        there.stdout.strip()
        == hashlib.sha256(repr(generated_sources()).encode()).hexdigest()
    )
