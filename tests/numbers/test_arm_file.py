"""Arm files: what they may say, and one line for each mistake."""

from __future__ import annotations

import dataclasses
import math
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arm_keys import SENSOR, changes
from least_time import least_time

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    ImplausibleWarning,
    InputError,
    MissingFileError,
)
from alpha5_model.numbers import arm_schema
from alpha5_model.numbers.arm_writing import new_arm_file
from alpha5_model.numbers.parameters import Alpha5Parameters

ARM = a5.parameters()
CHANGES = dict(changes(SENSOR))
#: The study's example, all keys in use.
LAB = """
format = 1
name = "alpha5_lab_2"
corrections = ["base_frame"]
[mount]
parent = "bluerov"
xyz = {value = [210, 0, -85], unit = "mm"}
rpy = {value = [180, 0, 0], unit = "deg"}
[lengths]
a_1 = {value = 150.9, unit = "mm", source = "CMM", half_width = 0.05}
[zeros]
axis_d = {value = 0.4, unit = "deg"}
[joint_limits.axis_e]
min_position = {value = 20, unit = "deg"}
max_position = {value = 330, unit = "deg"}
max_velocity = {value = 20, unit = "deg/s"}
max_effort = 1.5
[links.link_2]
mass = {value = 341, unit = "g", source = "scale", half_width = 1}
[[attached]]
name = "force_sensor"
link = "link_4"
at = {value = [0, 0, -75], unit = "mm"}
spacer = {value = 22, unit = "mm"}
mass = {value = 120, unit = "g"}
volume = {value = 0.045, unit = "L"}
[motors]
supply_voltage = 24.0
current_limit = 1.0
rotor_inertia = {axis_e = 5e-7}
efficiency = {axis_b = {value = 75, unit = "%"}}
"""


def read(tmp_path: Path, text: str) -> Alpha5Parameters:
    path = tmp_path / "my_arm.toml"
    path.write_text(text, encoding="utf-8")
    return a5.arm_file(path)


def flat(value: Any) -> Any:
    """A record as plain data, every bit of its numbers included."""
    if dataclasses.is_dataclass(value):
        names = [field.name for field in dataclasses.fields(value)]
        return {name: flat(getattr(value, name)) for name in names}
    if isinstance(value, np.ndarray):
        return [flat(number) for number in value.ravel().tolist()]
    if isinstance(value, tuple):
        return [flat(item) for item in value]
    return value.hex() if isinstance(value, float) else value


# --- what a file says -----------------------------------------------------------------


def test_the_example_is_read(tmp_path: Path) -> None:
    own = read(tmp_path, LAB)
    assert own.name == "alpha5_lab_2"
    assert own.mount is not None
    assert own.mount.parent == "bluerov"
    assert own.mount.position.tolist() == [0.21, 0.0, -0.085]
    expected = np.diag([1.0, -1.0, -1.0])
    assert own.mount.rotation == pytest.approx(expected, abs=1e-15)
    assert own.dh[1].a == 0.1509
    zero = own.dh[1].theta_offset - ARM.dh[1].theta_offset
    assert zero == pytest.approx(math.radians(0.4), abs=1e-15)
    limits = own.joints[0]
    assert (limits.lower, limits.upper) == (math.radians(20), math.radians(330))
    assert (limits.velocity, limits.effort) == (math.radians(20), 1.5)
    assert own.links[2].mass == 0.341
    assert own.links[2].inertia is ARM.links[2].inertia or np.array_equal(
        own.links[2].inertia, ARM.links[2].inertia
    )
    (sensor,) = own.attached
    assert (sensor.name, sensor.link, sensor.spacer) == (
        "force_sensor",
        "link_4",
        0.022,
    )
    assert (sensor.mass, sensor.volume) == (0.12, 4.5e-5)
    assert sensor.position.tolist() == [0, 0, -0.075]
    assert own.tool is not None
    assert own.tool.position == pytest.approx([0, 0, -0.202], abs=1e-15)
    assert own.motors.supply_voltage == 24.0
    assert own.motors.current_limits == (1.0,) * 5
    assert own.motors.rotor_inertias == (5e-7, None, None, None, None)
    assert own.actuators[3].efficiency == 0.75
    assert own.actuators[4] is ARM.actuators[4]


