"""What the compiled self-collision refuses: anything that is not plainly its input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from collision_scenes import (
    FREE,
    HIT,
    chain,
    compiled,
    cubes,
    scene_of,
    shape,
    solutions,
    table,
)

from alpha5_model._support.checks import LARGEST


def five() -> Any:
    return scene_of(chain(5), [shape(0, [0.1] * 3), shape(4, [0.1] * 3)], [(0, 4)])


Q = np.linspace(0.0, 1.0, 16).reshape(4, 4)


@pytest.mark.parametrize(
    "changed",
    [
        {0: list(solutions(Q, [1] * 4))},
        {0: solutions(Q, [1] * 4)[:4]},
        {0: (*solutions(Q, [1] * 4), None)},
        {0: solutions(Q.tolist(), [1] * 4)},
        {0: solutions(Q.astype(np.float32), [1] * 4)},
        {0: solutions(Q[:3], [1] * 4)},
        {0: solutions(Q.ravel(), [1] * 4)},
        {0: solutions(Q.reshape(2, 2, 4), [1] * 4)},
        {0: solutions(Q, [1] * 3)},
        {0: solutions(Q, [1] * 5)},
        {0: (Q, None, np.ones(4), np.array(False), None)},
        {0: (Q, None, np.ones(4, np.bool_), 0, None)},
        {0: (Q, None, np.ones(4, np.bool_), np.zeros(2, np.bool_), None)},
        {0: solutions(Q, [1] * 4, singular=True)},
        {0: solutions(Q, [0] * 4)},
        {1: np.zeros(3)},
        {1: np.zeros((1, 4))},
        {1: [0.0, 0.0, 0.0]},
        {1: [0.0, 0.0, 0.0, np.nan]},
        {1: [0.0, 0.0, 0.0, 2 * LARGEST]},
        {1: {0.0, 1.0, 2.0, 3.0}},
        {1: [0.0, 0.0, 0.0, "1"]},
        {1: [0.0, 0.0, 0.0, 10**400]},
        {2: 1},
        {2: None},
    ],
)
def test_no_best_solution_is_made_of_what_is_not_plainly_one(changed: Any) -> None:
    plain: list[Any] = [solutions(Q, [1] * 4), np.zeros(4), True]
    scene = five()
    assert compiled.best_solution(scene, *plain).tolist() == Q[0].tolist()
    for same in ([0, 0.0, 0, 0], (0.0, 0.0, 0.0, 0.0), [-1.0, 0.0, 0.0, 0.0]):
        found = compiled.best_solution(scene, plain[0], same, True)
        assert found.tolist() == Q[0].tolist()
    for place, value in changed.items():
        plain[place] = value
    assert compiled.best_solution(scene, *plain) is None


def test_a_scene_of_other_bodies_has_no_best_solution() -> None:
    plain = (solutions(Q, [1] * 4), np.zeros(4), True)
    for count in (4, 6):
        shapes = [shape(0, [0.1] * 3), shape(3, [0.1] * 3)]
        scene = scene_of(chain(count), shapes, [(0, 3)])
        assert compiled.best_solution(scene, *plain) is None


ONE = np.zeros((1, 1))


@pytest.mark.parametrize(
    ("angles", "margin"),
    [
        ([0.0], 0.0),
        (np.zeros(2), 0.0),
        (np.zeros(0), 0.0),
        (ONE, 0.0),
        (np.array(0.0), 0.0),
        (np.zeros(1, np.float32), 0.0),
        (np.full(1, np.nan), 0.0),
        (np.full(1, np.inf), 0.0),
        (np.full(1, 2 * LARGEST), 0.0),
        (np.zeros(1), -1e-300),
        (np.zeros(1), np.nan),
        (np.zeros(1), 2 * LARGEST),
        (np.zeros(1), "0"),
        (np.zeros(1), np.float64(0.0)),
        (np.zeros(1), True),
        (np.zeros(1), 10**400),
    ],
)
def test_one_state_that_is_not_plainly_so_has_no_answer(
    angles: Any, margin: Any
) -> None:
    scene = scene_of(*cubes(), [(0, 1)])
    assert compiled.self_collision(scene, np.zeros(1), 0.0) is False
    assert compiled.self_collision(scene, np.zeros(1), 0) is False
    assert compiled.self_collision(scene, np.zeros(1), LARGEST) is True
    assert compiled.self_collision(scene, angles, margin) is None


def read_only(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


NO = np.zeros(2, np.bool_)
TWO = np.zeros((2, 1))


@pytest.mark.parametrize(
    "changed",
    [
        {0: TWO.tolist()},
        {0: np.zeros(2)},
        {0: np.zeros((2, 2))},
        {0: np.zeros((3, 1))},
        {0: np.zeros((2, 1, 1))},
        {0: np.zeros((4, 1))[::2]},
        {1: -1e-9},
        {1: np.nan},
        {1: "0"},
        {2: [False, False]},
        {2: np.zeros(3, np.bool_)},
        {2: np.zeros(2)},
        {2: np.zeros(4, np.bool_)[::2]},
        {3: [False, False]},
        {3: np.zeros(1, np.bool_)},
        {3: np.zeros(2, np.int8)},
        {3: read_only(NO.copy())},
        {3: np.zeros(4, np.bool_)[::2]},
    ],
)
def test_rows_that_are_not_plainly_so_are_not_computed(changed: Any) -> None:
    scene = scene_of(*cubes(), [(0, 1)])
    plain: list[Any] = [read_only(TWO.copy()), 0.0, read_only(NO.copy()), NO.copy()]
    assert compiled.self_collision_rows(scene, *plain) is True
    for place, value in changed.items():
        plain[place] = value
    assert compiled.self_collision_rows(scene, *plain) is False


@pytest.mark.parametrize(
    "changed",
    [
        {0: TWO.tolist()},
        {0: np.zeros((2, 2))},
        {0: np.zeros((3, 1))},
        {0: np.array([[0.0], [np.nan]])},
        {1: np.zeros(17)},
        {1: np.zeros((2, 10))},
        {1: np.zeros((2, 9), np.float32)},
        {1: read_only(np.zeros((2, 9)))},
    ],
)
def test_nearest_bodies_are_not_computed_of_other_arrays(changed: Any) -> None:
    scene = scene_of(*cubes(), [(0, 1)])
    plain: list[Any] = [read_only(TWO.copy()), np.zeros((2, 9))]
    assert compiled.nearest_bodies_rows(scene, *plain) is True
    for place, value in changed.items():
        plain[place] = value
    assert compiled.nearest_bodies_rows(scene, *plain) is False


@pytest.mark.parametrize(
    "changed",
    [
        {0: np.ones((2, 1))},
        {0: np.ones((1, 2))},
        {0: [[1.0]]},
        {1: np.zeros((3, 1))},
        {1: np.zeros((2, 2))},
        {1: np.array([[0.0], [np.nan]])},
        {2: np.zeros((3, 1))},
        {2: np.zeros((2, 2))},
        {2: np.array([[0.0], [np.inf]])},
        {3: -1e-9},
        {3: np.nan},
        {3: None},
        {4: np.zeros(3)},
        {4: np.zeros(2, np.float32)},
        {4: read_only(np.zeros(2))},
    ],
)
def test_lines_of_other_arrays_are_not_computed(changed: Any) -> None:
    scene = scene_of(*cubes(), [(0, 1)])
    plain: list[Any] = [np.ones((1, 1)), TWO, TWO, 0.0, np.zeros(2)]
    assert compiled.free_shares(scene, *plain) is True
    for place, value in changed.items():
        plain[place] = value
    assert compiled.free_shares(scene, *plain) is False


@pytest.mark.parametrize(
    ("name", "count"),
    [
        ("self_collision", 2),
        ("self_collision_rows", 4),
        ("best_solution", 3),
        ("nearest_bodies_rows", 2),
        ("free_shares", 5),
    ],
)
def test_calls_without_a_scene_or_of_other_counts_raise(name: str, count: int) -> None:
    function = getattr(compiled, name)
    scene = scene_of(*cubes(), [(0, 1)])
    for wrong in (count - 1, count + 1):
        with pytest.raises(TypeError, match=f"{name} takes a scene"):
            function(scene, *[None] * wrong)
    with pytest.raises(ValueError, match="PyCapsule"):
        function(None, *[None] * count)


# --- scenes -------------------------------------------------------------------------


def test_a_scene_takes_at_most_eight_bodies_64_pairs_and_four_tables() -> None:
    shapes = [shape(0, [0.1] * 3), shape(7, [0.1] * 3)]
    many = [(0, 7)] * 64
    always = table(np.full(1, HIT, np.uint8), pairs=[63])
    never = table(np.full(1, FREE, np.uint8), pairs=range(64))
    angles = np.zeros(7)
    scene = scene_of(chain(8), shapes, many)
    assert compiled.self_collision(scene, angles, 0.0) is True
    assert compiled.self_collision(scene_of(chain(8), shapes, []), angles, 0.0) is False
    free = scene_of(chain(8), shapes, many, *never * 4)
    assert compiled.self_collision(free, angles, 0.0) is False
    hit = scene_of(chain(8), shapes, many, *never * 3, *always)
    assert compiled.self_collision(hit, angles, 0.0) is True
    for wrong in (
        (chain(9), shapes, many),
        (chain(0), [], []),
        (chain(8), shapes, [*many, (0, 7)]),
        (chain(8), shapes, many, *never * 5),
        (chain(8), shapes, many, never[0]),
    ):
        with pytest.raises(ValueError, match=r"^scene"):
            scene_of(*wrong)


def with_entry(array: np.ndarray, place: Any, value: float) -> np.ndarray:
    changed = array.copy()
    changed[place] = value
    return changed


BODIES, SHAPES = cubes()
PAIRS = np.array([[0.0, 1.0]])


@pytest.mark.parametrize(
    "changed",
    [
        {0: with_entry(BODIES, (0, 0), 0.0)},
        {0: with_entry(BODIES, (1, 0), 1.0)},
        {0: with_entry(BODIES, (1, 0), -1.0)},
        {0: BODIES[:, :12].copy()},
        {0: BODIES.tolist()},
        {1: with_entry(np.array(SHAPES), (1, 0), 2.0)},
        {1: with_entry(np.array(SHAPES), (0, 0), -1.0)},
        {1: np.array(SHAPES)[::-1].copy()},
        {1: np.array(SHAPES)[:, :16].copy()},
        {1: np.array(SHAPES, np.float32)},
        {2: with_entry(PAIRS, (0, 1), 2.0)},
        {2: with_entry(PAIRS, (0, 0), 2.0)},
        {2: with_entry(PAIRS, (0, 0), -1.0)},
        {2: with_entry(PAIRS, (0, 1), -1.0)},
        {2: np.zeros((1, 3))},
        {2: PAIRS.ravel()},
    ],
)
def test_scenes_that_do_not_fit_are_refused(changed: Any) -> None:
    plain: list[Any] = [BODIES, np.array(SHAPES), PAIRS]
    compiled.scene(*plain)
    for place, value in changed.items():
        plain[place] = value
    with pytest.raises(ValueError, match=r"^scene"):
        compiled.scene(*plain)
    with pytest.raises(ValueError, match=r"^scene"):
        compiled.scene(*plain[:2])


def test_tables_that_do_not_fit_are_refused() -> None:
    bodies = chain(4)
    shapes = [shape(0, [0.1] * 3), shape(3, [0.1] * 3)]
    numbers, codes = table(np.zeros((2, 2, 3), np.uint8))

    def made(changed: Any, of: Any = codes) -> Any:
        return scene_of(bodies, shapes, [(0, 3)], changed, of)

    made(numbers)
    longest = with_entry(numbers, slice(8, 11), 1.0)
    made(with_entry(longest, 8, 1 << 12), bytes(1 << 10))
    one_joint = with_entry(with_entry(numbers, 1, 1.0), 0, 2.0)
    made(one_joint, codes[:1])
    for changed, of in (
        (numbers, codes[:-1]),
        (numbers, bytearray(codes)),
        (numbers, None),
        (numbers[:-1].copy(), codes),
        (np.append(numbers, 0.0), codes),
        (numbers.astype(np.float32), codes),
        (numbers.tolist(), codes),
        (with_entry(numbers, 0, 1.0), codes),
        (with_entry(numbers, 0, -1.0), codes),
        (with_entry(one_joint, 0, 3.0), codes),
        (with_entry(numbers, 1, 0.0), codes),
        (with_entry(numbers, 1, 4.0), codes),
        (with_entry(numbers, 8, 0.0), codes),
        (with_entry(numbers, 10, -1.0), codes),
        (with_entry(longest, 8, (1 << 12) + 1), bytes(1 << 11)),
        (with_entry(longest, 10, (1 << 12) + 1), bytes(1 << 11)),
    ):
        with pytest.raises(
            ValueError, match=r"^scene: bodies, shapes, pairs or tables"
        ):
            made(changed, of)
