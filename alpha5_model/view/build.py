"""From an arm and its joint positions to a scene: bodies, frames, centres, forces, workspace, ghosts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, choice, float_array
from alpha5_model.description.poses import NAMED_POSES
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.parameters import parameters
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.view.bodies import urdf_bodies
from alpha5_model.view.framing import framing
from alpha5_model.view.reach import workspace_shapes
from alpha5_model.view.scene import (
    DEFAULT_SHOW,
    GROUPS,
    WORLD,
    Label,
    Load,
    Mean,
    MotionTrack,
    Rigid,
    Scene,
    Shape,
)
from alpha5_model.view.shapes import arrow, ball, triad
from alpha5_model.view.tree import TreeJoint, joint_motion, joint_tree

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.trajectory.motion import Motion

#: Length of an arrow per force [m/N].
ARROW_SCALE = 0.015
_YELLOW, _BLACK = (0.98, 0.80, 0.10), (0.10, 0.10, 0.10)
_BLUE, _WHITE = (0.10, 0.45, 0.85), (0.97, 0.97, 0.97)
_RED, _SKY = (0.80, 0.17, 0.15), (0.16, 0.55, 0.86)
#: One colour for each branch of the inverse kinematics.
_GHOSTS = ((0.05, 0.55, 0.50), (0.85, 0.45, 0.05), (0.45, 0.30, 0.75), (0.55, 0.50, 0.10))


def build_scene(
    arm: Arm,
    q: ArrayLike | None = None,
    *,
    target: ArrayLike | None = None,
    motion: Motion | None = None,
    show: Iterable[str] | None = None,
) -> Scene:
    """Everything that can be seen of an arm.

    Args:
        arm: What to show.
        q: Joint positions, (nq,); the pose ``home`` if None.
        target: Position for which all solutions of the inverse kinematics stand as ghosts, (3,) [m].
        motion: Played in real time.
        show: Groups to show, of `alpha5_model.view.scene.GROUPS`; the others can be switched on.

    Raises:
        InputError: Joint positions or a target that do not fit (`ShapeError`, `NonFiniteError`).
        UnknownNameError: A group that there is not.
    """
    source = Path(JAWS_URDF_PATH if "axis_a" in arm.joint_names else URDF_PATH)
    text = source.read_text(encoding="utf-8")
    tree = _as_in(arm, joint_tree(text))
    sliders = arm.joint_names
    named = named_poses(arm)
    position = float_array("q", with_base(arm, named["home"]) if q is None else q, (arm.model.nq,))
    if position.ndim != 1:
        raise ShapeError("q", position.shape, f"shape ({arm.model.nq},)")
    poses = link_poses(arm, tree, position)
    loads = _loads(arm, tree)
    shown = tuple(
        choice("group", g, tuple(GROUPS)) for g in (DEFAULT_SHOW if show is None else show)
    )
    folder = str(source.parent)
    shapes = [*_bodies(text, folder), *_frames(tree), *_centers(loads), *_forces(arm, loads)]
    shapes += [*_collision(text, folder), *workspace_shapes()]
    labels = [*_frame_labels(tree, sliders), *_center_labels(loads), *_force_labels(arm, loads)]
    if target is not None:
        ghosts, ghost_labels = _ghosts(arm, tree, shapes, position, target)
        shapes += ghosts
        labels += ghost_labels
    weight, lift = sum(load.weight for load in loads), sum(load.buoyancy for load in loads)
    notes = [
        f"In water of {arm.fluid_density:g} kg/m\u00b3: weight {weight:.2f} N, buoyancy {lift:.2f} N."
        if arm.fluid_density
        else f"In air: weight {weight:.2f} N.",
        f"Arrows: {1e3 * ARROW_SCALE:g} mm per newton. Torque: what each joint holds at rest.",
    ]
    return Scene(
        title="Reach Alpha 5",
        notes=tuple(notes),
        tree=tree,
        sliders=sliders,
        q=position[arm.model.nq - len(sliders) :],
        poses=poses,
        shapes=tuple(shapes),
        labels=tuple(labels),
        loads=loads,
        gravity=np.array(arm.model.gravity.linear),
        camera=framing(shapes, poses, shown),
        show=shown,
        named_poses=named,
        motion=None if motion is None else motion_track(motion, sliders, position),
    )


def pose_of(arm: Arm, text: str) -> FloatArray:
    """Joint positions (nq,) from the name of a pose or from numbers with commas or spaces."""
    try:
        values = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        named = named_poses(arm)
        return with_base(arm, named[choice("pose", text.strip(), tuple(named))])
    n = len(arm.joint_names)
    if "axis_a" in arm.joint_names and len(values) == n - 1:
        values.append(parameters().joints[4].lower)  # closed jaws
    if len(values) != n:
        names = ", ".join(arm.joint_names)
        raise InputError("pose", text, f"{n} numbers ({names}), or the name of a pose")
    return with_base(arm, float_array("pose", values, (n,)))


def with_base(arm: Arm, joints: FloatArray) -> FloatArray:
    """Joint positions (n,) as the arm's q (nq,): a floating base stands at the world's origin."""
    return np.concatenate([[0, 0, 0, 0, 0, 0, 1.0], joints]) if arm.floating_base else joints


def link_poses(arm: Arm, tree: Sequence[TreeJoint], q: FloatArray) -> dict[str, FloatArray]:
    """Pose of every link in the world by Pinocchio, (4, 4), and of the world itself."""
    links = [tree[0].parent, *(joint.child for joint in tree)]
    poses = {link: np.array(arm.forward_kinematics(q, frame=link).homogeneous) for link in links}
    return {WORLD: np.eye(4), **poses}


def _as_in(arm: Arm, tree: tuple[TreeJoint, ...]) -> tuple[TreeJoint, ...]:
    """The tree with the placements of the arm's own model, whose corrections may be others."""
    zero = with_base(arm, np.zeros(len(arm.joint_names)))
    poses = link_poses(arm, tree, zero)
    return tuple(
        replace(
            joint,
            placement=np.linalg.inv(poses[joint.parent])
            @ poses[joint.child]
            @ np.linalg.inv(joint_motion(joint, 0.0)),
        )
        for joint in tree
    )


