"""Every public name with its parameters, and the command line: `public_api.txt`.

After a change that you meant, run this file as a script: it rewrites the list.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
LIST = TESTS / "public_api.txt"


def command_line() -> Iterator[str]:
    import command_parsers

    from alpha5_model.cli import COMMANDS

    for name in COMMANDS:
        for command, parser in command_parsers.leaves(name).items():
            yield command
            for option in command_parsers.options(parser):
                yield from (f"{command} {flag}" for flag in option.option_strings)
                yield from [] if option.option_strings else [f"{command} {option.dest}"]


def listed() -> list[str]:
    from public_names import public_names

    return sorted(public_names().lines | set(command_line()))


@pytest.mark.slow
def test_no_public_name_is_lost_or_added_unseen() -> None:
    recorded = LIST.read_text("utf-8").splitlines()
    current = listed()
    assert len(current) > 500
    assert sorted(set(recorded) - set(current)) == []
    assert sorted(set(current) - set(recorded)) == []


if __name__ == "__main__":
    sys.path.insert(0, str(TESTS / "support"))
    LIST.write_text("\n".join(listed()) + "\n", "utf-8")
