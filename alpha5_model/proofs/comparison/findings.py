"""Findings in words: the texts of ``findings.toml``, filled in with figures."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import choice
from alpha5_model.proofs.comparison.records import Finding

#: Topic -> its texts, and those of its subjects.
FINDINGS: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text("utf-8")
)


def finding(key: str, *, where: str = "", cost: float = 0.0, **words: Any) -> Finding:
    """A finding in the words of ``findings.toml``.

    Args:
        key: ``topic`` or ``topic.subject`` there.
        where: The link, joint or file that it is about, unless the texts name it.
        cost: Gravity torque that it causes alone [N m].
        words: Names in the texts -> values.
    """
    topic, _, subject = key.partition(".")
    shared = FINDINGS[topic]
    entry = {"where": where, **shared, **shared.get(subject, {}), **words}
    return Finding(
        where=entry["where"],
        text=entry.get("text", "").format_map(entry),
        serious=entry.get("serious", True),
        cost=cost,
        instead=entry.get("instead", "").format_map(entry),
        id=key,
    )


def finding_ids() -> tuple[str, ...]:
    """The ids of all findings: ``topic`` or ``topic.subject``."""
    ids = []
    for topic, shared in FINDINGS.items():
        if "text" in shared:
            ids.append(topic)
        ids += [
            f"{topic}.{name}" for name, own in shared.items() if isinstance(own, dict)
        ]
    return tuple(ids)


def explanation(key: str) -> str:
    """What a finding means and what to do, in a few sentences.

    Args:
        key: Its id.

    Raises:
        UnknownNameError: No such finding.
    """
    topic, _, subject = choice("finding", key, finding_ids()).partition(".")
    shared = FINDINGS[topic]
    own = shared.get(subject, {})
    explained: str = own.get("explain", shared["explain"])
    return explained
