"""What the digits of the printed numbers leave open in each result.

`printed_numbers` are the intervals, `sample` draws parameter sets from them.
"""

from alpha5_model.uncertainty.printed import (
    ALTERNATIVES,
    PrintedNumber,
    Sample,
    printed_numbers,
    sample,
)

__all__ = [
    "ALTERNATIVES",
    "PrintedNumber",
    "Sample",
    "printed_numbers",
    "sample",
]
