"""Each number that the page prints is Python's, in water, air, currents and loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import page_digits
import pytest
from browser import needs_browser

pytestmark = needs_browser


@pytest.mark.parametrize("name", ["mount", "current", "recording", "own"])
def test_printed_digits_are_pythons(chromium: Any, name: str, tmp_path: Path) -> None:
    one = page_digits.case(name)
    tab = page_digits.opened(chromium, one, tmp_path)
    q = page_digits.poses(one, 5, seed=page_digits.PAGES.index(name))
    count, wrong = page_digits.differences(tab, one, q)
    assert wrong == []
    assert count == 35
    assert tab.complaints == []
    tab.page.close()


def test_another_density_is_seen(chromium: Any, tmp_path: Path) -> None:
    """Negative control: 1 kg/m^3 more changes digits."""
    one = page_digits.case("payload")
    tab = page_digits.opened(chromium, one, tmp_path)
    tab.run("() => alpha5.change({ density: 1026 })")
    _, wrong = page_digits.differences(tab, one, page_digits.poses(one, 2, seed=1))
    assert len(wrong) > 3
    tab.page.close()
