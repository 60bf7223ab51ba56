"""Self-collision of an arm of your own, against coal on bodies placed by hand."""

from __future__ import annotations

import dataclasses
import itertools
import math
from functools import partial

import coal
import numpy as np
import own_arm_dynamics as own
import pytest
from loops import each
from pinocchio_collision import CollisionModel, collision_geometry

import alpha5_model as a5
from alpha5_model._support.spatial import pose
from alpha5_model.collision.link_pairs import unchecked_pairs
from alpha5_model.errors import InputError
from alpha5_model.geometry.collision_shapes import collision_primitives
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

RECORDS = own.RECORDS
SAMPLE = [RECORDS[k] for k in (1, 2, 8, 9)]
every_record = each("record", SAMPLE)


def coal_shape(shape: Primitive) -> coal.CollisionGeometry:
    kinds = {"box": coal.Box, "cylinder": coal.Cylinder, "sphere": coal.Sphere}
    return kinds[shape.kind](*shape.size)


def closed_finger(record: Alpha5Parameters, side: int) -> np.ndarray:
    """Pose of a finger's frame in link_4, with the spacer, (4, 4)."""
    jaws = record.jaws
    at = np.eye(4)
    at[:3, :3] = [[1, 0, 0], [0, 0, -side], [0, side, 0]]
    depth = jaws.collar_base + jaws.pivot_height + record.spacer
    at[:3, 3] = (side * jaws.pivot_offset, 0.0, -depth)
    return at


def bodies(record: Alpha5Parameters) -> dict[str, list[tuple[Primitive, np.ndarray]]]:
    """The shapes of each link and their poses in it, jaws closed."""
    shapes = collision_primitives("jaws")
    found = {}
    for i in range(5):
        name = f"link_{i}"
        found[name] = [(one, pose(one.xyz, one.rpy)) for one in shapes[name]]
    for finger, side in (("finger_1", -1), ("finger_2", 1)):
        for one in shapes[finger]:
            at = closed_finger(record, side) @ pose(one.xyz, one.rpy)
            found["link_4"].append((one, at))
    return found


def least_distance(record: Alpha5Parameters, q: np.ndarray) -> float:
    rotations, origins = own.link_frames(record, q[None])
    frames = {}
    for i in range(5):
        frames[f"link_{i}"] = at = np.eye(4)
        at[:3, :3], at[:3, 3] = rotations[i, 0], origins[i, 0]
    left_out = {
        frozenset(pair) for pairs in unchecked_pairs(record).values() for pair in pairs
    }
    least = math.inf
    of_links = bodies(record)
    for one, other in itertools.combinations(of_links, 2):
        if frozenset((one, other)) in left_out:
            continue
        for a, b in itertools.product(of_links[one], of_links[other]):
            least = min(least, distance(frames[one] @ a[1], a[0], frames[other], b))
    return least


def distance(
    at: np.ndarray,
    shape: Primitive,
    frame: np.ndarray,
    other: tuple[Primitive, np.ndarray],
) -> float:
    there = frame @ other[1]
    result = coal.DistanceResult()
    return float(
        coal.distance(
            coal_shape(shape),
            coal.Transform3s(at[:3, :3], at[:3, 3]),
            coal_shape(other[0]),
            coal.Transform3s(there[:3, :3], there[:3, 3]),
            coal.DistanceRequest(),
            result,
        )
    )


@every_record
def test_distances_are_those_of_bodies_placed_by_hand(record: Alpha5Parameters) -> None:
    arm = a5.load(arm=record)
    jaws = a5.load(arm=record, gripper="jaws")
    for q in own.states(record, 6)[0]:
        expected = least_distance(record, q)
        assert arm.collision_distance(q) == pytest.approx(expected, abs=2e-6)
        assert arm.in_collision(q) == (expected <= 0)
        closed = np.append(q, record.joints[4].lower)
        assert jaws.collision_distance(closed) == pytest.approx(expected, abs=2e-6)


def test_some_of_them_touch_themselves() -> None:
    """The sample above holds both kinds."""
    hits = [
        a5.load(arm=record).in_collision(q)
        for record in SAMPLE
        for q in own.states(record, 6)[0]
    ]
    assert 0 < sum(hits) < len(hits)


def test_with_a_spacer_the_fingers_reach_the_base() -> None:
    longer = dataclasses.replace(parameters(), attached=RECORDS[1].attached)
    q = np.array([3.13, 2.7, 0.22, 4.4])
    assert not a5.load().in_collision(q)
    arm = a5.load(arm=longer)
    assert arm.in_collision(q)
    assert arm.collision_distance(q) == pytest.approx(
        least_distance(longer, q), abs=2e-6
    )
    (pair,) = CollisionModel(arm.model, longer).colliding_links(q)
    assert pair == ("link_0", "link_4")


@pytest.mark.parametrize("seed", [1, 2])
def test_without_self_collision_is_of_the_record(seed: int) -> None:
    record = RECORDS[seed]
    arm = a5.load(arm=record)
    q = own.states(record, 60)[0]
    wrist = record.joints[3]
    free = a5.without_self_collision(q, arm=record)
    for row, answer in zip(q, free, strict=True):
        turned = np.tile(row, (26, 1))
        turned[1:, 3] = np.linspace(wrist.lower, wrist.upper, 25)
        assert answer == any(not arm.in_collision(each) for each in turned)
    assert 0 < free.sum() < 60


def test_reach_without_self_collision_of_an_arm_with_its_tool_on_the_axis() -> None:
    record = RECORDS[1]
    accept = partial(a5.without_self_collision, arm=record)
    q = own.states(record, 80)[0]
    points = np.array([own.tcp(record, each)[:3, 3] for each in q])
    reached = a5.reachable(points, accept=accept, arm=record)
    free = a5.without_self_collision(q, arm=record)
    assert reached[free].all()
    assert not reached.all()


def test_the_same_lengths_have_the_catalogues_pairs() -> None:
    heavier = dataclasses.replace(parameters(), links=RECORDS[2].links)
    model = a5.load().model
    ours = collision_geometry(model)
    theirs = collision_geometry(a5.load(arm=heavier).model, heavier)
    assert len(theirs.collisionPairs) == len(ours.collisionPairs)
    far = collision_geometry(a5.load(arm=RECORDS[2]).model, RECORDS[2])
    # Links 1 and 3 are checked for other lengths.
    shapes = collision_primitives("locked")
    added = len(shapes["link_1"]) * len(shapes["link_3"])
    assert len(far.collisionPairs) == len(ours.collisionPairs) + added


def test_a_model_of_another_arm_is_refused() -> None:
    model = a5.load(arm=RECORDS[2]).model
    with pytest.raises(InputError, match="the dimensions of Table 1"):
        CollisionModel(model)
    with pytest.raises(InputError, match="the dimensions of its record"):
        CollisionModel(model, RECORDS[4])
    with pytest.raises(InputError, match="expected an Alpha5Parameters"):
        CollisionModel(model, "my_arm.toml")  # type: ignore[arg-type]
