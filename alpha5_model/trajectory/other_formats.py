"""Formats that are no table of text, told by their first bytes."""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError

_CONVERT = "write the recording as CSV, as Parquet or as a ROS bag"
_DECOMPRESS = "decompress it first"


@dataclass(frozen=True)
class _Format:
    """A format of files, and what its owner can do.

    Attributes:
        signature: The first bytes of such a file, after blanks if it is text.
        name: With its article.
        advice: An imperative.
    """

    signature: bytes
    name: str
    advice: str = _CONVERT


#: The signatures are those of the formats' own specifications.
_FORMATS = (
    _Format(b"PK\x03\x04", "a ZIP archive, such as an Excel workbook or an .npz file"),
    _Format(b"\xd0\xcf\x11\xe0", "an Excel workbook"),
    _Format(b"\x89HDF\r\n", "an HDF5 file"),
    _Format(b"MATLAB 5.0", "a MATLAB file"),
    _Format(b"\x93NUMPY", "a NumPy array"),
    _Format(b"ARROW1", "an Arrow or Feather file"),
    _Format(b"\x80\x04\x95", "a pickle of Python"),
    _Format(b"\x80\x05\x95", "a pickle of Python"),
    _Format(b"\x1f\x8b", "compressed by gzip", _DECOMPRESS),
    _Format(b"BZh", "compressed by bzip2", _DECOMPRESS),
    _Format(b"\xfd7zXZ", "compressed by xz", _DECOMPRESS),
    _Format(b"\x28\xb5\x2f\xfd", "compressed by Zstandard", _DECOMPRESS),
    _Format(b"PAR1", "a Parquet file", "name it .parquet"),
    _Format(b"#ROSBAG V", "a bag of ROS 1", "name it .bag"),
    _Format(b"SQLite format 3", "a bag of ROS 2", "name it .db3"),
    _Format(b"\x89MCAP0", "an MCAP file", "name it .mcap"),
    _Format(
        b"header:\n",
        "what ros2 topic echo prints",
        "record it with ros2 topic echo --csv, or with ros2 bag record",
    ),
    _Format(b"{", "JSON"),
    _Format(b"[", "JSON"),
    _Format(b"<", "XML or HTML"),
)


def refuse_other_formats(path: PathLike, content: bytes) -> None:
    """Refuse a file that is no table of text by its name.

    Args:
        path: The file, for the message.
        content: Its bytes, or the first hundred of them.

    Raises:
        FileFormatError: It is in one of these formats.
    """
    start = content[:100].removeprefix(b"\xef\xbb\xbf").lstrip()
    start = start.removeprefix(b"---").lstrip().replace(b"\r\n", b"\n")
    for known in _FORMATS:
        if start.startswith(known.signature):
            problem = f"is {known.name}, a CSV file is expected: {known.advice}"
            raise FileFormatError(path, problem)
