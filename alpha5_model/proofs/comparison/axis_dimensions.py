"""Lengths, zeros and link frames of an arm, from the lines of its four joint axes.

The twists are Table 1's: axis_e is square to axis_d, which is parallel to axis_c, which
is square to axis_b. What does not fit them, or needs a length that Table 1 does not
have, is left over.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform, wrap
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.comparison.axis_lines import AxisLines, X, Z

#: Larger angles between axes, and distances that Table 1 does not have, are named: what
#: is smaller moves the tool by less than the digits of any file.
SAME_ANGLE, SAME_LENGTH = 1e-7, 1e-8  # [rad], [m]


class AxisDimensions(NamedTuple):
    """What the axes of an arm say, at joint position zero.

    Attributes:
        lengths: a_0, d_0, a_1 and a_2 by name [m].
        zeros: What is added to DH angles 0 to 2 [rad].
        frames: Poses of link_1, link_2 and link_3, and of link_4 before its own angle,
            (4, 4, 4).
        odd: What an arm with Table 1's twists cannot have, in words.
    """

    lengths: dict[str, float]
    zeros: list[float]
    frames: FloatArray
    odd: tuple[str, ...]


def axis_dimensions(
    lines: AxisLines, base: FloatArray, parameters: Alpha5Parameters
) -> AxisDimensions:
    """The dimensions of an arm whose axes are given.

    Args:
        lines: The axes at joint position zero, base to tip, (4, 3), with the directions
            that Table 1 gives them.
        base: Pose of base_link, whose z is the first axis, in the same frame, (4, 4).
        parameters: Table 1's twists and angles.
    """
    lengths: dict[str, float] = {}
    zeros: list[float] = []
    frames: list[FloatArray] = []
    odd: list[str] = []
    frame = base
    for i, row in enumerate(parameters.dh[:3]):
        next_point = lines.points[i + 1]
        next_direction = lines.directions[i + 1]
        angle = _angle(frame, row.alpha, next_point, next_direction)
        link = frame @ transform(rotation_about(Z, angle))
        zeros.append(float(wrap(angle - row.theta_offset)))
        frames.append(link)

        twist = transform(rotation_about(X, row.alpha))
        a, d = _along_x_and_z(link, next_point, next_direction)
        odd += _left_over(i, link @ twist, next_direction, d)
        lengths[f"a_{i}"] = a
        if i == 0:
            lengths["d_0"] = d
        shift = [a, 0.0, d if i == 0 else 0.0]
        frame = link @ transform(None, shift) @ twist
    frames.append(frame)
    return AxisDimensions(
        lengths=lengths, zeros=zeros, frames=np.array(frames), odd=tuple(odd)
    )


def _angle(
    frame: FloatArray, twist: float, point: FloatArray, direction: FloatArray
) -> float:
    """The joint's angle, by which x becomes the common normal with the next axis."""
    to_frame = frame[:3, :3].T
    if abs(math.sin(twist)) > 0.5:  # square: by the next axis' direction
        x, y, _ = to_frame @ direction
        side = math.copysign(1.0, math.sin(twist))
        return math.atan2(side * x, -side * y)
    x, y, _ = to_frame @ (point - frame[:3, 3])  # parallel: by its place
    return math.atan2(y, x)


def _along_x_and_z(
    link: FloatArray, point: FloatArray, direction: FloatArray
) -> tuple[float, float]:
    """Where the next axis crosses the plane of x and z of a link [m]."""
    to_link = link[:3, :3].T
    x, y, z = to_link @ (point - link[:3, 3])
    along_x, along_y, along_z = to_link @ direction
    if abs(along_y) < 0.5:  # parallel to z: it crosses nowhere, or is in the plane
        return float(x), 0.0
    steps = -y / along_y
    return float(x + steps * along_x), float(z + steps * along_z)


def _left_over(
    i: int, next_frame: FloatArray, direction: FloatArray, d: float
) -> Iterator[str]:
    """What the next axis has and Table 1 has not."""
    names = ("axis_e", "axis_d", "axis_c", "axis_b")
    pair = f"{names[i]} and {names[i + 1]}"
    sine = float(np.linalg.norm(np.cross(next_frame[:3, 2], direction)))
    if sine > SAME_ANGLE:
        square = "parallel" if i == 1 else "square"
        degrees = math.degrees(math.asin(min(sine, 1.0)))
        yield f"{pair} are {degrees:.3g} deg from {square}"
    if i > 0 and abs(d) > SAME_LENGTH:
        yield f"{names[i + 1]} is {1e3 * d:.3g} mm beside the plane of the arm"
