"""``alpha5 generate``: any variant of the arm's description, anywhere."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from alpha5_model.checks import choice
from alpha5_model.cli.options import (
    FLUID_HELP,
    correction_names,
    fluid_density,
    print_written,
    triple,
)
from alpha5_model.description import committed
from alpha5_model.description.meshes import mesh_assets
from alpha5_model.description.mjcf import MjcfOptions, mjcf_files
from alpha5_model.description.sdf import SdfOptions, sdf_files
from alpha5_model.description.variants import Variant, urdf
from alpha5_model.errors import InputError, OutputError
from alpha5_model.files import atomic_write, atomic_write_all, check_outputs, is_stream
from alpha5_model.paths import REPOSITORY_PATH

MESH_URIS = {
    "relative": "meshes/",
    "package": "package://alpha5_description/meshes/",
    "file": (Path(REPOSITORY_PATH) / "meshes").as_uri() + "/",
}
FORMATS = ("urdf", "mjcf", "sdf")
#: Options that not every format has, and the formats that have them.
_FORMATS_OF = {
    **dict.fromkeys(("prefix", "parent", "xyz", "rpy", "mesh_uri", "dh_frames"), ("urdf",)),
    **dict.fromkeys(("ros2_control", "ros2_control_plugin"), ("urdf",)),
    **dict.fromkeys(("actuators", "drag"), ("mjcf",)),
    "fluid": ("mjcf", "sdf"),
    "collision": ("urdf", "mjcf"),
}


def generate(
    context: typer.Context,
    output: Annotated[
        Path | None,
        typer.Option(
            help="File to write, meshes go beside it; for mjcf and sdf a folder. "
            "Standard output if not given."
        ),
    ] = None,
    description_format: Annotated[
        str, typer.Option("--format", help="urdf, mjcf (MuJoCo) or sdf (Gazebo).")
    ] = "urdf",
    gripper: Annotated[str, typer.Option(help="locked or jaws.")] = "locked",
    prefix: Annotated[str, typer.Option(help="Before every link and joint name.")] = "",
    parent: Annotated[str, typer.Option(help="Link to mount on; made if given.")] = "",
    xyz: Annotated[str, typer.Option(help="Mount in the parent, three numbers (m).")] = "0 0 0",
    rpy: Annotated[str, typer.Option(help="Its roll, pitch, yaw (rad).")] = "0 0 0",
    mesh_uri: Annotated[
        str,
        typer.Option(help="relative (copies the meshes beside the file), package or file."),
    ] = "relative",
    collision: Annotated[str, typer.Option(help="primitives or none.")] = "primitives",
    dh_frames: Annotated[bool, typer.Option("--dh-frames", help="Add dh_1 ... dh_5.")] = False,
    ros2_control: Annotated[
        bool, typer.Option("--ros2-control", help="Add interfaces and device ids.")
    ] = False,
    ros2_control_plugin: Annotated[
        str, typer.Option(help="Hardware plugin.")
    ] = "mock_components/GenericSystem",
    corrections: Annotated[
        str | None,
        typer.Option(help="Recorded corrections, with commas; '' is the document to the letter."),
    ] = None,
    fluid: Annotated[str, typer.Option(help=f"mjcf, sdf: {FLUID_HELP}")] = "sea",
    actuators: Annotated[str, typer.Option(help="mjcf: position, velocity or motor.")] = "position",
    drag: Annotated[
        bool, typer.Option("--drag", help="mjcf: MuJoCo's own drag, not from the document.")
    ] = False,
    check: Annotated[
        bool, typer.Option("--check", help="Compare the committed files; status 1 if stale.")
    ] = False,
    update: Annotated[
        bool, typer.Option("--update", help="Write the committed files of this checkout anew.")
    ] = False,
) -> int:
    """Write the description of any variant of the arm.

    Examples:
    alpha5 generate --gripper jaws --prefix left_ --output out/left_arm.urdf
    alpha5 generate --format mjcf --fluid fresh --output out/mujoco
    """
    given = _given(context)
    if check or update:
        alone = "check" if check else "update"
        for name, value in given.items():
            if name != alone:
                raise InputError(_option(name), value, f"nothing beside --{alone}")
        return _check() if check else _update()

    chosen_corrections = correction_names(corrections)
    choice("format", description_format, FORMATS)
    for name, formats in _FORMATS_OF.items():
        if name in given and description_format not in formats:
            expected = f"--format {' or '.join(formats)} with it"
            raise InputError(_option(name), description_format, expected)
    if description_format == "mjcf":
        options = MjcfOptions(
            gripper, fluid_density(fluid), actuators, drag, collision, chosen_corrections
        )
        return _write_folder(mjcf_files(options), output, "alpha5.xml")
    if description_format == "sdf":
        world = SdfOptions(gripper, fluid_density(fluid), chosen_corrections)
        return _write_folder(sdf_files(world), output, "model.sdf")
    variant = Variant(
        gripper=gripper,
        prefix=prefix,
        parent=parent,
        xyz=triple("xyz", xyz),
        rpy=triple("rpy", rpy),
        mesh_prefix=MESH_URIS[choice("mesh URI", mesh_uri, tuple(MESH_URIS))],
        collision=collision,
        dh_frames=dh_frames,
        ros2_control=ros2_control,
        ros2_control_plugin=ros2_control_plugin,
        corrections=chosen_corrections,
    )
    text = urdf(variant)
    if output is None or is_stream(output):
        return _write_stream(text, output)
    if not output.suffix:
        raise OutputError(output, "give a file name, such as alpha5.urdf")
    check_outputs((), output=(output, (".urdf", ".xml")))
    meshes = mesh_assets(".obj", ".mtl") if mesh_uri == "relative" else {}
    beside = {output.parent / "meshes" / name: content for name, content in meshes.items()}
    atomic_write_all({output: text, **beside})
    print_written(output)
    return 0


def _given(context: typer.Context) -> dict[str, Any]:
    """The options that stand on the command line."""
    sources = {name: context.get_parameter_source(name) for name in context.params}
    return {
        name: context.params[name]
        for name, source in sources.items()
        if source is not None and source.name == "COMMANDLINE"
    }


def _option(name: str) -> str:
    return "--format" if name == "description_format" else "--" + name.replace("_", "-")


def _write_folder(files: dict[str, bytes], output: Path | None, main_file: str) -> int:
    if output is None or is_stream(output):
        return _write_stream(files[main_file].decode(), output)
    if output.is_file():
        raise OutputError(output, "it is a file; this format needs a folder")
    atomic_write_all({output / name: content for name, content in files.items()})
    typer.echo(f"wrote {output / main_file} and {len(files) - 1} files beside it")
    return 0


def _write_stream(text: str, output: Path | None) -> int:
    """The description alone, without what stands beside a file."""
    if output is None:
        typer.echo(text, nl=False)
    else:
        atomic_write(output, text)
    return 0


def _check() -> int:
    fresh = committed.generated_files()
    stale = committed.stale_files(fresh=fresh)
    for file in stale:
        typer.echo(file.diff, nl=False)
    typer.echo(f"{len(fresh) - len(stale)} of {len(fresh)} generated files are fresh")
    if not committed.can_draw():
        typer.echo(committed.NOT_DRAWN)
    return 1 if stale else 0


def _update() -> int:
    print_written(*committed.update())
    if not committed.can_draw():
        typer.echo(committed.NOT_DRAWN)
    return 0
