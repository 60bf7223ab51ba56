"""Models made from the arm's: with one more body, and on a free-flyer."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model.checks import bounded, choice, real, shaped
from alpha5_model.dynamics.hydrostatics import Displacement, displacement
from alpha5_model.dynamics.states import vector
from alpha5_model.errors import InputError
from alpha5_model.inertia import inconsistencies

_PAYLOAD = "payload"


def with_body(
    model: Any,
    frame: str,
    mass: float,
    com: ArrayLike,
    inertia: ArrayLike | None,
    volume: float,
    cob: ArrayLike | None,
    name: str = _PAYLOAD,
) -> tuple[Any, Displacement]:
    """A copy of a pin.Model with a rigid body fixed to a frame, and its volume on the joint below.

    Arguments and errors are those of `alpha5_model.dynamics.arm.Arm.with_payload`.
    """
    m, centre = real("mass", mass, minimum=0.0), vector("com", com, 3)
    tensor = np.zeros((3, 3))
    if inertia is not None:
        tensor = bounded("inertia", shaped("inertia", inertia, (3, 3)))
        wrong = inconsistencies(m, centre, tensor)
        if wrong:
            raise InputError("inertia", tensor.tolist(), f"a possible body, but {wrong[0]}")
    displaced = real("volume", volume, minimum=0.0)
    centroid = centre if cob is None else vector("cob", cob, 3)
    loaded, names = model.copy(), [f.name for f in model.frames]
    index = loaded.getFrameId(choice("frame", frame, names))
    carrier = loaded.frames[index]
    count = 1 + sum(known.startswith(name) for known in names)
    name = name if count == 1 else f"{name}_{count}"
    body = pin.Inertia(m, centre, tensor)
    kind = pin.FrameType.BODY
    # This adds the inertia to the joint, too.
    loaded.addFrame(pin.Frame(name, carrier.parentJoint, index, carrier.placement, kind, body))
    return loaded, displacement(loaded, name, name, displaced, centroid)


def on_free_flyer(model: Any) -> Any:
    """A pin.Model with its base on a free-flyer joint, whose six torques are those of the mount."""
    free = pin.Model()
    root = free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    out = pin.appendModel(free, model, free.addJointFrame(root), pin.SE3.Identity())
    out.gravity = model.gravity
    return out