def test_sources_and_half_widths_are_kept(tmp_path: Path) -> None:
    found = {each.key: each for each in read(tmp_path, LAB).measurements}
    assert found.keys() == {"lengths.a_1", "links.link_2.mass"}
    assert found["lengths.a_1"].source == "CMM"
    assert found["lengths.a_1"].half_width == 5e-5
    assert found["links.link_2.mass"].half_width == 1e-3


def test_a_new_file_is_the_catalogue_exactly(tmp_path: Path) -> None:
    assert flat(read(tmp_path, new_arm_file())) == flat(ARM)
    assert flat(read(tmp_path, "format = 1")) == flat(ARM)
    literal = read(tmp_path, "format = 1\ncorrections = []")
    assert flat(literal) == flat(a5.parameters(()))


def test_a_new_file_shows_every_key() -> None:
    text = new_arm_file()
    shown = text.replace("\n# ", "\n")
    lines = [line.split("#")[0] for line in shown.split("\n")]
    for table in (arm_schema.MOUNT, arm_schema.ATTACHED, arm_schema.TOOL):
        for name in table:
            assert any(line.startswith(f"{name} = ") for line in lines), name
    given = tomllib.loads(text)
    assert given["lengths"].keys() == arm_schema.LENGTHS.keys()
    assert given["zeros"].keys() == arm_schema.ZEROS.keys()
    for part, schema in (
        ("joint_limits", arm_schema.JOINT_LIMITS),
        ("links", arm_schema.LINKS),
    ):
        assert {n: {*given[part][n]} for n in schema} == {
            n: {*schema[n]} for n in schema
        }
    for name in ("supply_voltage", "constants", *arm_schema.DRIVES):
        assert any(line.startswith(f"{name} = ") for line in lines), name
    assert arm_schema.ACTUATORS.keys() <= given["motors"].keys()


def test_the_tool_of_a_file(tmp_path: Path) -> None:
    moved = read(tmp_path, "format = 1\n[tool]\nxyz = [0.004, 0, -0.245]")
    assert moved.tool is not None
    assert moved.tool.position.tolist() == [0.004, 0, -0.245]
    assert moved.tool.rotation.tolist() == [[0, 1, 0], [0, 0, -1], [-1, 0, 0]]
    turned = read(tmp_path, "format = 1\n[tool]\nrpy = [0, 0, 0]")
    assert turned.tool is not None
    assert turned.tool.position.tolist() == [0, 0, -0.18]
    assert turned.tool.rotation.tolist() == np.eye(3).tolist()
    both = read(tmp_path, LAB + "[tool]\nrpy = [0, 0, 0]")
    assert both.tool is not None
    assert both.tool.position == pytest.approx([0, 0, -0.202], abs=1e-15)
    assert both.tool.rotation.tolist() == np.eye(3).tolist()


# --- each key alone -------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@pytest.mark.parametrize("key", CHANGES)
def test_each_key_alone_changes_the_record(tmp_path: Path, key: str) -> None:
    before = SENSOR if key.startswith("attached.") else ""
    default = flat(read(tmp_path, f"format = 1\n{before}"))
    own = flat(read(tmp_path, f"format = 1\n{CHANGES[key]}"))
    different = {name for name in own if own[name] != default[name]}
    part = {"lengths": "dh", "zeros": "dh", "joint_limits": "joints"}
    first = key.split(".")[0]
    expected = {part.get(first, first)}
    if first == "corrections":
        expected = {"corrections", "dh", "base_yaw"} & different | {"corrections"}
    if first == "motors" and key.split(".")[1] in arm_schema.ACTUATORS:
        expected = {"actuators"}
    if key == "attached.spacer":
        expected |= {"tool"}
    assert different == expected


