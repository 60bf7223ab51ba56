"""Mutants of Python: another operator, another number, a condition the other way round.

Left out by rule, since no test can see them: annotations, a cache taken off a function
or of another size, ``strict=True`` of a zip, ``slots=True`` of a record, what only a
type checker reads, and -2 in place of the -1 of a ``reshape``, which NumPy takes alike.
A comparison with a word has one mutant, since words have no order that would mean
anything: ``kind == "box"`` becomes ``kind != "box"``.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Iterator
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

from mutating.mutants import Mutant, Place

ARITHMETIC = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
}
BITS = {
    ast.BitOr: "|",
    ast.BitAnd: "&",
    ast.BitXor: "^",
    ast.LShift: "<<",
    ast.RShift: ">>",
}
COMPARISONS = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
}
EQUALITIES = {ast.Eq: "==", ast.NotEq: "!="}
IDENTITIES = {ast.Is: "is", ast.IsNot: "is not"}
MEMBERSHIPS = {ast.In: "in", ast.NotIn: "not in"}
BOOLEANS = {ast.And: "and", ast.Or: "or"}
#: Operators of which any may stand for any other.
FAMILIES = (ARITHMETIC, BITS, COMPARISONS, IDENTITIES, MEMBERSHIPS, BOOLEANS)
#: The same where an operand is a word.
FAMILIES_OF_WORDS = (EQUALITIES, *FAMILIES)
#: Fields of syntax nodes that no test can see a change of.
_UNSEEN = ("annotation", "returns", "type_params")
#: Arguments by name that no test can see a change of.
_UNSEEN_ARGUMENTS = ("maxsize", "slots", "strict")


class _Text:
    """A source in bytes, in which syntax nodes count their columns."""

    def __init__(self, text: str) -> None:
        self.data = text.encode()
        self.starts = [0]
        for line in self.data.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))

    def start(self, node: ast.AST) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def end(self, node: ast.AST) -> int:
        return self.starts[node.end_lineno - 1] + node.end_col_offset

    def changed(self, start: int, end: int, new: str) -> str:
        return (self.data[:start] + new.encode() + self.data[end:]).decode()


#: Start, end, what stands there instead, and what to call it.
Change = tuple[int, int, str, str]


def places(file: Path, text: str) -> list[Place]:
    """One place for each syntax node, with all changes of it."""
    source = _Text(text)
    tree = ast.parse(text)
    any_lengths = list(_any_lengths(tree))
    found = []
    for node in _visible(tree):
        changes = list(_changes(source, node))
        if changes and node not in any_lengths:
            found.append(_place(file, text, source, changes))
    return found


def code_lines(text: str) -> int:
    """Lines that begin a statement."""
    statements = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.stmt)]
    return len({node.lineno for node in statements})


def statement(text: str, line: int) -> range:
    """Lines of the statement around a line; of a compound statement, its head."""
    spans = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.stmt):
            body = getattr(node, "body", None)
            last = node.end_lineno or node.lineno
            end = body[0].lineno if isinstance(body, list) else last + 1
            spans.append(range(node.lineno, max(end, node.lineno + 1)))
    around = [span for span in spans if line in span]
    return min(around, key=len, default=range(line, line + 1))


def readers(text: str, line: int) -> set[int]:
    """Lines that read what an import gives a name to in the statement around a line.

    A constant of a module or a default of a field is computed by an import, which is
    no test's, or that of the first test that needs it. What reads it is.
    """
    tree = ast.parse(text)
    around = statement(text, line)
    names = set()
    for node in _run_by_import(tree):
        if isinstance(node, (ast.Assign, ast.AnnAssign)) and node.lineno in around:
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            parts = [part for target in targets for part in ast.walk(target)]
            names |= {part.id for part in parts if isinstance(part, ast.Name)}
    return {
        node.lineno
        for node in ast.walk(tree)
        if (isinstance(node, ast.Name) and node.id in names)
        or (isinstance(node, ast.Attribute) and node.attr in names)
    } - set(around)


def _run_by_import(node: ast.AST) -> Iterator[ast.AST]:
    """All nodes that are in no function."""
    yield node
    if not isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)):
        for child in ast.iter_child_nodes(node):
            yield from _run_by_import(child)


def _place(file: Path, text: str, source: _Text, changes: list[Change]) -> Place:
    def mutants(chance: random.Random) -> Iterator[Mutant]:
        meaning = ast.dump(ast.parse(text))
        for start, end, new, name in chance.sample(changes, len(changes)):
            line = source.data.count(b"\n", 0, start) + 1
            with suppress(SyntaxError, UnicodeDecodeError):
                changed = source.changed(start, end, new)
                if ast.dump(ast.parse(changed)) != meaning:
                    yield Mutant(file, line, name, changed)

    return mutants


def _visible(node: ast.AST) -> Iterator[ast.AST]:
    """A node and all below it, in their order, but not what no test can see."""
    yield node
    for name, value in ast.iter_fields(node):
        if name in _UNSEEN or (isinstance(node, ast.If) and _for_types(node)):
            continue
        for child in value if isinstance(value, list) else [value]:
            unseen = isinstance(child, ast.keyword) and child.arg in _UNSEEN_ARGUMENTS
            if isinstance(child, ast.AST) and not unseen:
                yield from _visible(child)


def _any_lengths(tree: ast.AST) -> Iterator[ast.AST]:
    """The 1 of each -1 that a ``reshape`` is given."""
    for call in ast.walk(tree):
        match call:
            case ast.Call(func=ast.Attribute(attr="reshape")):
                for argument in call.args:
                    for part in ast.walk(argument):
                        match part:
                            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant()):
                                yield part.operand


def _for_types(node: ast.If) -> bool:
    return ast.unparse(node.test) == "TYPE_CHECKING"


def _changes(source: _Text, node: ast.AST) -> Iterator[Change]:
    yield from _changes_of_expression(source, node)
    yield from _changes_of_statement(source, node)


def _changes_of_expression(source: _Text, node: ast.AST) -> Iterator[Change]:
    """Changes of an operator or a constant."""
    match node:
        case ast.BinOp():
            yield from _operator(source, node.op, node.left, node.right)
        case ast.BoolOp():
            for left, right in pairwise(node.values):
                yield from _operator(source, node.op, left, right)
        case ast.Compare():
            operands = pairwise([node.left, *node.comparators])
            for op, (left, right) in zip(node.ops, operands, strict=True):
                yield from _operator(source, op, left, right)
        case ast.AugAssign():
            yield from _operator(source, node.op, node.target, node.value)
        case ast.UnaryOp():
            at = source.start(node)
            yield at, source.start(node.operand), " ", "operator dropped"
        case ast.Constant():
            yield from _constant(source, node)


def _changes_of_statement(source: _Text, node: ast.AST) -> Iterator[Change]:
    """Changes of a condition, a loop, a handler or a decorator."""
    match node:
        case ast.If() if _for_types(node):
            return
        case ast.If() | ast.While() | ast.IfExp():
            yield _negated(source, node.test)
        case ast.comprehension():
            yield from (_negated(source, test) for test in node.ifs)
        case ast.For():
            yield source.start(node.iter), source.end(node.iter), "()", "loop dropped"
        case ast.Break() | ast.Continue():
            other = "continue" if isinstance(node, ast.Break) else "break"
            yield source.start(node), source.end(node), other, f"becomes {other}"
        case ast.ExceptHandler(type=ast.expr() as kind):
            yield source.start(kind), source.end(kind), "()", "catches nothing"
        case ast.FunctionDef() | ast.ClassDef():
            yield from _decorators(source, node)


def _decorators(
    source: _Text, node: ast.FunctionDef | ast.ClassDef
) -> Iterator[Change]:
    for decorator in node.decorator_list:
        if "cache" not in ast.unparse(decorator):
            start = source.start(decorator)
            at = source.data.rindex(b"@", 0, start)
            yield at, source.end(decorator), "", "decorator dropped"


def _operator(
    source: _Text, op: ast.AST, left: ast.expr, right: ast.expr
) -> Iterator[Change]:
    of_words = any(_is_word(operand) for operand in (left, right))
    families = FAMILIES_OF_WORDS if of_words else FAMILIES
    family = next((f for f in families if type(op) in f), {})
    old = family.get(type(op))
    if old is None:
        return
    start = source.data.find(old.encode(), source.end(left), source.start(right))
    if start >= 0:
        for new in family.values():
            if new != old:
                yield start, start + len(old), new, f"{old} becomes {new}"


def _is_word(operand: ast.expr) -> bool:
    return isinstance(operand, ast.Constant) and isinstance(operand.value, str)


def _constant(source: _Text, node: ast.Constant) -> Iterator[Change]:
    start = source.start(node)
    end = source.end(node)
    value = node.value
    if isinstance(value, bool):
        yield start, end, str(not value), f"{value} becomes {not value}"
    elif isinstance(value, int | float):
        with suppress(SyntaxError, ValueError, UnicodeDecodeError):
            # Columns are wrong in some texts with fields.
            if ast.literal_eval(source.data[start:end].decode()) == value:
                yield start, end, f"({value + 1})", "one more"
                yield start, end, f"({value - 1})", "one less"


def _negated(source: _Text, test: ast.expr) -> Change:
    start = source.start(test)
    end = source.end(test)
    inner = source.data[start:end].decode("utf-8", "replace")
    return start, end, f"(not ({inner}))", "condition negated"
