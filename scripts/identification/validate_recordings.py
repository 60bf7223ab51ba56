"""Compare where the model has the arm's weight with recordings of a real arm.

    python scripts/identification/validate_recordings.py FOLDER
        [--fit FOLDER] [--plot PAGE.png] [--json]

FOLDER holds pairs ``NAME_joint_states.csv`` (joint positions) and ``NAME_mocap.csv``
(attitude of the vehicle, quaternion ``x_ori y_ori z_ori w_ori``, same clock), as
published with arXiv 2209.13577 (repository hkolano/UVMS-SysID-with-EAs, MIT licence).

A vehicle that floats freely tilts until the water's restoring moment balances the
static moment of the arm's weight minus buoyancy, so tilt = moment / stiffness, with one
stiffness for pitch and one for roll over all recordings:

- moment: `Arm.base_wrench` at rest of the moving links in fresh water, about the axes
  of base_link, which are parallel to the vehicle's (z up). It is linear in gravity:
  computed for gravity along each axis, then combined with gravity as the tilted vehicle
  sees it, from the quaternions;
- both signals averaged over 1.5 s, the moment earlier by the vehicle's lag, one for all
  recordings;
- the mean of each recording is taken off both: trim and ballast are not known.

Recordings are taken as they come: what is left out, sample by sample or whole, goes by
`RULES`, the same for all files, none of which looks at a moment or a score; the output
says for each recording what was left out by which rule.

``in moving water`` adds what the arm's own motion takes of added mass and drag in still
water (estimated), which is small beside the weight.

R^2 is of recordings that neither stiffnesses nor lag were fitted to, by least squares:
the trajectories (``traj003`` of ``traj003-0`` and ``traj003-0-test``) are halved by
turns in the order of names, each half is scored with what was fitted on the other. With
``--fit`` everything is fitted on that folder and FOLDER is only scored. The length of
the average and the rules are fixed above.

Controls go through the same procedure with their own stiffnesses: the wrist's COM on
the wrong side of its frame and products of inertia with SolidWorks' sign (a static
moment knows of the COM only); no buoyancy; buoyancy at the COM; gravity level, the
attitude ignored. A free stiffness absorbs any factor, so a control that leaves the
moment's course alone cannot lose here; `course` says how alike the moments are
(correlation with those of the model).
"""

from __future__ import annotations

import argparse
import csv
import json
import re
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import alpha5_model as a5
from alpha5_model._support.checks import FloatArray
from alpha5_model._support.files import STDOUT, read_named
from alpha5_model._support.outputs import check_outputs
from alpha5_model._support.writing import atomic_write
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import (
    Alpha5Error,
    FileFormatError,
    MissingFileError,
    OutputError,
)
from alpha5_model.numbers.hydrodynamics import LEVELS
from alpha5_model.numbers.inertia import flip_products
from alpha5_model.trajectory import Motion, motion, smooth
from alpha5_model.viewer.figures import FORMATS
from alpha5_model.water.terms import water_terms

