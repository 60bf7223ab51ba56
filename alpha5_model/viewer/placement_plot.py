"""Plot of the poses of a vehicle from which its arm reaches some points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.spatial import moved, pose
from alpha5_model.collision.turning_radii import corners_around
from alpha5_model.planning.obstacles import Mesh, Obstacle
from alpha5_model.planning.placement_table import Placements
from alpha5_model.viewer.figures import Color, new_figure, style
from alpha5_model.viewer.outlines import legend_below

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from alpha5_model.dynamics.arm import Arm

#: Around what is drawn [m].
_BORDER = 0.2
#: Of obstacles; what is behind one shows through it.
_OBSTACLE = (0.3, 0.3, 0.3, 0.2)
_EDGE = "0.4"
#: At most so many positions of the arm are drawn.
_ARMS = 8
_LINKS = ("base_link", "link_1", "link_2", "link_3", "link_4", "tcp")


@style(axes={"titlesize": 10}, legend={"fontsize": 8})
def placement_figure(found: Placements, arm: Arm) -> Any:
    """Plot a map of poses over the scene, as a matplotlib Figure.

    Left from above, right from the side, across the line from the best pose's arm to
    the points. Each place has the colour of its best pose; the best of all is drawn
    with its hull and arm. Lengths in m.

    Args:
        found: What `alpha5_model.placements` returns.
        arm: Of the vehicle, on a fixed base.
    """
    ahead = _ahead(found)
    page = new_figure(10.5, 5.6)
    above, side = page.subplots(1, 2)
    up = np.array([0.0, 0.0, 1.0])
    dots = _draw(above, found, arm, np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    _draw(side, found, arm, np.array([ahead, up]))
    above.set(title="from above", xlabel="x [m]", ylabel="y [m]")
    heading = np.degrees(np.arctan2(ahead[1], ahead[0]))
    side.set(
        title="from the side",
        xlabel=f"along the heading of the best pose, {heading:z.0f}° from x [m]",
        ylabel="z [m]",
    )
    legend_below(above, 0.12, in_row=True)
    label = "least clearance or reach margin [mm]"
    page.colorbar(dots, ax=[above, side], shrink=0.8, pad=0.02, label=label)
    page.suptitle(f"{len(found)} of {found.tried} poses", fontsize=11)
    return page


def _ahead(found: Placements) -> FloatArray:
    """Level direction from the best pose's base_link to the points, (3,)."""
    way = found.points.mean(axis=0) - found.base[0, :3, 3]
    way[2] = 0.0
    length = float(np.linalg.norm(way))
    return np.asarray(way / length if length else np.array([1.0, 0.0, 0.0]))


def _draw(axes: Axes, found: Placements, arm: Arm, view: FloatArray) -> Any:
    """One view of the scene.

    Args:
        axes: Where to draw it.
        found: What is drawn.
        arm: Of the vehicle.
        view: Directions in the world to the right and upwards, (2, 3).

    Returns:
        The coloured places.
    """
    places = found.pose[:, :3] @ view.T
    # The best pose of each place is the first one.
    _, first = np.unique(np.round(places, 6), axis=0, return_index=True)
    last_to_first = np.sort(first)[::-1]
    distances = [found.clearance, found.hull_clearance, found.reach_margin]
    room = np.min(distances, axis=0) * 1e3

    for obstacle in found.world:
        corners = _corners(obstacle) @ view.T
        _fill(axes, corners, facecolor=_OBSTACLE, edgecolor=_EDGE, zorder=0.5)
    right, upward = places[last_to_first].T
    colors = room[last_to_first]
    dots = axes.scatter(right, upward, s=22, c=colors, cmap="viridis", zorder=2)
    seen = [places]
    for number, part in enumerate(found.hull):
        corners = moved(found.base[0], _corners(part)) @ view.T
        label = "" if number else "its hull"
        outline = {"facecolor": "none", "edgecolor": Color.BLACK, "label": label}
        _fill(axes, corners, zorder=3, **outline)
        seen.append(corners)
    for number, origins in enumerate(_arms(found, arm)):
        line = origins @ view.T
        label = "" if number else "its arm"
        axes.plot(*line.T, color=Color.VERMILION, zorder=4, label=label)
        seen.append(line)
    axes.plot(*places[0], "o", color=Color.BLACK, ms=4, zorder=5, label="the best pose")
    points = found.points @ view.T
    size = 9 if len(points) <= _ARMS else 3
    label = "to be reached"
    axes.plot(*points.T, "x", color=Color.BLUE, ms=size, zorder=6, label=label)

    extent = np.vstack([*seen, points])
    low = extent.min(axis=0) - _BORDER
    high = extent.max(axis=0) + _BORDER
    axes.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    return dots


def _arms(found: Placements, arm: Arm) -> list[FloatArray]:
    """Origins of the arm's links in the world at some points, (6, 3) each."""
    lines = []
    for q in found.q[0, :: 1 + len(found.points) // _ARMS]:
        origins = [arm.forward_kinematics(q, link).translation for link in _LINKS]
        lines.append(moved(found.base[0], np.array(origins)))
    return lines


def _corners(obstacle: Obstacle) -> FloatArray:
    """Points whose convex hull is an obstacle, or nearly, (N, 3)."""
    shape = obstacle.shape
    if isinstance(shape, Mesh):
        return shape.vertices
    if shape.kind != "sphere":
        return corners_around(shape)
    (radius,) = shape.size
    turn, height = np.meshgrid(np.linspace(0, 2 * np.pi, 33), np.linspace(-1, 1, 17))
    level = np.sqrt(1 - height**2)
    unit = np.stack([level * np.cos(turn), level * np.sin(turn), height], axis=-1)
    return moved(pose(shape.xyz, (0.0, 0.0, 0.0)), radius * unit.reshape(-1, 3))


def _fill(axes: Axes, points: FloatArray, **options: Any) -> None:
    """Fill the convex hull of points (N, 2)."""
    from scipy.spatial import ConvexHull

    outline = points[ConvexHull(points).vertices]
    axes.fill(*outline.T, **options)
