"""Show an arm: picture, page or live viewer."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from alpha5_model._support.renaming import renamed

if TYPE_CHECKING:
    from alpha5_model.dynamics.arm import Arm
    from alpha5_model.planning.obstacles import Obstacle
    from alpha5_model.trajectory.motions import Motion
    from alpha5_model.viewer.visualizer import ArmVisualizer


@renamed("current", "water_velocity")
def view(
    arm: Arm,
    q: ArrayLike | None = None,
    *,
    target: ArrayLike | None = None,
    motion: Motion | None = None,
    show: Iterable[str] | None = None,
    water_velocity: ArrayLike | None = None,
    payload: Sequence[Any] | None = None,
    obstacles: Iterable[Obstacle] = (),
    curves: Mapping[str, ArrayLike] | None = None,
    port: int = 0,
) -> ArmVisualizer:
    """Start a live meshcat viewer on an arm.

    The page has a slider for each joint, controls of water, current, payload and mount,
    switches for everything that can be shown, and a player for the motion. ``open()``
    shows it in a browser, ``url()`` is its address, ``display(q)`` and ``play(q, dt)``
    move the arm in every page, ``on_change(function)`` calls back when a page moves it,
    ``captureImage()`` is a picture, ``static_html()`` is the same page as one file.

    Args:
        arm: What to show; one of your own (``a5.load(arm=record)``) is drawn with the
            joints, limits, tool and spacer of its record.
        q: Joint positions, (nq,). If None: with the tcp at the target, or at the
            nearest point that it reaches; the pose ``home`` without one.
        target: Position in base_link, (3,) [m]; the other solutions of its inverse
            kinematics are ghosts.
        motion: Played in real time by the page.
        show: Groups to show, of `alpha5_model.viewer.scene.GROUPS`; the others can be
            switched on.
        water_velocity: (3,) [m/s], in base_link if the base is fixed,
            else in the world. If it is given, the torques on the page and those of the
            motion include its estimated load.
        payload: What the arm holds, beside payloads that it has: mass [kg], centre in
            tcp (3,) [m] and displaced volume [m^3]; the mass alone is a point at the
            tcp that the water does not lift.
        obstacles: Fixed bodies in base_link, such as those of a plan.
        curves: Name -> a signal beside the motion, with one number for each of its
            samples; drawn under the arm.
        port: Of the page on this machine; 0 for a free one.

    Returns:
        An `ArmVisualizer`, which is a `meshcat.Visualizer`.

    Raises:
        InputError, UnknownNameError: Arguments that do not fit the arm.
        ViewerError: The port is taken.
    """
    from alpha5_model.viewer.build import build_scene
    from alpha5_model.viewer.visualizer import ArmVisualizer

    scene = build_scene(
        arm,
        q,
        target=target,
        motion=motion,
        show=show,
        water_velocity=water_velocity,
        payload=payload,
        obstacles=obstacles,
        curves=curves,
    )
    return ArmVisualizer(arm, scene, port)
