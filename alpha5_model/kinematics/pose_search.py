"""Poses of a tool beside the wrist axis: a search along theta_3.

theta_3 moves such a tool point, and so each theta_3 has branches of its own. For each
branch, the least rotation error is searched over the range of theta_3:

- Starts are `_STARTS` even steps, the wrist angles of the target's Euler angles, at
  which a pose that can be attained is attained, and, for a target on the yaw axis, the
  wrist angles at which the tool point reaches that axis.
- Around the best local minima among the starts, the step shrinks until it is rounding.
- Where a branch ends, or meets a limit, between two starts, that place is bisected: the
  rotation error may drop steeply towards it.

A joint position within the limits is preferred to any that is not, and of those that
are not, the one that is least beyond them. The search is no proof: it can miss a branch
that comes within reach or the limits between two starts only.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from alpha5_model._support.checks import BoolArray, FloatArray
from alpha5_model._support.spatial import wrap
from alpha5_model.kinematics.geometry import on_axis
from alpha5_model.kinematics.hand import Hand
from alpha5_model.kinematics.solver import Branches, solve

#: Even steps of theta_3.
_STARTS = 192
#: Local minima of a branch that are followed.
_FOLLOWED = 5
#: Wrist angles around a minimum in each round, in steps.
_AROUND = np.linspace(-1.0, 1.0, 9)
#: How much the step shrinks in a round: to less than the distance of these angles.
_SHRINK = 3.5
#: Rounds, after which the step is below 1e-13 rad.
_ROUNDS = 22
#: Ends of a branch that are bisected, and halvings.
_ENDS = 6
_HALVINGS = 42
#: Costs of a branch that is beyond a limit, and of one that is not there: more than any
#: rotation.
_BEYOND = 10.0
_MISSING = 100.0
#: Poses in a block: bounds the memory.
_BLOCK = 64
_BRANCHES = np.arange(4)


class _Found(NamedTuple):
    """Solutions of each branch of N poses, (N, 4), or at W wrist angles, (N, 4, W).

    Attributes:
        q: (..., 4) [rad], not NaN.
        exists, within_limits, singular: (...).
        error: Rotation error, (...) [rad].
        beyond: How far the joints are beyond their limits in sum, (...) [rad].
    """

    q: FloatArray
    exists: BoolArray
    within_limits: BoolArray
    singular: BoolArray
    error: FloatArray
    beyond: FloatArray

    @property
    def cost(self) -> FloatArray:
        """What is least for the best solution, (...).

        Beyond the limits it leads back to them, as between two steps a branch may come
        within them for a short way.
        """
        off = np.where(self.within_limits, self.error, _BEYOND + self.beyond)
        return np.where(self.exists, off, _MISSING)

    def best(self) -> _Found:
        """The best of W wrist angles of each branch: without the axis W."""
        index = self.cost.argmin(axis=-1)[..., None]
        q = np.take_along_axis(self.q, index[..., None], axis=-2)[..., 0, :]
        others: list[Any] = [
            np.take_along_axis(each, index, axis=-1)[..., 0] for each in self[1:]
        ]
        return _Found(q, *others)

    def or_better(self, other: _Found) -> _Found:
        """Of each branch the better one of two solutions, (N, 4)."""
        first = self.cost <= other.cost
        q = np.where(first[..., None], self.q, other.q)
        both = zip(self[1:], other[1:], strict=True)
        return _Found(q, *(np.where(first, one, another) for one, another in both))


def search_poses(
    hand: Hand, position: FloatArray, rotation: FloatArray
) -> tuple[Branches, FloatArray]:
    """Branches of poses and their rotation errors, (..., 4) [rad].

    Args:
        hand: Of the arm.
        position, rotation: Of the poses, (..., 3) [m] and (..., 3, 3).
    """
    lead = position.shape[:-1]
    points = position.reshape(-1, 3)
    turns = rotation.reshape(-1, 3, 3)
    blocks = []
    for start in range(0, max(len(points), 1), _BLOCK):
        rows = slice(start, start + _BLOCK)
        blocks.append(_searched(hand, points[rows], turns[rows]))

    found = _Found._make(np.concatenate(part) for part in zip(*blocks, strict=True))
    branches = Branches(
        q=found.q.reshape(*lead, 4, 4),
        exists=found.exists.reshape(*lead, 4),
        within_limits=found.within_limits.reshape(*lead, 4),
        singular=np.reshape((found.singular & found.exists).any(axis=-1), lead),
        position=position,
    )
    return branches, found.error.reshape(*lead, 4)


def _searched(hand: Hand, position: FloatArray, rotation: FloatArray) -> _Found:
    """The best solution of each branch of N poses."""
    lower = hand.geometry.lower[3]
    upper = hand.geometry.upper[3]
    grid = np.linspace(lower, upper, _STARTS)
    step = float(grid[1] - grid[0])

    starts = np.broadcast_to(grid, (len(position), 4, _STARTS))
    even = _tried(hand, position, rotation, starts)
    known = _tried(hand, position, rotation, _known_wrists(hand, rotation))
    best = even.best().or_better(known.best())
    for fits_limits in (False, True):
        at_ends = _best_at_ends(hand, position, rotation, even, grid, fits_limits)
        best = best.or_better(at_ends)

    wrists = grid[_local_minima(even.cost)]
    for _ in range(_ROUNDS):
        around = np.clip(wrists[..., None] + step * _AROUND, lower, upper)
        tried = _tried(hand, position, rotation, around.reshape(len(around), 4, -1))
        best = best.or_better(tried.best())
        least = tried.cost.reshape(around.shape).argmin(axis=-1)
        wrists = np.take_along_axis(around, least[..., None], axis=-1)[..., 0]
        step /= _SHRINK
    return best


def _best_at_ends(
    hand: Hand,
    position: FloatArray,
    rotation: FloatArray,
    even: _Found,
    grid: FloatArray,
    fits_limits: bool,
) -> _Found:
    """The best solution where a branch ends, or where it meets a limit.

    Args:
        hand: Of the arm.
        position, rotation: Of N poses.
        even: What was found at the starts, (N, 4, `_STARTS`).
        grid: The starts, (`_STARTS`,) [rad].
        fits_limits: Where the branch meets a limit.
    """

    def fitting(found: _Found) -> BoolArray:
        return found.exists & found.within_limits if fits_limits else found.exists

    fits = fitting(even)
    differs = fits[..., 1:] != fits[..., :-1]
    first = np.argsort(~differs, axis=-1, kind="stable")[..., :_ENDS]
    first_fits = np.take_along_axis(fits, first, axis=-1)
    inside = np.where(first_fits, grid[first], grid[first + 1])
    outside = np.where(first_fits, grid[first + 1], grid[first])

    best = _tried(hand, position, rotation, inside).best()
    for _ in range(_HALVINGS):
        middle = (inside + outside) / 2
        tried = _tried(hand, position, rotation, middle)
        best = best.or_better(tried.best())
        inside = np.where(fitting(tried), middle, inside)
        outside = np.where(fitting(tried), outside, middle)
    return best


def _tried(
    hand: Hand, position: FloatArray, rotation: FloatArray, wrists: FloatArray
) -> _Found:
    """Solutions of each branch of N poses at its wrist angles (N, 4, W)."""

    def of_own_branch(array: NDArray[Any]) -> NDArray[Any]:
        """The entries (N, 4, W, ...) of branch i at the wrist angles of branch i."""
        return array[:, _BRANCHES, :, _BRANCHES].swapaxes(0, 1)

    targets = np.broadcast_to(position[:, None, None], (*wrists.shape, 3))
    solved = solve(hand.geometry, targets, wrists)
    exists = of_own_branch(solved.exists)
    middle = np.array(hand.geometry.middle)
    q = np.where(exists[..., None], of_own_branch(solved.q), middle)
    turns = rotation[:, None, None]
    error = hand.rotation_error(q, turns)

    free = on_axis(position)
    if free.any():
        best, least = q[free], error[free]
        for theta_0 in hand.yaws_with_wrist(best, turns[free]):
            trial = best.copy()
            trial[..., 0] = theta_0
            missed = hand.rotation_error(trial, turns[free])
            better = missed < least
            best = np.where(better[..., None], trial, best)
            least = np.where(better, missed, least)
        q[free], error[free] = best, least

    above = np.maximum(q - np.array(hand.geometry.upper), 0.0)
    below = np.maximum(np.array(hand.geometry.lower) - q, 0.0)
    return _Found(
        q=q,
        exists=exists,
        within_limits=of_own_branch(solved.within_limits),
        singular=solved.singular,
        error=error,
        beyond=(above + below).sum(axis=-1),
    )


def _known_wrists(hand: Hand, rotation: FloatArray) -> FloatArray:
    """Wrist angles that the target itself names, within the limits, (N, 4, 4)."""
    geometry = hand.geometry
    by_rotation = hand.wrist_of_rotation(rotation)
    # w is 0 there: the tool point reaches the yaw axis.
    on_yaw_axis = math.atan2(-geometry.y, geometry.x) - geometry.wrist_offset
    by_position = np.full_like(by_rotation, on_yaw_axis)
    angles = np.stack([by_rotation, by_position], axis=-1)
    both = np.concatenate([angles, angles + math.pi], axis=-1)
    turned = wrap(both, geometry.middle[3])
    within = np.clip(turned, geometry.lower[3], geometry.upper[3])
    return np.repeat(within[:, None], 4, axis=1)


def _local_minima(cost: FloatArray) -> NDArray[np.intp]:
    """Indices of the least local minima of each branch, (N, 4, `_FOLLOWED`).

    Args:
        cost: At even steps, (N, 4, `_STARTS`).
    """
    beside = np.pad(cost, [(0, 0), (0, 0), (1, 1)], constant_values=np.inf)
    is_minimum = (cost <= beside[..., :-2]) & (cost <= beside[..., 2:])
    ranked = np.where(is_minimum, cost, cost + 2 * _MISSING)
    order: NDArray[np.intp] = ranked.argsort(axis=-1, kind="stable")
    return order[..., :_FOLLOWED]
