"""Every public function that takes arrays, with a call of each.

The tests of arrays' layouts go through these calls.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from public_names import public_names

import alpha5_model as a5
from alpha5_model.dynamics.batch import frame_positions
from alpha5_model.dynamics.torque_causes import torque_terms
from alpha5_model.numbers import arm_checks, fluids, inertia
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin
from alpha5_model.water.terms import water_terms

#: More rows than the compiled kernels turn to columns at once.
ROWS = 70
#: An annotation that an array fits.
_ARRAY = re.compile(r"Array|Rows|Flow|Numbers")
#: Takes arrays, but hands them on to a screen, or only keeps what the package computed.
NOT_CALLED = {
    "ArmVisualizer": "a screen",
    "view": "a screen",
    "Alignment.theirs": "made by compare of a file",
    "ActuatorPower": "a record",
    "Analysis": "a record",
    "Calibration": "a record",
    "DexterityMap": "a record",
    "Gains": "a record",
    "Margins": "a record",
    "Step": "a record",
    "Sensor.check": "for `fit`, which has checked readings",
    "Sensor.check_readings": "for `fit`, which has checked readings",
    "Sensor.holds": "for `fit`, which has checked readings",
    "Sensor.read": "for `fit`, which has checked readings",
    "Scales.check": "for `fit`, which has checked readings",
    "Scales.check_readings": "for `fit`, which has checked readings",
    "Scales.holds": "for `fit`, which has checked readings",
    "Scales.read": "for `fit`, which has checked readings",
    "summary": "takes what `analyse` computed",
    "text": "takes what `analyse` computed",
    "Described.theirs": "a record of compare",
    "Interval": "a record",
    "Motion": "a record",
    "Loads": "a record",
    "Own": "a record",
    "Placements": "a record",
    "Placements.take": "takes numbers of rows",
    "Problem": "a record",
    "Sample": "a record",
    "Sensitivity": "a record",
    "Sensor": "a record",
    "Session": "a record",
    "Singularities": "a record",
    "SmoothMotion": "a record",
    "Solutions": "a record",
    "Spread": "a record",
    "HydrodynamicArm.regressor": "refuses every state",
    "ArmOnVehicle.regressor": "refuses every state",
    "ArmOnVehicle.with_hydrodynamics": "hands its current to the arm's",
}


@dataclass(frozen=True)
class Call:
    """A function, its arrays and its other arguments."""

    function: Callable[..., Any]
    arrays: dict[str, np.ndarray]
    others: dict[str, Any]


def taking_arrays() -> dict[str, Any]:
    """Name -> public function, method or class with a parameter that an array fits."""
    found = {}
    for name, value in public_names().functions.items():
        parameters = inspect.signature(value).parameters.values()
        if any(_ARRAY.search(str(p.annotation)) for p in parameters):
            found[name.removeprefix("-> ")] = value
    return found


def short(name: str) -> str:
    """A public name without its modules: ``Arm.jacobian`` of ``a5.Arm.jacobian``."""
    parts = name.split(".")
    own = [part for part in parts if part[0].isupper()]
    return ".".join(parts[parts.index(own[0]) :]) if own else parts[-1]


def left_out(name: str) -> bool:
    """Whether `NOT_CALLED` names it, or its class."""
    return short(name) in NOT_CALLED or short(name).partition(".")[0] == "ArmVisualizer"


#: A name, a function, its arrays and its other arguments.
_Row = tuple[str, Callable[..., Any], dict[str, Any], dict[str, Any]]

#: Methods of an arm that take one state; the others take rows.
_MANY = ("_batch", "regressor")
_BODY = {"com": np.array([0.01, 0.02, 0.05]), "inertia": np.diag([4e-4, 5e-4, 6e-4])}
_LOAD = {**_BODY, "cob": np.array([0.01, 0.0, 0.04])}


def _of_arm(owner: str, arm: Any, rng: np.random.Generator) -> dict[str, Call]:
    """Every method of an arm that takes a state."""
    model = arm.still.model if hasattr(arm, "still") else arm.model
    q = np.array([pin.randomConfiguration(_bounded(model)) for _ in range(ROWS)])
    rates = rng.normal(size=(3, ROWS, model.nv))
    state = {"q": q, "v": rates[0], "a": rates[1], "tau": rates[2]}
    state["water_velocity"] = rng.normal(scale=0.3, size=(ROWS, 3))
    state["acceleration"] = rng.normal(size=(ROWS, 3))
    state["position"] = np.tile([0.2, 0.1, 0.1], (ROWS, 1))
    calls = {}
    for name, value in inspect.getmembers(type(arm), inspect.isfunction):
        if name.startswith("_"):
            continue
        given = [p for p in inspect.signature(value).parameters if p in state]
        if not given or name in (
            "with_hydrodynamics",
            "configuration",
            "reaction",
            "trim",
        ):
            continue
        known = arm._kernel_parameters is not None and not arm.has_hydrodynamics
        if name == "regressor" and not known:
            continue  # refused
        many = name.endswith(_MANY)
        arrays = {p: state[p] if many else state[p][0] for p in given}
        calls[f"{owner}.{name}"] = Call(getattr(arm, name), arrays, {})
    return calls


def _bounded(model: Any) -> Any:
    """A model whose free joints are near the origin.

    `pin.randomConfiguration` needs bounds.
    """
    bounded = pin.Model(model)
    low, high = bounded.lowerPositionLimit.copy(), bounded.upperPositionLimit.copy()
    low[low < -100.0] = -1.0
    high[high > 100.0] = 1.0
    bounded.lowerPositionLimit, bounded.upperPositionLimit = low, high
    return bounded


def _vehicle(**arrays: Any) -> a5.Vehicle:
    own = {
        "com": np.zeros(3),
        "inertia": np.diag([0.26, 0.23, 0.37]),
        "cob": [0.0, 0.0, 0.02],
    }
    return a5.Vehicle(**{"mass": 13.5, "volume": 0.0134, **own, **arrays})


def arm_calls() -> list[tuple[str, Call]]:
    """Of `Arm`, its variants and functions of arms, (name, call), made anew.

    The arms compute with the kernels in use.
    """
    pin.seed(3)
    rng = np.random.default_rng(3)
    arms = {
        "Pinocchio": a5.load(),
        "floating": a5.load(floating_base=True),
        "jaws": a5.load(gripper="jaws"),
    }
    calls = []
    for arm in arms.values():
        calls += _of_arm("Arm", arm, rng).items()
    wet = arms["Pinocchio"].with_hydrodynamics()
    on_vehicle = wet.on_vehicle(_vehicle())
    calls += _of_arm("HydrodynamicArm", wet, rng).items()
    calls += _of_arm("HydrodynamicArm", arms["jaws"].with_hydrodynamics(), rng).items()
    calls += _of_arm("ArmOnVehicle", on_vehicle, rng).items()

    q, v, a = rng.normal(size=(3, ROWS, 4))
    state = {"q": q, "v": v, "a": a}
    current = {"water_velocity": rng.normal(scale=0.3, size=3)}
    plain = arms["Pinocchio"]

    def torque(arm: Any) -> Any:
        return arm.inverse_dynamics_batch(q, v, a)

    own = {
        "torque_terms": (torque_terms, state, {"arm": plain}),
        "water_terms": (water_terms, state | current, {"arm": plain}),
        "frame_positions": (frame_positions, {"q": q}, {"arm": plain}),
        "torque_margin": (torque_margin, state, {"arm": plain}),
        "bounds": (a5.uncertainty.bounds, state, {}),
        "without_self_collision": (a5.without_self_collision, {"q": q}, {"wrists": 2}),
        "load": (
            lambda **g: torque(a5.load(**g)),
            {"gravity": np.array([1.0, 2.0, -9.0])},
            {},
        ),
        "arm": (
            lambda **g: torque(a5.uncertainty.arm(a5.parameters(), **g)),
            {"gravity": np.array([1.0, 2.0, -9.0])},
            {},
        ),
        "Arm.with_payload": (
            lambda **g: torque(plain.with_payload(0.6, **g)),
            _LOAD,
            {},
        ),
        "HydrodynamicArm.with_payload": (
            lambda **g: torque(wet.with_payload(0.6, **g)),
            {**_LOAD, "added_mass": np.diag(np.arange(1.0, 7.0))},
            {},
        ),
        "Arm.with_hydrodynamics": (
            lambda **g: torque(plain.with_hydrodynamics(**g)),
            current,
            {},
        ),
        "HydrodynamicArm.with_hydrodynamics": (
            lambda **g: torque(wet.with_hydrodynamics(**g)),
            current,
            {},
        ),
        "ArmOnVehicle.configuration": (
            on_vehicle.configuration,
            {"transform_vehicle_to_world": np.eye(4), "q": q[0]},
            {},
        ),
        "ArmOnVehicle.trim": (on_vehicle.trim, {"q": q[0]}, {}),
        "ArmOnVehicle.reaction": (
            on_vehicle.reaction,
            {
                "q": on_vehicle.configuration(np.eye(4), q[0]),
                "v": rng.normal(size=10),
                "a": a[0],
                **current,
            },
            {},
        ),
    }
    return calls + [(name, Call(*call)) for name, call in own.items()]


def _from_turning_devices(e: Any, d: Any) -> Any:
    """`q_from_devices` with arrays in place of its mapping."""
    return a5.q_from_devices({5: e, 4: d, 3: d, 2: e})


def kinematics_calls() -> list[tuple[str, Call]]:
    """Of inverse kinematics, reach and workspace, (name, call)."""
    rng = np.random.default_rng(4)
    positions = rng.uniform(-0.4, 0.4, (ROWS, 3))
    wrist = rng.uniform(0.1, 3.0, ROWS)
    q = rng.uniform(0.5, 3.0, (ROWS, 4))
    reached = {"positions": positions[np.asarray(a5.reachable(positions))]}
    solved = a5.inverse_kinematics(reached["positions"])
    is_free = (solved.within_limits & ~solved.collides).any(axis=-1)
    solved = a5.inverse_kinematics(reached["positions"][is_free])
    poses = a5.dh.DHChain.alpha5().forward_kinematics(q)
    path = np.linspace([0.2, 0.1, 0.1], [0.2, 0.12, 0.1], 20)
    plane = {"radius": rng.uniform(0.0, 0.4, ROWS), "z": rng.uniform(-0.3, 0.4, ROWS)}
    posed = a5.inverse_kinematics_pose(poses[:, :, :])
    inside = (posed.within_limits & ~posed.collides).any(axis=-1)
    posed = a5.inverse_kinematics_pose(poses[inside])
    space = a5.workspace
    limits = a5.load().limits
    jaws = a5.jaws()
    rods = {"rod": rng.uniform(jaws.closed, jaws.open, ROWS)}
    places = {"at": rng.uniform(-0.03, 0.03, ROWS)}
    table: list[tuple[str, Any, dict[str, Any], dict[str, Any]]] = [
        ("Limits.beyond", limits.beyond, {"q": q}, {}),
        ("JawTool.opening", jaws.opening, rods, {}),
        ("JawTool.rod", jaws.rod, {"opening": rng.uniform(0.0, 0.1, ROWS)}, {}),
        ("JawTool.gap", jaws.gap, places, {"rod": 0.006}),
        (
            "JawTool.force",
            jaws.force,
            {"current": rng.uniform(0.0, 0.2, ROWS)},
            {"screw_lead": 1e-3},
        ),
        ("inverse_kinematics", a5.inverse_kinematics, {"position": positions}, {}),
        ("inverse_kinematics", a5.inverse_kinematics, {"position": positions[0]}, {}),
        (
            "inverse_kinematics",
            a5.inverse_kinematics,
            {"position": positions, "wrist": wrist},
            {},
        ),
        (
            "inverse_kinematics_pose",
            a5.inverse_kinematics_pose,
            {"transform": poses},
            {},
        ),
        (
            "inverse_kinematics_path",
            a5.inverse_kinematics_path,
            {"positions": path, "wrist": wrist[:1].repeat(20)},
            {},
        ),
        (
            "inverse_kinematics_path",
            a5.inverse_kinematics_path,
            {"positions": path, "q_start": a5.inverse_kinematics_path(path)[0]},
            {},
        ),
        (
            "published_inverse_kinematics",
            a5.published_inverse_kinematics,
            {"position": positions},
            {},
        ),
        ("Solutions.best", solved.best, {"q_reference": q[0]}, {}),
        ("Solutions.best", solved.best, {"q_reference": q[: len(solved.position)]}, {}),
        ("PoseSolutions.best", posed.best, {"q_reference": q[0]}, {}),
        ("reachable", a5.reachable, {"positions": positions}, {}),
        ("distance_to_reach", a5.distance_to_reach, {"positions": positions}, {}),
        ("devices_from_q", a5.devices_from_q, {"q": q}, {}),
        ("q_from_devices", _from_turning_devices, {"e": wrist, "d": wrist}, {}),
        ("nearest_reachable", a5.nearest_reachable, {"positions": positions}, {}),
        (
            "published_reachable",
            space.published_reachable,
            {"positions": positions},
            {},
        ),
        ("in_half_plane", space.in_half_plane, plane, {}),
        ("in_tori", space.in_tori, plane, {}),
        ("manipulability", space.manipulability, {"q": q}, {}),
        ("singularities", space.singularities, {"q": q}, {}),
        ("Arc.points", space.boundary()[0].points, {"angle": wrist}, {}),
    ]
    return [(name, Call(*call)) for name, *call in table]


@dataclass(frozen=True)
class _TheoryRows:
    """Random arrays for the functions that take no arm, `ROWS` rows each."""

    mass: np.ndarray
    com: np.ndarray
    tensor: np.ndarray
    tensor_at_origin: np.ndarray
    torque: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    q: np.ndarray
    points: np.ndarray
    wrench: np.ndarray
    chain: a5.dh.DHChain

    @property
    def pose(self) -> np.ndarray:
        """The pose (4, 4) of the chain's end effector at the first row."""
        return self.chain.forward_kinematics(self.q[0])

    @property
    def rotation(self) -> np.ndarray:
        """The rotations (N, 3, 3) of the chain's end effector."""
        return self.chain.forward_kinematics(self.q)[:, :3, :3].copy()


