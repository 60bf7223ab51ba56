"""``alpha5 calibrate``: poses to weigh an arm in, and an arm file of the readings."""

from __future__ import annotations

from argparse import Namespace
from collections import Counter
from inspect import signature
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import choice
from alpha5_model._support.files import STDOUT
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.text import table
from alpha5_model._support.writing import atomic_write
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE, LENGTH, MASS, NUMBER, Scalar, Vector
from alpha5_model.errors import InputError, OutputError

if TYPE_CHECKING:
    from alpha5_model.numbers.parameters import Alpha5Parameters
    from alpha5_model.studies.calibration import Calibration, Sensor, Session

_FORMATS = (".toml",)

HELP = """
plan writes a file with the poses in which a sensor tells the most. Fill in
the readings. The tilt of a floating vehicle is a sensor, too: --vehicle names
a file with its mass, buoyancy and centres. fit makes an arm file of one or
several such files, for example one in air and one in water, and names what is
wrong with them. motors estimates friction and torque per ampere from recorded
currents.

Exit status of fit and motors: 1 if the readings contradict the model.

Example: alpha5 calibrate plan scales.toml
Example: alpha5 calibrate fit scales.toml --output my_arm.toml
Example: alpha5 calibrate motors sway.csv --fluid sea --output my_arm.toml
"""


def options(parser: Parser) -> None:
    parser.add_commands(
        {
            "plan": ("write the poses in which a sensor tells the most", _of_plan),
            "fit": ("make an arm file of the filled-in files", _of_fit),
            "motors": ("friction and torque per ampere from currents", _of_motors),
        }
    )


def _of_plan(parser: Parser) -> None:
    parser.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="the file to write",
    )
    parser.add_argument(
        "--sensor",
        default="scales",
        help="scales (three), weight (one scale), force-torque, efforts or "
        "vehicle-tilt. Default: %(default)s",
    )
    parser.add_argument(
        "--poses", type=int, default=12, help="how many poses. Default: %(default)s"
    )
    parser.add_argument(
        "--positions",
        type=Vector(*[LENGTH] * 9),
        metavar="X Y Z ...",
        help="where three scales carry the plate: x y z of each in base_link (m)",
    )
    parser.add_argument(
        "--vehicle",
        type=Path,
        metavar="FILE",
        help="vehicle-tilt: TOML with mass, com, volume, cob, xyz, rpy (SI)",
    )
    parser.add_argument(
        "--noise",
        type=Scalar(NUMBER),
        help="standard deviation of a reading (kg, N m or rad)",
    )
    parser.add_argument(
        "--ballast",
        type=Scalar(MASS),
        default=0.0,
        help="mass on the scales beside the arm (kg). Default: 0",
    )
    parser.add_argument(
        "--zeroed",
        action="store_true",
        help="the scales showed 0 with the bare plate",
    )
    common.fluid(parser, "air")
    common.gravity(parser, None, "in base_link (m/s^2). Default: 0 0 -9.81")
    _prior(parser)
    common.arm_file(parser)
    common.as_json(parser)


def _of_fit(parser: Parser) -> None:
    parser.add_argument(
        "files", nargs="+", type=Path, metavar="FILE", help="the filled-in files"
    )
    _prior(parser)
    parser.add_argument(
        "--zeros",
        type=Scalar(ANGLE),
        default="1deg",
        help="standard deviation of the joints' zeros (rad). Default: %(default)s",
    )
    parser.add_argument(
        "--tilt",
        type=Scalar(ANGLE),
        default="0.5deg",
        help="standard deviation of the mount's tilt (rad). Default: %(default)s",
    )
    parser.add_argument(
        "--correlated",
        action="store_true",
        help="the readings are a recording whose noise drifts; estimate it",
    )
    _output(parser)
    common.arm_file(parser)
    common.as_json(parser)


def _of_motors(parser: Parser) -> None:
    parser.add_argument(
        "file", type=Path, metavar="FILE", help="a recording with currents"
    )
    common.fluid(parser, "air")
    common.gravity(
        parser,
        None,
        "in base_link (m/s^2). Default: 0 0 -9.81, turned by the mount of --arm",
    )
    parser.add_argument(
        "--payload", action="store_true", help="weigh what the tool point carries"
    )
    _output(parser)
    common.arm_file(parser)
    common.as_json(parser)


def _prior(parser: Parser) -> None:
    parser.add_argument(
        "--prior",
        default="digits",
        help="how well the numbers are known before: to their printed digits, or loose "
        "(masses and volumes to 10 %%, centres to 5 mm). Default: %(default)s",
    )


def _output(parser: Parser) -> None:
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="the arm file, .toml"
    )


