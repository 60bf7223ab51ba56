"""Parquet files, read without pyarrow being loaded when tests are collected."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def read_table(path: Path) -> Any:
    """A file, or a folder of files."""
    from pyarrow import parquet

    return parquet.read_table(path)


def read_schema(path: Path) -> Any:
    from pyarrow import parquet

    return parquet.read_schema(path)
