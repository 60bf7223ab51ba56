"""The load on a fixed mount, by way of a free-flyer that stays where it is: its six torques are the mount's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from alpha5_model.checks import FloatArray
from alpha5_model.dynamics import batch


class Mount:
    """A fixed-base arm and its displaced fluid, both put on a free-flyer joint.

    Attributes:
        model: pin.Model of the arm with the free-flyer; frames are left out.
        fluid: pin.Model of the displaced fluid with the free-flyer.
    """

    def __init__(self, model: Any, fluid: Any) -> None:
        self.model, self.fluid = _free_flyer(model), _free_flyer(fluid)

    def wrenches(
        self,
        pools: batch.Pools,
        threads: int | None,
        q: FloatArray,
        v: FloatArray,
        a: FloatArray,
    ) -> FloatArray:
        """Load on the mount of each row, (N, 6); see `alpha5_model.dynamics.arm.Arm.base_wrench`."""
        still = np.zeros((len(q), 6))
        pose = np.hstack([still, np.ones((len(q), 1)), q])
        v, a = np.hstack([still, v]), np.hstack([still, a])
        return -batch.inverse_dynamics(self.model, self.fluid, pools, threads, pose, v, a)[:, :6]

    def derivatives(
        self, q: FloatArray, v: FloatArray, a: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of the load with respect to q, v and a, (6, nv) each."""
        still = np.zeros(6)
        pose = np.concatenate([still, [1.0], q])
        v, a = np.concatenate([still, v]), np.concatenate([still, a])
        data = self.model.createData()  # held by name: what comes next are views of its memory
        dq, dv, da = pin.computeRNEADerivatives(self.model, data, pose, v, a)
        water = pin.computeGeneralizedGravityDerivatives(self.fluid, self.fluid.createData(), pose)
        return (water - dq)[:6, 6:], -dv[:6, 6:], -da[:6, 6:]


def _free_flyer(model: Any) -> Any:
    free = pin.Model()
    free.gravity = model.gravity
    root = free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    free.appendBodyToJoint(root, model.inertias[0], pin.SE3.Identity())
    for i in range(1, model.njoints):
        parent = model.parents[i] + 1
        joint = free.addJoint(parent, model.joints[i], model.jointPlacements[i], model.names[i])
        free.appendBodyToJoint(joint, model.inertias[i], pin.SE3.Identity())
    return free
