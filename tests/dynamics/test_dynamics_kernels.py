"""The kernels of the dynamics agree with Pinocchio and two other Newton-Eulers."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin
import pytest
import reference
from compiled_kernels import compiled_kernels
from dynamics_cases import PAYLOAD, TILTED
from fk import STRETCHED, fk
from kernel_inputs import DIMENSIONS, kernel_inputs
from loops import each
from newton_euler import link_frames, newton_euler, rotation_x
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.codegen.regrouping import BASE_PARAMETERS, base_parameters
from alpha5_model.dynamics.buoyancy import Displacement
from alpha5_model.dynamics.kernel_numbers import arm_parameters
from alpha5_model.errors import InputError
from alpha5_model.kernels import numpy_kernels
from alpha5_model.kernels.generated.formulas import KERNELS
from alpha5_model.numbers.parameters import RigidBody

if TYPE_CHECKING:
    import casadi
    from casadi import SX


# The formulas hold for any bodies, however unlikely.
pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)

#: Kernel, named as the method of `Arm` -> how far its result may be from it,
#: divided by the largest entry or by 1.
ONE = {
    "gravity_torque": 1e-13,
    "buoyancy_torque": 1e-13,
    "nonlinear_effects": 1e-13,
    "inverse_dynamics": 1e-13,
    "base_wrench": 1e-13,
    "forward_dynamics": 1e-9,
}
#: Those that JAX alone calls, which are not compiled.
OF_JAX = {
    "jacobian": 1e-14,
    "hydrostatic_torque": 1e-13,
    "mass_matrix": 1e-13,
    "coriolis_matrix": 1e-13,
}
SETS, STATES = 20, 1000


@pytest.fixture(params=["numpy", "compiled"])
def kernels(request: pytest.FixtureRequest) -> Any:
    return numpy_kernels if request.param == "numpy" else compiled_kernels()


@cache
def states() -> np.ndarray:
    """q, v, a, (3, 20 000, 4): random ones, and in each set the special positions.

    These are the limits, the stretched arm, the tcp on the yaw axis, and right angles.
    """
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
    mass = rng.uniform(0.0, 0.2, 8)
    at = rng.normal(scale=0.1, size=(8, 3))
    com = mass @ at / mass.sum()
    arms = at - com
    second = np.einsum("i,ij,ik", mass, arms, arms)
    inertia = np.trace(second) * np.eye(3) - second
    volume = rng.uniform(0.0, 1e-3)
    cob = rng.normal(scale=0.1, size=3)
    return RigidBody(name, mass.sum(), com, inertia, volume, cob)


@cache
def random_arm(seed: int) -> tuple[a5.Arm, list[RigidBody]]:
    """An arm with random bodies, fluid and gravity; seed 0 is the arm itself."""
    rng = np.random.default_rng(seed)
    if not seed:
        return a5.load(), [*a5.parameters().links]
    gravity = rng.normal(scale=6.0, size=3)
    model = a5.load(gravity=gravity).model
    links = [body(rng, f"link_{k}") for k in range(5)]
    for joint, link in enumerate(links):
        model.inertias[joint] = pin.Inertia(link.mass, link.com, link.inertia)
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
    """The number of a kernel's inputs without its parameters."""
    return len(KERNELS[name][1]) - 1


@cache
def expected(name: str) -> np.ndarray:
    """Pinocchio's results, (SETS, STATES, n); each set of states has its own arm."""
    blocks = states()[: inputs(name)].reshape(-1, SETS, STATES, 4)
    results = []
    for seed, rows in enumerate(blocks.transpose(1, 2, 0, 3)):
        arm, _ = random_arm(seed)
        method = getattr(arm, name)
        results.append([flat(method(*state)) for state in rows])
    return np.array(results)


