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
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.tables import Published

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


def printed_solution(position: FloatArray, p: Alpha5Parameters, overarm: bool) -> FloatArray:
    """The formulas of Section 1.3 (underarm) or 1.4 (overarm), to the letter.

    Args:
        position: (..., 3) in base_link [m].
        p: Lengths.
        overarm: Section 1.4 instead of 1.3.

    Returns:
        (..., 4), theta_3 = 0, not wrapped into the limits; NaN out of reach.
    """
    a_0, d_0, a_1, a_2, d_3 = p.dh[0].a, p.dh[0].d, p.dh[1].a, p.dh[2].a, p.dh[3].d
    x, y, z = np.moveaxis(position, -1, 0)
    side = -1.0 if overarm else 1.0
    radius = np.hypot(x, y) - side * a_0
    l_1, l_2, l_3 = a_1, np.hypot(a_2, d_3), np.hypot(radius, z - d_0)
    corner = np.arcsin(2 * a_2 / l_1)
    with np.errstate(invalid="ignore"):
        theta_2 = np.arccos((l_1**2 + l_2**2 - l_3**2) / (2 * l_1 * l_2))
        inner = np.arccos((l_1**2 + l_3**2 - l_2**2) / (2 * l_1 * l_3))
    theta_2 = theta_2 - corner - np.arcsin(a_2 / l_2)
    start = 3 * np.pi / 2 if overarm else np.pi / 2
    theta_1 = start + side * np.arctan2(z - d_0, radius) - inner - corner
    theta_0 = np.arctan2(y, x) + (0.0 if overarm else np.pi)
    return np.stack([theta_0, theta_1, theta_2, np.zeros_like(theta_0)], axis=-1)


def _inverse_kinematics(p: Alpha5Parameters) -> list[AuditRow]:
    """Random joint positions within the limits: where do the printed formulas lead?"""
    joints = p.joints[:4]
    lower, upper = np.array([j.lower for j in joints]), np.array([j.upper for j in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]
    rows, found = [], np.zeros(SAMPLES, dtype=bool)
    for overarm, name, section in ((False, "underarm", "1.3"), (True, "overarm", "1.4")):
        solution = printed_solution(target, p, overarm)
        exists = np.isfinite(solution).all(axis=-1)
        reached = chain.frames(solution[exists])[:, -1, :3, 3]
        away = np.remainder(solution - q + np.pi, 2 * np.pi) - np.pi
        found |= exists & (np.abs(away[:, :3]).max(axis=-1) < 1e-6)
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
            "each pose has a second elbow, and the four solutions recover all",
        )
    )
    return rows
