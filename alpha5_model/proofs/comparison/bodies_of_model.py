"""The bodies of another model as links of a record, and as what is attached to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.errors import InputError
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.inertia import inconsistencies, point_mass_tensor
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.numbers.rigid_body import AttachedBody

#: Smaller differences are rounding [m]; of the largest mass or moment.
_ROUNDING = 1e-12
#: Shares of a link that may remain of it where its COM is outside its bounds.
_SHARES = (1.0, 0.5, 0.1, 0.01, 0.001)


def bodies_of_model(
    printed: Sequence[LinkParameters],
    masses: FloatArray,
    coms: FloatArray,
    inertias: FloatArray,
    left_out: list[str],
) -> tuple[tuple[LinkParameters, ...], tuple[AttachedBody, ...]]:
    """Links with the bodies of another model, and bodies to attach to them.

    If a COM is outside the bounds of a link, part of the body is attached: an arm file
    refuses such a link.

    Args:
        printed: The catalogue's links.
        masses, coms, inertias: In the frames of these links, (5,) [kg], (5, 3) [m] and,
            at the COM, (5, 3, 3) [kg m^2].
        left_out: Takes a text for each body that cannot be said.
    """
    links: list[LinkParameters] = []
    attached: list[AttachedBody] = []
    bodies = zip(printed, masses.tolist(), coms, inertias, strict=True)
    for link, mass, com, inertia in bodies:
        symmetric = (inertia + inertia.T) / 2
        problem = _problem(mass, com, symmetric)
        if problem:
            left_out.append(f"{link.name} {problem}: the printed one is kept")
            links.append(link)
            continue
        try:
            links.append(_link(link, mass, com, symmetric))
        except InputError:
            parted = _parted(link, mass, com, symmetric)
            if parted is None:
                text = f"{link.name} has its COM outside the link, and no part in it"
                left_out.append(f"{text}: the printed one is kept")
                links.append(link)
                continue
            links.append(parted.body)
            attached.append(parted.rest)
    return tuple(links), tuple(attached)


def _problem(mass: float, com: FloatArray, inertia: FloatArray) -> str:
    """Why an arm file cannot say a body; empty if it can."""
    wrong = inconsistencies(mass, com, inertia) if mass else ["no mass"]
    if wrong:
        return f"is no possible body ({wrong[0]})"
    if not plausibility.MASS.holds(mass):
        return f"has {mass:.4g} kg"
    farthest = float(np.abs(com).max())
    if not plausibility.POSITION.holds(farthest):
        return f"has its COM {farthest:.4g} m off"
    return ""


def _link(
    link: LinkParameters, mass: float, com: FloatArray, inertia: FloatArray
) -> LinkParameters:
    """A link with another body; printed numbers stay if only rounding differs."""
    if abs(mass - link.mass) > _ROUNDING * link.mass:
        link = replace(link, mass=mass)
    if np.abs(com - link.com).max() > _ROUNDING:
        link = replace(link, com=com)
    if np.abs(inertia - link.inertia).max() > _ROUNDING * np.abs(link.inertia).max():
        link = replace(link, inertia=inertia)
    return link


class _Parted(NamedTuple):
    """A share of the printed link, and an attached body that makes up for the rest."""

    body: LinkParameters
    rest: AttachedBody


def _parted(
    link: LinkParameters, mass: float, com: FloatArray, inertia: FloatArray
) -> _Parted | None:
    """The largest share of the printed link that leaves a possible rest, if any."""
    about_origin = inertia + point_mass_tensor(mass, com)
    printed = link.inertia + point_mass_tensor(link.mass, link.com)
    for share in _SHARES:
        rest = mass - share * link.mass
        if rest <= 0:
            continue
        rest_com = (mass * com - share * link.mass * link.com) / rest
        shifted = point_mass_tensor(rest, rest_com)
        rest_inertia = about_origin - share * printed - shifted
        rest_inertia = (rest_inertia + rest_inertia.T) / 2
        if inconsistencies(rest, rest_com, rest_inertia):
            continue
        body = replace(link, mass=share * link.mass, inertia=share * link.inertia)
        attached = AttachedBody(
            name=f"rest_of_{link.name}",
            mass=rest,
            com=rest_com,
            inertia=rest_inertia,
            volume=0.0,
            cob=rest_com,
            link=link.name,
            position=np.zeros(3),
            rotation=np.eye(3),
        )
        return _Parted(body=body, rest=attached)
    return None
