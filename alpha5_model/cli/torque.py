"""``alpha5 torque``: what the joints of the arm take at one state."""

from __future__ import annotations

import math
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import (
    ACCELERATION,
    ANGULAR_ACCELERATION,
    ANGULAR_SPEED,
    SPEED,
    joints,
)
from alpha5_model.cli.torque_record import State, torque_record
from alpha5_model.cli.torque_text import torque_lines
from alpha5_model.errors import InputError

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

HELP = """
With --gripper jaws, a fifth number is the position of the jaw rod; without
it, the jaws are closed and at rest.

Examples:
alpha5 torque --q 3.1 1.2 1.8 0 --v 0 0.2 0 0 --fluid fresh
alpha5 torque --q 180 70 100 0 deg --payload 0.5 --mount 180 0 0 deg
alpha5 torque --q 3.1 1.2 1.8 0 --water-velocity 0 1 0 --plot polar.png
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "--q",
        required=True,
        type=common.POSITION,
        metavar="Q",
        help=f"positions: {common.JOINTS} (rad), or stow, home, reach",
    )
    parser.add_argument(
        "--v",
        type=joints(ANGULAR_SPEED, SPEED),
        default="0 0 0 0",
        metavar="V",
        help="velocities (rad/s). Default: 0",
    )
    parser.add_argument(
        "--a",
        type=joints(ANGULAR_ACCELERATION, ACCELERATION),
        default="0 0 0 0",
        metavar="A",
        help="accelerations (rad/s^2). Default: 0",
    )
    common.fluid(parser)
    common.gravity(parser)
    common.gripper(parser)
    common.mount(parser)
    common.payload(parser)
    common.water_velocity(parser)
    common.motors(parser)
    common.plot(
        parser,
        "draw the load on the mount for every horizontal direction of the water, at "
        "the speed of --water-velocity: .png, .pdf or .svg",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    if given.plot is not None:
        from alpha5_model.viewer import figures

        check_outputs([given.arm], plot=(given.plot, figures.FORMATS))
    own = common.record_of(given)
    arm = common.arm_of(given, given.gripper, own)
    count = len(arm.joint_names)
    state = State(
        q=common.joint_position(given.q, arm, own),
        v=_rates("v", given.v, count),
        a=_rates("a", given.a, count),
    )

    record = torque_record(
        arm, state, given.constants, given.efficiency, given.water_velocity
    )
    if given.plot is not None:
        _draw_mount_load(arm, state, given.water_velocity, given.plot)
    printing.show(given.json, record, torque_lines(record), given.plot)


def _rates(option: str, numbers: list[float], count: int) -> list[float]:
    """A number for each joint; the jaw rod rests if nothing is said."""
    if len(numbers) > count:
        raise InputError(f"--{option}", numbers, "four numbers, or --gripper jaws")
    return numbers + [0.0] * (count - len(numbers))


def _draw_mount_load(
    arm: Arm, state: State, water_velocity: list[float] | None, plot: Path
) -> None:
    from alpha5_model.viewer import figures
    from alpha5_model.viewer.mount_plot import mount_load_figure

    speed = math.hypot(*water_velocity) if water_velocity else 0.0
    if speed == 0.0:
        raise InputError("plot", str(plot), "a --water-velocity other than 0, with it")
    page: Any = mount_load_figure(arm, state.q, speed)
    figures.write_figure(page, plot)
