"""What programs refuse in a URDF, or read differently.

Each finding names the programs that stumble: urdfdom, which ROS and Pinocchio use,
Pinocchio, MuJoCo, Drake and yourdfpy. ``tests/proofs/test_lint.py`` runs those that are
installed on a file for each finding. Drake is run
on the limits that it refuses or keeps.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from types import MappingProxyType

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rpy_from_rotation
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfLink, UrdfRobot
from alpha5_model.description.xml import text_of
from alpha5_model.numbers.inertia import combine
from alpha5_model.numbers.motors import joint_losses
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    JointParameters,
    JointRange,
)
from alpha5_model.proofs.comparison.corrections import token_inertial
from alpha5_model.proofs.comparison.result import (
    Correction,
    Finding,
    finding,
    some_names,
)

#: Versions of URDF that urdfdom 6 reads.
VERSIONS = ("", "1.0", "1.1", "1.2")
#: Plausible losses of a joint at its rated speed [N m]. The arm's weight needs at most
#: 1.4 N m: with more friction it would hold itself up.
LOSSES = 2.0
#: Smallest mass [kg] and moment [kg m^2] of a moving body: MuJoCo's mjMINVAL.
LEAST = 1e-15
#: Plausible scales of a mesh: from micrometres to decametres.
SCALES = (1e-6, 10.0)


def lint(
    robot: UrdfRobot,
    joints: Sequence[UrdfJoint],
    record: Alpha5Parameters,
    advice: Mapping[str, Correction] = MappingProxyType({}),
    mended: Collection[str] = (),
    jaws: Mapping[str, JointRange] = MappingProxyType({}),
) -> Iterator[Finding]:
    """What programs refuse in a URDF, or read differently.

    Args:
        robot: The URDF.
        joints: The arm's joints in it, as ``axis_e`` to ``axis_b``; empty if unknown.
        record: The arm's numbers.
        advice: Name of one of these joints -> what to write in it, its range included.
        mended: Links whose inertials other findings mend: they are not judged.
        jaws: Name of a joint of its jaws -> ours, for those that are ours.
    """
    yield from _file(robot)
    names = [joint.name for joint in joints]
    ours_of = dict(zip(names, record.joints, strict=False))
    is_first = robot.version in VERSIONS[:3]
    for joint in robot.joints.values():
        ours = ours_of.get(joint.name)
        where = joint.name if ours is None else ours.name
        right = [advice[joint.name]] if joint.name in advice else []
        yield from _range(joint, where, is_first, right)
        if joint.limit is not None:
            rated = ours or jaws.get(joint.name)
            yield from _ratings(joint, where, rated, is_first)
        if joint.dynamics is not None:
            yield from _dynamics(joint, where, ours, record)
        if joint.mimic is not None and joint.mimic not in robot.joints:
            yield finding("lint.mimic", where, leader=joint.mimic, corrections=right)
    yield from _bodies(robot, mended)
    yield from _scales(robot)


# --- the file -------------------------------------------------------------------------


def _file(robot: UrdfRobot) -> Iterator[Finding]:
    """Name and version of the robot, and elements that are out of place."""
    if not robot.name:
        yield finding("lint.no_name")
    if robot.version not in VERSIONS:
        yield finding("lint.version", version=robot.version)

    has_none_of_1_1 = robot.version in VERSIONS[:2]
    for remark in robot.remarks:
        if remark.kind in ("doubled", "number", "shapes"):
            yield finding(
                f"lint.{remark.kind}",
                remark.where,
                written=remark.text,
                line=remark.line,
            )
    for kind in ("macro", "expression", "quaternion", "capsule"):
        remarks = [remark for remark in robot.remarks if remark.kind == kind]
        if not remarks:
            continue
        subject = kind
        if kind in ("quaternion", "capsule") and has_none_of_1_1:
            subject = f"{kind}_1_0"
        yield finding(
            f"lint.{subject}",
            written=remarks[0].text,
            line=remarks[0].line,
            count=len(remarks),
        )


def _scales(robot: UrdfRobot) -> Iterator[Finding]:
    """Scales of meshes that are no unit of length, or not that of the others."""
    scales: dict[str, tuple[float, ...]] = {}
    for link in robot.links.values():
        for file in link.files:
            scales[file] = link.scales.get(file, (1.0, 1.0, 1.0))

    unread = [file for file, scale in scales.items() if len(scale) != 3]
    odd = []
    small: dict[str, str] = {}  # kind of file -> scale
    for file, scale in scales.items():
        if not all(SCALES[0] <= abs(factor) <= SCALES[1] for factor in scale):
            odd.append(file)
        elif len(scale) == 3 and max(map(abs, scale)) < 0.1:
            small[_kind(file)] = text_of(scale)
    # A mesh in mm has a scale of 0.001. One without it among others that have it is a
    # thousand times too large.
    unscaled = []
    for file, scale in scales.items():
        if scale == (1.0, 1.0, 1.0) and _kind(file) in small:
            unscaled.append(file)

    if unread:
        yield finding("lint.scale_unread", files=some_names(unread))
    if odd:
        shown = text_of(scales[odd[0]])
        yield finding("lint.scale", files=some_names(odd), scale=shown)
    if unscaled:
        shown = small[_kind(unscaled[0])]
        yield finding("lint.scale_missing", files=some_names(unscaled), scale=shown)


def _kind(file: str) -> str:
    """The end of a file's name, such as ``stl``."""
    return file.rpartition(".")[2].lower()