def _theory_rows() -> _TheoryRows:
    rng = np.random.default_rng(5)
    mass = rng.uniform(0.1, 1.0, ROWS)
    com = rng.normal(scale=0.1, size=(ROWS, 3))
    moment = rng.uniform(1.0, 1.5, (ROWS, 3))
    tensor = np.einsum("ni,ij->nij", moment, np.eye(3))
    torque, velocity, acceleration = rng.normal(size=(3, ROWS))
    return _TheoryRows(
        mass=mass,
        com=com,
        tensor=tensor,
        tensor_at_origin=inertia.tensor_at_origin(mass, com, tensor),
        torque=torque,
        velocity=velocity,
        acceleration=acceleration,
        q=rng.uniform(0.5, 3.0, (ROWS, 4)),
        points=rng.uniform(-6.0, 6.0, (ROWS, 2)),
        wrench=rng.normal(size=(101, 6)),
        chain=a5.dh.DHChain.alpha5(),
    )


def theory_calls() -> list[tuple[str, Call]]:
    """Of the functions that take no arm of the package, (name, call)."""
    rows = _theory_rows()
    table = [
        *_inertia_calls(rows),
        *_actuator_calls(rows),
        *_chain_calls(rows),
        *_planar_calls(rows),
        *_recording_calls(rows),
        *_water_calls(rows),
        *_obstacle_calls(rows),
        *_calibration_calls(rows),
        *_control_calls(rows),
    ]
    return [(name, Call(*call)) for name, *call in table]


