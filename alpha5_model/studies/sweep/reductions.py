"""What is kept of a quantity: extremes with their rows, histograms, quantiles.

Each reduction has one number for each column of the quantity and each group of rows. It
takes in rows, and the entries of reductions of other rows. No floating-point numbers
are added up, so the result does not depend on how the rows are divided.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.study import Output, Study

IntArray: TypeAlias = NDArray[np.int64]
#: Columns of a table by name.
Columns: TypeAlias = dict[str, NDArray[Any]]
#: Edges of a quantile's bins on each side of 0, from 2^-20 to 2^20: each octave has
#: this many of the same width.
_OCTAVE = 256
_LEAST = -20
_MOST = 20
_EDGES = np.outer(
    np.ldexp(1.0, np.arange(_LEAST, _MOST)), 1 + np.arange(_OCTAVE) / _OCTAVE
).ravel()


class Extremes:
    """The peak, maximum or minimum of each group, and the first row that has it.

    A minimum is kept as the maximum of the negated numbers.
    """

    def __init__(self, output: Output, grid: Mapping[str, Sequence[Any]]) -> None:
        self._output = output
        self._by = {axis: grid[axis] for axis in output.by}
        groups = math.prod(map(len, self._by.values()))
        shape = (len(output.columns), groups)
        self._values = np.full(shape, -np.inf)
        self._rows = np.full(shape, -1)

    def add(self, values: FloatArray, index: Mapping[str, Any], rows: IntArray) -> None:
        """Take in later rows; NaN is ignored.

        Args:
            values: Of the quantity, (n, columns).
            index: Axis -> index of its value, one for all rows or (n,).
            rows: Their numbers, rising, (n,).
        """
        group: Any = 0
        for axis, on_axis in self._by.items():
            group = group * len(on_axis) + index[axis]
        if self._output.form == "peak":
            values = np.abs(values)
        if self._output.form == "minimum":
            values = -values

        for k, column in enumerate(values.T):
            if np.ndim(group):
                self._take(k, group, column, rows)
            else:  # of one group: its best row is enough
                best = [np.argmax(np.where(np.isnan(column), -np.inf, column))]
                self._take(k, np.array([group]), column[best], rows[best])

    def _take(self, k: int, group: IntArray, value: FloatArray, row: IntArray) -> None:
        """Take in values of column k, (n,); rows in order, after those before."""
        kept = self._values[k]
        better = value > kept[group]  # of equal values the earlier row stays; no NaN
        group = group[better]
        value = value[better]
        row = row[better]
        np.maximum.at(kept, group, value)
        best = np.flatnonzero(value == kept[group])[::-1]
        # The last assignment to a group stays: that of its first row.
        self._rows[k][group[best]] = row[best]

    def entries(self) -> Columns:
        """Column, group, value and row of what is known."""
        column, group = np.nonzero(self._values > -np.inf)
        value = self._values[column, group]
        return {
            "column": column,
            "group": group,
            "value": value,
            "number": self._rows[column, group],
        }

    def merge(self, entries: Columns) -> None:
        """Take in the entries of later rows."""
        for k in range(len(self._output.columns)):
            own = entries["column"] == k
            self._take(
                k,
                group=entries["group"][own],
                value=entries["value"][own],
                row=entries["number"][own],
            )

    def table(self) -> Columns:
        """The axes, then each column and its row; NaN and -1 if a group has none."""
        axes = np.meshgrid(*self._by.values(), indexing="ij")
        table = {name: axis.ravel() for name, axis in zip(self._by, axes, strict=True)}
        sign = -1.0 if self._output.form == "minimum" else 1.0
        extremes = np.where(self._rows < 0, np.nan, sign * self._values)
        for k, name in enumerate(self._output.columns):
            table[name] = extremes[k]
            table[f"{name}_row"] = self._rows[k]
        return table


class Histogram:
    """Numbers of values in each bin, below the first and above the last."""

    def __init__(self, output: Output, edges: FloatArray) -> None:
        self._output = output
        self._edges = np.concatenate([[-np.inf], edges, [np.inf]])
        self._counts = np.zeros((len(output.columns), len(edges) + 1), np.int64)

    def add(self, values: FloatArray, index: Mapping[str, Any], rows: IntArray) -> None:
        """Take in more rows, see `Extremes.add`; NaN is ignored."""
        for k, column in enumerate(values.T):
            self._counts[k] += self._counted(column[~np.isnan(column)])

    def _counted(self, values: FloatArray) -> IntArray:
        """How many of some values, (n,), are in each bin, its upper end excluded."""
        low, high = self._output.range
        inside, _ = np.histogram(values, self._output.bins, (low, high))
        inside[-1] -= np.count_nonzero(values == high)
        below = np.count_nonzero(values < low)
        above = np.count_nonzero(values >= high)
        return np.concatenate([[below], inside, [above]])

    def entries(self) -> Columns:
        """Column, bin and number of values of the bins that are not empty."""
        column, group = np.nonzero(self._counts)
        number = self._counts[column, group]
        value = np.full(len(number), np.nan)
        return {"column": column, "group": group, "value": value, "number": number}

    def merge(self, entries: Columns) -> None:
        """Take in the entries of other rows."""
        self._counts[entries["column"], entries["group"]] += entries["number"]

    def table(self) -> Columns:
        """The edges of each bin, then the counts of each column."""
        counts = dict(zip(self._output.columns, self._counts, strict=True))
        return {"low": self._edges[:-1], "high": self._edges[1:], **counts}


class Quantiles(Histogram):
    """A histogram whose bins are fine enough for quantiles."""

    def __init__(self, output: Output) -> None:
        super().__init__(output, np.concatenate([-_EDGES[::-1], _EDGES]))

    def _counted(self, values: FloatArray) -> IntArray:
        """How many of some values, (n,), are in each bin."""
        size = np.clip(np.abs(values), 2.0 ** (_LEAST - 1), 2.0**_MOST)
        # size = mantissa * 2^exponent with 0.5 <= mantissa < 1, exactly.
        mantissa, exponent = np.frexp(size)
        octave = exponent - 1 - _LEAST
        part = (2 * _OCTAVE * mantissa).astype(np.int64) - _OCTAVE
        place = np.clip(_OCTAVE * octave + part + 1, 0, _EDGES.size)
        bins = _EDGES.size + np.where(values < 0, -place, place)
        return np.bincount(bins, minlength=len(self._edges) - 1)

    def table(self) -> Columns:
        """The levels, then for each column the edges of the bins of its quantiles."""
        levels = np.array(self._output.levels)
        table: Columns = {"level": levels}
        # NaN if there are no numbers at all.
        low = np.append(self._edges[:-1], np.nan)
        high = np.append(self._edges[1:], np.nan)
        for name, counts in zip(self._output.columns, self._counts, strict=True):
            up_to_bin = np.cumsum(counts)
            wanted = np.maximum(np.ceil(levels * up_to_bin[-1]), 1)
            at = np.searchsorted(up_to_bin, wanted)
            table[f"{name}_low"] = low[at]
            table[f"{name}_high"] = high[at]
        return table


Reduction: TypeAlias = Extremes | Histogram


def reductions_of(study: Study) -> dict[str, Reduction]:
    """An empty reduction for each output that is not a table, by name."""
    found: dict[str, Reduction] = {}
    for name, output in study.outputs.items():
        if output.form == "quantile":
            found[name] = Quantiles(output)
        elif output.form == "histogram":
            found[name] = Histogram(output, np.linspace(*output.range, output.bins + 1))
        elif output.form != "table":
            found[name] = Extremes(output, study.axes.grid)
    return found
