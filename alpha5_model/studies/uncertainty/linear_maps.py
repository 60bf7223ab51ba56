"""Linear maps from printed numbers to links, and from links to base parameters."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, lru_cache
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
    """The 14 numbers of each link, or derivatives by them.

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
    """The numbers of links, (..., 14), by their kinds."""
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
    """Map from the printed numbers to the links, (K, 5, 14), see `LinkNumbers`.

    It is linear, even with the correction of link 3's COB, whose frame depends on
    lengths of Table 1.

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
        # Not checked as bodies: all numbers but one are zero.
        links = link_numbers(tables, applied)
        out.append([numbers_of_body(link) for link in links])
    return frozen(out)


def numbers_of_body(body: Mapping[str, Any]) -> list[float]:
    """The 14 numbers of a body with these fields of `LinkParameters`."""
    second = second_moments(body["inertia"])[UPPER]
    return [body["mass"], *body["com"], *second, body["volume"], *body["cob"]]


@lru_cache(maxsize=64)
def grouping(fluid_density: float, parameters: Alpha5Parameters) -> FloatArray:
    """Map from moments of the links to the base parameters, (5, 14, 38).

    The moments are m, m c, second moments, V and V b. Gravity is left out.

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
        # A mass counts in both matrices; displaced water reduces the net mass only.
        share = (0.0, -fluid_density) if of_volume else 1.0
        unit[link, :, row, column] = share
        unit[link, :, column, row] = share
        out.append(regrouped(unit, np.zeros(3), parameters)[:-3])
    return frozen(np.reshape(out, (5, 14, -1)))


def groups(bodies: FloatArray, by_moments: FloatArray) -> FloatArray:
    """Base parameters of bodies, without gravity, (..., 38).

    Args:
        bodies: Their numbers, (..., B, 14).
        by_moments: Map from their moments to the base parameters, (B, 14, 38).
    """
    links = split(bodies)
    mass = links.mass[..., None]
    volume = links.volume[..., None]
    rows, columns = UPPER
    at_origin = links.second + mass * links.com[..., rows] * links.com[..., columns]
    parts = [mass, mass * links.com, at_origin, volume, volume * links.cob]
    moments = np.concatenate(parts, axis=-1)
    return np.asarray(np.tensordot(moments, by_moments, 2))


def possible(links: FloatArray) -> Any:
    """Which sets of links (n, B, 14) are possible bodies, (n,) bool.

    A body has a positive definite pseudo-inertia and no negative volume. The
    pseudo-inertia is positive definite exactly if the mass is positive and the second
    moments at the COM are positive definite [Wensing2018].
    """
    parts = split(links)
    least = np.linalg.eigvalsh(parts.second[..., SYMMETRIC])[..., 0]
    bodies = (least > 0) & (parts.mass > 0) & (parts.volume >= 0)
    return bodies.all(axis=-1)
