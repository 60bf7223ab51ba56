"""The approximate distance of JAX and CasADi against coal's, and its gradients."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from fk import sample
from own_arm import random_arm, within

import alpha5_model as a5
from alpha5_model.collision.bodies import CollisionBodies, collision_bodies
from alpha5_model.collision.coal_scene import CoalScene
from alpha5_model.collision.spheres import (
    SHORT_BY,
    STICKING_OUT,
    signed_distances,
    spheres_for,
    surface_places,
)
from alpha5_model.collision.turning_radii import distance_rates
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

#: What the docstrings promise [m].
OFF = 0.012
pytestmark = pytest.mark.tools


def distances(arm: Alpha5Parameters, q: np.ndarray, **options: float) -> np.ndarray:
    """By CasADi, (N,)."""
    import alpha5_model.casadi as in_casadi

    function = in_casadi.approximate_collision_distance(arm, **options)
    return np.array(function(q.T)).ravel()


def in_double(function, *given):  # type: ignore[no-untyped-def]
    import jax

    with jax.enable_x64(True):
        return jax.tree.map(np.asarray, function(*given))


def of_the_same_shapes(arm: Alpha5Parameters, q: np.ndarray) -> np.ndarray:
    """The exact distance of links that can touch within the limits, by coal, (N,)."""
    bodies = collision_bodies(arm)
    if arm is parameters():
        pairs = ((0, 2), (0, 4), (1, 4))
        shoulder = replace(bodies.bodies[2], shapes=bodies.bodies[2].shapes[:1])
        parts = (*bodies.bodies[:2], shoulder, *bodies.bodies[3:])
        bodies = replace(bodies, bodies=parts, pairs=pairs)
    scene = CoalScene(bodies)
    return np.array([scene.nearest(row).distance for row in q])


def test_how_far_it_is_off_of_the_catalogues_arm() -> None:
    q = np.concatenate([sample(2000, seed=40), near_the_mount(200)])
    found = distances(parameters(), q)
    arm = a5.load()
    touches = arm.in_collision(q)
    assert 0.05 < touches.mean() < 0.6

    off = found - of_the_same_shapes(parameters(), q)
    assert np.abs(off).max() < OFF
    assert off.mean() < -0.002, "mostly too small"
    assert off[~touches].max() < 0.002
    # Where the arm touches itself, it is the distance that `Arm` has.
    deep = found[touches] - arm.collision_distance(q[touches])
    assert np.abs(deep).max() < OFF
    # Elsewhere that one may be smaller, by links that pass each other at a joint.
    assert (found - arm.collision_distance(q)).min() > -OFF
    assert (found[touches] < 0.0).all(), "no collision is missed"
    assert (found[~touches] > 0.0).mean() > 0.95
    assert found.max() > 0.04


def test_what_the_catalogues_distance_leaves_out_never_meets() -> None:
    """Link 2 but for its first shape, and link 0: all angles, by halving cells."""
    bodies = collision_bodies(parameters())
    rest = replace(bodies.bodies[2], shapes=bodies.bodies[2].shapes[1:])
    parts = (*bodies.bodies[:2], rest, *bodies.bodies[3:])
    assert proved_apart(replace(bodies, bodies=parts, pairs=((0, 2),)))
    assert not proved_apart(replace(bodies, pairs=((0, 2),)))


def proved_apart(bodies: CollisionBodies) -> bool:
    """Whether two links are apart at all theta_0 and theta_1 within the limits.

    A distance at the middle of a cell holds in all of it, less what the angles move.
    """
    scene = CoalScene(bodies)
    rates = distance_rates(bodies, (0, 2))[:2]
    joints = parameters().joints[:2]
    low = np.array([[joint.lower for joint in joints]])
    size = np.array([joint.upper for joint in joints]) - low[0]
    while len(low):
        middles = low + size / 2
        found = np.array([scene.nearest([*row, 1.0, 1.0]).distance for row in middles])
        if (found < 0.0).any():
            return False
        low = low[found <= rates @ size / 2]
        size = size / 2
        steps = size * np.array([[0, 0], [0, 1], [1, 0], [1, 1]])
        low = (low[:, None] + steps).reshape(-1, 2)
    return True


def near_the_mount(count: int) -> np.ndarray:
    """Positions in which links 0 and 2 touch or nearly do."""
    rng = np.random.default_rng(41)
    return rng.uniform([0.02, 0.5, 0.5, 0.0], [0.8, 1.4, 3.0, 6.0], (count, 4))


def test_how_far_it_is_off_of_another_arm() -> None:
    arm = random_arm(np.random.default_rng(1), off_axis=False)
    q = within(arm, 400, seed=1)
    found = distances(arm, q)
    touches = a5.load(arm=arm).in_collision(q)
    off = found - of_the_same_shapes(arm, q)
    assert np.abs(off).max() < OFF
    assert touches.any()
    assert found[touches].max() < 0.002
    # It is not the catalogue's.
    assert np.abs(found - distances(parameters(), q)).max() > 0.01


def test_jax_agrees_with_casadi() -> None:
    """Values of the catalogue's arm in single precision, of another one in double."""
    import jax

    import alpha5_model.jax as in_jax

    q = sample(60, seed=42)
    mapped = jax.jit(jax.vmap(in_jax.approximate_collision_distance))
    single = np.asarray(mapped(q.astype(np.float32)))
    assert single.dtype == np.float32
    assert single == pytest.approx(distances(parameters(), q), abs=2e-5)
    arm = random_arm(np.random.default_rng(1), off_axis=False)
    own = jax.jit(
        jax.vmap(lambda row: in_jax.approximate_collision_distance(row, arm=arm))
    )
    assert in_double(own, q) == pytest.approx(distances(arm, q), abs=1e-12)


