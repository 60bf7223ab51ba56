"""What can be chosen about the C library."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from alpha5_model._support.checks import choice
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm

REALS = ("double", "float")
#: In the code, or in a struct that the functions take.
PARAMETERS = ("folded", "struct")


@dataclass(frozen=True)
class COptions:
    """What can be chosen about the C library.

    Attributes:
        fluid_density: [kg/m^3], given as for `alpha5_model.load`.
        gravity: As of `alpha5_model.load`, (3,) [m/s^2].
        corrections: Recorded corrections to the document.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's.
        real: Type of all numbers, ``double`` or ``float``.
        parameters: Where the arm's parameters are: ``folded`` into the code, or in a
            ``struct`` that the functions take.

    Raises:
        InputError: An arm together with corrections that it does not have.
        UnknownNameError: No such type, or no such place.
    """

    fluid_density: float = SEA_WATER
    gravity: tuple[float, float, float] = GRAVITY
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    real: str = "double"
    parameters: str = "folded"
    arm: Alpha5Parameters | None = None

    @property
    def struct(self) -> bool:
        """Whether the functions take the parameters."""
        return self.parameters == "struct"

    def __post_init__(self) -> None:
        choice("real", self.real, REALS)
        choice("parameters", self.parameters, PARAMETERS)
        if self.arm is not None:
            chosen_arm(self.arm, self.corrections)
