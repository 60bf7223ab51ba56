"""Table 3 and the arm in water by Pinocchio: the reference for every other tool.

The displaced fluid is a second model. It holds the mass of the displaced fluid as a
point at each centre of buoyancy; its weight, negated, is the buoyancy.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import reference

URDF = Path(__file__).parents[2] / "urdf"
#: Table 3 by link: L, mm.
VOLUME = {f"link_{i}": volume for i, volume in enumerate(reference.VOLUME)}
COB = {f"link_{i}": cob for i, cob in enumerate(reference.COB)}


class Reference:
    """The committed URDF and the typed Table 3 in Pinocchio."""

    def __init__(
        self, density: float = 1025.0, urdf: Path = URDF / "alpha5.urdf"
    ) -> None:
        self.model = pin.buildModelFromUrdf(str(urdf))
        self.data = self.model.createData()
        self.fluid = pin.Model(self.model)
        for i in range(self.fluid.njoints):
            self.fluid.inertias[i] = pin.Inertia.Zero()
        for name, litres in VOLUME.items():
            frame = self.model.frames[self.model.getFrameId(name)]
            at = frame.placement.act(np.array(COB[name]) / 1000)
            point = pin.Inertia(density * litres / 1000, at, np.zeros((3, 3)))
            self.fluid.inertias[frame.parentJoint] += point
        self.fluid_data = self.fluid.createData()

    def tcp(self, q: np.ndarray) -> np.ndarray:
        """Pose of the TCP, (4, 4)."""
        pin.framesForwardKinematics(self.model, self.data, q)
        return self.data.oMf[self.model.getFrameId("tcp")].homogeneous

    def mass_matrix(self, q: np.ndarray) -> np.ndarray:
        upper = np.triu(pin.crba(self.model, self.data, q))
        return upper + np.triu(upper, 1).T

    def bias(self, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Coriolis, centrifugal and weight."""
        return pin.nonLinearEffects(self.model, self.data, q, v).copy()

    def buoyancy(self, q: np.ndarray) -> np.ndarray:
        """What the water applies."""
        return pin.computeGeneralizedGravity(self.fluid, self.fluid_data, q).copy()

    def acceleration(self, q: np.ndarray, v: np.ndarray, tau: np.ndarray) -> np.ndarray:
        return pin.aba(self.model, self.data, q, v, tau + self.buoyancy(q)).copy()

    def free_motion(
        self, q: np.ndarray, v: np.ndarray, duration: float, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Integrate without torque by the classical Runge-Kutta method."""
        h, zero = duration / steps, np.zeros(self.model.nv)
        for _ in range(steps):
            a1 = self.acceleration(q, v, zero)
            v2 = v + h / 2 * a1
            a2 = self.acceleration(q + h / 2 * v, v2, zero)
            v3 = v + h / 2 * a2
            a3 = self.acceleration(q + h / 2 * v2, v3, zero)
            v4 = v + h * a3
            a4 = self.acceleration(q + h * v3, v4, zero)
            q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
            v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        return q, v
