"""Arm files just within, and just beyond, what a file may say."""

from __future__ import annotations

import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from arm_keys import SENSOR

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, ImplausibleWarning
from alpha5_model.numbers import arm_schema
from alpha5_model.numbers.arm_values import shown
from alpha5_model.numbers.arm_writing import new_arm_file
from alpha5_model.numbers.inertia import flip_products
from alpha5_model.numbers.parameters import Alpha5Parameters

ARM = a5.parameters()


def read(folder: Path, text: str) -> Alpha5Parameters:
    path = folder / "my_arm.toml"
    path.write_text(f"format = 1\n{text}", encoding="utf-8")
    return a5.arm_file(path)


def refusal(folder: Path, text: str) -> str:
    """The message of a file that is refused, after the file's name."""
    with pytest.raises(FileFormatError) as caught:
        read(folder, text)
    return str(caught.value).removeprefix(f"{folder / 'my_arm.toml'}")


#: Content after "format = 1" -> the message after the file's name.
BEYOND = {
    "[lengths]\na_0 = 0": ", lengths.a_0: 0 m; expected a length above 0, as Table 1's "
    "0.02 m",
    "[joint_limits.axis_e]\nmin_position = 1.5\nmax_position = 1.5": ", "
    "joint_limits.axis_e: min_position 1.5 is not below max_position 1.5 rad",
    "[joint_limits.axis_a]\nmin_position = 0.02": ", joint_limits.axis_a: min_position "
    "0.02 is not below max_position 0.0133 m",
    '[joint_limits.axis_b]\nmax_position = {value = 360, unit = "deg"}': ", "
    "joint_limits.axis_b: min_position 0 to max_position 6.283 rad; expected less "
    "than a full turn",
    "[links.link_2]\ncom = [0.07361234567, 0.09, 0]": ", links.link_2.com: [0.073612, "
    "0.09, 0.0] m; expected a point inside the body's bounds, [[-0.02, 0.1707], "
    "[-0.0333, 0.0333], [-0.02, 0.02]] m",
    "[links.link_2]\ncom = [0, 0, 0, 0]": ", links.link_2.com: [0, 0, 0, 0]; expected "
    "3 numbers",
    "[links.link_2]\ninertia = 3": ", links.link_2.inertia: 3; expected 3 rows of 3 "
    "numbers",
    "[links.link_2]\nmass = {value = 0.341, half_width = -0.001}": ", "
    "links.link_2.mass.half_width: -0.001 kg; expected 0 to the value (it has the "
    "value's unit)",
    SENSOR.replace("mass = 0.5", "mass = -0.5"): ", attached.s.mass: -0.5 kg; expected "
    "at least 0 kg",
    "[motors]\ngear_ratio = 1000000000000.5": ", motors.gear_ratio: 1000000000000.5; "
    "expected a number below 1e12",
}


@pytest.mark.parametrize("text", BEYOND)
def test_just_beyond(tmp_path: Path, text: str) -> None:
    assert refusal(tmp_path, text) == BEYOND[text]


