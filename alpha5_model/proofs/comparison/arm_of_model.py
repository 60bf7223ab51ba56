"""The record of an arm of your own that another model of this arm describes.

The joint axes at the other model's zero give lengths and zeros by Denavit and
Hartenberg's construction, so positions of the record are those of the model, unless a
joint turns the other way. Each body is placed by its own axis.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform, wrap
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import FARTHEST_TOOL
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    DHParameters,
    JointParameters,
    LinkParameters,
    chosen_arm,
)
from alpha5_model.numbers.pose import Pose, printed_tool
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.numbers.tables import BODY_NAMES
from alpha5_model.proofs.comparison.alignment import SAME_ZERO, Alignment
from alpha5_model.proofs.comparison.axis_lines import AxisLines, foot, twists
from alpha5_model.proofs.comparison.bodies_of_model import bodies_of_model
from alpha5_model.proofs.comparison.chains import AXES
from alpha5_model.proofs.comparison.four_joint_arm import FourJointArm
from alpha5_model.proofs.comparison.measure import arms_of_model
from alpha5_model.proofs.comparison.model_file import read_model
from alpha5_model.proofs.comparison.poses import carried_to, origin_of, rotation_of

#: Smaller differences from the catalogue's numbers are rounding [m, rad].
_ROUNDING = 1e-12
#: Larger twists and offsets of axes are said to be left out [rad, m].
_LEFT_OUT = 1e-7
#: A base_link whose d_0 differs by more is another frame [m].
_OTHER_BASE = 0.1
#: Names that a parent of base_link cannot have.
_TAKEN = ("base_link", "tcp", *BODY_NAMES)


class ArmOfModel(NamedTuple):
    """What an arm file can say of another model.

    Attributes:
        record: The arm.
        left_out: What no arm file can say, a text for each.
    """

    record: Alpha5Parameters
    left_out: tuple[str, ...]


class _Axes(NamedTuple):
    """The axes of the other model at its zero, as Table 1 has them.

    Attributes:
        sign: +1 or -1 per joint: whether positions of the record are the model's.
        dh: The rows of Table 1.
        base: Pose of base_link in the model's root, (4, 4).
        links: Poses of link_1 to link_4 in the model's root, (4, 4, 4).
    """

    sign: FloatArray
    dh: tuple[DHParameters, ...]
    base: FloatArray
    links: FloatArray


def arm_of_model(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    base: str | None = None,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    xacro: bool = False,
) -> ArmOfModel:
    """The record of an arm that another model of this arm describes.

    Its lengths, zeros, limits, masses, COMs, inertias, tool and mount are those of the
    model; what the model does not say is the catalogue's. `alpha5_model.arm_file_text`
    writes it to an arm file.

    Args:
        path, joints, base, packages, arguments, xacro: As of
            `alpha5_model.compare`.

    Raises:
        MissingFileError, FileFormatError, UnknownNameError, InputError: As of
            `alpha5_model.compare`; also a model of another arm.
    """
    other = read_model(path, packages, arguments, xacro)
    return arm_of_robot(other, joints, base)


def arm_of_robot(
    other: UrdfRobot, names: Mapping[str, str] | None = None, base: str | None = None
) -> ArmOfModel:
    """`arm_of_model` of a model that has been read."""
    catalogue = chosen_arm(None)
    arms = arms_of_model(other, names, base, catalogue)
    if arms is None:
        expected = "a model of the Reach Alpha 5; compare says why it is none"
        raise InputError("model", other.name, expected)

    theirs = arms.meant
    left_out: list[str] = []
    axes = _axes(catalogue, theirs, arms.alignment, left_out)
    links, attached = _bodies(catalogue, theirs, axes, left_out)
    record = replace(
        catalogue,
        dh=axes.dh,
        links=links,
        attached=attached,
        joints=_joints(catalogue, theirs, axes, left_out),
        name=_plain(other.name, "arm"),
    )
    record = _with_room_for_jaws(record, catalogue, left_out)
    record = replace(
        record,
        tool=_tool(record, theirs, axes, left_out),
        mount=_mount(other, axes, left_out),
    )
    left_out += _rest(other, theirs)
    return ArmOfModel(record=record, left_out=tuple(left_out))


def arm_text(described: ArmOfModel, source: str) -> str:
    """The text of the arm file of a model, with what it cannot say in its head.

    Args:
        described: From `arm_of_model`.
        source: Name of the model's file.
    """
    notes = [f"An arm file of {source}. Not said here:"]
    notes += [f"- {text}" for text in described.left_out]
    return arm_file_text(described.record, notes)


# --- Axes -----------------------------------------------------------------------------


class _Chain(NamedTuple):
    """The axes of the other model at its zero, joint by joint.

    Attributes:
        sign: +1 or -1 per joint, (4,).
        z: Directions of the axes, as the record has them, (4, 3).
        x: Common normals before axis_d, axis_c and axis_b, (3, 3).
        origins: Feet on axis_e, axis_d, axis_c and axis_b, (4, 3) [m].
        a: Distances of axes, a_0 to a_2, (3,) [m].
        offset: How far axis_b stands beside the plane of the arm [m].
    """

    sign: FloatArray
    z: FloatArray
    x: FloatArray
    origins: FloatArray
    a: FloatArray
    offset: float


def _axes(
    catalogue: Alpha5Parameters,
    theirs: FourJointArm,
    alignment: Alignment,
    left_out: list[str],
) -> _Axes:
    """Lengths, zeros and frames from the axes at the model's zero."""
    chain = _chain(catalogue, theirs, alignment)
    _note_twists(chain, left_out)
    _note_signs(chain.sign, left_out)
    base, d_0 = _base(catalogue, theirs, alignment, chain)

    zero_3 = _small(-chain.sign[3] * alignment.zero[3], SAME_ZERO)
    theta_3 = catalogue.dh[3].theta_offset + zero_3
    x = [*chain.x, rotation_about(chain.z[3], theta_3) @ chain.x[2]]
    thetas = [
        _angle(base[:3, 0], x[0], chain.z[0]),
        _angle(x[0], x[1], chain.z[1]),
        _angle(x[1], x[2], chain.z[2]),
        theta_3,
    ]
    a_0, a_1, a_2 = chain.a.tolist()
    lengths = {(0, "a"): a_0, (0, "d"): d_0, (1, "a"): a_1, (2, "a"): a_2}
    origins = [base[:3, 3], *chain.origins[1:]]
    links = [_frame(x[i], chain.z[i], origins[i]) for i in range(4)]
    return _Axes(
        sign=chain.sign,
        dh=_rows(catalogue, lengths, thetas, left_out),
        base=base,
        links=np.array(links),
    )


