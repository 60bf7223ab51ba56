"""Read whatever describes another model: URDF, and xacro that expands to it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from alpha5_model.description.urdf_reading import UrdfRobot, parse_urdf
from alpha5_model.description.variants import expand_xacro
from alpha5_model.errors import FileFormatError
from alpha5_model.files import read_named

#: Root element -> what its file is.
OTHERS = {"mujoco": "an MJCF model", "sdf": "an SDF model", "COLLADA": "a COLLADA mesh"}


def read_model(
    path: Any,
    packages: Mapping[str, str] | None = None,
    arguments: Mapping[str, str] | None = None,
) -> UrdfRobot:
    """Read a URDF, or expand a xacro file and read what it makes.

    Args:
        path: The file.
        packages: Name of each package in ``$(find NAME)`` -> its folder.
        arguments: Values of the xacro file's arguments, as text.

    Raises:
        InputError, MissingFileError: See `read_named`.
        FileFormatError: Another format, named with what to do; a xacro file that cannot be expanded,
            with the options that would; a broken URDF, with its line.
    """
    content = read_named(path, "a URDF or xacro file")
    # In whatever encoding: the marks are ASCII.
    text = content.replace(b"\0", b"").decode("utf-8", "replace")
    root = re.search(r"<([A-Za-z][\w:.-]*)", re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL))
    if root and root[1] in OTHERS:
        problem = (
            f"expected <robot>, got <{root[1]}>: {OTHERS[root[1]]}; compare reads URDF and xacro"
        )
        raise FileFormatError(path, problem)
    if Path(path).suffix != ".xacro" and not re.search(r"<xacro:|\$\{", text):
        return parse_urdf(content, str(path))
    try:
        expanded = expand_xacro(path, arguments, packages)
    except FileFormatError as error:
        problem = str(error).removeprefix(f"{path}: ")
        needs = re.findall(r"\$\(find\s+([^)\s]+)\s*\)", text)
        needs += re.findall(r"no folder for package (\S+)", problem)
        options = [f"--package {name}=FOLDER" for name in sorted(set(needs) - {*(packages or {})})]
        options += [
            f"--arg {name}:=VALUE"
            for name in re.findall(r"[Uu]ndefined substitution argument (\w+)", problem)
        ]
        if not options:
            raise
        line = " ".join(("alpha5 compare", str(path), *options))
        raise FileFormatError(path, f"{problem}; this would expand it: {line}") from None
    return parse_urdf(expanded, str(path))
