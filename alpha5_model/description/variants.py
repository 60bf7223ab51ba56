"""Variants of the URDF: what can be chosen, and the text that a choice gives."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from alpha5_model.checks import choice, flag, float_array
from alpha5_model.corrections import DEFAULT_CORRECTIONS
from alpha5_model.description.expand import expand_xacro
from alpha5_model.description.parameter_file import parameter_yaml
from alpha5_model.description.xml_text import text_of
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.jaws import GRIPPERS
from alpha5_model.parameters import parameters
from alpha5_model.paths import XACRO_PATH

COLLISIONS = ("primitives", "none")
_PLUGIN = "mock_components/GenericSystem"


@dataclass(frozen=True)
class Variant:
    """What can be chosen about a generated URDF.

    Attributes:
        gripper: ``locked`` (4 joints) or ``jaws`` (adds axis_a and two fingers that follow it).
        prefix: Stands before every link and joint name.
        parent: Name of a link to mount on, which is then made; empty for none.
        xyz: Mount of base_link in the parent [m].
        rpy: Its roll, pitch, yaw [rad].
        mesh_prefix: Stands before the file name of every mesh.
        collision: ``primitives`` or ``none``.
        dh_frames: Adds the massless DH frames ``dh_1`` to ``dh_5``.
        ros2_control: Adds hardware interfaces and device ids.
        ros2_control_plugin: Name of the hardware plugin.
        corrections: Recorded corrections to apply.
    """

    gripper: str = "locked"
    prefix: str = ""
    parent: str = ""
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mesh_prefix: str = "../meshes/"
    collision: str = "primitives"
    dh_frames: bool = False
    ros2_control: bool = False
    ros2_control_plugin: str = _PLUGIN
    corrections: Iterable[str] = DEFAULT_CORRECTIONS

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        choice("collision", self.collision, COLLISIONS)
        flag("dh_frames", self.dh_frames)
        flag("ros2_control", self.ros2_control)
        for name in ("xyz", "rpy"):
            mount = float_array(name, getattr(self, name), (3,))
            if mount.ndim != 1:
                raise ShapeError(name, mount.shape, "three numbers")
            if self.parent == "" and mount.any():
                raise InputError(name, getattr(self, name), "a parent link to mount on")
        for name in ("prefix", "parent", "mesh_prefix", "ros2_control_plugin"):
            text = getattr(self, name)
            # xacro would evaluate ${...} and $(...), XML escapes would hide in names, and neither UTF-8
            # nor XML has a place for what cannot be printed
            if not (isinstance(text, str) and text.isprintable()) or set(text) & set("${}<>&\"'"):
                raise InputError(
                    name, text, "a text without any of $ { } < > & quotes or unprintable characters"
                )
            if name in ("prefix", "parent") and " " in text:
                raise InputError(name, text, "a name without spaces")
        if self.ros2_control_plugin != _PLUGIN and not self.ros2_control:
            raise InputError(
                "ros2_control_plugin", self.ros2_control_plugin, "ros2_control with it"
            )


def urdf(variant: Variant | None = None) -> str:
    """Text of the URDF of a variant, expanded by xacro from the published tables.

    Raises:
        Alpha5Error: See `Variant`, `UnknownNameError` for unknown corrections, and `InputError` for
            a parent with the name of one of the arm's own links.
    """
    chosen = variant or Variant()
    with tempfile.TemporaryDirectory() as folder:
        # From the tables, never from the committed YAML: that one may be stale.
        values = Path(folder) / "parameters.yaml"
        values.write_text(parameter_yaml(parameters(chosen.corrections)), encoding="utf-8")
        arguments = {
            name: _xacro_text(x) for name, x in vars(chosen).items() if name != "corrections"
        }
        text = expand_xacro(XACRO_PATH, {**arguments, "parameters": str(values)})
    if chosen.parent and text.count(f'<link name="{chosen.parent}"') > 1:
        raise InputError("parent", chosen.parent, "a name that no link of the arm has")
    return text


def _xacro_text(value: str | bool | Iterable[float]) -> str:
    return str(value).lower() if isinstance(value, bool | np.bool_) else text_of(value)
