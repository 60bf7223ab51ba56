"""Parts of the tables: shapes smaller and larger than a link's, and their cells."""

from __future__ import annotations

import numpy as np
import pytest

from alpha5_model._support.spatial import pose
from alpha5_model.collision.bodies import Body, collision_bodies
from alpha5_model.collision.cells import (
    FREE,
    HIT,
    PLANS,
    UNDECIDED,
    Cells,
    _cylinders_about_axis,
    _cylinders_around,
    _shrunk,
)
from alpha5_model.collision.cells_file import committed_cells
from alpha5_model.collision.spheres import signed_distances, surface_places
from alpha5_model.geometry.primitives import Primitive
from alpha5_model.numbers.parameters import parameters

BOX = Primitive("box", (0.04, 0.02, 0.06), (0.01, -0.02, 0.03), (0.3, -0.2, 0.5))
CYLINDER = Primitive("cylinder", (0.02, 0.05), (0.0, 0.01, -0.02), (0.4, 0.1, 0.0))
ON_AXIS = Primitive("cylinder", (0.02, 0.05), (0.0, 0.0, -0.02), (0.0, 0.0, 1.0))


def body(*shapes: Primitive) -> Body:
    return Body(name="link_4", parent=3, placement=np.eye(4), shapes=shapes)


@pytest.mark.parametrize("shape", [BOX, CYLINDER], ids=lambda shape: shape.kind)
def test_a_shape_is_smaller_by_the_same_on_all_sides(shape: Primitive) -> None:
    by = 0.004
    (core,) = _shrunk(shape, by)
    assert (core.kind, core.xyz, core.rpy) == (shape.kind, shape.xyz, shape.rpy)
    depth = -signed_distances(shape, surface_places(core))
    assert depth.min() == pytest.approx(by, abs=1e-12)
    # From each face, not only from the nearest one.
    thinner = np.subtract(shape.size, core.size)
    expected = [by, 2 * by] if shape.kind == "cylinder" else [2 * by] * 3
    assert thinner == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize(
    ("shape", "half"), [(BOX, 0.01), (CYLINDER, 0.02)], ids=["box", "cylinder"]
)
def test_a_shape_that_is_too_thin_has_no_core(shape: Primitive, half: float) -> None:
    assert len(_shrunk(shape, 0.99 * half)) == 1
    assert _shrunk(shape, half) == []
    assert _shrunk(shape, 1.5 * half) == []


def test_cylinders_about_the_axis_enclose_each_shape_at_every_angle() -> None:
    shapes = (BOX, CYLINDER, ON_AXIS)
    around = _cylinders_around(body(*shapes))
    for shape, cylinder in zip(shapes, around, strict=True):
        assert cylinder.kind == "cylinder"
        assert cylinder.xyz[:2] == (0.0, 0.0)
        assert not any(cylinder.rpy)
        places = surface_places(shape)
        for angle in (0.0, 1.0, 2.5, 4.0):
            turn = pose((0.0, 0.0, 0.0), (0.0, 0.0, angle))[:3, :3]
            outside = signed_distances(cylinder, places @ turn.T)
            assert outside.max() < 1e-12
        # And no more than that, but for the polygon that encloses a circle.
        radius, length = cylinder.size
        reach = np.hypot(places[:, 0], places[:, 1]).max()
        assert radius == pytest.approx(reach, rel=0.02)
        assert length == pytest.approx(np.ptp(places[:, 2]), rel=0.02)
    radius, length = around[2].size
    assert length == pytest.approx(0.05)


def test_only_cylinders_about_the_axis_are_the_same_at_every_angle() -> None:
    aside = Primitive("cylinder", (0.02, 0.05), (0.0, 1e-6, 0.0))
    rolled = Primitive("cylinder", (0.02, 0.05), (0.0, 0.0, 0.0), (1e-3, 0.0, 0.0))
    pitched = Primitive("cylinder", (0.02, 0.05), (0.0, 0.0, 0.0), (0.0, 1e-3, 0.0))
    block = Primitive("box", (0.02, 0.02, 0.05), (0.0, 0.0, 0.0))
    link = body(aside, rolled, pitched, block, ON_AXIS)
    assert _cylinders_about_axis(link) == (ON_AXIS,)


def test_the_ends_of_a_range_are_in_its_outermost_cells() -> None:
    codes = np.array([[FREE, HIT, FREE], [HIT, FREE, UNDECIDED]], np.uint8)
    table = Cells(
        pairs=((0, 2),),
        joint=1,
        lower=np.array([-1.0, 2.0]),
        upper=np.array([1.0, 5.0]),
        codes=codes,
    )
    assert table.per_radian.tolist() == [1.0, 1.0]
    rows = {
        (-1.0, 2.0): FREE,
        (1.0, 2.0): HIT,
        (-1.0, 5.0): FREE,
        (1.0, 5.0): UNDECIDED,
        (-0.1, 3.5): HIT,
        (0.1, 3.5): FREE,
        (-1.0 - 1e-9, 2.0): UNDECIDED,
        (1.0 + 1e-9, 3.5): UNDECIDED,
        (0.1, 5.0 + 1e-9): UNDECIDED,
    }
    q = np.array([[9.0, one, two, 9.0] for one, two in rows])
    assert table.look_up(q).tolist() == list(rows.values())


def test_the_committed_tables_have_the_cells_of_the_plans() -> None:
    tables = committed_cells(collision_bodies(parameters()))
    made = [(table.pairs, table.joint, table.codes.shape) for table in tables]
    assert made == [tuple(plan) for plan in PLANS]
