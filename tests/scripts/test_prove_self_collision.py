"""The script that proves self-collision again: what it compares and writes."""

from __future__ import annotations

import shutil
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.codegen.kernels.choice import module as kernels
from alpha5_model.collision import cells
from alpha5_model.collision.bodies import collision_bodies, joint_ranges
from alpha5_model.collision.cells import FREE, HIT, UNDECIDED, certified_cells
from alpha5_model.collision.cells_file import cells_text, committed_cells

needs_kernels = pytest.mark.skipif(
    not hasattr(kernels(), "scene"), reason="the compiled kernels are not installed"
)


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> ModuleType:
    """The script on copies of the committed files, with a proof that repeats them."""
    from checks import prove_self_collision as module

    texts = {}
    for name in ("TOUCHING_PAIRS_PATH", "CELLS_PATH"):
        path = getattr(module, name)
        copy = tmp_path / path.name
        shutil.copy(path, copy)
        texts[name] = copy.read_text("utf-8")
        monkeypatch.setattr(module, name, copy)
    monkeypatch.setattr(
        module, "touching_text", lambda arm, grippers: texts["TOUCHING_PAIRS_PATH"]
    )
    monkeypatch.setattr(module, "_cells_text", lambda: texts["CELLS_PATH"])
    return module


def test_what_is_proved_again_agrees(script: ModuleType, capsys) -> None:
    assert script.main([]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said == [
        "touching_pairs.toml is as proven",
        "self_collision_cells.json is as proven",
    ]


def test_a_pair_too_many_or_another_cell_is_stale(script: ModuleType, capsys) -> None:
    path = script.TOUCHING_PAIRS_PATH
    text = path.read_text("utf-8")
    # Where a pair touches may differ, but not which pair.
    path.write_text(text.replace("0.400297", "0.400296"))
    assert script.main([]) == 0
    path.write_text(text.replace("  [5, 0, ", "  [4, 0, ", 1))
    script.CELLS_PATH.write_text("{}")
    assert script.main([]) == 1
    said = capsys.readouterr().out
    assert "touching_pairs.toml is stale: run it with --update" in said
    assert "self_collision_cells.json is stale" in said
    assert script.main(["--update"]) == 0
    assert path.read_text("utf-8") == text
    assert script.main([]) == 0


def test_another_argument_prints_the_help(script: ModuleType, capsys) -> None:
    assert script.main(["--write"]) == 2
    assert "--update" in capsys.readouterr().out


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
