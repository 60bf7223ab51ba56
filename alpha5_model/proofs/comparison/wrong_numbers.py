"""Which numbers of another model's body are wrong, and which mistake gives them.

Numbers are compared in the frame of the link that says them, because there they were
typed. A wrong one is explained by making the mistakes of the table until one gives it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose
from alpha5_model.description.frames import fixed_frames, joint_placements
from alpha5_model.errors import InputError
from alpha5_model.numbers.inertia import combine, inconsistencies, tensor_at_origin
from alpha5_model.numbers.jaws import loaded_links, split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody
from alpha5_model.proofs.comparison.document_revisions import Revision, revisions
from alpha5_model.proofs.comparison.mistakes import (
    FITTED,
    MISTAKES,
    Body,
    Case,
    Mistake,
    Part,
)
from alpha5_model.proofs.comparison.tolerance import (
    MOST,
    Digits,
    Quantity,
    Tolerance,
)

#: Of more links that make up a body, the lightest ones are taken to be right.
MOST_PARTS = 12
#: Wrist, rod and two fingers.
JAW_BODIES = 4
#: A frame whose pose differs by less in every entry was meant to be ours [m, rad].
SAME_FRAME = 2e-3


class WrongNumber(NamedTuple):
    """A number of a link that has to be changed.

    Attributes:
        link: The link of the other model.
        quantity: ``mass``, ``com`` or ``inertia``.
        mistake: What gives the written number; None if nothing in the table does.
        right: What the link should say, in its own frame: our body less the other
            links that make it up. A mass of 0 means that its inertial has to go.
    """

    link: str
    quantity: Quantity
    mistake: Mistake | None
    right: Body


def wrong_numbers(
    record: Alpha5Parameters, index: int, parts: Sequence[Part], digits: Digits
) -> list[WrongNumber]:
    """What the links of a body say wrong, each number with the mistake that gives it.

    If several links make up the body, as few numbers as possible are taken to be wrong,
    and rather those that a mistake explains.

    Args:
        record: Our arm.
        index: Which of its bodies: 0 for link_0 to 4 for link_4.
        parts: The links that make it up, without those that the user is told to empty
            (dummies, vehicles).
        digits: Of the file.

    Returns:
        Empty if the body agrees to the digits of the file.
    """
    arm = Arm(record, index)
    heaviest = sorted(parts, key=lambda part: -abs(part.body.mass))
    solid = [part for part in heaviest if part.body.mass or part.body.inertia.any()]
    heaviest = solid or heaviest[:1]  # frames without a body are no parts
    options = list(_options(arm, heaviest, digits))
    if [] in options:
        return []
    whole = _whole_in_one(arm, heaviest, digits)
    if whole is not None:
        return _too_many([part for part in heaviest if part is not whole])
    if len(_jaws(arm, heaviest)) == JAW_BODIES:
        wrong = options[0]  # each body is compared with its own
    elif options:
        wrong = min(options, key=_unlikely)
    else:
        # Too much is there: the heaviest link is the body, and the others have no mass.
        wrong = _wrong_in_link(arm, arm.body, heaviest[:1], 0, digits)
        wrong += _too_many(heaviest[1:])
    if len(heaviest) > 1 and not all(number.mistake for number in wrong):
        wrong = _explained_as_whole(arm, heaviest, wrong, digits)
    return wrong


def _options(
    arm: Arm, parts: Sequence[Part], digits: Digits
) -> Iterator[list[WrongNumber]]:
    """What may be wrong: numbers of one of the links, or of opened jaws."""
    jaws = _jaws(arm, parts)
    if len(jaws) == JAW_BODIES:
        found = []
        for place, part in enumerate(parts):
            if part.link in jaws:
                found += _wrong_in_link(arm, jaws[part.link], parts, place, digits)
        yield found + _too_many([part for part in parts if part.link not in jaws])
    for place, part in enumerate(parts[:MOST_PARTS]):
        others = [other.body.at(other.pose) for other in parts if other is not part]
        rest = _less(arm.body, others)
        if rest is not None:
            yield _wrong_in_link(arm, rest, parts, place, digits)


def _whole_in_one(arm: Arm, parts: Sequence[Part], digits: Digits) -> Part | None:
    """The link that alone is the whole body, beside links that are none of ours."""
    if len(parts) == 1 or len(_jaws(arm, parts)) > 1:
        return None
    for part in parts[:MOST_PARTS]:
        if not _wrong_in_link(arm, arm.body, [part], 0, digits):
            return part
    return None


def _too_many(parts: Iterable[Part]) -> list[WrongNumber]:
    """Links whose mass has to go."""
    nothing = Body(mass=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))
    return [WrongNumber(part.link, "mass", None, nothing) for part in parts]


def _unlikely(wrong: Sequence[WrongNumber]) -> int:
    """A count of wrong numbers: those that no mistake explains count twice.

    A fitted mistake fits more than one link, so it counts as one and a half.
    """
    fitted = [mistake.id for mistake in FITTED]
    score = 0
    for number in wrong:
        score += 4
        if number.mistake:
            score -= 1 if number.mistake.id.split(".")[-1] in fitted else 2
    return score


def _less(whole: Body, others: Sequence[Body]) -> Body | None:
    """A body without some of its parts, all in one frame; None if none remains."""
    if not others:
        return whole
    masses = [whole.mass, *(-body.mass for body in others)]
    if np.sum(masses) <= 0:
        return None
    coms = [whole.com, *(body.com for body in others)]
    inertias = [whole.inertia, *(-body.inertia for body in others)]
    mass, com, inertia = combine(masses, coms, inertias)
    if inconsistencies(mass, com, inertia):
        return None
    return Body(mass=mass, com=com, inertia=inertia)


def _jaws(arm: Arm, parts: Sequence[Part]) -> dict[str, Body]:
    """The links that stand where our wrist, rod and fingers do -> ours, in link_4."""
    if arm.index != 4:
        return {}
    try:
        jaws = split_link_4(arm.record)
    except InputError:  # the arm's link_4 leaves no possible wrist
        return {}
    found = {}
    for body, closed in zip(jaws.bodies, jaws.closed, strict=True):
        ours = pose(body.origin, (body.roll, 0.0, 0.0))
        for part in parts:
            is_there = np.abs(part.pose - ours).max() < SAME_FRAME
            if is_there and part.link not in found:
                found[part.link] = body_of(closed)
                break
    return found


# --- One link -------------------------------------------------------------------------


def _wrong_in_link(
    arm: Arm, right: Body, parts: Sequence[Part], place: int, digits: Digits
) -> list[WrongNumber]:
    """The wrong numbers of one link.

    Args:
        arm: Our arm.
        right: What the link should say, in our link frame.
        parts: All links of the body.
        place: Which of them it is.
        digits: Of the file.
    """
    part = parts[place]
    here = right.at(part.to_link)
    wrong: dict[Quantity, Tolerance] = {}
    for quantity, tolerance in _tolerances(here, parts, place, digits).items():
        written = getattr(part.body, quantity)
        if not tolerance.holds(getattr(here, quantity), written):
            wrong[quantity] = tolerance
    mistakes = explained(attempts(arm, right, part), part, wrong)
    found = []
    for quantity, tolerance in wrong.items():
        mistake = mistakes.get(quantity)
        written = getattr(part.body, quantity)
        if tolerance.holds(getattr(here, quantity), written, any_digits=True):
            mistake = ROUNDED
        found.append(WrongNumber(part.link, quantity, mistake, here))
    return found


def _tolerances(
    right: Body, parts: Sequence[Part], place: int, digits: Digits
) -> dict[Quantity, Tolerance]:
    """How closely the numbers of a link must agree.

    Rounding elsewhere, in joints and other links, changes what the link should say.

    Args:
        right: What the link should say.
        parts: All links of the body.
        place: Which of them it is.
        digits: Of the file.
    """
    part = parts[place]
    body = part.body.at(part.pose)
    com = digits.length + digits.angle * float(np.linalg.norm(body.com))
    inertia = 2 * digits.angle * float(np.abs(body.inertia).max())
    for other in (*parts[:place], *parts[place + 1 :]):
        off = min(float(digits.com.half_digit(other.body.com).max()), MOST["com"])
        apart = float(np.linalg.norm(other.body.at(other.pose).com - body.com))
        tensor = float(digits.inertia.half_digit(other.body.inertia).max())
        mass = abs(other.body.mass)
        com += off * mass / max(abs(body.mass), 1e-3)
        inertia += min(tensor, MOST["inertia"]) + 2 * mass * apart * off
    return {
        "mass": Tolerance("mass", right.mass, digits, slack=0.0),
        "com": Tolerance("com", right.com, digits, slack=com),
        "inertia": Tolerance("inertia", right.inertia, digits, slack=inertia),
    }


def _explained_as_whole(
    arm: Arm, parts: Sequence[Part], wrong: Sequence[WrongNumber], digits: Digits
) -> list[WrongNumber]:
    """The wrong numbers of the heaviest link, explained by those of all links together.

    So a body is recognized whose author split another revision's.
    """
    bodies = [part.body.at(part.pose) for part in parts]
    masses = [body.mass for body in bodies]
    if not np.sum(masses):
        return list(wrong)
    coms = [body.com for body in bodies]
    inertias = [body.inertia for body in bodies]
    whole = Part("", Body(*combine(masses, coms, inertias)), np.eye(4))
    mistakes = {}
    for number in _wrong_in_link(arm, arm.body, [whole], 0, digits):
        if number.mistake:
            words = f"all its links together have {number.mistake.words}"
            mistakes[number.quantity] = number.mistake._replace(words=words)
    explained_too = []
    for number in wrong:
        mistake = number.mistake
        if mistake is None and number.link == parts[0].link:
            mistake = mistakes.get(number.quantity)
        explained_too.append(number._replace(mistake=mistake))
    return explained_too


# --- Explaining a wrong number -------------------------------------------------------


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