def test_every_number_takes_a_unit_a_source_and_a_half_width(tmp_path: Path) -> None:
    for key, text in CHANGES.items():
        head, _, number = text.rpartition(" = ")
        is_number = key not in ("name", "mount.parent", "motors.constants")
        if not is_number or key.startswith(("corrections", "attached.", "motors.")):
            continue
        whole = f'{head} = {{value = {number}, source = "me", half_width = 0}}'
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)
            own = read(tmp_path, f"format = 1\n{whole}")
        (found,) = own.measurements
        assert (found.key, found.source, found.half_width) == (key, "me", 0.0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{value = 20.0, unit = "mm"}', 0.02),
        ('{value = 2, unit = "cm"}', 0.02),
        ("0.02", 0.02),
        ("2e-2", 0.02),
        ("2_0e-3", 0.02),
        ('{value = 21.123456789012345678, unit = "mm"}', 0.021123456789012345678),
    ],
)
def test_a_length_is_the_nearest_double(
    tmp_path: Path, text: str, expected: float
) -> None:
    assert read(tmp_path, f"format = 1\n[lengths]\na_0 = {text}").dh[0].a == expected


@pytest.mark.parametrize("unit", ["N m", "Nm", "N.m", "N*m", "N·m"])
def test_units_are_known_by_their_spellings(tmp_path: Path, unit: str) -> None:
    text = f'max_effort = {{value = 2, unit = "{unit}"}}'
    own = read(tmp_path, f"format = 1\n[joint_limits.axis_d]\n{text}")
    assert own.joints[1].effort == 2.0


# --- warnings -------------------------------------------------------------------------

ODD = {
    "[lengths]\na_1 = 0.18": "lengths.a_1: 0.18 m is 29 mm off the printed one",
    "[zeros]\naxis_b = 0.2": "zeros.axis_b: 0.2 rad is more than 10 deg off the prin",
    "[joint_limits.axis_e]\nmin_position = 0": (
        "joint_limits.axis_e.min_position: 0 rad is beyond the published 0.01745 to "
        "6.143 rad"
    ),
    "[joint_limits.axis_d]\nmax_position = 3.5": (
        "joint_limits.axis_d.max_position: 3.5 rad is beyond the published 0.01745 to"
    ),
    "[joint_limits.axis_c]\nmax_velocity = 0.6": (
        "joint_limits.axis_c.max_velocity: 0.6 rad/s is faster than the rated 0.5236"
    ),
    "[links.link_2]\nmass = 0.2": (
        "links.link_2.mass: 0.2 kg with the printed inertia; give an inertia too, "
        "for example the printed one times 0.526"
    ),
    "[links.link_2]\ncob = [0.3, 0, 0]": (
        "links.link_2.cob: (0.3, 0, 0) m is outside the body's bounds"
    ),
    "[links.link_2]\ninertia = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]": (
        "link_2.inertia: a radius of gyration of 2.81 m is implausible"
    ),
    SENSOR: "attached.s.volume: not given, so the body displaces no water",
}


@pytest.mark.parametrize("text", ODD)
def test_what_is_odd_is_warned_of_with_the_file(tmp_path: Path, text: str) -> None:
    with pytest.warns(ImplausibleWarning) as found:
        read(tmp_path, f"format = 1\n{text}")
    messages = [str(warning.message) for warning in found]
    start = f"{tmp_path / 'my_arm.toml'}: {ODD[text]}"
    assert any(message.startswith(start) for message in messages), messages
    assert all(warning.filename == __file__ for warning in found)


# --- wrong files ----------------------------------------------------------------------