#: Length of the average, and step of the times that are compared [s].
AVERAGE = 1.5
STEP = 0.05
#: Lags of the vehicle that are tried [s].
LAGS = np.arange(0.0, 1.001, 0.05)
#: A joint moves if its angle changes by so much [rad].
MOVES = 0.1
#: Largest deviation of a quaternion's length from 1.
NORM = 0.01
#: A tracking jump is a turn beyond an angle [rad] plus a speed [rad/s].
JUMP = np.radians(5)
TURN = np.radians(60)
#: Shortest piece between jumps, longest gap, shortest recording [s].
RUN = 1.0
GAP = 0.5
LEAST = 5.0
#: Largest angle between the verticals of a piece and of the longest one [rad].
APART = np.radians(20)
#: Rule -> what it leaves out; the same for every file.
RULES = {
    "cells": "rows in which the time, a joint position or a part of the quaternion "
    "is empty or no number",
    "norm": f"rows whose quaternion's length is not 1 within {NORM:g}",
    "order": "rows whose time is not later than that of the row before",
    "jump": "tracking jumps: where the vertical turns by more than "
    f"{np.degrees(JUMP):g} degrees plus {np.degrees(TURN):g} degrees/s between two "
    f"rows the recording is cut; pieces shorter than {RUN:g} s, and those more than "
    f"{np.degrees(APART):g} degrees from the longest on the average, are left out",
    "gap": f"times whose {AVERAGE:g} s of average hold {GAP:g} s or more without a row",
    "short": f"recordings of which less than {LEAST:g} s are left",
    "rest": f"recordings in which no joint moves by {MOVES:g} rad",
    "file": "recordings of which a file or a column is missing or cannot be read",
}
#: Of moments about x and y.
AXES = ("roll", "pitch")
GRAVITY = 9.81
#: The model with added mass and drag of the arm's motion, estimated.
MOVING = "in moving water"
JOINTS = ("axis_e_pos", "axis_d_pos", "axis_c_pos", "axis_b_pos")
QUATERNION = ("x_ori", "y_ori", "z_ori", "w_ori")
SUFFIXES = ("_joint_states.csv", "_mocap.csv")


@dataclass(frozen=True, eq=False)
class Recording:
    """A moving arm on a floating vehicle.

    Attributes:
        name: Common part of the file names.
        motion: Joint motion.
        time: (N,) of the motion capture [s].
        tilt: Roll and pitch of the vehicle, (N, 2) [rad].
        gravity: Gravity in the vehicle's axes, (N, 3) [m/s^2].
        grid: Times to compare at, (M,) [s].
    """

    name: str
    motion: Motion
    time: FloatArray
    tilt: FloatArray
    gravity: FloatArray
    grid: FloatArray


@dataclass
class Report:
    """What became of a recording.

    Attributes:
        name: Of the recording.
        left_out: Rule -> how many rows of which file, or seconds, or what is wrong with
            the whole.
        used: Whether anything is used.
        seconds: Time used, and time that both files cover [s].
    """

    name: str
    left_out: dict[str, str] = field(default_factory=dict)
    used: bool = False
    seconds: tuple[float, float] = (0.0, 0.0)

    def leave(self, rule: str, what: str) -> None:
        """Note what is left out by a rule."""
        assert rule in RULES
        before = self.left_out.get(rule)
        self.left_out[rule] = f"{before}, {what}" if before else what

    def __str__(self) -> str:
        notes = "; ".join(f"{rule}: {what}" for rule, what in self.left_out.items())
        used = "left out"
        if self.used:
            used = f"used {self.seconds[0]:.1f} of {self.seconds[1]:.1f} s"
        because = f"  ({notes})" if notes else ""
        return f"  {self.name:38}{used}{because}"


def read(folder: Path) -> tuple[list[Recording], list[str], list[Report]]:
    """The recordings of a folder.

    Returns:
        The recordings in which the arm moves, by name; the names of those in which it
        rests; all reports.
    """
    if not folder.is_dir():
        raise MissingFileError(folder, "a folder of recordings")
    names = set()
    for suffix in SUFFIXES:
        names |= {path.name.removesuffix(suffix) for path in folder.glob(f"*{suffix}")}

    reports = [Report(name) for name in sorted(names)]
    found = [_recording(folder, report) for report in reports]
    moving = [recording for recording in found if recording is not None]
    resting = [report.name for report in reports if "rest" in report.left_out]
    return moving, resting, reports


