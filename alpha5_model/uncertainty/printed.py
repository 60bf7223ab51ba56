"""What the digits of each printed number allow, and parameter sets drawn from that.

A number stands for all that round to it: 0.38 kg is 0.375 to 0.385 kg; friction has the tolerance that is
printed with it. Zeros of Table 1 are exact: axes that meet are no measured lengths.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields, replace
from decimal import Decimal
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model.base_parameters import regrouped
from alpha5_model.checks import FloatArray, choice, count, frozen, generator, listed, real
from alpha5_model.consistency.bodies import implied_mass
from alpha5_model.corrections import CORRECTIONS, DEFAULT_CORRECTIONS
from alpha5_model.dynamics.states import vector
from alpha5_model.errors import InputError
from alpha5_model.fluids import GRAVITY, SEA_WATER
from alpha5_model.inertia import second_moments
from alpha5_model.parameters import Alpha5Parameters, convert
from alpha5_model.published import published
from alpha5_model.published.quantity import DECIMAL_SHIFT, Quantity
from alpha5_model.published.tables import Published

#: Where the documents contradict themselves: name -> what is believed in place of the plain reading.
ALTERNATIVES: dict[str, str] = {
    "link3_cob": CORRECTIONS["link3_cob"].statement,
    "implied_mass": "The masses that best carry Table 2's I_COM to its I_Link, not those printed.",
    "torque_constant": "Table 4's K_t for both constants of a motor, which should agree.",
    "voltage_constant": "Table 4's K_v for both.",
}
DISTRIBUTIONS = ("uniform", "normal")
#: Numbers of a link in `link_numbers`: mass, COM (3), tensor at the COM (6), volume, COB (3).
NUMBERS = 14
UPPER = np.triu_indices(3)
_Change = Callable[[str, Quantity], Quantity]
#: What a draw in which no body is possible has tried at least.
_TRIES = 100


@dataclass(frozen=True)
class PrintedNumber:
    """A number of Tables 1 to 4 and its interval, SI units.

    Attributes:
        name: As ``link_2.mass``, ``link_3.cob.z``, ``link_1.inertia_com.xy``, ``actuator_0.friction``.
        table: ``"1"`` to ``"4"``.
        printed: Digits and unit as printed.
        value: The middle of the interval; of an implied mass not what is printed.
        lower, upper: Its ends.
    """

    name: str
    table: str
    printed: Quantity
    value: float
    lower: float
    upper: float


def check_alternatives(alternatives: Iterable[str]) -> tuple[str, ...]:
    """The alternatives asked for, once each, in the order of `ALTERNATIVES`.

    Raises:
        InputError: Not a collection of names, or both motor constants.
        UnknownNameError: An alternative that is not recorded.
    """
    expected = "a tuple of names, such as ('link3_cob',), with one motor constant at most"
    names = () if isinstance(alternatives, str) else alternatives
    asked = {
        choice("alternative", x, tuple(ALTERNATIVES))
        for x in listed("alternatives", names, expected)
    }
    if names is not alternatives or {"torque_constant", "voltage_constant"} <= asked:
        raise InputError("alternatives", alternatives, expected)
    return tuple(name for name in ALTERNATIVES if name in asked)


def printed_numbers(alternatives: Iterable[str] = ()) -> dict[str, PrintedNumber]:
    """Every number of Tables 1 to 4 by its name, with the interval that its digits allow.

    Args:
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        UnknownNameError: An alternative that is not recorded.
    """
    return dict(_numbers(check_alternatives(alternatives)))


@cache
def _numbers(alternatives: tuple[str, ...]) -> dict[str, PrintedNumber]:
    found: dict[str, PrintedNumber] = {}
    table = ""

    def note(name: str, number: Quantity) -> Quantity:
        exact = table == "1" and not number.value
        half = 0.0 if exact else number.rounding
        found[name] = _centred(name, table, number, number.si, half)
        return number

    for table in "1234":
        _changed(table, note)
    for i in range(5):
        friction = found[f"actuator_{i}.friction"]
        share = found.pop(f"actuator_{i}.friction_tolerance").value
        half = max(friction.upper - friction.value, share * friction.value)
        found[friction.name] = _centred(friction.name, "4", friction.printed, friction.value, half)
        mass = found[f"link_{i}.mass"]
        if "implied_mass" in alternatives:
            value, bound = implied_mass(published().table_2.rows[i])
            found[mass.name] = _centred(mass.name, "2", mass.printed, value, bound)
    return found


def _centred(name: str, table: str, printed: Quantity, value: float, half: float) -> PrintedNumber:
    return PrintedNumber(name, table, printed, value, value - half, value + half)


def _changed(table: str, change: _Change) -> dict[str, Any]:
    """The fields of `Published` that hold a table, each number changed."""
    printed = published()
    one = getattr(printed, f"table_{table}")
    kind = "actuator" if table == "4" else "link"
    rows = tuple(_walked(f"{kind}_{i}", row, change) for i, row in enumerate(one.rows))
    out = {f"table_{table}": replace(one, rows=rows)}
    return out | ({"elbow": _walked("elbow", printed.elbow, change)} if table == "1" else {})


def _walked(name: str, value: Any, change: _Change, axes: str = "") -> Any:
    """A record, tuple or number with its numbers changed; the two halves of a tensor have the same names."""
    if isinstance(value, Quantity):
        return change(".".join(filter(None, (name, "".join(sorted(axes))))), value)
    if isinstance(value, tuple):
        items = zip("xyz", value, strict=True)
        return tuple(_walked(name, item, change, axes + axis) for axis, item in items)
    if isinstance(value, str):
        return value
    parts = {f.name: getattr(value, f.name) for f in fields(value)}
    return replace(value, **{k: _walked(f"{name}.{k}", x, change) for k, x in parts.items()})


def parameter_set(values: dict[str, float], alternatives: tuple[str, ...] = ()) -> Alpha5Parameters:
    """The arm's parameters with other values of the printed numbers, by name, SI units."""
    same = [name for name in alternatives if name.endswith("_constant")]

    def change(name: str, number: Quantity) -> Quantity:
        if same and name.endswith("_constant"):
            name = f"{name.partition('.')[0]}.{same[0]}"
        if name not in values:
            return number
        shift = -DECIMAL_SHIFT[number.unit]
        return Quantity(str(Decimal(repr(float(values[name]))).scaleb(shift)), number.unit)

    tables: dict[str, Any] = {}
    for table in "1234":
        tables |= _changed(table, change)
    corrections = tuple(name for name in alternatives if name in CORRECTIONS)
    moved: Published = replace(published(), **tables)
    return convert(moved, DEFAULT_CORRECTIONS + corrections)


