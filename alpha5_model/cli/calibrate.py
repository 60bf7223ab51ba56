"""``alpha5 calibrate``: poses to weigh an arm in, and an arm file of the readings."""

from __future__ import annotations

from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from typer import Argument, Option

from alpha5_model._support.checks import choice
from alpha5_model._support.files import STDOUT
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options, printing, values
from alpha5_model.errors import InputError, OutputError

if TYPE_CHECKING:
    from alpha5_model.studies.calibration import Calibration, Sensor, Session

_ACTIONS = ("plan", "fit", "motors")
_FORMATS = (".toml",)

# The options of this command.
_Action = Annotated[str, Argument(help="plan, fit or motors.")]
_Files = Annotated[
    list[Path],
    Argument(
        help="plan: the file to write; fit: the filled-in files; motors: a recording."
    ),
]
_SensorKind = Annotated[
    str,
    Option(
        "--sensor",
        help="plan: scales (three), weight (one scale), force-torque, efforts or "
        "vehicle-tilt.",
    ),
]
_Vehicle = Annotated[
    Path | None,
    Option(
        "--vehicle",
        help="plan, vehicle-tilt: TOML with mass, com, volume, cob, xyz, rpy (SI).",
        metavar="FILE",
    ),
]
_Poses = Annotated[int, Option(help="plan: how many poses.", min=1)]
_Fluid = Annotated[
    str | None,
    Option(help=f"{options.FLUID} Default: air for plan, sea for motors."),
]
_Gravity = Annotated[
    str | None,
    Option(help="plan, motors: gravity in base_link (m/s^2). Default: 0 0 -9.81."),
]
_Positions = Annotated[
    str | None,
    Option(
        help="plan: where three scales carry the plate: x y z of each in base_link (m)."
    ),
]
_Noise = Annotated[
    float | None, Option(help="plan: standard deviation of a reading (kg, N m or rad).")
]
_Ballast = Annotated[
    float, Option(help="plan: mass on the scales beside the arm (kg).")
]
_Zeroed = Annotated[
    bool, Option("--zeroed", help="plan: the scales showed 0 with the bare plate.")
]
_Prior = Annotated[
    str,
    Option(
        help="plan, fit: how well the numbers are known before: to their printed "
        "digits, or loose (masses and volumes to 10 %, centres to 5 mm)."
    ),
]
_Zeros = Annotated[
    str, Option(help="fit: standard deviation of the joints' zeros (rad).")
]
_Tilt = Annotated[
    str, Option(help="fit: standard deviation of the mount's tilt (rad).")
]
_Correlated = Annotated[
    bool,
    Option(
        "--correlated",
        help="fit: the readings are a recording whose noise drifts; estimate it.",
    ),
]
_Payload = Annotated[
    bool, Option("--payload", help="motors: weigh what the tool point carries.")
]
_Output = Annotated[
    Path | None, Option("--output", "-o", help="fit, motors: the arm file, .toml.")
]


def calibrate(
    action: _Action,
    files: _Files,
    sensor: _SensorKind = "scales",
    poses: _Poses = 12,
    fluid: _Fluid = None,
    gravity: _Gravity = None,
    positions: _Positions = None,
    vehicle: _Vehicle = None,
    noise: _Noise = None,
    ballast: _Ballast = 0.0,
    zeroed: _Zeroed = False,
    prior: _Prior = "digits",
    zeros: _Zeros = "1deg",
    tilt: _Tilt = "0.5deg",
    correlated: _Correlated = False,
    payload: _Payload = False,
    output: _Output = None,
    arm_file: options.Arm = None,
    as_json: options.Json = False,
) -> int:
    """Weigh your own arm: poses to take, and an arm file of what you read.

    plan writes a file with the poses in which a sensor tells the most. Fill in
    the readings. The tilt of a floating vehicle is a sensor, too: --vehicle
    names a file with its mass, buoyancy and centres.

    fit makes an arm file of one or several such files, for example one in air
    and one in water, and names what is wrong with them. motors estimates
    friction and torque per ampere from recorded currents.

    Exit status of fit: 1 if the readings contradict the model.

    Example: alpha5 calibrate plan scales.toml
    Example: alpha5 calibrate fit scales.toml --output my_arm.toml
    Example: alpha5 calibrate motors sway.csv --fluid sea --output my_arm.toml
    """
    choice("action", action, _ACTIONS)
    down: Any = None
    if gravity is not None:
        down = values.numbers("gravity", gravity, (3,), "m/s^2")
    own = values.arm_record(arm_file)
    if action == "fit":
        check_outputs([*files, arm_file], output=(output, _FORMATS))
        return _fit(files, prior, zeros, tilt, correlated, output, own, as_json)

    if action == "motors":
        check_outputs([*files, arm_file], output=(output, _FORMATS))
        known = "sea" if fluid is None else fluid
        return _motors(files, known, down, payload, output, own, as_json)

    file = _only(files, "one file to write")
    if str(file) != STDOUT and file.exists():
        raise OutputError(file, "it exists; name another file")
    from alpha5_model.studies.calibration import plan_poses, session_text

    chosen = _sensor(sensor, positions, noise, zeroed, vehicle)
    density = values.fluid_density("air" if fluid is None else fluid)
    planned = plan_poses(
        chosen,
        poses,
        arm=own,
        fluid_density=density,
        gravity=down,
        prior=prior,
        ballast=ballast,
    )
    atomic_write(file, session_text(planned, own))
    degrees = np.degrees(planned.q)
    record = {
        "sensor": planned.sensor.kind,
        "channels": planned.sensor.channels,
        "q": planned.q,
    }
    printing.show(as_json, record, _plan_text(planned, degrees), file)
    return 0


