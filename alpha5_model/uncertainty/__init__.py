"""What the digits of the printed numbers leave open in each result.

`printed_numbers` are the intervals; `bounds` what no numbers in them can pass; `sample`, `spread` and
`sensitivity` do for any result; `identify` is for recordings.
"""

from alpha5_model.dynamics import arm_of as arm
from alpha5_model.uncertainty.effects import (
    Bounds,
    Identification,
    Sensitivity,
    Spread,
    bounds,
    identify,
    sensitivity,
    spread,
    torque_bounds,
)
from alpha5_model.uncertainty.printed import (
    ALTERNATIVES,
    PrintedNumber,
    Sample,
    printed_numbers,
    reach,
    sample,
)

__all__ = [
    "ALTERNATIVES",
    "Bounds",
    "Identification",
    "PrintedNumber",
    "Sample",
    "Sensitivity",
    "Spread",
    "arm",
    "bounds",
    "identify",
    "printed_numbers",
    "reach",
    "sample",
    "sensitivity",
    "spread",
    "torque_bounds",
]
