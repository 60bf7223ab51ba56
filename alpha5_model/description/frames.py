"""Where the frames of the arm are: the poses of links and DH frames in their parents.

Inertial frame {i+1} is DH frame {i} turned by the joint (Section 2), so joint i turns
about +z of its child link. The rest of the DH row, ``Tz(d) Tx(a) Rx(alpha)``, leads on
to the next joint.
"""

from __future__ import annotations

import math

from alpha5_model._support.spatial import (
    Placement,
    Triple,
    rpy_from_rotation,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, DHParameters
from alpha5_model.numbers.pose import Pose


def base_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of link_0 in base_link, DH frame {0}."""
    return Placement("base_link", rpy=(0.0, 0.0, parameters.base_yaw))


def mount_placement(mount: Pose) -> Placement:
    """Pose of base_link in the parent of a mount."""
    x, y, z = mount.position.tolist()
    return Placement(
        parent=mount.parent, xyz=(x, y, z), rpy=rpy_from_rotation(mount.rotation)
    )


def joint_placements(parameters: Alpha5Parameters) -> tuple[Placement, ...]:
    """Pose of each child link at joint position zero, ``axis_e`` to ``axis_b``."""
    dh = parameters.dh
    shoulder_yaw = dh[0].theta_offset - parameters.base_yaw
    placements = [Placement("link_0", rpy=_roll_yaw(0.0, shoulder_yaw))]
    for i in (1, 2, 3):
        placements.append(_after_joint(i - 1, dh[i - 1], dh[i].theta_offset))
    return tuple(placements)


def tcp_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of the TCP in link_4: the record's tool, or Table 1's, DH frame {5}."""
    tool = parameters.tool
    if tool is not None:
        x, y, z = tool.position.tolist()
        return Placement(
            parent="link_4", xyz=(x, y, z), rpy=rpy_from_rotation(tool.rotation)
        )

    wrist = parameters.dh[3]
    last = parameters.dh[4]
    if last.variable is not None or any((last.d, last.a, last.alpha)):
        raise InputError("dh[4]", last, "a fixed rotation about z only")
    return _after_joint(3, wrist, last.theta_offset)


def fixed_frames(parameters: Alpha5Parameters) -> dict[str, Placement]:
    """Poses of the frames fixed in their parents: link_0, tcp, dh_1 to dh_5."""
    frames = {
        "link_0": base_placement(parameters),
        "tcp": tcp_placement(parameters),
    }
    for i, row in enumerate(parameters.dh[:4]):
        frames[f"dh_{i + 1}"] = _after_joint(i, row, 0.0)

    last_turn = parameters.dh[4].theta_offset
    frames["dh_5"] = Placement("dh_4", rpy=(0.0, 0.0, last_turn))
    return frames


def _after_joint(i: int, row: DHParameters, angle: float) -> Placement:
    """Pose in link i+1 of the frame after joint i's DH row, turned about its z."""
    return Placement(
        parent=f"link_{i + 1}",
        xyz=(row.a, 0.0, row.d),
        rpy=_roll_yaw(row.alpha, angle),
    )


def _roll_yaw(alpha: float, beta: float) -> Triple:
    """Roll, pitch, yaw of ``Rx(alpha) Rz(beta)``, exact for alpha a multiple of pi/2.

    ``Rx(alpha) Rz(beta) Rx(-alpha)`` turns by beta about ``(0, -sin alpha, cos
    alpha)``, which is then a coordinate axis. Angles that are read off the matrix would
    fail at axis_b, where the pitch is pi/2.
    """
    sine = round(math.sin(alpha))
    cosine = round(math.cos(alpha))
    if not math.isclose(math.sin(alpha), sine, abs_tol=1e-12):
        raise InputError("alpha", alpha, "a multiple of pi/2")
    # Adding zero turns a negative zero into zero.
    pitch = -sine * beta + 0.0
    yaw = cosine * beta + 0.0
    return (alpha, pitch, yaw)
