"""Sections 1.1, 2 and 2.2: frames and references; 1.2 to 1.4: tori, reach and inverse kinematics.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1 to 1.4, 2 and 2.2, Figure 2.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from alpha5_model.checks import BoolArray, FloatArray
from alpha5_model.consistency.row import (
    ARITHMETIC,
    GRAVITY,
    MM,
    AuditRow,
    audited,
    excess_of_box,
    figure,
    sampled_share,
    si,
)
from alpha5_model.dh import DHChain
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.ik import inverse_kinematics, published_inverse_kinematics
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import Published
from alpha5_model.spatial import wrap

#: Random joint positions for the printed formulas, and points of the reachable volume for
#: self-collision.
SAMPLES = 4000
#: Points along the radius of the grid on which the rounding of the tori is counted.
GRID = 401
#: Where the document sends the reader for the frames: section -> the section it names, and the
#: section that places the frames.
REFERENCES = {"1.1": ("2", "2"), "2.2": ("2.1", "2")}


def audit(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of frames, inverse kinematics and workspace."""
    return [
        *_frames(printed, p),
        *_inverse_kinematics(printed, p),
        *tori(printed, p),
        *_shares(printed, p),
        _self_collision(),
    ]


def _length(printed: Published, row: int, column: str) -> Quantity:
    value = getattr(printed.table_1.rows[row], column)
    assert isinstance(value, Quantity)  # a_1 is the only symbol in the columns d and a
    return value


def _frames(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    first, largest = float(printed.table_1.rows[0].link) - 1, max(abs(r.alpha) for r in p.dh[:4])
    rows = [audited("frames.first", first), audited("frames.aligned", largest, bound=ARITHMETIC)]
    for at, (named, right) in REFERENCES.items():
        words: dict[str, Any] = {"section": at, "named": named, "right": right}
        rows.append(audited(f"cross_reference.section_{at}", float(named), float(right), **words))
    base, link = printed.table_2.rows[0], p.links[0]
    measured, bound = figure(lambda x: excess_of_box(x * [-1, -1, 1], link.bounds), base.com)
    displaced = 2 * float(np.hypot(*link.com[:2]))
    effect, moved = displaced * link.mass * GRAVITY, f"{displaced / MM:.1f}"
    rows.append(audited("base_frame", measured, bound=bound, of=base, effect=effect, moved=moved))
    return rows


def _inverse_kinematics(document: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The elbow's sine, and where the printed formulas lead from random joint positions."""
    a_2, opposite = _length(document, 2, "a"), document.elbow.opposite
    bound = 2 * a_2.rounding + opposite.rounding
    rows = [audited("inverse_kinematics.elbow_offset", 2 * a_2.si, opposite.si, bound)]
    joints = p.joints[:4]
    lower, upper = np.array([j.lower for j in joints]), np.array([j.upper for j in joints])
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, 4))
    chain = DHChain.alpha5()
    target = chain.frames(q)[:, -1, :3, 3]
    found, as_printed = np.zeros((2, SAMPLES), dtype=bool)
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


def _shoulder_distance(elbow: float) -> float:
    """From the shoulder, DH frame {1}, to the tcp, at a theta_2 [rad], in m."""
    frames = DHChain.alpha5().frames([0.0, 0.0, elbow, 0.0])
    return float(np.linalg.norm(frames[-1, :3, 3] - frames[1, :3, 3]))


def tori(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The lengths in the formulas of the tori."""
    numbers, ours = printed.workspace, printed.elbow.opposite
    theirs, a_2, d_3 = numbers.inner_offset, p.dh[2].a, p.dh[3].d
    table = [_length(printed, 2, "a"), _length(printed, 3, "d")]
    inner = [theirs, numbers.inner_length, *table]
    # Longest with the elbow stretched, or as near to that as its limits allow.
    stretched = workspace.singular_elbow_angles()["stretched"]
    bend = float(np.clip(stretched, p.joints[2].lower, p.joints[2].upper))

    def inner_radius(x: FloatArray) -> float:
        return float(np.hypot(x[0] + x[2], x[1] + x[3]))

    def inner_shift(x: FloatArray) -> float:
        """The printed radius less that with the caption's lengths; a_2 and d_3 are common."""
        return inner_radius(x[:4]) - inner_radius(np.array([x[4], x[5], x[2], x[3]]))

    _, shift = figure(inner_shift, [*inner, ours, printed.elbow.adjacent])
    _, drop = figure(lambda x: np.hypot(*x) - abs(x[1]), table)
    corner = DHChain.alpha5().frames(np.zeros(4))[2, :3, 3]
    offset, rounding = float(np.hypot(*corner[:2])) - p.dh[0].a, _length(printed, 0, "a").rounding
    lower = float(np.hypot(a_2, d_3))
    figures = {
        "inner_offset": (theirs.si, ours.si, theirs.rounding + ours.rounding),
        "outer_torus": (_shoulder_distance(bend), p.dh[1].a + lower, ARITHMETIC),
        "inner_torus": (inner_radius(si(inner)), _shoulder_distance(0.0), shift),
        "downward_centre": (offset, 0.0, rounding + ours.rounding),
        "downward_radius": (lower, -d_3, drop),
    }
    texts: dict[str, Any] = {
        "ours": ours.text,
        "offset": theirs.text,
        "length": numbers.inner_length.text,
        "drop": numbers.downward_drop.text,
    }
    rows = []
    for name, (measured, expected, bound) in figures.items():
        effect = None if bound == ARITHMETIC else abs(measured - expected)
        claim = f"workspace.{name}"
        rows.append(audited(claim, measured, expected, bound, effect=effect, **texts))
    return rows


def _shares(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and reached within the limits.

    The areas are exact; how much of them the rounding of the printed lengths may move is counted on
    a grid, on which only the tori move.
    """
    elbow, numbers = printed.elbow, printed.workspace
    table = [_length(printed, *cell) for cell in ((0, "a"), (0, "d"), (2, "a"), (3, "d"))]
    torus = [numbers.inner_offset, numbers.inner_length, numbers.downward_drop]
    inputs = [*table, elbow.opposite, elbow.adjacent, *torus]
    size = p.dh[0].a + p.dh[1].a + float(np.hypot(p.dh[2].a, p.dh[3].d))
    radius, height = np.meshgrid(
        np.linspace(0.0, size, GRID), p.dh[0].d + np.linspace(-size, size, 2 * GRID - 1)
    )
    # Azimuth pi/2 lies within the limits of theta_0 whichever way the arm faces.
    points = np.stack([np.zeros_like(radius), radius, height], axis=-1)
    reached = workspace.reachable(points)

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

    exact = workspace.published_errors()
    beyond = exact.unreachable_area / exact.published_area
    missed = exact.missed_area / exact.reachable_area
    return [
        audited("workspace.beyond_reach", beyond, bound=figure(beyond_reach, inputs)[1]),
        audited("workspace.left_out", missed, bound=figure(left_out, inputs)[1]),
    ]


@cache
def _self_collision() -> AuditRow:
    from alpha5_model.dynamics.collision import without_self_collision  # late: Pinocchio

    free = workspace.sampled_share(without_self_collision, SAMPLES)
    error = free.standard_error
    return audited("workspace.self_collision", 1 - free.share, standard_error=error)
