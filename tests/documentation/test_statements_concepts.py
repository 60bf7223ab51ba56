"""What the pages on concepts and the errata say in numbers, computed again."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import coal
import numpy as np
import pinocchio as pin
import pytest
from fk import sample, tip
from reference import LOWER, UPPER
from statement_registry import AtMost, Figure, Near, Statement, parameters_of, statement

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH
from alpha5_model.collision.disabled_pairs import disabled_pairs
from alpha5_model.collision.touching_pairs import touching_pairs
from pinocchio_collision import collision_geometry
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.numbers.inertia import (
    flip_products,
    principal_moments,
    second_moments,
)

ERRATA = "docs/errata.md"
DEXTERITY = "docs/concepts/dexterity.md"


# --- pairs of collision shapes -------------------------------------------------------


class UrdfPairs(NamedTuple):
    """What Pinocchio counts in a committed URDF."""

    shapes: int
    all: int
    left: int


def urdf_pairs(path: str) -> UrdfPairs:
    """Shapes, pairs of those on different links, and those that the SRDF leaves."""
    model = pin.buildModelFromUrdf(path)
    geometry = pin.buildGeomFromUrdf(model, path, pin.GeometryType.COLLISION)
    geometry.addAllCollisionPairs()
    every = len(geometry.collisionPairs)
    pin.removeCollisionPairs(model, geometry, path.replace(".urdf", ".srdf"))
    return UrdfPairs(
        shapes=geometry.ngeoms, all=every, left=len(geometry.collisionPairs)
    )


def own_pairs() -> UrdfPairs:
    """The same of the shapes that the package compares, by arithmetic."""
    counts = {
        link: len(items) for link, items in collision_primitives("locked").items()
    }
    apart = {
        frozenset(pair)
        for pairs in disabled_pairs(a5.parameters(), "locked").values()
        for pair in pairs
    }
    products = {
        frozenset(pair): counts[pair[0]] * counts[pair[1]]
        for pair in itertools.combinations(counts, 2)
    }
    left = sum(count for pair, count in products.items() if pair not in apart)
    return UrdfPairs(shapes=sum(counts.values()), all=sum(products.values()), left=left)


@statement(
    "docs/concepts/self-collision.md",
    "| compared by this package | {} | {} | | in the URDF | {} | {} | "
    "In the URDF with jaws that move, {} pairs are left.",
)
def shapes_of_both() -> Sequence[Figure]:
    own = own_pairs()
    locked = urdf_pairs(a5.URDF_PATH)
    jaws = urdf_pairs(JAWS_URDF_PATH)
    counts = (own.shapes, own.left, locked.shapes, locked.left, jaws.left)
    return [Near(count) for count in counts]


@statement(
    "docs/concepts/self-collision.md",
    "Of the other {} pairs of this package's shapes, {} can touch within the joint "
    "limits; the remaining {} are proved never to touch. With jaws that move, {} can "
    "touch.",
)
def pairs_that_can_touch() -> Sequence[Figure]:
    counts = [len(items) for items in collision_primitives("locked").values()]
    neighbours = sum(one * other for one, other in itertools.pairwise(counts))
    compared = own_pairs().all - neighbours
    can_touch = len(touching_pairs("locked"))
    with_jaws = len(touching_pairs("jaws"))
    return [
        Near(count) for count in (compared, can_touch, compared - can_touch, with_jaws)
    ]


@statement(
    "docs/guides/ros.md",
    "The {} collision shapes make {} pairs on different links. {} of them are left to "
    "check; with jaws, {} of {}.",
)
def pairs_for_moveit() -> Sequence[Figure]:
    locked = urdf_pairs(a5.URDF_PATH)
    jaws = urdf_pairs(JAWS_URDF_PATH)
    counts = (locked.shapes, locked.all, locked.left, jaws.left, jaws.all)
    return [Near(count) for count in counts]


# --- the workspace without self-collision --------------------------------------------

#: Points in a box around the reach; about a third of them are reached.
POINTS = 6000


def touching(geometry: Any, q: np.ndarray, margin: float) -> np.ndarray:
    """Whether any pair of bodies is closer than a margin [m], by coal pair by pair,
    (N,).
    """
    model = a5.load().model
    data, objects = model.createData(), geometry.createData()
    request = coal.CollisionRequest()
    request.security_margin = margin
    objects.collisionRequests[:] = [request] * len(objects.collisionRequests)
    return np.array(
        [pin.computeCollisions(model, data, geometry, objects, x, True) for x in q]
    )


@cache
def reached() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Reached points of a box (M, 3), all solutions of them (K, 4), and whose they are
    (K,).
    """
    rng = np.random.default_rng(3)
    points = rng.uniform([-0.37, -0.37, -0.31], [0.37, 0.37, 0.41], (POINTS, 3))
    solutions = a5.inverse_kinematics(points, 3.0)
    within = solutions.within_limits
    points, within, q = (x[within.any(axis=1)] for x in (points, within, solutions.q))
    return points, q[within], np.nonzero(within)[0]


