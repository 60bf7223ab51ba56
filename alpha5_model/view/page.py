"""The page: meshcat's own viewer with sliders, switches and labels around it, in one file."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable
from dataclasses import replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model.errors import MissingDependencyError
from alpha5_model.view.commands import link_path, scene_commands, shape_path
from alpha5_model.view.scene import DRAWN, GROUPS, SEE_THROUGH, Scene

_HERE = Path(__file__).parent
#: meshcat's viewer in its package.
_VIEWER = "viewer/dist/main.min.js"
#: Fields of a scene that the page gets as they are.
_AS_IT_STANDS = ("title", "notes", "sliders", "labels", "loads", "gravity", "camera")


def static_page(scene: Scene, commands: Iterable[bytes] | None = None) -> str:
    """One HTML file that shows a scene from disk, with no server and no network.

    Args:
        scene: What to show.
        commands: Packed meshcat commands to draw instead of the scene's own.
    """
    packed = (c.packed() for c in scene_commands(scene)) if commands is None else commands
    encoded = [base64.b64encode(command).decode("ascii") for command in packed]
    return _page(scene, live=False, commands=encoded)


def live_page(scene: Scene) -> str:
    """The page that the live viewer serves; the scene comes over its connection."""
    return _page(scene, live=True, commands=[])


def page_data(scene: Scene) -> dict[str, Any]:
    """What the page's script knows about the scene; arrays become nested lists, records objects."""
    moved = {joint.child for joint in scene.tree}
    drawn = {shape.group for shape in scene.shapes}
    track = scene.motion
    return {
        **{name: getattr(scene, name) for name in _AS_IT_STANDS},
        "tree": [{**vars(joint), "source": joint.source} for joint in scene.tree],
        "root": {link: pose for link, pose in scene.poses.items() if link not in moved},
        "q": dict(zip(scene.sliders, scene.q.tolist(), strict=True)),
        "links": {link: link_path(link) for link in scene.poses},
        "anchors": [
            {"path": shape_path(shape), "anchor": shape.anchor}
            for shape in scene.shapes
            if shape.group != "bodies"
        ],
        "groups": [
            {"name": name, "title": title, "shown": name in scene.show}
            for name, title in GROUPS.items()
            if name in drawn or name not in DRAWN
        ],
        "seeThrough": SEE_THROUGH,
        "poses": scene.named_poses,
        "motion": track and replace(track, time=track.time.round(4), q=track.q.round(5)),
    }


@cache
def meshcat_script() -> str:
    """meshcat's viewer with three.js inside, from the installed package."""
    found = find_spec("meshcat")
    script = Path(found.origin if found and found.origin else "").parent / _VIEWER
    if not script.is_file():
        raise MissingDependencyError("meshcat", "the viewer", "pip install meshcat")
    return script.read_text(encoding="utf-8")


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
    def plain(part: Any) -> Any:
        return part.tolist() if isinstance(part, np.ndarray) else vars(part)

    # "<" cannot close the script element that holds the data.
    return json.dumps(value, separators=(",", ":"), default=plain).replace("<", "\\u003c")


@cache
def _read(name: str) -> str:
    return (_HERE / name).read_text(encoding="utf-8")
