"""Which link of another model was meant to be our base_link."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.own_arm import OwnArm
from alpha5_model.proofs.comparison.poses import origin_of

#: A frame this close to our base_link was meant to be base_link; a radian of tilt
#: counts as 0.1 m.
SAME_FRAME = 0.05  # [m]
#: So was a frame in which the COM of link_0 is this close to ours.
SAME_COM = 0.02  # [m]


class _Candidate(NamedTuple):
    """A link between the root and axis_e.

    Attributes:
        name: Its name.
        pose: Its pose in our root frame, (4, 4).
        distance: How far it is from our base_link [m]; see `distance_from_base`.
        same: Whether it could be meant to be base_link.
        named: Whether its name ends in "base" or "base_link".
    """

    name: str
    pose: FloatArray
    distance: float
    same: bool
    named: bool

    @property
    def unlikeliness(self) -> tuple[bool, float]:
        """Key that sorts the likeliest first: by name, then distance and direction."""
        has_name = self.same and self.named
        forward = self.pose[0, 0]
        return not has_name, round(self.distance - 1e-3 * forward, 6)


def with_base_link(
    theirs: FourJointArm, com_errors: Mapping[str, float], alignment: Alignment
) -> Alignment:
    """The alignment, with the link that comes closest to being our base_link.

    A link is recognized by its frame, or by the COM of link_0 in its frame if axis_e is
    misplaced, or by its place and name if axis_e is upside down. If several links
    qualify, the one with the right name is taken.

    Args:
        theirs: The other arm.
        com_errors: See `com_errors_by_link`.
        alignment: How it lies in our root frame.
    """
    candidates = [
        _candidate(theirs, com_errors.get(name), alignment, name)
        for name in theirs.base_path
    ]
    best = min(candidates, key=lambda candidate: candidate.unlikeliness)
    return replace(
        alignment, base_link=best.name, stands=best.pose, same_base=best.same
    )


def _candidate(
    theirs: FourJointArm, com_error: float | None, alignment: Alignment, name: str
) -> _Candidate:
    """Judge one link."""
    pose = alignment.base @ theirs.link_poses[name]
    distance = distance_from_base(pose)
    named = name.lower().endswith(("base", "base_link"))

    same = distance < SAME_FRAME
    if named:
        in_place = np.linalg.norm(origin_of(pose)) < SAME_FRAME
        same = same or bool(in_place)
    if com_error is not None and com_error < SAME_COM:
        same = True
        distance = min(distance, SAME_FRAME + com_error)
    return _Candidate(name=name, pose=pose, distance=distance, same=same, named=named)


def com_errors_by_link(ours: OwnArm, theirs: FourJointArm) -> dict[str, float]:
    """How far link_0's COM would be from ours if a link were base_link [m].

    It is the same for all alignments. Without a mass of link_0 there is none.
    """
    if not theirs.mass[0]:
        return {}
    return {name: _com_error(ours, theirs, name) for name in theirs.base_path}


def _com_error(ours: OwnArm, theirs: FourJointArm, name: str) -> float:
    to_link: FloatArray = np.asarray(np.linalg.inv(theirs.link_poses[name]), np.float64)
    com = moved(to_link, theirs.com[0])
    return float(np.linalg.norm(com - ours.reduced.com[0]))


def distance_from_base(pose: FloatArray) -> float:
    """Distance of a frame (4, 4) from our base_link, without its yaw [m].

    A radian of tilt counts as 0.1 m.
    """
    tilt = math.acos(np.clip(pose[2, 2], -1, 1))
    return float(np.linalg.norm(origin_of(pose)) + 0.1 * tilt)
