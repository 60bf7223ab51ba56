"""Lengths, zeros and tool of an arm, as numbers or as symbols of its equations.

Table 1's twists are the structure of the equations: every arm has them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tool import printed_tool

_JOINTS = 4


class QuarterTurns(NamedTuple):
    """Cosine and sine of an angle that is a multiple of pi/2."""

    cosine: int
    sine: int


class Dimensions(NamedTuple):
    """Where the joints and the tool of an arm are; numbers, or CasADi's symbols.

    Attributes:
        a_0, d_0: From joint 0 to joint 1 along x and z [m].
        a_1: From joint 1 to joint 2 along x [m].
        a_2: From joint 2 to joint 3 along x [m].
        cosines, sines: Of the constant parts of DH angles 0 to 3, 4 each.
        tool: Upper three rows of the tcp's pose in link_4, row by row, 12 [1 and m].
        twists: From link 1 to link 2, ..., from link 3 to link 4.
    """

    a_0: Any
    d_0: Any
    a_1: Any
    a_2: Any
    cosines: tuple[Any, ...]
    sines: tuple[Any, ...]
    tool: tuple[Any, ...]
    twists: tuple[QuarterTurns, ...]

    @classmethod
    def from_parameters(cls, parameters: Alpha5Parameters) -> Dimensions:
        """The dimensions that a record has."""
        dh = parameters.dh
        *_, wrist, tip = dh
        tool = parameters.tool or printed_tool(wrist, tip)
        pose = np.column_stack([tool.rotation, tool.position])
        offsets = [row.theta_offset for row in dh[:_JOINTS]]
        return cls(
            a_0=dh[0].a,
            d_0=dh[0].d,
            a_1=dh[1].a,
            a_2=dh[2].a,
            cosines=tuple(_exact(math.cos(offset)) for offset in offsets),
            sines=tuple(_exact(math.sin(offset)) for offset in offsets),
            tool=tuple(pose.ravel().tolist()),
            twists=twists(parameters),
        )

    @classmethod
    def from_numbers(
        cls, numbers: Sequence[Any], twists: tuple[QuarterTurns, ...]
    ) -> Dimensions:
        """The dimensions of their `numbers`, or of symbols in their place."""
        a_0, d_0, a_1, a_2, *others = numbers
        return cls(
            a_0=a_0,
            d_0=d_0,
            a_1=a_1,
            a_2=a_2,
            cosines=tuple(others[:_JOINTS]),
            sines=tuple(others[_JOINTS : 2 * _JOINTS]),
            tool=tuple(others[2 * _JOINTS :]),
            twists=twists,
        )

    @property
    def numbers(self) -> FloatArray:
        """All of them in order, without the twists, (24,)."""
        lengths = (self.a_0, self.d_0, self.a_1, self.a_2)
        return np.array([*lengths, *self.cosines, *self.sines, *self.tool])

    @property
    def origins(self) -> list[tuple[Any, Any, Any]]:
        """Origin of each link in the link before, of link 1 in base_link."""
        return [
            (0.0, 0.0, 0.0),
            (self.a_0, 0.0, self.d_0),
            (self.a_1, 0.0, 0.0),
            (self.a_2, 0.0, 0.0),
        ]


#: How many numbers describe the dimensions: lengths, cosines, sines, tool.
DIMENSIONS = 4 + 2 * _JOINTS + 3 * 4


def has_known_structure(parameters: Alpha5Parameters, known: Alpha5Parameters) -> bool:
    """Whether the equations of one arm are those of another with other numbers."""
    rows = parameters.dh
    must_be_zero = (rows[1].d, rows[2].d, rows[3].a, rows[4].d, rows[4].a)
    return not any(must_be_zero) and twists(parameters) == twists(known)


def twists(parameters: Alpha5Parameters) -> tuple[QuarterTurns, ...]:
    """The twists between the links of an arm."""
    return tuple(
        QuarterTurns(cosine=round(math.cos(row.alpha)), sine=round(math.sin(row.alpha)))
        for row in parameters.dh[: _JOINTS - 1]
    )


def _exact(value: float) -> float:
    """A sine or cosine, exact for multiples of pi/2."""
    nearest = float(round(value))
    return nearest if abs(value - nearest) < 1e-15 else value