def test_gradients_by_finite_differences_and_of_each_other() -> None:
    import casadi
    import jax

    import alpha5_model.casadi as in_casadi
    import alpha5_model.jax as in_jax

    q = sample(40, seed=43)
    q = np.concatenate([q, near_the_mount(20)])
    function = in_casadi.approximate_collision_distance()
    gradient = casadi.Function(
        "g", [x := casadi.SX.sym("x", 4)], [casadi.gradient(function(x), x)]
    )
    found = np.array(gradient(q.T)).T
    with_value = jax.jit(
        jax.vmap(jax.value_and_grad(in_jax.approximate_collision_distance))
    )
    value, slope = in_double(with_value, q)
    assert value == pytest.approx(distances(parameters(), q), abs=1e-12)
    assert slope == pytest.approx(found, abs=1e-9)
    step = 1e-6
    for joint in range(4):
        ahead = q + step * np.eye(4)[joint]
        behind = q - step * np.eye(4)[joint]
        difference = np.array(function(ahead.T) - function(behind.T)).ravel()
        assert difference / (2 * step) == pytest.approx(found[:, joint], abs=2e-5)
    assert np.abs(found).max(axis=0) == pytest.approx([0.1, 0.1, 0.1, 0.01], rel=2)


def test_along_a_line_the_gradient_does_not_jump() -> None:
    """As an optimiser meets it: from free into contact, in small steps."""
    import alpha5_model.casadi as in_casadi

    line = np.tile([0.0, 0.7, 1.5, 1.5], (4000, 1))
    line[:, 0] = np.linspace(1.1, 0.3, 4000)
    function = in_casadi.approximate_collision_distance()
    jacobian = function.jacobian()
    slopes = np.array([jacobian(row, 0.0)[0] for row in line[::10]]).ravel()
    found = distances(parameters(), line)
    assert found[0] > 0.005 > 0.0 > found[-1]
    jumps = np.abs(np.diff(slopes))
    assert jumps.max() < 0.03
    exact = [a5.load().collision_distance_gradient(row)[0] for row in line[::10]]
    assert jumps.max() < np.abs(np.diff(exact)).max()


