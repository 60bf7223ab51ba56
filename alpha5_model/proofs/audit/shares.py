"""Section 1.2: how much of the printed workspace is reached.

References:
    [ReachAlpha] Manufacturer's document, Section 1.2, Figure 2.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.half_plane import area
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit import printed_workspace
from alpha5_model.proofs.audit.rounding import figure
from alpha5_model.proofs.audit.row import AuditRow, audited
from alpha5_model.proofs.audit.table_1_lengths import lengths

#: Points of the reachable volume that are tried for self-collision.
SAMPLES = 4000
#: Points along the radius of the grid on which the rounding of the tori is counted.
GRID = 401


def audit(printed: Published, parameters: Alpha5Parameters) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and within the limits.

    The areas are exact. The effect of rounding in the printed lengths is estimated by
    counting points of a grid; it moves the tori, not the arm.
    """
    # The inverse kinematics are generated for the catalogue's arm.
    exact = printed_workspace.published_errors()
    beyond_share = exact.unreachable_area / exact.published_area
    left_out_share = exact.missed_area / exact.reachable_area
    beyond_rounding, missed_rounding = _rounding_of_shares(printed, parameters)
    # The document draws the inner and the downward torus for the underarm pose.
    left_out = area(printed_workspace.reachable_but_unpublished("underarm"))
    reached = workspace.cross_section_area("underarm")
    return [
        audited(
            "workspace.beyond_reach",
            measured=beyond_share,
            bound=beyond_rounding,
            share=100 * beyond_share,
        ),
        audited(
            "workspace.left_out",
            measured=left_out_share,
            bound=missed_rounding,
            share=100 * left_out_share,
            underarm=100 * left_out / reached,
        ),
        _self_collision(),
    ]


def _rounding_of_shares(printed: Published, parameters: Alpha5Parameters) -> FloatArray:
    """Bounds of rounding of two shares, (2,).

    They are the share of the published region that is not reached, and the share of the
    reached region that is not published.
    """
    radius, height = _grid(parameters)
    # Azimuth pi/2 lies within the limits of theta_0 whichever way the arm faces.
    points = np.stack([np.zeros_like(radius), radius, height], axis=-1)
    reached = workspace.reachable(points)

    def differing(lengths: FloatArray) -> FloatArray:
        region = _between_tori(radius, height, lengths)
        beyond = region & ~reached
        missed = reached & ~region
        return np.array([beyond.sum() / region.sum(), missed.sum() / reached.sum()])

    bounds: FloatArray = figure(differing, _inputs(printed)).bound
    return bounds


def _between_tori(
    radius: FloatArray, height: FloatArray, lengths: FloatArray
) -> BoolArray:
    """Which points lie between the printed tori.

    Args:
        radius, height: Of the points, (...) [m].
        lengths: In the order of `_inputs` [m].
    """
    a_0, d_0, a_2, d_3, opposite, adjacent, offset, length, drop = lengths
    square = (radius - a_0) ** 2 + (height - d_0) ** 2
    outer_square = (np.hypot(opposite, adjacent) + np.hypot(d_3, a_2)) ** 2
    inner_square = (offset + a_2) ** 2 + (length + d_3) ** 2
    lower_square = (radius - a_0) ** 2 + (height - d_0 + drop) ** 2

    outside_inner = inner_square <= square
    inside_outer = square <= outer_square
    outside_lower = lower_square >= d_3**2
    return np.asarray(outside_inner & inside_outer & outside_lower)


def _grid(parameters: Alpha5Parameters) -> tuple[FloatArray, FloatArray]:
    """Radius from the yaw axis and height in base_link [m] of a grid over the reach."""
    row_0, row_1, row_2, row_3 = parameters.dh[:4]
    reach = row_0.a + row_1.a + float(np.hypot(row_2.a, row_3.d))
    heights = row_0.d + np.linspace(-reach, reach, 2 * GRID - 1)
    radius, height = np.meshgrid(np.linspace(0.0, reach, GRID), heights)
    return radius, height


def _inputs(printed: Published) -> list[Quantity]:
    """The printed lengths on which the shape of the tori depends."""
    elbow = [printed.elbow.opposite, printed.elbow.adjacent]
    torus = [
        printed.workspace.inner_offset,
        printed.workspace.inner_length,
        printed.workspace.downward_drop,
    ]
    return [*lengths(printed), *elbow, *torus]


@cache
def _self_collision() -> AuditRow:
    """The share of the reachable volume that is reached in self-collision only."""
    # Imported late: it loads Pinocchio.
    from alpha5_model.collision.self_collision import without_self_collision

    free = workspace.sampled_share(without_self_collision, SAMPLES)
    return audited(
        "workspace.self_collision",
        measured=1 - free.share,
        standard_error=free.standard_error,
        share=100 * (1 - free.share),
    )
