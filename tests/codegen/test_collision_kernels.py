"""The compiled self-collision on scenes of a few shapes, by other routes."""

from __future__ import annotations

import itertools
from typing import Any

import coal
import numpy as np
import pytest
from collision_scenes import (
    AT_ORIGIN,
    assert_same_nearest,
    at,
    chain,
    compiled,
    cubes,
    hits,
    nearest,
    scene_of,
    shape,
    shares,
)

# --- distances --------------------------------------------------------------------


def reach(row: np.ndarray, direction: np.ndarray) -> float:
    """How far a shape reaches along a direction, from the origin of its body."""
    half = row[2:5]
    placement = row[5:].reshape(3, 4)
    own = placement[:, :3].T @ direction
    if row[1]:
        extent = half[0] * np.hypot(own[0], own[1]) + half[2] * abs(own[2])
    else:
        extent = half @ np.abs(own)
    return float(placement[:, 3] @ direction + extent)


def by_coal(one: np.ndarray, other: np.ndarray) -> float:
    solids, poses = [], []
    for row in (one, other):
        a, b, c = 2 * row[2:5]
        solids.append(coal.Cylinder(a / 2, c) if row[1] else coal.Box(a, b, c))
        placement = row[5:].reshape(3, 4)
        poses.append(coal.Transform3s(placement[:, :3], placement[:, 3]))
    result = coal.DistanceResult()
    return float(
        coal.distance(
            solids[0], poses[0], solids[1], poses[1], coal.DistanceRequest(), result
        )
    )


def turns(rng: np.random.Generator, count: int) -> list[Any]:
    """Random ones, quarter turns and ones that are off by less than is measured."""
    from scipy.spatial.transform import Rotation

    none = Rotation.identity()
    quarters = Rotation.from_euler("XYZ", [90, 0, 90], degrees=True)
    small = Rotation.from_rotvec(rng.normal(scale=1e-5, size=3))
    return [*Rotation.random(count, rng), *[none, quarters, small] * 10]


@pytest.mark.parametrize("kinds", itertools.product((0, 1), repeat=2))
def test_no_plane_separates_shapes_by_more_than_their_distance(
    kinds: tuple[int, int],
) -> None:
    """The distance is that of its points, and all of both shapes lies beyond them."""
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(kinds[0] + 2 * kinds[1])
    separated = 0
    for turn in turns(rng, 90):
        sizes = rng.uniform(0.02, 0.3, (2, 3))
        for size, is_round in zip(sizes, kinds, strict=True):
            size[1] = size[0] if is_round else size[1]
        place = rng.uniform(-0.45, 0.45, 3)
        one = shape(0, sizes[0], at(*rng.normal(size=3), Rotation.random(None, rng)))
        first = np.vstack([one[5:].reshape(3, 4), [0, 0, 0, 1]])
        second = first @ np.vstack([at(*place, turn).reshape(3, 4), [0, 0, 0, 1]])
        other = shape(1, sizes[1], second[:3].ravel(), kinds[1])
        one[1] = kinds[0]
        scene = scene_of(chain(2), [one, other], [(0, 1)])

        distance, *numbers = nearest(scene, np.zeros((1, 1)))[0].tolist()
        assert numbers[:2] == [0, 1]
        assert hits(scene, np.zeros((1, 1)))[0] == (distance == 0.0)
        assert hits(scene, np.zeros((1, 1)), distance * (1 + 1e-9))[0]
        if distance == 0.0:
            assert by_coal(one, other) < 1e-6
            continue
        separated += 1
        assert not hits(scene, np.zeros((1, 1)), distance * (1 - 1e-9))[0]
        on_a, on_b = np.array(numbers[2:]).reshape(2, 3)
        assert np.linalg.norm(on_b - on_a) == pytest.approx(distance, abs=1e-9)
        normal = (on_b - on_a) / distance
        assert reach(one, normal) == pytest.approx(on_a @ normal, abs=1e-8)
        assert -reach(other, -normal) == pytest.approx(on_b @ normal, abs=1e-8)
    assert separated > 40


