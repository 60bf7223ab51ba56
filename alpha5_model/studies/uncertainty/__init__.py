"""What the digits of the printed numbers leave open in each result.

`printed_numbers` are the intervals. `bounds` are limits that no numbers in them can
pass. `sample`, `spread` and `sensitivity` work for any result; `identify` is for
recordings.

The bounds of torques, loads and energies are sums over the links of ``m s(c) + w . I +
V (w_V + w_b . b)``, with s of second degree in the COM c. No number is in two of the
terms, so the extremes of the sum are the sums of their extremes; those of a product of
intervals are at its corners. At rest s is of first degree, and the bounds are attained.
In motion its second-degree part about the middle of c is taken at the largest that it
can be. The lengths of Table 1 are taken as printed: see `sensitivity` for their share.
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
from alpha5_model.studies.uncertainty.identification import Identification, identify
from alpha5_model.studies.uncertainty.printed import (
    ALTERNATIVES,
    PrintedNumber,
    printed_numbers,
)
from alpha5_model.studies.uncertainty.sampling import Sample, sample

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