def _recording(folder: Path, report: Report) -> Recording | None:
    """One recording, or None with the reason in the report."""
    joints_file, vehicle_file = (folder / f"{report.name}{end}" for end in SUFFIXES)
    try:
        arm = _table(joints_file, JOINTS, report)
        vehicle = _table(vehicle_file, QUATERNION, report)
        moved = motion(arm[:, 0], arm[:, 1:])
    except Alpha5Error as error:
        report.leave("file", " ".join(str(error).replace(f"{folder}/", "").split()))
        return None
    if np.ptp(moved.position, axis=0).max() < MOVES:
        report.leave("rest", "all")
        return None

    time, up = _verticals(vehicle, report)
    grid = _grid(moved.time, time, report)
    if report.seconds[0] < LEAST:
        report.leave("short", f"{report.seconds[0]:.1f} s are left")
        return None
    report.used = True
    roll = np.arctan2(up[:, 1], up[:, 2])
    pitch = -np.arcsin(np.clip(up[:, 0], -1, 1))
    return Recording(
        name=report.name,
        motion=moved,
        time=time,
        tilt=np.stack([roll, pitch], axis=1),
        gravity=-GRAVITY * up,
        grid=grid,
    )


def _verticals(vehicle: FloatArray, report: Report) -> tuple[FloatArray, FloatArray]:
    """Times (N,), and world z in the vehicle's axes (N, 3), of the rows to be used.

    Args:
        vehicle: Time and quaternion, (M, 5).
        report: Notes the rows that are left out.
    """
    norm = np.linalg.norm(vehicle[:, 1:], axis=1)
    unit = np.abs(norm - 1) <= NORM
    if not unit.all():
        report.leave("norm", f"{np.count_nonzero(~unit)} rows")

    time = vehicle[unit, 0]
    x, y, z, w = (vehicle[unit, 1:] / norm[unit, None]).T
    # The last row of the rotation from the vehicle to the world.
    row = [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]
    up = np.stack(row, axis=1)
    tracked = _tracked(time, up)
    if not tracked.all():
        report.leave("jump", f"{np.count_nonzero(~tracked)} rows")
    return time[tracked], up[tracked]


def _table(path: Path, names: Sequence[str], report: Report) -> FloatArray:
    """Time and the named columns, (N, 1 + k): rows that are whole and in order."""
    try:
        text = read_named(path, "a CSV file of a recording").decode("utf-8-sig")
        header, *rows = csv.reader(text.splitlines())
    except (UnicodeDecodeError, csv.Error, ValueError) as error:
        raise FileFormatError(path, f"is no table of numbers: {error}") from None
    header = [name.strip() for name in header]
    for name in ("time_secs", *names):
        if name not in header:
            raise FileFormatError(path, f"no column {name!r}", "line 1")
    columns = [header.index(name) for name in ("time_secs", *names)]

    whole: list[list[float]] = []
    left_out = {"cells": 0, "order": 0}
    for row in filter(None, rows):
        numbers = _numbers(row, columns)
        if not np.isfinite(numbers).all():
            left_out["cells"] += 1
        elif whole and numbers[0] <= whole[-1][0]:
            left_out["order"] += 1
        else:
            whole.append(numbers)

    kind = path.name.removeprefix(f"{report.name}_").removesuffix(".csv")
    for rule, count in left_out.items():
        if count:
            report.leave(rule, f"{count} rows of {kind}")
    return np.array(whole).reshape(-1, len(columns))


def _numbers(row: Sequence[str], columns: Sequence[int]) -> list[float]:
    """Numbers in some columns of a row; NaN if one is no number or lacking."""
    try:
        return [float(row[column]) for column in columns]
    except (ValueError, IndexError):
        return [np.nan]


def _tracked(time: FloatArray, up: FloatArray) -> Any:
    """Whether rows are in pieces between tracking jumps that are to be used, (N,) bool.

    They are if the piece is long enough, and near the longest one.
    """
    if time.size < 2:
        return np.ones(time.size, dtype=bool)
    sine = np.linalg.norm(np.cross(up[1:], up[:-1]), axis=1)
    cosine = (up[1:] * up[:-1]).sum(axis=1)
    jumps = np.arctan2(sine, cosine) > JUMP + TURN * np.diff(time)
    piece = np.concatenate([[0], np.cumsum(jumps)])

    pieces = np.arange(piece[-1] + 1)
    first = np.searchsorted(piece, pieces, "left")
    end = np.searchsorted(piece, pieces, "right")
    duration = time[end - 1] - time[first]
    mean = np.stack([up[i:j].mean(axis=0) for i, j in zip(first, end, strict=True)])
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)

    is_near = mean @ mean[duration.argmax()] >= np.cos(APART)
    is_long = (duration >= RUN) | (duration == duration.max())
    return (is_near & is_long)[piece]


