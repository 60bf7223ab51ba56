"""The lecture's statements on planar arms and on A_j, against the exact ones.

References:
    [Lecture7.1] Describing Robot Arms: "Workspace", "Dexterous Workspace", the theorem
        on a planar arm whose tip is pinned, with its experiment, and the relative pose
        A_j.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from functools import partial

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import rotation_about, transform
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.proofs.audit.geometry import sampled_share
from alpha5_model.proofs.audit.row import AuditRow, Figure, judged
from alpha5_model.theory.dh.chain import DHChain
from alpha5_model.theory.dh.link import dh_transform
from alpha5_model.theory.dh.types_and_tasks import spatial_conditions
from alpha5_model.theory.planar import (
    PlanarArm,
    dexterity,
    dexterous_area,
    dexterous_radii,
    theorem_row,
    turns_fully,
)

#: The experiment's link lengths l_1, l_2, l_3.
EXPERIMENT = (5.0, 4.0, 1.0)
#: The experiment's table: l_4, the column headed l_2 + l_3, the one headed l_4/2.
PRINTED_TABLE = (
    (10.0, 9.0, 10.0),
    (9.0, 9.0, 9.5),
    (8.0, 9.0, 9.0),
    (7.0, 9.0, 8.5),
    (6.0, 9.0, 8.0),
    (5.0, 9.0, 7.5),
    (4.0, 8.0, 7.0),
    (3.0, 7.0, 6.5),
    (2.0, 6.0, 6.0),
    (1.9, 5.9, 5.95),
)
#: Limit of each joint of the lecture's arms [rad]: 170 deg either way, as of many
#: industrial arms.
LIMIT = 2.967
#: Whole link lengths that are tried; sums and halves of them are exact.
LONGEST = 6
#: The same for arms of four links, which the closing note is about.
FOUR_LONGEST = 4
#: Most joints of the arms that test the spatial condition: six reach all dimensions.
SPATIAL_JOINTS = 6
#: Points with which the dexterous workspace with limits is sampled.
POINTS = 4000
#: Orientations that are tried at each of the points.
ORIENTATIONS = 120


def rows(parameters: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the lecture, in its order; those of A_j on the arm of Table 1."""
    return [
        *_workspaces(),
        *_dexterity(),
        _spatial_condition(),
        *_theorem(),
        _four_joints(),
        *_experiment(),
        _relative_pose(parameters),
        *_numbering(parameters),
    ]


# --- workspaces -----------------------------------------------------------------------


def _workspaces() -> list[AuditRow]:
    """The lecture's shapes, each by a length of curves, an area or a hole's radius."""
    one = EXPERIMENT[:1]
    two = EXPERIMENT[:2]
    limit = (-LIMIT, LIMIT)
    limited = PlanarArm(two, [limit, limit]).workspace()
    ring = math.pi * (sum(two) ** 2 - (two[0] - two[1]) ** 2)
    disc = math.pi * sum(EXPERIMENT) ** 2

    def length(arm: PlanarArm) -> float:
        return math.fsum(curve.length for curve in arm.workspace().curves)

    def area(arm: PlanarArm) -> float:
        return arm.workspace().area

    circle = length(PlanarArm(one))
    arc = length(PlanarArm(one, [limit]))
    travel = length(PlanarArm([0], [(1, 3)], "P"))
    hole = (
        f"radius of the hole for links of 5 and 4 and limits of ±{LIMIT} rad, if disc "
        "means one without a hole"
    )
    shapes = [
        ("1r", "1R: S1", "length of a whole circle", circle, 2 * math.pi * one[0]),
        ("1r_limits", "1R with joint limits: I", "length of an arc", arc, 10 * LIMIT),
        ("1p", "1P: I", "length of the joint's travel", travel, 2.0),
        (
            "2r",
            "2R without limits: disc with a hole",
            "area for links of 5 and 4",
            area(PlanarArm(two)),
            ring,
        ),
        ("2r_limits", "2R with joint limits: disc", hole, limited.radii[0], 0.0),
        (
            "3r",
            "3R is similar",
            "area for links of 5, 4 and 1, whose hole has closed",
            area(PlanarArm(EXPERIMENT)),
            disc,
        ),
    ]
    return [
        judged(
            f"planar_workspace.{name}",
            Figure(measured),
            expected=expected,
            place="Lecture 7.1, Workspace",
            says=says,
            measures=measures,
            finding="Limits only remove points of the ring, here an area of "
            f"{ring - limited.area:.1f}. The text is right if disc is meant "
            "topologically and the limits cut the ring open.",
            used="the exact region",
            category="reading",
        )
        for name, says, measures, measured, expected in shapes
    ]


