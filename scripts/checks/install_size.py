"""How many packages an environment has, and how large they are.

    python scripts/checks/install_size.py PYTHON [--page README.md]

PYTHON is the interpreter of the environment. With --page, exit status 1 if the figures
that the page names ("54 packages, 759 MB") are off by more than a tenth.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

#: pip and setuptools are of the environment, not of what is installed into it.
_LIST = """
import json, sysconfig
from importlib.metadata import distributions
names = {one.name.lower() for one in distributions()} - {"pip", "setuptools"}
print(json.dumps([sorted(names), sysconfig.get_path("purelib")]))
"""
_OWN = ("pip", "setuptools", "pkg_resources", "_distutils_hack")
FIGURES = re.compile(r"(\d+) packages, (\d+) MB")
#: How far the figures of a page may be off: versions change their sizes.
TOLERANCE = 0.1


def measure(python: str) -> tuple[int, float]:
    """Number of packages and their size [MB] in the environment of an interpreter."""
    printed = subprocess.run(
        [python, "-I", "-c", _LIST], capture_output=True, text=True, check=True
    ).stdout
    names, folder = json.loads(printed)
    size = 0
    for path in Path(folder).rglob("*"):
        part = path.relative_to(folder).parts[0]
        if not part.startswith(_OWN) and path.is_file() and not path.is_symlink():
            size += path.stat().st_size
    return len(names), size / 1e6


def off(text: str, packages: int, megabytes: float) -> list[str]:
    """The figures of a page that are off, in words."""
    figures = FIGURES.findall(text)
    if not figures:
        return ["the page names no figures"]
    wrong = []
    for written_packages, written_size in figures:
        pairs = ((written_packages, packages), (written_size, megabytes))
        if any(abs(int(said) - true) > TOLERANCE * true for said, true in pairs):
            wrong.append(f"{written_packages} packages, {written_size} MB")
    return wrong


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the figures; returns the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("python", help="interpreter of the environment")
    parser.add_argument("--page", type=Path, help="page whose figures are compared")
    chosen = parser.parse_args(arguments)
    packages, megabytes = measure(chosen.python)
    print(f"{packages} packages, {megabytes:.0f} MB")
    wrong = []
    if chosen.page:
        wrong = off(chosen.page.read_text(encoding="utf-8"), packages, megabytes)
    for figure in wrong:
        print(f"{chosen.page}: {figure}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
