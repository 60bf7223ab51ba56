"""What the links of an arm carry, if the links themselves had other numbers."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import moments, regrouped
from alpha5_model.dynamics.arm import Arm
from alpha5_model.dynamics.kernel_numbers import moments_of_links
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody


def moments_carried(arm: Arm, record: Alpha5Parameters) -> FloatArray:
    """Moments on each link, (5, 2, 4, 4): what an arm carries, and a record's links.

    Args:
        arm: On a fixed base, with its jaws locked, in its fluid, with its payload.
        record: Of an arm with other links, which replace the arm's own.
    """
    carried = moments_of_links(arm)
    links = zip(record.links, arm.parameters.links, strict=True)
    for number, (link, own) in enumerate(links):
        if link is not own:
            change = np.subtract(
                _moments(link, arm.fluid_density), _moments(own, arm.fluid_density)
            )
            carried[number] += change
    return carried


def base_parameters_carried(arm: Arm, record: Alpha5Parameters) -> FloatArray:
    """Base parameters of the same on the joints of the record, (38,)."""
    carried = moments_carried(arm, record)
    return regrouped(carried, np.zeros(3), record)[:-3]


def _moments(link: RigidBody, density: float) -> tuple[FloatArray, FloatArray]:
    """Moments of a link."""
    return moments(link.mass, link.com, link.inertia, link.volume, link.cob, density)
