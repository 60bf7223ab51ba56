"""Figures that explain the concepts: side views of the drawn bodies with numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.numbers.fluids import GRAVITY
from alpha5_model.numbers.inertia import flip_products, second_moments
from alpha5_model.viewer.figures import Color, new_figure, number, style
from alpha5_model.viewer.planar_plot import new_axes, plot_planar
from alpha5_model.viewer.shapes import read_obj

BODY = "#D9DEE3"
#: Arm in the plane y = 0, facing +x [rad].
SIDE = np.array([np.pi, 0.75, 1.35, 0.0])


#: Seen along y: x to the right, z up.
ALONG_Y = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def side_view(axes: Any, q: np.ndarray, view: np.ndarray = ALONG_Y) -> None:
    """The bodies at a joint position, in mm, seen through a view (2, 3)."""
    import pinocchio as pin

    arm, folder = a5.load(), str(Path(a5.URDF_PATH).parent)
    geometry = pin.buildGeomFromUrdf(
        arm.model, a5.URDF_PATH, pin.GeometryType.VISUAL, package_dirs=[folder]
    )
    placed = geometry.createData()
    pin.updateGeometryPlacements(arm.model, arm.data, geometry, placed, q)
    for body, pose in zip(geometry.geometryObjects, placed.oMg, strict=True):
        outline(axes, body.meshPath, pose.homogeneous, view)


def outline(axes: Any, mesh: str, pose: np.ndarray, view: np.ndarray) -> None:
    """The filled outline of a body, in mm."""
    from matplotlib.collections import PolyCollection

    moved = read_obj(mesh).moved(pose)
    faces = moved.vertices[moved.faces] @ view.T * 1e3
    look = {"facecolor": BODY, "edgecolor": BODY, "linewidth": 0.4, "zorder": 1}
    axes.add_collection(PolyCollection(faces, **look))


def _arrow(
    axes: Any, start: np.ndarray, change: np.ndarray, color: str, width: float
) -> None:
    look = {
        "arrowstyle": "-|>",
        "color": color,
        "lw": width,
        "shrinkA": 0,
        "shrinkB": 0,
    }
    axes.annotate("", start + change, start, arrowprops=look, zorder=5)


def written_at(
    axes: Any, text: str, at: Any, shift: tuple[int, int], **look: Any
) -> None:
    side = "left" if shift[0] >= 0 else "right"
    box = {"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 0.6}
    given = {
        "fontsize": 9,
        "ha": side,
        "va": "center",
        "bbox": box,
        "zorder": 7,
        **look,
    }
    axes.annotate(text, at, shift, textcoords="offset points", **given)


def look_at(
    axes: Any, x: tuple[float, float], z: tuple[float, float], name: str = "z [mm]"
) -> None:
    axes.set(aspect="equal", xlim=x, ylim=z, xlabel="x [mm]", ylabel=name)


@style()
def frames_figure() -> Any:
    """Frames and joint axes, side view."""
    page = new_figure(9.6, 6.0)
    axes = page.subplots()
    side_view(axes, SIDE)
    arm = a5.load()
    poses = {f.name: arm.forward_kinematics(SIDE, f.name) for f in arm.model.frames}
    for name, text, shift in (
        ("base_link", "base_link, link_0", (-12, -22)),
        ("link_1", "link_1", (10, -22)),
        ("link_2", "link_2", (22, 14)),
        ("link_3", "link_3", (-26, 2)),
        ("link_4", "link_4", (26, 8)),
        ("tcp", "tcp", (14, 2)),
    ):
        at = poses[name].translation[[0, 2]] * 1e3
        for axis, color in ((0, Color.VERMILION), (1, Color.GREEN), (2, Color.BLUE)):
            along = poses[name].rotation[[0, 2], axis]
            if np.linalg.norm(along) > 0.1:
                _arrow(axes, at, 42 * along, color, 1.8)
        axes.plot(*at, "o", ms=4, color=Color.BLACK, zorder=6)
        written_at(axes, text, at, shift)
    line = {"color": Color.BLACK, "lw": 0.8, "ls": (0, (6, 3, 1, 3)), "zorder": 2}
    for joint, link, reach in (
        ("axis_e", "link_1", (-70, 130)),
        ("axis_b", "link_4", (-215, 60)),
    ):
        at, along = (
            poses[link].translation[[0, 2]] * 1e3,
            poses[link].rotation[[0, 2], 2],
        )
        axes.plot(*np.array([at + s * along for s in reach]).T, **line)
        written_at(
            axes,
            f"{joint}: in the plane",
            at + reach[1] * along,
            (8, 0),
            style="italic",
        )
    for joint, link, shift in (
        ("axis_d", "link_2", (92, 30)),
        ("axis_c", "link_3", (-84, -26)),
    ):
        at = poses[link].translation[[0, 2]] * 1e3
        axes.plot(*at, "o", ms=15, mfc="none", mec=Color.BLACK, mew=0.8, zorder=4)
        written_at(
            axes, f"{joint}: square to it", at, shift, style="italic", ha="center"
        )
    for color, text in ((Color.VERMILION, "x"), (Color.GREEN, "y"), (Color.BLUE, "z")):
        axes.plot([], [], color=color, label=text)
    axes.legend(
        loc="upper left", ncols=3, title="axes that lie in the picture", fontsize=9
    )
    angles = ", ".join(f"{x:.0f}°" for x in np.degrees(SIDE))
    axes.set_title(
        f"frames at q = ({angles}), seen along y: "
        "the arm moves in a plane that axis_e turns"
    )
    look_at(axes, (-150, 330), (-115, 185))
    return page


@style()
def products_figure() -> Any:
    """What the sign of the products of inertia does: the ellipse of link 3's mass,
    right and wrong.
    """
    page = new_figure(9.0, 5.0)
    link = a5.parameters().links[3]
    panels = page.subplots(1, 2, sharey=True)
    for axes, inertia, title, color in (
        (panels[0], link.inertia, "products as negative integrals (URDF)", Color.GREEN),
        (
            panels[1],
            flip_products(link.inertia),
            "the printed signs, copied",
            Color.VERMILION,
        ),
    ):
        outline(
            axes,
            str(Path(REPOSITORY_PATH, "meshes", "link_3.obj")),
            np.eye(4),
            np.eye(3)[:2],
        )
        spread = second_moments(inertia)[:2, :2] / link.mass
        size, turn = np.linalg.eigh(spread)
        circle = np.linspace(0, 2 * np.pi, 200)
        round_ = np.stack([np.cos(circle), np.sin(circle)]) * np.sqrt(5 * size)[:, None]
        centre = link.com[:2]
        axes.plot(
            *(turn @ round_ + centre[:, None]) * 1e3, color=color, lw=2.2, zorder=4
        )
        for axis, length in zip(turn.T, np.sqrt(5 * size), strict=True):
            ends = np.array([centre - length * axis, centre + length * axis]) * 1e3
            axes.plot(*ends.T, color=color, lw=1.0, ls="--", zorder=4)
        axes.plot(*centre * 1e3, "o", color=Color.BLACK, ms=5, zorder=5)
        written_at(axes, "COM", centre * 1e3, (8, -10))
        axes.set_title(f"{title}\nixy = {number(inertia[0, 1] * 1e6)} kg·mm²")
        look_at(axes, (-45, 65), (-65, 40), "y of link_3 [mm]")
        axes.set_xlabel("x of link_3 [mm]")
    panels[1].set_ylabel("")
    return page


@style()
def buoyancy_figure() -> Any:
    """Weights at the COMs, buoyancy at the COBs, and the torque of each at rest."""
    page = new_figure(9.0, 5.4)
    panels = page.subplot_mosaic(
        [["weight", "lift"], ["torque", "torque"]], height_ratios=(1.5, 1)
    )
    left, middle, right = panels["weight"], panels["lift"], panels["torque"]
    q, arm, links = SIDE, a5.load(), a5.parameters().links
    down, per_newton = float(GRAVITY[2]), 20.0
    for axes, title, color in (
        (left, "the arm: weight at the COM", Color.VERMILION),
        (middle, "the displaced fluid: buoyancy at the COB", Color.BLUE),
    ):
        side_view(axes, q)
        for link in links:
            pose = arm.forward_kinematics(q, link.name)
            weight = axes is left
            point = link.com if weight else link.cob
            force = (
                link.mass * down if weight else -arm.fluid_density * link.volume * down
            )
            at = pose.act(np.array(point))[[0, 2]] * 1e3
            _arrow(axes, at, np.array([0.0, per_newton * force]), color, 2.0)
            axes.plot(*at, "o", ms=4, color=Color.BLACK, zorder=6)
            written_at(
                axes, f"{abs(force):.1f} N", at, (5, 4 if weight else -6), fontsize=8
            )
        axes.set_title(title)
        look_at(axes, (-150, 330), (-110, 150))
    middle.set_ylabel("")
    names = arm.joint_names
    rows = np.arange(len(names))
    for offset, values, color, text in (
        (-0.27, arm.gravity_torque(q), Color.VERMILION, "weight"),
        (0.0, -arm.buoyancy_torque(q), Color.BLUE, "buoyancy"),
        (0.27, arm.hydrostatic_torque(q), Color.BLACK, "left to hold"),
    ):
        right.barh(rows + offset, values, height=0.25, color=color, label=text)
    right.set_yticks(rows, names)
    right.invert_yaxis()
    right.axvline(0, color=Color.BLACK, lw=0.8)
    right.legend(fontsize=8, loc="lower right")
    held, weight = (
        np.abs(torque(q)).max()
        for torque in (arm.hydrostatic_torque, arm.gravity_torque)
    )
    right.set_title(
        f"torque at rest: {number(held)} N·m are left to hold of {number(weight)} N·m"
    )
    right.set_xlabel("[N·m]")
    return page


@style()
def branches_figure() -> Any:
    """The four solutions of one target."""
    page = new_figure(9.6, 7.6)
    target = np.array([0.18, 0.05, 0.16])
    along = target[:2] / np.linalg.norm(target[:2])
    # The vertical plane through the target.
    view = np.array([[*along, 0.0], [0.0, 0.0, 1.0]])
    found = a5.inverse_kinematics(target)
    arm = a5.load()
    page.suptitle(
        f"{found.exists.sum()} ways to one target, "
        f"{found.within_limits.sum()} within the limits",
        fontsize=11,
    )
    for axes, name, q, allowed in zip(
        page.subplots(2, 2).flat, a5.BRANCHES, found.q, found.within_limits, strict=True
    ):
        color = Color.BLUE if allowed else Color.VERMILION
        side_view(axes, q, view)
        frames = ("link_2", "link_3", "tcp")
        points = (
            np.array([view @ arm.forward_kinematics(q, f).translation for f in frames])
            * 1e3
        )
        points = np.vstack([[0.0, points[0, 1]], points])
        axes.plot(*points.T, "-", color=color, lw=2.4, zorder=4)
        axes.plot(*points[1:3].T, "o", ms=7, mfc="white", mec=color, mew=2, zorder=5)
        axes.plot(*view @ target * 1e3, "*", ms=14, color=Color.BLACK, zorder=6)
        axes.axvline(0, color=Color.BLACK, lw=0.8, ls=(0, (6, 3, 1, 3)))
        angles = ", ".join(f"{x:.0f}°" for x in np.degrees(q[:3]))
        verdict = "within the limits" if allowed else "beyond a joint limit"
        axes.set_title(f"{name}: ({angles})\n{verdict}")
        look_at(axes, (-200, 260), (-120, 280))
        axes.set_xlabel(
            "distance from the yaw axis, towards the target [mm]", fontsize=8
        )
    return page


def dexterity_figure() -> Any:
    """A planar arm with and without joint limits: workspace and dexterous workspace."""
    panels = new_axes(2)
    limits = [(-2.967, 2.967)] * 3
    plot_planar(a5.planar.PlanarArm([5, 4, 1]), axes=panels[0])
    plot_planar(
        a5.planar.PlanarArm([5, 4, 1], limits=limits), axes=panels[1], resolution=121
    )
    return panels[0].figure


FIGURES = {
    "frames.png": frames_figure,
    "products.png": products_figure,
    "buoyancy.png": buoyancy_figure,
    "branches.png": branches_figure,
    "dexterity.png": dexterity_figure,
}
