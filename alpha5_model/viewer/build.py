"""Build the scene of an arm: bodies, frames, centres, forces, reach, solutions of the IK; poses and motions of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise, product
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, choice, float_array, shaped
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model._support.spatial import transform
from alpha5_model.codegen.base_parameters import regrouped
from alpha5_model.description.reading import UrdfJoint, parse_urdf, urdf_shapes
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.buoyancy import displaced_fluid_model
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.errors import InputError
from alpha5_model.kinematics import ik, reach
from alpha5_model.numbers.hydrodynamics import WATER_DENSITY, hydrodynamics
from alpha5_model.numbers.parameters import parameters
from alpha5_model.trajectory import Motion, analyse, motion
from alpha5_model.trajectory.smoothing import DEFAULT_BANDWIDTH
from alpha5_model.viewer import scene
from alpha5_model.viewer.scene import (
    Label,
    Load,
    Mean,
    MotionTrack,
    Rigid,
    Scene,
    Shape,
    Stream,
)
from alpha5_model.viewer.shapes import arrow, ball, drawn, triad
from alpha5_model.viewer.workspace_plot import workspace_shapes

#: Length of an arrow per force [m/N].
ARROW_SCALE = scene.ARROWS["force"]
#: Length of the axes of a frame [m].
_AXES = 0.05
_COLORS: Any = {name: tuple(rgb) for name, rgb in scene.LOOK["colors"].items()}
_ball = cache(ball)
#: Samples per second of a tour, and its rest at each pose [s].
_RATE, _PAUSE = 25.0, 0.6


def build_scene(
    arm: Arm,
    q: ArrayLike | None = None,
    *,
    target: ArrayLike | None = None,
    motion: Motion | None = None,
    show: Iterable[str] | None = None,
    current: ArrayLike | None = None,
) -> Scene:
    """Build the scene of an arm.

    Args:
        arm: What to show.
        q: Joint positions, (nq,). If None: the solution for the target that is nearest to ``home``,
            or, where nothing reaches the target, for the nearest point that is reached; else ``home``.
        target: Position in base_link, (3,) [m]; the solutions of its inverse kinematics are ghosts.
        motion: Played in real time.
        show: Groups to show, of `alpha5_model.viewer.scene.GROUPS`; the others can be switched on. If
            None: bodies, labels, centres, the ghosts if there is a target, the current if it is given.
        current: Velocity of the water in the world, (3,) [m/s]; 1 m/s along x if None. Where it is shown, its
            nominal load, which is estimated, is in the page's torques.

    Raises:
        InputError: Joint positions or a target that do not fit (`ShapeError`, `NonFiniteError`), or an arm
            with other dimensions than the catalogue's, which are drawn.
        UnknownNameError: An unknown group.
    """
    check_dimensions(arm._model, "the drawing")
    source = Path(JAWS_URDF_PATH if "axis_a" in arm.joint_names else URDF_PATH)
    text, folder = source.read_text(encoding="utf-8"), str(source.parent)
    tree, sliders, named = tree_of(arm, text), arm.joint_names, named_poses(arm)
    goal = None if target is None else shaped("target", target, (3,))
    home = named["home"].copy()
    if goal is not None:
        home[:4] = ik.inverse_kinematics(reach.nearest_reachable(goal), home[3]).best(
            home[:4]
        )
    position = shaped("q", with_base(arm, home) if q is None else q, (arm.model.nq,))
    poses = link_poses(arm, tree, position)
    water: ArrayLike = (1.0, 0.0, 0.0) if current is None else current
    flow = array("current", water, 3)
    inside = np.clip(
        position, arm.model.lowerPositionLimit, arm.model.upperPositionLimit
    )
    beyond = (np.abs(position - inside) > 1e-9)[-len(sliders) :].tolist()
    frames = _frames(tree, dict(zip(sliders, beyond, strict=True)))
    loads, gravity = tuple(_loads(arm, tree)), np.array(arm.model.gravity.linear)
    if show is None:
        given = {"ghosts": target, "current": current}
        show = (
            *scene.DEFAULT_SHOW,
            *(name for name, value in given.items() if value is not None),
        )
    shown = tuple(choice("group", group, tuple(scene.GROUPS)) for group in show)
    bodies = list(_bodies(text, folder, "visual"))
    things: list[Shape | Label] = [*bodies, *frames, *_centers(gravity, loads)]
    things += [
        *_bodies(text, folder, "collision"),
        *workspace_shapes(),
        *_current(flow),
    ]
    if goal is not None:
        things += _ghosts(arm, tree, bodies, position, goal)
    shapes = tuple(thing for thing in things if isinstance(thing, Shape))
    labels = tuple(thing for thing in things if isinstance(thing, Label))
    weight, lift = (
        sum(load.weight for load in loads),
        sum(load.buoyancy for load in loads),
    )
    wet = f"In water of {arm.fluid_density:g} kg/m\u00b3: weight {weight:.2f} N, buoyancy {lift:.2f} N."
    dry = f"In air: weight {weight:.2f} N."
    scale = f"Arrows: {1e3 * ARROW_SCALE:g} mm per newton. Torque: what each joint holds at rest."
    notes, joints = (
        (wet if arm.fluid_density else dry, scale),
        position[-len(sliders) :],
    )
    statics, streams = _statics(arm, loads, tree[0].parent), tuple(_streams(arm))
    track = None if motion is None else motion_track(motion, arm, position, current)
    fields = (
        notes,
        tree,
        sliders,
        joints,
        poses,
        shapes,
        labels,
        loads,
        statics,
        shown,
        named,
    )
    return scene.framed(
        Scene(*fields, motion=track, current=flow, streams=streams, target=goal)
    )


def _bodies(text: str, folder: str, element: str) -> Iterator[Shape]:
    for shape in urdf_shapes(text, element):
        at, mesh = Rigid(shape.link), drawn(shape, folder)
        if element == "collision":
            name = f"{shape.link}_{shape.index}"
            yield Shape("collision", name, at, mesh, _COLORS["orange"], opacity=0.35)
        else:
            name, (r, g, b) = f"{shape.link}/part_{shape.index}", shape.color[:3]
            # Only highlights show the form of a dark body.
            shine = 0.9 if max(r, g, b) < 0.4 else 0.4
            yield Shape("bodies", name, at, mesh, (r, g, b), shine=shine)


def _loads(arm: Arm, tree: Sequence[UrdfJoint]) -> Iterator[Load]:
    """Weight and buoyancy on each joint of the model, payloads included."""
    carrier = {joint.name: joint.child for joint in tree}
    strength = float(np.linalg.norm(arm.model.gravity.linear))
    water = displaced_fluid_model(
        arm.model, arm.displacements, 1.0
    )  # its masses are volumes
    for name, body, fluid in zip(
        arm.model.names, arm.model.inertias, water.inertias, strict=True
    ):
        if body.mass or fluid.mass:
            # The universe and the free-flyer carry the base.
            link = carrier.get(name, tree[0].parent)
            com, cob = body.lever.copy(), fluid.lever.copy()
            forces = strength * body.mass, strength * arm.fluid_density * fluid.mass
            yield Load(link, body.mass, com, fluid.mass, cob, *forces)


def _statics(arm: Arm, loads: Sequence[Load], base: str) -> dict[str, Any]:
    moments, beyond = np.zeros((5, 2, 4, 4)), []
    links = [base, *(f"link_{i}" for i in range(1, 5))]
    for load in loads:
        displaced = arm.fluid_density * load.volume * np.append(load.cob, 1.0)
        net = load.mass * np.append(load.com, 1.0) - displaced
        if load.link in links:
            moments[links.index(load.link), 1, :, 3] += net
        else:
            beyond.append((load.link, net))
    catalogue = parameters()
    units = np.zeros((4, 5, 2, 4, 4))
    units[range(4), 4, 1, range(4), 3] = 1.0
    share = np.stack(
        [regrouped(unit, np.zeros(3), catalogue) for unit in units], axis=-1
    )
    values = regrouped(moments, arm.model.gravity.linear, catalogue)
    return {"parameters": values, "share": share, "beyond": beyond}


def _frames(
    tree: Sequence[UrdfJoint], beyond: Mapping[str, bool]
) -> Iterator[Shape | Label]:
    """Axes of every link frame, over the bodies; names of joints, frames and the tcp."""
    axes = triad(_AXES, 0.0013)
    beside = transform(translation=(_AXES, 0.0, 0.0))  # the tip of x
    yield Shape("frames", tree[0].parent, Rigid(tree[0].parent), axes, on_top=1)
    for joint in tree:
        link = joint.child
        yield Shape("frames", link, Rigid(link), axes, on_top=1)
        if link != "tcp":
            yield Label("frames", link, Rigid(link, beside), (0.1, 0.3, 0.6))
        if joint.name in beyond or link == "tcp":
            out = beyond.get(joint.name, False)
            text = "tcp" if link == "tcp" else joint.name + ", beyond its limit" * out
            yield Label(
                "bodies", text, Rigid(link), _COLORS["red"] if out else Label.color
            )


def _centers(gravity: FloatArray, loads: Sequence[Load]) -> Iterator[Shape | Label]:
    """Balls at the centres of each body, arrows of its forces to scale; larger of the whole arm."""
    down = gravity / (np.linalg.norm(gravity) or 1.0)
    named = {**{f"load_{i}": [load] for i, load in enumerate(loads)}, "arm": loads}
    for kind, (name, carried) in product(scene.LOOK["centers"], named.items()):
        center, share, force, text, *colors, sense = kind
        one, other, ink, color = (_COLORS[name] for name in colors)
        points = tuple(
            p for p in map(attrgetter("link", share, center), carried) if p[1]
        )
        if not points:
            continue
        at, whole = Mean(points), name == "arm"
        yield Shape(
            center, name, at, _ball(0.0095 if whole else 0.0048, one, other), on_top=2
        )
        if whole:
            yield Label(center, text, at, ink)
        if strength := sum(getattr(load, force) for load in carried):
            tip = ARROW_SCALE * sense * strength * down
            r, g, b = (0.8 * c if whole else c for c in color)
            mesh = arrow(tip, 0.004 if whole else 0.0022)
            yield Shape(force, name, at, mesh, (r, g, b), on_top=1)
            if whole:
                yield Label(
                    force, f"{force} {strength:.2f} N", Mean(points, tip), (r, g, b)
                )


def _current(flow: FloatArray) -> Iterator[Shape | Label]:
    """An arrow beside the base along the current."""
    teal, tip = _COLORS["teal"], scene.ARROWS["current"] * flow
    at = Rigid(scene.WORLD, transform(translation=(0.0, -0.16, 0.05)))
    speed = float(np.linalg.norm(flow))
    mesh = arrow(tip, 0.004) if speed else _ball(0.004, teal, teal)
    yield Shape("current", "arrow", at, mesh, teal, on_top=1)
    yield Label("current", f"current {speed:.3g} m/s, load estimated", at, teal)


def _streams(arm: Arm) -> Iterator[Stream]:
    """What a current does to each link, at the arm's fluid density."""
    for link, water in hydrodynamics(
        "jaws" if "axis_a" in arm.joint_names else "locked"
    ).items():
        strips = []
        for s in water.strips:
            line = s.end - s.start
            length = float(np.linalg.norm(line))
            face = arm.fluid_density / 2 * s.diameter * length
            strips.append(
                ((s.start + s.end) / 2, line / length, face * s.across, face * s.along)
            )
        added = water.added_mass[:3, :3] * (arm.fluid_density / WATER_DENSITY)
        yield Stream(link, tuple(strips), added)


