"""The record of an arm of your own that another model of this arm describes.

Lengths and zeros are those of `described`, at the other model's zero: positions of the
record are those of the model, unless a joint turns the other way. Each body is placed
by its own axis.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, wrap
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.arm_checks import FARTHEST_TOOL, LENGTHS, TAKEN
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.inertia import inconsistencies, rotate_tensor
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    DHParameters,
    JointParameters,
    LinkParameters,
    chosen_arm,
)
from alpha5_model.numbers.pose import Pose, printed_tool
from alpha5_model.proofs.comparison.comparing import reduce_and_describe
from alpha5_model.proofs.comparison.described import (
    SAME_ZERO,
    Described,
    describe_as_table,
)
from alpha5_model.proofs.comparison.digits import as_meant
from alpha5_model.proofs.comparison.joint_mistakes import without_joint_mistakes
from alpha5_model.proofs.comparison.model import AXES, find_chains, read_model
from alpha5_model.proofs.comparison.reduced import Reduced

#: Smaller differences from the catalogue's numbers are rounding [m, rad].
ROUNDING = 1e-12
#: Larger twists and offsets of axes are said to be left out [rad, m].
LEFT_OUT = 1e-7
#: A base_link whose d_0 differs by more is another frame [m].
OTHER_BASE = 0.1


class ArmOfModel(NamedTuple):
    """What an arm file can say of another model.

    Attributes:
        record: The arm.
        left_out: What no arm file can say, a text for each.
    """

    record: Alpha5Parameters
    left_out: tuple[str, ...]


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
    """`arm_of_model` of a model that has been read.

    An arm whose joints are named as ours, or by the caller, may have any lengths. What
    is odd about its numbers is in ``left_out``, and no warning besides.
    """
    with plausibility.silenced():
        return _arm_of_robot(other, names, base)


def _arm_of_robot(
    other: UrdfRobot, names: Mapping[str, str] | None, base: str | None
) -> ArmOfModel:
    catalogue = chosen_arm(None)
    mended, slips = without_joint_mistakes(other, catalogue, names)
    meant = as_meant(mended)
    chains = find_chains(meant, catalogue, names)
    is_named = chains and (chains[0].named_as_ours == 4 or len(names or {}) == 4)
    if not chains or not (is_named or chains[0].is_ours):
        expected = "a model of the Reach Alpha 5; compare says why it is none"
        raise InputError("model", other.name, expected)

    theirs = reduce_and_describe(meant, chains[0], catalogue, base).reduced
    described = describe_as_table(theirs, catalogue)
    origin, d_0 = _base(catalogue, theirs, described)
    zeros = _zeros(described)
    dh, of_axes = _rows(catalogue, described, d_0, zeros)
    links, of_bodies = _links(catalogue, theirs, described, origin)
    joints, of_limits = _joints(catalogue, theirs, described, zeros)
    record = replace(
        catalogue, dh=dh, links=links, joints=joints, name=_plain(other.name, "arm")
    )
    tool, of_tool = _tool(record, theirs, described)
    mount = _mount(other, origin)
    return ArmOfModel(
        record=replace(record, tool=tool, mount=mount),
        left_out=(
            *(f"warning: {one.written.name} was mended: {one.id}" for one in slips),
            *of_axes,
            *of_bodies,
            *of_limits,
            *of_tool,
            *_notes_on_the_rest(other, theirs, mount),
        ),
    )


def arm_text(described: ArmOfModel, source: str) -> str:
    """The text of the arm file of a model, with what it cannot say in its head.

    Args:
        described: From `arm_of_model`.
        source: Name of the model's file.
    """
    notes = [f"An arm file of {source}. Not said here:"]
    notes += [f"- {text}" for text in described.left_out]
    return arm_file_text(described.record, notes)


# --- Lengths, zeros and frames --------------------------------------------------------


def _base(
    catalogue: Alpha5Parameters, theirs: Reduced, described: Described
) -> tuple[FloatArray, float]:
    """Pose of base_link in the model's root, (4, 4), and the length d_0 [m].

    The model's own base_link is kept if its origin is near ours on the first axis.
    """
    base = described.frames[0]
    d_0 = catalogue.dh[0].d
    if not described.same_base:
        return base, d_0
    own = theirs.link_poses[described.base_link]
    z = base[:3, 2]
    up = float((own[:3, 3] - base[:3, 3]) @ z)
    if up < d_0 and abs(up) < OTHER_BASE:
        moved_up = base.copy()
        moved_up[:3, 3] += up * z
        return moved_up, d_0 - up
    return base, d_0


def _zeros(described: Described) -> FloatArray:
    """What to add to our zeros so that positions are the model's, (4,) [rad]."""
    zeros = -described.sign * described.zero
    smallest = [ROUNDING, ROUNDING, ROUNDING, SAME_ZERO]
    return np.where(np.abs(zeros) > smallest, zeros, 0.0)


def _changed(record: Any, field: str, value: Any) -> Any:
    """A record with another number; None if no arm file takes the number."""
    with plausibility.of_file("arm"), suppress(InputError):
        return replace(record, **{field: value})
    return None


