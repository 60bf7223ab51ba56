"""Angles that printed digits stand for, and how much the digits leave open."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from urdf_edits import OWN

from alpha5_model.description.reading import parse_urdf
from alpha5_model.proofs.comparison.printed_digits import (
    Rounding,
    last_digits,
    meant_angle,
)

JOINT = parse_urdf(OWN).joints["axis_e"]


def test_two_decimals_stand_for_multiples_of_90_degrees_only() -> None:
    texts = [f"{hundredths / 100:.2f}" for hundredths in range(10, 700)]
    meant = {t: meant_angle(t) for t in texts if meant_angle(t) != float(t)}
    quarters = {"1.57": 1, "3.14": 2, "4.71": 3, "6.28": 4}
    assert meant == pytest.approx({t: n * math.pi / 2 for t, n in quarters.items()})


@pytest.mark.parametrize("digits", [3, 4, 5, 8])
@pytest.mark.parametrize("sign", [1, -1])
def test_each_multiple_of_15_degrees_up_to_a_turn_is_recognised(
    digits: int, sign: int
) -> None:
    # Below 45 deg a third digit is too coarse for a pi of three digits.
    for multiple in range(3 if digits == 3 else 1, 25):
        angle = sign * multiple * math.pi / 12
        text = f"{angle:.{digits}f}"
        assert meant_angle(text) == pytest.approx(angle, rel=1e-15), text
    for other in (25, 26, 0.5):
        text = f"{sign * other * math.pi / 12:.{digits}f}"
        assert meant_angle(text) == float(text)


@pytest.mark.parametrize(
    ("text", "twelfths"),
    [
        # 3.14 / 12 * 9 is 2.355: its digits may be one off, as far as pi is cut.
        ("2.354", 9),
        ("1.308", 5),
        ("3.139", 12),
        ("3.143", 12),
        ("6.285", 24),
    ],
)
def test_three_decimals_may_come_from_a_pi_of_three_digits(
    text: str, twelfths: int
) -> None:
    assert meant_angle(text) == pytest.approx(twelfths * math.pi / 12, rel=1e-15)


def printed(xyz: str, rpy: str = "0 0 0") -> Rounding:
    return last_digits([replace(JOINT, printed=(xyz, rpy))])


def test_what_the_digits_of_an_origin_leave_open() -> None:
    """Half of the finest last place, added in quadrature; integers are exact."""
    assert printed("0 1 -2.0", "0 3 1") == (0.0, 0.0, 0.0)
    assert printed("0.25 0 0").length == pytest.approx(0.005)
    assert printed("0.25 0.3 -1.125").length == pytest.approx(0.0005 * math.sqrt(3))
    assert printed("0.25 1.0 2").length == pytest.approx(0.005)
    assert printed("0 0 0", "0.2 0.25 1").angle == pytest.approx(0.005 * math.sqrt(2))


def test_multiples_of_pi_leave_open_by_how_much_they_are_cut() -> None:
    rounding = printed("0.5 0 0", "1.57 3.1416 0.1")
    assert rounding.pi == pytest.approx(math.pi / 2 - 1.57)
    assert rounding.angle == pytest.approx(0.05)
    assert rounding.length == pytest.approx(0.05)


def test_digits_of_several_joints_count_together() -> None:
    joints = [replace(JOINT, printed=(f"0.{k}5 0 0", "0 0 0")) for k in range(1, 5)]
    assert last_digits(joints).length == pytest.approx(0.005 * 2)
