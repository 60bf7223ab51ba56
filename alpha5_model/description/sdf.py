"""Gazebo: a model and a world in SDF 1.9 or 1.11, with the buoyancy of Table 3.

Gazebo's buoyancy system takes the sum of a link's collision volumes as its displaced
volume and the volume-weighted mean of the collisions' pose origins as its centre of
buoyancy (gz-sim, ``systems::Buoyancy``). One box per link, of exactly the printed
volume and placed at the printed centre, therefore gives Table 3. A box is also the
shape for which the system's graded density works.

Added mass and drag, on request, are written by `alpha5_model.description.sdf_water`.
Names of plugins and their elements are those of gz-sim [gz-sim]_. A position controller
takes a ``gz.msgs.Double`` on ``/model/NAME/joint/JOINT/0/cmd_pos``.

.. [gz-sim] github.com/gazebosim/gz-sim, ``src/systems/joint_position_controller/`` and
   ``src/systems/joint_state_publisher/``.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, flag
from alpha5_model._support.spatial import Placement, rpy_from_rotation
from alpha5_model.description.assets import mesh_assets, template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.digits import rounded
from alpha5_model.description.frames import mount_placement, tcp_placement
from alpha5_model.description.options import SimulationOptions
from alpha5_model.description.sdf_water import added_mass, drag
from alpha5_model.description.srdf import named_poses
from alpha5_model.description.xml import (
    XML_HEAD,
    Nested,
    add,
    document,
    fill,
    serialized,
    text_of,
    without_armature,
)
from alpha5_model.geometry.materials import material_of
from alpha5_model.numbers.hydrodynamics import hydrodynamics
from alpha5_model.numbers.jaws import FingerJoint
from alpha5_model.numbers.motors import JointLosses, joint_losses
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange
from alpha5_model.numbers.pose import Pose

#: 1.9 is the newest version that Debian's libsdformat reads. 1.11 has ``mimic`` and
#: ``fluid_added_mass``.
SDF_VERSIONS = ("1.9", "1.11")
#: The pose to which the controllers drive until a command comes.
CONTROLLED_POSE = "home"


class Gains(NamedTuple):
    """Gains of a joint's controller: tuned, not from the document.

    Attributes:
        proportional: [N m/rad, N/m].
        derivative: [N m s/rad, N s/m]. Gazebo differentiates over one step, so that
            twice as much would be unstable at 1 ms.
    """

    proportional: float
    derivative: float


GAINS = {
    "axis_e": Gains(200.0, 4.0),
    "axis_d": Gains(200.0, 4.0),
    "axis_c": Gains(200.0, 1.0),
    "axis_b": Gains(5.0, 0.01),
    "axis_a": Gains(500.0, 2.0),
}


@dataclass(frozen=True)
class SdfOptions(SimulationOptions):
    """Options of the Gazebo model, beside those of `SimulationOptions`.

    ``hydrodynamics`` needs SDF 1.11. The parent of the mount is a frame, by which the
    model is placed; if it is ``world``, the mount is the model's pose. Friction and
    damping of an arm's joints are in the file, rotor inertia cannot be.

    Attributes:
        sdf_version: ``1.9``, in which the fingers move freely, or ``1.11``, in which
            they follow the rod.
        controllers: Adds a position controller for each driven joint, which holds
            ``home`` until a command comes, and the joint state publisher.
    """

    sdf_version: str = SDF_VERSIONS[0]
    controllers: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        flag("controllers", self.controllers)
        choice("SDF version", self.sdf_version, SDF_VERSIONS)

    @property
    def version(self) -> str:
        """SDF version of the file: hydrodynamics need 1.11."""
        return SDF_VERSIONS[1] if self.hydrodynamics else self.sdf_version


def sdf_files(options: SdfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``model.sdf``, ``model.config`` (what Gazebo looks for), ``world.sdf`` (the arm
    fixed in a uniform fluid), ``meshes/``.

    Raises:
        Alpha5Error: See `SdfOptions`.
    """
    chosen = options or SdfOptions()
    meshes = mesh_assets(".obj", ".mtl")
    arm = chosen.record
    config = template("model.config").format(name=arm.name, version=chosen.version)
    return {
        "model.sdf": sdf(chosen, meshes).encode(),
        "model.config": config.encode(),
        "world.sdf": sdf_world(chosen, meshes).encode(),
        **{f"meshes/{name}": data for name, data in meshes.items()},
    }


