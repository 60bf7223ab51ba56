"""The load of a steady current on an arm at rest, a second route for the tests.

Nothing here comes from the package: the text of a data file has the strips, and the
frames are those of `reference`. Drag is a plain sum over short pieces of each strip. A
steady current has a Munk moment ``u x (A u)`` on each link.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import reference

FILES = Path(__file__).parents[2] / "alpha5_model" / "numbers"


@cache
def bodies(numbers: str = "estimated") -> dict:
    """The bodies of a set of numbers as they stand in its file."""
    text = (FILES / f"{numbers}_hydrodynamics.toml").read_text("utf-8")
    return tomllib.loads(text)["bodies"]


def strip_drag(strip: dict, level: int, velocity, density: float, pieces: int = 400):
    """Points (n, 3) [m] along a strip and the drag on each piece (n, 3) [N].

    ``velocity`` gives that of the water relative to the points, (n, 3).
    """
    start, end = (np.array(strip[key], dtype=float) / 1000 for key in ("start", "end"))
    length = np.linalg.norm(end - start)
    axis = (end - start) / length
    points = start + (np.arange(pieces)[:, None] + 0.5) / pieces * (end - start)
    flow = velocity(points)
    along = (flow @ axis)[:, None] * axis
    across = flow - along
    area = 0.5 * density * float(strip["diameter"]) / 1000 * length / pieces
    force = (
        float(strip["across"][level]) * np.linalg.norm(across, axis=1)[:, None] * across
    )
    force += (
        float(strip["along"][level]) * np.linalg.norm(along, axis=1)[:, None] * along
    )
    return points, area * force


def added_mass(row: dict, level: int) -> np.ndarray:
    """Added mass of a row of the file at a level, (6, 6), by energies.

    The kinetic energy of a motion is that of its parts at the centre, each in
    proportion to the root of its share. The centre is found by a search.
    """
    from scipy.optimize import least_squares

    matrix = np.array(row["added_mass"], dtype=float)
    factor = float(row["added_mass_factor"][level])
    if level == 1:
        return factor * matrix

    def coupling(r):
        return (matrix[:3, 3:] + matrix[:3, :3] @ skew(r)).ravel()

    centre = least_squares(coupling, np.zeros(3), xtol=1e-15, gtol=1e-15).x
    key = "shape_low" if level == 0 else "shape_high"
    roots = np.sqrt(np.array(row[key], dtype=float))
    columns = []
    for motion in np.eye(6):
        velocity, spin = motion[:3], motion[3:]
        at_centre = np.concatenate([velocity + np.cross(spin, centre), spin]) * roots
        back = at_centre[:3] - np.cross(at_centre[3:], centre)
        columns.append(np.concatenate([back, at_centre[3:]]))
    motions = np.transpose(columns)
    return factor * motions.T @ matrix @ motions


def skew(r) -> np.ndarray:
    """The matrix of ``r x``."""
    return np.cross(np.eye(3), r).T @ -np.eye(3)


def load(q, current, level: int, density: float = 1025.0, numbers: str = "estimated"):
    """Joint torques (4,) that hold the arm against the current.

    Also returns the force and the moment (3,) on the mount.
    """
    frames, rows = reference.inertial_frames(np.asarray(q)), bodies(numbers)
    wrenches = []
    for i, frame in enumerate(frames):
        row, turn = rows[f"link_{i}"], frame[:3, :3]
        u = turn.T @ np.asarray(current, dtype=float)
        force, moment = np.zeros(3), np.zeros(3)
        for strip in row["strips"]:
            points, drag = strip_drag(
                strip, level, lambda p, u=u: np.tile(u, (len(p), 1)), density
            )
            force += drag.sum(axis=0)
            moment += np.cross(points, drag).sum(axis=0)
        added = added_mass(row, level)
        # The water pushes a body that stands still by -nu x* A nu, nu = -u.
        moment -= np.cross(u, density / 1000 * added[:3, :3] @ u)
        force, moment = turn @ force, turn @ moment
        wrenches.append((force, moment + np.cross(frame[:3, 3], force)))
    torque = np.zeros(4)
    for k in range(4):
        origin, axis = frames[k + 1][:3, 3], frames[k + 1][:3, 2]
        beyond = wrenches[k + 1 :]
        about = sum(m - np.cross(origin, f) for f, m in beyond)
        torque[k] = -axis @ about
    return torque, sum(f for f, _ in wrenches), sum(m for _, m in wrenches)