def by_wrist() -> tuple[pin.GeometryModel, pin.GeometryModel]:
    """The pairs of bodies that the wrist does not move, and those that it moves."""
    model = a5.load().model
    wrist = model.getJointId("axis_b")
    halves = []
    for moved in (False, True):
        geometry = collision_geometry(model)
        bodies = geometry.geometryObjects
        kept = [
            pin.CollisionPair(pair.first, pair.second)
            for pair in geometry.collisionPairs
            if moved
            == (
                wrist
                in (bodies[pair.first].parentJoint, bodies[pair.second].parentJoint)
            )
        ]
        geometry.removeAllCollisionPairs()
        for pair in kept:
            geometry.addCollisionPair(pair)
        halves.append(geometry)
    return halves[0], halves[1]


@cache
def only_touching(margin: float) -> np.ndarray:
    """Which of the reached points are reached only where bodies are closer than a
    margin [m].
    """
    points, q, owner = reached()
    before_wrist, with_wrist = by_wrist()
    free = np.zeros(len(q), bool)
    left = np.flatnonzero(~touching(before_wrist, q, margin))
    for wrist in np.linspace(LOWER[3], UPPER[3], 25):
        turned = q[left].copy()
        turned[:, 3] = wrist
        hit = touching(with_wrist, turned, margin)
        free[left[~hit]] = True
        left = left[hit]
    out = np.ones(len(points), bool)
    out[owner[free]] = False
    return out


def share(margin: float) -> Near:
    """Share of the reached volume [%], and four standard errors."""
    hits = only_touching(margin)
    p = float(hits.mean())
    return Near(100 * p, 400 * math.sqrt(p * (1 - p) / hits.size))


@statement(ERRATA, "{} % is reached only where the arm touches itself")
def self_collision() -> Sequence[Figure]:
    return [share(0.0)]


@statement(ERRATA, "(100 000 points, standard error {} %)")
def its_standard_error() -> Sequence[Figure]:
    p = share(0.0).value / 100
    return [Near(100 * math.sqrt(p * (1 - p) / 100_000), 0.005)]


@statement(
    ERRATA,
    "| if less than 3 mm apart | {} % | | if they touch | {} % | "
    "| if they overlap by more than 3 mm | {} % |",
)
def self_collision_by_margin() -> Sequence[Figure]:
    return [share(3e-3), share(0.0), share(-3e-3)]


def test_it_is_on_the_side_of_the_mount() -> None:
    points, _, _ = reached()
    hits = points[only_touching(0.0)]
    assert len(hits) > 80
    assert (hits[:, 0] < 0).all()
    text = Statement(ERRATA, "All of this volume is on the side of the mount", list)
    assert text.found()


def test_the_audits_share_is_the_pages() -> None:
    (row,) = (r for r in a5.audit() if r.claim == "workspace.self_collision")
    assert row.measured == pytest.approx(9.1, abs=3 * row.standard_error)


# --- the base frame ------------------------------------------------------------------


@statement(
    "alpha5_model/numbers/corrections.toml",
    "has the base body at x = {} to {} mm. Table 2's COM ({} mm) and Table 3's COB "
    "({} mm) are inside it only without the rotation. The range that real arms report "
    "for theta_0, {} to {} deg",
)
def base_frame() -> Sequence[Figure]:
    p = a5.parameters()
    low, high = 1e3 * p.links[0].bounds[0]
    com, cob = 1e3 * p.links[0].com[0], 1e3 * p.links[0].cob[0]
    assert low < com < high
    assert low < cob < high
    assert -com > high
    assert -cob > high
    lower, upper = (math.degrees(x) for x in (p.joints[0].lower, p.joints[0].upper))
    # The underarm pose points along theta_0 + pi: to -x at 0 and at 360 deg, which are
    # left out.
    assert lower > 0
    assert upper < 360
    return [Near(low), Near(high), Near(com), Near(cob), Near(lower), Near(upper)]


