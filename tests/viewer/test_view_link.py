"""A link restores what a person has changed on the page; what it must not hold."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page

pytestmark = needs_browser

#: What a link has to restore, and the numbers that the page prints.
SEEN = """() => {
  const { state, viewer } = alpha5;
  const printed = document.querySelectorAll(
    "#joints .torque, #readout, #bars output, #verdict, summary span",
  );
  const fields = document.querySelectorAll("#panel input");
  return {
    state: JSON.parse(JSON.stringify(state)),
    eye: viewer.camera.position.toArray(),
    printed: [...printed].map((each) => each.textContent),
    fields: [...fields].map((each) => `${each.value} ${each.checked}`),
  };
}"""


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("link") / "page.html"
    path.write_text(static_page(build_scene(a5.load(gripper="jaws"))), "utf-8")
    return path.as_uri()


@pytest.fixture(scope="module")
def opened(chromium: Any, address: str) -> Iterator[Tab]:
    """A page without a link."""
    tab = new_tab(chromium)
    tab.open(address)
    yield tab
    assert tab.complaints == []


def followed(tab: Tab, link: str) -> str:
    """Put a link into the address of an open page; what the page says of it."""
    tab.run(
        """(link) => new Promise((done) => {
          const before = location.hash;
          addEventListener("hashchange", done, { once: true });
          location.hash = link;
          if (location.hash === before) done();
        })""",
        link,
    )
    tab.settle()
    return tab.message()


def test_a_link_opened_elsewhere_shows_the_same_numbers(
    chromium: Any, address: str, opened: Tab
) -> None:
    opened.run("""() => {
      alpha5.change({ q: [2.345678901234, 1.1, 1.9, -0.4, 0.004] });
      alpha5.follow([0.21, 0.1, 0.12], 0);
      alpha5.change({ density: 998.2, current: [0.3, -0.1, 0.05], degrees: false });
      alpha5.change({ attitude: [0.1, -1e-7] });
      alpha5.change({ payload: { mass: 0.31, com: [0, 0, 0.01], volume: 4e-5 } });
      alpha5.change({ limits: [null, 2.5, 0.25, null], guard: true });
      const shown = { current: true, ghosts: true, payload: true, labels: false };
      alpha5.change({ shown });
      alpha5.look("side", false);
    }""")
    opened.settle()
    link = opened.run("() => alpha5.linkText()")

    other = new_tab(chromium)
    other.open(f"{address}#{link}")
    there = other.run(SEEN)
    here = opened.run(SEEN)
    np.testing.assert_allclose(there.pop("eye"), here.pop("eye"), atol=1e-12)
    assert there == here
    assert any(
        "No for 310 g. Holds up to" in text and "axis_c" in text
        for text in here["printed"]
    ), "the limits are judged"
    assert other.complaints == []

    # A view that a hand has turned is restored, too.
    other.run("() => alpha5.change({ view: null })")
    turned = other.run(
        """() => { alpha5.viewer.camera.position.set(1, 0.5, 0.25);
          return alpha5.linkText(); }"""
    )
    assert followed(opened, turned) == opened.message()
    np.testing.assert_allclose(opened.run(SEEN)["eye"], [1, 0.5, 0.25], atol=1e-9)


def test_a_link_written_by_python_shows_python_s_numbers(
    chromium: Any, address: str
) -> None:
    """200 g with a volume, in fresh water, at a pose."""
    arm = a5.load(a5.FRESH_WATER, gripper="jaws")
    held = arm.with_payload(0.2, volume=5e-5)
    q = np.array([2.9, 0.9, 2.1, 0.3, 0.006])
    pose = ",".join(repr(float(angle)) for angle in q)
    tab = new_tab(chromium)
    tab.open(f"{address}#q={pose}&fluid=1000&payload=0.2,0,0,0,0.00005&show=bodies")
    torques = tab.run("() => alpha5.torques().map(({ value }) => value)")
    np.testing.assert_allclose(torques, held.hydrostatic_torque(q)[:4], atol=1e-9)
    shown = tab.run("() => alpha5.state.shown")
    assert [name for name, on in shown.items() if on] == ["bodies"]


@pytest.mark.parametrize(
    ("link", "said"),
    [
        ("q=1,2,3", "q needs 5 numbers"),
        ("q=9,1,2,0,0", "number 1 of q must lie between"),
        ("fluid=-1", "number 1 of fluid must lie between 0.000 and 2000.000"),
        ("view=1,1,1,1,1,1", "view needs a camera away from what it looks at"),
        ("show=%3Cimg src%3Dx onerror%3Dalert(1)%3E", "show takes bodies"),
        ("units=grad", "units takes deg, rad"),
        ("fluid=1&fluid=2", "it holds fluid, current"),
        ("fluid=%E0%A4%A", "it is damaged"),
        ("fluid=1" + "0" * 3000, "more than 2000 characters"),
    ],
)
def test_what_is_no_state_is_refused_whole(opened: Tab, link: str, said: str) -> None:
    before = opened.run(SEEN)
    assert said in followed(opened, link)
    assert opened.run(SEEN) == before
    elements = "() => document.querySelectorAll('#message img').length"
    assert opened.run(elements) == 0
    assert "The link" not in followed(opened, "units=rad"), "a good one clears it"


def test_the_button_puts_the_link_into_the_address(opened: Tab) -> None:
    # The button says it for a moment, in which a slow machine may not look.
    opened.run("""() => {
        const button = document.querySelector("#link");
        window.said = [];
        new MutationObserver(() => window.said.push(button.textContent))
            .observe(button, { childList: true });
    }""")
    opened.page.get_by_role("button", name="Link").click()
    hash_ = opened.run("() => location.hash")
    assert hash_ == "#" + opened.run("() => alpha5.linkText()")
    opened.page.wait_for_function("() => window.said.length > 0")
    assert opened.run("() => window.said[0]") in ("Copied", "See address")