def _only(files: list[Path], expected: str) -> Path:
    """The one file that an action takes."""
    first, *others = files
    if others:
        raise InputError("files", " ".join(map(str, files)), expected)
    return first


def _motors(
    files: list[Path],
    fluid: str,
    gravity: Any,
    payload: bool,
    output: Path | None,
    own: Any,
    as_json: bool,
) -> int:
    """Motors from a recording of currents."""
    file = _only(files, "one recording")
    from alpha5_model.dynamics.load import load
    from alpha5_model.numbers.fluids import GRAVITY
    from alpha5_model.studies.calibration import motors
    from alpha5_model.trajectory import read_motion

    pull = GRAVITY if gravity is None else gravity
    arm = load(values.fluid_density(fluid), gravity=pull, arm=own)
    found = motors(read_motion(file, arm=own), arm, payload=payload)
    if output is not None:
        found.write(output)
    weighed = None if found.payload is None else found.payload._asdict()
    record = {
        "joints": {joint.name: joint._asdict() for joint in found.joints},
        "payload": weighed,
        "gravity_deviation": found.gravity_deviation,
    }
    printing.show(as_json, record, str(found).splitlines(), output)
    return 0


def _sensor(
    kind: str,
    positions: str | None,
    noise: float | None,
    zeroed: bool,
    vehicle: Path | None,
) -> Sensor:
    """The sensor that the options describe."""
    from alpha5_model.studies.calibration.sensors import SENSORS

    make = SENSORS[choice("sensor", kind, tuple(SENSORS))]
    arguments = signature(make).parameters
    given: dict[str, Any] = {}
    if positions is not None:
        points = values.numbers("positions", positions, (9,), "m")
        given["positions"] = np.reshape(points, (3, 3))
    if noise is not None:
        name = "torque_noise" if "torque_noise" in arguments else "noise"
        given[name] = noise
    if zeroed:
        given["zeroed"] = True
    if vehicle is not None:
        given["vehicle"] = _tables(vehicle)
    for name, value in given.items():
        if name not in arguments:
            raise InputError(name, value, f"nothing: {kind} has no such option")
    if "vehicle" in arguments and vehicle is None:
        raise InputError("vehicle", None, f"--vehicle FILE, which {kind} needs")
    return make(**given)


def _tables(file: Path) -> dict[str, Any]:
    """The tables of a TOML file."""
    from alpha5_model._support.files import read_named
    from alpha5_model._support.toml import toml_tables

    text = read_named(file, "the facts of a vehicle (TOML)").decode(
        "utf-8-sig", "replace"
    )
    return toml_tables(text, str(file))


def _plan_text(planned: Session, degrees: Any) -> printing.Lines:
    poses = "one pose" if len(degrees) == 1 else f"{len(degrees)} poses"
    yield f"{poses} for {planned.sensor.kind} (deg)"
    rows = [["", "axis_e", "axis_d", "axis_c", "axis_b"]]
    for number, angles in enumerate(degrees, 1):
        rows.append([str(number), *(f"{angle:.1f}" for angle in angles)])
    yield from table(rows, "<>>>>")
    yield "\nfill in the readings, then: alpha5 calibrate fit FILE --output my_arm.toml"


def _fit(
    files: list[Path],
    prior: str,
    zeros: str,
    tilt: str,
    correlated: bool,
    output: Path | None,
    own: Any,
    as_json: bool,
) -> int:
    """Fit the readings of files; 1 if they contradict the model."""
    from alpha5_model.studies.calibration import fit, read_session

    sessions = [read_session(file, own) for file in files]
    (of_zeros,) = values.numbers("zeros", zeros, (1,), "rad")
    (of_tilt,) = values.numbers("tilt", tilt, (1,), "rad")
    with printing.spinner("fitting"):
        found = fit(
            sessions,
            arm=own,
            prior=prior,
            zeros=of_zeros,
            tilt=of_tilt,
            correlated=correlated,
        )
    if output is not None:
        found.write(output)
    printing.show(as_json, _record(found), str(found).split("\n"), output)
    return 1 if found.problems else 0


def _record(found: Calibration) -> dict[str, Any]:
    """The result for scripts."""
    numbers = zip(
        found.names, found.estimate, found.prior, found.deviation, strict=True
    )
    others = zip(
        found.other_names, found.other_estimate, found.other_deviation, strict=True
    )
    return {
        "problems": [
            {
                "name": one.name,
                "message": one.message,
                "session": one.session,
                "rank": one.rank,
            }
            for one in found.problems
        ],
        "readings": found.readings,
        "squared_misfit": found.squared,
        "density": found.density,
        "torque_before": found.torque_before,
        "torque_after": found.torque_after,
        "numbers": {
            name: {"value": value, "before": before, "deviation": after}
            for name, value, before, after in numbers
        },
        "others": {
            name: {"value": value, "deviation": deviation}
            for name, value, deviation in others
        },
    }