def _rows(
    catalogue: Alpha5Parameters, described: Described, d_0: float, zeros: FloatArray
) -> tuple[tuple[DHParameters, ...], list[str]]:
    """The rows of Table 1 with the model's lengths and zeros.

    Returns:
        The rows, and notes on twists, offsets, reversed joints and lengths that no arm
        file says.
    """
    notes = []
    changes = described.changes
    twists = (changes.alpha_0, math.hypot(changes.alpha_1, changes.beta_1))
    for axis, twist in zip(AXES[1:], (*twists, changes.alpha_2), strict=True):
        if abs(twist) > LEFT_OUT:
            turned = f"twisted by {abs(math.degrees(twist)):.3g} deg"
            notes.append(f"{axis} is {turned} against the axis before it")
    if abs(changes.d_1) > LEFT_OUT:
        beside = abs(changes.d_1) * 1e3
        notes.append(f"axis_b stands {beside:.3g} mm beside the plane of the arm")
    for axis, sign in zip(AXES, described.sign, strict=True):
        if sign < 0:
            notes.append(
                f"{axis} turns the other way: its position is minus the model's"
            )

    rows = list(catalogue.dh)
    own = described.dimensions
    lengths = {"a_0": own.a_0, "d_0": d_0, "a_1": own.a_1, "a_2": own.a_2}
    for name, length in lengths.items():
        i, field = LENGTHS[name]
        printed = getattr(rows[i], field)
        row = _changed(rows[i], field, length)
        if length * printed <= 0:
            given = f"{name} is {length:.3g} m"
            notes.append(f"{given}, which has not the sign of Table 1")
        elif row is None:
            notes.append(f"{name} is {length:.3g} m: the printed one is kept")
        elif abs(length - printed) > ROUNDING:
            rows[i] = row
    for i, zero in enumerate(wrap(zeros).tolist()):
        if zero:
            rows[i] = replace(rows[i], theta_offset=rows[i].theta_offset + zero)
    return tuple(rows), notes


# --- Bodies ---------------------------------------------------------------------------


def _links(
    catalogue: Alpha5Parameters,
    theirs: Reduced,
    described: Described,
    base: FloatArray,
) -> tuple[tuple[LinkParameters, ...], list[str]]:
    """The links with the model's bodies, those that an arm file can say.

    A COM may be outside the bounds of the printed link: that is worth a warning, and
    no reason to write another body.

    Args:
        catalogue: The catalogue's arm.
        theirs: The model.
        described: It in our terms.
        base: Pose of base_link in its root, (4, 4).

    Returns:
        The links, and notes on bodies that are kept as printed and on odd COMs.
    """
    frames = described.frames.copy()
    frames[0] = base
    frames[1, :3, 3] = base[:3, 3]
    placed = np.linalg.inv(frames) @ theirs.zero_poses()
    coms = moved(placed, theirs.com)
    inertias = rotate_tensor(placed[:, :3, :3], theirs.inertia)
    inertias = (inertias + np.swapaxes(inertias, 1, 2)) / 2

    links: list[LinkParameters] = []
    notes = []
    for k, printed in enumerate(catalogue.links):
        mass = float(theirs.mass[k])
        at = ", ".join(f"{x * 1e3:z.1f}" for x in coms[k])
        problem = _problem_of_body(printed, mass, coms[k], inertias[k])
        link = printed if problem else _link(printed, mass, coms[k], inertias[k])
        if printed.name == "link_4" and not _leaves_a_wrist(catalogue, link):
            problem = f"has {mass:.4g} kg with its COM at ({at}) mm, which leaves no "
            problem += "wrist beside the jaws"
            link = printed
        links.append(link)

        bounds = printed.bounds
        outside = (link.com < bounds[:, 0]) | (link.com > bounds[:, 1])
        if problem:
            notes.append(f"warning: {link.name} {problem}: the printed one is kept")
        elif outside.any():
            notes.append(
                f"warning: {link.name} has its COM outside the link, at ({at}) mm"
            )
    return tuple(links), notes


def _problem_of_body(
    link: LinkParameters, mass: float, com: FloatArray, inertia: FloatArray
) -> str:
    """Why an arm file cannot say a body of a link; empty if it can."""
    wrong = inconsistencies(mass, com, inertia) if mass else ["no mass"]
    if wrong:
        return f"is no possible body ({wrong[0]})"
    if _changed(link, "mass", mass) is None:
        return f"has {mass:.4g} kg"
    if _changed(link, "com", com) is None:
        return f"has its COM {np.abs(com).max():.4g} m off"
    return ""


def _link(
    link: LinkParameters, mass: float, com: FloatArray, inertia: FloatArray
) -> LinkParameters:
    """A link with another body; printed numbers stay if only rounding differs."""
    changes: dict[str, Any] = {}
    if abs(mass - link.mass) > ROUNDING * link.mass:
        changes["mass"] = mass
    if np.abs(com - link.com).max() > ROUNDING:
        changes["com"] = com
    if np.abs(inertia - link.inertia).max() > ROUNDING * np.abs(link.inertia).max():
        changes["inertia"] = inertia
    return replace(link, **changes) if changes else link