# --- dexterity -----------------------------------------------------------------------


@cache
def called_dexterous() -> tuple[int, int, int]:
    """Random points; of these called dexterous by 360 orientations, and not by 3600."""
    arm = a5.planar.PlanarArm([5, 4, 1], limits=[(-2.967, 2.967)] * 3)
    turn, square = np.random.default_rng(0).uniform(size=(2, 4000))
    radius = 10 * np.sqrt(square)
    points = np.stack(
        [radius * np.cos(math.tau * turn), radius * np.sin(math.tau * turn)], axis=-1
    )
    candidates = points[a5.planar.dexterity(arm, points) == 1]
    finer = np.zeros(len(candidates), bool)
    for part in np.array_split(np.arange(len(candidates)), 8):
        finer[part] = gaps_are_small(candidates[part])
    return len(points), len(candidates), int((~finer).sum())


def gaps_are_small(points: np.ndarray) -> np.ndarray:
    """Whether the arm (5, 4, 1) reaches points with 3600 hand orientations; the tests'
    own formulas.
    """
    hand = np.exp(1j * np.linspace(0, math.tau, 3600, endpoint=False))
    wrist = (points[:, 0] + 1j * points[:, 1])[:, None] - hand
    cosine = (np.abs(wrist) ** 2 - 25 - 16) / 40
    found = np.zeros(wrist.shape, bool)
    for side in (1, -1):
        with np.errstate(invalid="ignore"):
            elbow = side * np.arccos(cosine)
            shoulder = np.angle(wrist / (5 + 4 * np.exp(1j * elbow)))
            last = np.angle(hand * np.exp(-1j * (shoulder + elbow)))
            angles = np.max(np.abs([shoulder, elbow, last]), axis=0)
        found |= angles <= 2.967 + 1e-9
    return np.asarray(found.all(axis=1))


@statement(
    DEXTERITY,
    "tries {} orientations unless you give another number. It misses gaps narrower "
    "than one degree: of {} random points of the arm below, it wrongly calls {} "
    "dexterous, as 3600 orientations show",
)
def dexterity_with_limits() -> Sequence[Figure]:
    import inspect

    default = inspect.signature(a5.planar.dexterity).parameters["orientations"].default
    points, _, wrong = called_dexterous()
    return [Near(default), Near(points), Near(wrong)]


def turning_4r(links: np.ndarray, tip_distance: np.ndarray) -> np.ndarray:
    """Whether link 4 turns fully with the tip pinned: its wrist stays in the annulus of
    links 1 to 3.
    """
    first = links[:, :3]
    outer = first.sum(axis=1)
    inner = np.maximum(2 * first.max(axis=1) - outer, 0.0)
    angle = np.linspace(0, math.tau, 181)[:, None]
    x = tip_distance - links[:, 3] * np.cos(angle)
    y = -links[:, 3] * np.sin(angle)
    wrist = np.hypot(x, y)
    return np.asarray(((wrist <= outer + 1e-12) & (wrist >= inner - 1e-12)).all(axis=0))


@statement(
    DEXTERITY,
    "Of {} random 4R arms {} turn fully, and the theorem predicts none of them",
)
def four_joints() -> Sequence[Figure]:
    """Lengths uniform in 0 to 1, the tip at a distance uniform in the reach."""
    rng = np.random.default_rng(0)
    links = rng.uniform(0, 1, (20_000, 4))
    distance = rng.uniform(0, 1, 20_000) * links.sum(axis=1)
    turns = turning_4r(links, distance)
    half = (links.sum(axis=1) + distance) / 2
    others = np.column_stack([links[:, :3], distance])
    pairs = [
        others[:, list(pair)].sum(axis=1)
        for pair in itertools.combinations(range(4), 2)
    ]
    predicted = np.min(pairs, axis=0) >= half
    assert not predicted.any()
    exact = [
        a5.planar.turns_fully(a5.planar.PlanarArm(x), d)
        for x, d in zip(links[:400], distance[:400], strict=True)
    ]
    assert np.array_equal(exact, turns[:400])
    return [Near(len(links)), Near(int(turns.sum()))]


