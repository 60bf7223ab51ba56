"""Arms drawn from the intervals of their uncertain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray, choice, count, frozen, generator
from alpha5_model.errors import InputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.arm_numbers import ArmNumbers, arm_numbers, by_body
from alpha5_model.studies.printed_digits import SYMMETRIC

#: Standard deviation of a number that is uniform in -1 to 1.
DEVIATION = 3**-0.5
#: Sets that are still missing are drawn again so many times, some seconds in all.
_MOST_ROUNDS = 10_000


@dataclass(frozen=True, eq=False)
class Sample:
    """Sets of numbers; make one with `sample`.

    Attributes:
        names: Of the numbers, (K,), as `PrintedNumber` and arm files have them.
        values: (n, K) SI units.
        arm: Record of the arm whose numbers they are.
    """

    names: tuple[str, ...]
    values: FloatArray
    arm: Alpha5Parameters

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
        return arm_numbers(self.arm).record(self.values[index])


def sample(
    n: int,
    seed: int = 0,
    distribution: str = "uniform",
    arm: Alpha5Parameters | None = None,
) -> Sample:
    """Draw sets of the uncertain numbers of an arm.

    For the catalogue's arm, all numbers of a set round to the printed ones. A set that
    no bodies can have is drawn again.

    Args:
        n: Number of sets.
        seed: Of the random numbers.
        distribution: ``uniform`` within the intervals, or ``normal`` with the same
            variance, which exceeds their ends. A covariance is drawn along its axes: of
            a calibrated arm, about 8 % of sets lie beyond the ± of `bounds`.
        arm: Record of an arm of your own; None for the catalogue's. The half widths of
            its file replace those of the digits. The numbers of a calibrated arm have
            its covariance.

    Raises:
        InputError: ``n`` or ``seed`` is not such a number, or hardly any numbers within
            the half widths are possible.
        UnknownNameError: No such distribution.
    """
    rng = generator(seed)
    choice("distribution", distribution, ("uniform", "normal"))
    size = count("n", n)
    numbers = arm_numbers(chosen_arm(arm))
    values = np.empty((0, len(numbers.names)))
    rounds = 0
    while len(values) < size:
        rounds += 1
        if rounds > _MOST_ROUNDS:
            found = f"{len(values)} possible sets in {_MOST_ROUNDS} rounds"
            raise InputError("arm", found, "half widths with more possible bodies")
        shape = (size - len(values), len(numbers.names))
        if distribution == "normal":
            drawn = rng.normal(0, DEVIATION, shape)
        else:
            drawn = rng.uniform(-1, 1, shape)
        sets = drawn_values(numbers, drawn)
        values = np.concatenate([values, sets[possible(numbers, sets)]])
    return Sample(names=numbers.names, values=frozen(values), arm=numbers.arm)


def drawn_values(numbers: ArmNumbers, drawn: FloatArray) -> FloatArray:
    """Values of the numbers from independent draws with the variance 1/3, (..., K).

    A calibration knows first moments m c, not their factors. So a drawn change dm, dc
    of calibrated numbers is that of ``m c`` to first order, ``c dm + m dc``: the centre
    moves by ``dc m / (m + dm)``, and the moment by just that.
    """
    known = numbers.arm.covariance
    if known is None or numbers.root is None:
        return np.asarray(numbers.middle + numbers.half_width * drawn)
    together = np.isin(numbers.names, known.names)
    # The root has a column, and so a draw, for each number that is known together.
    change = np.where(
        together, drawn[..., together] @ numbers.root.T, numbers.half_width * drawn
    )

    for k in np.flatnonzero(together):
        stem, _, centre = numbers.names[k].rpartition(".")
        amount = {"com": "mass", "cob": "volume"}.get(stem.rpartition(".")[2])
        if amount is None or centre not in {*"xyz"}:
            continue
        of_amount = numbers.names.index(f"{stem.rpartition('.')[0]}.{amount}")
        if together[of_amount]:
            mass = numbers.middle[of_amount]
            heavier = mass + change[..., of_amount]
            change[..., k] *= np.where(heavier > 0, mass / heavier, 1.0)
    return np.asarray(numbers.middle + change)


def possible(numbers: ArmNumbers, values: FloatArray) -> Any:
    """Which sets (n, K) are possible links with their COM inside, (n,) bool.

    A body has a positive definite pseudo-inertia and no negative volume. The
    pseudo-inertia is positive definite exactly if the mass is positive and the second
    moments at the COM are positive definite [Wensing2018].

    References:
        [Wensing2018] Wensing, Kim, Slotine: Linear matrix inequalities for physically
            consistent inertial parameter identification, IEEE RA-L 3(1).
    """
    links = by_body(values)
    inertia = links[..., 4:10][..., SYMMETRIC]
    trace = np.trace(inertia, axis1=-2, axis2=-1)[..., None, None]
    second = trace / 2 * np.eye(3) - inertia
    bodies = (links[..., 0] > 0) & (links[..., 10] >= 0)
    bodies &= np.linalg.eigvalsh(second)[..., 0] > 0

    # A measured COM may be outside of the drawn body already.
    own = np.array([link.com for link in numbers.arm.links])
    bounds = np.array([link.bounds for link in numbers.arm.links])
    com = links[..., 1:4]
    inside = np.minimum(bounds[..., 0], own) <= com
    inside &= com <= np.maximum(bounds[..., 1], own)
    return (bodies & inside.all(axis=-1)).all(axis=-1)
