"""Describe another model's axes as Table 1 does ours, in closed form.

Lengths, twists and zeros follow from the common normals of the axes, as Denavit and
Hartenberg define them [Denavit1955]. Two things do not: lines have no sense, and
neither have common normals. All 64 choices are tried, and the one for which the
author of the model had to get the least wrong is taken. The yaw of the base and the
roll of the wrist do not show in the axes: the base link and the last body decide them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, rotation_about, transform, wrap
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.pose import tool_of
from alpha5_model.proofs.comparison.model import foot
from alpha5_model.proofs.comparison.reduced import (
    Dimensions,
    Reduced,
    X,
    Y,
    Z,
    dimensions_of,
)

#: A frame this close to our base_link was meant to be base_link; a radian of tilt
#: counts as 0.1 m.
SAME_FRAME = 0.05  # [m]
#: So was a frame in which the COM of link_0 is this close to ours.
SAME_COM = 0.02  # [m]
#: A smaller zero counts as ours.
SAME_ZERO = 0.005  # [rad]
#: A smaller error of a dimension is rounding [m, rad].
ROUNDING = 1e-9
#: From this distance on, a misplaced body, tool or shape counts in full.
FULL_SCORE_AT = 0.05  # [m]
#: The wrist is taken as rolled if its body then fits this many times better.
BETTER = 4


@dataclass(frozen=True, eq=False)
class Described:
    """Another model in our terms: ``q_theirs = sign * q_ours + zero``.

    Attributes:
        sign: +1 or -1 per joint, (4,).
        zero: Position of the other joint at our zero, (4,) [rad].
        dimensions: Its lengths and twists.
        changes: Theirs minus ours.
        base: transform_theirs_to_ours of the root frames, (4, 4).
        base_link: Its link whose frame comes closest to our base_link.
        base_link_pose: Pose of that link's frame in our base_link, (4, 4).
        same_base: Whether that frame was meant to be our base_link.
        frames: Poses of our link_0 to link_4 in its root, at its zero, (5, 4, 4). Each
            has its joint's axis as z.
        placed: Poses of its five bodies in these frames, (5, 4, 4). A misplaced joint
            is an error of the dimensions, and does not count here.
        coms: Of the bodies in our link frames, (5, 3) [m].
        inertias: At the COMs, in our link frames, (5, 3, 3) [kg m^2].
        senses: How its axes and common normals were read: +1 or -1 of axis_e, of the
            normal before axis_d, of the other three axes, and of the normal before
            axis_b, (6,).
        rolled: Whether the last body shows a roll, which is then a zero of axis_b.
    """

    sign: FloatArray
    zero: FloatArray
    dimensions: Dimensions
    changes: Dimensions
    base: FloatArray
    base_link: str
    base_link_pose: FloatArray
    same_base: bool
    frames: FloatArray
    placed: FloatArray
    coms: FloatArray
    inertias: FloatArray
    senses: FloatArray
    rolled: bool = False

    def theirs(self, q: FloatArray) -> FloatArray:
        """The other model's joint positions for ours."""
        return self.sign * q + self.zero

    def as_dict(self) -> dict[str, Any]:
        """Base, signs, zeros and dimensions, for JSON."""
        return {
            "base": self.base,
            "base_link": self.base_link,
            "sign": self.sign,
            "zero_rad": self.zero,
            "dimensions": self.dimensions._asdict(),
            "dimension_error": {
                name: change
                for name, change in self.changes._asdict().items()
                if abs(change) > ROUNDING
            },
        }


def describe(theirs: Reduced, record: Alpha5Parameters) -> Described:
    """Describe another model of this arm.

    Args:
        theirs: The other arm.
        record: Ours.
    """
    lines = _lines(theirs)
    readings = []
    for first in itertools.product((1.0, -1.0), repeat=2):
        base = _base(theirs, record, lines, *first)
        for others in itertools.product((1.0, -1.0), repeat=4):
            senses = np.array([*first, *others])
            readings.append(_read(theirs, record, lines, senses, base))
    best = min(readings, key=lambda reading: _oddity(reading, theirs, record))
    return _rolled_or_not(best, theirs, record)


def describe_as_table(theirs: Reduced, record: Alpha5Parameters) -> Described:
    """Describe another model with lengths and twists of the signs of Table 1.

    An arm file can say no others. A joint may have to turn the other way for that.

    Args:
        theirs: The other arm.
        record: Ours.
    """
    best = describe(theirs, record)
    lines = _lines(theirs)
    ours = dimensions_of(record)
    for signs in itertools.product((1.0, -1.0), repeat=5):
        senses = np.array([best.sign[0], *signs])
        base = _base(theirs, record, lines, senses[0], senses[1])
        reading = _read(theirs, record, lines, senses, base)
        own = reading.dimensions
        lengths = own.a_0 * ours.a_0 >= 0 and own.a_2 * ours.a_2 >= 0
        twists = np.abs(reading.changes[4:7]).max() <= math.pi / 2
        if lengths and twists:
            return _rolled_or_not(reading, theirs, record)
    return best


