"""``alpha5 torque``: what holds or moves the arm at one state, term by term."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from alpha5_model.actuators import actuator
from alpha5_model.cli.options import (
    Constants,
    Fluid,
    Gravity,
    fluid_density,
    gravity_vector,
    print_json,
)
from alpha5_model.dynamics.loading import load
from alpha5_model.dynamics.series import torque_terms
from alpha5_model.parameters import parameters

Four = tuple[float, float, float, float]
TERMS = ("inertia", "coriolis", "weight", "buoyancy")


def torque(
    q: Annotated[
        Four, typer.Option("--q", help="Positions of axis_e, axis_d, axis_c, axis_b (rad).")
    ],
    v: Annotated[Four, typer.Option("--v", help="Velocities (rad/s).")] = (0.0, 0.0, 0.0, 0.0),
    a: Annotated[Four, typer.Option("--a", help="Accelerations (rad/s^2).")] = (0.0, 0.0, 0.0, 0.0),
    degrees: Annotated[bool, typer.Option("--degrees", help="--q, --v, --a in degrees.")] = False,
    fluid: Fluid = "sea",
    gravity: Gravity = "0 0 -9.81",
    constants: Constants = "printed",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Joint torques by cause, motor currents and the load on the mount.

    Example: alpha5 torque --q 3.1 1.2 1.8 0 --v 0 0.2 0 0 --fluid fresh
    """
    unit = math.pi / 180.0 if degrees else 1.0
    position, velocity, acceleration = (tuple(unit * x for x in values) for values in (q, v, a))
    density, g = fluid_density(fluid), gravity_vector(gravity)
    result = _compute(position, velocity, acceleration, density, g, constants)
    if as_json:
        print_json(result)
    else:
        _show(result)


def _compute(q: Any, v: Any, a: Any, density: float, gravity: Any, constants: str) -> Any:
    """The result as it goes to JSON, SI units."""
    arm = load(density, gravity=gravity)
    total = arm.inverse_dynamics(q, v, a)
    terms = torque_terms(arm, q, v, a, threads=1)
    joints = []
    for i, name in enumerate(arm.joint_names):
        motor, limits = actuator(name, constants), parameters().joints[i]
        if v[i]:
            current, span = motor.current(total[i], v[i]), motor.current_interval(total[i], v[i])
        else:
            current, span = motor.current(total[i]), motor.holding_current(total[i])
        joints.append(
            {
                "joint": name,
                "position": q[i],
                "velocity": v[i],
                "acceleration": a[i],
                **{term: float(getattr(terms, term)[0, i]) for term in TERMS},
                "torque": float(total[i]),
                "current": float(current),
                "current_range": [float(span.lower), float(span.upper)],
                "within_limits": limits.lower <= q[i] <= limits.upper,
            }
        )
    wrench = arm.base_wrench(q, v, a)
    return {
        "fluid_density": density,
        "gravity": list(gravity),
        "constants": constants,
        "joints": joints,
        "mount": {"force": wrench.linear.tolist(), "moment": wrench.angular.tolist()},
    }


def _show(result: Any) -> None:
    heads = ("inertia", "Coriolis", "weight", "buoyancy", "torque", "current", "range")
    lines = [_line("", heads), _line("", ["N m"] * 5 + ["A"] * 2)]
    for joint in result["joints"]:
        name = joint["joint"] + ("" if joint["within_limits"] else " *")
        numbers = [*(joint[key] for key in (*TERMS, "torque", "current")), *joint["current_range"]]
        *cells, low, high = map(_cell, numbers)
        lines.append(_line(name, [*cells, f"{low} to {high}"]))
    force, moment = (
        f"({', '.join(map(_cell, result['mount'][key]))})" for key in ("force", "moment")
    )
    lines += [
        "",
        f"fluid {result['fluid_density']:g} kg/m^3; inertia + Coriolis + weight + buoyancy = torque",
        "current of a moving joint: with friction and gear loss;",
        "                           range: friction's printed tolerance",
        "current of a joint at rest: without losses; range: where friction keeps it still",
        f"load on the mount at base_link: force {force} N,",
        f"                                moment {moment} N m",
    ]
    if not all(joint["within_limits"] for joint in result["joints"]):
        lines.append("* position beyond the joint's limits")
    typer.echo("\n".join(lines))


def _line(name: str, cells: Sequence[str]) -> str:
    """Name, five torques, current and its range in 80 characters."""
    return "{:8}{:>9}{:>9}{:>9}{:>9}{:>9}{:>8}{:>19}".format(name, *cells)


def _cell(x: float) -> str:
    return f"{x:z.4f}" if abs(x) < 1000 else f"{x:.2e}"
