"""Variants of the URDF: what can be chosen, the parameters that xacro is given, and what it makes of them.

The xacro library is called here only.
"""

from __future__ import annotations

import importlib
import os
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from alpha5_model._support.checks import choice, flag, float_array
from alpha5_model._support.files import read_named
from alpha5_model._support.paths import XACRO_PATH
from alpha5_model.description.bodies import (
    Body,
    arm_bodies,
    fixed_frames,
    provenance,
    template,
    text_of,
)
from alpha5_model.description.srdf import NAMED_POSES
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    MissingFileError,
    ShapeError,
)
from alpha5_model.geometry.materials import MATERIALS
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.jaws import GRIPPERS
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

COLLISIONS = ("primitives", "none")
_PLUGIN = "mock_components/GenericSystem"
#: What is written of a joint that has it; fingers have no device, arm joints follow none.
_JOINT = ("lower", "upper", "velocity", "effort", "device_id", "multiplier", "offset")


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
            # xacro would evaluate ${...} and $(...), names would hide XML escapes, and some unprintable
            # characters do not exist in UTF-8 or XML
            if not (isinstance(text, str) and text.isprintable()) or set(text) & set(
                "${}<>&\"'"
            ):
                allowed = (
                    "a text without any of $ { } < > & quotes or unprintable characters"
                )
                raise InputError(name, text, allowed)
            if name in ("prefix", "parent") and " " in text:
                raise InputError(name, text, "a name without spaces")
            if (
                name == "ros2_control_plugin"
                and text != _PLUGIN
                and not self.ros2_control
            ):
                raise InputError(name, text, "ros2_control with it")


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
        values.write_text(
            parameter_yaml(parameters(chosen.corrections)), encoding="utf-8"
        )
        arguments = {"parameters": str(values)}
        for name, x in vars(chosen).items():
            if name != "corrections":
                arguments[name] = (
                    str(x).lower() if isinstance(x, bool | np.bool_) else text_of(x)
                )
        text = expand_xacro(XACRO_PATH, arguments)
    if chosen.parent and text.count(f'<link name="{chosen.parent}"') > 1:
        raise InputError("parent", chosen.parent, "a name that no link of the arm has")
    return text


def parameter_yaml(parameters: Alpha5Parameters) -> str:
    """Text of ``xacro/parameters.yaml`` for these parameters.

    Numbers are written so that they read back as the same doubles.
    """
    import yaml

    locked, jaws = arm_bodies(parameters, "locked"), arm_bodies(parameters, "jaws")[4:]
    source, joints = provenance(parameters), parameters.joints
    home = zip(joints, (*NAMED_POSES["home"], joints[4].lower), strict=True)
    content = {
        "provenance": source,
        "materials": {m.name: list(m.rgba) for m in MATERIALS},
        **_tree(locked),
        "frames": {
            name: asdict(frame) for name, frame in fixed_frames(parameters).items()
        },
        "jaws": _tree(jaws),
        # where mock hardware starts; at zero the arm is out of its limits and in collision
        "home": {joint.name: position for joint, position in home},
    }
    text: str = yaml.safe_dump(
        content, sort_keys=False, default_flow_style=None, width=110
    )
    return template("parameters_head.yaml").format(**source) + text


def _tree(bodies: tuple[Body, ...]) -> dict[str, Any]:
    """Links, and the joints of all but the first: link_0 has none, link_4's is among the arm's."""
    links, joints = {}, {}
    for body in bodies:
        shapes, joint = [asdict(shape) for shape in body.shapes], body.joint
        own = {"mass": body.mass, "com": body.com.tolist(), "inertia": body.moments}
        links[body.name] = {**own, "collision": shapes}
        if joint is not None and body is not bodies[0]:
            own = {key: getattr(joint, key) for key in _JOINT if hasattr(joint, key)}
            joints[joint.name] = {**asdict(body.placement), "child": body.name, **own}
    return {"links": links, "joints": joints}


def expand_xacro(
    path: str | os.PathLike[str],
    arguments: Mapping[str, str] | None = None,
    packages: Mapping[str, str] | None = None,
) -> str:
    """Expand a xacro file.

    Args:
        path: The file.
        arguments: Values of its ``xacro:arg`` elements, as text.
        packages: Folders of the packages that it names in ``$(find NAME)``.

    Returns:
        The XML text, without xacro's banner, which names the input's path on this machine, and
        without the comments above the root element, which are about the source.

    Raises:
        InputError, MissingFileError, FileFormatError: See `read_named`.
        FileFormatError: xacro cannot expand it.
    """
    import xacro

    # Beside a folder named xacro/, Python finds that folder if the library is missing.
    process: Any = getattr(xacro, "process_file", None)
    if process is None:
        raise MissingFileError("xacro", "the xacro library to be installed")
    read_named(path, "a xacro file")
    # xacro asks the index of ROS for the folders of $(find NAME), which need not be there.
    module: Any = importlib.import_module("xacro.substitution_args")
    before = module._eval_find

    def find(name: str) -> str:
        if packages and name in packages:
            return str(Path(packages[name]).resolve())
        try:
            return str(before(name))
        except Exception:
            raise LookupError(f"no folder for package {name}") from None

    module._eval_find = module._eval_dict["find"] = find
    try:
        # xacro writes into the mapping that it is given.
        document = process(os.fspath(path), mappings=dict(arguments or {}))
    except Exception as error:
        raise FileFormatError(path, f"xacro: {' '.join(str(error).split())}") from None
    finally:
        module._eval_find = module._eval_dict["find"] = before
    text: str = document.documentElement.toprettyxml(indent="  ")
    lines = [line for line in text.splitlines() if line.strip()]
    return "\n".join(['<?xml version="1.0" ?>', *lines, ""])