def _dexterity() -> list[AuditRow]:
    """The necessary condition for planar arms, by points spread over the reach."""
    turn, square = np.random.default_rng(0).uniform(size=(2, POINTS))
    bearing = 2 * math.pi * turn
    radius = sum(EXPERIMENT) * np.sqrt(square)
    points = np.stack([radius * np.cos(bearing), radius * np.sin(bearing)], axis=-1)

    arm = PlanarArm(EXPERIMENT, [(-LIMIT, LIMIT)] * 3)
    share = sampled_share(dexterity(arm, points, ORIENTATIONS) == 1)
    disc = math.pi * sum(EXPERIMENT) ** 2
    area = Figure(disc * share.value, disc * share.bound)
    measures = (
        f"dexterous area of the arm l = (5, 4, 1) with limits of ±{LIMIT} rad on every "
        "joint"
    )
    judge = partial(
        judged,
        place="Lecture 7.1, Dexterous Workspace",
        used="the exact dexterous region",
    )
    return [
        judge(
            "dexterous_workspace.necessary",
            area,
            says="necessary: a revolute joint without limits",
            measures=measures,
            finding="By the condition there is no such area.",
        ),
        judge(
            "dexterous_workspace.limits",
            area,
            expected=dexterous_area(PlanarArm(EXPERIMENT)),
            relation="<=",
            says="joint limits reduce the dexterous workspace",
            measures=f"{measures}, compared with that without limits",
        ),
    ]


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
        numbers = rng.uniform(size=(SPATIAL_JOINTS, 4))
        chain = DHChain.from_table(list(np.column_stack([numbers, kinds])))
        jacobian = chain.jacobian(rng.uniform(size=SPATIAL_JOINTS))
        if np.linalg.matrix_rank(jacobian) < 6:
            continue
        able += 1
        ruled_out += not spatial_conditions(chain).satisfied

    return judged(
        "dexterous_workspace.spatial",
        Figure(ruled_out / able),
        unit="%",
        place="Lecture 7.1, Dexterous Workspace",
        says="necessary: three revolute joints and three others",
        measures=f"share that the condition rules out, of the {able} sequences of up "
        f"to {SPATIAL_JOINTS} joints whose tool moves in all six dimensions",
    )


# --- the theorem on a pinned tip, and its experiment ----------------------------------


