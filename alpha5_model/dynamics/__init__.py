"""Dynamics under water: Pinocchio on the generated URDF, with the water added."""
