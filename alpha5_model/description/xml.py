"""Writing XML: numbers as text, elements, documents with their sources.

Also the lines about what a format has no place for.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping

from alpha5_model import __version__
from alpha5_model.numbers.motors import joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters, is_catalogue
from alpha5_model.numbers.printed import published

#: Type of an attribute: a text, a number, or numbers; None is left out.
Value = str | float | Iterable[float] | None
#: Content of an element: a text or numbers, or elements by name, each with such
#: content.
Nested = str | float | Iterable[float] | Mapping[str, "Nested"]
XML_HEAD = '<?xml version="1.0"?>\n'


def text_of(value: str | float | Iterable[float]) -> str:
    """Text of a value: a text as it is, numbers separated by spaces.

    A number is written so that it reads back as the same double.
    """
    if isinstance(value, str):
        return value
    numbers = value if isinstance(value, Iterable) else (value,)
    return " ".join(repr(float(x)) for x in numbers)


def add(
    parent: ET.Element, tag: str, class_: Value = None, /, **attributes: Value
) -> ET.Element:
    """Append and return a child element with these attributes, ``class`` first."""
    texts = {}
    for name, value in {"class": class_, **attributes}.items():
        if value is not None:
            texts[name] = text_of(value)
    return ET.SubElement(parent, tag, texts)


def fill(parent: ET.Element, /, **content: Nested) -> None:
    """Append child elements by name, each with its text or its own children."""
    for name, value in content.items():
        child = add(parent, name)
        if isinstance(value, Mapping):
            fill(child, **value)
        else:
            child.text = text_of(value)


def provenance(parameters: Alpha5Parameters) -> dict[str, str]:
    """Document, package and corrections that the parameters come from."""
    source = published().table_2.source
    edition = f"version {source.version}, {source.date}"
    document = f"{source.publisher}, {source.document}, {edition}"
    if not is_catalogue(parameters):
        document += f"; changed for the arm {parameters.name}"
    return {
        "document": document,
        "package": f"alpha5_model {__version__}",
        "corrections": ", ".join(parameters.corrections) or "none",
    }


def document(
    parameters: Alpha5Parameters, tag: str, *comments: str, **attributes: str
) -> ET.Element:
    """A root element whose comments name the sources of the numbers.

    Args:
        parameters: The arm's parameters.
        tag: Tag of the root element.
        comments: Further comments, below those about the sources.
        attributes: Attributes of the root element.
    """
    source = provenance(parameters)
    package = source["package"]
    corrections = source["corrections"]
    lines = [
        f"Generated from: {source['document']}.",
        f"By: {package}. Corrections: {corrections}.",
        *comments,
    ]

    root = ET.Element(tag, attributes)
    for line in lines:
        root.append(ET.Comment(f" {line} "))
    return root


def without_armature(file_format: str, arm: Alpha5Parameters) -> list[str]:
    """A line about rotor inertia, which URDF and SDF cannot hold; none without any.

    Args:
        file_format: Its name.
        arm: Record of the arm.
    """
    rotors = []
    for joint, losses in joint_losses(arm).items():
        if losses.armature:
            rotors.append(f"{joint} {losses.armature:.3g} kg m^2")
    if not rotors:
        return []
    return [f"{file_format} has no rotor inertia; left out: {', '.join(rotors)}."]


def serialized(root: ET.Element) -> str:
    """The indented text of a document."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"
