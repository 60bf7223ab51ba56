"""Compare another model of the arm with ours: read, align, measure, judge."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, count
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm, is_catalogue
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.best_alignment import align
from alpha5_model.proofs.comparison.chains import (
    ANGLES,
    AXES,
    LENGTHS,
    TURNING,
    Chain,
    find_chains,
    our_shape,
)
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import FINDINGS, finding
from alpha5_model.proofs.comparison.four_joint_arm import DOWN, FourJointArm
from alpha5_model.proofs.comparison.inspection import all_findings
from alpha5_model.proofs.comparison.model_file import read_model
from alpha5_model.proofs.comparison.own_arm import (
    OwnArm,
    compared_record,
    own_arm_of,
    random_positions,
)
from alpha5_model.proofs.comparison.placement import bodies_in_our_frames
from alpha5_model.proofs.comparison.poses import rotation_of
from alpha5_model.proofs.comparison.printed_digits import as_meant
from alpha5_model.proofs.comparison.records import BodyDifference, Comparison, Finding
from alpha5_model.proofs.comparison.reduction import reduce_robot
from alpha5_model.proofs.comparison.tool import measure_tool

#: A chain whose misfit is larger belongs to another arm: a third of the upper arm. A
#: model of this arm with an offset on the wrong side has a misfit of 40 mm at most.
OTHER_ARM = 0.05  # [m]
#: The same if more joints follow, as on many other arms.
OTHER_ARM_IF_LONGER = 0.005  # [m]
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
    Each body is then compared with the tables in our link frame.

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
    folder = Path(path).parent
    return compare_robots(other, joints, samples, folder, base, arm=arm)


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
    meant = as_meant(other)
    chains = find_chains(meant, record, names)
    if not chains or not _is_ours(chains[0]):
        why = _another_arm(record, other, chains)
        return Comparison(name=other.name, findings=(why,), against=against)

    ours = own_arm_of(record)
    q = random_positions(record, number)
    arms = _reduced(ours, other, meant, chains[0], base)
    evidence = Evidence(
        ours=ours,
        other=other,
        theirs=arms.meant,
        written=arms.written,
        alignment=arms.alignment,
        bodies=_bodies(ours, arms.meant, arms.alignment),
        folder=folder,
        q=q,
    )
    return _compared(evidence, chains, against)


class Arms(NamedTuple):
    """The other arm as it is meant and as it is written, and the former's alignment."""

    meant: FourJointArm
    written: FourJointArm
    alignment: Alignment


def arms_of_model(
    other: UrdfRobot,
    names: Mapping[str, str] | None,
    base: str | None,
    parameters: Alpha5Parameters,
) -> Arms | None:
    """The arm of a model, aligned; None for a model of another arm.

    An arm whose joints are named as ours, or by the caller, may have any lengths.

    Args:
        other: The model.
        names: Our joint name -> theirs; see `compare`.
        base: The first link of the arm; see `compare`.
        parameters: Our arm.
    """
    meant = as_meant(other)
    chains = find_chains(meant, parameters, names)
    if not chains:
        return None
    is_named = chains[0].named_as_ours == len(AXES) or len(names or {}) == len(AXES)
    if not is_named and not _is_ours(chains[0]):
        return None
    return _reduced(own_arm_of(parameters), other, meant, chains[0], base)


def _reduced(
    ours: OwnArm, other: UrdfRobot, meant: UrdfRobot, chain: Chain, base: str | None
) -> Arms:
    """Reduce the other model to four joints, and align it with ours.

    Args:
        ours: Our arm.
        other: The other model as it is written.
        meant: The other model as it is meant.
        chain: Its four joints.
        base: The first link of its arm, if it is given.
    """
    parameters = ours.parameters
    arm = reduce_robot(meant, chain.joints, parameters, base)
    alignment = align(ours, arm)

    place = arm.base_path.index(alignment.base_link)
    before_base = set(arm.base_path[:place])
    is_foreign = before_base.issubset(arm.foreign_links)
    if base is None and alignment.same_base and not is_foreign:
        # A link before our base_link is not the arm's, even if it weighs nothing.
        base = alignment.base_link
        arm = reduce_robot(meant, chain.joints, parameters, base)

    written_joints = tuple(other.joints[name] for name in chain.names)
    written = reduce_robot(other, written_joints, parameters, base)
    return Arms(meant=arm, written=written, alignment=alignment)


def _bodies(
    ours: OwnArm, theirs: FourJointArm, alignment: Alignment
) -> tuple[BodyDifference, ...]:
    """The bodies of the other arm, each with ours."""
    coms, inertias = bodies_in_our_frames(ours, theirs, alignment)
    exact = alignment.exact or alignment
    exact_coms, _ = bodies_in_our_frames(ours, theirs, exact)
    slack = np.linalg.norm(exact_coms - coms, axis=1)
    bodies = []
    for k, link in enumerate(ours.parameters.links):
        bodies.append(
            BodyDifference(
                name=link.name,
                links=theirs.links[k],
                mass=float(theirs.mass[k]),
                com=coms[k],
                inertia=inertias[k],
                ours=link,
                slack=float(slack[k]),
            )
        )
    return tuple(bodies)


