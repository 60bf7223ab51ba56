"""Which shapes can ever touch: the list, its proof, the bounds, and brute force."""

from __future__ import annotations

import dataclasses
import itertools
import math
import tomllib
from typing import Any

import coal
import numpy as np
import pinocchio as pin
import pytest
from coal_reference import BEYOND_LIMITS, CoalReference
from own_arm import random_arm, within
from own_shapes_urdf import urdf_with_own_shapes
from reference import LOWER, UPPER

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, URDF_PATH
from alpha5_model._support.spatial import pose
from alpha5_model.collision import disabled_pairs as disabled
from alpha5_model.collision import touching_proof
from alpha5_model.collision.bodies import (
    body_poses,
    collision_bodies,
    joint_ranges,
)
from alpha5_model.collision.distance_bounds import Cells, PairDistances
from alpha5_model.collision.link_chain import BodyPair, body_pair
from alpha5_model.collision.link_pairs import NEVER_PAIRS, NEVER_WITHIN_LIMITS
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.collision.subdivision import Proof, prove
from alpha5_model.collision.touching_pairs import (
    made_for,
    touching_links,
    touching_pairs,
)
from alpha5_model.errors import UnknownNameError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

#: coal's distances are right to this [m].
COAL = 1e-6
GRIPPERS = ("locked", "jaws")
#: Gripper and links whose proof is quick.
QUICK = [
    ("locked", "link_0", "link_2"),
    ("locked", "link_0", "link_3"),
    ("locked", "link_1", "link_3"),
    ("locked", "link_1", "link_4"),
    ("locked", "link_2", "link_4"),
    ("jaws", "link_0", "link_4"),
    ("jaws", "link_1", "link_4"),
    ("jaws", "link_2", "finger_1"),
    ("jaws", "link_3", "finger_2"),
]


def pair_of(gripper: str, *links: str, arm: Alpha5Parameters | None = None) -> BodyPair:
    record = arm or parameters()
    bodies = collision_bodies(record, gripper)
    one, other = (bodies.names.index(name) for name in links)
    return body_pair(bodies, joint_ranges(record, gripper), (one, other))


def listed(gripper: str, *links: str) -> set[tuple[int, int]]:
    """Numbers of two links' shapes that the committed list has."""
    return {
        (pair.first.number, pair.second.number)
        for pair in touching_pairs(gripper)
        if (pair.first.link, pair.second.link) == links
    }


def solid(shape: Primitive) -> coal.CollisionGeometry:
    kind = coal.Box if shape.kind == "box" else coal.Cylinder
    return kind(*shape.size)


def shape_distance(
    arm: Alpha5Parameters,
    gripper: str,
    angles: np.ndarray,
    first: tuple[str, int],
    second: tuple[str, int],
) -> float:
    """coal's distance of two shapes of an arm at angles of all bodies but the first."""
    bodies = collision_bodies(arm, gripper)
    poses = body_poses(bodies, angles)
    placed = []
    for link, number in (first, second):
        body = bodies.names.index(link)
        shape = bodies.bodies[body].shapes[number]
        at = poses[body] @ pose(shape.xyz, shape.rpy)
        placed += [solid(shape), coal.Transform3s(at[:3, :3], at[:3, 3])]
    result = coal.DistanceResult()
    return float(coal.distance(*placed, coal.DistanceRequest(), result))


