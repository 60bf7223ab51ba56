"""``alpha5 trajectory``: what a motion asks of the arm."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from typer import Argument, Option

from alpha5_model import trajectory as library
from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.outputs import check_outputs
from alpha5_model.cli import options, printing, values
from alpha5_model.dynamics.actuators import Actuator, actuator
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin
from alpha5_model.trajectory.tables import Progress
from alpha5_model.trajectory.time_series import FORMATS
from alpha5_model.viewer import figures
from alpha5_model.viewer.motion_plot import motion_figure

_USE_VELOCITY = {"auto": None, "file": True, "positions": False}

# The options of this command.
_File = Annotated[Path, Argument(help=options.HELP["file"])]
_Topic = Annotated[
    str | None, Option(help="Topic of the joint states, if a bag has several.")
]
_Prefix = Annotated[
    str | None, Option(help="Prefix of the joints' names, such as left_.")
]
_Map = Annotated[
    str,
    Option(
        "--map",
        help="Names of the joints: axis_e=NAME,axis_d=-NAME (turns the other way) and "
        "so on.",
    ),
]
_Time = Annotated[
    str | None,
    Option("--time", help="Column of the time, NAME or NAME:ms (s, ms, us or ns)."),
]
_Episode = Annotated[
    int | None, Option(help="Episode of a Parquet file that holds several.")
]
_Degrees = Annotated[
    bool, Option("--degrees", help="Angles are in degrees, if columns name no unit.")
]
_Output = Annotated[
    Path | None,
    Option("--output", "-o", help="Every quantity over time: .csv or .json."),
]
_Gripper = Annotated[str, Option(help=options.HELP["gripper"])]
_Smoothing = Annotated[str, Option(help="spline, or interpolate (no noise).")]
_Bandwidth = Annotated[float, Option(help="-3 dB frequency of the smoothing (Hz).")]
_Velocities = Annotated[str, Option(help="file, positions (their slope) or auto.")]
_SupplyVoltage = Annotated[
    float | None, Option(help="Supply voltage of the motors (V); not published.")
]
_CurrentLimit = Annotated[
    float | None, Option(help="Current limit of each motor (A); not published.")
]
_Verbose = Annotated[
    bool,
    Option("--verbose", "-v", help="Also print the assumptions behind the figures."),
]
_ScrewLead = Annotated[
    float | None, Option(help="Screw lead of the jaw rod (m per turn); not published.")
]


def trajectory(
    file: _File,
    topic: _Topic = None,
    prefix: _Prefix = None,
    joints: _Map = "",
    degrees: _Degrees = False,
    time: _Time = None,
    episode: _Episode = None,
    output: _Output = None,
    plot: options.Plot = None,
    verbose: _Verbose = False,
    as_json: options.Json = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    mount: options.Mount = None,
    payload: options.Payload = None,
    current: options.Current = None,
    gripper: _Gripper = "auto",
    smoothing: _Smoothing = "spline",
    bandwidth: _Bandwidth = 2.0,
    velocities: _Velocities = "auto",
    constants: options.Constants = None,
    efficiency: options.Efficiency = "gearbox",
    supply_voltage: _SupplyVoltage = None,
    current_limit: _CurrentLimit = None,
    screw_lead: _ScrewLead = None,
    arm_file: options.Arm = None,
) -> None:
    """Torques by cause, motor currents, power, load on the mount and TCP path of a motion.

    Recorded efforts are compared with the torques. The table (--output) has every
    quantity over time. For a planned motion without noise, use --smoothing
    interpolate. Velocities are those of the file if it has any (auto), or the
    slope of its positions. With --supply-voltage and --current-limit, the answer
    says what is left to the motors' limits; with --screw-lead, the current of the
    jaw rod. With --arm, limits, motors and mount are those of your arm; options
    override them.

    Example: alpha5 trajectory recording.csv --output torques.csv --plot page.png
    """  # noqa: E501 (a line of the help)
    # Wrong outputs and choices are refused before the work.
    check_outputs([file], output=(output, FORMATS), plot=(plot, figures.FORMATS))
    choice("gripper", gripper, ("auto", *GRIPPERS))
    water_current = values.current_vector(current)
    use_velocity = _USE_VELOCITY[choice("velocities", velocities, tuple(_USE_VELOCITY))]

    own = values.arm_record(arm_file)
    with printing.progress_bars() as progress:
        motion = library.read_motion(
            file,
            progress,
            topic=topic,
            prefix=prefix,
            arm=own,
            joints=values.pairs("map", joints.split(","), "="),
            degrees=degrees,
            time=time,
            episode=episode,
        )
        variant = _gripper(gripper, motion)
        analysis = library.analyse(
            motion,
            values.arm_in(fluid, gravity, variant, mount, payload, own),
            method=smoothing,
            bandwidth=bandwidth,
            use_velocity=use_velocity,
            constants=constants,
            actuators=_rod_actuator(variant, screw_lead, constants, efficiency, own),
            supply_voltage=supply_voltage,
            current_limit=current_limit,
            progress=progress,
            current=water_current,
            efficiency=efficiency,
        )
        margin = _torque_margin(analysis)
        _write(analysis, output, plot, progress)
    record = library.summary(analysis, margin)
    lines = [library.text(analysis, verbose, margin)]
    printing.show(as_json, record, lines, output, plot)


def _gripper(choice_of_user: str, motion: library.Motion) -> str:
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
    gripper: str,
    screw_lead: float | None,
    constants: str | None,
    efficiency: str,
    own: Alpha5Parameters | None,
) -> Mapping[str, Actuator]:
    """The jaw rod's actuator, if its screw lead is given: that is not published."""
    if screw_lead is None:
        return {}
    rod = actuator(
        "axis_a", constants, screw_lead=screw_lead, efficiency=efficiency, arm=own
    )
    if gripper != "jaws":
        expected = "no value: the jaw rod is not part of the motion"
        raise InputError("screw-lead", screw_lead, expected)
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
