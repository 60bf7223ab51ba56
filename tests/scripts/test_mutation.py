"""How mutants are made and drawn; whether the tests see them takes hours."""

from __future__ import annotations

import ast
import random
from collections import Counter
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def parts():
    """The modules that need nothing but Python: mutants, Python's and C's."""
    from mutating import c_code, mutants, python_code

    return mutants, python_code, c_code


def made(part: ModuleType, name: str, text: str) -> set[str]:
    """All mutants of a source."""
    chance = random.Random(1)
    places = part.places(Path(name), text)
    return {mutant.text for place in places for mutant in place(chance)}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("y = a is b\n", {"y = a is not b\n"}),
        ("y = a @ b\n", set()),
        ("y = a == 'b'\n", {"y = a != 'b'\n"}),
        ("y = 'b' != a\n", {"y = 'b' == a\n"}),
        ("y = a.reshape(b, -1)\n", {"y = a.reshape(b,  1)\n"}),
        ("y = a.reshape((-1, b))\n", {"y = a.reshape(( 1, b))\n"}),
        ("y = a and b\n", {"y = a or b\n"}),
        ("y: int | None = x\n", set()),
        ("def f(a: A | B = True) -> C | D: ...\n", {"False"}),
        ("y = True\n", {"y = False\n"}),
        ("s = 'ä'; y = 2\n", {"s = 'ä'; y = (3)\n", "s = 'ä'; y = (1)\n"}),
        ("y = zip(a, b, strict=True)\n", set()),
        ("@cache\ndef f(): ...\n", set()),
        ("@lru_cache(maxsize=8)\ndef f(): ...\n", set()),
        ("@dataclass(slots=True)\nclass A: ...\n", {"\nclass A: ...\n"}),
        ("@property\ndef f(): ...\n", {"\ndef f(): ...\n"}),
        ("for x in y:\n    break\n", {"for x in ():", "continue"}),
        ("try:\n    f()\nexcept E:\n    g()\n", {"except ():"}),
        ("if TYPE_CHECKING:\n    import a\n", set()),
        ("if a:\n    b()\n", {"if (not (a)):\n    b()\n"}),
    ],
)
def test_mutants_of_python(parts, source, expected):
    found = made(parts[1], "a.py", source)
    assert len(found) == len(expected)
    for text in expected:
        assert any(text in mutant for mutant in found)
    for mutant in found:
        ast.parse(mutant)


def test_any_arithmetic_operator_may_stand_for_any_other(parts):
    found = made(parts[1], "a.py", "y = a * b\n")
    others = ("+", "-", "/", "//", "%", "**")
    assert found == {f"y = a {operator} b\n" for operator in others}


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("a < b;", {"a <= b;", "a > b;", "a == b;"}),
        ("a && b;", {"a || b;", "a || 0 && b;"}),
        ("x = 4;", {"x = 5;", "x = 3;"}),
        ("x = 0.125;", {"x = 0.225;"}),
        ("double *x;", set()),
        ("f(&x, -y);", {"f(&x, y);"}),
        ("/* a < b */ \"a < b\" 'a' // 1\n", set()),
        ("#if A == 1\n#include <a.h>\n", set()),
        ("#define A(x) (x + 1)\n", {"(x - 1)", "(x * 1)", "(x + 2)", "(x + 0)"}),
        ("for (i = 0; i < $count; i++)", {"(-1)", "= 1;", ">", "<=", "==", "--"}),
        ("p->x >>= q;", set()),
    ],
)
def test_mutants_of_c(parts, source, expected):
    found = made(parts[2], "a.c", source)
    assert len(found) == len(expected)
    for text in expected:
        assert any(text in mutant for mutant in found)


@pytest.mark.slow
def test_all_rooms_and_all_c_that_is_written_by_hand_have_mutants(parts):
    mutants, python_code, c_code = parts
    texts = mutants.sources()
    rooms = {mutants.room(file) for file in texts}
    folders = {p.parent.name for p in mutants.PACKAGE.glob("*/__init__.py")}
    assert folders <= rooms
    assert {"C", "errors.py", "jax.py"} <= rooms
    c_files = {file.name for file in texts if mutants.is_c(file)}
    assert {"_compiled.c", "rows.h", "vector.h", "test_alpha5.c"} <= c_files
    assert not any("generated" in file.parts for file in texts)
    with_places = {
        mutants.room(file)
        for file, text in texts.items()
        if (c_code if mutants.is_c(file) else python_code).places(file, text)
    }
    assert len(with_places) >= 0.9 * len(rooms)


