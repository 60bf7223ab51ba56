"""Plot of the part of the workspace that the arm reaches only in self-collision."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.collision.self_collision import without_self_collision
from alpha5_model.dynamics.load import load
from alpha5_model.kinematics.geometry import Geometry
from alpha5_model.kinematics.workspace import reachable, sampled_share
from alpha5_model.numbers.parameters import parameters
from alpha5_model.viewer.figures import Color, new_figure, style
from alpha5_model.viewer.shapes import Mesh, read_obj
from alpha5_model.viewer.workspace_plot import FILL

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Edge of the cells in which self-collision is counted [m].
CELL = 0.015
#: Bounds of the shares that have a colour of their own [%].
_STEPS = (0, 20, 40, 60, 80, 100)
#: Range of the axes [mm].
_RANGE = (-390, 390)


class _Cells(NamedTuple):
    """What the arm reaches of a grid of points.

    Attributes:
        x, y, z: Coordinates of the points, [m].
        reached: Whether the arm reaches a point, (X, Y, Z).
        free: Whether it does so without self-collision, (X, Y, Z).
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    reached: BoolArray
    free: BoolArray


@style()
def self_collision_figure(cell: float = CELL, *, samples: int) -> Any:
    """Plot, from above and the side, the share that is reached in self-collision only.

    The arm is the catalogue's, whose bodies are drawn.

    Args:
        cell: Edge of the cells whose centres are tried [m].
        samples: Points behind the share in the title.
    """
    cells = _cells(cell)
    base = _base()
    page = new_figure(9.6, 4.7)
    above, side = page.subplots(1, 2)

    _draw_view(above, cells, "y")
    _draw_base(above, base, "y")
    above.set_title("from above: share of the reached heights")

    image = _draw_view(side, cells, "z")
    _draw_base(side, base, "z")
    side.set_title("from the side: share of the reached widths")

    above.annotate(
        "theta_0 stops",
        (-300, 20),
        (-385, 330),
        fontsize=8,
        arrowprops={"arrowstyle": "-", "lw": 0.6},
    )

    found = sampled_share(without_self_collision, samples)
    share = f"{1 - found.share:.1%} ± {found.standard_error:.1%}"
    title = f"{share} of the reachable volume is reached only in self-collision"
    page.suptitle(title, fontsize=11)
    label = "reached only in self-collision [%]"
    page.colorbar(image, ax=[above, side], shrink=0.8, pad=0.02, label=label)
    return page


def _cells(cell: float) -> _Cells:
    """What the arm reaches of a grid that covers its whole workspace."""
    geometry = Geometry.of(parameters())
    x = _centered(geometry.a_0 + geometry.longest, cell)
    y = x
    z = _centered(geometry.longest, cell) + geometry.d_0
    points = np.stack(np.meshgrid(x, y, z, indexing="ij"), axis=-1)
    reached = reachable(points)
    free = np.zeros_like(reached)
    free[reached] = reachable(points[reached], accept=without_self_collision)
    return _Cells(x=x, y=y, z=z, reached=reached, free=free)


def _centered(far: float, cell: float) -> FloatArray:
    """Multiples of the edge of a cell, from -far to far or a little beyond."""
    count = math.ceil(far / cell)
    return np.asarray(cell * np.arange(-count, count + 1), np.float64)


def _base() -> Mesh:
    """The drawn body of link_0, in base_link."""
    placement = load().forward_kinematics(np.zeros(4), "link_0").homogeneous
    path = Path(REPOSITORY_PATH, "meshes", "link_0.obj")
    return read_obj(str(path)).moved(placement)


def _draw_view(axes: Axes, cells: _Cells, up: str) -> Any:
    """The share of points behind one another that are reached in self-collision only.

    Args:
        axes: Where to draw it.
        cells: What is reached.
        up: ``"y"`` from above, ``"z"`` from the side.

    Returns:
        The coloured cells.
    """
    from matplotlib.colors import BoundaryNorm, ListedColormap

    from_above = up == "y"
    rows = cells.y if from_above else cells.z
    line_of_sight = 2 if from_above else 1
    reached = cells.reached.sum(axis=line_of_sight)
    free = cells.free.sum(axis=line_of_sight)
    share = 100 * (reached - free) / np.maximum(reached, 1)
    steps = BoundaryNorm(_STEPS, ncolors=256)

    def draw(values: FloatArray, colors: Any) -> Any:
        """Colour the cells whose value is not 0."""
        return axes.pcolormesh(
            cells.x * 1e3,
            rows * 1e3,
            np.ma.masked_equal(values, 0).T,
            cmap=colors,
            norm=steps,
            shading="nearest",
        )

    draw(reached, ListedColormap([FILL]))
    image = draw(share, "viridis_r")
    axes.set(aspect="equal", xlim=_RANGE, ylim=_RANGE)
    axes.set(xlabel="x [mm]", ylabel=f"{up} [mm]")
    return image


def _draw_base(axes: Axes, base: Mesh, up: str) -> None:
    """The body of link_0, with x to the right and ``up``, y or z, upwards."""
    from matplotlib.collections import PolyCollection

    columns = [0, "xyz".index(up)]
    triangles: Any = base.vertices[base.faces][:, :, columns] * 1e3
    axes.add_collection(PolyCollection(triangles, color=Color.BLACK, linewidth=0.3))
    axes.annotate("link_0", (0, 0), (0, -14), textcoords="offset points", fontsize=8)
