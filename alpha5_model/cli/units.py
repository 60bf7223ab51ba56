"""Sizes of the units in which commands print numbers, each in SI units."""

from __future__ import annotations

MILLIMETRE = 1e-3
SQUARE_CENTIMETRE = 1e-4
LITRE = 1e-3
GRAM = 1e-3
