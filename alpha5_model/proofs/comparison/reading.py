"""Read another model: its file, what its digits leave open, and which joints are this arm's."""

from __future__ import annotations

import math
import re
import shlex
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, flag
from alpha5_model._support.files import read_named
from alpha5_model._support.spatial import pose
from alpha5_model.description.reading import UrdfJoint, UrdfRobot, parse_urdf
from alpha5_model.description.urdf import expand_xacro
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.numbers.parameters import parameters
from alpha5_model.numbers.tables import JOINT_NAMES

#: Root element -> what its file is.
OTHERS = {"mujoco": "an MJCF model", "sdf": "an SDF model", "COLLADA": "a COLLADA mesh"}
AXES = JOINT_NAMES[:4]
TURNING = ("revolute", "continuous")
#: Fractions of a turn that people write: multiples of 15 deg, up to a full turn.
PARTS = np.arange(1, 25)[:, None] / 12


def read_model(
    path: Any,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    xacro: bool = False,
) -> UrdfRobot:
    """Read a URDF as it is, or expand a xacro file on request and read the result.

    Args:
        path: The file.
        packages: Of a xacro file: name of each package in ``$(find NAME)`` -> its folder. The
            package that the file is in is found by the ``package.xml`` above it.
        arguments: Of a xacro file: values of its arguments, as text.
        xacro: Whether to expand. A xacro file is a program: it can read files and run commands.

    Raises:
        InputError, MissingFileError: See `read_named`.
        InputError: Something to expand that is no xacro file, or packages or arguments for a file
            that is not expanded.
        FileFormatError: Another format, named with what to do; a xacro file that is not to be
            expanded or cannot be, with the command that would; a broken URDF, with its line.
    """
    content = read_named(path, "a URDF or xacro file")
    program = Path(path).suffix.lower() == ".xacro"
    given = _XacroOptions(dict(packages or {}), dict(arguments or {}))
    if program and not flag("xacro", xacro):
        problem = (
            "a xacro file is a program, and to expand it is to run it; if you trust it"
        )
        raise FileFormatError(path, f"{problem}: {given.command(path)}")
    if flag("xacro", xacro):
        if not program:
            expected = "a file whose name ends in .xacro; a URDF is read as it is"
            raise InputError("xacro", str(path), expected)
        content = _expanded(path, content, given).encode()
    elif given.packages or given.arguments:
        expected = "a xacro file to expand, with --xacro; a URDF is read as it is"
        raise InputError("package, arg", [*given.packages, *given.arguments], expected)
    tag = parse_xml(content, str(path)).top.tag
    if tag in OTHERS:
        problem = f"expected <robot>, got <{tag}>: {OTHERS[tag]}; compare reads URDF and xacro"
        raise FileFormatError(path, problem)
    try:
        return parse_urdf(content, str(path))
    except FileFormatError as error:
        if program or b"<xacro:" not in content.replace(b"\0", b""):
            raise
        problem = str(error).removeprefix(f"{path}").lstrip(",: ")
        hint = (
            "it has xacro in it, and only a file whose name ends in .xacro is expanded"
        )
        raise FileFormatError(path, f"{problem}; {hint}", error.place) from None


@dataclass(frozen=True)
class _XacroOptions:
    """Folders of packages and values of arguments, by name."""

    packages: dict[str, str]
    arguments: dict[str, str]

    def command(self, path: Any) -> str:
        """The command line that expands and compares, quoted for a shell."""
        words = ["alpha5", "compare", "--xacro", str(path)]
        for name, folder in self.packages.items():
            words += ["--package", f"{name}={folder}"]
        for name, value in self.arguments.items():
            words += ["--arg", f"{name}:={value}"]
        return shlex.join(words)


def _expanded(path: Any, content: bytes, given: _XacroOptions) -> str:
    """The text that a xacro file makes."""
    packages = package_above(path) | given.packages
    try:
        return expand_xacro(path, given.arguments, packages)
    except FileFormatError as error:
        problem = str(error).removeprefix(f"{path}: ")
    # In whatever encoding: the marks are ASCII. A name that is itself computed is known only where
    # xacro says it.
    text = content.replace(b"\0", b"").decode("utf-8", "replace")
    needs = re.findall(r"\$\(find\s+([A-Za-z][\w.-]*)\s*\)", text)
    needs += re.findall(r"no folder for package ([A-Za-z][\w.-]*)", problem)
    wants = re.findall(r"[Uu]ndefined substitution argument (\w+)", problem)
    folders = dict.fromkeys(sorted(set(needs) - {*packages}), "FOLDER")
    values = dict.fromkeys(wants, "VALUE")
    if folders or values:
        more = _XacroOptions(given.packages | folders, given.arguments | values)
        problem += f"; this would expand it: {more.command(path)}"
    raise FileFormatError(path, problem)