def by_kernel(
    kernels: Any, name: str, parameters: np.ndarray, *given: np.ndarray
) -> np.ndarray:
    """The outputs of a kernel for N states, joined, (N, n)."""
    outputs = kernels.rows(name, parameters, *map(np.ascontiguousarray, given))
    return np.concatenate([out.reshape(len(out), -1) for out in outputs], axis=1)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "kernels"),
    [*product(ONE, ("numpy", "compiled")), *product(OF_JAX, ("numpy",))],
    indirect=["kernels"],
)
def test_kernels_are_pinocchio_s_for_any_bodies_fluid_and_gravity(
    name: str, kernels: Any
) -> None:
    bound = (ONE | OF_JAX)[name]
    theirs = expected(name)
    for seed, rows in enumerate(
        states()[: inputs(name)].reshape(-1, SETS, STATES, 4).swapaxes(0, 1)
    ):
        arm, links = random_arm(seed)
        gravity = arm.model.gravity.linear
        parameters = kernel_inputs(links, arm.fluid_density, gravity)
        ours = by_kernel(kernels, name, parameters, *rows)
        scale = np.maximum(1.0, np.abs(theirs[seed]).max(axis=1))
        assert (np.abs(ours - theirs[seed]).max(axis=1) / scale).max() < bound
        wrong = by_kernel(kernels, name, parameters * 1.001, *rows)
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
        difference = by_kernel(kernels, "coriolis_torque", parameters, q, v) - coriolis
        assert np.abs(difference).max() < 1e-13


def test_frames_are_those_of_table_1(kernels: Any) -> None:
    q = states()[0]
    numbers = a5.load()._kernel_parameters
    tcp = by_kernel(kernels, "forward_kinematics", numbers, q).reshape(-1, 4, 4)
    assert np.abs(tcp - fk(q)).max() < 1e-15 * 5
    links = by_kernel(numpy_kernels, "link_poses", numbers, q)
    links = links.reshape(-1, 4, 4, 4).swapaxes(0, 1)
    rotations, origins = link_frames(q)
    assert np.abs(links[..., :3, :3] - rotations[1:]).max() < 1e-15 * 5
    assert np.abs(links[..., :3, 3] - origins[1:]).max() < 1e-15
    assert np.array_equal(
        links[..., 3, :], np.broadcast_to([0.0, 0.0, 0.0, 1.0], (4, len(q), 4))
    )


@dataclass(frozen=True)
class LinkMotion:
    """A link's motion in its own frame, with the direction of gravity, each (3,)."""

    omega: SX
    alpha: SX
    acceleration: SX
    gravity: SX


def rotation_z(angle: SX) -> SX:
    import casadi
    from casadi import SX

    c = casadi.cos(angle)
    s = casadi.sin(angle)
    return casadi.vertcat(
        casadi.horzcat(c, -s, 0), casadi.horzcat(s, c, 0), SX([[0, 0, 1]])
    )


def frame_in_parent(link: int, q: SX) -> tuple[SX, SX]:
    """Rotation and origin of a link's frame in its parent's, from the DH table."""
    from casadi import SX

    turn = rotation_z(q[link - 1] + reference.DH[link - 1][1])
    if link == 1:
        return turn, SX.zeros(3)
    d, _, length, twist = reference.DH[link - 2]
    origin = SX([length / 1e3, 0, d / 1e3])
    return SX(np.round(rotation_x(twist))) @ turn, origin


def motion_of_child(
    parent: LinkMotion, rotation: SX, origin: SX, speed: SX, rate: SX
) -> LinkMotion:
    """The motion of the next link, whose joint turns about its z axis."""
    import casadi

    cross = casadi.cross
    z = casadi.DM([0, 0, 1])
    centripetal = cross(parent.omega, cross(parent.omega, origin))
    acceleration = parent.acceleration + cross(parent.alpha, origin) + centripetal
    omega = rotation.T @ parent.omega
    alpha = rotation.T @ parent.alpha
    return LinkMotion(
        omega=omega + z * speed,
        alpha=alpha + cross(omega, z * speed) + z * rate,
        acceleration=rotation.T @ acceleration,
        gravity=rotation.T @ parent.gravity,
    )


def force_and_moment(body: SX, motion: LinkMotion) -> tuple[SX, SX]:
    """What a body of 14 numbers takes to move, at the origin of its link's frame."""
    import casadi

    cross = casadi.cross
    mass, com, xx, yy, zz, xy, xz, yz, net, cob = casadi.vertsplit(
        body, [0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 14]
    )
    rows = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    inertia = casadi.vertcat(*(casadi.horzcat(*row) for row in rows))
    omega = motion.omega
    alpha = motion.alpha
    centripetal = cross(omega, cross(omega, com))
    force = mass * (motion.acceleration + cross(alpha, com) + centripetal)
    lift = net * motion.gravity
    moment = (
        inertia @ alpha
        + cross(omega, inertia @ omega)
        + cross(com, force)
        + cross(cob, lift)
    )
    return force + lift, moment


