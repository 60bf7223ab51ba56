"""Strategies that damage a good file, or put into it what means harm."""

from __future__ import annotations

import re
from collections.abc import Callable
from xml.sax.saxutils import escape

from hypothesis import strategies as st
from watch import CANARY

#: In place of a number.
NUMBERS = (
    *("nan", "inf", "-inf", "1e400", "1e308", "1e-320", "-1", "0", "", "x", "1,5"),
    *("0x10", "1_0", "٣", "1e", "--1", "9" * 5000),
)
#: In place of a character.
CHARACTERS = "<>&\"'/=,;\t\n\r\0 \ufeff\u2028é9-eE.#${}[]"
#: Programs and paths, in the words of xacro, ROS, Python, YAML, shells and
#: spreadsheets. Each would be seen if somebody obeyed it.
TRAPS = (
    f"${{__import__('os').system('touch {CANARY}')}}",
    f"$(eval __import__('os').system('touch {CANARY}'))",
    f"${{xacro.load_yaml('/etc/{CANARY}')}}",
    f"${{open('{CANARY}').read()}}",
    f"$(find {CANARY})/{CANARY}.xacro",
    f"$(env {CANARY})",
    f"package://../../../../etc/{CANARY}",
    f"file:///etc/{CANARY}",
    f"../../../../../../etc/{CANARY}",
    f"http://127.0.0.1:9/{CANARY}",
    f"; touch {CANARY}",
    f"=cmd|'/c {CANARY}'!A1",
    f"!!python/object/apply:os.system ['touch {CANARY}']",
    *("{{7*7}}", "%(x)s%n%s", "{0.__class__}", "${1/0}", "${'a'*10**10}", "${" * 500),
    *("&e9;", "\u202e\u2066", "A" * 5000),
)
_TEN_OF = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 10))
#: Heads of an XML file that read another file, or grow without end.
HEADS = (
    f'<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/{CANARY}">]>',
    f'<!DOCTYPE robot [<!ENTITY % x SYSTEM "{CANARY}.dtd"> %x;]>',
    f'<!DOCTYPE robot PUBLIC "a" "http://127.0.0.1:9/{CANARY}">',
    f'<!DOCTYPE robot [<!ENTITY e0 "ha">{_TEN_OF}]>',
    '<!DOCTYPE robot [<!ENTITY a "&b;"><!ENTITY b "&a;">]>',
    f'<?xml version="1.0" encoding="{CANARY}"?>',
)
#: Elements that a robot may hold, or not.
ELEMENTS = (
    f'<xacro:include filename="{CANARY}.xacro"/>',
    f'<xi:include href="{CANARY}.xml"/>',
    f'<link name="x"><visual><geometry><mesh filename="{CANARY}"/></geometry></visual>'
    "</link>",
    '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
    '<joint name="j" type="fixed"><parent link="tcp"/><child link="link_1"/></joint>',
    '<link name="link_1"/>',
    "<a>" * 3000,
)
#: Values of TOML that may be far from what is expected.
VALUES = (
    *("[[[[]]]]", "{}", "1e400", "nan", "9" * 400, "2000-01-01", "true", "-1", '"""'),
    *("[" * 900, "{values = [1, 'a']}", "{from = 0, to = 1, count = 999999999999}"),
)
#: Short texts that are repeated to no end.
REPEATED = (
    *("<!--", "<", "<![CDATA[", "<a>", "<robot>", "&amp;", "${", "$(", '"', ",", "\n"),
    *("[", "{", "0 ", "((", '<link name="a"/>', "a = "),
)
_NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
_QUOTED = re.compile(r'"[^"<>]*"')
_ASSIGNED = re.compile(r"(?<== ).+")

Draw = st.DrawFn


