"""Changes of a URDF's text that name what they change, not the number that is there."""

from __future__ import annotations

import re

_MASS = r'(<link name="{link}">(?:(?!</link>).)*?<mass value=")([^"]*)'


def mass_text(urdf: str, link: str = "link_2") -> str:
    """The text of a link's mass."""
    return _mass(urdf, link)[2]


def with_mass(urdf: str, value: str, link: str = "link_2") -> str:
    """The URDF with another text as a link's mass."""
    found = _mass(urdf, link)
    return urdf[: found.start(2)] + value + urdf[found.end(2) :]


def _mass(urdf: str, link: str) -> re.Match[str]:
    found = re.search(_MASS.format(link=link), urdf, re.DOTALL)
    assert found, f"{link} has no mass"
    return found