def _ghosts(
    arm: Arm,
    tree: Sequence[UrdfJoint],
    bodies: Sequence[Shape],
    q: FloatArray,
    target: FloatArray,
) -> Iterator[Shape | Label]:
    """Every solution of the inverse kinematics for a target, as ghosts of the moving links."""
    solutions = ik.inverse_kinematics(target)
    for i in np.flatnonzero(solutions.exists):
        branch, color, solution = ik.BRANCHES[i], scene.LOOK["ghosts"][i], q.copy()
        solution[len(q) - len(arm.joint_names) :][:4] = solutions.q[i]
        poses = link_poses(arm, tree, solution)
        for body in bodies:
            if isinstance(body.anchor, Rigid) and body.anchor.link not in (
                "base_link",
                "link_0",
            ):
                at = Rigid(scene.WORLD, poses[body.anchor.link])
                yield Shape(
                    "ghosts", f"{branch}/{body.name}", at, body.mesh, color, opacity=0.3
                )
        limits = "" if solutions.within_limits[i] else ", beyond the limits"
        elbow = Rigid(scene.WORLD, transform(translation=poses["link_3"][:3, 3]))
        yield Label("ghosts", branch.replace("_", " ") + limits, elbow, color)
    base = arm.forward_kinematics(q, frame="base_link")
    at = Rigid(scene.WORLD, transform(translation=base.act(target)))
    yield Shape(
        "ghosts", "target", at, ball(0.008, _COLORS["pink"], _COLORS["white"]), on_top=2
    )
    away = float(reach.distance_to_reach(target))
    text = f"target, out of reach by {1e3 * away:.1f} mm" if away else "target"
    yield Label("ghosts", text, at, (0.75, 0.05, 0.4))


