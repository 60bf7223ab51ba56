"""Each axis of a study is what a single call takes."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from parquet_files import read_table
from pinocchio_collision import CollisionModel

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.cli import main
from alpha5_model.studies.sweep import parts
from alpha5_model.studies.sweep.study import read_study

JOINTS = [f"axis_{x}" for x in "edcb"]
STATES = """
axis_e_pos = [0.4, 2.0]
axis_d_pos = [0.3, 1.7]
axis_c_pos = [0.2, 2.9]
axis_b_pos = 0.5
axis_e_vel = 0.3
axis_c_vel = -0.4
axis_d_acc = 1.1
"""
V = np.array([0.3, 0.0, -0.4, 0.0])
A = np.array([0.0, 1.1, 0.0, 0.0])
#: A small vehicle that the arm tilts by many degrees; upside down below it.
VEHICLE = """
[vehicles.small]
mass = 13.5
volume = 0.0134
com = [0.0, 0.01, 0.0]
cob = [0.002, 0.0, 0.02]
xyz = [0.15, 0.03, -0.14]
rpy = [3.0, 0.1, 0.2]
"""


def table(quantity: str) -> str:
    return f'[outputs.{quantity}]\nquantity = "{quantity}"\nas = "table"\n'


def rows_of(folder: Path, text: str, **options: Any) -> list[dict[str, Any]]:
    """The rows of a study."""
    folder.mkdir(exist_ok=True)
    study = folder / "study.toml"
    study.write_text(text, encoding="utf-8")
    a5.sweep(study, folder / "out", **options)
    rows: list[dict[str, Any]] = read_table(folder / "out/rows").to_pylist()
    return rows


def position(row: dict[str, Any]) -> np.ndarray:
    return np.array([row[f"{joint}_pos"] for joint in JOINTS])


def torque(row: dict[str, Any]) -> list[float]:
    return [row[f"torque.{joint}"] for joint in JOINTS]


def turned(*angles: float) -> Any:
    """The arm on a turned mount."""
    down = rotation_from_rpy(list(angles)).T @ [0.0, 0.0, -9.81]
    return a5.load(gravity=down)


def holding(mass: float, com: tuple[float, ...], volume: float = 0.0) -> Any:
    return a5.load().with_payload(mass, com, volume=volume)


def flowing(*current: float, level: str = "nominal") -> Any:
    return a5.load().with_hydrodynamics(current, level)


COS, SIN = np.cos(0.4), np.sin(0.4)
#: Axes -> the arm by single calls. Without current and level, water acts by its
#: buoyancy alone.
CASES: dict[str, Any] = {
    "": a5.load,
    "mount_roll = 0.7": lambda: turned(0.7, 0.0, 0.0),
    "mount_pitch = 0.7": lambda: turned(0.0, 0.7, 0.0),
    "mount_yaw = 0.7\nmount_roll = 0.2": lambda: turned(0.2, 0.0, 0.7),
    "payload_mass = 0.3": lambda: holding(0.3, (0.0, 0.0, 0.0)),
    "payload_mass = 0.3\npayload_x = 0.02": lambda: holding(0.3, (0.02, 0.0, 0.0)),
    "payload_mass = 0.3\npayload_y = 0.02": lambda: holding(0.3, (0.0, 0.02, 0.0)),
    "payload_mass = 0.3\npayload_z = 0.02": lambda: holding(0.3, (0.0, 0.0, 0.02)),
    "payload_volume = 1e-4": lambda: holding(0.0, (0.0, 0.0, 0.0), 1e-4),
    "fluid_density = 1000": lambda: a5.load(1000.0),
    "current_speed = 0.0": lambda: flowing(0.0, 0.0, 0.0),
    'level = "nominal"': lambda: flowing(0.0, 0.0, 0.0),
    "current_speed = 0.6\ncurrent_azimuth = 0.4": lambda: flowing(
        0.6 * COS, 0.6 * SIN, 0.0
    ),
    "current_speed = 0.6\ncurrent_elevation = 0.4": lambda: flowing(
        0.6 * COS, 0.0, 0.6 * SIN
    ),
    'current_speed = 0.6\nlevel = "low"': lambda: flowing(0.6, 0, 0, level="low"),
    'current_speed = 0.6\nlevel = "high"': lambda: flowing(0.6, 0, 0, level="high"),
    'corrections = "none"': lambda: a5.load(corrections=()),
}


@pytest.mark.parametrize("axes", CASES)
def test_each_axis_of_a_case_is_what_a_single_call_takes(
    axes: str, tmp_path: Path
) -> None:
    quantities = ("torque", "margin", "mount_force", "mount_moment")
    outputs = "".join(table(quantity) for quantity in quantities)
    arm = CASES[axes]()
    efforts = np.array([joint.effort for joint in a5.parameters().joints[:4]])
    for row in rows_of(tmp_path, f"[axes]\n{axes}\n{STATES}{outputs}"):
        tau = arm.inverse_dynamics(position(row), V, A)
        assert torque(row) == pytest.approx(tau, rel=1e-9, abs=1e-12)
        margin = [row[f"margin.{joint}"] for joint in JOINTS]
        assert margin == pytest.approx(efforts - np.abs(tau), rel=1e-9)
        load = arm.base_wrench(position(row), V, A)
        for name, vector in (("force", load.linear), ("moment", load.angular)):
            found = [row[f"mount_{name}.{x}"] for x in ("x", "y", "z", "norm")]
            expected = [*vector, np.linalg.norm(vector)]
            assert found == pytest.approx(expected, rel=1e-9, abs=1e-11)


@pytest.fixture(scope="module")
def on_vehicle(tmp_path_factory: pytest.TempPathFactory) -> list[dict[str, Any]]:
    """Rows of a study with a vehicle: in trim, and held level."""
    quantities = ("torque", "mount_force", "mount_moment", "trim", "reach")
    text = f"""[axes]
    vehicle = ["small"]
    trim = [true, false]
    level = "nominal"
    fluid_density = 1000
    payload_mass = [0.0, 0.3]
    payload_z = 0.05
    {STATES}
    {VEHICLE}
    {"".join(table(quantity) for quantity in quantities)}"""
    return rows_of(tmp_path_factory.mktemp("vehicle"), text)


def vehicle() -> a5.Vehicle:
    """The same vehicle for `on_vehicle`."""
    mount = np.eye(4)
    mount[:3, :3] = pin.rpy.rpyToMatrix(3.0, 0.1, 0.2)
    mount[:3, 3] = 0.15, 0.03, -0.14
    return a5.Vehicle(
        mass=13.5,
        com=[0.0, 0.01, 0.0],
        inertia=np.diag([0.26, 0.23, 0.37]),
        volume=0.0134,
        cob=[0.002, 0.0, 0.02],
        mount=mount,
    )


def test_the_trim_is_that_of_the_vehicle(on_vehicle: list[dict[str, Any]]) -> None:
    for row in on_vehicle:
        loaded = a5.load(1000.0).with_payload(row["payload_mass"], (0, 0, 0.05))
        trim = loaded.on_vehicle(vehicle()).trim(position(row))
        assert row["trim.roll"] == pytest.approx(trim.roll, abs=1e-12)
        assert row["trim.pitch"] == pytest.approx(trim.pitch, abs=1e-12)
    pitches = [row["trim.pitch"] for row in on_vehicle]
    assert np.ptp(pitches) > 0.2


def test_torques_on_a_vehicle_are_those_of_a_floating_arm_at_rest_on_it(
    on_vehicle: list[dict[str, Any]],
) -> None:
    """Pinocchio's free-flyer has the vehicle's attitude, and gravity pulls down."""
    floating = a5.load(1000.0, floating_base=True)
    no_motion = np.zeros(6)
    for row in on_vehicle:
        loaded = floating.with_payload(row["payload_mass"], (0, 0, 0.05))
        angles = (row["trim.roll"], row["trim.pitch"]) if row["trim"] else (0.0, 0.0)
        turn = pin.rpy.rpyToMatrix(*angles, 0.0) @ vehicle().mount[:3, :3]
        base = pin.SE3ToXYZQUAT(pin.SE3(turn, np.zeros(3)))
        q = np.concatenate([base, position(row)])
        state = (q, np.concatenate([no_motion, V]), np.concatenate([no_motion, A]))
        wet = loaded.with_hydrodynamics()
        tau = wet.inverse_dynamics(*state)[6:]
        assert torque(row) == pytest.approx(tau, rel=1e-9, abs=1e-11)
        load = wet.base_wrench(*state)
        force = [row[f"mount_force.{x}"] for x in "xyz"]
        moment = [row[f"mount_moment.{x}"] for x in "xyz"]
        assert force == pytest.approx(load.linear, rel=1e-9, abs=1e-11)
        assert moment == pytest.approx(load.angular, rel=1e-9, abs=1e-11)
    in_trim = [torque(row)[1] for row in on_vehicle if row["trim"]]
    level = [torque(row)[1] for row in on_vehicle if not row["trim"]]
    assert np.abs(np.subtract(in_trim, level)).max() > 0.02


@pytest.fixture
def arms(tmp_path: Path) -> Path:
    """A folder with two arm files."""
    light = "format = 1\n[links.link_2]\nmass = 0.36\n"
    mounted = f"{light}[mount]\nrpy = [0.0, 1.2, 0.0]\n[motors]\nsupply_voltage = 22\n"
    (tmp_path / "light.toml").write_text(light, encoding="utf-8")
    (tmp_path / "mounted.toml").write_text(mounted, encoding="utf-8")
    return tmp_path


ARMS = f"""leave_out_self_collision = true
[axes]
parameters = 2
arm = ["mounted.toml", "catalogue", "light.toml"]
{STATES}
{table("torque")}"""


def test_rows_of_an_axis_of_arms_are_those_of_each_arm(arms: Path) -> None:
    rows = rows_of(arms, ARMS)
    alone = ARMS.replace('arm = ["mounted.toml", "catalogue", "light.toml"]', "")
    for name in ("mounted.toml", "catalogue", "light.toml"):
        record = None if name == "catalogue" else a5.arm_file(arms / name)
        single = rows_of(arms / f"of_{name}", alone, arm=record)
        own = [torque(row) for row in rows if row["arm"] == name]
        assert len(own) == 12
        assert own == [torque(row) for row in single]
    of_arm = {
        name: [torque(row) for row in rows if row["arm"] == name]
        for name in ("mounted.toml", "catalogue", "light.toml")
    }
    lighter = np.abs(np.subtract(of_arm["light.toml"], of_arm["catalogue"]))
    assert lighter[:, 1].min() > 1e-4


def test_a_changed_arm_file_is_another_study(
    arms: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = rows_of(arms, ARMS)
    words = ["sweep", str(arms / "study.toml"), "-o", str(arms / "out")]
    assert main(words) == 0
    file = arms / "light.toml"
    file.write_text(file.read_text("utf-8").replace("0.36", "0.37"), encoding="utf-8")
    capsys.readouterr()
    assert main(words) == 2
    assert "parts of another study" in capsys.readouterr().err
    assert main([*words, "--restart"]) == 0
    fresh = read_table(arms / "out/rows").to_pylist()
    assert len(fresh) == len(rows)


def test_workers_need_no_arm_files(arms: Path) -> None:
    (arms / "study.toml").write_text(ARMS, encoding="utf-8")
    study = read_study(arms / "study.toml")
    packed = pickle.dumps(study)
    here = parts.compute(study, 0)
    for name in ("light.toml", "mounted.toml"):
        (arms / name).unlink()
    there = parts.compute(pickle.loads(packed), 0)
    assert there == here


# At 0 of axis_c the wrist touches link 2 within the micrometre that coal knows.
FOLDED = f"""seed = 3
samples = 5
[axes]
axis_e_pos = {{values = [-60, 0, 60, 170], unit = "deg"}}
axis_d_pos = {{from = 0, to = 200, count = 5, unit = "deg"}}
axis_c_pos = {{from = 1, to = 200, count = 5, unit = "deg"}}
axis_b_pos = {{random = [-170, 170], unit = "deg"}}
in_collision = VALUES
[outputs.peak]
quantity = "torque"
as = "peak"
by = ["in_collision"]
{table("torque")}"""


def test_rows_in_and_out_of_collision_are_told_apart(tmp_path: Path) -> None:
    rows = rows_of(tmp_path, FOLDED.replace("VALUES", "[true, false]"))
    collisions = CollisionModel(a5.load().model)
    assert len(rows) == 4 * 25 * 5
    touching = [collisions.in_collision(position(row)) for row in rows]
    assert [row["in_collision"] for row in rows] == touching
    found = read_table(tmp_path / "out" / "peak.parquet").to_pydict()
    assert found["in_collision"] == [True, False]
    for value, peak in zip((True, False), found["axis_d"], strict=True):
        of_value = [row for row in rows if row["in_collision"] == value]
        assert len(of_value) > 50
        assert peak == max(abs(torque(row)[1]) for row in of_value)


@pytest.mark.parametrize("value", ["true", "[false]", ""])
def test_only_the_states_on_the_axis_are_kept(value: str, tmp_path: Path) -> None:
    """``leave_out_self_collision`` keeps those of ``false``, without a column."""
    text = FOLDED.replace("in_collision = VALUES", f"in_collision = {value}")
    if not value:
        left_out = FOLDED.replace('by = ["in_collision"]', "")
        text = f"leave_out_self_collision = true\n{left_out}"
        text = text.replace("in_collision = VALUES", "")
    rows = rows_of(tmp_path / "some", text)
    whole = rows_of(tmp_path / "all", FOLDED.replace("VALUES", "[true, false]"))
    wanted = value == "true"
    kept = [row["row"] for row in whole if row["in_collision"] is wanted]
    assert [row["row"] for row in rows] == kept

    found = a5.sweep(tmp_path / "some/study.toml", tmp_path / "some/out")
    assert found.rows == len(rows)
    at = found.outputs["peak"]["axis_d_row"][0]
    assert abs(found.inputs(at)["torque.axis_d"]) == found.outputs["peak"]["axis_d"][0]
    absent = min({row["row"] for row in whole} - {*kept})
    with pytest.raises(a5.errors.InputError, match="this one is left out"):
        found.inputs(absent)


def test_a_study_of_collisions_only_has_no_rows(tmp_path: Path) -> None:
    axes = "".join(f"{joint}_pos = 0.0\n" for joint in JOINTS)
    peak = '[outputs.peak]\nquantity = "torque"\nas = "peak"\n'
    text = f"[axes]\nin_collision = false\n{axes}{peak}"
    study = tmp_path / "study.toml"
    study.write_text(text, encoding="utf-8")
    found = a5.sweep(study, tmp_path / "out")
    assert found.rows == 0
    assert np.isnan(found.outputs["peak"]["axis_d"]).all()


def test_samples_of_a_recording_are_told_apart_too(tmp_path: Path) -> None:
    time = np.linspace(0, 6, 150)
    q = np.array([3.1, 1.8, 1.8, 0.0]) + np.sin(time)[:, None] * [2.9, 1.7, 1.7, 0.0]
    head = ",".join(["time_secs", *(f"{joint}_pos" for joint in JOINTS)])
    table_of_times = np.column_stack([time, q])
    file = tmp_path / "folding.csv"
    np.savetxt(file, table_of_times, delimiter=",", header=head, comments="")
    text = f"""[axes]
    recordings = "folding.csv"
    in_collision = [false, true]
    {table("torque")}"""
    rows = rows_of(tmp_path, text)
    arm = a5.load()
    smooth = a5.trajectory.smooth(a5.trajectory.read_motion(file))
    touching = arm.in_collision(smooth.position[:, :4])
    assert [row["in_collision"] for row in rows] == touching.tolist()
    assert 0 < touching.sum() < 150
    left_out = text.replace("in_collision = [false, true]", "")
    free = rows_of(
        tmp_path, f"leave_out_self_collision = true\n{left_out}", restart=True
    )
    assert [row["sample"] for row in free] == np.flatnonzero(~touching).tolist()


@pytest.mark.parametrize(
    ("axis", "place"),
    [
        ('level = "middle"', "unknown level 'middle'; choose from low, nominal, high"),
        ('level = ["low", "low"]', "axes.level: expected at least one value, each"),
        ("level = []", "axes.level"),
        ('vehicle = "rov"', "unknown vehicle 'rov'; choose from small"),
        ('vehicle = "small"\nmount_pitch = 1', "vehicle and mount_pitch"),
        ('vehicle = "small"\ncurrent_speed = 1', "trim = false"),
        ("trim = true", "axes.trim"),
        ('vehicle = "small"\ntrim = "yes"', "axes.trim: expected True or False"),
        ('arm = "no.toml"', "no.toml: no such file"),
        ('arm = ["catalogue", "catalogue"]', "axes.arm"),
        ('arm = "short.toml"', "axes.axis_d_pos: expected values within the limits"),
        ('arm = "bad.toml"', "bad.toml"),
        ('arm = "catalogue"\ncorrections = ["none"]', "arm and corrections"),
        ('in_collision = "no"', "axes.in_collision: expected True or False"),
        ("in_collision = [true, true]", "axes.in_collision"),
    ],
)
def test_a_bad_axis_is_refused_in_one_line(
    axis: str, place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits = "[joint_limits.axis_d]\nmin_position = 0.5\n"
    (tmp_path / "short.toml").write_text(f"format = 1\n{limits}", encoding="utf-8")
    (tmp_path / "bad.toml").write_text("format = 1\n[wheels]\n", encoding="utf-8")
    study = tmp_path / "study.toml"
    study.write_text(
        f"[axes]\n{axis}\n{STATES}\n{VEHICLE}\n{table('torque')}", encoding="utf-8"
    )
    assert main(["sweep", str(study), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert place in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (("mass = 13.5\n", ""), "vehicles.small.mass"),
        (("mass = 13.5", "mass = -1"), "vehicles.small.mass"),
        (("com = [0.0, 0.01, 0.0]", "com = [0.0]"), "vehicles.small.com"),
        (("xyz =", "place ="), "unknown key of vehicles.small 'place'"),
        (("[vehicles.small]\n", "[vehicles]\nsmall = 1\n"), "vehicles"),
        (("axis_e_pos", "in_collision = true\naxis_e_pos"), "leave_out_self_collision"),
        (('quantity = "torque"', 'quantity = "trim"'), "outputs.torque.quantity"),
    ],
)
def test_a_bad_vehicle_or_a_contradiction_is_refused(
    change: tuple[str, str], place: str, tmp_path: Path
) -> None:
    text = f"leave_out_self_collision = true\n[axes]\n{STATES}{VEHICLE}"
    whole = f"{text}{table('torque')}"
    assert change[0] in whole
    study = tmp_path / "study.toml"
    study.write_text(whole.replace(*change, 1), encoding="utf-8")
    with pytest.raises(a5.errors.FileFormatError, match=place):
        a5.sweep(study, tmp_path / "out")


def test_the_command_refuses_an_axis_of_arms_beside_an_arm(
    arms: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (arms / "study.toml").write_text(ARMS, encoding="utf-8")
    words = ["sweep", str(arms / "study.toml"), "-o", str(arms / "out")]
    assert main([*words, "--arm", str(arms / "light.toml")]) == 2
    assert "the arm of the whole study" in capsys.readouterr().err
