"""Compiles ``alpha5_model/kernels/_compiled`` for a wheel, or in place.

    python hatch_build.py            # in place, for a checkout that is not installed
    python hatch_build.py --digest   # of the sources, and the flags

This needs NumPy, setuptools and a C compiler. Without a compiler, a wheel is built
without the kernels and computes in NumPy; with ``ALPHA5_REQUIRE_KERNELS=1`` that is an
error.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import sys
import sysconfig
import tempfile
from pathlib import Path
from typing import Any

try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ModuleNotFoundError:  # in place, beside an installed package
    BuildHookInterface = object  # type: ignore[misc, assignment]

ROOT = Path(__file__).resolve().parent
FOLDER = Path("alpha5_model", "kernels")
MODULE = "_compiled.abi3.so"
#: For GCC and Clang, whose vector extensions the kernels are written in.
#: `-ffp-contract=off`: the same bits on every processor; gcc 12 contracts nevertheless
#: where it vectorizes straight lines (a vfmsubadd). Nothing reads errno.
FLAGS = [
    "-O3",
    "-ffp-contract=off",
    "-fno-tree-slp-vectorize",
    "-fno-math-errno",
    "-Wno-psabi",
    "-g0",
]
#: Where the models of `mjcf/` have their meshes: in a checkout the folder stands alone,
#: in a wheel they are in the package once.
MESHES = {"checkout": 'meshdir="assets"', "wheel": 'meshdir="../meshes"'}


def digest() -> str:
    """SHA-256 of the C sources."""
    files = sorted((ROOT / FOLDER).rglob("*.[ch]"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def made_of() -> str:
    """What the compiled module names as its own: sources and flags."""
    return f"{digest()} {' '.join(FLAGS)}"


def compiled() -> Path:
    """The module, compiled below ``build/`` unless one of these sources is there."""
    folder = ROOT / "build" / "kernels" / sysconfig.get_platform()
    there = next(path for path in (folder, *folder.parents) if path.exists())
    if not os.access(there, os.W_OK):  # a read-only mount, another user's build: once
        folder = Path(tempfile.mkdtemp())
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
    module = folder / MODULE
    if not (module.is_file() and made_of().encode() in module.read_bytes()):
        compile_into(folder)
    return module


def compile_into(folder: Path) -> None:
    """Compile the module."""
    import numpy
    from setuptools import Distribution, Extension

    extension = Extension(
        "_compiled",
        [str(ROOT / FOLDER / "_compiled.c")],
        include_dirs=[numpy.get_include()],
        define_macros=[("SOURCES", f'"{made_of()}"')],
        extra_compile_args=FLAGS,
        py_limited_api=True,
    )
    with tempfile.TemporaryDirectory() as objects:
        distribution = Distribution({"ext_modules": [extension]})
        command = distribution.get_command_obj("build_ext")
        command.build_lib = str(folder)
        command.build_temp = objects
        command.force = True
        command.ensure_finalized()
        command.run()


def compiled_in_place() -> Path:
    """The module, beside its sources."""
    place = ROOT / FOLDER / MODULE
    # As a new file: a running program keeps the one that it has loaded.
    copy = shutil.copy(compiled(), place.with_suffix(".new"))
    return Path(copy).replace(place)


def mjcf_files(output: Path) -> dict[str, str]:
    """Write ``mjcf/`` for a wheel, without the meshes: file -> its place there."""
    places = {}
    for file in sorted((ROOT / "mjcf").iterdir()):
        if file.is_dir():
            continue
        content = file.read_bytes()
        if file.suffix == ".xml":
            content = content.replace(*(line.encode() for line in MESHES.values()))
        (output / file.name).write_bytes(content)
        places[str(output / file.name)] = f"alpha5_model/_data/mjcf/{file.name}"
    return places


class KernelHook(BuildHookInterface):
    """Adds the compiled kernels to a wheel; an editable install gets them in place.

    A wheel also gets ``mjcf/``, whose meshes it has already.
    """

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Called by hatchling before it collects the files of the wheel."""
        editable = version == "editable"
        self.folder = None if editable else Path(tempfile.mkdtemp())
        if self.folder:
            build_data["force_include"] |= mjcf_files(self.folder)
        try:
            module = compiled_in_place() if editable else compiled()
        except (Exception, SystemExit) as error:
            self._without_kernels(error)
            return

        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{platform}"
        if not editable:
            build_data["force_include"][str(module)] = str(FOLDER / module.name)

    def _without_kernels(self, error: BaseException) -> None:
        """Say that the kernels are not compiled, or fail if they must be.

        Raises:
            RuntimeError: ``ALPHA5_REQUIRE_KERNELS=1``.
        """
        if os.environ.get("ALPHA5_REQUIRE_KERNELS") == "1":
            raise RuntimeError(
                f"the kernels cannot be compiled here: {error}"
            ) from None
        self.app.display_warning(f"kernels not compiled, NumPy will compute: {error}")

    def finalize(
        self, version: str, build_data: dict[str, Any], artifact_path: str
    ) -> None:
        """Called when the wheel is written."""
        if self.folder:
            shutil.rmtree(self.folder)


if __name__ == "__main__":
    print(made_of() if "--digest" in sys.argv else compiled_in_place())
