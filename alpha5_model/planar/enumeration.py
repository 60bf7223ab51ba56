"""Dexterity of planar arms by enumeration, joint limits included.

Each of evenly spaced orientations of the last link puts the wrist at one place, which the two joints
before reach in at most two ways, in closed form; joints before those are sampled.

References:
    [Lecture7.1] Describing Robot Arms, "Dexterous Workspace" (joint limits reduce it).
    [Siciliano2009] Siciliano et al.: Robotics, section 2.12.1 (solution of the planar arm).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, count, float_array, instance
from alpha5_model.errors import InputError
from alpha5_model.planar.arm import PlanarArm
from alpha5_model.planar.curves import TURN


@dataclass(frozen=True, eq=False)
class DexterityMap:
    """Dexterity over a square grid on the workspace's bounding box.

    Attributes:
        x, y: Grid lines, (I,) and (J,) [m].
        share: Share of orientations reached at (x[i], y[j]), (J, I); 0 outside the workspace.
        spacing: Distance between grid lines [m].
        orientations: How many were tried: gaps narrower than 2 pi / orientations can be missed.
    """

    x: FloatArray
    y: FloatArray
    share: FloatArray
    spacing: float
    orientations: int

    @property
    def area(self) -> float:
        """Area of the dexterous workspace, in whole grid squares [m^2]."""
        return float((self.share == 1).sum()) * self.spacing**2


def dexterity_map(
    arm: PlanarArm, resolution: int = 81, orientations: int = 120, samples: int = 31
) -> DexterityMap:
    """Dexterity over the whole workspace.

    Args:
        arm: See `dexterity`.
        resolution: Grid lines along the longer side of the workspace's bounding box, 2 or more.
        orientations, samples: See `dexterity`.
    """
    if count("resolution", resolution) < 2:
        raise InputError("resolution", resolution, "at least 2 grid lines")
    _check_arm(arm)
    space = arm.workspace()
    points = np.concatenate([c.point(np.linspace(*c.interval, 181)) for c in space.curves])
    low, high = points.min(axis=0), points.max(axis=0)
    spacing = float((high - low).max()) / (resolution - 1)
    x, y = (np.arange(a, b + spacing, spacing) for a, b in zip(low, high, strict=True))
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    inside = space.contains(grid)
    share = np.zeros(inside.shape)
    share[inside] = dexterity(arm, grid[inside], orientations, samples)
    return DexterityMap(x, y, share, spacing, orientations)


def dexterity(
    arm: PlanarArm, points: ArrayLike, orientations: int = 360, samples: int = 181
) -> FloatArray:
    """Share of orientations with which points are reached, numerically, joint limits included.

    The last three joints are solved in closed form for each of evenly spaced orientations; joints
    before them are sampled evenly between their limits, both limits included. A point counts as
    dexterous where the share is 1: a range of orientations narrower than 2 pi / orientations can
    be missed, and with more than three joints some orientations are missed near the boundary.

    Args:
        arm: Three joints or more, the last one revolute.
        points: (..., 2) [m].
        orientations: Number of orientations.
        samples: Number of positions of each joint before the last three.

    Returns:
        0 to 1, (...).

    Raises:
        InputError: Fewer than three joints, or a last joint that slides.
    """
    p = float_array("points", points, (2,))
    _check_arm(arm)
    orientations, samples = count("orientations", orientations), count("samples", samples)
    flat = p.reshape(-1, 2)
    phi = np.arange(orientations) * (TURN / orientations)
    found = np.zeros((len(flat), orientations), dtype=bool)
    tail = arm.part(arm.n - 3)
    wrist = flat[:, None, :] - arm.lengths[-1] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    for x, y, heading in _sampled_starts(arm, samples):
        c, s = math.cos(heading), math.sin(heading)
        local = (wrist - (x, y)) @ np.array([[c, -s], [s, c]])
        found |= _three_joint_reach(tail, local, phi - heading)
    return np.asarray(found.mean(axis=1).reshape(p.shape[:-1]))


def _check_arm(arm: PlanarArm) -> None:
    if instance("arm", arm, PlanarArm).n < 3 or arm.joints[-1] != "R":
        raise InputError("arm", arm.joints, "three joints or more, the last one R")


def _sampled_starts(arm: PlanarArm, samples: int) -> FloatArray:
    """Poses of the link before the last three joints, (K, 3)."""
    head = arm.n - 3
    if head == 0:
        return np.zeros((1, 3))
    axes = [np.linspace(*(limit or (-math.pi, math.pi)), samples) for limit in arm.limits[:head]]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, head)
    return arm.part(0, head).forward_kinematics(q)


def _three_joint_reach(arm: PlanarArm, wrist: FloatArray, phi: FloatArray) -> np.ndarray:
    """Whether joints 1 and 2 reach the wrist (..., 2) and joint 3 then the orientation phi (...)."""
    first, second = wrist_solutions(arm, wrist)
    last = phi[..., None] - math.fsum(arm.angles)
    for kind, q in zip(arm.joints, (first, second), strict=False):
        last = last - (q if kind == "R" else 0.0)
    ok = _within(first, arm, 0) & _within(second, arm, 1) & _within(last, arm, 2)
    return np.asarray(ok.any(axis=-1))


def wrist_solutions(arm: PlanarArm, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions of an arm's first two joints that bring the end of link 2 to points.

    Limits are not asked for. The four cases (RR, RP, PR, PP) intersect the path on which joint 1
    carries the target, seen from link 1, with the path of the end of link 2.

    Args:
        arm: Two joints or more; the others do not matter.
        points: (..., 2) [m].

    Returns:
        q_1 and q_2, (..., 2) each, one column per solution, NaN where there is none. Directions that
        are free (the target on the pivot) come out as one of many.
    """
    (l_1, l_2), (b_1, b_2), kinds = arm.lengths[:2], arm.angles[:2], arm.joints[:2]
    x, y = points[..., 0], points[..., 1]
    sign = np.array([1.0, -1.0])
    tolerance = 1e-9 * max(arm.reach, l_1 + l_2)
    with np.errstate(invalid="ignore", divide="ignore"):
        if kinds[0] == "R":
            r, bearing = np.hypot(x, y)[..., None], np.arctan2(y, x)[..., None]
            if kinds[1] == "R":  # the law of cosines
                cosine = (r**2 - l_1**2 - l_2**2) / (2 * l_1 * l_2)
                slack = tolerance * (l_1 + l_2) / (l_1 * l_2)
                elbow = np.where(np.abs(cosine) <= 1 + slack, np.clip(cosine, -1, 1), np.nan)
                turn = sign * np.arccos(elbow)
                tip_x, tip_y = l_1 + l_2 * np.cos(turn), l_2 * np.sin(turn)
                second = turn - b_2
            else:  # l_1 + (l_2 + q) u has length r
                along, across = l_1 * math.cos(b_2), l_1 * math.sin(b_2)
                square = r**2 - across**2
                root = np.where(square < 0, np.where(square > -2 * tolerance * r, 0.0, np.nan), 1.0)
                length = -along + sign * root * np.sqrt(np.maximum(square, 0.0))
                tip_x, tip_y = l_1 + length * math.cos(b_2), length * math.sin(b_2)
                second = length - l_2
            first = bearing - np.arctan2(tip_y, tip_x) - b_1
            return first, second + np.zeros_like(first)
        c, s = math.cos(b_1), math.sin(b_1)
        local_x, local_y = (c * x + s * y)[..., None], (c * y - s * x)[..., None]
        if kinds[1] == "R":
            sine = local_y / l_2
            sine = np.where(np.abs(sine) <= 1 + tolerance / l_2, np.clip(sine, -1, 1), np.nan)
            turn = np.where(sign > 0, np.arcsin(sine), math.pi - np.arcsin(sine))
            return local_x - l_2 * np.cos(turn) - l_1, turn - b_2
        length = local_y / math.sin(b_2) if abs(math.sin(b_2)) > 1e-9 else local_y * np.nan
        pair = length + np.zeros(2)
        return local_x - pair * math.cos(b_2) - l_1, pair - l_2


def _within(q: FloatArray, arm: PlanarArm, joint: int) -> np.ndarray:
    """Whether positions lie in a joint's limits; NaN does not."""
    limit = arm.limits[joint]
    if limit is None:
        return ~np.isnan(q)
    low, high = limit
    if arm.joints[joint] == "P":
        return np.asarray((q >= low - 1e-9) & (q <= high + 1e-9))
    with np.errstate(invalid="ignore"):
        return np.asarray(np.mod(q - low + 1e-9, TURN) <= high - low + 2e-9)
