"""Build the scene of an arm: its drawing, its poses, the numbers of its page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, choice, shaped
from alpha5_model._support.paths import URDF_PATH
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.load import arm_urdf
from alpha5_model.errors import InputError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.kinematics.reach import nearest_reachable
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.jaws import finger_tips
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue, parameters
from alpha5_model.planning.goals import reaching_wrists
from alpha5_model.planning.obstacles import Obstacle, checked_obstacles
from alpha5_model.trajectory import Motion
from alpha5_model.viewer import drawing
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.loads import loads_of, streams_of
from alpha5_model.viewer.own_arm import own_notes
from alpha5_model.viewer.poses import (
    gravity_in_world,
    link_poses,
    named_poses,
    tree_of,
    with_base,
)
from alpha5_model.viewer.reach_shapes import workspace_shapes
from alpha5_model.viewer.scene import (
    DEFAULT_SHOW,
    GROUPS,
    NO_PAYLOAD,
    WORLD,
    Label,
    Load,
    MotionTrack,
    Payload,
    Scene,
    Shape,
    Water,
)
from alpha5_model.viewer.tracks import motion_track

#: Velocity of the water in the scene if none is given [m/s].
_WATER_VELOCITY = (1.0, 0.0, 0.0)
#: Where file names of meshes in a URDF start.
_FOLDER = str(Path(URDF_PATH).parent)


def build_scene(
    arm: Arm,
    q: ArrayLike | None = None,
    *,
    target: ArrayLike | None = None,
    motion: Motion | None = None,
    show: Iterable[str] | None = None,
    water_velocity: ArrayLike | None = None,
    payload: Sequence[Any] | None = None,
    obstacles: Iterable[Obstacle] = (),
    curves: Mapping[str, ArrayLike] | None = None,
) -> Scene:
    """Build the scene of an arm.

    Args:
        arm: What to show.
        q: Joint positions, (nq,). If None: the first pose of the motion; or the
            solution nearest to ``home`` for the target, or for the nearest point in
            reach; or ``home``.
        target: Position in base_link, (3,) [m]; the solutions of its inverse kinematics
            are ghosts.
        motion: Played in real time.
        show: Groups to show, of `alpha5_model.viewer.scene.GROUPS`; the others can be
            switched on. If None: bodies, labels, centres, the ghosts if there is a
            target, the current if it is given.
        water_velocity: (3,) [m/s], in base_link if the base is fixed,
            else in the world; 1 m/s along x if None. If the current is shown, the
            page's torques include its nominal load, which is estimated.
        payload: What the arm holds, beside payloads that it has, as
            `alpha5_model.viewer.scene.Payload` has it.
        obstacles: Fixed bodies in base_link.
        curves: Name -> signals beside the motion, one number for each of its samples.

    Raises:
        InputError: Joint positions or a target that do not fit (`ShapeError`,
            `NonFiniteError`), or an arm with other dimensions than its record's, which
            are drawn.
        UnknownNameError: An unknown group.
    """
    record = arm.parameters
    check_dimensions(arm._model, "the drawing", arm=record)
    urdf = _urdf(arm)
    tree = tree_of(arm, urdf)
    root = tree[0].parent

    goal = None if target is None else shaped("target", target, (3,))
    held = NO_PAYLOAD if payload is None else Payload(*payload)
    loaded = _loaded(arm, held)
    # Joints that the motion lacks stay where this pose has them.
    resting = with_base(arm, _start(arm, goal)) if q is None else q
    position = shaped("q", resting, (arm.model.nq,))
    track = _track(motion, loaded, position, water_velocity, curves)
    if track is not None and q is None and goal is None:
        position = with_base(arm, track.q[0])
    water = _water(arm, water_velocity)
    loads = tuple(loads_of(arm, tree))
    if show is None:
        show = _default_show(
            target=target is not None, water_velocity=water_velocity is not None
        )

    bodies = list(drawing.bodies(urdf, _FOLDER))
    bodies += drawing.spacer(bodies, record.spacer)
    things: list[Shape | Label] = [
        *bodies,
        *drawing.frames(tree, _beyond_limits(arm, position)),
        *_extras(record, urdf),
        *drawing.obstacles(checked_obstacles(obstacles), root),
        *_forces(arm, root, loads, water, held),
    ]
    if goal is not None:
        things += drawing.ghosts(arm, tree, bodies, position, goal)

    is_own = not is_catalogue(record)
    joints = record.joints[: len(arm.joint_names)]
    scene = Scene(
        notes=_notes(arm, is_own),
        tree=tree,
        sliders=arm.joint_names,
        q=position[-len(arm.joint_names) :],
        poses=link_poses(arm, tree, position),
        geometry=Geometry.of(record),
        shapes=tuple(thing for thing in things if isinstance(thing, Shape)),
        labels=tuple(thing for thing in things if isinstance(thing, Label)),
        loads=loads,
        show=tuple(choice("group", group, tuple(GROUPS)) for group in show),
        named_poses=named_poses(arm),
        motion=track,
        water=water,
        collision=self_collision(record, arm.gripper).bodies,
        speed=np.array([joint.velocity for joint in joints]),
        target=goal,
        name=record.name if is_own else "",
        payload=held,
        is_fixed=not arm.floating_base,
        finger_tips=finger_tips(record),
    )
    return framed(scene)


def _extras(record: Alpha5Parameters, urdf: str) -> Iterator[Shape | Label]:
    """What is attached, the collision bodies, and the reach in a plane."""
    yield from drawing.attached(record.attached)
    yield from drawing.collision_bodies(urdf, _FOLDER)
    if Geometry.of(record).tool_on_axis:
        yield from workspace_shapes(Geometry.of(record))


def _forces(
    arm: Arm, root: str, loads: Sequence[Load], water: Water, payload: Payload
) -> Iterator[Shape | Label]:
    """Centres with weight and buoyancy, the current, and what the arm holds."""
    yield from drawing.centers(water.gravity, loads)
    frame = WORLD if arm.floating_base else root
    yield from drawing.current_arrow(water.water_velocity, frame)
    yield from drawing.payload(payload, water)


def _water(arm: Arm, water_velocity: ArrayLike | None) -> Water:
    """What the arm is in.

    The scene always has a current, which the page can switch on. A motion has one only
    if it is given.
    """
    return Water(
        density=arm.fluid_density,
        gravity=gravity_in_world(arm),
        water_velocity=array(
            "water_velocity",
            _WATER_VELOCITY if water_velocity is None else water_velocity,
            3,
        ),
        streams={level: tuple(streams_of(arm, level)) for level in LEVELS},
    )


def _loaded(arm: Arm, payload: Payload) -> Arm:
    """The arm with a payload, if there is one."""
    if not payload.mass and not payload.volume:
        return arm
    return arm.with_payload(payload.mass, payload.com, volume=payload.volume)


def _track(
    motion: Motion | None,
    arm: Arm,
    q: FloatArray,
    water_velocity: ArrayLike | None,
    curves: Mapping[str, ArrayLike] | None,
) -> MotionTrack | None:
    """A motion with its curves, if there is one."""
    if motion is not None:
        return motion_track(motion, arm, q, water_velocity, curves)
    if curves:
        raise InputError("curves", [*curves], "a motion, with whose samples they go")
    return None


def _urdf(arm: Arm) -> str:
    """The URDF that is drawn: the shipped one for the catalogue's arm."""
    record = arm.parameters
    # With other corrections, the joints of the shipped one are moved.
    return arm_urdf(arm.gripper, parameters() if is_catalogue(record) else record)