def _chain(
    catalogue: Alpha5Parameters, theirs: FourJointArm, alignment: Alignment
) -> _Chain:
    """Common normals, feet and lengths.

    The direction of axis_e is that of the alignment. Those of the others follow from
    the lengths, which are positive.
    """
    alpha = [row.alpha for row in catalogue.dh]
    lines = theirs.axis_lines(np.zeros(4))
    z = lines.directions * alignment.sign[:, None]

    on_e, on_d = foot(lines, 0, 1), foot(lines, 1, 0)
    before_d = _next(z[0], z[1], on_d - on_e, alpha[0])
    z[1] *= before_d.sign

    parallel = math.copysign(1.0, math.cos(alpha[1]) * float(z[2] @ z[1]))
    z[2] *= parallel
    upper_arm = lines.points[2] - on_d
    upper_arm = upper_arm - (upper_arm @ z[1]) * z[1]
    elbow = on_d + upper_arm
    a_1 = float(np.linalg.norm(upper_arm))

    on_c, on_b = foot(lines, 2, 3), foot(lines, 3, 2)
    before_b = _next(z[2], z[3], on_b - on_c, alpha[2])
    z[3] *= before_b.sign
    return _Chain(
        sign=np.sign(np.sum(z * lines.directions, axis=1)),
        z=z,
        x=np.array([before_d.x, upper_arm / a_1, before_b.x]),
        origins=np.array([on_e, on_d, elbow, on_b]),
        a=np.array([before_d.a, a_1, before_b.a]),
        offset=float((on_c - elbow) @ z[2]),
    )


class _Normal(NamedTuple):
    """The common normal of two axes.

    Attributes:
        sign: +1, or -1 if the second axis has to be reversed.
        x: Its direction, (3,).
        a: Its length [m].
    """

    sign: float
    x: FloatArray
    a: float


def _next(z: FloatArray, after: FloatArray, step: FloatArray, alpha: float) -> _Normal:
    """The common normal of an axis and the next, along which a is positive.

    Args:
        z, after: Directions of both axes, at right angles but for errors, (3,).
        step: From the first axis to the second, along their common normal, (3,) [m].
        alpha: Table 1's twist [rad].
    """
    normal = np.cross(z, after) * math.sin(alpha)
    x = normal / np.linalg.norm(normal)
    a = float(step @ x)
    sign = 1.0 if a >= 0 else -1.0
    return _Normal(sign=sign, x=sign * x, a=sign * a)


def _note_twists(chain: _Chain, left_out: list[str]) -> None:
    """Say which axes are twisted, and whether axis_b stands beside the plane."""
    angles = twists(AxisLines(points=chain.origins, directions=chain.z))
    off = np.abs(angles - [math.pi / 2, 0.0, math.pi / 2])
    for name, twist in zip(AXES[1:], off.tolist(), strict=True):
        if twist > _LEFT_OUT:
            degrees = math.degrees(twist)
            text = f"{name} is twisted by {degrees:.3g} deg against the axis before it"
            left_out.append(text)
    if abs(chain.offset) > _LEFT_OUT:
        beside = f"{abs(chain.offset) * 1e3:.3g} mm beside the plane of the arm"
        left_out.append(f"axis_b stands {beside}")