def test_of_several_bodies_and_shapes_the_nearest_are_found() -> None:
    """Five bodies of three shapes each, all pairs, one by one and by brute force."""
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(5)
    bodies = chain(5)
    bodies[1:, 1:] = [
        at(*rng.uniform(-0.6, 0.6, 3), Rotation.random(None, rng)) for _ in range(4)
    ]
    bodies[3, 0] = 1.0
    shapes = [
        shape(
            body,
            [0.05, 0.05, rng.uniform(0.02, 0.2)],
            at(*rng.uniform(-0.2, 0.2, 3), Rotation.random(None, rng)),
            is_round,
        )
        for body in range(5)
        for is_round in (0, 1, 0)
    ]
    pairs = list(itertools.combinations(range(5), 2))
    angles = rng.uniform(-3.0, 3.0, (60, 4))
    together = nearest(scene_of(bodies, shapes, pairs), angles)

    alone = []
    for one, other in itertools.combinations(shapes, 2):
        if one[0] != other[0]:
            scene = scene_of(bodies, [one, other], [(int(one[0]), int(other[0]))])
            alone.append(nearest(scene, angles)[:, 0])
    least = np.min(alone, axis=0)
    np.testing.assert_allclose(together[:, 0], least, rtol=0, atol=1e-9)
    assert 5 < (least == 0.0).sum() < 55
    for margin in (0.0, 0.03):
        found = hits(scene_of(bodies, shapes, pairs), angles, margin)
        assert np.array_equal(found, least <= margin)

    # In the other order, and with a body that has no shape, nothing changes.
    turned = scene_of(bodies, shapes, [(b, a) for a, b in reversed(pairs)])
    np.testing.assert_allclose(nearest(turned, angles)[:, 0], least, rtol=0, atol=1e-9)
    empty = np.vstack([bodies, [4, *AT_ORIGIN]])
    more = scene_of(empty, shapes, [(0, 5), *pairs, (5, 1)])
    rows = np.hstack([angles, np.zeros((60, 1))])
    assert_same_nearest(nearest(more, rows), together)


def test_rows_beyond_a_block_are_those_of_single_calls() -> None:
    scene = scene_of(*cubes(0.22), [(0, 1)])
    angles = np.random.default_rng(6).uniform(-3.0, 3.0, (8200, 1))
    found = hits(scene, angles)
    assert 0.1 < found.mean() < 0.9
    one_by_one = [compiled.self_collision(scene, row, 0.0) for row in angles]
    assert found.tolist() == one_by_one
    asked = np.arange(8200) % 3 == 0
    assert np.array_equal(hits(scene, angles, asked=asked), found & asked)
    some = angles[:520]
    rows = np.concatenate([nearest(scene, row[None]) for row in some])
    assert_same_nearest(nearest(scene, some), rows)


def test_points_of_shapes_that_touch_are_not_a_number() -> None:
    bodies, _ = cubes(0.05)
    rounds = [shape(body, [0.1, 0.1, 0.1], is_round=1) for body in (0, 1)]
    found = nearest(scene_of(bodies, rounds, [(0, 1)]), np.zeros((1, 1)))
    assert found[0, :3].tolist() == [0.0, 0.0, 1.0]
    assert np.isnan(found[0, 3:]).all()


# --- lines ------------------------------------------------------------------------


@pytest.mark.parametrize("margin", [0.0, 0.02])
def test_a_line_is_free_up_to_the_contact(margin: float) -> None:
    """A ball-like bar turns about z towards a wall at y = 0.3."""
    bodies = chain(2)
    shapes = [
        shape(0, [2.0, 0.1, 1.0], at(0.0, 0.4)),
        shape(1, [0.5, 1e-6, 1e-6], at(0.5)),
    ]
    scene = scene_of(bodies, shapes, [(0, 1)])
    rates = np.ones((1, 1))
    start = np.zeros((4, 1))
    end = np.array([[1.0], [0.2], [-1.0], [0.0]])
    found = shares(scene, rates, start, end, margin)
    assert found[0] == pytest.approx(np.arcsin(0.3 - margin), abs=1e-4)
    assert found[0] < np.arcsin(0.3 - margin)
    assert found[1:].tolist() == [1.0, 1.0, 1.0]
    # From a place within the margin nothing is free, and nothing is NaN.
    inside = np.full((1, 1), 1.0)
    assert shares(scene, rates, inside, -inside, margin)[0] == 0.0


