"""Arms of one's own: arm files, and what ``compare --write-arm`` writes of a model."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from fuzzing import hostile
from fuzzing.cases import Case, Target
from fuzzing.damage import damage
from fuzzing.values import Rng, pick

import alpha5_model as a5
from alpha5_model._support.text import plain
from alpha5_model.description.urdf import Variant, urdf
from alpha5_model.errors import Alpha5Error
from alpha5_model.numbers.arm_writing import new_arm_file
from alpha5_model.proofs.comparison.arm_of_model import arm_of_model, arm_text

#: Keys of an arm file that its template shows as comments only.
_MORE = """
[links.link_2]
mass = {value = 341, unit = "g", source = "weighed", half_width = 1}

[[attached]]
name = "force_sensor"
link = "link_4"
at = {value = [0, 0, -75], unit = "mm"}
spacer = {value = 22, unit = "mm"}
mass = {value = 120, unit = "g"}
volume = {value = 0.045, unit = "L"}
"""
ARM = 'format = 1\nname = "lab"\n' + _MORE
#: At a pitch of 90 degrees, roll and yaw are rounded to this.
_ROUNDING = 2e-9
_NUMBER = re.compile(r"(?<=[\" ])-?\d+\.\d+(?=[\" ])")
_NAME = re.compile(r"\b(axis_[b-e]|link_\d|alpha5)\b")


class WrongArmError(Exception):
    """The file of an arm is another arm."""


def arm_file(rng: Rng, folder: Path) -> Case:
    """A damaged or hostile arm file; what is read is written and read again."""
    text = pick(rng, (ARM, ARM, new_arm_file()))
    if rng.integers(3) == 0:
        made = hostile.study_of_anything(rng, text)
        content = made.encode("utf-8", "replace")
    else:
        content = damage(rng, text)
    path = folder / "arm.toml"
    path.write_bytes(content)

    def call(path: Path) -> Any:
        arm = a5.arm_file(path)
        _check_written(a5.arm_file_text(arm), arm, path.with_name("again.toml"))
        return arm

    return Case(call, {"path": path}, size=len(content))


def model_file(rng: Rng, folder: Path) -> Case:
    """A URDF of nearly this arm: its arm file says the same arm."""
    text = pick(rng, _WAYS)(rng, _urdf(int(rng.integers(2))))
    content = text.encode("utf-8", "replace")
    path = folder / "model.urdf"
    path.write_bytes(content)

    def call(path: Path) -> Any:
        made = arm_of_model(path)
        written = arm_text(made, path.name)
        _check_written(written, made.record, path.with_name("model.toml"))
        return made.record

    return Case(call, {"path": path}, size=len(content))


def _check_written(text: str, arm: Any, path: Path) -> None:
    """Raise an error unless the text describes the arm."""
    path.write_text(text, encoding="utf-8")
    try:
        again = _numbers(plain(a5.arm_file(path)))
    except Alpha5Error as error:
        raise WrongArmError(f"the file cannot be read: {error}") from None
    known = _numbers(plain(arm))
    if len(again) != len(known):
        raise WrongArmError(f"{len(again)} values, not {len(known)}")
    for before, after in zip(known, again, strict=True):
        if isinstance(before, float) and isinstance(after, float):
            same = bool(np.isclose(before, after, rtol=1e-9, atol=_ROUNDING))
        else:
            same = before == after
        if not same:
            raise WrongArmError(f"{after!r} instead of {before!r}")


def _numbers(record: Any) -> list[Any]:
    """All values of a record, one after the other."""
    if isinstance(record, dict):
        return [x for key in record for x in _numbers(record[key])]
    if isinstance(record, list):
        return [x for part in record for x in _numbers(part)]
    return [record]


@cache
def _urdf(k: int) -> str:
    return urdf(Variant(("locked", "jaws")[k], collision="none"))


def _with_other_numbers(rng: Rng, text: str) -> str:
    """Some numbers larger or smaller, by a little or a lot."""
    share = 1 / pick(rng, (5, 50, 300))
    spread = pick(rng, (1e-9, 1e-3, 0.05, 1.0))

    def changed(found: re.Match[str]) -> str:
        if rng.random() > share:
            return found.group()
        return repr(float(found.group()) * (1 + spread * rng.normal()))

    return _NUMBER.sub(changed, text)


def _with_other_names(rng: Rng, text: str) -> str:
    """A link, a joint or the robot has a name that means harm in a TOML comment."""
    found = sorted(set(_NAME.findall(text)))
    old = pick(rng, found)
    new = pick(
        rng, ("a&#10;[links]", "&quot;", "x&#13;y", "é", "a b", "#", "\\\\u0000")
    )
    return re.sub(rf"\b{old}\b", lambda _: new, text)


def _with_a_body(rng: Rng, text: str) -> str:
    """One more body on a link, of a name that may mean harm."""
    name = pick(
        rng, ("sensor", "a&#10;mass = 3", "&quot;x", "x]]", "é", "..", "link_1")
    )
    mass = pick(rng, ("0.1", "0", "-1", "30", "nan"))
    parent = pick(rng, ("base_link", "link_2", "link_4", "tcp"))
    body = (
        f'<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="1e-4" '
        'ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial></link>'
        f'<joint name="j" type="fixed"><origin xyz="0 0.01 0" rpy="0 1 0"/>'
        f'<parent link="{parent}"/><child link="{name}"/></joint>'
    )
    return text.replace("</robot>", f"{body}</robot>")


_WAYS: tuple[Callable[[Rng, str], str], ...] = (
    _with_other_numbers,
    _with_other_numbers,
    _with_other_names,
    _with_a_body,
    lambda rng, text: _with_a_body(rng, _with_other_numbers(rng, text)),
    hostile.trapped_xml,
    lambda rng, text: hostile.chain_of_joints(rng),
)

TARGETS: dict[str, Target] = {"arm file": arm_file, "model to arm": model_file}
