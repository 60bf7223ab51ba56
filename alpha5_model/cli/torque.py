"""``alpha5 torque``: what the joints of the arm take at one state."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options, printing, values
from alpha5_model.cli.limits import JOINTS
from alpha5_model.cli.torque_record import Motors, State, torque_record
from alpha5_model.cli.torque_text import torque_lines
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import InputError
from alpha5_model.viewer import figures
from alpha5_model.viewer.mount_plot import mount_load_figure

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm


def torque(
    q: Annotated[
        str, Option("--q", help=f"Positions: {JOINTS} (rad), or stow, home, reach.")
    ],
    v: Annotated[str, Option("--v", help="Velocities (rad/s).")] = "0 0 0 0",
    a: Annotated[str, Option("--a", help="Accelerations (rad/s^2).")] = "0 0 0 0",
    degrees: Annotated[
        bool, Option("--degrees", help="--q, --v and --a are in degrees.")
    ] = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    gripper: options.Gripper = "locked",
    mount: options.Mount = None,
    payload: options.Payload = None,
    current: options.Current = None,
    constants: options.Constants = None,
    efficiency: options.Efficiency = "gearbox",
    plot: Annotated[Path | None, Option(help=options.HELP["plot_current"])] = None,
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> None:
    """Joint torques by cause, motor currents and the load on the mount.

    With --gripper jaws, a fifth number is the position of the jaw rod; without
    it, the jaws are closed and at rest.

    Examples:
    alpha5 torque --q 3.1 1.2 1.8 0 --v 0 0.2 0 0 --fluid fresh
    alpha5 torque --q 180 70 100 0 deg --payload 0.5 --mount 180 0 0 deg
    alpha5 torque --q 3.1 1.2 1.8 0 --current 0 1 0 --plot polar.png
    """
    check_outputs([arm_file], plot=(plot, figures.FORMATS))
    own = values.arm_record(arm_file)
    arm = values.arm_in(fluid, gravity, gripper, mount, payload, own)
    water_current = values.current_vector(current)
    state = State(
        q=_positions(arm, q, degrees),
        v=_rates(arm, "--v", v, "rad/s", degrees),
        a=_rates(arm, "--a", a, "rad/s^2", degrees),
    )

    motors = Motors(constants=constants, efficiency=efficiency)
    record = torque_record(arm, state, motors, water_current)
    if plot is not None:
        _draw_mount_load(arm, state, water_current, plot)
    printing.show(as_json, record, torque_lines(record), plot)


def _positions(arm: Arm, text: str, degrees: bool) -> list[float]:
    """Position of each joint of the arm; the jaws are closed if nothing is said."""
    count = len(arm.joint_names)
    named = text.strip() in NAMED_POSES
    given = f"{text} deg" if degrees and not named else text
    row = values.joint_positions("--q", given, (4, count), arm.parameters)
    closed = arm.limits.lower[len(row) :]
    return row + [float(rod) for rod in closed]


def _rates(arm: Arm, option: str, text: str, unit: str, degrees: bool) -> list[float]:
    """A number for each joint of the arm; 0 for the jaw rod if nothing is said."""
    count = len(arm.joint_names)
    given = f"{text} deg" if degrees else text
    row = values.joint_numbers(option, given, unit, (4, count))
    return row + [0.0] * (count - len(row))


def _draw_mount_load(
    arm: Arm, state: State, current: list[float] | None, plot: Path
) -> None:
    speed = math.hypot(*current) if current else 0.0
    if speed == 0.0:
        raise InputError("plot", plot, "a --current that flows, with it")
    page = mount_load_figure(arm, state.q, speed)
    figures.write_figure(page, plot)
