"""The audit of documents in which printed digits were changed."""

from __future__ import annotations

import json
import tomllib
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

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


def changed(text: str, place: str, new: Any) -> str:
    """The text of a file with another value at one place.

    The place is named, not its present digits: a corrected digit of the document
    leaves such a test alone, even if it is the new value already.

    Args:
        text: TOML.
        place: Keys and numbers of rows, for example ``table_2.rows.1.mass``.
        new: A text, or lists of texts.
    """
    document = tomllib.loads(text)
    *steps, last = [int(step) if step.isdigit() else step for step in place.split(".")]
    table: Any = document
    for step in steps:
        table = table[step]
    table[last] = new
    return "".join(f"{name} = {_toml(value)}\n" for name, value in document.items())


def _toml(value: Any) -> str:
    """A value of TOML in one line."""
    if isinstance(value, dict):
        return f"{{{', '.join(f'{k} = {_toml(v)}' for k, v in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value, ensure_ascii=False)


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