def test_the_example_of_four_joints() -> None:
    distances = np.linspace(0.0, 8.0, 801)
    assert turning_4r(np.tile([3.0, 3, 3, 1], (801, 1)), distances).all()
    assert not turning_4r(np.array([[3.0, 3, 3, 1]]), np.array([8.01])).any()


def test_approach_directions_are_circles_on_the_yaw_axis_and_four_at_most_off_it() -> (
    None
):
    """Every theta_0 of its range brings the tcp to the same point of the axis."""
    position = np.array([0.0, 0.0, 0.3])
    ways = a5.load().approach_directions(position)
    assert ways.any_azimuth
    solutions = a5.inverse_kinematics(position)
    for q, exists in zip(solutions.q, solutions.exists, strict=True):
        if exists:
            turned = np.tile(q, (9, 1))
            turned[:, 0] = np.linspace(LOWER[0], UPPER[0], 9)
            assert np.abs(tip(turned) - position).max() < 1e-12
    off = a5.load().approach_directions(tip(sample(300, 5)))
    assert off.directions.shape == (300, 4, 3)
    assert not off.any_azimuth.any()


# --- inertia -------------------------------------------------------------------------


@statement(
    "docs/concepts/inertia.md",
    "change, too, by up to {} % for the links of this arm",
)
def copied_products() -> Sequence[Figure]:
    changes = []
    for link in a5.parameters().links:
        right, copied = (
            np.linalg.eigvalsh(x) for x in (link.inertia, flip_products(link.inertia))
        )
        changes.append(np.abs(copied / right - 1).max())
    return [Near(100 * max(changes))]


def test_copied_products_are_no_mirror_image() -> None:
    """A mirror keeps the principal moments; a rod along (1, 1, 1) becomes a body that
    cannot be.
    """
    link = a5.parameters().links[3].inertia
    for axis in range(3):
        mirror = np.eye(3)
        mirror[axis, axis] = -1
        image = mirror @ link @ mirror
        assert (np.sign(image) != np.sign(link)).sum() == 4  # two products, each twice
        np.testing.assert_allclose(
            principal_moments(image), principal_moments(link), rtol=1e-12
        )
    rod = np.eye(3) - np.ones((3, 3)) / 3
    wrong = flip_products(rod)
    np.testing.assert_allclose(np.linalg.eigvalsh(rod), [0, 1, 1], atol=1e-12)
    np.testing.assert_allclose(
        np.linalg.eigvalsh(wrong), [1 / 3, 1 / 3, 4 / 3], atol=1e-12
    )
    assert principal_moments(second_moments(wrong))[0] == pytest.approx(-1 / 3)
    words = (
        "rod = np.eye(3) - np.ones((3, 3)) / 3  # principal moments 0, 1, 1 [kg m^2]"
    )
    assert Statement("docs/concepts/inertia.md", words, list).found()


# --- branches ------------------------------------------------------------------------


@statement(
    "docs/concepts/branches.md",
    "Each of {} random positions within the limits is among the solutions of its "
    "own tcp",
)
def branches() -> Sequence[Figure]:
    q = sample(200_000, seed=77)
    solutions = a5.inverse_kinematics(tip(q), q[:, 3])
    off = np.abs(solutions.q - q[:, None]).max(axis=-1)
    found = (np.where(solutions.within_limits, off, np.inf).min(axis=-1) < 1e-6).sum()
    return [Near(int(found))]


# --- the statements ------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("item", parameters_of(__name__))
def test_the_page_says_what_is_computed(item: Statement) -> None:
    item.check()


def test_a_wrong_number_is_seen() -> None:
    assert Near(9.77, 0.1).holds("9.8")
    assert not Near(8.9, 0.1).holds("9.8")
    assert Near(200_000).holds("200 000")
    assert not Near(199_999).holds("200 000")
    assert Near(0.3552).holds("0.36")
    assert not Near(0.342).holds("0.36")
    assert AtMost(1.9e-15).holds("2e-15")
    assert not AtMost(2.1e-15).holds("2e-15")
    wrong = Statement(
        ERRATA, "{} % is reached only where the arm touches itself", lambda: [Near(8.9)]
    )
    with pytest.raises(AssertionError, match=r"9\.1 for"):
        wrong.check()
    missing = Statement(ERRATA, "{} % is reached by nobody", lambda: [Near(9.8)])
    with pytest.raises(AssertionError, match="does not say"):
        missing.check()
