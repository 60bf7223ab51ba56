"""``alpha5 trajectory``: what a recorded or planned joint motion asks of the arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import numpy as np
from rich.console import Console
from rich.progress import Progress
from typer import Argument, Option

from alpha5_model import trajectory as library
from alpha5_model.actuators import actuator
from alpha5_model.checks import choice
from alpha5_model.cli import options
from alpha5_model.errors import InputError
from alpha5_model.files import check_outputs
from alpha5_model.jaws import GRIPPERS
from alpha5_model.trajectory.report import FORMATS
from alpha5_model.uncertainty.effects import torque_margin
from alpha5_model.view import figures, trajectory_plot

_FILE = (
    "CSV with a header, columns in any order: time_secs or time (s), time_ms; axis_e_pos, axis_d_pos, "
    "axis_c_pos, axis_b_pos (rad), if recorded axis_a_pos (jaw rod, m); axis_e_vel, axis_e_effort (N·m) "
    "and so on if recorded. Parquet (.parquet) with the same columns. A ROS bag (.bag, .db3, .mcap or "
    "its folder) with sensor_msgs/JointState."
)
_GRIPPER = (
    "auto: jaws (5 joints) if the file has axis_a, else locked (4 joints, jaws closed). "
    "locked leaves axis_a out; jaws needs it."
)
_USE_VELOCITY = {"auto": None, "file": True, "positions": False}


def trajectory(
    file: Annotated[Path, Argument(help=_FILE)],
    topic: Annotated[str | None, Option(help="Of a bag with several arms.")] = None,
    prefix: Annotated[str | None, Option(help="Before the joints' names: left_.")] = None,
    output: Annotated[Path | None, Option("--output", "-o", help="Table, .csv or .json.")] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    mount: options.Mount = "0 0 0",
    payload: options.Payload = None,
    current: options.Current = None,
    gripper: Annotated[str, Option(help=_GRIPPER)] = "auto",
    smoothing: Annotated[str, Option(help="spline, savgol or interpolate (no noise).")] = "spline",
    bandwidth: Annotated[float, Option(help="-3 dB frequency of the smoothing (Hz).")] = 2.0,
    velocities: Annotated[str, Option(help="file, positions (their slope) or auto.")] = "auto",
    constants: options.Constants = "printed",
    supply_voltage: Annotated[float | None, Option(help="For limits (V); not published.")] = None,
    current_limit: Annotated[float | None, Option(help="Of each motor (A); not published.")] = None,
    screw_lead: Annotated[float | None, Option(help="Jaw rod (m per turn); not published.")] = None,
) -> None:
    """Torques by cause, motor currents, power, load on the mount and TCP path of a motion.

    Recorded efforts are compared with the torques. The table (--output) has every
    quantity over time. Planned motions without noise need no smoothing but
    interpolate; velocities are those of the file if it has any (auto), or the
    slope of its positions. With --supply-voltage and --current-limit the answer
    says what is left to the motors' limits, with --screw-lead the jaw rod's
    current. Table 4's K_t and K_v of one motor should agree and do not: printed
    takes K_t for torque and K_v for voltage, and powers do not balance.

    Example: alpha5 trajectory recording.csv --output torques.csv --plot page.png
    """
    # What cannot be written or chosen is refused before the work, not after it.
    check_outputs([file], output=(output, FORMATS), plot=(plot, figures.FORMATS))
    choice("gripper", gripper, ("auto", *GRIPPERS))
    flow = options.current_vector(current)
    use_velocity = _USE_VELOCITY[choice("velocities", velocities, tuple(_USE_VELOCITY))]
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:

        def progress(stage: str, done: float) -> None:
            if stage not in (task.description for task in bar.tasks):
                bar.add_task(stage, total=1.0)
            bar.update(bar.tasks[-1].id, completed=done)

        motion = library.read_motion(file, progress, topic=topic, prefix=prefix)
        if gripper == "auto":
            gripper = "jaws" if "axis_a" in motion.joints else "locked"
        motors = {}
        if screw_lead is not None:
            motors["axis_a"] = actuator("axis_a", constants, screw_lead=screw_lead)
            if gripper != "jaws":
                expected = "no value: the jaw rod is not part of the motion"
                raise InputError("screw-lead", screw_lead, expected)
        arm = options.arm_in(fluid, gravity, gripper, mount, payload)
        how: dict[str, Any] = {"method": smoothing, "bandwidth": bandwidth}
        how |= {"use_velocity": use_velocity, "constants": constants, "actuators": motors}
        how |= {"supply_voltage": supply_voltage, "current_limit": current_limit}
        analysis = library.analyse(motion, arm, progress=progress, current=flow, **how)
        summary = library.summary(analysis)
        s = analysis.smooth
        for k, joint in enumerate(summary["joints"].values()):
            at = np.abs(analysis.torque[:, k]).argmax()
            state = (x[at] for x in (s.position, s.velocity, s.acceleration))
            ends = analysis.torque[at, k] + torque_margin(analysis.arm, *state)[:, k]
            joint["torque_peak"]["interval"] = ends.tolist()
        if output is not None:
            library.write(analysis, output, progress)
        if plot is not None:
            figures.write_figure(trajectory_plot.figure(analysis), plot, dpi=110)
    options.show(as_json, summary, [library.text(summary)], output, plot)
