"""Each method of an arm with a longer a_1 answers for that arm, or refuses."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from loops import each
from pinocchio_collision import CollisionModel

import alpha5_model as a5
from alpha5_model._support.spatial import pose
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.dimensions import DRAWN, check_dimensions, check_limits
from alpha5_model.dynamics.load import arm_of
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.errors import InputError
from alpha5_model.theory.dh import DHChain, DHLink
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.motion_plot import motion_figure

LONGER = 0.05
Q = np.array([3.0, 1.2, 1.8, 0.5])
V = np.array([0.1, -0.2, 0.3, 0.4])
A = np.array([0.5, 0.4, -0.3, 0.2])
ROWS = np.random.default_rng(7).uniform(0.1, 3.0, (20, 3, 4)).transpose(1, 0, 2)


def parameters() -> Any:
    p = a5.parameters()
    dh = list(p.dh)
    dh[1] = dataclasses.replace(dh[1], a=dh[1].a + LONGER)
    return dataclasses.replace(p, dh=tuple(dh))


@cache
def arm() -> a5.Arm:
    return arm_of(parameters())


@cache
def afloat() -> a5.Arm:
    own = a5.load(floating_base=True)
    model = own.model.copy()
    elbow = model.getJointId("axis_c")
    model.jointPlacements[elbow].translation += np.array([LONGER, 0.0, 0.0])
    return a5.Arm(model, own.displacements)


@cache
def chain() -> DHChain:
    """The longer arm as a DH chain, which shares no code with the dynamics."""
    ours = DHChain.alpha5()
    links = list(ours.links)
    links[1] = dataclasses.replace(links[1], a=links[1].a + LONGER)
    assert isinstance(links[1], DHLink)
    return dataclasses.replace(ours, links=tuple(links))


def potential_energy(q: np.ndarray) -> float:
    """The energy of weight and buoyancy, body by body."""
    frames = chain().frames(q)
    turned = [
        frame @ pose((0.0, 0.0, 0.0), (0.0, 0.0, angle + row.theta_offset))
        for frame, angle, row in zip(frames, q, a5.parameters().dh, strict=False)
    ]
    total = 0.0
    for link, frame in zip(a5.parameters().links, [frames[0], *turned], strict=True):
        weight = link.mass * (frame @ np.append(link.com, 1.0))[2]
        lift = 1025.0 * link.volume * (frame @ np.append(link.cob, 1.0))[2]
        total += 9.81 * (weight - lift)
    return total


def test_its_positions_energy_and_torques_are_its_own() -> None:
    own = arm()
    rng = np.random.default_rng(1)
    for q in rng.uniform(0.1, 3.0, (20, 4)):
        tcp = chain().forward_kinematics(q)
        assert np.abs(own.forward_kinematics(q).homogeneous - tcp).max() < 1e-14
        assert (
            np.linalg.norm(tcp[:3, 3] - a5.load().forward_kinematics(q).translation)
            > 0.04
        )
        assert own.potential_energy(q) == pytest.approx(potential_energy(q), abs=1e-13)
        h = 1e-6
        slope = [
            (potential_energy(q + h * e) - potential_energy(q - h * e)) / (2 * h)
            for e in np.eye(4)
        ]
        assert own.hydrostatic_torque(q) == pytest.approx(slope, abs=1e-8)
        place = frame_positions(own, q[None])[0]
        assert place == pytest.approx(tcp[:3, 3], abs=1e-14)


def test_its_batches_are_its_single_calls() -> None:
    own = arm()
    q, v, a = ROWS
    single = np.array(
        [own.inverse_dynamics(*state) for state in zip(q, v, a, strict=True)]
    )
    assert own.inverse_dynamics_batch(q, v, a) == pytest.approx(single, abs=1e-13)
    terms = torque_terms(own, q, v, a)
    total = terms.inertia + terms.coriolis + terms.weight + terms.buoyancy
    assert total == pytest.approx(single, abs=1e-13)
    back = own.forward_dynamics_batch(q, v, single)
    assert back == pytest.approx(a, abs=1e-9)
    loads = np.array(
        [own.base_wrench(*state).vector for state in zip(q, v, a, strict=True)]
    )
    assert own.base_wrench_batch(q, v, a) == pytest.approx(loads, abs=1e-12)
    assert np.abs(a5.load().inverse_dynamics_batch(q, v, a) - single).max() > 0.1


#: What cannot answer for it, and says so.
REFUSED: dict[str, Callable[[], Any]] = {
    "with_hydrodynamics, floating": lambda: afloat().with_hydrodynamics(),
    "a collision model": lambda: CollisionModel(arm().model),
    "approach_directions, floating": lambda: afloat().approach_directions(
        [0.3, 0.0, 0.1]
    ),
    "in_collision, floating": lambda: afloat().in_collision(
        pin.neutral(afloat().model)
    ),
    "scene, floating": lambda: build_scene(afloat()),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_was_made_for_the_catalogues_dimensions_refuses(name: str) -> None:
    with pytest.raises(
        InputError,
        match=r"expected the dimensions of Table 1, .* got .*axis_c 50 mm off",
    ):
        REFUSED[name]()


#: Methods of an arm that answer from its own model.
ANSWERED = {
    "approach_directions",
    "base_wrench",
    "base_wrench_batch",
    "base_wrench_derivatives",
    "buoyancy_torque",
    "buoyancy_wrenches",
    "center_of_buoyancy",
    "center_of_mass",
    "closest_links",
    "collision_distance",
    "collision_distance_gradient",
    "coriolis_matrix",
    "forward_dynamics",
    "forward_dynamics_batch",
    "forward_dynamics_derivatives",
    "forward_kinematics",
    "gravity_torque",
    "hydrostatic_torque",
    "hydrostatic_torque_derivative",
    "in_collision",
    "inverse_dynamics",
    "inverse_dynamics_batch",
    "inverse_dynamics_derivatives",
    "jacobian",
    "kinetic_energy",
    "linearized",
    "mass_matrix",
    "nonlinear_effects",
    "on_vehicle",
    "potential_energy",
    "regressor",
    "with_hydrodynamics",
    "with_payload",
}


#: Methods whose results are not compared entry by entry. For those of bodies see
#: test_own_arm_collision.py: the bodies that are nearest at Q do not move with a_1.
NO_NUMBERS = {
    "approach_directions",
    "buoyancy_wrenches",
    "closest_links",
    "collision_distance",
    "collision_distance_gradient",
    "in_collision",
    "on_vehicle",
    "with_hydrodynamics",
    "with_payload",
}


def test_every_method_of_an_arm_is_listed_here() -> None:
    methods = {
        name
        for name, x in vars(a5.Arm).items()
        if callable(x) and not name.startswith("_")
    }
    assert methods == ANSWERED | (methods & REFUSED.keys())


@each("name", sorted(ANSWERED - NO_NUMBERS))
def test_a_method_that_answers_does_not_take_the_catalogues_arm(name: str) -> None:
    inputs = {"q": Q, "v": V, "a": A, "tau": A}
    if name.endswith("_batch"):
        inputs = {"q": ROWS[0], "v": ROWS[1], "a": ROWS[2], "tau": ROWS[2]}
    ours = answer(arm(), name, inputs)
    theirs = answer(a5.load(), name, inputs)
    assert np.abs(flat(ours) - flat(theirs)).max() > 1e-4


def answer(one: a5.Arm, name: str, inputs: dict[str, Any]) -> Any:
    """What a method gives for those of the inputs that it takes."""
    names = arguments(one, name)
    taken = {key: value for key, value in inputs.items() if key in names}
    return getattr(one, name)(**taken)


def arguments(one: a5.Arm, name: str) -> tuple[str, ...]:
    code = getattr(type(one), name).__code__
    return tuple(code.co_varnames[: code.co_argcount])


def flat(result: Any) -> np.ndarray:
    if isinstance(result, pin.StdVec_Force):
        result = [force.vector for force in result]
    if isinstance(result, tuple | list):
        return np.concatenate([flat(part) for part in result])
    for part in ("vector", "homogeneous", "matrix"):
        result = getattr(result, part, result)
    return np.ravel(np.asarray(result, dtype=np.float64))


def test_limits_of_a_parameter_set_are_the_arms_and_the_reports() -> None:
    p = a5.parameters()
    joints = list(p.joints)
    joints[1] = dataclasses.replace(
        joints[1], lower=0.5, upper=2.0, velocity=0.1, effort=3.0
    )
    own = arm_of(dataclasses.replace(p, joints=tuple(joints)))
    found = [end[1] for end in own.limits]
    assert found == [0.5, 2.0, 0.1, 3.0]
    beyond = own.forward_kinematics([1.0, 2.5, 1.5, 0.0]).translation
    wider = a5.load().approach_directions(beyond).within_limits
    narrow = own.approach_directions(beyond).within_limits
    assert wider.sum() > narrow.sum()
    other = a5.Arm(own.model, own.displacements)
    with pytest.raises(
        InputError, match=r"the limits of its record, .* 'axis_d from 0.5 to 2 rad'"
    ):
        other.approach_directions([0.3, 0.0, 0.1])
    time = np.linspace(0, 4, 81)
    q = np.stack(
        [np.full(81, 1.0), 1.0 + 0.2 * np.sin(time), np.full(81, 1.5), np.ones(81)],
        axis=1,
    )
    analysis = a5.trajectory.analyse(
        a5.trajectory.motion(time, q), own, method="interpolate"
    )
    joint = a5.trajectory.summary(analysis)["joints"]["axis_d"]
    assert joint["position_margin"] == pytest.approx(q[:, 1].min() - 0.5)
    assert joint["beyond_rated_velocity"] > 10
    assert joint["torque_margin"] == pytest.approx(
        3.0 - np.abs(analysis.torque[:, 1]).max()
    )


@pytest.mark.slow
def test_its_motion_is_analysed_and_drawn_without_the_margin_of_other_digits() -> None:
    time = np.linspace(0, 4, 81)
    q = Q + 0.1 * np.sin(time)[:, None]
    motion = a5.trajectory.motion(time, q)
    analysis = a5.trajectory.analyse(motion, arm(), method="interpolate")
    for at in (0, 40, 80):
        tcp = chain().forward_kinematics(analysis.smooth.position[at])
        assert analysis.tcp[at] == pytest.approx(tcp[:3, 3], abs=1e-14)
    page = motion_figure(analysis)
    ours = a5.trajectory.analyse(motion, method="interpolate")
    labels = [
        {text for axes in shown.axes for text in axes.get_legend_handles_labels()[1]}
        for shown in (page, motion_figure(ours))
    ]
    assert labels[1] - labels[0] == {"printed digits"}


def test_sets_within_the_printed_digits_have_the_drawn_bodies() -> None:
    drawn = a5.uncertainty.sample(10, 3)
    for k in range(10):
        own = arm_of(drawn.parameters(k))
        assert own.collision_distance(Q) == pytest.approx(
            a5.load().collision_distance(Q), abs=DRAWN
        )
        own.with_hydrodynamics()
        found = own.approach_directions([0.3, 0.0, 0.1])
        assert found.exists.any()


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"gripper": "jaws"},
        {"floating_base": True},
        {"corrections": ()},
    ],
)
def test_every_arm_of_the_catalogue_is_one(options: dict[str, Any]) -> None:
    own = a5.load(**options)
    check_dimensions(own.model, "this")
    check_limits(own.model, "this", own.parameters)
    assert own.with_payload(0.2).approach_directions([0.3, 0.0, 0.1]).exists.any()


def test_another_robot_is_named_by_what_it_lacks() -> None:
    robot = pin.buildSampleModelManipulator()
    with pytest.raises(InputError, match="got 'an arm without axis_e'"):
        check_dimensions(robot, "this")
