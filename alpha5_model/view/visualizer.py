"""meshcat's visualizer on an arm: `display` and `play` as users of Pinocchio's know them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import meshcat
from numpy.typing import ArrayLike

from alpha5_model.checks import float_array, real
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.view.arm_poses import link_poses
from alpha5_model.view.commands import pose_commands, scene_commands, set_visible
from alpha5_model.view.page import live_page, static_page
from alpha5_model.view.scene import GROUPS, Scene
from alpha5_model.view.server import Window

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm


class ArmVisualizer(meshcat.Visualizer):  # type: ignore[misc]
    """A meshcat visualizer that shows an arm; every method of meshcat's works on it.

    Attributes:
        arm: What it shows.
        scene: Everything that can be seen of it, as it stands.
    """

    __slots__ = ["arm", "scene"]

    def __init__(self, arm: Arm, scene: Scene, port: int = 0) -> None:
        self.arm = arm
        self.scene = scene
        window = Window(
            port,
            live=lambda: live_page(self.scene),
            static=lambda commands: static_page(self.scene, commands),
        )
        super().__init__(window=window)
        for command in scene_commands(scene):
            window.send(command)

    def display(self, q: ArrayLike) -> None:
        """Show the arm at joint positions q (nq,)."""
        position = float_array("q", q, (self.arm.model.nq,))
        if position.ndim != 1:
            raise ShapeError("q", position.shape, f"shape ({self.arm.model.nq},)")
        poses = link_poses(self.arm, self.scene.tree, position)
        joints = position[len(position) - len(self.scene.sliders) :]
        self.scene = replace(self.scene, q=joints, poses=poses)
        self.window.move(pose_commands(self.scene, poses))

    def play(self, q: ArrayLike, dt: float) -> float:
        """Play joint positions in real time, dropping frames rather than falling behind.

        Args:
            q: (N, nq), one row for each time step.
            dt: Time step [s].

        Returns:
            Time that it took [s].
        """
        track = float_array("q", q, (self.arm.model.nq,))
        if track.ndim != 2 or len(track) < 1:
            raise ShapeError("q", track.shape, f"shape (N, {self.arm.model.nq})")
        step = real("dt", dt, minimum=0.0, strict=True)
        start = time.perf_counter()
        for row in _due(len(track), step, start):
            self.display(track[row])
        return time.perf_counter() - start

    def show(self, *groups: str, visible: bool = True) -> None:
        """Show or hide groups of `alpha5_model.view.scene.GROUPS`."""
        for group in groups:
            if group not in GROUPS or group in ("labels", "see-through"):
                known = ", ".join(g for g in GROUPS if g not in ("labels", "see-through"))
                raise InputError("group", group, f"one of {known}")
            self.window.send(set_visible(group, visible))
            others = tuple(name for name in self.scene.show if name != group)
            self.scene = replace(self.scene, show=(*others, group) if visible else others)

    def close(self) -> None:
        """Stop the server and free its port."""
        self.window.close()


def _due(count: int, step: float, start: float) -> Iterator[int]:
    """The sample that is due, again and again, until the last has been shown."""
    row = -1
    while row < count - 1:
        now = time.perf_counter() - start
        due = min(int(now / step), count - 1)
        if due == row:
            time.sleep((row + 1) * step - now)
            continue
        row = due
        yield row
