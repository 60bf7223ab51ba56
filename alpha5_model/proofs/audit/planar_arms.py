"""The lecture's statements on planar arms, against the exact ones.

References:
    [Lecture7.1] Describing Robot Arms: "Workspace", "Dexterous Workspace", and the
        theorem on a planar arm whose tip is pinned, with its experiment.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.proofs.audit.rounding import sampled_share
from alpha5_model.proofs.audit.row import AuditRow, audited, texts
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.types_and_tasks import spatial_conditions
from alpha5_model.theory.planar import (
    PlanarArm,
    dexterity,
    dexterous_area,
    dexterous_radii,
    theorem_row,
    turns_fully,
)

#: Whole link lengths that are tried; sums and halves of them are exact.
LONGEST = 6
#: The same for arms of four links, which the closing note is about.
FOUR_LONGEST = 4
#: Four links whose last one turns fully at every distance of the tip up to a radius.
FOUR_LINKS = (3, 3, 3, 1)
#: Most joints of the arms that test the spatial condition: six reach all dimensions.
SPATIAL_JOINTS = 6
_PRINTED = texts()["experiment"]
#: The experiment's link lengths.
EXPERIMENT = tuple(_PRINTED["links"])
#: The experiment's table: l_4, the column headed l_2 + l_3, the one headed l_4/2.
PRINTED_TABLE = tuple(zip(*_PRINTED["columns"], strict=True))
#: Limit of each joint of the lecture's arms [rad]: 170 deg either way, as of many
#: industrial arms.
LIMIT = 2.967
#: Points with which the dexterous workspace with limits is sampled.
POINTS = 4000
#: Orientations that are tried at each of the points.
ORIENTATIONS = 120
#: Subject -> measured, expected.
Figures = dict[str, tuple[float, float]]


def audit() -> list[AuditRow]:
    """The rows of planar arms, in the lecture's order."""
    return [
        *_workspaces(),
        *_dexterity(),
        _spatial_condition(),
        *_theorem(),
        _four_joints(),
        *_experiment(),
    ]


def _rows(
    topic: str, figures: Figures, bound: float | None = None, **words: Any
) -> list[AuditRow]:
    """The rows of a topic.

    Args:
        topic: First word of the claims.
        figures: By the claims' second words.
        bound, words: As of `audited`.
    """
    return [
        audited(
            f"{topic}.{subject}",
            measured=measured,
            bound=bound,
            expected=expected,
            **words,
        )
        for subject, (measured, expected) in figures.items()
    ]


def _workspaces() -> list[AuditRow]:
    """The lecture's shapes, each by a length of curves, an area or a hole's radius."""
    one = EXPERIMENT[:1]
    two = EXPERIMENT[:2]
    limit = (-LIMIT, LIMIT)
    slide = (1, 3)
    limited = PlanarArm(two, [limit, limit]).workspace()
    ring = math.pi * (sum(two) ** 2 - (two[0] - two[1]) ** 2)
    disc = math.pi * sum(EXPERIMENT) ** 2
    figures = {
        "1r": (_length(PlanarArm(one)), 2 * math.pi * one[0]),
        "1r_limits": (_length(PlanarArm(one, [limit])), 2 * LIMIT * one[0]),
        "1p": (_length(PlanarArm([0], [slide], "P")), 2.0),
        "2r": (PlanarArm(two).workspace().area, ring),
        "2r_limits": (limited.radii[0], 0.0),
        "3r": (PlanarArm(EXPERIMENT).workspace().area, disc),
    }
    lost = ring - limited.area
    return _rows("planar_workspace", figures, limit=LIMIT, lost=lost)


def _length(arm: PlanarArm) -> float:
    """Length of the curves that an arm of one link reaches."""
    return math.fsum(curve.length for curve in arm.workspace().curves)


def _dexterity() -> list[AuditRow]:
    """The necessary condition for planar arms, by points spread over the reach."""
    points = _points_in_reach()
    area, error = _dexterous_area(points, LIMIT)
    least, _ = _dexterous_area(points, 0.75 * math.pi)
    without_limits = dexterous_area(PlanarArm(EXPERIMENT))
    return _rows(
        "dexterous_workspace",
        {"necessary": (area, 0.0), "limits": (area, without_limits)},
        bound=0.0,
        standard_error=error,
        limit=LIMIT,
        least=least,
    )


def _points_in_reach() -> FloatArray:
    """Points (N, 2) spread evenly over the disc that the experiment's arm reaches."""
    turn, square = np.random.default_rng(0).uniform(size=(2, POINTS))
    bearing = 2 * math.pi * turn
    radius = sum(EXPERIMENT) * np.sqrt(square)
    return np.stack([radius * np.cos(bearing), radius * np.sin(bearing)], axis=-1)