SENSOR_4 = SENSOR + "volume = 1e-4\n"
#: Content after "format = 1" -> the message after the file's name.
WRONG = {
    "speed = 1": ": unknown 'speed'; choose from format, name, corrections, mount, "
    "lengths, zeros, joint_limits, links, attached, tool, motors, covariance",
    "lenghts = {}": ": unknown 'lenghts', did you mean 'lengths'?",
    'name = "my arm"': ", name: 'my arm'; expected a name of at most 64 letters, "
    "digits and _, a letter first",
    'corrections = "base_frame"': ", corrections: 'base_frame'; expected a list of "
    "names, such as ['base_frame']",
    'corrections = ["baseframe"]': ", corrections: unknown 'baseframe', did you mean "
    "'base_frame'?",
    "[mount]\nxyz = [210, 0, -85]": ", mount.xyz: [210, 0, -85] m; expected at most 5 "
    "m for a vehicle: is it in mm?",
    "[mount]\nrpy = [180, 0, 0]": ", mount.rpy: [180, 0, 0] rad; expected at most two "
    "turns: is it in deg?",
    "[mount]\nposition = [0, 0, 0]": ", mount: unknown 'position'; write xyz",
    "[mount]\nxyz = [0, 0]": ", mount.xyz: [0, 0]; expected 3 numbers",
    "[lengths]\na_1 = 150.9": ", lengths.a_1: 150.9 m; expected at most 2 m on this arm"
    ": is it in mm?",
    "[lengths]\na_0 = -0.02": ", lengths.a_0: -0.02 m; expected a length above 0, as "
    "Table 1's 0.02 m",
    "[lengths]\nd_3 = 0.18": ", lengths.d_3: 0.18 m; expected a length below 0, as "
    "Table 1's -0.18 m",
    "[lengths]\nalpha_1 = 0.003": ", lengths: unknown 'alpha_1'; axes are parallel or "
    "square as in Table 1, because the closed-form inverse kinematics has no twisted "
    "or shifted ones",
    '[lengths]\na_0 = {value = 2, unit = "inch"}': ", lengths.a_0: unit 'inch'; "
    "expected one of m, mm, cm",
    "[lengths]\na_0 = {valeu = 2}": ", lengths.a_0: unknown 'valeu', did you mean "
    "'value'?",
    '[lengths]\na_0 = {unit = "mm"}': ", lengths.a_0: no value; write lengths.a_0 = "
    "{value = ...}",
    '[lengths]\na_0 = "20 mm"': ", lengths.a_0: '20 mm'; expected a number",
    "[lengths]\na_0 = nan": ", lengths.a_0: NaN; expected a number below 1e12",
    "[zeros]\naxis_a = 0.01": ", zeros: unknown 'axis_a', did you mean 'axis_e'?",
    "[zeros]\naxis_d = 20": ", zeros.axis_d: 20 rad; expected at most two turns: "
    "is it in deg?",
    "[joint_limits.axis_f]\nmin_position = 1": ", joint_limits: unknown 'axis_f', did "
    "you mean 'axis_e'?",
    "[joint_limits.axis_e]\nmin_position = 3.49\nmax_position = 1.75": ", "
    "joint_limits.axis_e: min_position 3.49 is not below max_position 1.75 rad",
    "[joint_limits.axis_b]\nmin_position = -3.2\nmax_position = 3.2": ", "
    "joint_limits.axis_b: min_position -3.2 to max_position 3.2 rad; expected less "
    "than a full turn",
    "[joint_limits.axis_e]\nmax_position = 330": ", joint_limits.axis_e.max_position: "
    "330 rad; expected at most two turns: is it in deg?",
    "[joint_limits.axis_e]\nmax_velocity = 20": ", joint_limits.axis_e.max_velocity: "
    "20 rad/s; expected at most two turns a second: is it in deg/s?",
    "[joint_limits.axis_e]\nmax_acceleration = 1": ", joint_limits.axis_e: unknown "
    "'max_acceleration'; the record has no limit of acceleration: leave it out",
    "[joint_limits.axis_e]\neffort = 1": ", joint_limits.axis_e: unknown 'effort'; "
    "write max_effort",
    "[joint_limits.axis_e]\nmax_effort = 0": ", joint_limits.axis_e.max_effort: 0 "
    "N m; expected more than 0 N m",
    "[joint_limits.axis_a]\nmax_position = 13.3": ", joint_limits.axis_a.max_position:"
    " 13.3 m; expected at most 0.5 m for the jaws: is it in mm?",
    "[links.link_2]\nmass = -1": ", links.link_2.mass: -1 kg; expected more than 0 kg",
    "[links.link_2]\nmass = 341": ", links.link_2.mass: 341 kg; expected at most 20 "
    "kg on this arm: is it in g?",
    '[links.link_2]\nmass = {value = 341, unit = "g", half_width = 400}': ", "
    "links.link_2.mass.half_width: 400 g; expected 0 to the value (it has the value's "
    "unit)",
    "[links.link_2]\nvolume = 0.218": ", links.link_2.volume: 0.218 m^3; expected at "
    "most 0.1 m^3 on this arm: is it in L?",
    "[links.link_2]\ncom = [0.0736, 0.09, 0]": ", links.link_2.com: [0.0736, 0.09, "
    "0.0] m; expected a point inside the body's bounds, [[-0.02, 0.1707], [-0.0333, "
    "0.0333], [-0.02, 0.02]] m",
    "[links.link_2]\ncom = [0.73, -0.91, -0.73]": ", links.link_2.com: [0.73, -0.91, "
    "-0.73] m; expected a point inside the body's bounds, [[-0.02, 0.1707], [-0.0333, "
    "0.0333], [-0.02, 0.02]] m; is it in mm?",
    "[links.link_2]\ninertia = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 3e-4]]": ", "
    "links.link_2.inertia: no body has it: the largest principal moment 0.0003 kg m^2 "
    "exceeds the sum of the others, 0.0002; expected it at the COM, products as in "
    "URDF, in kg m^2",
    "[links.link_2]\ninertia = [[1e-4, 1e-5, 0], [0, 1e-4, 0], [0, 0, 1e-4]]": ", "
    "links.link_2.inertia: [[0.0001, 0.00001, 0], [0, 0.0001, 0], [0, 0, 0.0001]] "
    "kg m^2; expected a symmetric tensor",
    "[links.link_4]\nmass = 0.03": (
        ", links.link_4: 0.03 kg, 0.000134 m^3, moments 0.0006159, 0.0006253, "
        "6.257e-05 kg m^2; expected a body that leaves a possible wrist if rod and "
        "fingers, which are estimated at 0.0422 kg, are taken out of it"
    ),
    "[links.link_9]\nmass = 1": ", links: unknown 'link_9', did you mean 'link_4'?",
    '[attached]\nname = "s"': ", attached: {'name': 's'}; expected at most 32 tables "
    "[[attached]]",
    SENSOR_4.replace("at = [0, 0, 0]\n", ""): ", attached[0].at: missing",
    SENSOR_4.replace("link_4", "link4"): ", attached.s.link: unknown 'link4', did you "
    "mean 'link_4'?",
    SENSOR_4 + SENSOR_4: ", attached[1].name: 's'; expected a name that no other body "
    "has",
    SENSOR_4
    + "spacer = 22": ", attached.s.spacer: 22 m; expected at most 0.5 m for the "
    "jaws: is it in mm?",
    SENSOR_4.replace("link_4", "link_3") + "spacer = 0.02": ", attached.s.spacer: "
    "0.02 m on link_3; only link_4 has jaws",
    SENSOR_4 + "spacer = 0.02\n[tool]\nxyz = [0, 0, -0.2]": ", tool.xyz: [0, 0, -0.2] "
    "m together with a spacer, which moves the tool: give one",
    "[tool]\nxyz = [0, 0, -0.5]": ", tool.xyz: [0, 0, -0.5] m; expected a point within "
    "0.3 m of the published one, [0.0, 0.0, -0.18] m: is the unit right?",
    "[tool]\nxyz = [4, 0, -245]": ", tool.xyz: [4, 0, -245] m; expected at most 2 m on "
    "this arm: is it in mm?",
    "[motors]\nefficiency = 86": ", motors.efficiency: 86; expected at most 1: is it "
    "in %?",
    "[motors]\nrotor_inertia = {axis_e = 0.5}": ", motors.rotor_inertia.axis_e: 0.5 "
    "kg m^2; expected at most 0.0013 kg m^2 for a small motor: is it in kg mm^2?",
    '[motors]\nconstants = "measured"': ", motors.constants: unknown 'measured'; "
    "choose from printed, torque, voltage",
    "[motors]\nsupply_voltage = true": ", motors.supply_voltage: True; expected a "
    "number",
}
#: Whole content -> the message after the file's name.
WRONG_FORMAT = {
    'name = "a"': ", format: missing; write format = 1",
    "format = 2": ", format: 2; this version reads format = 1",
    'format = "1"': ", format: '1'; this version reads format = 1",
    "format = 1\nformat = 1": ": Cannot overwrite a value (at end of document)",
    "format 1": ": Expected '=' after a key in a key/value pair (at line 1, column 8)",
    "a" + ".a" * 30 + " = 1": ", line 1: a key of more than 20 parts",
    "format = " + "[" * 20000: ": expected fewer brackets inside one another",
    "#" * 70000: ": more than 64 KiB, an arm file (TOML) is expected",
}


