"""Names and numbers in the notes, curves and sliders of a page."""

from __future__ import annotations

import pytest

from alpha5_model.errors import InputError
from alpha5_model.viewer.live_controls import Controls, curve_name, slider
from alpha5_model.viewer.own_arm import _rounded


@pytest.mark.parametrize(
    ("number", "text"),
    [(-0.04, "0.0"), (-0.06, "\u22120.1"), (12.36, "12.4"), (-123.0, "\u2212123.0")],
)
def test_a_number_has_one_decimal_and_no_minus_zero(number: float, text: str) -> None:
    assert _rounded(number) == text


def test_a_name_has_1_to_40_characters() -> None:
    for name in ("x", "x" * 40):
        assert curve_name(name) == name
    for wrong in ("", "x" * 41, "a\nb"):
        with pytest.raises(InputError, match="1 to 40 printable characters"):
            curve_name(wrong)


def test_a_slider_starts_anywhere_from_end_to_end_or_in_the_middle() -> None:
    for value, start in ((-1.0, -1.0), (3.0, 3.0), (None, 1.0)):
        assert slider("gain", -1.0, 3.0, value, None).value == start
    for wrong in (-1.001, 3.001):
        with pytest.raises(InputError, match="a number from -1 to 3"):
            slider("gain", -1.0, 3.0, wrong, None)
    with pytest.raises(InputError, match="above low"):
        slider("gain", 1.0, 1.0, None, None)


def test_a_curve_is_sent_by_sample_and_whole_to_a_new_page() -> None:
    controls = Controls()
    first = controls.add_sample("depth", 2.0, 7.0)
    again = controls.add_sample("depth", 2.0, 8.0)  # a second one at the same time
    assert first == {
        "type": "curve",
        "name": "depth",
        "samples": [[2.0, 7.0]],
        "whole": False,
    }
    assert again["samples"] == [[2.0, 8.0]]
    (whole,) = controls.commands()
    assert whole["samples"] == [[2.0, 7.0], [2.0, 8.0]]
    assert whole["whole"]
    with pytest.raises(InputError, match="2 s or later"):
        controls.add_sample("depth", 1.999, 9.0)


def test_there_are_at_most_20_curves_and_20_sliders() -> None:
    controls = Controls()
    for number in range(20):
        controls.add_sample(f"curve {number}", 0.0, 0.0)
        controls.add_slider(slider(f"slider {number}", 0.0, 1.0, None, None))
    for refused in (
        lambda: controls.add_sample("one more", 0.0, 0.0),
        lambda: controls.add_slider(slider("one more", 0.0, 1.0, None, None)),
    ):
        with pytest.raises(InputError, match=r"at most 20; .* 19, got 21"):
            refused()
    controls.add_sample("curve 3", 1.0, 0.0)
    assert controls.add_slider(slider("slider 3", 0.0, 5.0, None, None))["value"] == 2.5
