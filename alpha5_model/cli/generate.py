"""``alpha5 generate``: the description of any variant of the arm, in any folder."""

from __future__ import annotations

import sys
from argparse import Namespace
from collections.abc import Callable, Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.checks import choice
from alpha5_model._support.files import is_stream
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.cli import options as common
from alpha5_model.cli import printing
from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.quantities import ANGLE, LENGTH, Vector
from alpha5_model.codegen.c_library import COptions, c_files
from alpha5_model.description import mjcf, sdf
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.moveit import moveit_files
from alpha5_model.description.srdf import srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.usd import UsdOptions, usd_files
from alpha5_model.description.water_table import WaterOptions, water_files
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.description.xml import without_armature
from alpha5_model.errors import OutputError
from alpha5_model.numbers.corrections import DEFAULT_CORRECTIONS
from alpha5_model.numbers.parameters import chosen_arm

HELP = """
Without --output the main file goes to standard output.

At joint position 0, where many tools start, the arm is out of its limits and
in collision. Start at home: it is in the SRDF and is the first key frame of
mjcf.

Examples:
alpha5 generate urdf --gripper jaws --prefix left_ --output out/left_arm.urdf
alpha5 generate mjcf --fluid fresh --output out/mujoco
alpha5 generate sdf --controllers --output out/gazebo
alpha5 generate usd --gripper jaws --output out/alpha5.usda
alpha5 generate c --real float --output out/controller
alpha5 generate water --fluid fresh --output out/water.json
"""

#: Value of --mesh-uri -> prefix of the name of each mesh.
MESH_URIS = {
    "relative": "meshes/",
    "package": "package://alpha5_description/meshes/",
    "file": (Path(REPOSITORY_PATH) / "meshes").as_uri() + "/",
}


class _Format(NamedTuple):
    """A format of descriptions.

    Attributes:
        summary: What it is, for the help.
        options: Adds its options; each is named after its field of the record.
        files: Makes its files, name -> content, from what was given.
        main_file: Name of the file that goes to standard output.
        suffixes: Those that this file may have, beside which the others are written;
            empty for a folder.
        without_armature: Its name, if it has joints and no place for rotor inertia.
    """

    summary: str
    options: Callable[[Parser], None]
    files: Callable[[Namespace], Mapping[str, bytes]]
    main_file: str
    suffixes: tuple[str, ...] = ()
    without_armature: str = ""


def options(parser: Parser) -> None:
    parser.add_commands(
        {name: (form.summary, form.options) for name, form in _FORMATS.items()}
    )


def run(given: Namespace) -> None:
    form = _FORMATS[given.command]
    output = given.output
    if output is not None and form.suffixes and not is_stream(output):
        if not output.suffix:
            raise OutputError(output, f"give a file name, such as {form.main_file}")
        check_outputs((given.arm,), output=(output, form.suffixes))
    given.arm = common.record_of(given)
    files = form.files(given)
    if form.without_armature:
        arm = chosen_arm(given.arm, given.corrections)
        for line in without_armature(form.without_armature, arm):
            print(line, file=sys.stderr)
    meshes = given.command == "urdf" and given.mesh_uri == "relative"
    _hand_out(form, files, output, meshes)


# --- the formats ----------------------------------------------------------------------


def _record(kind: Any, given: Namespace) -> Any:
    """A record of options, whose fields are what was given."""
    values = vars(given)
    names = [field.name for field in fields(kind) if field.name in values]
    return kind(**{name: values[name] for name in names})


def _of_urdf(parser: Parser) -> None:
    common.gripper(parser)
    parser.add_argument(
        "--prefix", default="", help="prefix of every link and joint name"
    )
    _mounted(parser)
    parser.add_argument(
        "--mesh-uri",
        default="relative",
        help="how the URDF names meshes: relative (copied beside it), package, file, "
        "or a URI such as package://my_description/meshes. Default: %(default)s",
    )
    _collision(parser, "primitives or none; capsules with --urdf-version 1.1 or 1.2")
    parser.add_argument(
        "--urdf-version",
        default="1.0",
        help="1.0, 1.1, or 1.2 with limits of acceleration and jerk of an arm file. "
        "Default: %(default)s",
    )
    parser.add_argument(
        "--dh-frames", action="store_true", help="add the DH frames dh_1 to dh_5"
    )
    parser.add_argument(
        "--ros2-control", action="store_true", help="add hardware interfaces"
    )
    parser.add_argument(
        "--ros2-control-hardware",
        default="mock",
        help="mock, alpha_hardware, blue_reach_5, or a YAML file. Default: %(default)s",
    )
    parser.add_argument(
        "--ros2-control-param",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="parameter of the hardware",
    )
    parser.add_argument(
        "--ros2-control-plugin",
        default="",
        metavar="PLUGIN",
        help="plugin in place of the layout's",
    )
    _record_and_output(parser)


