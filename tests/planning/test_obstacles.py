"""Obstacles beside the arm, against coal on all pairs of shapes."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest
import trimesh
from coal_world import CoalWorld, samples
from reference import LOWER, UPPER
from scipy.spatial import ConvexHull

import alpha5_model as a5
from alpha5_model._support.spatial import moved, pose
from alpha5_model.collision import self_collision
from alpha5_model.errors import Alpha5Error, ImplausibleWarning, InputError
from alpha5_model.kernels import numpy_kernels
from alpha5_model.planning import Mesh, Obstacle
from alpha5_model.planning.broad_phase import SHORTEST
from alpha5_model.planning.obstacles import seen_from
from alpha5_model.planning.surroundings import Surroundings

#: Deepest disagreement with coal, whose own tolerance it is [m].
TOLERANCE = 2e-6


def ball_of_triangles(seed: int, radius: float, xyz: Sequence[float]) -> Obstacle:
    """A closed mesh around a point."""
    points = np.random.default_rng(seed).normal(size=(40, 3))
    points *= radius / np.linalg.norm(points, axis=1, keepdims=True)
    triangles = ConvexHull(points).simplices
    return Obstacle.mesh("stone", points, triangles, xyz, (0.3, -0.2, 1.0))


HULL = Obstacle.box("hull", (0.4, 0.3, 0.2), (-0.15, 0.0, 0.25), (0.1, 0.2, 0.3))
POST = Obstacle.cylinder("post", 0.03, 0.8, (0.22, 0.15, 0.0), (0.4, 0.0, 0.0))
BUOY = Obstacle.sphere("buoy", 0.08, (0.1, -0.25, 0.1))
STONE = ball_of_triangles(3, 0.12, (0.17, 0.1, -0.1))
ALL = (HULL, POST, BUOY, STONE)
each = pytest.mark.parametrize("obstacle", ALL, ids=lambda o: o.name)
record_of = own.random_record


def random_q(count: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(LOWER, UPPER, (count, 4))


def boundary(
    surroundings: Surroundings, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Joint positions just outside and just inside of contact, bisected."""
    hits = surroundings.touches(q)
    count = min(hits.sum(), (~hits).sum())
    touching, free = q[hits][:count].copy(), q[~hits][:count].copy()
    for _ in range(25):
        middle = (free + touching) / 2
        inside = surroundings.touches(middle)
        touching[inside] = middle[inside]
        free[~inside] = middle[~inside]
    return free, touching


@each
def test_random_positions_as_coal_says(obstacle: Obstacle) -> None:
    world = CoalWorld(obstacles=[obstacle])
    surroundings = Surroundings(a5.parameters(), [obstacle])
    q = random_q(150, seed=1)
    expected = [world.touches(row) for row in q]
    assert np.array_equal(surroundings.touches(q), expected)
    assert 10 < sum(expected) < 140


@each
def test_bisected_contacts_as_coal_says(obstacle: Obstacle) -> None:
    """At the edge of contact a wrong answer would be a wrong distance, too."""
    world = CoalWorld(obstacles=[obstacle])
    free, touching = boundary(
        Surroundings(a5.parameters(), [obstacle]), random_q(60, 2)
    )
    assert len(free) > 5
    for one, other in zip(free, touching, strict=True):
        assert world.distances(one).min() > -TOLERANCE
        assert world.distances(other).min() < TOLERANCE


@each
def test_distance_and_names_as_coal_says(obstacle: Obstacle) -> None:
    world = CoalWorld(obstacles=[obstacle])
    surroundings = Surroundings(a5.parameters(), [obstacle])
    q = random_q(60, seed=3)
    for row in q[~surroundings.touches(q)]:
        distances = world.distances(row)
        distance, names = surroundings.nearest(row)
        assert distance == pytest.approx(distances.min(), abs=TOLERANCE)
        pair = world.geometry.collisionPairs[int(distances.argmin())]
        bodies = [world.geometry.geometryObjects[n] for n in (pair.first, pair.second)]
        assert {body.name.rpartition("_")[0] or body.name for body in bodies} == {
            *names
        }


@each
def test_a_margin_is_kept(obstacle: Obstacle) -> None:
    world = CoalWorld(obstacles=[obstacle])
    surroundings = Surroundings(a5.parameters(), [obstacle], margin=0.03)
    free, touching = boundary(surroundings, random_q(120, seed=4))
    of_obstacle = 0
    for one, other in zip(free, touching, strict=True):
        assert world.obstacle_distance(one) > 0.03 - TOLERANCE
        found = surroundings.contact(other)
        assert found is not None
        if obstacle.name in found.names:
            assert world.obstacle_distance(other) < 0.03 + TOLERANCE
            of_obstacle += 1
        assert surroundings.contact(one) is None
    assert of_obstacle > 2