def _inertia_calls(rows: _TheoryRows) -> list[_Row]:
    """Of inertia and gravity, (name, call)."""
    pulled = {"mass": rows.mass, "com": rows.com, "inertia_com": rows.tensor}
    return [
        (
            "check_possible",
            inertia.check_possible,
            {"com": rows.com[0], "inertia": rows.tensor[0]},
            {"name": "a body", "mass": 0.1},
        ),
        (
            "check_inside",
            arm_checks.check_inside,
            {"com": rows.com[0], "bounds": np.array([rows.com[0], rows.com[0]]).T},
            {"name": "com"},
        ),
        (
            "combine",
            inertia.combine,
            {"masses": rows.mass, "coms": rows.com, "inertias": rows.tensor},
            {},
        ),
        (
            "check_possible",
            inertia.check_possible,
            {"com": rows.com[0], "inertia": rows.tensor[0]},
            {"name": "inertia", "mass": 100.0},
        ),
        (
            "flip_products",
            inertia.flip_products,
            {"inertia": rows.tensor_at_origin},
            {},
        ),
        (
            "inconsistencies",
            inertia.inconsistencies,
            {
                "com": rows.com[0],
                "inertia_com": rows.tensor_at_origin[0],
                "bounds": np.tile([-1.0, 1.0], (3, 1)),
            },
            {"mass": 0.1},
        ),
        (
            "point_mass_tensor",
            inertia.point_mass_tensor,
            {"mass": rows.mass, "position": rows.com},
            {},
        ),
        (
            "principal_moments",
            inertia.principal_moments,
            {"inertia": rows.tensor_at_origin},
            {},
        ),
        ("pseudo_inertia", inertia.pseudo_inertia, pulled, {}),
        (
            "rotate_tensor",
            inertia.rotate_tensor,
            {"rotation_a_to_b": rows.rotation, "inertia": rows.tensor_at_origin},
            {},
        ),
        (
            "second_moments",
            inertia.second_moments,
            {"inertia": rows.tensor_at_origin},
            {},
        ),
        (
            "tensor_at_com",
            inertia.tensor_at_com,
            {
                "mass": rows.mass,
                "com": rows.com,
                "inertia_origin": rows.tensor_at_origin,
            },
            {},
        ),
        ("tensor_at_origin", inertia.tensor_at_origin, pulled, {}),
        (
            "gravity_in_base",
            fluids.gravity_in_base,
            {"rotation": rows.rotation[0], "gravity": rows.com[0]},
            {},
        ),
    ]


