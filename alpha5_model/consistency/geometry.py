"""Sections 1 and 2 against Table 1: base frame, tori of the workspace, inverse kinematics.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.2, 1.3, 1.4 and 2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, judged, rounding_bound
from alpha5_model.consistency.units import GRAVITY, MM, excess_of_box
from alpha5_model.kinematics.dh import DHChain
from alpha5_model.kinematics.ik import inverse_kinematics
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import Published

#: Points along each side of the grid that measures areas of the workspace's cross-section.
GRID = 401
SAMPLES = 4000


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of kinematics."""
    return [
        _base_frame(printed, p),
        _inner_offset(printed),
        *_tori(printed, p),
        *_workspace_shares(printed, p),
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


def _inner_offset(printed: Published) -> AuditRow:
    ours, theirs = printed.elbow.opposite, printed.workspace.inner_offset
    return judged(
        "workspace.inner_offset",
        "Section 1.2, inner torus, against Table 1",
        f"{theirs.text} where Table 1 has {ours.text}",
        theirs.si / MM,
        "=",
        ours.si / MM,
        (theirs.rounding + ours.rounding) / MM,
        "mm",
        f"{theirs.text} rounds to {ours.text}: the torus has the finer number, Table 1 the rounded one",
        effect=abs(theirs.si - ours.si) / MM,
        effect_unit="mm",
    )


def _shoulder_distance(q: FloatArray) -> FloatArray:
    """From the shoulder, DH frame {1}, to the tcp, for joint positions (..., 4) [m]."""
    frames = DHChain.alpha5().frames(q)
    out: FloatArray = np.linalg.norm(frames[..., -1, :3, 3] - frames[..., 1, :3, 3], axis=-1)
    return out


def _tori(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    numbers = printed.workspace
    a_1, a_2, d_3 = p.dh[1].a, p.dh[2].a, p.dh[3].d
    a_2_printed, d_3_printed = _length(printed, 2, "a"), _length(printed, 3, "d")
    outer = a_1 + float(np.hypot(d_3, a_2))
    # Longest where the elbow is stretched: search theta_2 twice, the second time around the first.
    low, high = p.joints[2].lower, p.joints[2].upper
    for _ in range(4):
        q = np.zeros((2001, 4))
        q[:, 2] = np.linspace(low, high, len(q))
        best = int(np.argmax(reach := _shoulder_distance(q)))
        low, high = q[max(best - 1, 0), 2], q[min(best + 1, len(q) - 1), 2]
    inner = [numbers.inner_offset, numbers.inner_length, a_2_printed, d_3_printed]

    def inner_radius(x: FloatArray) -> float:
        return float(np.hypot(x[0] + x[2], x[1] + x[3]))

    def inner_shift(x: FloatArray) -> float:
        """The printed radius less that with the caption's lengths; a_2 and d_3 are common."""
        return inner_radius(x[:4]) - inner_radius(np.array([x[4], x[5], x[2], x[3]]))

    folded = float(_shoulder_distance(np.zeros(4)))
    caption = [printed.elbow.opposite, printed.elbow.adjacent]
    elbow = DHChain.alpha5().frames(np.zeros(4))[2, :3, 3]
    offset = float(np.hypot(*elbow[:2])) - p.dh[0].a
    lower_link = [a_2_printed, d_3_printed]
    return [
        judged(
            "workspace.outer_torus",
            "Section 1.2, outer torus",
            "radius a_1 + sqrt(d_3^2 + a_2^2)",
            reach[best] / MM,
            "=",
            outer / MM,
            ARITHMETIC,
            "mm",
            "longest distance from shoulder to tcp within the limits of theta_2, by forward kinematics",
        ),
        judged(
            "workspace.inner_torus",
            "Section 1.2, inner torus",
            f"radius sqrt(({numbers.inner_offset.text} + a_2)^2 + ({numbers.inner_length.text} + d_3)^2)",
            inner_radius(np.array([q.si for q in inner])) / MM,
            "=",
            folded / MM,
            float(rounding_bound(inner_shift, [*inner, *caption])) / MM,
            "mm",
            "against the distance from shoulder to tcp at theta_2 = 0; it holds for the underarm pose only",
            effect=abs(inner_radius(np.array([q.si for q in inner])) - folded) / MM,
            effect_unit="mm",
        ),
        judged(
            "workspace.downward_centre",
            "Section 1.2, downward torus",
            f"centre {numbers.downward_drop.text} below the shoulder",
            offset / MM,
            "=",
            0.0,
            _length(printed, 0, "a").rounding / MM + printed.elbow.opposite.rounding / MM,
            "mm",
            "horizontal distance of the elbow from the shoulder at theta_1 = 0, which the formula drops",
            effect=offset / MM,
            effect_unit="mm",
        ),
        judged(
            "workspace.downward_radius",
            "Section 1.2, downward torus",
            "radius -d_3",
            float(np.hypot(a_2, d_3)) / MM,
            "=",
            -d_3 / MM,
            float(rounding_bound(lambda x: np.hypot(*x) - abs(x[1]), lower_link)) / MM,
            "mm",
            "distance from elbow to tcp, sqrt(a_2^2 + d_3^2): the formula drops a_2",
            effect=(float(np.hypot(a_2, d_3)) + d_3) / MM,
            effect_unit="mm",
        ),
    ]


def _length(printed: Published, row: int, column: str) -> Quantity:
    value = getattr(printed.table_1.rows[row], column)
    assert isinstance(value, Quantity)  # a_1 is the only symbol in the columns d and a
    return value


def _workspace_shares(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and reached within the limits."""
    opposite, adjacent = printed.elbow.opposite, printed.elbow.adjacent
    numbers = printed.workspace
    inputs = [
        *(
            _length(printed, row, column)
            for row, column in ((0, "a"), (0, "d"), (2, "a"), (3, "d"))
        ),
        *(opposite, adjacent, numbers.inner_offset, numbers.inner_length, numbers.downward_drop),
    ]
    size = p.dh[0].a + p.dh[1].a + float(np.hypot(p.dh[2].a, p.dh[3].d))
    radius, height = np.meshgrid(
        np.linspace(0.0, size, GRID), p.dh[0].d + np.linspace(-size, size, 2 * GRID - 1)
    )
    # Azimuth pi/2 lies within the limits of theta_0 whichever way the arm faces.
    points = np.stack([np.zeros_like(radius), radius, height], axis=-1)
    reached = inverse_kinematics(points).within_limits.any(axis=-1)

    def published(x: FloatArray) -> NDArray[np.bool_]:
        a_0, d_0, a_2, d_3, opp, adj, offset, length, drop = x
        square = (radius - a_0) ** 2 + (height - d_0) ** 2
        inside: NDArray[np.bool_] = (
            (square <= (np.hypot(opp, adj) + np.hypot(d_3, a_2)) ** 2)
            & (square >= (offset + a_2) ** 2 + (length + d_3) ** 2)
            & ((radius - a_0) ** 2 + (height - d_0 + drop) ** 2 >= d_3**2)
        )
        return inside

    def beyond_reach(x: FloatArray) -> float:
        region = published(x)
        return float((region & ~reached).sum() / region.sum())

    def left_out(x: FloatArray) -> float:
        return float((reached & ~published(x)).sum() / reached.sum())

    values = np.array([q.si for q in inputs])
    return [
        judged(
            f"workspace.{name}",
            "Section 1.2, Figure 2",
            says,
            100 * share(values),
            "=",
            0.0,
            100 * float(rounding_bound(share, inputs)),
            "%",
            finding,
        )
        for name, says, share, finding in (
            (
                "beyond_reach",
                "all points between the tori are reached",
                beyond_reach,
                "share of the published region, by area in the half-plane, that no joint position within "
                "the limits reaches: the tori ignore joint limits",
            ),
            (
                "left_out",
                "no point outside the tori is reached",
                left_out,
                "share of what can be reached, by area in the half-plane, that lies outside the tori",
            ),
        )
    ]


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
