"""Functions and methods of the package with arguments of every sort."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from fuzzing import dynamics, forms, theory
from fuzzing.calls import Draw, of, of_function, of_method, spoiling, with_the_same_rows
from fuzzing.cases import Target
from fuzzing.good_values import (
    GOOD,
    Draws,
    always,
    count,
    flag,
    normal,
    one_of,
    uniform,
)
from fuzzing.values import Rng, number, pick, transform

import alpha5_model as a5
from alpha5_model.numbers import corrections, fluids, inertia
from alpha5_model.theory.dh import orientations

__all__ = ["DRAWS", "TARGETS", "UNCHECKED", "of"]

#: Public functions and constructors whose arguments `GOOD` and `_own_values` draw.
PLAIN = (
    "reachable",
    "distance_to_reach",
    "nearest_reachable",
    "inverse_kinematics_path",
    "inverse_kinematics",
    "inverse_kinematics_pose",
    "published_inverse_kinematics",
    "load",
    "gravity_in_base",
    "named_pose",
    "q_from_devices",
    "devices_from_q",
    "parameters",
    "compare",
    "without_self_collision",
    "robot_wrapper",
    "workspace.published_reachable",
    "workspace.cross_section_area",
    "workspace.volume",
    "workspace.reachable",
    "workspace.distance_to_reach",
    "workspace.nearest_reachable",
    "workspace.boundary",
    "workspace.published_but_unreachable",
    "workspace.reachable_but_unpublished",
    "workspace.singularities",
    "workspace.manipulability",
    "workspace.in_half_plane",
    "workspace.in_tori",
    "dh.dh_transform",
    "dh.DHLink",
    "dh.DHChain.from_table",
    "dh.DHChain.from_urdf",
    "dh.DHLink.from_vector",
    "dh.DHChain.alpha5",
    "planar.theorem_radii",
    "planar.theorem_row",
    "planar.lecture_theorem",
    "planar.PlanarArm",
    "planar.annulus",
    "actuators.actuator",
    "trajectory.read_motion",
    "trajectory.motion",
    "uncertainty.torque_bounds",
    "uncertainty.bounds",
    "uncertainty.printed_numbers",
    "Vehicle",
    "DragStrip",
    "plan",
    "Obstacle.box",
    "Obstacle.cylinder",
    "Obstacle.sphere",
    "Obstacle.mesh",
)
#: Of these, those that take an arm and rows of states.
OF_STATES = ("uncertainty.bounds", "uncertainty.torque_bounds")
#: Functions of `alpha5_model.numbers.inertia`.
INERTIA = (
    "flip_products",
    "point_mass_tensor",
    "tensor_at_origin",
    "tensor_at_com",
    "rotate_tensor",
    "combine",
    "second_moments",
    "pseudo_inertia",
    "principal_moments",
    "radii_of_gyration",
    "inconsistencies",
    "check_possible",
)
ACTUATOR_METHODS = (
    "current",
    "torque",
    "holding_current",
    "holding_torque",
    "voltage",
    "speed",
    "torque_limits",
    "speed_limits",
    "power",
    "current_interval",
    "torque_interval",
)


def _draws() -> dict[str, Draw]:
    """Public name -> what draws its calls."""
    return {
        **_plain(),
        **_of_modules(),
        **_results(),
        **dynamics.draws(),
        **theory.draws(),
        **_recordings(),
        **_actuators(),
        **_samples(),
        **_calibrations(),
    }


def _plain() -> dict[str, Draw]:
    """Functions of the package by their names."""
    own = _own_values()
    draws: dict[str, Draw] = {}
    for name in PLAIN:
        function: Any = a5
        for part in name.split("."):
            function = getattr(function, part)
        draws[f"a5.{name}"] = of_function(function, **own.get(name, {}))

    arm = dynamics.arm(0)
    for name in OF_STATES:
        function = getattr(a5.uncertainty, name.rpartition(".")[2])
        states = dynamics.states(arm, batch=True)
        draw = of_function(function, arm=always(arm), **states)
        draws[f"a5.{name}"] = with_the_same_rows(draw)
    return draws


def _own_values() -> dict[str, dict[str, Draws]]:
    """Name in `PLAIN` -> parameter -> value, where `GOOD` has none or another."""
    in_the_plane: dict[str, Draws] = {"radius": theory.numbers, "z": theory.numbers}
    return {
        "workspace.in_half_plane": in_the_plane,
        "workspace.in_tori": in_the_plane,
        "planar.PlanarArm": {"limits": theory.planar_limits, "angles": always(None)},
        "planar.annulus": {"length_ranges": _length_ranges},
        "dh.DHLink.from_vector": {"vector": normal(1, 4)},
        "trajectory.motion": {
            "position": _samples_of(4),
            "velocity": _samples_of(4),
            "effort": _samples_of(4),
            "current": _samples_of(4),
            "joints": always(None),
        },
        "q_from_devices": {"devices": _devices},
        "without_self_collision": {"q": uniform(0, 3, 2, 4), "wrists": always(3)},
        "plan": {
            "q0": uniform(0.1, 3.2, 4),
            "target": normal(0.2, 3),
            "obstacles": lambda rng: [_ball(rng)],
            "speed": number(0.05, 1),
            "acceleration": number(0.05, 2),
            "line": flag,
        },
        **_obstacles(),
        "Vehicle": {
            "linear_damping": uniform(0, 9, 6),
            "quadratic_damping": uniform(0, 9, 6),
            "added_mass": uniform(0, 9, 6),
            "inertia": lambda rng: np.diag(rng.uniform(1, 1.5, 3)),
            "mount": transform,
        },
        "DragStrip": {
            "start": normal(0.1, 3),
            "end": normal(0.1, 3),
            "diameter": number(0, 0.1),
            "across": number(0, 2),
            "along": number(0, 1),
        },
    }


def _devices(rng: Rng) -> dict[int, Any]:
    """What the devices on the bus report, with the jaws or without."""
    devices: dict[int, Any] = {k: rng.uniform(0.1, 3.0) for k in (5, 4, 3, 2)}
    if flag(rng):
        devices[1] = rng.uniform(2.0, 10.0)
    return devices


def _obstacles() -> dict[str, dict[str, Draws]]:
    """Constructor of an obstacle -> parameter -> value."""
    placed: dict[str, Draws] = {"xyz": normal(0.3, 3), "rpy": normal(1, 3)}
    return {
        "Obstacle.box": {"edges": uniform(0.01, 0.3, 3), **placed},
        "Obstacle.cylinder": {"length": number(0.01, 1), **placed},
        "Obstacle.sphere": {"xyz": placed["xyz"]},
        "Obstacle.mesh": {
            "vertices": normal(0.3, 4, 3),
            "triangles": always(np.array([[0, 1, 2], [1, 2, 3]])),
            **placed,
        },
    }


def _ball(rng: Rng) -> a5.Obstacle:
    return a5.Obstacle.sphere("ball", 0.05, rng.normal(0, 0.4, 3))


def _of_modules() -> dict[str, Draw]:
    """Functions of modules beside the package's own names."""
    functions: list[tuple[Any, Callable[..., Any]]] = [
        *((inertia, getattr(inertia, name)) for name in INERTIA),
        (fluids, fluids.gravity_in_base),
        (corrections, corrections.check_corrections),
        (orientations, orientations.even_rotations),
    ]
    draws = {}
    for module, function in functions:
        short = module.__name__.rpartition(".")[2]
        draws[f"{short}.{function.__name__}"] = of_function(function)
    return draws


