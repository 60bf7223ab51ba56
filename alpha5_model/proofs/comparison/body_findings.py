"""What is wrong with a body, what it costs, and what to write instead."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.inertia import inconsistencies
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.body_replacement import (
    Replacement,
    replacement_of,
)
from alpha5_model.proofs.comparison.diagnosis import (
    Explain,
    explain_com,
    explain_inertia,
    explain_mass,
    reason,
)
from alpha5_model.proofs.comparison.evidence import Evidence
from alpha5_model.proofs.comparison.findings import finding
from alpha5_model.proofs.comparison.guesses import explain_guess
from alpha5_model.proofs.comparison.hypotheses import BodyHypotheses, hypotheses_of
from alpha5_model.proofs.comparison.inertials import TOKEN_MASS, Inertial
from alpha5_model.proofs.comparison.placement import body_transforms, mended_transforms
from alpha5_model.proofs.comparison.poses import carried_to
from alpha5_model.proofs.comparison.records import BodyDifference, Finding

#: Smaller differences from the tables are no findings: a model may print fewer digits.
MASS_TOLERANCE = 1e-3  # of the mass
COM_TOLERANCE = 1e-4  # [m]
INERTIA_TOLERANCE = 5e-3  # of the largest moment
#: The arm stretched out, base to finger tips: no part of it is larger.
REACH = 0.6  # [m]
#: Index of the last body.
WRIST = 4

#: Index of a body, errors of its mass [kg] and of its first moment (3,) [kg m] -> the
#: gravity torque that they cause [N m].
Cost = Callable[[int, float, FloatArray], float]


@dataclass(frozen=True, eq=False)
class BodyCase:
    """A body of the other model, and everything that the findings need of it.

    Attributes:
        body: The body, compared with the tables.
        known: The numbers that known mistakes make of the tables'.
        written: The inertials that its links write.
        bare: Names of its links without an inertial.
        instead: What to write in their place.
        cost: Gravity torque that errors cause.
    """

    body: BodyDifference
    known: BodyHypotheses
    written: Sequence[Inertial]
    bare: Sequence[str]
    instead: Replacement
    cost: Cost

    @property
    def ours(self) -> LinkParameters:
        """The body of the tables."""
        return self.body.ours

    @property
    def mass_cost(self) -> float:
        """Gravity torque that the error of its mass causes [N m]."""
        error = self.body.mass_error
        return self.cost(self.known.body, error, error * self.ours.com)

    def why(self, explain: Explain) -> str:
        """Why a number of the body is wrong, in words; empty if nothing explains it."""
        return reason(self.known, self.written, explain)


def findings_of_bodies(evidence: Evidence) -> Iterator[Finding]:
    """What is wrong with the bodies, base to tip."""
    transforms = body_transforms(evidence.ours, evidence.theirs, evidence.alignment)
    mended = mended_transforms(evidence.ours, evidence.theirs, evidence.alignment)
    mended_coms, _ = carried_to(mended, evidence.theirs.com, evidence.theirs.inertia)
    regressor = evidence.ours.reduced.gravity_regressor(evidence.q)

    def cost(body: int, mass: float, first_moment: FloatArray) -> float:
        if body == 0:  # no joint carries the base
            return 0.0
        torques = regressor[:, :, body - 1] @ [mass, *first_moment]
        return float(np.abs(torques).max())

    for index, body in enumerate(evidence.bodies):
        case = BodyCase(
            body=body,
            known=hypotheses_of(evidence.ours, index),
            written=_written(evidence, body, transforms[index]),
            bare=_bare_links(evidence, body),
            instead=replacement_of(body.ours, _written(evidence, body, mended[index])),
            cost=cost,
        )
        found = list(findings_of_body(case))
        yield from found
        if not any("<origin" in one.instead for one in found):
            yield from _rounded(case, mended_coms[index])


def _written(
    evidence: Evidence, body: BodyDifference, transform: FloatArray
) -> list[Inertial]:
    """The inertials that the links of a body write.

    Args:
        evidence: Both arms.
        body: The body.
        transform: transform_theirs_to_ours of its frame, (4, 4).
    """
    written = []
    for name in body.links:
        link = evidence.other.links[name]
        written.append(
            Inertial(
                link=link.name,
                mass=link.mass or 0.0,
                com=link.com,
                inertia=link.inertia,
                pose=transform @ evidence.theirs.link_poses[name],
            )
        )
    return written


def _bare_links(evidence: Evidence, body: BodyDifference) -> list[str]:
    """Names of the links of a body without an inertial.

    KDL allows none on the root, so the root counts only if the body has no mass at all.
    """
    links = evidence.other.links
    bare = [name for name in body.links if links[name].mass is None]
    if body.mass:
        bare = [name for name in bare if name != evidence.other.root]
    return bare


def _rounded(case: BodyCase, mended_com: FloatArray) -> Iterator[Finding]:
    """A COM that will be off after the joints are corrected.

    Args:
        case: The body.
        mended_com: Its COM in our link frame after that, (3,) [m].
    """
    off = float(np.linalg.norm(mended_com - case.ours.com))
    if case.body.mass and off > COM_TOLERANCE:
        yield finding(
            "digits.of_body",
            where=case.body.name,
            off=off * 1e3,
            line=case.instead.com,
        )


def findings_of_body(case: BodyCase) -> Iterator[Finding]:
    """What is wrong with one body."""
    name = case.body.name
    yield from _dummies(name, case.written)
    if not case.written:
        yield finding("body.missing", where=name, cost=case.mass_cost)
        return
    if case.body.mass == 0.0:
        yield _without_mass(case)
        return
    if case.bare:
        yield finding("body.partly", where=name, links=", ".join(case.bare))

    wrong = [*_wrong_mass(case), *_wrong_com(case), *_wrong_inertia(case)]
    yield from wrong
    if wrong:
        yield from _impossible(case)


def _dummies(name: str, written: Sequence[Inertial]) -> Iterator[Finding]:
    """Links whose inertia is far too large for their mass, equal ones together."""
    equal: dict[tuple[float, float], list[str]] = {}
    for link in written:
        largest = float(np.abs(link.inertia).max())
        if link.mass > 0 and largest / link.mass > REACH**2:
            equal.setdefault((link.mass, largest), []).append(link.link)

    for (mass, largest), links in equal.items():
        several = len(links) > 1
        # A heavy dummy needs a tensor, a light one needs none: two findings.
        yield finding(
            "dummy" if mass <= TOKEN_MASS else "dummy.heavy",
            where=name,
            links=", ".join(links),
            s="s" if several else "",
            have="have" if several else "has",
            grams=mass * 1e3,
            inertia=largest,
            radius=math.sqrt(largest / mass),
        )


def _without_mass(case: BodyCase) -> Finding:
    """A body without mass, or without any inertial."""
    mass, com, _ = case.instead
    _, _, com_elements = com.partition(": ")
    return finding(
        "body.without_inertial" if case.bare else "body.without_mass",
        where=case.body.name,
        cost=case.mass_cost,
        links=", ".join(case.bare),
        ours=case.ours.mass,
        tag=mass,
        everything=mass if mass == com else f"{mass} {com_elements}",
    )


def _wrong_mass(case: BodyCase) -> Iterator[Finding]:
    """A mass that is not that of the tables."""
    mass = case.body.mass
    ours = case.ours.mass
    is_wrong = abs(case.body.mass_error) > MASS_TOLERANCE * ours
    if not is_wrong:
        return
    words = case.why(explain_mass) or f" ({mass / ours:.3g} times)"
    if case.known.body == WRIST and "; beside it" in words:
        words += ": the jaws are counted twice"
    yield finding(
        "body.mass",
        where=case.body.name,
        cost=case.mass_cost,
        mass=mass,
        ours=ours,
        reason=words,
        tag=case.instead.mass,
    )


def _wrong_com(case: BodyCase) -> Iterator[Finding]:
    """A COM that is not that of the tables."""
    body = case.body
    is_wrong = body.com_error > COM_TOLERANCE + body.slack
    if not is_wrong:
        return
    index = case.known.body
    beyond = index == WRIST and body.com[2] > 0
    first_moment = case.ours.mass * (body.com - case.ours.com)
    yield finding(
        "body.com_beyond" if beyond else "body.com",
        where=body.name,
        cost=case.cost(index, 0.0, first_moment),
        off=body.com_error * 1e3,
        z=body.com[2] * 1e3,
        reason=case.why(explain_com),
        tag=case.instead.com,
    )


def _wrong_inertia(case: BodyCase) -> Iterator[Finding]:
    """A tensor that is not that of the tables."""
    body = case.body
    ours = case.ours.inertia
    is_wrong = body.inertia_error > INERTIA_TOLERANCE * np.abs(ours).max()
    if not is_wrong:
        return
    words = case.why(explain_inertia)
    if not words:
        guess = explain_guess(case.ours, case.written)
        words = f": {guess}" if guess else ""
    is_wrist = case.known.body == WRIST
    yield finding(
        "body.inertia_of_wrist" if is_wrist else "body.inertia",
        where=body.name,
        times=np.diag(body.inertia) / np.diag(ours),
        reason=words,
        tag=case.instead.inertia,
    )


def _impossible(case: BodyCase) -> Iterator[Finding]:
    """What makes the body physically impossible."""
    ours = case.ours
    body = case.body
    # One body of Table 2 breaks its own bounds: the other model may do so, too.
    ours_breaks = inconsistencies(ours.mass, ours.com, ours.inertia, ours.bounds)
    bounds = None if ours_breaks else ours.bounds
    for problem in inconsistencies(body.mass, body.com, body.inertia, bounds):
        yield finding("body.impossible", where=body.name, problem=problem)
