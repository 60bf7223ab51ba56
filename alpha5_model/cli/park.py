"""``alpha5 park``: where to put the vehicle so that the arm reaches some points."""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.spatial import inverse, moved, pose
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE, LENGTH, Scalar, Vector
from alpha5_model.errors import InputError
from alpha5_model.viewer import figures

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.planning.placement_table import Placements

_TABLE = (".csv",)
_PAGES = (".html", ".htm")
#: Lines of the table that is printed; --output has all of them.
_PRINTED = 10

HELP = """
The world has z up and its origin near the points. Poses of the vehicle's frame
are tried at which base_link is on a grid about the points. --obstacles and
--hull name TOML files as alpha5 move takes them: obstacles in the world, and
the vehicle's hull in base_link, both of boxes, cylinders and spheres.

The table has, for each pose: arm and hull, the distances of the moving links,
and of hull and link_0, from the obstacles; reach, by which each point may be
off; hold, the share of the joints' effort (copied placeholders, if you have no
own) that holds the arm; tilt, the angle to the vehicle's trim. The best pose
has the largest of the three distances, compared in whole centimetres from the
least to the greatest; among equals the least hold, then the least tilt.

Exit status: 0 found, 2 no pose reaches all points and is free.

Example: alpha5 park 0.5 0 0.1 --hull hull.toml --obstacles wall.toml
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "points",
        type=Vector(LENGTH, counts=None),
        metavar="X Y Z",
        help="points of the tcp in the world (m), three numbers for each",
    )
    parser.add_argument(
        "--box",
        type=Vector(LENGTH, LENGTH, LENGTH),
        metavar="DX DY DZ",
        help="reach a box of these edges about each point (m), tried every 25 mm",
    )
    parser.add_argument(
        "--vehicle",
        type=Path,
        metavar="FILE",
        help="TOML with mass, com, volume, cob, xyz, rpy (SI), for the trim",
    )
    parser.add_argument(
        "--xyz",
        type=Vector(LENGTH, LENGTH, LENGTH),
        metavar="X Y Z",
        help="origin of base_link in the vehicle's frame (m), without --vehicle",
    )
    parser.add_argument(
        "--rpy",
        type=Vector(ANGLE, ANGLE, ANGLE),
        metavar="R P Y",
        help="roll, pitch, yaw of base_link in that frame (rad)",
    )
    parser.add_argument(
        "--hull",
        type=Path,
        metavar="FILE",
        help="TOML file with a table for each part of the hull, in base_link",
    )
    parser.add_argument(
        "--obstacles",
        type=Path,
        metavar="FILE",
        help="TOML file with a table for each obstacle, in the world",
    )
    parser.add_argument(
        "--clearance",
        type=Scalar(LENGTH),
        help="distance of arm and hull to obstacles (m). Default: 0.005",
    )
    parser.add_argument(
        "--wrist",
        type=Scalar(ANGLE),
        default=0.0,
        help="theta_3 at the points (rad). Default: 0",
    )
    parser.add_argument(
        "--spacing",
        type=Scalar(LENGTH),
        help="between the places that are tried (m). Default: 0.1",
    )
    parser.add_argument(
        "--yaws",
        type=int,
        help="yaw angles that are tried, evenly over a turn. Default: 12",
    )
    parser.add_argument(
        "--tilts",
        type=Vector(ANGLE, counts=None),
        default=[0.0, 0.0],
        metavar="R P",
        help="roll and pitch that are tried (rad), two numbers for each. Default: 0 0",
    )
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="write all poses, .csv"
    )
    common.plot(parser, "write a map of the poses: .png, .pdf or .svg")
    parser.add_argument(
        "--html",
        type=Path,
        metavar="FILE",
        help="write a page of the arm at the best pose, seen from base_link",
    )
    common.fluid(parser)
    common.payload(parser)
    parser.set_defaults(gravity=[0.0, 0.0, -9.81], mount=None)
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    check_outputs(
        [given.vehicle, given.hull, given.obstacles, given.arm],
        output=(given.output, _TABLE),
        plot=(given.plot, figures.FORMATS),
        html=(given.html, _PAGES),
    )
    own = common.record_of(given)
    arm = common.arm_of(given, "locked", own)

    from alpha5_model.planning.obstacle_file import read_obstacles
    from alpha5_model.planning.parking import placements

    vehicle = None if given.vehicle is None else common.vehicle_tables(given.vehicle)
    hull = () if given.hull is None else read_obstacles(given.hull)
    obstacles = () if given.obstacles is None else read_obstacles(given.obstacles)
    with printing.spinner("trying poses"):
        found = placements(
            _rows("X Y Z", given.points, 3),
            arm=arm,
            vehicle=vehicle,
            mount=_mount(given),
            hull=hull,
            obstacles=obstacles,
            box=given.box,
            wrist=given.wrist,
            tilts=_rows("tilts", given.tilts, 2),
            **common.given_only(
                clearance=given.clearance, spacing=given.spacing, yaws=given.yaws
            ),
        )
    if given.output is not None:
        found.write(given.output)
    if given.plot is not None:
        _draw(found, arm, given.plot)
    if given.html is not None:
        atomic_write(given.html, _page(found, arm))
    written = (given.output, given.plot, given.html)
    frame = "the vehicle's frame"
    if vehicle is None and given.xyz is None and given.rpy is None:
        has_mount = arm.parameters.mount is not None
        frame = "the mount's frame" if has_mount else "base_link"
    printing.show(given.json, _record(found), _text(found, frame), *written)


def _rows(name: str, numbers: list[float], size: int) -> FloatArray:
    """Numbers as rows of a size.

    Raises:
        InputError: They do not fill all rows.
    """
    if len(numbers) % size:
        raise InputError(name, numbers, f"{size} numbers for each")
    return np.reshape(numbers, (-1, size))


def _mount(given: Namespace) -> FloatArray | None:
    """Pose of base_link in the vehicle; None if neither --xyz nor --rpy is given.

    Raises:
        InputError: Given beside --vehicle.
    """
    if given.xyz is None and given.rpy is None:
        return None
    if given.vehicle is not None:
        name = "rpy" if given.xyz is None else "xyz"
        expected = "no value beside --vehicle, whose file has xyz and rpy"
        raise InputError(name, getattr(given, name), expected)
    return pose(given.xyz or [0.0] * 3, given.rpy or [0.0] * 3)


def _draw(found: Placements, arm: Arm, file: Path) -> None:
    from alpha5_model.viewer.placement_plot import placement_figure

    with printing.spinner("drawing"):
        figures.write_figure(placement_figure(found, arm), file)


def _page(found: Placements, arm: Arm) -> str:
    """The arm at the best pose, with its first point, the hull and the obstacles."""
    from alpha5_model.numbers.fluids import gravity_in_base
    from alpha5_model.viewer.build import build_scene
    from alpha5_model.viewer.page import static_page

    base = found.base[0]
    shown = build_scene(
        arm._in_gravity(gravity_in_base(base[:3, :3])),
        found.q[0, 0],
        target=moved(inverse(base), found.points[0]),
        obstacles=found.obstacles(),
    )
    return static_page(shown)


def _record(found: Placements) -> dict[str, Any]:
    return {
        "tried": found.tried,
        "points": found.points,
        "placements": [
            {
                "pose": found.pose[row],
                "base": found.base[row],
                "clearance_m": found.clearance[row],
                "hull_clearance_m": found.hull_clearance[row],
                "reach_margin_m": found.reach_margin[row],
                "holding": found.holding[row],
                "tilt_rad": found.tilt[row],
                "branch": found.branches(row),
                "q": found.q[row],
                "torque": found.torque[row],
            }
            for row in range(len(found))
        ],
    }


def _text(found: Placements, frame: str) -> printing.Lines:
    shown = min(len(found), _PRINTED)
    yield f"{len(found)} of {found.tried} poses of {frame}; the best {shown}"
    rows = [
        ["x", "y", "z", "roll", "pitch", "yaw", "arm", "hull", "reach", "hold", "tilt"],
        [*["m"] * 3, *["deg"] * 3, *["mm"] * 3, "%", "deg"],
    ]
    for row in range(shown):
        place = [f"{x:z.3f}" for x in found.pose[row, :3]]
        angles = [f"{x:z.1f}" for x in np.degrees(found.pose[row, 3:])]
        rows.append(
            [
                *place,
                *angles,
                _fixed(1e3 * found.clearance[row], 0),
                _fixed(1e3 * found.hull_clearance[row], 0),
                _fixed(1e3 * found.reach_margin[row], 0),
                _fixed(100 * found.holding[row], 1),
                _fixed(np.degrees(found.tilt[row]), 1),
            ]
        )
    yield from table(rows, ">")

    yield "\nat the best pose"
    branches = found.branches(0)
    count = min(len(branches), _PRINTED)
    for point in range(count):
        q = ",".join(f"{angle:.6g}" for angle in found.q[0, point])
        yield f"point {point + 1}, {branches[point]}: --q={q}"
    if len(branches) > count:
        yield f"and {len(branches) - count} more points"


def _fixed(value: float, decimals: int) -> str:
    """A number for the table; ``-`` for one that is not finite."""
    return f"{value:.{decimals}f}" if np.isfinite(value) else "-"
