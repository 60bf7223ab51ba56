"""The chunks of a study: a worker computes one at a time, and each has a part file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.text import plain
from alpha5_model.codegen.kernels.choice import backend
from alpha5_model.errors import FileFormatError, InputError, MissingFileError

if TYPE_CHECKING:
    from alpha5_model.studies.sweep.reduction import Reduction
    from alpha5_model.studies.sweep.study import Study

#: The expected content of a chunk's file, for messages.
_PART = "a part of this study"


@dataclass(frozen=True, eq=False)
class Chunks:
    """A study in chunks.

    Attributes:
        study: The study.
        head: The study's text and everything else that its results depend on.
        size: Number of blocks in a chunk.
        blocks: Number of blocks in the study.
    """

    study: Study
    head: str
    size: int
    blocks: int

    def count(self) -> int:
        """Number of chunks."""
        return -(-self.blocks // self.size)


class ComputedChunk(NamedTuple):
    """The files of a chunk.

    Attributes:
        number: Of the chunk.
        rows: Its table as Parquet; None if the study keeps no table.
        part: Its part of the reductions as Parquet.
    """

    number: int
    rows: bytes | None
    part: bytes


def chunks_of(study: Study, rows: int) -> Chunks:
    """A study in chunks.

    Args:
        study: The study.
        rows: Approximate number of rows in a chunk; each recording is one chunk.
    """
    from alpha5_model.studies.sweep.study import BLOCK

    sizes = study.sizes()
    blocks = sizes.cases * sizes.blocks
    recordings = study.cases.get("recording", ())
    if recordings:
        size = blocks // len(recordings)
    else:
        size = max(1, rows // min(BLOCK, sizes.states))
    head = _head(study, recordings)
    return Chunks(study=study, head=head, size=size, blocks=blocks)


def _head(study: Study, recordings: Sequence[str]) -> str:
    """The study's text, the version that computes it, recordings and own arm."""
    names = [f"# recording {k}: {name}\n" for k, name in enumerate(recordings)]
    arm = "" if study.arm is None else f"# arm: {json.dumps(plain(study.arm))}\n"
    return f"# {made_by()}\n{study.text}{''.join(names)}{arm}"


def made_by() -> str:
    """Version and kernels, which the last digits of the results depend on."""
    from alpha5_model import __version__

    return f"alpha5-model {__version__}, {backend().partition(' ')[0]} kernels"


def compute(chunks: Chunks, number: int) -> ComputedChunk:
    """Compute a chunk.

    A recording that cannot be used makes a chunk without rows that says why.

    Raises:
        InputError: This process has another version than the one that sent the chunk.
        Alpha5Error: Impossible values of an arm.
    """
    if not chunks.head.startswith(f"# {made_by()}\n"):
        asking, _, _ = chunks.head.partition("\n")
        raise InputError("worker", made_by(), f"what asks: {asking}")

    try:
        return _computed(chunks, number)
    except Exception as error:
        if "recording" not in chunks.study.cases:
            raise
        return _failed(chunks, number, str(error) or repr(error))


def _computed(chunks: Chunks, number: int) -> ComputedChunk:
    """A chunk with its rows."""
    from alpha5_model.studies.sweep.blocks import blocks_of, table_of_block
    from alpha5_model.studies.sweep.reductions import empty_reductions

    study = chunks.study
    found = empty_reductions(study)
    has_table = len(found) < len(study.outputs)
    tables = []
    rows = 0
    first = number * chunks.size
    last = min(chunks.blocks, first + chunks.size)
    for block in blocks_of(study, first, last):
        rows += len(block.rows)
        for reduction in found.values():
            reduction.add(block)
        if has_table:
            tables.append(table_of_block(study, block))

    return ComputedChunk(
        number=number,
        rows=parquet_file(*tables, study=chunks.head) if tables else None,
        part=_part(chunks, found, rows, problem=""),
    )


def _failed(chunks: Chunks, number: int, problem: str) -> ComputedChunk:
    """A chunk whose recording cannot be used."""
    from alpha5_model.studies.sweep.reductions import empty_reductions

    nothing = empty_reductions(chunks.study)
    part = _part(chunks, nothing, rows=0, problem=problem)
    return ComputedChunk(number=number, rows=None, part=part)


def _part(
    chunks: Chunks, found: dict[str, Reduction], rows: int, problem: str
) -> bytes:
    """The part of a chunk as Parquet; `is_finished` and `merge` read it."""
    tables = [reduction.parts(name) for name, reduction in found.items()]
    return parquet_file(
        *tables,
        study=chunks.head,
        rows=str(rows),
        blocks=str(chunks.size),
        problem=problem,
    )


def parquet_file(*tables: dict[str, Any], **metadata: str) -> bytes:
    """Tables with the same columns, one below the other, as Parquet."""
    import pyarrow
    from pyarrow import parquet

    whole = pyarrow.table({})
    if tables:
        whole = pyarrow.concat_tables([pyarrow.table(table) for table in tables])
    sink = pyarrow.BufferOutputStream()
    parquet.write_table(whole.replace_schema_metadata(metadata), sink)
    return bytes(sink.getvalue())


def is_finished(file: Path, chunks: Chunks) -> bool:
    """Whether a part is there already. A failed recording is tried again.

    Raises:
        InputError: It is a part of another study, or of another size.
        FileFormatError: There is a folder or a foreign table in its place.
    """
    from pyarrow import ArrowException, BufferReader, parquet

    try:
        content = read_named(file, _PART)
    except MissingFileError:
        return False
    try:
        facts = parquet.read_schema(BufferReader(content)).metadata or {}
    except (OSError, ArrowException):  # cut off: computed again
        return False

    if not {b"study", b"blocks", b"problem"} <= {*facts}:
        problem = (
            "is a table of something else; expected another folder for the results"
        )
        raise FileFormatError(file, problem)
    same_study = facts[b"study"] == chunks.head.encode()
    same_size = facts[b"blocks"] == str(chunks.size).encode()
    if not (same_study and same_size):
        expected = "a new one, or one with a part of this study in chunks of this size"
        raise InputError("folder", str(file.parents[1]), expected)
    return not facts[b"problem"]


def merge(file: PathLike, reductions: dict[str, Reduction]) -> tuple[int, str]:
    """Add a part to the reductions.

    Returns:
        Its number of rows, and why it has none; "" if it has.

    Raises:
        FileFormatError: It is damaged behind its head.
    """
    from pyarrow import ArrowException, BufferReader, parquet

    content = read_named(file, _PART)
    try:
        part = parquet.read_table(BufferReader(content))
        for name, reduction in reductions.items():
            own = part["output"].to_numpy() == name
            reduction.merge(
                keys=part["key"].to_numpy()[own],
                values=part["value"].to_numpy()[own],
                counts=part["count"].to_numpy()[own],
            )
        facts = part.schema.metadata
        return int(facts[b"rows"]), facts[b"problem"].decode()
    except (OSError, ArrowException, LookupError, ValueError, TypeError) as error:
        problem = f"is damaged ({error}); remove it, and it is computed again"
        raise FileFormatError(file, problem) from None
