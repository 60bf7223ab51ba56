"""The bins of a number are those that a search among the edges finds."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from alpha5_model.studies.sweep.histograms import (
    QUANTILE_EDGES,
    Histogram,
    Quantiles,
)
from alpha5_model.studies.sweep.outputs import Output


def output(form: str, ends: tuple[float, float] = (0.0, 1.0), bins: int = 1) -> Output:
    return Output(
        quantity="torque",
        unit="N m",
        columns=("one", "two"),
        form=form,
        by=(),
        levels=(0.5,),
        range=ends,
        bins=bins,
    )


def beside(edges: np.ndarray) -> np.ndarray:
    """Each edge, and its neighbours among the floating-point numbers."""
    special = [0.0, -0.0, np.inf, -np.inf, 5e-324, -5e-324, 1e308, -1e308]
    around = [np.nextafter(edges, -np.inf), edges, np.nextafter(edges, np.inf)]
    return np.concatenate([*around, special])


def counted(reduction: Histogram, values: np.ndarray) -> None:
    """Take in the numbers as one column, and their negatives as the other."""
    quantities = {"torque": np.stack([values, -values], axis=1)}
    reduction.add(SimpleNamespace(quantities=quantities))


def searched(edges: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Counts by a search among the edges, and NaN left out."""
    known = values[~np.isnan(values)]
    place = np.searchsorted(edges, known, side="right")
    return np.bincount(place, minlength=edges.size + 1)


@pytest.mark.parametrize("seed", range(3))
def test_quantiles_count_every_number_in_its_bin(seed: int) -> None:
    edges = np.concatenate([-QUANTILE_EDGES[::-1], QUANTILE_EDGES])
    rng = np.random.default_rng(seed)
    drawn = rng.normal(size=5000) * np.exp2(rng.integers(-30, 30, 5000))
    values = np.concatenate([beside(edges), drawn, [-(2.0**20), 2.0**20]])
    if seed:
        values = np.append(values, [np.nan, -np.nan])
    reduction = Quantiles(output("quantile"))
    counted(reduction, values)
    found = reduction.counts_by_column()
    np.testing.assert_array_equal(found["one"], searched(edges, values))
    np.testing.assert_array_equal(found["two"], searched(edges, -values))


@pytest.mark.parametrize(
    ("ends", "bins"),
    [
        ((-1.0, 1.0), 8),
        ((-0.1, 0.7), 1000),
        ((0.1, 0.3), 1),
        ((-3e-5, 1e6), 99_999),
        ((-1e300, 1e300), 7),
        ((1e9, 1e9 + 1e-5), 50),  # edges that coincide
        ((1.0, math.nextafter(1.0, 2.0)), 3),
        ((-5e-324, 5e-324), 4),
        ((1e15, 1e15 + 40), 33),
    ],
)
def test_histograms_count_every_number_in_its_bin(
    ends: tuple[float, float], bins: int
) -> None:
    edges = np.linspace(*ends, bins + 1)
    rng = np.random.default_rng(bins)
    drawn = ends[0] + (ends[1] - ends[0]) * rng.uniform(-0.2, 1.2, 3000)
    values = np.concatenate([beside(edges), drawn, [np.nan]])
    reduction = Histogram(output("histogram", ends, bins))
    counted(reduction, values)
    found: dict[str, Any] = reduction.counts_by_column()
    np.testing.assert_array_equal(found["one"], searched(edges, values))
    np.testing.assert_array_equal(found["two"], searched(edges, -values))