# --- joints ---------------------------------------------------------------------------


def _range(
    joint: UrdfJoint, where: str, is_first: bool, right: Sequence[Correction]
) -> Iterator[Finding]:
    """A range that is missing, reversed, empty or ignored.

    Args:
        joint: The joint.
        where: Its name in findings.
        is_first: Whether the file has a version before 1.2.
        right: What to write in the joint, if it is one of the arm's.
    """
    has_range = joint.kind in ("revolute", "prismatic")
    if joint.limit is None:
        if has_range:
            yield finding("lint.no_limit", where, corrections=right)
        return
    missing = [name for name in ("lower", "upper") if name not in joint.limit]
    if missing:
        if has_range:
            ends = " and ".join(missing)
            yield finding("lint.no_range", where, missing=ends, corrections=right)
        return

    lower = _number(joint.limit["lower"])
    upper = _number(joint.limit["upper"])
    if lower > upper and (has_range or not is_first):
        limit = {"lower": text_of(upper), "upper": text_of(lower)}
        turned = Correction("joint", joint.name, {"limit": limit})
        yield finding(
            "lint.reversed", where, lower=lower, upper=upper, corrections=[turned]
        )
    if lower == upper and has_range:
        fixed = right or [_fixed(joint, lower)]
        yield finding("lint.equal", where, value=lower, corrections=fixed)
    if 0 < upper - lower < 1e3 and joint.kind == "continuous":
        turning = Correction("joint", joint.name, {"joint": {"type": "revolute"}})
        yield finding(
            "lint.continuous", where, lower=lower, upper=upper, corrections=[turning]
        )


def _fixed(joint: UrdfJoint, position: float) -> Correction:
    """The joint as a fixed one at a position."""
    elements = {"joint": {"type": "fixed"}}
    if position:
        pose = joint.transform @ joint.motion(position)
        elements["origin"] = {
            "xyz": text_of(pose[:3, 3]),
            "rpy": text_of(rpy_from_rotation(pose[:3, :3])),
        }
    return Correction("joint", joint.name, elements)


def _ratings(
    joint: UrdfJoint, where: str, ours: JointRange | None, is_first: bool
) -> Iterator[Finding]:
    """A velocity or effort that is missing, zero or negative.

    Args:
        joint: The joint, which has a ``<limit>``.
        where: Its name in findings.
        ours: Our joint, if it is one of the arm's or of its jaws.
        is_first: Whether the file has a version before 1.2, which need not have them.
    """
    moves = joint.kind in ("revolute", "prismatic", "continuous")
    for name in ("velocity", "effort"):
        right = []
        if ours is not None:
            limit = {"limit": {name: text_of(getattr(ours, name))}}
            right = [Correction("joint", joint.name, limit)]
        value = getattr(joint, name)
        if is_first and name not in (joint.limit or {}):
            yield finding(f"lint.no_{name}", where, corrections=right)
        if value is None:
            continue
        if value < 0 and (moves or not is_first):
            yield finding(
                "lint.negative", where, limit=name, value=value, corrections=right
            )
        if value == 0 and moves:
            yield finding(f"lint.{name}_zero", where, corrections=right)


