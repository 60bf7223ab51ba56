"""What is wrong with another model's base, axes, tool, limits and files."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, wrap
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue
from alpha5_model.numbers.pose import tool_of
from alpha5_model.proofs.comparison.corrections import (
    LEVER,
    LIMIT_TOLERANCE,
    RightJoint,
    angle_between,
    origin_attributes,
    right_joints,
    right_tool,
    seems_in_degrees,
    velocity_differs,
)
from alpha5_model.proofs.comparison.described import Described
from alpha5_model.proofs.comparison.jaw_joints import JawJoint, findings_of_jaws
from alpha5_model.proofs.comparison.joint_mistakes import JointMistake
from alpha5_model.proofs.comparison.model import AXES
from alpha5_model.proofs.comparison.reduced import (
    FourJoints,
    Reduced,
    Z,
    dimensions_of,
    our_arm,
    reduce,
)
from alpha5_model.proofs.comparison.result import Correction, Finding, finding

#: Smaller differences of axes and of their angles are no findings. The angle moves the
#: tip by 0.03 mm.
LENGTH_TOLERANCE, ANGLE_TOLERANCE = 1e-5, 1e-4  # [m], [rad]
#: How many of the foreign links are named, the heaviest first.
NAMED = 3
#: A COM of link_0 this close to ours settles the zero of axis_e.
SAME_COM = 1e-3  # [m]
#: Distance of the jaws' collar from axis_c, by the manufacturer's CAD [m].
JAWS_FROM = 0.13275
#: A tool frame between collar and finger tips is a choice, no error, if it is this
#: close to the wrist axis [m] and one of its axes along it to this angle [rad].
BESIDE = 0.002
TURNED = math.radians(0.5)
#: Relative tolerance of the volume: Table 3's digits leave 5 * 0.5 mL of 573 mL open.
VOLUME_TOLERANCE = 5e-3


class Tolerance(NamedTuple):
    """Differences that are no findings: of lengths [m] and of angles [rad]."""

    length: float
    angle: float


@dataclass(frozen=True, eq=False)
class Evidence:
    """Both arms: what the findings are taken from.

    Attributes:
        arm: Our arm as its record is.
        record: Our arm with what it carries as part of its links.
        other: The other model as it is written.
        robot: It as it is meant: in m and rad, with exact multiples of pi.
        meant: It as it is meant, reduced.
        written: It as it is written, reduced.
        described: It in our terms.
        base: The first link of its arm; None if its mass shows it.
        slips: Mistakes in joints that were mended before, see `joint_mistakes`.
        jaws: Joints of its jaws that are ours. In ``robot`` they are as they have to
            be.
        folder: Where its meshes are; None if unknown.
        q: Our joint positions at which costs are evaluated, (N, 4) [rad].
    """

    arm: Alpha5Parameters
    record: Alpha5Parameters
    other: UrdfRobot
    robot: UrdfRobot
    meant: Reduced
    written: Reduced
    described: Described
    base: str | None
    slips: tuple[JointMistake, ...]
    jaws: tuple[JawJoint, ...]
    folder: Path | None
    q: FloatArray

    @cached_property
    def ours(self) -> FourJoints:
        """Our arm, reduced."""
        return our_arm(self.record)

    @cached_property
    def our_torque(self) -> FloatArray:
        """Gravity torque of our arm in air at ``q``, (N, 4) [N m]."""
        return self.ours.gravity_torque(self.q)

    @cached_property
    def rounding(self) -> Tolerance:
        """What the printed digits of the joint origins leave open.

        Rounded lengths turn the axes by their error over the length of the upper arm.
        The error of a pi that is cut short may hide in angles computed from it.
        """
        upper_arm = self.record.dh[1].a
        digits = self.meant.digits
        pi = 2 * digits.pi
        return Tolerance(
            length=max(digits.length, upper_arm * pi),
            angle=math.hypot(digits.angle, digits.length / upper_arm, pi),
        )

    @cached_property
    def tolerance(self) -> Tolerance:
        """Differences of the axes that are no findings."""
        return Tolerance(
            length=max(LENGTH_TOLERANCE, self.rounding.length),
            angle=max(ANGLE_TOLERANCE, self.rounding.angle),
        )

    @cached_property
    def right_joints(self) -> tuple[RightJoint, ...]:
        """How the four joints have to be, base to tip."""
        return right_joints(self.other, self.meant, self.described, self.record)

    @cached_property
    def right_tool(self) -> RightJoint | None:
        """How the joint of the tool frame has to be, if there is one."""
        return right_tool(self.other, self.meant, self.described, self.record)

    def correction(self, joint: int) -> Correction | None:
        """What to write in place of one of the four joints; None if it is right."""
        return self.right_joints[joint].correction

    def reduced_with(self, joint: UrdfJoint) -> Reduced:
        """The other model with one joint changed, reduced."""
        joints = {**self.robot.joints, joint.name: joint}
        four = tuple(joints[one.name] for one in self.meant.joints)
        robot = replace(self.robot, joints=joints)
        return reduce(robot, four, self.record, self.base)

    def torque_change(self, arm: FourJoints, q: FloatArray) -> float:
        """Largest difference of gravity torques in air from our arm's [N m].

        Args:
            arm: The arm to compare with ours.
            q: Its joint positions; ours are at ``self.q``, (N, 4) [rad].
        """
        change = float(np.abs(arm.gravity_torque(q) - self.our_torque).max())
        return round(change, 9)


def differences(evidence: Evidence) -> Iterator[Finding]:
    """Everything but the bodies that is wrong or odd, from the base on."""
    found = [*_slips(evidence), *_shoulder(evidence), *_zeros(evidence)]
    found += [*_dimensions(evidence), *_tool(evidence)]
    yield from _mount(evidence)
    yield from _carried(evidence)
    yield from found
    yield from _rest(evidence, found)
    yield from _limits(evidence)
    yield from _jaws(evidence)
    yield from _mimics(evidence)
    yield from _volume(evidence)
    yield from _files(evidence)


# --- Base -----------------------------------------------------------------------------


def _mount(evidence: Evidence) -> Iterator[Finding]:
    """A root of the other model that is not at our base_link."""
    described = evidence.described
    base = described.base
    shift = np.linalg.norm(base[:3, 3])
    angle = angle_between(np.eye(4), base)
    base_link = evidence.meant.link_poses[described.base_link]
    is_root = np.allclose(base_link, np.eye(4), atol=LENGTH_TOLERANCE)
    elsewhere = shift > LENGTH_TOLERANCE or angle > ANGLE_TOLERANCE
    if elsewhere and not (described.same_base and is_root):
        x, y, z = base[:3, 3] * 1e3
        yield finding(
            "mount" if described.same_base else "mount.or_zero",
            root=evidence.other.root,
            x=x,
            y=y,
            z=z,
            turned=math.degrees(angle),
        )


def _carried(evidence: Evidence) -> Iterator[Finding]:
    """Foreign links with a mass, which are left out of link_0."""
    links = evidence.other.links
    masses = {name: links[name].mass or 0.0 for name in evidence.meant.foreign}
    heaviest = sorted(masses, key=lambda name: -masses[name])
    heaviest = [name for name in heaviest if masses[name]]
    total = sum(masses.values())
    if not total:
        return
    named = [f"{name} ({masses[name]:.5g} kg)" for name in heaviest[:NAMED]]
    names = ", ".join(named)
    unnamed = len(heaviest) - NAMED
    if unnamed > 0:
        names += f" and {unnamed} more, {total:.5g} kg in all"
    excess = total + evidence.meant.mass[0] - evidence.record.links[0].mass
    yield finding("carried", names=names, excess=excess)


def _shoulder(evidence: Evidence) -> Iterator[Finding]:
    """A link meant to be base_link that is not where ours is below the shoulder."""
    described = evidence.described
    if not described.same_base:
        return
    x, y, z = described.base_link_pose[:3, 3]
    beside = math.hypot(x, y)
    up = described.base_link_pose[:3, 2]
    tilt = math.atan2(math.hypot(up[0], up[1]), up[2])
    both = [evidence.correction(0), evidence.correction(1)]
    if beside > evidence.tolerance.length or tilt > evidence.tolerance.angle:
        yield finding(
            "beside",
            link=described.base_link,
            beside=beside * 1e3,
            tilt=math.degrees(tilt),
            corrections=both,
        )
    elif abs(z) > evidence.tolerance.length:
        d = evidence.record.dh[0].d
        yield finding(
            "height",
            link=described.base_link,
            d=d * 1e3,
            above=(d - z) * 1e3,
            off=abs(z) * 1e3,
            way="lower" if z < 0 else "higher",
            corrections=both,
        )


# --- Axes -----------------------------------------------------------------------------


def _slips(evidence: Evidence) -> Iterator[Finding]:
    """Millimetres, degrees and exchanged axes."""
    names = [joint.name for joint in evidence.meant.joints]
    for slip in evidence.slips:
        name = slip.written.name
        where = AXES[names.index(name)] if name in names else name
        yield finding(
            f"joint.{slip.id}",
            where=where,
            cost=_slip_cost(evidence, slip),
            corrections=[_slip_correction(evidence, slip)],
            mistake=slip.id,
            turned=math.degrees(
                angle_between(slip.written.transform, slip.right.transform)
            ),
            was="xyz"[int(np.abs(slip.written.axis).argmax())],
            meant="xyz"[int(np.abs(slip.right.axis).argmax())],
        )


def _slip_correction(evidence: Evidence, slip: JointMistake) -> Correction | None:
    """The line to write: that of the joint in our arm, if ours has such a joint."""
    for right in (*evidence.right_joints, evidence.right_tool):
        if right is not None and right.joint.name == slip.written.name:
            return right.correction
    origin = origin_attributes(slip.right.transform)
    return Correction("joint", slip.written.name, {"origin": origin})


def _slip_cost(evidence: Evidence, slip: JointMistake) -> float:
    """Gravity torque that one mistake in a joint changes [N m]."""
    meant = evidence.meant
    names = [joint.name for joint in meant.joints]
    if slip.written.name not in names:
        return 0.0
    k = names.index(slip.written.name)
    placements = meant.placements.copy()
    axes = meant.axes.copy()
    if slip.id == "exchanged_axis":
        axes[k] = slip.written.axis
    else:
        to_parent = placements[k] @ np.linalg.inv(slip.right.transform)
        placements[k] = to_parent @ slip.written.transform
    wrong = replace(meant, placements=placements, axes=axes)
    there = evidence.described.theirs(evidence.q)
    down = evidence.described.base[:3, :3].T @ GRAVITY
    change = wrong.gravity_torque(there, down) - meant.gravity_torque(there, down)
    return round(float(np.abs(change).max()), 9)


def _zeros(evidence: Evidence) -> Iterator[Finding]:
    """Joints that turn the other way or have another zero."""
    described = evidence.described
    for joint, axis in enumerate(AXES):
        corrections = [evidence.correction(joint)]
        if described.sign[joint] < 0:
            q = evidence.q.copy()
            q[:, joint] = -q[:, joint]
            cost = evidence.torque_change(evidence.ours, q)
            yield finding("reversed", where=axis, cost=cost, corrections=corrections)

        zero = float(described.zero[joint])
        if abs(zero) > evidence.tolerance.angle:
            q = evidence.q.copy()
            q[:, joint] -= described.sign[joint] * zero
            unsure = joint == 0 and not _base_is_known(evidence)
            yield finding(
                "zero.or_base" if unsure else "zero",
                where=axis,
                cost=evidence.torque_change(evidence.ours, q),
                shift=math.degrees(zero),
                corrections=corrections,
            )


def _base_is_known(evidence: Evidence) -> bool:
    """Whether link_0 shows that the base is not turned by the shifted zero."""
    described = evidence.described
    ours = evidence.record.links[0].com
    turn = rotation_about(Z, described.sign[0] * described.zero[0])
    here = float(np.linalg.norm(described.coms[0] - ours))
    turned = float(np.linalg.norm(turn @ described.coms[0] - ours))
    return bool(evidence.meant.mass[0]) and (here < SAME_COM or 3 * here < turned)


def _dimensions(evidence: Evidence) -> Iterator[Finding]:
    """Lengths and twists that differ by more than the digits explain."""
    ours = dimensions_of(evidence.record)
    for name, change in evidence.described.changes._asdict().items():
        is_length = name in ("a_0", "a_1", "a_2", "d_1")
        within = evidence.tolerance.length if is_length else evidence.tolerance.angle
        if abs(change) <= within:
            continue
        own = getattr(ours, name)
        arm = our_arm(evidence.record, ours._replace(**{name: own + change}))
        scale = 1e3 if is_length else 180 / math.pi
        joint = int(name[-1]) + 1
        yield finding(
            f"dimension.{name}",
            cost=evidence.torque_change(arm, evidence.q),
            theirs=(own + change) * scale,
            ours=own * scale,
            unit="mm" if is_length else "deg",
            off=_tip_shift(evidence, arm) * 1e3,
            corrections=[evidence.correction(joint)],
        )


def _tip_shift(evidence: Evidence, arm: FourJoints) -> float:
    """How far our tool moves if our arm is replaced by another [m]."""
    tool = tool_of(evidence.record).matrix[:, 3]
    shifts = (
        arm.wrist_poses(evidence.q) - evidence.ours.wrist_poses(evidence.q)
    ) @ tool
    return float(np.linalg.norm(shifts, axis=1).max())


# --- Tool -----------------------------------------------------------------------------


def _tool(evidence: Evidence) -> Iterator[Finding]:
    """A tool frame that is not where ours is in link_4."""
    if evidence.right_tool is None:
        return
    wrist = evidence.described.placed[4]
    theirs = wrist @ evidence.meant.link_poses[evidence.meant.tool]
    ours = tool_of(evidence.record).matrix
    length, angle = evidence.tolerance
    off = float(np.linalg.norm(theirs[:3, 3] - ours[:3, 3]))
    turned = angle_between(ours, theirs)
    if off <= length and turned <= angle:
        return

    # Another point of the gripper, or axes with other names, are a choice.
    x, y, z = theirs[:3, 3]
    tips = evidence.record.links[4].bounds[2, 0]
    on_gripper = math.hypot(x, y) < BESIDE + length and tips <= z <= -JAWS_FROM
    along = np.sort(np.abs(theirs[2, :3]))
    tilt = math.atan2(math.hypot(along[0], along[1]), along[2])
    is_choice = (off <= length or on_gripper) and tilt < TURNED + angle
    is_printed = is_catalogue(evidence.record)
    yield finding(
        "tool.choice" if is_choice else "tool",
        frame=evidence.meant.tool,
        x=x * 1e3,
        y=y * 1e3,
        z=z * 1e3,
        off=off * 1e3,
        turned=math.degrees(turned),
        ours="Table 1's frame {5}" if is_printed else "its tcp",
        corrections=[evidence.right_tool.correction],
    )


# --- Rest of the joints ---------------------------------------------------------------


def _rest(evidence: Evidence, found: Sequence[Finding]) -> Iterator[Finding]:
    """Misplaced joints that no other finding corrects, and effects of printed digits.

    Args:
        evidence: Both arms.
        found: The findings of axes and tool.
    """
    length, angle = evidence.tolerance
    corrected = {one.name for item in found for one in item.corrections}
    rounded: list[Correction | None] = []
    for right in (*evidence.right_joints, evidence.right_tool):
        if right is None or right.joint.name in corrected:
            continue
        if right.off > 3 * (length + LEVER * angle):
            yield finding(
                "misplaced",
                where=right.ours.name if right.ours else "tool",
                off=right.off * 1e3,
                corrections=[right.correction],
            )
        elif right.off > LENGTH_TOLERANCE:
            rounded.append(right.correction)

    off = _short_pi(evidence)
    is_cut = off > LENGTH_TOLERANCE
    if is_cut:
        yield finding("digits.of_pi", off=off * 1e3, corrections=rounded)
    elif rounded:
        yield finding(
            "digits",
            length=length * 1e3,
            angle=math.degrees(angle),
            corrections=rounded,
        )


def _short_pi(evidence: Evidence) -> float:
    """How far multiples of pi that are cut short move their tool [m].

    Joints whose mistakes were mended are taken as they were meant.
    """
    if not evidence.meant.digits.pi:
        return 0.0
    joints = dict(evidence.other.joints)
    for slip in evidence.slips:
        joints[slip.right.name] = evidence.robot.joints[slip.right.name]
    robot = replace(evidence.other, joints=joints)
    four = tuple(joints[one.name] for one in evidence.meant.joints)
    written = reduce(robot, four, evidence.record, evidence.base)
    there = evidence.described.theirs(evidence.q)
    meant = evidence.meant.wrist_poses(there) @ tool_in_wrist(evidence, evidence.meant)
    cut = written.wrist_poses(there) @ tool_in_wrist(evidence, written)
    shifts = meant[:, :3, 3] - cut[:, :3, 3]
    return float(np.linalg.norm(shifts, axis=1).max())


def tool_in_wrist(evidence: Evidence, reduced: Reduced) -> FloatArray:
    """Pose of the other model's tool in its last body, (4, 4).

    Without a tool frame it is where ours would be.

    Args:
        evidence: Both arms.
        reduced: The other arm as it is meant, or as it is written.
    """
    if reduced.tool:
        return reduced.link_poses[reduced.tool]
    wrist = evidence.described.placed[4]
    return np.asarray(np.linalg.inv(wrist) @ tool_of(evidence.record).matrix)


# --- Limits ---------------------------------------------------------------------------


def _limits(evidence: Evidence) -> Iterator[Finding]:
    """Ranges, velocities and efforts of the four joints that are not ours.

    Those that are missing are findings of `lint`.
    """
    for k, right in enumerate(evidence.right_joints):
        joint = right.joint
        ours = evidence.record.joints[k]
        corrections = [right.correction]
        if seems_in_degrees(joint.velocity, ours.velocity):
            yield finding(
                "limits.velocity_in_degrees",
                where=ours.name,
                theirs=joint.velocity,
                ours=math.degrees(ours.velocity),
                corrections=corrections,
            )
        elif joint.velocity and velocity_differs(joint.velocity, ours.velocity):
            yield finding(
                "limits.velocity",
                where=ours.name,
                theirs=joint.velocity,
                ours=ours.velocity,
                corrections=corrections,
            )
        if joint.effort and abs(joint.effort - ours.effort) > 0.1 * ours.effort:
            own_effort = Correction(
                kind="joint",
                name=joint.name,
                elements={"limit": {"effort": f"{ours.effort:.5g}"}},
            )
            yield finding(
                "limits.effort",
                where=ours.name,
                theirs=joint.effort,
                ours=ours.effort,
                corrections=[own_effort],
            )
        if joint.lower is None or joint.upper is None:
            if joint.kind == "continuous" and "lower" not in (joint.limit or {}):
                yield finding("limits.none", where=ours.name, corrections=corrections)
            continue
        printed = np.array([ours.lower, ours.upper])
        if seems_in_degrees(joint.upper - joint.lower, ours.upper - ours.lower):
            yield finding(
                "limits.in_degrees",
                where=ours.name,
                theirs=(joint.lower, joint.upper),
                ours=np.degrees(printed),
                corrections=corrections,
            )
            continue

        written = np.array([joint.lower, joint.upper])
        described = evidence.described
        ends = np.sort(described.sign[k] * (written - described.zero[k]))
        # Shift their range by full turns to where ours is.
        middle = ends.mean()
        ends = ends + float(wrap(middle, printed.mean()) - middle)
        if np.abs(ends - printed).max() > LIMIT_TOLERANCE:
            yield finding(
                "limits",
                where=ours.name,
                theirs=np.degrees(ends),
                ours=np.degrees(printed),
                corrections=corrections,
            )


def _jaws(evidence: Evidence) -> Iterator[Finding]:
    """What is wrong with the joints of jaws that are ours."""
    there = evidence.described.theirs(evidence.q)
    down = evidence.described.base[:3, :3].T @ GRAVITY
    for jaw in evidence.jaws:
        cost = 0.0
        if jaw.right is not jaw.joint:
            wrong = evidence.reduced_with(jaw.joint).gravity_torque(there, down)
            change = wrong - evidence.meant.gravity_torque(there, down)
            cost = round(float(np.abs(change).max()), 9)
        yield from findings_of_jaws(evidence.other, jaw, cost)


def _mimics(evidence: Evidence) -> Iterator[Finding]:
    """Joints that their leader drives beyond their own limits.

    Those of our jaws are taken as they have to be.
    """
    joints = dict(evidence.other.joints)
    joints |= {jaw.joint.name: jaw.right for jaw in evidence.jaws}
    advised: dict[str, FloatArray] = {}  # joint -> the limits that it should have
    for joint in joints.values():
        leader = joints.get(joint.mimic or "")
        limits = _range(joint)
        travel = None if leader is None else _range(leader)
        if leader is None or limits is None or travel is None:
            continue
        travel = advised.get(leader.name, travel)
        low, high = np.sort(joint.multiplier * travel + joint.offset)
        beyond = max(limits[0] - low, high - limits[1])
        if beyond > ANGLE_TOLERANCE:
            advised[joint.name] = np.array([low, high])
            wider = {"lower": f"{low:.5g}", "upper": f"{high:.5g}"}
            yield finding(
                "mimic",
                where=joint.name,
                leader=leader.name,
                beyond=beyond,
                corrections=[Correction("joint", joint.name, {"limit": wider})],
            )


def _range(joint: UrdfJoint) -> FloatArray | None:
    """Lower and upper limit of a joint, (2,) [rad or m]; None if one is missing."""
    if joint.lower is None or joint.upper is None:
        return None
    return np.array([joint.lower, joint.upper], float)


# --- Collision shapes and files -------------------------------------------------------


def _volume(evidence: Evidence) -> Iterator[Finding]:
    """Collision meshes, which are not counted, and primitives with another volume."""
    meshes = 0
    for names in evidence.meant.links:
        meshes += sum(len(evidence.other.links[name].meshes) for name in names)
    if meshes:
        yield finding("volume.meshes", meshes=meshes)

    volume = evidence.meant.volume
    if not volume:
        return
    printed = sum(link.volume for link in evidence.record.links)
    # Our own collision shapes enclose the bodies and are not meant to displace water.
    off = min(abs(volume - printed), abs(volume - _own_shapes(evidence.record)))
    if off > VOLUME_TOLERANCE * printed:
        yield finding("volume", theirs=volume * 1e3, ours=printed * 1e3)


def _own_shapes(record: Alpha5Parameters) -> float:
    """Volume of our own collision shapes [m^3]."""
    # Imported late: most other models have no primitives.
    from alpha5_model.geometry.collision_shapes import exported_primitives

    volume = 0.0
    for shapes in exported_primitives("locked", record.spacer).values():
        for shape in shapes:
            if shape.kind == "box":
                volume += math.prod(shape.size)
            elif shape.kind == "cylinder":
                volume += math.pi * shape.size[0] ** 2 * shape.size[1]
            else:
                volume += 4 / 3 * math.pi * shape.size[0] ** 3
    return volume


def _files(evidence: Evidence) -> Iterator[Finding]:
    """Meshes that are not there, in one remark."""
    folder = evidence.folder
    if folder is None:
        return
    names: set[str] = set()
    for link in evidence.other.links.values():
        names.update(link.files)
    local = sorted(name for name in names if "://" not in name)
    missing = [name for name in local if not (folder / name).is_file()]
    if missing:
        more = f" and {len(missing) - NAMED} more" if len(missing) > NAMED else ""
        yield finding("file", names=", ".join(missing[:NAMED]) + more)