def _grid(arm: FloatArray, vehicle: FloatArray, report: Report) -> FloatArray:
    """Times whose averages, at any lag, meet no gap of either file."""
    if not vehicle.size:
        return np.empty(0)
    # The moment is averaged up to a lag earlier.
    reach = (
        (arm, AVERAGE / 2 + LAGS[-1], AVERAGE / 2),
        (vehicle, AVERAGE / 2, AVERAGE / 2),
    )
    start = max(times[0] + before for times, before, _ in reach)
    end = min(times[-1] - after for times, _, after in reach)
    grid = np.arange(start, end, STEP)
    whole = np.ones(grid.size, dtype=bool)
    for times, before, after in reach:
        for k in np.flatnonzero(np.diff(times) >= GAP):
            whole &= (grid + after <= times[k]) | (grid - before >= times[k + 1])
    if not whole.all():
        report.leave("gap", f"{np.count_nonzero(~whole) * STEP:.1f} s")
    common = min(arm[-1], vehicle[-1]) - max(arm[0], vehicle[0])
    report.seconds = (np.count_nonzero(whole) * STEP, max(common, 0.0))
    return grid[whole]


def moving_links(
    density: float = a5.FRESH_WATER,
    change_body: Callable[[int, Any], Any] | None = None,
    cob_at_com: bool = False,
) -> list[Arm]:
    """The arm without link_0, with gravity of 1 m/s^2 along x, y and z of base_link."""
    arms = []
    for axis in np.eye(3):
        arm = a5.load(fluid_density=density)
        model = arm.model.copy()
        model.gravity.linear = axis
        model.inertias[0] = pin.Inertia.Zero()
        displaced = [d for d in arm.displacements if d.joint != "universe"]
        for joint in range(1, model.njoints):
            if change_body is not None:
                model.inertias[joint] = change_body(joint, model.inertias[joint])
        if cob_at_com:
            displaced = [_with_cob_at_com(body, model) for body in displaced]
        arms.append(Arm(model, displaced, density))
    return arms


def _with_cob_at_com(displaced: Any, model: Any) -> Any:
    """A displaced body with its centre of buoyancy at the centre of mass."""
    inertia = model.inertias[model.getJointId(displaced.joint)]
    return replace(displaced, cob=np.array(inertia.lever))


def _wrong_body(joint: int, inertia: Any) -> Any:
    """A body with the printed signs of products, the wrist's COM on the wrong side."""
    com = np.array(inertia.lever)
    if joint == 4:
        com[2] = -com[2]
    return pin.Inertia(inertia.mass, com, flip_products(inertia.inertia))


def moments(
    arms: Sequence[Arm], recording: Recording, level: bool = False
) -> FloatArray:
    """Static moment of the moving links about x and y of base_link, (N, 2).

    Args:
        arms: See `moving_links`.
        recording: At whose motion's times the moment is computed.
        level: Ignore the vehicle's attitude.
    """
    motion = recording.motion
    gravity = interpolated(motion.time, recording.time, recording.gravity)
    if level:
        gravity = np.broadcast_to([0.0, 0.0, -GRAVITY], gravity.shape)
    q = motion.position[:, :4]
    rest = np.zeros((1, 4))
    per_axis = np.stack([arm.base_wrench_batch(q, rest, rest)[:, 3:5] for arm in arms])
    return np.asarray(np.einsum("nk,knj->nj", gravity, per_axis))


