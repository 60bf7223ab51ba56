"""``alpha5 gains``: gains of a first controller, and a simulated step as the proof."""

from __future__ import annotations

import math
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write, atomic_write_all
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import (
    ANGLE,
    ANGULAR_FREQUENCY,
    CURRENT,
    FREQUENCY,
    MASS,
    NUMBER,
    TIME,
    Scalar,
    Vector,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY

if TYPE_CHECKING:
    from alpha5_model._support.checks import BoolArray
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.studies.control import Gains, Step

_FOUR_OR_ONE = (1, 4)
#: Numbers that are 0 but for rounding.
_ROUNDING = 1e-12

HELP = """
The controller of each joint: torque = K (goal - q) + D (goal rate - v), plus
the torque that holds weight and buoyancy (and friction, if it was measured).
K and D act at the joints; in motor current, they are divided by the torque
per ampere. Rotor inertia and current limit are not published. With a current
limit, a step from home to reach is simulated.

Exit status: 0 found; 1 a simulated step does not hold, or would take too long;
2 the delay does not permit this bandwidth.

Example: alpha5 gains --bandwidth 8 --rate 200 --delay 0.01 --rotor-inertia 5e-8
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "--bandwidth",
        type=Scalar(ANGULAR_FREQUENCY),
        metavar="W",
        help="of each joint (rad/s)",
    )
    parser.add_argument(
        "--settling-time",
        type=Scalar(TIME),
        metavar="T",
        help="to 2 %% of a step (s), instead of --bandwidth",
    )
    parser.add_argument(
        "--rate", type=Scalar(FREQUENCY), required=True, help="samples per second (Hz)"
    )
    parser.add_argument(
        "--delay",
        type=Scalar(TIME),
        required=True,
        help="from measuring a position to the change of the torque (s)",
    )
    parser.add_argument(
        "--quantisation",
        type=Scalar(ANGLE),
        default=0.0,
        help="step of the measured positions (rad). Default: 0",
    )
    parser.add_argument(
        "--payload",
        type=Scalar(MASS),
        default=0.0,
        help="heaviest mass that the tcp carries (kg). Default: 0",
    )
    parser.add_argument(
        "--rotor-inertia",
        type=Vector(NUMBER, NUMBER, NUMBER, NUMBER, counts=_FOUR_OR_ONE),
        metavar="J",
        help="at the motor shafts, one or 4 (kg m^2). Default: those of --arm",
    )
    parser.add_argument(
        "--current-limit",
        type=Vector(CURRENT, CURRENT, CURRENT, CURRENT, counts=_FOUR_OR_ONE),
        metavar="I",
        help="of the motors, one or 4 (A). Default: those of --arm",
    )
    parser.add_argument(
        "--friction",
        type=Vector(NUMBER, NUMBER, NUMBER, NUMBER, counts=_FOUR_OR_ONE),
        metavar="F",
        help="true friction at the joints in the simulation, one or 4 (N m). "
        "Default: Table 4's, or that of --arm",
    )
    parser.add_argument(
        "--tolerance",
        type=Scalar(ANGLE),
        help="error that a joint may keep in the simulation (rad). Default: 0.05",
    )
    parser.add_argument(
        "--ros2-control",
        type=Path,
        metavar="FILE",
        help="write a joint trajectory controller with these gains, .yaml",
    )
    parser.add_argument(
        "--mjcf",
        type=Path,
        metavar="FOLDER",
        help="write the MuJoCo model with these gains in its servos",
    )
    common.fluid(parser)
    common.gravity(parser, default=None)
    common.mount(parser)
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> int:
    check_outputs([given.arm], ros2_control=(given.ros2_control, (".yaml", ".yml")))
    for option in ("mount", "gravity"):
        if given.mjcf is not None and getattr(given, option) is not None:
            expected = "no --mjcf with it; [mount] of an arm file is written"
            raise InputError(option, getattr(given, option), expected)
    if given.gravity is None:
        given.gravity = list(GRAVITY)
    own = common.record_of(given)
    arm = common.arm_of(given, "locked", own, payload=False)

    from alpha5_model.description.srdf import named_pose
    from alpha5_model.studies import control

    found = control.gains(
        given.bandwidth,
        settling_time=given.settling_time,
        rate=given.rate,
        delay=given.delay,
        quantisation=given.quantisation,
        payload=given.payload,
        rotor_inertias=_one_or_four(given.rotor_inertia),
        arm=arm,
    )
    limit = _one_or_four(given.current_limit)
    if limit is None:
        limit = _limits_of(own)
    home, reach = named_pose("home", own), named_pose("reach", own)
    steps = {}
    skipped = ""
    if limit is None:
        for option in ("friction", "tolerance"):
            if getattr(given, option) is not None:
                expected = "a --current-limit with it"
                raise InputError(option, getattr(given, option), expected)
    else:
        arms = {"no payload": arm}
        if given.payload:
            arms[f"{given.payload:g} kg"] = arm.with_payload(given.payload)
        for words, true_arm in arms.items():
            try:
                steps[words] = control.step(
                    found,
                    home,
                    reach,
                    current_limit=limit,
                    friction=_one_or_four(given.friction),
                    arm=true_arm,
                    **common.given_only(tolerance=given.tolerance),
                )
            except InputError as error:
                if error.name != "duration":
                    raise
                skipped = f"no step is simulated, {error}"
                break

    if given.ros2_control is not None:
        atomic_write(given.ros2_control, control.ros2_control(found))
    if given.mjcf is not None:
        files = control.mujoco_files(found)
        atomic_write_all({given.mjcf / name: data for name, data in files.items()})
    printing.show(
        given.json,
        _record(found, steps, skipped),
        _text(found, steps, reach != home, skipped),
        given.ros2_control,
        given.mjcf,
    )
    holds = all(step.holds for step in steps.values())
    return 0 if holds and not skipped else 1


def _one_or_four(numbers: list[float] | None) -> Any:
    """One number for all joints, or those of each."""
    return numbers[0] if numbers is not None and len(numbers) == 1 else numbers


def _limits_of(own: Alpha5Parameters | None) -> list[float] | None:
    """Current limits of an arm's record; None if one is not known."""
    limits = [None] if own is None else own.motors.current_limits[:4]
    known = [limit for limit in limits if limit is not None]
    return known if len(known) == len(limits) else None


def _record(found: Gains, steps: dict[str, Step], skipped: str) -> dict[str, Any]:
    """The result for scripts, in SI units."""
    return {
        "joints": found.arm.joint_names,
        "bandwidth": found.bandwidth,
        "settling_time": found.settling_time,
        "fastest": found.fastest,
        "stiffness": found.stiffness,
        "damping": found.damping,
        "friction": found.friction,
        "torque_per_ampere": found.torque_per_ampere,
        "stiffness_of_current": found.stiffness / found.torque_per_ampere,
        "damping_of_current": found.damping / found.torque_per_ampere,
        "inertia": found.inertia,
        "armature": found.armature,
        "ratio": found.ratio,
        "ratio_of_digits": found.ratio_of_digits,
        "least_ratio": found.least_ratio,
        "margins": found.margins,
        "dead_band": found.dead_band,
        "sag": found.sag,
        "ripple": found.ripple,
        "steps": {
            words: {
                "holds": step.holds,
                "settled": step.settled,
                "error": step.error,
                "tolerance": step.tolerance,
                "overshoot": step.overshoot,
                "limited": step.limited,
                "dead_band": step.dead_band,
            }
            for words, step in steps.items()
        },
        "skipped": skipped or None,
    }


def _text(
    found: Gains, steps: dict[str, Step], moves: BoolArray, skipped: str
) -> list[str]:
    """The result for people.

    Args:
        found: The gains.
        steps: Words for an arm -> its step.
        moves: Which joints the steps move.
        skipped: Why a step is not simulated; empty if none was left out.
    """
    from alpha5_model.studies.control.pd_gains import three_digits

    m = found.margins
    # That of a step is by the friction that was asked for.
    dead_band = next(iter(steps.values()), found).dead_band
    lines = [
        f"bandwidth {found.bandwidth:.4g} rad/s, settled to 2 % in "
        f"{found.settling_time:.3g} s; the delay permits "
        f"{three_digits(found.fastest)} rad/s",
        f"left at the worst pose, payload and digits: {math.degrees(m.phase):.0f} deg "
        f"of phase, {1e3 * m.delay:.0f} ms of delay, a factor of {m.gain:.2g} of the "
        "gains",
        "",
        *_by_joint(
            found,
            {
                "K [N m/rad]": found.stiffness,
                "D [N m s/rad]": found.damping,
                "K [A/rad]": found.stiffness / found.torque_per_ampere,
                "D [A s/rad]": found.damping / found.torque_per_ampere,
            },
        ),
        "",
        *_by_joint(
            found,
            {
                "inertia [kg m^2]": found.inertia,
                "of rotor": found.armature,
                "dead band [rad]": dead_band,
                "sag [rad]": found.sag,
                "a count [A]": found.ripple,
            },
        ),
    ]
    if not found.friction.any():
        lines += [
            "",
            "The dead band is that of the arm's friction, Table 4's unless --friction "
            "or --arm has another. Friction that was measured (alpha5 calibrate "
            "motors) is compensated while the goal moves.",
        ]
    for words, step in steps.items():
        verdict = "passed" if step.holds else "failed"
        lines += [
            "",
            f"{verdict} the simulated step from home to reach, {words}: errors up to "
            f"{step.tolerance:g} rad are allowed",
            *_by_joint(
                found,
                {
                    "moves": moves,
                    "settled [s]": step.settled,
                    "error [rad]": step.error,
                    "overshoot [rad]": step.overshoot,
                    "at limit [%]": 100 * step.limited,
                },
            ),
            *_held_by_friction(found, step),
        ]
    return [*lines, "", skipped] if skipped else lines


def _held_by_friction(found: Gains, step: Step) -> list[str]:
    """What helps a step in which friction alone can hold a joint off its goal."""
    off = np.where(np.isnan(step.settled), step.dead_band, 0.0)
    worst = int(off.argmax())
    held = float(off[worst])
    if held <= step.tolerance:
        return []
    # The stiffness grows with the square of the bandwidth.
    enough = found.bandwidth * math.sqrt(held / step.tolerance)
    remedy = "a larger --tolerance"
    if enough <= found.fastest:
        remedy = f"at least {enough:.3g} rad/s, or {remedy}"
    joint = found.arm.joint_names[worst]
    return ["", f"Friction can hold {joint} {held:.2g} rad off: ask for {remedy}."]


def _by_joint(found: Gains, columns: dict[str, Any]) -> list[str]:
    """A table with a row for each joint."""
    rows = [["joint", *columns]]
    for k, joint in enumerate(found.arm.joint_names):
        rows.append([joint, *(_number(column[k]) for column in columns.values())])
    return table(rows)


def _number(value: float) -> str:
    if isinstance(value, np.bool_):
        return "yes" if value else "no"
    if math.isnan(value):
        return "never"
    return f"{value:.3g}" if abs(value) > _ROUNDING else "0"
