"""What can be chosen about the C library."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from alpha5_model._support.checks import choice
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER

REALS = ("double", "float")
#: In the code, or in a struct that the functions take.
PARAMETERS = ("folded", "struct")


@dataclass(frozen=True)
class COptions:
    """What can be chosen about the C library.

    Attributes:
        fluid_density: [kg/m^3].
        gravity: In base_link, (3,) [m/s^2].
        corrections: Recorded corrections to the document.
        real: Type of all numbers, one of `REALS`.
        parameters: Where the arm's parameters are, one of `PARAMETERS`.

    Raises:
        UnknownNameError: No such type, or no such place.
    """

    fluid_density: float = SEA_WATER
    gravity: tuple[float, float, float] = GRAVITY
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    real: str = "double"
    parameters: str = "folded"

    @property
    def struct(self) -> bool:
        """Whether the functions take the parameters."""
        return self.parameters == "struct"

    def __post_init__(self) -> None:
        choice("real", self.real, REALS)
        choice("parameters", self.parameters, PARAMETERS)
