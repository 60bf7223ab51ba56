"""Named causes of a misfit: readings of the model itself, with one known fault."""

from __future__ import annotations

import re
from itertools import permutations
from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.problems import (
    _innovation,
    _Named,
    _named,
)
from alpha5_model.studies.calibration.unknowns import NAMES, arm_unknowns

calibrate = a5.calibrate
RNG = np.random.default_rng(3)
POSES = 8
Q = RNG.uniform([0.2, 0.3, 0.3, 0.0], [5.8, 3.0, 3.0, 3.0], (POSES, 4))
UNKNOWNS = arm_unknowns(a5.parameters())
SENSORS = {
    "scales": calibrate.scales(),
    "force": calibrate.force_torque(),
    "weight": calibrate.weight(),
}


class Model:
    """One sensor's equations, and the readings that the model itself gives."""

    def __init__(self, kind: str, density: float = a5.AIR) -> None:
        self.session = calibrate.session(SENSORS[kind], Q, fluid_density=density)
        self.equations = Equations(UNKNOWNS, [self.session], TILT)
        self.middle = self.equations.middle
        self.clean = self.equations.predicted(self.middle, 0)

    def with_readings(self, readings: Any) -> Equations:
        read = calibrate.with_readings(self.session, np.asarray(readings))
        return Equations(UNKNOWNS, [read], TILT)

    def found(self, readings: Any) -> _Named:
        return _named(self.with_readings(readings), self.middle, misfit=True)

    def squared(self, readings: Any) -> float:
        return _innovation(self.with_readings(readings), self.middle).squared


@pytest.fixture(scope="module")
def scales() -> Model:
    return Model("scales")


@pytest.fixture(scope="module")
def force() -> Model:
    return Model("force")


def problem(found: _Named, name: str) -> calibrate.Problem:
    (one,) = [one for one in found.problems if one.name == name]
    assert one.session == ("" if name.startswith(("mass", "zero")) else "session")
    return one


def chance(model: Model, tests: int = 1, free: int = 1) -> float:
    """What free numbers explain of noise, the best of some tests."""
    return float(free * np.log(model.clean.size) + 2 * np.log(tests))


def test_the_model_itself_has_no_problems(scales: Model, force: Model) -> None:
    for model in (scales, force):
        assert model.found(model.clean).problems == ()
        noise = np.random.default_rng(1).normal(size=model.clean.shape)
        noisy = model.clean + noise * model.session.sensor.noise
        assert model.found(noisy).problems == ()


#: Factor of the readings, and what is said of it.
FACTORS = [
    (1000.0, "1000 times too large: thousandths of the unit?"),
    (1e-3, "1000 times too small: another unit?"),
    (9.80665, "9.81 times too large: newtons for kilograms?"),
    (1 / 9.80665, "9.81 times too small: kilograms for newtons?"),
    (1 / 0.45359237, "2.2 times too large: pounds for kilograms?"),
    (16 / 0.45359237, "35 times too large: ounces for kilograms?"),
    (16 / 453.59237, "28 times too small: ounces for grams?"),
    (-1.0, "of the other sign"),
]


@pytest.mark.parametrize(("factor", "words"), FACTORS)
def test_a_factor_within_5_percent_of_a_unit_is_one(
    factor: float, words: str, scales: Model
) -> None:
    for off in (0.9502, 1.0498):
        found = scales.found(off * factor * scales.clean)
        unit = problem(found, "unit")
        assert unit.message == f"the readings are {words}"
        whole = scales.squared(off * factor * scales.clean)
        assert unit.gain == pytest.approx(whole - chance(scales), rel=1e-9)
    for off in (0.9498, 1.0502):
        found = scales.found(off * factor * scales.clean)
        said = f"all readings are {off * factor:.4g} times what they should be"
        assert problem(found, "scale").message == said


