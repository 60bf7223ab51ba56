"""What is known of an arm before its calibration."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.studies.calibration.possible_bodies import PossibleBodies
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

ARM = a5.parameters()
BODIES = 70


def place(name: str) -> int:
    return NAMES.index(name)


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


def bodies(arm: Alpha5Parameters) -> tuple[PossibleBodies, Any, Any]:
    unknowns = arm_unknowns(arm, "loose", moving=True)
    made = PossibleBodies(arm, unknowns.middle, unknowns.deviation)
    return made, unknowns.middle, unknowns.deviation
