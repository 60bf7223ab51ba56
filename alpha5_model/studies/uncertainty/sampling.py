"""Parameter sets drawn from the intervals of the printed numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    count,
    flag,
    frozen,
    generator,
    real,
)
from alpha5_model.errors import InputError
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.uncertainty import printed
from alpha5_model.studies.uncertainty.arm_numbers import (
    ArmNumbers,
    are_lengths,
    arm_numbers,
)
from alpha5_model.studies.uncertainty.linear_maps import groups
from alpha5_model.studies.uncertainty.printed import Names

#: Standard deviation of a number that is uniform in -1 to 1.
DEVIATION = 3**-0.5
#: Sets that are still missing are drawn again so many times, some seconds in all.
_MOST_ROUNDS = 10_000


@dataclass(frozen=True, eq=False)
class Sample:
    """Parameter sets; make one with `sample`.

    Attributes:
        names: Of the printed numbers, (K,).
        values: (n, K) SI units.
        alternatives: Names of `ALTERNATIVES` that are believed.
        arm: Record of the arm whose numbers they are; None for the catalogue's.
    """

    names: tuple[str, ...]
    values: FloatArray
    alternatives: tuple[str, ...]
    arm: Alpha5Parameters | None = None

    def __len__(self) -> int:
        return len(self.values)

    def parameters(self, index: int) -> Alpha5Parameters:
        """One set as the record that `alpha5_model.numbers.parameters` returns.

        Raises:
            InputError: Not the number of a set.
        """
        size = len(self)
        whole = isinstance(index, int | np.integer) and not isinstance(index, bool)
        if not whole or not -size <= index < size:
            raise InputError("index", index, f"a whole number from 0 to {size - 1}")
        return self._numbers().parameters(self.values[index])

    def base_parameters(
        self, fluid_density: float = SEA_WATER, gravity: ArrayLike = GRAVITY
    ) -> FloatArray:
        """38 base parameters and gravity of every set, (n, 41).

        See `alpha5_model.codegen.regrouping`.

        They are for the generated kernels with the lengths of the arm, and contain no
        jaws that a spacer has moved: an arm with a spacer is refused.

        Raises:
            InputError: A density below 0, or an arm with a spacer.
        """
        density = real("fluid_density", fluid_density, minimum=0.0)
        numbers = self._numbers()
        if numbers.arm.spacer:
            expected = "none, or sets of `parameters(index)`, which have it"
            raise InputError("spacer", numbers.arm.spacer, expected)
        of_bodies = groups(numbers.bodies(self.values), numbers.grouping(density))
        weight = np.broadcast_to(array("gravity", gravity, 3), (len(self), 3))
        return np.concatenate([of_bodies, weight], axis=1)

    def _numbers(self) -> ArmNumbers:
        """The numbers that the sets are of."""
        return arm_numbers(chosen_arm(self.arm), self.alternatives)


def sample(
    n: int,
    seed: int = 0,
    distribution: str = "uniform",
    alternatives: Names = (),
    arm: Alpha5Parameters | None = None,
    lengths: bool = True,
) -> Sample:
    """Draw parameter sets whose numbers all round to the printed ones.

    A set that no bodies can have is drawn again.

    Args:
        n: Number of sets.
        seed: Of the random numbers.
        distribution: ``uniform`` within the intervals, or ``normal`` with the same
            variance, which exceeds their ends.
        alternatives: Names of `ALTERNATIVES` to believe.
        arm: Record of an arm of your own; None for the catalogue's. The half widths of
            its file replace those of the digits.
        lengths: Whether lengths are drawn, too. Without them, no set exceeds what
            `bounds` gives, which has the same choice.

    Raises:
        InputError: ``n`` or ``seed`` is not such a number, alternatives for an arm of
            your own, or hardly any numbers within its half widths are possible.
        UnknownNameError: No such distribution or alternative.
    """
    rng = generator(seed)
    chosen = printed.believed(alternatives)
    choice("distribution", distribution, ("uniform", "normal"))
    size = count("n", n)

    numbers = arm_numbers(chosen_arm(arm), chosen)
    fixed = are_lengths(numbers.names) & (not flag("lengths", lengths))
    middle = numbers.middle
    values = np.empty((0, middle.size))
    rounds = 0
    while len(values) < size:
        rounds += 1
        if rounds > _MOST_ROUNDS:
            found = f"{len(values)} possible sets in {_MOST_ROUNDS} rounds"
            raise InputError("arm", found, "half widths with more possible bodies")
        shape = (size - len(values), middle.size)
        if distribution == "normal":
            drawn = rng.normal(0, DEVIATION, shape)
        else:
            drawn = rng.uniform(-1, 1, shape)
        sets = middle + np.where(fixed, 0.0, numbers.spread(drawn))
        values = np.concatenate([values, sets[numbers.possible(sets)]])
    return Sample(
        names=numbers.names, values=frozen(values), alternatives=chosen, arm=arm
    )