@cache
def link_map(alternatives: tuple[str, ...]) -> FloatArray:
    """What the printed numbers make of the links, (K, 5, NUMBERS): it is linear, the frame of link 3 included."""
    names = tuple(_numbers(alternatives))
    out = np.zeros((len(names), 5, NUMBERS))
    for k, row in enumerate(np.eye(len(names))):
        for i, link in enumerate(
            parameter_set(dict(zip(names, row, strict=True)), alternatives).links
        ):
            tensor = link.inertia[UPPER]
            out[k, i] = [link.mass, *link.com, *tensor, link.volume, *link.cob]
    return frozen(out)


@cache
def grouping(fluid_density: float) -> FloatArray:
    """Base parameters, gravity left out, of each link's mass, first and second moments, volume and its first moments.

    (5, NUMBERS, 38): moments about the origin of the link's frame, second ones as sums of ``m x y``.
    """
    places = [(3, 3), (0, 3), (1, 3), (2, 3), *zip(*UPPER, strict=True)]
    out = []
    for link, k in np.ndindex(5, NUMBERS):
        i, j = places[k % 10]
        moments = np.zeros((5, 2, 4, 4))
        for row, column in ((i, j), (j, i)):
            moments[link, :, row, column] = 1.0 if k < 10 else (0.0, -fluid_density)
        out.append(regrouped(moments, np.zeros(3))[:-3])
    return frozen(np.reshape(out, (5, NUMBERS, -1)))


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
        """One set as the record that `alpha5_model.parameters` returns."""
        values = dict(zip(self.names, self.values[index].tolist(), strict=True))
        return parameter_set(values, self.alternatives)

    def base_parameters(
        self, fluid_density: float = SEA_WATER, gravity: ArrayLike = GRAVITY
    ) -> FloatArray:
        """`alpha5_model.base_parameters` of every set, for the generated kernels, (n, 41).

        The lengths of Table 1 are built into the kernels and stay as printed.
        """
        density = real("fluid_density", fluid_density, minimum=0.0)
        links = np.tensordot(self.values, link_map(self.alternatives), 1)
        groups = np.tensordot(moments(links), grouping(density), 2)
        weight = np.broadcast_to(vector("gravity", gravity, 3), (len(self), 3))
        return np.concatenate([groups, weight], axis=1)