def _urdf_files(given: Namespace) -> Mapping[str, bytes]:
    given.mesh_prefix = _mesh_prefix(given.mesh_uri)
    given.ros2_control_parameters = common.pairs(
        "ros2_control_param", given.ros2_control_param, "="
    )
    return {"alpha5.urdf": urdf(_record(Variant, given)).encode()}


def _of_srdf(parser: Parser) -> None:
    common.gripper(parser)
    parser.add_argument(
        "--prefix", default="", help="prefix of every link, joint and group name"
    )
    common.arm_file(parser)
    _output(parser)


def _srdf_files(given: Namespace) -> Mapping[str, bytes]:
    text = srdf(given.gripper, given.arm, given.prefix)
    return {"alpha5.srdf": text.encode()}


def _moveit_files(given: Namespace) -> Mapping[str, bytes]:
    return moveit_files(given.gripper, given.prefix, given.arm)


def _xacro_files(given: Namespace) -> Mapping[str, bytes]:
    record = chosen_arm(given.arm, given.corrections)
    return {"parameters.yaml": parameter_yaml(record).encode()}


def _of_mjcf(parser: Parser) -> None:
    parser.epilog = "MuJoCo adds a prefix to names: MjSpec.attach(arm, prefix=...)."
    common.gripper(parser)
    _mounted(parser)
    _collision(parser, "primitives, capsules or none")
    _fluid(parser)
    parser.add_argument(
        "--actuators",
        default="position",
        help="position, velocity or motor. Default: %(default)s",
    )
    parser.add_argument(
        "--buoyancy",
        default="bodies",
        help="bodies, or none (for brax). Default: %(default)s",
    )
    parser.add_argument(
        "--hydrodynamics",
        action="store_true",
        help="add drag of moving water; estimated, not published",
    )
    _record_and_output(parser)


def _of_sdf(parser: Parser) -> None:
    parser.epilog = "Names are the model's own: include it with another <name>."
    common.gripper(parser)
    _mounted(parser)
    _fluid(parser)
    parser.add_argument(
        "--sdf-version",
        default="1.9",
        help="1.9, or 1.11, in which the fingers follow the jaw rod. "
        "Default: %(default)s",
    )
    parser.add_argument(
        "--controllers",
        action="store_true",
        help="add position controllers and joint states",
    )
    parser.add_argument(
        "--hydrodynamics",
        action="store_true",
        help="add drag and added mass of moving water; estimated, not published",
    )
    _record_and_output(parser)


def _of_usd(parser: Parser) -> None:
    parser.epilog = "Names are the prim's own: reference it as another prim."
    common.gripper(parser)
    _mounted(parser)
    _collision(parser, "primitives or none")
    _fluid(parser)
    _record_and_output(parser)


def _of_water(parser: Parser) -> None:
    common.gripper(parser)
    _fluid(parser)
    _record_and_output(parser)


def _of_c(parser: Parser) -> None:
    parser.epilog = "The library has four joints; the jaws are locked."
    _fluid(parser)
    common.gravity(parser, words="in base_link (m/s^2)")
    parser.add_argument(
        "--real", default="double", help="double or float. Default: %(default)s"
    )
    parser.add_argument(
        "--parameters",
        default="folded",
        help="masses and water as numbers (folded) or struct. Default: %(default)s",
    )
    _record_and_output(parser)


# Options of several formats.


def _mounted(parser: Parser) -> None:
    parser.add_argument(
        "--parent", default="", help="link that carries the arm; it is added"
    )
    parser.add_argument(
        "--xyz",
        type=Vector(LENGTH, LENGTH, LENGTH),
        default="0 0 0",
        metavar="X Y Z",
        help="mount in the parent (m)",
    )
    parser.add_argument(
        "--rpy",
        type=Vector(ANGLE, ANGLE, ANGLE),
        default="0 0 0",
        metavar="R P Y",
        help="mount: roll, pitch, yaw (rad; or 180 0 0 deg)",
    )


def _collision(parser: Parser, words: str) -> None:
    parser.add_argument(
        "--collision", default="primitives", help=f"{words}. Default: %(default)s"
    )