def named_poses(arm: Arm) -> dict[str, FloatArray]:
    """Named poses as joint positions (n,) of the arm, its jaws closed."""
    closed = [joint.lower for joint in parameters().joints[4 : len(arm.joint_names)]]
    return {name: np.array([*pose, *closed]) for name, pose in NAMED_POSES.items()}


def pose_of(arm: Arm, text: str) -> FloatArray:
    """Joint positions (nq,) from the name of a pose or from numbers with commas or spaces."""
    named, n = named_poses(arm), len(arm.joint_names)
    try:
        values = [float(part) for part in text.replace(",", " ").split()]
    except ValueError:
        return with_base(arm, named[choice("pose", text.strip(), tuple(named))])
    if len(values) == 4:
        values += named["home"][4:].tolist()
    if len(values) != n:
        names = ", ".join(arm.joint_names)
        raise InputError("pose", text, f"{n} numbers ({names}), or the name of a pose")
    return with_base(arm, float_array("pose", values, (n,)))


def with_base(arm: Arm, joints: FloatArray) -> FloatArray:
    """Joint positions (n,) as the arm's q (nq,): a floating base stands at the world's origin."""
    return (
        np.concatenate([[0, 0, 0, 0, 0, 0, 1.0], joints])
        if arm.floating_base
        else joints
    )


