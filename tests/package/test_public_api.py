"""Every public name with its parameters, and the command line: `public_api.txt`.

After a change that you meant, run this file as a script: it rewrites the list.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

TESTS = Path(__file__).resolve().parents[1]
LIST = TESTS / "public_api.txt"


def command_line() -> Iterator[str]:
    import typer.main

    from alpha5_model.cli import COMMANDS, application

    commands: Any = typer.main.get_command(application(*COMMANDS))
    for name, command in commands.commands.items():
        yield f"alpha5 {name}"
        for parameter in command.params:
            yield from (f"alpha5 {name} {option}" for option in parameter.opts)


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
