"""Sections 1.1, 2 and 2.2: frames and references; 1.2 to 1.4: tori, reach and inverse kinematics.

References:
    [ReachAlpha] Manufacturer's document, Sections 1.1 to 1.4, 2 and 2.2, Figure 2.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import excess_of_box, wrap
from alpha5_model.kinematics import workspace
from alpha5_model.kinematics.ik import inverse_kinematics, published_inverse_kinematics
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.quantity import Quantity
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.row import (
    ARITHMETIC,
    AuditRow,
    audited,
    figure,
    sampled_share,
    si,
)
from alpha5_model.theory.dh.chain import DHChain

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
    topics = (_frames, _inverse_kinematics, tori, _shares)
    return [*(row for topic in topics for row in topic(printed, p)), _self_collision()]


def _lengths(printed: Published) -> list[Quantity]:
    """a_0, d_0, a_2 and d_3 of Table 1."""
    cells = ((0, "a"), (0, "d"), (2, "a"), (3, "d"))
    return [getattr(printed.table_1.rows[row], column) for row, column in cells]


def _frames(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    first, largest = (
        float(printed.table_1.rows[0].link) - 1,
        max(abs(r.alpha) for r in p.dh[:4]),
    )
    rows = [
        audited("frames.first", first),
        audited("frames.aligned", largest, ARITHMETIC),
    ]
    for at, (named, right) in REFERENCES.items():
        words: dict[str, Any] = {"section": at, "named": named, "right": right}
        claim = f"cross_reference.section_{at}"
        rows.append(audited(claim, float(named), expected=float(right), **words))
    base, link = printed.table_2.rows[0], p.links[0]
    distance = figure(lambda x: excess_of_box(x * [-1, -1, 1], link.bounds), base.com)
    moved = 2 * float(np.hypot(*link.com[:2]))
    words = {"effect": moved * link.mass * -GRAVITY[2], "moved": 1e3 * moved}
    return [*rows, audited("base_frame", *distance, of=base, **words)]


def _inverse_kinematics(document: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The elbow's sine, and where the printed formulas lead from random joint positions."""
    a_2, opposite = _lengths(document)[2], document.elbow.opposite
    bound = 2 * a_2.rounding + opposite.rounding
    rows = [audited("inverse_kinematics.elbow_offset", 2 * a_2.si, bound, opposite.si)]
    lower, upper = np.array([(j.lower, j.upper) for j in p.joints[:4]]).T
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
        rows.append(
            audited(
                f"inverse_kinematics.{name}", miss, ARITHMETIC, targets=exists.sum()
            )
        )
    ours = inverse_kinematics(target, q[:, 3]).q
    recovered = (
        100 * (np.abs(ours - q[:, None]).max(axis=-1) < 1e-6).any(axis=-1).mean()
    )
    words: dict[str, Any] = {
        "expected": 1.0,
        "samples": SAMPLES,
        "recovered": recovered,
    }
    for name, hits in (("branches", found), ("wrapping", as_printed[found])):
        share, words["standard_error"] = sampled_share(hits)
        rows.append(audited(f"inverse_kinematics.{name}", share, **words))
    return rows


def _shoulder_distance(elbow: float) -> float:
    """From the shoulder, DH frame {1}, to the tcp, at a theta_2 [rad], in m."""
    frames = DHChain.alpha5().frames([0.0, 0.0, elbow, 0.0])
    return float(np.linalg.norm(frames[-1, :3, 3] - frames[1, :3, 3]))


