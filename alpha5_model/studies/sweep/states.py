"""The states of a study: points of its grid, random ones, or a recording's samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray, frozen
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.sweep.study import Study
from alpha5_model.trajectory import SmoothMotion, read_motion, smooth

#: Joints of the arm, base to tip.
_JOINTS = ("axis_e", "axis_d", "axis_c", "axis_b")
#: Blocks of states that are kept.
_KEPT = 32
#: Random numbers that the generator makes per step of its counter.
_PER_COUNT = 4


@dataclass(frozen=True, eq=False)
class States:
    """Some states of a case.

    Attributes:
        number: Of each among the states of its case, (n,).
        index: Axis -> index of its value, (n,).
        columns: Other columns that describe them: random numbers or times, (n,) each.
        motion: Positions, velocities and accelerations of the four joints, (n, 4).
    """

    number: NDArray[np.int64]
    index: dict[str, NDArray[np.intp]]
    columns: dict[str, NDArray[Any]]
    motion: SmoothMotion


def states_of(
    study: Study, arm: Alpha5Parameters | None, first: int, last: int
) -> States:
    """States first to last - 1 of a case; all cases of an arm have the same states.

    Those in self-collision are not among them, if the study leaves them out. The states
    are kept for the next case, if there is room for all of a case.

    Args:
        study: The study.
        arm: Record of the case's arm; None for the catalogue's.
        first: Number of the first state.
        last: Number after that of the last one.
    """
    if not (study.leaves_out_collisions or study.in_collision):
        arm = None  # the states do not depend on it
    sizes = study.sizes()
    if sizes.cases > 1 and sizes.blocks <= _KEPT:
        return _kept_states(study, arm, first, last)
    return _new_states(study, arm, first, last)


@lru_cache(maxsize=_KEPT)
def _kept_states(
    study: Study, arm: Alpha5Parameters | None, first: int, last: int
) -> States:
    """`_new_states`, kept."""
    return _new_states(study, arm, first, last)


def _new_states(
    study: Study, arm: Alpha5Parameters | None, first: int, last: int
) -> States:
    """States first to last - 1 of a case; see `states_of`."""
    index = _grid_index(study, first, last)
    drawn = _drawn(study, first, last)
    on_grid = {name: np.array(study.states[name])[at] for name, at in index.items()}
    given = {**on_grid, **drawn}

    zero = _zeros(last - first)
    velocity = _of_joints("vel", given, last - first)
    motion = SmoothMotion(
        time=zero,
        joints=(),
        position=_of_joints("pos", given, last - first),
        velocity=velocity,
        acceleration=_of_joints("acc", given, last - first),
        direction=_direction(velocity, given),
        method="interpolate",
        bandwidth=None,
        from_velocity=False,
        deviation=zero,
    )
    number = np.arange(first, last)
    states = States(number=number, index=index, columns=drawn, motion=motion)
    if study.leaves_out_collisions:
        return _selected(states, ~_touches(states, arm))
    return _told_apart(states, arm, tuple(study.in_collision))


def _touches(states: States, arm: Alpha5Parameters | None) -> NDArray[np.bool_]:
    """Whether the arm, its jaws closed, touches itself, (n,)."""
    return self_collision(chosen_arm(arm)).touches(states.motion.position)


def _told_apart(
    states: States, arm: Alpha5Parameters | None, in_collision: tuple[bool, ...]
) -> States:
    """The states with their place on the axis ``in_collision``, if there is one.

    Those that have no place on it are left out.
    """
    if not in_collision:
        return states
    touches = _touches(states, arm)
    place = np.zeros(len(touches), np.intp)
    on_axis = np.zeros(len(touches), bool)
    for k, value in enumerate(in_collision):
        is_value = touches == value
        place[is_value] = k
        on_axis |= is_value
    index = {**states.index, "in_collision": place}
    return _selected(replace(states, index=index), on_axis)


def _selected(states: States, kept: NDArray[np.bool_]) -> States:
    """Some of the states.

    Args:
        states: All of them.
        kept: Whether each is one of them, (n,).
    """
    motion = states.motion
    return States(
        number=states.number[kept],
        index={name: index[kept] for name, index in states.index.items()},
        columns={name: column[kept] for name, column in states.columns.items()},
        motion=replace(
            motion,
            time=motion.time[kept],
            position=motion.position[kept],
            velocity=motion.velocity[kept],
            acceleration=motion.acceleration[kept],
            direction=motion.direction[kept],
        ),
    )


def _grid_index(study: Study, first: int, last: int) -> dict[str, NDArray[np.intp]]:
    """Axis -> index of its value in each state; the last axis runs fastest."""
    index = {}
    rest = np.arange(first, last) // study.samples
    for name in reversed(study.states):
        rest, index[name] = np.divmod(rest, len(study.states[name]))
    return index


def _drawn(study: Study, first: int, last: int) -> dict[str, FloatArray]:
    """Random numbers of states, by axis.

    Each state has its own counts of the generator, so that its numbers do not depend on
    the block.
    """
    counts = -(-len(study.drawn) // _PER_COUNT)
    bits = np.random.Philox(study.seed).advance(first * counts)
    numbers = np.random.Generator(bits).random((last - first, _PER_COUNT * counts))
    return {
        name: low + (high - low) * numbers[:, k]
        for k, (name, (low, high)) in enumerate(study.drawn.items())
    }


def _of_joints(rate: str, given: dict[str, FloatArray], count: int) -> FloatArray:
    """Positions (``pos``), velocities (``vel``) or accelerations (``acc``), (n, 4)."""
    columns = {k: given.get(f"{joint}_{rate}") for k, joint in enumerate(_JOINTS)}
    if all(column is None for column in columns.values()):
        return _zeros(count, len(_JOINTS))
    values = np.zeros((count, len(_JOINTS)))
    for k, column in columns.items():
        if column is not None:
            values[:, k] = column
    return values


def _direction(velocity: FloatArray, given: dict[str, FloatArray]) -> FloatArray:
    """The sign of each velocity; most studies have none, and it takes time."""
    if not any(f"{joint}_vel" in given for joint in _JOINTS):
        return velocity
    return np.sign(velocity)


@lru_cache(maxsize=8)
def _zeros(*shape: int) -> FloatArray:
    """Zeros that all states share: making new ones would take a fifth of the time."""
    return frozen(np.zeros(shape))


@lru_cache(maxsize=1)
def recorded_states(
    path: Path, arm: Alpha5Parameters | None, in_collision: tuple[bool, ...]
) -> States:
    """The samples of a recording, smoothed.

    Args:
        path: Of the recording.
        arm: Record of an arm of one's own; None for the catalogue's.
        in_collision: Values of the axis; empty without it.

    Raises:
        Alpha5Error: The recording cannot be used.
    """
    motion = smooth(read_motion(path, arm=arm), arm=arm)
    sample = np.arange(len(motion.time))
    states = States(
        number=sample,
        index={},
        columns={"sample": sample, "time": motion.time},
        motion=replace(
            motion,
            position=_arm_columns(motion.position),
            velocity=_arm_columns(motion.velocity),
            acceleration=_arm_columns(motion.acceleration),
            direction=_arm_columns(motion.direction),
        ),
    )
    return _told_apart(states, arm, in_collision)


def _arm_columns(values: FloatArray) -> FloatArray:
    """The columns of the four joints, without the jaw rod's."""
    return np.ascontiguousarray(values[:, :4])
