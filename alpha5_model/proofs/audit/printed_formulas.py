"""Sections 1.3 and 1.4: the printed inverse kinematics, from random joint positions.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3 and 1.4.
"""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.printed_inverse_kinematics import (
    published_inverse_kinematics,
)
from alpha5_model.proofs.audit.rounding import sampled_share
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.proofs.audit.table_1_lengths import lengths
from alpha5_model.theory.dh.chain import DHChain

#: Random joint positions.
SAMPLES = 4000
#: The poses of the document, in the order of `published_inverse_kinematics`.
POSES = ("underarm", "overarm")
#: Two angles that differ by less are the same [rad].
_SAME = 1e-6


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the printed inverse kinematics."""
    joints = parameters.joints[:4]
    lower = [joint.lower for joint in joints]
    upper = [joint.upper for joint in joints]
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    # The inverse kinematics are generated for the catalogue's arm.
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]

    solutions = published_inverse_kinematics(target)
    # The formulas do not mention the wrist.
    by_pose = {
        pose: np.column_stack([solutions[:, k], q[:, 3]])
        for k, pose in enumerate(POSES)
    }
    return [
        _elbow_offset(printed),
        *(_miss(pose, solution, chain, target) for pose, solution in by_pose.items()),
        *_recovered(list(by_pose.values()), q, target),
    ]


def _elbow_offset(printed: Published) -> AuditRow:
    a_2 = lengths(printed).a_2
    opposite = printed.elbow.opposite
    return audited(
        "inverse_kinematics.elbow_offset",
        measured=2 * a_2.si,
        bound=2 * a_2.rounding + opposite.rounding,
        expected=opposite.si,
    )


def _miss(
    pose: str, solution: FloatArray, chain: DHChain, target: FloatArray
) -> AuditRow:
    """The largest distance [m] between a target and the tcp at its solution."""
    exists = np.isfinite(solution).all(axis=-1)
    reached = chain.frames(solution[exists])[:, -1, :3, 3]
    miss = np.linalg.norm(reached - target[exists], axis=-1)
    return audited(
        f"inverse_kinematics.{pose}",
        measured=float(miss.max()),
        bound=None,
        targets=exists.sum(),
    )


def _recovered(
    solutions: list[FloatArray], q: FloatArray, target: FloatArray
) -> list[AuditRow]:
    """Shares of joint positions that the formulas recover, with wrapping and without.

    Args:
        solutions: Of the two formulas, (N, 4) each [rad].
        q: The joint positions, (N, 4) [rad].
        target: Their tcp, (N, 3) [m].
    """
    found: BoolArray = np.zeros(len(q), dtype=bool)
    as_printed: BoolArray = np.zeros(len(q), dtype=bool)
    for solution in solutions:
        same = np.isfinite(solution).all(axis=-1) & _is_same(wrap(solution - q))
        found |= same
        as_printed |= same & _is_same(solution - q)

    all_four = inverse_kinematics(target, q[:, 3]).q
    recovered = np.asarray(_is_same(all_four - q[:, None]).any(axis=-1))
    return [
        _share("branches", found, recovered),
        _share("wrapping", as_printed[found], recovered),
    ]


def _is_same(difference: FloatArray) -> BoolArray:
    """Which joint positions (..., 4) do not differ."""
    return np.asarray(np.abs(difference).max(axis=-1) < _SAME)


def _share(name: str, hits: BoolArray, recovered: BoolArray) -> AuditRow:
    share, error = sampled_share(hits)
    return audited(
        f"inverse_kinematics.{name}",
        measured=share,
        expected=1.0,
        standard_error=error,
        samples=SAMPLES,
        recovered=100 * recovered.mean(),
        missing=100 * (1 - share),
    )
