"""Intervals of the printed numbers, samples of them, and what they leave open in torques and loads."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any

import newton_euler as second
import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import PAYLOAD, TILTED
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.base_parameters import base_parameters, regrouped
from alpha5_model.dynamics.regressor import regressor_rows
from alpha5_model.errors import Alpha5Error
from alpha5_model.inertia import pseudo_inertia
from alpha5_model.uncertainty.printed import link_map, possible

u = a5.uncertainty
TOML = Path(a5.__file__).with_name("published") / "reach_alpha_mk2_v7.toml"
SI = {"": 0, "kg": 0, "Ohm": 0, "Nm/A": 0, "V/rad/s": 0, "%": -2, "mm": -3, "L": -3, "Nmm": -3}
SI |= {"uH": -6, "kg.mm^2": -6}
AXES = "xyz"


def states(n: int, seed: int = 0) -> np.ndarray:
    """q, v, a of n states within the limits, (3, n, 4)."""
    rng = np.random.default_rng(seed)
    return np.stack([rng.uniform(LOWER, UPPER, (n, 4)), *rng.normal(scale=2.0, size=(2, n, 4))])


def transcribed() -> dict[str, tuple[str, str]]:
    """Name -> digits and unit, read from the data file by other means."""
    found: dict[str, tuple[str, str]] = {}
    root = tomllib.loads(TOML.read_text("utf-8"))
    for table, kind in (("1", "link"), ("2", "link"), ("3", "link"), ("4", "actuator")):
        data = root[f"table_{table}"]
        for i, row in enumerate(data["rows"]):
            for column, unit in data["units"].items():
                name, cell = f"{kind}_{i}.{column}", row[column]
                if unit == "rad" or cell == "a_1":
                    continue
                if isinstance(cell, str):
                    found[name] = cell, unit
                elif isinstance(cell[0], str):
                    found |= {f"{name}.{x}": (c, unit) for x, c in zip(AXES, cell, strict=True)}
                else:
                    upper = [(j, k) for j in range(3) for k in range(j, 3)]
                    found |= {f"{name}.{AXES[j]}{AXES[k]}": (cell[j][k], unit) for j, k in upper}
    for side, digits in root["table_1"]["elbow"].items():
        found[f"elbow.{side}"] = digits, "mm"
    return found


def test_every_printed_number_has_the_interval_of_its_digits() -> None:
    numbers, texts = u.printed_numbers(), transcribed()
    tolerances = {name: texts.pop(name) for name in list(texts) if name.endswith("_tolerance")}
    assert set(numbers) == set(texts)
    assert len(tolerances) == 5
    for name, (digits, unit) in texts.items():
        n, power = numbers[name], SI[unit]
        half = Decimal(10) ** -len(digits.partition(".")[2]) / 2
        if name.endswith("friction"):
            half = max(half, Decimal(digits) * Decimal(tolerances[f"{name}_tolerance"][0]) / 100)
        if n.table == "1" and not Decimal(digits):
            half = Decimal(0)
        low, high = (float((Decimal(digits) + s * half).scaleb(power)) for s in (-1, 1))
        assert (n.printed.text, n.printed.unit) == (digits, unit)
        assert n.lower == pytest.approx(low, rel=1e-13, abs=1e-18), name
        assert n.upper == pytest.approx(high, rel=1e-13, abs=1e-18), name
    mass = numbers["link_2.mass"]
    assert (mass.lower, mass.upper) == (0.375, 0.385)


def test_alternatives_change_what_they_name() -> None:
    plain, implied = u.printed_numbers(), u.printed_numbers(["implied_mass"])
    assert {n for n in plain if plain[n] != implied[n]} == {f"link_{i}.mass" for i in range(5)}
    rows = {row.claim: row for row in a5.audit()}
    for i in range(5):
        assert implied[f"link_{i}.mass"].value == pytest.approx(
            rows[f"implied_mass.link_{i}"].measured
        )
    same = u.sample(2, 1, alternatives=("torque_constant", "link3_cob")).parameters(1)
    assert all(m.voltage_constant == m.torque_constant for m in same.actuators)
    moved = a5.parameters(("base_frame", "link3_cob")).links[3].cob
    assert np.abs(same.links[3].cob - moved).max() < 1.01e-3  # half a millimetre, and a_2's
    other = u.sample(2, 1, alternatives=["voltage_constant"]).parameters(1)
    assert all(m.torque_constant == m.voltage_constant for m in other.actuators)
    assert other.actuators[0].torque_constant < same.actuators[0].torque_constant


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


def test_no_sample_is_an_impossible_body() -> None:
    """At a scale where most draws are impossible, by the pseudo-inertia's own eigenvalues."""
    drawn = u.sample(100, 3, scale=200.0)
    for k in range(100):
        for link in drawn.parameters(k).links:
            matrix = pseudo_inertia(link.mass, link.com, link.inertia)
            assert np.linalg.eigvalsh(matrix)[0] > 0
            assert link.volume >= 0
    heavy = drawn.values[:, drawn.names.index("link_2.mass")]
    assert heavy.min() < 0.2  # from -0.62 to 1.38 kg there would be 31 % of nothing
    links = np.tensordot(drawn.values[:1], link_map(()), 1)
    assert possible(links).tolist() == [True]
    for column, change in ((0, -1.0), (4, 1e-3), (5, 2e-4), (7, -1e-3), (10, -1e-3)):
        wrong = links.copy()
        wrong[0, 3, column] += change
        assert possible(wrong).tolist() == [False], column


