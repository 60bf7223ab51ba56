"""All solutions of the inverse kinematics for a target, as ghosts of the arm."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, float_array
from alpha5_model.description.urdf_reading import UrdfJoint
from alpha5_model.errors import ShapeError
from alpha5_model.kinematics.ik import BRANCHES, inverse_kinematics
from alpha5_model.view.arm_poses import link_poses
from alpha5_model.view.scene import WORLD, Label, Rigid, Shape
from alpha5_model.view.shapes import ball

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm

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
