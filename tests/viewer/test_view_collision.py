"""Self-collision on the page, in a real browser, against Pinocchio and coal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, open_scene

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene

pytestmark = needs_browser

#: Two branches within the limits: underarm touches the mount, overarm is free.
BEHIND = np.array([-0.2046462, 0.07319164, 0.14612506])
#: Reached only with link_2 in link_0.
STUCK = np.array([-0.211669, 0.0861231, 0.0540905])


@pytest.fixture(scope="module")
def page(chromium: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    folder = tmp_path_factory.mktemp("collision")
    tab = open_scene(chromium, build_scene(a5.load()), folder)
    yield tab
    assert tab.complaints == []


def test_links_that_touch_turn_red_and_are_named(page: Tab) -> None:
    solution = a5.inverse_kinematics(STUCK).best(np.ones(4), allow_collision=True)
    page.run("(q) => alpha5.change({ q })", solution.tolist())
    assert page.message() == "The arm collides with itself: link_0 with link_2."
    reds = page.run("""() => Object.keys(alpha5.data.links).filter((link) => {
        let red = false;
        const at = alpha5.data.links[link].split("/").filter((part) => part);
        alpha5.viewer.scene_tree.find(at).object.traverse((part) => {
          red = red || part.isMesh && part.material.emissive.r > 0.1;
        });
        return red;
      })""")
    assert sorted(reds) == ["link_0", "link_2"]
    page.run("(q) => alpha5.change({ q })", a5.named_pose("home").tolist())
    assert page.message() == ""


def test_a_colliding_solution_is_marked(page: Tab) -> None:
    page.change(shown={"ghosts": True})
    page.run("(p) => alpha5.follow(p, 1)", BEHIND.tolist())
    page.settle()
    assert page.message() == ""
    labels = page.run("() => alpha5.ghosts.map((ghost) => ghost.text)")
    assert labels[0] == "underarm, collides"
    assert not any("collides" in label for label in labels[1:])
    color = page.run("() => alpha5.ghosts[0].material.color.getHexString()")
    assert color == "d40f0f"
    button = page.page.get_by_role("button", name="underarm", exact=True)
    assert "link_0 with link_2" in button.get_attribute("title")
    assert "collides" in button.get_attribute("class")
    button.click()
    assert "collides with itself" in page.message()
    page.change(aim=None, q=[3.0, 1.5, 1.5, 1.0])


def test_a_hand_stops_before_a_collision_if_it_is_wanted(page: Tab) -> None:
    free = a5.inverse_kinematics(BEHIND).best([3.0, 3.0, 1.0, 0.0])
    hit = a5.inverse_kinematics(BEHIND).q[0]
    assert a5.inverse_kinematics(BEHIND).collides[0]
    page.run("(q) => alpha5.change({ q })", free.tolist())
    guard = page.page.get_by_label("Stop before the arm touches itself")
    guard.check()
    page.run("(q) => alpha5.travelTo(q, 'there')", hit.tolist())
    stays = page.run("() => alpha5.state.q")
    assert stays == free.tolist()
    assert page.message() == "Stopped: link_0 with link_2 would touch."
    # The slider is where the arm is.
    shown = page.page.get_by_label("axis_e", exact=True).first.input_value()
    assert float(shown) == pytest.approx(free[0], abs=1e-9)
    # A script moves it nevertheless, and out of a collision any way is open.
    page.run("(q) => alpha5.change({ q }, 'python')", hit.tolist())
    assert page.message() == "The arm collides with itself: link_0 with link_2."
    page.run("(q) => alpha5.travelTo(q, 'there')", free.tolist())
    assert page.message() == ""
    guard.uncheck()
    page.run("(q) => alpha5.travelTo(q, 'there')", hit.tolist())
    assert "collides with itself" in page.message()
    page.run("(q) => alpha5.change({ q })", free.tolist())


def test_the_first_picture_of_a_target_is_free_if_possible() -> None:
    arm = a5.load()
    assert not arm.in_collision(build_scene(arm, target=BEHIND).q)
    stuck = build_scene(arm, target=STUCK).q
    assert arm.in_collision(stuck)
    np.testing.assert_allclose(
        arm.forward_kinematics(stuck).translation, STUCK, atol=1e-9
    )
