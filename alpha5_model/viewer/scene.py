"""What is drawn, as data: shapes and labels in groups, on anchors; a camera.

A `Scene` knows nothing of browsers or pixels. `commands` and `page` turn it into
meshcat commands and a page, `picture` into a PNG.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, transform
from alpha5_model.collision.bodies import CollisionBodies
from alpha5_model.description.urdf_robot import UrdfJoint
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.viewer.shapes import Mesh

#: All of ``scene.toml``.
LOOK: Any = tomllib.loads(Path(__file__).with_suffix(".toml").read_text("utf-8"))
#: Name of a group of things that can be shown and hidden -> its title on the page.
GROUPS: dict[str, str] = LOOK["groups"]
#: Groups with shapes of their own. The other two change how shapes are drawn.
DRAWN = tuple(name for name in GROUPS if name not in ("see-through", "labels"))
#: Groups that the page draws itself, because a hand changes what they show.
MADE_BY_PAGE = ("ghosts", "weight", "buoyancy", "current", "payload")
#: Length of an arrow per force [m/N], and of the current's arrow per speed [s].
ARROWS: dict[str, float] = LOOK["arrows"]
#: Name of a view -> direction from which the arm is seen, (3,).
VIEWS = {name: np.array(direction) for name, direction in LOOK["views"].items()}
#: Groups that are shown by default.
DEFAULT_SHOW = tuple(LOOK["show"])
#: Opacity of bodies that are seen through.
SEE_THROUGH: float = LOOK["see_through"]
#: The fixed frame at the root of the scene.
WORLD = "world"
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


class WeightedPoint(NamedTuple):
    """A point that counts in a mean.

    Attributes:
        link: Name of its link.
        weight: Its share of the mean, in any unit.
        point: In the link's frame, (3,) [m].
    """

    link: str
    weight: float
    point: FloatArray


@dataclass(frozen=True, eq=False)
class Mean:
    """An anchor at the weighted mean of points on links, with the axes of the world.

    Attributes:
        points: The points, at least one.
        offset: Added to the mean, in the world's axes, (3,) [m].
    """

    points: tuple[WeightedPoint, ...]
    offset: FloatArray = field(default_factory=lambda: np.zeros(3))

    def transform(self, poses: Poses) -> FloatArray:
        """Pose in the world, (4, 4)."""
        placed = [moved(poses[each.link], each.point) for each in self.points]
        weights = [each.weight for each in self.points]
        mean = np.average(placed, axis=0, weights=weights)
        return transform(translation=self.offset + mean)


@dataclass(frozen=True, eq=False)
class Shape:
    """A mesh on an anchor.

    Attributes:
        group: One of `GROUPS`.
        name: Unique within its group.
        anchor: What it moves with.
        mesh: In the anchor's frame.
        color: Red, green, blue, 0 to 1; unused if the mesh has its own colours.
        opacity: 0 to 1.
        on_top: Its layer, 0 to 2. A layer is drawn over the lower ones, so that centres
            and arrows inside a body are seen.
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
        text: The text.
        anchor: The point, at its origin.
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


class StripDrag(NamedTuple):
    """Drag of one strip of a link.

    Attributes:
        middle: Middle of the strip in the link's frame, (3,) [m].
        axis: Its unit axis in the link's frame, (3,).
        across, along: Force per squared speed and density of the fluid, across and
            along the axis [m^2].
    """

    middle: FloatArray
    axis: FloatArray
    across: float
    along: float


@dataclass(frozen=True, eq=False)
class Stream:
    """Added mass and drag of one link, for the forces of a steady current; estimated.

    Attributes:
        link: Its name.
        strips: Drag of its strips.
        added_mass: Added mass of its translations, per density, (3, 3) [m^3].
    """

    link: str
    strips: tuple[StripDrag, ...]
    added_mass: FloatArray


class Payload(NamedTuple):
    """A body at the tcp.

    Attributes:
        mass: [kg].
        com: Centres of its mass and volume in tcp, (3,) [m].
        volume: Displaced [m^3].
    """

    mass: float
    com: tuple[float, float, float] = (0.0, 0.0, 0.0)
    volume: float = 0.0


