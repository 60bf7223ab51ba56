"""Read untrusted XML: no entities, no other files, bounded size and depth."""

from __future__ import annotations

import codecs
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from xml.parsers import expat

from alpha5_model.errors import FileFormatError

#: Limits that no robot description needs. The largest public ones have 1 MB, 20 levels.
MOST_BYTES = 64 * 2**20
MOST_LEVELS = 100
#: Attributes that name something. They are printed, and could pose as other lines.
_NAMES = ("name", "link", "joint", "filename")


@dataclass(frozen=True, eq=False)
class XmlTree:
    """The elements of an XML text.

    Attributes:
        top: The root element.
        lines: Element -> the number of the line where it begins.
    """

    top: ET.Element
    lines: dict[ET.Element, int]


def parse_xml(text: str | bytes, origin: str) -> XmlTree:
    """Read an XML text. Namespaces are ignored, so names keep their prefixes.

    Args:
        text: The text, or its bytes in an encoding that expat knows, or in UTF-16 with
            a byte order mark.
        origin: Name of the text in errors.

    Raises:
        FileFormatError: Not XML, too large or too deep, a name with a line end, or with
            a document type, which could declare entities or name other files. The
            message names the line.
    """
    if len(text) > MOST_BYTES:
        most = MOST_BYTES // 2**20
        problem = f"expected at most {most} MiB, got {len(text) / 2**20:.0f} MiB"
        raise FileFormatError(origin, problem)
    try:
        if isinstance(text, bytes) and text[:2] in (
            codecs.BOM_UTF16_LE,
            codecs.BOM_UTF16_BE,
        ):
            text = text.decode("utf-16")  # whatever its declaration says
        return _Builder(origin).parse(text)
    except expat.ExpatError as error:
        problem = f"not XML: {expat.errors.messages[error.code]}"
        raise FileFormatError(origin, problem, f"line {error.lineno}") from None
    except FileFormatError:
        raise
    except (ValueError, AssertionError, LookupError) as error:
        raise FileFormatError(origin, f"not XML: {error}") from None


class _Builder:
    """Builds the tree while expat reads."""

    def __init__(self, origin: str) -> None:
        self.origin = origin
        self.depth = 0
        self.lines: dict[ET.Element, int] = {}
        self.elements = ET.TreeBuilder()
        self.parser = expat.ParserCreate()
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.elements.data
        self.parser.StartDoctypeDeclHandler = self.document_type

    def parse(self, text: str | bytes) -> XmlTree:
        self.parser.Parse(text, True)
        return XmlTree(top=self.elements.close(), lines=self.lines)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > MOST_LEVELS:
            raise self.fail(f"expected at most {MOST_LEVELS} levels of elements")
        for key in _NAMES:
            value = attributes.get(key, "")
            if "".join(value.splitlines()) != value:
                raise self.fail(f"<{tag[:40]} {key}>: {value[:80]!r} has a line end")
        element = self.elements.start(tag, attributes)
        self.lines[element] = self.parser.CurrentLineNumber

    def end(self, tag: str) -> None:
        self.depth -= 1
        self.elements.end(tag)

    def document_type(self, name: str, *_: object) -> None:
        raise self.fail(
            f"<!DOCTYPE {name[:40]}>: entities and other files are not read; "
            "remove the document type"
        )

    def fail(self, problem: str) -> FileFormatError:
        place = f"line {self.parser.CurrentLineNumber}"
        return FileFormatError(self.origin, problem, place)