@each
def test_a_free_line_is_free_and_another_ends_at_its_obstacle(
    obstacle: Obstacle,
) -> None:
    world = CoalWorld(obstacles=[obstacle])
    margin = 0.004
    surroundings = Surroundings(a5.parameters(), [obstacle], margin)
    q = random_q(30, seed=5)
    touching = surroundings.touches(q)
    q = np.vstack([q[~touching][:10], q[touching][:5]])
    free = 0
    for start, end in pairwise(q):
        if surroundings.contact(start) is not None:
            continue
        found = surroundings.obstruction(start, end)
        share = 1.0 if found is None else found.share
        free += found is None
        for row in samples(start, start + share * (end - start), math.radians(10)):
            assert world.obstacle_distance(row) > margin - TOLERANCE
        if found is not None and obstacle.name in found.names:
            assert found.distance <= margin + 1.01 * SHORTEST
            at = world.obstacle_distance(found.q)
            assert found.distance == pytest.approx(at, abs=TOLERANCE)
    assert 2 < free < 10  # the last one leads to a contact


@pytest.mark.slow
def test_certified_lines_at_a_tenth_of_a_degree() -> None:
    """Lines of all obstacles that pass a contact closely: there steps could miss it."""
    world = CoalWorld(obstacles=ALL)
    surroundings = Surroundings(a5.parameters(), ALL)
    near, _ = boundary(Surroundings(a5.parameters(), ALL, 0.002), random_q(200, seed=6))
    certified = 0
    for start, end in pairwise(near):
        towards = start + 0.3 * (end - start)
        if surroundings.obstruction(start, towards) is not None:
            continue
        for row in samples(start, towards, math.radians(0.1)):
            assert not world.touches(row)
        certified += 1
        if certified == 5:
            return
    pytest.fail("too few lines are free")


@pytest.mark.parametrize("seed", [1, 2])
def test_arms_of_ones_own(seed: int) -> None:
    record = record_of(seed)
    world = CoalWorld(record, ALL)
    surroundings = Surroundings(record, ALL)
    lower = [joint.lower for joint in record.joints[:4]]
    upper = [joint.upper for joint in record.joints[:4]]
    q = np.random.default_rng(seed).uniform(lower, upper, (100, 4))
    assert np.array_equal(surroundings.touches(q), [world.touches(row) for row in q])
    free, touching = boundary(surroundings, q)
    for one, other in zip(free[:10], touching[:10], strict=True):
        assert world.distances(one).min() > -TOLERANCE
        assert world.distances(other).min() < TOLERANCE


def test_base_link_turns_with_the_correction() -> None:
    """Without it, link_0 is turned by pi in base_link; obstacles are in base_link."""
    record = a5.parameters(())
    world = CoalWorld(record, ALL)
    surroundings = Surroundings(record, ALL)
    q = random_q(100, seed=7)
    assert np.array_equal(surroundings.touches(q), [world.touches(row) for row in q])


@pytest.mark.slow
def test_without_a_compiler_the_answers_are_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    q = random_q(20, seed=8)
    compiled = Surroundings(a5.parameters(), ALL, 0.01)
    hits = compiled.touches(q)
    lines = [compiled.obstruction(*pair) for pair in zip(q[:5], q[5:10], strict=True)]

    monkeypatch.setattr(self_collision, "module", lambda: numpy_kernels)
    record = own.dataclasses.replace(a5.parameters(), name="again")
    plain = Surroundings(record, ALL, 0.01)
    assert np.array_equal(plain.touches(q), hits)
    for found, pair in zip(lines, zip(q[:5], q[5:10], strict=True), strict=True):
        other = plain.obstruction(*pair)
        assert (found is None) == (other is None)
        if found is not None and other is not None:
            assert other.share == pytest.approx(found.share, abs=1e-5)


def test_a_mesh_is_its_surface() -> None:
    """A link inside of a closed mesh is free: the motion did not cross the surface."""
    stone = ball_of_triangles(9, 2.0, (0.0, 0.0, 0.0))
    surroundings = Surroundings(a5.parameters(), [stone])
    assert not surroundings.touches(a5.named_pose("home")[None])[0]
    small = ball_of_triangles(9, 0.3, (0.0, 0.0, 0.0))
    found = Surroundings(a5.parameters(), [small]).contact(a5.named_pose("reach"))
    assert found is not None
    assert found.names[0] == "stone"
    assert found.distance <= 0.0


def test_what_the_mount_touches_does_not_count() -> None:
    plate = Obstacle.box("plate", (0.5, 0.5, 0.01), (0.0, 0.0, -0.006))
    found = Surroundings(a5.parameters(), [plate]).contact(a5.named_pose("home"))
    assert found is None or "link_0" not in found.names


def test_threads_may_share_surroundings() -> None:
    surroundings = Surroundings(a5.parameters(), ALL)
    q = random_q(40, seed=10)
    alone = surroundings.touches(q)
    with ThreadPoolExecutor(4) as pool:
        answers = list(pool.map(surroundings.touches, [q] * 8))
    assert all(np.array_equal(answer, alone) for answer in answers)


