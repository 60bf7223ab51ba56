"""How much the rounding of the printed digits leaves open in each result.

`printed_numbers` has the interval of each printed number. A half width in an arm file
replaces that of the digits. `bounds` says how far all these numbers together can move
torques, loads and energies, to first order. `sensitivity` has the effect of each number
on any result, `sample` draws arms, and `spread` evaluates a result for them.
"""

from alpha5_model.dynamics.load import arm_of as arm
from alpha5_model.studies.printed_digits import PrintedNumber, printed_numbers
from alpha5_model.studies.uncertainty.digit_bounds import Bounds, bounds
from alpha5_model.studies.uncertainty.effects import (
    Sensitivity,
    Spread,
    reach,
    sensitivity,
    spread,
)
from alpha5_model.studies.uncertainty.sampling import Sample, sample

__all__ = [
    "Bounds",
    "PrintedNumber",
    "Sample",
    "Sensitivity",
    "Spread",
    "arm",
    "bounds",
    "printed_numbers",
    "reach",
    "sample",
    "sensitivity",
    "spread",
]
