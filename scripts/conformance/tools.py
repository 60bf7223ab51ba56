"""One function per tool: load a generated file, return what the tool computes.

No function here knows the right answer. Each takes the folder of generated files and
the states, and returns named arrays: ``fk`` (N, 4, 4), ``mass`` (N, 4, 4), ``bias`` (N,
4), ``buoyancy`` (N, 4) and ``trajectory`` (4,); a quantity that a tool does not compute
by itself is left out.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Arrays = dict[str, np.ndarray]
GRAVITY = (0.0, 0.0, -9.81)
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")


@dataclass(frozen=True)
class States:
    """What is asked: configurations and speeds (N, 4), and a free motion in water.

    Attributes:
        q, v: [rad], [rad/s].
        start: First q and v of the motion, (2, 4).
        duration: Of the motion [s].
        steps: Of a fourth-order Runge-Kutta integration over it.
    """

    q: np.ndarray
    v: np.ndarray
    start: np.ndarray
    duration: float
    steps: int

    def __iter__(self):
        return zip(self.q, self.v, strict=True)


def mujoco_urdf(files: Path, states: States) -> Arrays:
    import mujoco

    text = (files / "alpha5.urdf").read_text(encoding="utf-8")
    settings = (
        '<mujoco><compiler fusestatic="false" discardvisual="true"/></mujoco></robot>'
    )
    model = mujoco.MjModel.from_xml_string(text.replace("</robot>", settings))
    out = _mujoco(model, states, lambda data: data.body("tcp"))
    del out["buoyancy"]  # URDF has no place for it
    return out


def mujoco_mjcf(files: Path, states: States) -> Arrays:
    import mujoco

    model = mujoco.MjModel.from_xml_path(str(files / "mjcf" / "alpha5.xml"))
    out = _mujoco(model, states, lambda data: data.site("tcp"))
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    model.opt.timestep = states.duration / states.steps
    data = mujoco.MjData(model)
    data.qpos, data.qvel = states.start
    mujoco.mj_step(model, data, nstep=states.steps)
    return {**out, "trajectory": data.qpos.copy()}


def _mujoco(model, states: States, tip) -> Arrays:
    import mujoco

    undisturbed(model).opt.gravity = GRAVITY
    data, columns = mujoco.MjData(model), np.zeros((4, 4))
    out: dict[str, list[np.ndarray]] = {
        "fk": [],
        "mass": [],
        "bias": [],
        "buoyancy": [],
    }
    water = model.body_gravcomp.copy()
    for q, v in states:
        data.qpos, data.qvel = q, v
        model.body_gravcomp[:] = 0.0
        mujoco.mj_forward(model, data)
        for column, unit in zip(columns, np.eye(4), strict=True):
            mujoco.mj_mulM(model, data, column, unit)
        frame = tip(data)
        out["fk"].append(pose(frame.xpos, frame.xmat.reshape(3, 3)))
        out["mass"].append(columns.copy())
        # From the acceleration, not from a field on the way to it.
        dry = -columns @ data.qacc
        out["bias"].append(dry)
        model.body_gravcomp[:] = water
        mujoco.mj_forward(model, data)
        out["buoyancy"].append(columns @ data.qacc + dry)
    return {name: np.array(rows) for name, rows in out.items()}


def mjx(files: Path, states: States) -> Arrays:
    cpu_only()
    import jax
    import mujoco
    from mujoco import mjx

    file = str(files / "mjcf_mjx" / "scene.xml")
    _same_contacts(mujoco.MjModel.from_xml_path(file), states)
    model = undisturbed(mujoco.MjModel.from_xml_path(file))
    water, air = (mjx.put_model(_with_gravcomp(model, wet)) for wet in (True, False))

    def one(q, v):
        dry = mjx.forward(air, mjx.make_data(air).replace(qpos=q, qvel=v))
        wet = mjx.forward(water, mjx.make_data(water).replace(qpos=q, qvel=v))
        mass = mjx.full_m(air, dry)
        return (
            dry.site_xpos[0],
            dry.site_xmat[0],
            mass,
            -mass @ dry.qacc,
            mass @ wet.qacc,
        )

    batch = jax.jit(jax.vmap(one))(jax.numpy.array(states.q), jax.numpy.array(states.v))
    xpos, xmat, mass, bias, wet = (np.asarray(array, dtype=float) for array in batch)
    fk = np.array([pose(x, r.reshape(3, 3)) for x, r in zip(xpos, xmat, strict=True)])
    return {"fk": fk, "mass": mass, "bias": bias, "buoyancy": wet + bias}


def _same_contacts(model, states: States) -> None:
    """Refuse an MJX whose contacts are not MuJoCo's in each state.

    Raises:
        ValueError: Another depth, or no contact in any state.
    """
    import jax
    import mujoco
    from mujoco import mjx

    there = mjx.put_model(model)
    step = jax.jit(
        lambda q: mjx.forward(there, mjx.make_data(there).replace(qpos=q)).contact.dist
    )
    data = mujoco.MjData(model)
    touched = 0
    for q in states.q:
        data.qpos = q
        mujoco.mj_forward(model, data)
        depths = np.sort(data.contact.dist[data.contact.dist < 0])
        found = np.asarray(step(jax.numpy.array(q)), dtype=float).ravel()
        found = np.sort(found[found < 0])
        touched += len(depths)
        # A contact that just begins is one for one of them only.
        deep, found = depths[depths < -1e-5], found[found < -1e-5]
        if len(deep) != len(found) or not np.allclose(deep, found, atol=1e-5):
            raise ValueError(f"contacts at {q}: {found}, MuJoCo has {deep}")
    if not touched:
        raise ValueError("no state has a contact")


def _with_gravcomp(model, wet: bool):
    import copy

    changed = copy.copy(model)
    if not wet:
        changed.body_gravcomp[:] = 0.0
    return changed


class NotBuiltError(Exception):
    """The tool is installed without what reads the file."""


def pinocchio_mjcf(files: Path, states: States) -> Arrays:
    """Its own reader; it knows no buoyancy."""
    import pinocchio as pin

    return _pinocchio(
        pin.buildModelFromMJCF(str(files / "mjcf" / "alpha5.xml")), states
    )


def pinocchio_sdf(files: Path, states: States) -> Arrays:
    import pinocchio as pin

    if not pin.WITH_SDFORMAT:
        raise NotBuiltError("built without SDFormat")
    model, *_ = pin.buildModelsAndConstraintsFromSdf(
        str(files / "sdf" / "model.sdf"), root_link_name="base_link", geometry_types=[]
    )
    return _pinocchio(model, states)


def _pinocchio(model, states: States) -> Arrays:
    import pinocchio as pin

    data, tip = model.createData(), model.getFrameId("tcp")
    order = [model.joints[model.getJointId(name)].idx_v for name in JOINTS]
    mixed = np.ix_(order, order)
    fk, mass, bias = [], [], []
    for q, v in states:
        position, velocity = np.zeros(4), np.zeros(4)
        position[order] = q
        velocity[order] = v
        pin.framesForwardKinematics(model, data, position)
        fk.append(data.oMf[tip].homogeneous.copy())
        mass.append(pin.crba(model, data, position)[mixed])
        bias.append(pin.nonLinearEffects(model, data, position, velocity)[order])
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def usd_physics(files: Path, states: States) -> Arrays:
    """What UsdPhysics parses of the file, computed by Pinocchio."""
    from conformance.usd_reading import usd_model

    return _pinocchio(usd_model(str(files / "alpha5.usda")), states)


def drake_mjcf(files: Path, states: States) -> Arrays:
    """Without buoyancy, and without sites: the tcp is put on link_4 as in the file."""
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.math import RigidTransform

    file = files / "mjcf" / "alpha5.xml"
    site = ET.parse(file).find(".//body[@name='link_4']/site[@name='tcp']").attrib
    position, turn = (
        [float(x) for x in site[name].split()] for name in ("pos", "quat")
    )
    tcp = RigidTransform(Quaternion(np.array(turn) / np.linalg.norm(turn)), position)
    return _drake(file, states, at=("link_4", tcp))


def drake_urdf(files: Path, states: States) -> Arrays:
    return _drake(files / "alpha5.urdf", states)


def drake_sdf(files: Path, states: States) -> Arrays:
    return _drake(files / "sdf" / "model.sdf", states)


def _drake(file: Path, states: States, at=None) -> Arrays:
    """``at``: link and pose of the tcp in MJCF, whose base stands; other bases are
    welded here.
    """
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import FixedOffsetFrame, MultibodyForces

    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(file))
    if at is None:
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    else:
        link, placement = at
        plant.AddFrame(FixedOffsetFrame("tcp", plant.GetFrameByName(link), placement))
    plant.mutable_gravity_field().set_gravity_vector(GRAVITY)
    plant.Finalize()
    order = [plant.GetJointByName(name).velocity_start() for name in JOINTS]
    context, tip = plant.CreateDefaultContext(), plant.GetFrameByName("tcp")
    fk, mass, bias = [], [], []
    for q, v in states:
        for name, angle, speed in zip(JOINTS, q, v, strict=True):
            joint = plant.GetJointByName(name)
            joint.set_angle(context, angle)
            joint.set_angular_rate(context, speed)
        forces = MultibodyForces(plant)
        plant.CalcForceElementsContribution(context, forces)
        fk.append(tip.CalcPoseInWorld(context).GetAsMatrix4())
        mass.append(plant.CalcMassMatrix(context)[np.ix_(order, order)])
        bias.append(plant.CalcInverseDynamics(context, np.zeros(4), forces)[order])
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def pybullet_urdf(files: Path, states: States) -> Arrays:
    import pybullet

    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setGravity(*GRAVITY)
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    arm = pybullet.loadURDF(str(files / "alpha5.urdf"), useFixedBase=True, flags=flags)
    infos = [pybullet.getJointInfo(arm, i) for i in range(pybullet.getNumJoints(arm))]
    number = {info[1].decode(): info[0] for info in infos}
    tip = next(info[0] for info in infos if info[12].decode() == "tcp")
    order = [number[name] for name in JOINTS]
    fk, mass, bias = [], [], []
    for q, v in states:
        for i, angle, speed in zip(order, q, v, strict=True):
            pybullet.resetJointState(arm, i, angle, speed)
        link = pybullet.getLinkState(arm, tip, computeForwardKinematics=True)
        rotation = np.array(pybullet.getMatrixFromQuaternion(link[5])).reshape(3, 3)
        fk.append(pose(link[4], rotation))
        mass.append(pybullet.calculateMassMatrix(arm, list(q)))
        bias.append(pybullet.calculateInverseDynamics(arm, list(q), list(v), [0.0] * 4))
    pybullet.disconnect(client)
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def roboticstoolbox_urdf(files: Path, states: States) -> Arrays:
    import roboticstoolbox

    robot = roboticstoolbox.ERobot.URDF(str((files / "alpha5.urdf").resolve()))
    fk, mass, bias = [], [], []
    for q, v in states:
        fk.append(robot.fkine(q, end="tcp").A)
        mass.append(robot.inertia(q))
        # with its own default gravity: the sign of the argument differs between
        # versions
        bias.append(robot.rne(q, v, np.zeros(4)))
    return {"fk": np.array(fk), "mass": np.array(mass), "bias": np.array(bias)}


def yourdfpy_urdf(files: Path, states: States) -> Arrays:
    import yourdfpy

    robot = yourdfpy.URDF.load(
        str(files / "alpha5.urdf"), load_meshes=False, build_collision_scene_graph=False
    )
    fk = []
    for q, _ in states:
        robot.update_cfg(dict(zip(JOINTS, q, strict=True)))
        fk.append(robot.get_transform("tcp", "base_link"))
    return {"fk": np.array(fk)}


def urchin_urdf(files: Path, states: States) -> Arrays:
    import urchin

    robot = urchin.URDF.load(str(files / "alpha5.urdf"), lazy_load_meshes=True)
    poses = [
        robot.link_fk(dict(zip(JOINTS, q, strict=True)), link="tcp") for q, _ in states
    ]
    return {"fk": np.array(poses)}


def pose(position, rotation) -> np.ndarray:
    """(4, 4) of a position and a rotation matrix."""
    matrix = np.eye(4)
    matrix[:3, 3], matrix[:3, :3] = position, rotation
    return matrix


def undisturbed(model):
    """The MuJoCo model without contacts, limits and actuators."""
    import mujoco

    for name in ("CONTACT", "LIMIT", "ACTUATION"):
        model.opt.disableflags |= getattr(mujoco.mjtDisableBit, f"mjDSBL_{name}")
    return model


def cpu_only() -> None:
    """JAX looks for no accelerator."""
    os.environ.setdefault("JAX_PLATFORMS", "cpu")
