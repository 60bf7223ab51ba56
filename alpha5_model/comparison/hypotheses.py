"""The wrong numbers that known mistakes would give, for every body, made from both revisions' tables.

Each table of hypotheses holds what one mistake or two at a time make of a printed number. Tensors that depend
on a size nobody printed (solid bodies, water, another point) are recomputed from the size that fits
best: few unknowns for six numbers.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from alpha5_model.checks import FloatArray
from alpha5_model.comparison.arm import FourJointArm
from alpha5_model.comparison.revisions import revisions
from alpha5_model.fluids import FRESH_WATER, SEA_WATER
from alpha5_model.inertia import (
    flip_products,
    point_mass_tensor,
    principal_moments,
    rotate_tensor,
)
from alpha5_model.jaws import split_link_4
from alpha5_model.parameters import LinkParameters, parameters

#: Two mistakes at a time; with three, some combination fits any number.
MOST_MISTAKES = 2
#: How far a solid of the body's size may exceed its bounds.
SIZE_SLACK = 1.25

_AXES = "xyz"
I_LINK = "I_Link used as I_COM (about the link frame, not the COM: the parallel-axis term twice)"
SOLIDWORKS = "products of inertia have the SolidWorks sign, that of the document"


@dataclass(frozen=True, eq=False)
class Hypothesis:
    """A wrong number and the mistakes it comes from.

    Attributes:
        words: The mistakes, as a person would say them.
        value: Mass (), COM (3,) or tensor (3, 3) that they give, SI.
        mistakes: How many they are.
    """

    words: str
    value: FloatArray
    mistakes: int = 0


Step = tuple[str, Callable[[FloatArray], FloatArray]]


def _with_mistakes(sources: list[Hypothesis], *stages: list[Step]) -> tuple[Hypothesis, ...]:
    """What the steps, at most one of each stage, make of the sources; fewest mistakes first."""
    found = []
    for source in sources:
        made = [source]
        for stage in stages:
            made += [
                Hypothesis(f"{before.words}, {words}", change(before.value), before.mistakes + 1)
                for before in made
                if before.mistakes < MOST_MISTAKES
                for words, change in stage
            ]
        found += made
    return tuple(sorted(found, key=lambda hypothesis: hypothesis.mistakes))


def frames(ours: FourJointArm, body: int) -> dict[str, FloatArray]:
    """Other frames a number may be taken from: words -> transform_body_to_frame (4, 4), at zero."""
    here = ours.poses(np.zeros(4))
    there = {name: here[i] @ ours.link_poses[name] for i in range(5) for name in ours.links[i]}
    named = {f"in DH frame {{{k}}}": f"dh_{k}" for k in range(1, 6)}
    named |= {f"in the frame of link_{k}": f"link_{k}" for k in range(5) if k != body}
    return {words: np.linalg.inv(there[name]) @ here[body] for words, name in named.items()}


def _move(transform: FloatArray, point: FloatArray) -> FloatArray:
    out: FloatArray = transform[:3, :3] @ point + transform[:3, 3]
    return out


def _signed_axes() -> Iterator[tuple[str, FloatArray]]:
    """The 47 ways to exchange and reverse axes; one reversed axis before two that contain it."""
    for order in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            matrix = np.zeros((3, 3))
            matrix[range(3), order] = signs
            wrong = [_AXES[i] for i in range(3) if signs[i] < 0]
            right = [_AXES[i] for i in range(3) if signs[i] > 0]
            if order != (0, 1, 2):
                axes = (
                    f"{'-' if s < 0 else ''}{_AXES[k]}" for s, k in zip(signs, order, strict=True)
                )
                yield f"in the wrong axes ({', '.join(axes)})", matrix
            elif len(wrong) == 1:
                yield f"the sign of {wrong[0]} is wrong (mirrored)", matrix
            elif len(wrong) == 2:
                yield f"turned by pi about {right[0]}", matrix
            elif wrong:
                yield "mirrored through the origin", matrix


def _sources(name: str, body: int, cob: bool) -> list[Hypothesis]:
    """The printed quantity of this body, its COB and the same of other bodies, in both revisions."""
    found = []
    for table in revisions():
        values = getattr(table, name)
        found.append(Hypothesis(table.numbers, values[body]))
        if cob:
            whose = "Table 3" if table is revisions()[0] else "an earlier revision"
            words = f"the centre of buoyancy of {whose}"
            found.append(Hypothesis(words, table.cob[body], 1))
        found += [
            Hypothesis(f"{table.numbers} of link_{k}", values[k], 1) for k in range(5) if k != body
        ]
    return found


@cache
def wrong_coms(ours: FourJointArm, body: int) -> tuple[Hypothesis, ...]:
    """COMs of a body in its own link frame, (3,) [m], the right one among them."""
    axes: list[Step] = [(words, partial(np.dot, m)) for words, m in _signed_axes()]
    elsewhere: list[Step] = [(words, partial(_move, t)) for words, t in frames(ours, body).items()]
    return _with_mistakes(_sources("com", body, True), axes, elsewhere)


@cache
def wrong_tensors(ours: FourJointArm, body: int) -> tuple[Hypothesis, ...]:
    """Tensors of a body in its own link's axes, (3, 3) [kg m^2], the right one among them."""
    sources = _sources("inertia", body, False)
    for table in revisions():
        own, moved = table.inertia[body], point_mass_tensor(table.mass[body], table.com[body])
        for tensor in (table.inertia_link[body], own + moved):
            sources.append(Hypothesis(f"{table.numbers}, {I_LINK}", tensor, 1))
            # Pasted as the document prints it: one slip, although two things are wrong.
            words = f"{table.numbers}, {I_LINK}, {SOLIDWORKS}"
            sources.append(Hypothesis(words, flip_products(tensor), 1))
        words = f"{table.numbers}, the parallel-axis term taken off I_COM"
        sources.append(Hypothesis(words, own - moved, 1))
    signs = [
        _products(SOLIDWORKS, -1, -1, -1),
        _products("the products of inertia are zeroed", 0, 0, 0),
    ]
    turns: list[Step] = [
        (words, partial(rotate_tensor, m)) for words, m in _signed_axes() if np.linalg.det(m) > 0
    ]
    turns += [(words, partial(rotate_tensor, t[:3, :3])) for words, t in frames(ours, body).items()]
    single = [
        _products("ixy has the wrong sign", -1, 1, 1),
        _products("ixz has the wrong sign", 1, -1, 1),
        _products("iyz has the wrong sign", 1, 1, -1),
    ]
    return _with_mistakes(sources, signs, turns, single)


