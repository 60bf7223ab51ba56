"""Libraries of kinematics, dynamics and control: one function each, as in `tools`."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from conformance.tools import GRAVITY, JOINTS, Arrays, States, cpu_only


def adam(files: Path, states: States) -> Arrays:
    """For floating bases: the base stands still, its rows are left out."""
    from adam.numpy import KinDynComputations

    gravity = np.array([*GRAVITY, 0.0, 0.0, 0.0])
    arm = KinDynComputations(str(files / "alpha5.urdf"), list(JOINTS), gravity=gravity)
    base, still = np.eye(4), np.zeros(6)
    fk, mass, bias = [], [], []
    for q, v in states:
        fk.append(arm.forward_kinematics("tcp", base, q))
        mass.append(arm.mass_matrix(base, q)[6:, 6:])
        bias.append(arm.bias_force(base, q, still, v)[6:])
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def mink(files: Path, states: States) -> Arrays:
    """The pose of its frame task: it leaves dynamics to MuJoCo."""
    import mink
    import mujoco

    arm = mink.Configuration(
        mujoco.MjModel.from_xml_path(str(files / "mjcf" / "alpha5.xml"))
    )
    fk = []
    for q, _ in states:
        arm.update(q)
        fk.append(arm.get_transform_frame_to_world("tcp", "site").as_matrix())
    return {"fk": np.array(fk)}


def urdf2casadi(files: Path, states: States) -> Arrays:
    from urdf2casadi.urdfparser import URDFparser

    arm = URDFparser()
    arm.from_file(str(files / "alpha5.urdf"))
    ends = "base_link", "tcp"
    place = arm.get_forward_kinematics(*ends)["T_fk"]
    inertia = arm.get_inertia_matrix_crba(*ends)
    torque = arm.get_inverse_dynamics_rnea(*ends, gravity=list(GRAVITY))
    q, v = states.q.T, states.v.T
    count = len(states.q)
    fk, mass = (
        np.array(function(q)).reshape(4, count, 4).swapaxes(0, 1)
        for function in (place, inertia)
    )
    return {"fk": fk, "mass": mass, "bias": np.array(torque(q, v, 0 * q)).T}


def frax(files: Path, states: States) -> Arrays:
    """Its frames are those of joints: the tcp is not among them."""
    os.environ["JAX_ENABLE_X64"] = "1"
    cpu_only()
    import jax
    from frax import Manipulator

    arm = Manipulator(str(files / "alpha5.urdf"), joint_ordering=list(JOINTS))
    mass = jax.jit(jax.vmap(arm.mass_matrix))(states.q)
    bias = jax.jit(jax.vmap(arm.nonlinear_bias))(states.q, states.v)
    return {"mass": np.asarray(mass), "bias": np.asarray(bias)}


def pytorch_kinematics(files: Path, states: States) -> Arrays:
    import pytorch_kinematics
    import torch

    text = (files / "alpha5.urdf").read_bytes()
    chain = pytorch_kinematics.build_serial_chain_from_urdf(text, "tcp", "base_link")
    chain = chain.to(dtype=torch.float64)
    order = [chain.get_joint_parameter_names().index(name) for name in JOINTS]
    q = np.empty_like(states.q)
    q[:, order] = states.q
    return {"fk": chain.forward_kinematics(torch.tensor(q)).get_matrix().numpy()}