@pytest.mark.parametrize(("pose", "channel"), [(0, 2), (3, 1), (7, 0)])
def test_a_wrong_reading(pose: int, channel: int, scales: Model) -> None:
    """All others say exactly what it should be."""
    readings = scales.clean.copy()
    readings[pose, channel] -= 0.025
    found = scales.found(readings)
    one = problem(found, "reading")
    said = f"scale_{channel + 1} in pose {pose + 1} is off by -0.025 kg, by what all"
    assert one.message == f"{said} others say"
    whole = scales.squared(readings)
    assert one.gain == pytest.approx(whole - chance(scales, tests=24), rel=1e-9)
    assert found.unexplained == pytest.approx(
        whole - max(p.gain for p in found.problems)
    )
    assert "pose" not in [p.name for p in found.problems]


def test_a_wrong_reading_where_others_are_missing(scales: Model) -> None:
    readings = scales.clean.copy()
    readings[0, 1] = np.nan
    readings[2] = np.nan
    readings[5, 2] += 0.03
    message = problem(scales.found(readings), "reading").message
    assert message.startswith("scale_3 in pose 6 is off by +0.03 kg")


@pytest.mark.parametrize("pose", [0, 4, 7])
def test_a_wrong_pose(pose: int, scales: Model) -> None:
    readings = scales.clean.copy()
    readings[pose] += [0.2, -0.1, -0.15]
    one = problem(scales.found(readings), "pose")
    assert one.message == f"pose {pose + 1} was another one than is noted"
    whole = scales.squared(readings)
    expected = whole - chance(scales, tests=POSES, free=3)
    assert one.gain == pytest.approx(expected, rel=1e-9)


def test_scales_that_are_mixed_up(scales: Model) -> None:
    for order in permutations(range(3)):
        if order != (0, 1, 2):
            found = scales.found(scales.clean[:, order])
            names = ", ".join(f"scale_{k + 1}" for k in order)
            said = f"the scales are mixed up: what is noted is {names}"
            assert problem(found, "channels").message == said


@pytest.mark.filterwarnings("ignore:fluid_density")
@pytest.mark.parametrize(
    ("density", "near"),
    [
        (0.0, "air"),
        (a5.AIR + 149.0, "air"),
        (a5.AIR + 151.0, None),
        (a5.FRESH_WATER - 151.0, None),
        (a5.FRESH_WATER - 149.0, "fresh water"),
        (1010.0, "fresh water"),
        (1015.0, "sea water"),
        (a5.SEA_WATER + 149.0, "sea water"),
        (a5.SEA_WATER + 151.0, None),
    ],
)
def test_the_density_of_another_fluid(density: float, near: str | None) -> None:
    """It is named within 150 kg/m^3 of air or water."""
    model = Model("force", 500.0)
    readings = Model("force", density).clean
    found = model.found(readings)
    if near is None:
        assert "fluid" not in [one.name for one in found.problems]
        return
    one = problem(found, "fluid")
    said = f"the readings are those of a fluid of {density:.0f} kg/m^3 ({near}?)"
    assert one.message == f"{said}, not of 500"
    expected = model.squared(readings) - chance(model)
    assert one.gain == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("link", range(5))
def test_a_mass_beyond_its_prior(link: int) -> None:
    """The first two turn about the vertical: only the whole weight tells of them."""
    model = Model("weight" if link < 2 else "force")
    name = f"links.link_{link}.mass"
    values = model.middle.copy()
    values[NAMES.index(name)] *= 1.5
    readings = model.equations.predicted(values, 0)
    one = problem(model.found(readings), f"mass of link_{link}")
    mass = a5.parameters().links[link].mass
    assert one.message == f"{1.5 * mass:.4g} kg instead of {mass:.4g}"
    expected = model.squared(readings) - chance(model)
    assert one.gain == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(("joint", "off"), [("e", 9.0), ("d", -9.0), ("c", 9.0)])
def test_a_zero_beyond_its_prior(joint: str, off: float) -> None:
    """A joint that is 9 deg further than its zero reports 9 deg too little."""
    model = Model("scales")
    values = model.middle.copy()
    values[NAMES.index(f"zeros.axis_{joint}")] = np.radians(off)
    one = problem(model.found(model.equations.predicted(values, 0)), "zero")
    found = re.fullmatch(
        rf"axis_{joint} reports ([+-][\d.]+) deg too much", one.message
    )
    assert found is not None
    assert float(found[1]) == pytest.approx(-off, rel=0.2)
