"""Arm files: what they may say, and one line for each mistake."""

from __future__ import annotations

import dataclasses
import math
import re
import time
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    ImplausibleWarning,
    InputError,
    MissingFileError,
)
from alpha5_model.numbers import arm_schema
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue
from alpha5_model.numbers.tables import JOINT_NAMES

ARM = a5.parameters()
#: An attached body with no more than it needs.
SENSOR = '[[attached]]\nname = "s"\nlink = "link_4"\nat = [0, 0, 0]\nmass = 0.5\n'
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
    assert flat(read(tmp_path, arm_file_text(ARM, every_key=True))) == flat(ARM)
    assert flat(read(tmp_path, "format = 1")) == flat(ARM)
    assert is_catalogue(read(tmp_path, "format = 1"))
    assert not is_catalogue(read(tmp_path, 'format = 1\nname = "mine"'))
    literal = read(tmp_path, "format = 1\ncorrections = []")
    assert flat(literal) == flat(a5.parameters(()))


def test_a_new_file_shows_every_key() -> None:
    text = arm_file_text(ARM, every_key=True)
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
        unknown = {"max_acceleration", "max_jerk"}  # no catalogue has them
        for name, keys in schema.items():
            assert given[part][name].keys() == keys.keys() - unknown
    assert given["signs"] == dict.fromkeys(JOINT_NAMES, 1)
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


def test_signs_accelerations_and_jerks(tmp_path: Path) -> None:
    own = read(
        tmp_path,
        """
format = 1
[signs]
axis_b = -1
[joint_limits.axis_c]
max_acceleration = {value = 90, unit = "deg/s^2", source = "MoveIt"}
max_jerk = 20
[joint_limits.axis_a]
max_acceleration = {value = 10, unit = "mm/s^2"}
""",
    )
    assert [joint.sign for joint in own.joints] == [1, 1, 1, -1, 1]
    assert own.signs.tolist() == [1.0, 1.0, 1.0, -1.0, 1.0]
    assert own.joints[2].acceleration == pytest.approx(math.pi / 2, rel=1e-15)
    assert (own.joints[2].jerk, own.joints[4].acceleration) == (20.0, 0.01)
    assert own.joints[0].acceleration is own.joints[0].jerk is None
    assert flat(read(tmp_path, arm_file_text(own))) == flat(own)


# --- numbers --------------------------------------------------------------------------


def test_every_number_takes_a_unit_a_source_and_a_half_width(tmp_path: Path) -> None:
    for key, text in {
        "mount.xyz": "[mount]\nxyz = ",
        "mount.rpy": "[mount]\nrpy = ",
        "lengths.a_1": "[lengths]\na_1 = ",
        "zeros.axis_c": "[zeros]\naxis_c = ",
        "joint_limits.axis_c.max_effort": "[joint_limits.axis_c]\nmax_effort = ",
        "links.link_2.mass": "[links.link_2]\nmass = ",
        "links.link_2.com": "[links.link_2]\ncom = ",
        "tool.xyz": "[tool]\nxyz = ",
    }.items():
        number = {"com": "[74, 0, 0]", "xyz": "[4, 0, -190]", "rpy": "[1, 2, 3]"}.get(
            key.rpartition(".")[2], "1"
        )
        unit = {"a_1": "cm", "xyz": "mm", "com": "mm", "max_effort": "N m"}.get(
            key.rpartition(".")[2], "kg" if "mass" in key else "deg"
        )
        number = "15.1" if unit == "cm" else number
        whole = f'value = {number}, unit = "{unit}", source = "me", half_width = 0'
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)
            own = read(tmp_path, f"format = 1\n{text}{{{whole}}}")
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

#: Content -> the key of the warning.
ODD = {
    "[lengths]\na_1 = 0.18": "lengths.a_1",
    "[zeros]\naxis_b = 0.2": "zeros.axis_b",
    "[joint_limits.axis_e]\nmin_position = 0": "joint_limits.axis_e.min_position",
    "[joint_limits.axis_d]\nmax_position = 3.5": "joint_limits.axis_d.max_position",
    "[joint_limits.axis_c]\nmax_velocity = 0.6": "joint_limits.axis_c.max_velocity",
    "[links.link_2]\nmass = 0.2": "links.link_2.mass",
    "[links.link_2]\ncom = [0.0736, 0.09, 0]": "links.link_2.com",
    "[links.link_2]\ncob = [0.3, 0, 0]": "links.link_2.cob",
    "[links.link_2]\ninertia = [[2, 0, 0], [0, 2, 0], [0, 0, 2]]": (
        "links.link_2.inertia"
    ),
    SENSOR: "attached.s.volume",
}


@pytest.mark.parametrize("text", ODD)
def test_what_is_odd_is_warned_of_with_the_file_and_the_key(
    tmp_path: Path, text: str
) -> None:
    with pytest.warns(ImplausibleWarning) as found:
        read(tmp_path, f"format = 1\n{text}")
    messages = [str(warning.message) for warning in found]
    start = f"{tmp_path / 'my_arm.toml'}: {ODD[text]}"
    assert any(message.startswith(start) for message in messages), messages
    assert all(warning.filename == __file__ for warning in found)


