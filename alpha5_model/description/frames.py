"""Where the frames of the URDF are: joint placements from the rows of Table 1.

Inertial frame {i+1} is DH frame {i} turned by the joint (Section 2), so joint i turns about +z of its
child link, and the rest of the DH row, ``Tz(d) Tx(a) Rx(alpha)``, leads on to the next joint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from alpha5_model.errors import PublishedDataError
from alpha5_model.parameters import Alpha5Parameters, DHParameters

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Placement:
    """Pose of a child frame in its parent.

    Attributes:
        parent: Name of the parent frame.
        xyz: Origin [m].
        rpy: Fixed-axis roll, pitch, yaw [rad].
    """

    parent: str
    xyz: Triple = (0.0, 0.0, 0.0)
    rpy: Triple = (0.0, 0.0, 0.0)


def joint_placements(parameters: Alpha5Parameters) -> dict[str, Placement]:
    """Pose of each child link at joint position zero, keyed ``axis_e`` to ``axis_b``."""
    dh = parameters.dh
    first = _turn(0.0, dh[0].theta_offset - parameters.base_yaw)
    placements = {parameters.joints[0].name: Placement("link_0", rpy=first)}
    for i in (1, 2, 3):
        previous = dh[i - 1]
        placements[parameters.joints[i].name] = Placement(
            f"link_{i}", _reach(previous), _turn(previous.alpha, dh[i].theta_offset)
        )
    return placements


def base_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of link_0 in base_link, DH frame {0}."""
    return Placement("base_link", rpy=(0.0, 0.0, parameters.base_yaw))


def tcp_placement(parameters: Alpha5Parameters) -> Placement:
    """Pose of the TCP, DH frame {5}, in link_4."""
    wrist, last = parameters.dh[3], parameters.dh[4]
    if last.variable is not None or any((last.d, last.a, last.alpha)):
        raise PublishedDataError("Table 1, link 4", "expected a fixed rotation about z only")
    return Placement("link_4", _reach(wrist), _turn(wrist.alpha, last.theta_offset))


def dh_placements(parameters: Alpha5Parameters) -> dict[str, Placement]:
    """Poses of the DH frames {1} to {5}, keyed ``dh_1`` to ``dh_5``."""
    frames = {
        f"dh_{i + 1}": Placement(f"link_{i + 1}", _reach(row), (row.alpha, 0.0, 0.0))
        for i, row in enumerate(parameters.dh[:4])
    }
    frames["dh_5"] = Placement("dh_4", rpy=(0.0, 0.0, parameters.dh[4].theta_offset))
    return frames


def _reach(row: DHParameters) -> Triple:
    return (row.a, 0.0, row.d)


def _turn(alpha: float, beta: float) -> Triple:
    """Roll, pitch, yaw of ``Rx(alpha) Rz(beta)``, exact for alpha a multiple of pi/2.

    ``Rx(alpha) Rz(beta) Rx(-alpha)`` turns by beta about ``(0, -sin alpha, cos alpha)``, which is
    then a coordinate axis. Reading the angles off the matrix instead would fail at axis_b, where
    the pitch is pi/2.
    """
    sine, cosine = round(math.sin(alpha)), round(math.cos(alpha))
    if abs(sine) + abs(cosine) != 1:
        raise PublishedDataError("Table 1", f"alpha = {alpha} rad is not a multiple of pi/2")
    return (alpha, -sine * beta + 0.0, cosine * beta + 0.0)
