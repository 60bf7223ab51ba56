"""What the viewer draws, compared with Pinocchio, the printed tables and trimesh."""

from __future__ import annotations

import math

import numpy as np
import pytest
from reference import COB, COM, LOWER, MASS, UPPER, VOLUME, inertial_frames

import alpha5_model as a5
from alpha5_model.errors import (
    Alpha5Error,
    InputError,
    NonFiniteError,
    ShapeError,
    UnknownNameError,
)
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.drawing import ARROW_SCALE
from alpha5_model.viewer.scene import (
    Payload,
    Rigid,
    Scene,
)


@pytest.fixture(scope="module")
def locked() -> Scene:
    return build_scene(a5.load(), [2.0, 1.1, 2.2, 0.7])


def test_link_poses_are_the_documents(locked: Scene) -> None:
    for i, frame in enumerate(inertial_frames(locked.q)):
        np.testing.assert_allclose(locked.poses[f"link_{i}"], frame, atol=1e-12)


def test_loads_are_tables_2_and_3(locked: Scene) -> None:
    links = [load.link for load in locked.loads]
    assert links == ["base_link", "link_1", "link_2", "link_3", "link_4"]
    for load, mass, com, volume, cob in zip(
        locked.loads, MASS, COM, VOLUME, COB, strict=True
    ):
        assert load.weight == pytest.approx(mass * 9.81, rel=1e-12)
        np.testing.assert_allclose(load.com, np.array(com) / 1e3, atol=1e-15)
        assert load.buoyancy == pytest.approx(1025 * volume * 1e-3 * 9.81, rel=1e-12)
        np.testing.assert_allclose(load.cob, np.array(cob) / 1e3, atol=1e-15)


@pytest.mark.parametrize("gripper", ["locked", "jaws"])
def test_whole_arm_markers_stand_at_the_arms_centres(gripper: str) -> None:
    arm = a5.load(gripper=gripper).with_payload(
        0.4, com=(0.01, 0.02, 0.03), volume=1e-4
    )
    q = np.array([1.2, 2.1, 0.6, 3.0, 0.0013][: len(arm.joint_names)])
    scene = build_scene(arm, q)
    marker = {s.group: s for s in scene.shapes if s.name == "arm"}
    for group, center in (
        ("com", arm.center_of_mass(q)),
        ("cob", arm.center_of_buoyancy(q)),
    ):
        place = marker[group].anchor.transform(scene.poses)[:3, 3]
        np.testing.assert_allclose(place, center, atol=1e-12)
    assert sum(load.weight for load in scene.loads) == pytest.approx(
        (sum(MASS) + 0.4) * 9.81
    )


def test_arrows_are_to_scale_and_start_where_the_force_acts(locked: Scene) -> None:
    def arrow_of(group: str, name: str) -> tuple[np.ndarray, np.ndarray]:
        (shape,) = [s for s in locked.shapes if (s.group, s.name) == (group, name)]
        tail = shape.anchor.transform(locked.poses)[:3, 3]
        tip = shape.mesh.vertices[np.argmax(np.abs(shape.mesh.vertices[:, 2]))]
        return tail, tip

    frames = inertial_frames(locked.q)
    for i in range(5):
        tail, tip = arrow_of("weight", f"load_{i}")
        np.testing.assert_allclose(
            tail, (frames[i] @ [*(np.array(COM[i]) / 1e3), 1])[:3], atol=1e-9
        )
        np.testing.assert_allclose(
            tip, [0, 0, -ARROW_SCALE * MASS[i] * 9.81], atol=1e-12
        )
        tail, tip = arrow_of("buoyancy", f"load_{i}")
        np.testing.assert_allclose(
            tail, (frames[i] @ [*(np.array(COB[i]) / 1e3), 1])[:3], atol=1e-9
        )
        lift = 1025 * VOLUME[i] * 1e-3 * 9.81
        np.testing.assert_allclose(tip, [0, 0, ARROW_SCALE * lift], atol=1e-12)
    assert np.allclose(
        arrow_of("weight", "arm")[1], [0, 0, -ARROW_SCALE * sum(MASS) * 9.81]
    )


