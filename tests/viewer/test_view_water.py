"""The page's controls of water, current, payload and mount, under a hand."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab, open_scene

import alpha5_model as a5
from alpha5_model.cli import main
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.scene import Payload

pytestmark = needs_browser

POSE = np.array([3.0, 1.1, 1.9, 0.4])


@pytest.fixture(scope="module")
def opened(chromium: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tab]:
    folder = tmp_path_factory.mktemp("water")
    tab = open_scene(chromium, build_scene(a5.load(), POSE), folder)
    tab.run("() => document.querySelectorAll('details').forEach((d) => d.open = true)")
    yield tab
    assert tab.complaints == []


@pytest.fixture
def page(opened: Tab) -> Tab:
    """The page in sea water, at its pose, with nothing else chosen."""
    opened.run(
        """(q) => {
          const limits = [null, null, null, null];
          const payload = { mass: 0, com: [0, 0, 0], volume: 0 };
          alpha5.change({ density: 1025, current: [1, 0, 0], attitude: [0, 0] });
          alpha5.change({ payload, limits });
          alpha5.change({ shown: { current: false } });
          alpha5.change({ q });
          alpha5.look('home', false);
        }""",
        POSE.tolist(),
    )
    opened.settle()
    return opened


def state(page: Tab, entry: str) -> Any:
    return page.run("(entry) => alpha5.state[entry]", entry)


def heading(page: Tab, section: str) -> str:
    return str(page.page.locator(f"#{section} summary span").text_content())


def test_fluids_are_buttons_and_any_density_can_be_typed(page: Tab) -> None:
    assert heading(page, "water") == "sea, 1025 kg/m³"
    for name, density in (("air", 0), ("fresh", 1000), ("sea", 1025)):
        page.page.get_by_role("button", name=name, exact=True).click()
        assert state(page, "density") == density
    assert page.type_into("Density in kg/m³", "1012.5") == "1012.5"
    assert heading(page, "water") == "1012.5 kg/m³"
    pressed = page.run("document.querySelectorAll('#water [aria-pressed=true]').length")
    assert pressed == 0


def test_a_field_refuses_what_cannot_be_and_is_filled_again(page: Tab) -> None:
    assert page.type_into("Density in kg/m³", "99999999") == "1025"
    assert "Density cannot be 99999999 kg/m³: it must lie between 0 and 2000" in (
        page.message()
    )
    assert page.type_into("Density in kg/m³", "") == "1025"
    assert page.message() == "Density needs a number."
    assert page.type_into("Current along x in m/s", "-7") == "0"
    assert "between \u22125 and 5 m/s" in page.message()
    assert page.type_into("Density in kg/m³", "1000") == "1000"
    assert page.message() == ""


def test_a_current_that_is_typed_is_shown(page: Tab) -> None:
    page.type_into("Current along y in m/s", "0.5")
    assert page.run("() => alpha5.state.shown.current")
    assert heading(page, "water") == "sea, 1025 kg/m³, current 0.50 m/s"
    assert state(page, "current") == [0, 0.5, 0], "what is not shown does not flow"
    page.type_into("Current along x in m/s", "1")
    page.type_into("Current along y in m/s", "0")


def test_what_it_can_hold_is_the_edge_of_pythons_torques(page: Tab) -> None:
    """The mass that is named is allowed, one gram more is not."""
    current = np.array([0.3, 0.4, 0.0])
    limits = np.array([0.9, 2.0, 0.7, 0.1])
    page.type_into("Current along x in m/s", "0.3")
    page.type_into("Current along y in m/s", "0.4")
    for joint, limit in zip(("e", "d", "c", "b"), limits, strict=True):
        page.type_into(f"Limit of axis_{joint} in N·m", f"{limit}")
    said = page.page.locator("#verdict").text_content()
    assert said.startswith("Holds up to ")
    grams = int(said.split()[3])
    first = said.split(": ")[1].split()[0]

    def loads(mass: float) -> np.ndarray:
        arm = a5.load().with_payload(mass)
        still = np.zeros(4)
        levels = [
            arm.with_hydrodynamics(current, level).inverse_dynamics(POSE, still, still)
            for level in ("low", "nominal", "high")
        ]
        return np.abs(levels).max(axis=0)

    assert (loads(1e-3 * grams) <= limits).all()
    over = loads(1e-3 * (grams + 1)) > limits
    assert a5.load().joint_names[int(np.flatnonzero(over)[0])] == first
    assert heading(page, "capacity") == f"up to {grams} g"

    for mass, answer in ((grams, "Yes"), (grams + 1, "No")):
        page.type_into("Payload in g", f"{mass}")
        asked = page.page.locator("#verdict").text_content()
        assert asked == f"{answer} for {mass} g. {said}"
    page.type_into("Payload in g", "0")
    page.type_into("Limit of axis_d in N·m", "0.01")
    assert "Nothing here: " in page.page.locator("#verdict").text_content()
    assert page.run("() => document.querySelectorAll('.bar.over').length") == 1


def test_the_payload_slider_shows_a_body_and_its_force(page: Tab) -> None:
    page.run(
        """() => {
          const slider = document.querySelector('input[name=payload]');
          slider.value = 0.25;
          slider.dispatchEvent(new Event('input'));
        }"""
    )
    page.settle()
    labels = page.run(
        "[...document.querySelectorAll('#labels *')].map((l) => l.innerText)"
    )
    assert "payload 250 g, 2.45 N" in labels
    assert heading(page, "payload") == "250 g, 2.45 N"
    page.type_into("Volume of the payload in cm³", "100")
    force = (0.25 - 1025 * 1e-4) * 9.81
    assert heading(page, "payload") == f"250 g, {force:.2f} N"


def test_the_command_opens_with_payload_and_mount(
    chromium: Any, tmp_path: Path
) -> None:
    path = tmp_path / "page.html"
    options = ["--payload", "0.5 0 0 0.01 1e-4", "--mount", "30 -20 45 deg"]
    assert main(["view", *options, "--pose", "home", "--html", str(path)]) == 0
    tab = new_tab(chromium)
    tab.open(path.as_uri())
    assert tab.run("() => alpha5.state.payload") == {
        "mass": 0.5,
        "com": [0, 0, 0.01],
        "volume": 1e-4,
    }
    np.testing.assert_allclose(
        np.degrees(tab.run("() => alpha5.state.attitude")), [30, -20], atol=1e-9
    )
    tab.page.close()


def test_a_motion_counts_its_payload() -> None:
    """The curves of a page that opens with a payload are those of the loaded arm."""
    time = np.linspace(0.0, 1.0, 11)
    motion = a5.trajectory.motion(time, np.tile(POSE, (11, 1)))
    held = Payload(mass=0.4)
    scene = build_scene(a5.load(), motion=motion, payload=held)
    assert scene.motion is not None
    weight = scene.motion.loads["weight"]
    loaded = a5.load().with_payload(0.4)
    np.testing.assert_allclose(weight[5], loaded.gravity_torque(POSE), atol=1e-9)
