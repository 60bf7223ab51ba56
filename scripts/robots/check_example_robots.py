"""Which links of the robots in example-robot-data are physically impossible?

A finding about public models, not a failure: the same test that this package applies to
its own links (`alpha5_model.numbers.inertia.inconsistencies`), applied to the inertials
that those URDFs print.

    python scripts/robots/check_example_robots.py            # all robots
    python scripts/robots/check_example_robots.py panda ur5  # some
"""

from __future__ import annotations

import argparse
import sys
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from alpha5_model.numbers.inertia import inconsistencies

#: Relative slack for the digits that a URDF rounds away.
TOLERANCE = 1e-6


@dataclass(frozen=True)
class Body:
    """A link with mass, as its URDF prints it.

    Attributes:
        link: Name.
        mass: [kg].
        inertia: At the COM, (3, 3) [kg m^2].
        problems: What makes it impossible; empty if nothing does.
    """

    link: str
    mass: float
    inertia: NDArray[np.float64]
    problems: tuple[str, ...]


def robots() -> list[str]:
    """Names of the robots that are URDF files."""
    from example_robot_data.robots_loader import ROBOTS

    return sorted(name for name, loader in ROBOTS.items() if loader.urdf_filename)


def bodies(robot: str) -> list[Body]:
    """The links of a robot that have an inertial element, massless frames left out."""
    from example_robot_data.robots_loader import ROBOTS, getModelPath

    loader = ROBOTS[robot]
    relative = Path(loader.path) / loader.urdf_subpath / loader.urdf_filename
    root = ElementTree.parse(Path(getModelPath(str(relative))) / relative).getroot()
    found = []
    for link in root.iter("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        mass = float(_attribute(inertial, "mass", "value"))
        xx, xy, xz, yy, yz, zz = (
            float(_attribute(inertial, "inertia", f"i{k}"))
            for k in ("xx", "xy", "xz", "yy", "yz", "zz")
        )
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        if mass == 0 and not tensor.any():
            continue
        # The place of the COM does not matter here: no bounds of the bodies are known.
        problems = inconsistencies(mass, np.zeros(3), tensor, tolerance=TOLERANCE)
        found.append(Body(link.get("name", ""), mass, tensor, problems))
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table."""
    from rich.console import Console
    from rich.table import Table

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "robots", nargs="*", help="names as in example-robot-data; all if none"
    )
    names = parser.parse_args(arguments).robots or robots()
    table = Table("robot", "link", "mass [kg]", "what is impossible")
    impossible: set[str] = set()
    links = wrong = 0
    for name in names:
        for body in bodies(name):
            links += 1
            if body.problems:
                wrong += 1
                impossible.add(name)
                table.add_row(
                    name, body.link, f"{body.mass:g}", "; ".join(body.problems)
                )
    console = Console(width=None if sys.stdout.isatty() else 140)
    console.print(table)
    which = ", ".join(sorted(impossible)) or "none"
    console.print(
        f"{len(names)} robots, {links} links with inertia: {wrong} links of "
        f"{len(impossible)} robots are not physically consistent ({which})"
    )
    return 0


def _attribute(inertial: ElementTree.Element, element: str, name: str) -> str:
    found = inertial.find(element)
    if found is None or name not in found.attrib:
        return "0"
    return found.attrib[name]


if __name__ == "__main__":
    sys.exit(main())
