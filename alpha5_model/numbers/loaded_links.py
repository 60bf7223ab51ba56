"""The links with the bodies that are attached to them, and with moved jaws."""

from __future__ import annotations

from collections.abc import Sequence

from alpha5_model.numbers.jaws import split_link_4
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.rigid_body import RigidBody, joined


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
