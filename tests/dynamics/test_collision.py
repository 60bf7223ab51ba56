"""Collision bodies enclose the drawn ones closely and find collisions rightly.

Here, distances to the primitives follow from their definition. Distances between bodies
are manifold3d's on the drawn surfaces, which the package's route by coal never sees.
"""

from __future__ import annotations

import csv
import itertools
import math
import pickle
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from coal_reference import without_pair
from drawn_bodies import BODIES, LINKS, MESHES, Mesh, finger_pose, link_poses, placed
from loops import each
from own_shapes_urdf import urdf_with_own_shapes
from pinocchio_collision import CollisionModel, collision_geometry
from reference import LOWER, UPPER
from shared_recordings import JOINT_STATES, needs_recordings

import alpha5_model as a5
from alpha5_model._support.paths import JAWS_URDF_PATH, REPOSITORY_PATH, URDF_PATH
from alpha5_model.collision.link_pairs import (
    ADJACENT_PAIRS,
    CLOSING_PAIRS,
    NEVER_PAIRS,
    NEVER_WITHIN_LIMITS,
)
from alpha5_model.description.srdf import NAMED_POSES, named_pose, srdf
from alpha5_model.errors import NonFiniteError, ShapeError, UnknownNameError
from alpha5_model.geometry.collision_shapes import (
    collision_primitives,
    exported_primitives,
)

RNG_SEED = 5


@pytest.fixture(scope="module")
def model():
    return pin.buildModelFromUrdf(URDF_PATH)


@pytest.fixture(scope="module")
def collisions(model):
    return CollisionModel(model)


@pytest.fixture(scope="module")
def meshes():
    return {name: Mesh((MESHES / f"{name}.obj").read_text("ascii")) for name in BODIES}


def rotation(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """URDF's fixed-axis angles, one elementary rotation after the other."""

    def turn(axis: int, angle: float) -> np.ndarray:
        out = np.eye(3)
        i, j = ((axis + 1) % 3, (axis + 2) % 3)
        out[i, i] = out[j, j] = math.cos(angle)
        out[j, i] = math.sin(angle)
        out[i, j] = -math.sin(angle)
        return out

    return turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)


def signed_distance(shape, points: np.ndarray) -> np.ndarray:
    """Distance of points (n, 3) to a primitive, negative inside [m]."""
    local = (points - shape.xyz) @ rotation(*shape.rpy)
    if shape.kind == "box":
        beyond = np.abs(local) - np.array(shape.size) / 2
    else:
        radius, length = shape.size
        beyond_side = np.hypot(local[:, 0], local[:, 1]) - radius
        beyond_end = np.abs(local[:, 2]) - length / 2
        beyond = np.column_stack([beyond_side, beyond_end])
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return outside + np.minimum(beyond.max(1), 0)


def samples(corners: np.ndarray, count: int, rng) -> np.ndarray:
    """Points on triangles (m, 3, 3), uniform by area."""
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    chosen = corners[rng.choice(len(corners), count, p=area / area.sum())]
    weights = rng.dirichlet((1, 1, 1), count)
    return np.einsum("nc,ncx->nx", weights, chosen)


