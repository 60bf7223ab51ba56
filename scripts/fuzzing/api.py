"""Functions and methods of the package with arguments of every sort."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from fuzzing import forms
from fuzzing.cases import Case, Target
from fuzzing.values import (
    TEXTS,
    Rng,
    angles,
    number,
    pick,
    points,
    rotation,
    spoil,
    tensor,
    transform,
)  # fmt: skip

import alpha5_model as a5
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.numbers import corrections, fluids, inertia
from alpha5_model.theory.dh import arm_types, orientations, tasks
from alpha5_model.water.terms import water_terms

#: Parameter -> a good value. What stands in no target's own table is looked up here.
GOOD: dict[str, Callable[[Rng], Any]] = {
    "positions": points, "position": points, "points": points, "transform": transform, "rotation": rotation,
    "limits": lambda rng: bool(rng.integers(2)), "q_reference": lambda rng: angles(4)(rng).reshape(-1, 4)[0],
    "q_start": lambda rng: angles(4)(rng).reshape(-1, 4)[0], "wrist": number(-3, 3), "max_step": number(0.01, 2),
    "q": angles(4), "gravity": lambda rng: rng.normal(0, 9.81, 3), "corrections": lambda rng: pick(rng, ((), ("base_frame",), ("base_frame", "link3_cob"))),
    "fluid_density": number(0, 2e4), "gripper": lambda rng: pick(rng, ("locked", "jaws")), "floating_base": lambda rng: bool(rng.integers(2)),
    "frame": lambda rng: pick(rng, ("tcp", "link_2", "base_link", "tool", 2)), "name": lambda rng: pick(rng, TEXTS), "side": lambda rng: pick(rng, ("both", "front", "back")),
    "mass": number(0, 2), "masses": lambda rng: rng.uniform(0.1, 2, 2), "com": lambda rng: rng.normal(0, 0.1, 3), "cob": lambda rng: rng.normal(0, 0.1, 3),
    "coms": lambda rng: rng.normal(0, 0.1, (2, 3)), "inertias": lambda rng: np.stack([tensor(rng).reshape(-1, 3, 3)[0]] * 2),
    "inertia": tensor, "inertia_com": tensor, "inertia_origin": tensor, "rotation_a_to_b": rotation, "volume": number(0, 5e-3),
    "bounds": lambda rng: np.array([[-1.0, 1.0]] * 3), "tolerance": number(0, 1e-6), "vertical": lambda rng: rng.normal(size=3), "tool_axis": lambda rng: rng.normal(size=3),
    "theta": number(-4, 4), "d": number(-1, 1), "a": number(-1, 1), "alpha": number(-4, 4), "sigma": lambda rng: int(rng.integers(2)),
    "offset": number(-1, 1), "lower": number(-3, 0), "upper": number(0, 3), "rows": lambda rng: rng.normal(0, 1, (int(rng.integers(1, 6)), 4)),
    "lengths": lambda rng: rng.uniform(0.1, 5, int(rng.integers(1, 5))), "joints": lambda rng: pick(rng, (None, "R", "RR", "RRR", "RPR", "PP", "")),
    "radius": number(0, 5), "number": lambda rng: int(rng.integers(1, 40)), "samples": lambda rng: int(rng.integers(1, 9)),
    "joint": lambda rng: pick(rng, ("axis_a", "axis_b", "axis_c", "axis_d", "axis_e")), "constants": lambda rng: pick(rng, ("printed", "torque", "voltage")),
    "rotor_inertia": number(0, 1e-5), "screw_lead": number(1e-4, 1e-2), "torque": lambda rng: rng.normal(0, 5, 3), "velocity": lambda rng: rng.normal(0, 1, 3),
    "acceleration": lambda rng: rng.normal(0, 1, 3), "current": lambda rng: rng.normal(0, 1, 3), "voltage": lambda rng: rng.normal(0, 12, 3),
    "current_rate": lambda rng: rng.normal(0, 1, 3), "supply_voltage": number(1, 48), "current_limit": number(0.1, 3),
    "l_1": number(0.1, 5), "l_2": number(0.1, 5), "l_3": number(0.1, 5), "l_4": number(0, 9),
    "time": lambda rng: np.arange(6) * 0.1, "path": lambda rng: pick(rng, TEXTS), "threads": lambda rng: pick(rng, (None, 1, 2)),
    "angle": number(0, 1), "distance": number(0, 1), "method": lambda rng: pick(rng, ("spline", "savgol", "interpolate")), "bandwidth": number(0.1, 4),
    "orientations": lambda rng: int(rng.integers(1, 9)), "starts": lambda rng: 2, "steps": lambda rng: 3, "start": lambda rng: 0, "stop": lambda rng: 1,
}  # fmt: skip
#: Counts, names of axes, what may be infinite or has no effect: not hopeless, whatever stands there.
LENIENT = {
    "limits",
    "samples", "number", "orientations", "threads", "starts", "steps", "start", "stop", "sigma", "lower", "upper", "bandwidth",
}  # fmt: skip


#: Draws a call; spoiled, some of its arguments may be of any sort.
Draw = Callable[[Rng, bool], Case]


def of(
    make: Callable[[Rng], Callable[..., Any]],
    **own: Callable[[Rng], Any],
) -> Draw:
    """Calls what ``make`` gives, with arguments by the names of its parameters."""

    def draw(rng: Rng, spoiled: bool) -> Case:
        call = make(rng)
        arguments: dict[str, Any] = {}
        hopeless = False
        for name, parameter in inspect.signature(call).parameters.items():
            optional = parameter.default is not parameter.empty
            if name in NOT_DRAWN or (optional and rng.integers(2)):
                continue
            value = own.get(name, GOOD.get(name, lambda rng: None))(rng)
            if not spoiled or name in OBJECTS:
                pass
            elif rng.integers(4) == 0:
                value, bad = spoil(rng, value)
                hopeless |= bad and name not in LENIENT
            elif rng.integers(40) == 0:
                value = pick(rng, TEXTS)
            arguments[name] = value
        return Case(call, arguments, hopeless)

    return draw


def spoiling(draw: Draw) -> Target:
    """The target of a draw."""
    return lambda rng, folder: draw(rng, True)


#: Parameters that stay at their default.
NOT_DRAWN = {
    "progress",
    "options",
    "kwargs",
    "seed",
    "fext",
    "reference_frame",
    "strips",
    "accept",
}
#: Parameters that are objects of the package, as they are.
OBJECTS = {"arm", "chain", "vehicle", "model"}


@cache
def _arm(k: int) -> a5.Arm:
    gripper, floating, density = (
        ("locked", "jaws")[k % 2],
        bool(k // 2 % 2),
        (1025.0, 0.0, 2e3)[k // 4 % 3],
    )
    arm = a5.load(density, gripper, floating)
    return arm.with_payload(0.1, volume=5e-4) if k >= 12 else arm


@cache
def _wet(k: int) -> Any:
    level = ("low", "nominal", "high")[k % 3]
    return _arm(k).with_hydrodynamics((0.1 * (k % 2), 0.0, 0.05), level)


@cache
def _vehicle() -> a5.Vehicle:
    return a5.Vehicle(
        mass=11.5,
        com=(0.0, 0.0, 0.02),
        inertia=np.diag([0.2, 0.25, 0.3]),
        volume=0.0115,
        cob=(0.0, 0.0, 0.05),
        added_mass=(5.0, 12.0, 14.0, 0.12, 0.12, 0.12),
        linear_damping=(4.0, 6.0, 5.0, 0.07, 0.07, 0.07),
        quadratic_damping=(18.0, 21.0, 37.0, 1.5, 1.5, 1.5),
    )


@cache
def _on_vehicle(k: int) -> Any:
    return _wet(k).on_vehicle(_vehicle())


def _states(arm: Any, batch: bool) -> dict[str, Callable[[Rng], np.ndarray]]:
    """Positions and rates of an arm: one state, or rows of them."""
    nq, nv = arm.model.nq, arm.model.nv

    def position(rng: Rng) -> np.ndarray:
        out = rng.uniform(0, 3, (rows(rng), nq))
        if nq > nv:
            out[:, 3:7] /= np.linalg.norm(out[:, 3:7], axis=1)[:, None]
        return out if batch else out[0]

    def rate(rng: Rng) -> np.ndarray:
        out = rng.normal(0, 1, (rows(rng), nv))
        return out if batch else out[0]

    def rows(rng: Rng) -> int:
        return int(rng.integers(0, 4)) if batch else 1

    return {"q": position, "v": rate, "a": rate, "tau": rate}


def _same_rows(draw: Draw) -> Draw:
    """The same number of rows in each argument, most of the time."""

    def drawn(rng: Rng, spoiled: bool) -> Case:
        case = draw(rng, spoiled)
        if rng.integers(8) == 0:
            return case
        rows = int(rng.integers(1, 5))
        for name in {"q", "v", "a", "tau"} & {*case.arguments}:
            value = case.arguments[name]
            if isinstance(value, np.ndarray) and value.ndim == 2 and len(value):
                case.arguments[name] = value[np.arange(rows) % len(value)]
        return replace(case, hopeless=False)  # what was bad may be left out

    return drawn


def _method(make: Callable[[int], Any], kinds: int, method: str) -> Draw:
    """A method of one of several arms."""
    batch = method.endswith("_batch") or method == "regressor"

    def draw(rng: Rng, spoiled: bool) -> Case:
        arm = make(int(rng.integers(kinds)))
        own: dict[str, Any] = {
            **_states(arm, batch),
            "link": lambda rng: pick(rng, LINKS),
        }
        if not method.startswith("with_"):
            own["current"] = lambda rng: rng.normal(0, 0.5, 3)
        call = of(lambda rng: getattr(arm, method), **own)
        return (_same_rows(call) if batch else call)(rng, spoiled)

    return draw


def _of_states(function: Callable[..., Any], batch: bool = True) -> Draw:
    """A function of an arm and its states."""

    def draw(rng: Rng, spoiled: bool) -> Case:
        arm = _arm(int(rng.integers(24)))
        call = of(lambda rng: function, arm=lambda rng: arm, **_states(arm, batch))
        return (_same_rows(call) if batch else call)(rng, spoiled)

    return draw


LINKS = ("link_1", "link_2", "link_3", "link_4", "tcp")
#: Methods of an arm in still water.
METHODS = (
    "forward_kinematics", "jacobian", "mass_matrix", "coriolis_matrix", "gravity_torque", "buoyancy_torque", "hydrostatic_torque",
    "hydrostatic_torque_derivative", "buoyancy_wrenches", "potential_energy", "center_of_mass", "center_of_buoyancy", "in_collision",
    "collision_distance", "nonlinear_effects", "inverse_dynamics", "forward_dynamics", "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives", "base_wrench", "base_wrench_derivatives", "kinetic_energy", "inverse_dynamics_batch",
    "forward_dynamics_batch", "base_wrench_batch", "with_payload", "approach_directions", "regressor", "with_hydrodynamics",
)  # fmt: skip
#: Methods of an arm in moving water.
WET_METHODS = (
    "added_mass", "base_wrench", "base_wrench_batch", "base_wrench_current_derivative", "base_wrench_derivatives", "coriolis_matrix",
    "current_load", "dissipated_power", "forward_dynamics", "forward_dynamics_batch", "forward_dynamics_current_derivative",
    "forward_dynamics_derivatives", "inverse_dynamics", "inverse_dynamics_batch", "inverse_dynamics_current_derivative",
    "inverse_dynamics_derivatives", "kinetic_energy", "mass_matrix", "nonlinear_effects",
)  # fmt: skip
#: Methods of JAX's arm: one state each, which are not checked.
JAX_METHODS = (
    "base_wrench", "base_wrench_derivatives", "buoyancy_torque", "coriolis_matrix", "forward_dynamics", "forward_dynamics_derivatives",
    "forward_kinematics", "gravity_torque", "hydrostatic_torque", "hydrostatic_torque_derivative", "inverse_dynamics",
    "inverse_dynamics_derivatives", "jacobian", "link_poses", "mass_matrix", "nonlinear_effects",
)  # fmt: skip


def _chain(rng: Rng) -> Any:
    chain = a5.dh.DHChain
    return (
        chain.alpha5()
        if rng.integers(2)
        else chain.from_table(rng.normal(0, 1, (int(rng.integers(1, 6)), 4)))
    )


def _planar(rng: Rng) -> a5.planar.PlanarArm:
    n = int(rng.integers(1, 4))
    limits = [
        (-1.0, float(rng.uniform(0, 3))) if rng.integers(2) else None for _ in range(n)
    ]
    return a5.planar.PlanarArm(
        rng.uniform(0.2, 3, n), limits if rng.integers(2) else None
    )


def _solutions(rng: Rng) -> Any:
    return a5.inverse_kinematics(rng.normal(0, 0.25, pick(rng, ((3,), (2, 3)))))


def _motion(rng: Rng) -> Callable[..., Any]:
    """A motion from arrays, analysed and told."""

    def call(
        time: Any,
        position: Any,
        velocity: Any,
        method: Any,
        bandwidth: Any,
        constants: Any,
        supply_voltage: Any,
        current_limit: Any,
    ) -> Any:
        library = a5.trajectory
        analysis = library.analyse(
            library.motion(time, position, velocity), method=method, bandwidth=bandwidth, constants=constants,
            supply_voltage=supply_voltage, current_limit=current_limit,
        )  # fmt: skip
        return library.summary(analysis)

    return call


def _rows(n: int) -> Callable[[Rng], np.ndarray]:
    return lambda rng: rng.uniform(1, 2, (6, n)).cumsum(axis=0) * 0.01


def _limits(rng: Rng) -> Any:
    return pick(
        rng,
        (
            None,
            [(-1.0, 1.0)] * 3,
            [None, (0.0, 2.0)],
            [(1.0, -1.0)],
            "none",
            [(0.0, np.inf)],
        ),
    )


@cache
def _jax() -> Any:
    from alpha5_model import jax

    return jax.load()


def _jax_inverse_kinematics(position: Any, wrist: Any = 0.0) -> Any:
    from alpha5_model import jax

    return jax.inverse_kinematics(position, wrist)


@cache
def _sample() -> Any:
    return a5.uncertainty.sample(3)


def _arc(rng: Rng) -> a5.planar.Arc:
    center = (float(rng.normal()), float(rng.normal()))
    return a5.planar.Arc(
        center, float(rng.uniform(0.1, 3)), float(rng.uniform(-3, 3)), 2.0
    )


def _segment(rng: Rng) -> a5.planar.Segment:
    start = (float(rng.normal()), float(rng.normal()))
    return a5.planar.Segment(
        start, float(rng.uniform(-3, 3)), float(rng.uniform(0.1, 3))
    )


def _plane_points(rng: Rng) -> np.ndarray:
    return rng.normal(0, 2, pick(rng, ((2,), (3, 2))))


def _numbers(rng: Rng) -> np.ndarray:
    return rng.uniform(-0.5, 0.5, pick(rng, ((), (3,), (2, 3))))


def _axes(rng: Rng) -> dict[str, Callable[[Rng], Any]]:
    n = int(rng.integers(1, 6))
    pairs = np.sort(rng.uniform(-3, 3, (n, 2)))
    return {
        "points": lambda rng: rng.normal(0, 1, (n, 3)),
        "directions": lambda rng: rng.normal(0, 1, (n, 3)),
        "sigma": lambda rng: [int(x) for x in rng.integers(0, 2, n)],
        "end_effector": transform,
        "q": lambda rng: rng.uniform(-1, 1, n),
        "limits": lambda rng: pairs,
        "tolerance": number(0, 1e-6),
    }


def _from_axes(rng: Rng, spoiled: bool) -> Case:
    return of(lambda rng: a5.dh.DHChain.from_axes, **_axes(rng))(rng, spoiled)


def _pose_solutions(rng: Rng) -> Any:
    return a5.inverse_kinematics_pose(transform(rng))


def _chain_of(links: Any, base: Any, tool: Any) -> Any:
    return a5.dh.DHChain(links, base, tool)


def _links(rng: Rng) -> Any:
    return [
        a5.dh.DHLink(*rng.uniform(-1, 1, 4)) for _ in range(int(rng.integers(1, 4)))
    ]


def _damping(rng: Rng) -> np.ndarray:
    return rng.uniform(0, 9, 6)


def _identified(
    time: Any, position: Any, velocity: Any, effort: Any, wrench: Any
) -> Any:
    motion = a5.trajectory.motion(time, position, velocity, effort=effort)
    return a5.identify(motion, wrench=wrench)


def _smoothed(time: Any, position: Any, velocity: Any) -> Any:
    return a5.trajectory.smooth(a5.trajectory.motion(time, position, velocity))


#: What takes the arguments of another target under another name, or by a method of its own.
PLAIN = (
    "reachable", "distance_to_reach", "nearest_reachable", "inverse_kinematics_path", "inverse_kinematics", "inverse_kinematics_pose",
    "published_inverse_kinematics", "load", "gravity_in_base", "named_pose", "parameters", "compare", "without_self_collision",
    "robot_wrapper", "workspace.published_reachable", "workspace.cross_section_area", "workspace.volume", "workspace.reachable",
    "workspace.distance_to_reach", "workspace.nearest_reachable", "workspace.boundary", "workspace.published_but_unreachable",
    "workspace.reachable_but_unpublished", "workspace.singularities", "workspace.manipulability", "workspace.in_half_plane",
    "workspace.in_tori", "dh.dh_transform", "dh.DHLink", "dh.DHChain.from_table", "dh.DHChain.from_urdf", "dh.DHLink.from_vector",
    "dh.DHChain.alpha5", "planar.theorem_radii", "planar.theorem_row", "planar.lecture_theorem", "planar.PlanarArm",
    "planar.annulus", "actuators.actuator", "trajectory.read_motion", "trajectory.motion", "uncertainty.torque_bounds",
    "uncertainty.bounds", "uncertainty.printed_numbers", "Vehicle", "DragStrip",
)  # fmt: skip


def _draws() -> dict[str, Draw]:
    """Public name -> what draws its calls."""
    draws = _plain() | _dynamics() | _theory() | _recordings()
    draws |= {
        f"a5.actuators.Actuator.{method}": of(
            lambda rng, m=method: getattr(_actuator(rng), m)
        )
        for method in ("current", "torque", "holding_current", "holding_torque", "voltage",
                       "speed", "torque_limits", "speed_limits", "power", "current_interval", "torque_interval")
    }  # fmt: skip
    draws["a5.uncertainty.Sample.base_parameters"] = of(
        lambda rng: _sample().base_parameters
    )
    draws["a5.uncertainty.Sample.parameters"] = of(
        lambda rng: _sample().parameters, index=lambda rng: int(rng.integers(3))
    )
    return draws


def _actuator(rng: Rng) -> Any:
    return a5.actuators.actuator(
        GOOD["joint"](rng), screw_lead=1e-3, rotor_inertia=1e-7
    )


def _plain() -> dict[str, Draw]:
    """Functions of the package by their names, and of the modules beside it."""
    draws: dict[str, Draw] = {}
    own: dict[str, dict[str, Callable[[Rng], Any]]] = {
        "workspace.in_half_plane": {"radius": _numbers, "z": _numbers},
        "workspace.in_tori": {"radius": _numbers, "z": _numbers},
        "planar.PlanarArm": {"limits": _limits, "angles": lambda rng: None},
        "planar.annulus": {"length_ranges": lambda rng: np.sort(rng.uniform(0, 2, (3, 2)))},
        "dh.DHLink.from_vector": {"vector": lambda rng: rng.normal(0, 1, 4)},
        "trajectory.motion": {"position": _rows(4), "velocity": _rows(4), "effort": _rows(4), "joints": lambda rng: None},
        "without_self_collision": {"q": lambda rng: rng.uniform(0, 3, (2, 4)), "wrists": lambda rng: 3},
        "Vehicle": {"linear_damping": _damping, "quadratic_damping": _damping, "added_mass": lambda rng: rng.uniform(0, 9, 6),
                    "inertia": lambda rng: np.diag(rng.uniform(1, 1.5, 3)), "transform_vehicle_to_base": transform},
        "DragStrip": {"start": lambda rng: rng.normal(0, 0.1, 3), "end": lambda rng: rng.normal(0, 0.1, 3), "diameter": number(0, 0.1), "across": number(0, 2), "along": number(0, 1)},
    }  # fmt: skip
    for name in PLAIN:
        call: Any = a5
        for part in name.split("."):
            call = getattr(call, part)
        draws[f"a5.{name}"] = of(lambda rng, call=call: call, **own.get(name, {}))
    for module, names in (
        (inertia, ("flip_products", "point_mass_tensor", "tensor_at_origin", "tensor_at_com", "rotate_tensor", "combine", "second_moments", "pseudo_inertia", "principal_moments", "radii_of_gyration", "inconsistencies", "check_possible")),
        (fluids, ("gravity_in_base",)),
        (corrections, ("check_corrections",)),
        (orientations, ("even_rotations",)),
    ):  # fmt: skip
        for name in names:
            call = getattr(module, name)
            short = module.__name__.rpartition(".")[2]
            draws[f"{short}.{name}"] = of(lambda rng, call=call: call)
    for name in ("uncertainty.bounds", "uncertainty.torque_bounds"):
        call = getattr(a5.uncertainty, name.rpartition(".")[2])
        draws[f"a5.{name}"] = _same_rows(
            of(
                lambda rng, call=call: call,
                arm=lambda rng: _arm(0),
                **_states(_arm(0), True),
            )
        )
    draws["Solutions.best"] = of(lambda rng: _solutions(rng).best)
    draws["PoseSolutions.best"] = of(lambda rng: _pose_solutions(rng).best)
    draws["a5.workspace.Singularities.near"] = of(
        lambda rng: a5.workspace.singularities(rng.uniform(0, 3, (5, 4))).near
    )
    draws["a5.workspace.Arc.points"] = of(
        lambda rng: a5.workspace.boundary()[0].points, angle=_numbers
    )
    return draws


def _dynamics() -> dict[str, Draw]:
    """Methods of arms, and functions of arms and states."""
    draws = {f"a5.Arm.{method}": _method(_arm, 24, method) for method in METHODS}
    for method in WET_METHODS:
        draws[f"HydrodynamicArm.{method}"] = _method(_wet, 12, method)
        draws[f"ArmOnVehicle.{method}"] = _method(_on_floating, 6, method)
    draws["HydrodynamicArm.with_payload"] = _method(_wet, 12, "with_payload")
    for method in ("mount_load", "reaction", "trim"):
        draws[f"ArmOnVehicle.{method}"] = _method(_on_floating, 6, method)
    draws["ArmOnVehicle.configuration"] = of(
        lambda rng: _on_floating(0).configuration, transform_vehicle_to_world=transform,
        q=lambda rng: rng.uniform(0, 3, 4),
    )  # fmt: skip
    for function in (torque_terms, frame_positions, water_terms):
        draws[f"dynamics.batch.{function.__name__}"] = _of_states(function)
    for method in JAX_METHODS:
        own = {
            name: lambda rng: rng.uniform(0, 3, 4) for name in ("q", "v", "a", "tau")
        }
        draws[f"jax.JaxArm.{method}"] = of(
            lambda rng, m=method: getattr(_jax(), m), **own
        )
    draws["jax.JaxArm.with_payload"] = of(
        lambda rng: _jax().with_payload, inertia=lambda rng: np.eye(3) * 1e-4
    )
    draws["jax.inverse_kinematics"] = of(
        lambda rng: _jax_inverse_kinematics, position=lambda rng: rng.normal(0, 0.25, 3)
    )
    return draws


def _on_floating(k: int) -> Any:
    """On a vehicle; k counts arms with a floating base."""
    return _on_vehicle(4 * (k // 2) + k % 2 + 2)


def _theory() -> dict[str, Draw]:
    """Denavit and Hartenberg, planar arms."""
    draws: dict[str, Draw] = {}
    for method in ("frames", "forward_kinematics", "jacobian", "joint_axes", "to_urdf"):
        draws[f"a5.dh.DHChain.{method}"] = of(
            lambda rng, m=method: getattr(_chain(rng), m)
        )
    draws["a5.dh.DHChain.from_axes"] = _from_axes
    draws["a5.dh.DHChain"] = of(
        lambda rng: _chain_of, links=_links, base=transform, tool=transform
    )
    draws["a5.dh.DHLink.transform"] = of(
        lambda rng: _links(rng)[0].transform, q=number(-3, 3)
    )
    for function in (
        arm_types.classify,
        tasks.task_capability,
        orientations.orientation_freedom,
        orientations.spatial_dexterity,
    ):
        draws[f"dh.{function.__name__}"] = of(lambda rng, f=function: f, chain=_chain)
    for method in ("poses", "forward_kinematics", "jacobian", "part"):
        draws[f"a5.planar.PlanarArm.{method}"] = of(
            lambda rng, m=method: getattr(_planar(rng), m),
            q=lambda rng: angles(int(rng.integers(1, 4)))(rng),
        )
    draws["a5.planar.Workspace.contains"] = of(
        lambda rng: _planar(rng).workspace().contains, points=_plane_points
    )
    draws["a5.planar.dexterity"] = of(
        lambda rng: a5.planar.dexterity, arm=_planar, points=_plane_points
    )
    for name in (
        "dexterous_area",
        "dexterous_radii",
        "necessary_conditions",
        "turns_fully",
        "workspace",
    ):
        draws[f"a5.planar.{name}"] = of(
            lambda rng, n=name: getattr(a5.planar, n), arm=_planar
        )
    draws["a5.planar.dexterity_map"] = of(
        lambda rng: a5.planar.dexterity_map, arm=_planar, resolution=lambda rng: 5
    )
    for name, curve in (("Arc", _arc), ("Segment", _segment)):
        draws[f"a5.planar.{name}.point"] = of(
            lambda rng, c=curve: c(rng).point, t=_numbers
        )
        draws[f"a5.planar.{name}.left"] = of(
            lambda rng, c=curve: c(rng).left, t=number(-3, 3)
        )
        draws[f"a5.planar.{name}.parameter"] = of(
            lambda rng, c=curve: c(rng).parameter,
            points=_plane_points,
            tolerance=number(0, 0.1),
        )
    return draws


def _recordings() -> dict[str, Draw]:
    """Motions from arrays."""
    return {
        "a5.trajectory.analyse": of(_motion, position=_rows(4), velocity=_rows(4)),
        "a5.trajectory.smooth": of(
            lambda rng: _smoothed, position=_rows(4), velocity=_rows(4)
        ),
        "a5.identify": of(
            lambda rng: _identified, position=_rows(4), velocity=_rows(4), effort=_rows(4),
            wrench=_rows(6), time=GOOD["time"],
        ),
    }  # fmt: skip


DRAWS = _draws()
#: Of functions that check nothing, as documented: JAX's numbers may be traced, curves are results.
UNCHECKED = forms.IN_THEIR_TYPE
TARGETS: dict[str, Target] = {
    name: spoiling(draw)
    for name, draw in DRAWS.items()
    if not name.startswith(UNCHECKED)
}
