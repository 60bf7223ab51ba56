"""Explain a wrong number: make the mistakes of the table until one gives it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.description.frames import fixed_frames, joint_placements
from alpha5_model.numbers.inertia import tensor_at_origin
from alpha5_model.numbers.jaws import loaded_links
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.document_revisions import Revision, revisions
from alpha5_model.proofs.comparison.mistakes import (
    FITTED,
    MISTAKES,
    PAIRED,
    Body,
    Case,
    Mistake,
    Part,
)
from alpha5_model.proofs.comparison.tolerance import Quantity, Tolerance

#: A frame whose pose differs by less in every entry was meant to be ours [m, rad].
SAME_FRAME = 2e-3


def _right(case: Case) -> list[Body]:
    return [case.right]


#: No mistake.
RIGHT = Mistake("", "", _right)
#: The right number with fewer digits than `MOST` asks for.
ROUNDED = Mistake("rounded", "rounded to too few digits", _right)


class Arm:
    """What the mistakes need of our arm.

    Attributes:
        record: Our arm.
        index: Which of its bodies is looked at.
        body: That body, in its link frame.
        tables: All its bodies.
        frames: Name of a frame of the arm -> transform_body_to_frame at zero, (4, 4).
    """

    def __init__(self, record: Alpha5Parameters, index: int) -> None:
        self.record = record
        self.index = index
        links = loaded_links(record)
        self.body = body_of(links[index])
        mass = np.array([link.mass for link in links])
        com = np.array([link.com for link in links])
        inertia = np.array([link.inertia for link in links])
        self.tables = Revision(
            numbers="",
            buoyancy_table="",
            mass=mass,
            com=com,
            inertia=inertia,
            inertia_link=tensor_at_origin(mass, com, inertia),
            volume=np.array([link.volume for link in links]),
            cob=np.array([link.cob for link in links]),
        )
        self.frames = _frames(record, index)


def body_of(link: RigidBody) -> Body:
    return Body(mass=link.mass, com=link.com, inertia=link.inertia)


def _frames(record: Alpha5Parameters, index: int) -> dict[str, FloatArray]:
    """Name of a frame of our arm -> transform_body_to_frame at zero, (4, 4)."""
    at = {"base_link": np.eye(4)}
    fixed = fixed_frames(record)
    placements = {"link_0": fixed.pop("link_0")}
    for k, placement in enumerate(joint_placements(record), start=1):
        placements[f"link_{k}"] = placement
    for name, placement in {**placements, **fixed}.items():
        at[name] = at[placement.parent] @ pose(placement.xyz, placement.rpy)
    at["dh_0"] = at["base_link"]
    body = at[f"link_{index}"]
    return {name: np.linalg.inv(frame) @ body for name, frame in at.items()}


class Attempt(NamedTuple):
    """Right numbers, and mistakes to make with them.

    Attributes:
        before: What is already wrong with these numbers; `RIGHT` if nothing.
        case: The numbers.
        mistakes: The mistakes.
    """

    before: Mistake
    case: Case
    mistakes: Sequence[Mistake]


def explained(
    attempts: Iterator[Attempt], part: Part, wrong: Mapping[Quantity, Tolerance]
) -> dict[Quantity, Mistake]:
    """The first mistake that gives each written number, for those that one gives."""
    found: dict[Quantity, Mistake] = {}
    for attempt in attempts:
        if len(found) == len(wrong):
            break
        made = []
        bodies = []
        for mistake in attempt.mistakes:
            for body in mistake.make(attempt.case):
                made.append(mistake)
                bodies.append(body)
        for quantity, tolerance in wrong.items():
            if quantity in found:
                continue
            numbers = np.array([getattr(body, quantity) for body in bodies])
            hits = tolerance.holds(numbers, getattr(part.body, quantity))
            # A mistake that leaves this number alone does not explain it.
            unchanged = getattr(attempt.case.right, quantity)
            for k in np.flatnonzero(hits):
                if made[k] is RIGHT or not np.array_equal(numbers[k], unchanged):
                    found[quantity] = _joined(attempt.before, made[k])
                    break
    return found


def attempts(arm: Arm, right: Body, part: Part) -> Iterator[Attempt]:
    """What may have been done with our numbers, those of both revisions, the fewest
    mistakes first.

    Args:
        arm: Our arm.
        right: What the link should say, in our link frame.
        part: The link.
    """
    frame = Mistake("other_frame", f"in a frame that is not link_{arm.index}'s", _right)
    elsewhere = np.abs(part.pose - np.eye(4)).max() > SAME_FRAME
    sources = [(RIGHT, arm.tables, right)]
    names = ("catalogue", "earlier_revision")
    for name, tables in zip(names, revisions(), strict=True):
        k = arm.index
        body = Body(float(tables.mass[k]), tables.com[k], tables.inertia[k])
        sources.append((Mistake(name, tables.numbers, _right), tables, body))

    by_count: list[list[tuple[Mistake, Case]]] = [[], [], []]
    for source, tables, body in sources:
        case = Case(
            index=arm.index,
            source=tables,
            right=body.at(part.to_link),
            in_ours=body,
            to_link=part.to_link,
            frames=arm.frames,
            written=part.body,
        )
        count = int(source is not RIGHT)
        by_count[count].append((source, case))
        if elsewhere:
            unmoved = replace(case, right=body, to_link=np.eye(4))
            by_count[count + 1].append((_joined(source, frame), unmoved))

    ours, one, two = by_count
    for before, case in ours:
        yield Attempt(before, case, MISTAKES)
    for before, case in (*one, *two):
        yield Attempt(before, case, (RIGHT,))
    for before, case in (*one, *two):
        yield Attempt(before, case, MISTAKES)
    for before, case in (*ours, *one):
        yield Attempt(before, case, FITTED)


def double_attempts(
    arm: Arm, right: Body, part: Part, quantities: Iterable[Quantity]
) -> Iterator[Attempt]:
    """Two mistakes with our numbers, the first of which changes one of some kind."""
    ours = next(attempts(arm, right, part)).case
    for first in PAIRED:
        for body in first.make(ours):
            changes = False
            for quantity in quantities:
                unchanged = getattr(ours.right, quantity)
                changes |= not np.array_equal(getattr(body, quantity), unchanged)
            if changes:
                case = replace(ours, right=body, in_ours=body.at(part.pose))
                yield Attempt(first, case, PAIRED)


def _joined(*mistakes: Mistake) -> Mistake:
    """Two mistakes as one; `RIGHT` is none."""
    named = [mistake for mistake in mistakes if mistake.id]
    if not named:
        return RIGHT
    return Mistake(
        id=".".join(mistake.id for mistake in named),
        words=", ".join(mistake.words for mistake in named),
        make=named[-1].make,
    )
