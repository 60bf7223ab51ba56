"""What surrounds the arm: densities of fluids and gravity."""

from __future__ import annotations

#: Sea water of 35 g/kg near the surface, fresh water, and no fluid at all [kg/m^3].
SEA_WATER = 1025.0
FRESH_WATER = 1000.0
AIR = 0.0
#: Gravity with z up [m/s^2].
GRAVITY = (0.0, 0.0, -9.81)
