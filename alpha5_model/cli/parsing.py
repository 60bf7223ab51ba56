"""The parser of a command: argparse, with vectors of several words."""

from __future__ import annotations

import re
from argparse import Action, ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NoReturn

from alpha5_model.cli.quantities import UNITS, Vector
from alpha5_model.errors import Alpha5Error

#: One number or several in one word, each perhaps with its unit: 1, -0.4,0.2, 90deg.
_UNIT = f"(?:{'|'.join(map(re.escape, UNITS))})"
_NUMBER = rf"[-+−]?(?:\d+\.?\d*|\.\d+|inf|nan)(?:e[-+]?\d+)?{_UNIT}?"
_NUMBERS = re.compile(rf"\s*{_NUMBER}(?:[\s,]+{_NUMBER})*[\s,]*", re.IGNORECASE)
_SEPARATED = re.compile(r"[\s,]+")


class UsageError(Alpha5Error):
    """Words that a command does not take."""


class Parser(ArgumentParser):
    """A parser that raises `UsageError`, and takes vectors of several words.

    ``--q 1 2 3 4``, ``--q 1,2,3,4`` and ``--q 57 115 172 229 deg`` are the same, as are
    ``1 2`` and ``1,2`` without an option.
    """

    def __init__(self, **settings: Any) -> None:
        #: Sub-command -> its parser; without any, the parser takes options itself.
        self.commands: dict[str, Parser] = {}
        self._names: set[str] = set()
        self._vectors: dict[str, Vector] = {}
        self._takes_a_word: set[str] = set()
        self._takes_numbers = False
        super().__init__(
            formatter_class=RawDescriptionHelpFormatter, allow_abbrev=False, **settings
        )

    def add_argument(self, *names: Any, **settings: Any) -> Action:
        """As argparse's; one with a `Vector` as its type takes several words."""
        action = super().add_argument(*names, **settings)
        self._names |= {*action.option_strings}
        if isinstance(action.type, Vector):
            self._vectors |= dict.fromkeys(action.option_strings, action.type)
            self._takes_numbers |= not action.option_strings
        elif action.nargs is None:
            self._takes_a_word |= {*action.option_strings}
        return action

    def add_commands(
        self, commands: Mapping[str, tuple[str, Callable[[Parser], None]]]
    ) -> None:
        """Add sub-commands: name -> what it does, and what adds its options."""
        metavar = f"{{{','.join(commands)}}}"
        added = self.add_subparsers(dest="command", metavar=metavar, required=True)
        for name, (summary, options) in commands.items():
            sentence = f"{summary[:1].upper()}{summary[1:]}."
            parser = added.add_parser(name, help=summary, description=sentence)
            options(parser)
            self.commands[name] = parser

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str], namespace: Namespace | None = None
    ) -> tuple[Namespace, list[str]]:
        """As argparse's, of words in which each vector is one word."""
        if self.commands:
            return super().parse_known_args(list(args), namespace)
        given, unknown = super().parse_known_args(self._joined(args), namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(map(str.strip, unknown))}")
        return given, unknown

    def error(self, message: str) -> NoReturn:
        """Raise `UsageError`, where argparse prints and exits."""
        raise UsageError(f"{message} (see {self.prog} --help)")

    def _is_unknown(self, word: str) -> bool:
        """Whether a word is an option that there is not."""
        name = word.partition("=")[0] if word.startswith("--") else word[:2]
        is_option = len(word) > 1 and word.startswith("-")
        return is_option and name not in self._names and not _NUMBERS.fullmatch(word)

    def _joined(self, words: Sequence[str]) -> list[str]:
        """The words, each vector as one of them."""
        left = deque(words)
        joined: list[str] = []
        while left:
            word = left[0]
            if word == "--":
                return [*joined, *left]
            if self._is_unknown(word):
                # Else argparse takes the word after it for an argument.
                self.error(f"unrecognized arguments: {word}")
            if word in self._vectors:
                joined.append(left.popleft())
                # More numbers are arguments, if the command takes any; else too many.
                most = self._vectors[word].most if self._takes_numbers else None
                joined += _numbers(left, most)
            elif word in self._takes_a_word:
                joined += [left.popleft(), *_numbers(left, 1)]
            elif self._takes_numbers and _NUMBERS.fullmatch(word):
                joined += _numbers(left, None)
            else:
                joined += _numbers(left, 1) or [left.popleft()]
        return joined


def _numbers(left: deque[str], most: int | None) -> list[str]:
    """Take numbers from the start of the words, and a unit after them.

    Args:
        left: The words; what is taken is removed.
        most: How many words with numbers to take at most; None for all.

    Returns:
        One word; empty if the words begin with something else.
    """
    taken: list[str] = []
    while left and _NUMBERS.fullmatch(left[0]) and len(taken) != most:
        taken.append(left.popleft())
        if most and len(_SEPARATED.split(taken[0].strip(" ,"))) > 1:
            break
    if taken and left and left[0] in UNITS:
        taken.append(left.popleft())
    # With a space before it, argparse does not take -1e-3 for an option.
    word = " ".join(taken)
    return [f" {word}" if word.startswith("-") else word] if taken else []
