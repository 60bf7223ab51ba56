"""An arm in moving water as the generated kernels take it.

The kernels know the joints of the Reach Alpha 5 on a fixed base with locked jaws, any
added mass, and the drag strips of `alpha5_model.codegen.added_mass_and_drag`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.added_mass_and_drag import water_parameters
from alpha5_model.codegen.kernels import choice as kernels
from alpha5_model.numbers.hydrodynamics import DragStrip
from alpha5_model.water.forces import JointWater


class WaterKernels(NamedTuple):
    """Single calls of the kernels, with the parameters of one arm.

    They answer None to what is not plainly a state. Both are None if the kernels do not
    know the arm or its water.
    """

    inverse_dynamics: Callable[..., Any] | None
    forward_dynamics: Callable[..., Any] | None


def water_kernels(parameters: FloatArray | None) -> WaterKernels:
    """The kernels with the parameters of an arm; see `water_kernel_parameters`."""
    if parameters is None:
        return WaterKernels(inverse_dynamics=None, forward_dynamics=None)
    bind = kernels.module().bind
    return WaterKernels(
        inverse_dynamics=bind("inverse_dynamics_in_current", parameters),
        forward_dynamics=bind("forward_dynamics_in_current", parameters),
    )


def water_kernel_parameters(
    still: Any, bodies: Iterable[JointWater], added_mass: FloatArray
) -> FloatArray | None:
    """Parameters of the kernels, (125,); None if they do not know the arm or its water.

    Args:
        still: The `Arm` in still water.
        bodies: The added mass and drag of its bodies.
        added_mass: Of base_link and the four moving links, about their joints, in the
            arm's fluid, (5, 6, 6).
    """
    of_still_water = still._kernel_parameters
    strips: dict[str, list[DragStrip]] = {
        joint: [] for joint in list(still._model.names)[1:]
    }
    moving = [body for body in bodies if body.joint in strips]
    if of_still_water is None or not all(body.plain for body in moving):
        return None
    for body in moving:
        strips[body.joint] += body.data.strips

    of_moving_water = water_parameters(
        added_mass[1:], [*strips.values()], still.fluid_density, still.parameters
    )
    if of_moving_water is None:
        return None
    added, of_water = of_moving_water
    base_parameters, dimensions = np.split(of_still_water, [len(added)])
    return np.concatenate([base_parameters + added, of_water, dimensions])
