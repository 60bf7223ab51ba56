"""Records written as arm files and read back."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import own_arm_dynamics as own
import pytest

import alpha5_model as a5
from alpha5_model.errors import InputError
from alpha5_model.numbers.arm_schema import ACTUATORS, DRIVE_FIELDS, DRIVES
from alpha5_model.numbers.arm_writing import arm_file_text
from alpha5_model.numbers.parameters import Alpha5Parameters
from alpha5_model.numbers.tables import JOINT_NAMES

EXAMPLE = Path(__file__).parents[2] / "examples" / "my_arm.toml"
pytestmark = pytest.mark.filterwarnings(
    "ignore::alpha5_model.errors.ImplausibleWarning"
)
#: What is written as it is, and so read to the bit.
EXACT = ("name", "corrections", "joints", "actuators", "motors", "measurements")


@pytest.fixture
def read(tmp_path: Path) -> Any:
    def from_text(text: str) -> Alpha5Parameters:
        file = tmp_path / "arm.toml"
        file.write_text(text, encoding="utf-8")
        return a5.arm_file(file)

    return from_text


def plain(value: Any) -> Any:
    """A value as lists, dictionaries and numbers, which can be compared."""
    if dataclasses.is_dataclass(value):
        return {k: plain(v) for k, v in vars(value).items()}
    if isinstance(value, np.ndarray | tuple | list):
        return [plain(x) for x in value]
    return value


def check_same(found: Alpha5Parameters, expected: Alpha5Parameters) -> None:
    """Bits of what is written as it is; the rest to rounding."""
    for name in EXACT:
        ours, theirs = plain(getattr(found, name)), plain(getattr(expected, name))
        assert ours == theirs, name
    for row, wanted in zip(found.dh, expected.dh, strict=True):
        assert (row.a, row.d, row.alpha) == (wanted.a, wanted.d, wanted.alpha)
        assert row.theta_offset == pytest.approx(wanted.theta_offset, abs=4e-15)
    for link, wanted in zip(found.links, expected.links, strict=True):
        assert plain(link) == plain(wanted)
    for body, wanted in zip(found.attached, expected.attached, strict=True):
        assert body.rotation == pytest.approx(wanted.rotation, abs=4e-15)
        same = dataclasses.replace(body, rotation=wanted.rotation)
        assert plain(same) == plain(wanted)
    assert (found.mount is None) == (expected.mount is None)
    for place in ("mount", "tool"):
        one, other = getattr(found, place), getattr(expected, place)
        if other is not None:
            assert one.position.tolist() == other.position.tolist()
            assert one.rotation == pytest.approx(other.rotation, abs=4e-15)


@pytest.mark.slow
@pytest.mark.parametrize("record", own.RECORDS, ids=range(10))
def test_ten_arms_come_back(record: Alpha5Parameters, read: Any) -> None:
    found = read(arm_file_text(record))
    check_same(found, record)
    q, v, a = own.states(record, 5)
    expected = a5.load(arm=record).inverse_dynamics_batch(q, v, a)
    torque = a5.load(arm=found).inverse_dynamics_batch(q, v, a)
    assert torque == pytest.approx(expected, abs=1e-12)


def test_the_example_and_a_new_file_come_back(read: Any) -> None:
    example = a5.arm_file(EXAMPLE)
    text = arm_file_text(example)
    assert 'source = "weighed", half_width = 0.001' in text
    check_same(read(text), example)
    new = read(arm_file_text(a5.parameters(), every_key=True))
    check_same(read(arm_file_text(new)), a5.parameters())


def test_the_catalogues_arm_has_no_table_but_its_notes(read: Any) -> None:
    text = arm_file_text(a5.parameters(), ["from other.urdf"])
    assert text == (
        "# from other.urdf\n"
        "# Numbers are in SI units; what is left out is as printed.\n"
        'format = 1\nname = "alpha5"\n'
    )


@pytest.mark.parametrize("end", ["\n", "\r", "\x0b", "\x85", "\u2028", "\0", "\x7f"])
def test_a_note_stays_in_its_line(read: Any, end: str) -> None:
    """Names in notes come from other people's files."""
    text = arm_file_text(a5.parameters(), [f"sensor{end}[links.link_2]{end}mass = 3"])
    head, *rest = text.split("\n")
    assert head.startswith("# sensor\\")
    assert head.isprintable()
    assert head.endswith("mass = 3")
    assert rest[0] == "# Numbers are in SI units; what is left out is as printed."
    check_same(read(text), a5.parameters())


def test_what_was_measured_as_printed_is_kept(read: Any) -> None:
    text = (
        "format = 1\n[links.link_2]\nmass = {value = 0.38, half_width = 0.002, "
        'source = "a \\"scale\\" \\u007f \\n \\\\ ä"}\n[motors]\n'
        "friction = {value = 2.5e-3, half_width = 1e-4}\n"
    )
    record = read(text)
    found = read(arm_file_text(record))
    assert len(found.measurements) == 1 + len(JOINT_NAMES)
    check_same(found, record)


@pytest.mark.parametrize("key", sorted({**DRIVES, **ACTUATORS}))
def test_a_value_of_all_joints_is_a_value_of_each(key: str, read: Any) -> None:
    """And stays that of the others, if one joint is given another."""
    one = f'format = 1\n[motors]\n{key} = {{value = 2e-6, source = "data sheet"}}\n'
    by_joint = ", ".join(
        f'{joint} = {{value = 2e-6, source = "data sheet"}}' for joint in JOINT_NAMES
    )
    record = read(one)
    check_same(record, read(f"format = 1\n[motors]\n{key} = {{{by_joint}}}\n"))

    if key in DRIVES:
        field = DRIVE_FIELDS[key]
        others = (None, *getattr(record.motors, field)[1:])
        motors = dataclasses.replace(record.motors, **{field: others})
        record = dataclasses.replace(record, motors=motors)
    else:
        axis_e = dataclasses.replace(record.actuators[0], **{key: 1e-6})
        actuators = (axis_e, *record.actuators[1:])
        record = dataclasses.replace(record, actuators=actuators)
    found = read(arm_file_text(record))
    assert plain(found.motors) == plain(record.motors)
    assert plain(found.actuators) == plain(record.actuators)


def test_a_zero_has_no_sign(read: Any) -> None:
    link = dataclasses.replace(a5.parameters().links[2], com=[0.07, -0.0, 0.0])
    links = (*a5.parameters().links[:2], link, *a5.parameters().links[3:])
    text = arm_file_text(dataclasses.replace(a5.parameters(), links=links))
    assert "com = [0.07, 0.0, 0.0]" in text
    assert read(text).links[2].com.tolist() == [0.07, 0.0, 0.0]


@pytest.mark.parametrize("names", [(), ("link3_cob",), ("base_frame", "link3_cob")])
def test_corrections_come_back(names: tuple[str, ...], read: Any) -> None:
    record = a5.parameters(names)
    assert read(arm_file_text(record)).corrections == names


def test_no_record_is_refused() -> None:
    with pytest.raises(InputError, match="arm: expected"):
        arm_file_text("my_arm.toml")  # type: ignore[arg-type]