def test_meshes_are_placed_like_their_points() -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    turn = (0, 0, math.pi / 2)
    mesh = Obstacle.mesh("m", points, [[0, 1, 2]], (0.1, 0.2, 0.3), turn).shape
    assert isinstance(mesh, Mesh)
    expected = [[0.1, 0.2, 0.3], [0.1, 1.2, 0.3], [-0.9, 0.2, 0.3]]
    assert mesh.vertices == pytest.approx(np.array(expected))
    assert not mesh.vertices.flags.writeable


def test_a_shape_is_seen_from_any_frame() -> None:
    """What is seen from a frame, moved by the frame's pose, is where it was."""
    rng = np.random.default_rng(3)
    mesh = Mesh(vertices=rng.normal(size=(5, 3)), triangles=np.array([[0, 1, 2]]))
    box = Obstacle.box("b", (1, 2, 3), (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)).shape

    def at(shape: Any) -> np.ndarray:
        return pose(shape.xyz, shape.rpy)

    for frame in (pose(*rng.normal(size=(2, 3))) for _ in range(5)):
        seen = seen_from(frame, mesh)
        assert moved(frame, seen.vertices) == pytest.approx(mesh.vertices, abs=1e-12)
        placed = frame @ at(seen_from(frame, box))
        assert placed == pytest.approx(at(box), abs=1e-12)


BAD = [
    (lambda: Obstacle.box("", (1, 1, 1)), "name"),
    (lambda: Obstacle.box(3, (1, 1, 1)), "name"),  # type: ignore[arg-type]
    (lambda: Obstacle.box("b", (1, 0, 1)), r"edges\[1\]: expected a number above 0"),
    (lambda: Obstacle.box("b", (1, 1)), "edges"),
    (lambda: Obstacle.box("b", (1, 1, 1), (0, 0)), "xyz"),
    (lambda: Obstacle.box("b", (1, 1, 1), rpy=(0, 0, math.nan)), "rpy"),
    (lambda: Obstacle.cylinder("c", -1, 1), "radius"),
    (lambda: Obstacle.cylinder("c", 1, 0), "length"),
    (lambda: Obstacle.sphere("s", 0), "radius"),
    (lambda: Obstacle.mesh("m", np.zeros((0, 3)), [[0, 1, 2]]), "triangles"),
    (lambda: Obstacle.mesh("m", np.zeros((3, 3)), np.zeros((0, 3))), "T at least 1"),
    (lambda: Obstacle.mesh("m", np.zeros(3), [[0, 1, 2]]), "vertices"),
    (lambda: Obstacle.mesh("m", np.zeros((3, 3)), [[0, 1, 3]]), "from 0 to 2, got 3"),
    (lambda: Obstacle.mesh("m", np.zeros((3, 3)), [[0, 1, 0.5]]), "whole numbers"),
    (lambda: Obstacle.mesh("m", np.zeros((3, 3)), [0, 1, 2]), "triangles"),
    (lambda: Obstacle("o", "box"), "shape"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("make", "message"), BAD, ids=range(len(BAD)))
def test_bad_obstacles(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        make()  # type: ignore[operator]
    assert isinstance(caught.value, Alpha5Error)


@pytest.mark.parametrize(
    "make",
    [
        lambda mm: Obstacle.box("hull", (457 * mm, 338 * mm, 254 * mm)),
        lambda mm: Obstacle.box("hull", (0.4, 0.3, 0.2), xyz=(200 * mm, 0, -140 * mm)),
        lambda mm: Obstacle.cylinder("post", 30 * mm, 1000 * mm, (220 * mm, 0, 0)),
        lambda mm: Obstacle.sphere("buoy", 80 * mm),
        lambda mm: Obstacle.mesh(
            "tent",
            np.vstack([np.eye(3), -np.eye(3)]) * 500 * mm,
            [[0, 1, 2], [3, 4, 5]],
        ),
    ],
)
def test_millimetres_are_warned_of(make: Callable[[float], Obstacle]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        make(1e-3)
    with pytest.warns(ImplausibleWarning, match="hull|post|buoy|tent"):
        make(1.0)


@pytest.mark.filterwarnings("error")
def test_a_wide_sea_bed_is_plausible() -> None:
    Obstacle.box("sea bed", (50.0, 50.0, 0.1), xyz=(20.0, 0.0, -1.0))
    Obstacle.mesh("hull", [[0, 0, 0], [0, 0, -9], [0, 9, 0]], [[0, 1, 2]])


def test_arrays_of_other_libraries_are_taken() -> None:
    """trimesh gives subclasses of arrays, as the guide on motions shows."""
    box = trimesh.creation.box((0.4, 0.2, 0.1))
    hull = Obstacle.mesh("hull", box.vertices, box.faces)
    np.testing.assert_array_equal(hull.shape.vertices, np.array(box.vertices))
    with pytest.raises(InputError, match="vertices"):
        Obstacle.mesh("hull", np.ma.masked_array(box.vertices), box.faces)
