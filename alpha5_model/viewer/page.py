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
    Scene,
    Water,
)

#: A file of the page -> the files in its place for an arm of one's own, whose numbers
#: are no constants of the formulas.
_OF_OWN_ARM = {
    "formulas.js": ("own_formulas.js",),
    "web/base.js": ("web/base.js", "web/own_formulas.js"),
    "web/nearest.js": ("web/own_nearest.js",),
}
#: The page's heading and title.
_HEADING = "Reach Alpha 5"
#: Most samples of a motion in a page.
_SAMPLES = 2000


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
    data = {
        "notes": scene.notes,
        "sliders": scene.sliders,
        "labels": [each for each in scene.labels if each.group not in MADE_BY_PAGE],
        "loads": scene.loads,
        "statics": {**vars(scene.statics), "beyond": _beyond(scene)},
        "water": _water(scene.water),
        "payload": scene.payload._asdict(),
        "payloadRadius": LOOK["payload_radius"],
        "currentAt": LOOK["current_at"],
        "fixed": scene.is_fixed,
        "attitude": _attitude(scene),
        "collision": _collision(scene.collision),
        "travel": scene.travel._asdict(),
        "camera": scene.camera,
        "target": scene.target,
        "tree": [_joint(joint) for joint in scene.tree],
        "root": pose_message(scene)["root"],
        "q": dict(zip(scene.sliders, scene.q.tolist(), strict=True)),
        "links": {link: link_path(link) for link in scene.poses},
        "anchors": [
            {"path": path, "anchor": anchor} for path, anchor in anchors(scene).items()
        ],
        "groups": _groups(scene),
        "seeThrough": SEE_THROUGH,
        "branches": BRANCHES,
        "poses": scene.named_poses,
        "views": VIEWS,
        "plane": _plane(scene),
        "arrows": ARROWS,
        "motion": None if scene.motion is None else _track(scene.motion),
    }
    if scene.own is not None:
        data["own"] = {
            "shape": _lengths_and_zeros(scene.own.geometry),
            "kinematics": scene.own.geometry.ik_parameters,
            "dimensions": scene.own.geometry.dimensions,
        }
    return data


def _joint(joint: UrdfJoint) -> dict[str, Any]:
    """A joint of the tree, without what a URDF says of its motor."""
    fields = {**vars(joint), "source": joint.source}
    return {key: x for key, x in fields.items() if key not in ("limit", "dynamics")}


def _beyond(scene: Scene) -> list[dict[str, Any]]:
    return [body._asdict() for body in scene.statics.beyond]


def _water(water: Water) -> dict[str, Any]:
    """Density, gravity and current, and the streams as objects by level."""
    return {
        "density": water.density,
        "gravity": water.gravity,
        "current": water.current,
        "streams": water.streams,
    }


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
        "placement": pose(shape.xyz, shape.rpy),
    }


def _plane(scene: Scene) -> dict[str, Any] | None:
    """The plane of the arm; None for a tool beside the wrist axis."""
    geometry = scene.geometry
    if not geometry.tool_on_axis:
        return None
    return {
        "a_0": geometry.a_0,
        "d_0": geometry.d_0,
        "l_1": geometry.l_1,
        "l_2": geometry.l_2,
        "azimuth_offset": geometry.azimuth_offset,
        "phi_offset": geometry.phi_offset,
        "gamma_offset": geometry.gamma_offset,
        "lower": geometry.lower,
        "upper": geometry.upper,
        "middle": geometry.middle,
        "longest": geometry.longest,
        "shortest": geometry.shortest,
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
    """A motion of at most `_SAMPLES` samples, with no more digits than can be seen."""
    count = len(motion.time)
    rows = np.linspace(0, count - 1, min(count, _SAMPLES)).round().astype(int)
    columns = {"time": motion.time, "q": motion.q, **motion.loads}
    thinned = {name: column[rows].round(6) for name, column in columns.items()}
    compared = {
        name: {
            "recorded": _known(each.recorded[rows]),
            "computed": _known(each.computed[rows]),
        }
        for name, each in motion.compared.items()
    }
    signals = {name: values[rows] for name, values in motion.signals.items()}
    return {"name": motion.name, **thinned, "compared": compared, "signals": signals}


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
    """``web/page.html`` with its data and the files that it names."""
    data = {**page_data(scene), "live": live, "commands": commands}
    text = json.dumps(data, separators=(",", ":"), default=_plain)
    parts = {
        "connect": "; connect-src 'self' ws: wss:" if live else "",
        "meshcat": meshcat_script(),
        # Without "<" nothing can close the script element that holds the data.
        "data": text.replace("<", "\\u003c"),
    }

    instead = {} if scene.own is None else _OF_OWN_ARM

    def filled(found: re.Match[str]) -> str:
        part, file = found.groups()
        if part:
            return parts[part]
        return "\n".join(_read(name) for name in instead.get(file, (file,)))

    template = _read("web/page.html")
    if scene.own is not None:
        template = template.replace(_HEADING, f"{_HEADING}: {scene.own.name}")
    # {{name}} stands for a part, {{folder/name.js}} for a file.
    return re.sub(r"{{(?:(\w+)|([\w/.]+))}}", filled, template)


def _plain(part: Any) -> Any:
    """What JSON takes in place of an array or a record: a list or an object."""
    return part.tolist() if isinstance(part, np.ndarray) else vars(part)


@cache
def _read(name: str) -> str:
    return (Path(__file__).parent / name).read_text(encoding="utf-8")
