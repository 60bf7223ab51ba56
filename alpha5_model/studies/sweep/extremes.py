"""Extremes of a quantity, and the rows in which they occur."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.reduction import IntArray, Reduction
from alpha5_model.studies.sweep.study import Study
from alpha5_model.studies.sweep.tables import Columns


class Extremes(Reduction):
    """The peak, maximum or minimum of each group, and the first row that has it.

    A minimum is kept as the maximum of the negated numbers.
    """

    def __init__(self, study: Study, output: Output) -> None:
        self._by = {name: study.axes[name] for name in output.by}
        sizes = [len(axis) for axis in self._by.values()]
        super().__init__(output, groups=math.prod(sizes))

    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN is ignored."""
        quantity = block.quantities[self.output.quantity]
        values = self._maximised(quantity)
        columns = np.arange(len(self.output.columns))
        groups = self._groups_of(block)
        if np.ndim(groups):
            rows = np.repeat(block.rows, columns.size)
        else:  # the block is in one group: the best row of each column is enough
            known = np.where(np.isnan(values), -np.inf, values)
            best = known.argmax(axis=0)
            rows = block.rows[best]
            values = values[best, columns]

        keys = np.add.outer(groups, self.first_keys())
        self.merge(keys.ravel(), values.ravel(), rows)

    def _maximised(self, values: FloatArray) -> FloatArray:
        """The numbers whose maximum is kept."""
        if self.output.form == "peak":
            return np.abs(values)
        return -values if self.output.form == "minimum" else values

    def _groups_of(self, block: Block) -> int | NDArray[np.intp]:
        """The group of each row of a block, or one number if all are in one."""
        group: int | NDArray[np.intp] = 0
        for name, axis in self._by.items():
            group = group * len(axis) + block.index[name]
        return group

    def merge(self, keys: IntArray, values: FloatArray, counts: IntArray) -> None:
        """Take in values and rows of some keys, which may repeat; rows in order."""
        kept_values = self.values[keys]
        kept_rows = self.counts[keys]
        larger = values > kept_values  # not NaN
        earlier = (values == kept_values) & (counts < kept_rows)
        better = larger | earlier

        keys = keys[better]
        values = values[better]
        rows = counts[better]
        np.maximum.at(self.values, keys, values)

        is_best = values == self.values[keys]
        # Backwards: if a key repeats, its last assignment stays, that of the first row.
        best = np.flatnonzero(is_best)[::-1]
        self.counts[keys[best]] = rows[best]

    def known(self) -> NDArray[np.intp]:
        """The keys that have an entry."""
        return np.flatnonzero(self.values > -np.inf)

    def result(self) -> Columns:
        """The axes, then each column and its row; NaN and -1 if a group has none."""
        table = self._axes_of_groups()
        sign = -1.0 if self.output.form == "minimum" else 1.0
        maxima = self.values.reshape(-1, self.groups)
        rows = self.counts.reshape(-1, self.groups)
        for k, name in enumerate(self.output.columns):
            unknown = maxima[k] == -np.inf
            extreme = sign * maxima[k]
            table[name] = np.where(unknown, np.nan, extreme)
            table[f"{name}_row"] = np.where(unknown, -1, rows[k])
        return table

    def _axes_of_groups(self) -> Columns:
        """The value of each axis in each group; the last axis runs fastest."""
        grid = np.meshgrid(*self._by.values(), indexing="ij")
        values = [axis.ravel() for axis in grid]
        return dict(zip(self._by, values, strict=True))