def textbook() -> casadi.Function:
    """Torques and load on the mount by Newton and Euler, without base parameters.

    Link by link, from all 14 numbers of each body.
    """
    import casadi
    from casadi import SX

    q = SX.sym("q", 4)
    v = SX.sym("v", 4)
    a = SX.sym("a", 4)
    bodies = SX.sym("b", 14, 5)
    g = SX.sym("g", 3)

    frames = [frame_in_parent(link, q) for link in range(1, 5)]
    motion = LinkMotion(
        omega=SX.zeros(3), alpha=SX.zeros(3), acceleration=-g, gravity=g
    )
    loads = [force_and_moment(bodies[:, 0], motion)]
    for joint, (rotation, origin) in enumerate(frames):
        motion = motion_of_child(motion, rotation, origin, v[joint], a[joint])
        loads.append(force_and_moment(bodies[:, joint + 1], motion))

    force = SX.zeros(3)
    moment = SX.zeros(3)
    torques: list[SX] = []
    for (rotation, origin), load in zip(frames[::-1], loads[:0:-1], strict=True):
        moment_in_joint = load[1] + moment
        torques.insert(0, moment_in_joint[2])
        force = rotation @ (load[0] + force)
        moment = rotation @ moment_in_joint + casadi.cross(origin, force)
    wrench = casadi.vertcat(-force - loads[0][0], -moment - loads[0][1])
    return casadi.Function(
        "textbook",
        [q, v, a, bodies, g],
        [casadi.vertcat(*torques), wrench],
        ["q", "v", "a", "bodies", "gravity"],
        ["tau", "wrench"],
    )


def all_numbers(links: Sequence[RigidBody], density: float) -> np.ndarray:
    """Bodies in a fluid for `textbook`, (14, n)."""
    columns = []
    for link in links:
        moments = link.inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        displaced = density * link.volume
        columns.append([link.mass, *link.com, *moments, displaced, *link.cob])
    return np.array(columns).T


def test_regrouped_parameters_give_what_all_numbers_of_the_bodies_give() -> None:
    from alpha5_model.codegen.arm_functions import functions

    function = textbook()
    ours = functions()["inverse_dynamics_with_base_wrench"]
    rng = np.random.default_rng(8)
    for _ in range(500):
        q, v, a = rng.normal(size=(3, 4)) * [[3.0], [2.0], [5.0]]
        gravity = rng.normal(scale=6.0, size=3)
        density = rng.uniform(0.0, 2e4)
        links = [body(rng, "link") for _ in range(5)]
        results = function(q, v, a, all_numbers(links, density), gravity)
        expected = flat(tuple(np.array(x) for x in results))
        grouped = kernel_inputs(links, density, gravity)
        got = flat(tuple(np.array(x) for x in ours(q, v, a, grouped)))
        assert np.abs(got - expected).max() < 1e-13 * max(1.0, np.abs(expected).max())


def test_regrouping_saves_operations() -> None:
    """Base parameters save a tenth of the operations at least; it was 29 % once.

    This is the real arm with gravity along z.
    """
    from alpha5_model.codegen.arm_functions import functions
    from alpha5_model.codegen.casadi_functions import folded
    from alpha5_model.codegen.instructions import program

    p = a5.parameters()
    gravity = np.array([0.0, 0.0, -9.81])
    full = folded(textbook(), bodies=all_numbers(p.links, 1025.0), gravity=gravity)
    ours = functions()
    grouped = kernel_inputs(p.links)
    both = folded(ours["inverse_dynamics_with_base_wrench"], parameters=grouped)
    assert len(program(both).steps) < 0.9 * len(program(full).steps)
    torque = folded(ours["inverse_dynamics"], parameters=grouped)
    assert len(program(torque).steps) < 450


