"""What is drawn, as data: shapes and labels in named groups, each anchored to the arm; a camera.

A `Scene` knows nothing of browsers or pixels. `page` turns it into meshcat commands and a page,
`picture` into a PNG.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, transform
from alpha5_model.description.reading import UrdfJoint
from alpha5_model.errors import InputError
from alpha5_model.viewer.shapes import Mesh

#: All of ``scene.toml``.
LOOK: Any = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: Groups of things that can be shown and hidden -> what the page calls them.
GROUPS: dict[str, str] = LOOK["groups"]
#: Groups of shapes; the other two change how shapes are drawn.
DRAWN = tuple(name for name in GROUPS if name not in ("see-through", "labels"))
#: Length of an arrow per force [m/N], and of the current's per speed [s].
ARROWS: dict[str, float] = LOOK["arrows"]
#: Directions from which the arm is seen, by name, (3,).
VIEWS = {name: np.array(direction) for name, direction in LOOK["views"].items()}
#: Shown by default; opacity of bodies that are seen through.
DEFAULT_SHOW, SEE_THROUGH = tuple(LOOK["show"]), LOOK["see_through"]
#: The fixed frame at the root of the scene.
WORLD = "world"
#: Share of the frame's half-height that is used, and of its half-width beside that.
_MARGIN, _ACROSS = 0.86, 0.95
#: Red, green, blue, each 0 to 1.
Color = tuple[float, float, float]
#: Width and height in pixels.
Size = tuple[int, int]
#: Pose of every link in the world, (4, 4).
Poses = Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Rigid:
    """An anchor that moves with a link.

    Attributes:
        link: Name of the link, or `WORLD`.
        placement: In the link's frame, (4, 4).
    """

    link: str
    placement: FloatArray = field(default_factory=lambda: np.eye(4))

    def transform(self, poses: Poses) -> FloatArray:
        """Pose in the world, (4, 4)."""
        return poses[self.link] @ self.placement


@dataclass(frozen=True, eq=False)
class Mean:
    """An anchor at the weighted mean of points on links, with the axes of the world.

    Attributes:
        points: Link, weight and point (3,) [m] in the link's frame.
        offset: Added to the mean, in the world's axes, (3,) [m].
    """

    points: tuple[tuple[str, float, FloatArray], ...]
    offset: FloatArray = field(default_factory=lambda: np.zeros(3))

    def transform(self, poses: Poses) -> FloatArray:
        """Pose in the world, (4, 4)."""
        links, weights, points = zip(*self.points, strict=True)
        placed = [
            moved(poses[link], point) for link, point in zip(links, points, strict=True)
        ]
        return transform(
            translation=self.offset + np.average(placed, axis=0, weights=weights)
        )


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh on an anchor.

    Attributes:
        group: One of `GROUPS`.
        name: Unique within its group.
        anchor: What it moves with.
        mesh: In the anchor's frame.
        color: Red, green, blue, 0 to 1; white where the mesh has its own colours.
        opacity: 0 to 1.
        on_top: Layer drawn over the lower ones, so that what lies inside a body is seen; 0 to 2.
        shine: Strength of the highlight, 0 to 1.
        flat: Drawn in its own colour from both sides, without light.
    """

    group: str
    name: str
    anchor: Rigid | Mean
    mesh: Mesh
    color: Color = (1.0, 1.0, 1.0)
    opacity: float = 1.0
    on_top: int = 0
    shine: float = 0.0
    flat: bool = False

    def placed(self, poses: Poses) -> Mesh:
        """The mesh in the world."""
        return self.mesh.moved(self.anchor.transform(poses))


@dataclass(frozen=True, eq=False)
class Label:
    """A text beside a point; shown with its group, if labels are shown.

    Attributes:
        group: One of `GROUPS`.
        text: What it says.
        anchor: Where.
        color: Red, green, blue, 0 to 1.
    """

    group: str
    text: str
    anchor: Rigid | Mean
    color: Color = (0.15, 0.17, 0.2)


@dataclass(frozen=True, eq=False)
class Load:
    """Weight and buoyancy of one body.

    Attributes:
        link: Link in whose frame the points are.
        mass: [kg].
        com: Centre of mass, (3,) [m].
        volume: Displaced [m^3].
        cob: Centre of buoyancy, (3,) [m].
        weight: Force along gravity, at the centre of mass [N].
        buoyancy: Force against gravity, at the centre of buoyancy [N].
    """

    link: str
    mass: float
    com: FloatArray
    volume: float
    cob: FloatArray
    weight: float
    buoyancy: float


@dataclass(frozen=True, eq=False)
class Stream:
    """What a steady current does to one link at rest; estimated.

    Attributes:
        link: Its name.
        strips: Middle and axis, (3,) each in the link's frame, resistance across and along [N s^2/m^2].
        added_mass: Of its translations, (3, 3) [kg].
    """

    link: str
    strips: tuple[tuple[FloatArray, FloatArray, float, float], ...]
    added_mass: FloatArray


