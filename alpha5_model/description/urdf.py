"""Variants of the URDF: their options, and their text by xacro."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice, flag, float_array
from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.description.ros2_control import (
    MOCK,
    hardware_argument,
    parameter_argument,
)
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.description.xml import text_of
from alpha5_model.errors import InputError, ShapeError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.numbers.tables import BODY_NAMES

COLLISIONS = ("primitives", "capsules", "none")
VERSIONS = ("1.0", "1.1", "1.2")
#: xacro would evaluate ``${...}`` and ``$(...)``; the others would need escapes in XML.
_FORBIDDEN = set("${}<>&\"'")


@dataclass(frozen=True)
class Variant:
    """Options of a generated URDF.

    Attributes:
        gripper: ``locked`` (4 joints) or ``jaws`` (adds axis_a and two fingers that
            follow it).
        prefix: Prefix of every link and joint name.
        parent: Name of a new link that base_link is mounted on; empty for none.
        xyz: Position of base_link in the parent [m].
        rpy: Its roll, pitch, yaw [rad].
        mesh_prefix: Folder or URI of the meshes; empty for names without one.
        collision: ``primitives``, ``none``, or ``capsules``: one for each link, which
            URDF has since version 1.1, and only with locked jaws.
        urdf_version: ``1.0``, ``1.1`` or ``1.2``. The last has limits of acceleration
            and jerk, which are written if the arm has them.
        dh_frames: Adds the massless DH frames ``dh_1`` to ``dh_5``.
        ros2_control: Adds hardware interfaces and device ids.
        ros2_control_hardware: Layout of these, with its plugin: ``mock``,
            ``alpha_hardware``, ``blue_reach_5``, or a YAML file.
        ros2_control_parameters: Parameters of the hardware, such as ``serial_port``.
            They replace the layout's, or are added to them.
        ros2_control_plugin: Another plugin than the layout's; empty for that one.
        corrections: Recorded corrections to apply.
        arm: Record of an arm of your own, which has its corrections already; None for
            the catalogue's. Its mount is used if ``parent`` is empty, its name is the
            robot's. What is attached to a link is part of its inertial.
    """

    gripper: str = "locked"
    prefix: str = ""
    parent: str = ""
    xyz: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    mesh_prefix: str = "../meshes/"
    collision: str = "primitives"
    urdf_version: str = "1.0"
    dh_frames: bool = False
    ros2_control: bool = False
    ros2_control_hardware: str = MOCK
    ros2_control_parameters: Mapping[str, str] = field(default_factory=dict)
    ros2_control_plugin: str = ""
    corrections: Iterable[str] = DEFAULT_CORRECTIONS
    arm: Alpha5Parameters | None = None

    def __post_init__(self) -> None:
        choice("gripper", self.gripper, GRIPPERS)
        choice("collision", self.collision, COLLISIONS)
        choice("urdf_version", self.urdf_version, VERSIONS)
        if self.collision == "capsules":
            self._check_capsules()
        flag("dh_frames", self.dh_frames)
        flag("ros2_control", self.ros2_control)
        _check_name("prefix", self.prefix)
        _check_name("parent", self.parent)
        self._check_mount("xyz", self.xyz)
        self._check_mount("rpy", self.rpy)
        _check_text("mesh_prefix", self.mesh_prefix)
        self._check_ros2_control()
        if self.arm is not None:
            chosen_arm(self.arm, self.corrections)

    def _check_capsules(self) -> None:
        if self.gripper == "jaws":
            raise InputError("collision", "capsules", "primitives or none, with jaws")
        if self.urdf_version == VERSIONS[0]:
            expected = "1.1 or 1.2 with capsules"
            raise InputError("urdf_version", self.urdf_version, expected)

    def _check_ros2_control(self) -> None:
        _check_text("ros2_control_plugin", self.ros2_control_plugin)
        _check_text("ros2_control_hardware", self.ros2_control_hardware)
        pairs = parameter_argument(self.ros2_control_parameters)
        _check_text("ros2_control_parameters", pairs)
        if self.ros2_control:
            hardware_argument(self.ros2_control_hardware)
            return
        given = {
            "ros2_control_hardware": self.ros2_control_hardware != MOCK,
            "ros2_control_parameters": pairs,
            "ros2_control_plugin": self.ros2_control_plugin,
        }
        for name, is_given in given.items():
            if is_given:
                raise InputError(name, getattr(self, name), "ros2_control with it")

    def _check_mount(self, name: str, value: tuple[float, float, float]) -> None:
        mount = float_array(name, value, (3,))
        if mount.ndim != 1:
            raise ShapeError(name, mount.shape, "three numbers")
        if self.parent == "" and mount.any():
            raise InputError(name, value, "a parent link to mount on")


def _check_text(name: str, text: Any) -> None:
    """Check that xacro and XML keep a text unchanged.

    Some unprintable characters do not exist in UTF-8 or XML.
    """
    printable = isinstance(text, str) and text.isprintable()
    if not printable or set(text) & _FORBIDDEN:
        allowed = "a text without any of $ { } < > & quotes or unprintable characters"
        raise InputError(name, text, allowed)


def _check_name(name: str, text: Any) -> None:
    _check_text(name, text)
    if " " in text:
        raise InputError(name, text, "a name without spaces")


def urdf(variant: Variant | None = None) -> str:
    """Text of the URDF of a variant, expanded by xacro from the published tables.

    Raises:
        Alpha5Error: See `Variant`, `UnknownNameError` for unknown corrections, and
            `InputError` for a parent with the name of one of the arm's own links.
    """
    chosen = variant or Variant()
    arm = chosen_arm(chosen.arm, chosen.corrections)
    mount = arm.mount
    parent = chosen.parent or (mount.parent if mount is not None else "")
    if parent in _link_names(chosen):
        expected = "a name that no link of the arm has; a prefix renames the arm's"
        raise InputError("parent", parent, expected)

    numbers = parameter_yaml(arm)
    with tempfile.TemporaryDirectory() as folder:
        # The committed YAML may be stale, so a fresh one is written.
        file = Path(folder) / "parameters.yaml"
        file.write_text(numbers, encoding="utf-8")
        return expand_xacro(XACRO_PATH, _xacro_arguments(chosen, file))


def _link_names(variant: Variant) -> list[str]:
    """Names of the links of the arm."""
    names = ["base_link", *BODY_NAMES, "tcp"]
    if variant.gripper == "jaws":
        names += ["jaw_rod", "finger_1", "finger_2"]
    if variant.dh_frames:
        names += [f"dh_{i}" for i in range(1, 6)]
    return [variant.prefix + name for name in names]


def _xacro_arguments(variant: Variant, parameter_file: Path) -> dict[str, str]:
    """Arguments of ``xacro/alpha5.urdf.xacro``, which have the names of the fields."""
    arguments = {
        "parameters": str(parameter_file),
        "ros2_control_hardware": hardware_argument(variant.ros2_control_hardware),
        "ros2_control_parameters": parameter_argument(variant.ros2_control_parameters),
    }
    for name, value in vars(variant).items():
        if name in arguments or name in ("corrections", "arm"):
            continue
        is_flag = isinstance(value, bool | np.bool_)
        arguments[name] = str(value).lower() if is_flag else text_of(value)
    return arguments
