"""Gazebo: a model and a world in SDF 1.9 or 1.11, with the buoyancy of Table 3.

Gazebo's buoyancy system takes the sum of a link's collision volumes as its displaced volume and the
volume-weighted mean of the collisions' pose origins as its centre of buoyancy (gz-sim,
``systems::Buoyancy``). One box per link, of exactly the printed volume and placed at the printed centre,
therefore gives Table 3. A box is also the shape for which the system's graded density works.

On request, estimated and in SDF 1.11: added mass in ``<fluid_added_mass>``, which is about the link's origin
[SDFormat]_, and drag by Gazebo's hydrodynamics system. It takes no coefficient but those of products
``nu_j |nu_k|`` about the link's origin (``yVabsV``, negative where they brake), so its drag is the strips' for
each component of a velocity alone and near it for others. Its own added mass, a step late, is off.

.. [SDFormat] SDFormat 1.11, inertial.sdf, ``fluid_added_mass``; gz-sim, ``systems::Hydrodynamics``.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice, flag
from alpha5_model._support.spatial import Placement, cross_matrix
from alpha5_model.description.assets import mesh_assets, template
from alpha5_model.description.bodies import Body, arm_bodies
from alpha5_model.description.frames import tcp_placement
from alpha5_model.description.xml import XML_HEAD, add, document, serialized, text_of
from alpha5_model.geometry.materials import material_of
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS, check_corrections
from alpha5_model.numbers.fluids import SEA_WATER, density_of
from alpha5_model.numbers.hydrodynamics import (
    WATER_DENSITY,
    BodyHydrodynamics,
    gauss_points,
    hydrodynamics,
)
from alpha5_model.numbers.jaws import GRIPPERS, FingerJoint
from alpha5_model.numbers.parameters import Alpha5Parameters, JointRange, parameters

#: 1.9 is the most that Debian's libsdformat reads; 1.11 has ``mimic`` and ``fluid_added_mass``.
SDF_VERSIONS = ("1.9", "1.11")
#: Names of the components of a velocity in a matrix of added mass, of a force and of a velocity in damping.
_ADDED, _FORCE, _VELOCITY = "xyzpqr", "xyzkmn", "UVWPQR"
#: Share of a velocity that counts beside another one. A norm is no sum of sizes; with this one the damping is within
#: a tenth of the strips in a current and a sixth where joints move (root mean square), 0 and 1 both err by more.
_BESIDE = 0.45


@dataclass(frozen=True)
class SdfOptions:
    """What can be chosen about the Gazebo model.

    Attributes:
        gripper: ``locked`` or ``jaws``. The fingers move freely in SDF 1.9, which has no mimic joints.
        fluid_density: Of the world [kg/m^3]; 0 is air.
        corrections: Recorded corrections to apply.
        hydrodynamics: Adds drag and added mass, which are estimated, not published; in SDF 1.11.
        sdf_version: ``1.9`` or ``1.11``, in which the fingers follow the rod.
    """

    gripper: str = "locked"
    fluid_density: float = SEA_WATER
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    hydrodynamics: bool = False
    sdf_version: str = SDF_VERSIONS[0]

    def __post_init__(self) -> None:
        flag("hydrodynamics", self.hydrodynamics)
        choice("gripper", self.gripper, GRIPPERS)
        choice("SDF version", self.sdf_version, SDF_VERSIONS)
        density_of(self.fluid_density)
        object.__setattr__(self, "corrections", check_corrections(self.corrections))

    @property
    def version(self) -> str:
        """SDF version that it takes."""
        return SDF_VERSIONS[1] if self.hydrodynamics else self.sdf_version


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
        "model.config": template("model.config")
        .format(version=chosen.version)
        .encode(),
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
    return XML_HEAD + serialized(root)


def sdf_world(options: SdfOptions | None = None, meshes: Iterable[str] = ()) -> str:
    """Text of a world: gravity, buoyancy system, uniform fluid, and the arm fixed at base_link.

    The arm is written into it, so that no search path is needed. Arguments as for `sdf`.
    """
    chosen = options or SdfOptions()
    root, arm = _document(chosen, meshes)
    root.remove(arm)
    frame = ET.fromstring(
        template("world.sdf").format(density=text_of(chosen.fluid_density))
    )
    frame[-1].insert(0, arm)  # into the model that is mounted
    root.append(frame)
    return XML_HEAD + serialized(root)


def _document(
    options: SdfOptions, meshes: Iterable[str]
) -> tuple[ET.Element, ET.Element]:
    values = parameters(options.corrections)
    water = hydrodynamics(options.gripper) if options.hydrodynamics else {}
    said = "estimated, not published: published/estimated_hydrodynamics.toml of the package"
    start = "start elsewhere, such as at home of the SRDF"
    comments = [f"Added mass and drag: {said}."] if options.hydrodynamics else []
    comments.append(
        f"At zero, where Gazebo starts, joints are beyond their limits: {start}."
    )
    root = document(values, "sdf", *comments, version=options.version)
    # base_link and tcp have no mass: frames here, because a simulated link needs some.
    names = {"canonical_link": "link_0", "placement_frame": "base_link"}
    model = add(root, "model", name="alpha5", **names)
    _frame(
        model, "base_link", Placement("link_0", rpy=(0.0, 0.0, -values.base_yaw + 0.0))
    )
    for body in arm_bodies(values, options.gripper, meshes):
        moved = water.get(body.name)
        inertial = _link(model, body, values)
        if body.joint is not None:
            _joint(model, body.joint, body, options.version)
        if moved is not None:
            _fill(inertial, fluid_added_mass=_added_mass(moved, options.fluid_density))
            _drag(model, body.name, moved, options.fluid_density)
    _frame(model, "tcp", tcp_placement(values))
    return root, model


def _buoyancy_box(body: Body, values: Alpha5Parameters) -> tuple[float, float, float]:
    """Edges of a box of the body's displaced volume and of its proportions [m]."""
    jaws = values.jaws
    thick = jaws.finger_volume / (jaws.finger_length * jaws.finger_width)
    edges = [thick, jaws.finger_length, jaws.finger_width]
    if not body.name.startswith("finger"):
        edges = np.ptp(values.links[int(body.name[-1])].bounds, axis=1).tolist()
    scale = math.cbrt(body.volume / math.prod(edges))
    x, y, _ = (scale * edge for edge in edges)
    return x, y, body.volume / (x * y)