def describe_like(
    theirs: Reduced, record: Alpha5Parameters, like: Described
) -> Described:
    """Describe another model with the senses of an earlier description of it."""
    lines = _lines(theirs)
    base = _base(theirs, record, lines, like.senses[0], like.senses[1])
    reading = _read(theirs, record, lines, like.senses, base)
    return _with_roll(reading, theirs) if like.rolled else reading


def _rolled_or_not(
    reading: Described, theirs: Reduced, record: Alpha5Parameters
) -> Described:
    """The description, with a roll of the wrist if its body shows one."""
    rolled = _with_roll(reading, theirs)
    error = _wrist_error(reading, record)
    fits_rolled = BETTER * _wrist_error(rolled, record) < error
    return rolled if fits_rolled else reading


@dataclass(frozen=True, eq=False)
class _Lines:
    """The axes of a model at its zero as lines in its root, and their common normals.

    Attributes:
        bodies: Poses of the bodies, (5, 4, 4).
        directions: Of axis_e to axis_b, as the model has them, (4, 3).
        on_e, on_d: Where the common normal of these two meets them, (3,) [m].
        on_c, on_b: The same for the last two, (3,) [m].
        normal_0, normal_2: Directions of these normals, (3,).
        upper_arm: Direction from axis_d to axis_c, at a right angle to axis_d, (3,).
    """

    bodies: FloatArray
    directions: FloatArray
    on_e: FloatArray
    on_d: FloatArray
    on_c: FloatArray
    on_b: FloatArray
    normal_0: FloatArray
    normal_2: FloatArray
    upper_arm: FloatArray


def _lines(theirs: Reduced) -> _Lines:
    """The axes at the model's zero."""
    bodies = theirs.zero_poses()
    points = bodies[1:, :3, 3]
    directions = np.einsum("nij,nj->ni", bodies[1:, :3, :3], theirs.axes)
    e, d, c, b = zip(points, directions, strict=True)
    on_d = foot(*d, *e)
    on_c = foot(*c, *b)
    return _Lines(
        bodies=bodies,
        directions=directions,
        on_e=foot(*e, *d),
        on_d=on_d,
        on_c=on_c,
        on_b=foot(*b, *c),
        normal_0=_across(_cross(e[1], d[1]), e[1]),
        normal_2=_across(_cross(c[1], b[1]), c[1]),
        upper_arm=_across(on_c - on_d, d[1]),
    )


def _across(vector: FloatArray, axis: FloatArray) -> FloatArray:
    """The unit vector of the part of a vector that is at a right angle to an axis.

    Any such vector if there is no such part: parallel axes have many normals.
    """
    across = vector - (vector @ axis) * axis
    length = np.linalg.norm(across)
    if length < 1e-9:
        return _across(np.eye(3)[np.abs(axis).argmin()], axis)
    return np.asarray(across / length)


class _Base(NamedTuple):
    """Where our base_link is in another model.

    Attributes:
        pose: Its pose in the model's root, (4, 4).
        link: The model's link that comes closest to it.
        link_pose: Pose of that link in our base_link, (4, 4).
        same: Whether that link was meant to be base_link.
    """

    pose: FloatArray
    link: str
    link_pose: FloatArray
    same: bool


def _base(
    theirs: Reduced,
    record: Alpha5Parameters,
    lines: _Lines,
    sense_of_z: float,
    sense_of_x: float,
) -> _Base:
    """Our base_link, for one choice of the senses of axis_e and the normal behind it.

    Without a base link of theirs the zero of axis_e is taken to be ours.
    """
    z = sense_of_z * lines.directions[0]
    x = rotation_about(z, -record.dh[0].theta_offset) @ (sense_of_x * lines.normal_0)
    base = _frame(x, z, lines.on_e - record.dh[0].d * z)
    link, link_pose, same = _base_link(theirs, record, base)
    if same:
        x, y = link_pose[:2, 0], link_pose[:2, 1]
        along_axis = math.hypot(*x) < 0.5
        yaw = math.atan2(-y[0], y[1]) if along_axis else math.atan2(x[1], x[0])
        turn = transform(rotation_about(Z, yaw))
        base = base @ turn
        link_pose = turn.T @ link_pose
    return _Base(pose=base, link=link, link_pose=link_pose, same=same)


