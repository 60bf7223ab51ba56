"""Standard DH parameters of a Pinocchio model or a URDF, by frame assignment on its joint axes."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np

from alpha5_model.checks import instance
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.files import read_named
from alpha5_model.kinematics.dh import DHChain
from alpha5_model.kinematics.frame_assignment import assign_frames

#: What a joint of a URDF needs in order to move.
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")


def dh_from_pinocchio(model: Any, frame: str | None = None, tolerance: float = 1e-9) -> DHChain:
    """The DH table of the serial chain from a model's root to one of its frames.

    Joint variables, their zero and their sign are the model's. Joints off the chain stay at zero.

    Args:
        model: pin.Model; not changed.
        frame: End effector; by default the last body frame of the last joint.
        tolerance: See `assign_frames`: URDF files round their angles.

    Raises:
        UnknownNameError: No such frame.
        InputError: A joint on the chain with other than one degree of freedom, or a helical one; or
            no joint at all.
    """
    import pinocchio as pin

    names = [f.name for f in instance("model", model, pin.Model).frames]
    if frame is None:
        last = [f for f in model.frames if f.parentJoint == model.njoints - 1]
        frame = last[-1].name
    if not isinstance(frame, str) or frame not in names:
        raise UnknownNameError("frame", frame, names)
    tip = model.getFrameId(frame)
    path = [j for j in model.supports[model.frames[tip].parentJoint] if j != 0]
    if not path:
        raise InputError("frame", frame, "a frame that a joint moves")
    data = model.createData()
    q = pin.neutral(model)
    jacobians = pin.computeJointJacobians(model, data, q).reshape(6, -1)
    pin.updateFramePlacements(model, data)
    sigma, points, directions, limits = [], [], [], []
    for j in path:
        joint = model.joints[j]
        if joint.nv != 1:
            raise InputError(model.names[j], joint.shortname(), "a revolute or prismatic joint")
        linear, angular = jacobians[:3, joint.idx_v], jacobians[3:, joint.idx_v]
        slides = not angular.any()
        # World Jacobian: linear is the velocity of the body's point at the world's origin.
        if not slides and abs(linear @ angular) > 1e-12:
            raise InputError(model.names[j], joint.shortname(), "a revolute or prismatic joint")
        sigma.append(int(slides))
        points.append(data.oMi[j].translation.copy())
        directions.append((linear if slides else angular).copy())
        if joint.nq == 1:
            lower = float(model.lowerPositionLimit[joint.idx_q])
            upper = float(model.upperPositionLimit[joint.idx_q])
            limits.append((lower, upper) if lower < upper else (-math.inf, math.inf))
        else:  # continuous: Pinocchio keeps cosine and sine
            limits.append((-math.inf, math.inf))
    return assign_frames(
        points,
        directions,
        sigma,
        data.oMf[tip].homogeneous,
        np.zeros(len(path)),
        limits,
        tolerance,
        name=model.name,
        joint_names=tuple(model.names[j] for j in path),
    )


def dh_from_urdf(
    path: str | os.PathLike[str], frame: str | None = None, tolerance: float = 1e-9
) -> DHChain:
    """The DH table of an arm described by a URDF file; see `dh_from_pinocchio`.

    Raises:
        InputError, MissingFileError, FileFormatError: The file cannot be read; see `read_urdf`, which
            names the line, and what Pinocchio says of a URDF that only it refuses.
    """
    import pinocchio as pin

    from alpha5_model.description.urdf_reading import parse_urdf

    text = read_named(path, "a URDF file")
    parse_urdf(text, str(path))
    # Written anew, since Pinocchio reads no UTF-16, and without what moves nothing: its parser would
    # complain of a picture's colour on stderr.
    tree = ET.fromstring(text)
    for element in tree:
        kept = _MOVING if element.tag == "joint" else ()
        element[:] = [child for child in element if child.tag in kept]
    try:
        model = pin.buildModelFromXML(ET.tostring(tree, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise FileFormatError(path, " ".join(str(error).split())) from None
    return dh_from_pinocchio(model, frame, tolerance)
