"""The generated formulas, compiled or in NumPy."""
