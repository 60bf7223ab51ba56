"""A scene as meshcat commands, and as a page: meshcat's viewer with sliders, switches and labels.

The live viewer and the page on disk get the same commands.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import umsgpack  # type: ignore[import-untyped]
from numpy.typing import NDArray

from alpha5_model.errors import MissingDependencyError
from alpha5_model.kinematics import ik, plane
from alpha5_model.viewer import scene as scenes
from alpha5_model.viewer.scene import (
    DRAWN,
    GROUPS,
    Mean,
    MotionTrack,
    Rigid,
    Scene,
    Shape,
)

#: Fields of a scene that go to the page unchanged.
_AS_IT_STANDS = "notes sliders labels statics current streams camera target"
#: Most samples of a motion in a page.
_SAMPLES = 2000
#: Typed arrays, and the MessagePack extension codes by which meshcat sends them.
_CODES = {"<f4": ("Float32Array", 0x17), "<u4": ("Uint32Array", 0x16)}
#: Root of the arm in meshcat's scene tree.
ROOT = "/meshcat/alpha5"


class Command(dict[str, Any]):
    """One meshcat command, ready for MessagePack."""

    def lower(self) -> Command:
        """Itself: what meshcat's window sends."""
        return self

    def packed(self) -> bytes:
        """The message as the browser reads it."""
        return bytes(umsgpack.packb(self))


def shape_path(shape: Shape) -> str:
    """Node of a shape in meshcat's scene tree."""
    return f"{ROOT}/{shape.group}/{shape.name}"


def _anchors(scene: Scene) -> dict[str, Rigid | Mean]:
    """Path -> anchor of every shape that does not move with the node of its link."""
    return {
        shape_path(s): s.anchor
        for s in scene.shapes
        if s.group not in ("bodies", "ghosts")
    }


def scene_commands(scene: Scene) -> Iterator[Command]:
    """Commands that build a scene from nothing.

    A mesh that several shapes share is sent with the first of them; the page remembers it. Ghosts it
    makes of the bodies: they follow the hand.
    """
    sent: dict[int, str] = {}
    for shape in scene.shapes:
        if shape.group != "ghosts":
            yield _set_object(shape, sent)
    yield from pose_commands(scene)
    for group in DRAWN:
        yield set_visible(group, group in scene.show)


def pose_commands(scene: Scene) -> Iterator[Command]:
    """Commands that move everything to where the scene has it."""
    placed = {f"{ROOT}/bodies/{link}": pose for link, pose in scene.poses.items()}
    placed |= {
        path: anchor.transform(scene.poses) for path, anchor in _anchors(scene).items()
    }
    for path, pose in placed.items():
        yield Command(type="set_transform", path=path, matrix=pose.T.ravel().tolist())


def set_visible(group: str, visible: bool) -> Command:
    """Show or hide a group."""
    return Command(
        type="set_property", path=f"{ROOT}/{group}", property="visible", value=visible
    )


def _set_object(shape: Shape, sent: dict[int, str]) -> Command:
    # Names, not random identifiers: the same scene gives the same bytes.
    name, colored = f"{shape.group}/{shape.name}", shape.mesh.colors is not None
    content = {} if id(shape.mesh) in sent else {"data": _geometry(shape)}
    geometry = sent.setdefault(id(shape.mesh), f"{name}:geometry")
    material = {
        "uuid": f"{name}:material",
        "type": "MeshBasicMaterial" if shape.flat else "MeshPhongMaterial",
        "color": 0xFFFFFF if colored else _hex(shape.color),
        "specular": _hex((0.55 * shape.shine,) * 3),
        "shininess": 40.0,
        # three.js: 0 front only, 2 both sides. Closed bodies need their front only.
        "side": 2 if shape.flat else 0,
        "transparent": shape.on_top > 0 or shape.opacity < 1.0,
        "opacity": shape.opacity,
        "depthTest": shape.on_top == 0,
        "depthWrite": shape.opacity == 1.0,
        "vertexColors": colored,
    }
    mesh = {
        "uuid": name,
        "type": "Mesh",
        "geometry": geometry,
        "material": material["uuid"],
    }
    parts = {
        "metadata": {"version": 4.5, "type": "Object"},
        "geometries": [{"uuid": geometry, "type": "BufferGeometry", **content}],
        "materials": [material],
        "object": {**mesh, "renderOrder": shape.on_top},
    }
    return Command(type="set_object", path=shape_path(shape), object=parts)


def _geometry(shape: Shape) -> dict[str, Any]:
    mesh, normals = shape.mesh, None if shape.flat else shape.mesh.normals
    corners = {"position": mesh.vertices, "normal": normals, "color": mesh.colors}
    given = {name: _typed(x, "<f4", 3) for name, x in corners.items() if x is not None}
    return {"attributes": given, "index": _typed(mesh.faces.ravel(), "<u4", 1)}


