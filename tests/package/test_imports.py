"""``import alpha5_model`` stays light, and imports run in one direction."""

from __future__ import annotations

import ast
import subprocess
import sys
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "alpha5_model"
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

#: The arrows of the design, packages from the bottom up. A module may import from
#: layers before its own and from its own package. A sub-package may have its own layer.
LAYERS: tuple[tuple[str, ...], ...] = (
    ("errors",),
    ("_support",),
    ("codegen.kernels",),
    ("numbers",),
    ("theory.planar",),
    ("theory.dh",),
    ("geometry",),
    ("collision",),
    ("kinematics",),
    ("codegen",),
    ("description",),
    ("dynamics",),
    ("water", "loaders"),
    ("trajectory", "casadi", "jax", "codegen.c_library"),
    ("planning",),
    ("proofs.audit", "proofs.comparison"),
    ("workspace",),
    ("studies.vehicle_tilt",),
    ("studies.uncertainty",),
    ("studies.calibration",),
    ("studies.sweep",),
    ("viewer",),
    ("cli",),
)
LEVEL = {name: level for level, layer in enumerate(LAYERS) for name in layer}
#: Folders of packages, in whose own `__init__` is nothing.
GROUPS = {"proofs", "studies", "theory"}
#: What anyone may take from the package itself.
FROM_ROOT = {"__version__"}
#: Methods that hand over to a later layer when they are called, not when imported.
HAND_OVERS = {
    ("alpha5_model.theory.dh.urdf", "description"),  # whose reader names the line
    ("alpha5_model.dynamics.arm", "water"),  # Arm.with_hydrodynamics, Arm.on_vehicle
}


def printed(script: str) -> list[str]:
    """The words that a script prints in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        text=True,
        check=True,
        cwd=PACKAGE.parent,
    )
    return done.stdout.split()


def loaded_after(statement: str) -> set[str]:
    top_levels = "sorted({m.split('.')[0] for m in sys.modules})"
    script = f"{statement}\nimport sys; print(*{top_levels})"
    return set(printed(script))


@pytest.mark.parametrize(
    "statement",
    [
        "import alpha5_model",
        "import alpha5_model as a5; a5.parameters(); a5.published(); a5.URDF_PATH",
        "import alpha5_model.errors, alpha5_model.numbers.inertia, "
        "alpha5_model.numbers.corrections",
        "import alpha5_model as a5; a5.dh.DHChain.alpha5().home; "
        "a5.planar.PlanarArm((5, 4)).workspace()",
    ],
)
def test_light_imports(statement: str) -> None:
    loaded = loaded_after(statement)
    assert "numpy" in loaded or statement == "import alpha5_model"
    assert loaded.isdisjoint(HEAVY), loaded & set(HEAVY)


def test_the_probe_sees_heavy_imports() -> None:
    assert "pinocchio" in loaded_after("import pinocchio")


def unit(name: str) -> str:
    """The package of `LAYERS` that a module belongs to, itself if it is in none."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        if ".".join(parts[:length]) in LEVEL:
            return ".".join(parts[:length])
    return parts[0]


def imports(source: str, module: str) -> set[str]:
    """Packages of `LAYERS` that a source imports from, anywhere in it."""
    package = module.split(".")[:-1]
    found = set()
    for node in ast.walk(ast.parse(source)):
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = (
                ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            )
            start = ".".join(part for part in (base, node.module or "") if part)
            names = [f"{start}.{alias.name}" for alias in node.names]
        for name in names:
            root, _, rest = name.partition(".")
            if root == "alpha5_model":
                found.add(unit(rest) if rest else "")
    return found - FROM_ROOT


def imports_on_load(source: str, module: str) -> set[str]:
    """The same, outside of functions and of what only a type checker reads."""
    tree = ast.parse(source)
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            node.body = [ast.Pass()]
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node.body = [ast.Pass()]
    return imports(ast.unparse(tree), module)


def violations(source: str, module: str) -> list[str]:
    own = unit(module.partition(".")[2])
    if own in GROUPS and not imports(source, module):
        return []
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
                f"{module}: imports {name or 'the package itself'!r}, "
                "which is in no layer"
            )
        elif level >= LEVEL[own]:
            wrong.append(
                f"{module}: imports {name!r}, against the direction of the layers"
            )
    return wrong


