"""Histograms of a quantity, and quantiles from fine histograms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.reduction import IntArray, Reduction
from alpha5_model.studies.sweep.tables import Columns

#: Edges of a quantile's bins: sizes from 2^-20 to 2^20, 256 to an octave.
QUANTILE_EDGES = np.outer(
    np.ldexp(1.0, np.arange(-20, 20)), 1 + np.arange(256) / 256
).ravel()


#: Edges on each side of 0, and the number of the first among the double's own top bits:
#: sign, exponent and the 8 bits that number the edges of an octave.
_EDGES = QUANTILE_EDGES.size
_SHIFT = 44
_FIRST_EDGE = int(QUANTILE_EDGES[:1].view(np.int64)[0]) >> _SHIFT
#: A place that is computed is off by at most one if edges are so far apart, as a share
#: of the largest of them.
_FAR_APART = 1e-12


class Histogram(Reduction):
    """Counts of numbers between edges, below the first and above the last edge."""

    def __init__(self, output: Output, edges: FloatArray | None = None) -> None:
        if edges is None:
            low, high = output.range
            edges = np.linspace(low, high, output.bins + 1)
        self._inner_edges = edges
        self._edges = np.concatenate([[-np.inf], edges, [np.inf]])
        super().__init__(output, groups=len(edges) + 1)

        self._places = _even_places(edges)

    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN is ignored."""
        values = block.quantities[self.output.quantity]
        known = ~np.isnan(values)
        keys = self._place(values) + self.first_keys()
        kept = keys.ravel() if known.all() else keys[known]
        self.counts += np.bincount(kept, minlength=self.counts.size)

    def _place(self, values: FloatArray) -> IntArray:
        """The number of inner edges up to each value; any number for NaN."""
        if self._places is not None:
            return self._places(values)
        return np.searchsorted(self._inner_edges, values, side="right")

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

    def _place(self, values: FloatArray) -> IntArray:
        """The number of inner edges up to each value; any number for NaN.

        The edges are powers of two, divided evenly, so that the top bits of a number
        are that of its bin. A negative number at an edge is in the bin above, so the
        next one towards 0 is taken.
        """
        bits = np.ascontiguousarray(values).view(np.int64)
        sign = bits >> 63  # 0 or -1
        size = (bits & np.iinfo(np.int64).max) + sign
        size >>= _SHIFT
        size -= _FIRST_EDGE - 1
        np.clip(size, 0, _EDGES, out=size)
        size ^= sign
        size -= sign - _EDGES
        return size

    def result(self) -> Columns:
        """The levels, then for each column the edges of the bins of its quantiles."""
        levels = np.array(self.output.levels)
        table: Columns = {"level": levels}
        # NaN if there are no numbers at all.
        low = np.append(self._edges[:-1], np.nan)
        high = np.append(self._edges[1:], np.nan)
        for name, counts in self.counts_by_column().items():
            place = _bins_of_levels(levels, counts)
            table[f"{name}_low"] = low[place]
            table[f"{name}_high"] = high[place]
        return table


def _even_places(edges: FloatArray) -> Callable[[FloatArray], IntArray] | None:
    """A function that counts the edges up to each value; None if they are too uneven.

    It computes the place, which rounding may leave one off, and compares the value with
    the edges beside it.
    """
    count = edges.size - 1
    with np.errstate(over="ignore"):
        step = (edges[-1] - edges[0]) / count
        narrowest = np.diff(edges).min()
    if not narrowest > max(0.5 * step, _FAR_APART * np.abs(edges).max()):
        return None
    beside = np.concatenate([[-np.inf], edges, [np.nan]])  # no number is above NaN

    def places(values: FloatArray) -> IntArray:
        with np.errstate(over="ignore"):
            place = (values - edges[0]) / step
        np.fmax(place, -1.0, out=place)  # NaN, too
        np.fmin(place, count, out=place)
        place += 1.0
        found: IntArray = place.astype(np.int64)
        found -= values < beside[found]
        found += values >= beside[found + 1]
        return found

    return places


def _bins_of_levels(levels: FloatArray, counts: IntArray) -> NDArray[np.intp]:
    """The bins of the quantiles; the number of bins if there are no numbers."""
    up_to_bin = np.cumsum(counts)
    total = up_to_bin[-1]
    wanted = np.maximum(np.ceil(levels * total), 1)
    return np.asarray(np.searchsorted(up_to_bin, wanted))
