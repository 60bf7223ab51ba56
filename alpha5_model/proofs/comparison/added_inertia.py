"""Tensors with something added: water, or the parallel-axis term of a wrong point.

Both depend on an unknown size: the length of a cylinder of water, or the position of a
point. It is computed from the tensor, whose six numbers then test the one or three
unknowns.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.fluids import FRESH_WATER
from alpha5_model.numbers.inertia import flip_products, point_mass_tensor
from alpha5_model.proofs.comparison.body_size import body_radius, largest_sizes
from alpha5_model.proofs.comparison.document_revisions import Revision, revisions
from alpha5_model.proofs.comparison.hypotheses import (
    I_LINK,
    SOLIDWORKS,
    BodyHypotheses,
)
from alpha5_model.proofs.comparison.inertials import Inertial


class AddedWater(NamedTuple):
    """The origin of a mass and of a tensor, in words."""

    mass: str
    inertia: str


class _Printed(NamedTuple):
    """A tensor of a revision, as somebody may have copied it.

    Attributes:
        revision: The revision.
        tensor: (3, 3) [kg m^2].
        about_end: Whether it is about the link frame, not about the COM.
        solidworks: Whether its products of inertia have the document's sign.
    """

    revision: Revision
    tensor: FloatArray
    about_end: bool
    solidworks: bool

    @property
    def words(self) -> str:
        """Whose numbers they are, about which point, in which sign."""
        point = I_LINK if self.about_end else "I_COM"
        return f"{self.revision.numbers}, {point}{_sign_in_words(self.solidworks)}"


class _Cylinder(NamedTuple):
    """A cylinder of water: radius [m], length [m] and mass [kg]."""

    radius: float
    length: float
    mass: float

    @property
    def words(self) -> str:
        """Its size."""
        return (
            f"a cylinder of water of radius {self.radius * 1e3:.0f} mm "
            f"and length {self.length * 1e3:.0f} mm"
        )


def added_water(known: BodyHypotheses, subject: Inertial) -> AddedWater | None:
    """Tell whether mass and tensor are printed ones with a cylinder of water added.

    Strip theory adds ``rho pi r^2 L`` to the mass. To the moments of inertia about both
    axes across the cylinder it adds ``rho pi r^2 L^3 / 3`` if they are about its end
    (I_Link), and ``rho pi r^2 L^3 / 12`` if they are about its middle (I_COM). The
    radius is the body's, so that six of seven numbers test the one unknown, L. The
    tensor is tried in our frame, and as it is written if its axes are not ours.
    """
    longest = largest_sizes(known.link).max()
    mass_digits = subject.mass_digits
    inertia_digits = subject.inertia_digits
    tensors = (subject.in_our_frame().inertia, subject.inertia)
    printed_ones = list(_printed_tensors(known.body))
    for tensor, printed, axis in itertools.product(tensors, printed_ones, range(3)):
        surplus = tensor - printed.tensor
        moment = _moment_across(surplus, axis, inertia_digits)
        if moment is None:
            continue

        cylinder = _cylinder(body_radius(known.link), moment, printed.about_end)
        dry_mass = printed.revision.mass[known.body]
        off = abs(subject.mass - dry_mass - cylinder.mass)
        # L follows from the tensor to a third of its relative error.
        slack = mass_digits + cylinder.mass * inertia_digits / (3 * moment)
        if cylinder.length <= longest and off <= slack:
            return _in_words(printed, cylinder)
    return None


def _printed_tensors(body: int) -> Iterator[_Printed]:
    """The tensors of a body that both revisions print."""
    for revision in revisions():
        for about_end in (True, False):
            tensors = revision.inertia_link if about_end else revision.inertia
            tensor = tensors[body]
            for solidworks in (False, True):
                yield _Printed(
                    revision=revision,
                    tensor=flip_products(tensor) if solidworks else tensor,
                    about_end=about_end,
                    solidworks=solidworks,
                )


def _moment_across(tensor: FloatArray, axis: int, digits: float) -> float | None:
    """Moment of inertia across a thin rod, if a tensor is that of one [kg m^2].

    Args:
        tensor: (3, 3) [kg m^2].
        axis: Of the rod, 0 to 2.
        digits: How closely the tensor must be that of a rod [kg m^2].

    Returns:
        None if it is not, or is too small to tell.
    """
    across = float(np.delete(np.diag(tensor), axis).mean())
    rest = tensor - across * np.diag(np.arange(3) != axis)
    if across <= 5 * digits or np.abs(rest).max() > digits:
        return None
    return across


def _cylinder(radius: float, moment: float, about_end: bool) -> _Cylinder:
    """The cylinder of water with a moment across [kg m^2], about its end or middle."""
    mass_per_length = FRESH_WATER * np.pi * radius**2
    factor = 3 if about_end else 12
    length = float(np.cbrt(factor * moment / mass_per_length))
    return _Cylinder(radius=radius, length=length, mass=mass_per_length * length)


def _in_words(printed: _Printed, cylinder: _Cylinder) -> AddedWater:
    """Mass and tensor of a revision with a cylinder of water, in words."""
    owner = printed.revision.numbers.removesuffix(" numbers")
    grams = f"{cylinder.mass * 1e3:.0f} g"
    size = cylinder.words
    return AddedWater(
        mass=f"{owner} mass and the water's added mass, {grams}, of {size}",
        inertia=f"{printed.words}, with the added inertia of {size} (strip theory)",
    )


def _sign_in_words(solidworks: bool) -> str:
    return f", {SOLIDWORKS}" if solidworks else ""


def wrong_point(known: BodyHypotheses, subject: Inertial) -> str | None:
    """Tell whether a tensor is the printed I_COM, but about another point p.

    Six numbers of the parallel-axis term ``m (|p|^2 1 - p p^T)`` test three unknowns.
    """
    mass = subject.mass
    tensor = subject.in_our_frame().inertia
    tolerance = subject.inertia_digits
    for revision, solidworks in itertools.product(revisions(), (False, True)):
        printed = revision.inertia[known.body]
        right = flip_products(printed) if solidworks else printed
        term = (tensor - right) / mass
        square = float(np.trace(term)) / 2
        point = _nearest_point(square * np.eye(3) - term)
        error = np.abs(tensor - right - point_mass_tensor(mass, point)).max()
        if mass * square > 5 * tolerance and error <= tolerance:
            distance = np.sqrt(square) * 1e3
            return (
                f"{revision.numbers}, about the wrong point, {distance:.1f} mm from "
                f"the COM{_sign_in_words(solidworks)}"
            )
    return None


def _nearest_point(outer: FloatArray) -> FloatArray:
    """The point p (3,) whose ``p p^T`` comes closest to a symmetric matrix (3, 3)."""
    values, vectors = np.linalg.eigh(outer)
    return np.asarray(vectors[:, 2] * np.sqrt(max(values[2], 0.0)))
