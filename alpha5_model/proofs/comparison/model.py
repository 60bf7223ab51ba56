"""Read another model, and find the four joints that are this arm's."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, flag
from alpha5_model._support.files import read_named
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfJoint, UrdfRobot
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES

AXES = JOINT_NAMES[:4]
TURNING = ("revolute", "continuous")

#: Root element -> the format of its file.
OTHER_FORMATS = {
    "mujoco": "an MJCF model",
    "sdf": "an SDF model",
    "COLLADA": "a COLLADA mesh",
}
#: Axes whose shape differs by more are another arm's: a third of the upper arm. A model
#: of this arm with an offset on the wrong side differs by 40 mm at most.
OTHER_ARM = 0.05  # [m]
#: The same if two or more turning joints follow, as on many other arms.
OTHER_ARM_IF_LONGER = 0.005  # [m]


# --- Reading --------------------------------------------------------------------------


def read_model(
    path: str | Path,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    xacro: bool = False,
) -> UrdfRobot:
    """Read a URDF as it is, or expand a xacro file on request and read the result.

    Args:
        path: The file.
        packages: For a xacro file: name of each package in ``$(find NAME)`` -> its
            folder. The package of the file itself is found by the ``package.xml`` above
            it.
        arguments: For a xacro file: values of its arguments, as text.
        xacro: Whether to expand. A xacro file is a program: it can read files and run
            commands.

    Raises:
        InputError, MissingFileError: See `read_named`.
        InputError: The file to expand is no xacro file, or packages or arguments are
            given for a file that is not expanded.
        FileFormatError: The file has another format, is a xacro file that is not to be
            expanded or cannot be, or is a broken URDF. The message names the line.
    """
    folders_of = texts("packages", packages)
    values = texts("arguments", arguments)
    content = read_named(path, "a URDF or xacro file")
    is_xacro = Path(path).suffix.lower() == ".xacro"
    expand = flag("xacro", xacro)
    if is_xacro and not expand:
        problem = "a xacro file is a program: to expand it is to run it"
        raise FileFormatError(path, f"{problem}; if you trust it, use --xacro")
    if expand and not is_xacro:
        expected = "a file whose name ends in .xacro; a URDF is read as it is"
        raise InputError("xacro", str(path), expected)
    if (folders_of or values) and not expand:
        given = [*folders_of, *values]
        expected = "a xacro file to expand, with --xacro; a URDF is read as it is"
        raise InputError("package, arg", given, expected)

    if expand:
        folders = package_above(path) | folders_of
        content = expand_xacro(path, values, folders).encode()

    tag = parse_xml(content, str(path)).top.tag
    if tag in OTHER_FORMATS:
        problem = f"expected <robot>, got <{tag}>: {OTHER_FORMATS[tag]}"
        raise FileFormatError(path, f"{problem}; compare reads URDF and xacro")
    return parse_urdf(content, str(path))


def texts(name: str, given: Mapping[str, str] | None) -> dict[str, str]:
    """A copy of a mapping of texts; empty if there is none.

    Raises:
        InputError: Anything else.
    """
    if given is None:
        return {}
    is_mapping = isinstance(given, Mapping)
    if not is_mapping or not all(
        isinstance(word, str) for pair in given.items() for word in pair
    ):
        raise InputError(name, given, "a mapping of names, such as {'axis_e': 'joint'}")
    return dict(given)


def package_above(path: str | Path) -> dict[str, str]:
    """Name and folder of the ROS package of a file, by the nearest ``package.xml``."""
    for folder in Path(path).resolve().parents:
        manifest = folder / "package.xml"
        if not manifest.is_file():
            continue
        with suppress(Alpha5Error):
            content = read_named(manifest, "the manifest of a package")
            tree = parse_xml(content, str(manifest))
            name = (tree.top.findtext("name") or "").strip()
            return {name: str(folder)} if name else {}
    return {}


# --- Walking through the tree ---------------------------------------------------------


def path_to(robot: UrdfRobot, link: str) -> tuple[str, ...]:
    """The links from the root to this one."""
    parents = {joint.child: joint.parent for joint in robot.joints.values()}
    path = [link]
    while path[-1] in parents:
        path.append(parents[path[-1]])
    return tuple(reversed(path))


def rest_position(robot: UrdfRobot, joint: UrdfJoint) -> float:
    """The position at which a joint is frozen [rad or m]: jaws are closed.

    This is the position nearest to zero in the joint's range, or the one to which the
    joint it mimics drives it.
    """
    leader = robot.joints.get(joint.mimic) if joint.mimic else None
    if leader is not None and leader.mimic is None:
        driven_by = rest_position(robot, leader)
        return joint.multiplier * driven_by + joint.offset

    lower = joint.lower or 0.0
    upper = joint.upper or 0.0
    return lower if lower > 0 else min(upper, 0.0)


def rest_poses(robot: UrdfRobot) -> dict[str, FloatArray]:
    """Link -> its pose (4, 4) in the root, with every joint at its rest position."""
    poses = {robot.root: np.eye(4)}
    for joint in robot.joints.values():  # each after the joint before it
        origin = poses[joint.parent] @ joint.transform
        poses[joint.child] = origin @ joint.motion(rest_position(robot, joint))
    return poses


# --- Lines in space -------------------------------------------------------------------


def foot(
    point: FloatArray, direction: FloatArray, other: FloatArray, along: FloatArray
) -> FloatArray:
    """Where the common normal of two lines meets the first of them, (3,) [m].

    Args:
        point, direction: The first line, (3,) each.
        other, along: The second line, (3,) each.
    """
    between = point - other
    cosine = direction @ along
    squared_sine = np.maximum(1 - cosine * cosine, 1e-12)
    distance = (cosine * (along @ between) - direction @ between) / squared_sine
    return np.asarray(point + distance * direction)


def axis_shape(points: FloatArray, directions: FloatArray) -> FloatArray:
    """The numbers that describe how four consecutive axes lie, whatever their senses.

    Args:
        points: A point on each axis, (4, 3) [m].
        directions: Unit vectors, (4, 3).

    Returns:
        Distance of each axis from the one before it, (3,) [m]; offset of the elbow
        along the second axis [m]; angle of each axis with the one before it, (3,), at
        most pi/2 [rad].
    """
    normals = np.cross(directions[:-1], directions[1:])
    sines = np.linalg.norm(normals, axis=1)
    cosines = np.sum(directions[:-1] * directions[1:], axis=1)
    steps = np.diff(points, axis=0)
    along_normals = np.abs(np.sum(steps * normals, axis=1))
    distances = along_normals / np.maximum(sines, 1e-9)

    # The second and third axis are parallel, or nearly so: their common normal is not
    # unique.
    elbow = foot(points[2], directions[2], points[3], directions[3])
    shoulder = foot(points[1], directions[1], points[0], directions[0])
    upper_arm = elbow - shoulder
    offset = upper_arm @ directions[1]
    distances[1] = np.linalg.norm(upper_arm - offset * directions[1])

    angles = np.arctan2(sines, np.abs(cosines))
    return np.array([*distances, abs(offset), *angles])


def our_shape(record: Alpha5Parameters) -> FloatArray:
    """The `axis_shape` of our own arm, (7,) [m, rad]."""
    lengths = [row.a for row in record.dh[:3]]
    twists = np.abs([row.alpha for row in record.dh[:3]])
    return np.array([*lengths, 0.0, *np.minimum(twists, math.pi - twists)])


# --- The four joints ------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Chain:
    """Four joints that turn one after another, and the shape of their axes.

    Attributes:
        joints: Base to tip.
        shape: Distances and angles of their axes, (7,) [m, rad]; see `axis_shape`.
        differences: How far the shape is from ours, (7,) [m]: angles times the length
            of our upper arm.
        following: Length of the longest chain of turning joints behind them.
    """

    joints: tuple[UrdfJoint, ...]
    shape: FloatArray
    differences: FloatArray
    following: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return tuple(joint.name for joint in self.joints)

    @property
    def misfit(self) -> float:
        """All differences together [m]."""
        return float(np.linalg.norm(self.differences))

    @property
    def named_as_ours(self) -> int:
        """How many of the joints have a name that ends in ours."""
        return sum(map(str.endswith, self.names, AXES))

    @property
    def is_ours(self) -> bool:
        """Whether the axes have the shape of this arm's."""
        longer = self.following >= 2
        return self.misfit <= (OTHER_ARM_IF_LONGER if longer else OTHER_ARM)

    @property
    def mapping(self) -> dict[str, str]:
        """Our joint name -> theirs."""
        return dict(zip(AXES, self.names, strict=True))


