"""``import alpha5_model`` stays light, and imports run in one direction."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

import alpha5_model

PACKAGE = Path(__file__).resolve().parent.parent / "alpha5_model"
HEAVY = (
    "pinocchio",
    "xacro",
    "trimesh",
    "meshcat",
    "matplotlib",
    "scipy",
    "casadi",
    "jax",
    "typer",
    "rich",
    "yaml",
    "pyarrow",
    "dask",
    "distributed",
)

#: The arrows of the design. A module may import from the layers before its own and from its own name.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("errors", "checks", "plausibility", "files", "paths", "text", "fluids", "spatial", "kernels"),
    ("published",),
    (
        "inertia",
        "corrections",
        "parameters",
        "jaws",
        "hydrodynamics",
        "base_parameters",
    ),
    ("planar", "actuators", "meshing"),
    ("dh",),
    ("kinematics",),
    ("symbolic",),
    ("description",),
    ("dynamics", "comparison", "loaders"),
    ("trajectory", "casadi", "jax", "c_library"),
    ("consistency",),
    ("uncertainty",),
    ("sweep",),
    ("view",),
    ("cli",),
)
LEVEL = {name: level for level, layer in enumerate(LAYERS) for name in layer}
#: Within the first and third layer, siblings build on one another.
OPEN_LAYERS = {0, 2}
#: What anyone may take from the package itself.
FROM_ROOT = {"__version__"}
#: Methods that hand over to a later layer when they are called, never when they are imported.
HAND_OVERS = {
    ("alpha5_model.dh.urdf", "description"),  # whose reader names the line
}


def loaded_after(statement: str) -> set[str]:
    script = f"{statement}\nimport sys; print(*sorted({{m.split('.')[0] for m in sys.modules}}))"
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        cwd=PACKAGE.parent,
    )
    return set(done.stdout.split())


@pytest.mark.parametrize(
    "statement",
    [
        "import alpha5_model",
        "import alpha5_model as a5; a5.parameters(); a5.published(); a5.URDF_PATH",
        "import alpha5_model.errors, alpha5_model.inertia, alpha5_model.corrections",
        "import alpha5_model as a5; a5.dh.DHChain.alpha5().home; a5.planar.PlanarArm((5, 4)).workspace()",
    ],
)
def test_light_imports(statement: str) -> None:
    loaded = loaded_after(statement)
    assert "numpy" in loaded
    assert loaded.isdisjoint(HEAVY), loaded & set(HEAVY)


def test_the_probe_sees_heavy_imports() -> None:
    assert "pinocchio" in loaded_after("import pinocchio")


def imports(source: str, module: str) -> set[str]:
    """Modules of this package that a source imports, anywhere in it, as top-level names."""
    package = module.split(".")[:-1]
    found = set()
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            start = ".".join(part for part in (base, node.module or "") if part)
            names = [f"{start}.{alias.name}" for alias in node.names]
        for name in names:
            parts = name.split(".")
            if parts[0] == "alpha5_model":
                found.add(parts[1] if len(parts) > 1 else "")
    return found - FROM_ROOT


def imports_on_load(source: str, module: str) -> set[str]:
    """The same, outside of functions."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            node.body = [ast.Pass()]
    return imports(ast.unparse(tree), module)


def violations(source: str, module: str) -> list[str]:
    own = module.split(".")[1]
    if own not in LEVEL:
        return [f"{module}: say in LAYERS where {own!r} belongs"]
    wrong = []
    for name in imports(source, module):
        if name == own or (
            (module, name) in HAND_OVERS and name not in imports_on_load(source, module)
        ):
            continue
        level = LEVEL.get(name)
        if level is None:
            wrong.append(
                f"{module}: imports {name or 'the package itself'!r}, which is in no layer"
            )
        elif level > LEVEL[own] or (level == LEVEL[own] and level not in OPEN_LAYERS):
            wrong.append(f"{module}: imports {name!r}, against the direction of the layers")
    return wrong


def modules() -> dict[str, Path]:
    return {
        ".".join(("alpha5_model", *path.relative_to(PACKAGE).with_suffix("").parts)): path
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.parent != PACKAGE or path.stem not in ("__init__", "__main__")
    }


def named_modules(source: str, among: set[str]) -> set[str]:
    """Which modules a source imports anywhere, late imports and those for types included."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are written in full"
            whole = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {name if name in among else str(node.module) for name in whole}
    return found & among


def cycle(sources: dict[str, str]) -> list[str]:
    """Modules that import one another in a circle; empty if there is none."""
    graph = {name: named_modules(text, {*sources} - {name}) for name, text in sources.items()}
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_module_imports_what_imports_it() -> None:
    sources = {m.removesuffix(".__init__"): p.read_text("utf-8") for m, p in modules().items()}
    assert cycle(sources) == []


def test_the_guard_sees_a_cycle() -> None:
    late = "def f() -> None:\n    from alpha5_model.a.x import g"
    sources = {"alpha5_model.a.x": "from alpha5_model.a import y", "alpha5_model.a.y": late}
    assert set(cycle(sources)) == {*sources}
    for_types = "if TYPE_CHECKING:\n    import alpha5_model.a.x"
    assert cycle({**sources, "alpha5_model.a.y": for_types})
    assert cycle({**sources, "alpha5_model.a.y": "from alpha5_model.a import z"}) == []


def test_imports_run_in_one_direction() -> None:
    assert len(modules()) > 15
    wrong = [v for m, p in modules().items() for v in violations(p.read_text("utf-8"), m)]
    assert wrong == []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("alpha5_model.inertia", "from alpha5_model import dh"),
        ("alpha5_model.published.tables", "from ..parameters import parameters"),
        ("alpha5_model.errors", "def f():\n    import alpha5_model.cli.main"),
        ("alpha5_model.dynamics.arm", "import alpha5_model as a5"),
        ("alpha5_model.kinematics.x", "from alpha5_model.description import bodies"),
        ("alpha5_model.dh.chain", "from alpha5_model.description import urdf_reading"),
        ("alpha5_model.actuators", "from alpha5_model import dh"),
        ("alpha5_model.consistency.row", "from alpha5_model import view"),
        ("alpha5_model.novelty", "pass"),
    ],
)
def test_the_guard_catches(module: str, source: str) -> None:
    assert violations(source, module)


def test_the_guard_lets_pass() -> None:
    assert (
        violations(
            "from .row import Row\nfrom alpha5_model import __version__", "alpha5_model.cli.x"
        )
        == []
    )
    assert (
        violations("from alpha5_model.inertia import combine", "alpha5_model.consistency.x") == []
    )


def test_the_function_that_shadows_its_module_has_the_modules_names() -> None:
    import alpha5_model.parameters as p
    import alpha5_model.published.tables as tables

    assert p.parameters is alpha5_model.parameters
    assert p.JointRange is type(p.parameters().joints[0]).__mro__[1]
    assert isinstance(p.published(), tables.Published)
    public = {name for name in vars(sys.modules["alpha5_model.parameters"]) if name[0] != "_"}
    assert all(getattr(p, name) is not None for name in public)
    assert "__file__" not in vars(p)
