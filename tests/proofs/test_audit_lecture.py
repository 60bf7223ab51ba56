"""The lecture's rows of the audit again, by turning hands and filling cells."""

from __future__ import annotations

import dataclasses
import itertools
import math
import os
import re
from pathlib import Path

import numpy as np
import pytest
import reference

import alpha5_model as a5
from alpha5_model.proofs.audit import lecture
from alpha5_model.proofs.audit.lecture import PRINTED_TABLE
from alpha5_model.proofs.audit.row import AuditRow


@pytest.fixture(scope="module")
def rows() -> dict[str, AuditRow]:
    return {row.claim: row for row in a5.audit()}


@dataclasses.dataclass(frozen=True)
class FourLinks:
    """A planar arm with links of these lengths; the last one is its hand."""

    lengths: tuple[int, int, int, int]

    def turns_fully(self) -> bool:
        """Whether links 1 and 2 reach the wrist in every orientation of the hand."""
        l_1, l_2, l_3, l_4 = self.lengths
        angle = np.linspace(0, 2 * np.pi, 721)
        wrist = np.hypot(l_4 + l_3 * np.cos(angle), l_3 * np.sin(angle))
        near_enough = wrist.max() <= l_1 + l_2 + 1e-9
        far_enough = wrist.min() >= abs(l_1 - l_2) - 1e-9
        return bool(near_enough and far_enough)

    def is_promised(self) -> bool:
        """Whether the theorem of the lecture says that the hand turns fully."""
        half = sum(self.lengths) / 2
        return all(sum(pair) >= half for pair in itertools.combinations(self._long, 2))

    def is_borderline(self) -> bool:
        """Whether the theorem would not say so with > in place of >=."""
        return sum(sorted(self._long)[:2]) == sum(self.lengths) / 2

    def has_a_longer_third_link(self) -> bool:
        return self.lengths[2] > min(self._long)

    @property
    def _long(self) -> tuple[int, int, int]:
        """The links that the theorem adds up in pairs."""
        l_1, l_2, _, l_4 = self.lengths
        return l_1, l_2, l_4


def test_the_theorem_by_turning_the_hand(rows: dict[str, AuditRow]) -> None:
    arms = [FourLinks(x) for x in itertools.product(range(1, 7), repeat=4)]
    turning = [arm for arm in arms if arm.turns_fully()]
    promised = [arm for arm in arms if arm.is_promised()]
    broken = [arm for arm in promised if not arm.turns_fully()]
    missed = [arm for arm in turning if not arm.is_promised()]
    longer = [arm for arm in turning if arm.has_a_longer_third_link()]
    borderline = [arm for arm in promised if arm.is_borderline()]

    for arm in missed:
        assert arm.lengths[3] <= min(arm.lengths[:3])
    sufficient = rows["lecture.sufficient"]
    assert sufficient.measured == 100 * len(broken) / len(promised) == 0
    assert sufficient.verdict == "agrees"
    necessary = rows["lecture.necessary"]
    assert necessary.measured == pytest.approx(100 * len(missed) / len(turning))
    assert necessary.verdict == "differs"
    shortest = rows["lecture.shortest"]
    assert shortest.measured == pytest.approx(100 * len(longer) / len(turning))
    strict = rows["lecture.strict"]
    assert strict.measured == pytest.approx(100 * len(borderline) / len(promised))
    assert longer
    assert borderline


def hand_turns(first: list[int], last: int, tip: int) -> bool:
    """Whether the wrist of a turning hand stays in the annulus of the first links."""
    angle = np.linspace(0, 2 * np.pi, 361)
    wrist = np.hypot(tip + last * np.cos(angle), last * np.sin(angle))
    inner = max(0, 2 * max(first) - sum(first))
    return bool(
        wrist.max() <= sum(first) + 1e-9 and wrist.min() >= inner - 1e-9,
    )


def test_the_theorem_with_four_joints(rows: dict[str, AuditRow]) -> None:
    """Two of the other links never reach half of the sum; three of them do."""
    row = rows["lecture.any_number"]
    turning = by_pairs = by_threes = broken = 0
    for *first, last, tip in itertools.product(range(1, 5), repeat=5):
        half = (sum(first) + last + tip) / 2
        others = [*first, tip]
        pairs_reach = all(sum(x) >= half for x in itertools.combinations(others, 2))
        threes_reach = all(sum(x) >= half for x in itertools.combinations(others, 3))
        turns = hand_turns(first, last, tip)

        turning += turns
        by_pairs += pairs_reach
        by_threes += threes_reach
        broken += threes_reach and not turns

    assert by_pairs == 0
    assert by_threes > 100
    assert f"of the {turning} sets" in row.measures
    assert f", {broken} promises are broken" in row.finding
    assert broken == 0
    tips = [tip for tip in range(1, 11) if hand_turns((3, 3, 3), 1, tip)]
    assert tips == [*range(1, 9)]
    example = "l = (3, 3, 3, 1), which turns fully at every distance up to 8,"
    assert example in row.finding
    assert (row.measured, row.verdict, row.category) == (100, "differs", "error")


