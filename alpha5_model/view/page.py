"""The page: meshcat's own viewer with sliders, switches and labels around it, in one file."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from alpha5_model.errors import MissingDependencyError
from alpha5_model.view.commands import link_path, scene_commands, shape_path
from alpha5_model.view.scene import GROUPS, SEE_THROUGH, Scene

_HERE = Path(__file__).parent
_JOINT = ("name", "parent", "child", "kind", "lower", "upper", "source", "multiplier", "offset")


def static_page(scene: Scene, commands: Iterable[bytes] | None = None) -> str:
    """One HTML file that shows a scene from disk, with no server and no network.

    Args:
        scene: What to see.
        commands: Packed meshcat commands to draw instead of the scene's own.
    """
    packed = (c.packed() for c in scene_commands(scene)) if commands is None else commands
    encoded = [base64.b64encode(command).decode("ascii") for command in packed]
    return _page(scene, live=False, commands=encoded)


def live_page(scene: Scene) -> str:
    """The page that the live viewer serves; the scene comes over its connection."""
    return _page(scene, live=True, commands=[])


def page_data(scene: Scene) -> dict[str, Any]:
    """What the page's script knows about the scene."""
    return {
        "title": scene.title,
        "notes": scene.notes,
        "tree": [
            {
                "placement": joint.transform.T.ravel().tolist(),
                "axis": joint.axis.tolist(),
                **{name: getattr(joint, name) for name in _JOINT},
            }
            for joint in scene.tree
        ],
        "root": {
            link: pose.T.ravel().tolist()
            for link, pose in scene.poses.items()
            if link not in {joint.child for joint in scene.tree}
        },
        "sliders": scene.sliders,
        "q": dict(zip(scene.sliders, scene.q.tolist(), strict=True)),
        "links": {link: link_path(link) for link in scene.poses},
        "anchors": [
            {"path": shape_path(shape), **shape.anchor.as_json()}
            for shape in scene.shapes
            if shape.group != "bodies"
        ],
        "labels": [
            {
                "group": label.group,
                "text": label.text,
                "color": "rgb({})".format(",".join(str(round(255 * c)) for c in label.color)),
                **label.anchor.as_json(),
            }
            for label in scene.labels
        ],
        "groups": [
            {"name": name, "title": title, "shown": name in scene.show}
            for name, title in GROUPS.items()
            if name in ("see-through", "labels") or any(s.group == name for s in scene.shapes)
        ],
        "loads": [
            {
                "link": load.link,
                "weight": load.weight,
                "com": load.com.tolist(),
                "buoyancy": load.buoyancy,
                "cob": load.cob.tolist(),
            }
            for load in scene.loads
        ],
        "gravity": scene.gravity.tolist(),
        "seeThrough": SEE_THROUGH,
        "camera": {
            "eye": scene.camera.eye.tolist(),
            "target": scene.camera.target.tolist(),
            "fieldOfView": scene.camera.field_of_view,
        },
        "poses": {name: q.tolist() for name, q in scene.named_poses.items()},
        "motion": None
        if scene.motion is None
        else {
            "name": scene.motion.name,
            "time": scene.motion.time.round(4).tolist(),
            "q": scene.motion.q.round(5).tolist(),
        },
    }


@cache
def meshcat_script() -> str:
    """meshcat's viewer with three.js inside, from the installed package."""
    found = find_spec("meshcat")
    places = [] if found is None else list(found.submodule_search_locations or [])
    for place in places:
        script = Path(place) / "viewer" / "dist" / "main.min.js"
        if script.is_file():
            return script.read_text(encoding="utf-8")
    raise MissingDependencyError("meshcat", "the viewer", "pip install meshcat")


def _page(scene: Scene, live: bool, commands: list[str]) -> str:
    # The policy makes "no request leaves the machine" a promise that the browser keeps.
    policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
    parts = {
        "policy": policy + ("; connect-src 'self' ws: wss:" if live else ""),
        "title": scene.title,
        "style": _read("page.css"),
        "meshcat": meshcat_script(),
        "data": _json({**page_data(scene), "live": live, "commands": commands}),
        "script": _read("page.js"),
    }
    page = _read("page.html")
    for name, text in parts.items():
        page = page.replace("{{" + name + "}}", text, 1)
    return page


def _json(value: Any) -> str:
    # "<" cannot close the script element that holds the data.
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c")


@cache
def _read(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
