"""The parsers of the commands, and the options that they take."""

from __future__ import annotations

from argparse import Action

from alpha5_model.cli.parsing import Parser
from alpha5_model.cli.program import parser_of


def leaves(command: str) -> dict[str, Parser]:
    """Words of a command line -> the parser that takes its options."""
    parser = parser_of(command)
    parsers = [*parser.commands.values()] or [parser]
    return {leaf.prog: leaf for leaf in parsers}


def options(leaf: Parser) -> list[Action]:
    """The options and arguments of a parser, in the order of its help."""
    return leaf._actions
