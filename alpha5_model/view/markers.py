"""What explains the arm: frames, centres of mass and buoyancy, forces as arrows, ghosts of IK solutions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.errors import ShapeError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.view.arm_poses import link_poses
from alpha5_model.view.scene import WORLD, Label, Load, Mean, Rigid, Shape
from alpha5_model.view.shapes import arrow, ball, triad

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

#: Length of an arrow per force [m/N].
ARROW_SCALE = 0.015
_YELLOW, _BLACK = (0.98, 0.80, 0.10), (0.10, 0.10, 0.10)
_BLUE, _WHITE = (0.10, 0.45, 0.85), (0.97, 0.97, 0.97)
_RED, _SKY = (0.80, 0.17, 0.15), (0.16, 0.55, 0.86)


def loads_of(arm: Arm, tree: Sequence[UrdfJoint]) -> tuple[Load, ...]:
    """Weight and buoyancy on each joint of the model, payloads included."""
    carrier = {joint.name: joint.child for joint in tree}
    strength = float(np.linalg.norm(arm.model.gravity.linear))
    loads = []
    for name, inertia in zip(arm.model.names, arm.model.inertias, strict=True):
        displaced = [d for d in arm.displacements if d.joint == name and d.volume > 0.0]
        volume = sum(d.volume for d in displaced)
        if inertia.mass == 0.0 and volume == 0.0:
            continue
        cob = sum((d.volume * np.asarray(d.cob) for d in displaced), np.zeros(3))
        loads.append(
            Load(
                # the universe and the free-flyer carry the base
                link=carrier.get(name, tree[0].parent),
                mass=inertia.mass,
                com=np.array(inertia.lever),
                volume=volume,
                cob=cob / volume if volume else np.array(inertia.lever),
                weight=inertia.mass * strength,
                buoyancy=arm.fluid_density * volume * strength,
            )
        )
    return tuple(loads)


def frame_shapes(tree: Sequence[UrdfJoint]) -> list[Shape]:
    """Axes of every link frame, over the bodies."""
    links = [tree[0].parent, *(joint.child for joint in tree)]
    mesh = triad(0.05, 0.0013)
    return [Shape("frames", link, Rigid(link), mesh, on_top=1) for link in links]


def frame_labels(tree: Sequence[UrdfJoint], sliders: Sequence[str]) -> list[Label]:
    """Names of joints and of link frames."""
    labels = [
        Label("bodies", joint.name, Rigid(joint.child)) for joint in tree if joint.name in sliders
    ]
    frames = [joint.child for joint in tree if joint.child != "tcp"]
    beside = np.eye(4)
    beside[0, 3] = 0.05  # the tip of x
    labels += [Label("frames", link, Rigid(link, beside), (0.1, 0.3, 0.6)) for link in frames]
    return [*labels, Label("bodies", "tcp", Rigid("tcp"))]


def center_shapes(loads: Sequence[Load]) -> list[Shape]:
    """Balls at the centres of mass and buoyancy, of each body and, larger, of the whole arm."""
    shapes = []
    for kind, colors in (("com", (_YELLOW, _BLACK)), ("cob", (_BLUE, _WHITE))):
        small, large = ball(0.0048, *colors), ball(0.0095, *colors)
        for i, load in enumerate(loads):
            point = load.com if kind == "com" else load.cob
            if load.mass if kind == "com" else load.volume:
                anchor = Mean(((load.link, 1.0, point),))
                shapes.append(Shape(kind, f"load_{i}", anchor, small, on_top=2))
        if _whole(loads, kind).points:
            shapes.append(Shape(kind, "arm", _whole(loads, kind), large, on_top=2))
    return shapes


def center_labels(loads: Sequence[Load]) -> list[Label]:
    """Names of the whole arm's centres."""
    names = {"com": ("centre of mass", (0.45, 0.33, 0.0)), "cob": ("centre of buoyancy", _BLUE)}
    return [
        Label(kind, text, _whole(loads, kind), color)
        for kind, (text, color) in names.items()
        if _whole(loads, kind).points
    ]


def force_shapes(arm: Arm, loads: Sequence[Load]) -> list[Shape]:
    """Arrows of weight and buoyancy to scale, of each body and, thicker, of the whole arm."""
    shapes = []
    for i, load in enumerate(loads):
        for kind, force, point, color in _pair(arm, load):
            anchor = Mean(((load.link, 1.0, point),))
            mesh = arrow(ARROW_SCALE * force, 0.0022)
            shapes.append(Shape(kind, f"load_{i}", anchor, mesh, color, on_top=1))
    for kind, force, anchor, color in _totals(arm, loads):
        mesh = arrow(ARROW_SCALE * force, 0.004)
        shapes.append(Shape(kind, "arm", anchor, mesh, color, on_top=1))
    return shapes