def test_there_are_more_than_forty_wrong_files() -> None:
    assert len(WRONG) + len(WRONG_FORMAT) > 50


@pytest.mark.parametrize("text", WRONG)
def test_a_wrong_value_gets_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, f"format = 1\n{text}")
    assert str(caught.value) == f"{tmp_path / 'my_arm.toml'}{WRONG[text]}"


@pytest.mark.parametrize("text", WRONG_FORMAT)
def test_a_wrong_file_gets_one_line(tmp_path: Path, text: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, text)
    assert str(caught.value) == f"{tmp_path / 'my_arm.toml'}{WRONG_FORMAT[text]}"


def test_no_file_a_folder_and_no_text(tmp_path: Path) -> None:
    with pytest.raises(MissingFileError, match="expected an arm file"):
        a5.arm_file(tmp_path / "none.toml")
    with pytest.raises(FileFormatError, match="is a folder"):
        a5.arm_file(tmp_path)
    with pytest.raises(InputError, match="the path of an arm file"):
        a5.arm_file(None)  # type: ignore[arg-type]
    (tmp_path / "a.toml").write_bytes(b"format = 1\n\xff")
    with pytest.raises(FileFormatError, match="UTF-8"):
        a5.arm_file(tmp_path / "a.toml")
    with pytest.raises(FileFormatError, match="more than 64 KiB"):
        a5.arm_file("/dev/zero")