def test_no_base_parameter_is_too_many() -> None:
    """No base parameter is a linear combination of others.

    Torques and load on the mount are linear in all of them but gravity.
    """
    import casadi
    from casadi import SX

    from alpha5_model.codegen.arm_functions import functions

    function = functions()["inverse_dynamics_with_base_wrench"]
    given = [SX.sym(name, function.size1_in(name)) for name in function.name_in()]
    out = casadi.vertcat(*function(*given))
    slope = casadi.jacobian(out, given[-1])[:, : len(BASE_PARAMETERS)]
    regressor = casadi.Function("r", given, [slope])
    rng = np.random.default_rng(9)
    parameters = rng.normal(size=len(BASE_PARAMETERS))
    rows = []
    for _ in range(60):
        q, v, a = rng.normal(size=(3, 4))
        parameters[-3:] = rng.normal(size=3)
        numbers = np.append(parameters, DIMENSIONS)
        columns = np.array(regressor(q, v, a, numbers))[:, :-3]
        rows.append(columns)
        results = [np.array(x).ravel() for x in function(q, v, a, numbers)]
        nonlinear = columns @ parameters[:-3] - np.concatenate(results)
        assert np.abs(nonlinear).max() < 1e-12
    singular = np.linalg.svd(np.concatenate(rows), compute_uv=False)
    assert singular[-1] > 1e-3 * singular[0]


def test_parameters_of_the_arm_are_those_of_its_tables_and_payload() -> None:
    arm = a5.load(1000.0, gravity=TILTED)
    by_table = base_parameters(
        a5.parameters().links, 1000.0, TILTED, parameters=a5.parameters()
    )
    assert np.abs(arm_parameters(arm) - by_table).max() < 1e-15
    loaded = arm_parameters(arm.with_payload(**PAYLOAD))
    change = dict(zip(BASE_PARAMETERS, loaded - by_table, strict=True))
    assert (
        abs(change["link_0.n"] - (PAYLOAD["mass"] - 1000.0 * PAYLOAD["volume"])) < 1e-15
    )


def rebuilt(model: pin.Model, change: str) -> pin.Model:
    """The joints and bodies of a model with another third joint, or none of its tcp."""
    third = {
        "axis": pin.JointModelRX(),
        "any axis": pin.JointModelRevoluteUnaligned(np.array([0.0, 0.0, 1.0])),
    }
    out = pin.Model()
    out.appendBodyToJoint(0, model.inertias[0], pin.SE3.Identity())
    for number in range(1, 5):
        kind = third.get(change) if number == 3 else None
        parent = 2 if change == "branch" and number == 4 else number - 1
        out.addJoint(
            parent,
            kind or pin.JointModelRZ(),
            model.jointPlacements[number],
            model.names[number],
        )
        out.appendBodyToJoint(number, model.inertias[number], pin.SE3.Identity())
    if change != "no tcp":
        placement = model.frames[model.getFrameId("tcp")].placement
        out.addFrame(pin.Frame("tcp", 4, 0, placement, pin.FrameType.OP_FRAME))
    return out


def test_a_model_made_by_hand_is_known_by_its_joints() -> None:
    arm = a5.load()
    made = a5.Arm(rebuilt(arm.model, ""), arm.displacements)
    np.testing.assert_allclose(
        made._kernel_parameters, arm._kernel_parameters, rtol=0, atol=1e-15
    )


@each(
    "change",
    [
        "placement",
        "armature",
        "tcp",
        "tcp's joint",
        "no tcp",
        "axis",
        "any axis",
        "branch",
        "joint",
        "jaws",
        "floating",
    ],
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
        elif change != "joint":
            model = rebuilt(model, change)
        else:
            model = pin.buildSampleModelManipulator()
        arm = a5.Arm(model, arm.displacements if change != "joint" else [])
    assert arm._kernel_parameters is None
    state = [np.full((3, n), 0.1) for n in (arm.model.nq, arm.model.nv, arm.model.nv)]
    if arm.floating_base:
        state[0][:, 3:7] = 0.5
    single = arm.inverse_dynamics(*(x[0] for x in state))
    assert np.abs(arm.inverse_dynamics_batch(*state) - single).max() < 1e-12
    with pytest.raises(InputError, match="arm"):
        arm_parameters(arm)


@pytest.mark.slow
def test_sources_are_the_same_in_every_process() -> None:
    from alpha5_model.codegen.sources import generated_sources

    script = (
        "import hashlib\n"
        "from alpha5_model.codegen.sources import generated_sources as g\n"
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
    here = hashlib.sha256(repr(generated_sources()).encode()).hexdigest()
    assert there.stdout.strip() == here
