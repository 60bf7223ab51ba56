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

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.audit.row import (
    ARITHMETIC,
    AuditRow,
    audited,
    sampled_share,
    texts,
)
from alpha5_model.theory.dh.arm_types import spatial_conditions
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.link import dh_transform
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
#: The same for the closing note, with four links.
FOUR_LONGEST = 4
#: Four links whose last one turns fully at every distance of the tip up to a limit.
FOUR_LINKS = (3, 3, 3, 1)
#: Most joints of the arms for the spatial condition: with six, all dimensions are in reach.
SPATIAL_JOINTS = 6
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
    return [
        *_workspaces(),
        *_dexterity(),
        _spatial_condition(),
        *_theorem(),
        _four_joints(),
        *_experiment(),
        *_relative_pose(p),
        *_numbering(p),
    ]


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


def _rows(
    topic: str, figures: Figures, bound: float = ARITHMETIC, **words: Any
) -> list[AuditRow]:
    """Rows of a topic."""
    return [
        audited(f"{topic}.{k}", m, bound, e, **words) for k, (m, e) in figures.items()
    ]


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
    (area, error), (least, _) = (
        disc * np.array(sampled_share(hits)) for hits in shares
    )
    words: dict[str, Any] = {"standard_error": error, "limit": LIMIT, "least": least}
    figures = {
        "necessary": (area, 0.0),
        "limits": (area, dexterous_area(PlanarArm(EXPERIMENT))),
    }
    return _rows("dexterous_workspace", figures, 0.0, **words)


def _spatial_condition() -> AuditRow:
    """The spatial necessary condition, against the rank of the Jacobian of random arms.

    A dexterous workspace with an interior needs poses in all six dimensions. Every
    sequence of joints gets one random geometry; its rank is the largest that any geometry
    has, almost surely.
    """
    rng = np.random.default_rng(0)
    able = 0
    ruled_out = 0
    for count in range(1, SPATIAL_JOINTS + 1):
        for kinds in itertools.product((0, 1), repeat=count):
            sizes = rng.uniform(0.2, 1.0, (count, 3))
            turns = rng.uniform(0.3, 1.2, (count, 1))
            types = np.reshape(kinds, (count, 1))
            chain = DHChain.from_table([*np.hstack([sizes, turns, types])])
            jacobian = chain.jacobian(rng.uniform(-1.0, 1.0, count))
            if np.linalg.matrix_rank(jacobian) < 6:
                continue
            able += 1
            ruled_out += not spatial_conditions(chain).satisfied

    words: dict[str, Any] = {"joints": SPATIAL_JOINTS, "able": able}
    return audited("dexterous_workspace.spatial", ruled_out / able, **words)


def _theorem() -> list[AuditRow]:
    """Both directions of the theorem, for all whole lengths l_1 ... l_4 up to `LONGEST`."""
    lengths = np.array([*itertools.product(range(1, LONGEST + 1), repeat=4)])
    rows = [theorem_row(*map(float, row)) for row in lengths]
    promised, turning, tied = np.array(
        [(r.theorem, r.exact, r.pair == r.half) for r in rows]
    ).T
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
    return [
        audited(f"lecture.{k}", float(np.mean(x)), whole=len(x), **words)
        for k, x in sets
    ]


def _four_joints() -> AuditRow:
    """The closing note: the theorem for four revolute joints, with the pairs of all but link 4.

    In the form that carries over, the sums are of all lengths but the last link's and one
    other; for three links these are the theorem's pairs.
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
            by_pairs = all(
                sum(pair) >= half for pair in itertools.combinations(others, 2)
            )
            by_threes = all(
                sum(three) >= half for three in itertools.combinations(others, 3)
            )
            turns = turns_fully(arm, tip)
            turning += turns
            missed += turns and not by_pairs
            broken += by_threes and not turns

    ((_, until),) = dexterous_radii(PlanarArm(FOUR_LINKS))
    words: dict[str, Any] = {
        "whole": turning,
        "longest": FOUR_LONGEST,
        "example": ", ".join(map(str, FOUR_LINKS)),
        "until": until,
        "broken": broken,
    }
    return audited("lecture.any_number", missed / turning, **words)


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
        effect, apart = (
            float(np.linalg.norm(tips[0] - tips[1])),
            np.abs(form - product).max(),
        )
        rows.append(audited(f"relative_pose.{name}", apart, ARITHMETIC, effect=effect))
    return rows


def _numbering(p: Alpha5Parameters) -> list[AuditRow]:
    """Two indices of the notes, on Table 1 with all joints at mid-range."""
    chain = DHChain.alpha5()
    middle = np.array([(joint.lower + joint.upper) / 2 for joint in p.joints[:4]])
    frames = chain.frames(middle)

    # z_1, the label of the first joint's axis, against the axis about which theta_1 turns
    first = np.eye(4)[0]
    moved = chain.frames(middle + first)[1, :3, :3] @ frames[1, :3, :3].T
    axis = np.array(
        [
            moved[2, 1] - moved[1, 2],
            moved[0, 2] - moved[2, 0],
            moved[1, 0] - moved[0, 1],
        ]
    )
    along = [float(axis @ frame[:3, 2]) for frame in frames[:2]]
    turning = int(np.argmax(along))
    labels = audited("relative_pose.axis_labels", turning, expected=1)

    # {}^0A_j, frame {j} seen from the base, against the printed product, which is {}^{j-1}A_j
    steps = np.linalg.inv(frames[:-1]) @ frames[1:]
    apart = np.abs(steps - frames[1:]).max()
    tool_gap = steps[-1, :3, 3] - frames[-1, :3, 3]
    effect = float(np.linalg.norm(tool_gap))
    superscript = audited("relative_pose.superscript", apart, ARITHMETIC, effect=effect)
    return [labels, superscript]