@pytest.mark.parametrize("alternatives", [(), ("link3_cob",), ("implied_mass",)])
def test_base_parameters_of_samples(
    alternatives: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn, (q, v, a) = u.sample(3, 2, alternatives=alternatives), states(5)
    for k, ours in enumerate(drawn.base_parameters(1000.0, TILTED)):
        links = drawn.parameters(k).links
        np.testing.assert_allclose(ours, base_parameters(links, 1000.0, TILTED), atol=1e-15)
        values = dict(zip(drawn.names, drawn.values[k], strict=True))
        order = ("xx", "yy", "zz", "xy", "xz", "yz")
        com = [[values[f"link_{i}.com.{x}"] for x in AXES] for i in range(5)]
        printed = [[values[f"link_{i}.inertia_com.{x}"] for x in order] for i in range(5)]
        monkeypatch.setattr(second, "COM", np.array(com))
        monkeypatch.setattr(second, "PRINTED", np.array(printed))
        mass = np.array([values[f"link_{i}.mass"] for i in range(5)])
        volume = np.array([values[f"link_{i}.volume"] for i in range(5)])
        cob = np.array([[values[f"link_{i}.cob.{x}"] for x in AXES] for i in range(5)])
        if "link3_cob" in alternatives:
            x, y, z = cob[3]
            cob[3] = values["link_2.a"] - x, z - values["link_0.d"], y
        theirs = second.newton_euler(q, v, a, 1000.0, TILTED, mass=mass, volume=volume, cob=cob)
        linear = regressor_rows(q, v, a, np.array(TILTED)) @ ours[:-3]
        np.testing.assert_allclose(linear, np.hstack(theirs), atol=2e-13)


def test_regressor_of_an_arm() -> None:
    q, v, a = states(20)
    arms = (a5.load(), a5.load(0.0, gravity=TILTED).with_payload(**PAYLOAD))
    for arm in arms:
        many = arm.regressor(q, v, a)
        assert many.matrix.shape == (20, 4, 38)
        assert len(many.names) == len(many.units) == 38
        np.testing.assert_allclose(
            many.matrix @ many.parameters, arm.inverse_dynamics_batch(q, v, a), atol=1e-12
        )
        one = arm.regressor(q[3], v[3], a[3])
        assert one.matrix.shape == (4, 38)
        assert np.array_equal(one.matrix, many.matrix[3])
        assert np.array_equal(arm.regressor(q[3], v, a).matrix[3], many.matrix[3])
        links = [name.partition(".")[0] for name in one.names]
        assert not one.matrix[:, [link == "link_0" for link in links]].any()


def test_regressor_is_pinocchios_regrouped() -> None:
    arm, model = a5.load(fluid_density=0.0, gravity=TILTED), a5.load(0.0, gravity=TILTED).model
    data = model.createData()
    # What one of Pinocchio's ten parameters of a body is in moments: m, m c, and the tensor about the origin.
    bodies = []
    for k in range(10):
        p = np.zeros((4, 4))
        if k == 0:
            p[3, 3] = 1
        elif k < 4:
            p[k - 1, 3] = p[3, k - 1] = 1
        else:
            i, j = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))[k - 4]
            tensor = np.zeros((3, 3))
            tensor[i, j] = tensor[j, i] = 1
            p[:3, :3] = np.trace(tensor) / 2 * np.eye(3) - tensor
        bodies.append(p)
    groups = np.zeros((38, 40))
    for link, k in np.ndindex(4, 10):
        moments = np.zeros((5, 2, 4, 4))
        moments[link + 1] = bodies[k]
        groups[:, 10 * link + k] = regrouped(moments, np.zeros(3))[:-3]
    for q, v, a in states(20, 1).swapaxes(0, 1):
        theirs = pin.computeJointTorqueRegressor(model, data, q, v, a)
        np.testing.assert_allclose(arm.regressor(q, v, a).matrix @ groups, theirs, atol=1e-12)


Z = np.zeros(4)
WRONG: dict[str, Callable[[], Any]] = {
    "n: expected a whole number of at least 1, got 0": lambda: u.sample(0),
    "seed: expected a whole number": lambda: u.sample(1, -1),
    "scale: expected one at which the drawn bodies": lambda: u.sample(1, scale=1e9),
    "scale: expected a number of at least 0": lambda: u.sample(1, scale=-1),
    "unknown distribution 'box'; choose from uniform, normal": lambda: u.sample(
        1, distribution="box"
    ),
    "unknown alternative 'cob'; choose from link3_cob,": lambda: u.printed_numbers(["cob"]),
    "alternatives: expected a tuple of names": lambda: u.sample(1, alternatives="link3_cob"),
    "one motor constant at most": lambda: u.sample(
        1, alternatives=["torque_constant", "voltage_constant"]
    ),
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
