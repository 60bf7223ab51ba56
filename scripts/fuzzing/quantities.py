"""Masses, lengths, densities and gravity as no arm has them: impossible ones are
refused, odd ones told.

Of each quantity the plausible numbers are answered without a word.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from fuzzing.cases import Case
from fuzzing.values import Rng, pick

import alpha5_model as a5


class Quantity(NamedTuple):
    """A call with one number.

    Attributes:
        call: Takes the number.
        good: Range that any arm may have.
        odd: Numbers that no arm has, which must be told or refused.
        impossible: Numbers that must be refused.
    """

    call: Callable[[float], Any]
    good: tuple[float, float]
    odd: tuple[float, ...]
    impossible: tuple[float, ...] = ()


def _vehicle(**more: Any) -> Any:
    given: dict[str, Any] = {
        "mass": 11.5,
        "com": (0.0, 0.0, 0.02),
        "inertia": np.diag([0.2, 0.25, 0.3]),
        "volume": 0.0115,
        "cob": (0.0, 0.0, 0.05),
    }
    return a5.Vehicle(**given | more)


def _payload(**more: Any) -> Any:
    return a5.load().with_payload(**{"mass": 0.2} | more)


QUANTITIES = {
    "fluid density": Quantity(
        lambda x: a5.load(fluid_density=x),
        (990.0, 1035.0),
        (1.025, 1.0, 0.998),
        (-1.0, -1025.0),
    ),
    "gravity": Quantity(
        lambda x: a5.load(gravity=(0.0, 0.0, x)),
        (-9.84, -9.76),
        (981.0, -981.0, 9810.0),
    ),
    "payload mass": Quantity(
        lambda x: _payload(mass=x), (0.01, 1.5), (500.0, 250.0, 1e4), (-0.1, -500.0)
    ),
    "payload volume": Quantity(
        lambda x: _payload(volume=x), (1e-5, 1e-3), (1.0, 200.0), (-1e-4,)
    ),
    "payload centre of mass": Quantity(
        lambda x: _payload(com=(0.0, 0.0, x)), (-0.1, 0.1), (20.0, 50.0, -20.0)
    ),
    "vehicle mass": Quantity(lambda x: _vehicle(mass=x), (8.0, 15.0), (), (-1.0,)),
    "vehicle volume": Quantity(
        lambda x: _vehicle(volume=x), (0.010, 0.013), (11.4, 11.5), (-0.01,)
    ),
}


def target(rng: Rng, folder: Path) -> Case:
    """A good, an odd or an impossible number of some quantity."""
    name = pick(rng, [*QUANTITIES])
    quantity = QUANTITIES[name]
    way = int(rng.integers(3))
    if way == 1 and quantity.odd:
        return Case(quantity.call, {"x": pick(rng, quantity.odd)}, told=True)
    if way == 2 and quantity.impossible:
        return Case(quantity.call, {"x": pick(rng, quantity.impossible)}, hopeless=True)
    return Case(_silent(quantity.call), {"x": float(rng.uniform(*quantity.good))})


def _silent(call: Callable[[float], Any]) -> Callable[..., Any]:
    """The call, which must have nothing to say."""

    def silent(x: float) -> Any:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            answer = call(x)
        if caught:
            raise AssertionError(f"a plausible number warns: {caught[0].message}")
        return answer

    return silent
