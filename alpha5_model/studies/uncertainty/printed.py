"""What the digits of each printed number allow, and parameter sets drawn from that.

A number stands for all that round to it: 0.38 kg is 0.375 to 0.385 kg; friction has the tolerance that is
printed with it. Zeros of Table 1 are exact: axes that meet are no measured lengths.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import (
    FloatArray,
    array,
    choice,
    count,
    frozen,
    generator,
    named,
    real,
)
from alpha5_model.codegen.base_parameters import regrouped
from alpha5_model.errors import InputError
from alpha5_model.numbers.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
from alpha5_model.numbers.fluids import GRAVITY, SEA_WATER
from alpha5_model.numbers.inertia import second_moments
from alpha5_model.numbers.parameters import (
    Alpha5Parameters,
    convert,
    link_numbers,
    parameters,
)
from alpha5_model.numbers.printed import published
from alpha5_model.numbers.quantity import DECIMAL_SHIFT, Quantity
from alpha5_model.numbers.tables import Published
from alpha5_model.proofs.audit.masses import implied_mass

#: Where the documents contradict themselves or can be read in two ways: name -> what is believed in
#: place of the plain reading.
ALTERNATIVES: dict[str, str] = {
    "link3_cob": CORRECTIONS["link3_cob"].statement,
    "implied_mass": "The masses that best carry Table 2's I_COM to its I_Link, not those printed.",
    "torque_constant": "Table 4's K_t for both constants of a motor, which should agree.",
    "voltage_constant": "Table 4's K_v for both; K_t if that is asked for, too.",
    "link2_mass": "Link 2's 0.38 kg is 0.380 kg, printed without its last zero.",
    "motor_efficiency": "Table 4's eta_max is the motor's: nothing is lost in the gearbox.",
}
#: Entries of a symmetric matrix, and the place of each in (3, 3).
UPPER = np.triu_indices(3)
SYMMETRIC = np.array([[0, 1, 2], [1, 3, 4], [2, 4, 5]])
#: Table -> what its rows are about.
_TABLES = {
    **dict.fromkeys(("table_1", "table_2", "table_3"), "link"),
    "table_4": "actuator",
}
Names = Iterable[str]


@dataclass(frozen=True)
class PrintedNumber:
    """A number of Tables 1 to 4 and its interval, SI units.

    Attributes:
        name: As ``link_2.mass``, ``link_3.cob.z``, ``link_1.inertia_com.xy``, ``actuator_0.friction``.
        printed: Digits and unit as printed.
        value: The middle of the interval. With the alternatives ``implied_mass`` and
            ``motor_efficiency`` it is not what is printed.
        lower, upper: Its ends.
    """

    name: str
    printed: Quantity
    value: float
    lower: float
    upper: float


def believed(alternatives: Names) -> tuple[str, ...]:
    """Check names of `ALTERNATIVES`."""
    return named("alternative", alternatives, tuple(ALTERNATIVES))


@cache
def numbers(alternatives: tuple[str, ...]) -> dict[str, PrintedNumber]:
    """Every number by its name; the alternatives are checked, and the answer is not to be changed."""
    found: dict[str, Quantity] = {}
    _changed(lambda name, number: found.setdefault(name, number))
    out = {}
    for name, number in found.items():
        # An axis that meets another one is at no measured distance.
        exact = not number.value and name.endswith((".d", ".a"))
        value, half = number.si, 0.0 if exact else number.rounding
        if name == "link_2.mass" and "link2_mass" in alternatives:
            half = _finest_mass().rounding
        if name.endswith("efficiency") and "motor_efficiency" in alternatives:
            value, half = 1.0, 0.0
        if name.endswith("friction"):
            half = max(half, value * found[f"{name}_tolerance"].si)
        if name.endswith("mass") and "implied_mass" in alternatives:
            value, half = implied_mass(published().table_2.rows[int(name[5])])
        if not name.endswith("tolerance"):
            out[name] = PrintedNumber(name, number, value, value - half, value + half)
    return out


def _finest_mass() -> Quantity:
    """The mass of Table 2 with the most decimals."""
    masses = [row.mass for row in published().table_2.rows]
    return min(masses, key=lambda mass: mass.rounding)


def ends(alternatives: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
    """Middle and half width of the intervals, (K,) each."""
    lower, upper = np.array(
        [(x.lower, x.upper) for x in numbers(alternatives).values()]
    ).T
    return (lower + upper) / 2, (upper - lower) / 2


def _changed(change: Callable[[str, Quantity], Quantity]) -> Published:
    """Tables 1 to 4 with every number changed, by its name; the two halves of a tensor have the same names."""

    def walked(value: Any, name: str, axes: str = "") -> Any:
        if isinstance(value, Quantity):
            return change(".".join([name, "".join(sorted(axes))]).rstrip("."), value)
        if isinstance(value, tuple):
            return tuple(
                walked(item, name, axes + "xyz"[i]) for i, item in enumerate(value)
            )
        if isinstance(value, str):
            return value
        parts = {f.name: getattr(value, f.name) for f in fields(value)}
        return replace(
            value, **{k: walked(part, f"{name}.{k}") for k, part in parts.items()}
        )

    tables: dict[str, Any] = {"elbow": walked(published().elbow, "elbow")}
    for key, kind in _TABLES.items():
        table = getattr(published(), key)
        rows = tuple(walked(row, f"{kind}_{i}") for i, row in enumerate(table.rows))
        tables[key] = replace(table, rows=rows)
    return replace(published(), **tables)


def parameter_set(
    values: Mapping[str, float], alternatives: tuple[str, ...]
) -> Alpha5Parameters:
    """The arm's parameters with other values of printed numbers, by name, SI units."""
    return convert(*printed_set(values, alternatives))


