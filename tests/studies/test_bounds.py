"""Bounds of catalogued, own and calibrated arms against Newton's and Euler's equations.

Gradients are differences of these for records with one number changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

import alpha5_model as a5
from alpha5_model.numbers.arm_schema import LINKS, NUMBERS
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.numbers.pose import printed_tool
from alpha5_model.studies.arm_numbers import arm_numbers
from alpha5_model.studies.uncertainty.digit_bounds import torque_margin
from alpha5_model.studies.uncertainty.sampling import drawn_values

u = a5.uncertainty
JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b", "axis_a")
ROWS = {"a_0": (0, "a"), "d_0": (0, "d"), "a_1": (1, "a"), "a_2": (2, "a")}
ROWS["d_3"] = (3, "d")
#: Standard deviations before a calibration, SI units.
SIZES = {"mass": 4e-3, "com": 1e-3, "inertia": 2e-6, "volume": 4e-6, "cob": 1e-3}
SIZES |= {"zeros": 0.01, "lengths": 5e-4}
PRODUCTS = ("xx", "xy", "xz", "yy", "yz", "zz")
#: No doubt about any link.
EXACT_LINKS = {
    f"links.{link}.{quantity}": 0.0
    for link in LINKS
    for quantity in ("mass", "com", "inertia", "volume", "cob")
}
DOWN = np.array([0.0, 0.0, -9.81])


def size_of(name: str) -> float:
    table, _, *quantity = name.split(".")
    return SIZES[quantity[0] if table == "links" else table]


def calibrated(
    seed: int, names: Sequence[str], half_widths: dict[str, float]
) -> Alpha5Parameters:
    """A random arm whose numbers of these names are known together.

    Args:
        seed: Of the arm.
        names: Of the covariance.
        half_widths: Key -> half width of other values.
    """
    rng = np.random.default_rng(seed)
    factor = rng.normal(size=(len(names), 5))
    covariance = Covariance(
        names=tuple(names),
        deviation=np.array([size_of(name) for name in names]),
        factor=0.95 * factor / np.linalg.norm(factor, 2),
    )
    widths = {**half_widths, **covariance.half_widths}
    measurements = [Measurement(key, half_width=x) for key, x in widths.items()]
    return replace(
        own.random_record(seed),
        covariance=covariance,
        measurements=tuple(measurements),
    )


def moved(record: Alpha5Parameters, name: str, by: float) -> Alpha5Parameters:
    """The record with one number of an arm file changed."""
    table, key, *rest = name.split(".")
    if table == "links":
        return with_link(record, int(key[-1]), rest, by)
    rows = list(record.dh)
    row, field = (JOINTS.index(key), "theta_offset") if table == "zeros" else ROWS[key]
    own_value: dict[str, Any] = {field: getattr(rows[row], field) + by}
    rows[row] = replace(rows[row], **own_value)
    # A spacer keeps the tool at the end of the last length.
    tool = None if record.spacer else record.tool
    return replace(record, dh=tuple(rows), tool=tool)


def with_link(
    record: Alpha5Parameters, link: int, quantity: list[str], by: float
) -> Alpha5Parameters:
    """The record with one number of a link changed."""
    field, *axes = quantity
    value = np.array(getattr(record.links[link], field), float)
    at = tuple("xyz".index(axis) for axis in "".join(axes))
    change = np.zeros(value.shape)
    change[at] = by
    change[at[::-1]] = by
    new: Any = value + change
    links = list(record.links)
    links[link] = replace(links[link], **{field: new if axes else float(new)})
    return replace(record, links=tuple(links))


def loads(record: Alpha5Parameters, states: tuple[np.ndarray, ...]) -> np.ndarray:
    """Torques and loads, (N, 10)."""
    found = own.inverse_dynamics(record, *states, a5.SEA_WATER, DOWN)
    return np.hstack(found)


def gradient(
    record: Alpha5Parameters, names: Sequence[str], states: tuple[np.ndarray, ...]
) -> np.ndarray:
    """Derivative of torques and loads by numbers, (N, 10, len(names))."""
    columns = []
    for name in names:
        step = 0.01 * size_of(name)
        after = loads(moved(record, name, step), states)
        before = loads(moved(record, name, -step), states)
        columns.append((after - before) / (2.0 * step))
    return np.stack(columns, axis=-1)


def half_widths(found: Any) -> np.ndarray:
    """Of torques and loads, (N, 10)."""
    lower, upper = np.concatenate([found.torque, found.base_wrench], axis=-1)
    return np.asarray((upper - lower) / 2)


def middles(found: Any) -> np.ndarray:
    """Of torques and loads, (N, 10)."""
    lower, upper = np.concatenate([found.torque, found.base_wrench], axis=-1)
    return np.asarray((upper + lower) / 2)


def by_elbow(record: Alpha5Parameters, states: tuple[np.ndarray, ...]) -> np.ndarray:
    """How far the digits of 40 mm and 145.3 mm move torques and loads, (N, 10)."""
    moved_by = []
    for side, width in (("opposite", 5e-4), ("adjacent", 5e-5)):
        low, high = (
            loads(with_elbow(record, side, by), states) for by in (-width, width)
        )
        moved_by.append(np.abs(high - low) / 2)
    return np.sum(moved_by, axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [None, 0, 1])
def test_bounds_are_the_worst_case_of_all_digits(seed: int | None) -> None:
    """Masses, centres, tensors, volumes and lengths, of any arm."""
    record = a5.parameters() if seed is None else own.random_record(seed)
    states = own.states(record, 4)
    for rates in states[1:]:
        rates[:2] = 0.0
    digits = u.printed_numbers()
    names = [name for name in NUMBERS if name in digits]
    widths = [digits[name].half_width for name in names]
    expected = np.abs(gradient(record, names, states)) @ widths
    expected = expected + by_elbow(record, states)
    found = u.bounds(*states, a5.load(arm=record))
    np.testing.assert_allclose(half_widths(found), expected, rtol=1e-3, atol=1e-7)
    np.testing.assert_allclose(middles(found), loads(record, states), atol=1e-9)


def test_no_sample_exceeds_the_bounds() -> None:
    """Folded up, lengths matter: many sets are beyond what the bodies alone explain."""
    q = np.array([a5.named_pose(name) for name in ("stow", "reach", "home")])
    states = (q, 0.0 * q, 0.0 * q)
    found = u.bounds(*states)
    record = a5.parameters()
    digits = u.printed_numbers()
    of_bodies = [name for name in NUMBERS if name.startswith("links.")]
    widths = [digits[name].half_width for name in of_bodies]
    narrow = np.abs(gradient(record, of_bodies, states)) @ widths
    drawn = u.sample(100, 0)
    off = np.array([loads(drawn.parameters(k), states) for k in range(100)])
    off = np.abs(off - middles(found))
    assert (off <= 1.001 * half_widths(found) + 1e-12).all()
    assert (off[:, 0] > narrow[0] + 1e-9).any(axis=1).sum() > 5


def test_bounds_of_energies_are_their_sensitivity() -> None:
    """By Pinocchio, for records at both ends of each interval."""
    q, v, _ = (x[0] for x in own.states(a5.parameters(), 1))
    found = u.bounds(q, v, np.zeros(4))
    for interval, energy in (
        (found.kinetic_energy, lambda p: u.arm(p).kinetic_energy(q, v)),
        (found.potential_energy, lambda p: u.arm(p).potential_energy(q)),
    ):
        expected = u.sensitivity(energy)
        half = (interval.upper - interval.lower) / 2
        assert half == pytest.approx(expected.half_width, rel=2e-3)
        assert (interval.upper + interval.lower) / 2 == pytest.approx(expected.nominal)


def test_a_turn_of_the_mount_counts_if_it_was_measured() -> None:
    record = own.random_record(0)
    mounted = replace(record, mount=own.random_mount(3))
    measured = replace(
        mounted, measurements=(Measurement("mount.rpy", half_width=1e-3),)
    )
    q, v, a = own.states(record, 3)
    known = u.bounds(q, v, a, a5.load(arm=mounted))
    found = u.bounds(q, v, a, a5.load(arm=measured))
    assert mounted.mount is not None
    rpy = np.array(mounted.mount.rpy)
    expected: Any = 0.0
    energy: Any = 0.0
    for step in 1e-3 * np.eye(3):
        ends = []
        for turned in (rpy + step, rpy - step):
            gravity = Rotation.from_euler("xyz", turned).inv().apply(DOWN)
            tau, wrench = own.inverse_dynamics(record, q, v, a, a5.SEA_WATER, gravity)
            arm = a5.load(gravity=gravity, arm=record)
            ends.append((np.hstack([tau, wrench]), arm.potential_energy(q[0])))
        expected = expected + np.abs(ends[0][0] - ends[1][0]) / 2
        energy = energy + abs(ends[0][1] - ends[1][1]) / 2
    wider = half_widths(found) - half_widths(known)
    np.testing.assert_allclose(wider, expected, rtol=1e-4, atol=1e-8)
    of_energy = np.ptp([found.potential_energy, known.potential_energy], axis=1)[:, 0]
    assert (of_energy[0] - of_energy[1]) / 2 == pytest.approx(energy, rel=1e-4)


@pytest.mark.parametrize("density", [0.0, a5.FRESH_WATER])
def test_bounds_are_of_the_fluid_of_the_arm(density: float) -> None:
    record = own.random_record(0)
    states = own.states(record, 3)
    found = u.bounds(*states, a5.load(density, arm=record)).torque
    tau, _ = own.inverse_dynamics(record, *states, density, DOWN)
    np.testing.assert_allclose((found.lower + found.upper) / 2, tau, atol=1e-9)
    expected = u.sensitivity(
        lambda p: u.arm(p, density).inverse_dynamics_batch(*states), record
    )
    half = (found.upper - found.lower) / 2
    np.testing.assert_allclose(half, expected.half_width, rtol=1e-2, atol=1e-6)


def test_bounds_with_jaws_are_about_the_arm_with_jaws() -> None:
    """The jaw rod adds a joint whose force no printed digit moves."""
    states = own.states(a5.parameters(), 4)
    jaws = a5.load(gripper="jaws").with_payload(0.2, (0.0, 0.01, 0.02))
    with_rod = [np.column_stack([x, np.full(4, 0.005)]) for x in states]
    found = u.bounds(*with_rod, arm=jaws)
    locked = u.bounds(*states, a5.load().with_payload(0.2, (0.0, 0.01, 0.02)))
    middle = (found.torque.lower + found.torque.upper) / 2
    assert middle == pytest.approx(jaws.inverse_dynamics_batch(*with_rod))
    half = (found.torque.upper - found.torque.lower) / 2
    assert half[:, :4] == pytest.approx(half_widths(locked)[:, :4])
    assert np.array_equal(found.torque.lower[:, 4], found.torque.upper[:, 4])
    low, high = torque_margin(jaws, *with_rod)
    assert high == pytest.approx(half)
    assert np.array_equal(low, -high)
    one = u.bounds(*(rows[1] for rows in with_rod), arm=jaws)
    for alone, of_all in zip(one, found, strict=True):
        assert alone.lower == pytest.approx(of_all.lower[1])
        assert alone.upper == pytest.approx(of_all.upper[1])


def test_a_floating_base_is_refused() -> None:
    free = a5.load(floating_base=True)
    q = pin.neutral(free.model)
    with pytest.raises(a5.errors.InputError, match="fixed base"):
        u.bounds(q, np.zeros(10), np.zeros(10), arm=free)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_bounds_of_numbers_that_are_all_known_together(seed: int) -> None:
    """Every number that a covariance may be of: sqrt(3) deviations to both sides."""
    record = calibrated(seed, NUMBERS, {})
    states = own.states(record, 3)
    found = u.bounds(*states, a5.load(arm=record))
    slopes = gradient(record, NUMBERS, states)
    assert record.covariance is not None
    matrix = record.covariance.matrix
    variance = np.einsum("nij,jk,nik->ni", slopes, matrix, slopes)
    expected = np.sqrt(3.0 * variance)
    np.testing.assert_allclose(half_widths(found), expected, rtol=1e-4, atol=1e-9)
    np.testing.assert_allclose(middles(found), loads(record, states), atol=1e-9)


@pytest.mark.slow
def test_other_numbers_count_one_by_one() -> None:
    """A length of the file by its half width, and the elbow by its digits."""
    names = (
        "links.link_2.mass",
        *(f"links.link_3.com.{axis}" for axis in "xyz"),
        *(f"links.link_4.inertia.{axes}" for axes in PRODUCTS),
        "zeros.axis_b",
        "lengths.a_2",
    )
    known = dict(EXACT_LINKS)
    known |= {"lengths.d_0": 0.0, "lengths.a_0": 3e-3, "lengths.d_3": 2e-3}
    record = calibrated(0, names, known)
    states = own.states(record, 3)
    slopes = gradient(record, names, states)
    assert record.covariance is not None
    matrix = record.covariance.matrix
    expected = np.sqrt(3 * np.einsum("nij,jk,nik->ni", slopes, matrix, slopes))
    expected += np.abs(gradient(record, ["lengths.a_0"], states)[..., 0]) * 3e-3
    expected += by_elbow(record, states)
    found = half_widths(u.bounds(*states, a5.load(arm=record)))
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-9)


def with_elbow(record: Alpha5Parameters, side: str, by: float) -> Alpha5Parameters:
    """The record with a side of the printed elbow, 40 mm by 145.3 mm, changed."""
    before = {"opposite": 0.04, "adjacent": 0.1453}
    after = {**before, side: before[side] + by}
    longer = np.hypot(*after.values()) - np.hypot(*before.values())
    turned = np.arctan2(*after.values()) - np.arctan2(*before.values())
    for name, change in (
        ("lengths.a_1", longer),
        ("zeros.axis_d", turned),
        ("zeros.axis_c", turned),
    ):
        record = moved(record, name, float(change))
    return record


def test_draws_have_the_covariance() -> None:
    record = calibrated(0, NUMBERS, {})
    numbers = arm_numbers(record)
    size = len(NUMBERS)
    assert numbers.names[:size] == NUMBERS
    small = 1e-6 * np.eye(len(numbers.names))
    changes = (drawn_values(numbers, small) - numbers.middle) / 1e-6
    others = np.abs(changes[:, size:]).sum(axis=0)
    np.testing.assert_allclose(others, numbers.half_width[size:], rtol=1e-4)

    assert record.covariance is not None
    expected = 3.0 * record.covariance.matrix
    width = np.sqrt(np.diag(expected))
    found = changes[:, :size].T @ changes[:, :size] / np.outer(width, width)
    np.testing.assert_allclose(found, expected / np.outer(width, width), atol=1e-4)
    np.testing.assert_allclose(numbers.half_width[:size], width, rtol=1e-12)


@pytest.mark.parametrize("link", ["link_1", "link_3"])
@pytest.mark.parametrize(("amount", "centre"), [("mass", "com"), ("volume", "cob")])
def test_draws_move_first_moments_by_their_linear_change(
    link: str, amount: str, centre: str
) -> None:
    """A calibration tells ``m c``, not its factors. No mass falls below 0."""
    record = calibrated(0, NUMBERS, {})
    numbers = arm_numbers(record)
    place = {name: k for k, name in enumerate(numbers.names)}

    def changed(draws: np.ndarray) -> np.ndarray:
        return drawn_values(numbers, draws) - numbers.middle

    rng = np.random.default_rng(3)
    drawn = rng.uniform(-1.0, 1.0, (20, len(numbers.names)))
    linear = changed(1e-7 * drawn) * 1e7
    change = changed(drawn)
    of_amount = place[f"links.{link}.{amount}"]
    of_centre = [place[f"links.{link}.{centre}.{axis}"] for axis in "xyz"]
    m, dm = numbers.middle[of_amount], linear[:, [of_amount]]
    c, dc = numbers.middle[of_centre], linear[:, of_centre]
    found = (m + change[:, [of_amount]]) * (c + change[:, of_centre]) - m * c
    np.testing.assert_allclose(found, c * dm + m * dc, rtol=1e-6, atol=1e-12)
    assert np.abs(change[:, of_centre] - dc).max() > 1e-6

    # A draw that leaves no mass moves the centre as if the mass were known.
    far = drawn * (-3.0 * m / dm)
    huge = changed(far)
    assert (huge[:, of_amount] < -m).all()
    np.testing.assert_allclose(
        huge[:, of_centre], dc * (-3.0 * m / dm), rtol=1e-5, atol=1e-9
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_what_is_held_is_farther_away_on_a_longer_arm(seed: int) -> None:
    """A payload is an attached body of the reference, fixed at the tool."""
    names = tuple(name for name in NUMBERS if name.startswith(("zeros.", "lengths.")))
    record = calibrated(seed, names, EXACT_LINKS)
    payload: dict[str, Any] = {"mass": 0.5, "volume": 2e-4, "com": [0.02, 0.0, 0.01]}
    tool = record.tool or printed_tool(record.dh[3], record.dh[4])
    held = replace(
        own.random_attached(np.random.default_rng(1), "held", "link_4", 0.0),
        mass=payload["mass"],
        com=np.array(payload["com"]),
        inertia=np.zeros((3, 3)),
        volume=payload["volume"],
        cob=np.array(payload["com"]),
        position=tool.position,
        rotation=tool.rotation,
    )
    holding = replace(record, attached=(*record.attached, held))
    states = own.states(record, 3)
    arm = a5.load(arm=record).with_payload(**payload)
    lower, upper = u.bounds(*states, arm).torque
    slopes = gradient(holding, names, states)[:, :4]
    assert record.covariance is not None
    matrix = record.covariance.matrix
    variance = np.einsum("nij,jk,nik->ni", slopes, matrix, slopes)
    half = (upper - lower) / 2
    np.testing.assert_allclose(half, np.sqrt(3 * variance), rtol=1e-3, atol=1e-7)
    tau = loads(holding, states)[:, :4]
    np.testing.assert_allclose((upper + lower) / 2, tau, atol=1e-9)
