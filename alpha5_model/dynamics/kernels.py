"""An arm for the generated kernels: its base parameters, and many states at once.

The kernels know the joints and frames of the Reach Alpha 5 on a fixed base with locked jaws; bodies,
payloads included, fluid and gravity are parameters.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model import kernels
from alpha5_model.base_parameters import base_parameters
from alpha5_model.checks import FloatArray
from alpha5_model.description.bodies import joint_placements, tcp_placement
from alpha5_model.dynamics.batch import thread_count
from alpha5_model.dynamics.hydrostatics import Displacement
from alpha5_model.dynamics.states import rows
from alpha5_model.errors import InputError
from alpha5_model.parameters import RigidBody, parameters
from alpha5_model.spatial import pose

#: How far a frame may be from where the kernels have it: what rounding does to the numbers of a URDF.
_ROUNDING = 1e-14


def kernel_parameters(
    model: Any, displaced: Iterable[Displacement], density: float
) -> FloatArray | None:
    """Base parameters of an arm, (41,); None if the kernels do not know its joints.

    Args:
        model: pin.Model.
        displaced: The volumes on its joints.
        density: Of the fluid [kg/m^3].
    """
    if not _known(model):
        return None
    volumes: list[list[Displacement]] = [[] for _ in model.names]
    for body in displaced:
        volumes[model.getJointId(body.joint)].append(body)
    links = []
    for name, inertia, there in zip(model.names, model.inertias, volumes, strict=True):
        volume = sum(body.volume for body in there)
        moment = sum((body.volume * body.cob for body in there), np.zeros(3))
        cob = moment / (volume or 1.0)
        links.append(RigidBody(name, inertia.mass, inertia.lever, inertia.inertia, volume, cob))
    return base_parameters(links, density, model.gravity.linear)


def _known(model: Any) -> bool:
    if [joint.shortname() for joint in list(model.joints)[1:]] != ["JointModelRZ"] * 4:
        return False
    arm, tip = parameters(), model.getFrameId("tcp")
    if tip == model.nframes or list(model.parents) != [0, 0, 1, 2, 3]:
        return False
    frame = model.frames[tip]
    ours = [pose(at.xyz, at.rpy) for at in (*joint_placements(arm), tcp_placement(arm))]
    theirs = [at.homogeneous for at in (*list(model.jointPlacements)[1:], frame.placement)]
    return bool(
        frame.parentJoint == 4
        and np.abs(np.subtract(ours, theirs)).max() < _ROUNDING
        and not np.any([*model.armature, *model.gravity.angular])
    )


def kernel_rows(
    arm: Any,
    name: str,
    columns: int,
    threads: int | None,
    parameters: FloatArray | None = None,
    **given: ArrayLike,
) -> FloatArray | None:
    """A kernel's output for each row of q and its rates, (N, columns); of the arm's base parameters unless told others.

    None where the kernels do not know the arm. Errors are those of `rows` and `thread_count`.
    """
    parameters = arm._kernel_parameters if parameters is None else parameters
    if parameters is None:
        return None
    if name == "forward_kinematics":
        parameters = np.empty(0)
    states: list[Any] = [*given.values()]
    run = kernels.module().batch
    plain = type(states[0]) is np.ndarray and states[0].ndim == 2
    out = np.empty((len(states[0]), columns)) if plain else None
    if out is None or not run(name, parameters, *states, out):
        states = rows(arm._model, **given)
        out = np.empty((len(states[0]), columns))
        run(name, parameters, *states, out)
    thread_count(threads, len(out))
    return out


def arm_parameters(arm: Any) -> FloatArray:
    """Base parameters of an arm, its fluid, gravity and payloads, (41,).

    Raises:
        InputError: The kernels do not know its joints: a floating base, or jaws that move.
    """
    if arm._kernel_parameters is None:
        raise InputError("arm", arm, "one on a fixed base with its jaws locked")
    return np.array(arm._kernel_parameters)
