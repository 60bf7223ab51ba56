"""Torque of drag at the joints of a moving arm, by the tests' own frames and sums."""

from __future__ import annotations

from typing import Any

import current_load
import numpy as np
import reference


def wrench(
    row: dict[str, Any], nu: np.ndarray, density: float = 1025.0, level: int = 1
) -> np.ndarray:
    """Drag on a link with the twist nu (6,) in still water, about its origin, (6,)."""
    total = np.zeros(6)
    for strip in row["strips"]:
        points, force = current_load.strip_drag(
            strip, level, lambda p: -(nu[:3] + np.cross(nu[3:], p)), density
        )
        moment = np.cross(points, force).sum(axis=0)
        total += np.concatenate([force.sum(axis=0), moment])
    return total


def own_torque(q: np.ndarray, v: np.ndarray, current: np.ndarray) -> np.ndarray:
    """Torque of drag at the joints, (4,)."""
    frames = reference.inertial_frames(q)
    rows = current_load.bodies()
    out = np.zeros(4)
    axes = [(frame[:3, 3], frame[:3, 2]) for frame in frames[1:]]
    for i, frame in enumerate(frames):
        turn = frame[:3, :3]
        at = frame[:3, 3]
        spin = np.zeros(3)
        speed = np.zeros(3)
        for k in range(i):
            origin, axis = axes[k]
            spin = spin + v[k] * axis
            speed = speed + v[k] * np.cross(axis, at - origin)
        nu = np.concatenate([turn.T @ (speed - current), turn.T @ spin])
        drag = wrench(rows[f"link_{i}"], nu)
        force = turn @ drag[:3]
        moment = turn @ drag[3:]
        for k in range(i):
            origin, axis = axes[k]
            out[k] += axis @ (moment + np.cross(at - origin, force))
    return out
