"""Intervals of the printed numbers, samples of them, and their bounds on torques."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from itertools import product
from pathlib import Path
from typing import Any

import newton_euler as second
import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import PAYLOAD, TILTED
from kernel_inputs import DIMENSIONS
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters, regrouped
from alpha5_model.dynamics.buoyancy import displacements
from alpha5_model.dynamics.regression import regressor_rows
from alpha5_model.errors import Alpha5Error, InputError
from alpha5_model.numbers.inertia import pseudo_inertia
from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.studies.uncertainty import linear_maps, printed
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin

u = a5.uncertainty
TOML = Path(a5.__file__).with_name("numbers") / "reach_alpha_mk2_v7.toml"
SI = {
    "": 0,
    "kg": 0,
    "Ohm": 0,
    "Nm/A": 0,
    "V/rad/s": 0,
    "%": -2,
    "mm": -3,
    "L": -3,
    "Nmm": -3,
    "uH": -6,
    "kg.mm^2": -6,
}
AXES = "xyz"
Z = np.zeros(4)


def states(n: int, seed: int = 0) -> np.ndarray:
    """q, v, a of n states within the limits, (3, n, 4)."""
    rng = np.random.default_rng(seed)
    return np.stack(
        [rng.uniform(LOWER, UPPER, (n, 4)), *rng.normal(scale=2.0, size=(2, n, 4))]
    )


def transcribed() -> dict[str, tuple[str, str]]:
    """Name -> digits and unit, read from the data file by other means."""
    found: dict[str, tuple[str, str]] = {}
    root = tomllib.loads(TOML.read_text("utf-8"))
    for table, kind in (("1", "link"), ("2", "link"), ("3", "link"), ("4", "actuator")):
        data = root[f"table_{table}"]
        for i, row in enumerate(data["rows"]):
            for column, unit in data["units"].items():
                name = f"{kind}_{i}.{column}"
                cell = row[column]
                if unit == "rad" or cell == "a_1":
                    continue
                if isinstance(cell, str):
                    found[name] = cell, unit
                elif isinstance(cell[0], str):
                    found |= {
                        f"{name}.{x}": (c, unit)
                        for x, c in zip(AXES, cell, strict=True)
                    }
                else:
                    upper = [(j, k) for j in range(3) for k in range(j, 3)]
                    found |= {
                        f"{name}.{AXES[j]}{AXES[k]}": (cell[j][k], unit)
                        for j, k in upper
                    }
    for side, digits in root["table_1"]["elbow"].items():
        found[f"elbow.{side}"] = digits, "mm"
    return found


def test_every_printed_number_has_the_interval_of_its_digits() -> None:
    numbers = u.printed_numbers()
    texts = transcribed()
    tolerances = {
        name: texts.pop(name) for name in list(texts) if name.endswith("_tolerance")
    }
    assert set(numbers) == set(texts)
    assert len(tolerances) == 5
    for name, (digits, unit) in texts.items():
        n = numbers[name]
        power = SI[unit]
        half = Decimal(10) ** -len(digits.partition(".")[2]) / 2
        if name.endswith("friction"):
            half = max(
                half,
                Decimal(digits) * Decimal(tolerances[f"{name}_tolerance"][0]) / 100,
            )
        if name.endswith((".d", ".a")) and not Decimal(digits):
            half = Decimal(0)
        low, high = (float((Decimal(digits) + s * half).scaleb(power)) for s in (-1, 1))
        assert (n.printed.text, n.printed.unit) == (digits, unit)
        assert n.lower == pytest.approx(low, rel=1e-13, abs=1e-18), name
        assert n.upper == pytest.approx(high, rel=1e-13, abs=1e-18), name
    mass = numbers["link_2.mass"]
    printed = a5.parameters().links[2].mass  # two digits
    assert (mass.lower, mass.upper) == pytest.approx((printed - 5e-3, printed + 5e-3))


@pytest.mark.slow
def test_alternatives_change_what_they_name() -> None:
    plain = u.printed_numbers()
    implied = u.printed_numbers(["implied_mass"])
    assert {n for n in plain if plain[n] != implied[n]} == {
        f"link_{i}.mass" for i in range(5)
    }
    rows = {row.claim: row for row in a5.audit()}
    for i in range(5):
        assert implied[f"link_{i}.mass"].value == pytest.approx(
            rows[f"implied_mass.link_{i}"].measured
        )
    same = u.sample(2, 1, alternatives=("torque_constant", "link3_cob")).parameters(1)
    assert all(m.voltage_constant == m.torque_constant for m in same.actuators)
    moved = a5.parameters(("base_frame", "link3_cob")).links[3].cob
    # The COB's half millimetre, and that of a_2.
    assert np.abs(same.links[3].cob - moved).max() < 1.01e-3
    other = u.sample(2, 1, alternatives=["voltage_constant"]).parameters(1)
    assert all(m.torque_constant == m.voltage_constant for m in other.actuators)
    assert other.actuators[0].torque_constant < same.actuators[0].torque_constant


@pytest.mark.slow
def test_the_missing_digit_and_the_motors_efficiency() -> None:
    plain = u.printed_numbers()
    finer = u.printed_numbers(["link2_mass"])
    assert {n for n in plain if plain[n] != finer[n]} == {"link_2.mass"}
    mass = finer["link_2.mass"]
    value = a5.parameters().links[2].mass
    assert mass.value == value
    assert (mass.lower, mass.upper) == pytest.approx((value - 5e-4, value + 5e-4))
    drawn = u.sample(200, 1, alternatives=["link2_mass"])
    masses = drawn.values[:, drawn.names.index("link_2.mass")]
    assert mass.lower <= masses.min() < value < masses.max() <= mass.upper
    # The masses of the tensors are known more closely still.
    both = u.printed_numbers(["link2_mass", "implied_mass"])["link_2.mass"]
    assert both == u.printed_numbers(["implied_mass"])["link_2.mass"]

    motors = u.printed_numbers(["motor_efficiency"])
    named = {f"actuator_{i}.efficiency" for i in range(5)}
    assert {n for n in plain if plain[n] != motors[n]} == named
    assert {(motors[n].lower, motors[n].upper) for n in named} == {(1.0, 1.0)}
    p = u.sample(1, 1, alternatives=["motor_efficiency"]).parameters(0)
    assert [m.efficiency for m in p.actuators] == [1.0] * 5

    def current(p: Any) -> Any:
        return a5.actuators.Actuator("axis_d", p.actuators[1]).current(0.5, 0.1)

    found = u.sensitivity(current, ["motor_efficiency"])
    motor = a5.actuators.actuator("axis_d", efficiency="motor")
    assert found.nominal == pytest.approx(float(motor.current(0.5, 0.1)), rel=1e-12)
    assert (
        dict(zip(found.names, found.effects, strict=True))["actuator_1.efficiency"] == 0
    )


def test_samples_round_to_what_is_printed() -> None:
    drawn = u.sample(200, 5)
    assert len(drawn) == 200
    assert np.ptp(drawn.values, axis=0).max() > 0
    numbers = u.printed_numbers()
    for name, column in zip(drawn.names, drawn.values.T, strict=True):
        n = numbers[name]
        assert ((n.lower <= column) & (column <= n.upper)).all()
        if n.lower < n.upper and not name.endswith("friction"):
            places = len(n.printed.text.partition(".")[2])
            scale = 10.0 ** -SI[n.printed.unit]
            rounded = {f"{x * scale:.{places}f}".replace("-0", "0") for x in column}
            assert rounded <= {n.printed.text, n.printed.text.replace("-0", "0")}, name
    spread = (drawn.values - drawn.values.mean(axis=0)).std(axis=0)
    half = np.array([(n.upper - n.lower) / 2 for n in numbers.values()])
    np.testing.assert_allclose(spread[half > 0], half[half > 0] / np.sqrt(3), rtol=0.25)
    normal = u.sample(200, 5, distribution="normal")
    beyond = np.abs(normal.values - drawn.values.mean(axis=0)) > half
    assert 0.05 < beyond[:, half > 0].mean() < 0.12  # 2 (1 - Phi(sqrt 3)) = 8.3 %
    assert np.array_equal(u.sample(200, 5).values, drawn.values)
    assert not np.array_equal(u.sample(200, 6).values, drawn.values)


@pytest.mark.filterwarnings("ignore::alpha5_model.errors.ImplausibleWarning")
def test_no_sample_is_an_impossible_body(monkeypatch: pytest.MonkeyPatch) -> None:
    """Samples are possible even if the intervals are so wide that most draws are not.

    The eigenvalues of the pseudo-inertia decide.
    """
    middle, half = printed.intervals(())
    of_links = [
        name.startswith("link_") and not name.endswith((".a", ".d"))
        for name in u.printed_numbers()
    ]
    wide = np.where(of_links, 200.0, 1.0) * half
    monkeypatch.setattr(printed, "intervals", lambda _: (middle, wide))
    drawn = u.sample(100, 3)
    for k in range(100):
        for link in drawn.parameters(k).links:
            matrix = pseudo_inertia(link.mass, link.com, link.inertia)
            assert np.linalg.eigvalsh(matrix)[0] > 0
            assert link.volume >= 0
    heavy = drawn.values[:, drawn.names.index("link_2.mass")]
    # Of draws from -0.62 to 1.38 kg, 31 % have no mass.
    assert heavy.min() < 0.2


def test_impossible_bodies_are_recognised() -> None:
    drawn = u.sample(100, 3)
    links = np.tensordot(drawn.values[:1], linear_maps.link_map(()), 1)
    assert linear_maps.possible(links).tolist() == [True]
    for column, change in ((0, -1.0), (4, -1e-3), (5, 2e-4), (7, -1e-3), (10, -1e-3)):
        wrong = links.copy()
        wrong[0, 3, column] += change
        assert linear_maps.possible(wrong).tolist() == [False], column


def test_every_body_of_the_intervals_is_possible() -> None:
    """No digit moves an eigenvalue of the second moments below 0 (Weyl)."""
    numbers = u.printed_numbers()
    for i, link in enumerate(a5.parameters().links):
        off = np.zeros((3, 3))
        for row, column in np.ndindex(3, 3):
            axes = "".join(sorted(AXES[row] + AXES[column]))
            number = numbers[f"link_{i}.inertia_com.{axes}"]
            off[row, column] = (number.upper - number.lower) / 2
        change = np.linalg.norm(off + np.trace(off) / 2 * np.eye(3))
        spread = np.trace(link.inertia) / 2 * np.eye(3) - link.inertia
        assert np.linalg.eigvalsh(spread)[0] > 100 * change
        assert numbers[f"link_{i}.mass"].lower > 0
        assert numbers[f"link_{i}.volume"].lower > 0


@pytest.mark.parametrize("alternatives", [(), ("link3_cob",), ("implied_mass",)])
def test_base_parameters_of_samples(
    alternatives: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = u.sample(3, 2, alternatives=alternatives)
    q, v, a = states(5)
    for k, ours in enumerate(drawn.base_parameters(1000.0, TILTED)):
        links = drawn.parameters(k).links
        np.testing.assert_allclose(
            ours,
            base_parameters(links, 1000.0, TILTED, parameters=a5.parameters()),
            atol=1e-15,
        )
        values = dict(zip(drawn.names, drawn.values[k], strict=True))
        order = ("xx", "yy", "zz", "xy", "xz", "yz")
        com = [[values[f"link_{i}.com.{x}"] for x in AXES] for i in range(5)]
        printed = [
            [values[f"link_{i}.inertia_com.{x}"] for x in order] for i in range(5)
        ]
        monkeypatch.setattr(second, "COM", np.array(com))
        monkeypatch.setattr(second, "PRINTED", np.array(printed))
        mass = np.array([values[f"link_{i}.mass"] for i in range(5)])
        volume = np.array([values[f"link_{i}.volume"] for i in range(5)])
        cob = np.array([[values[f"link_{i}.cob.{x}"] for x in AXES] for i in range(5)])
        if "link3_cob" in alternatives:
            x, y, z = cob[3]
            cob[3] = values["link_2.a"] - x, z - values["link_0.d"], y
        theirs = second.newton_euler(
            q, v, a, 1000.0, TILTED, mass=mass, volume=volume, cob=cob
        )
        linear = regressor_rows(q, v, a, np.array(TILTED), DIMENSIONS) @ ours[:-3]
        np.testing.assert_allclose(linear, np.hstack(theirs), atol=2e-13)


def test_regressor_of_an_arm() -> None:
    q, v, a = states(20)
    arms = (a5.load(), a5.load(0.0, gravity=TILTED).with_payload(**PAYLOAD))
    for arm in arms:
        many = arm.regressor(q, v, a)
        assert many.matrix.shape == (20, 4, 38)
        assert len(many.names) == len(many.units) == 38
        np.testing.assert_allclose(
            many.matrix @ many.parameters,
            arm.inverse_dynamics_batch(q, v, a),
            atol=1e-12,
        )
        one = arm.regressor(q[3], v[3], a[3])
        assert one.matrix.shape == (4, 38)
        assert np.array_equal(one.matrix, many.matrix[3])
        assert np.array_equal(arm.regressor(q[3], v, a).matrix[3], many.matrix[3])
        links = [name.partition(".")[0] for name in one.names]
        assert not one.matrix[:, [link == "link_0" for link in links]].any()


def test_regressor_is_pinocchios_regrouped() -> None:
    arm = a5.load(fluid_density=0.0, gravity=TILTED)
    model = a5.load(0.0, gravity=TILTED).model
    data = model.createData()
    groups = np.zeros((38, 40))
    for link, k in np.ndindex(4, 10):
        moments = np.zeros((5, 2, 4, 4))
        moments[link + 1] = pseudo_inertia_of_unit(k)
        groups[:, 10 * link + k] = regrouped(moments, np.zeros(3), a5.parameters())[:-3]
    for q, v, a in states(20, 1).swapaxes(0, 1):
        theirs = pin.computeJointTorqueRegressor(model, data, q, v, a)
        ours = arm.regressor(q, v, a).matrix @ groups
        np.testing.assert_allclose(ours, theirs, atol=1e-12)


def pseudo_inertia_of_unit(k: int) -> np.ndarray:
    """The pseudo-inertia of a body whose k-th of Pinocchio's ten parameters is 1.

    They are the mass, the first moments, and the tensor about the origin.
    """
    out = np.zeros((4, 4))
    if k == 0:
        out[3, 3] = 1
    elif k < 4:
        out[k - 1, 3] = 1
        out[3, k - 1] = 1
    else:
        i, j = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))[k - 4]
        tensor = np.zeros((3, 3))
        tensor[i, j] = 1
        tensor[j, i] = 1
        out[:3, :3] = np.trace(tensor) / 2 * np.eye(3) - tensor
    return out


def of_link(
    i: int, values: dict[str, float], q: Any, v: Any, a: Any, density: float
) -> np.ndarray:
    """Torques and mount load of one link alone by the tests' Newton-Euler, (N, 10)."""
    mass = np.zeros(5)
    volume = np.zeros(5)
    com = second.COM.copy()
    cob = second.COB.copy()
    tensor = np.zeros((5, 6))
    mass[i] = values[f"link_{i}.mass"]
    volume[i] = values[f"link_{i}.volume"]
    com[i] = [values[f"link_{i}.com.{x}"] for x in AXES]
    cob[i] = [values[f"link_{i}.cob.{x}"] for x in AXES]
    tensor[i] = [
        values[f"link_{i}.inertia_com.{x}"]
        for x in ("xx", "yy", "zz", "xy", "xz", "yz")
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(second, "COM", com)
        patch.setattr(second, "PRINTED", tensor)
        found = second.newton_euler(
            q, v, a, density, TILTED, mass=mass, volume=volume, cob=cob
        )
    return np.hstack(found)


def corrected(
    values: dict[str, float], corrections: tuple[str, ...]
) -> dict[str, float]:
    """Centre of buoyancy of link 3 as an arm with these corrections has it."""
    out = dict(values)
    if "link3_cob" in corrections:
        out["link_3.cob.x"] = values["link_2.a"] - values["link_3.cob.x"]
        out["link_3.cob.y"] = values["link_3.cob.z"] - values["link_0.d"]
        out["link_3.cob.z"] = values["link_3.cob.y"]
    return out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("of_arm", "alternatives"),
    [
        (("base_frame",), ()),
        (("base_frame",), ("link3_cob",)),
        (("base_frame", "link3_cob"), ()),
        (("base_frame", "link3_cob"), ("link3_cob",)),
    ],
)
def test_bounds_at_rest_are_attained_at_a_corner(
    of_arm: tuple[str, ...], alternatives: tuple[str, ...]
) -> None:
    """All corners of each link's mass and COM, and of its volume and COB, one by one.

    The arm's own corrections count once, even if they are among the alternatives.
    """
    q, _, _ = states(4, 7)
    corrections = of_arm + alternatives
    low = np.zeros((4, 10))
    high = np.zeros((4, 10))
    for i in range(5):
        for kind in ("mass", "volume"):
            found = [
                loads_at_rest(i, kind, corner, q, corrections)
                for corner in corners(i, kind, corrections)
            ]
            low += np.min(found, axis=0)
            high += np.max(found, axis=0)
    arm = a5.load(1000.0, gravity=TILTED, corrections=of_arm)
    still = np.zeros((4, 4))
    ours = u.bounds(q, still, still, arm, alternatives)
    lower, upper = (np.hstack([ours.torque[k], ours.base_wrench[k]]) for k in (0, 1))
    np.testing.assert_allclose(lower, low, rtol=0, atol=1e-12)
    np.testing.assert_allclose(upper, high, rtol=0, atol=1e-12)
    assert (upper[:, 1] - lower[:, 1] > 1e-3).all()


