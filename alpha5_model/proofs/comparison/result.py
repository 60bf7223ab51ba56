"""The result of a comparison: findings with their corrections, bodies, the whole."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.text import plain
from alpha5_model.numbers.inertia import principal_moments
from alpha5_model.numbers.parameters import LinkParameters

#: Topic -> its texts, and those of its subjects.
FINDINGS: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("findings.toml").read_text("utf-8")
)


@dataclass(frozen=True)
class Correction:
    """What to write in a joint or a link of the other file.

    Attributes:
        kind: ``joint`` or ``link``.
        name: Its name.
        elements: Tag of an element -> its attributes, as text. An element keeps the
            attributes that are not named. None in place of the attributes: the element
            has to go. The tag ``joint`` is the joint itself; ``mass``, ``origin`` and
            ``inertia`` of a link are those of its ``<inertial>``.
    """

    kind: str
    name: str
    elements: Mapping[str, Mapping[str, str] | None]

    @property
    def text(self) -> str:
        """The elements as URDF, after the name of the joint or link."""
        shown = []
        for tag, attributes in self.elements.items():
            if attributes is None:
                shown.append(f"no <{tag}>")
                continue
            words = [f'{name}="{value}"' for name, value in attributes.items()]
            end = ">" if tag == "joint" else "/>"
            shown.append(f"<{' '.join([tag, *words])}{end}")
        return f"{self.name}: {' '.join(shown)}"


@dataclass(frozen=True)
class Finding:
    """Something wrong or odd in the other model.

    Attributes:
        id: Which finding it is, such as ``body.mass``; the same in every version.
        where: ``link_0`` to ``link_4``, ``axis_e`` to ``axis_b``, ``base``, ``tool``,
            ``volume``, or the joint, link or file that it is about.
        text: What is wrong.
        serious: Whether the models differ by it; otherwise it is a remark.
        cost: Largest gravity torque in air that it causes alone, over the sampled
            positions [N m]; 0 if it causes none.
        corrections: What to write in the file instead.
    """

    id: str
    where: str
    text: str
    serious: bool = True
    cost: float = 0.0
    corrections: tuple[Correction, ...] = ()

    @property
    def instead(self) -> str:
        """The corrections as URDF, in one line; empty if there is nothing to write."""
        return "; ".join(correction.text for correction in self.corrections)

    def as_dict(self) -> dict[str, Any]:
        """The finding, for JSON."""
        return {
            "id": self.id,
            "where": self.where,
            "text": self.text,
            "serious": self.serious,
            "cost_Nm": self.cost,
            "instead": self.instead,
            "corrections": [
                {"kind": one.kind, "name": one.name, "elements": plain(one.elements)}
                for one in self.corrections
            ],
        }


def finding(
    key: str,
    where: str = "",
    *,
    cost: float = 0.0,
    corrections: Sequence[Correction | None] = (),
    **values: Any,
) -> Finding:
    """A finding in the words of ``findings.toml``.

    Args:
        key: ``topic`` or ``topic.subject`` there: the finding's id.
        where: The link, joint or file that it is about, unless the texts name it.
        cost: Gravity torque that it causes alone [N m].
        corrections: What to write in the file; those that are None are left out.
        values: Names in the text -> what is put there.
    """
    topic, _, subject = key.partition(".")
    shared = FINDINGS[topic]
    entry = {"where": where, **shared, **shared.get(subject, {}), **values}
    return Finding(
        id=key,
        where=entry["where"],
        text=entry["text"].format_map(entry),
        serious=entry.get("serious", True),
        cost=cost,
        corrections=tuple(one for one in corrections if one is not None),
    )


def finding_ids() -> tuple[str, ...]:
    """The ids of all findings: ``topic`` or ``topic.subject``."""
    ids = []
    for topic, shared in FINDINGS.items():
        if "text" in shared:
            ids.append(topic)
        subjects = [name for name, own in shared.items() if isinstance(own, dict)]
        ids += [f"{topic}.{name}" for name in subjects]
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


@dataclass(frozen=True, eq=False)
class BodyDifference:
    """A body of the other model, expressed in our link frame.

    Attributes:
        name: ``link_0`` to ``link_4``.
        links: The other model's links that make it up.
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, (3, 3) [kg m^2].
        ours: The body of the tables, or of the arm that it is compared with.
    """

    name: str
    links: tuple[str, ...]
    mass: float
    com: FloatArray
    inertia: FloatArray
    ours: LinkParameters

    @property
    def mass_error(self) -> float:
        """Theirs minus ours [kg]."""
        return self.mass - self.ours.mass

    @property
    def com_error(self) -> float:
        """Distance of the COMs [m]; NaN for a body without mass, which has none."""
        if not self.mass:
            return math.nan
        return float(np.linalg.norm(self.com - self.ours.com))

    @property
    def inertia_error(self) -> float:
        """Largest entry of the difference of the tensors [kg m^2]."""
        return float(np.abs(self.inertia - self.ours.inertia).max())

    def as_dict(self) -> dict[str, Any]:
        """Both sides and their difference, for JSON."""
        record: dict[str, Any] = plain(
            {
                "name": self.name,
                "links": self.links,
                **_side(self),
                "ours": _side(self.ours),
                "mass_error_kg": self.mass_error,
                "com_error_m": self.com_error,
                "inertia_error_kgm2": self.inertia_error,
            }
        )
        return record


def _side(body: BodyDifference | LinkParameters) -> dict[str, Any]:
    """The numbers of one side, for JSON."""
    return {
        "mass_kg": body.mass,
        "com_m": body.com if body.mass else None,
        "inertia_kgm2": body.inertia,
        "principal_moments_kgm2": principal_moments(body.inertia),
    }
