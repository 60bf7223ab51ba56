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
#: What may come before the first element: blank lines and a byte order mark.
_BLANK = "\ufeff \t\r\n".encode()
_JUNK = expat.errors.codes[expat.errors.XML_ERROR_JUNK_AFTER_DOC_ELEMENT]
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
#: How the answers of ROS tools begin that hold a robot description.
_ANSWERS = {
    "String value is:": "the answer of `ros2 param get`",
    "data:": "the output of `ros2 topic echo`",
    "robot_description:": "a YAML file of ROS parameters",
}
_REMEDY = (
    "save the description alone, by "
    "`ros2 param get --hide-type /robot_state_publisher robot_description`"
)


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
            a byte order mark. Blank lines may come first.
        origin: Name of the text in errors.

    Raises:
        FileFormatError: Not XML, too large or too deep, or with a document type, which
            could declare entities or name other files. The message names the line.
    """
    if len(text) > MOST_BYTES:
        most = MOST_BYTES // 2**20
        problem = f"expected at most {most} MiB, got {len(text) / 2**20:.0f} MiB"
        raise FileFormatError(origin, problem)
    builder = _Builder(origin)
    try:
        return builder.parse(text)
    except expat.ExpatError as error:
        problem = f"not XML: {expat.errors.messages[error.code]}"
        if error.code == _JUNK:
            problem += "; delete what follows the last element"
        raise builder.fail(problem, error.lineno) from None
    except FileFormatError:
        raise
    except (ValueError, AssertionError, LookupError) as error:
        raise FileFormatError(origin, f"not XML: {error}") from None


class _Builder:
    """Builds the tree while expat reads."""

    def __init__(self, origin: str) -> None:
        self.origin = origin
        self.depth = 0
        self.blank_lines = 0
        self.lines: dict[ET.Element, int] = {}
        self.elements = ET.TreeBuilder()

    def parse(self, text: str | bytes) -> XmlTree:
        if isinstance(text, bytes) and text[:2] in _UTF_16:
            text = text.decode("utf-16")  # whatever its declaration says
        content = text.encode() if isinstance(text, str) else text
        stripped = content.lstrip(_BLANK)
        self.blank_lines = content.count(b"\n", 0, len(content) - len(stripped))
        self.check_start(stripped[:4000].decode(errors="replace"))

        self.parser = expat.ParserCreate("utf-8" if isinstance(text, str) else None)
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.elements.data
        self.parser.StartDoctypeDeclHandler = self.document_type
        self.parser.Parse(stripped, True)
        return XmlTree(top=self.elements.close(), lines=self.lines)

    def check_start(self, start: str) -> None:
        """Say what a text is that holds a description but is none."""
        if not start or start.startswith("<"):
            return
        before, found, _ = start.partition("<")
        problem = f"not XML: begins with {before[:40]!r}, not with <"
        for words, kind in _ANSWERS.items():
            if start.startswith(words):
                problem = f"not XML, but {kind}"
        if found:
            problem += f": delete what comes before the first <, or {_REMEDY}"
        raise self.fail(problem, 1)

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        if self.depth > MOST_LEVELS:
            line = self.parser.CurrentLineNumber
            raise self.fail(f"expected at most {MOST_LEVELS} levels of elements", line)
        element = self.elements.start(tag, attributes)
        self.lines[element] = self.parser.CurrentLineNumber + self.blank_lines

    def end(self, tag: str) -> None:
        self.depth -= 1
        self.elements.end(tag)

    def document_type(self, name: str, *_: object) -> None:
        problem = f"<!DOCTYPE {name[:40]}>: entities and other files are not read; "
        line = self.parser.CurrentLineNumber
        raise self.fail(problem + "remove the document type", line)

    def fail(self, problem: str, line: int) -> FileFormatError:
        """An error at a line, counted from the first that is not blank."""
        return FileFormatError(self.origin, problem, f"line {line + self.blank_lines}")
