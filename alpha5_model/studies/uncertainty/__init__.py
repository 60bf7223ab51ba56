"""How much the rounding of the printed digits leaves open in each result.

`printed_numbers` gives the interval of each number. `bounds` are limits that no numbers
in these intervals can exceed. `sample`, `spread` and `sensitivity` work for any result.

A torque, load or energy is a sum over the links of

    m s(c) + w . I + V (w_V + w_b . b)

with mass m, COM c, tensor I, volume V and centre of buoyancy b. The function s and the
weights w, w_V and w_b follow from the state. s is quadratic in c. No number is part of
two terms, so the extremes of the sum are the sums of the terms' extremes, and those of
a product of two intervals are at its corners. At rest s is linear, and the bounds are
attained. In motion its quadratic part about the middle of c is replaced by its largest
possible value. The lengths of Table 1 are taken as printed.
With ``lengths=True`` their share is added to first order; `sample` has the same choice.
"""

from alpha5_model.dynamics.load import arm_of as arm
from alpha5_model.studies.uncertainty.digit_bounds import (
    Bounds,
    bounds,
    torque_bounds,
)
from alpha5_model.studies.uncertainty.effects import (
    Sensitivity,
    Spread,
    reach,
    sensitivity,
    spread,
)
from alpha5_model.studies.uncertainty.printed import (
    ALTERNATIVES,
    PrintedNumber,
    printed_numbers,
)
from alpha5_model.studies.uncertainty.sampling import Sample, sample

__all__ = [
    "ALTERNATIVES",
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
    "torque_bounds",
]
