"""The committed generated files, and how far they are from a fresh generation."""

from __future__ import annotations

import difflib
import math
import re
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
from alpha5_model.description.moveit import moveit_files
from alpha5_model.description.srdf import NAMED_POSES, srdf
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.description.xacro_parameters import parameter_yaml
from alpha5_model.geometry.drawing import bodies
from alpha5_model.geometry.gltf import Node, glb
from alpha5_model.geometry.triangles import Surface, surface
from alpha5_model.geometry.wavefront import MTL_NAME, mtl, obj
from alpha5_model.numbers.parameters import Alpha5Parameters, parameters

GLB_NAME = "alpha5.glb"
#: Package that some of the files need -> what is left out without it.
_NEEDED = {"manifold3d": "meshes are not drawn", "casadi": "formulas are not generated"}
#: Drawn by ``scripts/figures/make_figures.py``, not compared: pixels depend on the
#: renderer.
_PICTURE = b"![The arm in its home pose](alpha5.png)"


#: A number in a text without its sign, and its digits.
_NUMBER = re.compile(r"(?<![\w.])(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?!\w)")
#: Numbers of at least so many digits are computed. Two of them are the same if they
#: differ by this, relative to their size.
_COMPUTED_DIGITS = 10
_SAME = 1e-9


@dataclass(frozen=True)
class StaleFile:
    """A committed file that differs from what would be generated now.

    Attributes:
        path: Relative to the repository.
        diff: Unified diff, committed against fresh; one line for binary or missing
            files.
    """

    path: str
    diff: str


def generated_files() -> dict[str, bytes]:
    """Every file that is committed and generated: path in the repository -> content.

    Meshes and formulas are left out if the packages that they need are not installed,
    see `not_generated`.
    """
    arm = parameters()
    drawn = {} if "manifold3d" in _missing_packages() else mesh_files()
    texts = {"xacro/parameters.yaml": parameter_yaml(arm)}
    for gripper, name in (("locked", "alpha5"), ("jaws", "alpha5_jaws")):
        texts[f"urdf/{name}.urdf"] = urdf(Variant(gripper=gripper))
        texts[f"urdf/{name}.srdf"] = srdf(gripper)
    # ROS 2 alone reads them, so a wheel does not have them.
    if _in_checkout():
        texts |= {f"config/{name}": text for name, text in moveit_files(arm).items()}
    texts |= _formulas()
    return {
        **{path: text.encode("utf-8") for path, text in texts.items()},
        **{f"meshes/{name}": content for name, content in drawn.items()},
        **_menagerie(drawn),
    }


def _formulas() -> dict[str, str]:
    """Generated source code of the package; none outside of a checkout."""
    if not _in_checkout() or "casadi" in _missing_packages():
        return {}

    from alpha5_model.codegen.sources import generated_sources

    return generated_sources()


def _menagerie(drawn: Mapping[str, bytes]) -> dict[str, bytes]:
    """``mjcf/`` in the form of MuJoCo Menagerie: jaws locked, moving, and for MJX."""
    locked = mjcf_files()
    jaws = mjcf_files(MjcfOptions(gripper="jaws"))
    mjx = mjcf_files(MjcfOptions(collision="capsules"))
    title, text = locked["README.md"].split(b"\n\n", 1)

    files = {}
    for path, content in locked.items():
        if not path.startswith("assets/"):
            files[f"mjcf/{path}"] = content
    files["mjcf/README.md"] = b"\n\n".join((title, _PICTURE, text))
    files["mjcf/alpha5_jaws.xml"] = jaws["alpha5.xml"]
    scene = locked["scene.xml"]
    files["mjcf/scene_jaws.xml"] = scene.replace(b"alpha5", b"alpha5_jaws")
    files["mjcf/alpha5_mjx.xml"] = mjx["alpha5.xml"]
    files["mjcf/scene_mjx.xml"] = scene.replace(b"alpha5", b"alpha5_mjx")
    if not _in_checkout():
        return {path: _in_wheel(content) for path, content in files.items()}
    for name, content in drawn.items():
        if name.endswith(".obj"):
            files[f"mjcf/assets/{name}"] = content
    return files


def _in_wheel(content: bytes) -> bytes:
    """A file of ``mjcf/`` as ``hatch_build.py`` puts it into a wheel.

    The wheel has the meshes once, in ``meshes/``.
    """
    return content.replace(b'meshdir="assets"', b'meshdir="../meshes"')


