"""Causes of a misfit, alone: against ordinary least squares and known distributions."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from alpha5_model.studies.uncertainty.misfit import (
    Equations,
    Suspect,
    _chance,
    named_causes,
    suspects,
)

RNG = np.random.default_rng(4)
FITTED = RNG.normal(size=(60, 3))
NOISE = RNG.normal(size=60)


def equations(columns: np.ndarray, rest: np.ndarray, **more: Any) -> Equations:
    given = {"squared": 0.0, "rank": 1, "samples": 50, "independent": 1e9, **more}
    return Equations(restricted=FITTED, of_suspects=columns, rest=rest, **given)


def suspect(name: str, width: int, unit: str = "", without: float = 0.0) -> Suspect:
    of = tuple(f"{name}_{k}" for k in range(width))
    nothing = np.zeros((0, 0, 0))
    return Suspect(name=name, of=of, unit=unit, columns=nothing, without=without)


def least_squares(
    columns: np.ndarray, rest: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Sizes of columns beside FITTED, their deviations, and the misfit they explain."""
    every = np.column_stack([FITTED, columns])
    solution = np.linalg.lstsq(every, rest, rcond=None)[0]
    deviation = np.sqrt(np.diag(np.linalg.inv(every.T @ every)))
    without = rest - FITTED @ np.linalg.lstsq(FITTED, rest, rcond=None)[0]
    left = rest - every @ solution
    explained = float(without @ without - left @ left)
    return solution[3:], deviation[3:], explained


CAUSES = (
    suspect("delay", 1),  # not there
    suspect("offset", 3, "N m"),  # the second part cannot be told from the fit
    suspect("mass of link_1", 1, without=1.0),  # cannot be told at all
    suspect("scale", 1, without=1.0),
    suspect("viscous", 2, "N m s/rad"),  # nearly in the fit
)
COLUMNS = RNG.normal(size=(60, 8))
COLUMNS[:, 2] = FITTED @ [1.0, -2.0, 0.5] + 1e-8 * RNG.normal(size=60)
COLUMNS[:, 4] = FITTED @ [0.3, 0.0, 1.0] + 1e-8 * RNG.normal(size=60)
COLUMNS[:, 6:] = FITTED[:, :2] + 1e-4 * RNG.normal(size=(60, 2))
TRUE = np.array([0.0, 2.0, 0.0, -3.0, 0.0, 1.5, 3e4, -2e4])
REST = FITTED @ [4.0, 5.0, 6.0] + COLUMNS @ TRUE + NOISE
# What is not there explains nothing.
LEFT = REST - FITTED @ np.linalg.lstsq(FITTED, REST, rcond=None)[0]
COLUMNS[:, 0] -= LEFT * (LEFT @ COLUMNS[:, 0]) / (LEFT @ LEFT)


def test_each_cause_alone_is_fitted_by_least_squares() -> None:
    found = list(named_causes([equations(COLUMNS, REST)], CAUSES))
    assert [one.name for one in found] == ["offset", "scale", "viscous"]
    kept = {"offset": [1, 3], "scale": [5], "viscous": [6, 7]}
    for one in found:
        size, deviation, squared = least_squares(COLUMNS[:, kept[one.name]], REST)
        without = 1.0 if one.name == "scale" else 0.0
        np.testing.assert_allclose(one.size, without + size, rtol=1e-6)
        np.testing.assert_allclose(one.deviation, deviation, rtol=1e-6)
        gain = squared - len(size) * np.log(50)
        assert one.gain == pytest.approx(gain, rel=1e-6)
    assert found[0].of == ("offset_0", "offset_2")
    assert [one.unit for one in found] == ["N m", "", "N m s/rad"]


@pytest.mark.parametrize("count", [1, 3])
def test_a_chance_is_that_of_a_known_distribution(count: int) -> None:
    """Of chi-squared with many independent samples; of Student's t with few."""
    from scipy import stats

    many = _chance(9.0, count, 1e12)
    assert many == pytest.approx(stats.chi2.sf(9.0, count), rel=1e-4)
    if count == 1:
        few = _chance(9.0, 1, 5.0)
        assert few == pytest.approx(2 * stats.t.sf(3.0, 5.0), rel=1e-9)


JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")


@pytest.mark.parametrize("channels", [JOINTS, COMPONENTS])
@pytest.mark.parametrize("density", [0.0, 1000.0, 1025.0])
def test_a_cause_changes_the_recording_as_its_name_says(
    channels: tuple[str, ...], density: float
) -> None:
    """Of efforts, or of the load on the mount, which tells no friction."""
    n = len(channels)
    rng = np.random.default_rng(n)
    time = np.cumsum(rng.uniform(0.1, 0.2, 30))
    velocity = rng.normal(size=(30, 4))
    regressor = rng.normal(size=(30, n, 38))
    nominal, by_density = rng.normal(size=(2, 38))
    by_mass = rng.normal(size=(5, 38))
    found = suspects(regressor, time, velocity, nominal, by_density, by_mass, density)
    computed = np.einsum("nij,j->ni", regressor, nominal)

    shared = {
        "scale": (computed, "", 1.0),
        "delay": (-np.gradient(computed, time, axis=0), "s", 0.0),
        "fluid": (regressor @ by_density, "kg/m^3", density),
    }
    shared |= {f"mass of link_{k}": (regressor @ by_mass[k], "", 1.0) for k in range(5)}
    units = "N m" if channels is JOINTS else "N, N m"
    each = {"scale": (computed, "", 1.0), "offset": (np.ones((30, n)), units, 0.0)}
    if channels is JOINTS:
        each["Coulomb"] = (np.sign(velocity), "N m", 0.0)
        each["viscous"] = (velocity, "N m s/rad", 0.0)

    assert len(found) == len(shared) + len(each)
    for one in found:
        alone = one.of != channels
        column, unit, without = (shared if alone else each)[one.name]
        assert (one.unit, one.without) == (unit, without)
        assert one.columns.shape == (30, n, 1 if alone else n)
        np.testing.assert_allclose(one.columns.sum(axis=-1), column)
        if not alone:
            off = one.columns * (1.0 - np.eye(n))
            assert not off.any()
        others = {0.0, 1000.0, 1025.0} - {density}
        assert set(one.usual) == (others if one.name == "fluid" else set())