def corners(
    i: int, kind: str, corrections: tuple[str, ...]
) -> Iterator[dict[str, float]]:
    """The ends of the intervals of a link's mass and COM, or of its volume and COB."""
    numbers = u.printed_numbers()
    centre = {"mass": "com", "volume": "cob"}[kind]
    names = [f"link_{i}.{kind}", *(f"link_{i}.{centre}.{x}" for x in AXES)]
    if (i, centre) == (3, "cob") and "link3_cob" in corrections:
        names += ["link_2.a", "link_0.d"]
    intervals = [(numbers[name].lower, numbers[name].upper) for name in names]
    for ends in product(*intervals):
        yield dict(zip(names, ends, strict=True))


def loads_at_rest(
    i: int,
    kind: str,
    corner: dict[str, float],
    q: np.ndarray,
    corrections: tuple[str, ...],
) -> np.ndarray:
    """Torques and mount load of one link's weight, or of its buoyancy, (N, 10)."""
    middle = {name: number.value for name, number in u.printed_numbers().items()}
    other_kind = {"mass": "volume", "volume": "mass"}[kind]
    other = {f"link_{i}.{other_kind}": 0.0}
    values = corrected({**middle, **corner, **other}, corrections)
    still = np.zeros_like(q)
    return of_link(i, values, q, still, still, 1000.0)


