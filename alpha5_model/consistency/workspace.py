"""The tori of Section 1.2 against Table 1 and against what the arm reaches.

References:
    [ReachAlpha] Manufacturer's document, Section 1.2, Figure 2.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, audited, rounding_bound, si
from alpha5_model.dh import DHChain
from alpha5_model.kinematics.reach import reachable
from alpha5_model.kinematics.workspace import published_errors, sampled_share, singular_elbow_angles
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import Published

#: Points of the reachable volume that are asked for self-collision.
SAMPLES = 4000
#: Points along the radius of the grid on which the rounding of the tori is counted.
GRID = 401


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the workspace."""
    return [_inner_offset(printed), *_tori(printed, p), *_shares(printed, p), _self_collision()]


def _inner_offset(printed: Published) -> AuditRow:
    ours, theirs = printed.elbow.opposite, printed.workspace.inner_offset
    return audited(
        "workspace.inner_offset",
        theirs.si,
        ours.si,
        theirs.rounding + ours.rounding,
        effect=abs(theirs.si - ours.si),
        theirs=theirs.text,
        ours=ours.text,
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
    # Longest with the elbow stretched, or as near to that as its limits allow.
    elbow = p.joints[2]
    bend = np.clip(singular_elbow_angles()["stretched"], elbow.lower, elbow.upper)
    longest = float(_shoulder_distance(np.array([0.0, 0.0, bend, 0.0])))
    inner = [numbers.inner_offset, numbers.inner_length, a_2_printed, d_3_printed]

    def inner_radius(x: FloatArray) -> float:
        return float(np.hypot(x[0] + x[2], x[1] + x[3]))

    def inner_shift(x: FloatArray) -> float:
        """The printed radius less that with the caption's lengths; a_2 and d_3 are common."""
        return inner_radius(x[:4]) - inner_radius(np.array([x[4], x[5], x[2], x[3]]))

    folded = float(_shoulder_distance(np.zeros(4)))
    caption = [printed.elbow.opposite, printed.elbow.adjacent]
    corner = DHChain.alpha5().frames(np.zeros(4))[2, :3, 3]
    offset = float(np.hypot(*corner[:2])) - p.dh[0].a
    lower = float(np.hypot(a_2, d_3))
    inner_measured = inner_radius(si(inner))
    return [
        audited("workspace.outer_torus", longest, outer, ARITHMETIC),
        audited(
            "workspace.inner_torus",
            inner_measured,
            folded,
            float(rounding_bound(inner_shift, [*inner, *caption])),
            effect=abs(inner_measured - folded),
            offset=numbers.inner_offset.text,
            length=numbers.inner_length.text,
        ),
        audited(
            "workspace.downward_centre",
            offset,
            0.0,
            _length(printed, 0, "a").rounding + printed.elbow.opposite.rounding,
            effect=offset,
            drop=numbers.downward_drop.text,
        ),
        audited(
            "workspace.downward_radius",
            lower,
            -d_3,
            float(rounding_bound(lambda x: np.hypot(*x) - abs(x[1]), [a_2_printed, d_3_printed])),
            effect=lower + d_3,
        ),
    ]


def _length(printed: Published, row: int, column: str) -> Quantity:
    value = getattr(printed.table_1.rows[row], column)
    assert isinstance(value, Quantity)  # a_1 is the only symbol in the columns d and a
    return value


def _shares(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and reached within the limits.

    The areas are exact; how much of them the rounding of the printed lengths may move is counted on
    a grid, on which only the tori move.
    """
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
    reached = reachable(points)

    def published(x: FloatArray) -> BoolArray:
        a_0, d_0, a_2, d_3, opp, adj, offset, length, drop = x
        square = (radius - a_0) ** 2 + (height - d_0) ** 2
        inside: BoolArray = (
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

    exact = published_errors()
    beyond, missed = exact.unreachable_area, exact.missed_area
    return [
        audited(f"workspace.{name}", measured, bound=float(rounding_bound(share, inputs)))
        for name, measured, share in (
            ("beyond_reach", beyond / exact.published_area, beyond_reach),
            ("left_out", missed / exact.reachable_area, left_out),
        )
    ]


@cache
def _self_collision() -> AuditRow:
    from alpha5_model.dynamics.collision import without_self_collision  # late: Pinocchio

    free = sampled_share(without_self_collision, SAMPLES)
    error = free.standard_error
    return audited("workspace.self_collision", 1 - free.share, standard_error=error)