def _read(
    theirs: Reduced,
    record: Alpha5Parameters,
    lines: _Lines,
    senses: FloatArray,
    base: _Base,
) -> Described:
    """The description for one choice of senses.

    Args:
        theirs: The other arm.
        record: Ours.
        lines: Its axes.
        senses: See `Described.senses`.
        base: Our base_link with these senses.
    """
    sign = senses[[0, 2, 3, 4]]
    z = sign[:, None] * lines.directions
    x_0 = senses[1] * lines.normal_0
    x_1 = lines.upper_arm
    x_2 = senses[5] * lines.normal_2
    offsets = np.array([row.theta_offset for row in record.dh[:4]])
    x_3 = rotation_about(z[3], offsets[3]) @ x_2

    # axis_c may be twisted about both axes of the plane that axis_d is normal to.
    y_1 = _cross(z[1], x_1)
    beta_1 = math.asin(np.clip(z[2] @ x_1, -1.0, 1.0))
    alpha_1 = math.atan2(-(z[2] @ y_1), z[2] @ z[1])
    twist = rotation_about(X, alpha_1) @ rotation_about(Y, beta_1)
    elbow_x = np.column_stack([x_1, y_1, z[1]]) @ twist[:, 0]

    upper_arm = lines.on_c - lines.on_d
    dimensions = Dimensions(
        a_0=float((lines.on_d - lines.on_e) @ x_0),
        a_1=float(upper_arm @ x_1),
        a_2=float((lines.on_b - lines.on_c) @ x_2),
        d_1=float(upper_arm @ z[1]),
        alpha_0=_angle(z[0], z[1], x_0),
        alpha_1=alpha_1,
        alpha_2=_angle(z[2], z[3], x_2),
        beta_1=beta_1,
    )
    changes = np.subtract(dimensions, dimensions_of(record))
    changes[4:] = wrap(changes[4:])

    theta = [
        _angle(base.pose[:3, 0], x_0, z[0]),
        _angle(x_0, x_1, z[1]),
        _angle(elbow_x, x_2, z[2]),
        offsets[3],
    ]
    frames = np.array(
        [
            base.pose,
            _frame(x_0, z[0], base.pose[:3, 3]),
            _frame(x_1, z[1], lines.on_d),
            _frame(x_2, z[2], lines.on_c),
            _frame(x_3, z[3], lines.on_b),
        ]
    )
    placed = np.linalg.inv(frames) @ lines.bodies
    if base.same:
        placed[0] = np.linalg.inv(theirs.link_poses[base.link])
        height = base.link_pose[2, 3]
        placed[1] = _by_base_or_shoulder(placed[1], height, theirs, record)
    return Described(
        sign=sign,
        zero=wrap(-sign * (np.array(theta) - offsets)) + 0.0,
        dimensions=dimensions,
        changes=Dimensions(*changes.tolist()),
        base=np.asarray(np.linalg.inv(base.pose)),
        base_link=base.link,
        base_link_pose=base.link_pose,
        same_base=base.same,
        frames=frames,
        placed=placed,
        coms=moved(placed, theirs.com),
        inertias=_turned(placed, theirs.inertia),
        senses=senses,
    )


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """The cross product of two vectors (3,); `np.cross` takes ten times as long."""
    x, y, z = one.tolist()
    u, v, w = other.tolist()
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def _angle(one: FloatArray, other: FloatArray, about: FloatArray) -> float:
    """Angle from one direction to another about an axis [rad]."""
    return math.atan2(float(_cross(one, other) @ about), float(one @ other))


def _turned(placed: FloatArray, tensors: FloatArray) -> FloatArray:
    """Tensors (5, 3, 3) in the axes of the frames that their bodies are placed in."""
    rotations = placed[:, :3, :3]
    return np.asarray(rotations @ tensors @ np.swapaxes(rotations, 1, 2))


def _frame(x: FloatArray, z: FloatArray, origin: FloatArray) -> FloatArray:
    """A frame of two of its axes and its origin, (4, 4)."""
    return transform(np.array([x, _cross(z, x), z]).T, origin)


def _by_base_or_shoulder(
    by_shoulder: FloatArray, height: float, theirs: Reduced, record: Alpha5Parameters
) -> FloatArray:
    """Pose of body 1 in our link_1, placed by the shoulder or by the base.

    The one with the better COM is taken.

    Args:
        by_shoulder: By the shoulder, (4, 4).
        height: How high their base_link is above ours [m].
        theirs: The other arm.
        record: Ours.
    """
    by_base = by_shoulder.copy()
    by_base[2, 3] -= height
    choices = np.array([by_base, by_shoulder])
    off = np.linalg.norm(moved(choices, theirs.com[1]) - record.links[1].com, axis=1)
    return np.asarray(choices[off.argmin()])


# --- The base link --------------------------------------------------------------------


