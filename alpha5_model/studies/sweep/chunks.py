"""The chunks of a study: a worker computes one at a time, and each has its files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from alpha5_model._support.files import PathLike, read_named
from alpha5_model._support.text import plain
from alpha5_model.errors import FileFormatError, InputError
from alpha5_model.kernels.choice import backend
from alpha5_model.studies.sweep.checksums import digest_of_file
from alpha5_model.studies.sweep.tables import Columns, parquet_file

if TYPE_CHECKING:
    from alpha5_model.studies.sweep.reduction import Reduction
    from alpha5_model.studies.sweep.study import Study

#: The expected content of a chunk's file, for messages.
_PART = "a part of this study"
#: Most parts of a study: more files make a folder slow.
MOST_CHUNKS = 2**20


@dataclass(frozen=True, eq=False)
class Chunks:
    """A study in chunks.

    Attributes:
        study: The study.
        head: Everything that the results depend on, without the comments of the study.
        text: The same with the study's text, for people.
        size: Number of blocks in a chunk.
        blocks: Number of blocks in the study.
    """

    study: Study
    head: str
    text: str
    size: int
    blocks: int

    @property
    def has_table(self) -> bool:
        """Whether the study keeps rows."""
        return any(output.form == "table" for output in self.study.outputs.values())

    def recordings(self) -> list[Path]:
        """The recording of each chunk; none for a study of states."""
        names = self.study.cases.get("recording", ())
        return [Path(self.study.folder, name) for name in names]

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

    Raises:
        InputError: More than `MOST_CHUNKS`.
    """
    from alpha5_model.studies.sweep.study import BLOCK

    sizes = study.sizes()
    blocks = sizes.cases * sizes.blocks
    recordings = study.cases.get("recording", ())
    if recordings:
        size = blocks // len(recordings)
    else:
        size = max(1, rows // min(BLOCK, sizes.states))
    if -(-blocks // size) > MOST_CHUNKS:
        whole = f"{sizes.cases * sizes.states:.3g} rows of the study"
        most = f"at most {MOST_CHUNKS} parts of {rows} rows: a smaller study"
        raise InputError("rows", whole, most)
    settings = json.dumps(study.settings, ensure_ascii=False, default=str)
    return Chunks(
        study=study,
        head=_head(study, recordings, f"{settings}\n"),
        text=_head(study, recordings, study.text),
        size=size,
        blocks=blocks,
    )


def _head(study: Study, recordings: Sequence[str], settings: str) -> str:
    """The version that computes a study, its settings, recordings and own arm."""
    names = [f"# recording {k}: {name}\n" for k, name in enumerate(recordings)]
    arms = [
        f"# arm {name}: {json.dumps(plain(arm))}\n"
        for name, arm in study.files.arms.items()
    ]
    if study.arm is not None:
        arms = [f"# arm: {json.dumps(plain(study.arm))}\n"]
    return f"# {made_by()}\n{settings}{''.join(names)}{''.join(arms)}"


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

    recordings = chunks.recordings()
    if not recordings:
        return _computed(chunks, number, before="")
    before = digest_of_file(recordings[number]) or ""
    try:
        chunk = _computed(chunks, number, before)
    except Exception as error:
        return _failed(chunks, number, before, str(error) or repr(error))
    if digest_of_file(recordings[number]) != before:
        return _failed(chunks, number, before, "has changed while it was read")
    return chunk


def _computed(chunks: Chunks, number: int, before: str) -> ComputedChunk:
    """A chunk with its rows.

    Args:
        chunks: The study.
        number: Of the chunk.
        before: SHA-256 of its recording, "" if it has none.
    """
    from alpha5_model.studies.sweep.blocks import blocks_of, table_of_block
    from alpha5_model.studies.sweep.reductions import empty_reductions
    from alpha5_model.studies.sweep.states import recorded_states

    recorded_states.cache_clear()  # the file may have changed
    study = chunks.study
    found = empty_reductions(study)
    tables = []
    rows = 0
    first = number * chunks.size
    last = min(chunks.blocks, first + chunks.size)
    for block in blocks_of(study, first, last):
        rows += len(block.rows)
        for reduction in found.values():
            reduction.add(block)
        if chunks.has_table:
            tables.append(table_of_block(study, block))

    return ComputedChunk(
        number=number,
        rows=rows_file(chunks, tables) if tables else None,
        part=_part(chunks, found, rows, before, problem=""),
    )


def rows_file(chunks: Chunks, tables: list[Columns]) -> bytes:
    """Rows as Parquet. Random numbers and quantities are not worth compressing."""
    from alpha5_model.studies.sweep.units import units_of_rows

    study = chunks.study
    return parquet_file(
        tables,
        units=units_of_rows(study),
        repeated=[*study.axes],
        compression="none",
        study=chunks.head,
    )


def _failed(chunks: Chunks, number: int, before: str, problem: str) -> ComputedChunk:
    """A chunk whose recording cannot be used."""
    from alpha5_model.studies.sweep.reductions import empty_reductions

    nothing = empty_reductions(chunks.study)
    part = _part(chunks, nothing, 0, before, problem)
    return ComputedChunk(number=number, rows=None, part=part)


def _part(
    chunks: Chunks, found: dict[str, Reduction], rows: int, before: str, problem: str
) -> bytes:
    """The part of a chunk as Parquet; `facts_of_part` and `merge` read it."""
    tables = [reduction.parts(name) for name, reduction in found.items()]
    return parquet_file(
        tables,
        units={},
        study=chunks.head,
        rows=str(rows),
        blocks=str(chunks.size),
        input=before,
        problem=problem,
    )


def facts_of_part(content: bytes) -> dict[str, str]:
    """What a part says about itself; empty if it cannot be read."""
    from pyarrow import ArrowException, BufferReader, parquet

    try:
        facts = parquet.read_schema(BufferReader(content)).metadata or {b"": b""}
    except (OSError, ArrowException):
        return {}
    return {
        key.decode("utf-8", "replace"): value.decode("utf-8", "replace")
        for key, value in facts.items()
    }


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
