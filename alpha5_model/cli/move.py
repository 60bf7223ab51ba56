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
    LENGTH,
    NUMBER,
    UNITS,
    Scalar,
    Vector,
)
from alpha5_model.description.srdf import named_pose
from alpha5_model.errors import InputError
from alpha5_model.numbers.printed import published

if TYPE_CHECKING:
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.planning.planned_motion import PlannedMotion
    from alpha5_model.planning.replay import Peak

_FORMATS = (".csv",)
_EXPECTED = (
    f"two places, each {', '.join(common.NAMED_POSES)} or 4 angles (rad); "
    "the second also a point, 3 numbers (m)"
)
_POSITION = Vector(ANGLE, ANGLE, ANGLE, ANGLE)
_POINT = Vector(LENGTH, LENGTH, LENGTH)

HELP = """
FROM is stow, home, reach or four joint positions (rad); TO is the same, or
a point x y z of the tcp in base_link (m). The motion (--output) is a file
for alpha5 trajectory and alpha5 view --motion. --obstacles names a TOML file
with a table for each obstacle: its name, then box = edges, cylinder =
radius and length, sphere = radius, or mesh = an STL, OBJ or PLY file, and
xyz and rpy in base_link (m, rad).

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
        "-o", "--output", type=Path, metavar="FILE", help="write the motion, .csv"
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
        default=1.0,
        help="highest acceleration of a joint (rad/s^2). Default: 1",
    )
    parser.add_argument(
        "--margin",
        type=Scalar(LENGTH),
        default=0.005,
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
        help="theta_3 at the target point (rad). Default: as at the start, if free",
    )
    parser.add_argument(
        "--line",
        action="store_true",
        help="move the tcp in a straight line to a point (needs toppra)",
    )
    parser.add_argument(
        "--rate",
        type=Scalar(NUMBER),
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
    check_outputs([given.obstacles, given.arm], output=(given.output, _FORMATS))
    own = common.record_of(given)
    start, target = _places(given.places, own)

    from alpha5_model.planning.obstacle_file import read_obstacles
    from alpha5_model.planning.planner import plan

    motion = plan(
        start,
        target,
        arm=common.arm_of(given, "locked", own),
        obstacles=() if given.obstacles is None else read_obstacles(given.obstacles),
        speed=given.speed,
        acceleration=given.acceleration,
        margin=given.margin,
        self_margin=given.self_margin,
        wrist=given.wrist,
        line=given.line,
        rate=given.rate,
        supply_voltage=given.supply_voltage,
        current_limit=given.current_limit,
    )
    if given.output is not None:
        motion.write(given.output)
    printing.show(given.json, _record(motion), _text(motion), given.output)


def _places(words: list[str], own: Alpha5Parameters | None) -> tuple[Any, Any]:
    """Start and target, from words that are names or numbers with their units."""
    left = " ".join(words).replace(",", " ").split()
    size = 1 if left[:1] and left[0] in common.NAMED_POSES else 4
    # A unit may stand alone after the four numbers.
    size += left[size : size + 1] != [] and left[size] in UNITS
    start, target = left[:size], left[size:]
    is_point = len([word for word in target if word not in UNITS]) == 3
    try:
        return (
            _place(start, _POSITION, own),
            _place(target, _POINT if is_point else _POSITION, own),
        )
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
