"""Geometry of motion: NumPy only, no dynamics."""
