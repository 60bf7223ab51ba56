"""Gazebo: a model and a world in SDF 1.9, with the buoyancy of Table 3.

Gazebo's buoyancy system takes the sum of a link's collision volumes as its displaced volume and the
volume-weighted mean of the collisions' pose origins as its centre of buoyancy (gz-sim,
``systems::Buoyancy``). One box per link, of exactly the printed volume and placed at the printed centre,
therefore gives Table 3. A box is also the shape for which the system's graded density works.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model.checks import choice, real
from alpha5_model.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.description.bodies import Body, Placement, arm_bodies, tcp_placement
from alpha5_model.description.meshes import mesh_assets
from alpha5_model.description.xml_text import add, document, serialized, template, text_of
from alpha5_model.fluids import SEA_WATER
from alpha5_model.jaws import GRIPPERS
from alpha5_model.parameters import Alpha5Parameters, JointRange, parameters

SDF_VERSION = "1.9"
_HEAD = '<?xml version="1.0"?>\n'


@dataclass(frozen=True)
class SdfOptions:
    """What can be chosen about the Gazebo model.

    Attributes:
        gripper: ``locked`` or ``jaws``. SDF 1.9 has no mimic joints: the fingers then move freely.
        fluid_density: Of the world [kg/m^3]; 0 is air.
        corrections: Recorded corrections to apply.
    """

    gripper: str = "locked"
    fluid_density: float = SEA_WATER
    corrections: Iterable[str] = DEFAULT_CORRECTIONS

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        real("fluid_density", self.fluid_density, minimum=0.0)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))


def sdf_files(options: SdfOptions | None = None) -> dict[str, bytes]:
    """The folder: path in it -> content.

    ``model.sdf``, ``model.config`` (what Gazebo looks for), ``world.sdf`` (the arm fixed in a uniform
    fluid), ``meshes/``.

    Raises:
        Alpha5Error: See `SdfOptions`.
    """
    chosen = options or SdfOptions()
    meshes = mesh_assets(".obj", ".mtl")
    return {
        "model.sdf": sdf(chosen, meshes).encode(),
        "model.config": template("model.config").encode(),
        "world.sdf": sdf_world(chosen, meshes).encode(),
        **{f"meshes/{name}": data for name, data in meshes.items()},
    }


def sdf(options: SdfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of the model.

    Args:
        options: What to write.
        meshes: File names of the meshes that will be in ``meshes/``; others are left out.
    """
    root, _ = _document(options or SdfOptions(), meshes)
    return _HEAD + serialized(root)


def sdf_world(options: SdfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of a world: gravity, buoyancy system, uniform fluid, and the arm fixed at base_link.

    The arm is written into it, so that no search path is needed. Arguments as for `sdf`.
    """
    chosen = options or SdfOptions()
    root, arm = _document(chosen, meshes)
    root.remove(arm)
    frame = ET.fromstring(template("world.sdf").format(density=text_of(chosen.fluid_density)))
    mounted = frame.find("model")
    assert mounted is not None
    mounted.insert(0, arm)
    root.append(frame)
    return _HEAD + serialized(root)


def _document(options: SdfOptions, meshes: Iterable[str]) -> tuple[ET.Element, ET.Element]:
    values = parameters(options.corrections)
    root = document(values, "sdf", version=SDF_VERSION)
    # base_link and tcp have no mass: frames here, because a simulated link needs some.
    names = {"canonical_link": "link_0", "placement_frame": "base_link"}
    model = add(root, "model", name="alpha5", **names)
    _frame(model, "base_link", Placement("link_0", rpy=(0.0, 0.0, -values.base_yaw + 0.0)))
    for body in arm_bodies(values, options.gripper, meshes):
        _link(model, body, values)
        if body.joint is not None:
            _joint(model, body.joint, body)
    _frame(model, "tcp", tcp_placement(values))
    return root, model


def _buoyancy_box(body: Body, values: Alpha5Parameters) -> tuple[float, float, float]:
    """Edges of a box of the body's displaced volume and of its proportions [m]."""
    jaws = values.jaws
    edges = [jaws.finger_volume / (jaws.finger_length * jaws.finger_width)]
    edges += [jaws.finger_length, jaws.finger_width]
    if not body.name.startswith("finger"):
        edges = np.ptp(values.links[int(body.name[-1])].bounds, axis=1).tolist()
    scale = math.cbrt(body.volume / math.prod(edges))
    x, y, _ = (scale * edge for edge in edges)
    return x, y, body.volume / (x * y)


def _frame(model: ET.Element, name: str, placement: Placement) -> None:
    _fill(add(model, "frame", name=name, attached_to=placement.parent), pose=_pose(placement))


def _link(model: ET.Element, body: Body, values: Alpha5Parameters) -> None:
    link = add(model, "link", name=body.name)
    if body.joint is not None:
        pose = add(link, "pose", relative_to=body.placement.parent)
        pose.text = text_of(_pose(body.placement))
    com, cob = ((*point.tolist(), 0.0, 0.0, 0.0) for point in (body.com, body.cob))
    _fill(link, inertial={"pose": com, "mass": body.mass, "inertia": body.moments})
    if body.volume > 0:
        collision = add(link, "collision", name="displaced_volume")
        _fill(collision, pose=cob, geometry={"box": {"size": _buoyancy_box(body, values)}})
    for mesh in body.meshes:
        _fill(
            add(link, "visual", name=mesh.name),
            pose=_pose(mesh.placement),
            geometry={"mesh": {"uri": f"meshes/{mesh.name}.obj"}},
            material=dict.fromkeys(("ambient", "diffuse"), mesh.material.rgba),
        )


def _joint(model: ET.Element, joint: JointRange, body: Body) -> None:
    element = add(model, "joint", name=joint.name, type=joint.kind)
    limit = {name: getattr(joint, name) for name in ("lower", "upper", "effort", "velocity")}
    axis = {"xyz": "0 0 1", "limit": limit}
    _fill(element, parent=body.placement.parent, child=body.name, axis=axis)


def _pose(placement: Placement) -> tuple[float, ...]:
    return *placement.xyz, *placement.rpy


def _fill(parent: ET.Element, /, **content: Any) -> None:
    """Child elements by name: of a text or numbers, or of a dictionary of such again."""
    for name, value in content.items():
        child = add(parent, name)
        if isinstance(value, dict):
            _fill(child, **value)
        else:
            child.text = text_of(value)
