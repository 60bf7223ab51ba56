"""Write the generated files of the repository again, or say which are out of date.

    python scripts/generate.py
    python scripts/generate.py --check    # status 1 if a file is out of date

These are ``urdf/``, ``xacro/parameters.yaml``, ``config/``, ``meshes/``, ``mjcf/``, the
collision shapes that the package compares, and the generated source code. A file that
differs from a fresh one only in the last digits of computed numbers is left alone:
these differ between processors.
"""

from __future__ import annotations

import argparse
import difflib
import math
import re
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from meshes.compared_shapes import compared_shapes_text
from meshes.drawing import bodies
from meshes.glb import glb
from meshes.triangles import surface
from meshes.wavefront import MTL_NAME, mtl, obj

from alpha5_model._support.writing import atomic_write_all
from alpha5_model.codegen.sources import generated_sources
from alpha5_model.description.bodies import MESHES
from alpha5_model.description.mjcf import (
    MjcfOptions,
    mjcf,
    mjcf_files,
    mjcf_readme,
    mjcf_scene,
)
from alpha5_model.description.moveit import moveit_files
from alpha5_model.description.srdf import srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.geometry.collision_shapes import COMPARED_SHAPES_PATH
from alpha5_model.numbers.parameters import parameters

REPOSITORY = Path(__file__).resolve().parents[1]
GRIPPERS = {"locked": "alpha5", "jaws": "alpha5_jaws"}
#: Files of ``config/`` that serve locked jaws, too, which have fewer joints.
CONFIG_OF_BOTH = ("joint_limits.yaml", "kinematics.yaml", "ompl_planning.yaml")
#: Variant of ``mjcf/`` -> its options.
MODELS = {
    "": MjcfOptions(),
    "_jaws": MjcfOptions(gripper="jaws"),
    "_mjx": MjcfOptions(collision="capsules"),
}
#: Drawn by ``scripts/figures/make_figures.py``; pixels depend on the renderer.
PICTURE = "![The arm in its home pose](alpha5.png)\n\n"
#: A number in a text without its sign. If it has so many digits, it is computed. Two of
#: these are the same if they differ by less than `SAME`, relative to their size.
NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!\w)")
COMPUTED_DIGITS = 10
SAME = 1e-9
#: First bytes of a GLB.
GLB = b"glTF"
#: Difference of points of a GLB, in single precision, that is rounding [m].
ROUNDED = 2e-7


def generated_files() -> dict[str, bytes]:
    """Path in the repository -> content of every generated file."""
    meshes = mesh_files()
    texts = descriptions() | menagerie() | generated_sources()
    files = {path: text.encode() for path, text in texts.items()}
    shapes = COMPARED_SHAPES_PATH.relative_to(REPOSITORY).as_posix()
    files[shapes] = compared_shapes_text().encode()
    files |= moveit()
    files["mjcf/LICENSE"] = mjcf_files()["LICENSE"]
    for name, content in meshes.items():
        files[f"meshes/{name}"] = content
        if name.endswith(".obj"):
            files[f"mjcf/assets/{name}"] = content
    return files


def descriptions() -> dict[str, str]:
    """URDF, SRDF, and the parameters that plain xacro reads."""
    texts = {"xacro/parameters.yaml": parameter_yaml(parameters())}
    for gripper, name in GRIPPERS.items():
        texts[f"urdf/{name}.urdf"] = urdf(Variant(gripper=gripper))
        texts[f"urdf/{name}.srdf"] = srdf(gripper)
    return texts


def moveit() -> dict[str, bytes]:
    """``config/``: only the controllers depend on the gripper."""
    jaws = moveit_files("jaws")
    files = {f"config/{name}": jaws[name] for name in CONFIG_OF_BOTH}
    for gripper, name in GRIPPERS.items():
        suffix = name.removeprefix("alpha5")
        written = moveit_files(gripper)
        for kind in ("moveit_controllers", "ros2_controllers"):
            files[f"config/{kind}{suffix}.yaml"] = written[f"{kind}.yaml"]
    return files


