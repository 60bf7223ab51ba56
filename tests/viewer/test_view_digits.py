"""Each number that the page prints is Python's, in water, air, currents and loads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import page_digits
import pytest
from browser import needs_browser

pytestmark = needs_browser


@pytest.mark.parametrize("name", page_digits.PAGES)
def test_printed_digits_are_pythons(chromium: Any, name: str, tmp_path: Path) -> None:
    one = page_digits.case(name)
    tab = page_digits.opened(chromium, one, tmp_path)
    q = page_digits.poses(one, 5, seed=page_digits.PAGES.index(name))
    count, wrong = page_digits.differences(tab, one, q)
    assert wrong == []
    assert count == 35
    assert tab.complaints == []
    tab.page.close()