def test_the_spatial_condition_by_counting_dimensions(
    rows: dict[str, AuditRow],
) -> None:
    """Only revolute joints turn the tool: three dimensions need three of them."""
    row = rows["dexterous_workspace.spatial"]
    assert (row.measured, row.verdict) == (0, "agrees")
    sequences = [
        kinds for n in range(1, 7) for kinds in itertools.product("RP", repeat=n)
    ]
    able = [kinds for kinds in sequences if len(kinds) == 6 and kinds.count("R") >= 3]
    assert f"the {len(able)} sequences of up to 6 joints" in row.measures


def test_the_notes_numbers_of_axes_and_frames(rows: dict[str, AuditRow]) -> None:
    middle = (reference.LOWER + reference.UPPER) / 2
    frames = reference.dh_frames(middle)
    steps = [np.linalg.inv(a) @ b for a, b in itertools.pairwise(frames)]
    apart = max(
        np.abs(step - frame).max()
        for step, frame in zip(steps, frames[1:], strict=True)
    )
    row = rows["relative_pose.superscript"]
    assert row.measured == pytest.approx(apart)
    gap = steps[-1][:3, 3] - frames[-1][:3, 3]
    assert row.effect == pytest.approx(1000 * np.linalg.norm(gap))
    assert row.verdict == "differs"
    labels = rows["relative_pose.axis_labels"]
    assert (labels.measured, labels.expected) == (0, 1)
    # theta_1 turns frame {1} about z_0, upright, and not about z_1, which lies level.
    turned = reference.dh_frames(middle + np.array([0.1, 0, 0, 0]))
    assert (turned[1] @ np.linalg.inv(frames[1]))[:3, :3] == pytest.approx(
        reference.rotation_z(0.1)[:3, :3]
    )
    assert abs(frames[1][2, 2]) < 1e-12


def test_two_links_with_limits_keep_their_hole(rows: dict[str, AuditRow]) -> None:
    """Law of cosines: with the elbow at its limit the tip is nearest to the base."""
    row = rows["planar_workspace.2r_limits"]
    assert row.measured == pytest.approx(math.sqrt(25 + 16 + 40 * math.cos(2.967)))
    assert row.measured > 1
    assert row.verdict == "differs"
    q = np.random.default_rng(0).uniform(-2.967, 2.967, (2, 400_000))
    x, y = (5 * f(q[0]) + 4 * f(q[0] + q[1]) for f in (np.cos, np.sin))
    assert np.hypot(x, y).min() == pytest.approx(row.measured, abs=1e-3)
    r = np.arange(1.0025, 9, 0.005)[:, None]
    bearing = np.linspace(-np.pi, np.pi, 1500, endpoint=False)
    missed = np.ones((len(r), bearing.size), dtype=bool)
    for side in (1, -1):
        elbow = side * np.arccos((r**2 - 41) / 40)
        shoulder = np.angle(np.exp(1j * bearing) / (5 + 4 * np.exp(1j * elbow)))
        missed &= (np.abs(elbow) > 2.967) | (np.abs(shoulder) > 2.967)
    lost = float((missed * r).sum()) * 0.005 * 2 * np.pi / bearing.size
    area = re.search(r"an area of (\d+\.\d)\.", row.finding)
    assert area, row.finding
    assert float(area[1]) == pytest.approx(lost, abs=0.06)
    for name, measured in (
        ("1r", 10 * math.pi),
        ("1r_limits", 5 * 2 * 2.967),
        ("1p", 2.0),
    ):
        assert rows[f"planar_workspace.{name}"].measured == pytest.approx(measured)
        assert rows[f"planar_workspace.{name}"].verdict == "agrees"
    for name, measured in (("2r", 80 * math.pi), ("3r", 100 * math.pi)):
        assert rows[f"planar_workspace.{name}"].measured == pytest.approx(measured)
        assert rows[f"planar_workspace.{name}"].verdict == "agrees"


def dexterous_cells(limit: float, spacing: float = 0.2) -> float:
    """The area that the arm (5, 4, 1) reaches with each of 90 hand orientations."""
    line = np.arange(-10 + spacing / 2, 10, spacing)
    tip = (line[:, None] + 1j * line[None, :])[..., None]
    hand = np.exp(1j * np.linspace(0, 2 * np.pi, 90, endpoint=False))
    wrist = tip - hand
    cosine = (np.abs(wrist) ** 2 - 25 - 16) / 40
    found = np.zeros(wrist.shape, dtype=bool)
    for side in (1, -1):
        with np.errstate(invalid="ignore"):
            elbow = side * np.arccos(cosine)
            shoulder = np.angle(wrist / (5 + 4 * np.exp(1j * elbow)))
            last = np.angle(hand * np.exp(-1j * (shoulder + elbow)))
        found |= np.max(np.abs([shoulder, elbow, last]), axis=0) <= limit
    return float(found.all(axis=-1).sum()) * spacing**2