def test_more_smoothing_makes_it_smaller() -> None:
    q = sample(100, seed=44)
    sharp = distances(parameters(), q, smoothing=1e-5)
    usual = distances(parameters(), q)
    soft = distances(parameters(), q, smoothing=0.005)
    assert (soft < usual).all()
    assert (usual < sharp).all()
    assert (usual > sharp - 0.001 * np.log(2000)).all()


def test_wrong_input_is_refused() -> None:
    import alpha5_model.casadi as in_casadi
    import alpha5_model.jax as in_jax

    for bad in (0.0, -1.0, np.nan, "soft"):
        with pytest.raises(InputError, match="smoothing"):
            in_casadi.approximate_collision_distance(smoothing=bad)
        with pytest.raises(InputError, match="smoothing"):
            in_jax.approximate_collision_distance(np.ones(4), smoothing=bad)
    with pytest.raises(ShapeError, match=r"q: expected shape \(4,\)"):
        in_jax.approximate_collision_distance(np.ones(5))
    for function in (
        in_casadi.approximate_collision_distance,
        lambda arm: in_jax.approximate_collision_distance(np.ones(4), arm=arm),
    ):
        with pytest.raises(InputError, match="arm"):
            function("my_arm.toml")


@pytest.mark.parametrize("link", [2, 4])
def test_spheres_are_as_near_the_shapes_as_they_say(link: int) -> None:
    shapes = collision_bodies(parameters()).bodies[link].shapes
    centres, radii = spheres_for(shapes)
    # Places in between those that the spheres were chosen by.
    rng = np.random.default_rng(45)
    places = np.vstack([surface_places(shape) for shape in shapes])
    places = places[rng.integers(len(places), size=3000)]
    places += rng.uniform(-0.002, 0.002, places.shape)
    depth = np.min([signed_distances(shape, places) for shape in shapes], axis=0)
    inside = places[(depth <= 0.0)]
    assert len(inside) > 500
    from_spheres = np.linalg.norm(inside[:, None] - centres, axis=2) - radii
    bare = from_spheres.min(axis=1)
    exposed = depth[depth <= 0.0] > -0.0005
    assert bare[exposed].max() < SHORT_BY + 0.002
    turned = rng.normal(size=(2000, 3))
    turned /= np.linalg.norm(turned, axis=1)[:, None]
    chosen = rng.integers(len(radii), size=2000)
    skin = centres[chosen] + radii[chosen, None] * turned
    out = np.min([signed_distances(shape, skin) for shape in shapes], axis=0)
    assert out.max() < STICKING_OUT + 0.002


@pytest.mark.parametrize(
    "shape",
    [
        Primitive("box", (0.03, 0.021, 0.009), (0.1, 0.0, -0.1), (0.4, 0.0, 0.2)),
        Primitive("cylinder", (0.02, 0.031), (0.0, 0.2, 0.0), (0.0, 1.0, 0.0)),
    ],
    ids=lambda shape: shape.kind,
)
def test_places_are_all_over_the_surface(shape: Primitive) -> None:
    """No farther apart than 4 mm along either of two directions."""
    places = surface_places(shape)
    assert np.abs(signed_distances(shape, places)).max() < 1e-12
    # Random points, moved to the surface along the gradient of the distance.
    rng = np.random.default_rng(46)
    points = np.array(shape.xyz) + rng.uniform(-0.03, 0.03, (3000, 3))
    step = 1e-7
    for _ in range(3):
        depth = signed_distances(shape, points)
        ahead = [signed_distances(shape, points + step * unit) for unit in np.eye(3)]
        slope = (np.array(ahead) - depth).T / step
        points = points - depth[:, None] * slope
    on_surface = points[np.abs(signed_distances(shape, points)) < 1e-6]
    assert len(on_surface) > 2000
    away = np.linalg.norm(on_surface[:, None] - places, axis=2).min(axis=1)
    assert away.max() < 0.004 / np.sqrt(2.0)