def modules() -> dict[str, Path]:
    return {
        ".".join(
            ("alpha5_model", *path.relative_to(PACKAGE).with_suffix("").parts)
        ): path
        for path in sorted(PACKAGE.rglob("*.py"))
        if path.parent != PACKAGE or path.stem not in ("__init__", "__main__")
    }


def named_modules(source: str, among: set[str]) -> set[str]:
    """The modules that a source imports anywhere, late and for types included."""
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
    graph = {
        name: named_modules(text, {*sources} - {name}) for name, text in sources.items()
    }
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


@pytest.mark.slow
def test_no_module_imports_what_imports_it() -> None:
    sources = {
        m.removesuffix(".__init__"): p.read_text("utf-8") for m, p in modules().items()
    }
    assert cycle(sources) == []


def test_the_guard_sees_a_cycle() -> None:
    late = "def f() -> None:\n    from alpha5_model.a.x import g"
    sources = {
        "alpha5_model.a.x": "from alpha5_model.a import y",
        "alpha5_model.a.y": late,
    }
    assert set(cycle(sources)) == {*sources}
    for_types = "if TYPE_CHECKING:\n    import alpha5_model.a.x"
    assert cycle({**sources, "alpha5_model.a.y": for_types})
    assert cycle({**sources, "alpha5_model.a.y": "from alpha5_model.a import z"}) == []


@pytest.mark.slow
def test_imports_run_in_one_direction() -> None:
    assert len(modules()) > 15
    wrong = [
        v for m, p in modules().items() for v in violations(p.read_text("utf-8"), m)
    ]
    assert wrong == []


@pytest.mark.parametrize(
    ("module", "source"),
    [
        ("alpha5_model.numbers.inertia", "from alpha5_model.theory import dh"),
        ("alpha5_model._support.text", "from ..numbers.parameters import parameters"),
        ("alpha5_model.errors", "def f():\n    import alpha5_model.cli.main"),
        ("alpha5_model.dynamics.arm", "import alpha5_model as a5"),
        ("alpha5_model.dynamics.arm", "from alpha5_model.water import arm"),
        (
            "alpha5_model.dynamics.batch",
            "def f():\n    from alpha5_model.water import arm",
        ),
        ("alpha5_model.kinematics.x", "from alpha5_model.description import bodies"),
        (
            "alpha5_model.theory.dh.chain",
            "from alpha5_model.description import reading",
        ),
        ("alpha5_model.theory.planar.arm", "from alpha5_model.theory import dh"),
        (
            "alpha5_model.codegen.kernels.choice",
            "from alpha5_model.codegen import instructions",
        ),
        ("alpha5_model.proofs.audit.row", "from alpha5_model import viewer"),
        ("alpha5_model.novelty", "pass"),
    ],
)
def test_the_guard_catches(module: str, source: str) -> None:
    assert violations(source, module)


def test_the_guard_lets_pass() -> None:
    assert (
        violations(
            "from .row import Row\nfrom alpha5_model import __version__",
            "alpha5_model.cli.x",
        )
        == []
    )
    assert (
        violations(
            "from alpha5_model.numbers.inertia import combine",
            "alpha5_model.proofs.audit.run.x",
        )
        == []
    )


@pytest.mark.slow
def test_no_function_hides_a_module() -> None:
    """`import alpha5_model.viewer.scene as s` gives a module after any other import."""
    names = [name.removesuffix(".__init__") for name in modules()]
    script = f"""
import sys
from importlib import import_module
from operator import attrgetter
import alpha5_model
for name in {names}:
    import_module(name)
for name in {names}:
    if attrgetter(name.partition(".")[2])(alpha5_model) is not sys.modules[name]:
        print(name)
"""
    assert printed(script) == []


def test_the_package_has_few_entries() -> None:
    entries = {path.stem for path in PACKAGE.iterdir() if path.name[:2] != "__"}
    assert len(entries - {"py", "_data"}) <= 21