def link_poses(
    arm: Arm, tree: Sequence[UrdfJoint], q: FloatArray
) -> dict[str, FloatArray]:
    """Pose of every link in the world by Pinocchio, (4, 4), and of the world itself."""
    links = [tree[0].parent, *(joint.child for joint in tree)]
    poses = {
        link: np.array(arm.forward_kinematics(q, frame=link).homogeneous)
        for link in links
    }
    return {scene.WORLD: np.eye(4), **poses}


def posed(scene: Scene, arm: Arm, q: FloatArray) -> Scene:
    """A scene with its arm at joint positions q (nq,)."""
    poses = link_poses(arm, scene.tree, q)
    return replace(scene, q=q[len(q) - len(scene.sliders) :], poses=poses)


def resampled(
    arm: Arm, time: FloatArray, q: FloatArray, rate: float
) -> Iterator[FloatArray]:
    """Joint positions (nq,) at a steady rate [1/s] along a motion, time (N,) and q (N, nq)."""
    at = time[0] + np.arange(0.0, time[-1] - time[0] + 0.999 / rate, 1.0 / rate)
    for place in np.interp(at, time, np.arange(float(len(time)))):
        i = min(int(place), len(time) - 2)
        yield pin.interpolate(arm.model, q[i], q[i + 1], place - i)


