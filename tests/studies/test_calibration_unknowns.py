"""What is known of an arm before its calibration, and bodies that stay possible."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.measurement import Measurement
from alpha5_model.numbers.parameters import Alpha5Parameters, LinkParameters
from alpha5_model.studies.calibration.fitting import _searched
from alpha5_model.studies.calibration.possible_bodies import PossibleBodies
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

ARM = a5.parameters()
BODIES = 70


def place(name: str) -> int:
    return NAMES.index(name)


def test_the_loose_prior_is_ten_percent_and_5_mm() -> None:
    unknowns = arm_unknowns(ARM, "loose", moving=True)
    for link, known in zip(
        ARM.links, unknowns.deviation[:BODIES].reshape(5, 14), strict=True
    ):
        largest = np.abs(link.inertia).max()
        expected = [0.1 * link.mass, *[0.005] * 3, *[0.1 * largest] * 6]
        expected += [0.1 * link.volume, *[0.005] * 3]
        assert known == pytest.approx(expected, rel=1e-12)
    lengths = arm_unknowns(ARM, "digits").deviation[-4:]
    assert np.array_equal(unknowns.deviation[-4:], lengths)


def test_digits_are_known_to_half_a_unit() -> None:
    """One standard deviation of an even distribution is its half width / sqrt(3)."""
    unknowns = arm_unknowns(ARM)
    tenth = 0.5e-3 / np.sqrt(3)
    for name, width in (("a_0", tenth), ("d_0", tenth / 10), ("a_2", tenth)):
        found = unknowns.deviation[place(f"lengths.{name}")]
        assert found == pytest.approx(width, rel=1e-9)
    # a_1 is the hypotenuse of two printed lengths.
    a_1 = ARM.dh[1].a
    sides = a_1 * np.array([np.sin(ARM.theta_c), np.cos(ARM.theta_c)])
    changes = [np.hypot(*(sides + step)) - a_1 for step in ([5e-4, 0.0], [0.0, 5e-5])]
    expected = np.hypot(*changes) / np.sqrt(3)
    assert unknowns.deviation[place("lengths.a_1")] == pytest.approx(expected, rel=0.02)


def test_zeros_are_known_to_a_degree_or_as_the_file_says() -> None:
    rows = [place(f"zeros.axis_{letter}") for letter in "edcb"]
    assert arm_unknowns(ARM).deviation[rows] == pytest.approx([np.radians(1.0)] * 4)
    assert not arm_unknowns(ARM, zeros=0.0).deviation[rows].any()
    measured = Measurement(key="zeros.axis_c", source="a jig", half_width=0.006)
    record = replace(ARM, measurements=(measured,))
    found = arm_unknowns(record, zeros=0.02).deviation[rows]
    assert found == pytest.approx([0.02, 0.02, 0.006 / np.sqrt(3), 0.02])
    with pytest.raises(InputError, match="zeros"):
        arm_unknowns(ARM, zeros=-0.5)


def test_an_arm_at_rest_tells_no_moments_of_inertia() -> None:
    inertias = np.array([".inertia." in name for name in NAMES])
    for prior in ("digits", "loose"):
        still = arm_unknowns(ARM, prior).deviation
        moving = arm_unknowns(ARM, prior, moving=True).deviation
        assert not still[inertias].any()
        assert (moving[inertias] > 0).all()
        assert np.array_equal(still[~inertias], moving[~inertias])


def test_a_record_has_the_numbers_of_its_names() -> None:
    unknowns = arm_unknowns(ARM)
    rng = np.random.default_rng(1)
    values = unknowns.middle * rng.uniform(0.999, 1.001, len(NAMES))
    zeros = rng.uniform(-0.05, 0.05, 4)
    values[BODIES : BODIES + 4] = zeros
    for record in (unknowns.record(values), unknowns.lengthened(values)):
        for k, zero in enumerate(zeros):
            assert record.dh[k].theta_offset == ARM.dh[k].theta_offset + zero
        for name in ("a_0", "d_0", "a_1", "a_2"):
            row = record.dh[int(name[2])]
            assert getattr(row, name[0]) == values[place(f"lengths.{name}")]
        assert (record.dh[3].d, record.dh[3].a) == (ARM.dh[3].d, ARM.dh[3].a)
    assert unknowns.lengthened(values).links == ARM.links
    for number, link in enumerate(unknowns.record(values).links):
        key = f"links.link_{number}"
        for axis, side in enumerate("xyz"):
            assert link.com[axis] == values[place(f"{key}.com.{side}")]
            assert link.cob[axis] == values[place(f"{key}.cob.{side}")]
            for other, second in enumerate("xyz"):
                pair = "".join(sorted(side + second))
                assert (
                    link.inertia[axis, other] == values[place(f"{key}.inertia.{pair}")]
                )
        assert link.mass == values[place(f"{key}.mass")]
        assert link.volume == values[place(f"{key}.volume")]
    assert unknowns.record(unknowns.middle.copy()) is ARM


# --- possible bodies ------------------------------------------------------------------


def with_link_2(**changes: Any) -> Alpha5Parameters:
    links: list[LinkParameters] = list(ARM.links)
    links[2] = replace(links[2], **changes)
    return replace(ARM, links=tuple(links))


def bodies(arm: Alpha5Parameters) -> tuple[PossibleBodies, Any, Any]:
    unknowns = arm_unknowns(arm, "loose", moving=True)
    made = PossibleBodies(arm, unknowns.middle, unknowns.deviation)
    return made, unknowns.middle, unknowns.deviation


def test_zeros_stand_for_the_numbers_themselves() -> None:
    made, middle, _ = bodies(ARM)
    np.testing.assert_allclose(made.values(np.zeros(78)), middle, rtol=1e-12, atol=0)
    for body in range(5):
        inertia = slice(14 * body + 4, 14 * body + 10)
        found = made.values(np.zeros(78))[inertia]
        assert np.array_equal(found, middle[inertia])


@pytest.mark.parametrize("change", [-3.0, 0.5])
def test_masses_and_volumes_grow_as_exponentials(change: float) -> None:
    made, middle, deviation = bodies(ARM)
    values = made.values(np.full(78, change))
    for row in range(0, 70, 14):
        for number in (row, row + 10):
            share = deviation[number] / middle[number]
            assert np.log(values[number] / middle[number]) == pytest.approx(
                share * change
            )


def test_centres_follow_a_logistic_function() -> None:
    """Their log odds between the bounds grow evenly, with the prior's slope at 0."""
    made, middle, deviation = bodies(ARM)
    for change in (-2.0, 1.5):
        values = made.values(np.full(78, change))
        for body, link in enumerate(ARM.links):
            for axis in range(3):
                low, high = link.bounds[axis]
                row = 14 * body + 1 + axis
                odds = [(x - low) / (high - x) for x in (middle[row], values[row])]
                share = (middle[row] - low) / (high - low)
                slope = deviation[row] / ((high - low) * share * (1 - share))
                assert np.log(odds[1] / odds[0]) == pytest.approx(slope * change)


