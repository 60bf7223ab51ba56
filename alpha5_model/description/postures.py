"""Named reference postures of the arm."""

from __future__ import annotations

import math

#: Name -> joint -> position [rad].
POSTURES: dict[str, dict[str, float]] = {
    "stow": {"axis_e": math.pi, "axis_d": 0.1, "axis_c": 0.1, "axis_b": math.pi},
    "home": {"axis_e": math.pi, "axis_d": math.pi / 2, "axis_c": math.pi / 2, "axis_b": math.pi},
    "reach": {"axis_e": math.pi, "axis_d": math.pi / 2, "axis_c": math.pi, "axis_b": math.pi},
}
