"""Intervals of the printed numbers, samples of them, and their bounds on torques."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Any

import newton_euler as second
import numpy as np
import pinocchio as pin
import pytest
from dynamics_cases import PAYLOAD, TILTED
from reference import LOWER, MASS_ROUNDING, UPPER

import alpha5_model as a5
from alpha5_model.codegen.regrouping import regrouped
from alpha5_model.errors import Alpha5Error, InputError
from alpha5_model.numbers.inertia import pseudo_inertia
from alpha5_model.numbers.parameters import Measurement

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
    """Key of an arm file -> digits and unit, read from the data file by other means."""
    found: dict[str, tuple[str, str]] = {}
    root = tomllib.loads(TOML.read_text("utf-8"))
    upper = [(j, k) for j in range(3) for k in range(j, 3)]
    for table in ("table_2", "table_3"):
        units = root[table]["units"]
        for i, row in enumerate(root[table]["rows"]):
            for column in set(units) - {"inertia_link"}:
                key = f"links.link_{i}.{column.removesuffix('_com')}"
                cell = row[column]
                cells = {"": cell}
                if not isinstance(cell, str):
                    cells = dict(zip([".x", ".y", ".z"], cell, strict=True))
                if column == "inertia_com":
                    cells = {f".{AXES[j]}{AXES[k]}": cell[j][k] for j, k in upper}
                found |= {f"{key}{at}": (c, units[column]) for at, c in cells.items()}
    rows = root["table_1"]["rows"]
    for name, i, column in (
        ("a_0", 0, "a"),
        ("d_0", 0, "d"),
        ("a_2", 2, "a"),
        ("d_3", 3, "d"),
    ):
        found[f"lengths.{name}"] = rows[i][column], "mm"
    for side, digits in root["table_1"]["elbow"].items():
        found[f"elbow.{side}"] = digits, "mm"
    units = root["table_4"]["units"]
    for joint, row in zip("edcba", root["table_4"]["rows"], strict=True):
        for column in units:
            found[f"motors.{column}.axis_{joint}"] = row[column], units[column]
    return found


def is_product(name: str) -> bool:
    """The document prints products of inertia with the other sign."""
    return name.endswith((".xy", ".xz", ".yz"))


def test_every_printed_number_has_the_interval_of_its_digits() -> None:
    numbers = u.printed_numbers()
    texts = transcribed()
    tolerances = {
        name: texts.pop(name) for name in list(texts) if "friction_tolerance" in name
    }
    assert set(numbers) == set(texts)
    assert len(tolerances) == 5
    for name, (digits, unit) in texts.items():
        n = numbers[name]
        half = Decimal(10) ** -len(digits.partition(".")[2]) / 2
        if ".friction." in name:
            of = tolerances[name.replace("friction", "friction_tolerance")][0]
            half = max(half, Decimal(digits) * Decimal(of) / 100)
        value = -Decimal(digits) if is_product(name) else Decimal(digits)
        low, high = (float((value + s * half).scaleb(SI[unit])) for s in (-1, 1))
        assert (n.printed.text, n.printed.unit) == (digits, unit)
        assert n.lower == pytest.approx(low, rel=1e-13, abs=1e-18), name
        assert n.upper == pytest.approx(high, rel=1e-13, abs=1e-18), name


def test_samples_round_to_what_is_printed() -> None:
    drawn = u.sample(200, 5)
    assert len(drawn) == 200
    numbers = u.printed_numbers()
    known = [name not in numbers for name in drawn.names]
    assert not np.ptp(drawn.values[:, known], axis=0).any()
    values = dict(zip(drawn.names, drawn.values.T, strict=True))
    for name, n in numbers.items():
        column = values[name]
        assert ((n.lower <= column) & (column <= n.upper)).all()
        if ".friction." not in name:
            places = len(n.printed.text.partition(".")[2])
            scale = 10.0 ** -SI[n.printed.unit] * (-1 if is_product(name) else 1)
            rounded = {f"{x * scale:.{places}f}".replace("-0", "0") for x in column}
            assert rounded <= {n.printed.text, n.printed.text.replace("-0", "0")}, name
    columns = np.array([values[name] for name in numbers])
    half = np.array([n.half_width for n in numbers.values()])
    np.testing.assert_allclose(columns.std(axis=1), half / np.sqrt(3), rtol=0.25)

    normal = u.sample(200, 5, distribution="normal")
    wide = dict(zip(normal.names, normal.values.T, strict=True))
    middle = np.array([n.value for n in numbers.values()])[:, None]
    beyond = np.abs([wide[name] for name in numbers] - middle) > half[:, None]
    assert 0.05 < beyond.mean() < 0.12  # 2 (1 - Phi(sqrt 3)) = 8.3 %
    assert np.array_equal(u.sample(200, 5).values, drawn.values)
    assert not np.array_equal(u.sample(200, 6).values, drawn.values)


def test_no_sample_is_an_impossible_body() -> None:
    """Half widths so wide that most draws are impossible: they are drawn again."""
    record = a5.parameters()
    widths = {"links.link_2.mass": 0.35, "links.link_3.volume": 3e-5}
    widths |= {"links.link_1.inertia": 5e-6, "links.link_4.com": 0.03}
    measurements = tuple(Measurement(key, half_width=x) for key, x in widths.items())
    drawn = u.sample(50, 3, "normal", replace(record, measurements=measurements))
    for k in range(50):
        for link in drawn.parameters(k).links:
            matrix = pseudo_inertia(link.mass, link.com, link.inertia)
            assert np.linalg.eigvalsh(matrix)[0] > 0
            assert link.volume >= 0
            lower, upper = link.bounds.T
            assert ((lower <= link.com) & (link.com <= upper)).all()
    assert np.ptp([drawn.parameters(k).links[2].mass for k in range(50)]) > 0.3


def test_every_body_of_the_intervals_is_possible() -> None:
    """No digit moves an eigenvalue of second moments below 0 (Weyl's inequality)."""
    numbers = u.printed_numbers()
    for i, link in enumerate(a5.parameters().links):
        off = np.zeros((3, 3))
        for row, column in np.ndindex(3, 3):
            axes = "".join(sorted(AXES[row] + AXES[column]))
            off[row, column] = numbers[f"links.link_{i}.inertia.{axes}"].half_width
        change = np.linalg.norm(off + np.trace(off) / 2 * np.eye(3))
        spread = np.trace(link.inertia) / 2 * np.eye(3) - link.inertia
        assert np.linalg.eigvalsh(spread)[0] > 100 * change
        assert numbers[f"links.link_{i}.mass"].lower > 0
        assert numbers[f"links.link_{i}.volume"].lower > 0


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
    key = f"links.link_{i}"
    mass[i] = values[f"{key}.mass"]
    volume[i] = values[f"{key}.volume"]
    com[i] = [values[f"{key}.com.{x}"] for x in AXES]
    cob[i] = [values[f"{key}.cob.{x}"] for x in AXES]
    order = (".xx", ".yy", ".zz", ".xy", ".xz", ".yz")
    signs = [-1 if is_product(x) else 1 for x in order]
    tensor[i] = [
        s * values[f"{key}.inertia{x}"] for s, x in zip(signs, order, strict=True)
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(second, "COM", com)
        patch.setattr(second, "PRINTED", tensor)
        found = second.newton_euler(
            q, v, a, density, TILTED, mass=mass, volume=volume, cob=cob
        )
    return np.hstack(found)


def take_lengths(values: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the tests' own Newton-Euler have the lengths among printed numbers."""
    x = values["elbow.opposite"]
    y = values["elbow.adjacent"]
    bend = np.arctan2(x, y)
    offsets = [values["lengths.d_0"], 0.0, 0.0, values["lengths.d_3"]]
    monkeypatch.setattr(second, "D", np.array(offsets))
    lengths = [
        values["lengths.a_0"],
        np.hypot(x, y),
        values["lengths.a_2"],
        0.0,
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
    wanted = {"lengths.d_3": -0.5 * 180 / lower, "elbow.opposite": 0.5 * 40 / a_1}
    wanted |= {"lengths.a_2": 0.5 * 20 / lower, "elbow.adjacent": 0.05 * 145.3 / a_1}
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


def test_sensitivity_of_torques_and_currents() -> None:
    q = np.array([3.1, 1.2, 1.8, 0.0])
    torque = u.sensitivity(lambda p: u.arm(p).hydrostatic_torque(q))
    nominal = a5.load().hydrostatic_torque(q)
    np.testing.assert_allclose(torque.nominal, nominal, atol=1e-12)
    effects = dict(torque.most(1, count=len(torque.names)))
    expected = MASS_ROUNDING[2] * 9.81 * second_lever(q)
    assert effects["links.link_2.mass"] == pytest.approx(expected, rel=1e-9)

    def current(p: Any) -> Any:
        return a5.actuators.Actuator("axis_d", p.actuators[1]).current(0.5, 0.1)

    name, effect = u.sensitivity(current).most(count=1)[0]
    assert name == "motors.friction.axis_d"
    assert effect == pytest.approx(0.1 * 3.752e-3 / 0.0134, rel=1e-9)


def test_sensitivity_is_of_the_whole_record(tmp_path: Path) -> None:
    """An arm file that changes no number of a link keeps its tool and corrections."""
    file = tmp_path / "arm.toml"
    file.write_text("format = 1\n[tool]\nxyz = [0.0, 0.0, -0.3]\n")
    record = a5.arm_file(file)
    q = [3.0, 1.2, 1.5, 0.3]

    def tcp(p: Any) -> Any:
        return u.arm(p).forward_kinematics(q).translation

    wrist = a5.load().forward_kinematics(q)
    nominal = u.sensitivity(tcp, arm=record).nominal
    near = np.linalg.norm(
        nominal - a5.load(arm=record).forward_kinematics(q).translation
    )
    assert near < 1e-12
    assert np.linalg.norm(nominal - wrist.translation) == pytest.approx(0.12)
    to_the_letter = a5.parameters(())
    count = u.sensitivity(lambda p: float(len(p.corrections)), arm=to_the_letter)
    assert count.nominal == 0


def second_lever(q: np.ndarray) -> float:
    """The horizontal lever of link 2's COM about axis_d, by the tests' own frames."""
    rotations, origins = second.link_frames(q[None])
    arm = rotations[2, 0] @ second.COM[2]
    axis = rotations[2, 0][:, 2]
    del origins
    return float(axis @ np.cross(arm, [0, 0, 1.0]))


WRONG: dict[str, Callable[[], Any]] = {
    "n: expected a whole number of at least 1, got 0": lambda: u.sample(0),
    "seed: expected a whole number": lambda: u.sample(1, -1),
    "unknown distribution 'box'; choose from uniform, normal": lambda: u.sample(
        1, distribution="box"
    ),
    "arm: expected an Arm, got 3": lambda: u.bounds(Z, Z, Z, 3),
    "q: expected shape": lambda: u.bounds([1, 2], Z, Z),
    "n: expected at least 2 sets, got 1": lambda: u.spread(u.reach, 1),
    "result": lambda: u.sensitivity(lambda p: np.nan),
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


@pytest.mark.parametrize("index", [3, -4, 10**30, 1.0, True, None])
def test_a_set_that_was_not_drawn_is_refused(index: object) -> None:
    drawn = u.sample(3)
    first, last = drawn.parameters(-3), drawn.parameters(-1)
    assert first.links[2].mass == drawn.parameters(0).links[2].mass
    assert last.links[2].mass == drawn.parameters(2).links[2].mass
    with pytest.raises(InputError, match="index: expected a whole number from 0 to 2"):
        drawn.parameters(index)  # type: ignore[arg-type]
