"""Tables that ROS programs write, other names of joints, and capitals.

The layouts are those of PlotJuggler's export, ``rostopic echo -p``, ``ros2 topic echo
--csv`` and flattened messages, written here from the numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from bag_writer import State, write_bag

import alpha5_model as a5
from alpha5_model.cli.program import main
from alpha5_model.errors import FileFormatError, InputError, UnknownNameError

#: In the order of a driver: from the jaws to the base.
NAMES = [f"axis_{letter}" for letter in "abcde"]
COUNT = 12
#: Stamps [ns], which pass from one second to the next.
STAMPS = 1_700_000_000_500_000_000 + 125_000_000 * np.arange(COUNT)
#: (12, 5) [m], [rad]
POSITION = np.column_stack(
    [
        0.0078125 + np.zeros(COUNT),
        *(1 + 0.25 * k + 0.015625 * np.arange(COUNT) for k in range(4)),
    ]
)
VELOCITY = 0.125 + POSITION / 16
EFFORT = 0.5 + POSITION / 32


def written(path: Path, rows: Sequence[Sequence[object]]) -> Path:
    path.write_text("\n".join(",".join(map(str, row)) for row in rows), "utf-8")
    return path


def check(motion: a5.trajectory.Motion, effort: bool = True) -> None:
    """Compare each number with the recording's."""
    assert motion.joints == tuple(reversed(NAMES))
    elapsed = (STAMPS - STAMPS[0]) / 1e9
    np.testing.assert_allclose(motion.time - motion.time[0], elapsed, atol=1e-6)
    np.testing.assert_array_equal(motion.position, POSITION[:, ::-1])
    if motion.velocity is not None:
        np.testing.assert_array_equal(motion.velocity, VELOCITY[:, ::-1])
    assert (motion.effort is not None) == effort
    if motion.effort is not None:
        np.testing.assert_array_equal(motion.effort, EFFORT[:, ::-1])


def plotjuggler() -> list[list[object]]:
    quantities = {"position": POSITION, "velocity": VELOCITY, "effort": EFFORT}
    header = [f"/joint_states/{n}/{q}" for n in NAMES for q in quantities]
    columns = [q[:, k] for k in range(5) for q in quantities.values()]
    rows = zip(STAMPS / 1e9, *columns, strict=True)
    return [["__time", *header], *(list(map(repr, map(float, row))) for row in rows)]


def messages(names: Sequence[str] = NAMES, quantities: int = 3) -> list[list[object]]:
    """A row per message: seconds, nanoseconds, frame, names, numbers."""
    arrays = [POSITION, VELOCITY, EFFORT][:quantities]
    rows: list[list[object]] = []
    for k, stamp in enumerate(STAMPS.tolist()):
        numbers = np.concatenate([array[k] for array in arrays]).tolist()
        rows.append([*divmod(stamp, 10**9), "", *names, *numbers])
    return rows


def numbered(form: str, count: int = 5) -> list[str]:
    words = ("name", "position", "velocity", "effort")
    return [form.format(word, k) for word in words for k in range(count)]


def rostopic() -> list[list[object]]:
    head = ["%time", "field.header.seq", "field.header.stamp", "field.header.frame_id"]
    stamps = STAMPS.tolist()
    rows = [
        [t, k, t, *row[2:]]
        for k, (t, row) in enumerate(zip(stamps, messages(), strict=True))
    ]
    return [[*head, *numbered("field.{}{}")], *rows]


def flattened(start: str, form: str) -> list[list[object]]:
    head = [start + "header.stamp.sec", start + "header.stamp.nanosec"]
    head += [start + "header.frame_id", *numbered(start + form)]
    return [head, *messages()]


TABLES = {
    "PlotJuggler": plotjuggler(),
    "rostopic echo -p": rostopic(),
    "ros2 topic echo --csv": messages(),
    "flattened": flattened("", "{}[{}]"),
    "flattened, with a topic": flattened("/joint_states.", "{}.{}"),
}


@pytest.mark.parametrize("name", TABLES)
def test_each_table_has_the_numbers_of_the_messages(name: str, tmp_path: Path) -> None:
    motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", TABLES[name]))
    check(motion)
    kinds = {warning.kind for warning in motion.warnings}
    # Of two clocks one is named, and so is a unit that the name does not state.
    of_rostopic = {"time_column", "time_unit"}
    assert kinds == (of_rostopic if name.startswith("rostopic") else set())