def _fluid(parser: Parser) -> None:
    common.fluid(parser, dest="fluid_density")


def _record_and_output(parser: Parser) -> None:
    parser.add_argument(
        "--corrections",
        type=common.names,
        default=DEFAULT_CORRECTIONS,
        help="recorded corrections to apply, with commas; '' for none. "
        "Default: base_frame",
    )
    common.arm_file(parser)
    _output(parser)


def _output(parser: Parser) -> None:
    parser.add_argument(
        "-o", "--output", type=Path, metavar="PATH", help="file or folder to write"
    )


_FORMATS = {
    "urdf": _Format(
        summary="a URDF; its meshes are copied beside it",
        options=_of_urdf,
        files=_urdf_files,
        main_file="alpha5.urdf",
        suffixes=(".urdf", ".xml"),
        without_armature="URDF",
    ),
    "srdf": _Format(
        summary="the SRDF",
        options=_of_srdf,
        files=_srdf_files,
        main_file="alpha5.srdf",
        suffixes=(".srdf", ".xml"),
    ),
    "moveit": _Format(
        summary="a folder for MoveIt 2: limits, solver, planners, controllers, SRDF",
        options=_of_srdf,
        files=_moveit_files,
        main_file="joint_limits.yaml",
    ),
    "xacro": _Format(
        summary="the numbers as YAML, for xacro parameters:=FILE",
        options=_record_and_output,
        files=_xacro_files,
        main_file="parameters.yaml",
        suffixes=(".yaml", ".yml"),
    ),
    "mjcf": _Format(
        summary="a folder for MuJoCo",
        options=_of_mjcf,
        files=lambda given: mjcf.mjcf_files(_record(mjcf.MjcfOptions, given)),
        main_file="alpha5.xml",
    ),
    "sdf": _Format(
        summary="a folder for Gazebo",
        options=_of_sdf,
        files=lambda given: sdf.sdf_files(_record(sdf.SdfOptions, given)),
        main_file="model.sdf",
        without_armature="SDF",
    ),
    "usd": _Format(
        summary="a file for Isaac Sim and Newton, and the table of the water",
        options=_of_usd,
        files=lambda given: usd_files(_record(UsdOptions, given)),
        main_file="alpha5.usda",
        suffixes=(".usda",),
    ),
    "c": _Format(
        summary="a C99 library",
        options=_of_c,
        files=lambda given: c_files(_record(COptions, given)),
        main_file="alpha5.c",
    ),
    "water": _Format(
        summary="volume, centre of buoyancy, added mass and drag of each link, in JSON",
        options=_of_water,
        files=lambda given: water_files(_record(WaterOptions, given)),
        main_file="water.json",
        suffixes=(".json",),
    ),
}


def _mesh_prefix(mesh_uri: str) -> str:
    """The prefix of mesh files that ``--mesh-uri`` names, or is.

    Raises:
        UnknownNameError: Neither.
    """
    if "/" in mesh_uri:
        return mesh_uri
    return MESH_URIS[choice("mesh URI", mesh_uri, (*MESH_URIS, "URI/OF/MESHES"))]


def _hand_out(
    form: _Format, files: Mapping[str, bytes], output: Path | None, meshes: bool
) -> None:
    """Print the main file, or write the files; the meshes beside it if wanted."""
    main_file = files[form.main_file]
    if output is None:
        print(main_file.decode(), end="")
    elif is_stream(output):
        # A stream gets the description alone, without other files beside it.
        atomic_write_all({output: main_file})
    elif form.suffixes:
        # What lies beside has the name of the file: two variants fit into one folder.
        stem = Path(form.main_file).stem
        beside = {
            name.replace(stem, output.stem, 1): data
            for name, data in files.items()
            if name != form.main_file
        }
        if meshes:
            for name, mesh in mesh_assets(".obj", ".mtl").items():
                beside[f"meshes/{name}"] = mesh
        paths = {output.parent / name: data for name, data in beside.items()}
        _write({output: main_file, **paths})
    elif output.is_file():
        raise OutputError(output, "it is a file; this format needs a folder")
    else:
        _write({output / name: content for name, content in files.items()})


def _write(files: Mapping[Path, bytes]) -> None:
    """Write files, and say in which folder which of them are."""
    atomic_write_all(files)

    names: dict[Path, list[str]] = {}
    for path in files:
        names.setdefault(path.parent, []).append(path.name)
    for folder, inside in names.items():
        printing.say(f"wrote in {folder}: {', '.join(inside)}")
