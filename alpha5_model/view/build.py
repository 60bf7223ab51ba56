"""From an arm and its joint positions to a scene with everything that can be seen of it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import choice, shaped
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.view.arm_poses import link_poses, motion_track, named_poses, tree_of, with_base
from alpha5_model.view.bodies import urdf_bodies
from alpha5_model.view.framing import framing
from alpha5_model.view.markers import ARROW_SCALE, frame_markers, ghosts_of, load_markers, loads_of
from alpha5_model.view.reach import workspace_shapes
from alpha5_model.view.scene import DEFAULT_SHOW, GROUPS, Label, Rigid, Scene, Shape

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.trajectory.motion import Motion


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
        show: Groups to show, of `alpha5_model.view.scene.GROUPS`; the others can be switched on. If
            None: bodies, labels, centres, and the ghosts if there is a target.

    Raises:
        InputError: Joint positions or a target that do not fit (`ShapeError`, `NonFiniteError`).
        UnknownNameError: An unknown group.
    """
    source = Path(JAWS_URDF_PATH if "axis_a" in arm.joint_names else URDF_PATH)
    text = source.read_text(encoding="utf-8")
    tree = tree_of(arm, text)
    sliders = arm.joint_names
    named = named_poses(arm)
    position = shaped("q", with_base(arm, named["home"]) if q is None else q, (arm.model.nq,))
    poses = link_poses(arm, tree, position)
    loads = loads_of(arm, tree)
    if show is None:
        show = DEFAULT_SHOW if target is None else (*DEFAULT_SHOW, "ghosts")
    shown = tuple(choice("group", group, tuple(GROUPS)) for group in show)
    bodies = list(_bodies(text, str(source.parent)))
    things: list[Shape | Label] = [
        *bodies,
        *frame_markers(tree, sliders),
        *load_markers(arm, loads),
        *_collision(text, str(source.parent)),
        *workspace_shapes(),
    ]
    if target is not None:
        things += ghosts_of(arm, tree, bodies, position, target)
    shapes = tuple(thing for thing in things if isinstance(thing, Shape))
    weight, lift = sum(load.weight for load in loads), sum(load.buoyancy for load in loads)
    water = f"In water of {arm.fluid_density:g} kg/m\u00b3: weight {weight:.2f} N, buoyancy {lift:.2f} N."
    return Scene(
        title="Reach Alpha 5",
        notes=(
            water if arm.fluid_density else f"In air: weight {weight:.2f} N.",
            f"Arrows: {1e3 * ARROW_SCALE:g} mm per newton. Torque: what each joint holds at rest.",
        ),
        tree=tree,
        sliders=sliders,
        q=position[arm.model.nq - len(sliders) :],
        poses=poses,
        shapes=shapes,
        labels=tuple(thing for thing in things if isinstance(thing, Label)),
        loads=loads,
        gravity=np.array(arm.model.gravity.linear),
        camera=framing(shapes, poses, shown),
        show=shown,
        named_poses=named,
        motion=None if motion is None else motion_track(motion, sliders, position),
    )


def _bodies(text: str, folder: str) -> Iterator[Shape]:
    for body in urdf_bodies(text, folder):
        # Only highlights show the form of a dark body.
        shine = 0.9 if max(body.color) < 0.4 else 0.4
        name = f"{body.link}/part_{body.index}"
        yield Shape("bodies", name, Rigid(body.link), body.mesh, body.color, shine=shine)


def _collision(text: str, folder: str) -> Iterator[Shape]:
    for body in urdf_bodies(text, folder, "collision"):
        name = f"{body.link}_{body.index}"
        yield Shape("collision", name, Rigid(body.link), body.mesh, body.color, opacity=0.35)
