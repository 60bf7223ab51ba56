"""Arms that are weighed: their loads by Pinocchio, and what sensors show, by statics.

Nothing here is the package's but the arm's Pinocchio model, which has tests of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
from identification.calibration_trials import loads as loads_of_arm
from identification.calibration_trials import on_scales
from scipy.optimize import root

import alpha5_model as a5

DOWN = np.array([0.0, 0.0, -9.81])
#: A small vehicle; the arm hangs below it, turned.
VEHICLE: dict[str, Any] = {
    "mass": 11.5,
    "com": [0.01, 0.0, -0.02],
    "volume": 0.01115,
    "cob": [0.0, 0.01, 0.035],
    "xyz": [0.2, 0.05, -0.12],
    "rpy": [np.pi, 0.05, 0.3],
}


def loads(
    record: Any, density: float, gravity: Any, q: Any, v: Any = None, a: Any = None
) -> np.ndarray:
    """Joint torques, force and moment on the mount by Pinocchio, (N, 10)."""
    arm = a5.uncertainty.arm(record, density)
    for model in (arm.model, arm.fluid_model):
        model.gravity.linear = np.asarray(gravity, float)
    rest = np.zeros_like(q)
    return loads_of_arm(arm, q, rest if v is None else v, rest if a is None else a)


def rotation(rpy: Any) -> np.ndarray:
    """By roll, pitch, yaw about fixed axes."""
    return np.asarray(pin.rpy.rpyToMatrix(*np.asarray(rpy, float)))


def trim(
    record: Any, density: float, q: Any, facts: Mapping[str, Any], yaw: float = 0.0
) -> np.ndarray:
    """Roll and pitch at which nothing turns the vehicle, by a search, (2,)."""
    mount = rotation([0.0, 0.0, yaw]) @ rotation(facts["rpy"])

    def moment(angles: Any) -> Any:
        gravity = rotation([*angles, 0.0]).T @ DOWN
        load = loads(record, density, mount.T @ gravity, q[None])[0]
        force, own = mount @ load[4:7], mount @ load[7:]
        of_arm = own + np.cross(facts["xyz"], force)
        weight = np.cross(facts["com"], facts["mass"] * gravity)
        buoyancy = np.cross(facts["cob"], -density * facts["volume"] * gravity)
        return (rotation([*angles, 0.0]) @ (of_arm + weight + buoyancy))[:2]

    found = root(moment, [0.0, 0.0], tol=1e-13)
    assert np.abs(found.fun).max() < 1e-9
    return np.asarray(found.x)


def other_arm(seed: int, size: float = 0.002, zeros: float = 0.5) -> Any:
    """An arm whose masses are off by a share, zeros by some degrees."""
    rng = np.random.default_rng(seed)
    arm = a5.parameters()
    links = []
    for link in arm.links:
        masses = 1.0 + size * rng.normal(size=2)
        shift = 0.03 * size * rng.normal(size=3)
        links.append(
            replace(
                link,
                mass=link.mass * masses[0],
                volume=link.volume * masses[1],
                com=link.com + shift,
            )
        )
    rows = list(arm.dh)
    for i in range(4):
        offset = rows[i].theta_offset + np.radians(zeros) * rng.normal()
        rows[i] = replace(rows[i], theta_offset=offset)
    return replace(arm, links=tuple(links), dh=tuple(rows))


def random_q(count: int, seed: int = 0) -> Any:
    """Joint positions within the limits."""
    joints = a5.parameters().joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    return np.random.default_rng(seed).uniform(lower, upper, (count, 4))


def weighed(planned: Any, record: Any, seed: int, noise: float = 1.0) -> Any:
    """A session with readings of an arm on a tilted mount, with gains and offsets."""
    rng = np.random.default_rng(seed)
    sensor = planned.sensor
    tilt = np.append(0.005 * rng.normal(size=2), 0.0)
    gravity = planned.gravity + np.cross(tilt, planned.gravity)
    gravity *= 9.81 / np.linalg.norm(gravity)
    load = loads(record, planned.density, gravity, planned.q, planned.v, planned.a)
    clean = {
        "scales": lambda: on_scales(load),
        "force-torque": lambda: load[:, 4:],
        "efforts": lambda: load[:, :4],
    }[sensor.kind]()
    clean = clean * (1.0 + sensor.gain * rng.normal(size=sensor.size))
    if sensor.kind != "efforts":
        clean = clean + 0.4 * rng.normal(size=sensor.size)
    error = noise * sensor.deviation * rng.normal(size=clean.shape)
    return a5.calibrate.with_readings(planned, clean + error)
