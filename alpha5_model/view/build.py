"""From an arm and its joint positions to a scene with everything that can be seen of it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import choice, float_array
from alpha5_model.errors import ShapeError
from alpha5_model.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model.view.arm_poses import link_poses, motion_track, named_poses, tree_of, with_base
from alpha5_model.view.bodies import urdf_bodies
from alpha5_model.view.framing import framing
from alpha5_model.view.markers import (
    ARROW_SCALE,
    center_labels,
    center_shapes,
    force_labels,
    force_shapes,
    frame_labels,
    frame_shapes,
    ghosts_of,
    loads_of,
)
from alpha5_model.view.reach import workspace_shapes
from alpha5_model.view.scene import DEFAULT_SHOW, GROUPS, Rigid, Scene, Shape

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
        UnknownNameError: A group that there is not.
    """
    source = Path(JAWS_URDF_PATH if "axis_a" in arm.joint_names else URDF_PATH)
    text = source.read_text(encoding="utf-8")
    tree = tree_of(arm, text)
    sliders = arm.joint_names
    named = named_poses(arm)
    position = float_array("q", with_base(arm, named["home"]) if q is None else q, (arm.model.nq,))
    if position.ndim != 1:
        raise ShapeError("q", position.shape, f"shape ({arm.model.nq},)")
    poses = link_poses(arm, tree, position)
    loads = loads_of(arm, tree)
    if show is None:
        show = (*DEFAULT_SHOW, "ghosts") if target is not None else DEFAULT_SHOW
    shown = tuple(choice("group", group, tuple(GROUPS)) for group in show)
    folder = str(source.parent)
    shapes = [
        *_bodies(text, folder),
        *frame_shapes(tree),
        *center_shapes(loads),
        *force_shapes(arm, loads),
    ]
    shapes += [*_collision(text, folder), *workspace_shapes()]
    labels = [*frame_labels(tree, sliders), *center_labels(loads), *force_labels(arm, loads)]
    if target is not None:
        ghosts, ghost_labels = ghosts_of(arm, tree, shapes, position, target)
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
