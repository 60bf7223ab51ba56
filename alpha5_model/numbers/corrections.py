"""Recorded corrections: every departure from the document's text, by name.

Published numbers are never changed silently. A correction is applied only when its name
is in the ``corrections`` that `alpha5_model.numbers.parameters` is given;
``corrections=()`` is the text to the letter.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from alpha5_model._support.checks import named


@dataclass(frozen=True)
class Correction:
    """A departure from the document.

    Attributes:
        name: Its name in ``corrections``.
        statement: What the document says, and what the correction says instead.
        evidence: Why the correction is right.
        effect: What it changes in the model.
    """

    name: str
    statement: str
    evidence: str
    effect: str


_RECORDED = Path(__file__).with_suffix(".toml").read_text("utf-8")
#: Every correction by its name.
CORRECTIONS = {
    name: Correction(name, **text) for name, text in tomllib.loads(_RECORDED).items()
}
#: Applied by default.
DEFAULT_CORRECTIONS: tuple[str, ...] = ("base_frame",)


def check_corrections(corrections: Iterable[str]) -> tuple[str, ...]:
    """The given corrections, in the order of the records, without repetition.

    Raises:
        InputError: Not a collection of names.
        UnknownNameError: A name that is not recorded.
    """
    return named("correction", corrections, tuple(CORRECTIONS))