def menagerie() -> dict[str, str]:
    """``mjcf/`` in the form of MuJoCo Menagerie: jaws locked, moving, and for MJX."""
    meshes = [f"{name}.obj" for name in MESHES]
    texts = {
        "mjcf/README.md": mjcf_readme(MODELS[""], PICTURE, MODELS.values()),
        "mjcf/CHANGELOG.md": mjcf_files()["CHANGELOG.md"].decode(),
    }
    for suffix, options in MODELS.items():
        model = f"alpha5{suffix}.xml"
        texts[f"mjcf/{model}"] = mjcf(options, meshes)
        texts[f"mjcf/scene{suffix}.xml"] = mjcf_scene(options, model)
    return texts


def mesh_files() -> dict[str, bytes]:
    """Name -> content of every file in ``meshes/``: the drawn bodies."""
    surfaces = {name: surface(body.solid) for name, body in bodies().items()}
    objects = {f"{name}.obj": obj(name, drawn) for name, drawn in surfaces.items()}
    return {**objects, MTL_NAME: mtl(), "alpha5.glb": glb(surfaces)}


def stale_files(repository: Path, fresh: dict[str, bytes]) -> dict[str, str]:
    """Path of each file that is out of date -> what differs."""
    stale = {}
    for path, content in fresh.items():
        file = repository / path
        old = file.read_bytes() if file.is_file() else b""
        if not same_content(old, content):
            stale[path] = difference(path, old, content)
    return stale


def same_content(one: bytes, other: bytes) -> bool:
    """Whether two files are the same but for the last digits of computed numbers."""
    if one == other:
        return True
    if one.startswith(GLB) and other.startswith(GLB):
        return same_scene(one, other)
    try:
        texts = [one.decode("utf-8"), other.decode("utf-8")]
    except UnicodeDecodeError:
        return False
    words, other_words = (NUMBER.split(text) for text in texts)
    numbers, other_numbers = (NUMBER.findall(text) for text in texts)
    return words == other_words and all(map(_same_number, numbers, other_numbers))


def same_scene(one: bytes, other: bytes) -> bool:
    """Whether two GLB files show the same; their bytes depend on trimesh's version."""
    scene, other_scene = (
        trimesh.load(BytesIO(data), file_type="glb", process=False)
        for data in (one, other)
    )
    nodes = sorted(scene.graph.nodes_geometry)
    if nodes != sorted(other_scene.graph.nodes_geometry):
        return False
    return all(_same_node(node, scene, other_scene) for node in nodes)


def _same_node(node: str, scene: Any, other_scene: Any) -> bool:
    """Whether both scenes draw the same body in a node."""
    pose, name = scene.graph[node]
    other_pose, other_name = other_scene.graph[node]
    body = scene.geometry[name]
    other = other_scene.geometry[other_name]
    look = body.visual.material
    other_look = other.visual.material
    return (
        np.allclose(pose, other_pose, rtol=0, atol=ROUNDED)
        and np.array_equal(body.faces, other.faces)
        and np.allclose(body.vertices, other.vertices, rtol=0, atol=ROUNDED)
        and np.allclose(body.vertex_normals, other.vertex_normals, atol=2e-4)
        and look.name == other_look.name
        and np.array_equal(look.baseColorFactor, other_look.baseColorFactor)
    )


def _same_number(one: str, other: str) -> bool:
    if one == other:
        return True
    is_computed = max(_digits(one), _digits(other)) >= COMPUTED_DIGITS
    return is_computed and math.isclose(float(one), float(other), rel_tol=SAME)


def _digits(number: str) -> int:
    """Count of significant digits."""
    mantissa = re.split("[eE]", number)[0]
    return len(mantissa.replace(".", "").strip("0"))


def difference(path: str, old: bytes, new: bytes) -> str:
    """Unified diff of two texts, or one line of two other files."""
    try:
        lines = [data.decode("utf-8").splitlines(True) for data in (old, new)]
    except UnicodeDecodeError:
        return f"{path}: {len(old)} bytes, and {len(new)} fresh ones\n"
    return "".join(difflib.unified_diff(*lines, f"old/{path}", f"new/{path}"))


def main(arguments: list[str] | None = None, repository: Path = REPOSITORY) -> int:
    """Write or check; returns the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    check = parser.parse_args(arguments).check
    fresh = generated_files()
    stale = stale_files(repository, fresh)
    if check:
        print("".join(stale.values()), end="")
        print(f"{len(fresh) - len(stale)} of {len(fresh)} generated files are fresh")
        return 1 if stale else 0
    atomic_write_all({repository / path: fresh[path] for path in stale})
    for path in stale:
        print(f"wrote {path}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