def moments(links: FloatArray) -> FloatArray:
    """Numbers of links (..., NUMBERS) to those that torques are linear in: m, m c, second moments, V, V b."""
    mass, com, volume, cob = links[..., :1], links[..., 1:4], links[..., 10:11], links[..., 11:]
    i, j = UPPER
    second = mass * com[..., i] * com[..., j] + second_moments(_tensors(links))[..., i, j]
    return np.concatenate([mass, mass * com, second, volume, volume * cob], axis=-1)


def _tensors(links: FloatArray) -> FloatArray:
    out = np.empty((*links.shape[:-1], 3, 3))
    i, j = UPPER
    out[..., i, j] = out[..., j, i] = links[..., 4:10]
    return out


def possible(links: FloatArray) -> Any:
    """Which sets of links (n, 5, NUMBERS) are bodies: pseudo-inertia positive definite, no volume below 0; (n,).

    The pseudo-inertia is positive definite where the mass is positive and so are the second moments at the
    COM [Wensing2018].
    """
    spread = np.linalg.eigvalsh(second_moments(_tensors(links)))[..., 0] > 0
    return (spread & (links[..., 0] > 0) & (links[..., 10] >= 0)).all(axis=-1)


def sample(
    n: int,
    seed: int = 0,
    *,
    distribution: str = "uniform",
    scale: float = 1.0,
    alternatives: Iterable[str] = (),
) -> Sample:
    """Parameter sets whose numbers all round to the printed ones; bodies that cannot be are drawn again.

    Args:
        n: How many.
        seed: Of the random numbers.
        distribution: ``uniform`` within the intervals, or ``normal`` of the same variance, which passes their
            ends.
        scale: Widens every interval.
        alternatives: Names of `ALTERNATIVES` to believe.

    Raises:
        InputError: Not such numbers, or a scale at which no draw gives bodies.
        UnknownNameError: No such distribution or alternative.
    """
    n, rng, width = count("n", n), generator(seed), real("scale", scale, minimum=0.0)
    normal = choice("distribution", distribution, DISTRIBUTIONS) == "normal"
    chosen = check_alternatives(alternatives)
    numbers = _numbers(chosen).values()
    middle, upper = np.array([(x.value, x.upper) for x in numbers]).T
    half = width * (upper - middle)
    out = np.empty((0, middle.size))
    while len(out) < n:
        shape = max(n - len(out), _TRIES), middle.size
        drawn = rng.normal(0, 1 / np.sqrt(3), shape) if normal else rng.uniform(-1, 1, shape)
        sets = middle + half * drawn
        sets = sets[possible(np.tensordot(sets, link_map(chosen), 1))]
        if not len(sets):
            raise InputError("scale", scale, "one at which the drawn bodies are possible")
        out = np.concatenate([out, sets])[:n]
    return Sample(tuple(_numbers(chosen)), frozen(out), chosen)
