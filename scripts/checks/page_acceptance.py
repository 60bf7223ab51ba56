"""Look at the page in every window and state, and compare its digits with Python's.

    python scripts/checks/page_acceptance.py [layout] [digits]

``layout``: five widths, light and dark, ten states each: texts that overlap or are cut
off. ``digits``: 40 random poses on each of eight pages. Both without arguments. The
exit status is 1 if anything is found. It needs Chromium and Playwright and takes
minutes.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.append(str(Path(__file__).resolve().parents[2] / "tests" / "support"))

import page_digits
import page_layout
from browser import browser

POSES = 40


def layout(chromium: Any, folder: Path) -> Iterator[str]:
    """Faults, one in a line."""
    page = page_layout.write_page(folder)
    count = 0
    for width in page_layout.WIDTHS:
        for scheme in page_layout.SCHEMES:
            tab = page_layout.open_page(chromium, page, width, scheme)
            for state in page_layout.STATES:
                for unfolded in (False, True) if width < 760 else (False,):
                    count += 1
                    for fault in page_layout.faults(tab, state, unfolded):
                        yield f"{width} px, {scheme}, {state}: {fault}"
            yield from tab.complaints
            tab.page.close()
    print(f"layout: {count} states looked at")


def digits(chromium: Any, folder: Path) -> Iterator[str]:
    """Texts that differ, one in a line."""
    total = 0
    for name in page_digits.PAGES:
        one = page_digits.case(name)
        tab = page_digits.opened(chromium, one, folder)
        q = page_digits.poses(one, POSES, seed=40 + page_digits.PAGES.index(name))
        count, wrong = page_digits.differences(tab, one, q)
        total += count
        for text in wrong:
            yield f"{name}: {text}"
        yield from tab.complaints
        tab.page.close()
    print(f"digits: {total} texts compared")


def main() -> int:
    parts = {"layout": layout, "digits": digits}
    wanted = sys.argv[1:] or [*parts]
    unknown = sorted(set(wanted) - set(parts))
    if unknown:
        print(f"unknown: {', '.join(unknown)}; known: {', '.join(parts)}")
        return 2

    found = []
    with browser() as chromium, tempfile.TemporaryDirectory() as folder:
        for name in wanted:
            found += list(parts[name](chromium, Path(folder)))
    for line in found:
        print(line)
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
