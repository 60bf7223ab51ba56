"""The generated files that are committed, and how far they are from a fresh generation."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from alpha5_model._support.paths import REPOSITORY_PATH
from alpha5_model._support.spatial import Placement
from alpha5_model._support.writing import atomic_write_all
from alpha5_model.description.bodies import arm_bodies
from alpha5_model.description.mjcf import MjcfOptions, mjcf_files
from alpha5_model.description.srdf import NAMED_POSES, srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.geometry.drawing import bodies
from alpha5_model.geometry.gltf import Node, glb
from alpha5_model.geometry.triangles import Surface, surface
from alpha5_model.geometry.wavefront import MTL_NAME, mtl, obj
from alpha5_model.numbers.parameters import parameters

GLB_NAME = "alpha5.glb"
#: What part of the files needs, and what is not done where it is not installed.
_NEEDED = {"manifold3d": "meshes are not drawn", "casadi": "formulas are not generated"}
#: Drawn by ``scripts/figures/make_figures.py``, not compared: pixels depend on the renderer.
_PICTURE = b"![The arm in its home pose](alpha5.png)"


@dataclass(frozen=True)
class StaleFile:
    """A committed file that differs from what would be generated now.

    Attributes:
        path: Relative to the repository.
        diff: Unified diff, committed against fresh; one line for binary or missing files.
    """

    path: str
    diff: str


def generated_files() -> dict[str, bytes]:
    """Every file that is committed and generated: path in the repository -> content.

    Meshes and formulas are there only where what they need is, see `not_generated`.
    """
    lacking = _lacking()
    texts = {"xacro/parameters.yaml": parameter_yaml(parameters())}
    for gripper, name in (("locked", "alpha5"), ("jaws", "alpha5_jaws")):
        texts[f"urdf/{name}.urdf"] = urdf(Variant(gripper=gripper))
        texts[f"urdf/{name}.srdf"] = srdf(gripper)
    if _in_checkout() and "casadi" not in lacking:
        from alpha5_model.codegen.sources import generated_sources

        texts |= generated_sources()
    drawn = {} if "manifold3d" in lacking else mesh_files()
    meshes = {f"meshes/{name}": content for name, content in drawn.items()}
    return (
        {path: text.encode("utf-8") for path, text in texts.items()}
        | meshes
        | _menagerie(drawn)
    )


def _menagerie(drawn: Mapping[str, bytes]) -> dict[str, bytes]:
    """``mjcf/``: the arm with its jaws locked, and open, in the form of MuJoCo Menagerie."""
    files, jaws = mjcf_files(), mjcf_files(MjcfOptions(gripper="jaws"))
    title, said = files["README.md"].split(b"\n\n", 1)
    files["README.md"] = b"\n\n".join((title, _PICTURE, said))
    files["alpha5_jaws.xml"] = jaws["alpha5.xml"]
    files["scene_jaws.xml"] = files["scene.xml"].replace(b"alpha5", b"alpha5_jaws")
    texts = {
        path: content
        for path, content in files.items()
        if not path.startswith("assets/")
    }
    assets = {f"assets/{name}": drawn[name] for name in drawn if name.endswith(".obj")}
    return {f"mjcf/{path}": content for path, content in (texts | assets).items()}


def not_generated() -> tuple[str, ...]:
    """Why some files are not generated here, one line for each package that is not installed."""
    lacking = ((name, _NEEDED[name]) for name in _lacking())
    return tuple(
        f"{n} is not installed: the {x} anew (pip install {n})" for n, x in lacking
    )


def _lacking() -> list[str]:
    # An installed package has its formulas as they are.
    needed = _NEEDED if _in_checkout() else ["manifold3d"]
    return [package for package in needed if find_spec(package) is None]


def _in_checkout() -> bool:
    return Path(REPOSITORY_PATH, "alpha5_model").is_dir()


def stale_files(
    repository: str = REPOSITORY_PATH, fresh: Mapping[str, bytes] | None = None
) -> list[StaleFile]:
    """Compare the committed files with a fresh generation; empty if all agree.

    Args:
        repository: Folder that holds ``urdf/``, ``xacro/``, ``meshes/`` and ``mjcf/``.
        fresh: Result of `generated_files`; computed if not given.
    """
    stale = []
    for path, content in (generated_files() if fresh is None else fresh).items():
        file = Path(repository) / path
        committed = file.read_bytes() if file.is_file() else None
        if committed != content:
            stale.append(StaleFile(path, _diff(path, committed, content)))
    return stale


def update(repository: str = REPOSITORY_PATH) -> list[Path]:
    """Write the generated files into the repository; returns the paths that changed."""
    fresh = generated_files()
    changed = {
        Path(repository, s.path): fresh[s.path] for s in stale_files(repository, fresh)
    }
    atomic_write_all(changed)
    return list(changed)


@cache
def mesh_files() -> dict[str, bytes]:
    """Name -> content of every file in ``meshes/``; the same bytes every time.

    Raises:
        MissingDependencyError: manifold3d, with which the bodies are drawn, is not installed.
    """
    surfaces = {name: surface(body.solid) for name, body in bodies().items()}
    objects = {f"{name}.obj": obj(name, body) for name, body in surfaces.items()}
    return {**objects, MTL_NAME: mtl(), GLB_NAME: glb(list(_scene(surfaces)))}


def _scene(surfaces: Mapping[str, Surface]) -> Iterator[Node]:
    """The arm in its home pose; node ``link_i`` turns about z in node ``axis_...`` by the joint angle."""
    # glTF has y up, the base frame has z up.
    yield Node("base_link", Placement("", rpy=(-math.pi / 2, 0.0, 0.0)))
    angles = iter(NAMED_POSES["home"])
    for body in arm_bodies(parameters(), "jaws"):
        if not body.meshes:  # the rod
            continue
        at = body.placement
        if body.joint is not None:
            yield Node(body.joint.name, at)
            at = Placement(body.joint.name, rpy=(0.0, 0.0, next(angles, 0.0)))
        yield Node(body.name, at, surfaces[body.name])


def _diff(path: str, committed: bytes | None, fresh: bytes) -> str:
    if committed is None:
        return f"{path}: missing\n"
    try:
        old, new = (
            text.decode("utf-8").splitlines(True) for text in (committed, fresh)
        )
    except UnicodeDecodeError:
        return f"{path}: {len(committed)} bytes differ from {len(fresh)} fresh ones\n"
    return "".join(difflib.unified_diff(old, new, f"committed/{path}", f"fresh/{path}"))