def test_dexterous_without_a_free_joint(rows: dict[str, AuditRow]) -> None:
    row = rows["dexterous_workspace.necessary"]
    area = dexterous_cells(2.967)
    assert area == pytest.approx(155.8, abs=1.5)
    assert row.measured == pytest.approx(area, abs=row.bound)
    p = row.measured / (100 * math.pi)
    assert row.bound == pytest.approx(
        300 * math.pi * math.sqrt(p * (1 - p) / 4000), rel=1e-6
    )
    assert row.verdict == "differs"
    limits = rows["dexterous_workspace.limits"]
    assert (limits.measured, limits.bound) == (row.measured, row.bound)
    assert limits.expected == pytest.approx(math.pi * (64 - 4))
    assert limits.verdict == "agrees"


def test_the_experiments_columns(rows: dict[str, AuditRow]) -> None:
    for l_4, pair, half in PRINTED_TABLE:
        assert half == pytest.approx((5 + 4 + 1 + l_4) / 2)
        assert pair == pytest.approx(sum(sorted((5, 4, 1, l_4))[1:3]))
    figures = {
        "least": 0,
        "most": 10,
        "middle_links": 0,
        "half_of_all": 0,
        "middle_links_head": 9 - 5,
        "half": 10 - 5,
    }
    for name, measured in figures.items():
        row = rows[f"experiment.{name}"]
        assert row.measured == pytest.approx(measured, abs=1e-12)
        assert (row.verdict == "differs") == (name in ("middle_links_head", "half"))


def test_the_relative_pose_by_its_four_factors(rows: dict[str, AuditRow]) -> None:
    middle = (reference.LOWER + reference.UPPER) / 2
    wrong, worst = np.eye(4), 0.0
    for (d, offset, a, alpha), q in zip(reference.DH, [*middle, 0.0], strict=True):
        right = (
            reference.rotation_z(q + offset)
            @ reference.translation(a, d)
            @ reference.rotation_x(alpha)
        )
        printed = right.copy()
        printed[1, 2] = math.cos(q + offset) * math.sin(
            alpha
        )  # c_theta s_alpha, as the notes have it
        worst, wrong = max(worst, np.abs(printed - right).max()), wrong @ printed
    row = rows["relative_pose.printed"]
    assert row.measured == pytest.approx(worst)
    tip = reference.dh_frames(middle)[-1][:3, 3]
    assert row.effect == pytest.approx(1000 * np.linalg.norm(wrong[:3, 3] - tip))
    assert row.verdict == "impossible"


def test_a_changed_digit_of_the_table_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    table = [*PRINTED_TABLE[:6], (4.0, 8.5, 7.0), *PRINTED_TABLE[7:]]
    monkeypatch.setattr(lecture, "PRINTED_TABLE", tuple(table))
    found = {row.claim: row for row in lecture.rows(a5.parameters())}
    assert found["experiment.middle_links"].verdict == "differs"
    assert found["experiment.middle_links"].measured == 0.5
    assert found["experiment.half_of_all"].verdict == "agrees"


SEEDS = Path(
    os.environ.get("ALPHA5_SEEDS", Path(__file__).parents[2] / "shared" / "seeds")
)


def seed(name: str) -> str:
    files = list(SEEDS.glob(name))
    if not files:
        pytest.skip(f"the documents are not at {SEEDS}")
    return files[0].read_text("utf-8")


def test_the_lectures_table_and_matrix_arrived() -> None:
    text = seed("describing_robot_arms*")
    block = text.split("$l_4/2$\n")[1].split("\n\n")[0]
    assert [tuple(map(float, line.split("\t"))) for line in block.splitlines()] == list(
        PRINTED_TABLE
    )
    assert r"s_\theta & c_\theta c_\alpha & c_\theta s_\alpha & a s_\theta \\" in text
    assert "must be the shortest link" in text
    assert r"\lambda_2 + \lambda_3 > \frac{1}{2}L" in text
    assert "At least one revolute joint w/o limits" in text
    assert "valid for any number of revolute joints" in text
    assert "At least three revolute joints and at least three other joints" in text
    assert "{}^0A_j" in text
    words = " ".join(text.split())
    assert r"Label them $z_j$ , $j=1,2,\dots,N$" in words
    assert r"$\theta_j$ = angle about $z_{j-1}$" in words
