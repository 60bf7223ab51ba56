"""What the page on uncertainty claims, by second routes."""

from __future__ import annotations

import numpy as np
import reference

import alpha5_model as a5

#: Table 2: the tensor of link 2 about its frame [kg mm^2]: xx, yy, zz, xy, xz, yz.
LINK_TENSOR = np.array([82.905, 2903.184, 2924.317, -77.380, -22.366, 0.342])
#: Each product stands twice in a tensor.
WEIGHT = np.sqrt([1, 1, 1, 2, 2, 2])
#: Half a unit of the last printed digit, of all numbers used here.
HALF = 5e-4


def implied_mass(com: np.ndarray, link: np.ndarray, at_com: np.ndarray) -> float:
    """Mass that leads from one tensor to the other, by least squares [kg]."""
    x, y, z = com
    per_mass = np.array(
        [y * y + z * z, x * x + z * z, x * x + y * y, x * y, x * z, y * z]
    )
    term = per_mass * WEIGHT
    return float(term @ ((link - at_com) * WEIGHT) / (term @ term))


def test_the_mass_that_link_2s_tensors_imply() -> None:
    """The value and its rounding, all digits at their worst, are the alternative's."""
    com = np.array(reference.COM[2])
    at_com = np.array(reference.INERTIA[2])
    middle = implied_mass(com, LINK_TENSOR, at_com)
    rounding = 0.0
    for step in HALF * np.eye(3):
        rounding += abs(implied_mass(com + step, LINK_TENSOR, at_com) - middle)
    for step in HALF * np.eye(6):
        rounding += abs(implied_mass(com, LINK_TENSOR + step, at_com) - middle)
        rounding += abs(implied_mass(com, LINK_TENSOR, at_com + step) - middle)

    numbers = a5.uncertainty.printed_numbers(["implied_mass"])
    ours = numbers["link_2.mass"]
    printed = a5.parameters().links[2].mass
    assert ours.lower <= middle <= ours.upper
    assert rounding < 0.01 * middle
    assert abs(middle - printed) > 5 * rounding, "the two masses are told apart"
