"""Expanding xacro files. The xacro library is called here only."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from alpha5_model._support.files import read_named
from alpha5_model.errors import FileFormatError, MissingFileError


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
        The XML text. It leaves out xacro's banner, which names a path of this machine,
        and the comments above the root element, which are about the source.

    Raises:
        InputError, MissingFileError, FileFormatError: See `read_named`.
        FileFormatError: xacro cannot expand it.
    """
    process = _process_file()
    read_named(path, "a xacro file")
    # xacro writes into the mapping that it is given.
    mappings = dict(arguments or {})
    with _packages_found(packages or {}):
        try:
            document = process(os.fspath(path), mappings=mappings)
        except Exception as error:
            raise FileFormatError(path, f"xacro: {_problem(error)}") from None

    text: str = document.documentElement.toprettyxml(indent="  ")
    lines = [line for line in text.splitlines() if line.strip()]
    return "\n".join(['<?xml version="1.0" ?>', *lines, ""])


def _problem(error: Exception) -> str:
    """What xacro says in one line, without the expression that says it."""
    problem = " ".join(str(error).split())
    return problem.partition(" when evaluating expression 'xacro.fatal(")[0]


def _process_file() -> Callable[..., Any]:
    """The library's function that expands a file."""
    import xacro

    # Beside a folder named xacro/, Python imports that folder if the library is
    # missing.
    process: Callable[..., Any] | None = getattr(xacro, "process_file", None)
    if process is None:
        raise MissingFileError("xacro", "the xacro library to be installed")
    return process


@contextmanager
def _packages_found(packages: Mapping[str, str]) -> Iterator[None]:
    """Let xacro's ``$(find NAME)`` look into ``packages`` before ROS' own index.

    xacro asks ``ament_index_python``, which is not there without ROS, so another module
    takes its place for the time being.
    """
    in_ros = _index_of_ros()

    def get_package_share_directory(name: str) -> str:
        if name in packages:
            return str(Path(packages[name]).resolve())
        try:
            return str(in_ros(name))
        except Exception:
            raise LookupError(f"no folder for package {name}") from None

    names = ("ament_index_python", "ament_index_python.packages")
    before = {name: sys.modules.get(name) for name in names}
    for name in names:
        module: Any = ModuleType(name)
        module.get_package_share_directory = get_package_share_directory
        sys.modules[name] = module
    try:
        yield
    finally:
        for name, kept in before.items():
            del sys.modules[name]
            if kept is not None:
                sys.modules[name] = kept


def _index_of_ros() -> Callable[[str], Any]:
    """The function by which ROS finds packages; one that finds none without ROS."""
    find: Callable[[str], Any]
    try:
        index = importlib.import_module("ament_index_python.packages")
        find = index.get_package_share_directory
    except ImportError:
        find = dict[str, Any]().__getitem__
    return find