@pytest.mark.slow
def test_a_sample_has_rooms_by_their_lines_and_is_new_with_a_new_seed(parts):
    mutants, python_code, _ = parts
    texts = {
        Path("large/a.py"): "x = a < b\n" * 300,
        Path("small.py"): "x = a < b\n" * 100,
    }

    def drawn(seed: int, count: int = 120) -> list:
        lines = lambda file, text: python_code.code_lines(text)  # noqa: E731
        return mutants.draw(texts, python_code.places, lines, count, seed)

    first = drawn(1)
    assert first == drawn(1)
    assert first != drawn(2)
    assert drawn(1, 140)[:120] == first
    assert len({mutant.key for mutant in first}) == 120
    share = Counter(mutants.room(mutant.file) for mutant in first)
    # Binomial: 90 of 120, standard deviation 5.
    assert 70 <= share["large"] <= 108


def test_an_equivalent_mutant_is_named_with_a_reason_and_its_line_exists(parts):
    mutants, _, _ = parts
    texts = {file.as_posix(): text for file, text in mutants.sources().items()}
    for (file, line, mutant), reason in mutants.equivalents().items():
        lines = {text.strip() for text in texts[file].splitlines()}
        assert line in lines, f"{file}: no such line: {line}"
        assert mutant != line
        assert len(reason) > 20


def test_the_known_mutants_are_still_made_of_the_source(parts):
    from mutating.proofs import PROOFS

    texts = parts[0].sources()
    for proof in PROOFS:
        text = texts[Path(proof.file)]
        mutant = proof.mutant(text)
        assert mutant.text != text
        with pytest.raises(ValueError, match="no longer contains"):
            proof.mutant("")


def test_the_statement_around_a_line(parts):
    source = "def f(\n    a=1,\n):\n    return [\n        a,\n        2,\n    ]\n"
    assert parts[1].statement(source, 2) == range(1, 4)
    assert parts[1].statement(source, 6) == range(4, 8)


def test_the_readers_of_what_an_import_computes(parts):
    source = (
        "_MOST = (\n    3\n)\n\n\ndef f():\n    return _MOST\n\n\n"
        "class A:\n    size: int = 1\n\n    def g(self):\n        return self.size\n"
    )
    assert parts[1].readers(source, 2) == {7}
    assert parts[1].readers(source, 11) == {14}
    assert parts[1].readers(source, 7) == set()
    local = "def f():\n    size = 1\n    return size\n"
    assert parts[1].readers(local, 2) == set()


@pytest.mark.parametrize("budget", [0.0, 60.0])
def test_what_an_import_computes_is_judged_whatever_the_budget(parts, tmp_path, budget):
    """A default or a class belongs to no test: no record of lines names its tests."""
    judge = pytest.importorskip("mutating.seen", reason="coverage is not installed")
    of_imports = judge.OF_IMPORTS
    assert set(of_imports) <= set(judge.test_files())
    assert set(of_imports) <= set(judge.tests_of("dynamics"))

    file = Path("dynamics/arm.py")
    seen = judge.Seen(tmp_path, {file: "x = 1\n"}, budget)
    seen.seconds = {test: {f"{test}::test_all": 4.0} for test in of_imports}
    mutant = parts[0].Mutant(file, 1, "one more", "x = 2\n")
    at_home = seen.job_at_home(mutant)
    assert [chosen.file for chosen in at_home.selections] == list(of_imports)
    assert seen.job_elsewhere(mutant).selections == ()

    in_c = parts[0].Mutant(Path("codegen/kernels/rows.h"), 1, "one more", "")
    files = {chosen.file for chosen in seen.job_at_home(in_c).selections}
    assert not files & set(of_imports)
