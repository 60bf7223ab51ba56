"""The rows of a study, block by block, on any machine.

A block has the same place in the study whatever the size of the chunks: what NumPy
computes of it does not depend on who computes it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.studies.sweep.arms import arm_of_case
from alpha5_model.studies.sweep.outputs import Output
from alpha5_model.studies.sweep.quantities import quantities_of
from alpha5_model.studies.sweep.states import States, recorded_states, states_of
from alpha5_model.studies.sweep.study import BLOCK, Study

#: Columns of a table by name.
Columns = dict[str, NDArray[Any]]
#: Numbers of rows that are set aside for the samples of a recording.
_RECORDED = 2**32


@dataclass(frozen=True, eq=False)
class Block:
    """Some rows of a case.

    Attributes:
        rows: Their numbers, (n,).
        index: Axis -> places on the grid, one or (n,).
        columns: What else describes the states, (n,) each.
        quantities: By name, (n, 4) each.
    """

    rows: NDArray[np.int64]
    index: dict[str, int | NDArray[np.intp]]
    columns: dict[str, NDArray[Any]]
    quantities: dict[str, FloatArray]


def blocks_of(study: Study, first: int, last: int) -> Iterator[Block]:
    """The blocks of a study from the first number up to, not with, the last.

    Raises:
        Alpha5Error: A recording, or an arm, that cannot be used.
    """
    wanted = {output.quantity for output in study.outputs.values()}
    in_each = study.sizes().blocks
    for number in range(first, last):
        case, block_of_case = divmod(number, in_each)
        start = block_of_case * BLOCK
        place = _place(study, case)
        states = _states(study, place, start)
        motion = states.motion
        arm = arm_of_case(study, tuple(place.items()))

        first_row = case * _rows_in_each(study) + start
        count = len(motion.time)
        yield Block(
            rows=np.arange(first_row, first_row + count),
            index={**place, **states.index},
            columns=states.columns,
            quantities=quantities_of(arm, motion, wanted),
        )


def _place(study: Study, case: int) -> dict[str, int]:
    """Where a case is on each axis of cases; the last axis runs fastest."""
    if not study.cases:
        return {}
    shape = [len(values) for values in study.cases.values()]
    places = [int(place) for place in np.unravel_index(case, shape)]
    return dict(zip(study.cases, places, strict=True))


def _states(study: Study, place: dict[str, int], start: int) -> States:
    """The states of a block that starts at some state of a case."""
    if "recording" in place:
        recording = study.cases["recording"][place["recording"]]
        return recorded_states(Path(study.folder, recording))
    last = min(study.sizes().states, start + BLOCK)
    return states_of(study, start, last)


def _rows_in_each(study: Study) -> int:
    """Numbers of rows that are set aside for each case."""
    return _RECORDED if "recording" in study.cases else study.sizes().states


def inputs(study: Study, row: int) -> dict[str, Any]:
    """The values of the axes of a row, or its recording and sample; its table."""
    case, state = divmod(row, _rows_in_each(study))
    number = case * study.sizes().blocks
    if "recording" not in study.cases:
        number += state // BLOCK

    block = next(blocks_of(study, number, number + 1))
    table = columns(study, block)
    at = row - block.rows[0]
    return {name: values[at].item() for name, values in table.items()}


def columns(study: Study, block: Block) -> Columns:
    """A block as a table: numbers of the rows, axes, and quantities kept as tables."""
    grid = {**study.cases, **study.states}
    table: Columns = {"row": block.rows}
    for name, places in block.index.items():
        table[name] = np.array(grid[name])[places]
    table |= block.columns
    for output in study.outputs.values():
        if output.form == "table":
            table |= _quantity_columns(output, block)

    shape = block.rows.shape
    return {name: np.broadcast_to(values, shape) for name, values in table.items()}


def _quantity_columns(output: Output, block: Block) -> Columns:
    """The columns of a quantity that is kept as a table."""
    values = block.quantities[output.quantity]
    names = [f"{output.quantity}.{column}" for column in output.columns]
    return dict(zip(names, values.T, strict=True))
