"""``alpha5 trajectory`` and ``sweep``: what a motion asks of the arm, and what many states, cases or recordings do."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from rich.console import Console
from rich.progress import Progress
from typer import Argument, Option

from alpha5_model import trajectory as library
from alpha5_model._support.checks import choice
from alpha5_model._support.files import check_outputs
from alpha5_model._support.text import table
from alpha5_model.cli import options
from alpha5_model.dynamics.actuators import actuator
from alpha5_model.errors import InputError
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.studies.sweep.run import sweep as computed
from alpha5_model.studies.uncertainty.effects import torque_margin
from alpha5_model.trajectory.time_series import FORMATS
from alpha5_model.viewer import figures

#: Values of an output of a study that are printed; its file has all, and where they come from.
_PRINTED = 5
#: What goes wrong on a cluster ends in one line of ours.
_QUIET = "{'distributed': 'critical', 'distributed.client': 'critical'}"
_USE_VELOCITY = {"auto": None, "file": True, "positions": False}


def trajectory(
    file: Annotated[Path, Argument(help=options.HELP["file"])],
    topic: Annotated[str | None, Option(help="Of a bag with several arms.")] = None,
    prefix: Annotated[
        str | None, Option(help="Before the joints' names: left_.")
    ] = None,
    output: Annotated[
        Path | None, Option("--output", "-o", help="Table, .csv or .json.")
    ] = None,
    plot: options.Plot = None,
    as_json: options.Json = False,
    fluid: options.Fluid = "sea",
    gravity: options.Gravity = options.DOWN,
    mount: options.Mount = "0 0 0",
    payload: options.Payload = None,
    current: options.Current = None,
    gripper: Annotated[str, Option(help=options.HELP["gripper"])] = "auto",
    smoothing: Annotated[
        str, Option(help="spline, savgol or interpolate (no noise).")
    ] = "spline",
    bandwidth: Annotated[
        float, Option(help="-3 dB frequency of the smoothing (Hz).")
    ] = 2.0,
    velocities: Annotated[
        str, Option(help="file, positions (their slope) or auto.")
    ] = "auto",
    constants: options.Constants = "printed",
    efficiency: options.Efficiency = "gearbox",
    supply_voltage: Annotated[
        float | None, Option(help="For limits (V); not published.")
    ] = None,
    current_limit: Annotated[
        float | None, Option(help="Of each motor (A); not published.")
    ] = None,
    screw_lead: Annotated[
        float | None, Option(help="Jaw rod (m per turn); not published.")
    ] = None,
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
    with _progress() as progress:
        motion = library.read_motion(file, progress, topic=topic, prefix=prefix)
        if gripper == "auto":
            gripper = "jaws" if "axis_a" in motion.joints else "locked"
        motors = {}
        if screw_lead is not None:
            motors["axis_a"] = actuator(
                "axis_a", constants, screw_lead=screw_lead, efficiency=efficiency
            )
            if gripper != "jaws":
                expected = "no value: the jaw rod is not part of the motion"
                raise InputError("screw-lead", screw_lead, expected)
        arm = options.arm_in(fluid, gravity, gripper, mount, payload)
        how: dict[str, Any] = {"method": smoothing, "bandwidth": bandwidth}
        how |= {
            "use_velocity": use_velocity,
            "constants": constants,
            "actuators": motors,
        }
        how |= {"supply_voltage": supply_voltage, "current_limit": current_limit}
        how |= {"efficiency": efficiency}
        analysis = library.analyse(motion, arm, progress=progress, current=flow, **how)
        summary = library.summary(analysis)
        s, at = analysis.smooth, np.abs(analysis.torque).argmax(axis=0)
        peaks = (x[at] for x in (s.position, s.velocity, s.acceleration))
        ends = analysis.torque[at] + torque_margin(analysis.arm, *peaks)
        for k, joint in enumerate(summary["joints"].values()):
            joint["torque_peak"]["interval"] = ends[:, k, k].tolist()
        if output is not None:
            library.write(analysis, output, progress)
        if plot is not None:
            figures.write_figure(figures.motion_figure(analysis), plot, dpi=110)
    options.show(as_json, summary, [library.text(summary)], output, plot)


def sweep(
    study: Annotated[
        Path, Argument(help="TOML: axes and outputs; see the guide on studies.")
    ],
    output: Annotated[
        Path, Option("--output", "-o", help="Folder; goes on with what is there.")
    ],
    workers: Annotated[
        int, Option(help="Processes here; 0 for this one alone.", min=0)
    ] = 0,
    scheduler: Annotated[
        str | None, Option(help="Of a Dask cluster: tcp://host:8786.")
    ] = None,
    as_json: options.Json = False,
) -> int:
    """Torques, currents, loads over all that a study varies: extremes, maps, quantiles, tables.

    Exit status: 1 if a recording could not be used.

    Example: alpha5 sweep study.toml --output results
    """
    os.environ.setdefault(
        "DASK_LOGGING", _QUIET
    )  # read when Dask is imported, by the workers, too
    with _progress() as progress:
        found = computed(
            study, output, workers=workers, scheduler=scheduler, progress=progress
        )
    units = {name: found.study.outputs[name].unit for name in found.outputs}
    record = {"rows": found.rows, "failures": found.failures, "units": units}
    record["outputs"] = found.outputs
    options.show(as_json, record, _text(record), output)
    return int(bool(found.failures))


def _text(record: dict[str, Any]) -> options.Lines:
    yield f"{record['rows']} rows"
    for name, columns in record["outputs"].items():
        count = max(map(len, columns.values()))
        more = f": the first {_PRINTED} of {count}" if count > _PRINTED else ""
        yield f"\n{name} [{record['units'][name]}]{more}"
        shown = {
            key: x[:_PRINTED] for key, x in columns.items() if not key.endswith("_row")
        }
        yield from table(
            [[key, *map(_cell, x.tolist())] for key, x in shown.items()], "<>", 2
        )
    for recording, problem in record["failures"].items():
        yield f"\nnot used: {recording}: {problem}"


def _cell(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:.4g}" if math.isfinite(x) else "-"
    return str(x)


@contextmanager
def _progress() -> Iterator[Callable[[str, float], None]]:
    console = Console(stderr=True)
    with Progress(
        console=console, transient=True, disable=not console.is_terminal
    ) as bar:

        def progress(stage: str, done: float) -> None:
            if stage not in (task.description for task in bar.tasks):
                bar.add_task(stage, total=1.0)
            bar.update(bar.tasks[-1].id, completed=done)

        yield progress