def _typed(array: NDArray[Any], kind: str, item_size: int) -> dict[str, Any]:
    name, code = _CODES[kind]
    packed = umsgpack.Ext(code, array.astype(kind).tobytes())
    return {"itemSize": item_size, "type": name, "array": packed, "normalized": False}


def _hex(color: tuple[float, ...]) -> int:
    return int.from_bytes(bytes(round(255 * c) for c in color))


def static_page(scene: Scene, commands: Iterable[bytes] | None = None) -> str:
    """One HTML file that shows a scene from disk, with no server and no network.

    Args:
        scene: What to show.
        commands: Packed meshcat commands to draw instead of the scene's own.
    """
    packed = (
        (c.packed() for c in scene_commands(scene)) if commands is None else commands
    )
    return _page(
        scene,
        live=False,
        commands=[base64.b64encode(c).decode("ascii") for c in packed],
    )


def live_page(scene: Scene) -> str:
    """The page that the live viewer serves; the scene comes over its connection."""
    return _page(scene, live=True, commands=[])


def page_data(scene: Scene) -> dict[str, Any]:
    """What the page's script knows about the scene; arrays become nested lists, records objects."""
    drawn = {"ghosts", *(shape.group for shape in scene.shapes)}
    out: dict[str, Any] = {name: getattr(scene, name) for name in _AS_IT_STANDS.split()}
    out["tree"] = [{**vars(joint), "source": joint.source} for joint in scene.tree]
    out["root"] = pose_message(scene)["root"]
    out["q"] = dict(zip(scene.sliders, scene.q.tolist(), strict=True))
    out["links"] = {link: f"{ROOT}/bodies/{link}" for link in scene.poses}
    out["anchors"] = [
        {"path": path, "anchor": at} for path, at in _anchors(scene).items()
    ]
    titles = {
        name: x for name, x in GROUPS.items() if name in drawn or name not in DRAWN
    }
    out["groups"] = [
        {"name": k, "title": x, "shown": k in scene.show} for k, x in titles.items()
    ]
    out |= {
        "seeThrough": scenes.SEE_THROUGH,
        "branches": ik.BRANCHES,
        "poses": scene.named_poses,
    }
    out |= {
        "views": scenes.VIEWS,
        "plane": plane.arm_plane()._asdict(),
        "arrows": scenes.ARROWS,
    }
    return out | {"motion": scene.motion and _track(scene.motion)}


def pose_message(scene: Scene) -> Command:
    """What a page is told of a pose: the joints, and the links that no joint carries."""
    moved = {joint.child for joint in scene.tree}
    root = {
        link: pose.tolist() for link, pose in scene.poses.items() if link not in moved
    }
    return Command(type="pose", q=scene.q.tolist(), root=root)


def _track(motion: MotionTrack) -> dict[str, Any]:
    """A motion of at most `_SAMPLES` samples, in digits that can be seen."""
    count = len(motion.time)
    rows = np.linspace(0, count - 1, min(count, _SAMPLES)).round().astype(int)
    columns = {"time": motion.time, "q": motion.q, **motion.loads}
    return {"name": motion.name} | {
        key: one[rows].round(6) for key, one in columns.items()
    }


@cache
def meshcat_script() -> str:
    """meshcat's viewer with three.js inside, from the installed package."""
    found = find_spec("meshcat")
    script = (
        Path(found.origin if found and found.origin else "").parent
        / "viewer/dist/main.min.js"
    )
    if not script.is_file():
        raise MissingDependencyError("meshcat", "the viewer", "pip install meshcat")
    return script.read_text(encoding="utf-8")


def _page(scene: Scene, live: bool, commands: list[str]) -> str:
    data = {**page_data(scene), "live": live, "commands": commands}
    parts = {
        "connect": "; connect-src 'self' ws: wss:" if live else "",
        "meshcat": meshcat_script(),
        # "<" cannot close the script element that holds the data.
        "data": json.dumps(data, separators=(",", ":"), default=_plain).replace(
            "<", "\\u003c"
        ),
    }
    # A part, or a file.
    named = re.compile(r"{{(?:(\w+)|([\w/.]+))}}")
    return named.sub(
        lambda at: parts[at[1]] if at[1] else _read(at[2]), _read("web/page.html")
    )


def _plain(part: Any) -> Any:
    """What JSON takes in place of an array or a record."""
    return part.tolist() if isinstance(part, np.ndarray) else vars(part)


@cache
def _read(name: str) -> str:
    return (Path(__file__).parent / name).read_text(encoding="utf-8")
