"""The comparison itself: both models measured at the same joint positions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray, count
from alpha5_model.comparison.alignment import (
    align,
    bodies_in_our_frames,
    our_tips,
    their_tips,
)
from alpha5_model.comparison.arm import AXES, FourJointArm, reduce_robot
from alpha5_model.comparison.axis_fit import Alignment
from alpha5_model.comparison.bodies import Cost
from alpha5_model.comparison.findings import collision_volume, findings
from alpha5_model.comparison.mapping import (
    TURNING,
    Chain,
    find_chains,
    map_joints,
    our_shape,
)
from alpha5_model.comparison.reading import read_model
from alpha5_model.comparison.records import BodyDifference, Comparison, Finding
from alpha5_model.comparison.rounding import as_meant
from alpha5_model.description.urdf_reading import UrdfRobot, parse_urdf
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.fluids import GRAVITY
from alpha5_model.parameters import parameters

#: Shapes of axes that lie farther apart than this are not the same arm's: a third of the upper arm.
#: A model of this arm with an offset on the wrong side comes to 40 mm at most.
OTHER_ARM = 0.05  # [m]
SAME_SHAPE = 0.005  # [m]
LENGTHS = (
    "axis_d from axis_e",
    "axis_c from axis_d",
    "axis_b from axis_c",
    "the elbow out of the arm's plane",
)
TWISTS = ("axis_d to axis_e", "axis_c to axis_d", "axis_b to axis_c")


def compare(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    samples: int = 500,
    base: str | None = None,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> Comparison:
    """Hold another model of this arm against ours.

    The arm is found by the shape of its axes, the bases are aligned by the joint axes, every other
    joint is frozen with the jaws closed, what carries the arm is left out, and each body is compared in
    our link frame with the tables.

    Args:
        path: A URDF, or a xacro file that makes one. Meshes need not be there.
        joints: Our joint name -> theirs, for those that axes and names do not tell.
        samples: Random configurations for the kinematic and dynamic errors.
        base: The first link of the arm, if something carries it; found by its mass if None.
        packages: Of a xacro file: name of each package in ``$(find NAME)`` -> its folder.
        arguments: Of a xacro file: values of its arguments, as text.

    Returns:
        The comparison; ``agrees`` and ``verdict`` say how it ends. Another arm is no error: the
        verdict says that it is not a Reach Alpha 5, and why.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read; the message says where.
        UnknownNameError, InputError: A joint or link is not there, or the joints cannot be mapped.
    """
    other = read_model(path, packages, arguments)
    return compare_robots(other, joints, samples, Path(path).parent, base)


def compare_robots(
    other: UrdfRobot,
    names: Mapping[str, str] | None = None,
    samples: int = 500,
    folder: Path | None = None,
    base: str | None = None,
) -> Comparison:
    """As `compare`, for a model that is read already; ``folder`` is where its meshes are."""
    tables, ours, count_ = parameters(), _ours(), count("samples", samples)
    chains = find_chains(as_meant(other), names)
    if not chains or not _is_ours(chains[0]):
        return _another_arm(other, chains)
    mapped = chains[0].joints
    theirs = reduce_robot(as_meant(other), mapped, base)
    alignment = align(ours, theirs)
    way = theirs.base_path[: theirs.base_path.index(alignment.base_link)]
    if base is None and alignment.same_base and not set(way) <= set(theirs.carried):
        # What stands before our base_link carries it, even if it is as light as nothing.
        base = alignment.base_link
        theirs = reduce_robot(as_meant(other), mapped, base)
    written = reduce_robot(other, tuple(other.joints[j.name] for j in mapped), base)
    com, inertia = bodies_in_our_frames(ours, theirs, alignment)
    exact = bodies_in_our_frames(ours, theirs, alignment.exact or alignment)[0]
    bodies = tuple(
        BodyDifference(
            name=link.name,
            links=theirs.links[i],
            mass=float(theirs.mass[i]),
            com=com[i],
            inertia=inertia[i],
            ours=link,
            slack=float(np.linalg.norm(exact[i] - com[i])),
        )
        for i, link in enumerate(tables.links)
    )
    rng = np.random.default_rng(0)
    lower = np.array([joint.lower for joint in tables.joints[:4]])
    upper = np.array([joint.upper for joint in tables.joints[:4]])
    q = rng.uniform(lower, upper, (count_, 4))
    tips = our_tips(q) - their_tips(written, alignment, q)
    gravity_error, mass_matrix_error = _dynamic_errors(ours, written, alignment, q)
    cost = _gravity_cost(ours, q)
    found = findings(other, ours, theirs, written, alignment, bodies, q, cost, folder)
    return Comparison(
        name=other.name,
        joints={axis: joint.name for axis, joint in zip(AXES, mapped, strict=True)},
        alignment=alignment,
        bodies=bodies,
        tip_error=float(np.linalg.norm(tips, axis=1).max()),
        gravity_error=gravity_error,
        mass_matrix_error=mass_matrix_error,
        volume=collision_volume(theirs),
        findings=(*found, *_other_arms(chains)),
        carried={name: other.links[name].mass or 0.0 for name in theirs.carried},
    )


def _is_ours(chain: Chain) -> bool:
    """An arm that goes on behind axis_b has to be of just this shape to be more than alike."""
    return chain.misfit <= (OTHER_ARM if chain.following < 2 else SAME_SHAPE)


def _another_arm(other: UrdfRobot, chains: list[Chain]) -> Comparison:
    """The verdict for a model that is not of this arm."""
    turning = [j for j in other.joints.values() if j.kind in TURNING and j.mimic is None]
    if not chains:
        why = (
            f"no four joints turn one after another, as its four do ({len(turning)} turning joints "
            "in all)"
        )
    else:
        closest, (lengths, twists) = chains[0], our_shape()
        rows = [
            (abs(a - b), f"{words} {a * 1e3:.0f} mm (ours {b * 1e3:.0f})")
            for a, b, words in zip(closest.lengths, lengths, LENGTHS, strict=True)
        ]
        rows += [
            (
                abs(a - b) * lengths[1],
                f"{words} {math.degrees(a):.0f} deg (ours {math.degrees(b):.0f})",
            )
            for a, b, words in zip(closest.twists, twists, TWISTS, strict=True)
        ]
        worst = sorted(rows, key=lambda row: -row[0])[:3]
        names = ", ".join(joint.name for joint in closest.joints)
        why = (
            f"of its {len(turning)} turning joints {names} come closest, with "
            f"{', '.join(text for off, text in worst if off > 1e-3)}"
        )
    return Comparison(
        name=other.name,
        joints={},
        alignment=Alignment(np.eye(4), np.ones(4), np.zeros(4), residual=(math.nan, math.nan)),
        bodies=(),
        tip_error=math.nan,
        gravity_error=np.full(4, math.nan),
        mass_matrix_error=math.nan,
        volume=math.nan,
        findings=(Finding("arm", f"This is not a Reach Alpha 5: {why}."),),
    )


def _other_arms(chains: list[Chain]) -> Iterator[Finding]:
    """Further chains of the shape of this arm, such as a second arm on the vehicle."""
    names = [joint.name for joint in chains[0].joints]
    for chain in chains[1:]:
        others = [joint.name for joint in chain.joints]
        if _is_ours(chain) and not set(names) & set(others):
            mapping = ",".join(f"{a}={n}" for a, n in zip(AXES, others, strict=True))
            text = f"another arm of this shape is there: compare it with --map {mapping}"
            yield Finding("arm", text, serious=False)


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
