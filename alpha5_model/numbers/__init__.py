"""What was printed, and the same in SI units: one record of an arm."""