class UrdfShapes:
    """A URDF with the package's shapes, whose fingers turn on their own."""

    def __init__(self, gripper: str) -> None:
        path = JAWS_URDF_PATH if gripper == "jaws" else URDF_PATH
        self.model = pin.buildModelFromUrdf(str(path))
        self.geometry = pin.buildGeomFromUrdfString(
            self.model, urdf_with_own_shapes(gripper), pin.GeometryType.COLLISION
        )
        self.data = self.model.createData()
        self.numbers: dict[str, list[int]] = {}
        for number, body in enumerate(self.geometry.geometryObjects):
            link = self.model.frames[body.parentFrame].name
            self.numbers.setdefault(link, []).append(number)

    def distance(
        self, q: np.ndarray, first: tuple[str, int], second: tuple[str, int]
    ) -> float:
        pair = [self.numbers[link][number] for link, number in (first, second)]
        self.geometry.removeAllCollisionPairs()
        self.geometry.addCollisionPair(pin.CollisionPair(*pair))
        objects = self.geometry.createData()
        pin.updateGeometryPlacements(self.model, self.data, self.geometry, objects, q)
        return float(pin.computeDistance(self.geometry, objects, 0).min_distance)


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_every_pair_of_the_list_touches_within_the_limits(gripper: str) -> None:
    """By Pinocchio on a URDF with these shapes, at the angles that the list has."""
    urdf = UrdfShapes(gripper)
    limits = (urdf.model.lowerPositionLimit, urdf.model.upperPositionLimit)
    names = ["axis_e", "axis_d", "axis_c", "axis_b"]
    for pair in touching_pairs(gripper):
        finger = pair.second.link.startswith("finger")
        last = [f"{pair.second.link}_joint"] if finger else []
        behind = 0 if finger else int(pair.second.link[-1])
        between = names[int(pair.first.link[-1]) : behind or 4] + last
        assert len(pair.angles) == len(between)
        q = pin.neutral(urdf.model)
        for name, angle in zip(between, pair.angles, strict=True):
            q[urdf.model.joints[urdf.model.getJointId(name)].idx_q] = angle
            place = urdf.model.joints[urdf.model.getJointId(name)].idx_q
            assert limits[0][place] - 1e-6 <= angle <= limits[1][place] + 1e-6
        assert urdf.distance(q, pair.first, pair.second) < COAL


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_no_other_pair_touches_at_random_and_in_corners(gripper: str) -> None:
    reference = CoalReference(gripper)
    of_link: dict[str, list[int]] = {}
    for number, body in enumerate(reference._geometry.geometryObjects):
        link = reference.model.frames[body.parentFrame].name
        of_link.setdefault(link, []).append(number)
    known = {
        frozenset(
            of_link[shape.link][shape.number] for shape in (pair.first, pair.second)
        )
        for pair in touching_pairs(gripper)
    }
    limits = a5.load(gripper=gripper).limits
    rng = np.random.default_rng(30)
    q = rng.uniform(limits.lower, limits.upper, (200, len(limits.lower)))
    q[::2, 1] = rng.choice([LOWER[1], UPPER[1]], 100)
    q[::3, 2] = LOWER[2]
    pairs = [frozenset((p.first, p.second)) for p in reference._geometry.collisionPairs]
    seen = set()
    for row in q:
        reference._nearest(row)
        for pair, result in zip(pairs, reference._objects.distanceResults, strict=True):
            if result.min_distance < -COAL:
                seen.add(pair)
    assert seen <= known
    assert len(seen) > 0.3 * len(known)


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_the_list_is_of_todays_bodies_and_limits(gripper: str) -> None:
    arm = parameters()
    assert made_for(gripper) == touching_proof.ranged_digest(arm, gripper)
    wider = dataclasses.replace(arm.joints[2], lower=0.0)
    other = dataclasses.replace(arm, joints=(*arm.joints[:2], wider, *arm.joints[3:]))
    assert made_for(gripper) != touching_proof.ranged_digest(other, gripper)
    with pytest.raises(UnknownNameError):
        touching_pairs("open")


@pytest.mark.parametrize("gripper", GRIPPERS)
def test_links_that_are_not_in_the_list_never_meet(gripper: str) -> None:
    bodies = collision_bodies(parameters(), gripper)
    apart = {
        (bodies.names[one], bodies.names[other])
        for one, other in touching_proof.pairs_apart(bodies)
    }
    never = {*NEVER_PAIRS, *NEVER_WITHIN_LIMITS[gripper]} & apart
    assert apart - touching_links(gripper) == never
    assert never.isdisjoint(touching_links(gripper))
    assert set(BEYOND_LIMITS[gripper]) == set(NEVER_WITHIN_LIMITS[gripper])


