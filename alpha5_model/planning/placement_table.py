"""Poses of a vehicle from which the arm does what was asked, and their table."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import PathLike
from alpha5_model._support.outputs import output_format
from alpha5_model._support.text import short_repr
from alpha5_model._support.writing import atomic_write
from alpha5_model.errors import InputError
from alpha5_model.kinematics.ik import BRANCHES
from alpha5_model.numbers import plausibility
from alpha5_model.planning.obstacles import Obstacle, seen_from

#: Of the table.
FORMATS = (".csv",)
#: Distances are ranked in whole steps of this [m].
DISTANCE_STEP = 0.01
#: Shares of the joints' effort are ranked in whole steps of this.
HOLDING_STEP = 0.01
#: Tilts are ranked in whole steps of this [rad].
TILT_STEP = 1e-3
#: Added before a step is rounded down: a last bit must not change the rank.
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Placements:
    """N poses of a vehicle from which the arm reaches T points, the best first.

    The rank of a pose is that of its three distances, from the least to the greatest:
    `clearance`, `hull_clearance` and `reach_margin`, each in whole centimetres. Among
    equals it is that of `holding`, in whole percent, and then of `tilt`, in whole
    milliradians. `take` sorts in another order. Arrays are read-only.

    Attributes:
        points: That are reached from every pose, in the world, (T, 3) [m].
        pose: x, y, z [m] and roll, pitch, yaw [rad] of the vehicle's frame in the
            world, (N, 6).
        base: base_link in the world, (N, 4, 4).
        q: Joint positions at which the tcp is at each point, (N, T, 4) [rad].
        branch: Of the inverse kinematics, numbers of `alpha5_model.BRANCHES`, (N, T).
        clearance: Least distance of the moving links from the obstacles, (N,) [m]; inf
            if there are none.
        hull_clearance: Least distance of hull and link_0 from the obstacles, (N,) [m];
            inf if there are none.
        reach_margin: Each point may be off by this in any direction, and the arm still
            reaches it within its limits; the least of all points, (N,) [m]. It does not
            look at collisions.
        torque: That holds the arm still at each point, (N, T, 4) [N m].
        holding: Its greatest share of a joint's ``effort``, (N,). The catalogue's
            efforts are placeholders; no rating is published.
        tilt: Greatest angle between the upward axis of the pose and that of the
            vehicle's static trim, (N,) [rad]; NaN if nothing is known of its weight.
        hull: Fixed to the vehicle, in base_link.
        world: The obstacles in the world.
        tried: How many poses were tried.
    """

    points: FloatArray
    pose: FloatArray
    base: FloatArray
    q: FloatArray
    branch: np.ndarray
    clearance: FloatArray
    hull_clearance: FloatArray
    reach_margin: FloatArray
    torque: FloatArray
    holding: FloatArray
    tilt: FloatArray
    hull: tuple[Obstacle, ...]
    world: tuple[Obstacle, ...]
    tried: int

    def __len__(self) -> int:
        return len(self.pose)

    def __repr__(self) -> str:
        return short_repr(self)

    def branches(self, row: int = 0) -> tuple[str, ...]:
        """Names of the branches at a pose, one for each point.

        Raises:
            InputError: No such row.
        """
        return tuple(BRANCHES[branch] for branch in self.branch[self._row(row)])

    def take(self, rows: ArrayLike) -> Placements:
        """Some poses, or all in another order.

        ``found.take(np.argsort(found.holding))`` has the least torque first.

        Args:
            rows: Their numbers, (K,).

        Raises:
            InputError: Not such numbers.
        """
        try:
            index = np.arange(len(self))[np.asarray(rows)].reshape(-1)
        except (IndexError, TypeError, ValueError):
            expected = f"numbers of rows, from 0 to {len(self) - 1}"
            raise InputError("rows", rows, expected) from None
        return self._rows(index)

    def ranked(self) -> Placements:
        """The same in the order of their rank."""
        distances = [self.clearance, self.hull_clearance, self.reach_margin]
        steps = np.sort(_steps(np.array(distances), DISTANCE_STEP), axis=0)
        holding = _steps(self.holding, HOLDING_STEP)
        tilt = _steps(np.nan_to_num(self.tilt), TILT_STEP)
        # The last key counts first.
        order = np.lexsort([tilt, holding, -steps[2], -steps[1], -steps[0]])
        return self._rows(order)

    def obstacles(self, row: int = 0) -> tuple[Obstacle, ...]:
        """Hull and obstacles in base_link at a pose, for `plan` and `view`.

        Raises:
            InputError: No such row.
        """
        base = self.base[self._row(row)]
        # They gave their warnings when they were made.
        with plausibility.silenced():
            seen = [Obstacle(o.name, seen_from(base, o.shape)) for o in self.world]
        return (*self.hull, *seen)

    def write(self, path: PathLike) -> Path:
        """Write a table as CSV, with a line for each pose and point.

        Args:
            path: ``.csv``, ``-``, a device or a pipe.

        Raises:
            UnknownNameError: Another suffix.
            OutputError: The file cannot be written.
        """
        output_format("table format", path, FORMATS)
        names = [
            *("placement", "point", "x [m]", "y [m]", "z [m]"),
            *("roll [rad]", "pitch [rad]", "yaw [rad]"),
            *("clearance [m]", "hull_clearance [m]", "reach_margin [m]"),
            *("holding", "tilt [rad]", "branch"),
            *(f"axis_{letter} [rad]" for letter in "edcb"),
        ]
        lines = [",".join(names)]
        for row in range(len(self)):
            of_pose = [
                *self.pose[row],
                *(self.clearance[row], self.hull_clearance[row]),
                *(self.reach_margin[row], self.holding[row], self.tilt[row]),
            ]
            for point, branch in enumerate(self.branches(row)):
                cells: list[Any] = [row, point, *map(_digits, of_pose), branch]
                cells += map(_digits, self.q[row, point])
                lines.append(",".join(map(str, cells)))
        return atomic_write(Path(path), "\n".join(lines) + "\n")

    def _row(self, row: int) -> int:
        """The number of a row.

        Raises:
            InputError: No such row.
        """
        is_number = isinstance(row, int | np.integer) and not isinstance(row, bool)
        if not is_number or not -len(self) <= row < len(self):
            expected = f"the number of a row, from 0 to {len(self) - 1}"
            raise InputError("row", row, expected)
        return int(row)

    def _rows(self, index: np.ndarray) -> Placements:
        shared = ("points", "hull", "world", "tried")
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        for name in values.keys() - set(shared):
            values[name] = values[name][index]
            values[name].flags.writeable = False
        return Placements(**values)


def _steps(values: FloatArray, step: float) -> FloatArray:
    """Values in whole steps, rounded down."""
    return np.asarray(np.floor(values / step + _ROUNDING))


def _digits(value: float) -> str:
    """All digits; nothing for NaN."""
    return "" if np.isnan(value) else repr(float(value) + 0.0)