def printed_set(
    values: Mapping[str, float], alternatives: tuple[str, ...]
) -> tuple[Published, tuple[str, ...]]:
    """The tables with these values, and the corrections among the alternatives."""
    known = numbers(alternatives)
    same = [name for name in alternatives if name.endswith("_constant")]

    def change(name: str, number: Quantity) -> Quantity:
        if same and name.endswith("_constant"):
            name = f"{name.partition('.')[0]}.{same[0]}"
        if name.endswith("efficiency") and "motor_efficiency" in alternatives:
            return Quantity("100", "%")
        if name not in values:
            return known[name].printed if name in known else number
        digits = Decimal(repr(float(values[name]))).scaleb(-DECIMAL_SHIFT[number.unit])
        return Quantity(str(digits), number.unit)

    corrections = tuple(name for name in alternatives if name in CORRECTIONS)
    return _changed(change), DEFAULT_CORRECTIONS + corrections


@cache
def link_map(alternatives: tuple[str, ...]) -> FloatArray:
    """From the printed numbers to the links, (K, 5, 14); it is linear, the frame of link 3's COB included.

    Numbers of a link: mass, COM (3), second moments at the COM (6), volume, COB (3).
    """
    names, out = tuple(numbers(alternatives)), []
    for row in np.eye(len(names)):
        values = dict(zip(names, row.tolist(), strict=True))
        links = []
        # No bodies: all numbers but one are zero.
        for link in link_numbers(*printed_set(values, alternatives)):
            second = second_moments(link["inertia"])[UPPER]
            mass, volume = link["mass"], link["volume"]
            links.append([mass, *link["com"], *second, volume, *link["cob"]])
        out.append(links)
    return frozen(out)


@cache
def grouping(fluid_density: float) -> FloatArray:
    """From m, m c, second moments, V and V b of the links to the base parameters, gravity left out, (5, 14, 38)."""
    places = [(3, 3), (0, 3), (1, 3), (2, 3), *zip(*UPPER, strict=True)]
    out = []
    for link, k in np.ndindex(5, 14):
        unit, (i, j) = np.zeros((5, 2, 4, 4)), places[k % 10]
        unit[link, :, i, j] = unit[link, :, j, i] = (
            1.0 if k < 10 else (0.0, -fluid_density)
        )
        out.append(regrouped(unit, np.zeros(3), parameters())[:-3])
    return frozen(np.reshape(out, (5, 14, -1)))


def groups(
    values: FloatArray, alternatives: tuple[str, ...], density: float
) -> FloatArray:
    """Base parameters, gravity left out, of printed numbers, (..., K) to (..., 38)."""
    links = np.tensordot(values, link_map(alternatives), 1)
    mass, com, volume, cob = (
        links[..., :1],
        links[..., 1:4],
        links[..., 10:11],
        links[..., 11:],
    )
    second = links[..., 4:10] + mass * com[..., UPPER[0]] * com[..., UPPER[1]]
    moments = np.concatenate([mass, mass * com, second, volume, volume * cob], axis=-1)
    return np.asarray(np.tensordot(moments, grouping(density), 2))


@dataclass(frozen=True, eq=False)
class Sample:
    """Parameter sets; make one with `sample`.

    Attributes:
        names: Of the printed numbers, (K,).
        values: (n, K) SI units.
        alternatives: Those believed.
    """

    names: tuple[str, ...]
    values: FloatArray
    alternatives: tuple[str, ...]

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
        values = dict(zip(self.names, self.values[index].tolist(), strict=True))
        return parameter_set(values, self.alternatives)

    def base_parameters(
        self, fluid_density: float = SEA_WATER, gravity: ArrayLike = GRAVITY
    ) -> FloatArray:
        """`alpha5_model.codegen.base_parameters` of every set, for the generated kernels, (n, 41).

        The lengths of Table 1 are built into the kernels and stay as printed.
        """
        density = real("fluid_density", fluid_density, minimum=0.0)
        own = groups(self.values, self.alternatives, density)
        weight = np.broadcast_to(array("gravity", gravity, 3), (len(self), 3))
        return np.concatenate([own, weight], axis=1)


def sample(
    n: int, seed: int = 0, distribution: str = "uniform", alternatives: Names = ()
) -> Sample:
    """Parameter sets whose numbers all round to the printed ones; what is no body is drawn again.

    Args:
        n: How many.
        seed: Of the random numbers.
        distribution: ``uniform`` within the intervals, or ``normal`` of the same variance, which passes their
            ends.
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        InputError: Not such numbers.
        UnknownNameError: No such distribution or alternative.
    """
    rng, chosen, out = generator(seed), believed(alternatives), np.empty((0, 0))
    normal = choice("distribution", distribution, ("uniform", "normal")) == "normal"
    middle, half = ends(chosen)
    while len(out) < count("n", n):
        shape = n - len(out), middle.size
        drawn = rng.normal(0, 3**-0.5, shape) if normal else rng.uniform(-1, 1, shape)
        sets = middle + half * drawn
        sets = sets[possible(np.tensordot(sets, link_map(chosen), 1))]
        out = np.concatenate([out.reshape(-1, middle.size), sets])
    return Sample(tuple(numbers(chosen)), frozen(out), chosen)


def possible(links: FloatArray) -> Any:
    """Which sets of links (n, 5, 14) are bodies: pseudo-inertia positive definite, no volume below 0; (n,).

    The pseudo-inertia is positive definite where the mass is positive and so are the second moments at the
    COM [Wensing2018].
    """
    spread = np.linalg.eigvalsh(links[..., 4 + SYMMETRIC])[..., 0] > 0
    return (spread & (links[..., 0] > 0) & (links[..., 10] >= 0)).all(axis=-1)