def moving_water(recording: Recording) -> FloatArray:
    """What added mass and drag add to the moment about x and y, (N, 2).

    The vehicle and the water are at rest.
    """
    motion = smooth(recording.motion)
    arm = a5.load(fluid_density=a5.FRESH_WATER)
    q = motion.position[:, :4]
    v = motion.velocity[:, :4]
    a = motion.acceleration[:, :4]
    terms = water_terms(arm, q, v, a, np.zeros(3))
    return np.asarray(terms.wrench[:, LEVELS.index("nominal"), 3:5])


def averaged(
    at: FloatArray, time: FloatArray, values: FloatArray, length: float
) -> FloatArray:
    """Moving average of values, (M, K); between two times it counts the mean of both.

    Before the first value and after the last one they stay as they are. A sum that ends
    there would be taken for a tilt if the mean is not 0.

    Args:
        at: Middles of the averages, (M,).
        time: Of the values, (N,).
        values: (N, K).
        length: Of the average.
    """
    beyond = length + np.ptp(np.concatenate([at, time]))
    time = np.concatenate([[time[0] - beyond], time, [time[-1] + beyond]])
    values = np.vstack([values[:1], values, values[-1:]])
    areas = (values[1:] + values[:-1]) / 2 * np.diff(time)[:, None]
    integral = np.vstack([np.zeros(values.shape[1]), np.cumsum(areas, axis=0)])
    low = interpolated(at - length / 2, time, integral)
    high = interpolated(at + length / 2, time, integral)
    return (high - low) / length


