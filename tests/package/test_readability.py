"""The code keeps the bounds of its style: short functions, records built by keyword."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest
from checks.count_lines import lines_of_code

import alpha5_model as a5

PACKAGE = Path(a5.__file__).parent
SOURCES = {
    path.relative_to(PACKAGE).as_posix(): path.read_text("utf-8")
    for path in sorted(PACKAGE.rglob("*.py"))
    if not {"generated", "_data"} & {*path.parts}
}
#: Lines of code of a function, without its docstring, comments and blank lines.
MOST_LINES = 60
#: Fields from which on a record is built by keyword.
MANY_FIELDS = 5
#: Positional arguments that such a record may have: what it is, and its value.
FEW = 2


def long_functions(source: str) -> list[str]:
    """Functions with more than the allowed lines of code."""
    code = lines_of_code(source)
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            own = range(node.lineno, (node.end_lineno or node.lineno) + 1)
            if len(code.intersection(own)) > MOST_LINES:
                found.append(node.name)
    return found


def records(source: str) -> Iterator[str]:
    """Names of records with many fields and no constructor of their own."""
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.ClassDef):
            continue
        made = " ".join(map(ast.unparse, [*node.decorator_list, *node.bases]))
        own = any(
            isinstance(x, ast.FunctionDef) and x.name == "__init__" for x in node.body
        )
        fields = [x for x in node.body if isinstance(x, ast.AnnAssign)]
        record = "dataclass" in made or "NamedTuple" in made
        if record and not own and len(fields) >= MANY_FIELDS:
            yield node.name


RECORDS = {name for source in SOURCES.values() for name in records(source)}


def built_by_position(source: str, names: set[str]) -> list[str]:
    """Calls of records with a starred tuple, or with more than `FEW` positions."""
    found = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            name = ast.unparse(node.func).rpartition(".")[2]
            starred = any(isinstance(x, ast.Starred) for x in node.args)
            if name in names and (starred or len(node.args) > FEW):
                found.append(f"line {node.lineno}: {name}")
    return found


@pytest.mark.slow
@pytest.mark.parametrize("file", SOURCES)
def test_functions_are_short(file: str) -> None:
    assert long_functions(SOURCES[file]) == []


@pytest.mark.parametrize("file", SOURCES)
def test_records_are_built_by_keyword(file: str) -> None:
    assert built_by_position(SOURCES[file], RECORDS) == []


def test_the_checks_see_what_they_look_for() -> None:
    long = "def f():\n    'text'\n\n" + "    # why\n    x = 1\n" * (MOST_LINES + 1)
    assert long_functions(long) == ["f"]
    # With the line of its name it has one more: two less are allowed.
    assert long_functions(long.replace("    x = 1\n", "", 2)) == []
    fields = "\n".join(f"    x{k}: int" for k in range(MANY_FIELDS))
    source = f"@dataclass(frozen=True)\nclass Row:\n{fields}\n"
    assert [*records(source)] == ["Row"]
    calls = "Row(1, 2, x2=3)\nm.Row(1, 2, 3)\nRow(*rest)\nRow(**rest)\n"
    assert built_by_position(calls, {"Row"}) == ["line 2: Row", "line 3: Row"]
