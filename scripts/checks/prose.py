"""Counts the words of paragraphs, list items and sentences of a Markdown page.

Code, tables, headings, comments and what a program writes between comments ``begin``
and ``end`` are not counted.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

_NOT_PROSE = (
    r"(?s)^---\n.*?\n---\n",  # settings at the head of a page
    r"(?s)<!-- [\w: ]*begin -->.*?<!-- [\w: ]*end -->",
    r"(?s)<!--.*?-->",
    r"(?ms)^ *```.*?^ *```$",
    r"(?m)^ *\|.*$",
    r"(?m)^#.*$",
    r"(?m)^ *!\[.*\]\(.*\)$",
)
_ITEM = re.compile(r"^ *(?:[-*]|\d+\.) ", re.MULTILINE)
_LINK = re.compile(r"\[([^\]]*)\]\([^)]*\)")
_WORD = re.compile(r"[^\W_]\S*")
#: A sentence ends before a capital letter, a name in quotes, or code.
_SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z`*\"])")


@dataclass(frozen=True, kw_only=True)
class Prose:
    """What stands in a page as sentences.

    Attributes:
        paragraphs: Without line breaks.
        items: Of its lists.
    """

    paragraphs: list[str]
    items: list[str]

    @property
    def sentences(self) -> list[str]:
        """Of paragraphs and items, in their order."""
        return [s for text in self.paragraphs + self.items for s in sentences(text)]


def prose(page: str) -> Prose:
    """The paragraphs and list items of a page."""
    for pattern in _NOT_PROSE:
        page = re.sub(pattern, "", page)
    page = _LINK.sub(r"\1", page)
    paragraphs: list[str] = []
    items: list[str] = []
    for block in re.split(r"\n\s*\n", page):
        first, *rest = _ITEM.split(block)
        paragraphs += _one_line(first)
        for item in rest:
            items += _one_line(item)
    return Prose(paragraphs=paragraphs, items=items)


def sentences(text: str) -> Iterator[str]:
    yield from _SENTENCE.split(text)


def words(text: str) -> int:
    return len(_WORD.findall(text))


def _one_line(text: str) -> list[str]:
    line = " ".join(text.split())
    return [line] if line else []