def find_chains(
    robot: UrdfRobot,
    record: Alpha5Parameters,
    names: Mapping[str, str] | None = None,
) -> list[Chain]:
    """Every four joints in a row that could be our first four, the best first.

    They are ranked by the shape of their axes. Names decide between chains of the same
    shape, such as two arms on one vehicle. Joints that mimic another or have no range
    do not count.

    Args:
        robot: The other model.
        record: Our arm.
        names: Our joint name -> theirs, for joints that the user names. If all four
            are named, they need not be in a row.

    Raises:
        UnknownNameError: A name that is not there.
        InputError: Two of our joints are mapped to one, one does not turn, or there is
            no such chain.
    """
    given = texts("map", names)
    _check_names(robot, given)
    rows = _rows_of_turning_joints(robot)
    if len(given) == len(AXES):
        found = [tuple(robot.joints[given[axis]] for axis in AXES)]
    else:
        found = [row for row in rows.values() if _fits(row, given)]
    if given and not found:
        mapping = ",".join(f"{axis}={name}" for axis, name in given.items())
        listed = ", ".join(rows) or "none"
        expected = f"four different joints that follow each other, out of: {listed}"
        raise InputError("map", mapping, expected)

    ours = our_shape(record)
    upper_arm = ours[1]
    to_metres = np.array([1.0, 1.0, 1.0, 1.0, upper_arm, upper_arm, upper_arm])
    poses = rest_poses(robot)
    following = _following(robot)
    chains = []
    for row in found:
        origins = np.array([poses[joint.parent] @ joint.transform for joint in row])
        axes = np.array([joint.axis for joint in row])
        directions = np.einsum("nij,nj->ni", origins[:, :3, :3], axes)
        shape = axis_shape(origins[:, :3, 3], directions)
        chains.append(
            Chain(
                joints=row,
                shape=shape,
                differences=np.abs(shape - ours) * to_metres,
                following=following[row[-1].child],
            )
        )
    chains.sort(key=lambda chain: (round(chain.misfit, 4), -chain.named_as_ours))
    return chains