def _dynamics(
    joint: UrdfJoint,
    where: str,
    ours: JointParameters | None,
    record: Alpha5Parameters,
) -> Iterator[Finding]:
    """Friction and damping that no joint has, or none of this arm."""
    written = joint.dynamics or {}
    nothing = [Correction("joint", joint.name, {"dynamics": None})]
    if not written:
        yield finding("lint.no_dynamics", where, corrections=nothing)
    for name, value in written.items():
        if value < 0:
            yield finding(
                f"lint.negative_{name}", where, value=value, corrections=nothing
            )
    if ours is None:
        return

    friction = written.get("friction", 0.0)
    damping = written.get("damping", 0.0)
    lost = friction + damping * ours.velocity
    most = LOSSES
    own = joint_losses(record).get(ours.name)
    if own is not None:
        most = max(most, 2 * (own.friction + own.damping * ours.velocity))
    if lost > most:
        yield finding(
            "lint.dynamics",
            where,
            friction=friction,
            damping=damping,
            lost=lost,
            corrections=nothing,
        )


# --- bodies ---------------------------------------------------------------------------


def _bodies(robot: UrdfRobot, mended: Collection[str]) -> Iterator[Finding]:
    """Inertias that no body has, and moving bodies without any.

    Args:
        robot: The URDF.
        mended: Links whose inertials other findings mend.
    """
    judged = set(mended)
    for link in robot.links.values():
        moments = np.linalg.eigvalsh(link.inertia)
        if moments.any() and (moments[0] <= 0 or moments[2] > moments[0] + moments[1]):
            judged.add(link.name)
            yield finding("lint.impossible", link.name, moments=moments)

    alike: dict[tuple[str, float], list[list[str]]] = {}  # what is wrong -> bodies
    for links in _moving(robot).values():
        names = [link.name for link, _ in links]
        mass = sum(link.mass or 0.0 for link, _ in links)
        problem = _problem_of_body(links)
        if problem and judged.isdisjoint(names):
            alike.setdefault((problem, mass), []).append(names)

    for (problem, mass), bodies in alike.items():
        firsts = [names[0] for names in bodies]
        whose = f"moves, but {some_names(bodies[0])} has"
        if len(bodies) > 1:
            others = f"{len(bodies) - 1} other bod{'y' if len(bodies) == 2 else 'ies'}"
            whose = f"moves, and so do {others}, but {some_names(firsts)} have"
        corrections = [token_inertial(first, max(mass, 0.0)) for first in firsts]
        yield finding(
            f"lint.{problem}",
            firsts[0],
            whose=whose,
            mass=f"{mass:g} kg" if mass else "no mass",
            corrections=[] if problem == "negative_mass" else corrections,
        )


def _problem_of_body(links: Sequence[tuple[UrdfLink, FloatArray]]) -> str:
    """What a moving body lacks; empty if nothing.

    Args:
        links: Its links, and their poses in the first.
    """
    massive = [(link, at) for link, at in links if link.mass]
    masses = [link.mass or 0.0 for link, _ in massive]
    if masses and min(masses) < 0:
        return "negative_mass"
    if sum(masses) <= LEAST:
        has_tensor = any(link.inertia.any() for link, _ in links)
        return "no_mass" if has_tensor else "no_inertia"
    _, _, tensor = combine(
        masses,
        [at[:3, :3] @ link.com + at[:3, 3] for link, at in massive],
        [at[:3, :3] @ link.inertia @ at[:3, :3].T for link, at in massive],
    )
    moments = np.linalg.eigvalsh(tensor)
    if abs(moments[2]) <= LEAST:
        return "no_inertia"
    return "zero_moment" if abs(moments[0]) <= LEAST else ""


def _moving(robot: UrdfRobot) -> dict[str, list[tuple[UrdfLink, FloatArray]]]:
    """First link of each moving body -> its links, and their poses in the first."""
    bodies: dict[str, list[tuple[UrdfLink, FloatArray]]] = {}
    places = {robot.root: (robot.root, np.eye(4))}
    for joint in robot.joints.values():
        place = (joint.child, np.eye(4))
        if joint.kind == "fixed":
            first, pose = places[joint.parent]
            place = (first, pose @ joint.transform)
        places[joint.child] = place
        first, pose = place
        bodies.setdefault(first, []).append((robot.links[joint.child], pose))
    bodies.pop(robot.root, None)
    return bodies


def _number(text: str) -> float:
    """The number of a text; NaN if it is none."""
    with suppress(ValueError):
        return float(text)
    return math.nan
