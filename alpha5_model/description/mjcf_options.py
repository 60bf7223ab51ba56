"""What can be chosen about the MuJoCo model."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from alpha5_model.checks import choice, real
from alpha5_model.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.description.mjcf_control import ACTUATORS
from alpha5_model.description.variants import COLLISIONS
from alpha5_model.fluids import SEA_WATER
from alpha5_model.jaws import GRIPPERS


@dataclass(frozen=True)
class MjcfOptions:
    """What can be chosen about the MuJoCo model.

    Attributes:
        gripper: ``locked`` or ``jaws``.
        fluid_density: [kg/m^3]; 0 is air. Adjustable at run time too, see the folder's README.
        actuators: ``position``, ``velocity`` or ``motor``.
        drag: Turns MuJoCo's own fluid model on. Its forces are not from the document.
        collision: ``primitives`` or ``none``.
        corrections: Recorded corrections to apply.
    """

    gripper: str = "locked"
    fluid_density: float = SEA_WATER
    actuators: str = "position"
    drag: bool = False
    collision: str = "primitives"
    corrections: Iterable[str] = DEFAULT_CORRECTIONS

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        choice("actuators", self.actuators, ACTUATORS)
        choice("collision", self.collision, COLLISIONS)
        real("fluid_density", self.fluid_density, minimum=0.0)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))
