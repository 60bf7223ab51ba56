"""The ghosts of pictures are the ghosts of the page, in a real browser."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, needs_browser, new_tab
from own_arm import random_arm

import alpha5_model as a5
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.scene import Rigid, Scene

pytestmark = needs_browser

#: Two branches within the limits: underarm touches the mount, overarm is free.
BEHIND = np.array([-0.2046462, 0.07319164, 0.14612506])
#: What the page draws: branch -> its links, their poses, and how it looks.
SEEN = """() => {
  const found = {};
  alpha5.ghosts.forEach((ghost, i) => {
    if (!ghost.group.visible) return;
    const links = Object.entries(ghost.links).filter(([, link]) => link.visible);
    const poses = links.map(([name, link]) => [name, link.matrix.elements]);
    found[i] = {
      links: Object.fromEntries(poses),
      opacity: ghost.material.opacity,
      red: ghost.material.color.r > 4 * ghost.material.color.g,
      text: ghost.text,
    };
  });
  return found;
}"""


def of_scene(scene: Scene) -> dict[str, Any]:
    """The same of a scene, as pictures and videos draw it."""
    found: dict[str, Any] = {}
    for shape in scene.shapes:
        if shape.group != "ghosts" or shape.name == "target":
            continue
        branch, link, _ = shape.name.split("/")
        assert isinstance(shape.anchor, Rigid)
        ghost = found.setdefault(str(a5.BRANCHES.index(branch)), {"links": {}})
        ghost["links"][link] = shape.anchor.placement.T.ravel()
        ghost["opacity"] = shape.opacity
        red, green, _ = shape.color
        ghost["red"] = red > 4 * green
    for label in scene.labels:
        name = label.text.split(",")[0].replace(" ", "_")
        if label.group == "ghosts" and name in a5.BRANCHES:
            found[str(a5.BRANCHES.index(name))]["text"] = label.text
    return found


def targets(arm: a5.Arm, count: int) -> np.ndarray:
    """Positions of the tcp at random joint positions, (count, 3) [m]."""
    rng = np.random.default_rng(4)
    q = rng.uniform(arm.limits.lower, arm.limits.upper, (count, len(arm.limits.lower)))
    return np.array([arm.forward_kinematics(row).translation for row in q])


@pytest.mark.parametrize("kind", ["locked", "jaws", "own"])
def test_a_picture_has_the_ghosts_of_the_page(
    chromium: Any, tmp_path: Path, kind: str
) -> None:
    own = random_arm(np.random.default_rng(5), off_axis=False)
    options: dict[str, Any] = {"jaws": {"gripper": "jaws"}, "own": {"arm": own}}
    arm = a5.load(**options.get(kind, {}))
    texts = set()
    for target in [BEHIND, *targets(arm, 5)]:
        scene = build_scene(arm, target=target)
        path = tmp_path / "page.html"
        path.write_text(static_page(scene), "utf-8")
        tab: Tab = new_tab(chromium)
        tab.open(path.as_uri())
        tab.run("() => alpha5.change({ shown: { ghosts: true } })")
        seen, drawn = tab.run(SEEN), of_scene(scene)
        assert seen.keys() == drawn.keys()
        for branch, ghost in drawn.items():
            assert seen[branch]["links"].keys() == ghost["links"].keys()
            for link, pose in ghost["links"].items():
                np.testing.assert_allclose(seen[branch]["links"][link], pose, atol=1e-6)
            for key in ("opacity", "red", "text"):
                assert seen[branch][key] == ghost[key]
            texts.add(ghost["text"].partition(", ")[2])
        assert tab.complaints == []
        tab.page.close()
    assert "beyond the limits" in texts
    assert kind == "own" or "collides" in texts
