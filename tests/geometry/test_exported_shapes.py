"""The fewer collision shapes that other programs get: around the bodies, and close.

coal says whether points of the drawn meshes are in a shape, trimesh how far points on
the shapes are from the bodies. The fit itself uses neither.
"""

from __future__ import annotations

import csv
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from reference import LOWER, UPPER
from shared_recordings import JOINT_STATES, needs_recordings

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, REPOSITORY_PATH, URDF_PATH
from alpha5_model._support.spatial import pose
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.geometry.collision_shapes import (
    collision_primitives,
    exported_primitives,
)
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.jaws import split_link_4

if TYPE_CHECKING:
    import coal
    import trimesh

LINKS = tuple(collision_primitives())
#: Farthest that a shape may be from the drawn body [m].
FARTHEST = 3e-3


@cache
def body(link: str) -> trimesh.Trimesh:
    """The drawn body."""
    import trimesh

    mesh = trimesh.load(Path(REPOSITORY_PATH, "meshes", f"{link}.obj"), force="mesh")
    assert isinstance(mesh, trimesh.Trimesh)
    return mesh


@cache
def outside(link: str) -> trimesh.Trimesh:
    """The drawn body with its recesses, slots and shaft holes closed."""
    import trimesh

    pytest.importorskip("manifold3d")
    from meshes.drawing import bodies
    from meshes.triangles import surface

    closed = surface(bodies()[link].outside)
    return trimesh.Trimesh(closed.vertices, closed.faces, process=False)


def coal_shape(shape: Primitive) -> tuple[coal.CollisionGeometry, coal.Transform3s]:
    """A shape and its pose as coal has them."""
    import coal

    kinds = {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}
    placement = pose(shape.xyz, shape.rpy)
    return (
        kinds[shape.kind](*shape.size),
        coal.Transform3s(placement[:3, :3], placement[:3, 3]),
    )


def distances(shapes: tuple[Primitive, ...], points: np.ndarray) -> np.ndarray:
    """Distance of each point from each shape, not above 0 inside, by coal, (n, S)."""
    import coal

    placed = [coal_shape(shape) for shape in shapes]
    point = coal.Sphere(1e-9)
    request = coal.DistanceRequest()
    found = np.empty((len(points), len(shapes)))
    for row, place in enumerate(points):
        at = coal.Transform3s(np.eye(3), place)
        for column, (geometry, there) in enumerate(placed):
            result = coal.DistanceResult()
            found[row, column] = coal.distance(
                point, at, geometry, there, request, result
            )
    return found


def farthest_outside(distance: np.ndarray) -> float:
    """How far the worst of the points is from the nearest shape [m]."""
    return float(distance.min(axis=1).max())


def surface_of(shape: Primitive, count: int) -> np.ndarray:
    """Points on a shape and its corners, by trimesh, (n, 3) [m]."""
    import trimesh

    placement = pose(shape.xyz, shape.rpy)
    if shape.kind == "box":
        mesh = trimesh.creation.box(shape.size, placement)
    elif shape.kind == "sphere":
        mesh = trimesh.creation.icosphere(4, shape.size[0])
        mesh.apply_transform(placement)
    else:
        radius, height = shape.size
        mesh = trimesh.creation.cylinder(radius, height, 96, transform=placement)
    sampled, _ = trimesh.sample.sample_surface(mesh, count, seed=3)
    return np.vstack([mesh.vertices, sampled])


def excess(link: str, shapes: tuple[Primitive, ...]) -> float:
    """How far the shapes stick out of the body, by trimesh [m]."""
    import trimesh

    points = np.vstack([surface_of(shape, 250) for shape in shapes])
    return float(-trimesh.proximity.signed_distance(outside(link), points).min())


def sampled_body(link: str) -> np.ndarray:
    """Corners of a body's mesh, and points on it, (n, 3) [m]."""
    import trimesh

    points, _ = trimesh.sample.sample_surface(body(link), 1500, seed=1)
    corners = np.unique(body(link).vertices, axis=0)
    return np.vstack([corners, points])


@pytest.mark.parametrize("link", LINKS)
def test_the_shapes_enclose_the_drawn_body(link: str) -> None:
    shapes = exported_primitives()[link]
    distance = distances(shapes, sampled_body(link))
    assert farthest_outside(distance) < 1e-6
    # Without any one of them something sticks out.
    for number in range(len(shapes)):
        if len(shapes) > 1:
            assert farthest_outside(np.delete(distance, number, axis=1)) > 1e-6


def test_a_shape_that_is_too_small_is_seen() -> None:
    (tube,) = exported_primitives()["link_4"]
    radius, length = tube.size
    smaller = replace(tube, size=(radius - 1e-4, length))
    assert farthest_outside(distances((smaller,), sampled_body("link_4"))) > 1e-5


