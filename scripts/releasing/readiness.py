"""Say what in the checkout is not ready for a release, one line each.

    python scripts/releasing/readiness.py

Exit status 1 if anything is left to do. `release.sh` runs it before it builds.
"""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from releasing.set_version import CITED_DATE, REPOSITORY, VERSIONS, unreleased

#: Ends addresses that reach nobody (RFC 2606).
RESERVED = (".invalid", ".example", ".test", ".localhost")
#: Files that say how to install, and what they say before the first release.
INSTALL_TEXTS = ("README.md", "docs/start.md")
NOT_PUBLISHED = re.compile(r"on no\s+package\s+index")


def obstacles(folder: Path) -> Iterator[str]:
    """What a person has to do before a release is built."""
    yield from maintainer(folder)
    yield from versions(folder)
    yield from changes(folder)
    for name in INSTALL_TEXTS:
        if NOT_PUBLISHED.search((folder / name).read_text("utf-8")):
            yield (
                f'{name}: it says "on no package index"; write how pip installs the '
                "release, since this text is shown on the index"
            )


def maintainer(folder: Path) -> Iterator[str]:
    """Whether somebody reads the maintainer's address."""
    root = ET.parse(folder / "package.xml").getroot()
    for element in root.iter("maintainer"):
        address = element.get("email", "")
        if address.lower().endswith(RESERVED):
            yield f"package.xml: {address} reaches nobody; write a real address"


def versions(folder: Path) -> Iterator[str]:
    """Whether one version stands everywhere."""
    found = {name: found_in(folder / name, place) for name, place in VERSIONS.items()}
    if len(set(found.values())) > 1:
        named = ", ".join(f"{name} has {version}" for name, version in found.items())
        yield f"versions differ: {named}; run scripts/releasing/set_version.py"


def changes(folder: Path) -> Iterator[str]:
    """Whether the changelog has a dated section for the version and nothing newer."""
    text = (folder / "CHANGELOG.md").read_text("utf-8")
    version = found_in(
        folder / "alpha5_model/__init__.py", next(iter(VERSIONS.values()))
    )
    cited = found_in(folder / "CITATION.cff", CITED_DATE)
    if f"## [{version}] - {cited}\n" not in text:
        yield (
            f"CHANGELOG.md: no section [{version}] with the date of CITATION.cff, "
            f"{cited}; run scripts/releasing/set_version.py"
        )
    left = len(re.findall(r"(?m)^- ", unreleased(text)))
    if left:
        yield (
            f"CHANGELOG.md: {left} changes under [Unreleased]; "
            "run scripts/releasing/set_version.py"
        )


def found_in(file: Path, place: str) -> str:
    """What stands at the place of a pattern in a file."""
    found = re.search(place, file.read_text("utf-8"))
    return found[0] if found else "none"


def main() -> int:
    """Print what is left to do."""
    left = list(obstacles(REPOSITORY))
    print("\n".join(left) or "ready for a release")
    return 1 if left else 0


if __name__ == "__main__":
    sys.exit(main())
