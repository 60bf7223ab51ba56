"""The lecture's statements on planar arms and on the DH transform, against the exact ones.

References:
    [Lecture7.1] Describing Robot Arms: "Workspace", "Dexterous Workspace", the theorem on a planar arm whose
        tip is pinned with its experiment, and the relative pose A_j.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.consistency.row import ARITHMETIC, AuditRow, judged, sampled_share
from alpha5_model.consistency.units import MM
from alpha5_model.kinematics.planar import PlanarArm, dexterity, dexterous_area, theorem_row
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.spatial import rotation_about, transform

#: Whole link lengths that are tried; sums and halves of them are exact.
LONGEST = 6
#: The experiment's link lengths and its table: l_4, the column headed l_2 + l_3, the one headed l_4/2.
EXPERIMENT = (5.0, 4.0, 1.0)
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
#: Limits to try the lecture's arms with [rad]: 170 deg either way, as far as many industrial joints turn.
LIMIT = 2.967
#: Last word of the claim, what is said, measured, expected, finding.
_Statement = tuple[str, str, float, float, str]
#: Points and orientations that the dexterous workspace with limits is sampled with.
POINTS, ORIENTATIONS = 4000, 120


def audit(p: Alpha5Parameters) -> list[AuditRow]:
    """The rows of the lecture, in its order."""
    return [*_workspaces(), *_dexterity(), *_theorem(), *_experiment(), *_relative_pose(p)]


def _row(
    claim: str, place: str, says: str, measured: float, expected: float, finding: str
) -> AuditRow:
    """A row of a statement on lengths or areas that holds exactly or not at all."""
    return judged(
        claim, f"Lecture 7.1, {place}", says, measured, "=", expected, ARITHMETIC, "", finding
    )


def _workspaces() -> list[AuditRow]:
    """The shapes that the lecture gives, each by its measure: length of a curve, area, radius of a hole."""
    one, two = EXPERIMENT[:1], EXPERIMENT[:2]
    limit = (-LIMIT, LIMIT)
    reach, hole = sum(two), abs(two[0] - two[1])
    limited = PlanarArm(two, [limit] * 2).workspace()
    rows: tuple[_Statement, ...] = (
        ("1r", "S1", _length(PlanarArm(one)), 2 * math.pi * one[0], "length of a whole circle"),
        (
            "1r_limits",
            "I with joint limits",
            _length(PlanarArm(one, [limit])),
            2 * LIMIT * one[0],
            "length of an arc",
        ),
        ("1p", "I", _length(PlanarArm([0], [(1, 3)], "P")), 2.0, "length of the joint's travel"),
        (
            "2r",
            "2R without limits: disc with a hole",
            PlanarArm(two).workspace().area,
            math.pi * (reach**2 - hole**2),
            "area, link lengths 5 and 4",
        ),
        (
            "2r_limits",
            "2R with joint limits: disc",
            limited.radii[0],
            0.0,
            f"radius of the hole, link lengths 5 and 4, limits +-{LIMIT} rad: limits fill no hole, they take "
            f"points away, here {math.pi * (reach**2 - hole**2) - limited.area:.1f} of the ring's area; a "
            "topological disc is left where they cut the ring open",
        ),
        (
            "3r",
            "3R is similar",
            PlanarArm(EXPERIMENT).workspace().area,
            math.pi * sum(EXPERIMENT) ** 2,
            "area, link lengths 5, 4 and 1, whose hole has closed",
        ),
    )
    return [_row(f"planar_workspace.{row[0]}", "Workspace", *row[1:]) for row in rows]


def _length(arm: PlanarArm) -> float:
    return math.fsum(curve.length for curve in arm.workspace().curves)


def _dexterity() -> list[AuditRow]:
    """The necessary condition for planar arms, by points spread evenly over the reach of a limited arm."""
    reach = sum(EXPERIMENT)
    turn, square = np.random.default_rng(0).uniform(size=(2, POINTS))
    bearing, radius = 2 * math.pi * turn, reach * np.sqrt(square)
    points = np.stack([radius * np.cos(bearing), radius * np.sin(bearing)], axis=-1)
    shares = [
        dexterity(PlanarArm(EXPERIMENT, [(-a, a)] * 3), points, ORIENTATIONS) == 1
        for a in (LIMIT, 0.75 * math.pi)
    ]
    disc = math.pi * reach**2 / 100
    (area, error), (least, _) = (tuple(disc * x for x in sampled_share(hits)) for hits in shares)
    free = dexterous_area(PlanarArm(EXPERIMENT))
    limits = f"l = (5, 4, 1) with +-{LIMIT} rad on every joint"
    return [
        judged(
            "dexterous_workspace.necessary",
            "Lecture 7.1, Dexterous Workspace",
            "necessary: a revolute joint without limits",
            area,
            "=",
            0.0,
            0.0,
            "",
            f"dexterous area of {limits}, where the condition leaves none; with +-135 deg it is still {least:.0f}",
            standard_error=error,
        ),
        judged(
            "dexterous_workspace.limits",
            "Lecture 7.1, Dexterous Workspace",
            "joint limits reduce the dexterous workspace",
            area,
            "<=",
            free,
            0.0,
            "",
            f"dexterous area of {limits} against that without limits",
            standard_error=error,
        ),
    ]


def _theorem() -> list[AuditRow]:
    """Both directions of the theorem, over every set of whole lengths l_1 ... l_4 up to `LONGEST`."""
    lengths = itertools.product(range(1, LONGEST + 1), repeat=4)
    rows = [(values, theorem_row(*map(float, values))) for values in lengths]
    promised = [row for _, row in rows if row.theorem]
    turning = [(values, row) for values, row in rows if row.exact]
    broken = sum(not row.exact for row in promised)
    missed = [values for values, row in turning if not row.theorem]
    longer = sum(values[2] > min(values) for values, _ in turning)
    strict = sum(row.pair == row.half for row in promised)
    example = ", ".join(map(str, missed[-1])) if missed else "none"
    sets = f"sets of whole lengths up to {LONGEST}"
    return [
        judged(
            f"lecture.{name}",
            f"Lecture 7.1, {place}",
            says,
            100 * count / whole,
            "=",
            0.0,
            0.0,
            "%",
            f"share of the {whole} {sets} {finding}",
        )
        for name, place, says, count, whole, finding in (
            (
                "sufficient",
                "theorem",
                "if l_i + l_j >= L/2, link 3 turns fully",
                broken,
                len(promised),
                "that the theorem promises and that do not turn",
            ),
            (
                "necessary",
                "theorem",
                "only if l_i + l_j >= L/2",
                len(missed),
                len(turning),
                f"that turn fully and that the theorem rules out, such as l = ({example}): those where l_4 is the "
                "shortest",
            ),
            (
                "shortest",
                "experiment",
                "l_3 must be the shortest link",
                longer,
                len(turning),
                "that turn fully with a link shorter than l_3: it follows from the theorem, not from the arm",
            ),
            (
                "strict",
                "experiment",
                "lambda_2 + lambda_3 > L/2",
                strict,
                len(promised),
                "that the theorem promises with its >= and that the strict sign would rule out",
            ),
        )
    ]


def _experiment() -> list[AuditRow]:
    l_4, pair, half = np.array(PRINTED_TABLE).T
    total = sum(EXPERIMENT)
    links = np.array([[*EXPERIMENT, value] for value in l_4])
    middle = np.sort(links)[:, 1:3].sum(axis=1)
    low, high = PlanarArm(EXPERIMENT).workspace().radii
    rows: tuple[_Statement, ...] = (
        ("least", "0 <= l_4", low, 0.0, "least distance of the tip from the base"),
        ("most", "l_4 <= 10", high, 10.0, "greatest distance of the tip from the base"),
        (
            "middle_links",
            "column l_2 + l_3",
            _apart(pair, middle),
            0.0,
            "largest difference of the column from lambda_2 + lambda_3, second and third longest link",
        ),
        (
            "middle_links_head",
            "column l_2 + l_3, its head",
            _apart(pair, sum(EXPERIMENT[1:])),
            0.0,
            "largest difference of the column from l_2 + l_3 = 5: lambda is meant",
        ),
        (
            "half",
            "column l_4/2, its head",
            _apart(half, l_4 / 2),
            0.0,
            "largest difference of the column from l_4/2",
        ),
        (
            "half_of_all",
            "the same column as L/2",
            _apart(half, (total + l_4) / 2),
            0.0,
            "largest difference of the column from L/2, half the sum of all four: that is meant",
        ),
    )
    return [_row(f"experiment.{row[0]}", "experiment", *row[1:]) for row in rows]


def _apart(column: FloatArray, values: FloatArray | float) -> float:
    return float(np.abs(column - values).max())


def _relative_pose(p: Alpha5Parameters) -> list[AuditRow]:
    """A_j as printed and with the sign mended, on Table 1 with every joint at the middle of its range."""
    angles = [
        (j.lower + j.upper) / 2 + row.theta_offset
        for j, row in zip(p.joints[:4], p.dh, strict=False)
    ]
    table = [
        (theta, row.d, row.a, row.alpha)
        for theta, row in zip([*angles, p.dh[4].theta_offset], p.dh, strict=True)
    ]
    product = [_product(*row) for row in table]
    rows = []
    for name, sign, says, finding in (
        (
            "printed",
            1,
            "row 2 of A_j: [s_theta, c_theta c_alpha, c_theta s_alpha, a s_theta]",
            "largest difference from the product of the four factors, rows of Table 1 at the middle of the ranges: "
            "the printed matrix is no rotation; the effect is the tcp's",
        ),
        (
            "corrected",
            -1,
            "the same with - c_theta s_alpha",
            "with the minus sign the matrix is the product",
        ),
    ):
        form = [_matrix(*row, sign) for row in table]
        tips = [np.linalg.multi_dot(factors)[:3, 3] for factors in (form, product)]
        rows.append(
            judged(
                f"relative_pose.{name}",
                "Lecture 7.1, standard DH, A_j",
                says,
                float(np.abs(np.subtract(form, product)).max()),
                "=",
                0.0,
                ARITHMETIC,
                "",
                finding,
                law=True,
                effect=float(np.linalg.norm(tips[0] - tips[1])) / MM,
                effect_unit="mm",
            )
        )
    return rows


def _matrix(theta: float, d: float, a: float, alpha: float, sign: int) -> FloatArray:
    """A_j as the lecture prints it, the third entry of its row 2 times ``sign``, (4, 4)."""
    c, s, ca, sa = math.cos(theta), math.sin(theta), math.cos(alpha), math.sin(alpha)
    return np.array(
        [
            [c, -s * ca, s * sa, a * c],
            [s, c * ca, sign * c * sa, a * s],
            [0, sa, ca, d],
            [0, 0, 0, 1],
        ]
    )


def _product(theta: float, d: float, a: float, alpha: float) -> FloatArray:
    """The four factors that the lecture gives for it, (4, 4)."""
    turn_z, turn_x = rotation_about((0, 0, 1), theta), rotation_about((1, 0, 0), alpha)
    return transform(turn_z @ turn_x, turn_z @ (a, 0.0, d))
