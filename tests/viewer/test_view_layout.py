"""No two texts of the page overlap and none is cut off.

A few windows and states; scripts/checks/page_acceptance.py looks at all of them.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import page_layout
import pytest
from browser import needs_browser

pytestmark = needs_browser


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return page_layout.write_page(tmp_path_factory.mktemp("layout"))


@pytest.mark.parametrize(
    ("width", "scheme", "states"),
    [
        (390, "dark", ("forces", "solutions", "collision")),
        (390, "light", ("all sections open", "tilted, limited")),
        (820, "light", ("forces", "out of reach", "in the motion")),
        (1440, "dark", ("all sections open", "beyond the limits")),
    ],
)
def test_texts_keep_apart(
    chromium: Any, page: Path, width: int, scheme: str, states: tuple[str, ...]
) -> None:
    tab = page_layout.open_page(chromium, page, width, scheme)
    for state in states:
        for unfolded in (False, True) if width < 760 else (False,):
            assert page_layout.faults(tab, state, unfolded) == [], (state, unfolded)
    said = tab.run("() => document.getElementById('message').innerText")
    assert bool(said) == (states[-1] in ("collision", "beyond the limits"))
    assert tab.complaints == []
    tab.page.close()


def test_faults_are_seen(chromium: Any, page: Path) -> None:
    """Negative control: a heading that is cut, and one that is over another text."""
    tab = page_layout.open_page(chromium, page, 1024, "light")
    assert page_layout.faults(tab, "as opened") == []
    style = "() => { document.querySelector('h1').style.cssText = %r; }"
    tab.run(style % "width: 20px; overflow: hidden; white-space: nowrap")
    assert ["cut", "Reach Alpha 5"] in page_layout.faults(tab, "as opened")
    tab.run(style % "position: relative; top: 40px; left: 240px")
    kinds = {fault[0] for fault in page_layout.faults(tab, "as opened")}
    assert "over" in kinds
    tab.page.close()