def _in_place_of(pattern: re.Pattern[str], words: st.SearchStrategy[str]) -> Callable:
    """Replaces one of the places that match."""

    def change(draw: Draw, text: str) -> str:
        found = list(pattern.finditer(text))
        if not found:
            return text
        place = found[draw(st.integers(0, len(found) - 1))]
        return text[: place.start()] + draw(words) + text[place.end() :]

    return change


def _cut(draw: Draw, text: str) -> str:
    start = draw(st.integers(0, len(text)))
    return text[:start] + text[start + draw(st.integers(1, 60)) :]


def _doubled(draw: Draw, text: str) -> str:
    start = draw(st.integers(0, len(text)))
    return text[: start + draw(st.integers(1, 60))] + text[start:]


def _truncated(draw: Draw, text: str) -> str:
    return text[: draw(st.integers(0, len(text)))]


def _with_a_character(draw: Draw, text: str) -> str:
    place = draw(st.integers(0, len(text)))
    return text[:place] + draw(st.sampled_from(CHARACTERS)) + text[place + 1 :]


def _with_a_line_moved(draw: Draw, text: str) -> str:
    lines = text.split("\n")
    here = draw(st.integers(0, len(lines) - 1))
    line = lines.pop(here)
    lines.insert(draw(st.integers(0, len(lines))), line)
    return "\n".join(lines)


def _with_a_head(draw: Draw, text: str) -> str:
    return draw(st.sampled_from(HEADS)) + text.partition("?>")[2]


def _with_an_element(draw: Draw, text: str) -> str:
    return text.replace("</robot>", draw(st.sampled_from(ELEMENTS)) + "</robot>")


_traps = st.sampled_from(TRAPS)
_ANY = (
    _in_place_of(_NUMBER, st.sampled_from(NUMBERS)),
    _in_place_of(_NUMBER, st.floats().map(repr)),
    _cut,
    _doubled,
    _truncated,
    _with_a_character,
    _with_a_line_moved,
)
#: Kind of text -> ways to damage it.
WAYS: dict[str, tuple[Callable[[Draw, str], str], ...]] = {
    "xml": (
        *_ANY,
        _in_place_of(_QUOTED, _traps.map(lambda trap: f'"{escape(trap)}"')),
        _with_a_head,
        _with_an_element,
    ),
    "toml": (
        *_ANY,
        _in_place_of(_ASSIGNED, _traps.map(repr) | st.sampled_from(VALUES)),
    ),
    "table": (*_ANY, _in_place_of(re.compile(r"[^,\n]+"), _traps)),
}


@st.composite
def damaged(draw: Draw, text: str, kind: str) -> bytes:
    """A text with one to three things wrong, in some encoding; or one to no end.

    Args:
        draw: Of hypothesis.
        text: A good one.
        kind: Of `WAYS`.
    """
    if draw(st.integers(0, 15)) == 0:
        short = draw(st.sampled_from(REPEATED))
        return (short * draw(st.integers(1, 100_000 // len(short)))).encode()
    for _ in range(draw(st.integers(1, 3))):
        text = draw(st.sampled_from(WAYS[kind]))(draw, text)
    encodings = ("utf-8",) * 9 + ("utf-16", "latin-1", "utf-8-sig")
    return text.encode(draw(st.sampled_from(encodings)), "replace")


@st.composite
def garbled(draw: Draw, content: bytes) -> bytes:
    """The bytes of a container, some of them changed, cut out or doubled."""
    raw = bytearray(content)
    for _ in range(draw(st.integers(1, 5))):
        start = draw(st.integers(0, max(len(raw) - 1, 0)))
        length = draw(st.integers(1, 64))
        way = draw(st.integers(0, 4))
        if way < 2:
            raw[start : start + length] = draw(st.binary(max_size=length))
        elif way == 2:
            raw[start : start + 8] = bytes([draw(st.sampled_from((0, 127, 128, 255)))])
        elif way == 3:
            del raw[start : start + length]
        else:
            raw[start:start] = raw[start : start + length]
    return bytes(raw)
