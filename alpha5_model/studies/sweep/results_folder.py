"""The folder of a study's results: what is in it, what is missing, what is damaged.

Each chunk has a part, perhaps rows, and a file with the checksums of both::

    parts/part-000000.parquet
    parts/part-000000.sha256
    rows/part-000000.parquet

A chunk is finished if all its files have their checksums. The checksum file is written
last. ``sha256sum -c parts/*.sha256`` in the folder checks all of them, too.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from alpha5_model._support.files import read_named
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.errors import FileFormatError, InputError, MissingFileError
from alpha5_model.studies.sweep.checksums import (
    checksum_text,
    digest,
    digest_of_file,
    read_checksums,
    remove,
)
from alpha5_model.studies.sweep.chunks import Chunks, ComputedChunk, facts_of_part

#: The expected content of a chunk's file, for messages.
_PART = "a part of this study"
#: Most foreign files that a message names.
_NAMED = 5


class _State(NamedTuple):
    """The state of a chunk's files.

    Attributes:
        finished: Whether nothing is left to do.
        damage: What is wrong with a file of it; "" if nothing is.
        is_new: Whether it may get other results than those that the folder has.
    """

    finished: bool
    damage: str = ""
    is_new: bool = False


#: The state of a chunk that has no files.
_ABSENT = _State(finished=False, is_new=True)


class Inspection(NamedTuple):
    """What a folder of results holds.

    Attributes:
        missing: Numbers of the chunks that have to be computed.
        damage: What was wrong, a line for each file.
        is_new: Whether any chunk may get other results than those in the folder.
        started: Whether there are files of any chunk.
    """

    missing: list[int]
    damage: list[str]
    is_new: bool
    started: bool


class ResultsFolder:
    """The folder of the results of a study in chunks.

    Attributes:
        path: Of the folder.
        chunks: The study in chunks.
    """

    def __init__(self, path: Path, chunks: Chunks) -> None:
        self.path = path
        self.chunks = chunks

    def part(self, number: int) -> Path:
        """The part of a chunk."""
        return self.path / "parts" / f"{_name(number)}.parquet"

    def rows(self, number: int) -> Path:
        """The rows of a chunk."""
        return self.path / "rows" / f"{_name(number)}.parquet"

    def checksums(self, number: int) -> Path:
        """The checksums of the files of a chunk."""
        return self.path / "parts" / f"{_name(number)}.sha256"

    def inspect(self) -> Inspection:
        """What is there, and what is left to do.

        Raises:
            InputError: Parts of another study, or of chunks of another size.
            FileFormatError: A folder or a foreign file among the parts or rows.
        """
        present = {file.stem for file in _visible(self.path / "parts")}
        states = [
            self._state(number) if _name(number) in present else _ABSENT
            for number in range(self.chunks.count())
        ]
        self._refuse_foreign_files()
        return Inspection(
            missing=[k for k, state in enumerate(states) if not state.finished],
            damage=[state.damage for state in states if state.damage],
            is_new=any(state.is_new for state in states),
            started=any(state is not _ABSENT for state in states),
        )

    def _state(self, number: int) -> _State:
        """The state of the files of a chunk."""
        part = _read(self.part(number))
        text = _read(self.checksums(number))
        if text is None:
            if part is None:
                return _ABSENT
            self._check_is_own(number, part)
            missing = f"{self.checksums(number)}: is missing"
            return _State(finished=False, damage=missing)

        damage = self._damage(number, read_checksums(text))
        if damage or part is None:
            return _State(finished=False, damage=damage)
        return self._state_of_whole(number, part)

    def _damage(self, number: int, digests: dict[str, str]) -> str:
        """What is wrong with the files of a chunk; "" if nothing is."""
        part = self._inside(self.part(number))
        rows = self._inside(self.rows(number))
        if part not in digests or not {*digests} <= {part, rows}:
            return f"{self.checksums(number)}: is damaged"
        for file, expected in digests.items():
            found = digest_of_file(self.path / file)
            if found is None:
                return f"{self.path / file}: is missing"
            if found != expected:
                problem = "does not have its checksum"
                return f"{self.path / file}: {problem}"
        if rows not in digests and self.rows(number).exists():
            return f"{self.rows(number)}: has no checksum"
        return ""

    def _state_of_whole(self, number: int, part: bytes) -> _State:
        """The state of a chunk whose files have their checksums."""
        self._check_is_own(number, part)
        facts = facts_of_part(part)
        if facts["problem"]:  # a recording that failed is tried again
            return _State(finished=False, is_new=True)
        recordings = self.chunks.recordings()
        if recordings and facts["input"] != digest_of_file(recordings[number]):
            changed = f"{recordings[number]}: has changed since it was computed"
            return _State(finished=False, damage=changed, is_new=True)
        return _State(finished=True)

    def _check_is_own(self, number: int, part: bytes) -> None:
        """Refuse a part of another study; one that cannot be read is damaged.

        Raises:
            InputError: It is a part of another study, or of another size.
            FileFormatError: It is something else.
        """
        facts = facts_of_part(part)
        if not facts:  # cut off: computed again
            return
        if not {"study", "blocks", "input", "problem"} <= {*facts}:
            problem = (
                "is a table of something else; expected another folder for the results"
            )
            raise FileFormatError(self.part(number), problem)
        same_study = facts["study"] == self.chunks.head
        same_size = facts["blocks"] == str(self.chunks.size)
        if not (same_study and same_size):
            expected = (
                "another one: this one holds a part of another study, or of this "
                "study in chunks of another size"
            )
            raise InputError("folder", str(self.path), expected)

    def _refuse_foreign_files(self) -> None:
        """Refuse files among the parts and rows that are of no chunk."""
        suffixes = {"parts": {".parquet", ".sha256"}, "rows": {".parquet"}}
        if not self.chunks.has_table:
            suffixes["rows"] = set()
        foreign = [
            file
            for folder, own in suffixes.items()
            for file in _visible(self.path / folder)
            if file.suffix not in own or not self._is_of_a_chunk(file)
        ]
        if foreign:
            problem = f"is no part of this study{_and_more(foreign)}; move it away"
            raise FileFormatError(foreign[0], problem)

    def _is_of_a_chunk(self, file: Path) -> bool:
        """Whether a file is named as one of a chunk of this study."""
        _, _, digits = file.stem.partition("part-")
        if not (digits.isascii() and digits.isdigit()):
            return False
        return file.stem == _name(int(digits)) and int(digits) < self.chunks.count()

    def foreign_files(self, results: Iterable[Path]) -> list[str]:
        """Files beside the results that are none of them, by name.

        Args:
            results: Files that this study writes into the folder.
        """
        own = [self.path / "parts", self.path / "rows", Path(self.chunks.study.source)]
        known = {*results, *own}
        return [file.name for file in _visible(self.path) if file not in known]

    def write_chunk(self, chunk: ComputedChunk) -> None:
        """Write the files of a chunk, its checksums last.

        Raises:
            OutputError: They cannot be written.
        """
        files = {self.part(chunk.number): chunk.part}
        if chunk.rows is not None:
            files[self.rows(chunk.number)] = chunk.rows
        digests = {self._inside(file): digest(data) for file, data in files.items()}
        # A reader never finds new files with old checksums.
        remove(self.checksums(chunk.number))
        if chunk.rows is None:
            remove(self.rows(chunk.number))
        atomic_write_all(
            {**files, self.checksums(chunk.number): checksum_text(digests).encode()}
        )

    def write_results(self, files: dict[Path, bytes]) -> list[str]:
        """Write the files of the whole study.

        Returns:
            What was wrong with those that were there, a line for each file.

        Raises:
            OutputError: They cannot be written.
        """
        damage = []
        for file, content in files.items():
            present = digest_of_file(file)
            if present is None:
                damage.append(f"{file}: is missing")
            elif present != digest(content):
                damage.append(f"{file}: is not what this study gives")
        atomic_write_all(files)
        return damage

    def _inside(self, file: Path) -> str:
        """The path of a file in this folder, as a checksum file has it."""
        return file.relative_to(self.path).as_posix()


def _name(number: int) -> str:
    """The name of the files of a chunk, without suffix."""
    return f"part-{number:06}"


def _read(file: Path) -> bytes | None:
    """The content of a file; None if it is not there."""
    try:
        return read_named(file, _PART)
    except MissingFileError:
        return None


def _visible(folder: Path) -> list[Path]:
    """What is in a folder, by name; hidden files are nobody's business."""
    if not folder.is_dir():
        return []
    return sorted(file for file in folder.iterdir() if not file.name.startswith("."))


def _and_more(files: list[Path]) -> str:
    """The names of further files, for a message."""
    names = [file.name for file in files[1:_NAMED]]
    if not names:
        return ""
    more = f" and {len(files) - _NAMED} more" if len(files) > _NAMED else ""
    return f", nor are {', '.join(names)}{more}"
