"""``alpha5 trajectory``: what a recorded or planned joint motion asks of the arm."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Self

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
#: Shorter files are done before a bar of progress could be read.
_PROGRESS_SAMPLES = 50_000


def trajectory(
    file: Annotated[Path, Argument(help=_FILE)],
    topic: Annotated[
        str | None, Option(help="Of a bag, if several topics name the arm's joints.")
    ] = None,
    prefix: Annotated[
        str | None, Option(help="Before the joints' names, if there are several: left_.")
    ] = None,
    output: Annotated[
        Path | None,
        Option("--output", "-o", help="Table of every quantity over time, .csv or .json."),
    ] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    mount: options.Mount = "0 0 0",
    payload: options.Payload = None,
    current: options.Current = None,
    gripper: Annotated[str, Option(help=_GRIPPER)] = "auto",
    smoothing: Annotated[
        str, Option(help="spline, savgol, or interpolate for planned motions without noise.")
    ] = "spline",
    bandwidth: Annotated[float, Option(help="-3 dB frequency of the smoothing (Hz).")] = 2.0,
    velocities: Annotated[
        str, Option(help="file, positions (their slope), or auto: those of the file if it has any.")
    ] = "auto",
    constants: options.Constants = "printed",
    supply_voltage: Annotated[float | None, Option(help="For margins (V); not published.")] = None,
    current_limit: Annotated[
        float | None, Option(help="Of each motor, for margins (A); not published.")
    ] = None,
    screw_lead: Annotated[
        float | None, Option(help="Of the jaw rod, for its current (m per turn); not published.")
    ] = None,
) -> None:
    """Torques by cause, motor currents, power, load on the mount and TCP path of a motion.

    Recorded efforts are compared with the torques.

    Example: alpha5 trajectory recording.csv --fluid fresh --output torques.csv --plot page.png
    """
    # What cannot be written or chosen is refused before the work, not after it.
    check_outputs([file], output=(output, FORMATS), plot=(plot, figures.FORMATS))
    choice("gripper", gripper, ("auto", *GRIPPERS))
    flow = options.current_vector(current)
    use_velocity = _USE_VELOCITY[choice("velocities", velocities, tuple(_USE_VELOCITY))]
    with _Bar() as progress:
        motion = library.read_motion(file, progress, topic=topic, prefix=prefix)
        progress.long = len(motion.time) > _PROGRESS_SAMPLES
        if gripper == "auto":
            gripper = "jaws" if "axis_a" in motion.joints else "locked"
        arm = options.arm_in(fluid, gravity, gripper, mount, payload)
        motors = {}
        if screw_lead is not None:
            motors["axis_a"] = actuator("axis_a", constants, screw_lead=screw_lead)
            if gripper != "jaws":
                expected = "no value: the jaw rod is not part of the motion"
                raise InputError("screw-lead", screw_lead, expected)
        analysis = library.analyse(
            motion,
            arm,
            method=smoothing,
            bandwidth=bandwidth,
            use_velocity=use_velocity,
            constants=constants,
            actuators=motors,
            supply_voltage=supply_voltage,
            current_limit=current_limit,
            progress=progress,
            current=flow,
        )
        summary = library.summary(analysis)
        if output is not None:
            library.write(analysis, output, progress)
        if plot is not None:
            figures.write_figure(trajectory_plot.figure(analysis), plot, dpi=110)
    options.show(as_json, summary, [library.text(summary)], output, plot)


class _Bar(Progress):
    """Progress on long files, on stderr if that is a terminal."""

    def __init__(self) -> None:
        console = Console(stderr=True)
        super().__init__(console=console, transient=True, disable=not console.is_terminal)
        self.long = False

    def __enter__(self) -> Self:
        return self  # it starts at the first report of a long file

    def __call__(self, stage: str, done: float) -> None:
        # Reading reports after each block: more than one block is a long file.
        if not self.long and (stage != "read" or done >= 1.0):
            return
        if not self.tasks or self.tasks[-1].description != stage:
            self.start()
            self.add_task(stage, total=1.0)
        self.update(self.tasks[-1].id, completed=done)
