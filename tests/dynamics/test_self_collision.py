"""Reach without self-collision agrees with distances, exact volumes and sampling."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest
from coal_reference import CoalReference
from fk import WEDGE, sample, tip
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.errors import InputError

space = a5.workspace


@pytest.fixture(scope="module")
def arm() -> Any:
    return a5.load()


def underarm(q: np.ndarray) -> np.ndarray:
    """Whether the plane of the arm faces the tcp."""
    p = tip(q)
    return np.asarray(
        p[:, 0] * np.cos(q[:, 0] + math.pi) + p[:, 1] * np.sin(q[:, 0] + math.pi) > 0
    )


def test_free_at_some_wrist_angle_by_distances(arm: Any) -> None:
    q = sample(250, seed=90)
    got = a5.without_self_collision(q)
    for row, free in zip(q, got, strict=True):
        if free == (arm.collision_distance(row) > 0):
            continue
        assert free  # this wrist angle is not free, another one is
        turned = np.tile(row, (26, 1))
        turned[:, 3] = [*np.linspace(LOWER[3], UPPER[3], 25), row[3]]
        assert any(arm.collision_distance(t) > 0 for t in turned)
    for row in q[~got]:
        turned = np.tile(row, (9, 1))
        turned[:, 3] = np.linspace(LOWER[3], UPPER[3], 9)
        assert all(arm.in_collision(t) for t in turned)
    assert 10 < (~got).sum() < 60


def test_the_pairs_are_those_of_the_committed_files() -> None:
    pairs = CoalReference().links
    by_wrist = [pair for pair in pairs if "link_4" in pair]
    assert (len(pairs) - len(by_wrist), len(by_wrist)) == (126, 713)
    assert len(self_collision(a5.parameters())._coal._pairs) == len(pairs)


@pytest.mark.slow
def test_a_wrist_angle_is_not_held_against_the_others(arm: Any) -> None:
    """A position is free if the hand is free at any angle of the wrist."""
    q = sample(3000, seed=94)
    touching = q[[arm.in_collision(row) for row in q]]
    freed = 0
    for row, free in zip(touching, a5.without_self_collision(touching), strict=True):
        turned = np.tile(row, (25, 1))
        turned[:, 3] = np.linspace(LOWER[3], UPPER[3], 25)
        touches_at_every_angle = all(arm.in_collision(other) for other in turned)
        assert free == (not touches_at_every_angle)
        freed += free
    assert freed > 0


def test_positions_of_note() -> None:
    # At the zero position the arm is folded upon itself.
    assert not a5.without_self_collision(np.zeros(4))
    assert a5.without_self_collision([math.pi, 1.6, 1.6, 1.0])
    behind = tip(np.array([0.12, 0.37, 1.57, 0.0]))  # over the mount, the elbow low
    assert a5.reachable(behind)
    assert not a5.reachable(behind, accept=a5.without_self_collision)


@pytest.mark.parametrize("shape", [(), (0,), (5,), (2, 3)])
def test_shapes(shape: tuple[int, ...]) -> None:
    assert a5.without_self_collision(np.zeros((*shape, 4))).shape == shape
    p = np.full((*shape, 3), 0.15)
    assert a5.reachable(p, accept=a5.without_self_collision).shape == shape


def test_bad_input() -> None:
    for bad in ("abc", [0.0, 0, 0], [0, 0, 0, np.nan]):
        with pytest.raises(InputError):
            a5.without_self_collision(bad)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="wrists"):
        a5.without_self_collision(np.zeros(4), 0)
    for answer in (None, np.ones(3), np.ones(2, bool), True):
        with pytest.raises(InputError, match="accept: expected 1 times True or False"):
            a5.reachable([0.2, 0.1, 0.1], accept=lambda q, answer=answer: answer)
    for bad in ({"samples": 0}, {"seed": -1}, {"azimuth": math.inf}):
        with pytest.raises(InputError):
            space.sampled_share(underarm, **bad)  # type: ignore[arg-type]


def test_a_point_counts_if_any_branch_will_do() -> None:
    p = np.random.default_rng(92).uniform(-0.35, 0.38, (2000, 3))
    s = a5.inverse_kinematics(p, (LOWER[3] + UPPER[3]) / 2)
    bent = s.q[..., 2] < 1.5
    expected = (s.within_limits & bent).any(axis=-1)
    assert np.array_equal(a5.reachable(p, accept=lambda q: q[:, 2] < 1.5), expected)
    assert 0 < expected.sum() < a5.reachable(p).sum()
    loose = (s.exists & bent).any(axis=-1)
    assert np.array_equal(a5.reachable(p, False, lambda q: q[:, 2] < 1.5), loose)
    assert loose.sum() > expected.sum()


def test_on_the_yaw_axis_theta_0_is_tried() -> None:
    for wanted in (LOWER[0], 1.0, 5.9, UPPER[0]):
        accept = lambda q, at=wanted: np.abs(q[:, 0] - at) < 0.09  # noqa: E731
        assert a5.reachable([0.0, 0.0, 0.3], accept=accept)
        assert not a5.reachable([0.0, 0.0, -0.35], accept=accept)
    assert not a5.reachable([0.0, 0.0, 0.3], accept=lambda q: q[:, 0] > UPPER[0])
    # Off the axis theta_0 is what it is.
    q0 = a5.inverse_kinematics([0.1, 0.1, 0.3]).q[0, 0]
    near = a5.reachable(
        [0.1, 0.1, 0.3], accept=lambda q: np.abs(q[:, 0] - q0 - 0.5) < 0.2
    )
    assert not near


def test_shares_against_exact_volumes_and_areas() -> None:
    """The share of the underarm pose is its first moment, turned about the yaw axis.

    Green's theorem gives the moment; the wedge is what the pose cannot face.
    """
    from alpha5_model.kinematics.half_plane import first_moment

    exact = (2 * math.pi - WEDGE) * first_moment(space.boundary("underarm"))
    found = space.sampled_share(underarm, 40_000, seed=3)
    assert found.total == space.volume()
    assert found.samples == 40_000
    assert found.share * found.total == pytest.approx(
        exact, abs=4 * found.standard_error * found.total
    )
    assert found.standard_error == pytest.approx(
        math.sqrt(found.share * (1 - found.share) / 40_000), rel=1e-3
    )
    part = space.sampled_share(underarm, 20_000, azimuth=math.pi / 2)
    assert part.total == space.cross_section_area()
    exact = space.cross_section_area("underarm") / space.cross_section_area()
    assert part.share == pytest.approx(exact, abs=4 * part.standard_error)


@pytest.mark.parametrize(
    ("azimuth", "side"),
    [(math.pi, "overarm"), (-math.pi, "overarm"), (0.0, "underarm"), (7.0, "both")],
)
def test_a_half_plane_in_a_closed_wedge_is_one_pose(azimuth: float, side: str) -> None:
    found = space.sampled_share(underarm, 500, azimuth=azimuth)
    assert found.total == pytest.approx(space.cross_section_area(side), rel=1e-12)
    if side != "both":
        assert found.share == (side == "underarm")
    else:
        assert 0 < found.share < 1


def test_the_standard_error_is_never_zero_and_holds() -> None:
    nothing = space.sampled_share(lambda q: np.zeros(len(q), bool), 400)
    assert nothing.share == 0.0
    assert nothing.standard_error == pytest.approx(math.sqrt(1 / 402 * 401 / 402 / 400))
    everything = space.sampled_share(lambda q: np.ones(len(q), bool), 400)
    assert everything == pytest.approx(
        (1.0, nothing.standard_error, space.volume(), 400)
    )
    shares = [space.sampled_share(underarm, 400, seed=k) for k in range(60)]
    for share in shares:  # Laplace's rule of succession, for odd and even counts
        p = (400 * share.share + 1) / 402
        assert share.standard_error == pytest.approx(
            math.sqrt(p * (1 - p) / 400), rel=1e-12
        )
    spread = np.std([s.share for s in shares], ddof=1)
    assert spread == pytest.approx(shares[0].standard_error, rel=0.3)
    assert space.sampled_share(underarm, 400, seed=5) == shares[5]
    assert space.sampled_share(underarm, 400) == shares[0] != shares[1]


@pytest.mark.slow
def test_the_share_by_plain_sampling(arm: Any) -> None:
    rng = np.random.default_rng(93)
    p = rng.uniform([-0.36, -0.36, -0.3], [0.36, 0.36, 0.39], (1200, 3))
    s = a5.inverse_kinematics(p, 3.0)
    inside = s.within_limits.any(axis=-1)
    free = [
        any(not arm.in_collision(q) for q in rows[flags])
        for rows, flags in zip(s.q[inside], s.within_limits[inside], strict=True)
    ]
    plain = np.mean(free)
    n = inside.sum()
    found = space.sampled_share(a5.without_self_collision, 4000)
    error = math.hypot(found.standard_error, math.sqrt(plain * (1 - plain) / n))
    assert abs(plain - found.share) < 4 * error
    assert 0.88 < found.share < 0.93


@pytest.mark.slow
def test_command_line(capsys: Any, tmp_path: Any) -> None:
    assert main(["workspace", "--self-collision", "--samples", "300", "--json"]) == 0
    share = json.loads(capsys.readouterr().out)["without_self_collision"]
    assert share["samples"] == 300
    assert share["total"] == space.volume()
    assert main(["workspace", "--self-collision", "--samples", "300"]) == 0
    out = capsys.readouterr().out
    assert f"{1 - share['share']:.1%} of the volume" in out
    assert f"standard error {share['standard_error']:.2%}" in out
    assert main(["workspace", "--json"]) == 0
    assert "without_self_collision" not in json.loads(capsys.readouterr().out)
    assert main(["workspace", "--self-collision", "--samples", "0"]) == 2


@pytest.mark.slow
def test_the_picture_shows_the_share_of_each_column(arm: Any) -> None:
    from alpha5_model.viewer.self_collision_plot import self_collision_figure

    cell = 0.06
    page = self_collision_figure(cell, samples=200)
    title = page.get_suptitle()
    share = 1 - space.sampled_share(a5.without_self_collision, 200).share
    assert title.startswith(f"{share:.1%} ± ")
    above = page.axes[0].collections[1].get_array()
    behind = above[:, : above.shape[1] // 2]
    before = above[:, above.shape[1] // 2 + 1 :]
    assert behind.compressed().max() > 50
    assert before.count() == 0, "in front the arm stays clear of its base"
    # One column counted by hand.
    row, column = np.unravel_index(np.ma.argmax(above), above.shape)
    half = (np.array(above.shape) - 1) // 2
    x = cell * (column - half[1])
    y = cell * (row - half[0])
    p = np.array([[x, y, 0.0462 + cell * k] for k in range(-7, 8)])
    s = a5.inverse_kinematics(p, 3.0)
    seen = s.within_limits.any(axis=-1)
    free = [
        any(not arm.in_collision(q) for q in rows[flags])
        for rows, flags in zip(s.q[seen], s.within_limits[seen], strict=True)
    ]
    assert above[row, column] == pytest.approx(100 * (1 - np.mean(free)))
