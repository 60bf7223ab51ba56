"""The base of all reductions: extremes or counts of a quantity, block by block.

Blocks may come in any order. Nothing is added up in floating point: the same states
give the same result, whoever computed which of them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.blocks import Block, Columns
from alpha5_model.studies.sweep.outputs import Output

IntArray = NDArray[np.int64]


class Reduction(ABC):
    """One output in the making: a value and a count of each key.

    A key is a group of a column; the groups of the first column come first.

    Attributes:
        output: The quantity, and its form.
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
    def merge(self, keys: IntArray, values: FloatArray, counts: IntArray) -> None:
        """Take in values and counts of some keys, which may repeat; rows in order."""

    @abstractmethod
    def known(self) -> NDArray[np.intp]:
        """The keys that have something."""

    @abstractmethod
    def result(self) -> Columns:
        """Columns by name."""

    def parts(self, name: str) -> Columns:
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

    def counts_by_column(self) -> dict[str, IntArray]:
        """Column -> counts of its groups."""
        counts = self.counts.reshape(-1, self.groups)
        return dict(zip(self.output.columns, counts, strict=True))
