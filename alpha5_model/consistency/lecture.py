"""The lecture's statements on planar arms and on the DH transform, against the exact ones.

References:
    [Lecture7.1] Describing Robot Arms: "Workspace", "Dexterous Workspace", the theorem on a planar
        arm whose tip is pinned with its experiment, and the relative pose A_j.
"""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, audited, sampled_share, texts
from alpha5_model.dh.link import dh_transform
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.planar import PlanarArm, dexterity, dexterous_area, theorem_row
from alpha5_model.spatial import rotation_about, transform

#: Whole link lengths that are tried; sums and halves of them are exact.
LONGEST = 6
_PRINTED = texts()["experiment"]
#: The experiment's link lengths, and its table: l_4, the column headed l_2 + l_3, the one headed
#: l_4/2.
EXPERIMENT = tuple(_PRINTED["links"])
PRINTED_TABLE = tuple(zip(*_PRINTED["columns"], strict=True))
#: Limits to try the lecture's arms with [rad]: 170 deg either way, as far as many industrial joints
#: turn.
LIMIT = 2.967
#: Points and orientations that the dexterous workspace with limits is sampled with.
POINTS, ORIENTATIONS = 4000, 120
#: Subject -> measured, expected.
Figures = dict[str, tuple[float, float]]


def audit(p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the lecture, in its order."""
    return [*_workspaces(), *_dexterity(), *_theorem(), *_experiment(), *_relative_pose(p)]


def _workspaces() -> list[AuditRow]:
    """The lecture's shapes, each by its measure: length of a curve, area, radius of a hole."""
    one, two, limit = EXPERIMENT[:1], EXPERIMENT[:2], (-LIMIT, LIMIT)
    reach, hole = sum(two), abs(two[0] - two[1])
    ring = math.pi * (reach**2 - hole**2)
    limited = PlanarArm(two, [limit] * 2).workspace()
    figures = {
        "1r": (_length(PlanarArm(one)), 2 * math.pi * one[0]),
        "1r_limits": (_length(PlanarArm(one, [limit])), 2 * LIMIT * one[0]),
        "1p": (_length(PlanarArm([0], [(1, 3)], "P")), 2.0),
        "2r": (PlanarArm(two).workspace().area, ring),
        "2r_limits": (limited.radii[0], 0.0),
        "3r": (PlanarArm(EXPERIMENT).workspace().area, math.pi * sum(EXPERIMENT) ** 2),
    }
    return _rows("planar_workspace", figures, limit=LIMIT, lost=ring - limited.area)


def _rows(topic: str, figures: Figures, bound: float = ARITHMETIC, **words: Any) -> list[AuditRow]:
    """Rows of a topic."""
    return [audited(f"{topic}.{k}", m, bound, e, **words) for k, (m, e) in figures.items()]


def _length(arm: PlanarArm) -> float:
    return math.fsum(curve.length for curve in arm.workspace().curves)


def _dexterity() -> list[AuditRow]:
    """The necessary condition for planar arms, by points spread evenly over the reach."""
    reach = sum(EXPERIMENT)
    turn, square = np.random.default_rng(0).uniform(size=(2, POINTS))
    bearing, radius = 2 * math.pi * turn, reach * np.sqrt(square)
    points = np.stack([radius * np.cos(bearing), radius * np.sin(bearing)], axis=-1)
    arms = [PlanarArm(EXPERIMENT, [(-a, a)] * 3) for a in (LIMIT, 0.75 * math.pi)]
    shares = [dexterity(arm, points, ORIENTATIONS) == 1 for arm in arms]
    disc = math.pi * reach**2
    (area, error), (least, _) = (disc * np.array(sampled_share(hits)) for hits in shares)
    words: dict[str, Any] = {"standard_error": error, "limit": LIMIT, "least": least}
    figures = {"necessary": (area, 0.0), "limits": (area, dexterous_area(PlanarArm(EXPERIMENT)))}
    return _rows("dexterous_workspace", figures, 0.0, **words)


def _theorem() -> list[AuditRow]:
    """Both directions of the theorem, for all whole lengths l_1 ... l_4 up to `LONGEST`."""
    lengths = np.array([*itertools.product(range(1, LONGEST + 1), repeat=4)])
    rows = [theorem_row(*map(float, row)) for row in lengths]
    promised, turning, tied = np.array([(r.theorem, r.exact, r.pair == r.half) for r in rows]).T
    missed = lengths[turning & ~promised]
    figures = {
        "sufficient": ~turning[promised],
        "necessary": ~promised[turning],
        "shortest": (lengths[:, 2] > lengths.min(axis=1))[turning],
        "strict": tied[promised],
    }
    example = ", ".join(map(str, missed[-1])) if len(missed) else "none"
    words: dict[str, Any] = {"longest": LONGEST, "example": example}
    sets = figures.items()
    return [audited(f"lecture.{k}", float(np.mean(x)), whole=len(x), **words) for k, x in sets]


def _experiment() -> list[AuditRow]:
    l_4, pair, half = np.array(PRINTED_TABLE).T
    links = np.column_stack([np.tile(EXPERIMENT, (len(l_4), 1)), l_4])
    low, high = PlanarArm(EXPERIMENT).workspace().radii
    figures = {
        "least": (low, 0.0),
        "most": (high, 10.0),
        "middle_links": (_apart(pair, np.sort(links)[:, 1:3].sum(axis=1)), 0.0),
        "middle_links_head": (_apart(pair, sum(EXPERIMENT[1:])), 0.0),
        "half": (_apart(half, l_4 / 2), 0.0),
        "half_of_all": (_apart(half, links.sum(axis=1) / 2), 0.0),
    }
    return _rows("experiment", figures)


def _apart(column: FloatArray, values: FloatArray | float) -> float:
    return float(np.abs(column - values).max())


def _relative_pose(p: Alpha5Parameters) -> list[AuditRow]:
    """A_j as printed and with the sign corrected, on Table 1 with all joints at mid-range."""
    middles = [*((j.lower + j.upper) / 2 for j in p.joints[:4]), 0.0]
    columns = [(row.d, row.a, row.alpha, row.theta_offset) for row in p.dh]
    d, a, alpha, offset = np.array(columns).T
    theta = offset + middles
    corrected = dh_transform(theta, d, a, alpha)
    printed = corrected.copy()
    printed[:, 1, 2] *= -1  # the third entry of row 2
    turn, twist = rotation_about((0, 0, 1), theta), rotation_about((1, 0, 0), alpha)
    product = transform(turn) @ transform(twist, np.column_stack([a, 0 * a, d]))
    rows = []
    for name, form in (("printed", printed), ("corrected", corrected)):
        tips = [np.linalg.multi_dot(poses)[:3, 3] for poses in (form, product)]
        effect, apart = float(np.linalg.norm(tips[0] - tips[1])), np.abs(form - product).max()
        rows.append(audited(f"relative_pose.{name}", apart, ARITHMETIC, effect=effect))
    return rows