def _actuator_calls(rows: _TheoryRows) -> list[_Row]:
    """Of actuators, (name, call)."""
    axis = a5.actuators.actuator("axis_c", rotor_inertia=1e-7)
    drag = {
        "torque": rows.torque,
        "velocity": rows.velocity,
        "acceleration": rows.acceleration,
    }
    current = {
        "current": rows.torque,
        "velocity": rows.velocity,
        "acceleration": rows.acceleration,
    }
    limits = {"supply_voltage": 24.0, "current_limit": 3.0}
    return [
        ("Actuator.current", axis.current, drag, {}),
        ("Actuator.current_interval", axis.current_interval, drag, {}),
        ("Actuator.power", axis.power, drag, {}),
        ("Actuator.holding_current", axis.holding_current, {"torque": rows.torque}, {}),
        ("Actuator.holding_torque", axis.holding_torque, {"current": rows.torque}, {}),
        (
            "Actuator.speed",
            axis.speed,
            {"voltage": rows.velocity, "current": rows.torque},
            {},
        ),
        (
            "Actuator.torque_limits",
            axis.torque_limits,
            {"velocity": rows.velocity, "acceleration": rows.acceleration},
            limits,
        ),
        ("Actuator.torque", axis.torque, current, {}),
        (
            "Actuator.voltage",
            axis.voltage,
            {
                "current": rows.torque,
                "velocity": rows.velocity,
                "current_rate": rows.acceleration,
            },
            {},
        ),
    ]


