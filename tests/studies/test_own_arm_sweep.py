"""A study of an arm of your own: its rows are single calls with its record."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest
from parquet_files import read_table

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.numbers.motors import Motors
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
QUANTITIES = ("torque", "current", "power", "margin", "mount_moment", "reach")
OUTPUTS = "".join(
    f'[outputs.{name}]\nquantity = "{name}"\nas = "table"\n' for name in QUANTITIES
)


def study(folder: Path, record: Alpha5Parameters, more: str = "") -> Path:
    """Three positions of each joint within the limits, in motion."""
    lines = ["[axes]"]
    for joint in record.joints[:4]:
        width = joint.upper - joint.lower
        values = [joint.lower, joint.lower + 0.3 * width, joint.upper]
        lines.append(f"{joint.name}_pos = {values}")
        lines.append(f"{joint.name}_vel = {0.5 * joint.velocity}")
        lines.append(f"{joint.name}_acc = 0.7")
    file = folder / "study.toml"
    file.write_text("\n".join([*lines, more, OUTPUTS]), encoding="utf-8")
    return file


def table(folder: Path) -> dict[str, np.ndarray]:
    """The rows of a study by column."""
    rows = read_table(folder / "rows")
    return {name: rows[name].to_numpy() for name in rows.column_names}


@pytest.mark.parametrize("seed", [0, 1])
def test_rows_are_newtons_torques_of_the_record(seed: int, tmp_path: Path) -> None:
    motors = Motors(rotor_inertias=(1e-6,) * 5, constants="voltage")
    record = dataclasses.replace(
        own.random_record(seed), mount=own.random_mount(seed), motors=motors
    )
    a5.sweep(study(tmp_path, record), tmp_path / "out", arm=record)
    found = table(tmp_path / "out")
    q = np.column_stack([found[f"axis_{x}_pos"] for x in "edcb"])
    v = np.tile([0.5 * joint.velocity for joint in record.joints[:4]], (len(q), 1))
    a = np.full_like(q, 0.7)
    down = record.mount.rotation.T @ [0.0, 0.0, -9.81]
    tau, wrench = own.inverse_dynamics(record, q, v, a, a5.SEA_WATER, down)
    tip = np.array([own.tcp(record, row)[:3, 3] for row in q])
    for k, joint in enumerate(record.joints[:4]):
        assert found[f"torque.{joint.name}"] == pytest.approx(tau[:, k], abs=1e-11)
        margin = joint.effort - np.abs(tau[:, k])
        assert found[f"margin.{joint.name}"] == pytest.approx(margin, abs=1e-11)
        row = record.actuators[k]
        loss = row.efficiency ** -np.sign(tau[:, k] * v[:, k])
        shaft = tau[:, k] / row.gear_ratio * loss + row.friction
        shaft = shaft + 1e-6 * row.gear_ratio * a[:, k]
        current = shaft / row.voltage_constant
        assert found[f"current.{joint.name}"] == pytest.approx(current)
    for k, axis in enumerate("xyz"):
        assert found[f"reach.{axis}"] == pytest.approx(tip[:, k], abs=1e-12)
        moment = found[f"mount_moment.{axis}"]
        assert moment == pytest.approx(wrench[:, 3 + k], abs=1e-11)


def test_an_axis_of_the_mount_replaces_the_records(tmp_path: Path) -> None:
    record = dataclasses.replace(own.random_record(0), mount=own.random_mount(2))
    file = study(tmp_path, record, "mount_yaw = 0.4")
    a5.sweep(file, tmp_path / "out", arm=record)
    unmounted = dataclasses.replace(record, mount=None)
    a5.sweep(file, tmp_path / "same", arm=unmounted)
    found = table(tmp_path / "out")["torque.axis_d"]
    assert np.array_equal(found, table(tmp_path / "same")["torque.axis_d"])


def test_samples_have_the_records_half_widths(tmp_path: Path) -> None:
    """The mass of link 2 alone is measured, with 50 g; nothing else is open."""
    links = [f"link_{i}" for i in range(5)]
    quantities = ("mass", "com", "inertia", "volume", "cob")
    keys = [f"links.{link}.{name}" for link in links for name in quantities]
    keys += [f"lengths.{name}" for name in ("a_0", "d_0", "a_1", "a_2", "d_3")]
    widths = dict.fromkeys(keys, 0.0) | {"links.link_2.mass": 0.05}
    record = dataclasses.replace(
        own.random_record(0),
        measurements=tuple(Measurement(key, half_width=x) for key, x in widths.items()),
    )
    file = study(tmp_path, record, "parameters = 6")
    a5.sweep(file, tmp_path / "out", arm=record)
    drawn = a5.uncertainty.sample(6, 0, arm=record)
    found = table(tmp_path / "out")
    q = np.column_stack([found[f"axis_{x}_pos"] for x in "edcb"])
    v = np.tile([0.5 * joint.velocity for joint in record.joints[:4]], (81, 1))
    masses = set()
    for k in range(6):
        rows = slice(81 * k, 81 * (k + 1))
        one = drawn.parameters(k)
        masses.add(one.links[2].mass)
        a = np.full((81, 4), 0.7)
        down = np.array([0.0, 0.0, -9.81])
        tau, _ = own.inverse_dynamics(one, q[rows], v, a, a5.SEA_WATER, down)
        assert found["torque.axis_d"][rows] == pytest.approx(tau[:, 1], abs=1e-11)
    assert max(masses) - min(masses) > 0.03
    assert max(masses) - record.links[2].mass < 0.05


def test_a_recording_is_read_with_the_records_limits(tmp_path: Path) -> None:
    record = own.random_record(0)
    time = np.linspace(0, 5, 101)
    middle = np.array([(j.lower + j.upper) / 2 for j in record.joints[:4]])
    q = middle + 0.1 * np.sin(time)[:, None]
    names = ",".join(f"axis_{joint}_pos" for joint in "edcb")
    file = tmp_path / "r.csv"
    rows = np.column_stack([time, q])
    np.savetxt(file, rows, delimiter=",", header=f"time,{names}", comments="")
    text = f'[axes]\nrecordings = "r.csv"\n{OUTPUTS}'
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    a5.sweep(tmp_path / "study.toml", tmp_path / "out", arm=record)
    motion = a5.trajectory.read_motion(file, arm=record)
    analysis = a5.trajectory.analyse(motion, a5.load(arm=record))
    found = table(tmp_path / "out")
    assert found["torque.axis_c"] == pytest.approx(analysis.torque[:, 2], abs=1e-10)
    assert found["current.axis_c"] == pytest.approx(analysis.current[:, 2], abs=1e-8)


@pytest.mark.parametrize(
    ("joint", "axis", "value", "message"),
    [
        ("axis_e", "axis_e_pos", 0.2, "axes.axis_e_pos: expected values within"),
        ("axis_e", "axis_e_vel", 0.4, "0.4 rad/s"),
        ("axis_e", "corrections", ["none"], "has its own corrections"),
    ],
)
def test_what_the_arm_cannot_do_is_refused_in_one_line(
    joint: str, axis: str, value: Any, message: str, tmp_path: Path, capsys: Any
) -> None:
    axes = {f"axis_{x}_pos": 1.0 for x in "edcb"} | {axis: value}
    lines = [f"{name} = {json.dumps(number)}" for name, number in axes.items()]
    file = tmp_path / "study.toml"
    file.write_text("\n".join(["[axes]", *lines, OUTPUTS]), encoding="utf-8")
    words = ["sweep", str(file), "-o", str(tmp_path / "out"), "--arm", str(EXAMPLE)]
    assert main(words) == 2
    said = capsys.readouterr().err
    assert message in said
    assert "alpha5_lab_2" in said
    assert said.count("\n") == 1
    assert not (tmp_path / "out").exists()
