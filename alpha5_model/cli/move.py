"""``alpha5 move``: a motion that is free of collision, and its file."""

from __future__ import annotations

from argparse import ArgumentTypeError, Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import (
    ANGLE,
    ANGULAR_ACCELERATION,
    ANGULAR_SPEED,
    FREQUENCY,
    LENGTH,
    UNITS,
    Scalar,
    Vector,
)
from alpha5_model.description.srdf import named_pose
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import DEFAULT_ACCELERATION
from alpha5_model.numbers.printed import published

if TYPE_CHECKING:
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.planning.planned_motion import PlannedMotion
    from alpha5_model.planning.replay import Peak

_FORMATS = (".csv", ".json", ".yaml")
_BUS_FORMATS = (".csv",)
_EXPECTED = (
    f"two places, each {', '.join(common.NAMED_POSES)} or 4 angles (rad); "
    "the second also a point, 3 numbers (m), or none with --through"
)
#: An orientation that is off by more is said to be [rad].
_TURNED = 1e-3
_POSITION = Vector(ANGLE, ANGLE, ANGLE, ANGLE)
_POINT = Vector(LENGTH, LENGTH, LENGTH)

HELP = """
FROM is stow, home, reach or four joint positions (rad); TO is the same, or
a point x y z of the tcp in base_link (m). The motion (--output) is a .csv
file for alpha5 trajectory and alpha5 view --motion, or a JointTrajectory of
ROS as .json or .yaml.

--through names a file of waypoints, at each of which the arm rests, or which
it passes within --blend without a stop: a table with the columns axis_e to
axis_b (rad, or axis_e [deg]), or x, y, z of the tcp (m, or x [mm]), perhaps
with roll, pitch, yaw or qx, qy, qz, qw; or a JointTrajectory, whose times are
not used. Its last one is TO, if no other is given.

--obstacles names a TOML file with a table for each obstacle: its name, then
box = edges, cylinder = radius and length, sphere = radius, or mesh = an STL,
OBJ or PLY file, and xyz and rpy in base_link (m, rad).

Exit status: 0 found; 2 no path found, or beyond a limit at any speed.

Example: alpha5 move home 0.2 0.1 0.1 --output planned.csv
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "places",
        nargs="+",
        metavar="FROM TO",
        help="stow, home, reach or 4 joint positions (rad); TO also x y z (m)",
    )
    parser.add_argument(
        "--through",
        type=Path,
        metavar="FILE",
        help="waypoints: a table, or a JointTrajectory as .json or .yaml",
    )
    parser.add_argument(
        "--blend",
        type=Scalar(LENGTH),
        default=0.0,
        help="pass waypoints and corners within this distance (m). Default: 0, a stop",
    )
    common.names_in_file(parser)
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="write the motion, .csv, .json or .yaml",
    )
    parser.add_argument(
        "--bus",
        type=Path,
        metavar="FILE",
        help="write what the devices on the arm's bus are told, .csv",
    )
    parser.add_argument(
        "--obstacles",
        type=Path,
        metavar="FILE",
        help="TOML file with a table for each obstacle in base_link",
    )
    parser.add_argument(
        "--speed",
        type=Scalar(ANGULAR_SPEED),
        help="highest speed of a joint (rad/s). Default: rated",
    )
    parser.add_argument(
        "--acceleration",
        type=Scalar(ANGULAR_ACCELERATION),
        default=DEFAULT_ACCELERATION,
        help="highest acceleration of a joint (rad/s^2). Default: %(default)g",
    )
    parser.add_argument(
        "--margin",
        type=Scalar(LENGTH),
        help="distance to obstacles (m). Default: 0.005",
    )
    parser.add_argument(
        "--self-margin",
        type=Scalar(LENGTH),
        default=0.0,
        help="distance between the links (m). Default: 0",
    )
    parser.add_argument(
        "--wrist",
        type=Scalar(ANGLE),
        help="theta_3 at target points (rad). Default: as before, if free",
    )
    parser.add_argument(
        "--line",
        action="store_true",
        help="move the tcp in a straight line to a point (needs toppra)",
    )
    parser.add_argument(
        "--rate",
        type=Scalar(FREQUENCY),
        help="samples per second of the file. Default: 50",
    )
    common.fluid(parser)
    common.gravity(parser)
    common.mount(parser)
    common.payload(parser)
    common.drives(parser)
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    check_outputs(
        [given.obstacles, given.through, given.arm],
        output=(given.output, _FORMATS),
        bus=(given.bus, _BUS_FORMATS),
    )
    for name in ("prefix", "map", "degrees"):
        if getattr(given, name) and given.through is None:
            expected = "no value without --through, whose file it is about"
            raise InputError(name, getattr(given, name), expected)
    own = common.record_of(given)
    start, targets = _places(given.places, own, given.through is not None)

    from alpha5_model.planning.obstacle_file import read_obstacles
    from alpha5_model.planning.planner import plan
    from alpha5_model.planning.waypoints import read_waypoints

    if given.through is not None:
        names = common.names_of(given)
        targets = [*read_waypoints(given.through, arm=own, **names), *targets]
    arm = common.arm_of(given, "locked", own)
    obstacles = () if given.obstacles is None else read_obstacles(given.obstacles)
    with printing.spinner("planning"):
        motion = plan(
            start,
            targets[-1],
            through=targets[:-1],
            arm=arm,
            obstacles=obstacles,
            speed=given.speed,
            acceleration=given.acceleration,
            self_margin=given.self_margin,
            blend=given.blend,
            wrist=given.wrist,
            line=given.line,
            rate=given.rate,
            supply_voltage=given.supply_voltage,
            current_limit=given.current_limit,
            **common.given_only(margin=given.margin),
        )
    if given.output is not None:
        motion.write(given.output)
    if given.bus is not None:
        motion.write_bus(given.bus)
    text = _text(motion)
    printing.show(given.json, _record(motion), text, given.output, given.bus)


def _places(
    words: list[str], own: Alpha5Parameters | None, may_end: bool
) -> tuple[Any, list[Any]]:
    """Start and target, from words that are names or numbers with their units.

    Args:
        words: The start, then the target.
        own: Record of the arm; None for the catalogue's.
        may_end: Whether the target may be left out.
    """
    left = " ".join(words).replace(",", " ").split()
    size = 1 if left[:1] and left[0] in common.NAMED_POSES else 4
    # A unit may stand alone after the four numbers.
    size += left[size : size + 1] != [] and left[size] in UNITS
    start, target = left[:size], left[size:]
    is_point = len([word for word in target if word not in UNITS]) == 3
    try:
        first = _place(start, _POSITION, own)
        if may_end and not target:
            return first, []
        return first, [_place(target, _POINT if is_point else _POSITION, own)]
    except ArgumentTypeError:
        raise InputError("FROM TO", " ".join(words), _EXPECTED) from None


def _place(words: list[str], kind: Vector, own: Alpha5Parameters | None) -> Any:
    """A point, or the joint positions of a pose."""
    (name,) = words if len(words) == 1 else ("",)
    if name in common.NAMED_POSES:
        return named_pose(name, own)
    return kind(" ".join(words))


def _record(motion: PlannedMotion) -> dict[str, Any]:
    return {
        "duration_s": motion.duration,
        "samples": motion.time.size,
        "kind": motion.kind,
        "branch": motion.branch,
        "stops": motion.stops,
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
    yield f"obstacles: {', '.join(motion.obstacles) or 'none'}"
    if motion.slowed > 1.0:
        yield f"{motion.slowed:.2f} times as long for the limits of the motors"

    least = motion.clearance
    if least is not None:
        yield (
            f"nearest: {least.link} and {least.obstacle}, "
            f"{least.distance * 1e3:.1f} mm at {motion.time[least.sample]:.2f} s"
        )

    names = motion.motion.joints
    yield from _stops(motion)
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


def _stops(motion: PlannedMotion) -> printing.Lines:
    """When the arm is at each target, and by how much it misses an orientation."""
    if len(motion.stops) > 1:
        yield "\ntargets (s, rad, mm)"
        rows = [["", "at", *motion.motion.joints, "passed by"]]
        for stop in motion.stops:
            angles = (f"{angle:.4f}" for angle in stop.q)
            away = f"{stop.away * 1e3:.1f}" if stop.away else "-"
            rows.append([stop.place, f"{stop.time:.2f}", *angles, away])
        yield from table(rows, "<>>>>>>")
    for stop in motion.stops:
        if stop.rotation_error > _TURNED:
            yield (
                f"{stop.place}: turned by {stop.rotation_error:.3g} rad from the pose; "
                "four joints reach its point, but not every orientation"
            )


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