@pytest.mark.slow
@pytest.mark.parametrize("of_arm", [(), ("link3_cob",)])
def test_bounds_of_an_arm_with_its_base_turned(of_arm: tuple[str, ...]) -> None:
    """Without ``base_frame``, only link 0 is turned."""
    q, _, _ = states(4, 7)
    still = np.zeros((4, 4))
    turned = a5.load(1000.0, gravity=TILTED, corrections=of_arm)
    usual = a5.load(1000.0, gravity=TILTED, corrections=("base_frame", *of_arm))
    for alternatives in ((), ("link3_cob",)):
        ours = u.bounds(q, still, still, turned, alternatives)
        same = u.bounds(q, still, still, usual, alternatives)
        np.testing.assert_allclose(ours.torque, same.torque, rtol=0, atol=1e-12)
        moved = np.subtract(ours.base_wrench, same.base_wrench)
        shift = turned.base_wrench_batch(q, still, still)
        shift -= usual.base_wrench_batch(q, still, still)
        np.testing.assert_allclose(moved, [shift, shift], rtol=0, atol=1e-12)


def test_bounds_in_motion_are_hardly_wider_than_the_best_corner() -> None:
    """Corners found by walking along the edges, with the tests' own Newton-Euler."""
    q, v, a = states(3, 8)
    numbers = u.printed_numbers()
    ours = u.bounds(q, v, a, a5.load(1000.0, gravity=TILTED))
    found = np.zeros((2, 3, 10))
    for i in range(5):
        names = [name for name in numbers if is_of_body(name, i)]

        def value(at: dict[str, float], i: int = i) -> np.ndarray:
            return of_link(i, at, q, v, a, 1000.0)

        middle = {n: numbers[n].value for n in names}
        highest = [value({**middle, n: numbers[n].upper}) for n in names]
        lowest = [value({**middle, n: numbers[n].lower}) for n in names]
        rising = np.subtract(highest, lowest)
        for side, row, column in np.ndindex(2, 3, 10):
            up = (rising[:, row, column] > 0) == (side == 1)
            at = {
                n: numbers[n].upper if high else numbers[n].lower
                for n, high in zip(names, up, strict=True)
            }
            # The other columns would show nothing new.
            if column in (1, 2, 5, 7):
                found[side, row, column] += value(at)[row, column]
    lower = np.hstack([ours.torque.lower, ours.base_wrench.lower])
    upper = np.hstack([ours.torque.upper, ours.base_wrench.upper])
    for column in (1, 2, 5, 7):
        lowest, highest = found[:, :, column]
        wide = upper[:, column] - lower[:, column]
        assert (lower[:, column] <= lowest).all()
        assert (upper[:, column] >= highest).all()
        assert (wide <= 1.01 * (highest - lowest)).all()
        assert (wide > 1e-6).all()


