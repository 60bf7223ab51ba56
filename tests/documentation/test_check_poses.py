"""The poses of "From the arm to q" are those of its figure, and the tips are right."""

from __future__ import annotations

import re

import numpy as np
import pytest
from figures import guide_figures
from fk import tip
from pages import DOCS

import alpha5_model as a5

ROWS = re.findall(
    r"^\| \d \| ([\d., ]+) \| [^|]+ \| ([-\d, ]+) \|$",
    (DOCS / "guides" / "from-arm-to-q.md").read_text("utf-8"),
    re.MULTILINE,
)


def test_the_page_has_a_row_for_each_pose_that_is_drawn() -> None:
    assert len(ROWS) == len(guide_figures.CHECK_POSES) == 3


@pytest.mark.parametrize("pose", range(3))
def test_the_tip_follows_from_table_1(pose: int) -> None:
    devices, seen = (
        np.array([float(x) for x in cell.split(",")]) for cell in ROWS[pose]
    )
    drawn, _ = guide_figures.CHECK_POSES[pose]
    assert devices == pytest.approx(drawn, abs=0.005)
    q = guide_figures.check_position(drawn)
    assert q == pytest.approx(drawn), "devices 5 to 2 are joints 0 to 3"
    assert 1e3 * tip(q) == pytest.approx(seen, abs=0.5)


@pytest.mark.parametrize("pose", range(3))
def test_the_fingers_are_apart_along_y(pose: int) -> None:
    """The arm points along x in poses 1 and 2: left and right. In pose 3 it points
    along y: the other plane.
    """
    drawn, _ = guide_figures.CHECK_POSES[pose]
    closed = a5.parameters().joints[4].lower
    q = np.append(guide_figures.check_position(drawn), closed)
    arm = a5.load(gripper="jaws")
    finger_1, finger_2 = (
        arm.forward_kinematics(q, name).translation for name in ("finger_1", "finger_2")
    )
    x, y, z = abs(finger_1 - finger_2)
    assert y == pytest.approx(2 * 0.0155)
    assert (x, z) == pytest.approx((0.0, 0.0), abs=1e-12)
