"""How odd an alignment of a compared arm is: the cost that ranks the possible ones."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.proofs.comparison import measure
from alpha5_model.proofs.comparison.alignment import Alignment
from alpha5_model.proofs.comparison.oddity import Judge, misplacement
from alpha5_model.proofs.comparison.own_arm import own_arm_of

FAR = "1 0 0"


def judged(root: ET.Element) -> tuple[Judge, measure.Alignment]:
    """The judge of a model, and the alignment that was found for it."""
    record = a5.parameters()
    ours = own_arm_of(record)
    other = parse_urdf(ET.tostring(root))
    (chain,) = measure.find_chains(other, record, None)
    arms = measure._reduced(ours, other, other, chain, None)
    tolerances = np.full(8, 1e-6)
    return Judge(ours=ours, theirs=arms.meant, tolerances=tolerances), arms.alignment


@pytest.fixture(scope="module")
def own_alignment() -> measure.Alignment:
    """The alignment of our own arm; finding it takes a second."""
    _, alignment = judged(ET.fromstring(OWN))
    return alignment


@pytest.mark.parametrize(
    ("elsewhere", "oddity"),
    [
        ([], 0.0),
        # One of the three bodies, and one of the four shapes, that can tell.
        (["link[@name='link_4']/inertial/origin"], 4 / 3),
        (["link[@name='link_4']/collision/origin"], 4 / 4),
        (["joint[@name='tcp_fixed']/origin"], 6.0),
        (
            [
                "link[@name='link_3']/inertial/origin",
                "link[@name='link_4']/collision/origin",
                "joint[@name='tcp_fixed']/origin",
            ],
            4 / 3 + 4 / 4 + 6.0,
        ),
    ],
)
def test_what_lies_elsewhere_is_odd(
    own_alignment: measure.Alignment, elsewhere: list[str], oddity: float
) -> None:
    root = ET.fromstring(OWN)
    for place in elsewhere:
        found = root.findall(place)
        assert found
        for origin in found:
            origin.set("xyz", FAR)
    judge, _ = judged(root)
    assert judge.oddity(own_alignment) == pytest.approx(oddity, abs=1e-6)


@pytest.mark.parametrize(
    ("off", "expected"),
    [
        ([], 0.0),
        ([0.0], 0.0),
        ([0.025], 0.5),
        ([0.05], 1.0),
        ([3.0], 1.0),
        ([0.0, 0.01, 3.0], (0.0 + 0.2 + 1.0) / 3),
    ],
)
def test_a_body_off_by_50_mm_or_more_is_elsewhere(
    off: list[float], expected: float
) -> None:
    direction = np.array([2.0, -1.0, 2.0]) / 3.0
    points = np.multiply.outer(np.array(off), direction)
    assert misplacement(points) == pytest.approx(expected)


def test_each_reversed_joint_and_each_shifted_zero_is_one_oddity() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        reversed_joints = rng.random(4) < 0.5
        shifted = rng.random(4) < 0.5
        alignment = Alignment(
            sign=np.where(reversed_joints, -1.0, 1.0),
            zero=np.where(shifted, rng.choice([-0.01, 0.5, 3.1], 4), 1e-9),
        )
        assert alignment.oddities == np.count_nonzero([reversed_joints, shifted])
