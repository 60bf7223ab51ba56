"""A scene as a page: meshcat's viewer with sliders, switches and labels."""

from __future__ import annotations

import base64
import json
import math
import re
from collections.abc import Iterable
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import pose, rpy_from_rotation
from alpha5_model.collision.bodies import CollisionBodies
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.errors import MissingDependencyError
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.ik import BRANCHES
from alpha5_model.viewer.commands import (
    anchors,
    link_path,
    pose_message,
    scene_commands,
)
from alpha5_model.viewer.scene import (
    ARROWS,
    DRAWN,
    GROUPS,
    LOOK,
    MADE_BY_PAGE,
    SEE_THROUGH,
    VIEWS,
    MotionTrack,
    Rigid,
    Scene,
)

#: The page's modules in ``web``; each imports earlier ones only.
_MODULES = (
    "data",
    "vectors",
    "inverse_kinematics",
    "kinematics",
    "statics",
    "collision",
    "state",
    "page",
    "scene",
    "camera",
    "travel",
    "target",
    "panel",
    "water",
    "motion",
    "labels",
    "live",
    "start",
)
_STYLES = ("look.css", "panel.css", "strip.css")
_IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./(\w+)\.js";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:function|const) )", re.MULTILINE)
_EXPORTED = re.compile(
    r"^export (?:function|const) (?:(\w+)|\{ (.*?) \} =)", re.MULTILINE
)
#: What the page needs of a joint; a URDF also says things of its motor.
_OF_JOINT = (
    "name",
    "kind",
    "parent",
    "child",
    "axis",
    "lower",
    "upper",
    "source",
    "multiplier",
    "offset",
)
#: The page's heading and title.
_HEADING = "Reach Alpha 5"
#: Most samples of a motion that a page plays: 22 a second for half an hour.
_PLAYED = 40_000
#: Spans of time of the curves of a long motion; no screen has more pixels for one.
_SPANS = 1000


def static_page(scene: Scene, commands: Iterable[bytes] | None = None) -> str:
    """One HTML file that shows a scene from disk, with no server and no network.

    Args:
        scene: What to show.
        commands: Packed meshcat commands to draw instead of the scene's own.
    """
    if commands is None:
        commands = (command.packed() for command in scene_commands(scene))
    encoded = [base64.b64encode(command).decode("ascii") for command in commands]
    return _page(scene, live=False, commands=encoded)


def live_page(scene: Scene) -> str:
    """The page that the live viewer serves; the scene comes over its connection."""
    return _page(scene, live=True, commands=[])


def page_data(scene: Scene) -> dict[str, Any]:
    """The data of the page's script, for `json.dumps` with `_plain`."""
    return {
        "notes": scene.notes,
        "sliders": scene.sliders,
        "labels": [each for each in scene.labels if each.group not in MADE_BY_PAGE],
        "loads": scene.loads,
        "water": scene.water._asdict(),
        "payload": scene.payload._asdict(),
        "payloadRadius": LOOK["payload_radius"],
        "currentAt": LOOK["current_at"],
        "fixed": scene.is_fixed,
        "attitude": _attitude(scene),
        "collision": _collision(scene.collision),
        "speed": scene.speed,
        "camera": scene.camera,
        "target": scene.target,
        "fingerTips": scene.finger_tips,
        "tree": [_joint(joint) for joint in scene.tree],
        "root": pose_message(scene)["root"],
        "q": scene.q,
        "links": {link: link_path(link) for link in scene.poses},
        "anchors": [
            {"path": path, "anchor": anchor} for path, anchor in anchors(scene).items()
        ],
        "groups": _groups(scene),
        "seeThrough": SEE_THROUGH,
        "branches": BRANCHES,
        "poses": scene.named_poses,
        "views": VIEWS,
        "shape": _lengths_and_zeros(scene.geometry),
        "kinematics": scene.geometry.ik_parameters,
        "arrows": ARROWS,
        "backdrop": LOOK["backdrop"],
        "motion": None if scene.motion is None else _track(scene.motion),
    }


def _joint(joint: UrdfJoint) -> dict[str, Any]:
    """A joint of the tree, with its pose at position zero in three rows."""
    used = {name: getattr(joint, name) for name in _OF_JOINT}
    return {**used, "transform": joint.transform[:3]}


def _attitude(scene: Scene) -> list[float]:
    """Roll and pitch of the base in the world [rad]."""
    base = scene.poses[scene.tree[0].parent]
    roll, pitch, _ = rpy_from_rotation(base[:3, :3])
    return [roll, pitch]


def _collision(compared: CollisionBodies) -> dict[str, Any]:
    """Bodies with their shapes, and the pairs of bodies that are compared."""
    bodies = [
        {"link": body.name, "shapes": [_shape(shape) for shape in body.shapes]}
        for body in compared.bodies
    ]
    return {"bodies": bodies, "pairs": compared.pairs}


def _shape(shape: Primitive) -> dict[str, Any]:
    """A box or cylinder by half its edges, the ball around it, and its pose.

    A cylinder has its radius twice.
    """
    is_round = shape.kind == "cylinder"
    if is_round:
        radius, length = shape.size
        half = [radius, radius, length / 2]
        to_rim = half[1:]
    else:
        half = to_rim = [edge / 2 for edge in shape.size]
    return {
        "round": is_round,
        "half": half,
        "radius": math.hypot(*to_rim),
        "placement": pose(shape.xyz, shape.rpy)[:3],
    }