def _chain_calls(rows: _TheoryRows) -> list[_Row]:
    """Of Denavit-Hartenberg chains, (name, call)."""
    chain = rows.chain
    points_3 = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    directions_3 = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    return [
        (
            "DHChain",
            lambda **given: a5.dh.DHChain(chain.links, **given).frames(rows.q),
            {"base": rows.pose, "tool": rows.pose},
            {},
        ),
        ("DHChain.frames", chain.frames, {"q": rows.q}, {}),
        ("DHChain.forward_kinematics", chain.forward_kinematics, {"q": rows.q}, {}),
        ("DHChain.jacobian", chain.jacobian, {"q": rows.q}, {}),
        ("DHChain.joint_axes", chain.joint_axes, {"q": rows.q}, {}),
        (
            "DHChain.from_axes",
            a5.dh.DHChain.from_axes,
            {
                "points": points_3,
                "directions": directions_3,
                "end_effector": rows.pose,
                "q": rows.q[0, :2],
            },
            {},
        ),
        (
            "DHChain.from_table",
            a5.dh.DHChain.from_table,
            {"rows": np.array([[0, 0, 1.0, 0, 0]])},
            {},
        ),
        (
            "DHLink.from_vector",
            a5.dh.DHLink.from_vector,
            {"vector": np.array([0, 0, 1.0, 0, 0])},
            {},
        ),
        ("DHLink.transform", chain.links[0].transform, {"q": rows.torque}, {}),
        (
            "dh_transform",
            a5.dh.dh_transform,
            {
                "theta": rows.torque,
                "d": rows.velocity,
                "a": rows.acceleration,
                "alpha": rows.mass,
            },
            {},
        ),
    ]