@pytest.mark.slow
@pytest.mark.parametrize(("gripper", "one", "other"), QUICK)
def test_the_proof_gives_the_list_again(gripper: str, one: str, other: str) -> None:
    proof = prove(pair_of(gripper, one, other))
    assert proof.undecided == ()
    assert set(proof.witnesses) == listed(gripper, one, other)
    assert proof.never == ((one, other) not in touching_links(gripper))
    # The file has the same pairs.
    rows = touching_proof._rows(proof)
    assert len(rows) == (len(proof.witnesses) + 2 if proof.witnesses else 0)


@pytest.mark.slow
def test_the_text_of_the_list_is_read_as_its_proofs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of quick proofs, each with its links, shapes and angles to a microradian."""
    arm = parameters()
    of_gripper = {
        gripper: [prove(pair_of(*pair)) for pair in QUICK if pair[0] == gripper]
        for gripper in GRIPPERS
    }
    monkeypatch.setattr(
        touching_proof, "prove_all", lambda arm, gripper: of_gripper[gripper]
    )
    text = touching_proof.touching_text(arm, GRIPPERS)
    assert text.startswith("# Pairs of collision shapes that can ever touch")
    written = tomllib.loads(text)
    assert list(written) == ["locked", "jaws"]
    for gripper, proofs in of_gripper.items():
        assert written[gripper].pop("made_for") == made_for(gripper)
        rows = {
            (first, second): rows
            for first, others in written[gripper].items()
            for second, rows in others.items()
        }
        touching = {proof.bodies.names: proof for proof in proofs if proof.witnesses}
        assert list(rows) == list(touching)
        for links, proof in touching.items():
            expected = [
                [*pair, *np.round(q, 6)] for pair, q in sorted(proof.witnesses.items())
            ]
            assert rows[links] == expected


@pytest.mark.slow
def test_every_two_links_that_are_not_neighbours_are_proved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(touching_proof, "prove", lambda pair: pair.names)
    links = [f"link_{number}" for number in range(5)]
    apart = [
        (one, other)
        for one, other in itertools.combinations(links, 2)
        if int(other[-1]) - int(one[-1]) > 1
    ]
    proved: dict[str, Any] = {
        gripper: touching_proof.prove_all(parameters(), gripper) for gripper in GRIPPERS
    }
    assert proved["locked"] == apart
    fingers = [
        (link, finger) for link in links[:4] for finger in ("finger_1", "finger_2")
    ]
    assert sorted(proved["jaws"]) == sorted(apart + fingers)


def test_links_held_apart_by_length_are_so_at_any_angle() -> None:
    """`NEVER_PAIRS` are 40 mm apart all the way round, at any opening of the jaws."""
    lower, upper = joint_ranges(parameters(), "jaws")
    lower[:4] = -math.pi
    upper[:4] = math.pi
    bodies = collision_bodies(parameters(), "jaws")
    for links in NEVER_PAIRS:
        one, other = (bodies.names.index(name) for name in links)
        assert prove(body_pair(bodies, (lower, upper), (one, other)), margin=0.04).never


def test_a_margin_counts_as_touching() -> None:
    """How near links come that never touch, from both sides."""
    pair = pair_of("locked", "link_2", "link_4")
    nearest = prove(pair).nearest
    assert 0.0 < nearest < 1e-3
    assert prove(pair, margin=nearest + 1e-5).witnesses
    wide = pair_of("locked", "link_1", "link_3")
    assert prove(wide, margin=0.08).never
    # Links 0 and 3 come as near, by the distance of the exact test.
    pair = pair_of("locked", "link_0", "link_3")
    assert 0.0 < prove(pair).nearest < 1e-3


def test_a_proof_that_runs_out_of_effort_says_so() -> None:
    pair = pair_of("locked", "link_0", "link_2")
    short = prove(pair, effort=500)
    assert short.undecided
    assert not short.never
    first = prove(pair, until_contact=True)
    assert len(first.witnesses) >= 1
    assert first.undecided
    assert not first.never
    with pytest.raises(ArithmeticError, match="link_0, link_2: undecided"):
        touching_proof._rows(short)


@pytest.mark.slow
@pytest.mark.parametrize("constant", ["rates", "second_radii"])
def test_a_wrong_constant_is_noticed(constant: str) -> None:
    """With constants too small, pairs seem proven that the list knows to touch."""
    pair = pair_of("locked", "link_1", "link_4")
    small = {constant: 0.05 * getattr(pair, constant)}
    if constant == "second_radii":
        # The third bound decides alone.
        small["rates"] = 20.0 * pair.rates
    wrong = prove(dataclasses.replace(pair, **small), effort=300_000)
    missed = listed("locked", "link_1", "link_4") - set(wrong.witnesses)
    assert missed - set(wrong.undecided), "pairs that touch were given up"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gripper", "links"),
    [("locked", ("link_0", "link_4")), ("jaws", ("link_1", "finger_2"))],
)
def test_no_distance_changes_faster_than_its_constant(
    gripper: str, links: tuple[str, str]
) -> None:
    """Each joint alone, by coal's distances of random pairs of shapes."""
    pair = pair_of(gripper, *links)
    distances = PairDistances(pair)
    rng = np.random.default_rng(31)
    n = 2500
    first = rng.integers(len(pair.first.half), size=n)
    second = rng.integers(len(pair.second.half), size=n)
    largest = np.zeros(len(pair.joints))
    for joint in range(len(pair.joints)):
        before = rng.uniform(pair.lower, pair.upper, (n, len(pair.joints)))
        after = before.copy()
        after[:, joint] += rng.uniform(0.001, 0.05, n)
        there = [
            distances.of_coal(
                distances.placed(distances.frames(q)[:, -1], first, second)
            )[0]
            for q in (before, after)
        ]
        apart = np.minimum(*there) > 0.0
        change = np.abs(there[1] - there[0])[apart]
        turn = (after - before)[apart, joint]
        most = pair.rates[first, second, joint][apart] * turn
        assert (change <= most + 2 * COAL).all()
        assert (change > 0.5 * most + 2 * COAL).any() or (most == 0.0).all()
        largest[joint] = (change / np.maximum(most, 1e-9)).max()
    assert largest.max() > 0.8, "with 0.8 of the constant the test above would fail"


