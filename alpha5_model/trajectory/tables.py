"""A recording as a table of numbers with names, as every reader of files returns it.

`alpha5_model.trajectory.csv_file`, `parquet_file` and `bags` read a `Table`;
`alpha5_model.trajectory.column_names` finds out what its columns mean.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from alpha5_model import errors
from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model.trajectory.motions import MotionWarning

#: Units of time, and how many of each make a second.
PER_SECOND = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9, "min": 1 / 60}
#: A bag or Parquet file may expand to this many times its size. Joint states of an arm
#: at rest, compressed by zstd, expand to 10 times.
EXPANSION = 100
#: Called with a stage's name and the part done, 0 to 1.
Progress = Callable[[str, float], None]
#: The first line of a file that Git LFS has not fetched.
_GIT_LFS = b"version https://git-lfs.github.com/spec/"


class Problem(NamedTuple):
    """Why a row cannot be read.

    Attributes:
        place: Where it is in the file.
        text: What is wrong.
    """

    place: str
    text: str


class Table(NamedTuple):
    """The numbers of a file.

    Attributes:
        header: Names of the k columns.
        values: (N, k) NaN where there is no finite number.
        place: Where the number of a row and a column is in the file, for messages.
        problem: Why a row has no number in one of some columns.
        head: Where the names are in the file, for messages.
        in_seconds: Columns of time that are in seconds by their format.
        warnings: About what was read.
        ignored: Names in the file that are no columns.
        every_row: Whether a row without positions is odd. Messages of other nodes are
            not.
        of_joints: Name -> its columns and its rows, (N,), of a table whose rows are
            about one joint each.
    """

    header: list[str]
    values: FloatArray
    place: Callable[[int, int], str]
    problem: Callable[[int, Sequence[int]], Problem]
    head: str = ""
    in_seconds: frozenset[int] = frozenset()
    warnings: tuple[MotionWarning, ...] = ()
    ignored: tuple[str, ...] = ()
    every_row: bool = True
    of_joints: Mapping[str, tuple[range, BoolArray]] = MappingProxyType({})


def seconds(whole: Iterable[int | None], per_second: int) -> FloatArray:
    """Times in seconds from whole numbers of another unit, NaN for None.

    Python divides whole numbers exactly. Nanoseconds since 1970 would lose digits as
    floats.
    """
    return np.array([np.nan if x is None else x / per_second for x in whole])


def refuse_git_lfs_pointer(path: PathLike, content: bytes) -> None:
    """Refuse the small text that stands for a file that Git LFS has not fetched.

    Args:
        path: The file, for the message.
        content: Its bytes, or the first hundred of them.

    Raises:
        errors.FileFormatError: It is such a text.
    """
    if content.startswith(_GIT_LFS):
        problem = "is a Git LFS pointer, not the recording: run git lfs pull first"
        raise errors.FileFormatError(path, problem)


def refuse_expansion(path: PathLike, expanded: int, most: int) -> None:
    """Refuse a file that would take much more memory than it is large.

    Raises:
        errors.FileFormatError: It expands to more than `most` bytes.
    """
    if expanded > most:
        problem = (
            f"expands to more than {most / 1e6:.3g} MB, {EXPANSION} times its size; "
            "write it without compression if it is yours"
        )
        raise errors.FileFormatError(path, problem)


@contextmanager
def library(path: PathLike, extra: str) -> Iterator[None]:
    """Turn whatever an optional library raises into an error about the file.

    Args:
        path: The file that is read.
        extra: The extra of this package that installs the library.

    Raises:
        errors.MissingDependencyError: The library is not installed.
        errors.FileFormatError: The library cannot read the file.
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