def test_air_lifts_nothing() -> None:
    scene = build_scene(a5.load(fluid_density=0.0))
    assert not [s for s in scene.shapes if s.group == "buoyancy"]
    assert [s for s in scene.shapes if s.group == "weight"]
    assert [s for s in scene.shapes if s.group == "cob"], (
        "the displaced volume has its centre still"
    )
    assert scene.water.density == 0.0


def test_without_gravity_there_are_centres_and_no_forces() -> None:
    arm = a5.load(gravity=(0, 0, 0))
    scene = build_scene(arm, [1, 2, 3, 4])
    assert not [s for s in scene.shapes if s.group in ("weight", "buoyancy")]
    (marker,) = [s for s in scene.shapes if (s.group, s.name) == ("com", "arm")]
    place = marker.anchor.transform(scene.poses)[:3, 3]
    np.testing.assert_allclose(place, arm.center_of_mass([1, 2, 3, 4]), atol=1e-12)


def test_forces_follow_a_tilted_mount() -> None:
    """The arm is tilted in the picture, and gravity points down."""
    gravity = np.array([3.0, -4.0, -8.0])
    arm = a5.load(gravity=gravity)
    scene = build_scene(arm)
    (shape,) = [s for s in scene.shapes if (s.group, s.name) == ("weight", "arm")]
    tip = shape.mesh.vertices[np.argmin(shape.mesh.vertices[:, 2])]
    force = ARROW_SCALE * sum(MASS) * np.linalg.norm(gravity)
    np.testing.assert_allclose(tip, [0.0, 0.0, -force], atol=1e-9)
    base = scene.poses["base_link"]
    np.testing.assert_allclose(
        base[:3, :3] @ gravity, [0, 0, -np.linalg.norm(gravity)], atol=1e-12
    )
    assert base[1, 0] == pytest.approx(0.0, abs=1e-15)  # no yaw
    tcp = arm.forward_kinematics(scene.q).homogeneous
    np.testing.assert_allclose(scene.poses["tcp"], base @ tcp, atol=1e-12)


def test_a_payload_is_drawn_with_its_net_force() -> None:
    held = Payload(mass=0.3, com=(0.0, 0.01, 0.02), volume=1e-4)
    scene = build_scene(a5.load(), payload=held)
    shapes = {s.name: s for s in scene.shapes if s.group == "payload"}
    at = shapes["body"].anchor.transform(scene.poses)[:3, 3]
    placed = scene.poses["tcp"] @ [*held.com, 1.0]
    np.testing.assert_allclose(at, placed[:3], atol=1e-12)
    radius = np.linalg.norm(shapes["body"].mesh.vertices, axis=1)
    np.testing.assert_allclose(4 / 3 * np.pi * radius**3, held.volume, rtol=1e-9)

    lift = 1025 * held.volume * 9.81
    weight = held.mass * 9.81
    tip = shapes["force"].mesh.vertices[:, 2].min()
    assert tip == pytest.approx(-ARROW_SCALE * (weight - lift), abs=1e-9)
    (label,) = (one for one in scene.labels if one.group == "payload")
    assert label.text == f"payload 300 g, {weight - lift:.2f} N"
    assert sum(load.mass for load in scene.loads) == pytest.approx(sum(MASS))
    assert not [s for s in build_scene(a5.load()).shapes if s.group == "payload"]


