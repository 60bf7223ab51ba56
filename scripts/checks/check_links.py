"""Find dead links inside a folder of HTML pages: a file, or a place in it, is missing.

    python scripts/checks/check_links.py build/docs

Exit status 1 if one leads nowhere.
"""

from __future__ import annotations

import re
import sys
from functools import cache
from pathlib import Path
from urllib.parse import unquote

OUTSIDE = re.compile(r"[a-z]+:")


@cache
def places(page: Path) -> frozenset[str]:
    """Anchors of a page."""
    return frozenset(re.findall(r'\bid="([^"]+)"', page.read_text("utf-8")))


def dead_links(folder: Path) -> tuple[int, list[str]]:
    """Number of links inside the folder, and those that lead nowhere."""
    count, dead = 0, []
    for page in sorted(folder.rglob("*.html")):
        for link in re.findall(r'(?:href|src)="([^"]+)"', page.read_text("utf-8")):
            if OUTSIDE.match(link):
                continue
            count += 1
            path, _, place = link.partition("#")
            target = (
                (page.parent / unquote(path.partition("?")[0])).resolve()
                if path
                else page
            )
            there = target.exists()
            if there and place and target.suffix == ".html":
                there = unquote(place) in places(target)
            if not there:
                dead.append(f"{page.relative_to(folder)}: {link}")
    return count, dead


def main(folder: Path) -> int:
    """Print what is dead; returns the exit status."""
    count, dead = dead_links(folder)
    print("\n".join([*dead, f"{count} links, {len(dead)} lead nowhere"]))
    return 1 if dead or not count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
