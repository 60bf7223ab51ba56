"""Mutants of C: another operator, another comparison, another number, half a condition.

A line of the preprocessor has none, except the text that a ``#define`` stands for.
Nor have comments, texts and the ``$names`` of a template.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from pathlib import Path

from mutating.mutants import Mutant, Place

#: Token -> what may stand there instead. `|| 0 &&` drops the operand that follows.
OPERATORS = {
    "<": ("<=", ">", "=="),
    "<=": ("<", ">", "=="),
    ">": (">=", "<", "=="),
    ">=": (">", "<", "=="),
    "==": ("!=",),
    "!=": ("==",),
    "&&": ("||", "|| 0 &&"),
    "||": ("&&", "|| 0 &&"),
    "+": ("-", "*"),
    "-": ("+",),
    "*": ("+", "/"),
    "/": ("*", "%"),
    "%": ("/", "*"),
    "+=": ("-=", "="),
    "-=": ("+=", "="),
    "&=": ("|=", "="),
    "|=": ("&=", "="),
    "<<": (">>",),
    ">>": ("<<",),
    "^": ("&", "|"),
    "|": ("&", "^"),
    "&": ("|", "^"),
    "++": ("--",),
    "!": ("",),
    "~": ("",),
}
#: After one of these, or an operator, a sign or star has one operand only.
_BEFORE_AN_OPERAND = (
    "",
    "(",
    "[",
    "{",
    ",",
    ";",
    ":",
    "?",
    "=",
    "return",
    "const",
    "sizeof",
)
_TYPES = ("double", "void", "char", "int", "long", "PyObject", "PyArrayObject")
_SKIPPED = re.compile(
    r"""/\*.*?\*/ | //[^\n]* | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*' | \$\w+
    | ^[ \t]*\#[ \t]*define[ \t]+\w+(?:\([^)]*\))?
    | ^[ \t]*\#(?:[^\n\\]|\\.|\\\n)*""",
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)
_TOKEN = re.compile(
    r"""(?P<number>0[xX][0-9a-fA-F.]+(?:[pP][+-]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
        [uUlLfF]*
    | (?P<word>[A-Za-z_]\w*)
    | (?P<sign>->|\+\+|--|<<=|>>=|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[^\w\s])""",
    re.VERBOSE,
)


def places(file: Path, text: str) -> list[Place]:
    """Each token that something else may stand for."""
    return [
        _place(file, text, start, old, choices)
        for start, old, choices in _tokens(text)
        if choices
    ]


def code_lines(text: str) -> int:
    """Lines that hold a token which is neither comment nor preprocessor."""
    return len({text.count("\n", 0, start) for start, _, _ in _tokens(text)})


def _place(
    file: Path, text: str, start: int, old: str, choices: tuple[str, ...]
) -> Place:
    line = text.count("\n", 0, start) + 1

    def mutants(chance: random.Random) -> Iterator[Mutant]:
        for new in chance.sample(choices, len(choices)):
            changed = text[:start] + new + text[start + len(old) :]
            yield Mutant(file, line, f"{old} becomes {new or 'nothing'}", changed)

    return mutants


def _tokens(text: str) -> Iterator[tuple[int, str, tuple[str, ...]]]:
    """(Start, token, what may stand there) of each token."""
    skipped = [match.span() for match in _SKIPPED.finditer(text)]
    before = ""
    at = 0
    for begin, end in [*skipped, (len(text), len(text))]:
        for match in _TOKEN.finditer(text, at, begin):
            token = match.group()
            if match.group("number"):
                choices = _numbers(match.group("number"))
                yield match.start(), match.group("number"), choices
            else:
                yield match.start(), token, _operators(token, before)
            before = token
        at = end


def _operators(token: str, before: str) -> tuple[str, ...]:
    unary = before in _BEFORE_AN_OPERAND or before in OPERATORS or before in _TYPES
    if token in ("*", "&") and (unary or before[:1].isupper()):
        return ()  # a pointer, or the type of one
    if token == "-" and unary:
        return ("",)
    if token in ("+", "<", ">") and unary:
        return ()
    return OPERATORS.get(token, ())


def _numbers(token: str) -> tuple[str, ...]:
    """The neighbours of an integer; another first digit of any other number."""
    if token.isdigit():
        neighbours = (int(token) + 1, int(token) - 1)
        return tuple(str(n) if n >= 0 else "(-1)" for n in neighbours)
    if token.lower().startswith("0x"):
        return ("0x2" + token[3:],) if token[2] == "1" else ()
    digit = re.search("[1-9]", token)
    if digit is None:
        return ("1.0",)
    other = str(int(digit.group()) % 9 + 1)
    return (token[: digit.start()] + other + token[digit.end() :],)
