"""Names of the numbers in a column of lists, as LeRobot's data sets state them.

A data set has one column ``observation.state`` with a list of numbers per row. What
each of them is stands in ``meta/info.json`` of the data set, or in the metadata of the
Parquet file itself.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from alpha5_model._support.files import PathLike, read_named
from alpha5_model.errors import Alpha5Error

#: Keys of a Parquet file's metadata that hold features.
_METADATA_KEYS = (b"lerobot", b"huggingface")
#: A file is in ``data/chunk-000/`` of its data set.
_FOLDERS_UP = 3
#: Largest ``info.json`` that is read [bytes]; a robot's is some kilobytes.
_MOST_INFO = 1_000_000
#: Longer lists are no state of a robot; their numbers are no columns.
LONGEST_LIST = 256
_STATE = "observation.state"
_OBSERVED = "observation."
#: What stands behind a name in other columns than the state.
_QUANTITIES = {
    "velocity": "_velocity",
    "qvel": "_velocity",
    "effort": "_effort",
    "torque": "_torque",
    "current": "_current",
}


def list_names(
    path: PathLike,
    metadata: Mapping[bytes, bytes] | None,
    lists: Mapping[str, int | None],
) -> dict[str, list[str]]:
    """The name of each number in columns of lists.

    A number of ``observation.state`` has the name that the data set gives it, one of
    another column also that column's: ``action/axis_e``. Without names they are
    ``observation.state[0]`` and so on.

    Args:
        path: The Parquet file.
        metadata: Its key-value metadata.
        lists: Column -> how many numbers each of its lists has; None if the type of
            the column leaves it open. Such a column needs names.
    """
    features = _features(path, metadata) if lists else {}
    names = {}
    for column, count in lists.items():
        stated = _stated_names(features.get(column), count)
        if stated is not None:
            names[column] = [_full_name(column, name) for name in stated]
        elif count is not None:
            names[column] = [f"{column}[{k}]" for k in range(count)]
    return names


def _full_name(column: str, name: str) -> str:
    """The name of a number of a column, with what the column says about it."""
    if column == _STATE:
        return name
    quantity = _QUANTITIES.get(column.removeprefix(_OBSERVED))
    return f"{column}/{name}" if quantity is None else name + quantity


def _features(
    path: PathLike, metadata: Mapping[bytes, bytes] | None
) -> Mapping[str, Any]:
    """What a data set says about its columns; empty if it says nothing."""
    for text in [*_metadata_texts(metadata), *_info_texts(path)]:
        record: Any = None
        # RecursionError: brackets in brackets, by thousands.
        with suppress(ValueError, RecursionError):
            record = json.loads(text)
        for part in (record, _entry(record, "info")):
            features = _entry(part, "features")
            if isinstance(features, Mapping) and _has_names(features):
                return features
    return {}


def _metadata_texts(metadata: Mapping[bytes, bytes] | None) -> list[bytes]:
    """The texts in the metadata of a Parquet file that may have names."""
    known = metadata or {}
    return [known[key] for key in _METADATA_KEYS if key in known]


def _info_texts(path: PathLike) -> list[bytes]:
    """The nearest ``meta/info.json`` above a file, if there is one."""
    folders = Path(path).absolute().parents[:_FOLDERS_UP]
    for folder in folders:
        with suppress(Alpha5Error):
            file = folder / "meta" / "info.json"
            return [read_named(file, "a data set's info", _MOST_INFO)]
    return []


def _entry(record: Any, key: str) -> Any:
    """An entry of a JSON object; None if it is none, or lacks it."""
    return record.get(key) if isinstance(record, Mapping) else None


def _has_names(features: Mapping[str, Any]) -> bool:
    """Whether any feature names its numbers."""
    return any(_entry(feature, "names") for feature in features.values())


def _stated_names(feature: Any, count: int | None) -> list[str] | None:
    """The names of a feature's numbers; None if it does not name each of them.

    Older data sets have them in an object with one key, such as ``motors``.
    """
    names = _entry(feature, "names")
    if isinstance(names, Mapping) and len(names) == 1:
        (names,) = names.values()
    if not isinstance(names, list) or not 0 < len(names) <= LONGEST_LIST:
        return None
    if count is not None and len(names) != count:
        return None
    return names if all(isinstance(name, str) for name in names) else None
