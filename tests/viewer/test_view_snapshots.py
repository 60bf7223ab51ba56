"""Colours, sizes, places and words of what is drawn, as files that a person can read.

Other tests compare what is drawn with Pinocchio and the tables; this is its look. After
a change that you meant, run ``ALPHA5_UPDATE_PRINTED=1 python -m pytest
tests/viewer/test_view_snapshots.py`` and read the difference.
"""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import own_arm_dynamics as own
import pytest
from committed_texts import check_committed
from descriptions import described, figure, inline
from PIL import Image

import alpha5_model as a5
from alpha5_model.trajectory import Motion
from alpha5_model.viewer import motion_plot
from alpha5_model.viewer.build import build_scene
from alpha5_model.viewer.commands import scene_commands
from alpha5_model.viewer.comparison_plot import plot_comparison
from alpha5_model.viewer.figures import new_figure, write_figure
from alpha5_model.viewer.motion_plot import motion_figure, thin
from alpha5_model.viewer.mount_plot import mount_load_figure
from alpha5_model.viewer.page import page_data
from alpha5_model.viewer.planar_plot import new_axes, plot_planar, save
from alpha5_model.viewer.scene import GROUPS, Payload, Scene
from alpha5_model.viewer.self_collision_plot import self_collision_figure
from alpha5_model.viewer.workspace_plot import own_workspace_figure, workspace_figure

FOLDER = Path(__file__).parent / "snapshots"
#: Where axes are depends on how large the texts are.
AS_LAID_OUT = pytest.mark.skipif(
    mpl.__version_info__ < (3, 11),
    reason="matplotlib before 3.11 sizes texts otherwise",
)


def check_lines(name: str, lines: Iterable[str]) -> None:
    """Fail unless the lines equal those of the committed file of this name."""
    check_committed(FOLDER / f"{name}.txt", "\n".join(lines) + "\n")


def arm_with_made_up_masses(**options: Any) -> a5.Arm:
    """So that no snapshot changes with a printed mass."""
    printed = a5.parameters()
    links = [
        dataclasses.replace(link, mass=0.1 + 0.05 * number)
        for number, link in enumerate(printed.links)
    ]
    record = dataclasses.replace(printed, links=tuple(links))
    return a5.load(arm=record, **options)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """An arm with a payload that plays a motion, with every group shown."""
    arm = arm_with_made_up_masses().with_payload(0.3, (0.0, 0.01, 0.02), volume=1e-4)
    rows = np.linspace([2.0, 0.6, 0.9, 1.0], [2.4, 1.1, 1.4, 0.5], 5)
    motion = Motion(
        time=np.linspace(0.0, 2.0, 5),
        position=rows,
        joints=arm.joint_names,
        source="made up",
    )
    return build_scene(
        arm, rows[0], motion=motion, show=[*GROUPS], current=(0.5, 0.1, 0.0)
    )


def test_the_scene(scene: Scene) -> None:
    # The tree is Pinocchio's elsewhere, and the streams are estimates that change.
    water = scene.water._replace(streams={})
    drawn = dataclasses.replace(scene, tree=(), water=water)
    check_lines("scene", described("scene", drawn))


def test_the_scene_of_a_target() -> None:
    target = build_scene(arm_with_made_up_masses(), target=(0.25, 0.1, 0.1))
    shapes = [shape for shape in target.shapes if shape.group == "ghosts"]
    check_lines("target", described("ghosts", (shapes, target.labels, target.camera)))


def test_what_is_said_of_odd_scenes() -> None:
    """Labels, notes and poses of scenes in which something is out of the ordinary."""
    arm = arm_with_made_up_masses()
    beside = a5.load(arm=own.RECORDS[0])
    mounted = a5.load(arm=own.RECORDS[9], gripper="jaws")
    scenes = {
        "far target": build_scene(arm, target=(2.0, 0.1, 0.3)),
        "beyond limits": build_scene(arm, [7.0, 1.0, 1.0, 1.0]),
        "at limits": build_scene(arm, [0.01745 - 0.9e-9, 1.0, 1.0, 1.0]),
        "still water": build_scene(arm, current=(0.0, 0.0, 0.0)),
        "heavy payload": build_scene(arm, payload=Payload(mass=6.0)),
        "tool beside": build_scene(beside, target=(0.27, -0.19, 0.09)),
        "tool beside, far": build_scene(beside, target=(2.0, 0.0, 0.0)),
        "mounted": build_scene(mounted),
    }
    groups = ("ghosts", "current", "payload")
    lines = []
    for name, odd in scenes.items():
        lines.append(f"{name}: q {inline(odd.q)} shows {odd.show}")
        lines += [f"{name}: note {note}" for note in odd.notes[1:-1]]
        texts = [label.text for label in odd.labels if label.group in odd.show]
        lines.append(f"{name}: {' | '.join(texts)}")
        lines += [
            f"{name}: {shape.group}/{shape.name} {inline(shape.mesh.vertices)}"
            for shape in odd.shapes
            if shape.group in odd.show and shape.group in groups
        ]
    data = page_data(scenes["mounted"])
    for part in ("travel", "attitude", "own"):
        lines.append(f"mounted: {part} {inline(data[part])}")
    for body in data["statics"]["beyond"]:
        lines.append(f"mounted: beyond {inline(body)}")
    check_lines("odd_scenes", lines)


