"""What is kept of quantities: extremes with their rows, and counts.

Blocks may come in any order. Nothing is added up in floating point: the same states
give the same result, whoever computed which of them.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.study import Study

_IntArray = NDArray[np.int64]
#: Edges of a quantile's bins: sizes from 2^-20 to 2^20, 256 to an octave.
QUANTILE_EDGES = np.outer(
    np.ldexp(1.0, np.arange(-20, 20)), 1 + np.arange(256) / 256
).ravel()


class Reduction(ABC):
    """One output in the making: a value and a count of each key.

    A key is a group of a column; the groups of the first column come first.

    Attributes:
        output: What is kept.
        groups: How many groups each column has.
        values: (keys,) The extremes so far; -inf if there is none.
        counts: (keys,) The rows of the extremes, or how many numbers fell into a bin.
    """

    def __init__(self, output: Output, groups: int) -> None:
        self.output = output
        self.groups = groups
        size = len(output.columns) * groups
        self.values = np.full(size, -np.inf)
        self.counts = np.zeros(size, np.int64)

    @abstractmethod
    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN counts for nothing."""

    @abstractmethod
    def merge(self, keys: _IntArray, values: FloatArray, counts: _IntArray) -> None:
        """Take in values and counts of some keys, which may repeat; rows in order."""

    @abstractmethod
    def known(self) -> NDArray[np.intp]:
        """The keys that have something."""

    @abstractmethod
    def result(self) -> dict[str, Any]:
        """Columns by name."""

    def parts(self, name: str) -> dict[str, Any]:
        """What `merge` takes of another reduction of this output, as a table."""
        keys = self.known()
        return {
            "output": np.full(len(keys), name),
            "key": keys,
            "value": self.values[keys],
            "count": self.counts[keys],
        }

    def first_keys(self) -> NDArray[np.intp]:
        """The key of the first group of each column."""
        return np.arange(len(self.output.columns)) * self.groups

    def counts_by_column(self) -> dict[str, _IntArray]:
        """Column -> counts of its groups."""
        counts = self.counts.reshape(-1, self.groups)
        return dict(zip(self.output.columns, counts, strict=True))


class Extremes(Reduction):
    """The peak, maximum or minimum of each group, and the first row that has it.

    A minimum is kept as the maximum of the negative numbers.
    """

    def __init__(self, study: Study, output: Output) -> None:
        grid = {**study.cases, **study.states}
        self._by = {name: grid[name] for name in output.by}
        super().__init__(output, math.prod(len(axis) for axis in self._by.values()))

    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN counts for nothing."""
        values = block.quantities[self.output.quantity]
        if self.output.form == "peak":
            values = np.abs(values)
        elif self.output.form == "minimum":
            values = -values

        first = self.first_keys()
        group: Any = 0
        for name, axis in self._by.items():
            group = group * len(axis) + block.index[name]
        if np.ndim(group):
            rows = np.repeat(block.rows, len(first))
        else:  # the block is in one group: the best row of each column is enough
            best = np.where(np.isnan(values), -np.inf, values).argmax(axis=0)
            rows = block.rows[best]
            values = values[best, np.arange(len(first))]
        self.merge(np.add.outer(group, first).ravel(), values.ravel(), rows)

    def merge(self, keys: _IntArray, values: FloatArray, counts: _IntArray) -> None:
        """Take in values and rows of some keys, which may repeat; rows in order."""
        kept = self.values[keys]
        larger = values > kept  # not NaN
        earlier = (values == kept) & (counts < self.counts[keys])
        better = larger | earlier

        keys = keys[better]
        values = values[better]
        rows = counts[better]
        np.maximum.at(self.values, keys, values)
        best = values == self.values[keys]
        # If a key repeats, the last assignment stays: that of the first row.
        self.counts[keys[best][::-1]] = rows[best][::-1]

    def known(self) -> NDArray[np.intp]:
        """The keys that have something."""
        return np.flatnonzero(self.values > -np.inf)

    def result(self) -> dict[str, Any]:
        """The axes, then each column and its row; NaN and -1 if a group has none."""
        grid = np.meshgrid(*self._by.values(), indexing="ij")
        table: dict[str, Any] = {
            name: places.ravel() for name, places in zip(self._by, grid, strict=True)
        }
        sign = -1.0 if self.output.form == "minimum" else 1.0
        extremes = self.values.reshape(-1, self.groups)
        rows = self.counts_by_column()
        for name, extreme in zip(self.output.columns, extremes, strict=True):
            unknown = extreme == -np.inf
            table[name] = np.where(unknown, np.nan, sign * extreme)
            table[f"{name}_row"] = np.where(unknown, -1, rows[name])
        return table


class Histogram(Reduction):
    """How many numbers fall between two edges, below the first and above the last."""

    def __init__(self, output: Output, edges: FloatArray | None = None) -> None:
        if edges is None:
            low, high = output.range
            edges = np.linspace(low, high, output.bins + 1)
        self._inner_edges = edges
        self._edges = np.concatenate([[-np.inf], edges, [np.inf]])
        super().__init__(output, groups=len(edges) + 1)

    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN counts for nothing."""
        values = block.quantities[self.output.quantity]
        place = np.searchsorted(self._inner_edges, values, side="right")
        keys = place + self.first_keys()
        np.add.at(self.counts, keys[~np.isnan(values)], 1)

    def merge(self, keys: _IntArray, values: FloatArray, counts: _IntArray) -> None:
        """Take in counts of some keys, which may repeat."""
        np.add.at(self.counts, keys, counts)

    def known(self) -> NDArray[np.intp]:
        """The keys that have something."""
        return np.flatnonzero(self.counts)

    def result(self) -> dict[str, Any]:
        """The edges of each bin, then the counts of each column."""
        return {
            "low": self._edges[:-1],
            "high": self._edges[1:],
            **self.counts_by_column(),
        }


class Quantiles(Histogram):
    """Bins so fine that they tell quantiles."""

    def __init__(self, output: Output) -> None:
        super().__init__(
            output, np.concatenate([-QUANTILE_EDGES[::-1], QUANTILE_EDGES])
        )

    def result(self) -> dict[str, Any]:
        """The levels, then for each column the edges of the bins that they are in."""
        levels = np.array(self.output.levels)
        table: dict[str, Any] = {"level": levels}
        edges = np.append(self._edges, np.nan)  # NaN if there are no numbers at all
        for name, counts in self.counts_by_column().items():
            sums = np.cumsum(counts)
            wanted = np.maximum(np.ceil(levels * sums[-1]), 1)
            place = np.searchsorted(sums, wanted)
            table[f"{name}_low"] = edges[place]
            table[f"{name}_high"] = edges[place + 1]
        return table


def reductions(study: Study) -> dict[str, Reduction]:
    """An empty reduction of each output that is not a table, by name."""
    return {
        name: _reduction(study, output)
        for name, output in study.outputs.items()
        if output.form != "table"
    }


def _reduction(study: Study, output: Output) -> Reduction:
    """An empty reduction of an output."""
    if output.form == "quantile":
        return Quantiles(output)
    if output.form == "histogram":
        return Histogram(output)
    return Extremes(study, output)