def _theorem() -> list[AuditRow]:
    """Both directions of the theorem, for all whole lengths up to `LONGEST`."""
    lengths = np.array(list(itertools.product(range(1, LONGEST + 1), repeat=4)))
    answers = [theorem_row(*map(float, row)) for row in lengths]
    promised = np.array([answer.theorem for answer in answers])
    turning = np.array([answer.exact for answer in answers])
    tied = np.array([answer.pair == answer.half for answer in answers])
    third_is_longer = lengths[:, 2] > lengths.min(axis=1)
    example = ", ".join(map(str, lengths[turning & ~promised][-1]))

    whole = f"sets of whole lengths up to {LONGEST}"
    turn = f"of the {turning.sum()} {whole} with which link 3 turns fully"
    judge = partial(judged, unit="%")
    return [
        judge(
            "lecture.sufficient",
            Figure(np.mean(~turning[promised])),
            place="Lecture 7.1, theorem",
            says="if l_i + l_j >= L/2, link 3 turns fully",
            measures="share with which link 3 does not turn fully, of the "
            f"{promised.sum()} {whole} for which the theorem promises it",
        ),
        judge(
            "lecture.necessary",
            Figure(np.mean(~promised[turning])),
            place="Lecture 7.1, theorem",
            says="only if l_i + l_j >= L/2",
            measures=f"share that the theorem rules out, {turn}",
            finding="l_4 is the distance from the base to the pinned tip. In these "
            f"sets it is the shortest length, as in l = ({example}).",
            used="the exact condition",
        ),
        judge(
            "lecture.shortest",
            Figure(np.mean(third_is_longer[turning])),
            place="Lecture 7.1, experiment",
            says="l_3 must be the shortest link",
            measures=f"share with a link shorter than l_3, {turn}",
            finding="It is right if it only states what the theorem demands.",
            used="link lengths in any order",
            category="reading",
        ),
        judge(
            "lecture.strict",
            Figure(np.mean(tied[promised])),
            place="Lecture 7.1, experiment",
            says="lambda_2 + lambda_3 > L/2",
            measures=f"share that > rules out, of the {promised.sum()} {whole} for "
            "which the theorem, with >=, promises a full turn",
            finding="The theorem itself has >=.",
            used=">=",
            category="transcription",
        ),
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

    ((_, until),) = dexterous_radii(PlanarArm((3, 3, 3, 1)))
    return judged(
        "lecture.any_number",
        Figure(missed / turning),
        unit="%",
        place="Lecture 7.1, closing note",
        says="valid for any number of revolute joints",
        measures="share that the theorem's condition on pairs rules out, of the "
        f"{turning} sets of whole lengths up to {FOUR_LONGEST} with which link 4 turns "
        "fully",
        finding="Two pairs without a common length add up to less than L, so at least "
        "one of them is below L/2. Even with l = (3, 3, 3, 1), which turns fully at "
        f"every distance up to {until:g}, nothing is promised. With sums of three "
        f"lengths in place of pairs, {broken} promises are broken.",
        used="the exact condition, for any number of joints",
    )


def _sums_reach(half: float, lengths: Iterable[int], count: int) -> bool:
    """Whether every sum of so many of the lengths is at least ``half``."""
    return all(sum(some) >= half for some in itertools.combinations(lengths, count))


def _experiment() -> list[AuditRow]:
    """The experiment's printed table, against its links and its headings."""
    l_4, pair, half = np.array(PRINTED_TABLE).T
    links = np.column_stack([np.tile(EXPERIMENT, (len(l_4), 1)), l_4])
    middle_pair = np.sort(links)[:, 1:3].sum(axis=1)
    least, most = PlanarArm(EXPERIMENT).workspace().radii

    def apart(column: FloatArray, values: FloatArray | float) -> float:
        return float(np.abs(column - values).max())

    column = "largest difference between the column and"
    middle = "lambda_2 + lambda_3, the second and the third longest link"
    half_of_all = "L/2, half the sum of all four lengths"
    heading = apart(pair, sum(EXPERIMENT[1:]))
    middles = apart(pair, middle_pair)
    sums = apart(half, links.sum(axis=1) / 2)
    # Subject, what is printed, what is measured, the figure, and what it must be.
    claims = [
        ("least", "0 <= l_4", "least distance of the tip from the base", least, 0),
        ("most", "l_4 <= 10", "greatest distance of the tip from the base", most, 10),
        ("middle_links", "column l_2 + l_3", f"{column} {middle}", middles, 0),
        ("middle_links_head", "head l_2 + l_3", f"{column} l_2 + l_3 = 5", heading, 0),
        ("half", "head l_4/2", f"{column} l_4/2", apart(half, l_4 / 2), 0),
        ("half_of_all", "the same column as L/2", f"{column} {half_of_all}", sums, 0),
    ]
    holds = {"middle_links_head": middle, "half": half_of_all}
    return [
        judged(
            f"experiment.{name}",
            Figure(measured),
            expected=expected,
            place="Lecture 7.1, experiment",
            says=says,
            measures=measures,
            finding=f"The column holds {holds[name]}." if name in holds else "",
            used="what the column holds",
            category="transcription",
        )
        for name, says, measures, measured, expected in claims
    ]


# --- the relative pose A_j and its indices --------------------------------------------


def _middle(parameters: Alpha5Parameters) -> FloatArray:
    """Mid-range of the turning joints, (4,) [rad]."""
    joints = parameters.joints[:4]
    return np.array([(joint.lower + joint.upper) / 2 for joint in joints])


def _relative_pose(parameters: Alpha5Parameters) -> AuditRow:
    """A_j as printed, against the product of its factors."""
    table = parameters.dh
    d = np.array([row.d for row in table])
    a = np.array([row.a for row in table])
    alpha = np.array([row.alpha for row in table])
    offset = np.array([row.theta_offset for row in table])
    theta = offset + np.append(_middle(parameters), 0.0)

    printed = dh_transform(theta, d, a, alpha)
    printed[:, 1, 2] *= -1  # the third entry of row 2
    turn = transform(rotation_about((0, 0, 1), theta))
    lengths = np.column_stack([a, 0 * a, d])
    product = turn @ transform(rotation_about((1, 0, 0), alpha), lengths)

    tip, right_tip = (
        np.linalg.multi_dot(list(poses))[:3, 3] for poses in (printed, product)
    )
    return judged(
        "relative_pose.printed",
        Figure(np.abs(printed - product).max()),
        law=True,
        place="Lecture 7.1, standard DH, A_j",
        says="row 2 of A_j: [s_theta, c_theta c_alpha, c_theta s_alpha, a s_theta]",
        measures="largest difference between an entry of A_j and of the product of its "
        "four factors, for Table 1 with all joints at mid-range",
        finding="The printed matrix does not hold a rotation.",
        used="- c_theta s_alpha in row 2",
        effect=float(np.linalg.norm(tip - right_tip)),
        effect_unit="mm",
        cost="shift of the tcp, if you use the printed matrix",
        category="transcription",
    )


def _numbering(parameters: Alpha5Parameters) -> list[AuditRow]:
    """Two indices of the notes: of the axis of theta_1, and of the product A_j."""
    middle = _middle(parameters)
    chain = DHChain.alpha5(arm=parameters)
    frames = chain.frames(middle)
    one_radian_on = chain.frames(middle + np.eye(4)[0])
    turn = one_radian_on[1, :3, :3] @ frames[1, :3, :3].T
    # A rotation leaves its axis where it is.
    z = frames[:2, :3, 2]
    moved = np.linalg.norm(z @ turn.T - z, axis=1)

    steps = np.linalg.inv(frames[:-1]) @ frames[1:]
    tip_gap = steps[-1, :3, 3] - frames[-1, :3, 3]
    return [
        judged(
            "relative_pose.axis_labels",
            Figure(np.argmin(moved)),
            expected=1,
            place="Lecture 7.1, standard DH, frame assignment",
            says="the joint axes are z_1 to z_N",
            measures="index of the z axis about which theta_1 turns",
            finding="The lecture defines theta_j as the angle about z_{j-1}.",
            used="z_{j-1} for joint j",
            category="transcription",
        ),
        judged(
            "relative_pose.superscript",
            Figure(np.abs(steps - frames[1:]).max()),
            place="Lecture 7.1, standard DH, A_j",
            says="the product is ^0A_j, the pose of frame {j} in frame {0}",
            measures="largest difference between an entry of that pose and of the "
            "product, for Table 1 with all joints at mid-range",
            finding="The product is the pose of frame {j} in frame {j-1}.",
            used="^{j-1}A_j",
            effect=float(np.linalg.norm(tip_gap)),
            effect_unit="mm",
            cost="shift of the tcp, if you take the product for its pose in frame {0}",
            category="transcription",
        ),
    ]
