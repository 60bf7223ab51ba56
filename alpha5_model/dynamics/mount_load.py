"""The load of an arm on its mount, by Pinocchio."""

from __future__ import annotations

from typing import Any

import pinocchio as pin

from alpha5_model._support.checks import FloatArray
from alpha5_model.dynamics.states import Partials, forces


def base_wrench(
    arm: Any, q: FloatArray, v: FloatArray, a: FloatArray, fext: Any
) -> Any:
    """Wrench on the mount of an arm, a pin.Force in base_link; see `Arm.base_wrench`.

    Args:
        arm: An `Arm`.
        q, v, a: Its state, checked.
        fext: External forces or None, not checked.
    """
    scratch = arm._scratch
    outside = () if fext is None else (forces(fext, arm._model.njoints),)
    pin.rnea(arm._model, scratch.data, q, v, a, *outside)
    pin.computeGeneralizedGravity(arm._fluid, scratch.fluid_data, q)

    # The load of the first joint; on a floating base that is base_link itself.
    load = scratch.data.f[1] - scratch.fluid_data.f[1]
    if arm.floating_base:
        return -load

    # RNEA stops at the first joint. The last step adds the fixed bodies.
    load = arm._fixed.load + scratch.data.liMi[1].act(load)
    return outside[0][0] - load if outside else -load


def base_wrench_derivatives(
    arm: Any, q: FloatArray, v: FloatArray, a: FloatArray
) -> Partials:
    """Derivatives of `base_wrench` with respect to q, v and a, (6, nv) each."""
    tree, fluid, embedding = arm._floating_tree
    state = embedding.expand(q, v, a)
    data = arm._scratch.pool(tree).getData(0)
    fluid_data = arm._scratch.pool(fluid).getData(0)
    dq, dv, da = pin.computeRNEADerivatives(tree, data, *state)
    water = pin.computeGeneralizedGravityDerivatives(fluid, fluid_data, state[0])
    g = embedding.g
    return (water - dq)[:6] @ g, -dv[:6] @ g, -da[:6] @ g