def _note_signs(sign: FloatArray, left_out: list[str]) -> None:
    """Say which joints turn the other way."""
    for name, is_reversed in zip(AXES, np.signbit(sign), strict=True):
        if is_reversed:
            text = f"{name} turns the other way: its position is minus the model's"
            left_out.append(text)


def _base(
    catalogue: Alpha5Parameters,
    theirs: FourJointArm,
    alignment: Alignment,
    chain: _Chain,
) -> tuple[FloatArray, float]:
    """Pose of base_link in the model's root, (4, 4), and the length d_0 [m].

    The model's own base_link is kept if its origin is on the first axis' line.

    Args:
        catalogue: The catalogue's arm.
        theirs: The other arm.
        alignment: Its alignment.
        chain: Its axes.
    """
    z = chain.z[0]
    shoulder = chain.origins[0]
    own = np.linalg.inv(alignment.base)
    origin = shoulder - catalogue.dh[0].d * z
    if alignment.same_base:
        own = theirs.link_poses[alignment.base_link]
        on_axis = shoulder + ((origin_of(own) - shoulder) @ z) * z
        d_0 = float((shoulder - on_axis) @ z)
        if abs(d_0 - catalogue.dh[0].d) < _OTHER_BASE and d_0 > 0:
            origin = on_axis
    x = own[:3, 0] - (own[:3, 0] @ z) * z
    if np.linalg.norm(x) < 0.5:
        x = np.cross(own[:3, 1], z)
    x = x / np.linalg.norm(x)
    return _frame(x, z, origin), float((shoulder - origin) @ z)


def _rows(
    catalogue: Alpha5Parameters,
    lengths: Mapping[tuple[int, str], float],
    thetas: list[float],
    left_out: list[str],
) -> tuple[DHParameters, ...]:
    """The rows of Table 1 with the model's lengths and zeros."""
    rows = list(catalogue.dh)
    for (i, field), length in lengths.items():
        printed = getattr(rows[i], field)
        if length * printed <= 0:
            text = f"{field}_{i} is {length:.3g} m, which has not the sign of Table 1"
            left_out.append(text)
        elif not plausibility.POSITION.holds(abs(length)):
            left_out.append(f"{field}_{i} is {length:.3g} m: the printed one is kept")
        elif abs(length - printed) > _ROUNDING:
            own: dict[str, Any] = {field: length}
            rows[i] = replace(rows[i], **own)
    for i, theta in enumerate(thetas):
        zero = _small(float(wrap(theta - rows[i].theta_offset)), _ROUNDING)
        if zero:
            rows[i] = replace(rows[i], theta_offset=rows[i].theta_offset + zero)
    return tuple(rows)


def _frame(x: FloatArray, z: FloatArray, origin: FloatArray) -> FloatArray:
    """A frame of two of its axes and its origin, (4, 4)."""
    return transform(np.column_stack([x, np.cross(z, x), z]), origin)


def _angle(one: FloatArray, other: FloatArray, about: FloatArray) -> float:
    """Angle from one direction to another about an axis [rad]."""
    return math.atan2(float(np.cross(one, other) @ about), float(one @ other))


def _small(value: float, rounding: float) -> float:
    """The value; 0 if it is rounding."""
    return 0.0 if abs(value) <= rounding else float(value)


# --- Bodies, limits, tool and mount ---------------------------------------------------


def _bodies(
    catalogue: Alpha5Parameters,
    theirs: FourJointArm,
    axes: _Axes,
    left_out: list[str],
) -> tuple[tuple[LinkParameters, ...], tuple[AttachedBody, ...]]:
    """The links, and what is attached to them."""
    poses = theirs.poses(np.zeros(4))
    frames = np.array([axes.base, *axes.links])
    coms, inertias = carried_to(
        np.linalg.inv(frames) @ poses, theirs.com, theirs.inertia
    )
    return bodies_of_model(catalogue.links, theirs.mass, coms, inertias, left_out)


def _with_room_for_jaws(
    record: Alpha5Parameters, catalogue: Alpha5Parameters, left_out: list[str]
) -> Alpha5Parameters:
    """The record with the printed link_4, if its own leaves no wrist without jaws."""
    try:
        split_link_4(record)
    except InputError as error:
        text = f"link_4 is no possible body ({error.value}; expected {error.expected})"
        left_out.append(f"{text}: the printed one is kept")
        kept = [body for body in record.attached if body.link != BODY_NAMES[4]]
        links = (*record.links[:4], catalogue.links[4])
        return replace(record, links=links, attached=tuple(kept))
    return record


