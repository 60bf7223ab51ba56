"""The table of columns that every file of joint motion is read as.

One file of this package holds each kind: `CsvTable`, `ParquetTable` and `BagTable`.
`alpha5_model.trajectory.roles` finds out what the columns mean.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from alpha5_model import errors
from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model.trajectory.warning import MotionWarning

#: Units of time, and how many of each make a second.
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
#: A bag or Parquet file may expand to this many times its size. Joint states of an arm
#: at rest, compressed by zstd, expand to 10 times.
EXPANSION = 100
#: Samples, rows or messages between two reports of progress.
CHUNK = 10_000
#: Called with a stage's name and the part done, 0 to 1.
Progress = Callable[[str, float], None]


class Problem(NamedTuple):
    """Why a row cannot be read.

    Attributes:
        place: Where it is in the file.
        text: What is wrong.
    """

    place: str
    text: str


class FileTable(ABC):
    """Columns of a file of joint motion; their numbers are read when they are needed.

    Attributes:
        names: Names of all columns as in the file; see `read_motion`.
        header: The same with the arm's joints for those of the file.
        head: Where the names are in the file, for messages.
        warnings: Warnings about what was read so far.
        ignored: Names in the file that are no columns and are not used.
    """

    names: Sequence[str]
    header: Sequence[str]
    head: str = ""
    warnings: tuple[MotionWarning, ...] = ()
    ignored: tuple[str, ...] = ()

    @abstractmethod
    def read(self, columns: Sequence[int]) -> tuple[FloatArray, str | None]:
        """The numbers of some columns, the time first.

        Returns:
            The numbers, (N, k), NaN for what is none, and the unit of the time if the
            file's format defines it, else None.
        """

    @abstractmethod
    def problem(self, row: int, columns: Sequence[int]) -> Problem:
        """Why a row has no finite number in some of these columns, as read."""

    @abstractmethod
    def place(self, row: int, column: int) -> str:
        """Where a number is in the file, for messages."""


def seconds(whole: Iterable[int | None], per_second: int) -> FloatArray:
    """Times in seconds from whole numbers of another unit, NaN for None.

    Python divides whole numbers exactly. Nanoseconds since 1970 would lose digits as
    floats.
    """
    return np.array([np.nan if x is None else x / per_second for x in whole])


@contextmanager
def library(path: PathLike, extra: str) -> Iterator[None]:
    """Turn whatever an optional library raises into an error about the file.

    Args:
        path: The file that is read.
        extra: The extra of this package that installs the library.

    Raises:
        MissingDependencyError: The library is not installed.
        FileFormatError: The library cannot read the file.
    """
    remedy = f"python -m pip install 'alpha5-model[{extra}]'"
    try:
        with errors.needing(f"reading {path}", remedy):
            yield
    except errors.Alpha5Error:
        raise
    except Exception as error:  # whatever a damaged file makes it raise
        if extra == "bags":
            problem = (
                f"cannot be read as a ROS bag ({type(error).__name__}: {error}); "
                "if it was cut off: rosbag reindex, ros2 bag reindex or mcap recover"
            )
        else:
            problem = f"cannot be read as a table of numbers: {error}"
        raise errors.FileFormatError(path, problem) from None
