"""Set the version of the package wherever it stands, and date its changes.

    python scripts/releasing/set_version.py 1.0.0
    python scripts/releasing/set_version.py 1.0.0 --date 2027-01-15

It writes `alpha5_model/__init__.py`, `CITATION.cff` and `package.xml`, and turns the
section "Unreleased" of `CHANGELOG.md` into that of the version. Afterwards write the
generated files anew: `alpha5 generate --update`.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from datetime import UTC, date, datetime
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
#: File -> where the version stands in it.
VERSIONS = {
    "alpha5_model/__init__.py": r'(?m)(?<=^__version__ = ")[^"]+(?="$)',
    "CITATION.cff": r"(?m)(?<=^version: )\S+$",
    "package.xml": r"(?<=<version>)[^<]+(?=</version>)",
}
CITED_DATE = r"(?m)(?<=^date-released: )\S+$"
UNRELEASED = "## [Unreleased]\n"


def set_version(folder: Path, version: str, released: date) -> list[str]:
    """Write a version and its date into a checkout.

    Returns:
        The files that were written, relative to the folder.

    Raises:
        ValueError: If the version is not three numbers, if a file does not hold
            exactly one version, or if the changelog already has the version or has
            nothing under "Unreleased". No file is changed then.
    """
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise ValueError(f"expected a version such as 1.0.0, got {version!r}")
    texts = {name: (folder / name).read_text("utf-8") for name in VERSIONS}
    for name, place in VERSIONS.items():
        texts[name] = replaced(texts[name], place, version, name)
    citation = texts["CITATION.cff"]
    texts["CITATION.cff"] = replaced(
        citation, CITED_DATE, released.isoformat(), "CITATION.cff"
    )
    changes = (folder / "CHANGELOG.md").read_text("utf-8")
    texts["CHANGELOG.md"] = dated(changes, version, released)
    for name, text in texts.items():
        (folder / name).write_text(text, "utf-8")
    return list(texts)


def replaced(text: str, place: str, value: str, name: str) -> str:
    """The text of a file with another value at the one place of a pattern."""
    made, places = re.subn(place, value, text)
    if places != 1:
        raise ValueError(f"{name}: expected one place for {value}, found {places}")
    return made


def dated(changes: str, version: str, released: date) -> str:
    """The changelog with its unreleased changes under a version."""
    if f"## [{version}]" in changes:
        raise ValueError(f"CHANGELOG.md has a section [{version}] already")
    if "\n- " not in unreleased(changes):
        raise ValueError("CHANGELOG.md has nothing under [Unreleased]")
    heading = f"{UNRELEASED}\n## [{version}] - {released.isoformat()}\n"
    return changes.replace(UNRELEASED, heading, 1)


def unreleased(changes: str) -> str:
    """What stands under "Unreleased"; empty without that section."""
    after = changes.partition(UNRELEASED)[2]
    return "\n" + re.split(r"(?m)^## \[", after)[0]


def main(arguments: Sequence[str] | None = None) -> int:
    """Set the version of this checkout."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("version", help="such as 1.0.0")
    today = datetime.now(UTC).date()
    parser.add_argument(
        "--date", type=date.fromisoformat, default=today, help="today (UTC) if left out"
    )
    chosen = parser.parse_args(arguments)
    try:
        written = set_version(REPOSITORY, chosen.version, chosen.date)
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    print("\n".join(f"wrote {name}" for name in written))
    print("next: alpha5 generate --update")
    return 0


if __name__ == "__main__":
    sys.exit(main())
