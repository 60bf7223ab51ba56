"""Frames and references of Sections 1.1, 2 and 2.2, and the inverse kinematics of Sections 1.3 and 1.4.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1, 1.3, 1.4, 2 and 2.2.
"""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import (
    ARITHMETIC,
    AuditRow,
    judged,
    rounding_bound,
    sampled_share,
)
from alpha5_model.consistency.units import GRAVITY, MM, excess_of_box
from alpha5_model.kinematics.dh import DHChain
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.kinematics.ik_published import published_inverse_kinematics
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
        _first_frame(printed),
        _base_frame(printed, p),
        _aligned(p),
        *_references(),
        _elbow_sine(printed),
        *_inverse_kinematics(p),
    ]


def _base_frame(printed: Published, p: Alpha5Parameters) -> AuditRow:
    row, link = printed.table_2.rows[0], p.links[0]

    def excess(x: FloatArray) -> float:
        return excess_of_box(x * [-1, -1, 1], link.bounds)

    displaced = 2 * float(np.hypot(*link.com[:2]))
    return judged(
        "base_frame.link_0",
        "Section 2 against Figures 1 and 7",
        "frame {0} is DH frame {0} after the rotation pi",
        excess(link.com) / MM,
        "<=",
        0.0,
        float(rounding_bound(excess, row.com)) / MM,
        "mm",
        f"distance of the COM from the body if the text is followed; it moves {displaced / MM:.1f} mm to "
        "the other side, and the effect is what that does to the moment on the mount, in air",
        effect=displaced * link.mass * GRAVITY,
        effect_unit="N m",
    )


def _first_frame(printed: Published) -> AuditRow:
    return judged(
        "frames.first",
        "Section 1.1, Table 1",
        "row i leads from frame {i-1} to frame {i}",
        float(printed.table_1.rows[0].link) - 1,
        ">=",
        0.0,
        0.0,
        "",
        "number of the frame that row 0 would start from; Section 2 has theta_0 turn about z of frame {0}, so "
        "row i leads from {i} to {i+1}",
    )


def _aligned(p: Alpha5Parameters) -> AuditRow:
    return judged(
        "frames.aligned",
        "Section 2.2",
        "the inertial frames are aligned with the DH frames",
        max(np.degrees(abs(row.alpha)) for row in p.dh[:4]),
        "=",
        0.0,
        ARITHMETIC,
        "deg",
        "largest angle between inertial frame {i} and DH frame {i}: by Section 2 frame {i} has turned by "
        "theta, not yet by alpha; with frame {i-1} it shares the z axis only",
    )


def _references() -> list[AuditRow]:
    return [
        judged(
            f"cross_reference.section_{section}",
            f"Section {section}",
            f"the frames are described in Section {named}",
            float(named),
            "=",
            float(right),
            0.0,
            "",
            f"Section {right} places the inertial frames in the DH frames",
        )
        for section, (named, right) in REFERENCES.items()
    ]


def _elbow_sine(printed: Published) -> AuditRow:
    a_2, opposite = printed.table_1.rows[2].a, printed.elbow.opposite
    assert isinstance(a_2, Quantity)
    return judged(
        "inverse_kinematics.elbow_offset",
        "Sections 1.3 and 1.4 against Table 1",
        "arcsin(2 a_2 / l_1)",
        2 * a_2.si / MM,
        "=",
        opposite.si / MM,
        (2 * a_2.rounding + opposite.rounding) / MM,
        "mm",
        "2 a_2 stands where theta_c has the elbow's offset: the two lengths happen to be one number",
    )


def _inverse_kinematics(p: Alpha5Parameters) -> list[AuditRow]:
    """Random joint positions within the limits: where do the printed formulas lead?"""
    joints = p.joints[:4]
    lower, upper = np.array([j.lower for j in joints]), np.array([j.upper for j in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]
    rows, found, as_printed = [], np.zeros(SAMPLES, dtype=bool), np.zeros(SAMPLES, dtype=bool)
    printed = published_inverse_kinematics(target)
    for k, (name, section) in enumerate((("underarm", "1.3"), ("overarm", "1.4"))):
        solution = np.concatenate([printed[:, k], q[:, 3:]], axis=-1)
        exists = np.isfinite(solution).all(axis=-1)
        reached = chain.frames(solution[exists])[:, -1, :3, 3]
        away = wrap(solution - q)
        same = exists & (np.abs(away).max(axis=-1) < 1e-6)
        found |= same
        as_printed |= same & (np.abs(solution - q).max(axis=-1) < 1e-6)
        rows.append(
            judged(
                f"inverse_kinematics.{name}",
                f"Section {section}",
                f"analytical solution, {name} pose",
                float(np.linalg.norm(reached - target[exists], axis=-1).max()) / MM,
                "=",
                0.0,
                ARITHMETIC,
                "mm",
                f"largest miss of the tcp over {int(exists.sum())} random targets, by forward kinematics: "
                "the formulas are exact",
            )
        )
    ours = inverse_kinematics(target, q[:, 3]).q
    recovered = (np.abs(ours - q[:, None]).max(axis=-1) < 1e-6).any(axis=-1)
    for name, says, hits, finding in (
        (
            "branches",
            "two poses, underarm and overarm",
            found,
            f"share of {SAMPLES} random joint positions within the limits that the two formulas recover; "
            f"each pose has a second elbow, and the four solutions recover {100 * recovered.mean():.4g} %",
        ),
        (
            "wrapping",
            "angles with no range",
            as_printed[found],
            "share of the recovered joint positions that the formulas give as they stand; the others are a "
            "full turn away and must be wrapped into the limits",
        ),
    ):
        share, error = sampled_share(hits)
        rows.append(
            judged(
                f"inverse_kinematics.{name}",
                "Sections 1.3 and 1.4",
                says,
                share,
                ">=",
                100.0,
                0.0,
                "%",
                finding,
                kind="observation",
                standard_error=error,
            )
        )
    return rows
