"""The arm of a case has what each axis of the case says, by single calls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model._support.spatial import rotation_from_rpy
from alpha5_model.studies.sweep.blocks import blocks_of
from alpha5_model.studies.sweep.study import Study, read_study

Q = (0.4, 1.3, 2.1, 0.6)
V = (0.3, 0.0, -0.4, 0.1)
STATE = "".join(
    f"axis_{x}_pos = {q}\naxis_{x}_vel = {v}\n"
    for x, q, v in zip("edcb", Q, V, strict=True)
)
OUTPUTS = "".join(
    f'[outputs.{name}]\nquantity = "{name}"\nas = "peak"\n'
    for name in ("torque", "margin", "mount_force", "mount_moment", "reach")
)
VEHICLE = """
[vehicles.small]
mass = 13.5
volume = 0.0134
com = [0.0, 0.01, 0.0]
cob = [0.002, 0.0, 0.02]
xyz = [0.15, 0.03, -0.14]
rpy = [3.0, 0.1, 0.2]
"""


def study_of(folder: Path, axes: str, more: str = "") -> Study:
    file = folder / "study.toml"
    file.write_text(f"[axes]\n{axes}\n{STATE}{OUTPUTS}{more}", encoding="utf-8")
    return read_study(file)


def quantities(study: Study) -> dict[str, np.ndarray]:
    """Quantity -> its numbers in the only state."""
    (block,) = blocks_of(study, 0, 1)
    return {name: rows[0] for name, rows in block.quantities.items()}


def turned(*angles: float) -> Any:
    """The arm on a turned mount."""
    down = rotation_from_rpy(list(angles)).T @ [0.0, 0.0, -9.81]
    return a5.load(gravity=down)


def holding(mass: float, com: tuple[float, ...], volume: float = 0.0) -> Any:
    return a5.load().with_payload(mass, com, volume=volume)


def flowing(*current: float) -> Any:
    return a5.load().with_hydrodynamics(current)


#: Axes -> the arm by single calls.
CASES: dict[str, Any] = {
    "": a5.load,
    "mount_roll = 0.7": lambda: turned(0.7, 0.0, 0.0),
    "mount_pitch = 0.7": lambda: turned(0.0, 0.7, 0.0),
    "mount_yaw = 0.7": lambda: turned(0.0, 0.0, 0.7),
    "mount_yaw = 0.7\nmount_roll = 0.2": lambda: turned(0.2, 0.0, 0.7),
    "payload_mass = 0.3": lambda: holding(0.3, (0.0, 0.0, 0.0)),
    "payload_mass = 0.3\npayload_x = 0.02": lambda: holding(0.3, (0.02, 0.0, 0.0)),
    "payload_mass = 0.3\npayload_y = 0.02": lambda: holding(0.3, (0.0, 0.02, 0.0)),
    "payload_mass = 0.3\npayload_z = 0.02": lambda: holding(0.3, (0.0, 0.0, 0.02)),
    "payload_volume = 1e-4": lambda: holding(0.0, (0.0, 0.0, 0.0), 1e-4),
    "fluid_density = 1000": lambda: a5.load(1000.0),
    "current_speed = 0.6": lambda: flowing(0.6, 0.0, 0.0),
    "current_speed = 0.6\ncurrent_azimuth = 0.4": lambda: flowing(
        0.6 * np.cos(0.4), 0.6 * np.sin(0.4), 0.0
    ),
    "current_speed = 0.6\ncurrent_elevation = 0.4": lambda: flowing(
        0.6 * np.cos(0.4), 0.0, 0.6 * np.sin(0.4)
    ),
    'corrections = ["none"]': lambda: a5.load(corrections=()),
}


@pytest.mark.parametrize("axes", CASES)
def test_each_axis_of_a_case_is_what_a_single_call_takes(
    axes: str, tmp_path: Path
) -> None:
    arm = CASES[axes]()
    found = quantities(study_of(tmp_path, axes))
    rest = np.zeros(4)
    tau = arm.inverse_dynamics(np.array(Q), np.array(V), rest)
    np.testing.assert_allclose(found["torque"], tau, rtol=1e-9, atol=1e-12)
    efforts = np.array([joint.effort for joint in a5.parameters().joints[:4]])
    np.testing.assert_allclose(found["margin"], efforts - np.abs(tau), rtol=1e-9)
    load = arm.base_wrench(np.array(Q), np.array(V), rest)
    norms = np.linalg.norm(load.linear), np.linalg.norm(load.angular)
    np.testing.assert_allclose(found["mount_force"], [*load.linear, norms[0]])
    np.testing.assert_allclose(
        found["mount_moment"], [*load.angular, norms[1]], atol=1e-11
    )


def test_margin_and_reach_on_a_vehicle_are_those_of_its_arm(tmp_path: Path) -> None:
    axes = 'vehicle = "small"\nlevel = "nominal"'
    found = quantities(study_of(tmp_path, axes, VEHICLE))
    in_trim = quantities(study_of(tmp_path, f"{axes}\ntrim = true", VEHICLE))
    assert np.array_equal(found["torque"], in_trim["torque"])
    level = quantities(study_of(tmp_path, f"{axes}\ntrim = false", VEHICLE))
    assert np.abs(found["torque"] - level["torque"]).max() > 1e-3
    efforts = np.array([joint.effort for joint in a5.parameters().joints[:4]])
    assert found["margin"] == pytest.approx(efforts - np.abs(found["torque"]))
    tip = a5.load().forward_kinematics(np.array(Q)).translation
    assert found["reach"] == pytest.approx([*tip, np.linalg.norm(tip)])
