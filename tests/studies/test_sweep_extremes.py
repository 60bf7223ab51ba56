"""Extremes of random numbers with ties and gaps are those of a search through all."""

from __future__ import annotations

import itertools
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from alpha5_model.studies.sweep.extremes import Extremes
from alpha5_model.studies.sweep.histograms import (
    QUANTILE_EDGES,
    Histogram,
    Quantiles,
    _even_places,
)
from alpha5_model.studies.sweep.outputs import Output

#: Axes by which the rows are told apart, with the values of each.
AXES = {"fluid": ["air", "sea"], "load": [0.0, 0.1, 0.2]}


def output(form: str, by: tuple[str, ...] = ()) -> Output:
    return Output(
        quantity="torque",
        unit="N m",
        columns=("one", "two"),
        form=form,
        by=by,
        levels=(0.5, 1.0),
        range=(-1.0, 2.0),
        bins=6,
    )


def blocks_of(values: np.ndarray, index: dict[str, np.ndarray], size: int) -> list[Any]:
    """Rows in blocks of some size; in a block of one case, the axes have one index."""
    blocks = []
    for first in range(0, len(values), size):
        rows = np.arange(first, min(first + size, len(values)))
        own = {name: places[rows] for name, places in index.items()}
        for name, places in own.items():
            if size == 7 and name == "fluid":
                own[name] = places[0]
        block = SimpleNamespace(
            rows=rows, index=own, quantities={"torque": values[rows]}
        )
        blocks.append(block)
    return blocks


def searched(form: str, values: np.ndarray, rows: np.ndarray) -> tuple[float, int]:
    """The extreme of a column in some rows, and the first row that has it."""
    sign = {"peak": 1.0, "maximum": 1.0, "minimum": -1.0}[form]
    best, row = np.nan, -1
    for k in rows.tolist():
        value = abs(values[k]) if form == "peak" else values[k]
        if not np.isnan(value) and (row < 0 or sign * value > sign * best):
            best, row = value, k
    return best, row


@pytest.mark.parametrize("form", ["peak", "maximum", "minimum"])
@pytest.mark.parametrize("by", [(), ("load",), ("fluid", "load"), ("load", "fluid")])
@pytest.mark.parametrize("size", [7, 21])
def test_extremes_of_groups_in_any_order_of_blocks(
    form: str, by: tuple[str, ...], size: int
) -> None:
    """Half of the blocks are merged as parts of another process."""
    rng = np.random.default_rng(size)
    values = rng.integers(-4, 4, (42, 2)).astype(float)
    values[rng.random((42, 2)) < 0.2] = np.nan
    index = {
        "fluid": np.repeat([0, 1], 21),
        "load": rng.integers(0, 2, 42),  # no row has the last load
    }
    study = SimpleNamespace(axes=AXES)
    whole = Extremes(study, output(form, by))
    for k, block in enumerate(rng.permutation(blocks_of(values, index, size))):
        part = whole if k % 2 else Extremes(study, output(form, by))
        part.add(block)
        if part is not whole:
            table = part.parts("torque")
            assert set(table["output"]) <= {"torque"}
            whole.merge(table["key"], table["value"], table["count"])

    found = whole.result()
    groups = list(itertools.product(*(range(len(AXES[name])) for name in by)))
    for k, group in enumerate(groups):
        in_group = np.ones(42, bool)
        for name, place in zip(by, group, strict=True):
            assert found[name][k] == AXES[name][place]
            in_group &= index[name] == place
        for column, name in enumerate(("one", "two")):
            best, row = searched(form, values[:, column], np.flatnonzero(in_group))
            assert found[name][k] == pytest.approx(best, nan_ok=True)
            assert found[f"{name}_row"][k] == row
    assert len(found["one"]) == len(groups)


def test_bins_of_a_histogram_are_told_by_their_ends() -> None:
    values = np.array([[-3.0, 0.1], [-1.0, 0.2], [2.0, np.nan], [0.4, np.nan]])
    counts = Histogram(output("histogram"))
    part = Histogram(output("histogram"))
    for reduction, rows in ((counts, values[:3]), (part, values[3:])):
        reduction.add(SimpleNamespace(quantities={"torque": rows}))
    table = part.parts("bars")
    counts.merge(table["key"], table["value"], table["count"])
    found = counts.result()
    edges = [-np.inf, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, np.inf]
    assert found["low"].tolist() == edges[:-1]
    assert found["high"].tolist() == edges[1:]
    assert found["one"].tolist() == [1, 1, 0, 1, 0, 0, 0, 1]
    assert found["two"].tolist() == [0, 0, 0, 2, 0, 0, 0, 0]


def test_quantiles_lie_in_bins_of_256_to_an_octave() -> None:
    """From 2^-20 to 2^20 and their negatives, with 0 in a bin between them."""
    assert QUANTILE_EDGES[0] == 2.0**-20
    assert 1.0 in QUANTILE_EDGES
    growth = np.append(QUANTILE_EDGES[1:], 2.0**20) / QUANTILE_EDGES
    assert growth.min() > 1 + 1 / 512
    assert growth.max() == 1 + 1 / 256
    assert np.sum((QUANTILE_EDGES >= 1.0) & (QUANTILE_EDGES < 2.0)) == 256

    quantiles = Quantiles(output("quantile"))
    numbers = np.array([[0.0, np.nan], [-3.0, np.nan], [5.0, np.nan]])
    quantiles.add(SimpleNamespace(quantities={"torque": numbers}))
    found = quantiles.result()
    assert found["level"].tolist() == [0.5, 1.0]
    assert found["one_low"].tolist() == [-(2.0**-20), 5.0]
    assert found["one_high"].tolist() == [2.0**-20, 5.0 + 4 / 256]
    assert np.isnan(found["two_low"]).all()
    assert np.isnan(found["two_high"]).all()


@pytest.mark.parametrize(
    ("edges", "even"),
    [
        (np.linspace(-1.0, 3.0, 9), True),
        (np.linspace(1e9, 1e9 + 50.0, 6), True),
        (np.array([0.0, 0.6, 1.0, 1.4, 2.0]), True),
        (np.array([0.0, 1.0, 1.2, 3.0]), False),
        (QUANTILE_EDGES, False),
        (np.linspace(1e9, 1e9 + 1e-3, 6), False),
        (np.linspace(-1e9 - 1e-3, -1e9, 6), False),
    ],
)
def test_places_among_even_edges_are_computed_not_searched(
    edges: np.ndarray, even: bool
) -> None:
    """Too uneven: a step below half of the mean, or near the rounding of the edges."""
    places = _even_places(edges)
    assert (places is not None) == even
    if places is not None:
        values = np.random.default_rng(0).uniform(edges[0] - 1, edges[-1] + 1, 200)
        expected = np.searchsorted(edges, values, side="right")
        assert np.array_equal(places(values), expected)