def motion_track(motion: Motion, sliders: Sequence[str], q: FloatArray) -> MotionTrack:
    """A motion in the order of the sliders; joints that it lacks stay where they are."""
    time = motion.time - motion.time[0]
    track = np.tile(q[len(q) - len(sliders) :], (len(time), 1))
    for i, name in enumerate(sliders):
        if name in motion.joints:
            track[:, i] = motion.position[:, motion.joints.index(name)]
    return MotionTrack(Path(motion.source).name, time, track)


def named_poses(arm: Arm) -> dict[str, FloatArray]:
    """Named poses as joint positions (n,) of the arm, its jaws closed."""
    jaws = [parameters().joints[4].lower] * ("axis_a" in arm.joint_names)
    return {name: np.array([*pose, *jaws]) for name, pose in NAMED_POSES.items()}


def _loads(arm: Arm, tree: Sequence[TreeJoint]) -> tuple[Load, ...]:
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
                weight=inertia.mass * strength,
                com=np.array(inertia.lever),
                buoyancy=arm.fluid_density * volume * strength,
                cob=cob / volume if volume else np.array(inertia.lever),
            )
        )
    return tuple(loads)


def _bodies(text: str, folder: str) -> list[Shape]:
    bodies = urdf_bodies(text, folder)
    return [
        Shape(
            "bodies",
            f"{body.link}/part_{[other.link for other in bodies[:i]].count(body.link)}",
            Rigid(body.link),
            body.mesh,
            body.color[:3],
            shine=0.9 if max(body.color[:3]) < 0.4 else 0.4,  # dark bodies live by their highlights
        )
        for i, body in enumerate(bodies)
    ]


