"""The page's own numbers without a browser: its modules that need no page, in node."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model
from alpha5_model.viewer.page import static_page
from alpha5_model.viewer.scene import Scene

WEB = Path(alpha5_model.__file__).parent / "viewer/web"
MODULES = ("vectors", "inverse_kinematics", "kinematics", "collision")
#: For each row: the arm is moved to q, and everything about that pose is computed.
_PROGRAM = """
import { readFileSync } from "node:fs";
import { change, state } from "./state.js";
import { reach, solutions, weakest } from "./kinematics.js";
import { touching } from "./collision.js";

const rows = JSON.parse(readFileSync("rows.json"));
const answers = rows.map(({ q, point, wrist }) => {
  change({ q }, "page");
  return {
    touching: touching(state.poses),
    weakest: weakest(state.poses),
    reach: [0, 1, 2, 3].map((branch) => reach(point, branch, q)),
    solutions: solutions(point, wrist),
  };
});
console.log(JSON.stringify(answers));
"""


def data_of(html: str) -> Any:
    """The data of a page."""
    pattern = r'<script id="alpha5-data" type="application/json">(.*?)</script>'
    (text,) = re.findall(pattern, html)
    return json.loads(text)


def computed(
    scene: Scene,
    folder: Path,
    q: np.ndarray,
    points: np.ndarray,
) -> list[dict[str, Any]]:
    """What the page of a scene computes at some poses.

    Args:
        scene: Of the page.
        folder: An empty one.
        q: Positions of the sliders, (N, n).
        points: Targets in base_link, (N, 3); each is also solved for with the wrist
            angle of its pose.
    """
    (folder / "package.json").write_text('{"type": "module"}')
    for name in (*MODULES, "state"):
        shutil.copy(WEB / f"{name}.js", folder)
    data = json.dumps(data_of(static_page(scene)))
    (folder / "data.js").write_text(f"export const data = {data};\n")
    (folder / "main.js").write_text(_PROGRAM)
    rows = [
        {"q": row.tolist(), "point": point.tolist(), "wrist": row[3]}
        for row, point in zip(q, points, strict=True)
    ]
    (folder / "rows.json").write_text(json.dumps(rows))
    done = subprocess.run(
        ["node", "main.js"], cwd=folder, check=True, capture_output=True, text=True
    )
    answers: list[dict[str, Any]] = json.loads(done.stdout)
    return answers
