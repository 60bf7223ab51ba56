"""Records do not change, and those that hold arrays are not compared entry by entry."""

from __future__ import annotations

import copy
import dataclasses
import re
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model.description import frames
from alpha5_model.description.mjcf import MjcfOptions, mjcf
from alpha5_model.description.reading import read_urdf
from alpha5_model.description.verification import checks
from alpha5_model.errors import InputError, PublishedDataError
from alpha5_model.numbers.parameters import parameters

PACKAGE = Path(a5.__file__).parent


def records() -> list[type]:
    found: dict[str, type] = {}
    for file in sorted(PACKAGE.rglob("*.py")):
        parts = file.relative_to(PACKAGE.parent).with_suffix("").parts
        if parts[-1] == "__main__" or "_data" in parts:
            continue
        module = import_module(".".join(parts))
        for value in vars(module).values():
            if isinstance(value, type) and dataclasses.is_dataclass(value):
                found[f"{value.__module__}.{value.__qualname__}"] = value
    return [found[name] for name in sorted(found) if name.startswith("alpha5_model.")]


def test_every_record_is_frozen() -> None:
    every = records()
    assert len(every) > 80
    assert [r for r in every if not r.__dataclass_params__.frozen] == []


def compared_by_identity(every: list[type]) -> set[type]:
    """Records that hold an array, a function or anything, or another such record.

    Options name an arm, which is compared by identity, and are compared by content.
    """
    words = {"Callable", "Any"}

    def holds_one(record: type) -> bool:
        types = " ".join(str(field.type) for field in dataclasses.fields(record))
        names = re.findall(r"\w+", types)
        return any(name in words or name.endswith("Array") for name in names)

    while True:
        found = {record for record in every if holds_one(record)}
        names = {record.__name__ for record in found}
        if names - {"Alpha5Parameters"} <= words:
            return found
        words |= names - {"Alpha5Parameters"}


def test_records_of_arrays_have_no_equality() -> None:
    """``==`` of two arrays is an array; as records they would raise."""
    of_arrays = compared_by_identity(records())
    assert len(of_arrays) > 40
    assert [r for r in of_arrays if r.__dataclass_params__.eq] == []


def test_robots_as_read_are_told_apart_and_hashed_by_identity() -> None:
    """Their records of arrays compare by identity, they themselves by content."""
    one, other = read_urdf(a5.URDF_PATH), read_urdf(a5.URDF_PATH)
    assert one != other
    assert len({one, other, one}) == 2


# --- numbers and branches of the description that no other test holds -----------------


def test_the_rod_of_the_mujoco_model_is_damped_by_hand() -> None:
    """dampratio would take the rod's own mass; the value is tuned, and said to be."""
    text = mjcf(MjcfOptions(gripper="jaws"))
    (rod,) = [
        line for line in text.splitlines() if "<position" in line and "axis_a" in line
    ]
    assert 'kv="8.0"' in rod
    assert "dampratio" not in rod
    assert text.count('dampratio="1"') == 4


@pytest.mark.parametrize(
    "change", [{"d": 0.1}, {"a": 0.1}, {"alpha": 1.0}, {"variable": "theta"}]
)
def test_the_last_row_of_table_1_turns_only(change: dict[str, object]) -> None:
    p = parameters()
    last = dataclasses.replace(p.dh[4], **change)
    with pytest.raises(PublishedDataError, match="a fixed rotation about z only"):
        frames.tcp_placement(dataclasses.replace(p, dh=(*p.dh[:4], last)))


def test_a_placement_needs_right_angles() -> None:
    p = parameters()
    askew = dataclasses.replace(p.dh[0], alpha=np.pi / 4)
    with pytest.raises(InputError, match="twisted axes"):
        dataclasses.replace(p, dh=(askew, *p.dh[1:]))

    unchecked = copy.copy(p)
    object.__setattr__(unchecked, "dh", (askew, *p.dh[1:]))
    with pytest.raises(PublishedDataError, match="not a multiple of pi/2"):
        frames.joint_placements(unchecked)


def test_what_check_urdf_says_is_cut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = tmp_path / "check_urdf"
    program.write_text("#!/bin/sh\nprintf 'x%.0s' $(seq 500)\nexit 3\n")
    program.chmod(0o755)
    monkeypatch.setattr(checks.shutil, "which", lambda *_, **__: str(program))

    def found() -> str:
        rows = checks.verify_urdf(a5.URDF_PATH, samples=1)
        return next(r.finding for r in rows if r.check == "check_urdf")

    assert found() == "x" * 200
    program.write_text("#!/bin/sh\nexit 3\n")
    assert found() == "exit status 3"
