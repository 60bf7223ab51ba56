"""Sections of the benchmark table: one module per part of the package, each with ``rows()``."""
