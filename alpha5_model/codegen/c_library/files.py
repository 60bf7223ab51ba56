"""The files of the C library for an arm."""

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


def c_files(options: COptions | None = None) -> dict[str, bytes]:
    """Name -> content of each file.

    Raises:
        InputError: A density below 0, or gravity that is not three finite numbers.
        UnknownNameError: No such correction.
        MissingDependencyError: CasADi is not installed.
    """
    # Late: Pinocchio and CasADi come with these.
    from alpha5_model.codegen.c_library import source
    from alpha5_model.dynamics.load import load

    o = options or COptions()
    arm = load(o.fluid_density, gravity=o.gravity, corrections=o.corrections)
    made = source.programs(arm, o)
    texts = {
        "alpha5.h": source.header(arm, made, o),
        "alpha5.c": source.source(arm, made, o),
        "test_alpha5.c": source.check_program(arm, made, o),
        "CMakeLists.txt": source.template("CMakeLists.txt"),
    }
    return {name: text.encode() for name, text in texts.items()}