def _planar_calls(rows: _TheoryRows) -> list[_Row]:
    """Of planar arms, (name, call)."""
    planar = a5.planar.PlanarArm((5.0, 4.0, 1.0))
    arc = a5.planar.Arc((0.1, 0.2), 1.0)
    segment = a5.planar.Segment((0.1, 0.2), 0.3, 1.0)
    return [
        ("PlanarArm", a5.planar.PlanarArm, {"lengths": np.array([5.0, 4.0, 1.0])}, {}),
        (
            "PlanarArm",
            a5.planar.PlanarArm,
            {"lengths": np.array([5.0, 4.0]), "angles": np.array([0.1, 0.2])},
            {},
        ),
        ("PlanarArm.poses", planar.poses, {"q": rows.com}, {}),
        (
            "PlanarArm.forward_kinematics",
            planar.forward_kinematics,
            {"q": rows.com},
            {},
        ),
        (
            "Workspace.contains",
            planar.workspace().contains,
            {"points": rows.points},
            {},
        ),
        (
            "dexterity",
            a5.planar.dexterity,
            {"points": rows.points},
            {"arm": planar, "orientations": 4, "samples": 3},
        ),
        ("Arc.moved", arc.moved, {"shift": rows.com[0, :2]}, {"angle": 0.1}),
        ("Arc.point", arc.point, {"t": rows.torque}, {}),
        (
            "Arc.parameter",
            arc.parameter,
            {"points": arc.point(rows.mass)},
            {"tolerance": 1e-9},
        ),
        ("Segment.moved", segment.moved, {"shift": rows.com[0, :2]}, {"angle": 0.1}),
        ("Segment.point", segment.point, {"t": rows.torque}, {}),
        (
            "Segment.parameter",
            segment.parameter,
            {"points": rows.points},
            {"tolerance": 1e-9},
        ),
    ]


