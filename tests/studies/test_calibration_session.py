"""Files of states and readings: what is written is read again, and what is refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from support.weighing import VEHICLE, random_q, rotation

import alpha5_model as a5
from alpha5_model.errors import FileFormatError, ImplausibleWarning, InputError
from alpha5_model.studies.calibration import sessions

calibrate = a5.calibrate
#: Sensors whose channels all differ, and readings that they can show.
SENSORS = {
    "scales": calibrate.scales(
        noise=[1e-3, 2e-3, 3e-3], gain=[0.1, 0.2, 0.3], placement=[0.0, 1e-3, 2e-3]
    ),
    "zeroed": calibrate.scales(noise=0.03, zeroed=True),
    "weight": calibrate.weight(noise=0.007, zeroed=False),
    "cell": calibrate.force_torque(
        force_noise=[0.1, 0.2, 0.3], torque_noise=[1e-3, 2e-3, 3e-3], gain=0.0
    ),
    "efforts": calibrate.efforts(noise=[1e-3, 2e-3, 3e-3, 4e-3], offset=0.125),
    "tilt": calibrate.vehicle_tilt(VEHICLE, yaw=0.7),
}


@pytest.mark.parametrize("kind", SENSORS)
@pytest.mark.parametrize("moves", [False, True])
def test_a_file_reads_back(kind: str, moves: bool, tmp_path: Path) -> None:
    sensor = SENSORS[kind]
    if moves and kind == "tilt":
        return
    rates = np.random.default_rng(2).normal(size=(2, 4, 4)) if moves else [None, None]
    readings = np.arange(4.0 * sensor.size).reshape(4, -1) / 7 - 0.3
    readings = readings if kind != "tilt" else readings / 10
    readings[1] = np.nan
    readings[2, 0] = np.nan
    written = calibrate.session(
        sensor, random_q(4), readings, fluid_density=1012.5, v=rates[0], a=rates[1]
    )
    path = tmp_path / "plan.toml"
    path.write_text(calibrate.session_text(written), "utf-8")
    again = calibrate.read_session(path)
    for name in ("readings", "q", "v", "a", "gravity", "density"):
        one, other = getattr(again, name), getattr(written, name)
        np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12, err_msg=name)
    assert again.moves is moves
    assert again.sensor.kind == sensor.kind
    ours = sensor.settings()
    assert again.sensor.settings().keys() == ours.keys()
    for name, value in again.sensor.settings().items():
        if isinstance(value, dict):
            # An angle of half a turn may come back as minus that.
            turns = [rotation(table.pop("rpy")) for table in (value, ours[name])]
            np.testing.assert_allclose(*turns, atol=1e-9)
            for key in value:
                np.testing.assert_allclose(value[key], ours[name][key], rtol=1e-9)
        else:
            np.testing.assert_allclose(value, ours[name], rtol=1e-9, err_msg=name)
    mine = [one.deviation for one in sensor.own(moves)]
    for one, other in zip(again.sensor.own(moves), mine, strict=True):
        np.testing.assert_allclose(one.deviation, other, rtol=1e-9)


@dataclass(frozen=True, eq=False)
class Along(calibrate.Sensor):
    """The force on the mount along a direction; a sensor that someone adds."""

    kind = "along"
    channels = ("force",)
    unit = ("N",)
    units = MappingProxyType({"N": 1.0})
    guide = ()

    direction: np.ndarray
    noise: np.ndarray
    serial: str

    @property
    def deviation(self) -> np.ndarray:
        return self.noise

    def own(self, moves: bool) -> tuple[calibrate.Own, ...]:
        return ()

    def read(self, loads: calibrate.Loads, own: Any) -> np.ndarray:
        return np.asarray(loads.total[:, 4:7] @ self.direction[:, None])


def along(
    direction: Any = (1.0, 0.0, 0.0),
    *,
    noise: float = 0.1,
    gain: float = 0.01,
    serial: str = "",
) -> Along:
    directed = np.array(direction, float)
    assert directed.shape == (3,)
    return Along(
        direction=directed,
        noise=np.array([noise]),
        gain=np.array([gain]),
        serial=serial,
    )


def test_a_vector_of_equal_numbers_stays_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sessions.SENSORS, "along", along)  # type: ignore[call-overload]
    equal = np.ones(3) / np.sqrt(3)
    for serial in ("", 'N° 7 "left" \\ b'):
        sensor = along(equal, noise=0.25, serial=serial)
        written = calibrate.session(sensor, random_q(2))
        path = tmp_path / "plan.toml"
        path.write_text(calibrate.session_text(written), "utf-8")
        again = calibrate.read_session(path).sensor.settings()
        assert again["direction"] == pytest.approx(equal, rel=1e-9)
        assert again["noise"] == pytest.approx([0.25])
        assert again["serial"] == serial


@pytest.mark.slow
def test_the_longest_session_reads_back(tmp_path: Path) -> None:
    """What `session` takes, `session_text` writes and `read_session` reads."""
    rng = np.random.default_rng(1)
    q, v, a = rng.uniform(0.1, 2.0, (3, 5000, 4))
    readings = rng.normal(size=(5000, 6))
    cell = calibrate.force_torque()
    path = tmp_path / "long.toml"
    longest = calibrate.session(cell, q, readings, v=v, a=a)
    path.write_text(calibrate.session_text(longest), "utf-8")
    assert path.stat().st_size < 4 << 20
    path.write_text(calibrate.session_text(longest) + "[[pose]]\nangles=[1,1,1,1]\n")
    with pytest.raises(FileFormatError, match="pose"):
        calibrate.read_session(path)
    with pytest.raises(InputError, match="poses"):
        calibrate.plan_poses(cell, 5001)


def read(tmp_path: Path, text: str) -> calibrate.Session:
    path = tmp_path / "session.toml"
    path.write_text(text, "utf-8")
    return calibrate.read_session(path)


ONE_SCALE = 'format = 1\nsensor = "weight"\n'
POSE = "[[pose]]\nangles = [10, 90, 90, 0]\n"


def test_units_fluids_and_gravity(tmp_path: Path) -> None:
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
    assert found.q == pytest.approx(np.radians([[10, 90, 90, 0]]))
    turned = read(tmp_path, f"{ONE_SCALE}gravity = [0, -9.81, 0]\n{POSE}")
    assert turned.gravity.tolist() == [0.0, -9.81, 0.0]
    assert not turned.is_read
    moving = f"{efforts}{POSE}readings = [1, 2, 3, 4]\nrates = [0, 90, 0, 0]\n"
    assert read(tmp_path, moving).v[0] == pytest.approx([0.0, np.pi / 2, 0.0, 0.0])


def test_wrong_files_get_one_line(tmp_path: Path) -> None:
    """With the place: the key, and the pose that it belongs to."""
    tilt = ONE_SCALE.replace("weight", "vehicle-tilt")
    three = ONE_SCALE.replace("weight", "scales")
    wrong = [
        ("format", f'sensor = "weight"\n{POSE}'),
        ("format", f'format = 2\nsensor = "weight"\n{POSE}'),
        ("format", f'format = true\nsensor = "weight"\n{POSE}'),
        ("sensor", f'format = 1\nsensor = "scale"\n{POSE}'),
        ("sensor", f"format = 1\nsensor = 3\n{POSE}"),
        ("pose", f"{ONE_SCALE}pose = []"),
        ("pose", f"{ONE_SCALE}pose = 3"),
        ("pose", ONE_SCALE),
        ("pose 1", f"{ONE_SCALE}pose = [3]"),
        ("'poses'", f"{ONE_SCALE}[poses]"),
        ("unit", f'{ONE_SCALE}unit = "oz"\n{POSE}'),
        ("fluid", f'{ONE_SCALE}fluid = "oil"\n{POSE}'),
        ("fluid", f"{ONE_SCALE}fluid = true\n{POSE}"),
        ("fluid", f"{ONE_SCALE}fluid = -3\n{POSE}"),
        ("gravity", f"{three}gravity = [9.81, 0, 0]\n{POSE}"),
        ("settings", f"{ONE_SCALE}settings = 3\n{POSE}"),
        ("settings: noise", f"{ONE_SCALE}{POSE}[settings]\nnoise = 0"),
        ("'nosie'", f"{ONE_SCALE}{POSE}[settings]\nnosie = 1"),
        ("settings: positions", f"{three}{POSE}[settings]\npositions = [[0,0,0]]"),
        ("settings: vehicle", f"{tilt}{POSE}"),
        ("'weight'", f"{tilt}{POSE}[settings.vehicle]\nweight = 3"),
        ("vehicle.com", f"{tilt}{POSE}[settings.vehicle]\nmass = 3"),
        ("pose 1: angles", f"{ONE_SCALE}[[pose]]\nangles = [10, 90, 90]"),
        ("pose 1: angles", f"{ONE_SCALE}[[pose]]\nangles = [10, 90, 90, nan]"),
        ("pose 2: angles", f"{ONE_SCALE}{POSE}[[pose]]\nreadings = [1]"),
        ("pose 1 'angle'", f"{ONE_SCALE}[[pose]]\nangle = [10, 90, 90, 0]"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = [1, 2]"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = ['372']"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = [true]"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = [1000000000]"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = [-inf]"),
        ("pose 1: readings", f"{ONE_SCALE}{POSE}readings = 0"),
        ("pose 1: rates", f"{ONE_SCALE}{POSE}rates = [1, 2, 3]"),
        ("", "\xff"),
    ]
    assert read(tmp_path, f"{ONE_SCALE}{POSE}readings = [nan]").q.shape == (1, 4)
    failures = []
    for place, text in wrong:
        try:
            read(tmp_path, text)
        except FileFormatError as error:
            said = str(error)
            if place not in said or "session.toml" not in said or "\n" in said:
                failures.append((place, said))
        else:
            failures.append((place, text))
    assert failures == []
    path = tmp_path / "session.toml"
    path.write_bytes(b"\xff\xfe")
    with pytest.raises(FileFormatError, match="UTF-8"):
        calibrate.read_session(path)
    path.write_text(f"{ONE_SCALE}{POSE}#".ljust((4 << 20) + 1, "-"), "utf-8")
    with pytest.raises(FileFormatError):
        calibrate.read_session(path)


def test_readings_may_have_gaps() -> None:
    q = random_q(2)
    planned = calibrate.session(calibrate.weight(), q)
    for given in ([[np.nan], [1.5]], np.array([[np.nan], [1.5]]), ((np.nan,), (1.5,))):
        found = calibrate.with_readings(planned, given)
        np.testing.assert_array_equal(found.readings, [[np.nan], [1.5]])
    wrong: list[Any] = [
        [1.0],
        np.ma.masked_array([[1.0], [2.0]], [[0], [1]]),
        [[1], []],
    ]
    for given in wrong:
        with pytest.raises(InputError, match="readings"):
            calibrate.with_readings(planned, given)


def test_a_file_given_twice_is_noticed() -> None:
    """Two names for one file would count its readings twice."""
    readings = np.linspace(1.1, 1.3, 4)[:, None]
    q = random_q(4, seed=3)
    first = a5.calibrate.session(a5.calibrate.weight(), q, readings, name="a.toml")
    copy = a5.calibrate.session(a5.calibrate.weight(), q, readings, name="b.toml")
    other = a5.calibrate.session(a5.calibrate.weight(), q, readings + 1e-3)
    with pytest.warns(ImplausibleWarning, match=r"b\.toml .* a\.toml"):
        a5.calibrate.fit([first, copy])
    a5.calibrate.fit([first, other])


def test_numbers_of_scales_in_grams_and_millimetres_are_noticed() -> None:
    for name, make in {
        "noise": lambda: a5.calibrate.scales(noise=0.3),
        "placement": lambda: a5.calibrate.scales(placement=0.5),
        "ballast": lambda: a5.calibrate.plan_poses(
            a5.calibrate.weight(), 1, ballast=2000.0
        ),
    }.items():
        with pytest.warns(ImplausibleWarning, match=name):
            make()
