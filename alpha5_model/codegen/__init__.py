"""One source of formulas, written as C, NumPy, JAX, CasADi and JavaScript."""