def _recording_calls(rows: _TheoryRows) -> list[_Row]:
    """Of recordings and identification, (name, call)."""
    time = np.linspace(0.0, 2.0, 101)
    wave = np.sin(time[:, None] + np.arange(4.0)) * 0.3 + 1.5
    moved = {"time": time, "position": wave}
    recording = a5.trajectory.motion(
        **moved, joints=("axis_e", "axis_d", "axis_c", "axis_b")
    )

    def analysed(**given: Any) -> Any:
        return a5.trajectory.analyse(recording, **given).torque

    return [
        (
            "motion",
            a5.trajectory.motion,
            {**moved, "velocity": wave, "effort": wave},
            {},
        ),
        ("analyse", analysed, {"water_velocity": rows.com[0]}, {}),
    ]


def _tilted_mount(xyz: Any, rpy: Any) -> Any:
    """Pose of the arm on a vehicle that tilts, by rows of any layout."""
    facts = {"mass": 9.0, "com": xyz, "volume": 0.009, "cob": rpy}
    return a5.calibrate.vehicle_tilt(facts | {"xyz": xyz, "rpy": rpy}).vehicle.mount


def _calibration_calls(rows: _TheoryRows) -> list[_Row]:
    """Of plans and readings, (name, call)."""
    c = a5.calibrate
    down = np.array([0.0, 0.5, -9.8])
    q = np.array([[1.0, 1.2, 1.8, 0.5], [0.4, 2.0, 1.1, 3.0]])
    planned = c.plan_poses(c.efforts(), 2)
    triangle = np.array([[0.1, 0.0, -0.1], [-0.1, 0.1, -0.1], [-0.1, -0.1, -0.1]])

    def session(**given: Any) -> Any:
        made = c.session(c.efforts(), **given)
        return [made.q, made.v, made.a, made.gravity, made.readings]

    return [
        ("scales", lambda **g: c.scales(**g).matrix, {"positions": triangle}, {}),
        ("vehicle_tilt", _tilted_mount, {"xyz": down / 50, "rpy": down / 10}, {}),
        (
            "plan_poses",
            lambda **g: c.plan_poses(c.efforts(), 2, **g).q,
            {"gravity": down},
            {},
        ),
        (
            "session",
            session,
            {"q": q, "readings": 2 * q, "v": q + 1, "a": q + 2, "gravity": down},
            {},
        ),
        (
            "with_readings",
            lambda **g: c.with_readings(planned, **g).readings,
            {"readings": 2 * q},
            {},
        ),
    ]


def _control_calls(rows: _TheoryRows) -> list[_Row]:
    """Of gains and sensors with one number for each joint or channel, (name, call)."""
    c, calibrate = a5.control, a5.calibrate
    rotors = np.array([5e-8, 6e-8, 7e-8, 8e-8])
    settings = {"bandwidth": 6.0, "rate": 200.0, "delay": 0.01}
    found = c.gains(**settings, rotor_inertias=rotors)
    q, goal = rows.q[0], rows.q[0] + 0.1
    states = {"q": q, "v": goal, "goal": goal, "v_goal": q}

    def arrays(make: Any) -> Any:
        """What a sensor holds of its arguments."""
        return lambda **given: [
            value for value in vars(make(**given)).values() if np.ndim(value)
        ]

    loop = {"stiffness": rotors + 3, "damping": rotors + 2, "inertia": rotors + 1}
    step = {"start": q, "goal": goal, "current_limit": rotors + 0.5}
    return [
        (
            "gains",
            lambda **g: c.gains(**settings, **g).stiffness,
            {"rotor_inertias": rotors, "q": rows.q[:3]},
            {},
        ),
        ("Gains.torque", found.torque, states, {}),
        ("margins", c.margins, {**loop, "delay": rotors}, {}),
        (
            "step",
            lambda **g: c.step(found, **g, duration=0.5).position,
            {**step, "friction": rotors},
            {},
        ),
        ("efforts", arrays(calibrate.efforts), {"noise": rotors}, {}),
        ("weight", arrays(calibrate.weight), {"gain": rotors[:1]}, {}),
        (
            "force_torque",
            arrays(calibrate.force_torque),
            {"gain": np.arange(1, 7.0)},
            {},
        ),
    ]


