"""What works where NumPy is the only other package: `pip install --no-deps`.

    python scripts/checks/numpy_alone.py

Inverse kinematics with its limits, collisions and nearest points, the kernels, and the
URDF, MuJoCo and xacro files. Exit status 1 if one of them does not work, if they import
another package, or if the kernels are not compiled though ALPHA5_REQUIRE_KERNELS=1.
"""

from __future__ import annotations

import math
import os
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

import alpha5_model as a5
from alpha5_model.errors import (
    JointLimitError,
    SelfCollisionError,
    UnreachableError,
)

TARGET = (0.25, 0.10, 0.10)


def urdf_tip(q: np.ndarray) -> np.ndarray:
    """The tcp in base_link by the text of the URDF, (3,) [m]."""
    robot = ElementTree.parse(a5.URDF_PATH).getroot()
    joint_into = {
        joint.find("child").get("link"): joint for joint in robot.iter("joint")
    }
    angles = dict(zip(("axis_e", "axis_d", "axis_c", "axis_b"), q, strict=True))

    point = np.zeros(3)
    link = "tcp"
    while link in joint_into:
        joint = joint_into[link]
        point = about_z(angles.get(joint.get("name"), 0.0)) @ point
        origin = joint.find("origin")
        roll, pitch, yaw = (float(x) for x in origin.get("rpy", "0 0 0").split())
        turn = about_z(yaw) @ about_y(pitch) @ about_x(roll)
        shift = [float(x) for x in origin.get("xyz", "0 0 0").split()]
        point = turn @ point + shift
        link = joint.find("parent").get("link")
    return point


def about_x(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def about_y(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def about_z(angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def refuses_self_collision() -> bool:
    """Whether the links that touch are named at a target reached in collision only."""
    home = a5.named_pose("home")
    rng = np.random.default_rng(0)
    for target in rng.uniform(-0.15, 0.15, (4000, 3)):
        try:
            a5.inverse_kinematics(target).best(home)
        except SelfCollisionError as error:
            named = all(link.startswith("link_") for link in error.links)
            return named and math.isnan(error.depth)
        except (JointLimitError, UnreachableError):
            continue
    return False


def main() -> int:
    """Run the checks; returns the exit status."""
    solutions = a5.inverse_kinematics(TARGET)
    q = solutions.best(a5.named_pose("home"))
    tip = a5.dh.DHChain.alpha5().forward_kinematics(q)[:3, 3]
    outside = (0.9, 0.1, 0.1)
    checks = {
        "the solution reaches the target by the URDF": np.allclose(
            urdf_tip(q), TARGET, rtol=0.0, atol=1e-12
        ),
        "so does the chain of Table 1": np.allclose(tip, TARGET, rtol=0.0, atol=1e-12),
        "limits and collisions are known": bool(
            np.any(solutions.within_limits & ~solutions.collides)
        ),
        "a point out of reach has a nearest one": bool(
            a5.reachable(a5.nearest_reachable(outside)) and not a5.reachable(outside)
        ),
        "a target in self-collision is refused by name": refuses_self_collision(),
        "the bus devices are known": np.allclose(
            a5.q_from_devices(a5.devices_from_q(q)), q
        ),
        "the files are there": all(
            Path(path).is_file()
            for path in (a5.URDF_PATH, a5.paths.MJCF_PATH, a5.paths.XACRO_PATH)
        ),
    }
    for name, good in checks.items():
        print("yes" if good else "NO ", name)
    brought = {name.partition(".")[0] for name in sys.modules}
    heavy = sorted(brought & {"scipy", "pinocchio", "coal", "yaml", "rich"})
    print(f"kernels: {a5.backend()}; other packages: {', '.join(heavy) or 'none'}")
    required = os.environ.get("ALPHA5_REQUIRE_KERNELS") == "1"
    compiled = a5.backend() == "compiled" or not required
    return 0 if all(checks.values()) and not heavy and compiled else 1


if __name__ == "__main__":
    sys.exit(main())