def _lengths_and_zeros(geometry: Geometry) -> dict[str, Any]:
    """The lengths, zeros and limits of an arm with any tool."""
    azimuth_offset, phi_offset, elbow_offset, wrist_offset = geometry.zeros
    return {
        "a_0": geometry.a_0,
        "d_0": geometry.d_0,
        "a_1": geometry.a_1,
        "a_2": geometry.a_2,
        "x": geometry.x,
        "y": geometry.y,
        "z": geometry.z,
        "azimuth_offset": azimuth_offset,
        "phi_offset": phi_offset,
        "elbow_offset": elbow_offset,
        "wrist_offset": wrist_offset,
        "lower": geometry.lower,
        "upper": geometry.upper,
    }


def _groups(scene: Scene) -> list[dict[str, Any]]:
    """The groups with a switch on the page: ghosts, and groups that are not empty."""
    drawn = {*MADE_BY_PAGE, *(shape.group for shape in scene.shapes)}
    return [
        {"name": name, "title": title, "shown": name in scene.show}
        for name, title in GROUPS.items()
        if name in drawn or name not in DRAWN
    ]


def _track(motion: MotionTrack) -> dict[str, Any]:
    """A motion to play, and its curves, with no more digits than can be seen.

    Of a long one, rows at even steps are played. Its curves keep the lowest and the
    highest value in each of `_SPANS` equal spans of time.
    """
    count = len(motion.time)
    rows = np.linspace(0, count - 1, min(count, _PLAYED)).round().astype(int)
    curves = dict(motion.loads)
    causes = [curves[name] for name in curves if name != "mount"]
    if causes:
        # The lowest values of the causes do not add up to the lowest sum.
        curves["total"] = np.sum(causes, axis=0)
    compared = {
        name: {
            "recorded": each.recorded,
            "computed": each.computed,
            "residual": each.recorded - each.computed,
        }
        for name, each in motion.compared.items()
    }
    starts = _span_starts(motion.time)
    if len(starts) == count:

        def drawn(values: FloatArray) -> FloatArray:
            return values

    else:

        def drawn(values: FloatArray) -> FloatArray:
            low, high = (f.reduceat(values, starts) for f in (np.fmin, np.fmax))
            return np.stack([low, high], axis=1).reshape(-1, *values.shape[1:])

    return {
        "name": motion.name,
        "samples": count,
        "time": motion.time[rows].round(6),
        "q": motion.q[rows].round(6),
        # None if each sample is drawn.
        "spans": None if len(starts) == count else motion.time[starts].round(6),
        **{name: drawn(values).round(6) for name, values in curves.items()},
        "compared": {
            name: {kind: _known(drawn(values)) for kind, values in each.items()}
            for name, each in compared.items()
        },
        "signals": {name: drawn(values) for name, values in motion.signals.items()},
    }


def _span_starts(time: FloatArray) -> NDArray[np.intp]:
    """The first row of each span that has samples, or all rows of a short motion."""
    if len(time) <= 2 * _SPANS:
        return np.arange(len(time))
    span = np.floor((time - time[0]) / (time[-1] - time[0]) * _SPANS)
    return np.unique(np.minimum(span, _SPANS - 1), return_index=True)[1]


def _known(values: FloatArray) -> list[list[float | None]]:
    """Numbers in rows, and None, which JSON knows, for each that is not known."""
    rounded = values.round(6).tolist()
    return [[None if math.isnan(x) else x for x in row] for row in rounded]


@cache
def meshcat_script() -> str:
    """meshcat's viewer with three.js inside, from the installed package.

    Raises:
        MissingDependencyError: meshcat is not installed.
    """
    found = find_spec("meshcat")
    package = Path(found.origin if found and found.origin else "").parent
    script = package / "viewer/dist/main.min.js"
    if not script.is_file():
        raise MissingDependencyError("meshcat", "the viewer", "pip install meshcat")
    return script.read_text(encoding="utf-8")


def _page(scene: Scene, live: bool, commands: list[str]) -> str:
    """``web/page.html`` with its data, styles and modules."""
    data = {**page_data(scene), "live": live, "commands": commands}
    text = json.dumps(data, separators=(",", ":"), default=_plain)
    parts = {
        "heading": f"{_HEADING}: {scene.name}" if scene.name else _HEADING,
        "connect": "; connect-src 'self' ws: wss:" if live else "",
        "styles": "".join(_read(name) for name in _STYLES),
        "meshcat": meshcat_script(),
        # Without "<" nothing can close the script element that holds the data.
        "data": text.replace("<", "\\u003c"),
        "modules": _bundle(),
    }
    return re.sub(r"{{(\w+)}}", lambda found: parts[found[1]], _read("page.html"))


@cache
def _bundle() -> str:
    """The modules as one script, each in a function of its own.

    A browser does not load a module from disk into another one.
    """
    script = ['"use strict";', "const modules = {};"]
    for name in _MODULES:
        text = _read(f"{name}.js")
        names = [", ".join(filter(None, found)) for found in _EXPORTED.findall(text)]
        body = _EXPORT.sub("", _IMPORT.sub(r"const \1 = modules.\2;", text))
        script.append(
            f"modules.{name} = (() => {{\n{body}"
            f"return {{ {', '.join(names)} }};\n}})();"
        )
    return "\n".join(script)


def _plain(part: Any) -> Any:
    """What JSON takes in place of an array or a record: a list or an object."""
    if isinstance(part, np.ndarray):
        return part.tolist()
    if isinstance(part, Rigid):
        return {"link": part.link, "placement": part.placement[:3]}
    return vars(part)


@cache
def _read(name: str) -> str:
    return (Path(__file__).parent / "web" / name).read_text(encoding="utf-8")
