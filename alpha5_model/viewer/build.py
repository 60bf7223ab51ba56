"""Build the scene of an arm: its drawing, its poses, the numbers of its page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, choice, shaped
from alpha5_model._support.paths import URDF_PATH
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.dimensions import check_dimensions
from alpha5_model.dynamics.load import arm_urdf
from alpha5_model.errors import InputError, SelfCollisionError
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import Solutions, inverse_kinematics
from alpha5_model.kinematics.reach import nearest_reachable
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue, parameters
from alpha5_model.planning.goals import reaching_wrists
from alpha5_model.planning.planner import ACCELERATION
from alpha5_model.planning.retracted import retracted_poses
from alpha5_model.planning.s_curve import RAMP
from alpha5_model.trajectory import Motion
from alpha5_model.viewer import drawing
from alpha5_model.viewer.framing import framed
from alpha5_model.viewer.own_arm import own_arm, own_notes
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
    Travel,
    Water,
)
from alpha5_model.viewer.statics import loads_of, statics_of, streams_of
from alpha5_model.viewer.tracks import motion_track

#: Velocity of the water in the scene if none is given [m/s].
_CURRENT = (1.0, 0.0, 0.0)
#: Where file names of meshes in a URDF start.
_FOLDER = str(Path(URDF_PATH).parent)
#: How far beyond a limit rounding may put a joint [rad or m].
_ROUNDING = 1e-9


def build_scene(
    arm: Arm,
    q: ArrayLike | None = None,
    *,
    target: ArrayLike | None = None,
    motion: Motion | None = None,
    show: Iterable[str] | None = None,
    current: ArrayLike | None = None,
    payload: Payload = NO_PAYLOAD,
    curves: Mapping[str, ArrayLike] | None = None,
) -> Scene:
    """Build the scene of an arm.

    Args:
        arm: What to show.
        q: Joint positions, (nq,). If None: the solution nearest to ``home`` for the
            target, or for the nearest point in reach; ``home`` without a target.
        target: Position in base_link, (3,) [m]; the solutions of its inverse kinematics
            are ghosts.
        motion: Played in real time.
        show: Groups to show, of `alpha5_model.viewer.scene.GROUPS`; the others can be
            switched on. If None: bodies, labels, centres, the ghosts if there is a
            target, the current if it is given.
        current: Velocity of the water, (3,) [m/s], in base_link if the base is fixed,
            else in the world; 1 m/s along x if None. If the current is shown, the
            page's torques include its nominal load, which is estimated.
        payload: What the arm holds, beside payloads that it has.
        curves: Name -> signals beside the motion, one number for each of its samples.

    Raises:
        InputError: Joint positions or a target that do not fit (`ShapeError`,
            `NonFiniteError`), or an arm with other dimensions than its record's, which
            are drawn.
        UnknownNameError: An unknown group.
    """
    record = arm.parameters
    check_dimensions(arm._model, "the drawing", arm=record)
    own = own_arm(record)
    urdf = _urdf(arm)
    tree = tree_of(arm, urdf)
    root = tree[0].parent

    goal = None if target is None else shaped("target", target, (3,))
    given = with_base(arm, _start(arm, goal)) if q is None else q
    position = shaped("q", given, (arm.model.nq,))
    water = _water(arm, current)
    loads = tuple(loads_of(arm, tree))
    if show is None:
        show = _default_show(target=target is not None, current=current is not None)

    bodies = list(drawing.bodies(urdf, _FOLDER))
    things: list[Shape | Label] = [
        *bodies,
        *drawing.frames(tree, _beyond_limits(arm, position)),
        *_extras(record, urdf),
        *_forces(arm, root, loads, water, payload),
    ]
    if goal is not None:
        things += drawing.ghosts(arm, tree, bodies, position, goal)

    scene = Scene(
        notes=_notes(arm, own is not None),
        tree=tree,
        sliders=arm.joint_names,
        q=position[-len(arm.joint_names) :],
        poses=link_poses(arm, tree, position),
        geometry=Geometry.of(record),
        shapes=tuple(thing for thing in things if isinstance(thing, Shape)),
        labels=tuple(thing for thing in things if isinstance(thing, Label)),
        loads=loads,
        statics=statics_of(arm, loads, root),
        show=tuple(choice("group", group, tuple(GROUPS)) for group in show),
        named_poses=named_poses(arm),
        motion=_track(motion, _loaded(arm, payload), position, current, curves),
        water=water,
        collision=self_collision(record, _gripper_of(arm)).bodies,
        travel=_travel(arm),
        target=goal,
        own=own,
        payload=payload,
        is_fixed=not arm.floating_base,
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
    yield from drawing.current_arrow(water.current, frame)
    yield from drawing.payload(payload, water)


def _water(arm: Arm, current: ArrayLike | None) -> Water:
    """What the arm is in.

    The scene always has a current, which the page can switch on. A motion has one only
    if it is given.
    """
    return Water(
        density=arm.fluid_density,
        gravity=gravity_in_world(arm),
        current=array("current", _CURRENT if current is None else current, 3),
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
    current: ArrayLike | None,
    curves: Mapping[str, ArrayLike] | None,
) -> MotionTrack | None:
    """A motion with its curves, if there is one."""
    if motion is not None:
        return motion_track(motion, arm, q, current, curves)
    if curves:
        raise InputError("curves", [*curves], "a motion, with whose samples they go")
    return None


def _travel(arm: Arm) -> Travel:
    """How the page moves the arm; the jaws' rod has its speed after one ramp."""
    joints = arm.parameters.joints[: len(arm.joint_names)]
    speed = np.array([joint.velocity for joint in joints])
    acceleration = np.where(np.arange(len(speed)) < 4, ACCELERATION, speed / RAMP)
    return Travel(
        speed=speed,
        acceleration=acceleration,
        ramp=RAMP,
        retracted=retracted_poses(arm.parameters),
    )


