"""Shapes and labels: bodies, obstacles, frames, forces, current, IK solutions."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, pose, transform
from alpha5_model.description.reading import urdf_shapes
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.dynamics.arm import Arm
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import BRANCHES, Solutions, inverse_kinematics
from alpha5_model.kinematics.reach import distance_to_reach
from alpha5_model.numbers.rigid_body import AttachedBody
from alpha5_model.planning.obstacles import Obstacle
from alpha5_model.viewer.poses import link_poses
from alpha5_model.viewer.scene import (
    ARROWS,
    LOOK,
    WORLD,
    Color,
    Label,
    Load,
    Mean,
    Payload,
    Rigid,
    Shape,
    Water,
    WeightedPoint,
)
from alpha5_model.viewer.shapes import (
    arrow,
    ball,
    cylinder,
    drawn,
    faceted,
    primitive,
    triad,
)

#: Length of an arrow per force [m/N].
ARROW_SCALE = ARROWS["force"]
#: Length of the axes of a frame [m].
_AXES = 0.05
_COLORS: dict[str, Color] = {
    name: (red, green, blue) for name, (red, green, blue) in LOOK["colors"].items()
}
#: Opacity of a ghost within the joint limits, and of one beyond them; as on the page.
_OPACITY = 0.42
_OPACITY_BEYOND = 0.16
#: Joint positions [rad] and entries of poses that differ by less are the same.
_SAME = 1e-6
_ball = cache(ball)


def bodies(urdf: str, folder: str) -> Iterator[Shape]:
    """The visual shapes of a URDF, whose file names start at a folder."""
    for shape in urdf_shapes(urdf, "visual"):
        red, green, blue = shape.color[:3]
        dark = max(red, green, blue) < 0.4
        yield Shape(
            group="bodies",
            name=f"{shape.link}/part_{shape.index}",
            anchor=Rigid(shape.link),
            mesh=drawn(shape, folder),
            color=(red, green, blue),
            # Only highlights show the form of a dark body.
            shine=0.9 if dark else 0.4,
        )


def spacer(bodies: Sequence[Shape], length: float) -> Iterator[Shape]:
    """A cylinder of the wrist's diameter, where spacers moved the jaws away from it.

    Args:
        bodies: All bodies; the first of link_4 is the wrist.
        length: How far the jaws are moved along -z of link_4 [m].
    """
    if not length:
        return
    wrist = next(body for body in bodies if body.name.startswith("link_4/"))
    x, y, z = wrist.mesh.vertices.T
    middle = transform(translation=(0.0, 0.0, z.min() - length / 2))
    between = cylinder(np.hypot(x, y).max(), length).moved(middle)
    yield replace(wrist, name="link_4/spacer", mesh=between)


def collision_bodies(urdf: str, folder: str) -> Iterator[Shape]:
    """The collision shapes of a URDF, whose file names start at a folder."""
    for shape in urdf_shapes(urdf, "collision"):
        yield Shape(
            group="collision",
            name=f"{shape.link}_{shape.index}",
            anchor=Rigid(shape.link),
            mesh=drawn(shape, folder),
            color=_COLORS["orange"],
            opacity=0.35,
        )


def frames(
    tree: Sequence[UrdfJoint], beyond: Mapping[str, bool]
) -> Iterator[Shape | Label]:
    """Axes of the link frames, drawn over the bodies; names of joints and frames.

    Args:
        tree: Joints from the base to the tip.
        beyond: Name of each joint that can be moved -> whether it is beyond a limit.
    """
    axes = triad(_AXES, 0.0013)
    tip_of_x = transform(translation=(_AXES, 0.0, 0.0))
    base = tree[0].parent
    yield Shape(group="frames", name=base, anchor=Rigid(base), mesh=axes, on_top=1)
    for joint in tree:
        link = joint.child
        yield Shape(group="frames", name=link, anchor=Rigid(link), mesh=axes, on_top=1)
        if link == "tcp":
            yield Label("bodies", "tcp", Rigid(link))
            continue
        yield Label("frames", link, Rigid(link, tip_of_x), (0.1, 0.3, 0.6))
        if joint.name in beyond:
            yield _joint_label(joint, beyond[joint.name])


def attached(bodies: Iterable[AttachedBody]) -> Iterator[Label]:
    """Names of attached bodies at their places; what they look like is not known."""
    for body in bodies:
        place = transform(body.rotation, body.position)
        yield Label("bodies", body.name, Rigid(body.link, place))


def _joint_label(joint: UrdfJoint, beyond: bool) -> Label:
    if beyond:
        text = f"{joint.name}, beyond its limit"
        return Label("bodies", text, Rigid(joint.child), _COLORS["red"])
    return Label("bodies", joint.name, Rigid(joint.child))


class _Center(NamedTuple):
    """A kind of centre of the bodies, with the force that acts there.

    Attributes:
        group: Of its balls and label.
        point: The centre of a load, (3,) [m].
        share: Its weight in the mean of several loads.
        force: Name of the force, which is the group of its arrows.
        amount: The force of a load [N].
        text: Of the label of the whole arm's centre.
        ball: The two colours of its balls.
        ink: Colour of the label.
        arrow: Colour of the arrows.
        sense: 1 if the force acts along gravity, -1 if against it.
    """

    group: str
    point: Callable[[Load], FloatArray]
    share: Callable[[Load], float]
    force: str
    amount: Callable[[Load], float]
    text: str
    ball: tuple[str, str]
    ink: str
    arrow: str
    sense: float


_CENTERS = (
    _Center(
        group="com",
        point=lambda load: load.com,
        share=lambda load: load.mass,
        force="weight",
        amount=lambda load: load.weight,
        text="centre of mass",
        ball=("yellow", "black"),
        ink="ochre",
        arrow="red",
        sense=1.0,
    ),
    _Center(
        group="cob",
        point=lambda load: load.cob,
        share=lambda load: load.volume,
        force="buoyancy",
        amount=lambda load: load.buoyancy,
        text="centre of buoyancy",
        ball=("blue", "white"),
        ink="blue",
        arrow="sky",
        sense=-1.0,
    ),
)


def centers(gravity: FloatArray, loads: Sequence[Load]) -> Iterator[Shape | Label]:
    """Balls at the centres of the bodies and of the arm, with arrows of the forces.

    Args:
        gravity: Acceleration in the world, (3,) [m/s^2].
        loads: Weight and buoyancy of the bodies.
    """
    strength = np.linalg.norm(gravity)
    down = gravity / strength if strength else gravity
    for kind in _CENTERS:
        for i, load in enumerate(loads):
            yield from _center(kind, f"load_{i}", [load], down, whole=False)
        yield from _center(kind, "arm", loads, down, whole=True)


def _center(
    kind: _Center, name: str, loads: Sequence[Load], down: FloatArray, whole: bool
) -> Iterator[Shape | Label]:
    """Ball and arrow at the common centre of some loads; labels for the whole arm."""
    points = tuple(
        WeightedPoint(link=load.link, weight=kind.share(load), point=kind.point(load))
        for load in loads
        if kind.share(load)
    )
    if not points:
        return
    at = Mean(points)
    first, second = (_COLORS[color] for color in kind.ball)
    sphere = _ball(0.0095 if whole else 0.0048, first, second)
    yield Shape(group=kind.group, name=name, anchor=at, mesh=sphere, on_top=2)
    if whole:
        yield Label(kind.group, kind.text, at, _COLORS[kind.ink])

    force = sum(kind.amount(load) for load in loads)
    if not force:
        return
    tip = ARROW_SCALE * kind.sense * force * down
    yield Shape(
        group=kind.force,
        name=name,
        anchor=at,
        mesh=arrow(tip, 0.004 if whole else 0.0022),
        color=_COLORS[kind.arrow],
        on_top=1,
    )
    if whole:
        red, green, blue = _COLORS[kind.arrow]
        darker = (0.8 * red, 0.8 * green, 0.8 * blue)
        text = f"{kind.force} {force:.2f} N"
        yield Label(kind.force, text, Mean(points, tip), darker)


def obstacles(bodies: Iterable[Obstacle], root: str) -> Iterator[Shape | Label]:
    """Fixed bodies beside the arm, with their names.

    Args:
        bodies: In the frame of the root.
        root: Name of the base link.
    """
    for number, body in enumerate(bodies):
        if isinstance(body.shape, Primitive):
            placement = pose(body.shape.xyz, body.shape.rpy)
            mesh = primitive(body.shape.kind, body.shape.size).moved(placement)
            middle = placement
        else:
            mesh = faceted(body.shape.vertices, body.shape.triangles)
            middle = transform(translation=body.shape.vertices.mean(axis=0))
        yield Shape(
            group="obstacles",
            name=f"obstacle_{number}",
            anchor=Rigid(root),
            mesh=mesh,
            color=_COLORS["grey"],
            opacity=0.6,
        )
        yield Label("obstacles", body.name, Rigid(root, middle))


def current_arrow(water_velocity: FloatArray, frame: str) -> Iterator[Shape | Label]:
    """An arrow beside the base along the current (3,) [m/s] of a frame."""
    teal = _COLORS["teal"]
    beside_base = Rigid(frame, transform(translation=LOOK["current_at"]))
    speed = float(np.linalg.norm(water_velocity))
    tip = ARROWS["current"] * water_velocity
    mesh = arrow(tip, 0.004) if speed else _ball(0.004, teal, teal)
    yield Shape(
        group="current",
        name="arrow",
        anchor=beside_base,
        mesh=mesh,
        color=teal,
        on_top=1,
    )
    text = f"current {speed:.3g} m/s, load estimated"
    yield Label("current", text, beside_base, teal)


def payload(held: Payload, water: Water) -> Iterator[Shape | Label]:
    """A ball at the tcp for what the arm holds, with its net force and a label."""
    if not held.mass:
        return
    at = WeightedPoint(link="tcp", weight=1.0, point=np.array(held.com))
    color = _COLORS["orange"]
    sphere = _ball(payload_radius(held), color, color)
    yield Shape(group="payload", name="body", anchor=Mean((at,)), mesh=sphere)

    force = (held.mass - water.density * held.volume) * water.gravity
    strength = float(np.linalg.norm(force))
    if strength:
        yield Shape(
            group="payload",
            name="force",
            anchor=Mean((at,)),
            mesh=arrow(ARROW_SCALE * force, 0.004),
            color=color,
            on_top=1,
        )
    text = f"payload {1e3 * held.mass:.0f} g, {strength:.2f} N"
    yield Label("payload", text, Mean((at,), ARROW_SCALE * force), _COLORS["ochre"])


def payload_radius(held: Payload) -> float:
    """Radius of the ball that is drawn [m]: of its volume, or as small as a centre."""
    of_volume = (held.volume * 3 / (4 * np.pi)) ** (1 / 3)
    return max(float(of_volume), float(LOOK["payload_radius"]))


class _GhostLook(NamedTuple):
    """Colour and opacity of a ghost."""

    color: Color
    opacity: float


def ghosts(
    arm: Arm,
    tree: Sequence[UrdfJoint],
    body_shapes: Sequence[Shape],
    q: FloatArray,
    target: FloatArray,
) -> Iterator[Shape | Label]:
    """The target, and the other solutions of its inverse kinematics as ghosts.

    A ghost has the arm's wrist angle, base and jaws. A link where the arm, or another
    ghost, has it is not drawn again.

    Args:
        arm: The arm.
        tree: Its joints from the base to the tip.
        body_shapes: Its bodies.
        q: Its joint positions (nq,).
        target: Position of the tcp in base_link, (3,) [m].
    """
    first_joint = len(q) - len(arm.joint_names)
    angles = slice(first_joint, first_joint + 4)
    solutions = inverse_kinematics(target, q[angles][3], arm=arm.parameters)
    collides = solutions.collides
    earlier = [link_poses(arm, tree, q)]
    for i in np.flatnonzero(solutions.exists):
        if _turn(solutions.q[i], q[angles]) < _SAME:
            continue
        solution = q.copy()
        solution[angles] = solutions.q[i]
        poses = link_poses(arm, tree, solution)
        seen = [link for link in poses if not _is_drawn(link, poses, earlier)]
        earlier.append(poses)

        allowed = bool(solutions.within_limits[i])
        touches = allowed and bool(collides[i])
        look = _GhostLook(
            color=_COLORS["red"] if touches else tuple(LOOK["ghosts"][i]),
            opacity=_OPACITY if allowed else _OPACITY_BEYOND,
        )
        yield from _ghost(BRANCHES[i], look, body_shapes, poses, seen)

        elbow = transform(translation=poses["link_3"][:3, 3])
        text = _ghost_label(BRANCHES[i], allowed, touches)
        yield Label("ghosts", text, Rigid(WORLD, elbow), tuple(LOOK["ghosts"][i]))
    base = link_poses(arm, tree, q)[tree[0].parent]
    point = moved(base, target)
    yield from _target(point, _missed(solutions))


def _missed(solutions: Solutions) -> str:
    """What the label says of a target that is out of reach; empty if it is in reach."""
    if Geometry.of(solutions.arm).tool_on_axis:
        away = float(distance_to_reach(solutions.position, arm=solutions.arm))
        return f", out of reach by {1e3 * away:.1f} mm" if away else ""
    # How far the tool point stays away is not known for a tool beside the axis.
    return "" if solutions.within_limits.any() else ", out of reach"


def _ghost_label(branch: str, allowed: bool, touches: bool) -> str:
    """Name of a branch, and why the arm cannot go there; as the page has it."""
    name = branch.replace("_", " ")
    if touches:
        return f"{name}, collides"
    return name if allowed else f"{name}, beyond the limits"


def _turn(one: FloatArray, other: FloatArray) -> float:
    """Largest difference of two joint positions, full turns aside [rad]."""
    difference = np.remainder(one - other + np.pi, 2 * np.pi) - np.pi
    return float(np.abs(difference).max())


def _is_drawn(
    link: str,
    poses: Mapping[str, FloatArray],
    earlier: Sequence[Mapping[str, FloatArray]],
) -> bool:
    """Whether the arm or an earlier ghost has this link at the same pose."""
    return any(np.abs(poses[link] - other[link]).max() < _SAME for other in earlier)


def _ghost(
    branch: str,
    look: _GhostLook,
    body_shapes: Sequence[Shape],
    poses: Mapping[str, FloatArray],
    seen: Collection[str],
) -> Iterator[Shape]:
    """Copies of the bodies of some links, at some poses."""
    for body in body_shapes:
        if not isinstance(body.anchor, Rigid) or body.anchor.link not in seen:
            continue
        yield Shape(
            group="ghosts",
            name=f"{branch}/{body.name}",
            anchor=Rigid(WORLD, poses[body.anchor.link]),
            mesh=body.mesh,
            color=look.color,
            opacity=look.opacity,
        )


def _target(point: FloatArray, missed: str) -> Iterator[Shape | Label]:
    """A target at a point of the world (3,), and what is said of a missed one."""
    at = Rigid(WORLD, transform(translation=point))
    sphere = ball(0.008, _COLORS["pink"], _COLORS["white"])
    yield Shape(group="ghosts", name="target", anchor=at, mesh=sphere, on_top=2)
    yield Label("ghosts", f"target{missed}", at, (0.75, 0.05, 0.4))