def test_a_line_of_several_pairs_ends_at_the_first() -> None:
    """Also with a body without shapes, and with pairs that the line does not move."""
    bodies = np.vstack([chain(3), [0, *AT_ORIGIN]])
    shapes = [
        shape(0, [2.0, 0.1, 1.0], at(0.0, 0.4)),
        shape(1, [0.5, 1e-6, 1e-6], at(0.5)),
        shape(2, [0.5, 1e-6, 1e-6], at(0.5, 0.0, 0.1)),
    ]
    pairs = [(3, 1), (0, 1), (0, 2), (0, 3), (1, 2)]
    scene = scene_of(bodies, shapes, pairs)
    rates = np.ones((5, 3))
    start = np.zeros((3, 3))
    end = np.array([[0.4, 0.0, 3.0], [0.1, 0.6, 0.0], [0.1, 0.1, 9.0]])
    found = shares(scene, rates, start, end)
    contact = np.arcsin(0.3)
    expected = [contact / 0.4, contact / 0.7, 1.0]
    assert found == pytest.approx(expected, abs=1e-4)
    assert (found[:2] < expected[:2]).all()
    assert found[2] == 1.0


# --- what is refused ---------------------------------------------------------------


def test_what_is_not_plainly_their_input_is_not_computed() -> None:
    """No memory beside an array is read or written."""
    scene = scene_of(*cubes(), [(0, 1)])
    two = np.zeros((2, 1))
    flags = np.zeros(2, np.bool_)
    out = np.zeros(2, np.bool_)
    frozen = np.zeros(2)
    frozen.flags.writeable = False
    plain: dict[str, list[Any]] = {
        "self_collision_rows": [two, 0.0, flags, out],
        "nearest_bodies_rows": [two, np.zeros((2, 9))],
        "free_shares": [np.ones((1, 1)), two, two, 0.0, np.zeros(2)],
    }
    unfit: dict[str, list[tuple[int, Any]]] = {
        "self_collision_rows": [
            (0, two.tolist()),
            (0, np.zeros((3, 1))),
            (0, np.zeros((4, 1))[::2]),
            (1, np.nan),
            (2, np.zeros(3, np.bool_)),
            (3, np.zeros(1, np.bool_)),
            (3, np.zeros(2, np.int8)),
        ],
        "nearest_bodies_rows": [
            (0, np.array([[0.0], [np.nan]])),
            (1, np.zeros(17)),
            (1, np.zeros((2, 9), np.float32)),
        ],
        "free_shares": [
            (0, np.ones((1, 2))),
            (1, np.zeros((3, 1))),
            (2, np.array([[0.0], [np.inf]])),
            (3, -1e-9),
            (4, np.zeros(3)),
            (4, frozen),
        ],
    }
    for name, arguments in plain.items():
        function = getattr(compiled, name)
        assert function(scene, *arguments) is True
        for place, value in unfit[name]:
            changed = [*arguments]
            changed[place] = value
            assert function(scene, *changed) is False, (name, place, value)
        with pytest.raises(TypeError):
            function(scene, *arguments[:-1])
        with pytest.raises(ValueError, match="PyCapsule"):
            function(None, *arguments)
    for angles in ([0.0], np.zeros(2), np.zeros(1, np.float32), np.full(1, np.nan)):
        assert compiled.self_collision(scene, angles, 0.0) is None


def test_scenes_that_do_not_fit_are_refused() -> None:
    """At most eight bodies and 64 pairs, and each number in its range."""
    ends = [shape(0, [0.1] * 3), shape(7, [0.1] * 3)]
    many = [(0, 7)] * 64
    scene_of(chain(8), ends, many)
    bodies, shapes = cubes()
    backwards = bodies.copy()
    backwards[1, 0] = 1.0
    elsewhere = np.array(shapes)
    elsewhere[1, 0] = 2.0
    for wrong in (
        (chain(9), ends, many),
        (chain(0), [], []),
        (chain(8), ends, [*many, (0, 7)]),
        (backwards, shapes, [(0, 1)]),
        (bodies, elsewhere, [(0, 1)]),
        (bodies, shapes, [(0, 2)]),
        (bodies, shapes, [(-1, 1)]),
    ):
        with pytest.raises(ValueError, match="scene"):
            scene_of(*wrong)
