"""The arm as a tree of bodies: what every writer, YAML, MJCF, SDF and GLB, walks along; and what writers of XML share.

Beside what URDF knows it holds the displaced volume and the centre of buoyancy of each body.

Where the frames are: inertial frame {i+1} is DH frame {i} turned by the joint (Section 2), so joint i
turns about +z of its child link, and the rest of the DH row, ``Tz(d) Tx(a) Rx(alpha)``, leads on to the
next joint.
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from dataclasses import dataclass, fields
from itertools import combinations_with_replacement
from pathlib import Path

from alpha5_model import __version__
from alpha5_model._support.checks import choice
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.spatial import Placement, Triple
from alpha5_model.errors import MissingFileError, PublishedDataError
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import GRIPPERS, split_link_4
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    DHParameters,
    JointRange,
    RigidBody,
)
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.tables import BODY_NAMES

#: Bodies that are drawn; the rod is not.
MESHES = (*BODY_NAMES, "finger_1", "finger_2")
#: What an attribute may be: a text, a number, or numbers; None is left out.
Value = str | float | Iterable[float] | None
XML_HEAD = '<?xml version="1.0"?>\n'


@dataclass(frozen=True, eq=False)
class Body(RigidBody):
    """One rigid body in the tree.

    Attributes:
        placement: Parent body and pose in it, joint at zero.
        joint: About or along +z of the body; None for link_0, which is fixed in base_link.
        meshes: What it looks like: name of a mesh -> its pose in the body.
        shapes: What it collides with.
    """

    placement: Placement
    joint: JointRange | None
    meshes: dict[str, Placement]
    shapes: tuple[Primitive, ...]

    @property
    def moments(self) -> dict[str, float]:
        """The tensor's upper half, ``ixx`` to ``izz``, as URDF and SDF name it [kg m^2]."""
        pairs = combinations_with_replacement(range(3), 2)
        return {f"i{'xyz'[i]}{'xyz'[j]}": float(self.inertia[i, j]) for i, j in pairs}


def arm_bodies(
    parameters: Alpha5Parameters, gripper: str, meshes: Iterable[str] | None = None
) -> tuple[Body, ...]:
    """The bodies, each after its parent.

    Args:
        parameters: The arm's parameters.
        gripper: ``locked`` (link_0 to link_4) or ``jaws`` (adds rod and fingers).
        meshes: File names of the meshes that are there, others are left out; all if None.
    """
    moving = choice("gripper", gripper, GRIPPERS) == "jaws"
    jaws = split_link_4(parameters)
    hinges = {}
    for hung, joint in zip(jaws.bodies[1:], jaws.joints, strict=True):
        x, y, z = hung.origin.tolist()
        # Closed, the joint is at its lower limit; rod and fingers have +z along -z or across link_4's.
        hinges[hung.name] = Placement(
            "link_4", (x, y, z + joint.lower), (hung.roll, 0.0, 0.0)
        )
    records = (*parameters.links[:4], *jaws.bodies) if moving else parameters.links
    placements = (
        base_placement(parameters),
        *joint_placements(parameters),
        *hinges.values(),
    )
    joints = (None, *parameters.joints[:4], *jaws.joints)
    there = {
        name.removesuffix(".obj") for name in (MESHES if meshes is None else meshes)
    }
    shapes = collision_primitives(gripper)
    bodies = []
    for record, placement, moved in zip(records, placements, joints, strict=False):
        drawn = {record.name: Placement(record.name)}
        if record.name == "link_4" and not moving:  # the closed fingers
            drawn |= {name: hinges[name] for name in ("finger_1", "finger_2")}
        own = {field.name: getattr(record, field.name) for field in fields(RigidBody)}
        seen = {name: at for name, at in drawn.items() if name in there}
        touched = shapes.get(record.name, ())
        bodies.append(
            Body(**own, placement=placement, joint=moved, meshes=seen, shapes=touched)
        )
    return tuple(bodies)