#: Nothing at the tcp.
NO_PAYLOAD = Payload(mass=0.0)


class Water(NamedTuple):
    """What the arm is in.

    Attributes:
        density: Of the fluid [kg/m^3].
        gravity: In the world, (3,) [m/s^2]. A fixed base is drawn so that it points
            down.
        water_velocity: (3,) [m/s]: in base_link if the base is fixed, else in the
            world.
        streams: Level of the estimates -> added mass and drag of the links.
    """

    density: float
    gravity: FloatArray
    water_velocity: FloatArray
    streams: Mapping[str, tuple[Stream, ...]]


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
        """Unit vectors to the right, up and backwards, in the world, as rows (3, 3)."""
        sight = self.eye - self.target
        back = sight / np.linalg.norm(sight)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        up = np.cross(back, right)
        return np.stack([right, up, back])


class Compared(NamedTuple):
    """A recorded quantity beside the computed one.

    Attributes:
        recorded: (N, n) [rad, N m or A; jaw rod m or N]; NaN if unknown.
        computed: The same quantity of the model, (N, n); a position is the smoothed one
            from which torques are computed.
    """

    recorded: FloatArray
    computed: FloatArray


@dataclass(frozen=True, eq=False)
class MotionTrack:
    """A motion to play.

    Attributes:
        name: Its name on the page.
        time: (N,) [s], from 0.
        q: Positions of the sliders' joints, (N, n) [rad or m].
        loads: Cause -> torque, (N, n) [N m; jaw rod N]; ``mount`` -> force and moment
            on the mount at base_link, (N, 6) [N, N m]. Empty for an arm on a vehicle.
        compared: ``position``, ``effort`` and ``current`` -> what was recorded, and
            what was computed. Empty for an arm on a vehicle.
        signals: Name -> a curve of the user, (N,).
    """

    name: str
    time: FloatArray
    q: FloatArray
    loads: Mapping[str, FloatArray]
    compared: Mapping[str, Compared] = field(default_factory=dict)
    signals: Mapping[str, FloatArray] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Scene:
    """All that is drawn, and the numbers that the page computes with.

    Attributes:
        notes: Lines of explanation.
        tree: Joints from the base to the tip.
        sliders: Names of the joints with a slider.
        q: Positions of these joints.
        poses: Pose of every link in the world at ``q``, (4, 4).
        geometry: Lengths and limits, for the inverse kinematics.
        shapes, labels, loads: What to draw.
        show: Groups that are shown.
        named_poses: Name -> positions of the sliders.
        motion: A motion to play, or None.
        water: What the arm is in.
        collision: Bodies that are compared for self-collision.
        speed: Rated speeds of the sliders' joints, (n,) [rad/s or m/s].
        target: Target of the tcp in base_link, (3,) [m], or None.
        camera: The camera that sees the scene.
        name: Of an arm of one's own; empty for the catalogue's.
        payload: What the arm holds at the tcp; it is in none of the loads.
        is_fixed: Whether the base is fixed.
        finger_tips: Finger -> its tip in its frame, (3,) [m].
    """

    notes: tuple[str, ...]
    tree: tuple[UrdfJoint, ...]
    sliders: tuple[str, ...]
    q: FloatArray
    poses: dict[str, FloatArray]
    geometry: Geometry
    shapes: tuple[Shape, ...]
    labels: tuple[Label, ...]
    loads: tuple[Load, ...]
    show: tuple[str, ...]
    named_poses: dict[str, FloatArray]
    motion: MotionTrack | None
    water: Water
    collision: CollisionBodies
    speed: FloatArray
    target: FloatArray | None
    camera: Camera = field(default_factory=lambda: Camera(VIEWS["home"], np.zeros(3)))
    name: str = ""
    payload: Payload = NO_PAYLOAD
    is_fixed: bool = True
    finger_tips: Mapping[str, FloatArray] = field(default_factory=dict)
