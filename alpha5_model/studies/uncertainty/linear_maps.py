"""From printed numbers to links, and from links to base parameters: both are linear."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model.codegen.regrouping import regrouped
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.inertia import second_moments
from alpha5_model.numbers.parameters import Alpha5Parameters, link_numbers
from alpha5_model.studies.uncertainty import printed

#: Entries of a symmetric matrix, and the place of each in (3, 3).
UPPER = np.triu_indices(3)
SYMMETRIC = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])


class LinkNumbers(NamedTuple):
    """The 14 numbers of each link, or something for each of them.

    Attributes:
        mass: (...).
        com: (..., 3).
        second: Second moments at the COM, (..., 6); `SYMMETRIC` makes matrices of them.
        volume: (...).
        cob: (..., 3).
    """

    mass: FloatArray
    com: FloatArray
    second: FloatArray
    volume: FloatArray
    cob: FloatArray


def split(numbers: FloatArray) -> LinkNumbers:
    """The parts of numbers of links, (..., 14)."""
    return LinkNumbers(
        mass=numbers[..., 0],
        com=numbers[..., 1:4],
        second=numbers[..., 4:10],
        volume=numbers[..., 10],
        cob=numbers[..., 11:],
    )


@cache
def link_map(
    alternatives: tuple[str, ...],
    corrections: tuple[str, ...] = DEFAULT_CORRECTIONS,
) -> FloatArray:
    """From the printed numbers to the links, (K, 5, 14), in the order of `LinkNumbers`.

    It is linear, the frame of link 3's COB included.

    Args:
        alternatives: Checked names of `ALTERNATIVES`.
        corrections: Of the arm; those among the alternatives are added.
    """
    applied = printed.with_alternatives(corrections, alternatives)
    names = tuple(printed.numbers(alternatives))
    out = []
    for row in np.eye(len(names)):
        values = dict(zip(names, row.tolist(), strict=True))
        tables = printed.tables_with(values, alternatives)
        # These are no bodies: all numbers but one are zero.
        links = link_numbers(tables, applied)
        out.append([_numbers_of(link) for link in links])
    return frozen(out)


def _numbers_of(link: dict[str, Any]) -> list[float]:
    """The 14 numbers of a link."""
    second = second_moments(link["inertia"])[UPPER]
    return [link["mass"], *link["com"], *second, link["volume"], *link["cob"]]


@cache
def grouping(fluid_density: float, parameters: Alpha5Parameters) -> FloatArray:
    """From moments of the links to the base parameters, gravity left out, (5, 14, 38).

    The moments are m, m c, second moments, V and V b.

    Args:
        fluid_density: [kg/m^3].
        parameters: The arm's; only its dimensions and its base frame are used.
    """
    entries = [(3, 3), (0, 3), (1, 3), (2, 3), *zip(*UPPER, strict=True)]
    out = []
    for link, k in np.ndindex(5, 14):
        of_volume = k >= len(entries)
        row, column = entries[k - len(entries) if of_volume else k]
        unit = np.zeros((5, 2, 4, 4))
        # A mass counts in both matrices; displaced water takes from the net mass only.
        share = (0.0, -fluid_density) if of_volume else 1.0
        unit[link, :, row, column] = share
        unit[link, :, column, row] = share
        out.append(regrouped(unit, np.zeros(3), parameters)[:-3])
    return frozen(np.reshape(out, (5, 14, -1)))


def groups(
    values: FloatArray,
    alternatives: tuple[str, ...],
    density: float,
    parameters: Alpha5Parameters,
) -> FloatArray:
    """Base parameters, gravity left out, of printed numbers, (..., K) to (..., 38).

    Args:
        values: Printed numbers, (..., K) SI units.
        alternatives: Checked names of `ALTERNATIVES`.
        density: Of the fluid [kg/m^3].
        parameters: The arm's; only its dimensions and corrections are used.
    """
    to_links = link_map(alternatives, parameters.corrections)
    links = split(np.tensordot(values, to_links, 1))
    mass = links.mass[..., None]
    volume = links.volume[..., None]
    rows, columns = UPPER
    at_origin = links.second + mass * links.com[..., rows] * links.com[..., columns]
    parts = [mass, mass * links.com, at_origin, volume, volume * links.cob]
    moments = np.concatenate(parts, axis=-1)
    return np.asarray(np.tensordot(moments, grouping(density, parameters), 2))


def possible(links: FloatArray) -> Any:
    """Which sets of links (n, 5, 14) are bodies, (n,) bool.

    The pseudo-inertia of a body is positive definite, and its volume is not below 0.
    The pseudo-inertia is positive definite if the mass is positive and so are the
    second moments at the COM [Wensing2018].
    """
    parts = split(links)
    least = np.linalg.eigvalsh(parts.second[..., SYMMETRIC])[..., 0]
    bodies = (least > 0) & (parts.mass > 0) & (parts.volume >= 0)
    return bodies.all(axis=-1)