@dataclass(frozen=True, eq=False)
class Camera:
    """A perspective camera.

    Attributes:
        eye, target: (3,) [m].
        field_of_view: Vertical [degrees].
    """

    eye: FloatArray
    target: FloatArray
    field_of_view: float = 30.0

    def axes(self) -> FloatArray:
        """Rows: right, up and backwards, in the world, (3, 3)."""
        back = (self.eye - self.target) / np.linalg.norm(self.eye - self.target)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        return np.stack([right, np.cross(back, right), back])


@dataclass(frozen=True, eq=False)
class MotionTrack:
    """A motion to play.

    Attributes:
        name: What the page calls it.
        time: (N,) [s], from 0.
        q: Positions of the sliders' joints, (N, n) [rad or m].
        loads: Torque by cause, (N, n) each [N m; jaw rod N], and as ``mount`` force and moment on the
            mount at base_link, (N, 6) [N, N m]; nothing for an arm on a vehicle.
    """

    name: str
    time: FloatArray
    q: FloatArray
    loads: Mapping[str, FloatArray]


@dataclass(frozen=True, eq=False)
class Scene:
    """All that is drawn, and the numbers that the page's sliders need.

    Attributes:
        notes: Lines of explanation.
        tree: Joints from the base to the tip.
        sliders: Names of the joints that can be moved.
        q: Their positions.
        poses: Pose of every link in the world at ``q``, (4, 4).
        shapes, labels, loads: What to draw.
        statics: What the torque that holds the arm still is computed from: ``parameters``,
            `alpha5_model.codegen.base_parameters` without what moves beyond link_4, (41,); ``share`` of them by
            the net first moment and net mass of what does, in link_4, (41, 4); ``beyond``, link, and
            net first moment [kg m] and net mass [kg] in its frame, (4,), of each such body.
        show: Groups that are shown.
        named_poses: Name -> positions of the sliders.
        motion: A motion to play, or None.
        current, streams: Velocity of the water, (3,) [m/s], and what it does to the links.
        target: Where the tcp should be, in base_link, (3,) [m], or None.
        camera: From where the scene is seen.
    """

    notes: tuple[str, ...]
    tree: tuple[UrdfJoint, ...]
    sliders: tuple[str, ...]
    q: FloatArray
    poses: dict[str, FloatArray]
    shapes: tuple[Shape, ...]
    labels: tuple[Label, ...]
    loads: tuple[Load, ...]
    statics: Mapping[str, Any]
    show: tuple[str, ...]
    named_poses: dict[str, FloatArray]
    motion: MotionTrack | None
    current: FloatArray
    streams: tuple[Stream, ...]
    target: FloatArray | None
    camera: Camera = field(default_factory=lambda: Camera(VIEWS["home"], np.zeros(3)))


def framed(
    scene: Scene,
    size: Size = (1150, 950),
    view: str = "home",
    also: Iterable[Poses] = (),
) -> Scene:
    """A scene seen by the nearest camera that sees every corner of the bodies and of what is shown.

    Args:
        scene: What there is.
        size: Of the picture, in pixels; what a page leaves free by default.
        view: One of `VIEWS`.
        also: Poses of the links elsewhere in a motion, to be seen too.
    """
    check_size(size)
    aspect = _ACROSS * size[0] / size[1]
    drawn = [shape for shape in scene.shapes if shape.group in {"bodies", *scene.show}]
    points = np.concatenate(
        [s.placed(at).vertices for at in (scene.poses, *also) for s in drawn]
    )
    center = (points.min(axis=0) + points.max(axis=0)) / 2
    sight = VIEWS[view] / np.linalg.norm(VIEWS[view])
    camera = Camera(center + sight, center)
    axes, distance = camera.axes(), 0.0
    half = _MARGIN * np.tan(np.deg2rad(camera.field_of_view) / 2)
    # The centre of the corners in space is not their centre in the picture: correct it in steps.
    for _ in range(4):
        right, up, back = ((points - center) @ axes.T).T
        distance = float(
            np.max(back + np.maximum(np.abs(up), np.abs(right) / aspect) / half)
        )
        for coordinate, axis in zip((right, up), axes, strict=False):
            tangent = coordinate / (distance - back)
            center = center + (tangent.max() + tangent.min()) / 2 * distance * axis
    return replace(scene, camera=Camera(center + distance * sight, center))


def check_size(size: Size) -> Size:
    """Check width and height of a picture, 16 to 8000 pixels each.

    Raises:
        InputError: Anything else.
    """
    if len(size) != 2 or not all(isinstance(n, int) and 16 <= n <= 8000 for n in size):
        raise InputError("size", size, "width and height from 16 to 8000 pixels")
    return size
