"""Curves and sliders of a live viewer, which a Python program adds to its pages."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator

from alpha5_model._support.checks import real
from alpha5_model.errors import InputError
from alpha5_model.viewer.commands import Command

#: Longest name of a curve or slider [characters].
LONGEST_NAME = 40
#: Most curves, and most sliders.
MOST = 20
#: Samples of a curve that are kept.
SAMPLES = 600


def curve_name(name: object) -> str:
    """Check the name of a curve or slider, which the page shows.

    Raises:
        InputError: Not a text of 1 to 40 characters that can be printed.
    """
    expected = f"a text of 1 to {LONGEST_NAME} printable characters"
    if not isinstance(name, str):
        raise InputError("name", name, expected)
    if not 0 < len(name) <= LONGEST_NAME or not name.isprintable():
        raise InputError("name", name, expected)
    return name


class Curve:
    """The latest samples of a curve.

    Attributes:
        name: On the page.
        samples: Time [s] and value, in order of time.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.samples: deque[tuple[float, float]] = deque(maxlen=SAMPLES)

    def command(self) -> Command:
        """The command that draws all samples."""
        samples = [[*sample] for sample in self.samples]
        return Command(type="curve", name=self.name, samples=samples, whole=True)


class Slider:
    """A slider of the pages.

    Attributes:
        name: On the page.
        low, high: Its ends.
        value: Where it is; pages move it.
        on_change: Called with the value if a page has moved it, or None.
    """

    def __init__(
        self,
        name: str,
        low: float,
        high: float,
        value: float,
        on_change: Callable[[float], object] | None = None,
    ) -> None:
        self.name = name
        self.low = low
        self.high = high
        self.value = value
        self.on_change = on_change

    def command(self) -> Command:
        """The command that shows the slider."""
        return Command(
            type="slider",
            name=self.name,
            low=self.low,
            high=self.high,
            value=self.value,
        )


def slider(
    name: str,
    low: float,
    high: float,
    value: float | None,
    on_change: Callable[[float], object] | None,
) -> Slider:
    """A checked slider; it starts in the middle if no value is given.

    Raises:
        InputError: A name, an end or a value that cannot be.
    """
    lower = real("low", low)
    upper = real("high", high)
    if not lower < upper:
        raise InputError("high", upper, f"a number above low, {lower:g}")
    start = (lower + upper) / 2 if value is None else real("value", value)
    if not lower <= start <= upper:
        raise InputError("value", start, f"a number from {lower:g} to {upper:g}")
    return Slider(
        name=curve_name(name),
        low=lower,
        high=upper,
        value=start,
        on_change=on_change,
    )


class Controls:
    """The curves and sliders of a viewer, changed in the server's thread only.

    Attributes:
        curves, sliders: By name.
    """

    def __init__(self) -> None:
        self.curves: dict[str, Curve] = {}
        self.sliders: dict[str, Slider] = {}

    def add_sample(self, name: str, time: float, value: float) -> Command:
        """Add a sample to a curve, and return the command that draws it.

        Raises:
            InputError: Too many curves, or an earlier time than the last one.
        """
        if name not in self.curves:
            self._check_room("curve", self.curves)
        curve = self.curves.setdefault(name, Curve(name))
        if curve.samples and time < curve.samples[-1][0]:
            expected = f"{curve.samples[-1][0]:g} s or later, as samples are in order"
            raise InputError("time", time, expected)
        curve.samples.append((time, value))
        return Command(type="curve", name=name, samples=[[time, value]], whole=False)

    def add_slider(self, added: Slider) -> Command:
        """Add a slider, or replace the one of its name.

        Raises:
            InputError: Too many sliders.
        """
        if added.name not in self.sliders:
            self._check_room("slider", self.sliders)
        self.sliders[added.name] = added
        return added.command()

    @staticmethod
    def _check_room(kind: str, known: dict[str, Curve] | dict[str, Slider]) -> None:
        if len(known) >= MOST:
            expected = f"at most {MOST}; one of {', '.join(known)}"
            raise InputError(kind, len(known) + 1, expected)

    def commands(self) -> Iterator[Command]:
        """The commands that show everything to a new page."""
        for curve in self.curves.values():
            yield curve.command()
        for one in self.sliders.values():
            yield one.command()