def surface_points(shape, count: int, rng) -> np.ndarray:
    """Points on a primitive, its edges and corners included."""
    if shape.kind == "box":
        unit = rng.uniform(-1, 1, (count, 3))
        # Faces, edges and corners.
        for pins in (1, 2, 3):
            rows = slice((pins - 1) * count // 3, pins * count // 3)
            for row in unit[rows]:
                axes = rng.permutation(3)[:pins]
                row[axes] = np.sign(row[axes])
        local = unit * np.array(shape.size) / 2
    else:
        radius, length = shape.size
        angle = rng.uniform(0, 2 * math.pi, count)
        height = rng.uniform(-1, 1, count)
        r = np.full(count, radius)
        height[::2] = np.sign(height[::2])
        r[::4] *= np.sqrt(rng.uniform(0, 1, len(r[::4])))
        local = np.column_stack(
            [r * np.cos(angle), r * np.sin(angle), height * length / 2]
        )
    return local @ rotation(*shape.rpy).T + shape.xyz


@pytest.mark.slow
@pytest.mark.parametrize("name", BODIES)
def test_primitives_enclose_the_drawn_body(meshes, name):
    rng = np.random.default_rng(RNG_SEED)
    points = np.vstack([meshes[name].v, samples(meshes[name].corners, 20_000, rng)])
    shapes = collision_primitives()[name]
    assert np.min([signed_distance(s, points) for s in shapes], axis=0).max() < 1e-6
    # Each of them is needed: without it something sticks out.
    for left_out in range(len(shapes)):
        rest = [s for i, s in enumerate(shapes) if i != left_out]
        if rest:
            assert (
                np.min([signed_distance(s, points) for s in rest], axis=0).max() > 1e-4
            )


@pytest.mark.slow
@each("name", BODIES)
def test_primitives_stay_within_three_millimetres_of_the_outside(name):
    """The outside is the drawn body with its recesses, slots and shaft holes closed."""
    pytest.importorskip("manifold3d")
    import trimesh
    from meshes.drawing import bodies
    from meshes.triangles import surface

    outside = surface(bodies()[name].outside)
    mesh = trimesh.Trimesh(outside.vertices, outside.faces, process=False)
    rng = np.random.default_rng(RNG_SEED)
    shapes = collision_primitives()[name]
    points = np.vstack([surface_points(shape, 300, rng) for shape in shapes])
    exposed = np.min([signed_distance(s, points) for s in shapes], axis=0) > -1e-6
    excess = -trimesh.proximity.signed_distance(mesh, points[exposed])
    assert exposed.sum() > 100
    assert excess.max() < 3e-3


@pytest.mark.parametrize(
    ("path", "gripper"), [(URDF_PATH, "locked"), (JAWS_URDF_PATH, "jaws")]
)
def test_urdf_carries_the_primitives(path, gripper):
    """The fewer ones that other programs get."""
    root = ET.parse(path).getroot()
    wanted = exported_primitives(gripper)
    found = {link.get("name"): link.findall("collision") for link in root.iter("link")}
    assert {name for name, elements in found.items() if elements} == set(wanted)
    for name, shapes in wanted.items():
        assert len(found[name]) == len(shapes)
        for element, shape in zip(found[name], shapes, strict=True):
            origin = element.find("origin")
            (body,) = element.find("geometry")
            assert body.tag == shape.kind
            names = {
                "box": ["size"],
                "cylinder": ["radius", "length"],
                "sphere": ["radius"],
            }
            texts = [body.get(name) for name in names[body.tag]]
            size = [float(x) for text in texts for x in text.split()]
            assert size == list(shape.size)
            assert [float(x) for x in origin.get("xyz").split()] == list(shape.xyz)
            assert [float(x) for x in origin.get("rpy").split()] == list(shape.rpy)


def test_locked_is_the_jaws_closed():
    """The fingers' primitives at their closed poses, in link_4."""
    rng = np.random.default_rng(RNG_SEED)
    jaws = collision_primitives("jaws")
    locked = collision_primitives("locked")
    assert set(jaws) - set(locked) == {"finger_1", "finger_2"}
    points = rng.uniform((-0.03, -0.02, -0.23), (0.03, 0.02, -0.03), (4000, 3))
    distance = [signed_distance(s, points) for s in jaws["link_4"]]
    for name in ("finger_1", "finger_2"):
        pose = finger_pose(name)
        local = (points - pose[:3, 3]) @ pose[:3, :3]
        distance += [signed_distance(s, local) for s in jaws[name]]
    direct = np.min([signed_distance(s, points) for s in locked["link_4"]], axis=0)
    assert direct == pytest.approx(np.min(distance, axis=0), abs=1e-8)
    with pytest.raises(UnknownNameError, match="locked, jaws"):
        collision_primitives("open")


@pytest.mark.parametrize(
    ("path", "gripper", "file"),
    [
        (URDF_PATH, "locked", "alpha5.srdf"),
        (JAWS_URDF_PATH, "jaws", "alpha5_jaws.srdf"),
    ],
)
def test_srdf_leaves_the_packages_pairs_that_meet_within_the_limits(
    path, gripper, file
):
    """Pinocchio's pairs of the URDF, without those of the SRDF."""
    srdf_path = Path(REPOSITORY_PATH) / "urdf" / file
    assert srdf_path.read_text("utf-8") == srdf(gripper)
    model = pin.buildModelFromUrdf(path)
    geometry = pin.buildGeomFromUrdf(
        model, path, pin.GeometryType.COLLISION, package_dirs=[str(Path(path).parent)]
    )
    geometry.addAllCollisionPairs()
    pin.removeCollisionPairs(model, geometry, str(srdf_path))
    pairs = set(_link_pairs(model, collision_geometry(model)))
    for links in NEVER_WITHIN_LIMITS[gripper]:
        pairs.remove(frozenset(links))
    assert set(_link_pairs(model, geometry)) == pairs
    pin.loadReferenceConfigurations(model, str(srdf_path))
    for name, q in NAMED_POSES.items():
        assert model.referenceConfigurations[name][:4] == pytest.approx(q, abs=0)
    named = {link.get("name") for link in ET.parse(path).getroot().iter("link")}
    for element in ET.fromstring(srdf(gripper)).iter("disable_collisions"):
        assert {element.get("link1"), element.get("link2")} <= named


def _link_pairs(model, geometry) -> dict[frozenset[str], int]:
    counts: dict[frozenset[str], int] = {}
    for pair in geometry.collisionPairs:
        names = frozenset(
            model.frames[geometry.geometryObjects[i].parentFrame].name
            for i in (pair.first, pair.second)
        )
        if len(names) == 2:
            counts[names] = counts.get(names, 0) + 1
    return counts


@pytest.mark.parametrize(
    ("path", "gripper"), [(URDF_PATH, "locked"), (JAWS_URDF_PATH, "jaws")]
)
def test_every_pair_of_links_is_checked_but_neighbours_and_those_that_cannot_meet(
    path, gripper
):
    model = pin.buildModelFromUrdf(path)
    left_out = {
        frozenset(pair) for pair in (*ADJACENT_PAIRS, *CLOSING_PAIRS, *NEVER_PAIRS)
    }
    shapes = collision_primitives(gripper)
    expected = {
        frozenset((one, other)): len(shapes[one]) * len(shapes[other])
        for one, other in itertools.combinations(shapes, 2)
        if frozenset((one, other)) not in left_out
    }
    assert _link_pairs(model, collision_geometry(model)) == expected


def test_urdf_route_and_package_agree_on_distances(model, collisions):
    """Pinocchio on a URDF with the package's shapes, from a fresh start each time."""
    geometry = pin.buildGeomFromUrdfString(
        model, urdf_with_own_shapes(), pin.GeometryType.COLLISION
    )
    geometry.addAllCollisionPairs()
    text = Path(REPOSITORY_PATH, "urdf", "alpha5.srdf").read_text("utf-8")
    for links in NEVER_WITHIN_LIMITS["locked"]:
        text = without_pair(text, *links)
    pin.removeCollisionPairsFromXML(model, geometry, text)
    data = model.createData()
    rng = np.random.default_rng(RNG_SEED)
    folded = rng.uniform((0.02, 0.02, 0.02, 0), (0.6, 0.7, 1.5, 6.2), (20, 4))
    hits = 0
    for q in np.vstack([rng.uniform(LOWER, UPPER, (20, 4)), folded]):
        scratch = geometry.createData()
        index = pin.computeDistances(model, data, geometry, scratch, q)
        distance = collisions.clearance(q).distance
        assert distance == pytest.approx(
            scratch.distanceResults[index].min_distance, abs=2e-6
        )
        hit = pin.computeCollisions(model, data, geometry, scratch, q, True)
        assert (
            hit == collisions.in_collision(q) == (collisions.colliding_links(q) != ())
        )
        hits += hit
    assert 5 < hits < 35, "the sample must hold both kinds"


@pytest.mark.parametrize("name", NAMED_POSES)
def test_named_poses_are_free_and_within_the_limits(collisions, name):
    q = named_pose(name)
    assert np.all(q >= LOWER)
    assert np.all(q <= UPPER)
    assert not collisions.in_collision(q)
    assert collisions.colliding_links(q) == ()
    assert collisions.clearance(q).distance > 5e-4


def test_named_poses_look_as_described():
    """Folded, level and stretched, from the document's kinematics alone."""
    poses = {name: link_poses(np.array(q)) for name, q in NAMED_POSES.items()}
    tips = {name: pose["link_4"] @ [0, 0, -0.18, 1] for name, pose in poses.items()}
    assert tips["stow"][0] < 0.12, "folded in front of the base"
    for name in ("home", "reach"):
        along = -poses[name]["link_4"][:3, 2]
        assert along == pytest.approx([1, 0, 0], abs=1e-9), (
            "the forearm points forward, level"
        )
    assert tips["reach"][0] > 0.34
    assert tips["home"][2] < 0
    with pytest.raises(UnknownNameError, match="stow, home, reach"):
        named_pose("park")


def test_known_collisions_are_found(collisions):
    """Folded towards -x, the upper arm passes through the base tube."""
    q = np.array([0.02, 0.02, math.pi, 1.0])
    assert collisions.in_collision(q)
    assert ("link_0", "link_2") in collisions.colliding_links(q)
    found = collisions.clearance(q)
    assert found.distance < -0.01
    assert found.links == ("link_0", "link_2")


@needs_recordings
def test_the_real_arm_never_touched_itself(collisions):
    """Every pose of the pool recordings, which rest 1 mm from contact, is free."""
    closest = math.inf
    for path in JOINT_STATES:
        with path.open() as stream:
            rows = list(csv.DictReader(stream))[::25]
        for row in rows:
            q = np.array([float(row[f"axis_{joint}_pos"]) for joint in "edcb"])
            assert not collisions.in_collision(q)
            closest = min(closest, collisions.clearance(q).distance)
    assert 0 < closest < 2e-3


@pytest.mark.slow
def test_answers_bracket_the_distance_between_the_drawn_bodies(collisions, meshes):
    """Primitives enclose the drawn bodies, so they touch first and by 6 mm at most."""
    kernel = pytest.importorskip("manifold3d")
    solids = {
        name: kernel.Manifold(kernel.Mesh64(mesh.v * 1e3, mesh.f.astype(np.uint64)))
        for name, mesh in meshes.items()
    }
    rng = np.random.default_rng(RNG_SEED)
    # Half at random, half folded onto the base, where it matters.
    random = rng.uniform(LOWER, UPPER, (10, 4))
    folded = rng.uniform((0.02, 0.02, 0.02, 0), (0.6, 0.7, 1.5, 6.2), (10, 4))
    hits = 0
    for q in np.vstack([random, folded, [*NAMED_POSES.values()]]):
        overlap, gap = overlap_and_gap(solids, q)
        distance = collisions.clearance(q).distance * 1e3
        hit = collisions.in_collision(q)
        assert hit == (distance <= 0)
        if overlap > 0:
            hits += 1
            assert hit
        else:
            assert min(distance, 30.0) <= gap + 1e-3
            assert min(distance, 30.0) >= gap - 6.0
    assert 2 <= hits <= 15, "the sample must hold both kinds"


#: Pairs of drawn bodies that always touch or can never meet.
NOT_CHECKED = {
    *(frozenset(pair) for pair in ADJACENT_PAIRS),
    frozenset(("finger_1", "finger_2")),
    frozenset(("link_3", "finger_1")),
    frozenset(("link_3", "finger_2")),
}


def overlap_and_gap(solids, q):
    """Common volume [mm^3] and least distance, up to 30 mm, of the drawn bodies."""
    poses = link_poses(q)
    for name in ("finger_1", "finger_2"):
        poses[name] = poses["link_4"] @ finger_pose(name)
    there = {name: placed(solids[name], poses[name]) for name in BODIES}
    overlap = 0.0
    gap = 30.0
    for one, other in itertools.combinations(BODIES, 2):
        if frozenset((one, other)) in NOT_CHECKED:
            continue
        overlap += (there[one] ^ there[other]).volume()
        gap = min(gap, there[one].min_gap(there[other], 30.0))
    return overlap, gap


def test_clearance_names_points_that_far_apart_on_these_links(collisions):
    shapes = collision_primitives("locked")
    for q in (*map(np.array, NAMED_POSES.values()), np.array([2.0, 1.0, 0.3, 0.0])):
        found = collisions.clearance(q)
        one, other = found.points
        assert np.linalg.norm(one - other) == pytest.approx(found.distance, abs=1e-7)
        for link, point in zip(found.links, found.points, strict=True):
            pose = link_poses(q)[link]
            local = ((point - pose[:3, 3]) @ pose[:3, :3])[None]
            assert abs(min(signed_distance(s, local)[0] for s in shapes[link])) < 1e-5
        assert not found.points.flags.writeable


def test_links_1_and_3_cannot_meet(model):
    """They are excluded as `Never`: whatever axes d and c do, they are far apart."""
    geometry = collision_geometry(model)
    objects = geometry.geometryObjects
    geometry.removeAllCollisionPairs()
    of = {name: [] for name in LINKS}
    for number, body in enumerate(objects):
        link = model.frames[body.parentFrame].name
        if link in of:
            of[link].append(number)
    for a, b in itertools.product(of["link_1"], of["link_3"]):
        geometry.addCollisionPair(pin.CollisionPair(a, b))
    data = model.createData()
    scratch = geometry.createData()
    for d, c in itertools.product(np.linspace(LOWER[1], UPPER[1], 9), repeat=2):
        q = np.array([0.0, d, c, 0.0])
        index = pin.computeDistances(model, data, geometry, scratch, q)
        assert scratch.distanceResults[index].min_distance > 0.04


@pytest.mark.parametrize(
    "arguments", [{}, {"gripper": "jaws"}, {"floating_base": True}]
)
def test_the_arm_itself_answers(arguments, collisions):
    arm = a5.load(**arguments)
    for pose in [*NAMED_POSES.values(), (0.02, 0.02, math.pi, 1.0)]:
        q = np.array(pose)
        there = q
        if "gripper" in arguments:
            there = np.append(q, 0.0013)
        if "floating_base" in arguments:
            there = np.concatenate([[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0], q])
        assert arm.in_collision(there) == collisions.in_collision(q)
        wanted = collisions.clearance(q).distance
        assert arm.collision_distance(there) == pytest.approx(wanted, abs=2e-6)
    with pytest.raises(ShapeError):
        arm.in_collision([0.0, 1.0])
    with pytest.raises(NonFiniteError):
        arm.collision_distance(np.full(arm.model.nq, np.nan))


def test_threads_and_copies_have_memory_of_their_own(collisions):
    arm = a5.load()
    q = [
        np.array(pose) for pose in (*NAMED_POSES.values(), (0.02, 0.02, math.pi, 1.0))
    ] * 25
    alone = [arm.collision_distance(x) for x in q]
    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(arm.collision_distance, q)) == pytest.approx(
            alone, abs=2e-6
        )
    assert pickle.loads(pickle.dumps(arm)).collision_distance(q[0]) == pytest.approx(
        alone[0], abs=2e-6
    )
    assert arm.with_payload(1.0).collision_distance(q[0]) == pytest.approx(
        alone[0], abs=2e-6
    )


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_the_answer_at_q_does_not_depend_on_what_was_asked_before(gripper):
    arm = a5.load(gripper=gripper)
    rng = np.random.default_rng(12)
    low = arm.model.lowerPositionLimit
    high = arm.model.upperPositionLimit
    q = rng.uniform(low, high, (60, len(low)))
    collisions = CollisionModel(arm.model)

    def answers(order):
        found = {i: collisions.clearance(q[i]) for i in order}
        return [
            (found[i].distance, found[i].links, *found[i].points.ravel())
            for i in range(60)
        ]

    first = answers(range(60))
    assert answers(rng.permutation(60)) == first
    assert answers(range(59, -1, -1)) == first
    assert [CollisionModel(arm.model).clearance(x).distance for x in q[::10]] == [
        x[0] for x in first[::10]
    ]
    ours = [arm.collision_distance(x) for x in q]
    assert ours == pytest.approx([x[0] for x in first], abs=1.1e-6)
    assert [arm.collision_distance(x) for x in q[::-1]] == ours[::-1]


