"""The masses by which the page "Which model do I have?" tells models apart."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
import shared_recordings as recordings

import alpha5_model as a5
from alpha5_model.numbers.reading import earlier_revision

PAGE = Path(__file__).parents[2] / "docs" / "guides" / "which-model.md"


@pytest.fixture(scope="module")
def masses():
    """Of link 2 [kg], in the order of the page's table."""
    found = re.findall(r"^\| ([\d.]+) kg \|", PAGE.read_text("utf-8"), re.MULTILINE)
    return [float(mass) for mass in found]


def test_the_masses_of_both_revisions(masses):
    now, earlier, _ = masses
    assert now == a5.parameters().links[2].mass
    assert now == max(link.mass for link in a5.parameters().links)
    assert earlier == earlier_revision()[2].mass.si


def test_the_mass_with_water_in_it(masses):
    """A cylinder of water of radius 20 mm and length 160 mm, as that model has it."""
    _, earlier, with_water = masses
    water = 1000.0 * math.pi * 0.02**2 * 0.16
    assert with_water == pytest.approx(earlier + water, abs=5e-4)


@pytest.mark.parametrize(
    ("file", "link", "column"),
    [
        ("evan_palmer_alpha.urdf", "m2_joint_link", 1),
        ("diff_uvms.urdf", "alpha_m2_joint_link", 1),
        ("hkolano_blue_rov.urdf", "r5m_upper_arm_link", 2),
    ],
)
def test_the_masses_are_those_of_public_models(masses, file, link, column):
    path = recordings.RECORDINGS / "models" / file
    if not path.is_file():
        pytest.skip("no public models beside the checkout")
    body = ET.parse(path).getroot().find(f"link[@name='{link}']/inertial/mass")
    assert float(body.get("value")) == masses[column]
