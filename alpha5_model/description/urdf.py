"""Variants of the URDF: their options, and their text by xacro.

The layouts of ros2_control are in ``xacro/ros2_control_hardware.yaml``, which plain
xacro reads, too.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice, flag
from alpha5_model._support.files import read_named
from alpha5_model._support.paths import XACRO_PATH
from alpha5_model._support.yaml_reading import yaml_document
from alpha5_model.description.options import MountedOptions, check_name, check_text
from alpha5_model.description.xacro import expand_xacro
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.description.xml import text_of
from alpha5_model.errors import InputError
from alpha5_model.numbers.tables import BODY_NAMES

COLLISIONS = ("primitives", "capsules", "none")
VERSIONS = ("1.0", "1.1", "1.2")

#: Layout of ros2_control that is used if none is named: mock hardware.
MOCK = "mock"
_LAYOUTS = Path(XACRO_PATH).with_name("ros2_control_hardware.yaml")
_LAYOUT_SUFFIXES = (".yaml", ".yml")
#: Largest file of a layout of the user's own [bytes].
_MOST_BYTES = 256 * 1024
_LAYOUT = "a YAML file of a ros2_control layout"


@dataclass(frozen=True)
class Variant(MountedOptions):
    """Options of a generated URDF, beside those of `MountedOptions`.

    Attributes:
        prefix: Prefix of every link and joint name.
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
    """

    prefix: str = ""
    mesh_prefix: str = "../meshes/"
    collision: str = "primitives"
    urdf_version: str = "1.0"
    dh_frames: bool = False
    ros2_control: bool = False
    ros2_control_hardware: str = MOCK
    ros2_control_parameters: Mapping[str, str] = field(default_factory=dict)
    ros2_control_plugin: str = ""

    def __post_init__(self) -> None:
        check_name("prefix", self.prefix)
        check_name("parent", self.parent)
        super().__post_init__()
        choice("collision", self.collision, COLLISIONS)
        choice("urdf_version", self.urdf_version, VERSIONS)
        if self.collision == "capsules":
            self._check_capsules()
        flag("dh_frames", self.dh_frames)
        flag("ros2_control", self.ros2_control)
        check_text("mesh_prefix", self.mesh_prefix)
        self._check_ros2_control()

    def _check_capsules(self) -> None:
        if self.gripper == "jaws":
            raise InputError("collision", "capsules", "primitives or none, with jaws")
        if self.urdf_version == VERSIONS[0]:
            expected = "1.1 or 1.2 with capsules"
            raise InputError("urdf_version", self.urdf_version, expected)

    def _check_ros2_control(self) -> None:
        check_text("ros2_control_plugin", self.ros2_control_plugin)
        check_text("ros2_control_hardware", self.ros2_control_hardware)
        pairs = _parameter_argument(self.ros2_control_parameters)
        check_text("ros2_control_parameters", pairs)
        if self.ros2_control:
            _hardware_argument(self.ros2_control_hardware)
            return
        given = {
            "ros2_control_hardware": self.ros2_control_hardware != MOCK,
            "ros2_control_parameters": pairs,
            "ros2_control_plugin": self.ros2_control_plugin,
        }
        for name, is_given in given.items():
            if is_given:
                raise InputError(name, getattr(self, name), "ros2_control with it")


def urdf(variant: Variant | None = None) -> str:
    """Text of the URDF of a variant, expanded by xacro from the published tables.

    Raises:
        Alpha5Error: See `Variant`, and `InputError` for a parent with the name of one
            of the arm's own links.
    """
    chosen = variant or Variant()
    chosen.check_parent(_link_names(chosen))
    numbers = parameter_yaml(chosen.record)
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
        "ros2_control_hardware": _hardware_argument(variant.ros2_control_hardware),
        "ros2_control_parameters": _parameter_argument(variant.ros2_control_parameters),
    }
    for name, value in vars(variant).items():
        if name in arguments or name in ("corrections", "arm"):
            continue
        is_flag = isinstance(value, bool | np.bool_)
        arguments[name] = str(value).lower() if is_flag else text_of(value)
    return arguments


def _hardware_argument(hardware: str) -> str:
    """What xacro receives for a layout: its name, or the absolute path of a file.

    xacro checks what is in a layout, and whether it fits the gripper.

    Args:
        hardware: Name in ``xacro/ros2_control_hardware.yaml``, or a YAML file.

    Raises:
        UnknownNameError: No layout of this name.
        MissingFileError, FileFormatError: The file is not there, or is no YAML.
    """
    if hardware.endswith(_LAYOUT_SUFFIXES):
        # xacro would take minutes for some files that are no layouts.
        yaml_document(read_named(hardware, _LAYOUT, _MOST_BYTES), hardware)
        return str(Path(hardware).resolve())
    if hardware != MOCK:
        choice("ros2_control hardware", hardware, _layouts())
    return hardware


def _parameter_argument(parameters: Any) -> str:
    """What xacro receives for parameters of the hardware: NAME=VALUE with spaces.

    Raises:
        InputError: No mapping of names to texts, or one with spaces.
    """
    expected = "a mapping of names to texts, both without spaces"
    if not isinstance(parameters, Mapping):
        raise InputError("ros2_control_parameters", parameters, expected)
    pairs = []
    for name, value in parameters.items():
        are_texts = isinstance(name, str) and isinstance(value, str)
        pair = f"{name}={value}"
        if not are_texts or not name or "=" in name or " " in pair:
            raise InputError("ros2_control_parameters", pair, expected)
        pairs.append(pair)
    return " ".join(pairs)


@cache
def _layouts() -> tuple[str, ...]:
    """The names of the layouts."""
    import yaml

    return tuple(yaml.safe_load(_LAYOUTS.read_bytes()))
