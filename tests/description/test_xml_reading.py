"""Untrusted XML at the bounds of what is read, and what an error shows of it."""

from __future__ import annotations

import pytest

from alpha5_model.description import reading, xml_reading
from alpha5_model.description.reading import parse_urdf
from alpha5_model.description.xml_reading import parse_xml
from alpha5_model.errors import FileFormatError


def nested(levels: int) -> str:
    return "<a>" * levels + "</a>" * levels


def test_a_text_of_the_largest_size_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    text = nested(3)
    monkeypatch.setattr(xml_reading, "MOST_BYTES", len(text))
    assert parse_xml(text, "x").top.tag == "a"
    with pytest.raises(FileFormatError, match="expected at most 0 MiB"):
        parse_xml(text + "\n", "x")


def test_the_deepest_levels_are_read_and_siblings_are_not_deeper() -> None:
    assert len(parse_xml(nested(100), "x").lines) == 100
    with pytest.raises(FileFormatError, match="line 1: expected at most 100 levels"):
        parse_xml(nested(101), "x")
    siblings = f"<a>{nested(98) * 3}</a>"
    assert len(parse_xml(siblings, "x").lines) == 1 + 3 * 98


def test_as_many_links_as_are_allowed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MOST_LINKS", 2)
    links = [f'<link name="l{k}"/>' for k in range(3)]
    joint = '<joint name="j" type="fixed"><parent link="l0"/><child link="l1"/></joint>'
    robot = parse_urdf(f"<robot>{''.join(links[:2])}{joint}</robot>")
    assert list(robot.links) == ["l0", "l1"]
    with pytest.raises(FileFormatError, match="at most 2 links, got 3"):
        parse_urdf(f"<robot>{''.join(links)}{joint}</robot>")


@pytest.mark.parametrize("encoding", ["utf-16-le", "utf-16-be"])
def test_either_order_of_bytes_is_read_by_its_mark(encoding: str) -> None:
    """Whatever the declaration says."""
    text = '\ufeff<?xml version="1.0" encoding="UTF-8"?><ä name="ö"/>'
    tree = parse_xml(text.encode(encoding), "x")
    assert (tree.top.tag, tree.top.get("name")) == ("ä", "ö")
