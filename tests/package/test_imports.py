"""``import alpha5_model`` stays light, and each module has its own name.

The direction of imports is checked by import-linter: `make lint`.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "alpha5_model"
HEAVY = {
    "pinocchio",
    "xacro",
    "trimesh",
    "meshcat",
    "matplotlib",
    "scipy",
    "casadi",
    "jax",
    "rich",
    "yaml",
    "pyarrow",
    "dask",
    "distributed",
}


def printed(script: str, folder: Path = PACKAGE.parent) -> set[str]:
    """The words that a script prints in a process of its own, run in a folder."""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        cwd=folder,
    )
    return set(done.stdout.split())


def loaded_after(statement: str) -> set[str]:
    top_levels = "{m.split('.')[0] for m in sys.modules}"
    return printed(f"{statement}\nimport sys; print(*{top_levels})")


def test_a_checkout_with_windows_line_ends_has_all_names(tmp_path: Path) -> None:
    folder = tmp_path / PACKAGE.name
    folder.mkdir()
    for name in ("__init__.py", "__init__.pyi", "errors.py"):
        lines = (PACKAGE / name).read_bytes().splitlines()
        (folder / name).write_bytes(b"\r\n".join(lines))
    script = "import alpha5_model; print(*alpha5_model.__all__)"
    assert printed(script, tmp_path) == printed(script)


def test_light_imports() -> None:
    assert not loaded_after("import alpha5_model") & HEAVY
    loaded = loaded_after(
        "import alpha5_model as a5; a5.parameters(); a5.published(); a5.URDF_PATH\n"
        "import alpha5_model.errors, alpha5_model.numbers.inertia\n"
        "import alpha5_model.numbers.corrections\n"
        "a5.dh.DHChain.alpha5().home; a5.planar.PlanarArm((5, 4)).workspace()"
    )
    assert "numpy" in loaded
    assert not loaded & HEAVY


def test_the_probe_sees_heavy_imports() -> None:
    assert "yaml" in loaded_after("import yaml")


@pytest.mark.slow
def test_no_function_hides_a_module() -> None:
    """`import alpha5_model.viewer.scene as s` gives a module after any other import."""
    names = [
        ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.parent != PACKAGE or path.stem not in ("__init__", "__main__")
    ]
    script = f"""
import sys
from importlib import import_module
from operator import attrgetter
import alpha5_model
names = {[name.removesuffix(".__init__") for name in names]}
for name in names:
    import_module(name)
for name in names:
    if attrgetter(name.partition(".")[2])(alpha5_model) is not sys.modules[name]:
        print(name)
"""
    assert printed(script) == set()
