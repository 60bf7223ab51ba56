"""Generated text of the pages: errata from the audit, commands from their help.

    python docs/_extensions/generated_text.py

The line ``<!-- generated: NAME -->`` in a page marks the place of a text of `TEXTS`. If
a line ``<!-- end -->`` follows, the page itself holds the text between the two, for
readers of the source; running this file brings it up to date.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any
from unittest.mock import patch

from errata_tables import FIRST, corrections, first_errata, other_errata
from markdown_tables import table

import alpha5_model as a5
from alpha5_model.cli import COMMANDS
from alpha5_model.cli.program import parser_of

PAGES = Path(__file__).resolve().parents[1]
MARK = re.compile(
    r"^<!-- generated: (\w+) -->\n(?:\n((?:(?!<!--).*\n)*)<!-- end -->\n)?",
    re.MULTILINE,
)
#: Effects of a printed digit that are not shown [N m].
LEAST_EFFECT = 5e-6


# ---- what the digits leave open

#: Poses of the table of torques; names of `alpha5_model.named_pose`.
SHOWN_POSES = ("reach", "home", "stow")


def torque_intervals() -> str:
    """Torques at rest in sea water, their intervals, and which digits matter."""
    u, still, lines = a5.uncertainty, [0.0] * 4, []
    for name in SHOWN_POSES:
        q = a5.named_pose(name)
        found = u.sensitivity(lambda p, q=q: u.arm(p).hydrostatic_torque(q))
        lower, upper = u.bounds(q, still, still).torque
        for k, joint in enumerate(a5.load().joint_names):
            most = [(of, x) for of, x in found.most(k) if abs(x) >= LEAST_EFFECT]
            digits = ", ".join(f"`{of}` {1e3 * abs(x):.2f}" for of, x in most)
            torque = f"{1e3 * found.nominal[k]:z.2f}"
            half = f"{5e2 * (upper[k] - lower[k]):z.2f}"
            lines.append(
                [
                    f"`{name}`",
                    joint,
                    torque,
                    half,
                    digits or "none",
                ]
            )
    head = [
        "pose",
        "joint",
        "torque [mN·m]",
        "± [mN·m]",
        "digits that matter most [± mN·m]",
    ]
    return table(head, lines)


# ---- the command line

#: Command -> the words of an answer that is kept in ``tests/printed``.
ANSWERS = {
    "arm": "arm show my_arm.toml",
    "check": "check",
    "compare": "compare other.urdf --samples 5",
    "demo": "demo",
    "dh": "dh 0.5 1.2 1 0",
    "fk": "fk 180 70 100 0 deg",
    "generate": "generate urdf --gripper jaws --output made/arm.urdf",
    "ik": "ik 0.25 -0.1 0.05 --wrist 90deg",
    "move": "move home 0.2 0.1 0.1 --output planned.csv",
    "planar": "planar 5 4 1 --radius 3",
    "sweep": "sweep study.toml --output results",
    "torque": "torque --q 3.1 1.2 1.8 0",
    "trajectory": "trajectory motion.csv",
    "workspace": "workspace",
}
#: Command -> the name of that answer, if it is not the command's.
ANSWER_NAMES = {"arm": "arm-show"}
#: Lines of an answer that the page shows.
MOST_LINES = 40


def answer_file(name: str) -> Path:
    """Where the answer of a command is kept."""
    file = f"{ANSWER_NAMES.get(name, name)}.txt"
    return PAGES.parent / "tests" / "printed" / file


def answer(name: str) -> list[str]:
    """Markdown of what a command prints; empty if no answer is kept."""
    if name not in ANSWERS:
        return []
    lines = answer_file(name).read_text("utf-8").splitlines()
    if len(lines) > MOST_LINES:
        lines = [*lines[:MOST_LINES], "..."]
    told = f"`alpha5 {ANSWERS[name]}` prints:"
    return [told, "", "```text", *lines, "```", ""]


def commands() -> str:
    """A section for each command: its help, its arguments and its options."""
    return "\n".join(command_section(name) for name in COMMANDS)


def command_section(name: str) -> str:
    """One command: an answer that it gives, and its help."""
    parser = parser_of(name)
    # Helps are as wide as the page, whatever terminal builds it.
    with patch.dict(os.environ, COLUMNS="100"):
        helps = [parser.format_help()]
        helps += [command.format_help() for command in parser.commands.values()]
    return "\n".join(
        [
            f"(alpha5-{name})=",
            f"## alpha5 {name}",
            "",
            *answer(name),
            *(f"```text\n{text.rstrip()}\n```\n" for text in helps),
        ]
    )


TEXTS: dict[str, Callable[[], str]] = {
    **{name: partial(first_errata, name) for name in FIRST},
    "errors": partial(other_errata, "error"),
    "readings": partial(other_errata, "reading"),
    "transcription": partial(other_errata, "transcription"),
    "observations": partial(other_errata, "observation"),
    "outside": partial(other_errata, "outside"),
    "corrections": corrections,
    "commands": commands,
    "torque_intervals": torque_intervals,
}


def written(text: str) -> str:
    """A page's source with its generated parts; marks stay where an end is marked."""

    def part(found: re.Match[str]) -> str:
        made = TEXTS[found[1]]()
        kept = f"<!-- generated: {found[1]} -->\n\n{made}\n<!-- end -->\n"
        return made if found[2] is None else kept

    return MARK.sub(part, text)


def update(page: Path) -> bool:
    """Write a page that holds its generated text anew; whether that changed it."""
    text = page.read_text("utf-8")
    if "<!-- end -->" not in text or written(text) == text:
        return False
    page.write_text(written(text), "utf-8")
    return True


def setup(app: Any) -> dict[str, Any]:
    """Sphinx's entry point."""

    def read(_app: Any, _name: str, source: list[str]) -> None:
        source[0] = written(source[0])

    app.connect("source-read", read)
    return {"parallel_read_safe": True, "version": a5.__version__}


if __name__ == "__main__":
    for changed in filter(update, sorted(PAGES.rglob("*.md"))):
        print(f"wrote {changed}")
