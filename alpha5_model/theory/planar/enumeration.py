"""Dexterity of planar arms with joint limits, by trying orientations."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    BoolArray,
    FloatArray,
    count,
    float_array,
    instance,
)
from alpha5_model.errors import InputError
from alpha5_model.theory.planar.arm import (
    PlanarArm,
    first_joint_of,
    within_limits,
    workspace,
)
from alpha5_model.theory.planar.curves import TURN, Arc, Curve, Segment, turned

#: Distance, as a share of the reach, and angle [rad] that count as zero.
_TOLERANCE = 1e-9
#: Points that outline each boundary curve of a map.
_OUTLINE = 181


@dataclass(frozen=True, eq=False)
class DexterityMap:
    """Dexterity over a square grid on the workspace's bounding box.

    Attributes:
        x, y: Grid lines, (I,) and (J,) [m].
        share: Share of orientations reached at (x[i], y[j]), (J, I); 0 outside the
            workspace.
        spacing: Distance between grid lines [m].
        orientations: Number of orientations tried: gaps narrower than 2 pi /
            orientations can be missed.
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
        resolution: Grid lines along the longer side of the workspace's bounding box, 2
            or more.
        orientations, samples: See `dexterity`.
    """
    if count("resolution", resolution) < 2:
        raise InputError("resolution", resolution, "at least 2 grid lines")
    space = workspace(arm)
    outlines = [
        curve.point(np.linspace(*curve.interval, _OUTLINE)) for curve in space.curves
    ]
    corners = np.concatenate(outlines)
    low = corners.min(axis=0)
    high = corners.max(axis=0)
    spacing = float((high - low).max()) / (resolution - 1)
    x = np.arange(low[0], high[0] + spacing, spacing)
    y = np.arange(low[1], high[1] + spacing, spacing)

    grid = np.stack(np.meshgrid(x, y), axis=-1)
    inside = space.contains(grid)
    share = np.zeros(inside.shape)
    share[inside] = dexterity(arm, grid[inside], orientations, samples)
    return DexterityMap(
        x=x, y=y, share=share, spacing=spacing, orientations=orientations
    )


def dexterity(
    arm: PlanarArm, points: ArrayLike, orientations: int = 360, samples: int = 181
) -> FloatArray:
    """Share of orientations with which points are reached within the joint limits.

    Evenly spaced orientations are tried. For each, the last three joints are solved in
    closed form; joints before them are sampled evenly from limit to limit. A point
    counts as dexterous if the share is 1. A range of orientations narrower than 2 pi /
    orientations can be missed, and with more than three joints some orientations are
    missed near the boundary.

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
    if instance("arm", arm, PlanarArm).n < 3 or arm.joints[-1] != "R":
        raise InputError("arm", arm.joints, "three joints or more, the last one R")
    orientations = count("orientations", orientations)
    samples = count("samples", samples)
    flat = p.reshape(-1, 2)
    # No point beyond the arm's length is reached, and its square may overflow.
    near = np.abs(flat).max(axis=1) <= (1 + 1e-8) * arm.reach
    phi = np.arange(orientations) * (TURN / orientations)
    last_link = arm.lengths[-1] * np.stack([np.cos(phi), np.sin(phi)], axis=-1)
    wrist = flat[near, None, :] - last_link

    found = np.zeros((len(flat), orientations), dtype=bool)
    tail = arm.part(arm.n - 3)
    for x, y, heading in _sampled_starts(arm, samples):
        seen = turned(wrist - (x, y), -heading)
        found[near] |= _three_joint_reach(tail, seen, phi - heading)
    return np.asarray(found.mean(axis=1).reshape(p.shape[:-1]))


def _sampled_starts(arm: PlanarArm, samples: int) -> FloatArray:
    """Poses of the link before the last three joints, (K, 3)."""
    head = arm.n - 3
    if head == 0:
        return np.zeros((1, 3))
    axes = [
        np.linspace(*(limit or (-math.pi, math.pi)), samples)
        for limit in arm.limits[:head]
    ]
    q = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, head)
    return arm.part(0, head).forward_kinematics(q)


def _three_joint_reach(arm: PlanarArm, wrist: FloatArray, phi: FloatArray) -> BoolArray:
    """Whether three joints reach poses, (...) bool.

    Args:
        arm: The arm of three joints.
        wrist: Where joint 3 has to be, (..., 2) [m]: joints 1 and 2 bring it there.
        phi: Direction of the last link, (...) [rad].
    """
    tolerance = _TOLERANCE * arm.reach
    path = _path_of_second_joint(arm)
    points = wrist.reshape(-1, 2)
    ((first, there),) = first_joint_of(arm).positions_onto(points, [path], tolerance)
    second = _second_position(arm, there)
    third = np.broadcast_to(phi, wrist.shape[:-1]).reshape(-1, 1) - math.fsum(
        arm.angles
    )
    for kind, q in zip(arm.joints[:2], (first, second), strict=True):
        if kind == "R":
            third = third - q

    reached = np.ones(first.shape, dtype=bool)
    for joint, q in enumerate((first, second, third)):
        reached &= within_limits(arm, joint, q, _TOLERANCE)
    return np.asarray(reached.any(axis=-1).reshape(wrist.shape[:-1]))


def _path_of_second_joint(arm: PlanarArm) -> Curve:
    """Where the second joint carries the end of its link, in the frame of link 1."""
    length = arm.lengths[1]
    if arm.joints[1] == "R":
        return Arc(center=(0.0, 0.0), radius=length)
    low, high = arm.limits[1] or (0.0, 0.0)
    travel = Segment(start=(length + low, 0.0), angle=0.0, length=high - low)
    return travel.moved(arm.angles[1], (0.0, 0.0))


def _second_position(arm: PlanarArm, there: FloatArray) -> FloatArray:
    """Position of the second joint that puts the end of its link at points (..., 2)."""
    angle = arm.angles[1]
    if arm.joints[1] == "R":
        return np.asarray(np.arctan2(there[..., 1], there[..., 0]) - angle)
    return np.asarray(turned(there, -angle)[..., 0] - arm.lengths[1])