def base_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of link_0 in base_link, DH frame {0}."""
    return Placement("base_link", rpy=(0.0, 0.0, parameters.base_yaw))


def joint_placements(parameters: Alpha5Parameters) -> tuple[Placement, ...]:
    """Pose of each child link at joint position zero, ``axis_e`` to ``axis_b``."""
    dh = parameters.dh
    first = Placement(
        "link_0", rpy=_turn(0.0, dh[0].theta_offset - parameters.base_yaw)
    )
    return (first, *(_after(i - 1, dh[i - 1], dh[i].theta_offset) for i in (1, 2, 3)))


def tcp_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of the TCP, DH frame {5}, in link_4."""
    wrist, last = parameters.dh[3], parameters.dh[4]
    if last.variable is not None or any((last.d, last.a, last.alpha)):
        raise PublishedDataError(
            "Table 1, link 4", "expected a fixed rotation about z only"
        )
    return _after(3, wrist, last.theta_offset)


def fixed_frames(parameters: Alpha5Parameters) -> dict[str, Placement]:
    """Frames that stand still in their parents: link_0, tcp, and the DH frames, ``dh_1`` to ``dh_5``."""
    frames = {"link_0": base_placement(parameters), "tcp": tcp_placement(parameters)}
    frames |= {
        f"dh_{i + 1}": _after(i, row, 0.0) for i, row in enumerate(parameters.dh[:4])
    }
    return frames | {
        "dh_5": Placement("dh_4", rpy=(0.0, 0.0, parameters.dh[4].theta_offset))
    }


def _after(i: int, row: DHParameters, angle: float) -> Placement:
    """What follows joint i in its DH row, and a turn about z."""
    return Placement(f"link_{i + 1}", (row.a, 0.0, row.d), _turn(row.alpha, angle))


def _turn(alpha: float, beta: float) -> Triple:
    """Roll, pitch, yaw of ``Rx(alpha) Rz(beta)``, exact for alpha a multiple of pi/2.

    ``Rx(alpha) Rz(beta) Rx(-alpha)`` turns by beta about ``(0, -sin alpha, cos alpha)``, which is
    then a coordinate axis. Reading the angles off the matrix instead would fail at axis_b, where
    the pitch is pi/2.
    """
    sine, cosine = round(math.sin(alpha)), round(math.cos(alpha))
    if abs(sine) + abs(cosine) != 1:
        raise PublishedDataError(
            "Table 1", f"alpha = {alpha} rad is not a multiple of pi/2"
        )
    return (alpha, -sine * beta + 0.0, cosine * beta + 0.0)


def provenance(parameters: Alpha5Parameters) -> dict[str, str]:
    """Where the numbers come from: document, package and corrections."""
    source = published().table_2.source
    edition = f"{source.publisher}, {source.document}, version {source.version}, {source.date}"
    names = ", ".join(parameters.corrections) or "none"
    return {
        "document": edition,
        "package": f"alpha5_model {__version__}",
        "corrections": names,
    }


def text_of(value: str | float | Iterable[float]) -> str:
    """A text as it is; numbers separated by spaces, each so that it reads back as the same double."""
    if isinstance(value, str):
        return value
    return " ".join(
        repr(float(x)) for x in (value if isinstance(value, Iterable) else (value,))
    )


def add(
    parent: ET.Element, tag: str, class_: Value = None, /, **attributes: Value
) -> ET.Element:
    """A new child element with these attributes, ``class`` first."""
    given = {"class": class_, **attributes}
    return ET.SubElement(
        parent, tag, {k: text_of(v) for k, v in given.items() if v is not None}
    )


def document(
    values: Alpha5Parameters, tag: str, *more: str, **attributes: str
) -> ET.Element:
    """A root element with comments that say where the numbers are from, and more."""
    root, source = ET.Element(tag, attributes), provenance(values)
    by = f"By: {source['package']}. Corrections: {source['corrections']}."
    for comment in (f"Generated from: {source['document']}.", by, *more):
        root.append(ET.Comment(f" {comment} "))
    return root


def template(name: str) -> str:
    """Text of a file in ``templates/``."""
    return (Path(__file__).with_name("templates") / name).read_text(encoding="utf-8")


def serialized(root: ET.Element) -> str:
    """The indented text of a document."""
    ET.indent(root)
    return ET.tostring(root, encoding="unicode") + "\n"


def mesh_assets(*suffixes: str) -> dict[str, bytes]:
    """Name -> content of the files in ``meshes/`` that end in one of the suffixes.

    Raises:
        MissingFileError: There are none.
    """
    folder = Path(REPOSITORY_PATH) / "meshes"
    files = {
        p.name: p.read_bytes() for p in sorted(folder.glob("*")) if p.suffix in suffixes
    }
    if not files:
        raise MissingFileError(folder, f"mesh files ({', '.join(suffixes)})")
    return files