def test_the_data_of_the_page(scene: Scene) -> None:
    data = page_data(scene)
    for seen_elsewhere in ("labels", "anchors", "tree", "statics", "water"):
        del data[seen_elsewhere]
    check_lines("page", described("page", data))


def test_the_commands_of_meshcat(scene: Scene) -> None:
    first = {shape.group: shape for shape in reversed(scene.shapes)}
    few = dataclasses.replace(scene, shapes=tuple(first.values()))
    lines = []
    for command in scene_commands(few):
        lines += described(command["type"], without_arrays(command), depth=0)
    check_lines("commands", lines)


def without_arrays(part: object) -> object:
    """A command whose packed arrays are replaced by their kind and size."""
    if isinstance(part, dict):
        return {key: without_arrays(value) for key, value in part.items()}
    if isinstance(part, list | tuple):
        return [without_arrays(value) for value in part]
    if hasattr(part, "data") and hasattr(part, "type"):
        return f"packed {part.type} {len(part.data)} bytes"
    return part


@AS_LAID_OUT
def test_the_plot_of_the_workspace() -> None:
    lines = [*figure(workspace_figure())]
    printed = a5.parameters()
    rows = [dataclasses.replace(row, a=3 * row.a, d=3 * row.d) for row in printed.dh]
    large = dataclasses.replace(printed, dh=tuple(rows))
    lines += figure(own_workspace_figure(large))
    check_lines("workspace", lines)


@AS_LAID_OUT
def test_the_plot_of_self_collision() -> None:
    check_lines("self_collision", figure(self_collision_figure(samples=400)))


@AS_LAID_OUT
def test_the_plot_of_a_motion() -> None:
    """With measured torques, a motor's limits and a current of the water."""
    arm = arm_with_made_up_masses()
    time = np.linspace(0.0, 3.0, 500)
    turned = np.multiply.outer(time, [2.0, 1.3, 0.9, 2.6])
    phase = turned + np.array([0.1, 0.9, 2.0, 0.4])
    middle = np.array([2.0, 1.2, 1.4, 1.0])
    motion = a5.trajectory.motion(
        time, middle + 0.4 * np.sin(phase), effort=0.3 * np.cos(phase)
    )
    analysis = a5.trajectory.analyse(
        motion,
        arm,
        supply_voltage=24.0,
        current_limit=0.8,
        current=(0.2, 0.0, -0.1),
    )
    page = motion_figure(analysis)
    check_lines("motion", figure(page))
    time_axes = page.axes[0].get_shared_x_axes()
    shared = [time_axes.joined(page.axes[0], axes) for axes in page.axes]
    assert shared == [True] * (len(page.axes) - 1) + [False]  # the last is the path


@pytest.mark.slow
@AS_LAID_OUT
def test_the_plot_of_a_long_motion_with_jaws() -> None:
    """With measured currents and more samples than are drawn; panels of two joints.

    They are the jaws, whose motor has no known current, and the joint before them,
    which is almost at rest.
    """
    arm = arm_with_made_up_masses(gripper="jaws")
    time = np.linspace(0.0, 8.0, 6001)
    turned = 0.4 * np.sin(np.multiply.outer(time, [2.0, 1.3, 0.9, 2.6, 1.7]))
    middle = np.array([2.0, 1.2, 1.4, 1.0, 0.006])
    position = middle + turned * np.array([1.0, 1.0, 1.0, 0.001, 0.01])
    motion = dataclasses.replace(
        a5.trajectory.motion(time, position), current=0.1 * turned
    )
    lines = [*figure(motion_figure(a5.trajectory.analyse(motion, arm)))]
    joints = tuple(f"axes {number}:" for number in range(9, 15))
    kept = [line for line in lines if line.startswith(("page", *joints))]
    kept += [line for line in lines if " title " in line]
    check_lines("long_motion", kept)


