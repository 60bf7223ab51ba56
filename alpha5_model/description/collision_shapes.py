"""Collision primitives (interim: none)."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Primitive:
    kind: str
    size: tuple[float, ...]
    xyz: tuple[float, float, float]
    rpy: tuple[float, float, float]


def collision_primitives() -> dict[str, tuple[Primitive, ...]]:
    return {}
