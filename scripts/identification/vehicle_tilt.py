"""Stiffness, delay and turn of a floating vehicle that tilts by the moment of its arm.

    python scripts/identification/vehicle_tilt.py FOLDER [--predict FOLDER]

FOLDERs hold recordings as of `validate_recordings.py`, which are read, left out and
averaged by its rules. The arm's axes, or those of the motion capture, may be turned by
a yaw about the vehicle's z: roll and pitch then mix. Yaw and the compliances of roll
and pitch are fitted by least squares at each delay; the best delay is taken.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.optimize import least_squares

from alpha5_model.errors import Alpha5Error, FileFormatError

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from identification import validate_recordings as recordings

#: The yaw also turns gravity as the arm sees it: passes that settle both.
PASSES = 3
#: The moment is turned from these angles on [rad].
STARTS = np.radians([0.0, 90.0, 180.0, 270.0])


class Tilt(NamedTuple):
    """How a vehicle answers to the moment of its arm.

    Attributes:
        yaw: Of the arm about the vehicle's z [rad].
        stiffness: For roll and pitch, (2,) [N m/rad].
        lag: Index of the delay in `validate_recordings.LAGS`.
    """

    yaw: float
    stiffness: np.ndarray
    lag: int


def plane_rotation(angle: float) -> np.ndarray:
    """Rotation of a vector in the plane, (2, 2)."""
    cosine = np.cos(angle)
    sine = np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def signals(
    recording: recordings.Recording, yaw: float
) -> tuple[np.ndarray, np.ndarray]:
    """Averaged moment about the vehicle's x and y at each delay, and tilt."""
    turn = plane_rotation(yaw)
    gravity = recording.gravity.copy()
    gravity[:, :2] = gravity[:, :2] @ turn
    seen = replace(recording, gravity=gravity)
    moment = recordings.moments(recordings.moving_links(), seen) @ turn.T
    return recordings.signals(recording, moment)


def fit(read: Sequence[recordings.Recording]) -> Tilt:
    """The best yaw, stiffnesses and delay.

    Raises:
        FileFormatError: No recordings.
    """
    if not read:
        raise FileFormatError("recordings", "no recording of a moving arm")
    yaw = 0.0
    for _ in range(PASSES):
        pairs = [signals(one, yaw) for one in read]
        moment = np.concatenate([both[0] for both in pairs], axis=1)
        tilt = np.concatenate([both[1] for both in pairs])
        tried = [_at_delay(one, tilt) for one in moment]
        lag = int(np.argmin([found.cost for found in tried]))
        step, *compliance = tried[lag].x
        yaw += float(step)
    yaw = float(np.remainder(yaw + np.pi, 2 * np.pi) - np.pi)
    return Tilt(yaw=yaw, stiffness=1.0 / np.array(compliance), lag=lag)


def _at_delay(moment: np.ndarray, tilt: np.ndarray) -> least_squares:
    """Least squares for yaw and compliances at one delay."""

    def left(unknowns: np.ndarray) -> np.ndarray:
        turned = moment @ plane_rotation(unknowns[0]).T
        return np.ravel(tilt - turned * unknowns[1:])

    size = np.linalg.norm(tilt, axis=0) / np.linalg.norm(moment, axis=0)
    scale = [1.0, *size]
    fits = [least_squares(left, [yaw, *size], x_scale=scale) for yaw in STARTS]
    # A vehicle yields to the moment, it does not go against it.
    right = [one for one in fits if min(one.x[1:]) >= 0]
    return min(right or fits, key=lambda one: one.cost)


def score(found: Tilt, read: Sequence[recordings.Recording]) -> np.ndarray:
    """Share of the variance of roll and pitch that is explained, (2,)."""
    left = np.zeros(2)
    total = np.zeros(2)
    for one in read:
        moment, tilt = signals(one, found.yaw)
        left += ((tilt - moment[found.lag] / found.stiffness) ** 2).sum(axis=0)
        total += (tilt**2).sum(axis=0)
    return np.asarray(1 - left / total)


def main(arguments: list[str] | None = None) -> int:
    """Run the script; 2 with one line on stderr if a folder cannot be used, else 0."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--predict", type=Path, metavar="FOLDER")
    options = parser.parse_args(arguments)
    try:
        read, _, _ = recordings.read(options.folder)
        found = fit(read)
        others = read
        if options.predict:
            others, _, _ = recordings.read(options.predict)
    except Alpha5Error as error:
        print(f"vehicle_tilt: {error}", file=sys.stderr)
        return 2
    roll, pitch = found.stiffness
    print(
        f"{len(read)} recordings: yaw {np.degrees(found.yaw):.2f} deg, stiffness "
        f"{roll:.3f} and {pitch:.3f} N m/rad, delay {recordings.LAGS[found.lag]:.2f} s"
    )
    roll, pitch = score(found, others)
    print(f"R^2 over {len(others)} recordings: roll {roll:.4f}, pitch {pitch:.4f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
