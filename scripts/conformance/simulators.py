"""Simulators beside those of `tools`: one function each, used in the same way."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from conformance.tools import (
    GRAVITY,
    JOINTS,
    Arrays,
    States,
    cpu_only,
    pose,
    undisturbed,
)


def mujoco_warp(files: Path, states: States) -> Arrays:
    cpu_only()
    import mujoco
    import mujoco_warp as mjw
    import warp as wp

    model = undisturbed(
        mujoco.MjModel.from_xml_path(str(files / "mjcf" / "alpha5.xml"))
    )
    count, out = len(states.q), {}
    for wet in (False, True):
        if not wet:
            water = model.body_gravcomp.copy()
            model.body_gravcomp[:] = 0.0
        else:
            model.body_gravcomp[:] = water
        there, data = mjw.put_model(model), mjw.make_data(model, nworld=count)
        data.qpos.assign(states.q.astype(np.float32))
        data.qvel.assign(states.v.astype(np.float32))
        mjw.forward(there, data)
        columns, column = np.zeros((count, 4, 4)), wp.zeros((count, 4), dtype=float)
        for j, unit in enumerate(np.eye(4, dtype=np.float32)):
            mjw.mul_m(there, data, column, wp.array(np.tile(unit, (count, 1))))
            columns[:, :, j] = column.numpy()
        force = np.einsum("nij,nj->ni", columns, data.qacc.numpy().astype(float))
        if not wet:
            out = {"mass": columns, "bias": -force}
    place, turn = data.site_xpos.numpy()[:, 0], data.site_xmat.numpy()[:, 0]
    fk = [pose(x, r) for x, r in zip(place, turn, strict=True)]
    return {**out, "fk": np.array(fk), "buoyancy": force + out["bias"]}


def newton_mjcf(files: Path, states: States) -> Arrays:
    """Kinematics, mass matrix and bias by Newton itself, the water by its solver."""
    cpu_only()
    import mujoco
    import newton

    solver = newton.solvers.SolverMuJoCo
    arm = newton.ModelBuilder()
    solver.register_custom_attributes(arm)
    arm.add_mjcf(str(files / "mjcf" / "alpha5.xml"))
    model, state, out = _newton(arm, states)
    shapes = [i for i, label in enumerate(model.shape_label) if label.endswith("/tcp")]
    bodies = state.body_q.numpy()[model.shape_body.numpy()[shapes]]
    tips = model.shape_transform.numpy()[shapes]
    fk = [_transform(b) @ _transform(t) for b, t in zip(bodies, tips, strict=True)]
    run = solver(model, disable_contacts=True)
    for name in ("ACTUATION", "LIMIT"):
        run.mjw_model.opt.disableflags |= getattr(
            mujoco.mjtDisableBit, f"mjDSBL_{name}"
        )
    run.step(state, model.state(), model.control(), None, 1e-3)
    acceleration = run.mjw_data.qacc.numpy().astype(float)
    wet = np.einsum("nij,nj->ni", out["mass"], acceleration)
    return {**out, "fk": np.array(fk), "buoyancy": wet + out["bias"]}


def newton_usd(files: Path, states: States) -> Arrays:
    """The same from USD, which has no water; the tcp is a prim in link_4."""
    cpu_only()
    import newton
    from pxr import Usd, UsdGeom

    file = str(files / "alpha5.usda")
    arm = newton.ModelBuilder()
    arm.add_usd(file)
    model, state, out = _newton(arm, states)
    links = [i for i, label in enumerate(model.body_label) if label.endswith("/link_4")]
    stage = Usd.Stage.Open(file)
    (prim,) = (prim for prim in stage.Traverse() if prim.GetName() == "tcp")
    # USD's vectors are rows.
    tip = np.array(UsdGeom.Xformable(prim).GetLocalTransformation()).T
    fk = [_transform(body) @ tip for body in state.body_q.numpy()[links]]
    return {**out, "fk": np.array(fk)}


def _newton(arm, states: States):
    """One world for each state: model, state, mass matrix and bias."""
    import newton
    import warp as wp

    count = len(states.q)
    worlds = newton.ModelBuilder()
    worlds.replicate(arm, count)
    worlds.gravity = GRAVITY
    model = worlds.finalize(device="cpu")
    state = model.state()
    state.joint_q.assign(states.q.ravel().astype(np.float32))
    state.joint_qd.assign(states.v.ravel().astype(np.float32))
    newton.eval_fk(model, state.joint_q, state.joint_qd, state)
    mass = newton.eval_mass_matrix(model, state).numpy().astype(float)[:, -4:, -4:]
    weight, coriolis = (wp.zeros(4 * count, dtype=float) for _ in range(2))
    newton.eval_inverse_dynamics_passive(
        model, state, gravity_force=weight, coriolis_force=coriolis
    )
    bias = (weight.numpy() + coriolis.numpy()).astype(float).reshape(count, 4)
    return model, state, {"mass": mass, "bias": bias}


def _transform(values) -> np.ndarray:
    """Of position and quaternion (x, y, z, w)."""
    from scipy.spatial.transform import Rotation

    return pose(values[:3], Rotation.from_quat(values[3:]).as_matrix())


def brax(files: Path, states: States) -> Arrays:
    """Its generalized pipeline, which knows no buoyancy."""
    cpu_only()
    import jax
    from brax.generalized import dynamics, pipeline
    from brax.io import mjcf

    system = mjcf.load(str(files / "mjcf_brax" / "alpha5.xml"))
    system = system.replace(gravity=jax.numpy.array(GRAVITY))

    def one(q, v):
        state = pipeline.init(system, q, v)
        return (
            state.x.pos[-1],
            state.x.rot[-1],
            state.mass_mx,
            dynamics.inverse(system, state),
        )

    place, turn, mass, bias = (
        np.asarray(array, dtype=float)
        for array in jax.jit(jax.vmap(one))(
            jax.numpy.array(states.q), jax.numpy.array(states.v)
        )
    )
    arm = system.mj_model
    tip = _transform([*arm.site_pos[0], *np.roll(arm.site_quat[0], -1)])
    frames = np.concatenate([place, np.roll(turn, -1, axis=1)], axis=1)
    return {
        "fk": np.array([_transform(f) @ tip for f in frames]),
        "mass": mass,
        "bias": bias,
    }


def dart(files: Path, states: States) -> Arrays:
    import dartpy

    loader = dartpy.utils.DartLoader()
    options = dartpy.utils.DartLoaderOptions()
    options.mDefaultRootJointType = dartpy.utils.DartLoaderRootJointType.FIXED
    loader.setOptions(options)
    arm = loader.parseSkeleton(str(files / "alpha5.urdf"))
    arm.setGravity(GRAVITY)
    order = [arm.getDof(name).getIndexInSkeleton() for name in JOINTS]
    tip = arm.getBodyNode("tcp")
    fk, mass, bias = [], [], []
    for q, v in states:
        positions, speeds = np.zeros(4), np.zeros(4)
        positions[order], speeds[order] = q, v
        arm.setPositions(positions)
        arm.setVelocities(speeds)
        fk.append(tip.getWorldTransform().matrix())
        mass.append(arm.getMassMatrix()[np.ix_(order, order)])
        bias.append(arm.getCoriolisAndGravityForces()[order])
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def sapien(files: Path, states: States) -> Arrays:
    """Without visuals, for which SAPIEN needs a GPU.

    Gravity is that which it compensates itself.
    """
    import sapien
    from sapien import physx

    text = (files / "alpha5.urdf").read_text(encoding="utf-8")
    bare = files / "without_visuals.urdf"
    bare.write_text(
        re.sub(r"<visual>.*?</visual>", "", text, flags=re.DOTALL), encoding="utf-8"
    )
    scene = sapien.Scene([physx.PhysxCpuSystem()])
    loader = scene.create_urdf_loader()
    loader.fix_root_link = True
    arm = loader.load(str(bare))
    order = [
        [joint.name for joint in arm.get_active_joints()].index(name) for name in JOINTS
    ]
    tip = next(link for link in arm.links if link.name == "tcp")
    model, fk, mass, bias = arm.create_pinocchio_model(), [], [], []
    for q, v in states:
        positions, speeds = np.zeros(4), np.zeros(4)
        positions[order], speeds[order] = q, v
        arm.set_qpos(positions)
        arm.set_qvel(speeds)
        fk.append(tip.entity_pose.to_transformation_matrix())
        mass.append(
            model.compute_generalized_mass_matrix(positions)[np.ix_(order, order)]
        )
        bias.append(arm.compute_passive_force()[order])
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}
