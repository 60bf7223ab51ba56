"""The tilt of a floating vehicle as a sensor, against statics by Pinocchio."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import root

import alpha5_model as a5
from alpha5_model._support.spatial import pose, rotation_from_rpy
from alpha5_model.cli import main
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.loads import Motion, load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

calibrate = a5.calibrate
WATER = a5.FRESH_WATER
STILL = np.zeros(4)
#: A small vehicle; the arm hangs below it, turned.
FACTS: dict[str, Any] = {
    "mass": 11.5,
    "com": [0.01, 0.0, -0.02],
    "volume": 0.01115,
    "cob": [0.0, 0.01, 0.035],
    "xyz": [0.2, 0.05, -0.12],
    "rpy": [np.pi, 0.05, 0.3],
}


def balance(
    arm: Alpha5Parameters, q: Any, tilt: Any = (0.0, 0.0), yaw: float = 0.0
) -> Any:
    """Roll and pitch at which nothing turns the vehicle, by a search, (2,).

    Pinocchio computes the load of the arm on its mount in the tilted gravity.
    """
    turned = rotation_from_rpy([0.0, 0.0, yaw]) @ rotation_from_rpy(FACTS["rpy"])
    turned = turned @ rotation_from_rpy([tilt[0], 0, 0])
    turned = turned @ rotation_from_rpy([0, tilt[1], 0])

    def moment(angles: Any) -> Any:
        gravity = rotation_from_rpy([*angles, 0.0]).T @ [0.0, 0.0, -9.81]
        body = a5.load(WATER, gravity=turned.T @ gravity, arm=arm)
        load = body.base_wrench(q, STILL, STILL).vector
        force, own = turned @ load[:3], turned @ load[3:]
        of_arm = own + np.cross(FACTS["xyz"], force)
        weight = np.cross(FACTS["com"], FACTS["mass"] * gravity)
        buoyancy = np.cross(FACTS["cob"], -WATER * FACTS["volume"] * gravity)
        total = rotation_from_rpy([*angles, 0.0]) @ (of_arm + weight + buoyancy)
        return total[:2]

    found = root(moment, [0.0, 0.0], tol=1e-13)
    assert np.abs(found.fun).max() < 1e-10
    return found.x


def predicted(planned: calibrate.Session, prior: str = "digits") -> Any:
    equations = Equations(arm_unknowns(a5.parameters(), prior), [planned], TILT)
    return equations.predicted(equations.middle, 0)


@pytest.fixture(scope="module")
def planned() -> calibrate.Session:
    return calibrate.plan_poses(
        calibrate.vehicle_tilt(FACTS), fluid_density=WATER, prior="loose"
    )


def test_the_tilt_is_where_all_moments_balance(planned: calibrate.Session) -> None:
    angles = predicted(planned)
    for q, found in zip(planned.motion.q[:4], angles[:4], strict=True):
        assert np.allclose(found, balance(a5.parameters(), q), rtol=0, atol=1e-10)
    assert np.ptp(angles, axis=0).min() > 0.05  # the arm tilts it by degrees


def test_a_vehicle_object_says_the_same(planned: calibrate.Session) -> None:
    vehicle = a5.Vehicle(
        mass=FACTS["mass"],
        com=FACTS["com"],
        inertia=0.2 * np.eye(3),
        volume=FACTS["volume"],
        cob=FACTS["cob"],
        mount=pose(FACTS["xyz"], FACTS["rpy"]),
    )
    again = calibrate.session(
        calibrate.vehicle_tilt(vehicle), planned.motion.q, fluid_density=WATER
    )
    assert np.allclose(predicted(again), predicted(planned), rtol=0, atol=1e-14)
    trim = a5.load(WATER).on_vehicle(vehicle).trim(planned.motion.q[0])
    assert np.allclose(predicted(again)[0], [trim.roll, trim.pitch], atol=1e-12)


def test_slopes_by_finite_differences(planned: calibrate.Session) -> None:
    rng = np.random.default_rng(1)
    count = len(planned.motion.q)
    read = calibrate.with_readings(planned, np.zeros((count, 2)))
    equations = Equations(arm_unknowns(a5.parameters(), "loose"), [read], TILT)
    assert "0.yaw" in equations.names
    width = np.minimum(equations.deviation, 0.01)
    values = equations.middle + 0.1 * width * rng.normal(size=len(width))
    slopes = equations.matrix(values)
    for number in np.flatnonzero(equations.deviation):
        step = np.zeros(len(width))
        step[number] = max(0.01 * width[number], 1e-9)
        after, before = (equations.residuals(values + s) for s in (step, -step))
        by_steps = (before - after) / (2 * step[number])
        scale = max(np.abs(by_steps).max(), 1e-4)
        assert np.abs(slopes[:, number] - by_steps).max() < 3e-6 * scale


def readings_of(arm: Alpha5Parameters, planned: Any, rng: np.random.Generator) -> Any:
    """What a vehicle shows whose arm is turned, with gains, offsets and noise."""
    sensor = planned.sensor
    tilt = rng.normal(size=2) * TILT
    yaw = float(rng.normal() * sensor.placement)
    angles = np.array([balance(arm, q, tilt, yaw) for q in planned.motion.q])
    gain = 1.0 + rng.normal(size=2) * sensor.gain
    offset = rng.normal(size=2) * sensor.offset
    return gain * angles + offset + rng.normal(size=angles.shape) * sensor.noise


@pytest.mark.slow
def test_a_known_arm(planned: calibrate.Session) -> None:
    """Torques that nobody measured lie in their intervals, and are known better."""
    rng = np.random.default_rng(3)
    unknowns = arm_unknowns(a5.parameters(), "loose")
    change = np.clip(rng.normal(size=len(NAMES)), -2, 2) * unknowns.deviation
    truth = unknowns.record(unknowns.middle + change)
    read = calibrate.with_readings(planned, readings_of(truth, planned, rng))
    found = calibrate.fit(read, prior="loose")
    assert found.problems == ()
    assert (found.torque_after[1:3] < 0.4 * found.torque_before[1:3]).all()

    covariance = found.arm.covariance
    assert covariance is not None
    values = unknowns.middle.copy()
    values[[NAMES.index(name) for name in found.names]] = found.estimate
    q = np.random.default_rng(4).uniform(0.3, 3.0, (40, 4))
    motion = Motion(q=q, v=0 * q, a=0 * q, gravity=planned.motion.gravity)
    place = [NAMES.index(name) for name in covariance.names]
    slopes = load_slopes(unknowns, values, WATER, motion)[:, 1:3, place]
    variance = np.einsum("njk,kl,njl->nj", slopes, covariance.matrix, slopes)
    torque = [
        a5.load(WATER, gravity=planned.motion.gravity, arm=arm).inverse_dynamics_batch(
            q, 0 * q, 0 * q
        )[:, 1:3]
        for arm in (found.arm, truth, a5.parameters())
    ]
    assert np.abs((torque[0] - torque[1]) / np.sqrt(variance)).max() < 4.0
    off = [np.sqrt(((one - torque[1]) ** 2).mean()) for one in (torque[0], torque[2])]
    assert off[0] < 0.5 * off[1]


def test_small_tilts_are_the_moment_over_the_weight_times_the_righting_lever() -> None:
    level = {"rpy": [0.0, 0.0, 0.0], "com": [0, 0, -0.02], "cob": [0, 0, 0.035]}
    facts = {**FACTS, **level, "mass": 600.0, "volume": 0.6}
    time = np.arange(0.0, 30.0, 0.25)
    q = a5.named_pose("home") + 0.4 * np.sin(np.outer(time, [0.9, 0.7, 0.8, 0.0]))
    floating = calibrate.session(calibrate.vehicle_tilt(facts), q, fluid_density=WATER)
    tilt = predicted(floating)
    still = np.zeros((1, 4))
    moment = a5.load(WATER).base_wrench_batch(q, still, still)[:, 3:5]
    height = WATER * facts["volume"] * facts["cob"][2] - facts["mass"] * -0.02
    expected = (moment - moment.mean(axis=0)) / (9.81 * height)
    assert tilt - tilt.mean(axis=0) == pytest.approx(expected, abs=0.01 * np.ptp(tilt))


def test_a_plan_reads_back(planned: calibrate.Session, tmp_path: Path) -> None:
    path = tmp_path / "tilt.toml"
    read = calibrate.with_readings(planned, predicted(planned))
    path.write_text(calibrate.session_text(read), "utf-8")
    again = calibrate.read_session(path)
    assert np.allclose(again.readings, read.readings, rtol=1e-8)
    assert np.allclose(predicted(again), again.readings, rtol=0, atol=2e-4)
    assert np.allclose(again.motion.gravity, planned.motion.gravity, atol=1e-8)
    text = path.read_text("utf-8")
    assert "gravity" not in text
    for old, new, message in (
        ("[settings.vehicle]", "[settings.boat]", "settings: boat: unknown"),
        ("mass = ", "weight = ", "unknown key of vehicle 'weight'"),
        ("cob = ", "# cob = ", "vehicle.cob: expected a value"),
        ("fluid = ", "gravity = [0, 0, -9.81]\nfluid = ", "gravity: expected none"),
        ('fluid = "fresh"', 'fluid = "air"', "a vehicle that floats"),
        ('unit = "deg"', 'unit = "rad"', "within a quarter turn"),
    ):
        assert old in text
        path.write_text(text.replace(old, new, 1), "utf-8")
        with pytest.raises(FileFormatError) as caught:
            calibrate.read_session(path)
        assert message in str(caught.value)
        assert "\n" not in str(caught.value)


def test_what_is_refused() -> None:
    sensor = calibrate.vehicle_tilt(FACTS)
    q = np.ones((2, 4))
    with pytest.raises(InputError, match="an arm at rest"):
        calibrate.session(sensor, q, v=q, fluid_density=WATER)
    with pytest.raises(InputError, match="a vehicle that floats in this fluid"):
        calibrate.session(sensor, q, fluid_density=a5.AIR)
    top_heavy = calibrate.vehicle_tilt({**FACTS, "com": [0.0, 0.0, 0.05]})
    with pytest.raises(InputError, match="rights itself"):
        calibrate.session(top_heavy, q, fluid_density=WATER)
    degrees = np.full((2, 2), 12.0)
    with pytest.raises(InputError, match="in rad, within a quarter turn"):
        calibrate.session(sensor, q, degrees, fluid_density=WATER)
    steep = np.array([[1.56, 0.0], [0.0, -1.56]])
    calibrate.session(sensor, q, steep, fluid_density=WATER)
    beyond = np.array([[1.58, 0.0], [0.0, -1.56]])
    with pytest.raises(InputError, match="in rad, within a quarter turn"):
        calibrate.session(sensor, q, beyond, fluid_density=WATER)
    with pytest.raises(InputError, match="noise"):
        calibrate.vehicle_tilt(FACTS, noise=0.0)
    with pytest.raises(InputError, match="vehicle"):
        calibrate.vehicle_tilt(3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="force-torque sensor or efforts"):
        calibrate.plan_excitation(sensor)


@pytest.mark.slow
def test_the_command_plans_and_fits(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = [f"{key} = {value}" for key, value in FACTS.items()]
    Path("rov.toml").write_text("\n".join(lines), "utf-8")
    plan = ["calibrate", "plan", "tilt.toml", "--sensor", "vehicle-tilt"]
    assert main([*plan, "--fluid", "fresh"]) == 2
    assert "--vehicle FILE" in capsys.readouterr().err
    vehicle = ["--vehicle", "rov.toml"]
    assert main([*plan, "--fluid", "fresh", *vehicle, "--gravity", "0 0 -9.81"]) == 2
    assert "the vehicle's tilt says" in capsys.readouterr().err
    assert main([*plan, "--fluid", "fresh", "--poses", "6", *vehicle]) == 0
    session = calibrate.read_session("tilt.toml")
    filled = calibrate.with_readings(session, np.round(predicted(session), 4))
    Path("tilt.toml").write_text(calibrate.session_text(filled), "utf-8")
    capsys.readouterr()
    assert main(["calibrate", "fit", "tilt.toml", "--json", "-o", "mine.toml"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["problems"] == []
    assert record["readings"] == 12
    assert {"0.yaw", "0.gain.roll", "0.offset.pitch"} <= record["others"].keys()
    assert a5.arm_file("mine.toml").covariance is not None
