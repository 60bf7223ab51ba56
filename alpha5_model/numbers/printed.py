"""Tables 1-4 verbatim, in printed units, each number with its source."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from alpha5_model.numbers.tables import Published

__all__ = ["published"]


def published() -> Published:
    """The manufacturer's tables as printed, in printed units, each with its source.

    Raises:
        PublishedDataError: A data file is malformed; the message names the place.
    """
    # Imported late, so that `import alpha5_model` stays light.
    from alpha5_model.numbers.reading import load

    return load()
