"""Where another model's bodies are in our link frames, once its axes are aligned."""

from __future__ import annotations

import math

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, rotation_about, transform
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.axis_lines import Z
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.poses import carried_to, rotation_of


def bodies_in_our_frames(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> tuple[FloatArray, FloatArray]:
    """COMs (5, 3) [m] and tensors (5, 3, 3) of the other bodies in our link frames."""
    transforms = body_transforms(ours, theirs, alignment)
    return carried_to(transforms, theirs.com, theirs.inertia)


def body_transforms(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> FloatArray:
    """transform_theirs_to_ours of the five body frames, (5, 4, 4).

    Each body is placed by its own joint: a misplaced joint is an error of the geometry,
    and must not count as an error of the COM too. Body 0 is placed by the frame that
    was meant to be base_link, if there is one.
    """
    there = alignment.base @ theirs.poses(alignment.zero)
    to_ours = np.linalg.inv(ours.zero_poses(alignment.dimensions))
    transforms: FloatArray = to_ours @ there
    if alignment.same_base:
        transforms[0] = np.linalg.inv(theirs.link_poses[alignment.base_link])
        transforms[1] = _by_base_or_shoulder(
            ours, theirs, transforms[1], alignment.stands[2, 3]
        )
    return transforms


def _by_base_or_shoulder(
    ours: OwnArm, theirs: FourJointArm, by_shoulder: FloatArray, height: float
) -> FloatArray:
    """Transform of body 1, placed by the shoulder or by the base.

    The one with the better COM is taken.

    Args:
        ours: Our arm.
        theirs: The other arm.
        by_shoulder: The transform by the shoulder, (4, 4).
        height: How high their base_link is above ours [m].
    """
    by_base = by_shoulder.copy()
    by_base[2, 3] -= height
    choices = np.stack([by_base, by_shoulder])
    coms = moved(choices, theirs.com[1])
    off = np.linalg.norm(coms - ours.reduced.com[1], axis=1)
    return np.asarray(choices[off.argmin()])


def mended_transforms(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> FloatArray:
    """The `body_transforms` after the joints are corrected, (5, 4, 4).

    The axis of each body then lies exactly on ours.
    """
    transforms = body_transforms(ours, theirs, alignment)
    axes = alignment.sign[:, None] * theirs.axes
    for body, axis in enumerate(axes, start=1):
        transforms[body] = _on_z_axis(transforms[body], axis)
    return transforms


def _on_z_axis(pose: FloatArray, axis: FloatArray) -> FloatArray:
    """The pose, moved as little as possible to bring its axis (3,) onto z, (4, 4)."""
    rotation = rotation_of(pose)
    direction = rotation @ axis
    normal = np.cross(direction, Z)
    sine = float(np.linalg.norm(normal))
    turn = np.eye(3)
    if sine > 1e-15:
        turn = rotation_about(normal / sine, math.atan2(sine, direction[2]))
    return transform(turn @ rotation, [0.0, 0.0, pose[2, 3]])


def body_errors(ours: OwnArm, theirs: FourJointArm, alignment: Alignment) -> FloatArray:
    """Error of each body as one number in second moments, (5,) [kg m^2]."""
    com, inertia = bodies_in_our_frames(ours, theirs, alignment)
    arm = ours.reduced
    distances = np.square(com - arm.com).sum(axis=1)
    tensors = np.abs(inertia - arm.inertia).max(axis=(1, 2))
    return np.asarray(arm.mass * distances + tensors)
