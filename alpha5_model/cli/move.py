"""``alpha5 move``: a motion that is free of collision, and its file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Argument, Option

from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options, printing, values
from alpha5_model.description.srdf import NAMED_POSES, named_pose
from alpha5_model.errors import InputError
from alpha5_model.numbers.printed import published

if TYPE_CHECKING:
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.planning.planned_motion import PlannedMotion
    from alpha5_model.planning.replay import Peak

_FORMATS = (".csv",)
_EXPECTED = (
    f"two places, each {', '.join(NAMED_POSES)} or 4 angles (rad); "
    "the second also a point, 3 numbers (m)"
)

# The options of this command.
_Places = Annotated[list[str], Argument(metavar="FROM TO", help=options.HELP["places"])]
_Output = Annotated[
    Path | None, Option("--output", "-o", help="Write the motion, .csv.")
]
_Obstacles = Annotated[Path | None, Option(help=options.HELP["obstacles"])]
_Speed = Annotated[
    float | None,
    Option(
        help="Highest speed of a joint (rad/s). Default: rated.",
        parser=values.angular_speed,
    ),
]
_Acceleration = Annotated[
    float,
    Option(
        help="Highest acceleration of a joint (rad/s^2).",
        parser=values.angular_acceleration,
    ),
]
_Margin = Annotated[
    float, Option(help="Distance to obstacles (m).", parser=values.metres)
]
_SelfMargin = Annotated[
    float, Option(help="Distance between the links (m).", parser=values.metres)
]
_Rate = Annotated[
    float | None, Option(help="Samples per second of the file. Default: 50.")
]
_Wrist = Annotated[
    float | None,
    Option(
        help="theta_3 at the target point (rad). Default: as at the start, if free.",
        parser=values.radians,
    ),
]
_Line = Annotated[
    bool,
    Option("--line", help="Move the tcp in a straight line to a point (needs toppra)."),
]
_SupplyVoltage = Annotated[
    float | None, Option(help="Supply voltage of the motors (V); not published.")
]
_CurrentLimit = Annotated[
    float | None, Option(help="Current limit of each motor (A); not published.")
]


def move(
    places: _Places,
    output: _Output = None,
    obstacles: _Obstacles = None,
    speed: _Speed = None,
    acceleration: _Acceleration = 1.0,
    margin: _Margin = 0.005,
    self_margin: _SelfMargin = 0.0,
    wrist: _Wrist = None,
    line: _Line = False,
    rate: _Rate = None,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    mount: options.Mount = None,
    payload: options.Payload = None,
    supply_voltage: _SupplyVoltage = None,
    current_limit: _CurrentLimit = None,
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> None:
    """Move from one place to another without collision, within all limits.

    FROM is stow, home, reach or four joint positions (rad); TO is the same, or
    a point x y z of the tcp in base_link (m). The motion (--output) is a file
    for alpha5 trajectory and alpha5 view --motion. --obstacles names a TOML file
    with a table for each obstacle: its name, then box = edges, cylinder =
    radius and length, sphere = radius, or mesh = an STL, OBJ or PLY file, and xyz and
    rpy in base_link (m, rad).

    Exit status: 0 found; 2 no path found, or beyond a limit at any speed.

    Example: alpha5 move home 0.2 0.1 0.1 --output planned.csv
    """
    check_outputs([obstacles, arm_file], output=(output, _FORMATS))
    own = values.arm_record(arm_file)
    start, target = _places(places, own)

    from alpha5_model.planning.obstacle_file import read_obstacles
    from alpha5_model.planning.planner import plan

    motion = plan(
        start,
        target,
        arm=values.arm_in(fluid, gravity, "locked", mount, payload, own),
        obstacles=() if obstacles is None else read_obstacles(obstacles),
        speed=speed,
        acceleration=acceleration,
        margin=margin,
        self_margin=self_margin,
        wrist=wrist,
        line=line,
        rate=rate,
        supply_voltage=supply_voltage,
        current_limit=current_limit,
    )
    if output is not None:
        motion.write(output)
    printing.show(as_json, _record(motion), _text(motion), output)


def _places(words: list[str], own: Alpha5Parameters | None) -> tuple[Any, Any]:
    """Start and target from words: names or numbers."""
    left = list(words)
    start = _place(left, 4, own)
    target = _place(left, 3 if len(left) == 3 else 4, own)
    if start is None or target is None or left:
        raise InputError("FROM TO", " ".join(words), _EXPECTED)
    return start, target


def _place(left: list[str], count: int, own: Alpha5Parameters | None) -> Any:
    """The place that the words start with; they are removed. None if there is none."""
    if left and left[0] in NAMED_POSES:
        return named_pose(left.pop(0), own)
    taken = [left.pop(0) for _ in range(min(count, len(left)))]
    if len(taken) < count:
        return None
    name, unit = ("TO", "m") if count == 3 else ("joint positions", "rad")
    return values.numbers(name, " ".join(taken), (count,), unit)


def _record(motion: PlannedMotion) -> dict[str, Any]:
    return {
        "duration_s": motion.duration,
        "samples": motion.time.size,
        "kind": motion.kind,
        "branch": motion.branch,
        "way": motion.way,
        "slowed": motion.slowed,
        "fluid_density": motion.analysis.arm.fluid_density,
        "payload_kg": motion.analysis.arm.payload_mass,
        "peaks": [
            {
                "joint": peak.joint,
                "quantity": peak.quantity,
                "value": peak.value,
                "limit": peak.limit,
                "unit": peak.unit,
            }
            for peak in motion.peaks
        ],
        "tcp": motion.analysis.tcp[[0, -1]],
        "obstacles": motion.obstacles,
        "clearance": _clearance(motion),
    }


def _clearance(motion: PlannedMotion) -> dict[str, Any] | None:
    """The least distance to an obstacle; None without obstacles."""
    least = motion.clearance
    if least is None:
        return None
    return {
        "distance_m": least.distance,
        "obstacle": least.obstacle,
        "link": least.link,
        "time_s": motion.time[least.sample],
    }


def _text(motion: PlannedMotion) -> printing.Lines:
    branch = f", to the branch {motion.branch}" if motion.branch else ""
    yield f"{motion.kind}{branch}: {motion.duration:.2f} s"
    arm = motion.analysis.arm
    yield f"fluid: {arm.fluid_density:g} kg/m^3"
    yield printing.payload(arm.payload_mass)
    if motion.slowed > 1.0:
        yield f"{motion.slowed:.2f} times as long for the limits of the motors"

    least = motion.clearance
    if least is not None:
        yield f"obstacles: {', '.join(motion.obstacles)}"
        yield (
            f"nearest: {least.link} and {least.obstacle}, "
            f"{least.distance * 1e3:.1f} mm at {motion.time[least.sample]:.2f} s"
        )

    names = motion.motion.joints
    yield "\nway (rad)"
    rows = [["", *names]]
    for number, q in enumerate(motion.way):
        rows.append([str(number), *(f"{angle:.4f}" for angle in q)])
    yield from table(rows, "<>>>>")

    yield "\npeaks, and their limits"
    rows = [["", *names]]
    for quantity, unit in _quantities(motion).items():
        found = [peak for peak in motion.peaks if peak.quantity == quantity]
        rows.append([f"{quantity} ({unit})", *(f"{p.value:.3g}" for p in found)])
        if np.isfinite([peak.limit for peak in found]).any():
            limits = ["-" if np.isnan(p.limit) else f"{p.limit:.3g}" for p in found]
            rows.append([f"  {_kind_of_limit(found)}", *limits])
    yield from table(rows, "<>>>>")


def _kind_of_limit(found: Sequence[Peak]) -> str:
    """``placeholder`` for the torques that public models copy, else ``limit``."""
    copied = set()
    for row in published().supplementary.joints:
        if row.effort.status == "placeholder":
            copied.add((row.name, "torque", row.effort.quantity.si))
    shown = {(peak.joint, peak.quantity, peak.limit) for peak in found}
    return "placeholder" if shown <= copied else "limit"


def _quantities(motion: PlannedMotion) -> dict[str, str]:
    """Unit of each quantity."""
    return {peak.quantity: peak.unit for peak in motion.peaks}
