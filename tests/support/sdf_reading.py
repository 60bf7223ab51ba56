"""A reader of the Gazebo model that shares nothing with the package."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest


def numbers(element: ET.Element | None) -> np.ndarray:
    return np.array([float(x) for x in element.text.split()])


def pose(element: ET.Element) -> np.ndarray:
    """Element's pose: x y z, then rotations about the fixed x, y and z axes."""
    found = element.find("pose")
    x, y, z, roll, pitch, yaw = numbers(found) if found is not None else np.zeros(6)
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rz @ ry @ rx, (x, y, z)
    return out


def gazebo_buoyancy(text: str) -> dict[str, tuple[float, np.ndarray]]:
    """Volume and centre of buoyancy of each link, as gz-sim's Buoyancy system has them.

    ``volume = sum V_i``, ``centre = sum V_i p_i / volume`` over the link's collisions,
    with the volume of the shape and the position of the collision's pose (gz-sim,
    ``Buoyancy.cc``, CheckForNewEntities).
    """
    found = {}
    for link in ET.fromstring(text).iter("link"):
        volume, moment = 0.0, np.zeros(3)
        for collision in link.findall("collision"):
            (shape,) = collision.find("geometry")
            if shape.tag == "box":
                size = math.prod(numbers(shape.find("size")))
            elif shape.tag == "cylinder":
                radius, length = (
                    float(shape.find(n).text) for n in ("radius", "length")
                )
                size = math.pi * radius**2 * length
            else:
                size = 4 / 3 * math.pi * float(shape.find("radius").text) ** 3
            volume += size
            moment += size * pose(collision)[:3, 3]
        if volume > 0:
            found[link.get("name")] = volume, moment / volume
    return found


def link_poses(root: ET.Element, q: np.ndarray) -> dict[str, np.ndarray]:
    """Poses of the links in base_link: each link's pose at zero, then its joint."""
    model = root.find("model")
    base = next(f for f in model.findall("frame") if f.get("name") == "base_link")
    poses = {"link_0": np.linalg.inv(pose(base))}
    angles = iter(q)
    for joint in model.findall("joint"):
        child = model.find(f"link[@name='{joint.find('child').text}']")
        parent = joint.find("parent").text
        assert child.find("pose").get("relative_to") == parent
        assert joint.find("axis/xyz").text == "0 0 1"
        assert joint.find("pose") is None  # the joint stands in its child
        turn = np.eye(4)
        c, s = math.cos(angle := next(angles)), math.sin(angle)
        turn[:2, :2] = [[c, -s], [s, c]]
        poses[child.get("name")] = poses[parent] @ pose(child) @ turn
    return poses


LIBSDFORMAT = shutil.which("gz") or shutil.which("ign")
needs_libsdformat = pytest.mark.skipif(
    LIBSDFORMAT is None, reason="libsdformat's gz is not there"
)


def libsdformat(path: Path) -> subprocess.CompletedProcess[str]:
    """What libsdformat's program says of a file."""
    assert LIBSDFORMAT is not None
    environment = {
        "IGN_CONFIG_PATH": "/usr/share/ignition",
        "GZ_CONFIG_PATH": "/usr/share/gz",
    }
    return subprocess.run(
        [LIBSDFORMAT, "sdf", "-k", str(path)],
        capture_output=True,
        text=True,
        check=False,
        env={**environment, **os.environ},
    )