def not_generated() -> tuple[str, ...]:
    """Why some files are not generated here: one line for each missing package."""
    lines = []
    for name in _missing_packages():
        remedy = f"the {_NEEDED[name]} anew (pip install {name})"
        lines.append(f"{name} is not installed: {remedy}")
    return tuple(lines)


def _missing_packages() -> list[str]:
    """Packages of `_NEEDED` that are not installed."""
    # Formulas, which need casadi, are generated in a checkout only.
    needed = _NEEDED if _in_checkout() else ["manifold3d"]
    return [package for package in needed if find_spec(package) is None]


def _in_checkout() -> bool:
    return Path(REPOSITORY_PATH, "alpha5_model").is_dir()


def stale_files(
    repository: str = REPOSITORY_PATH, fresh: Mapping[str, bytes] | None = None
) -> list[StaleFile]:
    """Compare the committed files with a fresh generation; empty if all agree.

    Computed numbers may differ in their last digits, see `same_content`.

    Args:
        repository: Folder that holds ``urdf/``, ``xacro/``, ``config/``, ``meshes/``
            and ``mjcf/``.
        fresh: Result of `generated_files`; computed if not given.
    """
    files = generated_files() if fresh is None else fresh
    stale = []
    for path, content in files.items():
        file = Path(repository) / path
        committed = file.read_bytes() if file.is_file() else None
        if committed is None or not same_content(committed, content):
            stale.append(StaleFile(path, _diff(path, committed, content)))
    return stale


def same_content(one: bytes, other: bytes) -> bool:
    """Whether two files are the same but for the last digits of computed numbers.

    These differ between processors. Texts and short numbers must be equal.
    """
    if one == other:
        return True
    try:
        texts = [one.decode("utf-8"), other.decode("utf-8")]
    except UnicodeDecodeError:
        return False
    words, other_words = (_NUMBER.split(text) for text in texts)
    numbers, other_numbers = (_NUMBER.findall(text) for text in texts)
    return words == other_words and all(map(_same_number, numbers, other_numbers))


def _same_number(one: str, other: str) -> bool:
    if one == other:
        return True
    is_computed = max(_digits(one), _digits(other)) >= _COMPUTED_DIGITS
    return is_computed and math.isclose(float(one), float(other), rel_tol=_SAME)


def _digits(number: str) -> int:
    """Count of significant digits."""
    mantissa = re.split("[eE]", number)[0]
    return len(mantissa.replace(".", "").strip("0"))


def update(repository: str = REPOSITORY_PATH) -> list[Path]:
    """Write the stale files of the repository anew; returns their paths."""
    fresh = generated_files()
    changed = {}
    for stale in stale_files(repository, fresh):
        changed[Path(repository, stale.path)] = fresh[stale.path]
    atomic_write_all(changed)
    return list(changed)


@cache
def mesh_files() -> dict[str, bytes]:
    """Name -> content of every file in ``meshes/``; the same bytes every time.

    Raises:
        MissingDependencyError: manifold3d, with which the bodies are drawn, is not
            installed.
    """
    surfaces = {name: surface(body.solid) for name, body in bodies().items()}
    objects = {f"{name}.obj": obj(name, drawn) for name, drawn in surfaces.items()}
    scene = glb(list(_scene(surfaces, parameters())))
    return {**objects, MTL_NAME: mtl(), GLB_NAME: scene}


def _scene(
    surfaces: Mapping[str, Surface], parameters: Alpha5Parameters
) -> Iterator[Node]:
    """The arm in its home pose.

    Node ``link_i`` turns about z in node ``axis_...`` by the joint angle.
    """
    # glTF has y up, the base frame has z up.
    yield Node("base_link", Placement("", rpy=(-math.pi / 2, 0.0, 0.0)))
    angles = iter(NAMED_POSES["home"])
    for body in arm_bodies(parameters, "jaws"):
        if not body.meshes:  # the rod
            continue
        placement = body.placement
        if body.joint is not None:
            yield Node(body.joint.name, placement)
            angle = next(angles, 0.0)
            placement = Placement(body.joint.name, rpy=(0.0, 0.0, angle))
        yield Node(body.name, placement, surfaces[body.name])


def _diff(path: str, committed: bytes | None, fresh: bytes) -> str:
    """Unified diff of a committed and a fresh file."""
    if committed is None:
        return f"{path}: missing\n"
    try:
        old = committed.decode("utf-8").splitlines(True)
        new = fresh.decode("utf-8").splitlines(True)
    except UnicodeDecodeError:
        return f"{path}: {len(committed)} bytes differ from {len(fresh)} fresh ones\n"
    lines = difflib.unified_diff(old, new, f"committed/{path}", f"fresh/{path}")
    return "".join(lines)
