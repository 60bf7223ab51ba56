"""What is kept of a quantity, block by block, in any order: extremes with their rows, and whole counts.

Nothing is added up in floating point: the same states give the same result, whoever computed which of them.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.sweep.study import Output, Study

#: Edges of a quantile's bins: magnitudes from 2^-20 to 2^20, 256 to an octave.
_EDGES = np.outer(np.ldexp(1.0, np.arange(-20, 20)), 1 + np.arange(256) / 256).ravel()


class Reduction:
    """One output in the making: a number and a row of each key, or a count.

    Attributes:
        values: Of extremes, by column and group; -inf where there is none yet. A minimum has its sign turned.
        counts: The row of the extreme, the first of equals; or how many fell between two edges.
    """

    def __init__(self, study: Study, output: Output) -> None:
        self.output, self.extreme = output, output.form in ("peak", "maximum", "minimum")
        self.by = {name: (study.cases | study.states)[name] for name in output.by}
        edges = np.linspace(*output.range, output.bins + 1)
        if output.levels:
            edges = np.concatenate([-_EDGES[::-1], _EDGES])
        self.edges = np.concatenate([[-np.inf], edges, [np.inf]])
        self.groups = math.prod(map(len, self.by.values())) if self.extreme else len(edges) + 1
        self.values = np.full(len(output.columns) * self.groups, -np.inf)
        self.counts = np.zeros(len(self.values), np.int64)

    def add(self, values: FloatArray, index: dict[str, Any], rows: Any) -> None:
        """A block: values (n, columns), NaN where there are none; places on the axes; numbers of the rows."""
        first = np.arange(values.shape[1]) * self.groups
        if not self.extreme:
            there = ~np.isnan(values)
            place = np.searchsorted(self.edges[1:-1], values, side="right")
            keys = (place + first)[there]
            self.merge(keys, keys, np.ones(1, np.int64))
            return
        values = np.abs(values) if self.output.form == "peak" else values
        values = -values if self.output.form == "minimum" else values
        group: Any = 0
        for name, axis in self.by.items():
            group = group * len(axis) + index[name]
        if np.ndim(group):
            self.merge(
                (group[:, None] + first).ravel(), values.ravel(), np.repeat(rows, len(first))
            )
        else:  # one group: its best row is enough
            best = np.where(np.isnan(values), -np.inf, values).argmax(axis=0)
            self.merge(group + first, values[best, np.arange(len(first))], rows[best])

    def merge(self, keys: Any, values: Any, counts: Any) -> None:
        """Further numbers of some keys, which may repeat; rows in order."""
        if not self.extreme:
            np.add.at(self.counts, keys, counts)
            return
        better = values > self.values[keys]  # not NaN
        better |= (values == self.values[keys]) & (counts < self.counts[keys])
        keys, values, counts = keys[better], values[better], counts[better]
        np.maximum.at(self.values, keys, values)
        best = values == self.values[keys]
        # Of a key that repeats, the last assignment stays: that of the first row.
        self.counts[keys[best][::-1]] = counts[best][::-1]

    def parts(self, name: str) -> dict[str, Any]:
        """Keys that have something, with what `merge` takes of them, as a table."""
        keys = np.flatnonzero(self.values > -np.inf if self.extreme else self.counts)
        table = {"key": keys, "value": self.values[keys], "count": self.counts[keys]}
        return {"output": np.full(len(keys), name), **table}

    def result(self) -> dict[str, Any]:
        """Columns by name; of extremes, NaN and row -1 where a group has none."""
        counts = dict(zip(self.output.columns, self.counts.reshape(-1, self.groups), strict=True))
        if self.output.levels:
            out: dict[str, Any] = {"level": np.array(self.output.levels)}
            for name, column in counts.items():
                sums = np.cumsum(column)
                place = np.searchsorted(sums, np.maximum(np.ceil(out["level"] * sums[-1]), 1))
                ends = np.append(self.edges, np.nan)  # of no values at all
                out |= {f"{name}_low": ends[place], f"{name}_high": ends[place + 1]}
            return out
        if not self.extreme:
            return {"low": self.edges[:-1], "high": self.edges[1:], **counts}
        grid = np.meshgrid(*self.by.values(), indexing="ij")
        out = dict(zip(self.by, map(np.ravel, grid), strict=True))
        sign = -1.0 if self.output.form == "minimum" else 1.0
        values = self.values.reshape(-1, self.groups)
        for (name, row), value in zip(counts.items(), values, strict=True):
            none = value == -np.inf
            out[name] = np.where(none, np.nan, sign * value)
            out[f"{name}_row"] = np.where(none, -1, row)
        return out


def reductions(study: Study) -> dict[str, Reduction]:
    """Of each output but tables, empty."""
    named = study.outputs.items()
    return {name: Reduction(study, output) for name, output in named if output.form != "table"}