def package_above(path: Any) -> dict[str, str]:
    """Name and folder of the ROS package that a file is in, by the nearest ``package.xml``."""
    for folder in Path(path).resolve().parents:
        manifest = folder / "package.xml"
        if not manifest.is_file():
            continue
        with suppress(Alpha5Error):
            tree = parse_xml(
                read_named(manifest, "the manifest of a package"), str(manifest)
            )
            name = (tree.top.findtext("name") or "").strip()
            return {name: str(folder)} if name else {}
    return {}


def as_meant(robot: UrdfRobot) -> UrdfRobot:
    """The robot with every multiple of pi in its joints' rpy exact, whatever digits are printed."""
    joints = dict(robot.joints)
    for name, joint in robot.joints.items():
        if angles := [meant_angle(text) for text in joint.printed[1].split()]:
            joints[name] = replace(
                joint, transform=pose(joint.transform[:3, 3], angles)
            )
    return replace(robot, joints=joints)


@cache
def meant_angle(text: str) -> float:
    """The multiple of pi that a printed angle stands for; the angle itself if it is none.

    It is one if it equals, to its last printed digit, a multiple of 15 deg computed from pi cut or
    rounded to 3 digits or more: 3.1415 and 1.57075, but neither 1.5 nor 1.572.
    """
    angle, unit = float(text), last_place(text)
    with_digits = [10.0**n for n in range(2, 16)]
    pis = [f(math.pi * n) / n for n in with_digits for f in (math.floor, round)]
    # Two decimals are too few to tell thirds of pi from any other angle.
    parts = PARTS if unit < 5e-3 else PARTS[5::6]
    # Angles computed from a short pi are not exact; no last digit is worth more than what 3.14
    # leaves open.
    unit = min(1.01 * unit + 1e-12, (math.pi - 3.14) * abs(angle) / 3)
    near = (np.abs(parts * pis - abs(angle)) <= unit).any(axis=1)
    return (
        math.copysign(float(parts[near][0, 0]) * math.pi, angle)
        if near.any()
        else angle
    )


def last_digits(joints: Sequence[UrdfJoint]) -> tuple[float, float, float]:
    """What the digits of origins leave open: lengths [m], angles and multiples of pi [rad].

    Of lengths and angles half of the last decimal place, added in quadrature. A number may have
    lost its trailing zeros: the most decimals among the lengths are taken for all of them, and so
    for the angles. Zeros and integers are exact. Of the multiples of pi the largest error of any.
    """
    printed = [" ".join(j.printed[k] for j in joints).split() for k in (0, 1)]
    lengths, angles = ([text for text in texts if float(text) % 1] for texts in printed)
    cut = [abs(meant_angle(text) - float(text)) for text in angles]
    both = lengths, [text for text, off in zip(angles, cut, strict=True) if not off]
    length, angle = (
        0.5 * min(map(last_place, x), default=0.0) * math.sqrt(len(x)) for x in both
    )
    return length, angle, max(cut, default=0.0)


def last_place(text: str) -> float:
    """What one unit of the last digit of a printed number is worth."""
    mantissa, _, power = text.lower().partition("e")
    exponent = float(power or 0) - len(mantissa.partition(".")[2])
    return float(10.0 ** np.clip(exponent, -300, 300))


@dataclass(frozen=True, eq=False)
class Chain:
    """Four joints that turn one after another, and the shape of their axes.

    Attributes:
        joints: Base to tip.
        shape: Distance of each axis from the one before it, (3,), and of the first from the last
            common normal along the second axis [m]; angle of each axis with the one before it,
            (3,), up to pi/2 [rad]; (7,) in all.
        following: How many more joints turn one after another behind them.
    """

    joints: tuple[UrdfJoint, ...]
    shape: FloatArray
    following: int

    @property
    def names(self) -> tuple[str, ...]:
        """Of the joints."""
        return tuple([joint.name for joint in self.joints])

    @property
    def differences(self) -> FloatArray:
        """How far its shape is from ours, (7,) [m]: angles times the length of the upper arm."""
        ours = our_shape()
        return np.abs(self.shape - ours) * np.where(np.arange(7) < 4, 1.0, ours[1])

    @property
    def misfit(self) -> float:
        """All differences together [m]."""
        return float(np.linalg.norm(self.differences))


def our_shape() -> FloatArray:
    """Distances [m] and angles [rad] of our own axes, as in `Chain`."""
    rows = parameters().dh[:3]
    twists = np.abs([row.alpha for row in rows])
    return np.array(
        [*(row.a for row in rows), 0.0, *np.minimum(twists, math.pi - twists)]
    )


