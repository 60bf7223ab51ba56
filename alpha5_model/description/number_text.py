"""Numbers in XML attributes and elements, with all their digits."""

from __future__ import annotations


def numbers_text(*values: float) -> str:
    """The values, separated by spaces, each so that it reads back as the same double."""
    return " ".join(repr(float(value)) for value in values)