def _compared(evidence: Evidence, chains: Sequence[Chain], against: str) -> Comparison:
    """The comparison of a model of this arm.

    Args:
        evidence: Both arms.
        chains: All that could be this arm's joints; the first is compared.
        against: Name of our arm, if it is not the catalogue's.
    """
    theirs = evidence.theirs
    found = sorted(all_findings(evidence), key=_by_cost)
    links = evidence.other.links
    return Comparison(
        name=evidence.other.name,
        findings=(*found, *_second_arms(chains)),
        joints=_joint_names(chains[0]),
        alignment=evidence.alignment,
        bodies=evidence.bodies,
        tool=measure_tool(
            evidence.ours, evidence.written, theirs, evidence.alignment, evidence.q
        ),
        gravity_error=_gravity_error(evidence),
        mass_matrix_error=_mass_matrix_error(evidence),
        volume=theirs.volume or math.nan,
        carried={name: links[name].mass or 0.0 for name in theirs.foreign_links},
        against=against,
    )


def _by_cost(one: Finding) -> tuple[float, bool]:
    """Sorts the costliest first, and serious findings before remarks."""
    return -round(one.cost, 6), not one.serious


def _gravity_error(evidence: Evidence) -> FloatArray:
    """Largest error of the gravity torque in air, per joint, (4,) [N m]."""
    alignment = evidence.alignment
    # Gravity points down in our base frame, whatever the pose of the other root.
    down = rotation_of(alignment.base).T @ DOWN
    their_q = alignment.theirs(evidence.q)
    theirs = evidence.written.gravity_torque(their_q, down)
    ours = evidence.ours.reduced.gravity_torque(evidence.q)
    errors = np.abs(theirs * alignment.sign - ours)
    return np.asarray(errors.max(axis=0))


def _mass_matrix_error(evidence: Evidence) -> float:
    """Largest difference of an entry of the mass matrix [kg m^2]."""
    alignment = evidence.alignment
    signs = np.outer(alignment.sign, alignment.sign)
    their_q = alignment.theirs(evidence.q)
    theirs = evidence.written.mass_matrix(their_q)
    ours = evidence.ours.reduced.mass_matrix(evidence.q)
    errors = np.abs(theirs * signs - ours)
    return float(errors.max())


# ------------------------------------------------------------------------- other arms


def _is_ours(chain: Chain) -> bool:
    """Whether the axes of four joints have the shape of this arm's."""
    is_longer = chain.following >= 2
    return chain.misfit <= (OTHER_ARM_IF_LONGER if is_longer else OTHER_ARM)


def _joint_names(chain: Chain) -> dict[str, str]:
    """Our joint name -> theirs."""
    return dict(zip(AXES, chain.names, strict=True))


def _second_arms(chains: Sequence[Chain]) -> list[Finding]:
    """Remarks on further arms of this shape, such as a second one on the vehicle."""
    found = []
    for chain in chains[1:]:
        is_apart = set(chain.names).isdisjoint(chains[0].names)
        if _is_ours(chain) and is_apart:
            names = _joint_names(chain)
            mapping = ",".join(f"{ours}={theirs}" for ours, theirs in names.items())
            found.append(finding("second_arm", mapping=mapping))
    return found


def _another_arm(
    parameters: Alpha5Parameters, other: UrdfRobot, chains: Sequence[Chain]
) -> Finding:
    """Why a model is not of this arm.

    Args:
        parameters: Our arm.
        other: The model.
        chains: All that could be its joints, the best first.
    """
    turning = 0
    for joint in other.joints.values():
        if joint.kind in TURNING and joint.mimic is None:
            turning += 1
    if not chains:
        return finding("another_arm.without_joints", turning=turning)

    best = chains[0]
    worst = _worst_differences(best, our_shape(parameters))
    return finding(
        "another_arm",
        turning=turning,
        joints=", ".join(best.names),
        worst=", ".join(worst),
    )


def _worst_differences(chain: Chain, ours: FloatArray) -> list[str]:
    """The largest differences of a chain's shape from ours (7,), in words."""
    words = FINDINGS["another_arm"]["shape"]
    in_print = np.repeat([1e3, 180 / math.pi], (LENGTHS, ANGLES))  # [mm], [deg]
    theirs = chain.shape * in_print
    printed = ours * in_print
    worst = np.argsort(-chain.differences, kind="stable")[:WORST]
    return [
        words[k].format(theirs[k], printed[k])
        for k in worst
        if chain.differences[k] > 1e-3
    ]
