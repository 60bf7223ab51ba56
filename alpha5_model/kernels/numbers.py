"""NumPy's elementary functions for Python's numbers: what a generated formula takes as ``m``."""

from __future__ import annotations

import math
import operator
from types import SimpleNamespace

NUMBERS = SimpleNamespace(
    sin=math.sin,
    cos=math.cos,
    sqrt=math.sqrt,
    arctan=math.atan,
    arctan2=math.atan2,
    fabs=abs,
    floor=math.floor,
    fmin=min,
    fmax=max,
    nan=math.nan,
    logical_not=operator.not_,
    where=lambda condition, x, y: x if condition else y,
)
