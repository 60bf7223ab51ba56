"""Waypoints from files: joint positions, points or poses, for `alpha5_model.plan`.

A CSV table has one waypoint in each row. Names of its columns, and their units, are
those of recordings (`alpha5_model.trajectory.column_names`)::

    axis_e [deg], axis_d [deg], axis_c [deg], axis_b [deg]

or a point of the tcp in base_link, perhaps with an orientation of the tcp::

    x [mm], y [mm], z [mm], roll [deg], pitch [deg], yaw [deg]
    x, y, z, qx, qy, qz, qw

A JSON or YAML file is a ``trajectory_msgs/JointTrajectory``, or a goal of
``FollowJointTrajectory`` that contains one. Only its positions are used.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, flag
from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.spatial import rotation_from_rpy, transform
from alpha5_model._support.yaml_reading import yaml_document
from alpha5_model.errors import FileFormatError, JointLimitError
from alpha5_model.kinematics.limits import beyond
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import JOINT_NAMES
from alpha5_model.planning.goals import JOINTS, POINT, POSE, Target
from alpha5_model.trajectory.column_names import JointMap, Roles, find_roles, split_unit
from alpha5_model.trajectory.csv_file import read_csv
from alpha5_model.trajectory.tables import Problem, Table

_EXPECTED = "a CSV table of waypoints, or a JointTrajectory as .json or .yaml"
#: Jaws are closed within this travel of the rod, 0.3 degrees of a finger [m].
_CLOSED = 1e-4
#: Largest file of a JointTrajectory [bytes].
_LARGEST = 1 << 24
#: Keys that may contain a JointTrajectory: of an action's goal, and of MoveIt.
_AROUND = ("goal", "trajectory", "joint_trajectory")
#: The number of a row takes the place of the time, which waypoints need not have.
_ROW = "(row)"

_LENGTHS = {"": 1.0, "m": 1.0, "mm": 1e-3}
_ANGLES = {"": 1.0, "rad": 1.0, "deg": np.pi / 180, "degrees": np.pi / 180}
_SHARES = {"": 1.0}
_POINT = ("x", "y", "z")
_ANGLES_OF_POSE = ("roll", "pitch", "yaw")
_QUATERNION = ("qx", "qy", "qz", "qw")
#: Column of a table of poses -> its units.
_UNITS = {
    **dict.fromkeys(_POINT, _LENGTHS),
    **dict.fromkeys(_ANGLES_OF_POSE, _ANGLES),
    **dict.fromkeys(_QUATERNION, _SHARES),
}
#: A quaternion of three printed digits is off by less.
_UNIT_LENGTH = 5e-3
#: The farthest point that a message calls metres [m]; the arm reaches half a metre.
_FARTHEST = 5.0


def read_waypoints(
    path: PathLike,
    *,
    arm: Alpha5Parameters | None = None,
    joints: Mapping[str, str] | None = None,
    degrees: bool = False,
    prefix: str | None = None,
) -> tuple[Target, ...]:
    """The waypoints of a file, for ``through`` and ``target`` of `alpha5_model.plan`.

    A CSV table has the columns ``axis_e`` to ``axis_b`` (rad, or in the unit of their
    names: ``axis_e_pos [deg]``), or ``x``, ``y``, ``z`` of the tcp in base_link (m, or
    ``x [mm]``). With ``roll``, ``pitch``, ``yaw`` (rad, or ``[deg]``) or ``qx``,
    ``qy``, ``qz``, ``qw`` a row is a pose of the tcp.

    A JSON or YAML file is a ``trajectory_msgs/JointTrajectory``, or a
    ``FollowJointTrajectory`` goal. Its positions are used; its times, velocities and
    tolerances are not.

    Args:
        path: ``.json``, ``.yaml`` or ``.yml``; any other file is a CSV table.
        arm: Record of the arm, for the ranges and signs of its joints; None is the
            catalogue's.
        joints: Joint of the arm -> its name in the file, as `read_motion` takes it.
        degrees: Whether angles are in degrees if their columns name no unit.
        prefix: Of the names of joints, as `read_motion` takes it.

    Returns:
        One target for each row, in the order of the file.

    Raises:
        InputError: Not a path, or several arms to choose from.
        MissingFileError: No such file.
        FileFormatError: Columns that are missing or not understood, no rows, a value
            that is no finite number, degrees or mm without their unit, a key twice, or
            jaws that are not closed; it names the place.
    """
    named = JointMap(joints)
    in_degrees = flag("degrees", degrees)
    is_json = Path(str(path)).suffix.lower() == ".json"
    if is_json or Path(str(path)).suffix.lower() in (".yaml", ".yml"):
        table = _trajectory(path, is_json)
    else:
        table = read_csv(path, expected=_EXPECTED)
    if not len(table.values):
        raise FileFormatError(path, "has no waypoints", table.head)

    record = chosen_arm(arm)
    columns = {split_unit(name)[0].strip().lower() for name in table.header}
    if columns.isdisjoint(_UNITS):
        _check_names(path, table, named)
        return _joint_positions(path, table, named, in_degrees, prefix, record)
    return _poses(path, table, in_degrees)


def _check_names(path: PathLike, table: Table, named: JointMap) -> None:
    """Refuse columns of which none is a joint's.

    Raises:
        FileFormatError: Such a table.
    """
    names = ", ".join(named.renamed(table.header)).lower()
    if not any(joint in names for joint in JOINT_NAMES[:4]):
        got = ", ".join(table.header)[:200]
        problem = f"expected columns axis_e to axis_b, or x, y, z; got {got}"
        raise FileFormatError(path, problem, table.head)


def _joint_positions(
    path: PathLike,
    table: Table,
    named: JointMap,
    degrees: bool,
    prefix: str | None,
    arm: Alpha5Parameters,
) -> tuple[Target, ...]:
    header = [*named.renamed(table.header), _ROW]
    with_row = table._replace(header=[*table.header, _ROW])
    roles = find_roles(path, with_row, header, prefix, degrees, _ROW, waypoints=True)
    columns = roles.positions
    values = _numbers(path, table, columns)
    scales = [roles.scales.get(column, 1.0) for column in columns]
    signs = arm.signs[: len(columns)] * named.signs(roles.joints)
    positions = values * scales * signs
    if len(columns) > 4:
        closed = arm.joints[4].lower
        is_open = np.abs(positions[:, 4] - closed) > _CLOSED
        if is_open.any():
            problem = f"a plan keeps the jaws closed, axis_a at {closed:g} m: leave "
            problem += f"axis_a out, got {positions[is_open, 4][0]:g} m"
            place = table.place(int(is_open.argmax()), columns[4])
            raise FileFormatError(path, problem, place)
    _check_limits(path, table, roles, positions, arm)
    return tuple(
        Target(kind=JOINTS, value=position, place=_place(path, table, row))
        for row, position in enumerate(positions[:, :4])
    )


def _check_limits(
    path: PathLike,
    table: Table,
    roles: Roles,
    positions: FloatArray,
    arm: Alpha5Parameters,
) -> None:
    """Refuse positions beyond the limits, and say so if they are in degrees.

    Raises:
        FileFormatError: Such a position.
    """
    for k, joint in enumerate(arm.joints[:4]):
        angles = positions[:, k]
        outside = beyond(angles, joint.lower, joint.upper)
        if not outside.any():
            continue
        row = int(outside.argmax())
        value = float(angles[row])
        bound = joint.upper if value > joint.upper else joint.lower
        problem = str(JointLimitError(joint.name, value, bound))
        if plausibility.ANGLE.ranges[0][1] < abs(value):
            problem += "; for degrees name the column axis_e [deg], or give --degrees"
        raise FileFormatError(path, problem, table.place(row, roles.positions[k]))


def _poses(path: PathLike, table: Table, degrees: bool) -> tuple[Target, ...]:
    column_of: dict[str, int] = {}
    scale_of: dict[str, float] = {}
    for number, name in enumerate(table.header):
        stem, unit = split_unit(name)
        stem = stem.strip().lower()
        if stem not in _UNITS or unit not in _UNITS[stem] or stem in column_of:
            problem = (
                f"column {name[:40]!r} is not understood beside x, y, z: expected "
                f"these, of the tcp in base_link (m, or x [mm]), and perhaps "
                f"{', '.join(_ANGLES_OF_POSE)} or {', '.join(_QUATERNION)}, each once"
            )
            raise FileFormatError(path, problem, table.head)
        column_of[stem] = number
        is_in_degrees = degrees and not unit and stem in _ANGLES_OF_POSE
        scale_of[stem] = _UNITS[stem]["deg" if is_in_degrees else unit]

    orientations = [
        group
        for group in (_ANGLES_OF_POSE, _QUATERNION)
        if not column_of.keys().isdisjoint(group)
    ]
    wanted = [*_POINT, *(name for group in orientations for name in group)]
    missing = [name for name in wanted if name not in column_of]
    if missing or len(orientations) > 1:
        lacks = f"no column {missing[0]}" if missing else "two orientations"
        problem = f"{lacks}: expected x, y, z, and one whole orientation or none"
        raise FileFormatError(path, problem, table.head)

    columns = [column_of[name] for name in wanted]
    scales = [scale_of[name] for name in wanted]
    values = _numbers(path, table, columns) * scales
    _check_poses(path, table, values, columns, orientations)
    targets = []
    for row, value in enumerate(values):
        place = _place(path, table, row)
        point, orientation = value[:3], value[3:]
        if not orientations:
            targets.append(Target(kind=POINT, value=point, place=place))
            continue
        rotation = _rotation(orientation)
        pose = transform(rotation, point)
        targets.append(Target(kind=POSE, value=pose, place=place))
    return tuple(targets)


def _rotation(orientation: FloatArray) -> FloatArray:
    """Of roll, pitch and yaw (3,), or of a quaternion x, y, z, w (4,)."""
    if len(orientation) == 3:
        return rotation_from_rpy(orientation)
    # SciPy takes longer to import than the rest of this module.
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_quat(orientation).as_matrix())


def _check_poses(
    path: PathLike,
    table: Table,
    values: FloatArray,
    columns: Sequence[int],
    orientations: Sequence[Sequence[str]],
) -> None:
    """Refuse points in mm, angles in degrees and quaternions of another length.

    Raises:
        FileFormatError: Such a row.
    """
    far = np.abs(values[:, :3]) > _FARTHEST
    checks = [(0, far, "m, for mm name the columns x [mm]")]
    if _ANGLES_OF_POSE in orientations:
        turned = np.abs(values[:, 3:]) > plausibility.ANGLE.ranges[0][1]
        checks.append((3, turned, "rad, for degrees name the columns roll [deg]"))
    if _QUATERNION in orientations:
        length = np.linalg.norm(values[:, 3:], axis=1, keepdims=True)
        stretched = np.abs(length - 1.0) > _UNIT_LENGTH
        checks.append((3, stretched, "a quaternion of length 1"))
    for first, wrong, expected in checks:
        if wrong.any():
            row, column = np.argwhere(wrong)[0].tolist()
            got = ", ".join(f"{value:g}" for value in values[row])
            problem = f"expected {expected}, got {got}"
            place = table.place(row, columns[first + column])
            raise FileFormatError(path, problem, place)


def _place(path: PathLike, table: Table, row: int) -> str:
    """Where a row is, for messages about it."""
    return f"{path}, {table.problem(row, ()).place}"


def _numbers(path: PathLike, table: Table, columns: Sequence[int]) -> FloatArray:
    """The numbers of some columns, (N, k).

    Raises:
        FileFormatError: A row without one of them.
    """
    values = table.values[:, columns]
    bad = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if bad.size:
        problem = table.problem(int(bad[0]), columns)
        raise FileFormatError(path, problem.text, problem.place)
    return values


def _trajectory(path: PathLike, is_json: bool) -> Table:
    """The positions of a JointTrajectory, with the names of its joints.

    Raises:
        FileFormatError: No such message.
    """
    content = read_named(path, _EXPECTED, _LARGEST)
    message = _json(path, content) if is_json else yaml_document(content, path)
    for key in _AROUND:
        if isinstance(message, Mapping) and key in message:
            message = message[key]
    keys = message if isinstance(message, Mapping) else {}
    names, points = keys.get("joint_names"), keys.get("points")
    if not isinstance(names, list) or not isinstance(points, list):
        expected = "joint_names and points, perhaps in trajectory or goal"
        raise FileFormatError(path, f"no JointTrajectory: expected {expected}")
    if not all(isinstance(name, str) for name in names):
        raise FileFormatError(path, "expected texts", "joint_names")

    values = np.empty((len(points), len(names)))
    for number, point in enumerate(points):
        positions = point.get("positions") if isinstance(point, Mapping) else None
        if not isinstance(positions, list) or len(positions) != len(names):
            problem = f"expected {len(names)} positions, one of each joint"
            raise FileFormatError(path, problem, f"points[{number}]")
        values[number] = [_finite_or_nan(position) for position in positions]

    def place(row: int, column: int) -> str:
        return f"points[{row}], {names[column]}"

    def problem_of(row: int, columns: Sequence[int]) -> Problem:
        bad = [k for k in columns if not np.isfinite(values[row, k])]
        if not bad:
            return Problem(f"points[{row}]", "numbers that cannot be used")
        got = repr(points[row]["positions"][bad[0]])[:40]
        return Problem(place(row, bad[0]), f"expected a finite number, got {got}")

    return Table(
        header=names, values=values, place=place, problem=problem_of, head="joint_names"
    )


def _json(path: PathLike, content: bytes) -> Any:
    def distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        found = dict(pairs)
        if len(found) < len(pairs):
            keys = Counter(key for key, _ in pairs)
            twice = keys.most_common(1)[0][0]
            raise FileFormatError(path, f"the key {twice[:40]!r} stands twice")
        return found

    try:
        return json.loads(content, object_pairs_hook=distinct)
    except FileFormatError:
        raise
    except (ValueError, RecursionError) as error:
        raise FileFormatError(path, f"is not JSON: {error}") from None


def _finite_or_nan(number: Any) -> float:
    """A number of a message; NaN for anything else, as tables have it."""
    is_number = isinstance(number, int | float) and not isinstance(number, bool)
    try:
        return float(number) if is_number else np.nan
    except OverflowError:  # an integer of hundreds of digits
        return np.nan
