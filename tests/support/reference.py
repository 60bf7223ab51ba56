"""The document's kinematics and Tables 2 and 3, a second route for the tests.

No code here comes from the package. The kinematics is typed again; the tables are read
from the package's data file as text, which `tests/numbers` compares with the document.
Lengths are in mm, volumes in L, inertias in kg mm^2 with SolidWorks' signs. Lists run
from link_0 to link_4.
"""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

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

_PRINTED = tomllib.loads(
    (
        Path(__file__).resolve().parents[2]
        / "alpha5_model"
        / "numbers"
        / "reach_alpha_mk2_v7.toml"
    ).read_text("utf-8")
)
_TABLE_2, _TABLE_3 = (_PRINTED[name]["rows"] for name in ("table_2", "table_3"))

MASS = [float(row["mass"]) for row in _TABLE_2]
#: Half of the last digit of each mass, kg.
MASS_ROUNDING = [0.5 * 10.0 ** -len(row["mass"].partition(".")[2]) for row in _TABLE_2]
COM = [tuple(map(float, row["com"])) for row in _TABLE_2]
#: Element of the printed tensor, row and column, in the order xx, yy, zz, xy, xz, yz.
_ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
#: xx, yy, zz, xy, xz, yz at the COM
INERTIA = [
    tuple(float(row["inertia_com"][i][j]) for i, j in _ELEMENTS) for row in _TABLE_2
]
#: Table 3: displaced volume and centre of buoyancy.
VOLUME = [float(row["volume"]) for row in _TABLE_3]
COB = [tuple(map(float, row["cob"])) for row in _TABLE_3]


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
    """Inertial frames {0} to {4} of Section 2: the DH frame before each, rotated."""
    frames = dh_frames(q)
    turned = [frames[i] @ rotation_z(q[i] + DH[i][1]) for i in range(4)]
    return [np.eye(4), *turned]


def configurations(count: int, seed: int) -> np.ndarray:
    """Random positions (N, 4) within the limits, and the corners of the limits."""
    rng = np.random.default_rng(seed)
    corners = np.array(np.meshgrid(*zip(LOWER, UPPER, strict=True))).reshape(4, -1).T
    return np.vstack([corners, rng.uniform(LOWER, UPPER, (count - len(corners), 4))])