@pytest.mark.slow
def test_the_bounds_hold_in_all_of_a_cell() -> None:
    """All three lower bounds, against coal at random places of random cells."""
    pair = pair_of("locked", "link_0", "link_4")
    distances = PairDistances(pair)
    rng = np.random.default_rng(32)
    n, each = 300, 12
    first = rng.integers(len(pair.first.half), size=n)
    second = rng.integers(len(pair.second.half), size=n)
    centre = rng.uniform(pair.lower, pair.upper, (n, 4))
    half = rng.uniform(0.0, 0.15, (n, 4))
    frames = distances.frames(centre)
    placed = distances.placed(frames[:, -1], first, second)
    at_centre, between = distances.of_coal(placed)
    reach = np.einsum("ij,ij->i", pair.rates[first, second], half)
    bounds = [
        distances.of_boxes(placed) - reach,
        at_centre - reach,
        distances.by_taylor(placed, frames, half, between),
        distances.by_taylor(placed, frames, half, rng.normal(size=(n, 3))),
    ]
    least = np.full(n, np.inf)
    for _ in range(each):
        corner = rng.choice([-1.0, 1.0], (n, 4)) * rng.uniform(0.8, 1.0, (n, 1))
        q = centre + half * corner
        there = distances.placed(distances.frames(q)[:, -1], first, second)
        least = np.minimum(least, distances.of_coal(there)[0])
    apart = least > 0.0
    for bound in bounds:
        assert (bound <= least + COAL)[apart].all()
        assert (bound[~apart] <= COAL).all()
    # Taylor's bound is the sharpest one of small cells.
    assert np.median((bounds[2] - bounds[1])[apart]) > 0.0
    assert np.median((least - bounds[2])[apart]) < 0.02


