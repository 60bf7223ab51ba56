"""Noise that is correlated from sample to sample."""

from __future__ import annotations

import numpy as np

#: Of two samples, one after the other.
CORRELATION = 0.95


def correlated(driving: np.ndarray) -> np.ndarray:
    """Autoregressive noise of order 1, with the deviation of what drives it.

    Args:
        driving: White noise, (N, channels).
    """
    out = driving.copy()
    for k in range(1, len(out)):
        driven = np.sqrt(1 - CORRELATION**2) * driving[k]
        out[k] = CORRELATION * out[k - 1] + driven
    return out
