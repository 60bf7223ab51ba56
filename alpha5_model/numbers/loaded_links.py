"""The links with the bodies that are attached to them, and with moved jaws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody, joined

_NUMBERS = ("mass", "com", "inertia", "volume", "cob")


def with_merged_bodies(arm: Alpha5Parameters) -> Alpha5Parameters:
    """The same arm as one without attached bodies: they are part of their links.

    Where a spacer moved the tool, it is the arm's own tool.
    """
    if not arm.attached:
        return arm
    links = []
    for link, loaded in zip(arm.links, loaded_links(arm), strict=True):
        numbers = {name: getattr(loaded, name) for name in _NUMBERS}
        low, high = link.bounds.T
        bounds = [np.minimum(low, loaded.com), np.maximum(high, loaded.com)]
        links.append(replace(link, **numbers, bounds=np.transpose(bounds)))
    return replace(arm, links=tuple(links), attached=())


def loaded_links(parameters: Alpha5Parameters) -> tuple[RigidBody, ...]:
    """``link_0`` to ``link_4`` with what is attached to them, jaws closed.

    A spacer moves the jaws, and so their part of link_4, along -z of link_4.

    Args:
        parameters: The arm's parameters.

    Returns:
        Five bodies in the frames of their links. A link without anything attached is
        ``parameters.links[i]`` itself.
    """
    links: list[RigidBody] = []
    for link in parameters.links:
        attached = [body for body in parameters.attached if body.link == link.name]
        parts: Sequence[RigidBody] = [link]
        if parameters.spacer and link is parameters.links[4]:
            parts = split_link_4(parameters).closed
        elif attached:
            parts = [link, *(body.in_link() for body in attached)]
        links.append(link if parts == [link] else joined(link.name, parts))
    return tuple(links)
