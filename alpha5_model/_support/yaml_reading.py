"""YAML from other people: a few levels, no aliases, one line for every mistake."""

from __future__ import annotations

from typing import Any

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError

#: Deep levels take the reader quadratic time.
_MOST_LEVELS = 8


def yaml_document(content: bytes, path: PathLike) -> Any:
    """What a YAML file holds.

    A few aliases of aliases stand for more text than a machine can hold.

    Args:
        content: Of the file.
        path: Its name, for messages.

    Raises:
        FileFormatError: Not YAML, nested too deep, or with an alias.
    """
    import yaml

    level = 0
    try:
        for event in yaml.parse(content, yaml.SafeLoader):
            if isinstance(event, yaml.AliasEvent):
                raise FileFormatError(path, f"no alias such as *{event.anchor}")
            level += isinstance(event, yaml.CollectionStartEvent)
            level -= isinstance(event, yaml.CollectionEndEvent)
            if level > _MOST_LEVELS:
                raise FileFormatError(path, f"more than {_MOST_LEVELS} levels")
        return yaml.safe_load(content)
    except FileFormatError:
        raise
    except (yaml.YAMLError, ValueError) as error:
        # A ValueError is a date that does not exist, or a very long integer.
        problem = " ".join(str(error).split())
        raise FileFormatError(path, f"not YAML: {problem}") from None
