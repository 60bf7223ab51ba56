"""``alpha5 fk``, ``ik`` and ``torque``: the arm at one state."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Argument, Option

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import check_outputs
from alpha5_model._support.spatial import rpy_from_rotation, wrap
from alpha5_model._support.text import table
from alpha5_model.cli import options
from alpha5_model.dynamics.actuators import actuator
from alpha5_model.errors import InputError, MissingParameterError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.kinematics.plane import arm_plane
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.parameters import parameters
from alpha5_model.viewer import figures

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

TERMS = ("inertia", "coriolis", "weight", "buoyancy")
_JOINTS = "axis_e, axis_d, axis_c, axis_b"


def fk(
    q: Annotated[list[str], Argument(help=f"{_JOINTS} (rad), or also axis_a (m).")],
    as_json: options.Json = False,
) -> None:
    """Where the tcp and the links are at a joint position, in base_link.

    Example: alpha5 fk 180 70 100 0 deg
    """
    position = options.joint_numbers("q", " ".join(q), "rad", (4, 5))
    gripper = "locked" if len(position) == 4 else "jaws"
    arm = options.arm_in("sea", options.DOWN, gripper, "0 0 0", None)
    rows = [
        ["frame", "x", "y", "z", "roll", "pitch", "yaw"],
        ["", *["mm"] * 3, *["deg"] * 3],
    ]
    record: dict[str, Any] = {
        "q": position,
        "beyond_limits": _beyond(arm, position),
        "frames": {},
    }
    for name in (
        f.name for f in arm.model.frames if f.name == "tcp" or f.type.name == "BODY"
    ):
        pose = arm.forward_kinematics(position, name)
        record["frames"][name] = pose.homogeneous
        place = *1e3 * pose.translation, *np.degrees(rpy_from_rotation(pose.rotation))
        rows.append([name, *(f"{x:z.3f}" for x in place)])
    notes = [f"{name} is beyond its limits" for name in record["beyond_limits"]]
    options.show(as_json, record, [*table(rows), *notes])


def _beyond(arm: Arm, q: Sequence[float]) -> list[str]:
    """Joints that a position puts beyond their limits."""
    limits = zip(arm.joint_names, q, arm.limits.lower, arm.limits.upper, strict=True)
    return [name for name, x, lower, upper in limits if not lower <= x <= upper]


def ik(
    x: Annotated[float, Argument(help="tcp in base_link (m).", parser=options.metres)],
    y: Annotated[float, Argument(help="(m)", parser=options.metres)],
    z: Annotated[float, Argument(help="(m)", parser=options.metres)],
    wrist: Annotated[
        float, Option(help="theta_3 (rad).", parser=options.radians)
    ] = 0.0,
    as_json: options.Json = False,
) -> None:
    """All inverse kinematics solutions of a tcp position.

    Exit status: 0 solved, 2 out of reach within the joint limits.

    Example: alpha5 ik 0.25 -0.1 0.05 --wrist 90deg
    """
    solutions = inverse_kinematics([x, y, z], wrist)
    best = solutions.best(arm_plane().middle)
    record: dict[str, Any] = {"position": [x, y, z]}
    record |= {"singular": solutions.singular, "best": best, "branches": []}
    rows = [["branch", *(joint.name for joint in parameters().joints[:4]), "limits"]]
    for i, (name, q) in enumerate(zip(BRANCHES, solutions.q, strict=True)):
        exists, within = solutions.exists[i], solutions.within_limits[i]
        row = {
            "name": name,
            "exists": exists,
            "within_limits": within,
            "q": None,
            "same_as": None,
        }
        angles, said = ["-"] * 4, "out of reach"
        if exists:
            angles, row["q"] = [f"{angle:.6f}" for angle in q], q
            said = "within" if within else "beyond"
            # At singular targets branches meet.
            met = np.abs(wrap(q - solutions.q[:i])).max(axis=-1, initial=0.0) < 1e-6
            if met.any():
                row["same_as"] = BRANCHES[int(met.argmax())]
                said += f", as row {met.argmax() + 1}"
        record["branches"].append(row)
        rows.append([name, *angles, said])
    text = ["joint positions (rad)", *table(rows, "<>>>><")]
    text.append(
        f"nearest to mid-range: --q={','.join(f'{angle:.9g}' for angle in best)}"
    )
    if solutions.singular:
        text.append(
            "The target is singular: on the yaw axis, or the arm is stretched or folded."
        )
    options.show(as_json, record, text)


def torque(
    q: Annotated[str, Option("--q", help=f"Positions: {_JOINTS} (rad).")],
    v: Annotated[str, Option("--v", help="Velocities (rad/s).")] = "0 0 0 0",
    a: Annotated[str, Option("--a", help="Accelerations (rad/s^2).")] = "0 0 0 0",
    degrees: Annotated[
        bool, Option("--degrees", help="--q, --v, --a in degrees.")
    ] = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    gripper: options.Gripper = "locked",
    mount: options.Mount = "0 0 0",
    payload: options.Payload = None,
    current: options.Current = None,
    constants: options.Constants = "printed",
    efficiency: options.Efficiency = "gearbox",
    plot: Annotated[Path | None, Option(help=options.HELP["plot_current"])] = None,
    as_json: options.Json = False,
) -> None:
    """Joint torques by cause, motor currents and the load on the mount.

    With --gripper jaws a fifth number is the jaw rod's; left out, the jaws are
    closed and at rest. Table 4's K_t and K_v of one motor should agree and do
    not: --constants printed takes K_t for torque and K_v for voltage.

    Examples:
    alpha5 torque --q 3.1 1.2 1.8 0 --v 0 0.2 0 0 --fluid fresh
    alpha5 torque --q 180 70 100 0 deg --payload 0.5 --mount 180 0 0 deg
    alpha5 torque --q 3.1 1.2 1.8 0 --current 0 1 0 --plot polar.png
    """
    check_outputs((), plot=(plot, figures.FORMATS))
    arm = options.arm_in(fluid, gravity, gripper, mount, payload)
    flow = options.current_vector(current)
    n = len(arm.joint_names)
    state: list[Any] = []
    for name, text, unit in (
        ("--q", q, "rad"),
        ("--v", v, "rad/s"),
        ("--a", a, "rad/s^2"),
    ):
        row = options.joint_numbers(
            name, f"{text} deg" if degrees else text, unit, (4, n)
        )
        closed = arm.limits.lower[4:].tolist() if name == "--q" else [0.0]
        state.append([*row, *closed] if len(row) < n else row)
    result = _result(arm, constants, efficiency, flow, *state)
    if plot is not None:
        if not (speed := math.hypot(*(flow or ()))):
            raise InputError("plot", plot, "a --current that flows, with it")
        page = figures.mount_load_figure(arm, state[0], speed)
        figures.write_figure(page, plot, dpi=110)
    options.show(as_json, result, _text(result), plot)


def _result(
    arm: Arm, constants: str, efficiency: str, current: Any, q: Any, v: Any, a: Any
) -> Any:
    """The result as it goes to JSON, SI units."""
    from alpha5_model.dynamics.batch import torque_terms, water_terms
    from alpha5_model.studies.uncertainty.effects import torque_margin

    total, terms = arm.inverse_dynamics(q, v, a), torque_terms(arm, q, v, a, threads=1)
    wrench, load = arm.base_wrench(q, v, a).vector, {}
    around = {"fluid_density": arm.fluid_density, "gravity": arm.model.gravity.linear}
    columns = {
        "joint": arm.joint_names,
        "position": q,
        "velocity": v,
        "acceleration": a,
    }
    columns |= {term: getattr(terms, term)[0] for term in TERMS}
    if current is not None:
        water = water_terms(arm, np.array([q]), np.array([v]), np.array([a]), current)
        levels, around["water_current"] = water.torque[0], current
        total, wrench = total + levels[1], wrench + water.wrench[0, 1]
        load = {
            "moving_water": dict(
                zip(LEVELS, map(_wrench, water.wrench[0]), strict=True)
            )
        }
        # All numbers low to all high.
        interval = np.stack([levels.min(axis=0), levels.max(axis=0)], axis=1)
        columns |= {"moving_water": levels[1], "moving_water_range": interval}
    flows: list[Any] = []
    for name, torque, speed in zip(arm.joint_names, total, v, strict=True):
        motor = actuator(name, constants, efficiency=efficiency)
        flows.append((None, None))
        with suppress(
            MissingParameterError
        ):  # the jaw rod's screw lead is not published
            held = (
                motor.current_interval(torque, speed)
                if speed
                else motor.holding_current(torque)
            )
            flows[-1] = motor.current(torque, speed), [*held]
    columns |= {
        "torque": total,
        "torque_range": (total + torque_margin(arm, q, v, a)).T,
    }
    columns |= zip(("current", "current_range"), zip(*flows, strict=True), strict=True)
    beyond = _beyond(arm, q)
    columns["within_limits"] = [name not in beyond for name in arm.joint_names]
    rows = zip(*columns.values(), strict=True)
    joints = [dict(zip(columns, row, strict=True)) for row in rows]
    return {
        **around,
        "constants": constants,
        "efficiency": efficiency,
        "joints": joints,
        "mount": _wrench(wrench) | load,
    }


def _wrench(vector: FloatArray) -> dict[str, Any]:
    return {"force": vector[:3], "moment": vector[3:]}


def _text(result: Any) -> options.Lines:
    joints, water = result["joints"], result.get("water_current")
    rows = [
        ["", "inertia", "Coriolis", "weight", "buoyancy", "torque", "current", "range"]
    ]
    for unit, group in (("N m", joints[:4]), ("N", joints[4:])):
        rows += [["", *[unit] * 5, *["A"] * 2]] if group else []
        for joint in group:
            name = joint["joint"] + ("" if joint["within_limits"] else " *")
            cells = (_cell(joint[key]) for key in (*TERMS, "torque", "current"))
            rows.append([name, *cells, _range(joint["current_range"])])
    yield from table(rows, gap=1)
    mount = result["mount"]
    said = {part: ", ".join(map(_cell, mount[part])) for part in ("force", "moment")}
    said["gravity"] = ", ".join(f"{round(g, 6) + 0.0:g}" for g in result["gravity"])
    said["digits"] = ", ".join(
        _cell(np.ptp(joint["torque_range"]) / 2) for joint in joints[:4]
    )
    said["water"] = " + water" if water else ""
    yield options.WORDS["torque"]["notes"].format(**result | said)
    if water:
        yield from _water(joints, mount["moving_water"], water)
    if len(joints) > 4:
        yield "current of the jaw rod: its screw's lead is not published"
    if not all(joint["within_limits"] for joint in joints):
        yield "* position beyond the joint's limits"


def _water(joints: Any, loads: Any, current: list[float]) -> options.Lines:
    """What moving water adds, and the interval that its numbers leave."""
    speed = ", ".join(f"{x:g}" for x in current)
    yield options.WORDS["torque"]["water"].format(current=speed)
    rows = [["", "nominal", "range", ""]]
    for joint, unit in zip(joints, ("N m",) * 4 + ("N",), strict=False):
        interval = _range(joint["moving_water_range"])
        rows.append([joint["joint"], _cell(joint["moving_water"]), interval, unit])
    for part, unit in (("force", "N"), ("moment", "N m")):
        low, nominal, high = (math.hypot(*loads[level][part]) for level in LEVELS)
        rows.append([part, _cell(nominal), _range((low, high)), f"{unit} on the mount"])
    yield from table(rows, "<>><")


def _range(ends: Sequence[float] | None) -> str:
    return "" if ends is None else " to ".join(map(_cell, ends))


def _cell(x: float | None) -> str:
    return "-" if x is None else f"{x:z.4f}" if abs(x) < 1000 else f"{x:.2e}"
