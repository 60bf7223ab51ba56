"""Compare another model of this arm with ours."""

from alpha5_model.proofs.comparison.comparing import compare, compare_robots

__all__ = ["compare", "compare_robots"]
