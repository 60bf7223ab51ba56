"""Find what is wrong with a URDF of this arm, which has three common mistakes.

python examples/compare_a_model.py
"""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

import alpha5_model as a5


def with_mistakes() -> ET.ElementTree:
    """Our URDF with the mistakes that public models of this arm have."""
    tree = ET.parse(a5.URDF_PATH)
    links = {link.get("name"): link for link in tree.getroot().iter("link")}
    # The products of inertia have the signs of the document's table.
    inertia = links["link_2"].find("inertial/inertia")
    for product in ("ixy", "ixz", "iyz"):
        inertia.set(product, str(-float(inertia.get(product))))

    # The centre of mass is read from a mirrored drawing.
    origin = links["link_3"].find("inertial/origin")
    x, y, z = map(float, origin.get("xyz").split())
    origin.set("xyz", f"{x} {-y} {z}")

    # The jaws are left out.
    links["link_4"].find("inertial/mass").set("value", "0.255")
    return tree


def main() -> None:
    """Print what compare finds, the costliest first, and what to write instead."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "somebody_elses.urdf"
        with_mistakes().write(path)
        comparison = a5.compare(path)
    print(comparison.verdict)
    for finding in comparison.findings:
        print(f"\n{finding.where}: {finding.text}")
        if finding.instead:
            print(f"  gravity torque off by up to {finding.cost:.2f} N m; ", end="")
            print(f"write {finding.instead}")


if __name__ == "__main__":
    main()
