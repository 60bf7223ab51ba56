"""The arm's files for other tools. Here: what their XML writers share, numbers with all their digits."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable
from pathlib import Path

from alpha5_model.description.bodies import provenance
from alpha5_model.errors import MissingFileError
from alpha5_model.parameters import Alpha5Parameters
from alpha5_model.paths import REPOSITORY_PATH

#: What an attribute may be: a text, a number, or numbers; None is left out.
Value = str | float | Iterable[float] | None


def text_of(value: str | float | Iterable[float]) -> str:
    """A text as it is; numbers separated by spaces, each so that it reads back as the same double."""
    if isinstance(value, str):
        return value
    return " ".join(repr(float(x)) for x in (value if isinstance(value, Iterable) else (value,)))


def add(parent: ET.Element, tag: str, class_: Value = None, /, **attributes: Value) -> ET.Element:
    """A new child element with these attributes, ``class`` first."""
    given = {"class": class_, **attributes}
    return ET.SubElement(parent, tag, {k: text_of(v) for k, v in given.items() if v is not None})


def document(values: Alpha5Parameters, tag: str, **attributes: str) -> ET.Element:
    """A root element with comments that say where the numbers are from."""
    root, source = ET.Element(tag, attributes), provenance(values)
    root.append(ET.Comment(f" Generated from: {source['document']}. "))
    root.append(ET.Comment(f" By: {source['package']}. Corrections: {source['corrections']}. "))
    return root


def template(name: str) -> str:
    """Text of a file in ``templates/``."""
    return (Path(__file__).with_name("templates") / name).read_text(encoding="utf-8")


def serialized(root: ET.Element) -> str:
    """The indented text of a document."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def mesh_assets(*suffixes: str) -> dict[str, bytes]:
    """Name -> content of the files in ``meshes/`` that end in one of the suffixes.

    Raises:
        MissingFileError: There are none.
    """
    folder = Path(REPOSITORY_PATH) / "meshes"
    files = {p.name: p.read_bytes() for p in sorted(folder.glob("*")) if p.suffix in suffixes}
    if not files:
        raise MissingFileError(folder, f"mesh files ({', '.join(suffixes)})")
    return files