def interpolated(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Values (N, K) at other times, on straight lines, (M, K)."""
    return np.stack([np.interp(at, time, column) for column in values.T], axis=1)


def signals(recording: Recording, moment: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Averaged moment at each of `LAGS` (L, M, 2) and tilt (M, 2), without their means.

    Both are on the recording's grid.
    """
    r = recording
    lagging = [_average(r.grid - lag, r.motion.time, moment) for lag in LAGS]
    tilt = _average(r.grid, r.time, r.tilt)
    return _without_mean(np.stack(lagging)), _without_mean(tilt)


def _without_mean(signal: FloatArray) -> FloatArray:
    return np.asarray(signal - signal.mean(axis=-2, keepdims=True))


def _average(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Moving average over `AVERAGE` seconds."""
    return averaged(at, time, values, AVERAGE)


@dataclass(frozen=True, eq=False)
class Score:
    """How much of the tilt a model explains.

    Attributes:
        r2: Of roll and pitch over all held-out samples, (2,).
        recordings: The same for each recording, (M, 2).
        stiffness: From each fit, for roll and pitch, (F, 2) [N m/rad].
        lag: From each fit, (F,) [s].
        predicted: Held-out tilt of each recording, (N, 2) [rad].
    """

    r2: FloatArray
    recordings: FloatArray
    stiffness: FloatArray
    lag: FloatArray
    predicted: list[FloatArray]


#: Moment at each lag, and tilt; see `signals`.
Pair = tuple[FloatArray, FloatArray]


def fit(pairs: Sequence[Pair]) -> tuple[int, FloatArray]:
    """Index of the lag, and the compliances (2,) [rad/(N m)]: best by least squares."""
    tilted = sum((m * a).sum(axis=1) for m, a in pairs)  # (L, 2)
    square = sum((m * m).sum(axis=1) for m, _ in pairs)
    best = int(np.argmax((tilted**2 / square).sum(axis=1)))
    return best, tilted[best] / square[best]


def score(
    pairs: Sequence[Pair], fits: Sequence[Sequence[Pair]], of: Sequence[int]
) -> Score:
    """Score each pair with what was fitted on ``fits[of[k]]``."""
    fitted = [fit(group) for group in fits]
    predicted = []
    left = []
    for (moment, tilt), k in zip(pairs, of, strict=True):
        lag, compliance = fitted[k]
        prediction = moment[lag] * compliance
        predicted.append(prediction)
        left.append(((tilt - prediction) ** 2).sum(axis=0))

    unexplained = np.array(left)
    total = np.array([(tilt**2).sum(axis=0) for _, tilt in pairs])
    return Score(
        r2=1 - unexplained.sum(axis=0) / total.sum(axis=0),
        recordings=1 - unexplained / total,
        stiffness=np.array([1 / compliance for _, compliance in fitted]),
        lag=LAGS[[lag for lag, _ in fitted]],
        predicted=predicted,
    )


@dataclass(frozen=True, eq=False)
class Model:
    """A model of the arm: the right one, or a control.

    Attributes:
        arms: See `moving_links`.
        level: Ignore the vehicle's attitude.
        in_moving_water: Add what the motion takes of added mass and drag.
    """

    arms: list[Arm]
    level: bool = False
    in_moving_water: bool = False

    def pair(self, recording: Recording) -> Pair:
        """The signals of a recording."""
        moment = moments(self.arms, recording, self.level)
        if self.in_moving_water:
            moment = moment + moving_water(recording)
        return signals(recording, moment)


def _models() -> dict[str, Model]:
    """The model and its controls."""
    return {
        "model": Model(moving_links()),
        MOVING: Model(moving_links(), in_moving_water=True),
        "COM and products wrong": Model(moving_links(change_body=_wrong_body)),
        "no buoyancy": Model(moving_links(density=a5.AIR)),
        "buoyancy at the COM": Model(moving_links(cob_at_com=True)),
        "attitude ignored": Model(moving_links(), level=True),
    }


def validate(folder: Path, fit_folder: Path | None = None) -> dict[str, Any]:
    """Score the model and its controls on a folder of recordings.

    Returns:
        The figures, and what a plot needs.
    """
    recordings, resting, reports = read(folder)
    trajectories = [re.sub(r"-\d.*$", "", r.name) for r in recordings]
    order = sorted(set(trajectories))
    halves = [order.index(trajectory) % 2 for trajectory in trajectories]
    others = recordings if fit_folder is None else read(fit_folder)[0]
    _enough(folder, order, reports, 1 if fit_folder else 2)
    _enough(fit_folder or folder, others, [], 1)

    series: dict[str, list[Pair]] = {}
    scores = {}
    course = {}
    for name, model in _models().items():
        pairs = [model.pair(recording) for recording in recordings]
        series[name] = pairs
        if fit_folder is None:
            scores[name] = _score_of_halves(pairs, halves)
        else:
            theirs = [model.pair(recording) for recording in others]
            scores[name] = score(pairs, [theirs], [0] * len(recordings))
        course[name] = _correlation(series["model"], pairs)
    return {
        "recordings": [r.name for r in recordings],
        "resting": resting,
        "reports": reports,
        "fitted_on": None if fit_folder is None else [r.name for r in others],
        "scores": scores,
        "course": course,
        "series": [
            (r.grid, tilt)
            for r, (_, tilt) in zip(recordings, series["model"], strict=True)
        ],
    }


def _score_of_halves(pairs: Sequence[Pair], halves: Sequence[int]) -> Score:
    """Score each half of the pairs with what was fitted on the other half."""
    fits = []
    for side in (0, 1):
        other = [pair for pair, half in zip(pairs, halves, strict=True) if half != side]
        fits.append(other)
    return score(pairs, fits, halves)


def _correlation(ours: Sequence[Pair], theirs: Sequence[Pair]) -> FloatArray:
    """Correlation of two models' moments without lag, roll and pitch, (2,)."""
    a = np.concatenate([moment[0] for moment, _ in ours])
    b = np.concatenate([moment[0] for moment, _ in theirs])
    squares = (a**2).sum(axis=0) * (b**2).sum(axis=0)
    return np.asarray((a * b).sum(axis=0) / np.sqrt(squares))


def _enough(
    folder: Path, found: Sequence[Any], reports: Sequence[Report], needed: int
) -> None:
    """Raise an error that says what was left out if too little was found."""
    if len(found) < needed:
        why = "; ".join(str(report).strip() for report in reports if not report.used)
        because = f" ({' '.join(why.split())})" if why else ""
        found_and_needed = (
            f"{len(found)} trajectories of a moving arm, at least {needed} needed"
        )
        raise FileFormatError(folder, found_and_needed + because)


def record(result: dict[str, Any]) -> dict[str, Any]:
    """The figures of `validate`, made of what JSON knows."""
    return {
        "recordings": result["recordings"],
        "resting": result["resting"],
        "fitted_on": result["fitted_on"],
        "rules": RULES,
        "files": {
            r.name: {"used": r.used, "seconds": list(r.seconds), "left_out": r.left_out}
            for r in result["reports"]
        },
        "models": {
            name: _record_of_model(score, result["course"][name])
            for name, score in result["scores"].items()
        },
    }


def _record_of_model(score: Score, course: FloatArray) -> dict[str, Any]:
    """The figures of a model, for roll and pitch."""
    return {
        axis: {
            "r2": float(score.r2[k]),
            "r2_of_recordings": score.recordings[:, k].tolist(),
            "stiffness_nm_per_rad": score.stiffness[:, k].tolist(),
            "lag_s": score.lag.tolist(),
            "course": float(course[k]),
        }
        for k, axis in enumerate(AXES)
    }


def text(result: dict[str, Any]) -> str:
    """The figures of `validate` as a table."""
    lines = [_summary(result), *map(str, result["reports"])]
    rules = set()
    for report in result["reports"]:
        rules |= {*report.left_out}
    lines += [f"  {rule}: {words}" for rule, words in RULES.items() if rule in rules]

    lines += ["", *_HEADS]
    for name, one in result["scores"].items():
        lines.append(_row(name, one, result["course"][name]))

    lines += ["", f"{'held-out R^2 of the model':40}{'roll':>8}{'pitch':>8}"]
    r2 = result["scores"]["model"].recordings
    for name, (roll, pitch) in zip(result["recordings"], r2, strict=True):
        lines.append(f"  {name:38}{roll:8.3f}{pitch:8.3f}")
    return "\n".join(lines)


def _summary(result: dict[str, Any]) -> str:
    """The first line: how many recordings are used, and what is fitted on which."""
    fitted = result["fitted_on"]
    by = "the other half"
    if fitted is not None:
        by = f"{len(fitted)} recordings of another folder"
    return (
        f"{len(result['recordings'])} of {len(result['reports'])} recordings used; "
        f"stiffnesses and lag fitted on {by}"
    )


#: Heads of the columns of `_row`.
_HEADS = (
    f"{'':24}{'held-out R^2':>16}   {'stiffness [Nm/rad]':>34}   {'lag [s]':>10}   "
    f"{'course':>14}",
    f"{'':24}{'roll':>8}{'pitch':>8}   {'roll':>17}{'pitch':>17}   {'':>10}   "
    f"{'roll':>7}{'pitch':>7}",
)


def _row(name: str, score: Score, course: FloatArray) -> str:
    """The line of a model."""
    roll, pitch = (_two_decimals(score.stiffness[:, k]) for k in (0, 1))
    return (
        f"{name:24}{score.r2[0]:8.3f}{score.r2[1]:8.3f}   {roll:>17}{pitch:>17}   "
        f"{_two_decimals(score.lag):>10}   {course[0]:7.3f}{course[1]:7.3f}"
    )


def _two_decimals(values: FloatArray) -> str:
    return ", ".join(f"{value:.2f}" for value in values)


def plot(result: dict[str, Any], path: Path) -> None:
    """Draw measured and predicted tilt of up to six recordings, and all scores."""
    from alpha5_model.viewer.figures import new_figure, write_figure

    names = result["recordings"]
    evenly = np.linspace(0, len(names) - 1, min(6, len(names)))
    shown = np.unique(evenly.round().astype(int))
    page = new_figure(15, 2.3 * len(shown) + 3.4)
    heights = [1.0] * len(shown) + [1.35]
    grid = page.add_gridspec(len(shown) + 1, 2, height_ratios=heights)
    for row, index in enumerate(shown):
        for column, axis in ((0, 1), (1, 0)):  # pitch left, roll right
            axes = page.add_subplot(grid[row, column])
            _draw_tilt(axes, result, index, axis)
            if row == 0:
                place = "best" if column else "lower left"
                axes.legend(_CURVES, fontsize=8, frameon=False, loc=place)
            if row == len(shown) - 1:
                axes.set_xlabel("time [s]")

    _draw_scores(page.add_subplot(grid[-1, :]), result["scores"])
    for axes in page.axes:
        axes.grid(color="#E6E6E6", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    page.suptitle(
        "Tilt of the vehicle explained by the arm's static moment "
        f"({len(names)} recordings)",
        fontsize=13,
    )
    write_figure(page, path, dpi=100)


_CURVES = (
    "measured by motion capture",
    "model, fitted on other recordings",
    "the wrist's COM on the wrong side",
)


def _draw_tilt(axes: Any, result: dict[str, Any], index: int, axis: int) -> None:
    """Draw the measured and the predicted tilt of a recording about an axis."""
    time, tilt = result["series"][index]
    model = result["scores"]["model"]
    predicted = np.degrees(model.predicted[index][:, axis])
    wrong = result["scores"]["COM and products wrong"].predicted[index]

    axes.plot(time, np.degrees(tilt[:, axis]), color="#222222", linewidth=1.6)
    axes.plot(time, predicted, color="#D55E00", linewidth=1.6)
    axes.plot(
        time, np.degrees(wrong[:, axis]), color="#999999", linewidth=1, linestyle="--"
    )
    name = result["recordings"][index]
    r2 = model.recordings[index, axis]
    axes.set_title(f"{name}   R² = {r2:.3f}", loc="left", fontsize=10)
    axes.set_ylabel(f"{AXES[axis]} [°]")
    axes.margins(x=0.01)


def _draw_scores(axes: Any, scores: dict[str, Score]) -> None:
    """Draw R^2 of all models as bars."""
    place = np.arange(len(scores))
    for k, (axis, colour) in enumerate(((1, "#0072B2"), (0, "#E69F00"))):
        values = np.array([score.r2[axis] for score in scores.values()])
        bars = axes.bar(
            place + 0.4 * k - 0.2,
            np.maximum(values, 0),
            0.36,
            color=colour,
            label=AXES[axis],
        )
        axes.bar_label(bars, [f"{v:.3f}" for v in values], fontsize=9, padding=2)
    axes.set_xticks(place, list(scores))
    axes.set_ylim(0, 1.25)
    axes.set_yticks([0, 0.25, 0.5, 0.75, 1.0])
    axes.set_ylabel("held-out R² (bars end at 0)")
    axes.legend(fontsize=9, frameon=False, ncols=2, loc="upper right")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the script; 2 with one line on stderr if a folder cannot be used, else 0."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--fit", type=Path, metavar="FOLDER", help="fit on these recordings"
    )
    parser.add_argument("--plot", type=Path, help="page of curves, .png, .pdf or .svg")
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    try:
        inputs = [*_csv_files(options.folder), *_csv_files(options.fit)]
        check_outputs(inputs, plot=(options.plot, FORMATS))
        result = validate(options.folder, options.fit)
        if options.plot:
            plot(result, options.plot)
        said = json.dumps(record(result), indent=2) if options.json else text(result)
        atomic_write(STDOUT, said + "\n")
    except OutputError as error:
        # The reader has left, as `head` does.
        if isinstance(error.__context__, BrokenPipeError):
            return 0
        print(f"validate_recordings: {error}", file=sys.stderr)
        return 2
    except Alpha5Error as error:
        print(f"validate_recordings: {error}", file=sys.stderr)
        return 2
    return 0


def _csv_files(folder: Path | None) -> list[Path]:
    return [] if folder is None or not folder.is_dir() else list(folder.glob("*.csv"))


if __name__ == "__main__":
    sys.exit(main())