def _joints(
    catalogue: Alpha5Parameters,
    theirs: FourJointArm,
    axes: _Axes,
    left_out: list[str],
) -> tuple[JointParameters, ...]:
    """The joints with the model's limits, in positions of the record."""
    joints = list(catalogue.joints)
    for i, (ours, model) in enumerate(zip(joints[:4], theirs.joints, strict=True)):
        zero = axes.dh[i].theta_offset - catalogue.dh[i].theta_offset
        ends = [ours.lower - zero, ours.upper - zero]
        if model.lower is None or model.upper is None:
            left_out.append(f"{ours.name} has no limits: the catalogue's are kept")
        else:
            given = sorted([axes.sign[i] * model.lower, axes.sign[i] * model.upper])
            problem = _problem_of_range(given)
            if problem:
                text = f"{ours.name} has a range {problem}: the catalogue's is kept"
                left_out.append(text)
            else:
                ends = given
        joints[i] = replace(
            ours,
            lower=float(ends[0]),
            upper=float(ends[1]),
            velocity=_largest("velocity", ours, model.velocity, left_out),
            effort=_largest("effort", ours, model.effort, left_out),
        )
    return tuple(joints)


def _problem_of_range(ends: list[float]) -> str:
    """Why an arm file cannot say a range of positions; empty if it can."""
    width = ends[1] - ends[0]
    if not 0 < width < math.tau:
        return f"of {math.degrees(width):.4g} deg"
    if not all(plausibility.ANGLE.holds(abs(end)) for end in ends):
        return f"from {ends[0]:.4g} to {ends[1]:.4g} rad"
    return ""


def _largest(
    field: str, ours: JointParameters, value: float | None, left_out: list[str]
) -> float:
    """The largest velocity or effort of a joint: the model's, or the catalogue's."""
    printed: float = getattr(ours, field)
    if value is None or value <= 0:
        text = f"{ours.name} has no largest {field}: the catalogue's is kept"
        left_out.append(text)
        return printed
    if not plausibility.JOINT[field].holds(value):
        text = f"{ours.name} has a largest {field} of {value:.4g}"
        left_out.append(f"{text}: the catalogue's is kept")
        return printed
    return float(value)


def _tool(
    record: Alpha5Parameters,
    theirs: FourJointArm,
    axes: _Axes,
    left_out: list[str],
) -> Pose | None:
    """The model's tool; None for Table 1's."""
    if not theirs.tool:
        left_out.append("it has no tool frame: Table 1's is kept")
        return None
    body = theirs.poses(np.zeros(4))[4]
    pose = np.linalg.inv(axes.links[3]) @ body @ theirs.link_poses[theirs.tool]
    printed = printed_tool(record.dh[3], record.dh[4])
    same = np.abs(origin_of(pose) - printed.position).max() < _ROUNDING
    turned = np.abs(rotation_of(pose) - printed.rotation).max()
    if same and turned < _ROUNDING:
        return None
    if np.linalg.norm(origin_of(pose) - printed.position) > FARTHEST_TOOL:
        text = f"its tool frame {theirs.tool} is more than {FARTHEST_TOOL} m off"
        left_out.append(text)
        return None
    return Pose(position=origin_of(pose), rotation=rotation_of(pose))


def _mount(other: UrdfRobot, axes: _Axes, left_out: list[str]) -> Pose | None:
    """Where base_link is in the model's root; None if it is the root."""
    if np.abs(axes.base - np.eye(4)).max() < _ROUNDING:
        return None
    parent = _plain(other.root, "root")
    if parent in _TAKEN:
        parent = f"{parent}_of_model"
    if parent != other.root:
        left_out.append(f"its root is named {other.root}: the mount's is {parent}")
    return Pose(
        parent=parent,
        position=origin_of(axes.base),
        rotation=rotation_of(axes.base),
    )


def _rest(other: UrdfRobot, theirs: FourJointArm) -> list[str]:
    """What a URDF and an arm file never share."""
    found = ["volumes and centres of buoyancy, which no URDF has: Table 3's are kept"]
    foreign = [name for name in theirs.foreign_links if other.links[name].mass]
    if foreign:
        found.append(f"links that are not the arm's: {', '.join(foreign)}")
    four = {joint.name for joint in theirs.joints}
    moving = [
        joint.name
        for joint in other.joints.values()
        if joint.kind != "fixed" and joint.name not in four
    ]
    if moving:
        found.append(f"the joints {', '.join(moving)}, which are frozen with jaws shut")
    if any(link.files or link.volume for link in other.links.values()):
        found.append("shapes and meshes")
    return found


def _plain(name: str, fallback: str) -> str:
    """A name of letters, digits and underscores."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:64]
    return plain if re.match(r"[A-Za-z]", plain) else f"{fallback}_{plain}".strip("_")