def _check_names(robot: UrdfRobot, given: Mapping[str, str]) -> None:
    """Refuse names of joints that do not exist, do not turn, or are given twice."""
    for axis, name in given.items():
        choice("joint", axis, AXES)
        choice("joint of the other model", name, tuple(robot.joints))
        if robot.joints[name].kind not in TURNING:
            raise InputError("map", name, "a revolute joint")
    if len(set(given.values())) < len(given):
        mapping = ",".join(f"{axis}={name}" for axis, name in given.items())
        raise InputError("map", mapping, "four different joints")


def _rows_of_turning_joints(robot: UrdfRobot) -> dict[str, tuple[UrdfJoint, ...]]:
    """Turning joint -> the last four turning joints up to it, base to tip."""
    way_to_link: dict[str, tuple[UrdfJoint, ...]] = {robot.root: ()}
    rows = {}
    for joint in robot.joints.values():  # each after the joint before it
        way = way_to_link[joint.parent]
        if turns(joint):
            way = (*way, joint)[-4:]
            rows[joint.name] = way
        way_to_link[joint.child] = way
    return rows


def _fits(row: Sequence[UrdfJoint], given: Mapping[str, str]) -> bool:
    """Whether a row has four joints, with the names that are given for them."""
    if len(row) < len(AXES):
        return False
    return all(row[AXES.index(axis)].name == name for axis, name in given.items())


def turns(joint: UrdfJoint) -> bool:
    """Whether a joint turns by itself: it follows no other and has a range."""
    locked = joint.lower is not None and joint.lower == joint.upper
    return joint.kind in TURNING and joint.mimic is None and not locked


def _following(robot: UrdfRobot) -> dict[str, int]:
    """Link -> length of the longest chain of turning joints behind it."""
    following = dict.fromkeys(robot.links, 0)
    for joint in reversed(robot.joints.values()):
        behind = following[joint.child] + turns(joint)
        following[joint.parent] = max(following[joint.parent], behind)
    return following