def is_of_body(name: str, link: int) -> bool:
    """Whether a printed number is of a link's body, and not of its length or shape."""
    body = name.startswith(f"link_{link}.") and "_link" not in name[7:]
    return body and not name.endswith((".d", ".a"))


def holds(interval: Any, value: Any, i: Any = slice(None)) -> bool:
    """Whether row i of an interval contains a value."""
    return bool(((interval.lower[i] <= value) & (value <= interval.upper[i])).all())


@pytest.mark.parametrize(
    "alternatives", [(), ("link3_cob",), ("implied_mass",), ("link2_mass",)]
)
def test_bounds_hold_all_samples(alternatives: tuple[str, ...]) -> None:
    """Torques and mount loads of 20 000 samples, by base parameters."""
    q, v, a = still_and_fast_states()
    arm = a5.load(gravity=TILTED).with_payload(**PAYLOAD)
    ours = u.bounds(q, v, a, arm, alternatives)
    sample = u.sample(20_000, 11, alternatives=alternatives)
    drawn = sample.base_parameters(gravity=TILTED)[:, :38]
    linear = regressor_rows(q, v, a, np.array(TILTED), DIMENSIONS)
    bare = a5.load(gravity=TILTED)
    payload = arm.regressor(q, v, a).parameters - bare.regressor(q, v, a).parameters
    load = linear @ payload
    for some in np.split(drawn, 10):
        every = (some @ linear.reshape(-1, 38).T).reshape(-1, 30, 10) + load
        assert holds(ours.torque, every[..., :4])
        assert holds(ours.base_wrench, every[..., 4:])