def _obstacle_calls(rows: _TheoryRows) -> list[_Row]:
    """Of obstacles and motions, (name, call)."""
    placed = {"xyz": rows.com[0], "rpy": rows.com[1]}
    points = {"vertices": rows.com, "triangles": np.array([[0.0, 1, 2], [1, 2, 3]])}
    obstacle = a5.Obstacle
    ball = obstacle.sphere("o", 0.1).shape
    named = {"name": "o"}
    round_one = {"radius": 0.1, "length": 0.2}
    return [
        (
            "Obstacle.box",
            obstacle.box,
            {"edges": np.abs(rows.com[2]), **placed},
            named,
        ),
        ("Obstacle.cylinder", obstacle.cylinder, placed, named | round_one),
        (
            "Obstacle.sphere",
            obstacle.sphere,
            {"xyz": rows.com[0]},
            {"name": "o", "radius": 0.1},
        ),
        ("Obstacle.mesh", obstacle.mesh, points | placed, named),
        ("Primitive.moved", ball.moved, {"frame": rows.pose}, {}),
        (
            "plan",
            lambda **given: a5.plan(**given).position,
            {
                "q0": np.array(a5.named_pose("home")),
                "target": np.array([0.2, 0.1, 0.1]),
                "speed": np.array([0.1, 0.2, 0.3, 0.4]),
                "acceleration": np.array([0.5, 0.6, 0.7, 0.8]),
            },
            {},
        ),
        (
            "placements",
            lambda **given: a5.placements(**given).pose,
            {
                "targets": np.array([[0.3, 0.0, 0.1], [0.3, 0.05, 0.1]]),
                "mount": np.eye(4),
                "box": np.array([0.02, 0.0, 0.0]),
                "poses": np.array(
                    [[0.05, 0.0, 0.0, 0.0, 0.0, 0.1 * k] for k in range(3)]
                ),
            },
            {},
        ),
    ]


def _water_calls(rows: _TheoryRows) -> list[_Row]:
    """Of strips and vehicles in water, (name, call)."""
    return [
        (
            "DragStrip",
            a5.DragStrip,
            {"start": rows.com[0], "end": rows.com[1]},
            {"diameter": 0.04, "across": 1.0},
        ),
        (
            "Vehicle",
            _vehicle,
            {
                "com": rows.com[0],
                "inertia": rows.tensor[0],
                "cob": rows.com[1],
                "added_mass": np.arange(1.0, 7.0),
                "linear_damping": np.arange(1.0, 7.0),
                "quadratic_damping": np.arange(2.0, 8.0),
                "mount": rows.pose,
            },
            {},
        ),
    ]


def jax_calls() -> list[tuple[str, Call]]:
    """Of `alpha5_model.jax`, one state each, (name, call)."""
    from alpha5_model import jax as jax_arms

    arm = jax_arms.load()
    state = dict(
        zip(("q", "v", "a"), np.random.default_rng(6).normal(size=(3, 4)), strict=True)
    )
    state["tau"] = state["a"]
    calls = []
    for name, method in inspect.getmembers(jax_arms.JaxArm, inspect.isfunction):
        given = {
            p: state[p] for p in inspect.signature(method).parameters if p in state
        }
        if given:
            calls.append((f"JaxArm.{name}", Call(getattr(arm, name), given, {})))
    target = {"position": np.array([0.2, 0.1, 0.1]), "wrist": np.array([0.3])}
    calls.append(
        ("jax.inverse_kinematics", Call(jax_arms.inverse_kinematics, target, {}))
    )
    near = Call(jax_arms.approximate_collision_distance, {"q": state["q"]}, {})
    calls.append(("jax.approximate_collision_distance", near))
    held = Call(lambda **given: arm.with_payload(0.6, **given).parameters, _LOAD, {})
    calls.append(("JaxArm.with_payload", held))
    return calls
