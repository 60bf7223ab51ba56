"""What to write in place of another model's wrong body: Table 2 as URDF."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved
from alpha5_model.numbers.inertia import rotate_tensor
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.inertials import Inertial
from alpha5_model.proofs.comparison.poses import rotation_of


class Replacement(NamedTuple):
    """What to write in place of a body's mass, COM and tensor."""

    mass: str = ""
    com: str = ""
    inertia: str = ""


def replacement_of(ours: LinkParameters, written: Sequence[Inertial]) -> Replacement:
    """Table 2 as URDF, in the frame of the other model's heaviest link.

    COM and tensor come together, since the axes of the origin turn the tensor. If other
    links of the body have a mass, too, all three come together.
    """
    if not written:
        return Replacement()
    heaviest = max(written, key=lambda link: abs(link.mass))
    name = heaviest.link
    to_link = np.asarray(np.linalg.inv(heaviest.pose), np.float64)
    mass = f'<mass value="{ours.mass:g}"/>'
    placed = _placed(ours, to_link)

    others = [link.link for link in written if link is not heaviest and link.mass]
    if others:
        empty = ", ".join(others)
        everything = f"{name}: {mass} {placed} (nothing in {empty})"
        return Replacement(mass=everything, com=everything, inertia=everything)
    return Replacement(
        mass=f"{name}: {mass}",
        com=f"{name}: {placed}",
        inertia=f"{name}: {placed}",
    )


def _placed(ours: LinkParameters, to_link: FloatArray) -> str:
    """COM and tensor of Table 2, as URDF, in the frame of another link.

    Table 2 prints 1e-6 m and 1e-9 kg m^2; a frame written with fewer digits adds noise.
    """
    com = moved(to_link, ours.com).round(6) + 0.0
    tensor = rotate_tensor(rotation_of(to_link), ours.inertia).round(9) + 0.0
    xyz = " ".join(f"{x:.6g}" for x in com)
    upper_half = zip(*np.triu_indices(3), strict=True)
    entries = " ".join(
        f'i{"xyz"[i]}{"xyz"[j]}="{tensor[i, j]:.6g}"' for i, j in upper_half
    )
    return f'<origin xyz="{xyz}" rpy="0 0 0"/> <inertia {entries}/>'