def still_and_fast_states() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """q, v, a of 30 states, of which ten are at rest and ten are fast."""
    q, v, a = states(30, 4)
    v[:10] = 0
    a[:10] = 0
    v[20:] *= 20
    return q, v, a


def sampled_arms(count: int, seed: int, alternatives: Sequence[str]) -> Iterator[Any]:
    """Arms of samples that hold PAYLOAD; bounds do not include Table 1's intervals."""
    sample = u.sample(count, seed, alternatives=alternatives)
    for k in range(count):
        parameters = replace(sample.parameters(k), dh=a5.parameters().dh)
        yield u.arm(parameters, gravity=TILTED).with_payload(**PAYLOAD)


@pytest.mark.parametrize(
    "alternatives", [(), ("link3_cob",), ("implied_mass",), ("link2_mass",)]
)
def test_bounds_hold_the_energies_and_torques_of_sampled_arms(
    alternatives: tuple[str, ...],
) -> None:
    """The second route is Pinocchio, for an arm that holds something."""
    q, v, a = still_and_fast_states()
    arm = a5.load(gravity=TILTED).with_payload(**PAYLOAD)
    ours = u.bounds(q, v, a, arm, alternatives)
    for one in sampled_arms(20, 12, alternatives):
        for i in (0, 15, 25):
            assert holds(ours.kinetic_energy, one.kinetic_energy(q[i], v[i]), i)
            assert holds(ours.potential_energy, one.potential_energy(q[i]), i)
            assert holds(ours.torque, one.inverse_dynamics(q[i], v[i], a[i]), i)


