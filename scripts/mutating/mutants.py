"""A mutant, the files that can have one, and how a random sample of them is drawn."""

from __future__ import annotations

import difflib
import hashlib
import random
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "alpha5_model"
#: The room of all hand-written C code, wherever it lies.
C_ROOM = "C"
C_ENDINGS = (".c", ".h")
#: Written by `alpha5 generate`, not by hand.
GENERATED = PACKAGE / "codegen" / "kernels" / "generated"
EQUIVALENT = Path(__file__).with_name("equivalent.toml")


@dataclass(frozen=True)
class Mutant:
    """One change of one file.

    Attributes:
        file: Below the package's folder.
        line: Where the change starts, from 1.
        operator: What was changed into what.
        text: The whole file with the change.
    """

    file: Path
    line: int
    operator: str
    text: str

    @property
    def key(self) -> str:
        """Tells mutants apart, between runs too."""
        return hashlib.sha256(f"{self.file}\n{self.text}".encode()).hexdigest()[:16]


#: A place in a file -> the mutants that can be made there, made one by one.
Place = Callable[[random.Random], Iterator[Mutant]]


def sources() -> dict[Path, str]:
    """File below the package's folder -> text, of all that is written by hand."""
    found = {}
    for path in sorted(PACKAGE.rglob("*")):
        if path.suffix in (".py", *C_ENDINGS) and GENERATED not in path.parents:
            found[path.relative_to(PACKAGE)] = path.read_text(encoding="utf-8")
    return found


def is_c(file: Path) -> bool:
    """Whether it is C, a template of C included."""
    return file.suffix in C_ENDINGS


def room(file: Path) -> str:
    """The folder or module of the package that a file belongs to; C is a room."""
    return C_ROOM if is_c(file) else file.parts[0]


def changed_lines(old: str, new: str) -> tuple[list[str], list[str]]:
    """Lines of the old text that the new one has not, and the other way round."""
    difference = list(difflib.ndiff(old.splitlines(), new.splitlines()))
    gone = [line[2:].strip() for line in difference if line.startswith("- ")]
    come = [line[2:].strip() for line in difference if line.startswith("+ ")]
    return gone, come


def equivalents() -> dict[tuple[str, str, str], str]:
    """(File, line, line of the mutant) -> why no test can tell them apart."""
    table = tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))
    return {
        (row["file"], row["line"], row["mutant"]): row["reason"]
        for row in table.get("equivalent", [])
    }


def is_equivalent(mutant: Mutant, old: str) -> bool:
    """Whether the table names it."""
    gone, come = changed_lines(old, mutant.text)
    key = (mutant.file.as_posix(), " ".join(gone), " ".join(come))
    return key in equivalents()


def draw(
    texts: dict[Path, str],
    places: Callable[[Path, str], list[Place]],
    lines: Callable[[Path, str], int],
    count: int,
    seed: int,
) -> list[Mutant]:
    """A sample of mutants: each room has a share in proportion to its lines.

    Args:
        texts: As of `sources`.
        places: Of a file: where mutants can be made.
        lines: Of a file: how many lines of code it has.
        count: How many; fewer if there are no more places. A larger sample of the same
            seed begins with the smaller one.
        seed: Another seed, another sample.
    """
    chance = random.Random(seed)
    size: Counter[str] = Counter()
    waiting: dict[str, list[Place]] = {}
    for file, text in texts.items():
        found = places(file, text)
        if found:
            size[room(file)] += lines(file, text)
            waiting.setdefault(room(file), []).extend(found)
    for found in waiting.values():
        chance.shuffle(found)
    drawn: list[Mutant] = []
    while len(drawn) < count and waiting:
        rooms = sorted(waiting)
        chosen = chance.choices(rooms, [size[name] for name in rooms])[0]
        place = waiting[chosen].pop()
        if not waiting[chosen]:
            del waiting[chosen]
        mutant = next(place(chance), None)
        if mutant is not None:
            drawn.append(mutant)
    return drawn
