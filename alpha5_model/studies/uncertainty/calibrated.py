"""Numbers of a calibrated arm, which are known together better than one by one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.arm_checks import LENGTHS
from alpha5_model.numbers.covariance import WIDTH, Covariance
from alpha5_model.numbers.parameters import Alpha5Parameters


class Calibrated(NamedTuple):
    """The numbers of an arm that its covariance is of.

    Attributes:
        rows: Of these numbers among all, (k,).
        half_width: Of each, (k,).
        root: Square root of the covariance, times sqrt(3), as `Covariance.root`, in the
            signs of the printed numbers, (k, k).
        centres: Of each first moment that is known better than its factors: row of the
            mass or volume, row of the centre, (c, 2) of all rows.
    """

    rows: FloatArray
    half_width: FloatArray
    root: FloatArray
    centres: FloatArray


def calibrated_rows(arm: Alpha5Parameters, names: tuple[str, ...]) -> Calibrated | None:
    """The numbers of an arm's covariance among its numbers; None without one.

    Args:
        arm: The record.
        names: Of its numbers, (K,).
    """
    covariance = arm.covariance
    if covariance is None:
        return None
    place = {name: row for row, name in enumerate(names)}
    ours = [name for name in covariance.names if printed_name(name) in place]
    kept = [covariance.names.index(name) for name in ours]
    rows = np.array([place[printed_name(name)] for name in ours], int)
    signs = np.array([_sign(name) for name in ours])
    scale = WIDTH * covariance.deviation[kept] * signs
    known = Covariance(
        names=tuple(ours),
        deviation=covariance.deviation[kept],
        factor=covariance.factor[kept],
    )
    return Calibrated(
        rows=rows,
        half_width=WIDTH * known.standard_deviation,
        root=scale[:, None] * known.root,
        centres=_centres(ours, place),
    )


def spread_of(found: Calibrated, middle: FloatArray, drawn: FloatArray) -> FloatArray:
    """Changes of an arm's numbers from draws of a uniform width of -1 to 1.

    Measurements tell first moments m c, not the factors. So a drawn change dm, dc is
    that of ``m c`` to first order, ``c dm + m dc``: the centre moves by ``dc m / (m +
    dm)``, and the moment by just that.

    Args:
        found: The numbers.
        middle: Of all numbers, (K,).
        drawn: Of them, each independent with the variance 1/3, (..., k).

    Returns:
        (..., k).
    """
    change = drawn @ found.root.T
    at = {row: k for k, row in enumerate(found.rows.tolist())}
    for of_mass, of_centre in found.centres.tolist():
        mass = middle[of_mass]
        heavier = change[..., at[of_mass]] + mass
        change[..., at[of_centre]] *= np.where(heavier > 0, mass / heavier, 1.0)
    return np.asarray(change)


def printed_name(name: str) -> str:
    """The number of `ArmNumbers` that a name of a covariance stands for."""
    table, key, *rest = name.split(".")
    if table == "links":
        quantity = "inertia_com" if rest[0] == "inertia" else rest[0]
        return ".".join([key, quantity, *rest[1:]])
    if table == "lengths" and key != "a_1":
        row, field = LENGTHS[key]
        return f"link_{row}.{field}"
    return name


def _sign(name: str) -> float:
    """-1 for products of inertia, which the document prints with the other sign."""
    is_product = ".inertia." in name and len(set(name.rpartition(".")[2])) == 2
    return -1.0 if is_product else 1.0


def _centres(names: list[str], place: dict[str, int]) -> FloatArray:
    """Rows of mass or volume, and of centre, if the covariance has both."""
    pairs = []
    for name in names:
        for centre, amount in ((".com.", ".mass"), (".cob.", ".volume")):
            stem, found, _ = name.partition(centre)
            if found and f"{stem}{amount}" in names:
                of_mass = place[printed_name(f"{stem}{amount}")]
                pairs.append((of_mass, place[printed_name(name)]))
    return np.array(pairs, int).reshape(-1, 2)
