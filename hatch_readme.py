"""Make the text that a package index shows: README.md without the repository.

There is no address at which an index could find the repository's pictures and pages.
So pictures are left out, and of links to files the texts stay.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

try:
    from hatchling.metadata.plugin.interface import MetadataHookInterface
except ModuleNotFoundError:  # for the tests, where nothing is built
    MetadataHookInterface = object  # type: ignore[misc, assignment]

README = Path(__file__).resolve().parent / "README.md"

#: A block of code, which is left as it is.
CODE = re.compile(r"(^```.*?^```\n)", re.DOTALL | re.MULTILINE)
#: A picture or a link whose address is neither absolute nor in the page.
PICTURE = re.compile(r"!\[[^\]]*\]\((?![a-z]+:)[^)]*\)\n*")
LINK = re.compile(r"\[([^\]]*)\]\((?![a-z]+:|#)[^)]*\)")


def packaged_readme(text: str) -> str:
    """A page without pictures from files and without links to files."""
    parts = CODE.split(text)
    parts[::2] = [LINK.sub(r"\1", PICTURE.sub("", part)) for part in parts[::2]]
    return "".join(parts)


class ReadmeHook(MetadataHookInterface):
    """Hands the page to the builder."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set the readme, which ``pyproject.toml`` declares dynamic."""
        text = packaged_readme(README.read_text(encoding="utf-8"))
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
