"""Sections 1 and 2 of the audit again: by hand, by cells that are filled, by chance."""

from __future__ import annotations

import dataclasses
import math
import re

import numpy as np
import pytest
import reference
from changed_documents import DOCUMENT, SUPPLEMENTARY, audit_of, changed

import alpha5_model as a5
from alpha5_model.proofs.audit import geometry
from alpha5_model.proofs.audit.row import AuditRow

LENGTHS = (20.0, 46.2, 145.3, 40.0, 20.0, 180.0)  # a_0, d_0, the elbow's two, a_2, -d_3


@pytest.fixture(scope="module")
def rows() -> dict[str, AuditRow]:
    return {row.claim: row for row in a5.audit()}


def test_no_other_frame_is_aligned(rows: dict[str, AuditRow]) -> None:
    """The largest angle between an inertial frame and its Denavit-Hartenberg frame."""
    angles = []
    for q in reference.configurations(20, seed=5):
        inertial = reference.inertial_frames(q)[1:]
        hartenberg = reference.dh_frames(q)[1:]
        for frame, dh in zip(inertial, hartenberg, strict=False):
            cosine = (np.trace(frame[:3, :3].T @ dh[:3, :3]) - 1) / 2
            angles.append(math.degrees(math.acos(np.clip(cosine, -1, 1))))
    assert rows["frames.aligned"].measured == pytest.approx(max(angles), abs=1e-5)
    assert min(angles) == pytest.approx(90, abs=1e-5)
    assert rows["frames.aligned"].verdict == "differs"