def _products(words: str, xy: float, xz: float, yz: float) -> Step:
    """The step that multiplies the products of inertia by these factors."""
    return words, partial(np.multiply, np.array([[1, xy, xz], [xy, 1, yz], [xz, yz, 1]]))


@cache
def wrong_masses(body: int) -> tuple[Hypothesis, ...]:
    """Masses of a body, () [kg]."""
    now, before = revisions()
    found = [
        ("the mass of Table 2", now.mass[body]),
        ("an earlier revision's mass", before.mass[body]),
    ]
    for table, words in ((now, "that"), (before, "an earlier revision's")):
        found += [(f"{words} of link_{k}", table.mass[k]) for k in range(5) if k != body]
    found += [
        ("that of the whole arm", now.mass.sum()),
        ("that of the displaced water", now.volume[body] * FRESH_WATER),
    ]
    # Many public models pair the earlier revision's masses with version 7's volumes.
    for dry, wet in ((now, now), (before, before), (before, now)):
        whose = "Tables 2 and 3's" if dry is now else "an earlier revision's"
        volume = "its volume" if dry is wet else "Table 3's volume"
        for density in (FRESH_WATER, SEA_WATER):
            water = wet.volume[body] * density
            words = f"{whose} mass and the water's added mass of {volume}, {water * 1e3:.0f} g"
            found.append((words, dry.mass[body] + water))
    if body == 4:
        opened = split_link_4(parameters())
        parts = sum(part.mass for part in (opened.rod, opened.finger_1, opened.finger_2))
        found.append(("the jaws are counted twice", now.mass[4] + parts))
    return tuple(Hypothesis(words, np.array(value), 1) for words, value in found)


