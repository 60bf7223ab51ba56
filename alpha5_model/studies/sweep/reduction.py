"""The base of all reductions: extremes or counts of a quantity, block by block.

Blocks may come in any order. No floating-point numbers are added up, so the result does
not depend on which process computed which block.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.tables import Columns

IntArray = NDArray[np.int64]


class Reduction(ABC):
    """An output that is being computed: a value and a count for each key.

    A key numbers a group of a column. The groups of the first column come first.

    Attributes:
        output: The quantity and its form.
        groups: Number of groups of each column.
        values: The extremes so far, (keys,); -inf if there are none.
        counts: Row numbers of the extremes, or numbers of values in a bin, (keys,).
    """

    def __init__(self, output: Output, groups: int) -> None:
        self.output = output
        self.groups = groups
        size = len(output.columns) * groups
        self.values = np.full(size, -np.inf)
        self.counts = np.zeros(size, np.int64)

    @abstractmethod
    def add(self, block: Block) -> None:
        """Take in the quantities of a block; NaN is ignored."""

    @abstractmethod
    def merge(self, keys: IntArray, values: FloatArray, counts: IntArray) -> None:
        """Take in values and counts of some keys, which may repeat; rows in order."""

    @abstractmethod
    def known(self) -> NDArray[np.intp]:
        """The keys that have an entry."""

    @abstractmethod
    def result(self) -> Columns:
        """Columns by name."""

    def parts(self, name: str) -> Columns:
        """The table that `merge` of another reduction of this output takes in."""
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

    def counts_by_column(self) -> dict[str, IntArray]:
        """Column -> counts of its groups."""
        counts = self.counts.reshape(-1, self.groups)
        return dict(zip(self.output.columns, counts, strict=True))
