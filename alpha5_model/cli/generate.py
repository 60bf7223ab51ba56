"""``alpha5 generate``: the description of any variant of the arm, in any folder."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any

from typer import Context, Option, echo

from alpha5_model._support.checks import choice
from alpha5_model._support.files import atomic_write_all, check_outputs, is_stream
from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model.cli import options
from alpha5_model.cli.options import HELP
from alpha5_model.codegen.c_library import COptions, c_files
from alpha5_model.description import committed, mjcf, sdf
from alpha5_model.description.bodies import mesh_assets
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import InputError, OutputError

MESH_URIS = {"relative": "meshes/", "package": "package://alpha5_description/meshes/"}
MESH_URIS["file"] = (Path(REPOSITORY_PATH) / "meshes").as_uri() + "/"
#: Format -> record of its options, what makes its files, and the main one of them. An option has
#: the name of the field it fills, except for two.
_FORMATS: dict[str, tuple[Any, Any, str]] = {
    "urdf": (
        Variant,
        lambda variant: {"alpha5.urdf": urdf(variant).encode()},
        "alpha5.urdf",
    ),
    "mjcf": (mjcf.MjcfOptions, mjcf.mjcf_files, "alpha5.xml"),
    "sdf": (sdf.SdfOptions, sdf.sdf_files, "model.sdf"),
    "c": (COptions, c_files, "alpha5.c"),
}
#: Why an option is not for the format that was asked for, where that needs a word.
_REASONS = {"hydrodynamics": " (URDF has no element for drag or added mass)"}
_FIELD_OF = {"mesh_uri": "mesh_prefix", "fluid": "fluid_density"}


def generate(
    context: Context,
    output: Annotated[
        Path | None, Option(help="File; for mjcf, sdf and c a folder.")
    ] = None,
    description_format: Annotated[
        str, Option("--format", help="urdf, mjcf, sdf or c.")
    ] = "urdf",
    gripper: options.Gripper = "locked",
    prefix: Annotated[str, Option(help="Before every link and joint name.")] = "",
    parent: Annotated[str, Option(help="Link to mount on; made if given.")] = "",
    xyz: Annotated[str, Option(help="Mount in the parent, x y z (m).")] = "0 0 0",
    rpy: Annotated[
        str, Option(help="Its roll, pitch, yaw (rad; 180 0 0 deg).")
    ] = "0 0 0",
    mesh_uri: Annotated[str, Option(help=HELP["meshes"])] = "relative",
    collision: Annotated[str, Option(help="primitives or none.")] = "primitives",
    dh_frames: Annotated[
        bool, Option("--dh-frames", help="Add dh_1 ... dh_5.")
    ] = False,
    ros2_control: Annotated[
        bool, Option("--ros2-control", help="Interfaces, device ids.")
    ] = False,
    ros2_control_plugin: Annotated[
        str, Option(help="Hardware.")
    ] = "mock_components/GenericSystem",
    corrections: Annotated[
        str | None, Option(help="With commas; '' is to the letter.")
    ] = None,
    fluid: Annotated[str, Option(help=f"mjcf, sdf, c: {options.FLUID}")] = "sea",
    gravity: Annotated[str, Option(help="c: in base_link (m/s^2).")] = options.DOWN,
    real: Annotated[str, Option(help="c: double or float.")] = "double",
    parameters: Annotated[
        str, Option(help="c: masses and water folded, or a struct.")
    ] = "folded",
    actuators: Annotated[
        str, Option(help="mjcf: position, velocity or motor.")
    ] = "position",
    buoyancy: Annotated[
        str, Option(help="mjcf: bodies, or none, for brax.")
    ] = "bodies",
    sdf_version: Annotated[
        str, Option(help="sdf: 1.9, or 1.11 (fingers follow).")
    ] = "1.9",
    drag: Annotated[
        bool, Option("--drag", help="mjcf: MuJoCo's own, not published.")
    ] = False,
    hydrodynamics: Annotated[
        bool, Option("--hydrodynamics", help=HELP["moving_water"])
    ] = False,
    check: Annotated[
        bool, Option("--check", help="Compare the committed files.")
    ] = False,
    update: Annotated[
        bool, Option("--update", help="Write the committed files anew.")
    ] = False,
) -> int:
    """Write the description of any variant of the arm.

    urdf, mjcf (a folder for MuJoCo), sdf (a folder for Gazebo) or c (a C99
    library); without --output the main file goes to standard output. Meshes are
    copied beside a URDF unless --mesh-uri says where they are. mjcf without
    gravcomp (--buoyancy none) is for brax; in sdf 1.11 the fingers follow the jaw
    rod by mimic. C holds masses and water as numbers, or takes them in a struct.
    --check ends with status 1 if a committed file is stale.

    At joint position 0, where many tools start, it is out of its limits and in
    collision: start at home of the SRDF, the first key frame of mjcf.

    Examples:
    alpha5 generate --gripper jaws --prefix left_ --output out/left_arm.urdf
    alpha5 generate --format mjcf --fluid fresh --output out/mujoco
    alpha5 generate --format sdf --hydrodynamics --output out/gazebo
    alpha5 generate --format c --real float --output out/controller
    """
    given = [
        n
        for n in context.params
        if "COMMANDLINE" in str(context.get_parameter_source(n))
    ]
    words = {parameter.name: parameter.opts[0] for parameter in context.command.params}
    if check or update:
        alone = "check" if check else "update"
        for name in given:
            if name != alone:
                raise InputError(
                    words[name], context.params[name], f"nothing beside --{alone}"
                )
        return _committed(check)

    choice("format", description_format, tuple(_FORMATS))
    names = {
        kind: {f.name for f in fields(record)}
        for kind, (record, *_) in _FORMATS.items()
    }
    for name in given:
        formats = [kind for kind in names if _FIELD_OF.get(name, name) in names[kind]]
        if formats and description_format not in formats:
            expected = (
                f"--format {' or '.join(formats)} with it{_REASONS.get(name, '')}"
            )
            raise InputError(words[name], description_format, expected)
    vectors = (("xyz", xyz, "m"), ("rpy", rpy, "rad"), ("gravity", gravity, "m/s^2"))
    values = context.params | {
        n: options.numbers(n, x, (3,), unit) for n, x, unit in vectors
    }
    values["mesh_prefix"] = MESH_URIS[choice("mesh URI", mesh_uri, tuple(MESH_URIS))]
    values["fluid_density"] = options.fluid_density(fluid)
    values["corrections"] = options.correction_names(corrections)
    record, made, main = _FORMATS[description_format]
    files = made(record(**{name: values[name] for name in names[description_format]}))
    if output is None:
        echo(files[main].decode(), nl=False)
        return 0
    if is_stream(output):  # the description alone, without what stands beside a file
        written = {output: files[main]}
    elif description_format == "urdf":
        if not output.suffix:
            raise OutputError(output, "give a file name, such as alpha5.urdf")
        check_outputs((), output=(output, (".urdf", ".xml")))
        meshes = mesh_assets(".obj", ".mtl") if mesh_uri == "relative" else {}
        written = {output: files[main]}
        written |= {
            output.parent / "meshes" / name: mesh for name, mesh in meshes.items()
        }
    elif output.is_file():
        raise OutputError(output, "it is a file; this format needs a folder")
    else:
        written = {output / name: content for name, content in files.items()}
    atomic_write_all(written)
    for folder in dict.fromkeys(
        path.parent for path in written if not is_stream(output)
    ):
        inside = ", ".join(path.name for path in written if path.parent == folder)
        options.say(f"wrote in {folder}: {inside}")
    return 0


def _committed(check: bool) -> int:
    """Compare the committed files with fresh ones, or write them anew."""
    fresh = committed.generated_files() if check else {}
    stale = committed.stale_files(fresh=fresh)
    if check:
        echo("".join(file.diff for file in stale), nl=False)
        echo(f"{len(fresh) - len(stale)} of {len(fresh)} generated files are fresh")
    else:
        options.show(False, None, (), *committed.update())
    for line in committed.not_generated():
        echo(line)
    return 1 if stale else 0