def test_a_centre_on_a_bound_moves_evenly() -> None:
    link = ARM.links[2]
    beside = link.bounds.copy()
    beside[0, 0] = link.com[0]
    beside[2, 1] = link.com[2]
    made, middle, deviation = bodies(with_link_2(bounds=beside))
    free = np.linspace(-2.0, 2.0, 78)
    rows = [29, 31]
    expected = (middle + deviation * free)[rows]
    assert made.values(free)[rows] == pytest.approx(expected, rel=1e-12)
    assert np.diag(made.slopes(free))[rows] == pytest.approx(deviation[rows])
    low, high = beside[1]
    far = made.values(np.full(78, 12.0))
    assert low < far[30] < high


def test_a_body_without_volume_stays_without() -> None:
    made, _, _ = bodies(with_link_2(volume=0.0))
    free = np.linspace(-2.0, 2.0, 78)
    assert made.values(free)[38] == 0.0
    assert not made.slopes(free)[38].any()


def test_wild_numbers_leave_possible_bodies() -> None:
    made, _, _ = bodies(ARM)
    for sign in (-1.0, 1.0):
        values = made.values(np.full(78, sign * 1e6))
        assert np.isfinite(values).all()
        assert np.isfinite(made.slopes(np.full(78, sign * 1e6))).all()
        for link, numbers in zip(ARM.links, values[:70].reshape(5, 14), strict=True):
            assert numbers[0] > 0
            assert numbers[10] > 0
            assert (link.bounds[:, 0] < numbers[1:4]).all()
            assert (numbers[1:4] <= link.bounds[:, 1]).all()


def test_known_tensors_stay() -> None:
    unknowns = arm_unknowns(ARM, "loose")
    made = PossibleBodies(ARM, unknowns.middle, unknowns.deviation)
    free = np.linspace(-2.0, 2.0, 78)
    inertias = [".inertia." in name for name in NAMES]
    assert np.array_equal(made.values(free)[inertias], unknowns.middle[inertias])
    assert not made.slopes(free)[inertias].any()


# --- the search -----------------------------------------------------------------------


def test_the_search_ends_at_least_squares() -> None:
    """Of a curved valley [Rosenbrock1960], where whole steps overshoot."""

    def misfit(z: Any) -> Any:
        return np.array([10.0 * (z[1] + 1.5 - (z[0] - 1.0) ** 2), 2.0 - z[0], 0.5])

    def slopes(z: Any) -> Any:
        return np.array([[-20.0 * (z[0] - 1.0), 10.0], [-1.0, 0.0], [0.0, 0.0]])

    z, squared = _searched(misfit, slopes, 2)
    assert z == pytest.approx([2.0, -0.5], abs=1e-8)
    assert squared == pytest.approx(0.25, abs=1e-12)


def test_steps_are_halved_until_they_gain() -> None:
    """Gauss's and Newton's full step of an arctangent leads further and further."""
    slope_at = 12.0

    def misfit(z: Any) -> Any:
        return np.arctan(slope_at * (z - 1.0))

    def slopes(z: Any) -> Any:
        return np.diag(slope_at / (1.0 + (slope_at * (z - 1.0)) ** 2))

    z, squared = _searched(misfit, slopes, 1)
    assert z == pytest.approx([1.0], abs=1e-6)
    assert squared < 1e-12


def test_a_search_without_a_gain_stays() -> None:
    def uphill(z: Any) -> Any:
        return np.array([1.0 + np.abs(z).sum()])

    z, squared = _searched(uphill, lambda _: np.array([[1.0]]), 1)
    assert z == pytest.approx([0.0])
    assert squared == 1.0


def test_the_search_goes_12_deviations_at_most() -> None:
    far = np.array([50.0, -50.0, 3.0])
    z, squared = _searched(lambda z: z - far, lambda _: np.eye(3), 3)
    assert z == pytest.approx([12.0, -12.0, 3.0])
    assert squared == pytest.approx(2 * 38.0**2)
