"""The result of a comparison: findings with their corrections, bodies, the whole."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice
from alpha5_model._support.text import plain
from alpha5_model.numbers.inertia import principal_moments
from alpha5_model.numbers.parameters import LinkParameters

if TYPE_CHECKING:
    from alpha5_model.proofs.comparison.described import Described

#: Topic -> its texts, and those of its subjects.
FINDINGS: dict[str, dict[str, Any]] = tomllib.loads(
    Path(__file__).with_name("findings.toml").read_text("utf-8")
)

#: How many names a text lists.
NAMED = 3


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
        return f"{self.name}: {self.written}"

    @property
    def written(self) -> str:
        """The elements as URDF."""
        shown = []
        for tag, attributes in self.elements.items():
            if attributes is None:
                shown.append(f"no <{tag}>")
                continue
            words = [f'{name}="{value}"' for name, value in attributes.items()]
            end = ">" if tag == "joint" else "/>"
            shown.append(f"<{' '.join([tag, *words])}{end}")
        return " ".join(shown)


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
        mistake: Id of the mistake that explains it, of `mistakes` or `joint_mistakes`,
            such as ``i_link``; empty if none does.
    """

    id: str
    where: str
    text: str
    serious: bool = True
    cost: float = 0.0
    corrections: tuple[Correction, ...] = ()
    mistake: str = ""

    @property
    def instead(self) -> str:
        """The corrections as URDF, in one line; empty if there is nothing to write.

        Of more than three that write the same, three are named.
        """
        names: dict[str, list[str]] = {}
        for correction in self.corrections:
            names.setdefault(correction.written, []).append(correction.name)
        if all(len(same) <= NAMED for same in names.values()):
            return "; ".join(correction.text for correction in self.corrections)
        return "; ".join(f"{some_names(same)}: {to}" for to, same in names.items())

    def as_dict(self) -> dict[str, Any]:
        """The finding, for JSON."""
        return {
            "id": self.id,
            "where": self.where,
            "text": self.text,
            "mistake": self.mistake,
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
    mistake: str = "",
    **values: Any,
) -> Finding:
    """A finding in the words of ``findings.toml``.

    Args:
        key: ``topic`` or ``topic.subject`` there: the finding's id.
        where: The link, joint or file that it is about, unless the texts name it.
        cost: Gravity torque that it causes alone [N m].
        corrections: What to write in the file; those that are None are left out.
        mistake: Id of the mistake that explains it.
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
        mistake=mistake,
    )


def some_names(names: Sequence[str]) -> str:
    """The first of some names, and how many there are."""
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def differing_texts(one: float, other: float, digits: int = 4) -> tuple[str, str]:
    """Two numbers with the fewest significant digits that show their difference.

    Args:
        one, other: The numbers.
        digits: How many digits they have at least.
    """
    texts = (f"{one:.{digits}g}", f"{other:.{digits}g}")
    shown = float(texts[0]) - float(texts[1])
    if abs(shown - (one - other)) <= 0.1 * abs(one - other) or digits >= 17:
        return texts
    return differing_texts(one, other, digits + 1)


def place_text(shift: float, turned: float) -> str:
    """How far a frame is from ours, without what is zero in print.

    Args:
        shift: [m].
        turned: [rad].
    """
    millimetres = round(shift * 1e3, 2)
    degrees = round(math.degrees(turned), 2)
    if not degrees:
        return f"{millimetres:g} mm from ours"
    if not millimetres:
        return f"turned by {degrees:g} deg from ours"
    return f"{millimetres:g} mm from ours, turned by {degrees:g} deg"


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
    explained: str = own.get("explain") or shared["explain"]
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


@dataclass(frozen=True, eq=False)
class ToolDifference:
    """How far the other model's tool is from ours, in base_link, at random positions.

    Attributes:
        frame: Name of their tool link. Empty if they have none: then the point of their
            wrist was measured where Table 1's {5} would be.
        base: Name of their link that was taken for base_link. Empty if none was meant
            to be: then the joint axes place the base.
        offset, turned: How far their frame is from ours in link_4 [m] and [rad]; 0 if
            they have none.
        distance: At the same joint positions, (N,) [m].
        angle: At the same joint positions, (N,) [rad].
        matched_distance: At corresponding joint positions, with signs and zeros
            matched, (N,) [m].
        matched_angle: At corresponding joint positions, (N,) [rad].
    """

    frame: str
    base: str
    offset: float
    turned: float
    distance: FloatArray
    angle: FloatArray
    matched_distance: FloatArray
    matched_angle: FloatArray

    def as_dict(self) -> dict[str, Any]:
        """The largest values, and the median of the distance, for JSON."""
        return {
            "frame": self.frame,
            "base": self.base,
            "offset_m": self.offset,
            "turned_rad": self.turned,
            "distance_m": self.distance.max(),
            "median_distance_m": np.median(self.distance),
            "angle_rad": self.angle.max(),
            "matched_distance_m": self.matched_distance.max(),
            "matched_angle_rad": self.matched_angle.max(),
        }


@dataclass(frozen=True, eq=False)
class Comparison:
    """Another model of this arm, compared with ours.

    Attributes:
        name: Its name.
        findings: The costliest first, then base to tip; empty if the models agree.
        joints: Ours -> theirs.
        alignment: Base, signs, zeros and dimensions; None for another arm.
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
    alignment: Described | None = None
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
        """Nothing serious was found: joints and bodies are ours.

        A tool frame at another point of the gripper is a choice, and part of the
        verdict.
        """
        return not any(one.serious for one in self.findings)

    @property
    def verdict(self) -> str:
        """How the comparison ends, in one line."""
        if not self.joints:
            return self.findings[0].text
        serious = sum(one.serious for one in self.findings)
        if serious:
            return f"The model differs: {serious} finding{'s' * (serious > 1)}."
        agrees = f"The model agrees with {self.against or 'the tables'}"
        if self.tool and any(one.id == "tool.choice" for one in self.findings):
            off = place_text(self.tool.offset, self.tool.turned)
            return f"{agrees}, but its {self.tool.frame} is {off}."
        return f"{agrees}."

    def as_dict(self) -> dict[str, Any]:
        """Everything as plain numbers and texts, for JSON."""
        own = {"against": self.against} if self.against else {}
        alignment = {} if self.alignment is None else self.alignment.as_dict()
        record: dict[str, Any] = plain(
            {
                "name": self.name,
                **own,
                "agrees": self.agrees,
                "verdict": self.verdict,
                "joints": self.joints,
                **alignment,
                "carried_kg": self.carried,
                "tip_error_m": self.tip_error,
                "tool": None if self.tool is None else self.tool.as_dict(),
                "gravity_error_Nm": self.gravity_error,
                "mass_matrix_error_kgm2": self.mass_matrix_error,
                "volume_m3": self.volume,
                "bodies": [body.as_dict() for body in self.bodies],
                "findings": [one.as_dict() for one in self.findings],
            }
        )
        return record
