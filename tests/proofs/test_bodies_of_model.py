"""Bodies of another model as links of a record, and as what is attached to them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.numbers.parameters import LinkParameters
from alpha5_model.proofs.comparison.bodies_of_model import (
    _parted,
    bodies_of_model,
)

pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
LINKS = a5.parameters().links
Body = tuple[float, np.ndarray, np.ndarray]


def about_origin(body: Body) -> np.ndarray:
    """The tensor about the origin, by its integral over masses."""
    mass, com, inertia = body
    x, y, z = com
    square = [
        [y * y + z * z, -x * y, -x * z],
        [-x * y, x * x + z * z, -y * z],
        [-x * z, -y * z, x * x + y * y],
    ]
    return inertia + mass * np.array(square)


def together(*bodies: Body) -> Body:
    mass = sum(body[0] for body in bodies)
    com = sum(body[0] * body[1] for body in bodies) / mass
    whole = sum(about_origin(body) for body in bodies)
    return mass, com, whole - about_origin((mass, com, np.zeros((3, 3))))


def body_of(link: Any) -> Body:
    return link.mass, link.com, link.inertia


@pytest.mark.parametrize("share", [1.0, 0.5, 0.1, 0.01, 0.001])
@pytest.mark.parametrize("link", [LINKS[1], LINKS[4]], ids=lambda link: link.name)
def test_the_largest_share_of_a_link_stays(link: LinkParameters, share: float) -> None:
    """A weight far outside is attached, and the two are the body again."""
    weight = (0.05 * share, np.array([0.3, -0.2, 0.6]), 1e-4 * share * np.eye(3))
    kept = (share * link.mass, link.com, share * link.inertia)
    parted = _parted(link, *together(kept, weight))
    assert parted is not None
    body, rest = parted
    assert body.mass == pytest.approx(kept[0], rel=1e-12)
    assert body.com == pytest.approx(kept[1])
    assert body.inertia == pytest.approx(kept[2], rel=1e-12)
    assert rest.mass == pytest.approx(weight[0], rel=1e-9)
    assert rest.com == pytest.approx(weight[1], rel=1e-9)
    assert rest.inertia == pytest.approx(weight[2], abs=1e-9 * share)
    assert rest.cob == pytest.approx(rest.com)
    assert (rest.name, rest.link) == (f"rest_of_{link.name}", link.name)
    assert (rest.volume, rest.spacer) == (0.0, 0.0)
    assert rest.position.tolist() == [0, 0, 0]
    assert rest.rotation.tolist() == np.eye(3).tolist()
    assert body.volume == link.volume


@pytest.mark.parametrize(("mass", "moment"), [(0.456, 1e-5), (1e-5, 1e-6)])
def test_a_body_that_cannot_be_parted_is_as_printed(mass: float, moment: float) -> None:
    """A compact body leaves no possible rest, and a light one none at all."""
    com = np.array([0.4, 0.0, 0.0])
    assert _parted(LINKS[2], mass, com, moment * np.eye(3)) is None
    left_out: list[str] = []
    masses, coms, inertias = numbers_of_links()
    masses[2], coms[2], inertias[2] = mass, com, moment * np.eye(3)
    links, attached = bodies_of_model(LINKS, masses, coms, inertias, left_out)
    assert links == LINKS
    assert attached == ()
    said = "link_2 has its COM outside the link, and no part in it"
    assert left_out == [f"{said}: the printed one is kept"]


def numbers_of_links() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    masses = np.array([link.mass for link in LINKS])
    coms = np.array([link.com for link in LINKS])
    inertias = np.array([link.inertia for link in LINKS])
    return masses, coms, inertias
