"""The committed tables of self-collision are what the script proves again."""

from __future__ import annotations

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.codegen.kernels.choice import module as kernels
from alpha5_model.collision import cells
from alpha5_model.collision.bodies import collision_bodies, joint_ranges
from alpha5_model.collision.cells import FREE, HIT, UNDECIDED, certified_cells
from alpha5_model.collision.cells_file import cells_text, committed_cells

needs_kernels = pytest.mark.skipif(
    not hasattr(kernels(), "scene"), reason="the kernels are not compiled here"
)


@pytest.mark.slow
@needs_kernels
def test_the_committed_tables_are_made_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slab of those that depend on theta_0, all of the others."""
    from checks import prove_self_collision as module

    arm = a5.parameters()
    bodies = collision_bodies(arm)
    lower, upper = joint_ranges(arm)
    committed = committed_cells(bodies)
    assert [table.codes.shape for table in committed] == [
        plan.counts for plan in cells.PLANS
    ]
    # Of 64 cells along theta_0, one in which all its tables have hits.
    first, last = 1, 2
    width = (upper[0] - lower[0]) / 64
    low = np.concatenate([[lower[0] + first * width], lower[1:]])
    high = np.concatenate([[lower[0] + last * width], upper[1:]])
    slabs = []
    for table in committed:
        each = len(table.codes) // 64
        of_theta_0 = slice(first * each, last * each)
        slabs.append(table.codes[of_theta_0] if table.joint == 0 else table.codes)
    plans = [
        plan._replace(counts=slab.shape)
        for plan, slab in zip(cells.PLANS, slabs, strict=True)
    ]
    monkeypatch.setattr(cells, "PLANS", tuple(plans))

    made = certified_cells(bodies, low, high, module._touches)
    for again, slab, table in zip(made, slabs, committed, strict=True):
        different = again.codes != slab
        assert different.mean() < 1e-3
        # Other roundings move a cell to the undecided ones, not from free to hit.
        both = np.array([again.codes[different], slab[different]])
        assert (both == UNDECIDED).any(axis=0).all()
        assert FREE in slab
        assert (HIT in slab) == (HIT in table.codes)
    assert cells_text(bodies, committed) == module.CELLS_PATH.read_text("utf-8")
