"""``alpha5 generate``: the description of any variant of the arm, in any folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from typer import Context, Option, echo

from alpha5_model._support.checks import choice
from alpha5_model._support.files import is_stream
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.cli import options, printing, values
from alpha5_model.codegen.c_library import COptions, c_files
from alpha5_model.description import mjcf, sdf
from alpha5_model.description.assets import mesh_assets
from alpha5_model.description.srdf import srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.usd import UsdOptions, usd_files
from alpha5_model.description.water_table import WaterOptions, water_files
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.description.xml import without_armature
from alpha5_model.errors import InputError, OutputError
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm


class _Format(NamedTuple):
    """A format of descriptions.

    Attributes:
        options: Record of its options.
        files: Makes its files, name -> content, from this record.
        main_file: Name of the file that goes to standard output.
        suffixes: Those that this file may have, beside which the others are written;
            empty for a folder.
    """

    options: Any
    files: Callable[[Any], Mapping[str, bytes]]
    main_file: str
    suffixes: tuple[str, ...] = ()

    def option_names(self) -> set[str]:
        """The fields of the record of options."""
        return {field.name for field in fields(self.options)}


@dataclass(frozen=True)
class _SrdfOptions:
    """Options of the SRDF: see `srdf`."""

    gripper: str
    arm: Alpha5Parameters | None


@dataclass(frozen=True)
class _XacroOptions:
    """Options of the parameters that plain xacro reads: see `parameter_yaml`."""

    corrections: tuple[str, ...]
    arm: Alpha5Parameters | None


def _urdf_files(variant: Variant) -> dict[str, bytes]:
    return {"alpha5.urdf": urdf(variant).encode()}


def _srdf_files(chosen: _SrdfOptions) -> dict[str, bytes]:
    return {"alpha5.srdf": srdf(chosen.gripper, chosen.arm).encode()}


def _xacro_files(chosen: _XacroOptions) -> dict[str, bytes]:
    record = chosen_arm(chosen.arm, chosen.corrections)
    return {"parameters.yaml": parameter_yaml(record).encode()}


_FORMATS = {
    "urdf": _Format(
        options=Variant,
        files=_urdf_files,
        main_file="alpha5.urdf",
        suffixes=(".urdf", ".xml"),
    ),
    "srdf": _Format(
        options=_SrdfOptions,
        files=_srdf_files,
        main_file="alpha5.srdf",
        suffixes=(".srdf", ".xml"),
    ),
    "xacro": _Format(
        options=_XacroOptions,
        files=_xacro_files,
        main_file="parameters.yaml",
        suffixes=(".yaml", ".yml"),
    ),
    "mjcf": _Format(
        options=mjcf.MjcfOptions, files=mjcf.mjcf_files, main_file="alpha5.xml"
    ),
    "sdf": _Format(options=sdf.SdfOptions, files=sdf.sdf_files, main_file="model.sdf"),
    "c": _Format(options=COptions, files=c_files, main_file="alpha5.c"),
    "usd": _Format(
        options=UsdOptions,
        files=usd_files,
        main_file="alpha5.usda",
        suffixes=(".usda",),
    ),
    "water": _Format(
        options=WaterOptions,
        files=water_files,
        main_file="water.json",
        suffixes=(".json",),
    ),
}
#: Option of the command -> field of the record, if their names differ.
_FIELD_OF = {
    "arm_file": "arm",
    "mesh_uri": "mesh_prefix",
    "fluid": "fluid_density",
    "ros2_control_param": "ros2_control_parameters",
}
#: Option and format -> why the format does not have it, if that needs an explanation.
_REASONS = {
    ("hydrodynamics", "urdf"): " (URDF has no element for drag or added mass)",
    (
        "gripper",
        "c",
    ): " (the formulas of c have four joints, the jaws locked in link_4)",
    ("prefix", "mjcf"): " (MuJoCo adds one: MjSpec.attach(arm, prefix=...))",
    ("prefix", "sdf"): " (names are the model's own: include it with another <name>)",
    ("prefix", "usd"): " (names are the prim's own: reference it as another prim)",
}
#: Formats with joints, but without a place for rotor inertia.
_WITHOUT_ARMATURE = {"urdf": "URDF", "sdf": "SDF"}
#: Value of --mesh-uri -> prefix of the name of each mesh.
MESH_URIS = {
    "relative": "meshes/",
    "package": "package://alpha5_description/meshes/",
    "file": (Path(REPOSITORY_PATH) / "meshes").as_uri() + "/",
}

# The options of this command.
_Output = Annotated[
    Path | None,
    Option("--output", "-o", help="File to write; for mjcf, sdf and c a folder."),
]
_DescriptionFormat = Annotated[
    str,
    Option("--format", help="urdf, srdf, xacro, mjcf, sdf, usd, c or water."),
]
_Prefix = Annotated[str, Option(help="Prefix of every link and joint name.")]
_Parent = Annotated[str, Option(help="Link that carries the arm; it is added.")]
_Xyz = Annotated[str, Option(help="Mount in the parent: x y z (m).")]
_Rpy = Annotated[str, Option(help="Mount: roll, pitch, yaw (rad; or 180 0 0 deg).")]
_MeshUri = Annotated[str, Option(help=options.HELP["meshes"])]
_Collision = Annotated[
    str,
    Option(help="primitives or none; capsules for mjcf and urdf (1.1, 1.2)."),
]
_UrdfVersion = Annotated[
    str, Option(help="urdf: 1.0, 1.1, or 1.2 with limits of acceleration and jerk.")
]
_DhFrames = Annotated[
    bool, Option("--dh-frames", help="Add the DH frames dh_1 to dh_5.")
]
_Ros2Control = Annotated[
    bool, Option("--ros2-control", help="Add hardware interfaces.")
]
_Ros2ControlHardware = Annotated[
    str, Option(help="mock, alpha_hardware, blue_reach_5, or a YAML file.")
]
_Ros2ControlParam = Annotated[
    list[str] | None, Option(help="Parameter of the hardware: NAME=VALUE.")
]
_Ros2ControlPlugin = Annotated[str, Option(help="Plugin in place of the layout's.")]
_Corrections = Annotated[
    str | None,
    Option(
        help="Recorded corrections to apply, with commas; '' for none. "
        "Default: base_frame."
    ),
]
_Fluid = Annotated[str, Option(help=f"For formats with water: {options.FLUID}")]
_Gravity = Annotated[str, Option(help="c: gravity in base_link (m/s^2).")]
_Real = Annotated[str, Option(help="c: double or float.")]
_Parameters = Annotated[
    str, Option(help="c: masses and water as numbers (folded) or struct.")
]
_Actuators = Annotated[str, Option(help="mjcf: position, velocity or motor.")]
_Buoyancy = Annotated[str, Option(help="mjcf: bodies, or none (for brax).")]
_SdfVersion = Annotated[str, Option(help="sdf: 1.9, or 1.11 (fingers follow).")]
_Controllers = Annotated[
    bool,
    Option("--controllers", help="sdf: add position controllers and joint states."),
]
_Hydrodynamics = Annotated[
    bool, Option("--hydrodynamics", help=options.HELP["moving_water"])
]


def generate(
    context: Context,
    output: _Output = None,
    description_format: _DescriptionFormat = "urdf",
    arm_file: options.Arm = None,
    gripper: options.Gripper = "locked",
    prefix: _Prefix = "",
    parent: _Parent = "",
    xyz: _Xyz = "0 0 0",
    rpy: _Rpy = "0 0 0",
    mesh_uri: _MeshUri = "relative",
    collision: _Collision = "primitives",
    urdf_version: _UrdfVersion = "1.0",
    dh_frames: _DhFrames = False,
    ros2_control: _Ros2Control = False,
    ros2_control_hardware: _Ros2ControlHardware = "mock",
    ros2_control_param: _Ros2ControlParam = None,
    ros2_control_plugin: _Ros2ControlPlugin = "",
    corrections: _Corrections = None,
    fluid: _Fluid = "sea",
    gravity: _Gravity = options.DOWN,
    real: _Real = "double",
    parameters: _Parameters = "folded",
    actuators: _Actuators = "position",
    buoyancy: _Buoyancy = "bodies",
    sdf_version: _SdfVersion = "1.9",
    controllers: _Controllers = False,
    hydrodynamics: _Hydrodynamics = False,
) -> int:
    """Write the description of any variant of the arm.

    Formats: urdf, srdf, xacro (YAML of the numbers, for xacro parameters:=FILE),
    mjcf (a folder for MuJoCo), sdf (a folder for Gazebo), usd (a file for Isaac
    Sim and Newton, with the table of the water beside it), c (a C99 library) or
    water (a table of volume, centre of buoyancy, added mass and drag of each
    link, in JSON). Without --output the main file goes to standard output.

    Meshes are copied beside a URDF unless --mesh-uri says where they are: package,
    file, or a URI of yours such as package://my_description/meshes. With
    --urdf-version 1.2 limits of acceleration and jerk of an arm file are written,
    with --sdf-version 1.11 the fingers follow the jaw rod. --ros2-control adds
    the interfaces of mock hardware, of a public driver (--ros2-control-hardware),
    or of a layout in a file of yours.

    At joint position 0, where many tools start, the arm is out of its limits and
    in collision. Start at home: it is in the SRDF and is the first key frame of
    mjcf.

    Examples:
    alpha5 generate --gripper jaws --prefix left_ --output out/left_arm.urdf
    alpha5 generate --format mjcf --fluid fresh --output out/mujoco
    alpha5 generate --format sdf --controllers --output out/gazebo
    alpha5 generate --format usd --gripper jaws --output out/alpha5.usda
    alpha5 generate --format c --real float --output out/controller
    alpha5 generate --format water --fluid fresh --output out/water.json
    """
    choice("format", description_format, tuple(_FORMATS))
    _refuse_options_of_other_formats(context, description_format)
    made = _FORMATS[description_format]
    if output is not None and made.suffixes and not is_stream(output):
        if not output.suffix:
            raise OutputError(output, f"give a file name, such as {made.main_file}")
        check_outputs((arm_file,), output=(output, made.suffixes))
    record = _record(made, context.params)
    files = made.files(record)
    for line in _left_out(description_format, record):
        echo(line, err=True)
    meshes = description_format == "urdf" and mesh_uri == "relative"
    _hand_out(made, files, output, meshes)
    return 0


def _record(made: _Format, params: Mapping[str, Any]) -> Any:
    """The record of a format's options: each field is an option, or made from one."""
    given = {
        **params,
        "xyz": values.numbers("xyz", params["xyz"], (3,), "m"),
        "rpy": values.numbers("rpy", params["rpy"], (3,), "rad"),
        "gravity": values.numbers("gravity", params["gravity"], (3,), "m/s^2"),
        "mesh_prefix": _mesh_prefix(params["mesh_uri"]),
        "fluid_density": values.fluid_density(params["fluid"]),
        "corrections": values.correction_names(params["corrections"]),
        "arm": values.arm_record(params["arm_file"]),
        "ros2_control_parameters": values.pairs(
            "ros2_control_param", params["ros2_control_param"] or [], "="
        ),
    }
    return made.options(**{name: given[name] for name in made.option_names()})


