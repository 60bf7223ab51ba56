"""Texts that mean harm: URDF, xacro, recordings and studies with traps, or made up.

Every trap would run a program, open a file or expand without end if somebody obeyed it.
What it names holds the word that `fuzzing.watch` looks for.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from xml.sax.saxutils import quoteattr

import numpy as np
from fuzzing.values import Rng, pick
from fuzzing.watch import CANARY

#: Programs and paths, in the words of xacro, ROS, Python, YAML, shells and
#: spreadsheets.
TRAPS = (
    f"${{__import__('os').system('touch {CANARY}')}}",
    f"$(eval __import__('os').system('touch {CANARY}'))",
    f"${{[c for c in ().__class__.__base__.__subclasses__()][0].__init__('{CANARY}')}}",
    f"${{xacro.load_yaml('/etc/{CANARY}')}}",
    f"${{load_yaml('{CANARY}.yaml')}}",
    f"${{open('{CANARY}').read()}}",
    f"$(find {CANARY})/{CANARY}.xacro",
    f"$(env {CANARY})",
    f"$(optenv {CANARY} x)",
    f"$(dirname)/{CANARY}",
    f"package://../../../../etc/{CANARY}",
    f"package://{CANARY}/mesh.stl",
    f"file:///etc/{CANARY}",
    f"model://{CANARY}/model.sdf",
    f"../../../../../../etc/{CANARY}",
    f"/etc/{CANARY}",
    f"http://127.0.0.1:9/{CANARY}",
    f"\\\\\\\\127.0.0.1\\\\{CANARY}",
    f"`touch {CANARY}`",
    f"$(touch {CANARY})",
    f"; touch {CANARY}",
    f"| touch {CANARY}",
    f"=cmd|'/c {CANARY}'!A1",
    f"!!python/object/apply:os.system ['touch {CANARY}']",
    f"__import__('os').system('touch {CANARY}')",
    "{{7*7}}",
    "%(x)s%n%s",
    "{0.__class__}",
    "${1/0}",
    "${'a'*10**10}",
    "$" + "{" * 500,
    "&e9;",
    "\u202e\u2066",
    "A" * 5000,
)
#: Document types that read a file or grow without end.
DOCTYPES = (
    f'<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/{CANARY}">]>',
    f'<!DOCTYPE robot [<!ENTITY % x SYSTEM "{CANARY}.dtd"> %x;]>',
    f'<!DOCTYPE robot SYSTEM "file:///etc/{CANARY}.dtd">',
    f'<!DOCTYPE robot PUBLIC "a" "http://127.0.0.1:9/{CANARY}">',
    "<!DOCTYPE robot ["
    + '<!ENTITY e0 "ha">'
    + "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10}">' for k in range(1, 10))
    + "]>",
    '<!DOCTYPE robot [<!ENTITY a "&b;"><!ENTITY b "&a;">]>',
    f'<?xml-stylesheet href="{CANARY}.xsl"?>',
    f'<?xml version="1.0" encoding="{CANARY}"?>',
)
#: Short texts that are repeated to no end.
REPEATED = (
    "<!--",
    "<",
    "<?",
    "<![CDATA[",
    "<a>",
    "<robot>",
    "&amp;",
    "]]>",
    "${",
    "$(",
    '<link name="a"/>',
    '"',
    ",",
    "\n",
    "[",
    "{",
    "0 ",
    "((",
)
TAGS = (
    "robot",
    "link",
    "joint",
    "inertial",
    "mass",
    "inertia",
    "origin",
    "visual",
    "collision",
    "geometry",
    "mesh",
    "box",
    "sphere",
    "cylinder",
    "material",
    "color",
    "texture",
    "axis",
    "limit",
    "mimic",
    "parent",
    "child",
    "dynamics",
    "transmission",
    "gazebo",
    "sensor",
    "xacro:include",
    "xacro:macro",
    "xacro:property",
    "xacro:arg",
    "xacro:if",
    "xacro:call",
    "include",
    "xi:include",
    "group",
)
ATTRIBUTES = (
    "name",
    "type",
    "link",
    "joint",
    "value",
    "xyz",
    "rpy",
    "filename",
    "size",
    "radius",
    "length",
    "scale",
    "rgba",
    "lower",
    "upper",
    "effort",
    "velocity",
    "ixx",
    "ixy",
    "ixz",
    "iyy",
    "iyz",
    "izz",
    "href",
    "params",
    "default",
    "ns",
    "xmlns:xacro",
    "multiplier",
    "offset",
)
WORDS = (
    "axis_e",
    "axis_d",
    "axis_c",
    "axis_b",
    "base_link",
    "link_0",
    "link_4",
    "tcp",
    "revolute",
    "continuous",
    "fixed",
    "prismatic",
    "0",
    "1",
    "0 0 0",
    "1 0 0",
    "0 0 1",
    "nan nan nan",
    "1e308 1e308 1e308",
    "-1",
    "inf",
    "1e999",
    "3.14159",
    "0.38",
    "",
    " ",
    "é",
)
_ATTRIBUTE = re.compile(r'"[^"<>]*"')


def trapped_xml(rng: Rng, text: str) -> str:
    """A valid text with one to three traps.

    They are attributes, elements, document types, or short texts without end.
    """
    for _ in range(int(rng.integers(1, 4))):
        text = _with_trap(rng, text)
    return text


def _with_trap(rng: Rng, text: str) -> str:
    """The text with one trap more."""
    way = int(rng.integers(6))
    if way < 3:
        return _with_trap_in_attribute(rng, text)
    if way == 3:
        at = text.find("<robot")
        return _inserted(text, at, pick(rng, DOCTYPES)) if at >= 0 else text
    if way == 4:
        places = [tag.start() for tag in re.finditer(r"</?[a-z]", text)]
        at = pick(rng, places) if places else 0
        return _inserted(text, at, element(rng, 2))
    at = int(rng.integers(len(text) + 1))
    repetitions = pick(rng, REPEATED) * int(rng.integers(1, 2000))
    return _inserted(text, at, repetitions)


def _inserted(text: str, at: int, more: str) -> str:
    """A text with more of it at a place."""
    return text[:at] + more + text[at:]


def _with_trap_in_attribute(rng: Rng, text: str) -> str:
    """The text with a trap for the value of an attribute, if it has any."""
    found = [*_ATTRIBUTE.finditer(text)]
    if not found:
        return text
    value = pick(rng, found)
    trap = quoteattr(pick(rng, TRAPS))
    return text[: value.start()] + trap + text[value.end() :]


def element(rng: Rng, depth: int) -> str:
    """An element of any name with anything in it."""
    tag = pick(rng, TAGS)
    names = [pick(rng, ATTRIBUTES) for _ in range(int(rng.integers(5)))]
    given = {}
    for name in names:
        given[name] = pick(rng, TRAPS if rng.integers(6) == 0 else WORDS)
    attributes = "".join(f" {name}={quoteattr(value)}" for name, value in given.items())

    children = int(rng.integers(4)) if depth else 0
    inside = "".join(element(rng, depth - 1) for _ in range(children))
    return f"<{tag}{attributes}>{inside}</{tag}>" if inside else f"<{tag}{attributes}/>"


def made_up_xml(rng: Rng) -> str:
    """A robot from scratch: elements of a URDF in any order, with any attributes."""
    head = pick(rng, DOCTYPES) if rng.integers(6) == 0 else ""
    space = ' xmlns:xacro="http://www.ros.org/wiki/xacro"' if rng.integers(2) else ""
    parts = "".join(element(rng, 3) for _ in range(int(rng.integers(1, 12))))
    name = pick(rng, ("x", "alpha5", ""))
    return f'{head}<robot name="{name}"{space}>{parts}</robot>'


_JOINT_KINDS = (
    "revolute",
    "revolute",
    "revolute",
    "continuous",
    "fixed",
    "prismatic",
)
_BODY = (
    '<inertial><mass value="0.3"/><inertia ixx="1e-4" ixy="0" ixz="0" '
    'iyy="1e-4" iyz="0" izz="1e-4"/></inertial>'
)


def chain_of_joints(rng: Rng) -> str:
    """A readable URDF: a tree of links that turn, of any length and any axes."""
    count = int(rng.integers(1, 40))
    names = [f"axis_{x}" for x in "edcb"] if rng.integers(2) else []
    parts = ['<link name="l0"/>']
    for k in range(count):
        name = names[k] if k < len(names) else f"j{k}"
        parent = k if rng.integers(5) else int(rng.integers(k + 1))
        kind = pick(rng, _JOINT_KINDS)
        vectors = rng.normal(0, 0.3, (3, 3))
        xyz, rpy, axis = (" ".join(f"{x:.4g}" for x in row) for row in vectors)
        body = _BODY if rng.integers(2) else ""
        parts.append(
            f'<link name="l{k + 1}">{body}</link><joint name="{name}" type="{kind}">'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
            f'<parent link="l{parent}"/><child link="l{k + 1}"/>'
            '<limit lower="-1" upper="2" velocity="1" effort="9"/></joint>'
        )
    return f'<robot name="x">{"".join(parts)}</robot>'


def repeated(rng: Rng) -> str:
    """One short text again and again, up to 100 kB."""
    text = pick(rng, REPEATED)
    head = pick(rng, ("", "<robot>", "time_secs,axis_e_pos\n", "[axes]\n", "a = "))
    return head + text * int(rng.integers(1, 100_000 // len(text)))


def table_of_anything(rng: Rng) -> str:
    """A table with any names and any cells."""
    columns = int(rng.integers(1, 12))
    names = [
        "time_secs",
        *(f"axis_{x}_pos" for x in "edcb"),
        *TRAPS,
        "axis_b_vel",
        "",
        "a b",
    ]
    head = [pick(rng, names) for _ in range(columns)]
    if rng.integers(2):
        head[:5] = names[:5]
    cells = (
        "0",
        "1",
        "1.5",
        "nan",
        "inf",
        "",
        '"1"',
        '"',
        "1e308",
        "-0",
        "0x1",
        "1_0",
        *TRAPS[:4],
    )
    rows = []
    for k in range(int(rng.integers(0, 30))):
        row = [
            pick(rng, cells) if rng.integers(3) == 0 else f"{k * 0.1:.3f}" for _ in head
        ]
        rows.append(pick(rng, (",", ",", ",", ";", "\t")).join(row))
    return "\n".join([",".join(head), *rows])


def wide_table(rng: Rng) -> str:
    """A good table among thousands of columns."""
    more = int(rng.integers(1, 6000))
    names = [
        "time_secs",
        *(f"axis_{x}_pos" for x in "edcb"),
        *(f"c{k}" for k in range(more)),
    ]
    row = ["0"] * len(names)
    rows = [",".join([f"{k * 0.1:.1f}", *row[1:]]) for k in range(6)]
    return "\n".join([",".join(names), *rows])


def study_of_anything(rng: Rng, text: str) -> str:
    """A study with traps for values and keys of any sort."""
    lines = text.split("\n")
    values = (
        *(repr(trap) for trap in TRAPS[:24]),
        "[[[[]]]]",
        "{}",
        "1e400",
        "nan",
        "inf",
        "9" * 400,
        "2000-01-01",
        "true",
        "-1",
        "[" * 900,
        "{values = [1, 'a']}",
        "{from = 0, to = 1, count = 999999999999}",
        "{random = [0, 1]}",
        "'''x",
        '"""',
    )
    for _ in range(int(rng.integers(1, 4))):
        k = int(rng.integers(len(lines)))
        key, equals, _ = lines[k].partition("=")
        if equals and rng.integers(3):
            lines[k] = f"{key}= {pick(rng, values)}"
        else:
            name = pick(
                rng,
                (
                    "x",
                    "axis_e_pos",
                    "recordings",
                    "'a.b'",
                    "outputs",
                    "seed",
                    "samples",
                ),
            )
            lines.insert(k, f"{name} = {pick(rng, values)}")
    return "\n".join(lines)


