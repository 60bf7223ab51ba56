"""`compare` of bodies and tools at the edges of its tolerances."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from urdf_edits import OWN

import alpha5_model as a5
from alpha5_model.description.reading import parse_urdf
from alpha5_model.proofs.comparison.alignment import (
    ANGLE_TOLERANCE,
    LENGTH_TOLERANCE,
    Tolerance,
    allowed,
)
from alpha5_model.proofs.comparison.body_findings import (
    COM_TOLERANCE,
    INERTIA_TOLERANCE,
    MASS_TOLERANCE,
    BodyCase,
    _dummies,
    _rounded,
    findings_of_body,
)
from alpha5_model.proofs.comparison.body_replacement import Replacement
from alpha5_model.proofs.comparison.chains import find_chains
from alpha5_model.proofs.comparison.hypotheses import hypotheses_of
from alpha5_model.proofs.comparison.inertials import Inertial
from alpha5_model.proofs.comparison.own_arm import own_arm_of
from alpha5_model.proofs.comparison.records import BodyDifference
from alpha5_model.proofs.comparison.reduction import reduce_robot
from alpha5_model.proofs.comparison.tool_findings import JAWS_FROM, _on_gripper

RECORD = a5.parameters()
ROBOT = parse_urdf(OWN)
#: A hair more.
MORE = 1.0 + 1e-9


def made_up(**parts: Any) -> Any:
    return SimpleNamespace(**parts)


def ids(found: Any) -> list[str]:
    return [one.id for one in found]


# --- bodies


def case(body: int = 2, **changes: Any) -> BodyCase:
    """A body of ours with other numbers, written by one link in our frame."""
    ours = RECORD.links[body]
    difference = BodyDifference(
        name=ours.name,
        links=("limb",),
        mass=ours.mass,
        com=ours.com,
        inertia=ours.inertia,
        ours=ours,
    )
    difference = replace(difference, **changes)
    written = Inertial(
        link="limb",
        mass=difference.mass,
        com=difference.com,
        inertia=difference.inertia,
        pose=np.eye(4),
    )
    return BodyCase(
        body=difference,
        known=hypotheses_of(own_arm_of(RECORD), body),
        written=[written],
        bare=[],
        instead=Replacement(),
        cost=lambda body, mass, moment: 0.0,
    )


@pytest.mark.parametrize("body", range(5))
@pytest.mark.parametrize(("factor", "wrong"), [(0.999, False), (1.001, True)])
def test_a_body_off_by_its_tolerances_is_right(
    factor: float, wrong: bool, body: int
) -> None:
    ours = RECORD.links[body]
    kind = "body.inertia_of_wrist" if body == 4 else "body.inertia"

    def ids_of(**changes: Any) -> list[str]:
        found = ids(findings_of_body(case(body, **changes)))
        return [one for one in found if one != "body.impossible"]

    heavier = ours.mass * (1 - factor * MASS_TOLERANCE)
    assert ids_of(mass=heavier) == ["body.mass"] * wrong
    moved = np.add(ours.com, [0.0, factor * COM_TOLERANCE, 0.0])
    assert ids_of(com=moved) == ["body.com"] * wrong
    slack = 0.003
    moved = np.add(ours.com, [0.0, factor * (COM_TOLERANCE + slack), 0.0])
    assert ids_of(com=moved, slack=slack) == ["body.com"] * wrong
    other = ours.inertia.copy()
    other[2, 2] += factor * INERTIA_TOLERANCE * np.abs(ours.inertia).max()
    assert ids_of(inertia=other) == [kind] * wrong


def test_a_com_at_the_joint_is_not_on_its_wrong_side() -> None:
    for z, kind in ((0.0, "body.com"), (1e-6, "body.com_beyond")):
        com = np.array([0.0, 0.0, z])
        assert kind in ids(findings_of_body(case(4, com=com)))
        assert "body.com" in ids(findings_of_body(case(3, com=com)))


@pytest.mark.parametrize(
    ("mass", "factor", "found"),
    [
        (1e-3, MORE, ["dummy"]),
        (1e-3, 1 / MORE, []),
        (1e-3 * MORE, MORE, ["dummy.heavy"]),
        (0.0, MORE, []),
    ],
)
def test_a_link_with_a_radius_of_gyration_beyond_the_arm_is_a_dummy(
    mass: float, factor: float, found: list[str]
) -> None:
    """The arm is 0.6 m long, stretched out."""
    inertia = max(mass, 1e-3) * 0.36 * factor * np.eye(3)
    link = Inertial("tool", mass, np.zeros(3), inertia, np.eye(4))
    said = list(_dummies("link_4", [link]))
    assert ids(said) == found
    if said:
        assert "tool has" in said[0].text
        assert "a radius of gyration of 0.60 m" in said[0].text


def test_dummies_of_other_masses_or_inertias_are_named_apart() -> None:
    numbers = ((1e-4, 1e-4), (1e-4, 2e-4), (2e-4, 2e-4), (1e-4, 1e-4))
    links = [
        Inertial(f"l{k}", mass, np.zeros(3), inertia * np.eye(3), np.eye(4))
        for k, (mass, inertia) in enumerate(numbers)
    ]
    said = [one.text.split(" kg ")[0] for one in _dummies("link_4", links)]
    assert said == [
        "dummy links l0, l3 have 0.1 g and 0.0001",
        "dummy link l1 has 0.1 g and 0.0002",
        "dummy link l2 has 0.2 g and 0.0002",
    ]


def test_a_com_that_the_mended_joints_move_by_its_tolerance() -> None:
    ours = RECORD.links[2].com
    for factor, found in ((0.999, []), (1.001, ["digits.of_body"])):
        com = np.add(ours, [0.0, 0.0, factor * COM_TOLERANCE])
        said = list(_rounded(case(2), com))
        assert ids(said) == found
        assert all("COM 0.10 mm off" in one.text for one in said)
        assert list(_rounded(case(2, mass=0.0), com)) == []


# --- the tool


@pytest.mark.parametrize(
    ("point", "on"),
    [
        ((0.0, 0.0, -JAWS_FROM), True),
        ((0.0, 0.0, -JAWS_FROM + 1e-9), False),
        ((0.0, 0.0, RECORD.links[4].bounds[2, 0]), True),
        ((0.0, 0.0, RECORD.links[4].bounds[2, 0] - 1e-9), False),
        ((0.0018, 0.0024, -0.18), True),
        ((0.0018, 0.0025, -0.18), False),
        ((-0.0031, 0.0, -0.18), False),
    ],
)
def test_a_tool_is_on_the_gripper_between_its_collar_and_the_finger_tips(
    point: tuple[float, float, float], on: bool
) -> None:
    """It may be 2 mm beside the axis, and 1 mm more by its digits."""
    evidence: Any = made_up(parameters=RECORD, tolerance=Tolerance(0.00101, 0.01))
    assert _on_gripper(evidence, np.array(point)) == on


def test_the_tolerance_of_our_own_arm_is_that_of_nothing_printed() -> None:
    chain = find_chains(ROBOT, RECORD)[0]
    arm = reduce_robot(ROBOT, chain.joints, RECORD)
    # The URDF is written to the last digit of a double.
    assert allowed(RECORD, arm, short_pi=True) == (LENGTH_TOLERANCE, ANGLE_TOLERANCE)
