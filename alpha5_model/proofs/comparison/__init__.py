"""The comparison itself: both models measured at the same joint positions."""

from alpha5_model.proofs.comparison.measure import (
    compare,
    compare_robots,
)

__all__ = [
    "compare",
    "compare_robots",
]
