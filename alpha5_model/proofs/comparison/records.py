"""The result of a comparison: findings, bodies, and the whole."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.text import plain
from alpha5_model.numbers.inertia import principal_moments
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.tool import ToolDifference


@dataclass(frozen=True)
class Finding:
    """Something wrong or odd in the other model.

    Attributes:
        where: ``link_0`` to ``link_4``, ``axis_e`` to ``axis_b``, ``base``, ``volume``
            or a file.
        text: What is wrong.
        serious: Whether the models differ by it; otherwise it is a remark.
        cost: Largest gravity torque in air that it causes alone, over the sampled
            positions [N m]; 0 if it causes none.
        instead: What to write in its place; empty if there is nothing to write.
        id: Which finding it is, such as ``body.mass``; the same in every version.
    """

    where: str
    text: str
    serious: bool = True
    cost: float = 0.0
    instead: str = ""
    id: str = ""


@dataclass(frozen=True, eq=False)
class BodyDifference:
    """A body of the other model, expressed in our link frame.

    Attributes:
        name: ``link_0`` to ``link_4``.
        links: The other model's links that make it up.
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, (3, 3) [kg m^2].
        ours: The body of the tables.
        slack: How much of the COM's error comes from the rounded origins of joints [m].
    """

    name: str
    links: tuple[str, ...]
    mass: float
    com: FloatArray
    inertia: FloatArray
    ours: LinkParameters
    slack: float = 0.0

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


@dataclass(frozen=True, eq=False)
class Comparison:
    """Another model of this arm, compared with ours.

    Attributes:
        name: Its name.
        findings: The costliest first, then base to tip; empty if the models agree.
        joints: Ours -> theirs.
        alignment: Base, signs and zeros.
        bodies: Base to tip.
        tool: How far the tool is from ours, which frame of theirs it is, and in which
            of their frames it was measured; None for another arm.
        gravity_error: Largest difference of the gravity torque in air, per joint, (4,)
            [N m].
        mass_matrix_error: Largest difference of an entry of the mass matrix [kg m^2].
        volume: Volume of its collision primitives [m^3]; NaN if it has none.
        carried: Links that move with the base and are not the arm's -> mass [kg].
        against: Name of the arm of your own that it was compared with; empty for the
            catalogue's.

    Another arm has no joints and no bodies, its errors are NaN, and its one finding
    says why.
    """

    name: str
    findings: tuple[Finding, ...]
    joints: dict[str, str] = field(default_factory=dict)
    alignment: Alignment = field(default_factory=Alignment)
    bodies: tuple[BodyDifference, ...] = ()
    tool: ToolDifference | None = None
    gravity_error: FloatArray = field(default_factory=lambda: np.full(4, math.nan))
    mass_matrix_error: float = math.nan
    volume: float = math.nan
    carried: dict[str, float] = field(default_factory=dict)
    against: str = ""

    @property
    def tip_error(self) -> float:
        """Largest distance of the tools at the same joint positions [m]; see `tool`."""
        return math.nan if self.tool is None else float(self.tool.distance.max())

    @property
    def agrees(self) -> bool:
        """Nothing serious was found."""
        return not any(finding.serious for finding in self.findings)

    @property
    def verdict(self) -> str:
        """How the comparison ends, in one line."""
        if not self.joints:
            return self.findings[0].text
        serious = sum(finding.serious for finding in self.findings)
        if not serious:
            return f"The model agrees with {self.against or 'the tables'}."
        return f"The model differs: {serious} finding{'s' * (serious > 1)}."

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and texts, for JSON."""
        length, angle = self.alignment.residual
        own = {"against": self.against} if self.against else {}
        record: dict[str, Any] = plain(
            {
                "name": self.name,
                **own,
                "agrees": self.agrees,
                "verdict": self.verdict,
                "joints": self.joints,
                "base": self.alignment.base,
                "base_link": self.alignment.base_link,
                "carried_kg": self.carried,
                "sign": self.alignment.sign,
                "zero_rad": self.alignment.zero,
                "dimension_error": self.alignment.changes(),
                "residual_m": length,
                "residual_rad": angle,
                "tip_error_m": self.tip_error,
                "tool": None if self.tool is None else self.tool.as_dict(),
                "gravity_error_Nm": self.gravity_error,
                "mass_matrix_error_kgm2": self.mass_matrix_error,
                "volume_m3": self.volume,
                "bodies": [body.as_dict() for body in self.bodies],
                "findings": [_told(finding) for finding in self.findings],
            }
        )
        return record


def _told(finding: Finding) -> dict[str, Any]:
    """A finding, for JSON."""
    return {
        "id": finding.id,
        "where": finding.where,
        "text": finding.text,
        "serious": finding.serious,
        "cost_Nm": finding.cost,
        "instead": finding.instead,
    }
