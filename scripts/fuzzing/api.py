"""Functions and methods of the package with arguments of every sort."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model import inertia
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
    "samples", "number", "orientations", "threads", "starts", "steps", "start", "stop", "sigma", "lower", "upper", "bandwidth",
}  # fmt: skip


def of(
    make: Callable[[Rng], Callable[..., Any]],
    **own: Callable[[Rng], Any],
) -> Target:
    """A target that calls what ``make`` gives, with arguments by the names of its parameters."""

    def target(rng: Rng, folder: Path) -> Case:
        call = make(rng)
        arguments: dict[str, Any] = {}
        hopeless = False
        for name, parameter in inspect.signature(call).parameters.items():
            if name in ("progress", "options", "seed", "fext", "reference_frame") or (
                parameter.default is not parameter.empty and rng.integers(2)
            ):
                continue
            value = own.get(name, GOOD.get(name, lambda rng: None))(rng)
            if name in ("arm", "chain"):  # objects of the package, as they are
                pass
            elif rng.integers(4) == 0:
                value, bad = spoil(rng, value)
                hopeless |= bad and name not in LENIENT
            elif rng.integers(40) == 0:
                value = pick(rng, TEXTS)
            arguments[name] = value
        return Case(call, arguments, hopeless)

    return target


@cache
def _arm(k: int) -> a5.Arm:
    gripper, floating, density = (
        ("locked", "jaws")[k % 2],
        bool(k // 2 % 2),
        (1025.0, 0.0, 2e3)[k // 4 % 3],
    )
    arm = a5.load(density, gripper, floating)
    return arm.with_payload(0.1, volume=5e-4) if k >= 12 else arm


def _arm_target(method: str) -> Target:
    def state(arm: a5.Arm, name: str) -> Callable[[Rng], np.ndarray]:
        floating = arm.model.nq - arm.model.nv
        batch = method.endswith("_batch")

        def draw(rng: Rng) -> np.ndarray:
            rows = int(rng.integers(0, 4)) if batch else 1
            if name != "q":
                out = rng.normal(0, 1, (rows, arm.model.nv))
            else:
                out = rng.uniform(0, 3, (rows, arm.model.nq))
                if floating:
                    out[:, 3:7] /= np.linalg.norm(out[:, 3:7], axis=1)[:, None]
            return out if batch else out[0]

        return draw

    def target(rng: Rng, folder: Path) -> Case:
        arm = _arm(int(rng.integers(24)))
        own = {name: state(arm, name) for name in ("q", "v", "a", "tau")}
        return of(lambda rng: getattr(arm, method), **own)(rng, folder)

    return target


METHODS = (
    "forward_kinematics", "jacobian", "mass_matrix", "coriolis_matrix", "gravity_torque", "buoyancy_torque", "hydrostatic_torque",
    "hydrostatic_torque_derivative", "buoyancy_wrenches", "potential_energy", "center_of_mass", "center_of_buoyancy", "in_collision",
    "collision_distance", "nonlinear_effects", "inverse_dynamics", "forward_dynamics", "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives", "base_wrench", "base_wrench_derivatives", "kinetic_energy", "inverse_dynamics_batch",
    "forward_dynamics_batch", "base_wrench_batch", "with_payload", "approach_directions",
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
    limits = [(-1.0, float(rng.uniform(0, 3))) if rng.integers(2) else None for _ in range(n)]
    return a5.planar.PlanarArm(rng.uniform(0.2, 3, n), limits if rng.integers(2) else None)


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
        rng, (None, [(-1.0, 1.0)] * 3, [None, (0.0, 2.0)], [(1.0, -1.0)], "none", [(0.0, np.inf)])
    )


def _targets() -> dict[str, Target]:
    dh, planar, motor = a5.dh, a5.planar, a5.actuators
    from alpha5_model.dh import arm_types

    two = lambda rng: rng.normal(0, 2, pick(rng, ((2,), (3, 2))))  # noqa: E731
    plain: dict[str, Callable[..., Any]] = {
        name: getattr(a5, name)
        for name in ("reachable", "distance_to_reach", "nearest_reachable", "inverse_kinematics_path", "inverse_kinematics", "inverse_kinematics_pose", "published_inverse_kinematics", "load", "gravity_in_base", "named_pose", "parameters", "compare")
    }  # fmt: skip
    for module, names in (
        (inertia, ("flip_products", "point_mass_tensor", "tensor_at_origin", "tensor_at_com", "rotate_tensor", "combine", "second_moments", "pseudo_inertia", "principal_moments", "radii_of_gyration", "inconsistencies")),
        (a5.workspace, ("published_reachable", "cross_section_area", "volume", "published_but_unreachable", "reachable_but_unpublished")),
        (a5.workspace, ("singularities", "manipulability")),
        (dh, ("dh_transform", "DHLink", "DHChain.from_table", "DHChain.from_urdf")),
        (planar, ("theorem_radii", "theorem_row", "lecture_theorem")),
        (motor, ("actuator",)),
        (arm_types, ("even_rotations",)),
        (a5.trajectory, ("read_motion",)),
    ):  # fmt: skip
        for name in names:
            call: Any = module
            for part in name.split("."):
                call = getattr(call, part)
            plain[f"{module.__name__.split('.')[-1]}.{name}"] = call
    targets = {name: of(lambda rng, call=call: call) for name, call in plain.items()}
    targets["DHLink"] = targets.pop("dh.DHLink")
    targets |= {f"Arm.{method}": _arm_target(method) for method in METHODS}
    targets["Solutions.best"] = of(lambda rng: _solutions(rng).best)
    for method in ("frames", "forward_kinematics", "jacobian", "joint_axes", "to_urdf"):
        targets[f"DHChain.{method}"] = of(lambda rng, m=method: getattr(_chain(rng), m))
    for function in (
        arm_types.classify,
        arm_types.task_capability,
        arm_types.orientation_freedom,
        arm_types.spatial_dexterity,
    ):
        targets[function.__name__] = of(lambda rng, f=function: f, chain=_chain)
    targets["PlanarArm"] = of(lambda rng: planar.PlanarArm, limits=_limits, angles=lambda rng: None)
    for method in ("poses", "forward_kinematics", "jacobian", "part"):
        targets[f"PlanarArm.{method}"] = of(
            lambda rng, m=method: getattr(_planar(rng), m),
            q=lambda rng: angles(int(rng.integers(1, 4)))(rng),
        )
    targets["Workspace.contains"] = of(lambda rng: _planar(rng).workspace().contains, points=two)
    targets["planar.dexterity"] = of(lambda rng: planar.dexterity, arm=_planar, points=two)
    for name in ("dexterous_area", "dexterous_radii", "necessary_conditions", "turns_fully"):
        targets[f"planar.{name}"] = of(lambda rng, n=name: getattr(planar, n), arm=_planar)
    for method in (
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
    ):
        targets[f"Actuator.{method}"] = of(
            lambda rng, m=method: getattr(
                motor.actuator(GOOD["joint"](rng), screw_lead=1e-3, rotor_inertia=1e-7), m
            )
        )
    targets["motion"] = of(_motion, position=_rows(4), velocity=_rows(4))
    return targets


TARGETS = _targets()