def test_a_current_that_is_given_is_shown_to_scale() -> None:
    arm = a5.load()
    hidden = build_scene(arm)
    assert "current" not in hidden.show
    np.testing.assert_array_equal(hidden.water.water_velocity, [1.0, 0.0, 0.0])
    scene = build_scene(arm, water_velocity=(0.3, -0.4, 0.0))
    assert "current" in scene.show
    (shape,) = (s for s in scene.shapes if s.group == "current")
    tip = shape.mesh.vertices[np.argmax(shape.mesh.vertices @ [0.3, -0.4, 0.0])]
    np.testing.assert_allclose(tip, 0.12 * np.array([0.3, -0.4, 0.0]), atol=1e-9)
    (label,) = (one for one in scene.labels if one.group == "current")
    assert label.text == "current 0.5 m/s, load estimated"
    still = build_scene(arm, water_velocity=(0.0, 0.0, 0.0))
    assert [s.name for s in still.shapes if s.group == "current"] == ["arrow"]


def test_ghosts_put_the_tcp_on_the_target() -> None:
    target = np.array([0.06, 0.05, 0.36])
    arm = a5.load()
    scene = build_scene(arm, target=target)
    wrists = {
        s.name: s
        for s in scene.shapes
        if s.group == "ghosts" and "/link_4/part_0" in s.name
    }
    ways = a5.inverse_kinematics(target, scene.q[3]).q
    own = a5.BRANCHES[np.abs(ways - scene.q).max(axis=1).argmin()]
    assert {name.split("/")[0] for name in wrists} == {*a5.BRANCHES} - {own}
    places = []
    for shape in wrists.values():
        assert isinstance(shape.anchor, Rigid)
        assert shape.anchor.link == "world"
        # DH frame {5} lies 180 mm along -z of link_4
        tcp = shape.anchor.placement @ [0, 0, -0.18, 1]
        np.testing.assert_allclose(tcp[:3], target, atol=1e-9)
        places.append(shape.anchor.placement[:3, 3])
    assert (
        min(np.linalg.norm(a - b) for i, a in enumerate(places) for b in places[:i])
        > 1e-3
    )


def test_no_ghost_where_nothing_reaches() -> None:
    scene = build_scene(a5.load(), target=[2.0, 0.0, 0.0])
    assert [s.name for s in scene.shapes if s.group == "ghosts"] == ["target"]


def test_the_section_is_what_the_arm_reaches() -> None:
    """Its area against the exact one; random joint positions put the tcp into it."""
    scene = build_scene(a5.load())
    (section,) = [s for s in scene.shapes if s.name == "section"]
    a, b, c = (
        section.mesh.vertices[section.mesh.faces[:, k]][:, [0, 2]] for k in range(3)
    )
    u, v = b - a, c - a
    area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2
    exact = sum(
        a5.workspace.cross_section_area(side) for side in ("underarm", "overarm")
    )
    assert area == pytest.approx(exact, rel=5e-3)
    rng = np.random.default_rng(3)
    arm, inside = a5.load(), 0
    half_strip = 0.75e-3
    low = np.minimum(np.minimum(a, b), c) - half_strip
    high = np.maximum(np.maximum(a, b), c) + half_strip
    for q in rng.uniform(LOWER, UPPER, (200, 4)):
        tcp = arm.forward_kinematics(q, "link_1").actInv(
            arm.forward_kinematics(q).translation
        )
        assert abs(tcp[1]) < 1e-12
        point = tcp[[0, 2]]
        inside += bool(((low <= point) & (point <= high)).all(axis=1).any())
    assert inside == 200


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        ({"q": [0, 1, 2]}, ShapeError),
        ({"q": [0, 1, 2, math.nan]}, NonFiniteError),
        ({"q": "home"}, InputError),
        ({"target": [[0.1, 0.1, 0.1]]}, ShapeError),
        ({"show": ["arrows"]}, UnknownNameError),
    ],
)
def test_bad_arguments_end_in_the_error_tree(
    arguments: dict, error: type[Exception]
) -> None:
    with pytest.raises(error) as caught:
        build_scene(a5.load(), **arguments)
    assert isinstance(caught.value, Alpha5Error)
    assert "\n" not in str(caught.value)