def garbled(rng: Rng, content: bytes) -> bytes:
    """The bytes of a container, some of them changed, cut out or doubled."""
    raw = np.frombuffer(content, np.uint8).copy()
    for _ in range(int(rng.integers(1, 6))):
        start = int(rng.integers(len(raw) or 1))
        length = int(rng.integers(1, 64))
        way = int(rng.integers(5))
        if way < 2:
            raw[start : start + length] = rng.integers(
                0, 256, len(raw[start : start + length])
            )
        elif way == 2:
            raw[start : start + 8] = pick(rng, (0, 255, 127, 128))
        elif way == 3:
            raw = np.delete(raw, slice(start, start + length))
        else:
            raw = np.insert(raw, start, raw[start : start + length])
    if rng.integers(8) == 0:
        raw = raw[: int(rng.integers(len(raw) + 1))]
    return raw.tobytes()


#: Makes a URDF or xacro of the text of a valid one.
XML: tuple[Callable[[Rng, str], str], ...] = (
    trapped_xml,
    trapped_xml,
    trapped_xml,
    lambda rng, text: made_up_xml(rng),
    lambda rng, text: chain_of_joints(rng),
    lambda rng, text: repeated(rng),
)
TABLES: tuple[Callable[[Rng], str], ...] = (
    table_of_anything,
    table_of_anything,
    table_of_anything,
    wide_table,
    repeated,
)
