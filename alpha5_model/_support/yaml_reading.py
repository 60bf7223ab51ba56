"""YAML from other people: a few levels, no aliases, one line for every mistake."""

from __future__ import annotations

from typing import Any

from alpha5_model._support.files import PathLike
from alpha5_model.errors import FileFormatError

#: Deep levels take the reader quadratic time.
_MOST_LEVELS = 8


def yaml_document(content: bytes, path: PathLike) -> Any:
    """What a YAML file holds.

    A few aliases of aliases stand for more text than a machine can hold. A ``---`` may
    follow the document, as ``ros2 topic echo`` writes it.

    Args:
        content: Of the file.
        path: Its name, for messages.

    Raises:
        FileFormatError: Not YAML, nested too deep, with an alias, with a key twice, or
            several documents.
    """
    import yaml

    # The compiled one is several times as fast, but not in every installation.
    fastest = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

    class Loader(fastest):  # type: ignore[misc, valid-type]
        """YAML forbids equal keys; PyYAML would keep the last one."""

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            pairs = node.value if isinstance(node, yaml.MappingNode) else []
            seen = set()
            for key, _ in pairs:
                if isinstance(key, yaml.ScalarNode) and (key.tag, key.value) in seen:
                    problem = f"the key {key.value[:40]!r} stands twice"
                    line = f"line {key.start_mark.line + 1}"
                    raise FileFormatError(path, problem, line)
                if isinstance(key, yaml.ScalarNode):
                    seen.add((key.tag, key.value))
            return super().construct_mapping(node, deep)

    level = 0
    try:
        for event in yaml.parse(content, Loader):
            if isinstance(event, yaml.AliasEvent):
                raise FileFormatError(path, f"no alias such as *{event.anchor}")
            level += isinstance(event, yaml.CollectionStartEvent)
            level -= isinstance(event, yaml.CollectionEndEvent)
            if level > _MOST_LEVELS:
                raise FileFormatError(path, f"more than {_MOST_LEVELS} levels")
        documents = [*yaml.load_all(content, Loader)]
    except FileFormatError:
        raise
    except (yaml.YAMLError, ValueError) as error:
        # A ValueError is a date that does not exist, or a very long integer.
        problem = " ".join(str(error).split())
        raise FileFormatError(path, f"not YAML: {problem}") from None

    if len(documents) == 2 and documents[1] is None:
        documents.pop()
    if len(documents) > 1:
        problem = f"holds {len(documents)} documents, expected one: keep what is "
        raise FileFormatError(path, problem + "before the first ---")
    return documents[0] if documents else None