def _start(arm: Arm, goal: FloatArray | None) -> FloatArray:
    """``home`` (n,), with the tcp at a goal (3,), or at the nearest point in reach.

    The solution is the nearest to ``home``, with axis_b as little turned as needed, and
    free of self-collision if one is. With a tool beside the wrist axis, the arm stays
    at ``home`` if the goal is out of reach, since the nearest point is not known.
    """
    home = named_poses(arm)["home"]
    if goal is None:
        return home
    record = arm.parameters
    if Geometry.of(record).tool_on_axis:
        goal = nearest_reachable(goal, arm=record)

    colliding = home
    for wrist in [home[3], *reaching_wrists(goal, home[3], record)]:
        solutions = inverse_kinematics(goal, wrist, arm=record)
        if not solutions.within_limits.any():
            continue
        free = bool((solutions.within_limits & ~solutions.collides).any())
        best = solutions.best(home[:4], allow_collision=not free)
        found = np.concatenate([best, home[4:]])
        if free:
            return found
        if colliding is home:
            colliding = found
    return colliding


def _default_show(target: bool, water_velocity: bool) -> list[str]:
    """Groups that are shown if there is a target or a current."""
    shown = list(DEFAULT_SHOW)
    if target:
        shown.append("ghosts")
    if water_velocity:
        shown.append("current")
    return shown


def _beyond_limits(arm: Arm, q: FloatArray) -> dict[str, bool]:
    """Name of each joint of the arm -> whether it is beyond a limit."""
    joints = arm.limits.beyond(q[-len(arm.joint_names) :]).tolist()
    return dict(zip(arm.joint_names, joints, strict=True))


def _notes(arm: Arm, is_own: bool) -> tuple[str, ...]:
    """Lines about the arrows, and an arm of one's own."""
    arrows = f"Arrows: {1e3 * drawing.ARROW_SCALE:g} mm per newton."
    said = (f"{arrows} Torque: what each joint holds at rest.",)
    if not is_own:
        return said
    return *own_notes(arm.parameters, arm.floating_base), *said