def test_format_0_is_another_format(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    path.write_text("format = 0")
    with pytest.raises(FileFormatError, match="0; this version reads format = 1"):
        a5.arm_file(path)


def test_just_within(tmp_path: Path) -> None:
    assert read(tmp_path, "[motors]\ngear_ratio = 999999999999.5").actuators
    whole = "[links.link_2]\nmass = {value = 0.34, half_width = 0.34}"
    assert read(tmp_path, whole).measurements[0].half_width == 0.34
    weightless = SENSOR.replace("mass = 0.5", "mass = 0\nspacer = 0\nvolume = 0")
    (body,) = read(tmp_path, weightless).attached
    assert (body.mass, body.spacer, body.volume) == (0.0, 0.0, 0.0)


def test_a_file_may_have_64_kib(tmp_path: Path) -> None:
    path = tmp_path / "arm.toml"
    text = "format = 1\n#"
    path.write_text(text + "a" * (64 * 1024 - len(text)))
    assert a5.arm_file(path).name == ARM.name
    path.write_text(text + "a" * (64 * 1024 - len(text) + 1))
    with pytest.raises(FileFormatError, match="more than 64 KiB"):
        a5.arm_file(path)


def test_32_bodies_are_attached_and_no_more(tmp_path: Path) -> None:
    def bodies(count: int) -> str:
        one = SENSOR.replace("0.5", "0.001\nvolume = 1e-6")
        return "".join(one.replace('"s"', f'"s{k}"') for k in range(count))

    assert len(read(tmp_path, bodies(32)).attached) == 32
    message = refusal(tmp_path, bodies(33))
    assert message.endswith("; expected at most 32 tables [[attached]]")


@pytest.mark.parametrize("length", [1, 38, 39, 200])
def test_a_foreign_text_is_shown_in_40_characters(length: int) -> None:
    """Quotes included; the end of a longer one becomes three dots."""
    text = "".join(chr(ord("a") + k % 26) for k in range(length))
    found = shown(text)
    if length <= 38:
        assert found == repr(text)
    else:
        assert len(found) == 40
        assert found == repr(text)[:37] + "..."


# --- what is odd ----------------------------------------------------------------------


def warnings_of(folder: Path, text: str) -> list[str]:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        read(folder, text)
    assert all(warning.category is ImplausibleWarning for warning in found)
    return [str(warning.message).partition(".toml: ")[2] for warning in found]


@pytest.mark.parametrize(
    ("usual", "odd", "said"),
    [
        ("[lengths]\na_2 = 0.0399", "[lengths]\na_2 = 0.0401", "lengths.a_2: 0.0401 m"),
        (
            '[zeros]\naxis_e = {value = 9.9, unit = "deg"}',
            '[zeros]\naxis_e = {value = 10.1, unit = "deg"}',
            "zeros.axis_e: 0.1763 rad is more than 10 deg off",
        ),
        (
            "[links.link_2]\nmass = 0.455",
            "[links.link_2]\nmass = 0.457",
            "links.link_2.mass: 0.457 kg with the printed inertia",
        ),
        (
            "[joint_limits.axis_a]\nmin_position = 0.0013",
            "[joint_limits.axis_a]\nmin_position = 0.0012",
            "joint_limits.axis_a.min_position: 0.0012 m is beyond the published 0.0013 "
            "to 0.0133 m",
        ),
        (
            "[joint_limits.axis_a]\nmax_velocity = 0.003",
            "[joint_limits.axis_a]\nmax_velocity = 0.004",
            "joint_limits.axis_a.max_velocity: 0.004 m/s is faster than the rated",
        ),
        # 5 mm above the top of link 2, which is at 20 mm
        (
            "[links.link_2]\ncob = {value = [0.08, 0, 0.025], half_width = 0.006}",
            "[links.link_2]\ncob = {value = [0.08, 0, 0.025], half_width = 0.004}",
            "links.link_2.cob: (0.08, 0, 0.025) m is outside the body's bounds",
        ),
    ],
)
def test_where_a_number_becomes_odd(
    tmp_path: Path, usual: str, odd: str, said: str
) -> None:
    assert warnings_of(tmp_path, usual) == []
    (message,) = warnings_of(tmp_path, odd)
    assert message.startswith(said)


# --- the file with every key ----------------------------------------------------------


def printed_numbers(given: Any) -> Any:
    """Values of a file in their own units, without the units."""
    return given["value"] if isinstance(given, dict) else given


def test_a_new_file_has_every_motor_of_every_quantity() -> None:
    motors = tomllib.loads(new_arm_file())["motors"]
    for name in arm_schema.ACTUATORS:
        assert [*motors[name]] == [joint.name for joint in ARM.joints]
    resistances = [printed_numbers(x) for x in motors["resistance"].values()]
    assert resistances == [row.resistance for row in ARM.actuators]


def test_a_new_file_calls_placeholders_so() -> None:
    """The document prints no effort; what everybody writes is a placeholder."""
    lines = new_arm_file().splitlines()
    called = [line for line in lines if line.endswith("(a placeholder)")]
    assert len(called) == 5
    assert all(line.startswith("max_effort = ") for line in called)


def test_a_new_file_has_the_products_of_inertia_of_a_urdf() -> None:
    links = tomllib.loads(new_arm_file())["links"]
    for link, row in zip(links.values(), a5.published().table_2.rows, strict=True):
        printed = np.array([[x.value for x in line] for line in row.inertia_com], float)
        found = np.array(printed_numbers(link["inertia"]))
        np.testing.assert_array_equal(found, flip_products(printed))


def test_the_numbers_of_a_covariance_are_components() -> None:
    """For each of 5 links 1 + 3 + 6 + 1 + 3, then 4 zeros and 5 lengths."""
    assert len({*arm_schema.NUMBERS}) == len(arm_schema.NUMBERS) == 5 * 14 + 4 + 5
    tensor = [n for n in arm_schema.NUMBERS if n.startswith("links.link_3.inertia")]
    assert [n.rpartition(".")[2] for n in tensor] == [
        "xx",
        "xy",
        "xz",
        "yy",
        "yz",
        "zz",
    ]
    assert "links.link_0.com.z" in arm_schema.NUMBERS
    assert "links.link_4.volume" in arm_schema.NUMBERS


@pytest.mark.parametrize(
    ("key", "number", "takes"),
    [
        (arm_schema.LINKS["link_2"]["mass"], 20.0, True),
        (arm_schema.LINKS["link_2"]["mass"], 20.1, False),
        (arm_schema.LENGTHS["d_3"], -2.0, True),
        (arm_schema.LENGTHS["d_3"], -2.1, False),
        (arm_schema.LINKS["link_2"]["inertia"], 1e6, True),  # of any size
    ],
)
def test_what_numbers_a_key_takes(
    key: arm_schema.Key, number: float, takes: bool
) -> None:
    assert key.takes(number) == takes
