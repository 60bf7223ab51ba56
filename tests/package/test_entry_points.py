"""Only entry points take the catalogue's arm; all others receive an arm."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "alpha5_model"
#: Function -> module that defines it.
CATALOGUE = {
    "parameters": "alpha5_model.numbers.parameters",
}
#: Module -> its callers of the catalogue: public functions without an arm among their
#: arguments, commands, generators, and what was made for the catalogue's arm only.
ENTRY_POINTS = {
    "cli.arm": "a command",
    "cli.ik": "a command",
    "collision.link_pairs": "for which lengths links never meet",
    "dynamics.arm_model": "Arm without a record",
    "dynamics.dimensions": "for which arm kernels and drawn bodies were made",
    "geometry.collision_shapes": "bodies that are drawn for the catalogue's arm",
    "numbers.arm_file": "arm_file; what a file leaves out is the catalogue's",
    "numbers.arm_writing": "a file says what differs from the catalogue's arm",
    "proofs.audit.printed_inverse_kinematics": "the published formulas",
    "proofs.audit.printed_workspace": "the published region",
    "proofs.audit.run": "audit",
    "studies.arm_numbers": "arm_numbers; zeros count from Table 1's angles",
    "studies.sweep.cases": "a study that names corrections",
    "viewer.build": "which URDF is drawn",
    "viewer.own_arm": "what the page says of the differences",
    "viewer.self_collision_plot": "self_collision_figure",
    "viewer.workspace_plot": "workspace_figure",
}


def catalogue_names(tree: ast.AST) -> tuple[set[str], dict[str, str]]:
    """Local names of the functions of `CATALOGUE`, and module name -> its function."""
    functions: set[str] = set()
    modules: dict[str, str] = {}
    function_of = {module: function for function, module in CATALOGUE.items()}
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom):
            continue
        for alias in node.names:
            name = alias.asname or alias.name
            if CATALOGUE.get(alias.name) == node.module:
                functions.add(name)
            whole = f"{node.module}.{alias.name}"
            if whole in function_of:
                modules[name] = function_of[whole]
    return functions, modules


def calls(source: str) -> list[int]:
    """Lines of a source that call one of the functions of `CATALOGUE`."""
    tree = ast.parse(source)
    functions, modules = catalogue_names(tree)
    lines = []
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        match node.func:
            case ast.Name(id=name) if name in functions:
                lines.append(node.lineno)
            case ast.Attribute(value=ast.Name(id=module), attr=name):
                if modules.get(module) == name:
                    lines.append(node.lineno)
    return lines


def callers() -> dict[str, list[int]]:
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        name = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
        lines = calls(path.read_text("utf-8"))
        if lines:
            found[name] = lines
    return found


@pytest.mark.slow
def test_only_entry_points_ask_for_the_catalogue() -> None:
    found = callers()
    elsewhere = {name: found[name] for name in found.keys() - ENTRY_POINTS.keys()}
    assert elsewhere == {}, "receive the arm as an argument, or say why not"
    assert ENTRY_POINTS.keys() - found.keys() == set(), "asks no more"


@pytest.mark.parametrize(
    "source",
    [
        "from alpha5_model.numbers.parameters import parameters\nparameters()",
        "from alpha5_model.numbers.parameters import parameters as p\n"
        "def f():\n    p(())",
        "from alpha5_model.numbers import parameters as records\nrecords.parameters()",
    ],
)
def test_the_guard_sees_a_call(source: str) -> None:
    assert calls(source)


def test_the_guard_sees_no_call_in_other_names() -> None:
    assert calls("def f(parameters):\n    parameters()") == []
    assert calls("arm.parameters()") == []
    imported = "from alpha5_model.numbers.parameters import Alpha5Parameters\n"
    assert calls(imported + "def f(p: Alpha5Parameters): return p.dh") == []