def _leaves_a_wrist(catalogue: Alpha5Parameters, link_4: LinkParameters) -> bool:
    """Whether link_4 less rod and fingers is a possible body: arms have jaws."""
    with suppress(InputError):
        split_link_4(replace(catalogue, links=(*catalogue.links[:4], link_4)))
        return True
    return False


# --- Limits ---------------------------------------------------------------------------


def _joints(
    catalogue: Alpha5Parameters,
    theirs: Reduced,
    described: Described,
    zeros: FloatArray,
) -> tuple[tuple[JointParameters, ...], list[str]]:
    """The joints with the model's limits, in positions of the record.

    Returns:
        The joints, and notes on limits of the model that no arm file says.
    """
    joints = list(catalogue.joints)
    notes = []
    for i, (ours, model) in enumerate(zip(joints[:4], theirs.joints, strict=True)):
        ends = [float(ours.lower - zeros[i]), float(ours.upper - zeros[i])]
        if model.lower is None or model.upper is None:
            notes.append(f"{ours.name} has no limits: the catalogue's are kept")
        else:
            if model.lower > model.upper:
                given = f"{model.lower:.4g} to {model.upper:.4g} rad"
                notes.append(
                    f"warning: {ours.name} has reversed limits, {given}: sorted here"
                )
            own = described.sign[i] * np.array([model.lower, model.upper])
            own_ends = np.sort(own).tolist()
            problem = _problem_of_range(ours, own_ends)
            if problem:
                notes.append(
                    f"{ours.name} has a range {problem}: the catalogue's is kept"
                )
            else:
                ends = own_ends
        joints[i] = replace(ours, lower=ends[0], upper=ends[1])
        for field in ("velocity", "effort"):
            value = getattr(model, field)
            largest = f"largest {field}"
            if not value or value <= 0:
                notes.append(f"{ours.name} has no {largest}: the catalogue's is kept")
                continue
            changed = _changed(joints[i], field, value)
            if changed is None:
                text = f"{ours.name} has a {largest} of {value:.4g}"
                notes.append(f"{text}: the catalogue's is kept")
            else:
                joints[i] = changed
    return tuple(joints), notes


def _problem_of_range(joint: JointParameters, ends: Sequence[float]) -> str:
    """Why an arm file cannot say a range of positions; empty if it can."""
    width = ends[1] - ends[0]
    if not 0 < width < math.tau:
        return f"of {math.degrees(width):.4g} deg"
    with plausibility.of_file("arm"), suppress(InputError):
        replace(joint, lower=ends[0], upper=ends[1])
        return ""
    return f"from {ends[0]:.4g} to {ends[1]:.4g} rad"


# --- Tool, mount and the rest ---------------------------------------------------------


def _tool(
    record: Alpha5Parameters, theirs: Reduced, described: Described
) -> tuple[Pose | None, list[str]]:
    """The model's tool, None for Table 1's, and what an arm file cannot say of it."""
    if not theirs.tool:
        return None, ["it has no tool frame: Table 1's is kept"]
    pose = described.placed[4] @ theirs.link_poses[theirs.tool]
    printed = printed_tool(record.dh[3], record.dh[4])
    off = pose[:3, 3] - printed.position
    if np.linalg.norm(off) > FARTHEST_TOOL:
        far = f"its tool frame {theirs.tool} is more than {FARTHEST_TOOL} m off"
        return None, [far]
    turned = np.abs(pose[:3, :3] - printed.rotation).max()
    if np.abs(off).max() < ROUNDING and turned < ROUNDING:
        return None, []
    return Pose(position=pose[:3, 3], rotation=pose[:3, :3]), []


def _mount(other: UrdfRobot, base: FloatArray) -> Pose | None:
    """Where base_link is in the model's root; None if it is the root."""
    if np.abs(base - np.eye(4)).max() < ROUNDING:
        return None
    parent = _plain(other.root, "root")
    if parent in TAKEN:
        parent = f"{parent}_of_model"
    return Pose(position=base[:3, 3], rotation=base[:3, :3], parent=parent)


def _notes_on_the_rest(
    other: UrdfRobot, theirs: Reduced, mount: Pose | None
) -> Iterator[str]:
    """The name of the mount, and what a URDF and an arm file never share."""
    if mount is not None and mount.parent != other.root:
        yield f"its root is named {other.root}: the mount's is {mount.parent}"

    yield "volumes and centres of buoyancy, which no URDF has: Table 3's are kept"
    foreign = [name for name in theirs.foreign if other.links[name].mass]
    if foreign:
        yield f"links that are not the arm's: {', '.join(foreign)}"
    four = {joint.name for joint in theirs.joints}
    moving = [joint.name for joint in other.joints.values() if joint.kind != "fixed"]
    others = [name for name in moving if name not in four]
    if others:
        yield f"the joints {', '.join(others)}, which are frozen with jaws shut"
    if any(link.files or link.volume for link in other.links.values()):
        yield "shapes and meshes"


def _plain(name: str, fallback: str) -> str:
    """A name of letters, digits and underscores."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:64]
    return plain if re.match(r"[A-Za-z]", plain) else f"{fallback}_{plain}".strip("_")
