"""``alpha5 torque``: what holds or moves the arm at one state, term by term."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from typer import Option

from alpha5_model.actuators import actuator
from alpha5_model.checks import FloatArray
from alpha5_model.cli.options import (
    Constants,
    Current,
    Fluid,
    Gravity,
    Lines,
    arm_in,
    current_vector,
    show,
)
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.series import torque_terms, water_terms
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.hydrodynamics import LEVELS
from alpha5_model.parameters import parameters
from alpha5_model.view import current_plot, figures

Four = tuple[float, float, float, float]
TERMS = ("inertia", "coriolis", "weight", "buoyancy")


def torque(
    q: Annotated[Four, Option("--q", help="Positions of axis_e, axis_d, axis_c, axis_b (rad).")],
    v: Annotated[Four, Option("--v", help="Velocities (rad/s).")] = (0.0, 0.0, 0.0, 0.0),
    a: Annotated[Four, Option("--a", help="Accelerations (rad/s^2).")] = (0.0, 0.0, 0.0, 0.0),
    degrees: Annotated[bool, Option("--degrees", help="--q, --v, --a in degrees.")] = False,
    fluid: Fluid = "sea",
    gravity: Gravity = "0 0 -9.81",
    current: Current = None,
    constants: Constants = "printed",
    plot: Annotated[
        Path | None,
        Option(
            help="Load on the mount over the direction of a level current as fast as --current, .png, .pdf or .svg."
        ),
    ] = None,
    as_json: Annotated[bool, Option("--json", help="Print JSON.")] = False,
) -> None:
    """Joint torques by cause, motor currents and the load on the mount.

    Examples:
    alpha5 torque --q 3.1 1.2 1.8 0 --v 0 0.2 0 0 --fluid fresh
    alpha5 torque --q 3.1 1.2 1.8 0 --current "0 1 0" --plot polar.png
    """
    check_outputs((), plot=(plot, figures.FORMATS))
    unit = math.pi / 180.0 if degrees else 1.0
    state = [tuple(unit * x for x in values) for values in (q, v, a)]
    arm, flow = arm_in(fluid, gravity), current_vector(current)
    result = _result(arm, constants, flow, *state)
    if plot is not None:
        if not any(flow or ()):
            raise InputError("plot", plot, "a --current that flows, with it")
        page = current_plot.figure(arm, state[0], math.hypot(*(flow or ())))
        figures.write_figure(page, plot, dpi=110)
    show(as_json, result, _text(result), plot)


def _result(arm: Arm, constants: str, current: Any, q: Any, v: Any, a: Any) -> Any:
    """The result as it goes to JSON, SI units."""
    total, terms = arm.inverse_dynamics(q, v, a), torque_terms(arm, q, v, a, threads=1)
    wrench = arm.base_wrench(q, v, a).vector
    water, load = None, {}
    if current is not None:
        water = water_terms(arm, np.array([q]), np.array([v]), np.array([a]), current)
        total, wrench = total + water.torque[0, 1], wrench + water.wrench[0, 1]
        load = {"moving_water": dict(zip(LEVELS, map(_wrench, water.wrench[0]), strict=True))}
    joints = []
    for i, name in enumerate(arm.joint_names):
        motor, limits = actuator(name, constants), parameters().joints[i]
        moving = total[i], v[i]
        span = motor.current_interval(*moving) if v[i] else motor.holding_current(total[i])
        joints.append(
            {
                "joint": name,
                "position": q[i],
                "velocity": v[i],
                "acceleration": a[i],
                **{term: float(getattr(terms, term)[0, i]) for term in TERMS},
                **({} if water is None else _share(water.torque[0, :, i])),
                "torque": float(total[i]),
                "current": float(motor.current(*moving)),
                "current_range": [*map(float, span)],
                "within_limits": limits.lower <= q[i] <= limits.upper,
            }
        )
    return {
        "fluid_density": arm.fluid_density,
        "gravity": arm.model.gravity.linear.tolist(),
        **({} if current is None else {"water_current": list(current)}),
        "constants": constants,
        "joints": joints,
        "mount": {**_wrench(wrench), **load},
    }


def _share(levels: FloatArray) -> dict[str, Any]:
    """Moving water's share of a joint's torque, and its interval, all numbers low to all high."""
    interval = [float(levels.min()), float(levels.max())]
    return {"moving_water": float(levels[1]), "moving_water_range": interval}


def _wrench(vector: FloatArray) -> dict[str, list[float]]:
    return {"force": vector[:3].tolist(), "moment": vector[3:].tolist()}


def _text(result: Any) -> Lines:
    heads = ("inertia", "Coriolis", "weight", "buoyancy", "torque", "current", "range")
    yield _line("", *heads)
    yield _line("", *["N m"] * 5, *["A"] * 2)
    for joint in result["joints"]:
        name = joint["joint"] + ("" if joint["within_limits"] else " *")
        low, high = map(_cell, joint["current_range"])
        cells = (_cell(joint[key]) for key in (*TERMS, "torque", "current"))
        yield _line(name, *cells, f"{low} to {high}")
    mount, water = result["mount"], result.get("water_current")
    force, moment = (f"({', '.join(map(_cell, mount[key]))})" for key in ("force", "moment"))
    density, sum_of = result["fluid_density"], "inertia + Coriolis + weight + buoyancy"
    yield f"\nfluid {density:g} kg/m^3; {sum_of}{' + water' if water else ''} = torque"
    yield "current of a moving joint: with friction and gear loss;"
    yield "                           range: friction's printed tolerance"
    yield "current of a joint at rest: without losses; range: where friction keeps it still"
    yield f"load on the mount at base_link: force {force} N,"
    yield f"                                moment {moment} N m"
    if water:
        yield from _water(result["joints"], mount["moving_water"], water)
    if not all(joint["within_limits"] for joint in result["joints"]):
        yield "* position beyond the joint's limits"


def _water(joints: Any, loads: Any, current: list[float]) -> Lines:
    """What moving water adds, and the interval that its numbers leave."""
    speed = ", ".join(f"{x:g}" for x in current)
    yield f"\nwater: drag and added mass in a current of ({speed}) m/s in base_link;"
    yield "       estimated, not published; range: from all their numbers low to all high"
    yield f"{'':8}{'nominal':>9}{'range':>21}"
    for joint in joints:
        low, high = map(_cell, joint["moving_water_range"])
        yield f"{joint['joint']:8}{_cell(joint['moving_water']):>9}{f'{low} to {high}':>21} N m"
    for part, unit in (("force", "N"), ("moment", "N m")):
        low, nominal, high = (_cell(math.hypot(*loads[level][part])) for level in LEVELS)
        yield f"{part:8}{nominal:>9}{f'{low} to {high}':>21} {unit} on the mount"


def _line(*cells: str) -> str:
    """Name, five torques, current and its range in 80 characters."""
    return "{:8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>19}".format(*cells)


def _cell(x: float) -> str:
    return f"{x:z.4f}" if abs(x) < 1000 else f"{x:.2e}"
