"""Does the model know where the arm's weight is? Recordings of a real arm on a floating vehicle answer.

    python scripts/recordings/validate_recordings.py FOLDER [--fit FOLDER] [--plot PAGE.png] [--json]

FOLDER holds pairs ``NAME_joint_states.csv`` (joint positions) and ``NAME_mocap.csv`` (attitude of the vehicle,
quaternion ``x_ori y_ori z_ori w_ori``, same clock), as published with arXiv 2209.13577 (repository
hkolano/UVMS-SysID-with-EAs, MIT licence).

A vehicle that floats freely tilts until the water's restoring moment balances the static moment of the
arm's weight minus buoyancy, so tilt = moment / stiffness, with one stiffness for pitch and one for roll
over all recordings:

- moment: `Arm.base_wrench` at rest of the moving links in fresh water, about the axes of base_link, which
  are parallel to the vehicle's (z up). It is linear in gravity: computed for gravity along each axis, then
  combined with gravity as the tilted vehicle sees it, from the quaternions;
- both signals averaged over 1.5 s, the moment earlier by the vehicle's lag, one for all recordings;
- the mean of each recording is taken off both: trim and ballast are not known.

Recordings are taken as they come: what is left out, sample by sample or whole, goes by `RULES`, the same
for all files, none of which looks at a moment or a score; the output says for each recording what was
left out by which rule.

``in moving water`` adds what the arm's own motion takes of added mass and drag in still water (estimated), which is
small beside the weight.

R^2 is of recordings that neither stiffnesses nor lag were fitted to, by least squares: the trajectories
(``traj003`` of ``traj003-0`` and ``traj003-0-test``) are halved by turns in the order of names, each half is
scored with what was fitted on the other. With ``--fit`` everything is fitted on that folder and FOLDER is only
scored. The length of the average and the rules are fixed above.

Controls go through the same procedure with their own stiffnesses: the wrist's COM on the wrong side of its
frame and products of inertia with SolidWorks' sign (a static moment knows of the COM only); no buoyancy;
buoyancy at the COM; gravity level, the attitude ignored. A free stiffness absorbs any factor, so a control that
leaves the moment's course alone cannot lose here; `course` says how alike the moments are (correlation with
those of the model).
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

AVERAGE, STEP = 1.5, 0.05  # [s]
LAGS = np.arange(0.0, 1.001, 0.05)  # [s]
MOVES = 0.1  # [rad]
NORM = 0.01
JUMP, TURN = np.radians(5), np.radians(60)  # [rad], [rad/s]
RUN, GAP, LEAST = 1.0, 0.5, 5.0  # [s]
APART = np.radians(20)
#: Why samples, times or recordings are left out; the same for every file.
RULES = {
    "cells": "rows in which the time, a joint position or a part of the quaternion is empty or no number",
    "norm": f"rows whose quaternion's length is not 1 within {NORM:g}",
    "order": "rows whose time is not later than that of the row before",
    "jump": f"tracking jumps: where the vertical turns by more than {np.degrees(JUMP):g} degrees plus "
    f"{np.degrees(TURN):g} degrees/s between two rows the recording is cut; pieces shorter than {RUN:g} s, and "
    f"those more than {np.degrees(APART):g} degrees from the longest on the average, are left out",
    "gap": f"times whose {AVERAGE:g} s of average hold {GAP:g} s or more without a row",
    "short": f"recordings of which less than {LEAST:g} s are left",
    "rest": f"recordings in which no joint moves by {MOVES:g} rad",
    "file": "recordings of which a file or a column is missing or cannot be read",
}
AXES = ("roll", "pitch")  # moments about x and y
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
        left_out: Rule -> how many rows of which file, or seconds, or what is wrong with the whole.
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
        self.left_out[rule] = ", ".join(filter(None, (self.left_out.get(rule), what)))

    def __str__(self) -> str:
        notes = "; ".join(f"{rule}: {what}" for rule, what in self.left_out.items())
        used = (
            f"used {self.seconds[0]:.1f} of {self.seconds[1]:.1f} s"
            if self.used
            else "left out"
        )
        return f"  {self.name:38}{used}" + (f"  ({notes})" if notes else "")


def read(folder: Path) -> tuple[list[Recording], list[str], list[Report]]:
    """The recordings in which the arm moves, by name; the names of those in which it rests; all reports."""
    if not folder.is_dir():
        raise MissingFileError(folder, "a folder of recordings")
    names = {
        path.name.removesuffix(suffix)
        for suffix in SUFFIXES
        for path in folder.glob(f"*{suffix}")
    }
    reports = [Report(name) for name in sorted(names)]
    moving = [r for report in reports if (r := _recording(folder, report)) is not None]
    return (
        moving,
        [report.name for report in reports if "rest" in report.left_out],
        reports,
    )


def _recording(folder: Path, report: Report) -> Recording | None:
    """One recording, or None with the reason in the report."""
    try:
        arm, vehicle = (
            _table(folder / f"{report.name}{suffix}", columns, report)
            for suffix, columns in zip(SUFFIXES, (JOINTS, QUATERNION), strict=True)
        )
        moved = motion(arm[:, 0], arm[:, 1:])
    except Alpha5Error as error:
        report.leave("file", " ".join(str(error).replace(f"{folder}/", "").split()))
        return None
    if np.ptp(moved.position, axis=0).max() < MOVES:
        report.leave("rest", "all")
        return None
    norm = np.linalg.norm(vehicle[:, 1:], axis=1)
    unit = np.abs(norm - 1) <= NORM
    if not unit.all():
        report.leave("norm", f"{np.count_nonzero(~unit)} rows")
    time, (x, y, z, w) = vehicle[unit, 0], (vehicle[unit, 1:] / norm[unit, None]).T
    # Rows of the rotation vehicle -> world: the last one is world z in the vehicle's axes.
    up = np.stack(
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1
    )
    tracked = _tracked(time, up)
    if not tracked.all():
        report.leave("jump", f"{np.count_nonzero(~tracked)} rows")
    time, up = time[tracked], up[tracked]
    grid = _grid(moved.time, time, report)
    if report.seconds[0] < LEAST:
        report.leave("short", f"{report.seconds[0]:.1f} s are left")
        return None
    report.used = True
    tilt = np.stack(
        [np.arctan2(up[:, 1], up[:, 2]), -np.arcsin(np.clip(up[:, 0], -1, 1))], axis=1
    )
    return Recording(report.name, moved, time, tilt, -GRAVITY * up, grid)


def _table(path: Path, names: Sequence[str], report: Report) -> FloatArray:
    """Time and the named columns of the rows that are whole and in order, (N, 1 + k)."""
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
    whole, cells, order = [], 0, 0
    for row in filter(None, rows):
        try:
            numbers = [float(row[column]) for column in columns]
        except (ValueError, IndexError):
            numbers = [np.nan]
        if not np.isfinite(numbers).all():
            cells += 1
        elif whole and numbers[0] <= whole[-1][0]:
            order += 1
        else:
            whole.append(numbers)
    kind = path.name.removeprefix(f"{report.name}_").removesuffix(".csv")
    for rule, count in (("cells", cells), ("order", order)):
        if count:
            report.leave(rule, f"{count} rows of {kind}")
    return np.array(whole).reshape(-1, len(columns))


def _tracked(time: FloatArray, up: FloatArray) -> Any:
    """Rows that no tracking jump parts from the longest stretch of the recording, (N,) bool."""
    if time.size < 2:
        return np.ones(time.size, dtype=bool)
    turn = np.arctan2(
        np.linalg.norm(np.cross(up[1:], up[:-1]), axis=1),
        (up[1:] * up[:-1]).sum(axis=1),
    )
    run = np.concatenate([[0], np.cumsum(turn > JUMP + TURN * np.diff(time))])
    first, last = (
        np.searchsorted(run, np.arange(run[-1] + 1), side) for side in ("left", "right")
    )
    lasts = time[last - 1] - time[first]
    mean = np.stack([up[i:j].mean(axis=0) for i, j in zip(first, last, strict=True)])
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    near = mean @ mean[lasts.argmax()] >= np.cos(APART)
    return (near & ((lasts >= RUN) | (lasts == lasts.max())))[run]


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
            displaced = [
                replace(
                    d, cob=np.array(model.inertias[model.getJointId(d.joint)].lever)
                )
                for d in displaced
            ]
        arms.append(Arm(model, displaced, density))
    return arms


def _wrong_body(joint: int, inertia: Any) -> Any:
    """Products of inertia as printed, not flipped; the wrist's COM on the other side of its frame."""
    com = np.array(inertia.lever)
    if joint == 4:
        com[2] = -com[2]
    return pin.Inertia(inertia.mass, com, flip_products(inertia.inertia))


