"""Collision bodies: the primitives that URDF knows, around the drawn bodies of each link."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from alpha5_model.checks import FloatArray, choice
from alpha5_model.description.bodies.dimensions import (
    BASE,
    FINGER,
    RADIUS,
    SHELL,
    UPPER_ARM,
    WRIST,
)
from alpha5_model.parameters import JawParameters, parameters

Triple = tuple[float, float, float]
_TO_X: Triple = (0.0, math.pi / 2, 0.0)
_TO_Y: Triple = (-math.pi / 2, 0.0, 0.0)


@dataclass(frozen=True)
class Primitive:
    """One collision shape in its link's frame.

    Attributes:
        kind: ``box``, ``cylinder`` (along its own z) or ``sphere``.
        size: Edges x, y, z; radius and length; or radius [m].
        xyz: Its centre [m].
        rpy: Fixed-axis roll, pitch, yaw [rad].
    """

    kind: str
    size: tuple[float, ...]
    xyz: Triple
    rpy: Triple


def collision_primitives(gripper: str = "jaws") -> dict[str, tuple[Primitive, ...]]:
    """Primitives of each link.

    Together they enclose the drawn body and stay within 3 mm of it; bodies that turn against each
    other at a joint overlap, so adjacent pairs are to be left out (`alpha5_model.description.srdf`).

    Args:
        gripper: ``jaws`` has ``finger_1`` and ``finger_2`` as links of their own, in ``locked`` they
            belong to ``link_4``, closed.

    Raises:
        UnknownNameError: Another gripper.
    """
    shapes = dict(_with_jaws())
    if choice("gripper", gripper, ("locked", "jaws")) == "locked":
        jaws = parameters(()).jaws
        height = -(jaws.collar_base + jaws.pivot_height)
        closed = list(shapes["link_4"])
        for name, x, roll in (
            ("finger_1", -jaws.pivot_offset, -math.pi / 2),
            ("finger_2", jaws.pivot_offset, math.pi / 2),
        ):
            pose = _pose((x, 0.0, height), (roll, 0.0, 0.0))
            closed += [_moved(shape, pose) for shape in shapes.pop(name)]
        shapes["link_4"] = tuple(closed)
    return shapes


@cache
def _with_jaws() -> dict[str, tuple[Primitive, ...]]:
    arm = parameters(())
    shoulder = _matrix(
        [[-1, 0, 0], [0, 0, -1], [0, -1, 0]], (SHELL.axes_apart, 0, arm.dh[0].d * 1e3)
    )
    elbow = _matrix([[1, 0, 0], [0, -1, 0], [0, 0, -1]], (0, 0, 0))
    slant = _pose((0.0, 0.0, 0.0), (0.0, 0.0, -arm.theta_c))
    turned = _pose((0.0, 0.0, 0.0), (0.0, 0.0, math.pi))
    in_mm = {
        "link_0": _base(),
        "link_1": [_moved(shape, shoulder) for shape in _shell()],
        "link_2": [_moved(shape, slant) for shape in _upper_arm()],
        "link_3": [_moved(shape, elbow) for shape in _shell()],
        "link_4": _wrist(arm.jaws),
        "finger_1": _finger(arm.jaws),
        "finger_2": [_moved(shape, turned) for shape in _finger(arm.jaws)],
    }
    return {name: tuple(map(_in_metres, shapes)) for name, shapes in in_mm.items()}


def _base() -> list[Primitive]:
    d = BASE
    width = 2 * d.foot_half_width
    run, rise = d.foot_slope - d.foot_front, -17.0 - d.foot_face
    slope, depth = math.hypot(run, rise), 10.0
    angle = math.atan2(rise, run)
    middle = np.array([d.foot_front + run / 2, d.foot_face + rise / 2])
    x, y = middle + depth / 2 * np.array([-math.sin(angle), math.cos(angle)])
    return [
        _cylinder(RADIUS, d.rear, -d.relief, "x"),
        _cylinder(RADIUS, d.hub_low, d.hub_high, "z"),
        _box((-d.relief, -RADIUS + 1.0, -13.0), (-6.0, RADIUS - 1.0, d.hub_high)),
        _box((d.rear, d.foot_face, -d.foot_half_width), (d.foot_front, -4.0, d.foot_half_width)),
        Primitive("box", (slope, depth, width), (float(x), float(y), 0.0), (0.0, 0.0, angle)),
    ]


def _shell() -> list[Primitive]:
    d = SHELL
    wall, sides = 8.0, 5
    turn = math.pi / sides
    inner, outer = (RADIUS - wall) * math.cos(turn / 2), float(RADIUS)
    staves = []
    for i in range(sides):
        # From straight up the z axis, over +x, to straight down.
        angle = (i + 0.5) * turn - math.pi / 2
        middle = (inner + outer) / 2
        staves.append(
            Primitive(
                "box",
                (outer - inner, d.floor - d.rim, 2 * outer * math.tan(turn / 2)),
                (
                    d.axes_apart + middle * math.cos(angle),
                    (d.floor + d.rim) / 2,
                    middle * math.sin(angle),
                ),
                (0.0, -angle, 0.0),
            )
        )
    return [
        _cylinder(RADIUS, d.cheek_inner, d.cheek_outer, "z"),
        _cylinder(RADIUS, d.floor, d.collar_face, "y", (d.axes_apart, 0.0, 0.0)),
        _box((7.0, d.rim, d.cheek_inner), (d.axes_apart + 1.0, d.floor, d.cheek_outer)),
        *staves,
    ]


def _upper_arm() -> list[Primitive]:
    d = UPPER_ARM
    middle, end = d.drop / 2, d.reach - d.tube_start
    neck = ((11.0, 4.0, -19.0), (d.tube_start, d.neck, 19.0))
    shapes = [_cylinder(RADIUS, d.tube_start, end, "x", (0.0, middle, 0.0))]
    shapes += [
        _cylinder(RADIUS, d.barrel_low, d.barrel_high, "z", (x, y, 0.0))
        for x, y in ((0.0, 0.0), (d.reach, d.drop))
    ]
    low, high = neck
    shapes.append(_box(low, high))
    shapes.append(
        _box(
            (d.reach - high[0], d.drop - high[1], low[2]),
            (d.reach - low[0], d.drop - low[1], high[2]),
        )
    )
    return shapes


def _wrist(jaws: JawParameters) -> list[Primitive]:
    end = jaws.collar_base * 1e3 + WRIST.collar_height
    return [_cylinder(RADIUS, -end, -WRIST.tube_start, "z")]


def _finger(jaws: JawParameters) -> list[Primitive]:
    from alpha5_model.description.bodies.finger import centre_line

    width, sections = jaws.finger_width * 1e3, 5
    shapes = [_cylinder(FINGER.lug_radius, -width / 2, width / 2, "z")]
    ends = np.linspace(0.0, 1.0, sections + 1)
    for low, high in zip(ends[:-1], ends[1:], strict=True):
        points, half = centre_line(np.linspace(low, high, 15))
        along = (points[-1] - points[0]) / np.linalg.norm(points[-1] - points[0])
        across = np.array([-along[1], along[0]])
        offsets = (points - points[0]) @ across
        bottom, top = float((offsets - half).min()), float((offsets + half).max())
        length = float((points[-1] - points[0]) @ along) + 1.0
        centre = points[0] + along * (length - 1.0) / 2 + across * (bottom + top) / 2
        shapes.append(
            Primitive(
                "box",
                (length, top - bottom, width),
                (float(centre[0]), float(centre[1]), 0.0),
                (0.0, 0.0, math.atan2(along[1], along[0])),
            )
        )
    return shapes


def _cylinder(
    radius: float, low: float, high: float, axis: str, at: Triple = (0.0, 0.0, 0.0)
) -> Primitive:
    middle = (low + high) / 2
    step = {"x": (middle, 0.0, 0.0), "y": (0.0, middle, 0.0), "z": (0.0, 0.0, middle)}[axis]
    turn = {"x": _TO_X, "y": _TO_Y, "z": (0.0, 0.0, 0.0)}[axis]
    x, y, z = (float(a + s) for a, s in zip(at, step, strict=True))
    return Primitive("cylinder", (float(radius), float(high - low)), (x, y, z), turn)


def _box(low: Triple, high: Triple) -> Primitive:
    size = tuple(float(h - l) for l, h in zip(low, high, strict=True))
    x, y, z = (float(h + l) / 2 for l, h in zip(low, high, strict=True))
    return Primitive("box", size, (x, y, z), (0.0, 0.0, 0.0))


def _in_metres(shape: Primitive) -> Primitive:
    """Millimetres to metres, to a nanometre; angles to 1e-12 rad."""
    x, y, z = (round(c * 1e-3, 9) + 0.0 for c in shape.xyz)
    roll, pitch, yaw = (round(a, 12) + 0.0 for a in shape.rpy)
    size = tuple(round(s * 1e-3, 9) for s in shape.size)
    return Primitive(shape.kind, size, (x, y, z), (roll, pitch, yaw))


def _moved(shape: Primitive, pose: FloatArray) -> Primitive:
    """The shape in another frame, ``pose`` (4, 4) maps its own frame to that one."""
    x, y, z, *_ = map(float, (pose @ _pose(shape.xyz, shape.rpy))[:3, 3])
    rotation = (pose @ _pose(shape.xyz, shape.rpy))[:3, :3]
    return Primitive(shape.kind, shape.size, (x, y, z), _roll_pitch_yaw(rotation))


def _pose(xyz: Triple, rpy: Triple) -> FloatArray:
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return _matrix(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ],
        xyz,
    )


def _matrix(rotation: object, xyz: Triple) -> FloatArray:
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, xyz
    return pose


def _roll_pitch_yaw(r: FloatArray) -> Triple:
    """Fixed-axis angles; where the pitch is +-pi/2, the roll is taken as zero."""
    pitch = math.atan2(-r[2, 0], math.hypot(r[0, 0], r[1, 0]))
    if math.hypot(r[0, 0], r[1, 0]) < 1e-9:
        return (0.0, pitch, math.atan2(-r[0, 1], r[1, 1]))
    return (math.atan2(r[2, 1], r[2, 2]), pitch, math.atan2(r[1, 0], r[0, 0]))
