"""The base frame of Section 2 and the inverse kinematics of Sections 1.3 and 1.4 against Table 1.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.3, 1.4 and 2.
"""

from __future__ import annotations

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, judged, rounding_bound
from alpha5_model.consistency.units import GRAVITY, MM, excess_of_box
from alpha5_model.kinematics.dh import DHChain
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.kinematics.ik_published import published_inverse_kinematics
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.tables import Published
from alpha5_model.spatial import wrap

#: Random joint positions that the printed formulas are tried on.
SAMPLES = 4000


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of frames and inverse kinematics."""
    return [
        _base_frame(printed, p),
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


def _inverse_kinematics(p: Alpha5Parameters) -> list[AuditRow]:
    """Random joint positions within the limits: where do the printed formulas lead?"""
    joints = p.joints[:4]
    lower, upper = np.array([j.lower for j in joints]), np.array([j.upper for j in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]
    rows, found = [], np.zeros(SAMPLES, dtype=bool)
    printed = published_inverse_kinematics(target)
    for k, (name, section) in enumerate((("underarm", "1.3"), ("overarm", "1.4"))):
        solution = np.concatenate([printed[:, k], q[:, 3:]], axis=-1)
        exists = np.isfinite(solution).all(axis=-1)
        reached = chain.frames(solution[exists])[:, -1, :3, 3]
        away = wrap(solution - q)
        found |= exists & (np.abs(away).max(axis=-1) < 1e-6)
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
    rows.append(
        judged(
            "inverse_kinematics.branches",
            "Sections 1.3 and 1.4",
            "two poses, underarm and overarm",
            100 * float(found.mean()),
            ">=",
            100.0,
            0.0,
            "%",
            f"share of {SAMPLES} random joint positions within the limits that the two formulas recover; "
            f"each pose has a second elbow, and the four solutions recover {100 * recovered.mean():.4g} %",
        )
    )
    return rows