def printed_solution(
    x: np.ndarray, y: np.ndarray, height: np.ndarray, under: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(theta_0, theta_1) by the printed formulas, for the pose ``under`` or over arm.

    The document has ``theta_0 = atan2(y, x)`` overarm. That is negative for half of
    all targets, while the joint's range starts at 1 degree.
    """
    a_0, d_0, length, offset, a_2, d_3 = LENGTHS
    l_1, l_2 = math.hypot(offset, length), math.hypot(a_2, d_3)
    flat = np.hypot(x, y)
    reach = np.where(under, flat - a_0, flat + a_0)
    l_3 = np.hypot(reach, height - d_0)
    bearing = np.arctan2(height - d_0, reach)
    inner = np.arccos(np.clip((l_1**2 + l_3**2 - l_2**2) / (2 * l_1 * l_3), -1, 1))
    to_elbow = np.where(under, np.pi / 2 + bearing, 1.5 * np.pi - bearing) - inner

    theta_0 = np.arctan2(y, x) + np.where(under, np.pi, 0)
    theta_1 = to_elbow - math.asin(2 * a_2 / l_1)
    return theta_0, theta_1


def test_angles_outside_their_ranges(rows: dict[str, AuditRow]) -> None:
    """The share of recoverable poses whose angles the printed formulas return."""
    row = rows["inverse_kinematics.wrapping"]
    q = np.random.default_rng(8).uniform(reference.LOWER, reference.UPPER, (20_000, 4))
    recovered = q[:, 2] + elbow_constant() < np.pi

    r, height = plane(q[:, 1], q[:, 2])
    x = -r * np.cos(q[:, 0])
    y = -r * np.sin(q[:, 0])
    theta_0, theta_1 = printed_solution(x, y, height, under=r > 0)

    same_0 = np.abs(theta_0 - q[:, 0]) < 1e-6
    same_1 = np.abs(theta_1 - q[:, 1]) < 1e-6
    share = 100 * (same_0 & same_1)[recovered].mean()
    assert row.measured == pytest.approx(share, abs=row.bound)


def test_base_frame(rows: dict[str, AuditRow]) -> None:
    row = rows["base_frame.link_0"]
    x, y, _ = reference.COM[0]
    assert row.measured == pytest.approx(-x - 20)
    assert row.verdict == "differs"
    moment = reference.MASS[0] * 9.81 * 2 * math.hypot(x, y) / 1000
    assert row.effect == pytest.approx(moment)


def test_inner_offset(rows: dict[str, AuditRow]) -> None:
    row = rows["workspace.inner_offset"]
    assert (row.measured, row.expected) == (39.94, 40)
    assert row.bound == pytest.approx(0.005 + 0.5)
    assert row.verdict == "agrees"  # 39.94 rounds to 40


def test_tori(rows: dict[str, AuditRow]) -> None:
    a_0, _, length, offset, a_2, d_3 = LENGTHS
    tcp = reference.dh_frames(np.zeros(4))
    folded = np.linalg.norm(tcp[5][:3, 3] - tcp[1][:3, 3]) * 1000
    inner = rows["workspace.inner_torus"]
    assert inner.measured == pytest.approx(math.hypot(39.94 + a_2, length - d_3))
    assert inner.expected == pytest.approx(folded)
    # Half of each last digit along its leg; a_2 and d_3 are in both radii.
    printed, caption = [(x + a_2, length - d_3) for x in (39.94, offset)]
    expected = (printed[0] * 0.005 - printed[1] * 0.05) / math.hypot(*printed)
    expected += (caption[0] * 0.5 - caption[1] * 0.05) / math.hypot(*caption)
    assert inner.bound == pytest.approx(expected, rel=3e-3)
    outer = rows["workspace.outer_torus"]
    assert outer.expected == pytest.approx(
        math.hypot(offset, length) + math.hypot(d_3, a_2)
    )
    assert outer.verdict == "agrees"
    assert outer.measured == pytest.approx(outer.expected, abs=1e-9)
    elbow = tcp[2][:3, 3] * 1000
    assert rows["workspace.downward_centre"].measured == pytest.approx(
        math.hypot(*elbow[:2]) - a_0
    )
    assert rows["workspace.downward_centre"].measured == pytest.approx(40)
    assert rows["workspace.downward_radius"].measured == pytest.approx(
        math.hypot(20, 180)
    )
    assert {rows[f"workspace.downward_{n}"].verdict for n in ("centre", "radius")} == {
        "differs"
    }


@pytest.mark.parametrize(
    ("old", "new", "theta_2"),
    [
        ('upper = { value = "3.40339"', 'upper = { value = "2.0"', 2.0),
        ('lower = { value = "0.01745"', 'lower = { value = "3.1"', 3.1),
    ],
)
def test_the_outer_torus_asks_for_the_elbows_limits(
    old: str, new: str, theta_2: float
) -> None:
    """A limit before or beyond the stretched elbow keeps the arm from the torus."""
    head, _, tail = SUPPLEMENTARY.partition("[joints.axis_c]")
    assert old in tail
    limited = f"{head}[joints.axis_c]{tail.replace(old, new, 1)}"
    outer = audit_of(geometry.rows, supplementary=limited)
    row = outer["workspace.outer_torus"]
    frames = reference.dh_frames(np.array([0, 0, theta_2, 0]))
    distance = 1000 * np.linalg.norm(frames[5][:3, 3] - frames[1][:3, 3])
    assert row.measured == pytest.approx(distance)
    assert distance < row.expected - 1
    assert row.verdict == "differs"


def plane(theta_1: np.ndarray, theta_2: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """tcp in the arm's plane [mm], two links drawn by hand from Figure 4."""
    a_0, d_0, length, offset, a_2, d_3 = LENGTHS
    up = theta_1 - np.pi / 2 + reference.THETA_C  # direction of the first link
    fold = theta_2 + reference.THETA_C + math.atan(a_2 / d_3)  # angle between the links
    down = up + np.pi - fold
    l_1, l_2 = math.hypot(offset, length), math.hypot(a_2, d_3)
    return (
        a_0 + l_1 * np.cos(up) + l_2 * np.cos(down),
        d_0 + l_1 * np.sin(up) + l_2 * np.sin(down),
    )


@dataclasses.dataclass(frozen=True)
class Cells:
    """Cells of a vertical plane, and whether the arm reaches them."""

    radius: np.ndarray
    height: np.ndarray
    reached: np.ndarray

    def inside_the_tori(self, numbers: np.ndarray) -> np.ndarray:
        """The cells of the printed region, whose numbers are `TORUS_NUMBERS`."""
        a_0, d_0, length, offset, a_2, d_3, leg, other_leg, drop = numbers
        outer_radius = math.hypot(offset, length) + math.hypot(d_3, a_2)
        height = self.height - d_0
        square = (self.radius - a_0) ** 2 + height**2
        below_square = (self.radius - a_0) ** 2 + (height + drop) ** 2

        within_outer: np.ndarray = square <= outer_radius**2
        beyond_inner = square >= (leg + a_2) ** 2 + (other_leg - d_3) ** 2
        beyond_downward = below_square >= d_3**2
        return within_outer & beyond_inner & beyond_downward

    def shares(self, numbers: np.ndarray) -> dict[str, float]:
        """Percentages: of the region beyond reach, of the reach left out."""
        region = self.inside_the_tori(numbers)
        beyond = (region & ~self.reached).sum() / region.sum()
        outside = (self.reached & ~region).sum() / self.reached.sum()
        return {"beyond_reach": 100 * beyond, "left_out": 100 * outside}


#: `LENGTHS`, the two legs of the inner torus, the drop of the downward one. mm.
TORUS_NUMBERS = np.array([*LENGTHS, 39.94, 145.3, 145.3])
#: Half of the last digit of each.
TORUS_ROUNDING = [0.5, 0.05, 0.05, 0.5, 0.5, 0.5, 0.005, 0.05, 0.05]


@pytest.fixture(scope="module")
def cells() -> Cells:
    """Millions of joint positions paint a grid of 1 mm, without inverse kinematics."""
    t_1, t_2 = (
        np.linspace(reference.LOWER[i], reference.UPPER[i], 2400) for i in (1, 2)
    )
    r, z = plane(t_1[:, None], t_2[None, :])
    edges = np.arange(0.0, 361.0), np.arange(-300.0, 401.0)
    counts, *_ = np.histogram2d(np.abs(r).ravel(), z.ravel(), bins=edges)
    centres = [line[:-1] + 0.5 for line in edges]
    radius, height = np.meshgrid(*centres, indexing="ij")
    return Cells(radius=radius, height=height, reached=counts > 0)


def test_workspace_shares_by_filling_cells(
    rows: dict[str, AuditRow], cells: Cells
) -> None:
    for name, share in cells.shares(TORUS_NUMBERS).items():
        assert rows[f"workspace.{name}"].measured == pytest.approx(share, abs=0.8)
        assert rows[f"workspace.{name}"].verdict == "differs"
        assert rows[f"workspace.{name}"].bound < 1.5


def test_bounds_of_the_workspace_shares(
    rows: dict[str, AuditRow], cells: Cells
) -> None:
    """Roughly the change of each share by half of each last digit.

    The numbers move by eight such steps: a step of less than a cell would be lost.
    """
    shares = cells.shares(TORUS_NUMBERS)
    bounds = dict.fromkeys(shares, 0.0)
    for step in np.diag(TORUS_ROUNDING):
        more = cells.shares(TORUS_NUMBERS + 8 * step)
        less = cells.shares(TORUS_NUMBERS - 8 * step)
        for name, share in shares.items():
            change = max(abs(more[name] - share), abs(less[name] - share))
            bounds[name] += change / 8

    for name, bound in bounds.items():
        assert bound / 2 < rows[f"workspace.{name}"].bound < 2 * bound


def test_self_collision_point_by_point(rows: dict[str, AuditRow]) -> None:
    """Figure 2 again, with other points, single solutions and distances."""
    row = rows["workspace.self_collision"]
    assert row.verdict == "differs"
    p = row.measured / 100
    assert row.bound == pytest.approx(300 * math.sqrt(p * (1 - p) / 4000), rel=0.01)
    arm = a5.load()
    rng = np.random.default_rng(21)
    points = rng.uniform([-0.36, -0.36, -0.3], [0.36, 0.36, 0.4], (700, 3))
    solutions = a5.inverse_kinematics(points, 0.0)
    reached = touching = 0
    for q, within in zip(solutions.q, solutions.within_limits, strict=True):
        if within.any():
            reached += 1
            touching += not any(
                arm.collision_distance([*pose[:3], wrist]) > 0
                for pose in q[within]
                for wrist in np.linspace(0.0, 6.2, 9)
            )
    share = touching / reached
    assert reached > 200
    error = 3 * math.sqrt(p * (1 - p) / reached) + row.bound / 100
    assert share == pytest.approx(p, abs=error)


def elbow_constant() -> float:
    """gamma - theta_2 (rad); the printed formulas take the elbow 0 < gamma < pi."""
    _, _, length, offset, a_2, d_3 = LENGTHS
    l_1, l_2 = math.hypot(offset, length), math.hypot(a_2, d_3)
    return math.asin(2 * a_2 / l_1) + math.asin(a_2 / l_2)


def test_the_formulas_recover_one_bend_of_the_elbow(rows: dict[str, AuditRow]) -> None:
    gamma = elbow_constant()
    low, high = reference.LOWER[2], reference.UPPER[2]
    share = 100 * (min(high, math.pi - gamma) - low) / (high - low)
    row = rows["inverse_kinematics.branches"]
    assert share == pytest.approx(81.1, abs=0.05)
    assert row.measured == pytest.approx(share, abs=row.bound)
    assert row.verdict == "differs"
    assert row.finding.endswith("The four solutions recover 100 %.")


def planar_pose_in_range(cells_from_shoulder: np.ndarray, side: int) -> np.ndarray:
    """Whether the two links reach the cells with the elbow on a side.

    Cells are complex numbers, seen from the shoulder (mm).
    """
    _, _, length, offset, a_2, d_3 = LENGTHS
    l_1, l_2 = math.hypot(offset, length), math.hypot(a_2, d_3)
    square = np.abs(cells_from_shoulder) ** 2
    with np.errstate(invalid="ignore"):
        fold = side * np.arccos((l_1**2 + l_2**2 - square) / (2 * l_1 * l_2))
    to_elbow = np.angle(cells_from_shoulder) - np.angle(l_1 - l_2 * np.exp(-1j * fold))
    angles = {
        1: to_elbow + np.pi / 2 - reference.THETA_C,
        2: fold - reference.THETA_C - math.atan(a_2 / d_3),
    }

    within = np.ones(cells_from_shoulder.shape, bool)
    for i, angle in angles.items():
        turned = np.mod(angle - reference.LOWER[i], 2 * np.pi)
        within &= turned <= reference.UPPER[i] - reference.LOWER[i]
    return within


def test_the_tori_fit_the_underarm_pose(rows: dict[str, AuditRow]) -> None:
    """Cells of half a millimetre whose centre the two links reach, by cosines."""
    a_0, d_0, *_ = LENGTHS
    lines = np.arange(0.25, 361, 0.5), np.arange(-300.25, 401, 0.5)
    radius, height = np.meshgrid(*lines, indexing="ij")
    from_shoulder = (radius - a_0) + 1j * (height - d_0)
    elbow_up = planar_pose_in_range(from_shoulder, side=1)
    elbow_down = planar_pose_in_range(from_shoulder, side=-1)
    underarm = Cells(radius=radius, height=height, reached=elbow_up | elbow_down)

    share = underarm.shares(TORUS_NUMBERS)["left_out"]
    row = rows["workspace.left_out"]
    (printed,) = re.findall(r"The share is ([\d.]+) % if the tori", row.finding)
    assert float(printed) == pytest.approx(share, abs=0.02)
    assert float(printed) < row.measured / 8


#: Place in the document, other digits there -> the row whose verdict turns.
TURNED = [
    ("workspace.values.inner_offset", "38.94", "workspace.inner_offset"),
    ("workspace.values.inner_length", "155.3", "workspace.inner_torus"),
    ("table_1.elbow.opposite", "45", "inverse_kinematics.elbow_offset"),
    ("table_2.rows.0.com.0", "-2.425", "base_frame.link_0"),
]


@pytest.mark.parametrize(("place", "new", "claim"), TURNED)
def test_a_verdict_turns_with_a_printed_digit(
    rows: dict[str, AuditRow], place: str, new: str, claim: str
) -> None:
    turned = audit_of(geometry.rows, changed(DOCUMENT, place, new))
    agreed = rows[claim].verdict == "agrees"
    assert (turned[claim].verdict == "agrees") != agreed
