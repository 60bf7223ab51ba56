"""The comparison itself: both models measured at the same joint positions."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray, count
from alpha5_model.comparison.alignment import (
    Alignment,
    align,
    bodies_in_our_frames,
    body_transforms,
    tip_distance,
)
from alpha5_model.comparison.bodies import Cost
from alpha5_model.comparison.findings import collision_volume, findings
from alpha5_model.comparison.mapping import AXES, FourJointArm, map_joints, reduce_robot
from alpha5_model.comparison.records import BodyDifference, Comparison
from alpha5_model.description.urdf_reading import UrdfRobot, parse_urdf, read_urdf
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.fluids import GRAVITY
from alpha5_model.parameters import parameters


def compare(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    samples: int = 500,
) -> Comparison:
    """Hold another URDF of this arm against ours.

    Joints are mapped by name, the bases are aligned by the joint axes, every other joint is frozen with
    the jaws closed, and each body is compared in our link frame with the tables.

    Args:
        path: The other URDF. Meshes need not be there.
        joints: Our joint name -> theirs, for those that names do not tell.
        samples: Random configurations for the kinematic and dynamic errors.

    Returns:
        The comparison; ``agrees`` is the verdict.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read; the message says where.
        UnknownNameError, InputError: The joints cannot be mapped.
    """
    other = read_urdf(path)
    return compare_robots(other, joints, samples, Path(path).parent)


def compare_robots(
    other: UrdfRobot,
    names: Mapping[str, str] | None = None,
    samples: int = 500,
    folder: Path | None = None,
) -> Comparison:
    """As `compare`, for a model that is read already; ``folder`` is where its meshes are."""
    tables = parameters()
    ours = _ours()
    mapped = map_joints(other, names)
    theirs = reduce_robot(other, mapped)
    alignment = align(ours, theirs)
    com, inertia = bodies_in_our_frames(ours, theirs, alignment)
    bodies = tuple(
        BodyDifference(
            name=link.name,
            links=theirs.links[i],
            mass=float(theirs.mass[i]),
            com=com[i],
            inertia=inertia[i],
            ours=link,
        )
        for i, link in enumerate(tables.links)
    )
    rng = np.random.default_rng(0)
    lower = np.array([joint.lower for joint in tables.joints[:4]])
    upper = np.array([joint.upper for joint in tables.joints[:4]])
    q = rng.uniform(lower, upper, (count("samples", samples), 4))
    reach = -tables.dh[3].d
    tip_error = max(tip_distance(ours, theirs, alignment, reach, row) for row in q)
    gravity_error, mass_matrix_error = _dynamic_errors(ours, theirs, alignment, q)
    return Comparison(
        name=other.name,
        joints={axis: joint.name for axis, joint in zip(AXES, mapped, strict=True)},
        alignment=alignment,
        bodies=bodies,
        tip_error=tip_error,
        gravity_error=gravity_error,
        mass_matrix_error=mass_matrix_error,
        volume=collision_volume(theirs),
        findings=findings(
            other,
            ours,
            theirs,
            alignment,
            body_transforms(ours, theirs, alignment),
            bodies,
            tip_error,
            _gravity_cost(ours, q),
            folder,
        ),
    )


@cache
def _ours() -> FourJointArm:
    """Our own arm, generated from the tables and read like any other."""
    robot = parse_urdf(urdf(Variant(dh_frames=True)))
    return reduce_robot(robot, map_joints(robot))


def _dynamic_errors(
    ours: FourJointArm, theirs: FourJointArm, alignment: Alignment, samples: FloatArray
) -> tuple[FloatArray, float]:
    import pinocchio as pin

    models = [_model(ours), _model(theirs)]
    # Gravity points down in our base frame, wherever the other root stands.
    models[0].gravity.linear = np.array(GRAVITY)
    models[1].gravity.linear = alignment.base[:3, :3].T @ np.array(GRAVITY)
    data = [model.createData() for model in models]
    signs = alignment.sign
    gravity, matrix = np.zeros(4), 0.0
    for q in samples:
        there = alignment.theirs(q)
        g = pin.computeGeneralizedGravity(models[1], data[1], there) * signs
        gravity = np.maximum(
            gravity, np.abs(g - pin.computeGeneralizedGravity(models[0], data[0], q))
        )
        m = pin.crba(models[1], data[1], there) * np.outer(signs, signs)
        matrix = max(matrix, float(np.abs(m - pin.crba(models[0], data[0], q)).max()))
    return gravity, matrix


def _gravity_cost(ours: FourJointArm, samples: FloatArray) -> Cost:
    """What an error of one body's mass and first moment is worth in gravity torque in air [N m].

    Gravity torque is linear in both: its regressor [Atkeson1986] at the sampled positions says all. The base
    is held by no joint and costs nothing.
    """
    import pinocchio as pin

    model = _model(ours)
    model.gravity.linear = np.array(GRAVITY)
    data, rest = model.createData(), np.zeros(4)
    rows = [pin.computeJointTorqueRegressor(model, data, q, rest, rest).copy() for q in samples]
    regressor = np.array(rows).reshape(-1, 4, 4, 10)[..., :4]  # sample, joint, body, number

    def cost(body: int, mass: float, moment: FloatArray) -> float:
        return float(np.abs(regressor[:, :, body - 1] @ [mass, *moment]).max()) if body else 0.0

    return cost


def _model(arm: FourJointArm) -> Any:
    import pinocchio as pin

    model, parent = pin.Model(), 0
    for i, joint in enumerate(arm.joints):
        placement = pin.SE3(arm.placements[i])
        # an unaligned axis keeps whatever direction the file gives
        kind = pin.JointModelRevoluteUnaligned(arm.axes[i])
        parent = model.addJoint(parent, kind, placement, joint.name)
        body = pin.Inertia.Zero()  # filled by parts: the constructor refuses impossible tensors
        body.mass, body.lever, body.inertia = arm.mass[i + 1], arm.com[i + 1], arm.inertia[i + 1]
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    return model