def run(given: Namespace) -> int:
    own = common.record_of(given)
    if given.command == "plan":
        return _plan(given, own)
    files = given.files if given.command == "fit" else [given.file]
    check_outputs([*files, given.arm], output=(given.output, _FORMATS))
    return _fit(given, own) if given.command == "fit" else _motors(given, own)


def _plan(given: Namespace, own: Alpha5Parameters | None) -> int:
    """Poses to take, or a motion."""
    file = given.file
    check_outputs([given.arm, given.vehicle], file=(file, _FORMATS))
    if str(file) != STDOUT and file.exists():
        raise OutputError(file, "it exists; name another file")
    from alpha5_model.studies.calibration import plan_poses, session_text

    sensor = _sensor(given)
    planned = plan_poses(
        sensor,
        given.poses,
        arm=own,
        fluid_density=given.fluid,
        gravity=given.gravity,
        prior=given.prior,
        ballast=given.ballast,
    )
    atomic_write(file, session_text(planned, own))
    degrees = np.degrees(planned.q)
    record = {
        "sensor": planned.sensor.kind,
        "channels": planned.sensor.channels,
        "q": planned.q,
    }
    printing.show(given.json, record, _plan_text(planned, degrees), file)
    return 0


def _motors(given: Namespace, own: Alpha5Parameters | None) -> int:
    """Motors from a recording of currents."""
    from alpha5_model.dynamics.load import load
    from alpha5_model.numbers.fluids import GRAVITY
    from alpha5_model.studies.calibration import motors
    from alpha5_model.trajectory import read_motion

    pull: Any = GRAVITY
    if given.gravity is not None:
        # It is in base_link, but load takes it in the world, which the mount is in.
        mount = None if own is None else own.mount
        pull = given.gravity
        if mount is not None:
            pull = mount.rotation @ np.array(given.gravity)
    arm = load(given.fluid, gravity=pull, arm=own)
    found = motors(read_motion(given.file, arm=own), arm, payload=given.payload)
    if given.output is not None:
        found.write(given.output)
    weighed = None if found.payload is None else found.payload._asdict()
    record = {
        "problems": [one._asdict() for one in found.problems],
        "joints": {joint.name: joint._asdict() for joint in found.joints},
        "payload": weighed,
        "gravity_deviation": found.gravity_deviation,
    }
    printing.show(given.json, record, str(found).splitlines(), given.output)
    return 1 if found.contradicted else 0


def _sensor(given: Namespace) -> Sensor:
    """The sensor that the options of ``plan`` describe."""
    from alpha5_model.studies.calibration.sensors import SENSORS

    kind = given.sensor
    make = SENSORS[choice("sensor", kind, tuple(SENSORS))]
    arguments = signature(make).parameters
    settings: dict[str, Any] = {}
    if given.positions is not None:
        settings["positions"] = np.reshape(given.positions, (3, 3))
    if given.noise is not None:
        name = "torque_noise" if "torque_noise" in arguments else "noise"
        settings[name] = given.noise
    if given.zeroed:
        settings["zeroed"] = True
    if given.vehicle is not None:
        settings["vehicle"] = common.vehicle_tables(given.vehicle)
    if given.ballast and kind not in ("scales", "weight"):
        raise InputError("ballast", given.ballast, f"nothing: {kind} weighs no ballast")
    for name, value in settings.items():
        if name not in arguments:
            raise InputError(name, value, f"nothing: {kind} has no such option")
    if "vehicle" in arguments and given.vehicle is None:
        raise InputError("vehicle", None, f"--vehicle FILE, which {kind} needs")
    return make(**settings)


def _plan_text(planned: Session, degrees: Any) -> printing.Lines:
    poses = "one pose" if len(degrees) == 1 else f"{len(degrees)} poses"
    yield f"{poses} for {planned.sensor.kind} (deg)"
    rows = [["", "axis_e", "axis_d", "axis_c", "axis_b"]]
    for number, angles in enumerate(degrees, 1):
        rows.append([str(number), *(f"{angle:.1f}" for angle in angles)])
    yield from table(rows, "<>>>>")
    yield "\nfill in the readings, then: alpha5 calibrate fit FILE --output my_arm.toml"


def _fit(given: Namespace, own: Alpha5Parameters | None) -> int:
    """Fit the readings of files; 1 if they contradict the model."""
    from alpha5_model.studies.calibration import fit, read_session

    twice = [
        file for file, n in Counter(map(Path.resolve, given.files)).items() if n > 1
    ]
    if twice:
        raise InputError("files", str(twice[0]), "each file once")
    sessions = [read_session(file, own) for file in given.files]
    with printing.spinner("fitting"):
        found = fit(
            sessions,
            arm=own,
            prior=given.prior,
            zeros=given.zeros,
            tilt=given.tilt,
            correlated=given.correlated,
        )
    if given.output is not None:
        found.write(given.output)
    printing.show(given.json, _record(found), str(found).split("\n"), given.output)
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
