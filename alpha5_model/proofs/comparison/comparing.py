"""Compare another model of the arm with ours: read, reduce, describe, judge."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, count
from alpha5_model._support.spatial import angles_between
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.inertia import second_moments
from alpha5_model.numbers.jaws import loaded_links
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    LinkParameters,
    chosen_arm,
    is_catalogue,
)
from alpha5_model.numbers.pose import tool_of
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.bodies import bodies_of, findings_of_bodies
from alpha5_model.proofs.comparison.corrections import angle_between
from alpha5_model.proofs.comparison.described import Described, describe, describe_like
from alpha5_model.proofs.comparison.differences import (
    Evidence,
    differences,
    tool_in_wrist,
)
from alpha5_model.proofs.comparison.digits import as_meant
from alpha5_model.proofs.comparison.jaw_joints import jaw_joints
from alpha5_model.proofs.comparison.joint_mistakes import (
    turned_base_joint,
    without_joint_mistakes,
)
from alpha5_model.proofs.comparison.lint import lint
from alpha5_model.proofs.comparison.model import (
    TURNING,
    Chain,
    find_chains,
    our_shape,
    read_model,
)
from alpha5_model.proofs.comparison.reduced import Reduced, reduce
from alpha5_model.proofs.comparison.result import (
    FINDINGS,
    Comparison,
    Correction,
    Finding,
    ToolDifference,
    finding,
)

#: How many differences of another arm are reported.
WORST = 3


def compare(
    path: str | Path,
    joints: Mapping[str, str] | None = None,
    samples: int = 500,
    base: str | None = None,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
    xacro: bool = False,
    arm: Alpha5Parameters | None = None,
) -> Comparison:
    """Compare another model of this arm with ours.

    The arm is found by the shape of its axes. All other joints are frozen, with the
    jaws closed, and what carries the arm is left out. The joint axes align the bases.
    Each body is then compared with the tables in our link frame. Numbers differ if they
    differ by more than half a unit of the last digit that the file writes.

    Args:
        path: A URDF, or a xacro file that makes one. Meshes need not be there. A URDF
            is read as it is: nothing in it is executed, and no other file is read.
        joints: Our joint name -> theirs, for those that cannot be found by axes and
            names.
        samples: Random configurations for the kinematic and dynamic errors.
        base: The first link of the arm, if something carries it; found by its mass if
            None.
        packages: For a xacro file: name of each package in ``$(find NAME)`` -> its
            folder. The package of the file itself is found by the ``package.xml`` above
            it.
        arguments: For a xacro file: values of its arguments, as text.
        xacro: Expand a xacro file. It is a program, which can read files and run
            commands: do so only if you trust it.
        arm: Record of an arm of your own, to compare with instead of the catalogue's.

    Returns:
        The comparison; ``agrees`` and ``verdict`` are its outcome. Another arm is not
        an error: the verdict then explains why it is not a Reach Alpha 5.

    Raises:
        MissingFileError, FileFormatError: The file cannot be read, or is a xacro file
            that is not to be expanded. The message names the place and the remedy.
        UnknownNameError, InputError: A joint or link is not there, or the joints cannot
            be mapped.
    """
    other = read_model(path, packages, arguments, xacro)
    return compare_robots(other, joints, samples, Path(path).parent, base, arm=arm)


def compare_robots(
    other: UrdfRobot,
    names: Mapping[str, str] | None = None,
    samples: int = 500,
    folder: Path | None = None,
    base: str | None = None,
    arm: Alpha5Parameters | None = None,
) -> Comparison:
    """Compare a model that has been read.

    Args:
        other: The model.
        names: Our joint name -> theirs; see `compare`.
        samples: Random configurations; see `compare`.
        folder: Where its meshes are; None if unknown.
        base: The first link of the arm; see `compare`.
        arm: Record of an arm of your own; see `compare`.
    """
    number = count("samples", samples)
    own = chosen_arm(arm)
    if own.base_yaw:
        expected = "a record with the correction base_frame, for link_0's numbers"
        raise InputError("corrections", own.corrections, expected)
    record = compared_record(own)
    against = "" if is_catalogue(own) else own.name
    mended, slips = without_joint_mistakes(other, record, names)
    meant = as_meant(mended)
    chains = find_chains(meant, record, names)
    if not chains or not chains[0].is_ours:
        why = _another_arm(record, other, chains)
        return Comparison(name=other.name, findings=(why,), against=against)

    model = reduce_and_describe(meant, chains[0], record, base)
    turned = turned_base_joint(meant, model.reduced, model.described, record)
    if turned is not None:
        slips.append(turned)
        right = {turned.right.name: turned.right}
        meant = replace(meant, joints={**meant.joints, **right})
        model = reduce_and_describe(meant, chains[0], record, base)
    jaws = jaw_joints(meant, model.reduced, model.described, own)
    has_wrong_jaws = any(jaw.correction for jaw in jaws)
    if has_wrong_jaws:
        right = {jaw.joint.name: jaw.right for jaw in jaws}
        meant = replace(meant, joints={**meant.joints, **right})
        model = reduce_and_describe(meant, chains[0], record, base)
    evidence = Evidence(
        arm=own,
        record=record,
        other=other,
        robot=meant,
        meant=model.reduced,
        written=_as_written(other, model, record, bool(slips) or has_wrong_jaws),
        described=model.described,
        base=model.base,
        slips=tuple(slips),
        jaws=jaws,
        folder=folder,
        q=random_positions(record, number),
    )
    found = [*differences(evidence), *findings_of_bodies(evidence)]
    found += _stumbling_blocks(evidence, found)
    found.sort(key=lambda one: (-round(one.cost, 6), not one.serious))
    links = other.links
    gravity, mass_matrix = _dynamic_errors(evidence)
    return Comparison(
        name=other.name,
        findings=(*found, *_second_arms(chains)),
        joints=chains[0].mapping,
        alignment=evidence.described,
        bodies=bodies_of(evidence),
        tool=_tool(evidence),
        gravity_error=gravity,
        mass_matrix_error=mass_matrix,
        volume=evidence.meant.volume or math.nan,
        carried={name: links[name].mass or 0.0 for name in evidence.meant.foreign},
        against=against,
    )


def _stumbling_blocks(evidence: Evidence, found: Sequence[Finding]) -> list[Finding]:
    """What programs refuse or read differently, mended as the other findings say.

    Args:
        evidence: Both arms.
        found: The other findings.
    """
    advice: dict[tuple[str, str], dict[str, Mapping[str, str] | None]] = {}
    for one in found:
        for correction in one.corrections:
            elements = advice.setdefault((correction.kind, correction.name), {})
            elements.update(correction.elements)
    for right in evidence.right_joints:
        if right.correction is not None:
            advice["joint", right.joint.name] = dict(right.correction.elements)
    for jaw in evidence.jaws:
        if jaw.correction is not None:
            advice["joint", jaw.joint.name] = dict(jaw.correction.elements)

    joints = [right.joint for right in evidence.right_joints]
    jaws = {jaw.joint.name: jaw.ours for jaw in evidence.jaws}
    right_joints = {
        name: Correction(kind, name, elements)
        for (kind, name), elements in advice.items()
        if kind == "joint"
    }
    links = {name for kind, name in advice if kind == "link"}
    blocks = []
    for one in lint(evidence.other, joints, evidence.record, right_joints, links, jaws):
        corrections = tuple(
            replace(
                correction,
                elements={
                    **correction.elements,
                    **advice.get((correction.kind, correction.name), {}),
                },
            )
            for correction in one.corrections
        )
        blocks.append(replace(one, corrections=corrections))
    return blocks


class Model(NamedTuple):
    """A model, reduced and described, and the first link of its arm, if it is known."""

    reduced: Reduced
    described: Described
    base: str | None


def reduce_and_describe(
    meant: UrdfRobot, chain: Chain, record: Alpha5Parameters, base: str | None
) -> Model:
    """Reduce a model to four joints, and describe it in our terms.

    Args:
        meant: The model, with exact multiples of pi.
        chain: Its four joints.
        record: Our arm.
        base: The first link of its arm, if it is given.
    """
    reduced = reduce(meant, chain.joints, record, base)
    described = describe(reduced, record)
    place = reduced.base_path.index(described.base_link)
    before_base = set(reduced.base_path[:place])
    if base is None and described.same_base and not before_base <= {*reduced.foreign}:
        # A link before our base_link is not the arm's, even if it weighs nothing.
        base = described.base_link
        reduced = reduce(meant, chain.joints, record, base)
        described = describe_like(reduced, record, described)
    return Model(reduced=reduced, described=described, base=base)


def _as_written(
    other: UrdfRobot, model: Model, record: Alpha5Parameters, is_mended: bool
) -> Reduced:
    """The other model, reduced, with its joints as they are written.

    Args:
        other: The model as it is written.
        model: It as it is meant.
        record: Our arm.
        is_mended: Whether its joints were mended.
    """
    if not (model.reduced.digits.pi or is_mended):
        return model.reduced
    joints = tuple(other.joints[joint.name] for joint in model.reduced.joints)
    return reduce(other, joints, record, model.base)


# --- Our arm --------------------------------------------------------------------------


@lru_cache(maxsize=4)
def compared_record(arm: Alpha5Parameters) -> Alpha5Parameters:
    """The record that other models are compared with.

    What is attached to a link, and the jaws that a spacer moves, are part of that link,
    as in a URDF. The mount is left out: a comparison aligns the bases.
    """
    if is_catalogue(arm):
        return arm
    pairs = zip(arm.links, loaded_links(arm), strict=True)
    links = [own if own is loaded else _widened(own, loaded) for own, loaded in pairs]
    return replace(arm, links=tuple(links), attached=(), mount=None)


def _widened(link: LinkParameters, loaded: RigidBody) -> LinkParameters:
    """A link with what it carries, its bounds wide enough for that."""
    spread = np.sqrt(3 * np.diag(second_moments(loaded.inertia)) / loaded.mass)
    ends = np.column_stack([loaded.com - spread, loaded.com + spread])
    return LinkParameters(
        name=link.name,
        mass=loaded.mass,
        com=loaded.com,
        inertia=loaded.inertia,
        volume=loaded.volume,
        cob=loaded.cob,
        bounds=np.column_stack(
            [
                np.minimum(link.bounds[:, 0], ends[:, 0]),
                np.maximum(link.bounds[:, 1], ends[:, 1]),
            ]
        ),
    )


@lru_cache(maxsize=4)
def random_positions(record: Alpha5Parameters, number: int) -> FloatArray:
    """Joint positions within our limits, (number, 4) [rad]; always the same."""
    joints = record.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    return np.random.default_rng(0).uniform(lower, upper, (number, 4))


# --- Errors over the positions --------------------------------------------------------


def _dynamic_errors(evidence: Evidence) -> tuple[FloatArray, float]:
    """Largest errors of the gravity torques in air and of the mass matrix.

    Returns:
        Per joint, (4,) [N m], and of any entry [kg m^2].
    """
    described = evidence.described
    there = described.theirs(evidence.q)
    # Gravity points down in our base frame, whatever the pose of the other root.
    down = described.base[:3, :3].T @ GRAVITY
    torque = evidence.written.gravity_torque(there, down) * described.sign
    gravity = np.abs(torque - evidence.our_torque).max(axis=0)

    signs = np.outer(described.sign, described.sign)
    matrices = evidence.written.mass_matrices(there) * signs
    errors = np.abs(matrices - evidence.ours.mass_matrices(evidence.q))
    return np.asarray(gravity), float(errors.max())


def _tool(evidence: Evidence) -> ToolDifference:
    """How far their tool is from ours."""
    described = evidence.described
    ours = tool_of(evidence.record).matrix
    expected = evidence.ours.wrist_poses(evidence.q) @ ours
    to_base = described.base
    if described.same_base:
        base_link = evidence.written.link_poses[described.base_link]
        to_base = np.asarray(np.linalg.inv(base_link), np.float64)
    tool = tool_in_wrist(evidence, evidence.written)
    there = described.theirs(evidence.q)
    same = to_base @ evidence.written.wrist_poses(evidence.q) @ tool
    matched = to_base @ evidence.written.wrist_poses(there) @ tool

    in_wrist = described.placed[4] @ tool_in_wrist(evidence, evidence.meant)
    return ToolDifference(
        frame=evidence.meant.tool,
        base=described.base_link if described.same_base else "",
        offset=float(np.linalg.norm(in_wrist[:3, 3] - ours[:3, 3])),
        turned=angle_between(ours, in_wrist),
        distance=_distances(same, expected),
        angle=angles_between(same, expected),
        matched_distance=_distances(matched, expected),
        matched_angle=angles_between(matched, expected),
    )


def _distances(one: FloatArray, other: FloatArray) -> FloatArray:
    """Distances between the origins of poses (N, 4, 4), (N,) [m]."""
    return np.asarray(np.linalg.norm(one[:, :3, 3] - other[:, :3, 3], axis=1))


# --- Other arms -----------------------------------------------------------------------


def _second_arms(chains: Sequence[Chain]) -> list[Finding]:
    """Remarks on further arms of this shape, such as a second one on the vehicle."""
    found = []
    for chain in chains[1:]:
        is_apart = set(chain.names).isdisjoint(chains[0].names)
        if chain.is_ours and is_apart:
            names = chain.mapping.items()
            mapping = ",".join(f"{ours}={theirs}" for ours, theirs in names)
            found.append(finding("second_arm", mapping=mapping))
    return found


def _another_arm(
    record: Alpha5Parameters, other: UrdfRobot, chains: Sequence[Chain]
) -> Finding:
    """Why a model is not of this arm.

    Args:
        record: Our arm.
        other: The model.
        chains: All that could be its joints, the best first.
    """
    joints = other.joints.values()
    turning = sum(one.kind in TURNING and one.mimic is None for one in joints)
    if not chains:
        return finding("another_arm.without_joints", turning=turning)

    best = chains[0]
    words = FINDINGS["another_arm"]["shape"]
    in_print = np.array([1e3] * 4 + [180 / math.pi] * 3)  # [mm], [deg]
    theirs = best.shape * in_print
    printed = our_shape(record) * in_print
    worst = [
        words[k].format(theirs[k], printed[k])
        for k in np.argsort(-best.differences, kind="stable")[:WORST]
        if best.differences[k] > 1e-3
    ]
    return finding(
        "another_arm",
        turning=turning,
        joints=", ".join(best.names),
        worst=", ".join(worst),
    )
