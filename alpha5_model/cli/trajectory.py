"""``alpha5 trajectory``: what a motion asks of the arm."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import Literal

import numpy as np

from alpha5_model import trajectory as library
from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import FREQUENCY, LENGTH, Scalar
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import GRIPPERS, Gripper
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin
from alpha5_model.trajectory.tables import Progress
from alpha5_model.trajectory.time_series import FORMATS
from alpha5_model.viewer import figures
from alpha5_model.viewer.motion_plot import motion_figure

_USE_VELOCITY = {"auto": None, "file": True, "positions": False}

HELP = """
Recorded efforts are compared with the torques. The table (--output) has every
quantity over time. For a planned motion without noise, use --smoothing
interpolate. Velocities are those of the file if it has any (auto), or the
slope of its positions. With --supply-voltage and --current-limit, the answer
says what is left to the motors' limits; with --screw-lead, the current of the
jaw rod. With --arm, limits, motors and mount are those of your arm; options
override them.

Example: alpha5 trajectory recording.csv --output torques.csv --plot page.png
"""


def options(parser: Parser) -> None:
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="CSV with a header, columns in any order: time_secs or time (s), "
        "time_ms; axis_e_pos, axis_d_pos, axis_c_pos, axis_b_pos (rad); optionally "
        "axis_a_pos (jaw rod, m), axis_e_vel, axis_e_effort (N·m) and so on. Or "
        "Parquet (.parquet) with the same columns. Or a ROS bag (.bag, .db3, .mcap or "
        "its folder) with sensor_msgs/JointState",
    )
    common.reading(parser)
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="every quantity over time: .csv or .json",
    )
    common.plot(parser)
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="also print the assumptions behind the figures",
    )
    common.fluid(parser)
    common.gravity(parser)
    common.mount(parser)
    common.payload(parser)
    common.water_velocity(parser)
    parser.add_argument(
        "--gripper",
        default="auto",
        help="auto: jaws (5 joints) if the file has axis_a, else locked (4 joints, "
        "jaws closed). locked leaves axis_a out; jaws needs it",
    )
    parser.add_argument(
        "--smoothing",
        default="spline",
        help="spline, or interpolate (no noise). Default: %(default)s",
    )
    parser.add_argument(
        "--bandwidth",
        type=Scalar(FREQUENCY),
        default=2.0,
        help="-3 dB frequency of the smoothing (Hz). Default: 2",
    )
    parser.add_argument(
        "--velocities",
        default="auto",
        help="file, positions (their slope) or auto. Default: %(default)s",
    )
    common.motors(parser)
    common.drives(parser)
    parser.add_argument(
        "--screw-lead",
        type=Scalar(LENGTH),
        help="screw lead of the jaw rod (m per turn); not published",
    )
    common.arm_file(parser)
    common.as_json(parser)


def run(given: Namespace) -> None:
    # Wrong outputs and choices are refused before the work.
    output, plot = given.output, given.plot
    check_outputs([given.file], output=(output, FORMATS), plot=(plot, figures.FORMATS))
    choice("gripper", given.gripper, ("auto", *GRIPPERS))
    use_velocity = _USE_VELOCITY[
        choice("velocities", given.velocities, tuple(_USE_VELOCITY))
    ]

    own = common.record_of(given)
    with printing.progress_bars() as progress:
        motion = library.read_motion(
            given.file, progress, arm=own, **common.reading_of(given)
        )
        variant = _gripper(given.gripper, motion)
        analysis = library.analyse(
            motion,
            common.arm_of(given, variant, own),
            method=given.smoothing,
            bandwidth=given.bandwidth,
            use_velocity=use_velocity,
            constants=given.constants,
            actuators=_rod_actuator(given, variant, own),
            supply_voltage=given.supply_voltage,
            current_limit=given.current_limit,
            progress=progress,
            water_velocity=given.water_velocity,
            efficiency=given.efficiency,
        )
        margin = _torque_margin(analysis)
        _write(analysis, output, plot, progress)
    record = library.summary(analysis, margin)
    lines = [library.text(analysis, given.verbose, margin)]
    printing.show(given.json, record, lines, output, plot)


def _gripper(
    choice_of_user: Gripper | Literal["auto"], motion: library.Motion
) -> Gripper:
    """The gripper that the user chose; with ``auto`` that of the motion."""
    if choice_of_user != "auto":
        return choice_of_user
    return "jaws" if "axis_a" in motion.joints else "locked"


def _write(
    analysis: library.Analysis,
    output: Path | None,
    plot: Path | None,
    progress: Progress | None,
) -> None:
    """Write the table and the picture that the user asked for."""
    if output is not None:
        library.write(analysis, output, progress)
    if plot is not None:
        figures.write_figure(motion_figure(analysis), plot)


def _rod_actuator(
    given: Namespace, gripper: Gripper, own: Alpha5Parameters | None
) -> Mapping[str, Actuator]:
    """The jaw rod's actuator, if its screw lead is given: that is not published."""
    if given.screw_lead is None:
        return {}
    rod = actuator(
        "axis_a",
        given.constants,
        screw_lead=given.screw_lead,
        efficiency=given.efficiency,
        arm=own,
    )
    if gripper != "jaws":
        expected = "no value: the jaw rod is not part of the motion"
        raise InputError("screw-lead", given.screw_lead, expected)
    return {"axis_a": rod}


def _torque_margin(analysis: library.Analysis) -> FloatArray:
    """Distances of each joint's peak torque to the ends of its interval, (2, n)."""
    smooth = analysis.smooth
    peaks = np.abs(analysis.torque).argmax(axis=0)
    margin = torque_margin(
        analysis.arm,
        smooth.position[peaks],
        smooth.velocity[peaks],
        smooth.acceleration[peaks],
    )
    # Axes: lower and upper end, peak, joint. Each joint has its peak on the diagonal.
    return np.asarray(np.diagonal(margin, axis1=1, axis2=2))
