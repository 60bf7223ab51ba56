"""Read the file of another model: a URDF, or a xacro file expanded on request."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from alpha5_model._support.checks import flag
from alpha5_model._support.files import read_named
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.urdf_robot import UrdfRobot
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import Alpha5Error, FileFormatError, InputError

#: Root element -> the format of its file.
OTHER_FORMATS = {
    "mujoco": "an MJCF model",
    "sdf": "an SDF model",
    "COLLADA": "a COLLADA mesh",
}


@dataclass(frozen=True)
class XacroOptions:
    """Folders of packages and values of arguments, by name."""

    packages: dict[str, str]
    arguments: dict[str, str]

    def command(self, path: str | Path) -> str:
        """The command line that expands and compares the file, quoted for a shell."""
        words = ["alpha5", "compare", "--xacro", str(path)]
        for name, folder in self.packages.items():
            words += ["--package", f"{name}={folder}"]
        for name, value in self.arguments.items():
            words += ["--arg", f"{name}:={value}"]
        return shlex.join(words)


def read_model(
    path: str | Path,
    packages: Mapping[str, str] | None,
    arguments: Mapping[str, str] | None,
    xacro: bool,
) -> UrdfRobot:
    """Read a URDF as it is, or expand a xacro file on request and read the result.

    Args:
        path: The file.
        packages: For a xacro file: name of each package in ``$(find NAME)`` -> its
            folder. The package of the file itself is found by the ``package.xml`` above
            it.
        arguments: For a xacro file: values of its arguments, as text.
        xacro: Whether to expand. A xacro file is a program: it can read files and run
            commands.

    Raises:
        InputError, MissingFileError: See `read_named`.
        InputError: The file to expand is no xacro file, or packages or arguments are
            given for a file that is not expanded.
        FileFormatError: The file has another format (the message names it), is a xacro
            file that is not to be expanded or cannot be (the message gives the command
            that would expand it), or is a broken URDF (the message gives the line).
    """
    content = read_named(path, "a URDF or xacro file")
    options = XacroOptions(
        packages=dict(packages or {}), arguments=dict(arguments or {})
    )
    is_xacro = Path(path).suffix.lower() == ".xacro"
    expand = flag("xacro", xacro)

    _check_request(path, is_xacro, expand, options)
    if expand:
        content = _expanded(path, content, options).encode()

    _check_format(path, content)
    return _parsed(path, content, is_xacro)


def _check_request(
    path: str | Path, is_xacro: bool, expand: bool, options: XacroOptions
) -> None:
    """Refuse a xacro file without permission, and xacro options for other files."""
    if is_xacro and not expand:
        problem = (
            "a xacro file is a program, and to expand it is to run it; if you trust it"
        )
        raise FileFormatError(path, f"{problem}: {options.command(path)}")

    if expand and not is_xacro:
        expected = "a file whose name ends in .xacro; a URDF is read as it is"
        raise InputError("xacro", str(path), expected)

    given = [*options.packages, *options.arguments]
    if given and not expand:
        expected = "a xacro file to expand, with --xacro; a URDF is read as it is"
        raise InputError("package, arg", given, expected)


def _check_format(path: str | Path, content: bytes) -> None:
    """Refuse a model of another format by its name."""
    tag = parse_xml(content, str(path)).top.tag
    if tag in OTHER_FORMATS:
        problem = (
            f"expected <robot>, got <{tag}>: {OTHER_FORMATS[tag]}; "
            "compare reads URDF and xacro"
        )
        raise FileFormatError(path, problem)


def _parsed(path: str | Path, content: bytes, is_xacro: bool) -> UrdfRobot:
    """The robot of a URDF; a refusal adds a hint if xacro was not expanded."""
    try:
        return parse_urdf(content, str(path))
    except FileFormatError as error:
        has_xacro = b"<xacro:" in content.replace(b"\0", b"")
        if is_xacro or not has_xacro:
            raise

        problem = str(error).removeprefix(f"{path}").lstrip(",: ")
        hint = (
            "it has xacro in it, and only a file whose name ends in .xacro is expanded"
        )
        raise FileFormatError(path, f"{problem}; {hint}", error.place) from None


def _expanded(path: str | Path, content: bytes, options: XacroOptions) -> str:
    """The text that a xacro file makes; a refusal adds the command that would work."""
    packages = package_above(path) | options.packages
    try:
        return expand_xacro(path, options.arguments, packages)
    except FileFormatError as error:
        problem = str(error).removeprefix(f"{path}: ")

    folders = dict.fromkeys(_missing_packages(content, problem, packages), "FOLDER")
    values = dict.fromkeys(_missing_arguments(problem), "VALUE")
    if folders or values:
        complete = XacroOptions(
            packages=options.packages | folders,
            arguments=options.arguments | values,
        )
        problem += f"; this would expand it: {complete.command(path)}"
    raise FileFormatError(path, problem)


def _missing_packages(
    content: bytes, problem: str, known: Mapping[str, str]
) -> list[str]:
    """Packages that a xacro file needs and that have no folder, sorted by name.

    Args:
        content: The file. Its encoding does not matter: the marks are ASCII.
        problem: Message of xacro, which alone knows names that are computed.
        known: Name -> folder.
    """
    text = content.replace(b"\0", b"").decode("utf-8", "replace")
    written = re.findall(r"\$\(find\s+([A-Za-z][\w.-]*)\s*\)", text)
    computed = re.findall(r"no folder for package ([A-Za-z][\w.-]*)", problem)
    return sorted({*written, *computed} - {*known})


def _missing_arguments(problem: str) -> list[str]:
    """Arguments that xacro misses, by its message."""
    return re.findall(r"[Uu]ndefined substitution argument (\w+)", problem)


def package_above(path: str | Path) -> dict[str, str]:
    """Name and folder of the ROS package of a file, by the nearest ``package.xml``."""
    for folder in Path(path).resolve().parents:
        manifest = folder / "package.xml"
        if not manifest.is_file():
            continue
        with suppress(Alpha5Error):
            name = _package_name(manifest)
            return {name: str(folder)} if name else {}
    return {}


def _package_name(manifest: Path) -> str:
    """The name in the manifest of a package; empty if it has none."""
    content = read_named(manifest, "the manifest of a package")
    tree = parse_xml(content, str(manifest))
    return (tree.top.findtext("name") or "").strip()
