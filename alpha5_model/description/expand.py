"""Run xacro from Python: the one place that touches the xacro library."""

from __future__ import annotations

import importlib
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from alpha5_model.errors import FileFormatError, MissingFileError
from alpha5_model.files import read_named


def expand_xacro(
    path: str | os.PathLike[str],
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str] | None = None,
) -> str:
    """Expand a xacro file.

    Args:
        path: The file.
        arguments: Values of its ``xacro:arg`` elements, as text.
        packages: Folders of the packages that it names in ``$(find NAME)``.

    Returns:
        The XML text, without xacro's banner, which names the input's path on this machine, and
        without the comments above the root element, which are about the source.

    Raises:
        InputError, MissingFileError, FileFormatError: See `read_named`.
        FileFormatError: xacro cannot expand it.
    """
    import xacro

    # Beside a folder named xacro/, Python finds that folder if the library is missing.
    process: Any = getattr(xacro, "process_file", None)
    if process is None:
        raise MissingFileError("xacro", "the xacro library to be installed")
    read_named(path, "a xacro file")
    try:
        # xacro writes into the mapping that it is given.
        with _finding(packages or {}):
            document = process(os.fspath(path), mappings=dict(arguments or {}))
    except Exception as error:
        raise FileFormatError(path, f"xacro: {' '.join(str(error).split())}") from None
    for node in list(document.childNodes):
        if node.nodeType == node.COMMENT_NODE:
            document.removeChild(node)
    text: str = document.toprettyxml(indent="  ")
    return "\n".join(line for line in text.splitlines() if line.strip()) + "\n"


@contextmanager
def _finding(packages: Mapping[str, str]) -> Iterator[None]:
    """Let ``$(find NAME)`` find these folders; xacro itself asks the index of ROS, which need not be there."""
    module: Any = importlib.import_module("xacro.substitution_args")
    before = module._eval_find

    def find(name: str) -> str:
        if name in packages:
            return str(Path(packages[name]).resolve())
        try:
            return str(before(name))
        except Exception:
            raise LookupError(f"no folder for package {name}") from None

    module._eval_find = module._eval_dict["find"] = find
    try:
        yield
    finally:
        module._eval_find = module._eval_dict["find"] = before
