"""What a body at the tcp adds to the base parameters of an arm."""

from __future__ import annotations

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model.codegen.regrouping import regrouped
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.numbers.parameters import Alpha5Parameters


def slope_by_moments_at_the_tcp(parameters: Alpha5Parameters) -> FloatArray:
    """Derivatives of the base parameters by the moments of a body in tcp, (41, 32).

    The base parameters are linear in the moments.
    """
    tool = Geometry.of(parameters).tool
    tcp_in_link_4 = np.vstack([tool, [0.0, 0.0, 0.0, 1.0]])

    columns = []
    for unit in np.eye(32).reshape(32, 2, 4, 4):
        in_link_4 = tcp_in_link_4 @ unit @ tcp_in_link_4.T
        nothing = np.zeros_like(unit)
        links = [nothing, nothing, nothing, nothing, in_link_4]
        columns.append(regrouped(links, np.zeros(3), parameters))
    return np.array(columns).T