def _frame(model: ET.Element, name: str, placement: Placement) -> None:
    _fill(
        add(model, "frame", name=name, attached_to=placement.parent),
        pose=_pose(placement),
    )


def _added_mass(water: BodyHydrodynamics, density: float) -> dict[str, float]:
    matrix = water.added_mass * (density / WATER_DENSITY)
    pairs = combinations_with_replacement(range(6), 2)
    return {_ADDED[i] + _ADDED[j]: matrix[i, j] for i, j in pairs}


def _drag(
    model: ET.Element, link: str, water: BodyHydrodynamics, density: float
) -> None:
    """Quadratic damping about and in the link's frame: force i is ``D[i, j, k] nu_j |nu_k|``.

    Exact for each component of the velocity alone, linear before angular; never adds energy.
    """
    out = np.zeros((6, 6, 6))
    mix = _BESIDE + (1 - _BESIDE) * np.eye(6)
    for strip in water.strips:
        line = strip.end - strip.start
        length = float(np.linalg.norm(line))
        along = np.outer(line, line) / length**2
        for point, share in gauss_points(
            strip, 8
        ):  # in a file, where more cost nothing
            velocity = np.hstack([np.eye(3), -cross_matrix(point)])
            for part, drag in ((np.eye(3) - along, strip.across), (along, strip.along)):
                slip = part @ velocity
                face = density / 2 * drag * strip.diameter * length * share
                sizes = np.linalg.norm(slip, axis=0)
                out -= face * (slip.T @ slip)[:, :, None] * sizes * mix
    system = {
        "filename": "gz-sim-hydrodynamics-system",
        "name": "gz::sim::systems::Hydrodynamics",
    }
    felt = np.argwhere(np.abs(out) > 1e-9 * np.abs(out).max()).tolist()
    named = {
        f"{_FORCE[i]}{_VELOCITY[j]}abs{_VELOCITY[k]}": out[i, j, k] for i, j, k in felt
    }
    off = dict.fromkeys(("disable_added_mass", "disable_coriolis"), "true")
    _fill(add(model, "plugin", **system), link_name=link, **named, **off)


def _link(model: ET.Element, body: Body, values: Alpha5Parameters) -> ET.Element:
    """Adds a link; returns its inertial."""
    link = add(model, "link", name=body.name)
    if body.joint is not None:
        pose = add(link, "pose", relative_to=body.placement.parent)
        pose.text = text_of(_pose(body.placement))
    com, cob = ((*point.tolist(), 0.0, 0.0, 0.0) for point in (body.com, body.cob))
    inertial = add(link, "inertial")
    _fill(inertial, pose=com, mass=body.mass, inertia=body.moments)
    if body.volume > 0:
        collision = add(link, "collision", name="displaced_volume")
        _fill(
            collision, pose=cob, geometry={"box": {"size": _buoyancy_box(body, values)}}
        )
    for mesh, at in body.meshes.items():
        look = dict.fromkeys(("ambient", "diffuse"), material_of(mesh).rgba)
        shape = {"mesh": {"uri": f"meshes/{mesh}.obj"}}
        _fill(
            add(link, "visual", name=mesh),
            pose=_pose(at),
            geometry=shape,
            material=look,
        )
    return inertial


def _joint(model: ET.Element, joint: JointRange, body: Body, version: str) -> None:
    element = add(model, "joint", name=joint.name, type=joint.kind)
    limit = {
        name: getattr(joint, name) for name in ("lower", "upper", "effort", "velocity")
    }
    _fill(element, parent=body.placement.parent, child=body.name)
    axis = add(element, "axis")
    _fill(axis, xyz="0 0 1", limit=limit)
    if isinstance(joint, FingerJoint) and version != SDF_VERSIONS[0]:
        line = {
            "multiplier": joint.multiplier,
            "offset": joint.offset,
            "reference": 0.0,
        }
        _fill(add(axis, "mimic", joint=joint.leader), **line)


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