def _dexterous_area(points: FloatArray, limit: float) -> tuple[float, float]:
    """Area that the arm reaches in every orientation, with its standard error."""
    arm = PlanarArm(EXPERIMENT, [(-limit, limit)] * 3)
    share, error = sampled_share(dexterity(arm, points, ORIENTATIONS) == 1)
    disc = math.pi * sum(EXPERIMENT) ** 2
    return disc * share, disc * error


def _spatial_condition() -> AuditRow:
    """The spatial necessary condition, against the rank of the Jacobian of random arms.

    A dexterous workspace with an interior needs poses in all six dimensions. Every
    sequence of joints gets one random geometry; its rank is the largest that any
    geometry has, almost surely.
    """
    rng = np.random.default_rng(0)
    able = 0
    ruled_out = 0
    # Fewer joints than dimensions never reach them all.
    for kinds in itertools.product((0, 1), repeat=SPATIAL_JOINTS):
        chain = _random_chain(kinds, rng)
        jacobian = chain.jacobian(rng.uniform(size=SPATIAL_JOINTS))
        if np.linalg.matrix_rank(jacobian) < 6:
            continue
        able += 1
        ruled_out += not spatial_conditions(chain).satisfied

    return audited(
        "dexterous_workspace.spatial",
        measured=ruled_out / able,
        joints=SPATIAL_JOINTS,
        able=able,
    )


def _random_chain(kinds: Sequence[int], rng: np.random.Generator) -> DHChain:
    """A chain of joints that are revolute (0) or prismatic (1)."""
    count = len(kinds)
    numbers = rng.uniform(size=(count, 4))
    return DHChain.from_table(list(np.column_stack([numbers, kinds])))


def _theorem() -> list[AuditRow]:
    """Both directions of the theorem, for all whole lengths up to `LONGEST`."""
    lengths = np.array(list(itertools.product(range(1, LONGEST + 1), repeat=4)))
    rows = [theorem_row(*map(float, row)) for row in lengths]
    promised = np.array([row.theorem for row in rows])
    turning = np.array([row.exact for row in rows])
    tied = np.array([row.pair == row.half for row in rows])
    third_is_longer = lengths[:, 2] > lengths.min(axis=1)

    exceptions = {
        "sufficient": ~turning[promised],
        "necessary": ~promised[turning],
        "shortest": third_is_longer[turning],
        "strict": tied[promised],
    }
    missed = lengths[turning & ~promised]
    example = ", ".join(map(str, missed[-1])) if len(missed) else "none"
    return [
        audited(
            f"lecture.{subject}",
            measured=float(np.mean(among)),
            whole=len(among),
            longest=LONGEST,
            example=example,
            share=100 * np.mean(among),
        )
        for subject, among in exceptions.items()
    ]


def _four_joints() -> AuditRow:
    """The closing note: the theorem for four revolute joints.

    To the letter, the note asks of every pair of lengths, without the last link's, to
    reach half of the sum of all. In the form that stays true, the sums are of all but
    one of these lengths; for three links those are the theorem's pairs.
    """
    turning = 0
    missed = 0
    broken = 0
    sizes = range(1, FOUR_LONGEST + 1)
    for links in itertools.product(sizes, repeat=4):
        arm = PlanarArm(links)
        for tip in sizes:
            half = (sum(links) + tip) / 2
            others = [*links[:3], tip]
            turns = turns_fully(arm, tip)
            turning += turns
            missed += turns and not _sums_reach(half, others, 2)
            broken += _sums_reach(half, others, 3) and not turns

    ((_, until),) = dexterous_radii(PlanarArm(FOUR_LINKS))
    return audited(
        "lecture.any_number",
        measured=missed / turning,
        whole=turning,
        longest=FOUR_LONGEST,
        example=", ".join(map(str, FOUR_LINKS)),
        until=until,
        broken=broken,
        share=100 * missed / turning,
    )


def _sums_reach(half: float, lengths: Sequence[int], count: int) -> bool:
    """Whether every sum of so many of the lengths is at least ``half``."""
    return all(sum(some) >= half for some in itertools.combinations(lengths, count))


def _experiment() -> list[AuditRow]:
    """The experiment's printed table, against its links and its headings."""
    l_4, pair, half = np.array(PRINTED_TABLE).T
    links = np.column_stack([np.tile(EXPERIMENT, (len(l_4), 1)), l_4])
    middle_pair = np.sort(links)[:, 1:3].sum(axis=1)
    low, high = PlanarArm(EXPERIMENT).workspace().radii
    figures = {
        "least": (low, 0.0),
        "most": (high, 10.0),
        "middle_links": (_apart(pair, middle_pair), 0.0),
        "middle_links_head": (_apart(pair, sum(EXPERIMENT[1:])), 0.0),
        "half": (_apart(half, l_4 / 2), 0.0),
        "half_of_all": (_apart(half, links.sum(axis=1) / 2), 0.0),
    }
    return _rows("experiment", figures)


def _apart(column: FloatArray, values: FloatArray | float) -> float:
    """The largest difference."""
    return float(np.abs(column - values).max())
