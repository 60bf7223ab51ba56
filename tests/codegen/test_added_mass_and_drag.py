"""Numbers of moving water for the kernels: any added mass, and known strips only."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.codegen.added_mass_and_drag import (
    STRIPS,
    WATER_PARAMETERS,
    water_parameters,
)
from alpha5_model.codegen.dimensions import Dimensions
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.codegen.regrouping import BASE_PARAMETERS
from alpha5_model.numbers.hydrodynamics import DragStrip

ARM = a5.parameters()
NO_MASS = np.zeros((4, 6, 6))
NO_STRIPS: list[list[DragStrip]] = [[], [], [], []]


def strip(start: list[float], end: list[float], **changes: float) -> DragStrip:
    numbers = {"diameter": 0.04, "across": 1.2, "along": 0.1} | changes
    return DragStrip(start=np.array(start), end=np.array(end), **numbers)


def known_strips() -> list[list[DragStrip]]:
    """One strip of each kind, at random places of its link."""
    rng = np.random.default_rng(1)
    found: list[list[DragStrip]] = [[], [], [], []]
    for kind in STRIPS:
        start = rng.uniform(-0.05, 0.05, 3)
        end = start.copy()
        end[kind.axis] += 0.08 if kind.points == 4 else 0.16
        made = strip(start.tolist(), end.tolist(), along=rng.uniform(0.1, 0.5))
        found[kind.link - 1].append(made)
    return found


def by_name(strips: list[list[DragStrip]], density: float = 1025.0) -> dict[str, float]:
    made = water_parameters(NO_MASS, strips, density, ARM)
    assert made is not None
    added, values = made
    np.testing.assert_array_equal(added, np.zeros(len(BASE_PARAMETERS)))
    return dict(zip(WATER_PARAMETERS, values.tolist(), strict=True))


def test_any_added_mass_gives_the_mass_matrix_of_its_kinetic_energy() -> None:
    """``M = sum of J^T A J``: A of each link, Pinocchio's Jacobian of its joint."""
    rng = np.random.default_rng(2)
    roots = rng.normal(size=(4, 6, 6))
    added_mass = roots @ np.swapaxes(roots, 1, 2)
    made = water_parameters(added_mass, NO_STRIPS, 1025.0, ARM)
    assert made is not None
    numbers = np.concatenate([*made, Dimensions.from_parameters(ARM).numbers])

    model = a5.load().model
    data = model.createData()
    still = np.zeros((4, 4))
    torque = np.empty((4, 4))
    for q in rng.uniform(LOWER, UPPER, (20, 4)):
        expected = np.zeros((4, 4))
        for joint, inertia in enumerate(added_mass, 1):
            jacobian = pin.computeJointJacobian(model, data, q, joint)
            expected += jacobian.T @ inertia @ jacobian
        states = [np.tile(q, (4, 1)), still, np.eye(4), np.zeros((4, 3))]
        kernels.compute("inverse_dynamics_in_current", numbers, *states, torque)
        np.testing.assert_allclose(torque.T, expected, rtol=0, atol=1e-12)


def test_a_strip_becomes_its_middle_half_length_and_drag() -> None:
    strips = known_strips()
    values = by_name(strips, density=1010.0)
    waiting = [list(own) for own in strips]
    for place, kind in enumerate(STRIPS):
        own = waiting[kind.link - 1].pop(0)
        half = np.linalg.norm(own.end - own.start) / 2
        middle = own.start + (own.end - own.start) / 2
        # All of the strip, rho / 2 c d (2 half), as of Morison.
        drag = 1010.0 / 2 * own.diameter * 2 * half
        expected = [*middle, half, own.across * drag, own.along * drag]
        found = [
            values[f"strip_{place}.{name}"]
            for name in ("x", "y", "z", "half", "across", "along")
        ]
        assert found == pytest.approx(expected, rel=1e-13)


def test_strips_that_are_missing_drag_nothing() -> None:
    assert set(by_name(NO_STRIPS).values()) == {0.0}
    second_only = [[], known_strips()[1], [], []]
    values = by_name(second_only)
    drawn = {name.partition(".")[0] for name, value in values.items() if value}
    assert drawn == {"strip_1"}


@pytest.mark.parametrize(
    "strips",
    [
        [[strip([0, 0, 0], [0, 0.01, 0.08])], [], [], []],  # askew
        [[strip([0, 0, 0], [0.08, 0, 0])], [], [], []],  # along another axis
        [[strip([0, 0, 0], [0, 0, 0.16])], [], [], []],  # of more points
        [[], [], [], [strip([0, 0, 0], [0, 0, 0.16])] * 2],  # one too many
        [[], [strip([0, 0, 0], [0, 0, 0.08])], [], []],  # of another link
    ],
)
def test_strips_that_the_kernels_do_not_know_are_left_to_pinocchio(
    strips: list[list[DragStrip]],
) -> None:
    assert water_parameters(NO_MASS, known_strips(), 1025.0, ARM) is not None
    assert water_parameters(NO_MASS, strips, 1025.0, ARM) is None
