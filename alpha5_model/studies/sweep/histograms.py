"""Histograms of a quantity, and quantiles from fine histograms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block, Columns
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.reduction import IntArray, Reduction

#: Edges of a quantile's bins: sizes from 2^-20 to 2^20, 256 to an octave.
QUANTILE_EDGES = np.outer(
    np.ldexp(1.0, np.arange(-20, 20)), 1 + np.arange(256) / 256
).ravel()


class Histogram(Reduction):
    """Counts of numbers between edges, below the first and above the last edge."""

    def __init__(self, output: Output, edges: FloatArray | None = None) -> None:
        if edges is None:
            low, high = output.range
            edges = np.linspace(low, high, output.bins + 1)
        self._inner_edges = edges
        self._edges = np.concatenate([[-np.inf], edges, [np.inf]])
        super().__init__(output, groups=len(edges) + 1)

    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN is ignored."""
        values = block.quantities[self.output.quantity]
        place = np.searchsorted(self._inner_edges, values, side="right")
        keys = place + self.first_keys()
        np.add.at(self.counts, keys[~np.isnan(values)], 1)

    def merge(self, keys: IntArray, values: FloatArray, counts: IntArray) -> None:
        """Take in counts of some keys, which may repeat."""
        np.add.at(self.counts, keys, counts)

    def known(self) -> NDArray[np.intp]:
        """The keys that have an entry."""
        return np.flatnonzero(self.counts)

    def result(self) -> Columns:
        """The edges of each bin, then the counts of each column."""
        return {
            "low": self._edges[:-1],
            "high": self._edges[1:],
            **self.counts_by_column(),
        }


class Quantiles(Histogram):
    """A histogram whose bins are fine enough for quantiles."""

    def __init__(self, output: Output) -> None:
        edges = np.concatenate([-QUANTILE_EDGES[::-1], QUANTILE_EDGES])
        super().__init__(output, edges)

    def result(self) -> Columns:
        """The levels, then for each column the edges of the bins of its quantiles."""
        levels = np.array(self.output.levels)
        table: Columns = {"level": levels}
        edges = np.append(self._edges, np.nan)  # NaN if there are no numbers at all
        for name, counts in self.counts_by_column().items():
            place = _bins_of_levels(levels, counts)
            table[f"{name}_low"] = edges[place]
            table[f"{name}_high"] = edges[place + 1]
        return table


def _bins_of_levels(levels: FloatArray, counts: IntArray) -> NDArray[np.intp]:
    """The bins of the quantiles; the number of bins if there are no numbers."""
    up_to_bin = np.cumsum(counts)
    total = up_to_bin[-1]
    wanted = np.maximum(np.ceil(levels * total), 1)
    return np.asarray(np.searchsorted(up_to_bin, wanted))
