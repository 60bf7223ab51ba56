"""Copies of a pin.Model with one more body, or with the base on a free-flyer."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray, array, choice, real
from alpha5_model.dynamics.buoyancy import Displacement, displacement
from alpha5_model.numbers import plausibility
from alpha5_model.numbers.inertia import check_possible


class AddedBody(NamedTuple):
    """A rigid body, checked, in the frame that carries it.

    Attributes:
        mass: [kg].
        com: Centre of mass, (3,) [m].
        inertia: At the COM, URDF sign, (3, 3) [kg m^2].
        volume: Displaced volume [m^3].
        cob: Centre of buoyancy, (3,) [m].
    """

    mass: float
    com: FloatArray
    inertia: FloatArray
    volume: float
    cob: FloatArray


def added_body(
    mass: float,
    com: ArrayLike,
    inertia: ArrayLike | None,
    volume: float,
    cob: ArrayLike | None,
) -> AddedBody:
    """Check a rigid body.

    No inertia stands for a point mass, and no COB for the COM.

    Raises:
        InputError: Negative mass or volume, or an inertia that no body can have.
    """
    checked_mass = real("mass", mass, minimum=0.0)
    centre = array("com", com, 3)
    tensor = np.zeros((3, 3))
    if inertia is not None:
        tensor = array("inertia", inertia, 3, 3)
        check_possible("inertia", checked_mass, centre, tensor)
    return AddedBody(
        mass=checked_mass,
        com=centre,
        inertia=tensor,
        volume=real("volume", volume, minimum=0.0),
        cob=centre if cob is None else array("cob", cob, 3),
    )


def with_payload(
    model: pin.Model, frame: str, body: AddedBody
) -> tuple[pin.Model, Displacement]:
    """A copy of a pin.Model that holds a body, and the body's volume.

    The new frame is ``payload``, ``payload_2`` and so on.

    Warns:
        ImplausibleWarning: Numbers that seem to be in another unit.
    """
    plausibility.check_body(*body)
    return with_body(model, frame, body, "payload")


def with_body(
    model: pin.Model, frame: str, body: AddedBody, name: str
) -> tuple[Any, Displacement]:
    """A copy of a pin.Model with a body fixed to a frame, and the body's volume.

    Args:
        model: pin.Model; it is not changed.
        frame: Name of the frame that carries the body.
        body: In that frame.
        name: Of the body's new frame; further bodies of this name are numbered.

    Raises:
        UnknownNameError: No such frame.
    """
    names = [known.name for known in model.frames]
    choice("frame", frame, names)
    number = 1 + sum(known.startswith(name) for known in names)
    own_name = name if number == 1 else f"{name}_{number}"

    loaded = model.copy()
    index = loaded.getFrameId(frame)
    carrier = loaded.frames[index]
    own_frame = pin.Frame(
        own_name,
        carrier.parentJoint,
        index,
        carrier.placement,
        pin.FrameType.BODY,
        pin.Inertia(body.mass, body.com, body.inertia),
    )
    # This adds the inertia to the joint, too.
    loaded.addFrame(own_frame)
    volume = displacement(loaded, own_name, own_name, body.volume, body.cob)
    return loaded, volume


def on_free_flyer(model: pin.Model) -> pin.Model:
    """A copy of a pin.Model with its base on a free-flyer joint, ``root_joint``.

    The six torques of this joint are those of the mount.
    """
    free = pin.Model()
    root = free.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    root_frame = free.addJointFrame(root)
    out = pin.appendModel(free, model, root_frame, pin.SE3.Identity())
    out.gravity = model.gravity
    return out
