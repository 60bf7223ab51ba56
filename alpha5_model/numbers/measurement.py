"""Where a value of an arm of your own comes from, and how exact it is."""

from __future__ import annotations

from dataclasses import dataclass

from alpha5_model._support.checks import real


@dataclass(frozen=True)
class Measurement:
    """Source and half width of one value of an arm file.

    Attributes:
        key: Of the value in the arm file, for example ``links.link_2.mass``.
        source: Where it comes from; empty if not given.
        half_width: The true value is within this of the given one, in SI units; None
            if not given. For a vector or tensor, it holds for each of its numbers.

    Raises:
        InputError: A half width below 0.
    """

    key: str
    source: str = ""
    half_width: float | None = None

    def __post_init__(self) -> None:
        if self.half_width is not None:
            name = f"half_width of {self.key}"
            width = real(name, self.half_width, minimum=0.0)
            object.__setattr__(self, "half_width", width)
