"""What the arm holds: a rigid body with its own displaced volume."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import FloatArray, bounded, real, shaped
from alpha5_model.dynamics.hydrostatics import Displacement, displacement
from alpha5_model.dynamics.vectors import vector
from alpha5_model.errors import InputError
from alpha5_model.inertia import inconsistencies

_NAME = "payload"


@dataclass(frozen=True, eq=False)
class Payload:
    """A rigid body in the frame that carries it.

    Attributes:
        mass: [kg].
        com: (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: [m^3].
        cob: (3,) [m].
    """

    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray

    @classmethod
    def checked(
        cls,
        mass: float,
        com: ArrayLike,
        inertia: ArrayLike | None,
        volume: float,
        cob: ArrayLike | None,
    ) -> Payload:
        """Check and convert; the arguments of `alpha5_model.dynamics.arm.Arm.with_payload`."""
        m, centre = real("mass", mass, minimum=0.0), vector("com", com, 3)
        tensor = np.zeros((3, 3))
        if inertia is not None:
            tensor = bounded("inertia", shaped("inertia", inertia, (3, 3)))
            wrong = inconsistencies(m, centre, tensor)
            if wrong:
                raise InputError("inertia", tensor.tolist(), f"a possible body, but {wrong[0]}")
        return cls(
            mass=m,
            com=centre,
            inertia=tensor,
            volume=real("volume", volume, minimum=0.0),
            cob=centre if cob is None else vector("cob", cob, 3),
        )

    def attached(self, model: Any, frame: str) -> tuple[Any, Displacement]:
        """A copy of the model with this body fixed to a frame, and the volume on the joint under it."""
        loaded = model.copy()
        carrier = loaded.frames[loaded.getFrameId(frame)]
        count = 1 + sum(f.name.startswith(_NAME) for f in loaded.frames)
        name = _NAME if count == 1 else f"{_NAME}_{count}"
        body = pin.Frame(
            name,
            carrier.parentJoint,
            loaded.getFrameId(frame),
            carrier.placement,
            pin.FrameType.BODY,
            pin.Inertia(self.mass, np.array(self.com), np.array(self.inertia)),
        )
        loaded.addFrame(body)  # adds the inertia to the joint, too
        return loaded, displacement(loaded, name, name, self.volume, self.cob)
