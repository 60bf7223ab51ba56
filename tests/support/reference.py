"""The document's kinematics and Tables 1 to 3, typed again for the tests: an independent second route.

Nothing here comes from the package. Lengths in mm, volumes in L, inertias in kg mm^2 with SolidWorks signs;
lists run from link_0 to link_4.
"""

from __future__ import annotations

import math

import numpy as np

THETA_C = math.atan(40 / 145.3)
A_1 = math.sqrt(40**2 + 145.3**2)
#: d, constant part of theta, a, alpha
DH = [
    (46.2, math.pi, 20, math.pi / 2),
    (0, THETA_C - math.pi / 2, A_1, math.pi),
    (0, THETA_C - math.pi / 2, 20, -math.pi / 2),
    (-180, math.pi / 2, 0, math.pi / 2),
    (0, -math.pi / 2, 0, 0),
]
LOWER = np.array([0.01745, 0.01745, 0.01745, 0.0])
UPPER = np.array([6.143, 3.40339, 3.40339, 6.2])

MASS = [0.234, 0.161, 0.38, 0.142, 0.355]
COM = [
    (-52.425, -7.120, -0.037),
    (7.746, 0.112, 25.038),
    (73.563, -0.091, -0.734),
    (11.188, -16.660, 0.148),
    (-0.030, -1.482, -100.881),
]
#: xx, yy, zz, xy, xz, yz at the COM
INERTIA = [
    (45.012, 393.932, 397.995, 2.832, -4.115, -0.010),
    (109.469, 122.362, 43.987, 0.808, 29.828, 0.544),
    (82.697, 847.148, 868.483, -74.836, -1.866, 0.317),
    (63.596, 40.651, 75.158, -21.363, -0.802, 0.337),
    (615.921, 625.307, 62.574, 0.067, -7.916, -0.428),
]
#: Table 3: displaced volume and centre of buoyancy.
VOLUME = [0.157, 0.032, 0.218, 0.032, 0.134]
COB = [(-53, -3, -1), (2, -4, 31), (76, 0, -1), (2, -4, 29), (0, 0, -97)]


def rotation_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def rotation_x(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])


def translation(x: float, z: float) -> np.ndarray:
    out = np.eye(4)
    out[0, 3], out[2, 3] = x / 1000, z / 1000
    return out


def dh_frames(q: np.ndarray) -> list[np.ndarray]:
    """DH frames {0} to {5} in the base frame, Section 1.1."""
    frames = [np.eye(4)]
    for (d, offset, a, alpha), angle in zip(DH, [*q, 0.0], strict=True):
        row = (
            rotation_z(angle + offset)
            @ translation(0, d)
            @ translation(a, 0)
            @ rotation_x(alpha)
        )
        frames.append(frames[-1] @ row)
    return frames


def inertial_frames(q: np.ndarray) -> list[np.ndarray]:
    """Inertial frames {0} to {4}, Section 2: each at the DH frame before it, after the rotation."""
    frames = dh_frames(q)
    turned = [frames[i] @ rotation_z(q[i] + DH[i][1]) for i in range(4)]
    return [np.eye(4), *turned]


def configurations(count: int, seed: int) -> np.ndarray:
    """Random configurations within the limits, the corners of the limits among them, (N, 4)."""
    rng = np.random.default_rng(seed)
    corners = np.array(np.meshgrid(*zip(LOWER, UPPER, strict=True))).reshape(4, -1).T
    return np.vstack([corners, rng.uniform(LOWER, UPPER, (count - len(corners), 4))])