def test_shapes_at_the_same_place_have_a_bound() -> None:
    """Where nearest points coincide any direction will do."""
    pair = pair_of("locked", "link_0", "link_2")
    distances = PairDistances(pair)
    centre = np.array([[3.0, 0.1]])
    frames = distances.frames(centre)
    zero = np.zeros(1, np.intp)
    placed = distances.placed(frames[:, -1], zero, zero)
    bound = distances.by_taylor(placed, frames, np.full((1, 2), 0.01), np.zeros((1, 3)))
    assert np.isfinite(bound).all()


def test_cells_are_halved_until_they_are_small() -> None:
    """Halving keeps the box: the halves fill it without overlap."""
    from alpha5_model.collision.subdivision import _Search

    search = _Search(pair_of("locked", "link_0", "link_2"), margin=0.0)
    volume = np.prod(2 * search._cells.half)
    for _ in range(4):
        search.halve()
    cells: Cells = search._cells
    assert len(cells.centre) == 16
    assert np.prod(2 * cells.half, axis=1).sum() == pytest.approx(volume)
    low, high = cells.centre - cells.half, cells.centre + cells.half
    assert low.min(axis=0) == pytest.approx(LOWER[:2])
    assert high.max(axis=0) == pytest.approx(UPPER[:2])
    for i, j in itertools.combinations(range(16), 2):
        overlap = np.minimum(high[i], high[j]) - np.maximum(low[i], low[j])
        assert overlap.min() < 1e-12


def own_arm_with(**limits: tuple[float, float]) -> Alpha5Parameters:
    """The catalogue's arm with other limits of some joints."""
    arm = parameters()
    joints = [
        dataclasses.replace(
            joint, lower=limits[joint.name][0], upper=limits[joint.name][1]
        )
        if joint.name in limits
        else joint
        for joint in arm.joints
    ]
    return dataclasses.replace(arm, joints=tuple(joints))


def test_narrower_limits_need_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise AssertionError("a proof")

    monkeypatch.setattr(touching_proof, "never_within_limits", refuse)
    narrow = own_arm_with(axis_c=(0.5, 2.0))
    for gripper in GRIPPERS:
        pairs = disabled.disabled_pairs(narrow, gripper)
        assert pairs == disabled.disabled_pairs(parameters(), gripper)
        assert set(NEVER_WITHIN_LIMITS[gripper]) <= set(pairs["Never"])


def test_wider_limits_bring_links_2_and_4_together() -> None:
    wide = own_arm_with(axis_c=(-0.2, UPPER[2]))
    assert ("link_2", "link_4") not in disabled.disabled_pairs(wide, "locked")["Never"]
    proof: Proof = prove(pair_of("locked", "link_2", "link_4", arm=wide))
    (one, other), angles = next(iter(proof.witnesses.items()))
    q = np.array([0.0, 0.0, *angles])
    there = shape_distance(wide, "locked", q, ("link_2", one), ("link_4", other))
    assert there <= 0.0
    # Beyond the catalogue's own limits the package answers for these links, too.
    assert ("link_2", "link_4") in disabled.disabled_pairs(parameters(), "locked")[
        "Never"
    ]
    q[:2] = [3.0, 1.6]
    contact = self_collision(parameters()).nearest(q)
    assert contact.distance <= 0.0
    assert self_collision(parameters()).links(contact) == ("link_2", "link_4")


@pytest.mark.parametrize("seed", range(2))
def test_never_of_random_arms_by_brute_force(seed: int) -> None:
    """No random position touches what is left out, and something else does."""
    record = random_arm(np.random.default_rng(seed), off_axis=False)
    never = set(disabled.disabled_pairs(record, "locked")["Never"])
    scene = self_collision(record)
    bodies = scene.bodies
    q = within(record, 600, seed)
    corners = itertools.product(*[(j.lower, j.upper) for j in record.joints[:4]])
    q = np.concatenate([q, np.array(list(corners))])
    for number, pair in enumerate(bodies.pairs):
        links = (bodies.names[pair[0]], bodies.names[pair[1]])
        if links in never:
            alone = dataclasses.replace(bodies, pairs=(bodies.pairs[number],))
            assert not type(scene)(alone).touches(q).any()
    assert scene.touches(q).any()