def test_without_a_third_quantity_echoed_numbers_are_not_guessed(
    tmp_path: Path,
) -> None:
    for quantities in (1, 2):
        rows = messages(quantities=quantities)
        motion = a5.trajectory.read_motion(written(tmp_path / "m.csv", rows))
        check(motion, effort=False)
        assert motion.velocity is None
        assert ("other[0]" in motion.ignored) == (quantities == 2)


def test_a_row_with_other_joints_is_left_out(tmp_path: Path) -> None:
    rows = TABLES["flattened"]
    swapped = [*rows[4]]
    swapped[3], swapped[4] = swapped[4], swapped[3]
    motion = a5.trajectory.read_motion(
        written(tmp_path / "m.csv", [*rows[:4], swapped, *rows[4:]])
    )
    check(motion)
    [warning] = motion.warnings
    assert warning.first == "line 5, column 4 (name[0])"
    assert "expected 'axis_a', got 'axis_b'" in warning.text
    with pytest.raises(FileFormatError, match="line 5, column 4"):
        a5.trajectory.read_motion(
            written(tmp_path / "m.csv", [*rows[:4], swapped, swapped, *rows[4:]])
        )


#: The names of two public drivers of this arm, and names that swap the arm's.
OTHERS = {
    "hkolano": [f"r5m_joint{k}" for k in (1, 2, 3, 4, 5)],
    "LeoYu1128": ["jaws", *(f"joint_{k}" for k in (4, 3, 2, 1))],
    "swapped": [*reversed(NAMES)],
    "ten": [f"joint_{k}" for k in (10, 1, 100, 11, 2)],
}


@pytest.mark.parametrize("name", OTHERS)
def test_joints_with_other_names(name: str, tmp_path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    joints = dict(zip(NAMES, OTHERS[name], strict=True))
    header = ["time", *(f"{other}_pos" for other in joints.values())]
    rows: list[list[object]] = [
        [stamp / 1e9, *row]
        for stamp, row in zip(STAMPS.tolist(), POSITION.tolist(), strict=True)
    ]
    table = written(tmp_path / "m.csv", [header, *rows])
    check(a5.trajectory.read_motion(table, joints=joints), effort=False)
    columns = dict(zip(header, zip(*rows, strict=True), strict=True))
    parquet.write_table(pyarrow.table(columns), tmp_path / "m.parquet")
    motion = a5.trajectory.read_motion(tmp_path / "m.parquet", joints=joints)
    check(motion, effort=False)
    echoed = written(tmp_path / "e.csv", messages([*joints.values()]))
    check(a5.trajectory.read_motion(echoed, joints=joints))
    states = [
        State(
            stamp=stamp,
            names=[*joints.values()],
            position=POSITION[k],
            velocity=VELOCITY[k],
            effort=EFFORT[k],
        )
        for k, stamp in enumerate(STAMPS.tolist())
    ]
    check(
        a5.trajectory.read_motion(write_bag(tmp_path, ".mcap", states), joints=joints)
    )


def test_a_map_that_does_not_fit_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path / "m.csv", messages(OTHERS["hkolano"]))
    for joints, kind, words in (
        ({"axis_f": "r5m_joint1"}, UnknownNameError, "axis_f"),
        ({"axis_e": "r5m_joint"}, InputError, "a name in header.stamp.sec"),
        ({"axis_e": ""}, InputError, "each name once"),
        ("axis_e=r5m_joint1", InputError, "a mapping from joints"),
        ({"axis_e": "a", "axis_d": "a"}, InputError, "each name once"),
    ):
        with pytest.raises(kind, match=words):
            a5.trajectory.read_motion(path, joints=joints)  # type: ignore[arg-type]
    text = ",".join(f"{n}={o}" for n, o in zip(NAMES, OTHERS["hkolano"], strict=True))
    assert main(["trajectory", str(path), "--map", text, "--json"]) == 0
    assert '"axis_d"' in capsys.readouterr().out
    for wrong in ("axis_e", "axis_e=r5m_joint9", "x=r5m_joint1"):
        assert main(["trajectory", str(path), "--map", wrong]) == 2
        out, err = capsys.readouterr()
        assert (out, err.count("\n")) == ("", 1)
