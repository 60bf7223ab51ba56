"""A stage of UsdPhysics as a Pinocchio model, by what `UsdPhysics` itself parses.

Nothing here knows who wrote the stage: the writer of this package, or a converter.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pinocchio as pin


def usd_model(path: str) -> pin.Model:
    """The joints and masses of a stage, and a frame ``tcp`` if it has one.

    Args:
        path: The file.

    Raises:
        ValueError: A joint of an unknown type, or bodies that no joint carries.
    """
    from pxr import Usd, UsdPhysics

    stage = Usd.Stage.Open(path)
    with warnings.catch_warnings():
        # Newer versions call it otherwise.
        warnings.simplefilter("ignore", DeprecationWarning)
        parsed = UsdPhysics.LoadUsdPhysicsFromRange(stage, ["/"])
    found = {str(kind).rpartition(".")[2]: rest for kind, rest in parsed.items()}
    joints = []
    for kind in ("FixedJoint", "RevoluteJoint", "PrismaticJoint"):
        joints += [(kind, joint) for joint in found.get(kind, ((), ()))[1]]
    bodies = [str(path) for path in found["RigidBody"][0]]
    return _tree(stage, joints, bodies)


def _tree(stage: Any, joints: list[tuple[str, Any]], bodies: list[str]) -> pin.Model:
    """The model: each body's frame has its prim's path as its name."""
    model = pin.Model()
    #: Body -> number of the joint that carries it, and its pose there.
    carried: dict[str, tuple[int, pin.SE3]] = {"": (0, pin.SE3.Identity())}
    waiting = list(joints)
    while waiting:
        ready = [one for one in waiting if str(one[1].body0) in carried]
        if not ready:
            raise ValueError(f"no parent for {[str(j.primPath) for _, j in waiting]}")
        for kind, joint in ready:
            waiting.remove((kind, joint))
            _add(model, stage, kind, joint, carried)
    free = [body for body in bodies if body not in carried]
    if free:
        raise ValueError(f"no joint carries {free}")
    _add_tcp(model, stage, carried)
    return model


def _add(
    model: pin.Model,
    stage: Any,
    kind: str,
    joint: Any,
    carried: dict[str, tuple[int, pin.SE3]],
) -> None:
    """Add a joint and its body."""
    parent, in_parent = carried[str(joint.body0)]
    before = in_parent * _se3(joint.localPose0Position, joint.localPose0Orientation)
    after = _se3(joint.localPose1Position, joint.localPose1Orientation).inverse()
    name = str(joint.body1)
    if kind == "FixedJoint":
        number, placement = parent, before * after
    else:
        made = _joint_model(kind, str(joint.axis).rpartition(".")[2])
        short = str(joint.primPath).rpartition("/")[2]
        number, placement = model.addJoint(parent, made, before, short), after
    carried[name] = (number, placement)
    model.appendBodyToJoint(number, _inertia(stage, name), placement)


def _joint_model(kind: str, axis: str) -> Any:
    turns = kind == "RevoluteJoint"
    return getattr(pin, f"JointModel{'R' if turns else 'P'}{axis}")()


def _inertia(stage: Any, path: str) -> pin.Inertia:
    """Mass, centre of mass and principal moments of a body."""
    from pxr import UsdPhysics

    mass = UsdPhysics.MassAPI(stage.GetPrimAtPath(path))
    if not mass:
        return pin.Inertia.Zero()
    axes = _se3((0.0, 0.0, 0.0), mass.GetPrincipalAxesAttr().Get()).rotation
    tensor = axes @ np.diag(mass.GetDiagonalInertiaAttr().Get()) @ axes.T
    centre = np.array(mass.GetCenterOfMassAttr().Get(), dtype=float)
    return pin.Inertia(float(mass.GetMassAttr().Get()), centre, tensor)


def _se3(position: Any, turn: Any) -> pin.SE3:
    x, y, z = turn.GetImaginary()
    rotation = pin.Quaternion(turn.GetReal(), x, y, z)
    rotation.normalize()
    return pin.SE3(rotation, np.array(position, dtype=float))


def _add_tcp(model: pin.Model, stage: Any, carried: dict[str, Any]) -> None:
    """The prim ``tcp``: a body, or a frame in one."""
    from pxr import Gf, UsdGeom

    for prim in stage.Traverse():
        if prim.GetName() != "tcp" or not prim.IsA(UsdGeom.Xformable):
            continue
        body = prim
        while str(body.GetPath()) not in carried:
            body = body.GetParent()
        cache = UsdGeom.XformCache()
        inverse = cache.GetLocalToWorldTransform(body).GetInverse()
        local = Gf.Matrix4d(cache.GetLocalToWorldTransform(prim) * inverse)
        # USD's vectors are rows.
        matrix = np.array(local).T
        number, placement = carried[str(body.GetPath())]
        in_body = pin.SE3(matrix[:3, :3], matrix[:3, 3])
        frame = pin.Frame("tcp", number, placement * in_body, pin.FrameType.OP_FRAME)
        model.addFrame(frame)
        return