def _collision(text: str, folder: str) -> list[Shape]:
    bodies = urdf_bodies(text, folder, "collision")
    color = (0.95, 0.55, 0.10)
    return [
        Shape("collision", f"{body.link}_{i}", Rigid(body.link), body.mesh, color, opacity=0.35)
        for i, body in enumerate(bodies)
    ]


def _frames(tree: Sequence[TreeJoint]) -> list[Shape]:
    links = [tree[0].parent, *(joint.child for joint in tree)]
    mesh = triad(0.05, 0.0013)
    return [Shape("frames", link, Rigid(link), mesh, on_top=1) for link in links]


def _frame_labels(tree: Sequence[TreeJoint], sliders: Sequence[str]) -> list[Label]:
    labels = [
        Label("bodies", joint.name, Rigid(joint.child)) for joint in tree if joint.name in sliders
    ]
    frames = [joint.child for joint in tree if joint.child != "tcp"]
    beside = np.eye(4)
    beside[0, 3] = 0.05  # the tip of x
    labels += [Label("frames", link, Rigid(link, beside), (0.1, 0.3, 0.6)) for link in frames]
    return [*labels, Label("bodies", "tcp", Rigid("tcp"))]


def _whole(loads: Sequence[Load], kind: str) -> Mean:
    """Anchor at the centre of mass (``com``) or of buoyancy (``cob``) of the whole arm."""
    if kind == "com":
        return Mean(tuple((load.link, load.weight, load.com) for load in loads if load.weight))
    return Mean(tuple((load.link, load.buoyancy, load.cob) for load in loads if load.buoyancy))


def _centers(loads: Sequence[Load]) -> list[Shape]:
    shapes = []
    for kind, colors in (("com", (_YELLOW, _BLACK)), ("cob", (_BLUE, _WHITE))):
        small, large = ball(0.0048, *colors), ball(0.0095, *colors)
        for i, load in enumerate(loads):
            point = load.com if kind == "com" else load.cob
            if load.weight if kind == "com" else load.buoyancy:
                anchor = Mean(((load.link, 1.0, point),))
                shapes.append(Shape(kind, f"load_{i}", anchor, small, on_top=2))
        if _whole(loads, kind).points:
            shapes.append(Shape(kind, "arm", _whole(loads, kind), large, on_top=2))
    return shapes


def _center_labels(loads: Sequence[Load]) -> list[Label]:
    names = {"com": ("centre of mass", (0.45, 0.33, 0.0)), "cob": ("centre of buoyancy", _BLUE)}
    return [
        Label(kind, text, _whole(loads, kind), color)
        for kind, (text, color) in names.items()
        if _whole(loads, kind).points
    ]


def _forces(arm: Arm, loads: Sequence[Load]) -> list[Shape]:
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


def _force_labels(arm: Arm, loads: Sequence[Load]) -> list[Label]:
    return [
        Label(
            kind,
            f"{kind} {np.linalg.norm(force):.2f} N",
            Mean(anchor.points, ARROW_SCALE * force),
            color,
        )
        for kind, force, anchor, color in _totals(arm, loads)
    ]


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


def _ghosts(
    arm: Arm, tree: Sequence[TreeJoint], shapes: Sequence[Shape], q: FloatArray, target: ArrayLike
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
                        _GHOSTS[i],
                        opacity=0.3,
                    )
                )
        where = np.eye(4)
        where[:3, 3] = poses["link_3"][:3, 3]
        limits = "" if solutions.within_limits[i] else ", beyond the limits"
        labels.append(
            Label("ghosts", branch.replace("_", " ") + limits, Rigid(WORLD, where), _GHOSTS[i])
        )
    at = np.eye(4)
    at[:3, 3] = base[:3, :3] @ point + base[:3, 3]
    marker = ball(0.008, (0.85, 0.1, 0.5), _WHITE)
    ghosts.append(Shape("ghosts", "target", Rigid(WORLD, at), marker, on_top=2))
    labels.append(Label("ghosts", "target", Rigid(WORLD, at), (0.75, 0.05, 0.4)))
    return ghosts, labels
