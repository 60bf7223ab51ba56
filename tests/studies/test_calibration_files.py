"""Files of poses and readings: what is read, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, InputError

calibrate = a5.calibrate
Q = [[3.0, 1.5, 1.25, 0.5], [0.1, 0.2, 1.0, -0.0]]


def test_zeroed_scales_stay_zeroed(tmp_path: Path) -> None:
    """However noisy they are."""
    for make in (calibrate.scales, calibrate.weight):
        for zeroed, noise in ((True, 3.0), (True, 1e-4), (False, 0.7)):
            sensor = make(zeroed=zeroed, noise=noise)
            path = tmp_path / "plan.toml"
            text = calibrate.session_text(calibrate.session(sensor, Q))
            path.write_text(text, "utf-8")
            again = calibrate.read_session(path).sensor
            assert np.array_equal(again.offset, sensor.offset)
            if zeroed:
                assert np.allclose(sensor.offset, 2 * noise)


def read(tmp_path: Path, text: str) -> calibrate.Session:
    path = tmp_path / "session.toml"
    path.write_text(text, "utf-8")
    return calibrate.read_session(path)


ONE_SCALE = 'format = 1\nsensor = "weight"\n'
POSE = "[[pose]]\nangles = [10, 90, 90, 0]\n"


def test_units_and_fluids(tmp_path: Path) -> None:
    kilograms = read(tmp_path, f'{ONE_SCALE}unit = "kg"\n{POSE}readings = [1.5]')
    assert kilograms.readings == pytest.approx(np.array([[1.5]]))
    assert kilograms.density == a5.AIR
    grams = read(tmp_path, f"{ONE_SCALE}fluid = 1012.5\n{POSE}readings = [999999999]")
    assert grams.readings == pytest.approx(np.array([[999999.999]]))
    assert grams.density == 1012.5
    efforts = ONE_SCALE.replace("weight", "efforts")
    values = f'{efforts}unit = "mN m"\nfluid = "sea"\n{POSE}readings = [1, 2, 3, 4]'
    found = read(tmp_path, values)
    assert found.readings == pytest.approx(np.array([[1e-3, 2e-3, 3e-3, 4e-3]]))
    assert found.density == a5.SEA_WATER
    assert found.motion.q == pytest.approx(np.radians([[10, 90, 90, 0]]))
    tilt = (
        f'{ONE_SCALE}unit = "rad"\n{POSE}readings = [0.1, -0.2]\n[settings.vehicle]\n'
    )
    tilt += "mass = 10\ncom = [0, 0, -0.1]\nvolume = 0.0099\ncob = [0, 0, 0.1]"
    tilt = tilt.replace("weight", "vehicle-tilt").replace("unit", 'fluid = "sea"\nunit')
    assert read(tmp_path, tilt).readings == pytest.approx(np.array([[0.1, -0.2]]))


def test_one_scale_feels_the_gravity_of_the_file(tmp_path: Path) -> None:
    gravity = [0.0, -9.81, 0.0]
    found = read(tmp_path, f"{ONE_SCALE}gravity = {gravity}\n{POSE}")
    assert np.array_equal(found.motion.gravity, gravity)
    assert found.sensor.matrix == pytest.approx(calibrate.weight(gravity).matrix)
    assert not found.is_read


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f'format = true\nsensor = "weight"\n{POSE}', "reads format = 1"),
        (f"{ONE_SCALE}pose = []", "pose: expected 1 to 2000 tables"),
        (f"{ONE_SCALE}pose = 3", "pose: expected 1 to 2000 tables"),
        (f"{ONE_SCALE}pose = [3]", "pose 1: expected a table"),
        (f"{ONE_SCALE}settings = 3\n{POSE}", "settings: expected a table"),
        (f"{ONE_SCALE}fluid = true\n{POSE}", "fluid: True; expected a name or"),
        (f"{ONE_SCALE}{POSE}[[pose]]\nreadings = [1]", "pose 2: angles: missing"),
        (f"{ONE_SCALE}{POSE}readings = [true]", "readings: True; expected 1 numbers"),
        (f"{ONE_SCALE}{POSE}readings = [1000000000]", "readings: 1000000000;"),
        (f"{ONE_SCALE}{POSE}readings = [-inf]", "readings: -inf; expected 1 numbers"),
        (f"{ONE_SCALE}{POSE}readings = 3", "readings: expected 1 numbers: scale"),
        (
            f"{ONE_SCALE}{POSE}".replace("weight", "vehicle-tilt"),
            "settings: vehicle: missing",
        ),
    ],
)
def test_more_that_is_refused(text: str, message: str, tmp_path: Path) -> None:
    with pytest.raises(FileFormatError, match="session") as caught:
        read(tmp_path, text)
    assert message in str(caught.value)


def test_files_of_other_bytes_and_sizes(tmp_path: Path) -> None:
    """256 KiB and 2000 poses are enough."""
    path = tmp_path / "session.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(FileFormatError, match="TOML, which is UTF-8"):
        calibrate.read_session(path)
    text = f"{ONE_SCALE}{POSE}#"
    most = 256 * 1024
    assert len(read(tmp_path, text.ljust(most, "-")).motion.q) == 1
    with pytest.raises(FileFormatError):
        read(tmp_path, text.ljust(most + 1, "-"))
    assert len(read(tmp_path, ONE_SCALE + 2000 * POSE).motion.q) == 2000
    with pytest.raises(FileFormatError, match="expected 1 to 2000 tables"):
        read(tmp_path, ONE_SCALE + 2001 * POSE)


# --- what sessions refuse -------------------------------------------------------------


def test_readings_may_have_gaps() -> None:
    for given in ([[np.nan], [1.5]], np.array([[np.nan], [1.5]]), ((np.nan,), (1.5,))):
        found = calibrate.session(calibrate.weight(), Q, given)
        np.testing.assert_array_equal(found.readings, [[np.nan], [1.5]])
    whole = calibrate.session(calibrate.weight(), Q, [[1], [2]])
    np.testing.assert_array_equal(whole.readings, [[1.0], [2.0]])


def test_positions_are_rows() -> None:
    with pytest.raises(InputError, match="q: expected at least one pose"):
        calibrate.session(calibrate.weight(), Q[0])
    moving = calibrate.session(calibrate.efforts(), Q, v=np.ones((2, 4)))
    assert not moving.motion.a.any()
    assert not moving.motion.rests
    assert not calibrate.session(calibrate.efforts(), Q, a=np.ones((2, 4))).motion.rests
    with pytest.raises(InputError, match="v: expected"):
        calibrate.session(calibrate.efforts(), Q, v=np.ones((2, 3)))
    with pytest.raises(InputError, match="a: expected"):
        calibrate.session(calibrate.efforts(), Q, a=np.ones((1, 4)))