@pytest.mark.parametrize(
    "alternatives", [(), ("link3_cob",), ("implied_mass",), ("link2_mass",)]
)
def test_bounds_do_not_hold_other_alternatives(alternatives: tuple[str, ...]) -> None:
    """So bounds that hold everything would be found."""
    q, v, a = still_and_fast_states()
    arm = a5.load(gravity=TILTED).with_payload(**PAYLOAD)
    ours = u.bounds(q, v, a, arm, alternatives)
    others = ["implied_mass"] if "link3_cob" in alternatives else ["link3_cob"]
    (other,) = sampled_arms(1, 1, others)
    assert not holds(ours.torque, other.inverse_dynamics_batch(q, v, a))


def test_margin_of_an_arm_with_jaws() -> None:
    """Each sample's wrist is its link 4 without the fingers, which are not printed."""
    q, v, a = (np.hstack([x, np.full((4, 1), 0.005)]) for x in states(4, 6))
    jaws = a5.load(gripper="jaws").with_payload(**PAYLOAD)
    low, high = jaws.inverse_dynamics_batch(q, v, a) + torque_margin(jaws, q, v, a)
    drawn = u.sample(30, 14)
    for k in range(30):
        p = replace(drawn.parameters(k), dh=a5.parameters().dh)
        base = a5.load(gripper="jaws")
        model = base._joint_tree.model.copy()
        for link in (*p.links[1:4], split_link_4(p).wrist):
            joint = model.frames[model.getFrameId(link.name)].parentJoint
            model.inertias[joint] = pin.Inertia(link.mass, link.com, link.inertia)
        volumes = displacements(model, p, "jaws")
        other = type(base)(model, volumes, 1025.0, *base._constructor_arguments[3:])
        tau = other.with_payload(**PAYLOAD).inverse_dynamics_batch(q, v, a)
        assert (low <= tau + 1e-12).all()
        assert (tau - 1e-12 <= high).all()
    assert ((high - low)[:, 1] > 1e-3).all()
    assert np.array_equal(low[:, 4], high[:, 4])


def test_margin_of_an_arm_with_a_correction() -> None:
    """The correction is the arm's: the printed digits move it about its own torques."""
    q, v, a = states(3, 6)
    corrected = a5.load(corrections=("base_frame", "link3_cob"))
    low, high = torque_margin(corrected, q, v, a)
    nominal = corrected.inverse_dynamics_batch(q, v, a)
    expected = u.bounds(q, v, a, corrected).torque
    np.testing.assert_allclose(low + nominal, expected.lower, rtol=0, atol=1e-14)
    np.testing.assert_allclose(high + nominal, expected.upper, rtol=0, atol=1e-14)
    usual = torque_margin(a5.load(), q, v, a)
    assert np.abs(np.subtract([low, high], usual)).max() > 1e-5