def _results() -> dict[str, Draw]:
    """Methods of results."""
    return {
        "Solutions.best": of_method(_solutions, "best"),
        "Primitive.moved": of_method(
            lambda rng: _ball(rng).shape, "moved", frame=transform
        ),
        "PoseSolutions.best": of_method(_pose_solutions, "best"),
        "a5.workspace.Singularities.near": of_method(_singularities, "near"),
        "a5.workspace.Arc.points": of_method(
            lambda rng: a5.workspace.boundary()[0], "points", angle=theory.numbers
        ),
    }


def _solutions(rng: Rng) -> Any:
    return a5.inverse_kinematics(rng.normal(0, 0.25, pick(rng, ((3,), (2, 3)))))


def _pose_solutions(rng: Rng) -> Any:
    return a5.inverse_kinematics_pose(transform(rng))


def _singularities(rng: Rng) -> Any:
    return a5.workspace.singularities(rng.uniform(0, 3, (5, 4)))


def _length_ranges(rng: Rng) -> np.ndarray:
    return np.sort(rng.uniform(0, 2, (3, 2)))


def _recordings() -> dict[str, Draw]:
    """Motions from arrays."""
    joints: dict[str, Draws] = {"position": _samples_of(4), "velocity": _samples_of(4)}
    return {
        "a5.trajectory.analyse": of_function(_analysed, **joints),
        "a5.trajectory.smooth": of_function(_smoothed, **joints),
        "a5.identify": of_function(
            _identified,
            **joints,
            effort=_samples_of(4),
            wrench=_samples_of(6),
            time=GOOD["time"],
        ),
    }


def _samples_of(columns: int) -> Draws:
    """Six samples that grow from row to row."""
    return lambda rng: rng.uniform(1, 2, (6, columns)).cumsum(axis=0) * 0.01


