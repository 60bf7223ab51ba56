"""Changes of a URDF's text that name what they change, not the number that is there."""

from __future__ import annotations

import re
from pathlib import Path

import alpha5_model as a5

#: Our own arm, as it is committed.
OWN = Path(a5.URDF_PATH).read_text("utf-8")
_MASS = r'(<link name="{link}">(?:(?!</link>).)*?<mass value=")([^"]*)'


def mass_text(text: str, link: str = "link_2") -> str:
    """The text of a link's mass."""
    return _mass(text, link)[2]


def with_mass(text: str, value: str, link: str = "link_2") -> str:
    """The URDF with another text as a link's mass."""
    found = _mass(text, link)
    return text[: found.start(2)] + value + text[found.end(2) :]


def _mass(text: str, link: str) -> re.Match[str]:
    found = re.search(_MASS.format(link=link), text, re.DOTALL)
    assert found, f"{link} has no mass"
    return found