def test_the_largest_torque_is_that_of_a_rotary_joint() -> None:
    """Its magnitude is told; the force of the jaws' rod is another quantity."""
    values = np.array([[0.1, 0.2, 0.3, -0.5, 9.0], [0.0, np.nan, 0.4, 0.2, -9.0]])
    for column, size in ((3, "0.5"), (0, "2")):
        assert motion_plot._most(values, tuple("abcde"), "N·m") == (
            f"at most {size} N·m ({'abcde'[column]})"
        )
        values[1, 0] = 2.0


@pytest.mark.parametrize(("names", "columns"), [(5, 5), (6, 3), (7, 4), (8, 4)])
def test_a_row_of_the_legend_has_at_most_five_names(
    names: int, columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its rows are as even as can be."""
    monkeypatch.setattr(motion_plot, "_title", lambda analysis: "")
    page = new_figure(6.0, 4.0)
    axes = page.subplots()
    for number in range(names):
        axes.plot([], [], label=f"cause {number}")
    motion_plot._title_page(page, axes, None)  # type: ignore[arg-type]
    (legend,) = page.legends
    assert legend._ncols == columns


def test_a_long_curve_is_drawn_by_its_extremes() -> None:
    """By the lowest and highest of each of at most 2000 stretches of samples."""
    drawn = {}
    for count in (4000, 4001, 6000, 6001):
        time = np.arange(float(count))
        values = np.where(time % 3 == 1, time, -time)
        drawn[count], found = thin(time, values)
        np.testing.assert_array_equal(found, values[drawn[count].astype(int)])
    np.testing.assert_array_equal(drawn[4000], np.arange(4000.0))
    for count in (4001, 6000):
        # Of three samples in turn the second is highest, and the third lowest.
        first = np.arange(0.0, count // 3 * 3, 3.0)
        extremes = np.stack([first + 1, first + 2], axis=1).ravel()
        np.testing.assert_array_equal(drawn[count], [*extremes, count - 1.0])
    # One sample more, and each stretch is four samples long.
    assert len(drawn[6001]) == 2 * (6001 // 4) + 1


def _write_with_another_link_2(path: Path) -> None:
    """Our arm, with 0.1 kg, 2 mm and 30 kg mm^2 more in its second link."""
    tree = ET.parse(a5.URDF_PATH)
    inertial = tree.getroot().find("link[@name='link_2']/inertial")
    assert inertial is not None
    more = {"mass/value": 0.1, "origin/xyz": [0.0, 0.002, 0.0], "inertia/ixx": 3e-5}
    for place, change in more.items():
        tag, attribute = place.split("/")
        element = inertial.find(tag)
        assert element is not None
        numbers = np.array(element.attrib[attribute].split(), dtype=float) + change
        element.set(attribute, " ".join(f"{number:.9f}" for number in numbers))
    tree.write(path)


@AS_LAID_OUT
def test_the_plot_of_a_comparison(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = []

    def write(page: Any, path: Path) -> Path:
        drawn.append(page)
        return write_figure(page, path)

    monkeypatch.setattr("alpha5_model.viewer.comparison_plot.write_figure", write)
    path = tmp_path / "changed.urdf"
    _write_with_another_link_2(path)
    written = plot_comparison(a5.compare(path), tmp_path / "errors.png")
    lines = [*figure(drawn[0]), f"pixels: {pixels(written)}"]
    check_lines("comparison", lines)


@AS_LAID_OUT
def test_the_plot_of_planar_arms(tmp_path: Path) -> None:
    arms = (
        a5.planar.PlanarArm((3, 2), [(-1, 2), None]),
        a5.planar.PlanarArm((0.1, 0.2, 0.1)),  # a circle, up to rounding
        a5.planar.PlanarArm((5, 4, 1), [(-2.967, 2.967)] * 3),  # a map
        a5.planar.PlanarArm((1, 2, 1), [None, None, (0, 3)], "RRP"),
        a5.planar.PlanarArm((2,)),  # a line without area
        a5.planar.PlanarArm((4, 3, 2, 1), [(-1, 2), None, None, None]),
    )
    panels = new_axes(columns=2, rows=3)
    for arm, axes in zip(arms, panels.flat, strict=True):
        plot_planar(arm, axes=axes)
    lines = [*figure(panels.flat[0].figure)]
    alone = plot_planar(a5.planar.PlanarArm((5, 4)), [0.3, 1.1], dexterous=False)
    lines += figure(alone.figure)
    save(alone, tmp_path / "alone.png")
    lines.append(f"pixels: {pixels(tmp_path / 'alone.png')}")
    check_lines("planar", lines)


def pixels(path: Path) -> tuple[int, int]:
    with Image.open(path) as image:
        return image.size


@AS_LAID_OUT
def test_the_plot_of_the_load_on_the_mount() -> None:
    check_lines(
        "mount",
        figure(mount_load_figure(arm_with_made_up_masses(), [3.0, 1.0, 1.0, 0.5], 0.5)),
    )
