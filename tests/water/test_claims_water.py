"""What the guide on moving water claims of drag and added mass, by second routes."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from own_drag import own_torque
from reference import LOWER, UPPER

import alpha5_model as a5

REPOSITORY = Path(__file__).resolve().parents[2]


def drag_and_own_drag(factor: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Torque of drag of one joint that turns at its rated speed, and the tests' own.

    The tests' arm turns faster by a factor.
    """
    rng = np.random.default_rng(4)
    dry = a5.load()
    wet = dry.with_hydrodynamics()
    found = []
    expected = []
    for k, joint in enumerate(a5.parameters().joints[:3]):
        q = rng.uniform(LOWER, UPPER)
        v = np.eye(4)[k] * joint.velocity
        still = np.zeros(4)
        drag = wet.inverse_dynamics(q, v, still) - dry.inverse_dynamics(q, v, still)
        found.append(drag @ v)
        expected.append(-own_torque(q, factor * v, np.zeros(3)) @ v)
    return np.array(found), np.array(expected)


def test_drag_of_a_joint_in_still_water() -> None:
    """A power, so that added mass, which only turns the velocity, has no part in it."""
    found, expected = drag_and_own_drag()
    np.testing.assert_allclose(found, expected, rtol=2e-3)


def test_another_speed_would_be_seen() -> None:
    found, expected = drag_and_own_drag(factor=1.01)
    assert (np.abs(expected / found - 1) > 1e-2).all()


@pytest.mark.slow
def test_rings_of_sources_agree_with_the_handbook() -> None:
    """Added mass of cylinders across themselves, as DNV-RP-H103 prints it."""
    from hydrodynamics.revolution import cylinder_across

    for length, printed in {1.2: 0.62, 2.5: 0.78, 5.0: 0.90}.items():
        assert cylinder_across(length) == pytest.approx(printed, rel=0.025)


def shares(pose: str) -> list[float]:
    """Added mass of the whole arm over the sum of its bodies, by panels.

    Along and about the axes of the base, and about the joints.
    """
    file = REPOSITORY / "scripts" / "hydrodynamics" / "whole_arm.toml"
    found: dict[str, Any] = tomllib.loads(file.read_text("utf-8"))[pose]
    return [*found["base"], *found["joints"]]


def test_the_interval_of_added_mass_covers_the_arm_as_a_whole() -> None:
    """The stretched arm and a working pose; the folded one it does not, as is told."""
    low, nominal, high = (
        a5.load().with_hydrodynamics(level=level).added_mass("link_2")[1, 1]
        for level in ("low", "nominal", "high")
    )
    for pose in ("extended", "working"):
        assert low / nominal < min(shares(pose))
        assert max(shares(pose)) < high / nominal
    assert min(shares("folded")) < low / nominal
    assert max(shares("folded")) > high / nominal
