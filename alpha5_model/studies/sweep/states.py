"""The states of a study: points of its grid, random ones, or a recording's samples."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import FloatArray
from alpha5_model.collision.self_collision import self_collision
from alpha5_model.numbers.parameters import Alpha5Parameters, chosen_arm
from alpha5_model.studies.sweep.axes import JOINTS
from alpha5_model.studies.sweep.study import Study
from alpha5_model.trajectory import read_motion, smooth

#: Random numbers that the generator makes per step of its counter.
_PER_COUNT = 4


@dataclass(frozen=True, eq=False)
class States:
    """Some states of a case, and the motion of the four joints, (n, 4) each.

    Attributes:
        number: Of each among the states of its case, (n,).
        index: Axis -> index of its value, (n,), or one for all.
        columns: Other columns that describe them: random numbers or times, (n,) each.
        position: [rad].
        velocity: [rad/s].
        acceleration: [rad/s^2].
        direction: -1, 0 at rest, or 1.
    """

    number: NDArray[np.int64]
    index: dict[str, Any]
    columns: dict[str, NDArray[Any]]
    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    direction: FloatArray

    @property
    def signed_velocity(self) -> FloatArray:
        """Velocities as friction sees them, (n, 4): signed by `direction`."""
        return np.asarray(self.direction * np.abs(self.velocity))

    def chosen(self, kept: NDArray[np.bool_]) -> States:
        """Some of the states.

        Args:
            kept: Whether each is one of them, (n,).
        """
        return States(
            number=self.number[kept],
            index={name: at[kept] for name, at in self.index.items()},
            columns={name: column[kept] for name, column in self.columns.items()},
            position=self.position[kept],
            velocity=self.velocity[kept],
            acceleration=self.acceleration[kept],
            direction=self.direction[kept],
        )


def states_of(
    study: Study, arm: Alpha5Parameters | None, first: int, last: int
) -> States:
    """States first to last - 1 of each case; for recordings, see `recorded_states`.

    Those that the study leaves out for self-collision are not among them.

    Args:
        study: The study.
        arm: Record of the case's arm; None for the catalogue's.
        first: Number of the first state.
        last: Number after that of the last one.
    """
    if not (study.leaves_out_collisions or study.axes.in_collision):
        arm = None  # the states do not depend on it
    return _states(study, arm, first, last)


@lru_cache(maxsize=1)
def _states(
    study: Study, arm: Alpha5Parameters | None, first: int, last: int
) -> States:
    """`states_of`, kept for the next case."""
    index = {}
    rest = np.arange(first, last) // study.samples
    for name in reversed(study.axes.states):
        rest, index[name] = np.divmod(rest, len(study.axes.states[name]))
    on_grid = {
        name: np.array(study.axes.states[name])[at] for name, at in index.items()
    }
    drawn = _drawn(study, first, last)

    given = {**on_grid, **drawn}
    motion = {
        rate: np.zeros((last - first, len(JOINTS))) for rate in ("pos", "vel", "acc")
    }
    for rate, values in motion.items():
        for k, joint in enumerate(JOINTS):
            values[:, k] = given.get(f"{joint}_{rate}", 0.0)
    states = States(
        number=np.arange(first, last),
        index=index,
        columns=drawn,
        position=motion["pos"],
        velocity=motion["vel"],
        acceleration=motion["acc"],
        direction=np.sign(motion["vel"]),
    )
    return _told_apart(study, states, arm)


def _drawn(study: Study, first: int, last: int) -> dict[str, FloatArray]:
    """Random numbers of states, by axis.

    Each state has its own counts of the generator, so that its numbers do not depend on
    where the first state is.
    """
    counts = -(-len(study.axes.drawn) // _PER_COUNT)
    bits = np.random.Philox(study.seed).advance(first * counts)
    numbers = np.random.Generator(bits).random((last - first, _PER_COUNT * counts))
    return {
        name: low + (high - low) * numbers[:, k]
        for k, (name, (low, high)) in enumerate(study.axes.drawn.items())
    }


def _told_apart(study: Study, states: States, arm: Alpha5Parameters | None) -> States:
    """The states that a study keeps: the arm, its jaws closed, may touch itself.

    They have their place on the axis ``in_collision``, if there is one.
    """
    values = study.axes.in_collision
    if not (values or study.leaves_out_collisions):
        return states
    touches = self_collision(chosen_arm(arm)).touches(states.position)
    if study.leaves_out_collisions:
        return states.chosen(~touches)
    place = (touches == values[-1]) * (len(values) - 1)
    index = {**states.index, "in_collision": place}
    return replace(states, index=index).chosen(np.isin(touches, values))


@lru_cache(maxsize=1)
def recorded_states(study: Study, path: Path, arm: Alpha5Parameters | None) -> States:
    """The samples of a recording, smoothed.

    Args:
        study: The study.
        path: Of the recording.
        arm: Record of an arm of one's own; None for the catalogue's.

    Raises:
        Alpha5Error: The recording cannot be used.
    """
    motion = smooth(read_motion(path, arm=arm), arm=arm)
    sample = np.arange(len(motion.time))
    # Without the column of the jaw rod.
    states = States(
        number=sample,
        index={},
        columns={"sample": sample, "time": motion.time},
        position=np.ascontiguousarray(motion.position[:, :4]),
        velocity=np.ascontiguousarray(motion.velocity[:, :4]),
        acceleration=np.ascontiguousarray(motion.acceleration[:, :4]),
        direction=np.ascontiguousarray(motion.direction[:, :4]),
    )
    return _told_apart(study, states, arm)
