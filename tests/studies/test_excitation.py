"""Exciting motions: their series, the search for the best, and what it is worth."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.studies.calibration.equations import Equations
from alpha5_model.studies.calibration.excitation import _Search, _Series, _Wanted
from alpha5_model.studies.calibration.loads import load_slopes
from alpha5_model.studies.calibration.poses import TILT
from alpha5_model.studies.calibration.unknowns import arm_unknowns

calibrate = a5.calibrate
ARM = a5.parameters()
JOINTS = ARM.joints[:4]
MARGIN = np.radians(3.0)
LOWER = np.array([joint.lower for joint in JOINTS]) + MARGIN
UPPER = np.array([joint.upper for joint in JOINTS]) - MARGIN
SPEED = 0.95 * np.array([joint.velocity for joint in JOINTS])


class Empty:
    """Surroundings in which nothing touches anything."""

    def __init__(self) -> None:
        self.strayed = np.zeros(4)

    def touches(self, q: Any) -> Any:
        assert np.shape(q)[1] == 4
        return np.zeros(len(q), bool)

    def with_room(self, strayed: Any) -> Empty:
        self.strayed = strayed
        return self

    def obstruction(self, start: Any, end: Any) -> None:
        return None


def search(seed: int, period: float = 20.0) -> Any:
    made: Any = _Search(arm=ARM, period=period, rng=np.random.default_rng(seed))
    made._surroundings = Empty()
    return made


def test_a_series_is_the_sum_of_its_harmonics() -> None:
    rng = np.random.default_rng(1)
    middle = rng.normal(size=4)
    sines, cosines = rng.normal(size=(2, 3, 4))
    series = _Series(middle=middle, sines=sines, cosines=cosines, period=7.0)
    time = rng.uniform(0.0, 7.0, 30)
    q, v, a = series.at(time)
    expected = np.tile(middle, (30, 1))
    for n in (1, 2, 3):
        angle = 2 * np.pi * n * time / 7.0
        expected += np.outer(np.sin(angle), sines[n - 1])
        expected += np.outer(np.cos(angle), cosines[n - 1])
    np.testing.assert_allclose(q, expected, atol=1e-13)
    h = 1e-4
    for values, slopes, part in ((0, v, "v"), (1, a, "a")):
        by_steps = (series.at(time + h)[values] - series.at(time - h)[values]) / (2 * h)
        np.testing.assert_allclose(slopes, by_steps, atol=1e-6, err_msg=part)


def test_series_use_the_range_or_the_speed_of_each_joint() -> None:
    rng = np.random.default_rng(2)
    time = np.linspace(0.0, 20.0, 401)
    for period in (3.0, 20.0):
        for _ in range(4):
            series = search(0, period)._possible(rng.normal(size=(7, 4)))
            q, v, _ = series.at(time * period / 20.0)
            assert (q >= LOWER - 1e-9).all()
            assert (q <= UPPER + 1e-9).all()
            np.testing.assert_allclose(v[0], 0.0, atol=1e-12)
            fast = np.abs(v).max(axis=0) / SPEED
            wide = np.ptp(q, axis=0) / (UPPER - LOWER)
            np.testing.assert_allclose(np.maximum(fast, wide), 1.0, rtol=1e-9)


def test_the_last_gene_is_the_place_in_the_range() -> None:
    time = np.linspace(0.0, 1.0, 401)
    genes = np.random.default_rng(3).normal(size=(7, 4))
    for gene in (-50.0, 0.0, 50.0):
        genes[-1] = gene
        q = search(0, 1.0)._possible(genes).at(time)[0]
        free = np.array([q.min(axis=0) - LOWER, UPPER - q.max(axis=0)])
        share = free[0] / free.sum(axis=0)
        np.testing.assert_allclose(share, (np.sign(gene) + 1) / 2, atol=1e-9)


def test_harmonics_of_the_same_genes_move_as_fast() -> None:
    """The n-th has the amplitude of its gene over n."""
    genes = np.random.default_rng(7).normal(size=(7, 4))
    genes[1:6] = 1.0
    series = search(0)._possible(genes)
    size = series.cosines[0]
    assert (size > 0).all()
    np.testing.assert_allclose(
        series.cosines / size, np.tile([[1], [1 / 2], [1 / 3]], 4)
    )
    # The first sine makes the velocity 0 at the start.
    np.testing.assert_allclose(
        series.sines / size, np.tile([[-2], [1 / 2], [1 / 3]], 4)
    )


def test_a_curve_strays_from_its_samples_as_little_as_is_said() -> None:
    made = search(0)
    series = made._possible(np.random.default_rng(5).normal(size=(7, 4)))
    assert made._is_free(series)
    time = np.linspace(0.0, 20.0, 401)
    dense = np.linspace(0.0, 20.0, 8001)
    q = series.at(time)[0]
    straight = [np.interp(dense, time, column) for column in q.T]
    off = np.abs(series.at(dense)[0] - np.transpose(straight)).max(axis=0)
    assert (made._surroundings.strayed > off).all()
    assert (made._surroundings.strayed < 1.1 * off).all()


def test_the_best_series_of_all_that_are_free() -> None:
    told: list[tuple[float, _Series]] = []

    def information(series: _Series) -> float:
        value = float(series.at(np.array([1.0]))[0].sum())
        told.append((value, series))
        return value

    for evaluations in (1, 2, 30):
        told.clear()
        made = search(4)
        best, value = made.best(information, evaluations)
        assert made.compared == evaluations == len(told)
        most, series = max(told, key=lambda one: one[0])
        assert value == most
        assert best is series


def test_none_is_free() -> None:
    made = search(4)
    made._surroundings.touches = lambda q: np.ones(len(q), bool)
    with pytest.raises(InputError, match="evaluations: expected more: none was free"):
        made.best(lambda series: 0.0, 5)
    made = search(4)
    made._surroundings.obstruction = lambda start, end: "link_0"
    with pytest.raises(InputError, match="evaluations: expected more: none was free"):
        made.best(lambda series: 0.0, 5)


def sizes_of(evaluations: int, gains: set[int]) -> list[float]:
    """Size of the variation in each evaluation; NaN of one drawn at random.

    Each of some evaluations tells more than all before, the others tell nothing.
    """
    made = search(6)
    tried: list[Any] = []
    made._possible = lambda genes: tried.append(genes) or made
    made._is_free = lambda series: True
    values = (k if k in gains else -1.0 for k in range(evaluations))
    made.best(lambda series: next(values), evaluations)

    steps = np.random.default_rng(6).normal(size=(evaluations, 7, 4))
    best = tried[0]
    found = []
    for number, (genes, step) in enumerate(zip(tried, steps, strict=True)):
        by_size = (genes - best) / step
        random = np.array_equal(genes, step)
        found.append(np.nan if random else float(by_size.mean()))
        assert random or by_size == pytest.approx(np.full((7, 4), found[-1]))
        if number in gains:
            best = genes
    return found


def test_steps_grow_while_they_gain_and_shrink_while_they_do_not() -> None:
    sizes = np.array(sizes_of(60, {0, *range(40, 45)}))
    first = int(np.isnan(sizes).sum())
    assert 0.1 < sizes[first] < 0.9
    ratio = sizes[1:] / sizes[:-1]
    assert ((ratio[first:40] > 0.9) & (ratio[first:40] < 0.999)).all()
    assert ((ratio[40:45] > 1.1) & (ratio[40:45] < 2.0)).all()
    assert ((ratio[45:] > 0.9) & (ratio[45:] < 0.999)).all()


def test_steps_do_not_vanish() -> None:
    sizes = sizes_of(900, {0})
    assert 0.01 < sizes[-1] < 0.05
    assert sizes[-1] == pytest.approx(sizes[-2])


def test_half_of_few_motions_are_random_and_few_of_many() -> None:
    for evaluations in (4, 8, 20):
        random = np.isnan(sizes_of(evaluations, {0})).sum()
        assert evaluations / 2 <= random < evaluations
    assert np.isnan(sizes_of(900, {0})).sum() < 200


# --- what it is worth -----------------------------------------------------------------


def spread(unknowns: Any, read: Any, still: Any, repeated: float) -> Any:
    """Deviations of the wanted torques before and after readings, (2, 2)."""
    slopes = load_slopes(unknowns, unknowns.middle, still.density, still.motion)
    equations = Equations(unknowns, [read], TILT)
    free = equations.deviation > 0
    prior = np.diag(equations.deviation[free] ** 2)
    rows = equations.slopes(equations.middle, 0) / read.sensor.noise[:, None]
    rows = rows.reshape(-1, len(equations.names))[:, free]
    after = np.linalg.inv(np.linalg.inv(prior) + repeated * rows.T @ rows)
    wide = np.zeros((len(slopes), 10, len(equations.names)))
    wide[..., :78] = slopes
    found = []
    for covariance in (prior, after):
        torque = wide[:, 1:3][..., free]
        variance = np.einsum("njk,kl,njl->nj", torque, covariance, torque)
        found.append(np.sqrt(variance.mean(axis=0)))
    return np.array(found)


def known_lengths() -> Any:
    unknowns = arm_unknowns(ARM, moving=True)
    unknowns.deviation[-4:] = 0.0
    return unknowns


def test_information_is_the_log_of_how_much_torques_shrink() -> None:
    rng = np.random.default_rng(6)
    q, v, a = rng.uniform(0.3, 2.5, (3, 12, 4))
    unknowns = known_lengths()
    for sensor in (calibrate.efforts(), calibrate.force_torque()):
        read = calibrate.session(sensor, q, v=v, a=a, fluid_density=1025.0)
        still = calibrate.session(sensor, rng.uniform(0.3, 2.5, (9, 4)))
        before, after = spread(unknowns, read, still, 3.0)
        told = _Wanted(unknowns, still).told(read, repeated=3.0)
        assert told == pytest.approx(np.log(before / after).sum(), rel=1e-6)


@pytest.mark.slow
def test_information_of_a_planned_motion() -> None:
    """As if it were read 20 times a second, over positions within the limits."""
    sensor = calibrate.efforts()
    planned = calibrate.plan_excitation(sensor, evaluations=1, duration=15.0)
    assert planned.time == pytest.approx(np.linspace(0.0, 15.0, 301))
    rows = slice(0, 300, 5)
    read = calibrate.session(
        sensor,
        planned.position[rows],
        v=planned.velocity[rows],
        a=planned.acceleration[rows],
        fluid_density=a5.SEA_WATER,
    )
    q = np.random.default_rng(0).uniform(LOWER, UPPER, (100, 4))
    still = calibrate.session(sensor, q, fluid_density=a5.SEA_WATER)
    before, after = spread(known_lengths(), read, still, 5.0)
    expected = np.log(before / after).sum()
    assert planned.information == pytest.approx(expected, rel=0.005)


@pytest.mark.slow
def test_what_a_plan_takes_if_it_is_not_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """400 motions of 20 s, as the guide says."""
    monkeypatch.setattr(_Wanted, "told", lambda self, read, repeated: 0.0)
    planned = calibrate.plan_excitation(calibrate.efforts())
    assert planned.evaluations == 400
    assert planned.time[-1] == 20.0
    same = calibrate.plan_excitation(calibrate.efforts(), seed=0)
    assert np.array_equal(same.position, planned.position)


@pytest.mark.slow
def test_long_and_short_periods() -> None:
    hour = calibrate.plan_excitation(
        calibrate.efforts(), duration=3600, evaluations=150
    )
    assert hour.time[[1, -1]] == pytest.approx([0.05, 3600.0])
    with pytest.raises(InputError, match="duration: expected at most 3600 s, got 3600"):
        calibrate.plan_excitation(calibrate.efforts(), duration=3600.5)
    with pytest.raises(InputError, match="duration"):
        calibrate.plan_excitation(calibrate.efforts(), duration=0.0)
    short = calibrate.plan_excitation(calibrate.efforts(), duration=0.01, evaluations=2)
    assert short.time == pytest.approx([0.0, 0.01])


def test_without_gravity_nothing_is_learnt_of_torques_at_rest() -> None:
    sensor = calibrate.efforts()
    planned = calibrate.plan_excitation(sensor, gravity=(0, 0, 0), evaluations=2)
    assert planned.information == 0.0