def _mesh_prefix(mesh_uri: str) -> str:
    """The prefix of mesh files that ``--mesh-uri`` names, or is.

    Raises:
        UnknownNameError: Neither.
    """
    if "/" in mesh_uri:
        return mesh_uri
    return MESH_URIS[choice("mesh URI", mesh_uri, (*MESH_URIS, "URI/OF/MESHES"))]


def _left_out(description_format: str, record: Any) -> list[str]:
    """What the format has no place for, in lines for the user."""
    if description_format not in _WITHOUT_ARMATURE:
        return []
    arm = chosen_arm(record.arm, record.corrections)
    return without_armature(_WITHOUT_ARMATURE[description_format], arm)


def _hand_out(
    made: _Format, files: Mapping[str, bytes], output: Path | None, meshes: bool
) -> None:
    """Print the main file, or write the files; the meshes beside it if wanted."""
    main_file = files[made.main_file]
    if output is None:
        echo(main_file.decode(), nl=False)
    elif is_stream(output):
        # A stream gets the description alone, without other files beside it.
        atomic_write_all({output: main_file})
    elif made.suffixes:
        beside = {name: data for name, data in files.items() if name != made.main_file}
        if meshes:
            for name, mesh in mesh_assets(".obj", ".mtl").items():
                beside[f"meshes/{name}"] = mesh
        paths = {output.parent / name: data for name, data in beside.items()}
        _write({output: main_file, **paths})
    elif output.is_file():
        raise OutputError(output, "it is a file; this format needs a folder")
    else:
        _write({output / name: content for name, content in files.items()})


def _given(context: Context) -> list[str]:
    """Names of the options that were given on the command line."""
    return [
        name
        for name in context.params
        if "COMMANDLINE" in str(context.get_parameter_source(name))
    ]


def _flag(context: Context, name: str) -> str:
    """An option as on the command line: ``--mesh-uri`` for mesh_uri."""
    flags = {option.name: option.opts[0] for option in context.command.params}
    return flags[name]


def _refuse_options_of_other_formats(context: Context, description_format: str) -> None:
    for name in _given(context):
        field = _FIELD_OF.get(name, name)
        formats = [
            key for key, form in _FORMATS.items() if field in form.option_names()
        ]
        if formats and description_format not in formats:
            reason = _REASONS.get((name, description_format), "")
            expected = f"--format {' or '.join(formats)} with it{reason}"
            raise InputError(_flag(context, name), description_format, expected)


def _write(files: Mapping[Path, bytes]) -> None:
    """Write files, and say in which folder which of them are."""
    atomic_write_all(files)

    names: dict[Path, list[str]] = {}
    for path in files:
        names.setdefault(path.parent, []).append(path.name)
    for folder, inside in names.items():
        printing.say(f"wrote in {folder}: {', '.join(inside)}")