def _shape(points: FloatArray, directions: FloatArray) -> FloatArray:
    """Distances and angles of axes, given by a point on each and their directions, (4, 3)."""
    across = np.cross(directions[:-1], directions[1:])
    sines = np.linalg.norm(across, axis=1)
    upper = foot(points, directions, 2, 3) - foot(points, directions, 1, 0)
    offset = upper @ directions[1]
    lengths = np.abs(np.sum(np.diff(points, axis=0) * across, axis=1)) / np.maximum(
        sines, 1e-9
    )
    lengths[1] = np.linalg.norm(
        upper - offset * directions[1]
    )  # parallel, or nearly so
    twists = np.arctan2(sines, np.abs(np.sum(directions[:-1] * directions[1:], axis=1)))
    return np.array([*lengths, abs(offset), *twists])


def foot(points: FloatArray, directions: FloatArray, at: int, other: int) -> FloatArray:
    """Foot of the common normal of two of the axes (..., 4, 3), on the first of them, (..., 3)."""
    u, w, p = directions[..., at, :], directions[..., other, :], points[..., at, :]
    r = p - points[..., other, :]
    b, along, across = (
        np.sum(x * y, -1, keepdims=True) for x, y in ((u, w), (w, r), (u, r))
    )
    return np.asarray(p + (b * along - across) / np.maximum(1 - b * b, 1e-12) * u)


def find_chains(
    robot: UrdfRobot, names: Mapping[str, str] | None = None
) -> list[Chain]:
    """Every four joints in a row that could be axis_e, axis_d, axis_c and axis_b, the best first.

    Joints are known by the shape of their axes; names decide between chains of the same shape, such
    as two arms on one vehicle. Joints that mimic another or have no range do not count.

    Args:
        robot: The other model.
        names: Ours -> theirs, where the caller gives them; four of them need not be in a row.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints mapped to one, one that does not turn, or no such chain.
    """
    given = dict(names or {})
    for axis, name in given.items():
        choice("joint", axis, AXES)
        choice("joint of the other model", name, tuple(robot.joints))
        if robot.joints[name].kind not in TURNING:
            raise InputError("map", name, "a revolute joint")
        if twice := [
            other for other in given if other != axis and given[other] == name
        ]:
            raise InputError(
                "map", f"{axis}={name},{twice[0]}={name}", "four different joints"
            )
    poses = {robot.root: np.eye(4)}
    #: link -> the turning joints on the way to it, the last four
    way: dict[str, tuple[UrdfJoint, ...]] = {robot.root: ()}
    rows: dict[str, tuple[UrdfJoint, ...]] = {}
    for joint in robot.joints.values():
        at = poses[joint.parent] @ joint.transform
        poses[joint.child] = at @ joint.motion(rest_position(robot, joint))
        way[joint.child] = way[joint.parent]
        if _turns(joint):
            rows[joint.name] = way[joint.child] = (*way[joint.parent], joint)[-4:]
    following = _following(robot)
    found: list[tuple[UrdfJoint, ...]] = [row for row in rows.values() if len(row) == 4]
    if len(given) == 4:
        found = [tuple(robot.joints[given[axis]] for axis in AXES)]
    found = [
        row
        for row in found
        if all(row[AXES.index(a)].name == n for a, n in given.items())
    ]
    if given and not found:
        expected = "four different joints that follow each other, out of: "
        example = ",".join(map("=".join, given.items()))
        raise InputError("map", example, expected + (", ".join(rows) or "none"))
    chains = []
    for row in found:
        at = np.array([poses[joint.parent] @ joint.transform for joint in row])
        directions = np.einsum(
            "nij,nj->ni", at[:, :3, :3], [joint.axis for joint in row]
        )
        shape = _shape(at[:, :3, 3], directions)
        chains.append(Chain(row, shape, following[row[-1].child]))
    chains.sort(
        key=lambda c: (round(c.misfit, 4), -sum(map(str.endswith, c.names, AXES)))
    )
    return chains


def _turns(joint: UrdfJoint) -> bool:
    """Whether a joint turns by itself: it follows no other and has a range."""
    locked = joint.lower is not None and joint.lower == joint.upper
    return joint.kind in TURNING and joint.mimic is None and not locked


def _following(robot: UrdfRobot) -> dict[str, int]:
    """Link -> how many joints turn one after another behind it, at most."""
    following = dict.fromkeys(robot.links, 0)
    for joint in reversed(robot.joints.values()):
        behind = following[joint.child] + _turns(joint)
        following[joint.parent] = max(following[joint.parent], behind)
    return following


def rest_position(robot: UrdfRobot, joint: UrdfJoint) -> float:
    """Where a joint is frozen: nearest to zero in its range, or with the joint it mimics."""
    leader = robot.joints.get(joint.mimic) if joint.mimic else None
    if leader is not None and leader.mimic is None:
        return joint.multiplier * rest_position(robot, leader) + joint.offset
    lower, upper = joint.lower or 0.0, joint.upper or 0.0
    return lower if lower > 0 else min(upper, 0.0)
