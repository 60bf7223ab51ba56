"""What a URDF has that programs take differently: doubled elements, macros, numbers.

Limits and inertias are judged from the records; this is what the records do not show.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from contextlib import suppress

from alpha5_model.description.urdf_robot import Remark

#: Element -> its children that may be there only once.
_ONCE = {
    "link": ("inertial",),
    "inertial": ("origin", "mass", "inertia"),
    "visual": ("origin", "geometry", "material"),
    "collision": ("origin", "geometry"),
    "material": ("color",),
    "joint": ("origin", "parent", "child", "axis", "limit", "dynamics", "mimic"),
}
#: Elements whose attributes are single numbers.
_SCALARS = ("mass", "inertia", "limit", "dynamics", "mimic")


def remarks_of(top: ET.Element, lines: Mapping[ET.Element, int]) -> Iterator[Remark]:
    """What programs take differently in a URDF.

    Args:
        top: The ``<robot>``.
        lines: Element -> the line where it begins.
    """
    for owner in top:
        is_part = owner.tag in ("link", "joint")
        where = owner.get("name", "") if is_part else "robot"
        for element in owner.iter():
            for kind, text, place in _of_element(element, is_part):
                yield Remark(kind=kind, where=where, text=text, line=lines[place])


def _of_element(
    element: ET.Element, is_part: bool
) -> Iterator[tuple[str, str, ET.Element]]:
    """Kind, text and place of what readers take differently in an element.

    Args:
        element: Any element.
        is_part: Whether it belongs to a link or a joint.
    """
    if element.tag.startswith("xacro:"):
        yield "macro", f"<{element.tag}>", element
        return
    for value in element.attrib.values():
        if is_macro(value):
            yield "expression", value, element
    if not is_part:
        return

    for tag in _ONCE.get(element.tag, ()):
        for again in element.findall(tag)[1:]:
            yield "doubled", tag, again
    if element.tag in _SCALARS:
        for name, value in element.attrib.items():
            unread = value != value.rstrip() or "inf" in value.lower()
            if unread and floats(value):
                yield "number", f"<{element.tag} {name}={value!r}>", element
    if element.tag == "geometry":
        for again in element[1:]:
            yield "shapes", again.tag, again
    if element.tag == "capsule":
        yield "capsule", "capsule", element
    if element.tag == "origin":
        *axis, _ = floats(element.get("quat_xyzw", "")) or [0.0]
        if any(axis):
            yield "quaternion", element.get("quat_xyzw", ""), element


def is_macro(text: str) -> bool:
    """Whether a text has an expression of xacro."""
    return "${" in text or "$(" in text


def floats(text: str) -> list[float]:
    """The numbers of a text; none if one of them is not a number for URDF readers."""
    # Python also reads digits of other scripts, and 1_000.
    if text.isascii() and "_" not in text:
        with suppress(ValueError):
            return [float(part) for part in text.split()]
    return []
