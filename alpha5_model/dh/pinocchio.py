"""The joint axes of a Pinocchio model or a URDF, from which frame assignment makes a DH table."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ET
from typing import Any

import numpy as np

from alpha5_model.checks import instance
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError
from alpha5_model.files import read_named

#: What a joint of a URDF needs in order to move.
_MOVING = ("origin", "parent", "child", "axis", "limit", "mimic")


def pinocchio_axes(model: Any, frame: str | None) -> dict[str, Any]:
    """What `DHChain.from_axes` needs to know of a pin.Model; see `DHChain.from_pinocchio`."""
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
    return {
        "points": points,
        "directions": directions,
        "sigma": sigma,
        "end_effector": data.oMf[tip].homogeneous,
        "q": np.zeros(len(path)),
        "limits": limits,
        "name": model.name,
        "joint_names": tuple(model.names[j] for j in path),
    }


def urdf_model(path: str | os.PathLike[str]) -> Any:
    """The pin.Model of a URDF file; see `DHChain.from_urdf`."""
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
        for limit in element.findall("limit"):  # which moves without the two that it asks for
            limit.attrib = {"effort": "0", "velocity": "0", **limit.attrib}
    try:
        return pin.buildModelFromXML(ET.tostring(tree, encoding="unicode"))
    except (ValueError, RuntimeError) as error:
        raise FileFormatError(path, " ".join(str(error).split())) from None
