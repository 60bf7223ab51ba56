"""Densities of what surrounds the arm [kg/m^3]."""

from __future__ import annotations

#: Sea water of 35 g/kg near the surface, fresh water, and no fluid at all.
SEA_WATER = 1025.0
FRESH_WATER = 1000.0
AIR = 0.0