#: Values that make other readers slow, or fail.
HOSTILE = [
    "1e999999999999999999999999",
    "1e-999999999999999999999999",
    "-1e9999999",
    "9" * 4000,
    "9" * 6000,
    "0." + "1" * 60000,
    "1979-05-27",
    "[[[[[[1]]]]]]",
    '"' + "a" * 60000 + '"',
    "{" + ", ".join(f"k{i} = 1" for i in range(4000)) + "}",
    "[" + "1, " * 20000 + "]",
    "inf",
    "true",
]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
@pytest.mark.parametrize("number", range(len(HOSTILE)))
@pytest.mark.parametrize(
    "key",
    [
        "name",
        "corrections",
        "[lengths]\na_0",
        "[links.link_2]\ninertia",
        "[motors]\nrotor_inertia",
        "lengths",
        "attached",
    ],
)
def test_hostile_values_are_refused_at_once(
    tmp_path: Path, key: str, number: int
) -> None:
    message = ""

    def try_to_read() -> None:
        nonlocal message
        try:
            read(tmp_path, f"format = 1\n{key} = {HOSTILE[number]}")
        except Alpha5Error as error:
            message = str(error)

    assert least_time(try_to_read, 1.0) < 1.0
    assert "\n" not in message
    assert len(message) < 1001
    # A number that vanishes is a rotor without inertia; 0.1111... is a length.
    accepted = (key.startswith("[motors]") and "e-" in HOSTILE[number]) or (
        key.startswith("[lengths]") and HOSTILE[number].startswith("0.1")
    )
    assert bool(message) != accepted
