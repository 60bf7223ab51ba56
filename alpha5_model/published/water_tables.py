"""What moving water does to each body, as frozen records in the units of its files; read when it is asked for."""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model.published.quantity import Quantity
from alpha5_model.published.tables import BODY_NAMES, Triple, printed

Interval = tuple[Quantity, Quantity, Quantity]
Matrix = tuple[tuple[Quantity, ...], ...]

HYDRODYNAMIC_NAMES = (*BODY_NAMES, "link_4_open", "wrist", "finger_1", "finger_2")
#: Units of the blocks of an added mass: both indices linear, one angular, both angular.
ADDED_MASS_UNITS = ("kg", "kg.m", "kg.m^2")


@dataclass(frozen=True, slots=True)
class StripRow:
    """A strip of a body along which the water drags; see `alpha5_model.hydrodynamics.DragStrip`.

    Attributes:
        start, end: In the body's frame [mm].
        diameter: [mm].
        across, along: Drag coefficients: low, nominal, high.
    """

    start: Triple = printed("mm")
    end: Triple = printed("mm")
    diameter: Quantity = printed("mm")
    across: Interval = printed("")
    along: Interval = printed("")


@dataclass(frozen=True, slots=True)
class HydrodynamicRow:
    """What moving water does to a body; nothing of it is published.

    Attributes:
        name: ``link_0`` to ``link_4`` (closed jaws), ``link_4_open``, ``wrist`` (link 4 without its fingers),
            ``finger_1``, ``finger_2``.
        added_mass: 6x6, linear before angular, about and in the link's frame, for 1000 kg/m^3.
        added_mass_factor: Of all its entries: low, nominal, high.
        strips: Where it drags.
        status: One of ``STATUSES``.
        source: Who says so.
        method: How it was computed.
    """

    name: str
    added_mass: Matrix = printed("kg, kg.m, kg.m^2")
    added_mass_factor: Interval = printed("")
    strips: tuple[StripRow, ...] = ()
    status: str = ""
    source: str = ""
    method: str = ""
