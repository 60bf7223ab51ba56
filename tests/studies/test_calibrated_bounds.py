"""Numbers that are known together: bounds and draws against their covariance.

Gradients are differences of Newton's and Euler's equations for records with one number
changed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.numbers.arm_schema import LENGTHS, LINKS, NUMBERS, ZEROS
from alpha5_model.numbers.covariance import Covariance
from alpha5_model.numbers.parameters import Alpha5Parameters, Measurement
from alpha5_model.numbers.pose import printed_tool
from alpha5_model.studies.uncertainty.arm_numbers import ArmNumbers, arm_numbers

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


def bounds_of(
    record: Alpha5Parameters, states: tuple[np.ndarray, ...], lengths: bool
) -> np.ndarray:
    """Middle and half width of torques and loads, (2, N, 10)."""
    found = u.bounds(*states, a5.load(arm=record), lengths=lengths)
    lower, upper = np.concatenate([found.torque, found.base_wrench], axis=-1)
    return np.array([(lower + upper) / 2, (upper - lower) / 2])


@pytest.mark.slow
@pytest.mark.parametrize("lengths", [False, True])
@pytest.mark.parametrize("seed", [0, 1])
def test_bounds_of_numbers_that_are_all_known_together(
    seed: int, lengths: bool
) -> None:
    """Every number that a covariance may be of: sqrt(3) deviations to both sides."""
    record = calibrated(seed, NUMBERS, {})
    states = own.states(record, 3)
    middle, half = bounds_of(record, states, lengths)
    slopes = gradient(record, NUMBERS, states)
    assert record.covariance is not None
    matrix = record.covariance.matrix
    variance = np.einsum("nij,jk,nik->ni", slopes, matrix, slopes)
    np.testing.assert_allclose(half, np.sqrt(3.0 * variance), rtol=1e-4, atol=1e-9)
    np.testing.assert_allclose(middle, loads(record, states), atol=1e-9)


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
    known |= {"lengths.d_0": 0.0, "lengths.a_0": 0.0, "lengths.d_3": 2e-3}
    record = calibrated(0, names, known)
    states = own.states(record, 3)
    slopes = gradient(record, names, states)
    assert record.covariance is not None
    matrix = record.covariance.matrix
    together = np.sqrt(3 * np.einsum("nij,jk,nik->ni", slopes, matrix, slopes))
    _, half = bounds_of(record, states, lengths=False)
    np.testing.assert_allclose(half, together, rtol=1e-4, atol=1e-9)

    alone = np.abs(gradient(record, ["lengths.d_3"], states)[..., 0]) * 2e-3
    for side, width in (("opposite", 5e-4), ("adjacent", 5e-5)):
        ends = [with_elbow(record, side, by) for by in (-width, width)]
        low, high = (loads(end, states) for end in ends)
        alone = alone + np.abs(high - low) / 2
    _, half = bounds_of(record, states, lengths=True)
    np.testing.assert_allclose(half, together + alone, rtol=1e-3, atol=1e-9)
    assert (alone[:, 1] > 1e-3 * together[:, 1]).all()


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


def drawn_names(numbers: ArmNumbers) -> dict[str, int]:
    """Key of an arm file -> place among the numbers of an arm."""
    place = {name: k for k, name in enumerate(numbers.names)}
    found = {}
    for name in NUMBERS:
        table, key, *rest = name.split(".")
        printed = name
        if table == "links":
            printed = ".".join([key, *rest]).replace("inertia", "inertia_com")
        elif table == "lengths" and key != "a_1":
            printed = "link_{}.{}".format(*ROWS[key])
        found[name] = place[printed]
    return found


def test_draws_have_the_covariance() -> None:
    """Small draws; the document prints products of inertia with the other sign."""
    record = calibrated(0, NUMBERS, {})
    numbers = arm_numbers(record)
    place = [*drawn_names(numbers).values()]
    small = 1e-6
    changes = numbers.spread(small * np.eye(len(numbers.names))) / small
    others = np.delete(changes, place, axis=1)
    half_width = np.delete(numbers.half_width, place)
    assert np.array_equal(np.abs(others).sum(axis=0), half_width)

    signs = [-1.0 if name.endswith((".xy", ".xz", ".yz")) else 1.0 for name in NUMBERS]
    ours = changes[:, place] * signs
    assert record.covariance is not None
    expected = 3.0 * record.covariance.matrix
    size = np.sqrt(np.diag(expected))
    found = ours.T @ ours / np.outer(size, size)
    np.testing.assert_allclose(found, expected / np.outer(size, size), atol=1e-4)
    np.testing.assert_allclose(numbers.half_width[place], size, rtol=1e-12)


@pytest.mark.parametrize("link", ["link_1", "link_3"])
@pytest.mark.parametrize(("amount", "centre"), [("mass", "com"), ("volume", "cob")])
def test_draws_move_first_moments_by_their_linear_change(
    link: str, amount: str, centre: str
) -> None:
    """A calibration tells ``m c``, not its factors. No mass falls below 0."""
    record = calibrated(0, NUMBERS, {})
    numbers = arm_numbers(record)
    place = drawn_names(numbers)
    rng = np.random.default_rng(3)
    drawn = rng.uniform(-1.0, 1.0, (20, len(numbers.names)))
    linear = numbers.spread(1e-7 * drawn) * 1e7
    change = numbers.spread(drawn)
    of_amount = place[f"links.{link}.{amount}"]
    of_centre = [place[f"links.{link}.{centre}.{axis}"] for axis in "xyz"]
    m, dm = numbers.middle[of_amount], linear[:, [of_amount]]
    c, dc = numbers.middle[of_centre], linear[:, of_centre]
    found = (m + change[:, [of_amount]]) * (c + change[:, of_centre]) - m * c
    np.testing.assert_allclose(found, c * dm + m * dc, rtol=1e-6, atol=1e-12)
    assert np.abs(change[:, of_centre] - dc).max() > 1e-6

    # A draw that leaves no mass moves the centre as if the mass were known.
    far = drawn * (-3.0 * m / dm)
    huge = numbers.spread(far)
    assert (huge[:, of_amount] < -m).all()
    np.testing.assert_allclose(
        huge[:, of_centre], dc * (-3.0 * m / dm), rtol=1e-5, atol=1e-9
    )


def test_every_zero_and_length_can_be_calibrated() -> None:
    named = {name.partition(".")[2] for name in NUMBERS if name.startswith("lengths.")}
    assert named == set(LENGTHS) == set(ROWS)
    assert set(ZEROS) <= set(JOINTS)


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
    for lengths in (False, True):
        lower, upper = u.bounds(*states, arm, lengths=lengths).torque
        slopes = gradient(holding, names, states)[:, :4]
        assert record.covariance is not None
        matrix = record.covariance.matrix
        variance = np.einsum("nij,jk,nik->ni", slopes, matrix, slopes)
        half = (upper - lower) / 2
        np.testing.assert_allclose(half, np.sqrt(3 * variance), rtol=1e-3, atol=1e-7)
        tau = loads(holding, states)[:, :4]
        np.testing.assert_allclose((upper + lower) / 2, tau, atol=1e-9)
