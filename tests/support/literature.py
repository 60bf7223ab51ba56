"""Standard DH tables of well-known arms, as printed: [theta, d, a, alpha, sigma]."""

from __future__ import annotations

import math

QUARTER = math.pi / 2

PUMA_560 = [  # Corke, Robotics, Vision and Control, section 7.2 (mdl_puma560)
    [0, 0, 0, QUARTER, 0],
    [0, 0, 0.4318, 0, 0],
    [0, 0.15005, 0.0203, -QUARTER, 0],
    [0, 0.4318, 0, QUARTER, 0],
    [0, 0, 0, -QUARTER, 0],
    [0, 0, 0, 0, 0],
]
STANFORD = [  # Paul, Robot Manipulators, 1981 (mdl_stanford); third joint prismatic
    [0, 0.412, 0, -QUARTER, 0],
    [0, 0.154, 0, QUARTER, 0],
    [-QUARTER, 0, 0.0203, 0, 1],
    [0, 0, 0, -QUARTER, 0],
    [0, 0, 0, QUARTER, 0],
    [0, 0, 0, 0, 0],
]
