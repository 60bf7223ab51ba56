"""How well the numbers of a calibrated arm are known together."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from alpha5_model._support.checks import FloatArray, fill, frozen, listed, shaped
from alpha5_model.errors import InputError

#: Half width of a uniform distribution in standard deviations.
WIDTH = 3**0.5
#: How far the factor's singular values may exceed 1 by rounding.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Covariance:
    """Covariance of some numbers of an arm: ``D (1 - F F^T) D``.

    D holds the standard deviations before a calibration, and each column of F is a
    combination of numbers that the calibration has made more certain.

    Attributes:
        names: Key of the arm file and component, such as ``links.link_2.com.x`` or
            ``zeros.axis_d``, (K,).
        deviation: Standard deviations before the calibration, SI units, (K,).
        factor: F, (K, r).

    Raises:
        InputError: Not such arrays, a deviation not above 0, a name given twice, or a
            factor that would make a variance negative.
    """

    names: tuple[str, ...]
    deviation: FloatArray
    factor: FloatArray

    def __post_init__(self) -> None:
        names = tuple(listed("covariance.names", self.names, "names of numbers"))
        size = len(names)
        if len(set(names)) != size or not all(isinstance(n, str) for n in names):
            raise InputError("covariance.names", names, "names, each once")
        deviation = shaped("covariance.deviation", self.deviation, (size,))
        if size and not deviation.min() > 0.0:
            smallest = float(deviation.min())
            raise InputError("covariance.deviation", smallest, "numbers above 0")
        rank = np.shape(self.factor)[-1] if np.ndim(self.factor) == 2 else 0
        factor = shaped("covariance.factor", self.factor, (size, rank))
        if factor.size:
            _check_singular_values(factor)
        fill(self, names=names, deviation=frozen(deviation), factor=frozen(factor))

    @property
    def matrix(self) -> FloatArray:
        """The covariance itself, (K, K)."""
        scaled = self.deviation[:, None] * self.factor
        return np.asarray(np.diag(self.deviation**2) - scaled @ scaled.T)

    @cached_property
    def root(self) -> FloatArray:
        """R with ``R R^T = 1 - F F^T``, symmetric, (K, K)."""
        left, singular, _ = np.linalg.svd(self.factor, full_matrices=False)
        shrunk = 1.0 - np.sqrt(np.maximum(1.0 - singular**2, 0.0))
        return np.asarray(np.eye(len(self.names)) - (left * shrunk) @ left.T)

    @property
    def standard_deviation(self) -> FloatArray:
        """Of each number after the calibration, (K,)."""
        left = 1.0 - (self.factor**2).sum(axis=1)
        return np.asarray(self.deviation * np.sqrt(np.maximum(left, 0.0)))

    @property
    def half_widths(self) -> dict[str, float]:
        """Key of the arm file -> the largest half width among its components.

        As everywhere, a half width is sqrt(3) standard deviations.
        """
        found: dict[str, float] = {}
        widths = (WIDTH * self.standard_deviation).tolist()
        for name, width in zip(self.names, widths, strict=True):
            key = key_of(name)
            found[key] = max(width, found.get(key, width))
        return found


def _check_singular_values(factor: FloatArray) -> None:
    """Refuse a factor that tells more than everything."""
    largest = float(np.linalg.norm(factor, 2))
    if largest > 1.0 + _ROUNDING:
        expected = "a factor whose largest singular value is at most 1"
        raise InputError("covariance.factor", largest, expected)


def key_of(name: str) -> str:
    """The key of the arm file that a number belongs to."""
    return ".".join(name.split(".")[:3])  # "zeros.axis_d" has two parts