def test_bodies_that_touch_collide(collisions, monkeypatch):
    q = np.array(NAMED_POSES[next(iter(NAMED_POSES))])
    assert not collisions.in_collision(q)
    here = collisions.clearance(q)
    monkeypatch.setattr(collisions, "clearance", lambda _: replace(here, distance=0.0))
    assert collisions.in_collision(q)


def test_open_jaws_reach_farther():
    """The fingers follow the rod, so open jaws come closer to the upper arm."""
    arm = a5.load(gripper="jaws")
    collisions = CollisionModel(arm.model)
    q = np.array([math.pi, 0.5, 0.05, math.pi / 2, 0.0013])
    shut = collisions.data
    assert len(shut.oMg) == len(collisions.geometry.geometryObjects)
    at = {}
    for rod in (0.0013, 0.0133):
        q[4] = rod
        collisions.in_collision(q)
        names = [o.name for o in collisions.geometry.geometryObjects]
        tip = names.index("finger_1_12")
        at[rod] = collisions.data.oMg[tip].translation.copy()
    assert np.linalg.norm(at[0.0133] - at[0.0013]) > 0.03


def test_floating_base_gives_the_same_answers(collisions):
    arm = a5.load(floating_base=True)
    floating = CollisionModel(arm.model)
    pose = pin.SE3ToXYZQUAT(
        pin.SE3(rotation(0.3, -0.4, 2.0), np.array([1.0, 2.0, -3.0]))
    )
    for q in map(np.array, NAMED_POSES.values()):
        there = floating.clearance(np.concatenate([pose, q]))
        assert there.distance == pytest.approx(
            collisions.clearance(q).distance, abs=2e-6
        )