def tori(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """The lengths in the formulas of the tori."""
    numbers, ours = printed.workspace, printed.elbow.opposite
    theirs, (_, _, a_2, d_3) = numbers.inner_offset, _lengths(printed)
    inner = [theirs, numbers.inner_length, a_2, d_3]
    # Longest with the elbow stretched, or as near to that as its limits allow.
    stretched = workspace.singular_elbow_angles()["stretched"]
    bend = float(np.clip(stretched, p.joints[2].lower, p.joints[2].upper))

    def inner_radius(x: FloatArray) -> float:
        return float(np.hypot(*(x[:2] + x[2:4])))

    # The printed radius less that with the caption's lengths; a_2 and d_3 are common.
    both = [*inner, ours, printed.elbow.adjacent]
    _, shift = figure(lambda x: inner_radius(x) - inner_radius(x[[4, 5, 2, 3]]), both)
    _, drop = figure(lambda x: np.hypot(*x) - abs(x[1]), [a_2, d_3])
    corner = DHChain.alpha5().frames(np.zeros(4))[2, :3, 3]
    offset, rounding = (
        float(np.hypot(*corner[:2])) - p.dh[0].a,
        _lengths(printed)[0].rounding,
    )
    lower = float(np.hypot(a_2.si, d_3.si))
    figures = {
        "inner_offset": (theirs.si, theirs.rounding + ours.rounding, ours.si),
        "outer_torus": (_shoulder_distance(bend), ARITHMETIC, p.dh[1].a + lower),
        "inner_torus": (inner_radius(si(inner)), shift, _shoulder_distance(0.0)),
        "downward_centre": (offset, rounding + ours.rounding, 0.0),
        "downward_radius": (lower, drop, -d_3.si),
    }
    rows, words = [], dict[str, Any](numbers=numbers, ours=ours)
    for name, (measured, bound, expected) in figures.items():
        words["effect"] = None if bound == ARITHMETIC else abs(measured - expected)
        rows.append(audited(f"workspace.{name}", measured, bound, expected, **words))
    return rows


def _shares(printed: Published, p: Alpha5Parameters) -> list[AuditRow]:
    """Areas of the half-plane R >= 0: between the printed tori, and reached within the limits.

    The areas are exact; how much of them the rounding of the printed lengths may move is counted on
    a grid, on which only the tori move.
    """
    elbow, numbers = printed.elbow, printed.workspace
    torus = [numbers.inner_offset, numbers.inner_length, numbers.downward_drop]
    inputs = [*_lengths(printed), elbow.opposite, elbow.adjacent, *torus]
    size = p.dh[0].a + p.dh[1].a + float(np.hypot(p.dh[2].a, p.dh[3].d))
    heights = p.dh[0].d + np.linspace(-size, size, 2 * GRID - 1)
    radius, height = np.meshgrid(np.linspace(0.0, size, GRID), heights)
    # Azimuth pi/2 lies within the limits of theta_0 whichever way the arm faces.
    points = np.stack([np.zeros_like(radius), radius, height], axis=-1)
    reached = workspace.reachable(points)

    def differing(x: FloatArray) -> FloatArray:
        """Shares of the published region that is not reached, and of the reached that is left out."""
        a_0, d_0, a_2, d_3, opp, adj, offset, length, drop = x
        square = (radius - a_0) ** 2 + (height - d_0) ** 2
        outer = (np.hypot(opp, adj) + np.hypot(d_3, a_2)) ** 2
        inner = (offset + a_2) ** 2 + (length + d_3) ** 2
        below = (radius - a_0) ** 2 + (height - d_0 + drop) ** 2
        region = (inner <= square) & (square <= outer) & (below >= d_3**2)
        beyond, missed = region & ~reached, reached & ~region
        return np.array([beyond.sum() / region.sum(), missed.sum() / reached.sum()])

    exact, (_, bounds) = workspace.published_errors(), figure(differing, inputs)
    beyond = exact.unreachable_area / exact.published_area
    missed = exact.missed_area / exact.reachable_area
    outside = audited("workspace.beyond_reach", beyond, bounds[0])
    # The third torus is drawn for one pose, and so is the inner one.
    left_out = workspace.area(workspace.reachable_but_unpublished("underarm"))
    underarm = 100 * left_out / workspace.cross_section_area("underarm")
    return [
        outside,
        audited("workspace.left_out", missed, bounds[1], underarm=underarm),
    ]


@cache
def _self_collision() -> AuditRow:
    from alpha5_model.dynamics.collision import (
        without_self_collision,
    )  # late: Pinocchio

    free = workspace.sampled_share(without_self_collision, SAMPLES)
    return audited(
        "workspace.self_collision", 1 - free.share, standard_error=free.standard_error
    )
