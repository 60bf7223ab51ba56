"""How large a study is, and about how long it takes, before it starts."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

from alpha5_model.errors import Alpha5Error
from alpha5_model.studies.sweep.chunks import Chunks, rows_file

#: Studies with more rows, or with larger tables [bytes], are to be confirmed. It is a
#: choice: on one core of 2024 they take minutes at least, and fill a small disk.
MOST_ROWS = 1_000_000_000
MOST_BYTES = 10_000_000_000
#: Below so many blocks a study takes about a second, and is not timed.
_TIMED_BLOCKS = 50


@dataclass(frozen=True)
class Extent:
    """The size of what is left of a study.

    Attributes:
        rows: Number of rows; None for recordings, which are not read before.
        parts: Number of parts to compute.
        of_parts: Number of all parts.
        table_bytes: Approximate size of the rows in the folder; 0 without a table.
        seconds: Approximate time; None if the study is small, or of recordings.
    """

    rows: int | None
    parts: int
    of_parts: int
    table_bytes: int
    seconds: float | None

    @property
    def is_large(self) -> bool:
        """Whether it should be confirmed."""
        has_many_rows = self.rows is not None and self.rows > MOST_ROWS
        return has_many_rows or self.table_bytes > MOST_BYTES


def extent_of(chunks: Chunks, missing: int, workers: int) -> Extent:
    """The extent of a study of which some chunks are missing.

    Args:
        chunks: The study in chunks.
        missing: Number of chunks to compute.
        workers: Processes that share the work.
    """
    sizes = chunks.study.sizes()
    share = missing / chunks.count()
    if chunks.recordings():
        return Extent(
            rows=None,
            parts=missing,
            of_parts=chunks.count(),
            table_bytes=0,
            seconds=None,
        )

    rows = round(share * sizes.cases * sizes.states)
    bytes_per_row = 0.0
    seconds = None
    if share * chunks.blocks > _TIMED_BLOCKS:
        bytes_per_row, whole = _measured(chunks)
        seconds = share * whole / max(workers, 1)
    return Extent(
        rows=rows,
        parts=missing,
        of_parts=chunks.count(),
        table_bytes=round(rows * bytes_per_row),
        seconds=seconds,
    )


def _measured(chunks: Chunks) -> tuple[float, float]:
    """Size of a row in the table [bytes], and time of the whole study [s].

    Arms and states that are made once are kept, so that each block is timed for what
    it is the first to need.
    """
    sizes = chunks.study.sizes()
    try:
        _timed(chunks, chunks.blocks - 1)  # loads modules
        bytes_per_row, first_of_case = _timed(chunks, 0)
        _, next_of_case = _timed(chunks, min(1, sizes.blocks - 1))
    except Alpha5Error:  # said when its chunk is computed
        return 0.0, 0.0
    of_arm = max(first_of_case - next_of_case, 0.0)
    return bytes_per_row, sizes.cases * of_arm + chunks.blocks * next_of_case


def _timed(chunks: Chunks, number: int) -> tuple[float, float]:
    """Size of a row of a block [bytes], and the time that the block takes [s]."""
    from alpha5_model.studies.sweep.blocks import blocks_of, table_of_block
    from alpha5_model.studies.sweep.reductions import empty_reductions

    found = empty_reductions(chunks.study)
    bytes_per_row = 0.0
    start = perf_counter()
    for block in blocks_of(chunks.study, number, number + 1):
        for reduction in found.values():
            reduction.add(block)
        if chunks.has_table:
            table = rows_file(chunks, [table_of_block(chunks.study, block)])
            bytes_per_row = len(table) / len(block.rows)
    return bytes_per_row, perf_counter() - start
