"""Frames and references of Sections 1.1, 2 and 2.2, and the inverse kinematics of Sections 1.3 and 1.4.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1, 1.3, 1.4, 2 and 2.2.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from alpha5_model.consistency.row import ARITHMETIC, AuditRow, audited, figure, sampled_share
from alpha5_model.consistency.units import GRAVITY, MM, excess_of_box
from alpha5_model.dh import DHChain
from alpha5_model.kinematics.ik import inverse_kinematics, published_inverse_kinematics
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import Published
from alpha5_model.spatial import wrap

#: Random joint positions that the printed formulas are tried on.
SAMPLES = 4000
#: Where the document sends the reader for the frames: section -> the section it names, and the section that
#: places the frames.
REFERENCES = {"1.1": ("2", "2"), "2.2": ("2.1", "2")}


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of frames and inverse kinematics."""
    return [
        *_frames(printed, p),
        _base_frame(printed, p),
        _elbow_sine(printed),
        *_inverse_kinematics(p),
    ]


def _base_frame(printed: Published, p: Alpha5Parameters) -> AuditRow:
    row, link = printed.table_2.rows[0], p.links[0]
    measured, bound = figure(lambda x: excess_of_box(x * [-1, -1, 1], link.bounds), row.com)
    displaced = 2 * float(np.hypot(*link.com[:2]))
    return audited(
        "base_frame.link_0",
        measured,
        bound=bound,
        effect=displaced * link.mass * GRAVITY,
        moved=f"{displaced / MM:.1f}",
    )


def _frames(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    first = float(printed.table_1.rows[0].link) - 1
    return [
        audited("frames.first", first),
        audited("frames.aligned", max(abs(row.alpha) for row in p.dh[:4]), bound=ARITHMETIC),
        *(
            audited(
                f"cross_reference.section_{section}",
                float(named),
                float(right),
                section=section,
                named=named,
                right=right,
            )
            for section, (named, right) in REFERENCES.items()
        ),
    ]


def _elbow_sine(printed: Published) -> AuditRow:
    a_2, opposite = printed.table_1.rows[2].a, printed.elbow.opposite
    assert isinstance(a_2, Quantity)  # a_1 is the only symbol in the column a
    bound = 2 * a_2.rounding + opposite.rounding
    return audited("inverse_kinematics.elbow_offset", 2 * a_2.si, opposite.si, bound)


def _inverse_kinematics(p: Alpha5Parameters) -> list[AuditRow]:
    """Random joint positions within the limits: where do the printed formulas lead?"""
    joints = p.joints[:4]
    lower, upper = np.array([j.lower for j in joints]), np.array([j.upper for j in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]
    rows, found, as_printed = [], np.zeros(SAMPLES, dtype=bool), np.zeros(SAMPLES, dtype=bool)
    printed = published_inverse_kinematics(target)
    for k, name in enumerate(("underarm", "overarm")):
        solution = np.concatenate([printed[:, k], q[:, 3:]], axis=-1)
        exists = np.isfinite(solution).all(axis=-1)
        reached = chain.frames(solution[exists])[:, -1, :3, 3]
        miss = float(np.linalg.norm(reached - target[exists], axis=-1).max())
        same = exists & (np.abs(wrap(solution - q)).max(axis=-1) < 1e-6)
        found |= same
        as_printed |= same & (np.abs(solution - q).max(axis=-1) < 1e-6)
        claim = f"inverse_kinematics.{name}"
        rows.append(audited(claim, miss, bound=ARITHMETIC, targets=int(exists.sum())))
    ours = inverse_kinematics(target, q[:, 3]).q
    recovered = (np.abs(ours - q[:, None]).max(axis=-1) < 1e-6).any(axis=-1)
    words: dict[str, Any] = {"samples": SAMPLES, "recovered": f"{100 * recovered.mean():.4g}"}
    for name, hits in (("branches", found), ("wrapping", as_printed[found])):
        share, error = sampled_share(hits)
        claim = f"inverse_kinematics.{name}"
        rows.append(audited(claim, share, 1.0, standard_error=error, **words))
    return rows