def added_water(
    link: LinkParameters, mass: float, tensor: FloatArray, within: tuple[float, float]
) -> tuple[str, str] | None:
    """A printed mass and tensor with a cylinder of water of the body's width added, if they are that.

    Strip theory: ``rho pi r^2 L^3 / 3`` about either axis across for a tensor about the cylinder's
    end (I_Link), ``/ 12`` about its middle (I_COM), and ``rho pi r^2 L`` in the mass. Six of seven
    numbers test the one unknown, L.

    Args:
        link: The body of the tables.
        mass, tensor: Of the other model [kg, kg m^2].
        within: What they may be off by.

    Returns:
        Where the mass is from, and where the tensor is from.
    """
    body, radius = int(link.name[-1]), _radius(link)
    line = FRESH_WATER * np.pi * radius**2
    bases = itertools.product(revisions(), (True, False), (False, True), range(3))
    for table, about_end, solidworks, axis in bases:
        base = (table.inertia_link if about_end else table.inertia)[body]
        surplus = tensor - (flip_products(base) if solidworks else base)
        across = float(np.delete(np.diag(surplus), axis).mean())
        rest = surplus - across * np.diag(np.arange(3) != axis)
        if across <= 5 * within[1] or np.abs(rest).max() > within[1]:
            continue
        length = float(np.cbrt((3 if about_end else 12) * across / line))
        water = line * length
        # The tensor tells L to a third of its own relative error.
        allowed = within[0] + water * within[1] / (3 * across)
        longest = SIZE_SLACK * np.ptp(link.bounds, axis=1).max()
        if length <= longest and abs(mass - table.mass[body] - water) <= allowed:
            cylinder = f"of radius {radius * 1e3:.0f} mm and length {length * 1e3:.0f} mm"
            return (
                f"{table.numbers.removesuffix(' numbers')} mass and the water's added mass, "
                f"{water * 1e3:.0f} g, of a cylinder of water {cylinder}",
                f"{table.numbers}, {I_LINK if about_end else 'I_COM'}{f', {SOLIDWORKS}' * solidworks}, "
                f"with the added inertia of a cylinder of water {cylinder} (strip theory)",
            )
    return None


def wrong_point(body: int, mass: float, tensor: FloatArray, tolerance: float) -> str | None:
    """The printed I_COM about another point than the COM, if it is that: three unknowns, six numbers."""
    for table, solidworks in itertools.product(revisions(), (False, True)):
        right = flip_products(table.inertia[body]) if solidworks else table.inertia[body]
        shift = (tensor - right) / mass
        square = float(np.trace(shift)) / 2
        values, vectors = np.linalg.eigh(square * np.eye(3) - shift)  # p p^T
        point = vectors[:, 2] * np.sqrt(max(values[2], 0.0))
        error = np.abs(tensor - right - point_mass_tensor(mass, point)).max()
        if mass * square > 5 * tolerance and error <= tolerance:
            words = f"{table.numbers}, about the wrong point, {np.sqrt(square) * 1e3:.1f} mm from the COM"
            return words + f", {SOLIDWORKS}" * solidworks
    return None


def solid_of_size(link: LinkParameters, mass: float, tensor: FloatArray) -> str | None:
    """A solid cylinder or box of about the body's size that has these principal moments, if one has."""
    moments = principal_moments(tensor)
    sizes = np.sort(SIZE_SLACK * np.ptp(link.bounds, axis=1))
    if mass <= 0 or moments[0] <= 0:
        return None
    for axis in range(3):
        one, two = np.delete(moments, axis)
        radius = np.sqrt(2 * moments[axis] / mass)
        square = 12 * one / mass - 3 * radius**2
        round_ = two - one <= 1e-3 * moments[2] and radius <= SIZE_SLACK * _radius(link)
        if round_ and 0 < square <= sizes[2] ** 2:
            length = np.sqrt(square) * 1e3
            return f"a solid cylinder of radius {radius * 1e3:.1f} mm and length {length:.1f} mm"
    sides = np.sqrt(np.maximum(6 / mass * (moments.sum() - 2 * moments), 0.0))[::-1]
    # Any three moments are those of some box: only sides of whole millimetres tell of a guess.
    whole = np.abs(sides * 1e3 - np.round(sides * 1e3)).max() < 0.05
    if whole and sides[0] > 1e-3 and (sides <= sizes).all():
        x, y, z = sides * 1e3
        return f"a solid box of {x:.0f} x {y:.0f} x {z:.0f} mm"
    return None


def _radius(link: LinkParameters) -> float:
    """Half the least width of the body: all are turned parts [m]."""
    return float(np.ptp(link.bounds, axis=1).min() / 2)
