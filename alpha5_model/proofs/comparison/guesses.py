"""Recognize guessed tensors: those of solid cylinders, boxes and dummies."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.inertia import principal_moments
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.body_size import (
    SIZE_SLACK,
    body_radius,
    largest_sizes,
)
from alpha5_model.proofs.comparison.inertials import Inertial, solid_links

#: Smaller products and differences of moments are rounding, relative to the largest
#: moment.
GUESS_DIGITS = 1e-4
#: The same for the two moments across the axis of a cylinder.
ROUND_DIGITS = 1e-3


def explain_guess(link: LinkParameters, written: Sequence[Inertial]) -> str | None:
    """The solids from which a body's tensors were guessed, in words.

    Args:
        link: The body of the tables.
        written: What the other model's links write.

    Returns:
        None if the tensors have products of inertia and fit no solid.
    """
    solid = solid_links(written)
    shapes = []
    is_plain = True  # no link so far has products of inertia
    for one in solid:
        is_plain = is_plain and _has_no_products(one.inertia)
        shape = solid_of_size(link, one.mass, one.inertia)
        if is_plain and _is_round(one.inertia):
            moment = one.inertia[0, 0]
            shape = f"a dummy, {moment:g} kg m^2 about every axis"
        if shape:
            shapes.append(f"{one.link} {shape}" if len(solid) > 1 else shape)

    if not is_plain and len(shapes) < len(solid):
        return None
    guess = "a guess without products of inertia" if is_plain else "a guess"
    return f"{guess}: {'; '.join(shapes)}" if shapes else guess


def _has_no_products(tensor: FloatArray) -> bool:
    """Whether a tensor is diagonal.

    An ``<origin rpy>`` of few digits leaves products of its own rounding.
    """
    moments = np.diag(tensor)
    products = tensor - np.diag(moments)
    return bool(np.abs(products).max() <= GUESS_DIGITS * moments.max())


def _is_round(tensor: FloatArray) -> bool:
    """Whether a diagonal tensor has the same moment about every axis."""
    moments = np.diag(tensor)
    return bool(np.ptp(moments) <= GUESS_DIGITS * moments.max())


def solid_of_size(link: LinkParameters, mass: float, tensor: FloatArray) -> str | None:
    """A solid of about the body's size with these principal moments, in words.

    Args:
        link: The body of the tables.
        mass: [kg].
        tensor: At the COM, (3, 3) [kg m^2].

    Returns:
        A cylinder or a box; None if there is none.
    """
    moments = principal_moments(tensor)
    if mass <= 0 or moments[0] <= 0:
        return None
    return _solid_cylinder(link, mass, moments) or _solid_box(link, mass, moments)


def _solid_cylinder(
    link: LinkParameters, mass: float, moments: FloatArray
) -> str | None:
    """A solid cylinder of about the body's size, if one has these moments (3,)."""
    longest = largest_sizes(link)[2]
    widest = SIZE_SLACK * body_radius(link)
    for axis in range(3):
        less, more = np.delete(moments, axis)
        is_round = more - less <= ROUND_DIGITS * moments[2]
        radius = np.sqrt(2 * moments[axis] / mass)
        squared_length = 12 * less / mass - 3 * radius**2
        if is_round and radius <= widest and 0 < squared_length <= longest**2:
            length = np.sqrt(squared_length)
            return (
                f"a solid cylinder of radius {radius * 1e3:.1f} mm "
                f"and length {length * 1e3:.1f} mm"
            )
    return None


def _solid_box(link: LinkParameters, mass: float, moments: FloatArray) -> str | None:
    """A solid box of about the body's size, if it has these moments (3,).

    Every three moments belong to some box, so only sides of whole millimetres are
    taken for a guess.
    """
    squared_sides = 6 / mass * (moments.sum() - 2 * moments)
    sides = np.sqrt(np.maximum(squared_sides, 0.0))[::-1]
    millimetres = sides * 1e3
    is_whole = np.abs(millimetres - np.round(millimetres)).max() < 0.05
    fits = (sides <= largest_sizes(link)).all()
    if not (is_whole and fits and sides[0] > 1e-3):
        return None
    x, y, z = millimetres
    return f"a solid box of {x:.0f} x {y:.0f} x {z:.0f} mm"