def moments(
    arms: Sequence[Arm], recording: Recording, level: bool = False
) -> FloatArray:
    """Static moment of the moving links about x and y of base_link at the motion's times, (N, 2)."""
    motion = recording.motion
    gravity = _at(motion.time, recording.time, recording.gravity)
    if level:
        gravity = np.broadcast_to([0.0, 0.0, -GRAVITY], gravity.shape)
    q = motion.position[:, :4]
    rest = np.zeros((1, 4))
    per_axis = np.stack([arm.base_wrench_batch(q, rest, rest)[:, 3:5] for arm in arms])
    return np.asarray(np.einsum("nk,knj->nj", gravity, per_axis))


def moving_water(recording: Recording) -> FloatArray:
    """What added mass and drag add to the moment about x and y, the vehicle and the water at rest, (N, 2)."""
    motion = smooth(recording.motion)
    state = (x[:, :4] for x in (motion.position, motion.velocity, motion.acceleration))
    terms = water_terms(a5.load(fluid_density=a5.FRESH_WATER), *state, np.zeros(3))
    return np.asarray(terms.wrench[:, LEVELS.index("nominal"), 3:5])


def signals(recording: Recording, moment: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Averaged moment at each of `LAGS` (L, M, 2) and tilt (M, 2) on the grid, each without its mean."""
    r = recording
    pair = (
        np.stack([_average(r.grid - lag, r.motion.time, moment) for lag in LAGS]),
        _average(r.grid, r.time, r.tilt),
    )
    m, a = (signal - signal.mean(axis=-2, keepdims=True) for signal in pair)
    return m, a


def _average(at: FloatArray, time: FloatArray, values: FloatArray) -> FloatArray:
    """Moving average over `AVERAGE` seconds of the values joined by straight lines."""
    areas = (values[1:] + values[:-1]) / 2 * np.diff(time)[:, None]
    integral = np.vstack([np.zeros(values.shape[1]), np.cumsum(areas, axis=0)])
    edges = (_at(at + side * AVERAGE / 2, time, integral) for side in (-1, 1))
    low, high = edges
    return (high - low) / AVERAGE


def _at(new: FloatArray, old: FloatArray, values: FloatArray) -> FloatArray:
    return np.stack([np.interp(new, old, column) for column in values.T], axis=1)


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


def fit(pairs: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[int, FloatArray]:
    """Index of the lag, and the compliances (2,) [rad/(N m)], that leave the least of the tilt."""
    tilted = sum((m * a).sum(axis=1) for m, a in pairs)  # (L, 2)
    square = sum((m * m).sum(axis=1) for m, _ in pairs)
    best = int(np.argmax((tilted**2 / square).sum(axis=1)))
    return best, tilted[best] / square[best]


def score(
    pairs: Sequence[tuple[FloatArray, FloatArray]],
    fits: Sequence[Sequence[tuple[FloatArray, FloatArray]]],
    of: Sequence[int],
) -> Score:
    """Score (moment, tilt) pairs, each with what was fitted on ``fits[of[k]]``."""
    fitted = [fit(group) for group in fits]
    predicted = [
        m[fitted[k][0]] * fitted[k][1] for (m, _), k in zip(pairs, of, strict=True)
    ]
    left = np.array(
        [((a - p) ** 2).sum(axis=0) for (_, a), p in zip(pairs, predicted, strict=True)]
    )
    total = np.array([(a**2).sum(axis=0) for _, a in pairs])
    return Score(
        1 - left.sum(axis=0) / total.sum(axis=0),
        1 - left / total,
        np.array([1 / compliance for _, compliance in fitted]),
        LAGS[[lag for lag, _ in fitted]],
        predicted,
    )


def validate(folder: Path, fit_folder: Path | None = None) -> dict[str, Any]:
    """Score the model and its controls on a folder of recordings; also what a plot needs."""
    recordings, resting, reports = read(folder)
    trajectories = {r.name: re.sub(r"-\d.*$", "", r.name) for r in recordings}
    order = sorted(set(trajectories.values()))
    halves = [order.index(trajectories[r.name]) % 2 for r in recordings]
    others = recordings if fit_folder is None else read(fit_folder)[0]
    _enough(folder, order, reports, 1 if fit_folder else 2)
    _enough(fit_folder or folder, others, [], 1)
    models: dict[str, tuple[list[Arm], bool]] = {
        "model": (moving_links(), False),
        MOVING: (moving_links(), False),
        "COM and products wrong": (moving_links(change_body=_wrong_body), False),
        "no buoyancy": (moving_links(density=a5.AIR), False),
        "buoyancy at the COM": (moving_links(cob_at_com=True), False),
        "attitude ignored": (moving_links(), True),
    }
    series, scores, course = {}, {}, {}

    def pair(name: str, recording: Recording) -> tuple[FloatArray, FloatArray]:
        arms, level = models[name]
        moment = moments(arms, recording, level)
        return signals(
            recording, moment + (moving_water(recording) if name == MOVING else 0.0)
        )

    for name in models:
        series[name] = [pair(name, r) for r in recordings]
        if fit_folder is None:
            fits = [
                [
                    one
                    for one, half in zip(series[name], halves, strict=True)
                    if half != side
                ]
                for side in (0, 1)
            ]
            scores[name] = score(series[name], fits, halves)
        else:
            theirs = [pair(name, r) for r in others]
            scores[name] = score(series[name], [theirs], [0] * len(recordings))
        ours, alike = (
            np.concatenate([m[0] for m, _ in series[key]]) for key in ("model", name)
        )
        course[name] = (ours * alike).sum(axis=0) / np.sqrt(
            (ours**2).sum(axis=0) * (alike**2).sum(axis=0)
        )
    return {
        "recordings": [r.name for r in recordings],
        "resting": resting,
        "reports": reports,
        "fitted_on": None if fit_folder is None else [r.name for r in others],
        "scores": scores,
        "course": course,
        "series": [
            (r.grid, a) for r, (_, a) in zip(recordings, series["model"], strict=True)
        ],
    }


def _enough(
    folder: Path, found: Sequence[Any], reports: Sequence[Report], needed: int
) -> None:
    if len(found) < needed:
        why = "; ".join(str(report).strip() for report in reports if not report.used)
        raise FileFormatError(
            folder,
            f"{len(found)} trajectories of a moving arm, at least {needed} needed"
            + (f" ({' '.join(why.split())})" if why else ""),
        )


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
            name: {
                axis: {
                    "r2": float(s.r2[k]),
                    "r2_of_recordings": [float(x) for x in s.recordings[:, k]],
                    "stiffness_nm_per_rad": [float(x) for x in s.stiffness[:, k]],
                    "lag_s": [float(x) for x in s.lag],
                    "course": float(result["course"][name][k]),
                }
                for k, axis in enumerate(AXES)
            }
            for name, s in result["scores"].items()
        },
    }


def text(result: dict[str, Any]) -> str:
    """The figures of `validate` as a table."""
    fitted = result["fitted_on"]
    by = (
        "the other half"
        if fitted is None
        else f"{len(fitted)} recordings of another folder"
    )
    lines = [
        f"{len(result['recordings'])} of {len(result['reports'])} recordings used; stiffnesses and lag fitted "
        f"on {by}",
        *map(str, result["reports"]),
    ]
    rules = {rule for report in result["reports"] for rule in report.left_out}
    lines += [f"  {rule}: {words}" for rule, words in RULES.items() if rule in rules]
    lines += [
        "",
        f"{'':24}{'held-out R^2':>16}   {'stiffness [Nm/rad]':>34}   {'lag [s]':>10}   {'course':>14}",
        f"{'':24}{'roll':>8}{'pitch':>8}   {'roll':>17}{'pitch':>17}   {'':>10}   {'roll':>7}{'pitch':>7}",
    ]
    for name, s in result["scores"].items():
        roll, pitch = result["course"][name]
        lines.append(
            f"{name:24}{s.r2[0]:8.3f}{s.r2[1]:8.3f}   "
            + "".join(
                f"{', '.join(f'{x:.2f}' for x in s.stiffness[:, k]):>17}"
                for k in (0, 1)
            )
            + f"   {', '.join(f'{x:.2f}' for x in s.lag):>10}   {roll:7.3f}{pitch:7.3f}"
        )
    lines += ["", f"{'held-out R^2 of the model':40}{'roll':>8}{'pitch':>8}"]
    for name, row in zip(
        result["recordings"], result["scores"]["model"].recordings, strict=True
    ):
        lines.append(f"  {name:38}{row[0]:8.3f}{row[1]:8.3f}")
    return "\n".join(lines)


def plot(result: dict[str, Any], path: Path) -> None:
    """Measured and predicted tilt of up to six recordings, and the scores of all models."""
    from alpha5_model.viewer.figures import new_figure, write_figure

    names, scores = result["recordings"], result["scores"]
    shown = np.unique(
        np.linspace(0, len(names) - 1, min(6, len(names))).round().astype(int)
    )
    page = new_figure(15, 2.3 * len(shown) + 3.4)
    grid = page.add_gridspec(
        len(shown) + 1, 2, height_ratios=[1.0] * len(shown) + [1.35]
    )
    for row, index in enumerate(shown):
        time, tilt = result["series"][index]
        predicted = scores["model"].predicted[index]
        for k, axis in ((0, 1), (1, 0)):  # pitch left, roll right
            axes = page.add_subplot(grid[row, k])
            axes.plot(time, np.degrees(tilt[:, axis]), color="#222222", linewidth=1.6)
            axes.plot(
                time, np.degrees(predicted[:, axis]), color="#D55E00", linewidth=1.6
            )
            wrong = scores["COM and products wrong"].predicted[index]
            axes.plot(
                time,
                np.degrees(wrong[:, axis]),
                color="#999999",
                linewidth=1,
                linestyle="--",
            )
            r2 = scores["model"].recordings[index, axis]
            axes.set_title(f"{names[index]}   R² = {r2:.3f}", loc="left", fontsize=10)
            axes.set_ylabel(f"{AXES[axis]} [°]")
            axes.margins(x=0.01)
            if row == 0:
                labels = [
                    "measured by motion capture",
                    "model, fitted on other recordings",
                ]
                labels.append("the wrist's COM on the wrong side")
                axes.legend(
                    labels, fontsize=8, frameon=False, loc="best" if k else "lower left"
                )
            if row == len(shown) - 1:
                axes.set_xlabel("time [s]")
    axes = page.add_subplot(grid[-1, :])
    place = np.arange(len(scores))
    for k, (axis, colour) in enumerate(((1, "#0072B2"), (0, "#E69F00"))):
        values = np.array([s.r2[axis] for s in scores.values()])
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
    for axes in page.axes:
        axes.grid(color="#E6E6E6", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
    page.suptitle(
        f"Tilt of the vehicle explained by the arm's static moment ({len(names)} recordings)",
        fontsize=13,
    )
    write_figure(page, path, dpi=100)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the script; 0, or 2 with one line on stderr for a folder that cannot be used."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument(
        "--fit", type=Path, metavar="FOLDER", help="fit on these recordings"
    )
    parser.add_argument("--plot", type=Path, help="page of curves, .png, .pdf or .svg")
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    try:
        read = [
            path
            for folder in (options.folder, options.fit)
            for path in _csv_files(folder)
        ]
        check_outputs(read, plot=(options.plot, FORMATS))
        result = validate(options.folder, options.fit)
        if options.plot:
            plot(result, options.plot)
        said = json.dumps(record(result), indent=2) if options.json else text(result)
        atomic_write(STDOUT, said + "\n")
    except OutputError as error:
        if isinstance(
            error.__context__, BrokenPipeError
        ):  # the reader has left, as `head` does
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
