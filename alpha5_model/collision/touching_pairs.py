"""The pairs of collision shapes that can ever touch within the joint limits.

All other pairs of links that are not neighbours are proven never to touch
(`alpha5_model.collision.touching_proof`). The file ``touching_pairs.toml`` has the list
for the catalogue's arm, which ``scripts/checks/prove_self_collision.py`` makes.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from alpha5_model._support.checks import choice
from alpha5_model.numbers.jaws import GRIPPERS

TOUCHING_PAIRS_PATH = Path(__file__).with_name("touching_pairs.toml")


class LinkShape(NamedTuple):
    """A collision shape.

    Attributes:
        link: Name of its link.
        number: Its place among the shapes of the link in
            `alpha5_model.geometry.collision_shapes.collision_primitives`.
    """

    link: str
    number: int


class TouchingPair(NamedTuple):
    """Two shapes that can touch.

    Attributes:
        first: The shape nearer to the base.
        second: The other shape.
        angles: Of the joints between both links, where they touch [rad]. The last one
            of a finger is that of its hinge.
    """

    first: LinkShape
    second: LinkShape
    angles: tuple[float, ...]


@cache
def touching_pairs(gripper: str = "locked") -> tuple[TouchingPair, ...]:
    """Every pair of shapes of the catalogue's arm that can ever touch, base to tip.

    Args:
        gripper: ``locked``: closed jaws, which are part of link_4; ``jaws``: at any
            opening.

    Raises:
        UnknownNameError: Another gripper.
    """
    pairs = []
    for first, others in _table(gripper).items():
        if first == "made_for":
            continue
        for second, rows in others.items():
            for one, other, *angles in rows:
                pair = TouchingPair(
                    first=LinkShape(link=first, number=one),
                    second=LinkShape(link=second, number=other),
                    angles=tuple(angles),
                )
                pairs.append(pair)
    return tuple(pairs)


def touching_links(gripper: str = "locked") -> frozenset[tuple[str, str]]:
    """Pairs of links of the catalogue's arm that can ever touch; base to tip in each.

    Raises:
        UnknownNameError: Another gripper.
    """
    return frozenset(
        (pair.first.link, pair.second.link) for pair in touching_pairs(gripper)
    )


def made_for(gripper: str = "locked") -> str:
    """Digest of the shapes, joints and ranges that the list was made for."""
    return str(_table(gripper)["made_for"])


def _table(gripper: str) -> dict[str, Any]:
    """First link -> second link -> rows, and the digest."""
    table: dict[str, Any] = _read()[choice("gripper", gripper, GRIPPERS)]
    return table


@cache
def _read() -> dict[str, Any]:
    return tomllib.loads(TOUCHING_PAIRS_PATH.read_text(encoding="utf-8"))