# --- wrong files ----------------------------------------------------------------------

SENSOR_4 = SENSOR + "volume = 1e-4\n"
#: Content after "format = 1" -> the key that the error names; none if the table has no
#: such key at all.
WRONG = {
    "speed = 1": "",
    "lenghts = {}": "",
    'name = "my arm"': "name",
    'corrections = "base_frame"': "corrections",
    'corrections = ["baseframe"]': "corrections",
    "[mount]\nxyz = [210, 0, -85]": "mount.xyz",
    "[mount]\nrpy = [180, 0, 0]": "mount.rpy",
    "[mount]\nposition = [0, 0, 0]": "mount",
    "[mount]\nxyz = [0, 0]": "mount.xyz",
    "[lengths]\na_1 = 150.9": "lengths.a_1",
    "[lengths]\na_0 = -0.02": "lengths.a_0",
    "[lengths]\nd_3 = 0.18": "lengths.d_3",
    "[lengths]\nalpha_1 = 0.003": "lengths",
    '[lengths]\na_0 = {value = 2, unit = "inch"}': "lengths.a_0",
    "[lengths]\na_0 = {valeu = 2}": "lengths.a_0",
    '[lengths]\na_0 = {unit = "mm"}': "lengths.a_0.value",
    '[lengths]\na_0 = {value = 20, unit = "m m"}': "lengths.a_0",
    "[signs]\naxis_b = 0": "signs.axis_b",
    '[signs]\naxis_b = "-1"': "signs.axis_b",
    "[signs]\naxis_z = -1": "signs",
    "[joint_limits.axis_e]\nmax_acceleration = -1": (
        "joint_limits.axis_e.max_acceleration"
    ),
    "[joint_limits.axis_e]\nmax_jerk = 0": "joint_limits.axis_e.max_jerk",
    '[lengths]\na_0 = "20 mm"': "lengths.a_0",
    "[lengths]\na_0 = nan": "lengths.a_0",
    "[zeros]\naxis_a = 0.01": "zeros",
    "[zeros]\naxis_d = 20": "zeros.axis_d",
    "[joint_limits.axis_f]\nmin_position = 1": "joint_limits",
    "[joint_limits.axis_e]\nmin_position = 3.49\nmax_position = 1.75": (
        "joint_limits.axis_e"
    ),
    "[joint_limits.axis_b]\nmin_position = -3.2\nmax_position = 3.2": (
        "joint_limits.axis_b"
    ),
    "[joint_limits.axis_e]\nmax_position = 330": "joint_limits.axis_e.max_position",
    "[joint_limits.axis_e]\nmax_velocity = 20": "joint_limits.axis_e.max_velocity",
    "[joint_limits.axis_e]\neffort = 1": "joint_limits.axis_e",
    "[joint_limits.axis_e]\nmax_effort = 0": "joint_limits.axis_e.max_effort",
    "[joint_limits.axis_a]\nmax_position = 13.3": "joint_limits.axis_a.max_position",
    "[links.link_2]\nmass = -1": "links.link_2.mass",
    "[links.link_2]\nmass = 341": "links.link_2.mass",
    '[links.link_2]\nmass = {value = 341, unit = "g", half_width = 400}': (
        "links.link_2.mass.half_width"
    ),
    "[links.link_2]\nvolume = 0.218": "links.link_2.volume",
    "[links.link_2]\ncom = [0.0736, 0.9, 0]": "links.link_2.com",
    "[links.link_2]\ncom = [0.73, -0.91, -0.73]": "links.link_2.com",
    "[links.link_2]\ninertia = [[1e-4, 0, 0], [0, 1e-4, 0], [0, 0, 3e-4]]": (
        "links.link_2.inertia"
    ),
    "[links.link_2]\ninertia = [[1e-4, 1e-5, 0], [0, 1e-4, 0], [0, 0, 1e-4]]": (
        "links.link_2.inertia"
    ),
    "[links.link_4]\nmass = 0.03": "links.link_4",
    "[links.link_9]\nmass = 1": "links",
    '[attached]\nname = "s"': "attached",
    "[tool]\nxyz = [0, 0, -0.5]": "tool.xyz",
    "[tool]\nxyz = [4, 0, -245]": "tool.xyz",
    "[motors]\nefficiency = 86": "motors.efficiency",
    "[motors]\nrotor_inertia = {axis_e = 0.5}": "motors.rotor_inertia.axis_e",
    '[motors]\nconstants = "measured"': "motors.constants",
    "[motors]\nsupply_voltage = true": "motors.supply_voltage",
    "[lengths]\na_0 = 0": "lengths.a_0",
    "[joint_limits.axis_e]\nmin_position = 1.5\nmax_position = 1.5": (
        "joint_limits.axis_e"
    ),
    "[joint_limits.axis_a]\nmin_position = 0.02": "joint_limits.axis_a",
    '[joint_limits.axis_b]\nmax_position = {value = 360, unit = "deg"}': (
        "joint_limits.axis_b"
    ),
    "[links.link_2]\ncom = [0.07361234567, 0.9, 0]": "links.link_2.com",
    "[links.link_2]\ncom = [0, 0, 0, 0]": "links.link_2.com",
    "[links.link_2]\ninertia = 3": "links.link_2.inertia",
    "[links.link_2]\nmass = {value = 0.341, half_width = -0.001}": (
        "links.link_2.mass.half_width"
    ),
    "[motors]\ngear_ratio = 1000000000000.5": "motors.gear_ratio",
    SENSOR_4.replace("at = [0, 0, 0]\n", ""): "attached[0].at",
    SENSOR_4.replace("link_4", "link4"): "attached.s.link",
    SENSOR_4 + SENSOR_4: "attached[1].name",
    SENSOR_4 + "spacer = 22": "attached.s.spacer",
    SENSOR_4.replace("link_4", "link_3") + "spacer = 0.02": "attached.s.spacer",
    SENSOR_4 + "spacer = 0.02\n[tool]\nxyz = [0, 0, -0.18]": "tool.xyz",
    SENSOR_4 + "spacer = 0.02\n[tool]\nxyz = [0, 0, -0.19]": "tool.xyz",
    SENSOR.replace("mass = 0.5", "mass = -0.5"): "attached.s.mass",
}
#: Whole content -> what the error names.
WRONG_FORMAT = {
    'name = "a"': "format",
    "format = 0": "format",
    "format = 2": "format",
    'format = "1"': "format",
    "format = 1\nformat = 1": "",
    "format 1": "",
    "a" + ".a" * 30 + " = 1": "line 1",
    "format = " + "[" * 20000: "",
    "#" * 70000: "",
}


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_an_error_is_one_line_with_the_file_and_the_key(tmp_path: Path) -> None:
    cases = {f"format = 1\n{text}": key for text, key in WRONG.items()} | WRONG_FORMAT
    found = {}
    for text in cases:
        with pytest.raises(FileFormatError) as caught:
            read(tmp_path, text)
        assert str(caught.value).startswith(str(tmp_path / "my_arm.toml")), text
        assert "\n" not in str(caught.value)
        found[text] = caught.value.place
    assert found == cases