def _gripper_of(arm: Arm) -> str:
    """``jaws`` if they move, or ``locked``."""
    return "jaws" if "axis_a" in arm.joint_names else "locked"


def _urdf(arm: Arm) -> str:
    """The URDF that is drawn: the shipped one for the catalogue's arm."""
    record = arm.parameters
    # With other corrections, the joints of the shipped one are moved.
    return arm_urdf(_gripper_of(arm), parameters() if is_catalogue(record) else record)


def _start(arm: Arm, goal: FloatArray | None) -> FloatArray:
    """``home`` (n,), with the tcp at a goal (3,), or at the nearest point in reach.

    With a tool beside the wrist axis, the arm stays at ``home`` if the goal is out of
    reach, since the nearest point is not known.
    """
    home = named_poses(arm)["home"]
    if goal is None:
        return home
    record = arm.parameters
    if not Geometry.of(record).tool_on_axis:
        found = _beside(record, goal, home[:4])
        return home if found is None else np.concatenate([found, home[4:]])
    nearest = nearest_reachable(goal, arm=record)
    solutions = inverse_kinematics(nearest, home[3], arm=record)
    return np.concatenate([_nearest_to(home[:4], solutions), home[4:]])


def _nearest_to(home: FloatArray, solutions: Solutions) -> FloatArray:
    """The solution nearest to home (4,), free of self-collision if one is, (4,)."""
    try:
        return solutions.best(home)
    except SelfCollisionError:
        return solutions.best(home, allow_collision=True)


def _beside(
    record: Alpha5Parameters, goal: FloatArray, home: FloatArray
) -> FloatArray | None:
    """The solution (4,) nearest to home (4,), with axis_b as little turned as needed.

    It is free of self-collision if one is. None if no angle of axis_b that is tried
    reaches the goal (3,).
    """
    colliding = None
    for wrist in [home[3], *reaching_wrists(goal, home[3], record)]:
        solutions = inverse_kinematics(goal, wrist, arm=record)
        if not solutions.within_limits.any():
            continue
        if (solutions.within_limits & ~solutions.collides).any():
            return solutions.best(home)
        if colliding is None:
            colliding = solutions.best(home, allow_collision=True)
    return colliding


def _default_show(target: bool, current: bool) -> list[str]:
    """Groups that are shown if there is a target or a current."""
    shown = list(DEFAULT_SHOW)
    if target:
        shown.append("ghosts")
    if current:
        shown.append("current")
    return shown


def _beyond_limits(arm: Arm, q: FloatArray) -> dict[str, bool]:
    """Name of each joint of the arm -> whether it is beyond a limit."""
    inside = np.clip(q, arm.model.lowerPositionLimit, arm.model.upperPositionLimit)
    beyond = np.abs(q - inside) > _ROUNDING
    joints: list[bool] = beyond[-len(arm.joint_names) :].tolist()
    return dict(zip(arm.joint_names, joints, strict=True))


def _notes(arm: Arm, is_own: bool) -> tuple[str, ...]:
    """Lines about the arrows, and an arm of one's own."""
    arrows = f"Arrows: {1e3 * drawing.ARROW_SCALE:g} mm per newton."
    said = (f"{arrows} Torque: what each joint holds at rest.",)
    if not is_own:
        return said
    return *own_notes(arm.parameters, arm.floating_base), *said
