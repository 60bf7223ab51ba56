"""Colours of sRGB in linear light, against published tables and at the seam."""

from __future__ import annotations

import pytest

from alpha5_model.geometry.materials import linear_light


@pytest.mark.parametrize(
    ("byte", "linear"),
    # Some of the 256 values of sRGB that tables list, dark ones on the straight part.
    [
        (0, 0.0),
        (1, 0.000303527),
        (10, 0.003035270),
        (11, 0.003346536),
        (20, 0.006995410),
        (128, 0.215860500),
        (188, 0.502886458),
        (255, 1.0),
    ],
)
def test_bytes_of_srgb_in_linear_light(byte: int, linear: float) -> None:
    assert linear_light(byte / 255) == pytest.approx(linear, abs=1e-8)


def test_both_parts_of_the_curve_meet() -> None:
    below, above = linear_light(0.04045), linear_light(0.0404501)
    assert below == 0.04045 / 12.92
    assert above == pytest.approx(below, abs=1e-7)
