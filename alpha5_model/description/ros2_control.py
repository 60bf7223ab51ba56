"""What a variant says of its ros2_control block, checked before xacro writes it.

The layouts are in ``xacro/ros2_control_hardware.yaml``, which plain xacro reads, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from alpha5_model._support.checks import choice
from alpha5_model._support.files import read_named
from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.errors import FileFormatError, InputError

#: Layout that is used if none is named: mock hardware.
MOCK = "mock"
_LAYOUTS = Path(XACRO_PATH).with_name("ros2_control_hardware.yaml")
_SUFFIXES = (".yaml", ".yml")
#: Largest file of a layout of the user's own [bytes].
_MOST = 256 * 1024
#: Levels of a layout are three: its table, joint_parameters, those of a joint.
_LEVELS = 8
_EXPECTED = "a YAML file of a ros2_control layout"


def hardware_argument(hardware: str) -> str:
    """What xacro receives for a layout: its name, or the absolute path of a file.

    xacro checks what is in a layout, and whether it fits the gripper.

    Args:
        hardware: Name in ``xacro/ros2_control_hardware.yaml``, or a YAML file.

    Raises:
        UnknownNameError: No layout of this name.
        MissingFileError, FileFormatError: The file is not there, or is no YAML.
    """
    if hardware.endswith(_SUFFIXES):
        _check_file(hardware)
        return str(Path(hardware).resolve())
    if hardware != MOCK:
        choice("ros2_control hardware", hardware, _layouts())
    return hardware


def parameter_argument(parameters: Any) -> str:
    """What xacro receives for parameters of the hardware: NAME=VALUE with spaces.

    Raises:
        InputError: No mapping of names to texts, or one with spaces.
    """
    expected = "a mapping of names to texts, both without spaces"
    if not isinstance(parameters, Mapping):
        raise InputError("ros2_control_parameters", parameters, expected)
    pairs = []
    for name, value in parameters.items():
        texts = isinstance(name, str) and isinstance(value, str)
        pair = f"{name}={value}"
        if not texts or not name or "=" in name or " " in pair:
            raise InputError("ros2_control_parameters", pair, expected)
        pairs.append(pair)
    return " ".join(pairs)


@cache
def _layouts() -> tuple[str, ...]:
    """The names of the layouts."""
    import yaml

    return tuple(yaml.safe_load(_LAYOUTS.read_bytes()))


def _check_file(path: str) -> None:
    """Check what xacro would not: that the file is YAML of a few levels, no aliases.

    A few aliases of aliases stand for more text than a machine can hold, and deep
    levels take the reader quadratic time.
    """
    import yaml

    content = read_named(path, _EXPECTED, _MOST)
    level = 0
    try:
        for event in yaml.parse(content, yaml.SafeLoader):
            if isinstance(event, yaml.AliasEvent):
                raise FileFormatError(path, f"no alias such as *{event.anchor}")
            level += isinstance(event, yaml.CollectionStartEvent)
            level -= isinstance(event, yaml.CollectionEndEvent)
            if level > _LEVELS:
                raise FileFormatError(path, f"more than {_LEVELS} levels")
    except yaml.YAMLError as error:
        problem = " ".join(str(error).split())
        raise FileFormatError(path, f"not YAML: {problem}") from None