def test_bounds_of_one_state_are_those_of_many() -> None:
    q, v, a = states(3, 2)
    many = u.bounds(q, v, a)
    one = u.bounds(q[1], v[1], a[1])
    for several, single in zip(many, one, strict=True):
        np.testing.assert_allclose(
            single.lower, several.lower[1], rtol=1e-13, atol=1e-15
        )
        np.testing.assert_allclose(
            single.upper, several.upper[1], rtol=1e-13, atol=1e-15
        )
    assert np.array_equal(u.torque_bounds(q, v, a).lower, many.torque.lower)
    air = u.torque_bounds(q, v, a, fluid_density=0.0)
    assert np.array_equal(air.upper, u.bounds(q, v, a, a5.load(0.0)).torque.upper)
    still = u.torque_bounds(q[0], np.zeros(4), np.zeros(4))
    assert (still.lower < a5.load().hydrostatic_torque(q[0])).all()


def take_lengths(values: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the tests' own Newton-Euler have the lengths among printed numbers."""
    x = values["elbow.opposite"]
    y = values["elbow.adjacent"]
    bend = np.arctan2(x, y)
    offsets = [values[f"link_{i}.d"] for i in range(4)]
    monkeypatch.setattr(second, "D", np.array(offsets))
    lengths = [
        values["link_0.a"],
        np.hypot(x, y),
        values["link_2.a"],
        values["link_3.a"],
    ]
    monkeypatch.setattr(second, "A", np.array(lengths))
    turn = np.array([np.pi, bend - np.pi / 2, bend - np.pi / 2, np.pi / 2])
    monkeypatch.setattr(second, "OFFSET", turn)


def test_an_arm_of_other_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sample's arm, lengths included, agrees with the tests' own Newton-Euler."""
    q, v, a = states(3, 5)
    drawn = u.sample(2, 9)
    p = drawn.parameters(1)
    values = dict(zip(drawn.names, drawn.values[1], strict=True))
    take_lengths(values, monkeypatch)
    theirs = sum(of_link(i, values, q, v, a, 1000.0) for i in range(5))
    arm = u.arm(p, 1000.0, TILTED)
    torque = arm.inverse_dynamics_batch(q, v, a)
    np.testing.assert_allclose(torque, theirs[:, :4], atol=1e-12)
    wrench = arm.base_wrench_batch(q, v, a)
    np.testing.assert_allclose(wrench, theirs[:, 4:], atol=1e-12)
    catalogue = a5.load(1000.0, gravity=TILTED).inverse_dynamics_batch(q, v, a)
    assert np.abs(theirs[:, 1] - catalogue[:, 1]).max() > 1e-4


def test_an_arm_of_the_printed_numbers_is_the_one_that_is_loaded() -> None:
    q, v, a = states(3, 5)
    loaded = a5.load(corrections=()).base_wrench_batch(q, v, a)
    same = u.arm(a5.parameters(())).base_wrench_batch(q, v, a)
    np.testing.assert_allclose(same, loaded, atol=1e-12)


@pytest.mark.slow
def test_sensitivity_of_the_reach() -> None:
    """The reach is a_1 + hypot(a_2, d_3), with a_1 = hypot(40, 145.3)."""
    found = u.sensitivity(u.reach)
    lower = np.hypot(20, 180)
    a_1 = np.hypot(40, 145.3)
    wanted = {"link_3.d": -0.5 * 180 / lower, "elbow.opposite": 0.5 * 40 / a_1}
    wanted |= {"link_2.a": 0.5 * 20 / lower, "elbow.adjacent": 0.05 * 145.3 / a_1}
    assert found.nominal == pytest.approx((lower + a_1) / 1000, rel=1e-12)
    assert [name for name, _ in found.most(count=4)] == list(wanted)
    for name, effect in found.most(count=4):
        assert effect == pytest.approx(wanted[name] / 1000, rel=1e-5), name
    assert found.half_width == pytest.approx(
        sum(map(abs, wanted.values())) / 1000, rel=1e-5
    )
    drawn = u.spread(u.reach, 400, 2)
    exact = np.sqrt(sum(x**2 for x in wanted.values()) / 3) / 1000
    assert drawn.standard_deviation == pytest.approx(exact, rel=0.1)
    assert abs(drawn.mean - found.nominal) < 4 * drawn.standard_error
    assert drawn.standard_error == pytest.approx(drawn.standard_deviation / 20)


@pytest.mark.slow
def test_sensitivity_of_torques_and_currents() -> None:
    q = np.array([3.1, 1.2, 1.8, 0.0])
    torque = u.sensitivity(lambda p: u.arm(p).hydrostatic_torque(q))
    np.testing.assert_allclose(
        torque.nominal, a5.load().hydrostatic_torque(q), atol=1e-12
    )
    inside = [
        k
        for k, n in enumerate(torque.names)
        if "mass" in n or "com" in n or "volume" in n or "cob" in n
    ]
    low, high = u.torque_bounds(q, Z, Z)
    half = np.abs(torque.effects[inside]).sum(axis=0)
    np.testing.assert_allclose((high - low) / 2, half, rtol=1e-2, atol=1e-12)
    name, effect = torque.most(1)[0]
    assert name == "link_2.mass"
    assert effect == pytest.approx(0.005 * 9.81 * second_lever(q), rel=1e-9)

    def current(p: Any) -> Any:
        return a5.actuators.Actuator("axis_d", p.actuators[1]).current(0.5, 0.1)

    name, effect = u.sensitivity(current).most(count=1)[0]
    assert name == "actuator_1.friction"
    assert effect == pytest.approx(0.1 * 3.752e-3 / 0.0134, rel=1e-9)
    same = u.sensitivity(current, ["voltage_constant"])
    assert same.nominal == pytest.approx(
        u.sensitivity(current).nominal * 0.0134 / 0.0116
    )


def second_lever(q: np.ndarray) -> float:
    """The horizontal lever of link 2's COM about axis_d, by the tests' own frames."""
    rotations, origins = second.link_frames(q[None])
    arm = rotations[2, 0] @ second.COM[2]
    axis = rotations[2, 0][:, 2]
    del origins
    return float(axis @ np.cross(arm, [0, 0, 1.0]))


def swing(n: int, seed: int = 0) -> tuple[Any, np.ndarray]:
    """A motion of five sines in each joint, and its exact q, v, a, (3, n, 4)."""
    rng = np.random.default_rng(seed)
    time = 0.02 * np.arange(n)
    rate = 2 * np.pi * rng.uniform(0.1, 0.8, (5, 4))
    size = rng.uniform(0.06, 0.2, (5, 4)) / rate
    phase = rng.uniform(0, 6, (5, 4))
    angle = rate * time[:, None, None] + phase
    q = np.array([3.0, 1.7, 1.7, 3.0]) + (size * np.sin(angle)).sum(axis=1)
    v = (size * rate * np.cos(angle)).sum(axis=1)
    a = -(size * rate**2 * np.sin(angle)).sum(axis=1)
    return a5.trajectory.motion(time, q), np.array([q, v, a])


WRONG: dict[str, Callable[[], Any]] = {
    "n: expected a whole number of at least 1, got 0": lambda: u.sample(0),
    "seed: expected a whole number": lambda: u.sample(1, -1),
    "unknown distribution 'box'; choose from uniform, normal": lambda: u.sample(
        1, distribution="box"
    ),
    "unknown alternative 'cob'; choose from link3_cob,": lambda: u.printed_numbers(
        ["cob"]
    ),
    "alternatives: expected a tuple of names": lambda: u.sample(
        1, alternatives="link3_cob"
    ),
    "arm: expected a Arm, got 3": lambda: u.bounds(Z, Z, Z, 3),
    "q: expected shape": lambda: u.torque_bounds([1, 2], Z, Z),
    "unknown alternative 'x'": lambda: u.torque_bounds(Z, Z, Z, alternatives=["x"]),
    "n: expected at least 2 sets, got 1": lambda: u.spread(u.reach, 1),
    "result": lambda: u.sensitivity(lambda p: np.nan),
    "fluid_density: expected": lambda: u.sample(1).base_parameters(-1.0),
    "gravity: expected": lambda: u.sample(1).base_parameters(1.0, [1, 2]),
    "arm: expected one on a fixed base": lambda: a5.load(gripper="jaws").regressor(
        np.zeros(5), np.zeros(5), np.zeros(5)
    ),
    "q: expected": lambda: a5.load().regressor([1, 2], Z, Z),
    "v": lambda: a5.load().regressor(Z, [np.nan] * 4, Z),
}


@pytest.mark.parametrize("words", WRONG)
def test_wrong_input_is_said(words: str) -> None:
    with pytest.raises(Alpha5Error) as caught:
        WRONG[words]()
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_one_constant_of_a_motor_counts_for_both_if_that_is_asked() -> None:
    """With other alternatives, the two printed constants stay different."""
    for alternatives, together in (
        ((), False),
        (("implied_mass", "voltage_constant"), True),
    ):
        motor = u.sample(1, 3, alternatives=alternatives).parameters(0).actuators[2]
        assert (motor.torque_constant == motor.voltage_constant) is together


@pytest.mark.parametrize("index", [3, -4, 10**30, 1.0, True, None])
def test_a_set_that_was_not_drawn_is_refused(index: object) -> None:
    drawn = u.sample(3)
    first, last = drawn.parameters(-3), drawn.parameters(-1)
    assert first.links[2].mass == drawn.parameters(0).links[2].mass
    assert last.links[2].mass == drawn.parameters(2).links[2].mass
    with pytest.raises(InputError, match="index: expected a whole number from 0 to 2"):
        drawn.parameters(index)  # type: ignore[arg-type]