def sdf(options: SdfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``meshes/``; others are left
            out.
    """
    chosen = options or SdfOptions()
    arm = chosen.record
    root = _empty_document(chosen, arm)
    root.append(_model(chosen, arm, meshes))
    return XML_HEAD + serialized(root)


def sdf_world(options: SdfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of a world: gravity, buoyancy, uniform fluid, the arm fixed at base_link.

    The arm is written into it, so that no search path is needed. Arguments as for
    `sdf`.
    """
    chosen = options or SdfOptions()
    arm = chosen.record
    density = text_of(chosen.fluid_density)
    text = template("world.sdf").format(name=arm.name, density=density)
    world = ET.fromstring(text)
    mount = world[-1]
    mount.insert(0, _model(chosen, arm, meshes))

    root = _empty_document(chosen, arm)
    root.append(world)
    return XML_HEAD + serialized(root)


def _empty_document(options: SdfOptions, arm: Alpha5Parameters) -> ET.Element:
    """The root element, with comments about the sources and the start pose."""
    comments = []
    if options.hydrodynamics:
        comments.append(
            "Added mass and drag: estimated, not published: "
            "alpha5_model/numbers/estimated_hydrodynamics.toml."
        )
    comments += without_armature("SDF", arm)
    comments.append(
        "At zero, where Gazebo starts, joints are beyond their limits: "
        "start elsewhere, such as at home of the SRDF."
    )
    return document(arm, "sdf", *comments, version=options.version)


def _model(
    options: SdfOptions, arm: Alpha5Parameters, meshes: Iterable[str]
) -> ET.Element:
    """The arm as a model.

    base_link and tcp have no mass, so they are frames: a simulated link needs a mass.
    """
    bodies = arm_bodies(arm, options.gripper, meshes)
    model = ET.Element(
        "model", name=arm.name, canonical_link="link_0", placement_frame="base_link"
    )
    options.check_parent(_names(bodies))
    mount = options.mount
    if mount is not None and mount.parent == "world":
        fill(model, pose=_pose(mount_placement(mount)))
    # Adding zero turns a negative zero into zero.
    base_yaw = -arm.base_yaw + 0.0
    _add_frame(model, "base_link", Placement("link_0", rpy=(0.0, 0.0, base_yaw)))
    if mount is not None and mount.parent != "world":
        # Whoever places the model places the frame that carries the arm.
        model.set("placement_frame", mount.parent)
        _add_frame(model, mount.parent, _carrier(mount))

    losses = joint_losses(arm)
    water = hydrodynamics(options.gripper) if options.hydrodynamics else {}
    for body in bodies:
        inertial = _add_link(model, body, arm)
        if body.joint is not None:
            lost = losses.get(body.joint.name)
            _add_joint(model, body.joint, lost, body, options.version)
        if body.name in water:
            of_link = water[body.name]
            fill(inertial, fluid_added_mass=added_mass(of_link, options.fluid_density))
            damping = drag(of_link, options.fluid_density)
            _add_hydrodynamics(model, body.name, damping)
    _add_frame(model, "tcp", tcp_placement(arm))
    if options.controllers:
        _add_controllers(model, [body.joint for body in bodies if body.joint])
    return model


def _carrier(mount: Pose) -> Placement:
    """Pose in base_link of the frame that carries the arm."""
    turned_back = mount.rotation.T
    x, y, z = rounded(-turned_back @ mount.position).tolist()
    return Placement(
        parent="base_link", xyz=(x, y, z), rpy=rpy_from_rotation(turned_back)
    )


def _names(bodies: Iterable[Body]) -> list[str]:
    """Names of all frames of the model, which must differ."""
    names = ["base_link", "tcp"]
    for body in bodies:
        names.append(body.name)
        if body.joint is not None:
            names.append(body.joint.name)
    return names


def _add_frame(model: ET.Element, name: str, placement: Placement) -> None:
    frame = add(model, "frame", name=name, attached_to=placement.parent)
    fill(frame, pose=_pose(placement))


def _add_link(model: ET.Element, body: Body, arm: Alpha5Parameters) -> ET.Element:
    """Add a link; returns its inertial."""
    link = add(model, "link", name=body.name)
    if body.joint is not None:
        pose = add(link, "pose", relative_to=body.placement.parent)
        pose.text = text_of(_pose(body.placement))

    inertial = add(link, "inertial")
    fill(inertial, pose=_pose_at(body.com), mass=body.mass, inertia=body.moments)
    if body.volume > 0:
        collision = add(link, "collision", name="displaced_volume")
        box = {"size": _buoyancy_box(body, arm)}
        fill(collision, pose=_pose_at(body.cob), geometry={"box": box})
    for mesh, placement in body.meshes.items():
        color = material_of(mesh).rgba
        visual = add(link, "visual", name=mesh)
        fill(
            visual,
            pose=_pose(placement),
            geometry={"mesh": {"uri": f"meshes/{mesh}.obj"}},
            material={"ambient": color, "diffuse": color},
        )
    return inertial


def _buoyancy_box(body: Body, arm: Alpha5Parameters) -> tuple[float, float, float]:
    """Edges of a box with the body's displaced volume and its proportions [m]."""
    if body.name.startswith("finger"):
        jaws = arm.jaws
        thickness = jaws.finger_volume / (jaws.finger_length * jaws.finger_width)
        edges = [thickness, jaws.finger_length, jaws.finger_width]
    else:
        bounds = {link.name: link.bounds for link in arm.links}
        edges = np.ptp(bounds[body.name], axis=1).tolist()

    scale = math.cbrt(body.volume / math.prod(edges))
    x = float(rounded(scale * edges[0]))
    y = float(rounded(scale * edges[1]))
    return x, y, float(rounded(body.volume / (x * y)))


def _add_joint(
    model: ET.Element,
    joint: JointRange,
    losses: JointLosses | None,
    body: Body,
    version: str,
) -> None:
    element = add(model, "joint", name=joint.name, type=joint.kind)
    fill(element, parent=body.placement.parent, child=body.name)
    axis = add(element, "axis")
    limit = {
        "lower": joint.lower,
        "upper": joint.upper,
        "effort": joint.effort,
        "velocity": joint.velocity,
    }
    fill(axis, xyz="0 0 1", limit=limit)
    if losses is not None and (losses.damping or losses.friction):
        fill(axis, dynamics={"damping": losses.damping, "friction": losses.friction})
    if isinstance(joint, FingerJoint) and version != SDF_VERSIONS[0]:
        mimic = add(axis, "mimic", joint=joint.leader)
        fill(
            mimic,
            multiplier=joint.multiplier,
            offset=joint.offset,
            reference=0.0,
        )


def _add_hydrodynamics(
    model: ET.Element, link: str, damping: dict[str, Nested]
) -> None:
    """Add Gazebo's hydrodynamics system for a link.

    The added mass of the system is switched off, because it lags by a time step.
    """
    plugin = add(
        model,
        "plugin",
        filename="gz-sim-hydrodynamics-system",
        name="gz::sim::systems::Hydrodynamics",
    )
    fill(
        plugin,
        link_name=link,
        **damping,
        disable_added_mass="true",
        disable_coriolis="true",
    )


def _add_controllers(model: ET.Element, joints: Iterable[JointRange]) -> None:
    """Add a controller for each driven joint, and the publisher of all joints."""
    driven = [joint for joint in joints if not isinstance(joint, FingerJoint)]
    # The jaws are closed at their lower limit.
    positions = {joint.name: joint.lower for joint in driven}
    positions |= zip(positions, named_poses(driven)[CONTROLLED_POSE], strict=False)
    for joint in driven:
        gains = GAINS[joint.name]
        plugin = add(
            model,
            "plugin",
            filename="gz-sim-joint-position-controller-system",
            name="gz::sim::systems::JointPositionController",
        )
        fill(
            plugin,
            joint_name=joint.name,
            p_gain=gains.proportional,
            # Gazebo's own default is 0.1.
            i_gain=0.0,
            d_gain=gains.derivative,
            cmd_max=joint.effort,
            cmd_min=-joint.effort,
            initial_position=positions[joint.name],
        )
    add(
        model,
        "plugin",
        filename="gz-sim-joint-state-publisher-system",
        name="gz::sim::systems::JointStatePublisher",
    )


def _pose(placement: Placement) -> tuple[float, ...]:
    return (*placement.xyz, *placement.rpy)


def _pose_at(point: FloatArray) -> tuple[float, ...]:
    """Pose at a point, without a rotation."""
    return (*point.tolist(), 0.0, 0.0, 0.0)
