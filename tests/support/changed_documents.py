"""The audit of documents in which printed digits were changed."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import alpha5_model as a5
from alpha5_model.errors import ImplausibleWarning, InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters_from_tables
from alpha5_model.numbers.printed import parse
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.row import AuditRow

DATA = Path(a5.__file__).parent / "numbers"
DOCUMENT = (DATA / "reach_alpha_mk2_v7.toml").read_text("utf-8")
SUPPLEMENTARY = (DATA / "supplementary.toml").read_text("utf-8")

Part = Callable[[Published, Alpha5Parameters], list[AuditRow]]


def changed(text: str, old: str, new: str) -> str:
    """A text with other digits at one place."""
    assert text.count(old) == 1, old
    return text.replace(old, new)


def audit_of(
    part: Part, document: str = DOCUMENT, supplementary: str = SUPPLEMENTARY
) -> dict[str, AuditRow]:
    """The rows of a part of the audit, by claim."""
    printed = parse(document, supplementary)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)
            record = parameters_from_tables(printed, ("base_frame",))
    except InputError:  # no record holds the body that the audit is to judge
        record = a5.parameters()
    return {row.claim: row for row in part(printed, record)}
