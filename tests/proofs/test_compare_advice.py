"""The advice of a finding mends the file: one fault each, and none of another link."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest
from compared_models import advised, compared, ids
from urdf_edits import OWN


def inertial(root: ET.Element, link: str, tag: str) -> ET.Element:
    return root.find(f"link[@name='{link}']/inertial/{tag}")


# --- bodies that move and have no mass or inertia


@pytest.mark.parametrize("mass", ["-0.3", "0"])
def test_a_mass_that_no_body_has_is_said_once_and_mended(mass: str) -> None:
    root = ET.fromstring(OWN)
    inertial(root, "link_2", "mass").set("value", mass)
    comparison = compared(root)
    (serious,) = [one for one in comparison.findings if one.serious]
    assert serious.where == "link_2"
    again = compared(advised(root, comparison))
    assert again.agrees, again.findings
    assert again.gravity_error.max() < 1e-9


def test_a_moment_of_zero_is_said_without_a_second_reason() -> None:
    root = ET.fromstring(OWN)
    inertial(root, "link_3", "inertia").set("izz", "0")
    comparison = compared(root)
    assert not {"lint.no_inertia", "lint.zero_moment"} & set(ids(comparison))
    assert compared(advised(root, comparison)).agrees


def test_many_links_without_a_body_are_one_finding() -> None:
    root = ET.fromstring(OWN)
    parent = "base_link"
    for k in range(60):
        ET.SubElement(root, "link", name=f"x{k}")
        joint = ET.SubElement(root, "joint", name=f"turn{k}", type="continuous")
        ET.SubElement(joint, "parent", link=parent)
        ET.SubElement(joint, "child", link=f"x{k}")
        parent = f"x{k}"
    comparison = compared(root)
    (bare,) = [one for one in comparison.findings if one.id == "lint.no_inertia"]
    assert "59 other" in bare.text
    assert len(bare.corrections) == 60
    assert len(bare.instead) < 400
    assert all("x9" not in one.text for one in comparison.findings)
    assert "lint.no_inertia" not in ids(compared(advised(root, comparison)))