def _analysed(
    time: Any,
    position: Any,
    velocity: Any,
    method: Any,
    bandwidth: Any,
    constants: Any,
    supply_voltage: Any,
    current_limit: Any,
) -> Any:
    motion = a5.trajectory.motion(time, position, velocity)
    analysis = a5.trajectory.analyse(
        motion,
        method=method,
        bandwidth=bandwidth,
        constants=constants,
        supply_voltage=supply_voltage,
        current_limit=current_limit,
    )
    return a5.trajectory.summary(analysis)


def _smoothed(time: Any, position: Any, velocity: Any) -> Any:
    motion = a5.trajectory.motion(time, position, velocity)
    return a5.trajectory.smooth(motion)


def _identified(
    time: Any, position: Any, velocity: Any, effort: Any, wrench: Any
) -> Any:
    motion = a5.trajectory.motion(time, position, velocity, effort=effort)
    return a5.identify(motion, wrench=wrench)


def _actuators() -> dict[str, Draw]:
    return {
        f"a5.actuators.Actuator.{method}": of_method(_actuator, method)
        for method in ACTUATOR_METHODS
    }


def _actuator(rng: Rng) -> Any:
    joint = GOOD["joint"](rng)
    return a5.actuators.actuator(joint, screw_lead=1e-3, rotor_inertia=1e-7)


def _samples() -> dict[str, Draw]:
    """Methods of sampled arms."""
    return {
        "a5.uncertainty.Sample.base_parameters": of_method(_sample, "base_parameters"),
        "a5.uncertainty.Sample.parameters": of_method(
            _sample, "parameters", index=count(0, 3)
        ),
    }


def _calibrations() -> dict[str, Draw]:
    """Sensors, plans and readings."""
    c = a5.calibrate
    sensors = one_of(c.scales(), c.weight(), c.force_torque(), c.efforts())
    noise = number(0.0001, 0.01)
    small: dict[str, Draws] = {"noise": noise, "gain": noise, "zeroed": flag}
    return {
        "a5.calibrate.scales": of_function(
            c.scales, positions=normal(0.3, 3, 3), placement=noise, **small
        ),
        "a5.calibrate.weight": of_function(c.weight, gravity=normal(9, 3), **small),
        "a5.calibrate.vehicle_tilt": of_function(
            _tilting,
            mass=number(0, 50),
            com=normal(0.1, 3),
            volume=number(0, 0.05),
            cob=normal(0.1, 3),
            noise=noise,
            yaw=noise,
        ),
        "a5.calibrate.plan_poses": of_function(
            _planned,
            sensor=sensors,
            poses=count(1, 4),
            gravity=always((0.0, 0.0, -9.81)),
            prior=one_of("digits", "loose"),
            ballast=number(0, 5),
        ),
        "a5.calibrate.plan_excitation": of_function(
            c.plan_excitation,
            sensor=sensors,
            evaluations=count(1, 4),
            duration=number(5, 50),
            arm=always(None),
            gravity=always((0.0, 0.0, -9.81)),
            prior=one_of("digits", "loose"),
        ),
        "a5.calibrate.session": of_function(
            _weighed,
            sensor=sensors,
            q=uniform(0, 3, 2, 4),
            v=normal(1, 2, 4),
            a=normal(1, 2, 4),
            gravity=always((0.0, 0.0, -9.81)),
        ),
    }


def _tilting(mass: Any, com: Any, volume: Any, cob: Any, noise: Any, yaw: Any) -> Any:
    """What the tilt of a vehicle depends on."""
    vehicle = {"mass": mass, "com": com, "volume": volume, "cob": cob}
    return a5.calibrate.vehicle_tilt(vehicle, noise=noise, yaw=yaw).carrier


def _planned(sensor: Any, poses: Any, gravity: Any, prior: Any, ballast: Any) -> Any:
    """Poses without their readings, which are NaN."""
    plan = a5.calibrate.plan_poses(
        sensor, poses, gravity=gravity, prior=prior, ballast=ballast
    )
    return plan.motion


def _weighed(sensor: Any, q: Any, v: Any, a: Any, gravity: Any) -> Any:
    return a5.calibrate.session(sensor, q, v=v, a=a, gravity=gravity).motion


def _sample(rng: Rng) -> Any:
    return _three_arms()


@cache
def _three_arms() -> Any:
    return a5.uncertainty.sample(3)


DRAWS = _draws()
#: Functions that check nothing, as documented: JAX's numbers may be traced, and curves
#: are results.
UNCHECKED = forms.IN_THEIR_TYPE
TARGETS: dict[str, Target] = {
    name: spoiling(draw)
    for name, draw in DRAWS.items()
    if not name.startswith(UNCHECKED)
}
