"""The arm of another model as a record of our own, and what the record cannot say."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import transform
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.mount import Mount
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    LinkParameters,
)
from alpha5_model.numbers.tool import ToolPose
from alpha5_model.proofs.comparison.axis_dimensions import (
    SAME_ANGLE,
    SAME_LENGTH,
    AxisDimensions,
    axis_dimensions,
)
from alpha5_model.proofs.comparison.axis_lines import AxisLines
from alpha5_model.proofs.comparison.best_alignment import align_turning_as_ours
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.poses import carried_to

_WITHOUT_WATER = (
    "volumes and centres of buoyancy, which a URDF does not have, are as printed"
)
#: Relative difference of numbers that is rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class ModelArm:
    """The arm of another model.

    Attributes:
        parameters: The record: lengths, zeros, limits, links, tool and mount are the
            other model's, all else is the catalogue's.
        left_out: What the record does not say, in words.
    """

    parameters: Alpha5Parameters
    left_out: tuple[str, ...]


class _Record:
    """A record that takes the other model's numbers part by part.

    A part that no arm can have stays as printed, and is named in ``left_out``.
    """

    def __init__(self, parameters: Alpha5Parameters) -> None:
        self.parameters = parameters
        self.left_out: list[str] = []

    def take(self, what: str, change: Callable[[], dict[str, Any]]) -> None:
        """Change fields of the record, if the result is an arm."""
        try:
            self.parameters = replace(self.parameters, **change())
        except InputError as error:
            self.left_out.append(f"{what} as printed: {error}")


def arm_of_model(evidence: Evidence) -> ModelArm:
    """The arm of another model, from the poses of its joints and bodies.

    A joint that turns the other way counts in our direction.

    Args:
        evidence: The other model, aligned with the catalogue's arm.
    """
    theirs = evidence.theirs
    as_ours = align_turning_as_ours(evidence.ours, theirs)
    evidence = replace(evidence, alignment=as_ours or evidence.alignment)
    alignment = evidence.alignment
    at_zero = np.zeros(4)
    lines = theirs.axis_lines(at_zero)
    directions = lines.directions * alignment.sign[:, None]
    lines = AxisLines(points=lines.points, directions=directions)
    base = _base_frame(evidence, lines)
    dimensions = axis_dimensions(lines, base, evidence.parameters)
    wrist_zero = -float(alignment.sign[3] * alignment.zero[3])
    links = _link_frames(evidence.parameters, base, dimensions, wrist_zero)

    record = _Record(evidence.parameters)
    record.left_out += dimensions.odd
    record.left_out += _reversed_joints(evidence)
    zeros = [*dimensions.zeros, wrist_zero]
    record.take("lengths and zeros", lambda: _dh(record, dimensions.lengths, zeros))
    for i in range(4):
        _take_limits(record, evidence, i)
    bodies = np.linalg.inv(links) @ theirs.poses(at_zero)
    for i in range(5):
        _take_body(record, evidence, i, bodies[i])
    _take_tool(record, evidence, bodies[4])
    _take_mount(record, evidence, base)
    record.take("the name", lambda: {"name": _plain(evidence.other.name)})
    record.left_out.append(_WITHOUT_WATER)
    return ModelArm(parameters=record.parameters, left_out=tuple(record.left_out))


def _base_frame(evidence: Evidence, lines: AxisLines) -> FloatArray:
    """Pose of base_link in their root, (4, 4): their own frame, put on the first axis.

    Its z is the axis, its origin the point of the axis that is closest, and its x the
    direction that is closest.
    """
    alignment = evidence.alignment
    meant = np.linalg.inv(alignment.base)
    if alignment.same_base:
        meant = evidence.theirs.link_poses[alignment.base_link]

    z = lines.directions[0]
    along = (meant[:3, 3] - lines.points[0]) @ z
    across = meant[:3, 0] - (meant[:3, 0] @ z) * z
    x = across / np.linalg.norm(across)
    rotation = np.column_stack([x, np.cross(z, x), z])
    return transform(rotation, lines.points[0] + along * z)


def _link_frames(
    parameters: Alpha5Parameters,
    base: FloatArray,
    dimensions: AxisDimensions,
    wrist_zero: float,
) -> FloatArray:
    """Poses of link_0 to link_4 in their root at joint position zero, (5, 4, 4)."""
    link_0 = base @ transform(_about_z(parameters.base_yaw))
    *before, wrist = dimensions.frames
    turned = _about_z(parameters.dh[3].theta_offset + wrist_zero)
    return np.array([link_0, *before, wrist @ transform(turned)])


def _about_z(angle: float) -> FloatArray:
    sine, cosine = np.sin(angle), np.cos(angle)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _reversed_joints(evidence: Evidence) -> list[str]:
    joints = zip(evidence.theirs.joints, evidence.alignment.sign, strict=True)
    return [
        f"{joint.name} turns the other way: its positions count with the other sign"
        for joint, sign in joints
        if sign < 0
    ]


def _dh(
    record: _Record, lengths: dict[str, float], zeros: Sequence[float]
) -> dict[str, Any]:
    """The rows of Table 1 with the lengths and zeros that differ."""
    rows = list(record.parameters.dh)
    for name, length in lengths.items():
        i, field = LENGTHS[name]
        if abs(length - getattr(rows[i], field)) > SAME_LENGTH:
            change: dict[str, Any] = {field: length}
            rows[i] = replace(rows[i], **change)
    for i, zero in enumerate(zeros):
        if abs(zero) > SAME_ANGLE:
            rows[i] = replace(rows[i], theta_offset=rows[i].theta_offset + zero)
    return {"dh": tuple(rows)}


def _take_limits(record: _Record, evidence: Evidence, i: int) -> None:
    """Range, speed and effort of joint i."""
    theirs = evidence.theirs.joints[i]
    ours = record.parameters.joints[i]
    if theirs.lower is None or theirs.upper is None:
        record.left_out.append(f"{theirs.name} has no limits: {ours.name}'s as printed")
        return

    ends = sorted(
        float(evidence.alignment.sign[i]) * x for x in (theirs.lower, theirs.upper)
    )
    wanted = {
        "lower": ends[0],
        "upper": ends[1],
        "velocity": theirs.velocity,
        "effort": theirs.effort,
    }
    for field, value in wanted.items():
        if not value and field in ("velocity", "effort"):
            record.left_out.append(f"{theirs.name} has no {field}: as printed")

    def limited() -> dict[str, Any]:
        joints: list[JointParameters] = list(record.parameters.joints)
        own = {k: v for k, v in wanted.items() if v or k in ("lower", "upper")}
        changed = {k: v for k, v in own.items() if _differs(v, getattr(ours, k))}
        joints[i] = replace(ours, **changed)
        return {"joints": tuple(joints)}

    record.take(f"limits of {ours.name}", limited)


def _take_body(record: _Record, evidence: Evidence, i: int, pose: FloatArray) -> None:
    """Mass, COM and inertia of body i, whose frame has this pose in our link."""
    theirs = evidence.theirs
    name = record.parameters.links[i].name
    com, inertia = carried_to(pose, theirs.com[i], theirs.inertia[i])
    mass = {"mass": float(theirs.mass[i])}
    record.take(f"mass of {name}", lambda: _with_link(record, i, mass))
    shape = {"com": com, "inertia": (inertia + inertia.T) / 2}
    record.take(f"COM and inertia of {name}", lambda: _with_link(record, i, shape))


def _with_link(record: _Record, i: int, numbers: dict[str, Any]) -> dict[str, Any]:
    """The links, with those numbers of link i that differ."""
    links: list[LinkParameters] = list(record.parameters.links)
    printed = links[i]
    changed = {k: v for k, v in numbers.items() if _differs(v, getattr(printed, k))}
    links[i] = replace(printed, **changed)
    return {"links": tuple(links)}


def _take_tool(record: _Record, evidence: Evidence, to_link_4: FloatArray) -> None:
    """The tool, if they have a frame for it."""
    theirs = evidence.theirs
    if not theirs.tool:
        record.left_out.append("there is no tool frame: the tool is as printed")
        return
    pose = to_link_4 @ theirs.link_poses[theirs.tool]
    ours = evidence.ours.tool_pose
    if np.abs(pose - ours).max() > SAME_LENGTH:
        tool = {"position": pose[:3, 3], "rotation": pose[:3, :3]}
        record.take("the tool", lambda: {"tool": ToolPose(**tool)})


def _take_mount(record: _Record, evidence: Evidence, base: FloatArray) -> None:
    """Where base_link is in their root, if it is not the root itself."""
    if np.abs(base - np.eye(4)).max() <= SAME_LENGTH:
        return
    root = evidence.theirs.base_path[0]

    def mounted() -> dict[str, Any]:
        parent = _plain(root)
        mount = Mount(parent=parent, position=base[:3, 3], rotation=base[:3, :3])
        return {"mount": mount}

    record.take("the mount", mounted)


def _differs(one: Any, other: Any) -> bool:
    """Whether numbers differ by more than rounding."""
    scale = max(np.abs(other).max(), np.finfo(float).tiny)
    return bool(np.abs(np.subtract(one, other)).max() > _ROUNDING * scale)


def _plain(name: str) -> str:
    """A name of letters, digits and underscores."""
    plain = re.sub(r"\W", "_", name, flags=re.ASCII)[:60]
    return plain if plain[:1].isalpha() else f"arm_{plain}"
