"""A driver whose wrist turns the other way: its numbers become the model's."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.numbers.parameters import Alpha5Parameters

ARM = a5.parameters()
#: Of the wrist, 4, and of the jaw rod, 5.
SIGNS = np.array([1.0, 1.0, 1.0, -1.0, -1.0])


def turned() -> Alpha5Parameters:
    joints = [
        dataclasses.replace(joint, sign=int(sign))
        for joint, sign in zip(ARM.joints, SIGNS, strict=True)
    ]
    return dataclasses.replace(ARM, joints=tuple(joints))


def test_devices() -> None:
    q = np.array([[3.0, 1.2, 1.5, 0.8, 0.006], [3.1, 1.3, 1.6, 0.7, 0.012]])
    devices = a5.devices_from_q(q, turned())
    printed = a5.devices_from_q(q)
    for device, joint in zip((5, 4, 3, 2, 1), range(5), strict=True):
        assert devices[device].tolist() == (SIGNS[joint] * printed[device]).tolist()
    back = a5.q_from_devices(devices, turned())
    np.testing.assert_allclose(back, q, rtol=1e-15)
    # What another driver reports is out of range, in this driver's numbers.
    with pytest.raises(a5.errors.InputError, match=r"range of -6\.2 to 0 rad"):
        a5.q_from_devices(printed, turned())


def test_recordings_with_velocities_efforts_and_currents(tmp_path: Path) -> None:
    time = np.arange(0.0, 4.0, 0.05)[:, None]
    middle = [3.0, 1.2, 1.5, 0.8, 0.007]
    position = middle + 0.001 * np.sin(time + np.arange(5))
    columns = {
        "pos": position,
        "vel": 0.001 * np.cos(time + np.arange(5)),
        "effort": np.cos(time) + np.arange(5),
        "current": 0.01 * np.sin(time) + 0.001 * np.arange(5),
    }
    files = {}
    for name, signs in (("model", np.ones(5)), ("driver", SIGNS)):
        head = ["time_secs"]
        table = [time]
        for ending, values in columns.items():
            head += [f"axis_{x}_{ending}" for x in "edcba"]
            table.append(signs * values)
        files[name] = tmp_path / f"{name}.csv"
        rows = np.hstack(table).tolist()
        lines = [",".join(head), *(",".join(map(repr, row)) for row in rows)]
        files[name].write_text("\n".join(lines), encoding="utf-8")
    expected = a5.trajectory.read_motion(files["model"])
    found = a5.trajectory.read_motion(files["driver"], arm=turned())
    for field in ("position", "velocity", "effort", "current"):
        one, other = getattr(found, field), getattr(expected, field)
        assert one is not None
        np.testing.assert_array_equal(one, other)


def test_a_planned_motion_is_written_for_the_driver(tmp_path: Path) -> None:
    start, end = [3.0, 1.2, 1.5, 0.8], [3.0, 1.2, 1.5, 0.9]
    plan = a5.plan(start, end, arm=turned())
    file = plan.write(tmp_path / "plan.csv")
    rows = np.genfromtxt(file, delimiter=",", names=True)
    for ending, values in (
        ("pos", plan.position),
        ("vel", plan.velocity),
        ("acc", plan.acceleration),
    ):
        np.testing.assert_array_equal(rows[f"axis_b_{ending}"], -values[:, 3])
        np.testing.assert_array_equal(rows[f"axis_c_{ending}"], values[:, 2])
    again = a5.trajectory.read_motion(file, arm=turned())
    np.testing.assert_array_equal(again.position, plan.position)


def test_sessions_of_a_calibration(tmp_path: Path) -> None:
    q = np.array([[3.0, 1.2, 1.5, 0.8], [2.0, 1.0, 1.5, 0.5]])
    readings = np.array([[0.1, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 0.8]])
    session = a5.calibrate.session(a5.calibrate.efforts(), q, readings)
    file = tmp_path / "session.toml"
    file.write_text(a5.calibrate.session_text(session, turned()), "utf-8")
    theirs = a5.calibrate.read_session(file)
    np.testing.assert_allclose(theirs.q, SIGNS[:4] * q, atol=1e-4)
    np.testing.assert_allclose(theirs.readings, SIGNS[:4] * readings)
    ours = a5.calibrate.read_session(file, turned())
    np.testing.assert_allclose(ours.q, q, atol=1e-4)
    np.testing.assert_allclose(ours.readings, readings)
