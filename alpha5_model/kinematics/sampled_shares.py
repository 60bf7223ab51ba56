"""Shares of the reachable set, estimated from random points."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from alpha5_model._support import checks
from alpha5_model._support.checks import FloatArray
from alpha5_model.kinematics.areas import cross_section_area, volume
from alpha5_model.kinematics.half_plane import POSES, azimuth_beyond
from alpha5_model.kinematics.plane import ArmPlane
from alpha5_model.kinematics.reachable_points import Accept, reachable

#: A pose can face an azimuth if it misses it by less than this [rad].
_FACED = 1e-6


class SampledShare(NamedTuple):
    """A share of the reachable set, from points drawn evenly from it.

    Attributes:
        share: 0 to 1.
        standard_error: Of the share, 1 sigma; computed with one success and one
            failure added, so that it is never zero.
        total: Exact volume of the reachable set [m^3], or its area in a half-plane
            [m^2].
        samples: Number of points.
    """

    share: float
    standard_error: float
    total: float
    samples: int


def sampled_share(
    plane: ArmPlane, accept: Accept, samples: int, seed: int, azimuth: float | None
) -> SampledShare:
    """Share of the reachable set that is reached in accepted joint positions."""
    number = checks.count("samples", samples)
    rng = checks.generator(seed)
    fixed = None if azimuth is None else checks.real("azimuth", azimuth)

    points = _reachable_points(plane, number, rng, fixed)
    hits = int(reachable(plane, points, limits=True, accept=accept).sum())
    smoothed = (hits + 1) / (number + 2)
    return SampledShare(
        share=hits / number,
        standard_error=math.sqrt(smoothed * (1 - smoothed) / number),
        total=volume(plane, limits=True) if fixed is None else _area(plane, fixed),
        samples=number,
    )


def _reachable_points(
    plane: ArmPlane, number: int, rng: np.random.Generator, azimuth: float | None
) -> FloatArray:
    """Points drawn evenly from the reachable set or a half-plane of it, (number, 3)."""
    parts: list[FloatArray] = []
    found = 0
    while found < number:
        missing = number - found
        points = _points_around(plane, 2 * missing + 16, rng, azimuth)
        inside = reachable(plane, points, limits=True, accept=None)
        parts.append(points[inside][:missing])
        found += len(parts[-1])
    return np.concatenate(parts)


def _points_around(
    plane: ArmPlane, number: int, rng: np.random.Generator, azimuth: float | None
) -> FloatArray:
    """Points drawn evenly from a cylinder around the reachable set, (number, 3)."""
    u, height, turn = rng.uniform(size=(3, number))
    if azimuth is None:
        share_of_radius = np.sqrt(u)  # even in volume: R^2 is uniform
        angle = 2 * math.pi * turn
    else:
        share_of_radius = u  # even in area
        angle = np.full_like(turn, azimuth)
    radius = (plane.a_0 + plane.longest) * share_of_radius
    z = plane.d_0 + plane.longest * (2 * height - 1)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)


def _area(plane: ArmPlane, azimuth: float) -> float:
    """Area that the poses which can face an azimuth reach in its half-plane [m^2]."""
    facing = []
    for pose in POSES:
        if abs(azimuth_beyond(plane, azimuth, pose)) < _FACED:
            facing.append(pose)
    side = facing[0] if len(facing) == 1 else "both"
    return cross_section_area(plane, side, limits=True)