def test_a_unit_that_was_forgotten_is_proposed(tmp_path: Path) -> None:
    """Fifteen centimetres in mm, degrees, grammes, litres."""
    for text, unit in {
        "[lengths]\na_1 = 150.9": "mm",
        "[zeros]\naxis_d = 20": "deg",
        "[links.link_2]\nmass = 341": "g",
        "[links.link_2]\nvolume = 0.218": "L",
        "[joint_limits.axis_c]\nmax_acceleration = 60": "deg/s^2",
    }.items():
        with pytest.raises(FileFormatError, match=f"if it is in {re.escape(unit)}, "):
            read(tmp_path, f"format = 1\n{text}")


def test_the_ends_of_what_a_file_may_say(tmp_path: Path) -> None:
    half = "[links.link_2]\nmass = {value = 0.34, half_width = 0.34}"
    assert read(tmp_path, f"format = 1\n{half}").measurements[0].half_width == 0.34
    weightless = SENSOR.replace("mass = 0.5", "mass = 0\nspacer = 0\nvolume = 0")
    (body,) = read(tmp_path, f"format = 1\n{weightless}").attached
    assert (body.mass, body.spacer, body.volume) == (0.0, 0.0, 0.0)


def test_a_file_may_have_64_kib(tmp_path: Path) -> None:
    text = "format = 1\n#"
    assert read(tmp_path, text + "a" * (64 * 1024 - len(text))).name == ARM.name
    with pytest.raises(FileFormatError, match="64 KiB"):
        read(tmp_path, text + "a" * (64 * 1024 - len(text) + 1))


def test_32_bodies_are_attached_and_no_more(tmp_path: Path) -> None:
    one = SENSOR.replace("0.5", "0.001\nvolume = 1e-6")

    def bodies(count: int) -> str:
        several = [one.replace('"s"', f'"s{k}"') for k in range(count)]
        return "format = 1\n" + "".join(several)

    assert len(read(tmp_path, bodies(32)).attached) == 32
    with pytest.raises(FileFormatError) as caught:
        read(tmp_path, bodies(33))
    assert caught.value.place == "attached"


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
def test_hostile_values_are_refused_at_once(tmp_path: Path, key: str) -> None:
    accepted = []
    for value in HOSTILE:
        text = f"format = 1\n{key} = {value}"
        message = ""
        start = time.process_time()
        try:
            read(tmp_path, text)
            accepted.append(value[:6])
        except Alpha5Error as error:
            message = str(error)
        assert time.process_time() - start < 10.0
        assert "\n" not in message
        assert len(message) < 1001
    # A number that vanishes is a rotor without inertia; 0.1111... is a length.
    expected = {"[motors]\nrotor_inertia": ["1e-999"], "[lengths]\na_0": ["0.1111"]}
    assert accepted == expected.get(key, [])