def _base_link(
    theirs: Reduced, record: Alpha5Parameters, base: FloatArray
) -> tuple[str, FloatArray, bool]:
    """Which of their links comes closest to our base_link.

    A link is recognized by its frame, or by the COM of link_0 in its frame if axis_e is
    misplaced, or by its place and name if axis_e is upside down. If several links
    qualify, the one with the right name is taken.

    Args:
        theirs: The other arm.
        record: Ours.
        base: Where our base_link would be in their root, by the axes, (4, 4).

    Returns:
        Its name, its pose in our base_link, and whether it was meant to be base_link.
    """
    to_base = np.linalg.inv(base)
    ranked = []
    for name in theirs.base_path:
        pose = to_base @ theirs.link_poses[name]
        distance = _from_base(pose)
        named = name.lower().endswith(("base", "base_link"))
        in_place = np.linalg.norm(pose[:3, 3]) < SAME_FRAME
        same = distance < SAME_FRAME or (named and bool(in_place))
        if theirs.mass[0]:
            to_link = np.asarray(np.linalg.inv(theirs.link_poses[name]), np.float64)
            com = moved(to_link, theirs.com[0])
            error = float(np.linalg.norm(com - record.links[0].com))
            if error < SAME_COM:
                same = True
                distance = min(distance, SAME_FRAME + error)
        forward = pose[0, 0]
        rank = (not (same and named), round(distance - 1e-3 * forward, 6))
        ranked.append((rank, name, pose, same))
    _, name, pose, same = min(ranked, key=lambda one: one[0])
    return name, pose, same


def _from_base(pose: FloatArray) -> float:
    """Distance of a frame (4, 4) from our base_link, whatever its yaw [m]."""
    tilt = math.acos(np.clip(pose[2, 2], -1, 1))
    return float(np.linalg.norm(pose[:3, 3]) + 0.1 * tilt)


# --- Choosing -------------------------------------------------------------------------


def _oddity(
    reading: Described, theirs: Reduced, record: Alpha5Parameters
) -> tuple[float, float]:
    """A score of what the model's author would have had to get wrong.

    A reversed joint or a shifted zero scores 1, a distance to the other side 2, an axis
    turned by pi 4. A base that is displaced or upside down scores up to 6, misplaced
    bodies up to 4 together, misplaced collision shapes the same, and a misplaced tool
    frame up to 6. Of equal scores the one with the smaller zeros is taken.
    """
    score = 30 * min(0.2, _from_base(reading.base_link_pose))
    score += float(np.signbit(reading.sign).sum())
    score += float((np.abs(reading.zero[1:]) > SAME_ZERO).sum())
    ours = dimensions_of(record)
    for name in ("a_0", "a_2"):
        score += 2 * (getattr(reading.dimensions, name) * getattr(ours, name) < 0)
    for name in ("alpha_0", "alpha_1", "alpha_2"):
        score += 4 * (abs(getattr(reading.changes, name)) > math.pi / 2)

    coms = np.array([link.com for link in record.links])
    off_coms = reading.coms - coms
    score += 4 * _misplacement(off_coms[2:][theirs.mass[2:] > 0])

    shapes = moved(reading.placed, theirs.shape_centres)
    off_shapes = shapes - np.array([link.cob for link in record.links])
    score += 4 * _misplacement(off_shapes[1:][np.isfinite(off_shapes[1:, 0])])

    if theirs.tool:
        frame = theirs.link_poses[theirs.tool]
        tool = moved(reading.placed[4], frame[:3, 3])
        score += 6 * _misplacement((tool - tool_of(record).position)[None])
    return round(score, 6), float(np.abs(reading.zero).sum())


def _misplacement(off: FloatArray) -> float:
    """Mean score of points that are off by (N, 3) [m], from 0 to 1; 0 without any."""
    if not len(off):
        return 0.0
    scores = np.linalg.norm(off, axis=1) / FULL_SCORE_AT
    return float(np.minimum(1.0, scores).mean())


def _with_roll(reading: Described, theirs: Reduced) -> Described:
    """The description with the roll of their last body as a zero of axis_b."""
    wrist = reading.placed[4]
    roll = math.atan2(wrist[1, 0], wrist[0, 0])
    turn = transform(rotation_about(Z, roll))
    frames = reading.frames.copy()
    placed = reading.placed.copy()
    frames[4] = frames[4] @ turn
    placed[4] = turn.T @ placed[4]
    shift = np.array([0.0, 0.0, 0.0, roll])
    return replace(
        reading,
        zero=wrap(reading.zero - reading.sign * shift),
        frames=frames,
        placed=placed,
        coms=moved(placed, theirs.com),
        inertias=_turned(placed, theirs.inertia),
        rolled=True,
    )


def _wrist_error(reading: Described, record: Alpha5Parameters) -> float:
    """Error of the last body as one number, in second moments [kg m^2]."""
    ours = record.links[4]
    off = reading.coms[4] - ours.com
    tensor = np.abs(reading.inertias[4] - ours.inertia).max()
    return float(ours.mass * (off @ off) + tensor)