def force_labels(arm: Arm, loads: Sequence[Load]) -> list[Label]:
    """The whole arm's forces in figures, at the tips of their arrows."""
    return [
        Label(
            kind,
            f"{kind} {np.linalg.norm(force):.2f} N",
            Mean(anchor.points, ARROW_SCALE * force),
            color,
        )
        for kind, force, anchor, color in _totals(arm, loads)
    ]


def _whole(loads: Sequence[Load], kind: str) -> Mean:
    """Anchor at the centre of mass (``com``) or of buoyancy (``cob``) of the whole arm."""
    if kind == "com":
        return Mean(tuple((load.link, load.mass, load.com) for load in loads if load.mass))
    return Mean(tuple((load.link, load.volume, load.cob) for load in loads if load.volume))


def _pair(arm: Arm, load: Load) -> list[tuple[str, FloatArray, FloatArray, Any]]:
    down = _down(arm)
    pairs = [
        ("weight", load.weight * down, load.com, _RED),
        ("buoyancy", -load.buoyancy * down, load.cob, _SKY),
    ]
    return [pair for pair in pairs if pair[1].any()]


def _totals(arm: Arm, loads: Sequence[Load]) -> list[tuple[str, FloatArray, Mean, Any]]:
    down = _down(arm)
    weight, lift = sum(load.weight for load in loads), sum(load.buoyancy for load in loads)
    totals = [
        ("weight", weight * down, _whole(loads, "com"), tuple(0.8 * c for c in _RED)),
        ("buoyancy", -lift * down, _whole(loads, "cob"), tuple(0.8 * c for c in _SKY)),
    ]
    return [total for total in totals if total[1].any()]


def _down(arm: Arm) -> FloatArray:
    gravity = np.array(arm.model.gravity.linear)
    strength = np.linalg.norm(gravity)
    down: FloatArray = gravity / strength if strength else gravity
    return down


#: One colour for each branch.
_COLORS = ((0.05, 0.55, 0.50), (0.85, 0.45, 0.05), (0.45, 0.30, 0.75), (0.55, 0.50, 0.10))


def ghosts_of(
    arm: Arm, tree: Sequence[UrdfJoint], shapes: Sequence[Shape], q: FloatArray, target: ArrayLike
) -> tuple[list[Shape], list[Label]]:
    """Every solution of the inverse kinematics for a target, as a ghost of the moving links."""
    point = float_array("target", target, (3,))
    if point.ndim != 1:
        raise ShapeError("target", point.shape, "shape (3,)")
    solutions = inverse_kinematics(point)
    n = len(arm.joint_names)
    bodies = [s for s in shapes if s.group == "bodies"]
    moving = {joint.child for joint in tree} - {"link_0"}
    ghosts, labels = [], []
    base = arm.forward_kinematics(q, frame="base_link").homogeneous
    for i, branch in enumerate(BRANCHES):
        if not solutions.exists[i]:
            continue
        solution = q.copy()
        solution[len(q) - n : len(q) - n + 4] = solutions.q[i]
        poses = link_poses(arm, tree, solution)
        for body in bodies:
            link = body.anchor.link if isinstance(body.anchor, Rigid) else WORLD
            if link in moving:
                ghosts.append(
                    Shape(
                        "ghosts",
                        f"{branch}/{body.name}",
                        Rigid(WORLD, poses[link]),
                        body.mesh,
                        _COLORS[i],
                        opacity=0.3,
                    )
                )
        where = np.eye(4)
        where[:3, 3] = poses["link_3"][:3, 3]
        limits = "" if solutions.within_limits[i] else ", beyond the limits"
        labels.append(
            Label("ghosts", branch.replace("_", " ") + limits, Rigid(WORLD, where), _COLORS[i])
        )
    at = np.eye(4)
    at[:3, 3] = base[:3, :3] @ point + base[:3, 3]
    marker = ball(0.008, (0.85, 0.1, 0.5), (0.97, 0.97, 0.97))
    ghosts.append(Shape("ghosts", "target", Rigid(WORLD, at), marker, on_top=2))
    labels.append(Label("ghosts", "target", Rigid(WORLD, at), (0.75, 0.05, 0.4)))
    return ghosts, labels
