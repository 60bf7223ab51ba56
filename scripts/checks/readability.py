"""Print the words and the readability of each page of the documentation.

    python scripts/checks/readability.py
    python scripts/checks/readability.py --revision v0.1.0

Pages are README, CONTRIBUTING, CHANGELOG and those of `docs/`. Counted are the words of
prose and those of the longest paragraph, list item and sentence; code, tables and
headings are not.

LIX is the readability index of C.-H. Björnsson (Läsbarhet, 1968): words per sentence,
plus the percentage of words of more than six letters. It needs no dictionary of
syllables. Below 40 a text is easy, above 50 it is hard.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from checks.prose import prose, words

REPOSITORY = Path(__file__).resolve().parents[2]
#: A word with more letters is a long one.
LONG = 6
_LETTERS = re.compile(r"[^\W\d_]+(?:['’-][^\W\d_]+)*")
_PAGE = re.compile(r"(?:README|CONTRIBUTING|CHANGELOG|docs/.+)\.md")


@dataclass(frozen=True, kw_only=True)
class Readability:
    """What is counted in a page.

    Attributes:
        words: Of all its prose.
        paragraph: Words of the longest paragraph.
        item: Words of the longest list item.
        sentence: Words of the longest sentence.
        lix: Words per sentence, plus long words per hundred words. 0 without prose.
    """

    words: int
    paragraph: int
    item: int
    sentence: int
    lix: float


def readability(page: str) -> Readability:
    """The figures of a page in Markdown."""
    found = prose(page)
    sentences = [text for text in found.sentences if words(text)]
    return Readability(
        words=sum(map(words, sentences)),
        paragraph=longest(found.paragraphs),
        item=longest(found.items),
        sentence=longest(sentences),
        lix=lix(sentences),
    )


def longest(texts: Sequence[str]) -> int:
    """Words of the longest text."""
    return max(map(words, texts), default=0)


def lix(sentences: Sequence[str]) -> float:
    """Björnsson's readability index of sentences; 0 if there are none."""
    spelled = [word for text in sentences for word in _LETTERS.findall(text)]
    if not spelled:
        return 0.0
    long = sum(letters(word) > LONG for word in spelled)
    return len(spelled) / len(sentences) + 100 * long / len(spelled)


def letters(word: str) -> int:
    """How many letters a word has, without hyphens and apostrophes."""
    return sum(character.isalpha() for character in word)


def pages(folder: Path) -> Iterator[tuple[str, str]]:
    """Name and text of each page of a working tree."""
    for file in sorted(folder.rglob("*.md")):
        name = file.relative_to(folder).as_posix()
        if _PAGE.fullmatch(name):
            yield name, file.read_text("utf-8")


def pages_of_revision(folder: Path, revision: str) -> Iterator[tuple[str, str]]:
    """Name and text of each page as git has it in a revision."""
    listed = git(folder, "ls-tree", "-r", "--name-only", revision)
    for name in sorted(listed.splitlines()):
        if _PAGE.fullmatch(name):
            yield name, git(folder, "show", f"{revision}:{name}")


def git(folder: Path, *arguments: str) -> str:
    """What a command of git prints."""
    ran = subprocess.run(
        ["git", "-C", str(folder), *arguments],
        check=True,
        capture_output=True,
        encoding="utf-8",
    )
    return ran.stdout


def table(named: dict[str, Readability]) -> Iterator[str]:
    """Lines of a table, a page each."""
    width = max(map(len, named), default=0)
    yield f"{'page':{width}}  words  paragraph  item  sentence   LIX"
    for name, figures in named.items():
        yield (
            f"{name:{width}}{figures.words:7}{figures.paragraph:11}{figures.item:6}"
            f"{figures.sentence:10}{figures.lix:6.0f}"
        )


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table of the working tree or of a revision."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--revision", help="count what git has there")
    revision = parser.parse_args(arguments).revision
    try:
        found = dict(
            pages_of_revision(REPOSITORY, revision) if revision else pages(REPOSITORY)
        )
    except subprocess.CalledProcessError as error:
        print(error.stderr.strip(), file=sys.stderr)
        return 1
    counted = {name: readability(text) for name, text in found.items()}
    print("\n".join(table(counted)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