def tree_of(arm: Arm, urdf: str) -> tuple[UrdfJoint, ...]:
    """The joint tree of a URDF, placed as in the arm's model: its corrections may differ."""
    tree = tuple(parse_urdf(urdf).joints.values())
    poses = link_poses(arm, tree, with_base(arm, np.zeros(len(arm.joint_names))))
    inv = np.linalg.inv
    placed = [
        inv(poses[j.parent]) @ poses[j.child] @ inv(j.motion(j.offset)) for j in tree
    ]
    return tuple(replace(j, transform=at) for j, at in zip(tree, placed, strict=True))


def motion_track(
    moved: Motion, arm: Arm, q: FloatArray, current: ArrayLike | None = None
) -> MotionTrack:
    """A motion of the arm's joints, base to tip, with its torques and its load on the mount.

    Joints that it lacks stay where they are. An arm on a vehicle has no mount.
    """
    time, n = moved.time - moved.time[0], len(arm.joint_names)
    track, both = np.tile(q[len(q) - n :], (len(time), 1)), min(n, len(moved.joints))
    track[:, :both] = moved.position[:, :both]
    loads: dict[str, FloatArray] = {}
    if not arm.floating_base:
        known, rest = moved.velocity, ((0, 0), (0, n - both))
        velocity = None if known is None else np.pad(known[:, :both], rest)
        # Too few samples a second for a bandwidth.
        method = (
            "spline"
            if np.median(np.diff(time)) < 0.5 / DEFAULT_BANDWIDTH
            else "interpolate"
        )
        analysis = analyse(
            motion(time, track, velocity), arm, method=method, current=current
        )
        loads = {**analysis.causes(), "mount": analysis.base_wrench}
        del loads["friction"]  # at the motor
    return MotionTrack(Path(moved.source).name, time, track, loads)


def tour(waypoints: ArrayLike) -> Motion:
    """Move from pose to pose, resting at each.

    Each leg follows ``s = (1 - cos(pi t / T)) / 2`` and takes the time at which the fastest joint
    just reaches its speed.

    Args:
        waypoints: (N, n), at least two, joints base to tip [rad; jaw rod m].

    Returns:
        The motion, sampled at 25 Hz.

    Raises:
        InputError: Fewer than two poses, or not of four or five joints.
    """
    joints = parameters().joints[: np.shape(waypoints)[-1]]
    poses = float_array("waypoints", waypoints, (len(joints),))
    if poses.ndim != 2 or len(poses) < 2:
        raise InputError("waypoints", poses.shape, "at least two poses in rows")
    speed, rest = np.array([joint.velocity for joint in joints]), round(_PAUSE * _RATE)
    pieces: list[FloatArray] = [np.repeat(poses[:1], rest, axis=0)]
    for start, end in pairwise(poses):
        duration = float(np.max(np.pi / 2 * np.abs(end - start) / speed))
        phase = np.linspace(0.0, np.pi, max(2, round(duration * _RATE) + 2))[1:]
        leg = start + (end - start) * ((1.0 - np.cos(phase)) / 2)[:, None]
        pieces += [leg, np.repeat(end[None], rest, axis=0)]
    q = np.concatenate(pieces)
    return replace(motion(np.arange(len(q)) / _RATE, q), source="a short motion")