@pytest.mark.slow
@pytest.mark.parametrize("link", LINKS)
def test_no_shape_is_farther_than_three_millimetres_from_its_body(link: str) -> None:
    shapes = exported_primitives()[link]
    assert excess(link, shapes) < FARTHEST
    first = shapes[0]
    larger = replace(first, size=tuple(length + 7e-3 for length in first.size))
    assert excess(link, (larger,)) > FARTHEST


def test_there_are_fewer_than_the_package_compares() -> None:
    own = collision_primitives()
    exported = exported_primitives()
    assert list(exported) == list(own)
    for link, shapes in exported.items():
        assert len(shapes) <= len(own[link])
    assert count(exported) < 0.8 * count(own)


def count(shapes: dict[str, tuple[Primitive, ...]]) -> int:
    return sum(len(items) for items in shapes.values())


def test_the_file_is_for_the_present_shapes() -> None:
    pytest.importorskip("manifold3d")
    from shapes.fit_collision_shapes import digest, made_for

    stale = "run scripts/shapes/fit_collision_shapes.py --update"
    assert made_for() == digest(), stale


def test_closed_fingers_are_those_of_the_jaws() -> None:
    """At their closed poses in link_4, moved by a spacer."""
    spacer = 0.02
    locked = exported_primitives("locked", spacer)
    jaws = exported_primitives("jaws")
    assert list(locked) == ["link_0", "link_1", "link_2", "link_3", "link_4"]
    found = list(locked["link_4"][len(jaws["link_4"]) :])
    for finger in split_link_4(a5.parameters()).bodies[-2:]:
        origin = np.array(finger.origin) - [0.0, 0.0, spacer]
        closed = pose(origin, (finger.roll, 0.0, 0.0))
        for shape in jaws[finger.name]:
            moved = found.pop(0)
            expected = closed @ pose(shape.xyz, shape.rpy)
            assert pose(moved.xyz, moved.rpy) == pytest.approx(expected, abs=2e-9)
            assert moved.size == shape.size
    assert found == []
    with pytest.raises(a5.Alpha5Error, match="locked, jaws"):
        exported_primitives("open")


class Urdf:
    """A committed URDF with the pairs that its SRDF leaves, by Pinocchio alone."""

    def __init__(self, path: str) -> None:
        import pinocchio as pin

        # With fingers that follow the rod.
        self.model = pin.buildModelFromUrdf(path, True)
        self.geometry = pin.buildGeomFromUrdf(
            self.model, path, pin.GeometryType.COLLISION
        )
        self.geometry.addAllCollisionPairs()
        pin.removeCollisionPairs(
            self.model, self.geometry, path.replace(".urdf", ".srdf")
        )
        self._data = self.model.createData()

    def distance(self, q: np.ndarray) -> float:
        """The least distance at q [m]; coal's depth below 0."""
        import pinocchio as pin

        scratch = self.geometry.createData()
        number = pin.computeDistances(self.model, self._data, self.geometry, scratch, q)
        return float(scratch.distanceResults[number].min_distance)


@pytest.fixture(scope="module")
def urdf() -> Urdf:
    return Urdf(URDF_PATH)


@pytest.fixture(scope="module")
def jaws_urdf() -> Urdf:
    return Urdf(JAWS_URDF_PATH)


@pytest.mark.parametrize("name", NAMED_POSES)
def test_named_poses_are_free_in_the_urdf(
    urdf: Urdf, jaws_urdf: Urdf, name: str
) -> None:
    q = np.array(NAMED_POSES[name])
    assert urdf.distance(q) > 0.0
    rod = a5.parameters().joints[4]
    for opening in (rod.lower, rod.upper):
        assert jaws_urdf.distance(np.append(q, opening)) > 0.0


def test_verdicts_differ_only_where_bodies_are_six_millimetres_apart(
    urdf: Urdf,
) -> None:
    """Each of both shapes is up to 3 mm larger than the body that it encloses."""
    arm = a5.load()
    rng = np.random.default_rng(4)
    random = rng.uniform(LOWER, UPPER, (60, 4))
    folded = rng.uniform((0.02, 0.02, 0.02, 0), (0.6, 0.7, 1.5, 6.2), (120, 4))
    hits = 0
    differ = 0
    for q in np.vstack([random, folded]):
        theirs = urdf.distance(q)
        ours = float(arm.collision_distance(q))
        hits += theirs <= 0.0
        differ += (theirs <= 0.0) != (ours <= 0.0)
        if theirs <= 0.0:
            assert ours < 2.0 * FARTHEST
        if ours <= 0.0:
            assert theirs < 2.0 * FARTHEST
    assert 20 < hits < 160, "the sample must hold both kinds"
    assert differ < 0.1 * hits


@pytest.mark.slow
@needs_recordings
def test_the_real_arm_is_free_in_the_urdf(urdf: Urdf) -> None:
    """Every pose of the pool recordings, which rest 1 mm from contact."""
    for path in JOINT_STATES:
        with path.open() as stream:
            rows = list(csv.DictReader(stream))[::25]
        for row in rows:
            q = np.array([float(row[f"axis_{joint}_pos"]) for joint in "edcb"])
            assert urdf.distance(q) > 0.0
