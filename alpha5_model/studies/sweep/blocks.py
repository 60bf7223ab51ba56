"""The rows of a study, computed block by block.

Blocks do not depend on the size of the chunks. So NumPy gets the same arrays, and gives
the same bits, whichever process computes a block.
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
from alpha5_model.studies.sweep.tables import Columns

#: Row numbers reserved for each recording, whose number of samples is not known before.
_ROWS_OF_RECORDING = 2**32


@dataclass(frozen=True, eq=False)
class Block:
    """Some rows of a case.

    Attributes:
        rows: Their numbers, (n,).
        index: Axis -> index of its value, one for all rows or (n,).
        columns: Other columns that describe the states, (n,) each.
        quantities: By name, (n, columns) each.
    """

    rows: NDArray[np.int64]
    index: dict[str, int | NDArray[np.intp]]
    columns: dict[str, NDArray[Any]]
    quantities: dict[str, FloatArray]


def blocks_of(study: Study, first: int, last: int) -> Iterator[Block]:
    """The blocks of a study with numbers from first to last - 1.

    Raises:
        Alpha5Error: A recording, or an arm, that cannot be used.
    """
    wanted = {output.quantity for output in study.outputs.values()}
    blocks_per_case = study.sizes().blocks
    for number in range(first, last):
        case, block_of_case = divmod(number, blocks_per_case)
        start = block_of_case * BLOCK
        case_index = _case_index(study, case)
        states = _states(study, case_index, start)
        if not len(states.number):
            continue

        motion = states.motion
        arm = arm_of_case(study, tuple(case_index.items()))
        yield Block(
            rows=case * _rows_per_case(study) + states.number,
            index={**case_index, **states.index},
            columns=states.columns,
            quantities=quantities_of(arm, motion, wanted),
        )


def _case_index(study: Study, case: int) -> dict[str, int]:
    """Axis of cases -> index of its value in a case; the last axis runs fastest."""
    if not study.cases:
        return {}
    shape = [len(values) for values in study.cases.values()]
    indices = [int(index) for index in np.unravel_index(case, shape)]
    return dict(zip(study.cases, indices, strict=True))


def _states(study: Study, case_index: dict[str, int], start: int) -> States:
    """The states of a block.

    Args:
        study: The study.
        case_index: Of its case, see `_case_index`.
        start: Number in the case of the first state.
    """
    arm = study.arm_of(case_index)
    if "recording" in case_index:
        recording = study.cases["recording"][case_index["recording"]]
        path = Path(study.folder, recording)
        return recorded_states(path, arm, tuple(study.in_collision))
    last = min(study.sizes().states, start + BLOCK)
    return states_of(study, arm, start, last)


def _rows_per_case(study: Study) -> int:
    """Row numbers reserved for each case."""
    return _ROWS_OF_RECORDING if "recording" in study.cases else study.sizes().states


def values_of_row(study: Study, row: int) -> dict[str, Any]:
    """Column -> value of a row in the table of its block, see `table_of_block`."""
    case, state = divmod(row, _rows_per_case(study))
    number = case * study.sizes().blocks
    if "recording" not in study.cases:
        number += state // BLOCK

    (block,) = blocks_of(study, number, number + 1)
    table = table_of_block(study, block)
    at = int(np.searchsorted(block.rows, row))
    return {name: values[at].item() for name, values in table.items()}


def table_of_block(study: Study, block: Block) -> Columns:
    """A block as a table: row numbers, axes, and the quantities kept as tables."""
    grid = study.axes
    table: Columns = {"row": block.rows}
    for name, index in block.index.items():
        table[name] = np.array(grid[name])[index]
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
