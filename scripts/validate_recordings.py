"""Does the model know where the arm's weight is? Recordings of a real arm on a floating vehicle answer.

    python scripts/validate_recordings.py FOLDER [--plot PAGE.png] [--json]

FOLDER holds pairs ``NAME_joint_states.csv`` (joint positions) and ``NAME_mocap.csv`` (attitude of the vehicle,
quaternion ``x_ori y_ori z_ori w_ori``, same clock), as published with arXiv 2209.13577 (repository
hkolano/UVMS-SysID-with-EAs, MIT licence).

A vehicle that floats freely tilts until the water's restoring moment balances the static moment of the
arm's weight minus buoyancy, so tilt = moment / stiffness, with one stiffness for pitch and one for roll
over all recordings:

- moment: `Arm.base_wrench` at rest of the moving links in fresh water, about the axes of base_link, which
  are parallel to the vehicle's (z up). It is linear in gravity: computed for gravity along each axis, then
  combined with gravity as the tilted vehicle sees it, from the quaternions;
- both signals averaged over 1.5 s, the moment 0.3 s earlier (the vehicle's lag);
- the mean of each recording is taken off both: trim and ballast are not known;
- recordings in which no joint moves by more than 0.1 rad say nothing and are left out;
- the rest is halved by turns in the order of names; stiffnesses are fitted on one half by least squares and
  scored on the other, and the other way round. R^2 is of all held-out samples.

Controls go through the same procedure with their own stiffnesses: the wrist's COM on the wrong side of its
frame and products of inertia with SolidWorks' sign (a static moment knows of the COM only); no buoyancy;
buoyancy at the COM; gravity level, the attitude ignored. A free stiffness absorbs any factor, so a control that
leaves the moment's course alone cannot lose here; `course` says how alike the moments are (correlation with
those of the model).
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import alpha5_model as a5
from alpha5_model.checks import FloatArray
from alpha5_model.dynamics.arm import Arm
from alpha5_model.errors import Alpha5Error, FileFormatError, MissingFileError
from alpha5_model.inertia import flip_products
from alpha5_model.trajectory import Motion, read_motion

AVERAGE, DELAY, STEP = 1.5, 0.3, 0.05  # [s]
MOVES = 0.1  # [rad]
AXES = ("roll", "pitch")  # moments about x and y
GRAVITY = 9.81
QUATERNION = ("x_ori", "y_ori", "z_ori", "w_ori")


@dataclass(frozen=True, eq=False)
class Recording:
    """A moving arm on a floating vehicle.

    Attributes:
        name: Common part of the file names.
        motion: Joint motion.
        time: (N,) of the motion capture [s].
        tilt: Roll and pitch of the vehicle, (N, 2) [rad].
        gravity: Gravity in the vehicle's axes, (N, 3) [m/s^2].
    """

    name: str
    motion: Motion
    time: FloatArray
    tilt: FloatArray
    gravity: FloatArray


def read(folder: Path) -> tuple[list[Recording], list[str]]:
    """The recordings in which the arm moves, by name, and the names of those in which it rests."""
    if not folder.is_dir():
        raise MissingFileError(folder, "a folder of recordings")
    moving, resting = [], []
    for path in sorted(folder.glob("*_mocap.csv")):
        name = path.name.removesuffix("_mocap.csv")
        motion = read_motion(path.with_name(f"{name}_joint_states.csv"))
        if np.ptp(motion.position[:, :4], axis=0).max() < MOVES:
            resting.append(name)
            continue
        time, quaternion = _mocap(path)
        x, y, z, w = (quaternion / np.linalg.norm(quaternion, axis=1, keepdims=True)).T
        # Rows of the rotation vehicle -> world: the last one is world z in the vehicle's axes.
        up = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=1)
        tilt = np.stack([np.arctan2(up[:, 1], up[:, 2]), -np.arcsin(up[:, 0])], axis=1)
        moving.append(Recording(name, motion, time, tilt, -GRAVITY * up))
    if len(moving) < 2:
        raise FileFormatError(
            folder, f"{len(moving)} recordings of a moving arm, at least 2 needed"
        )
    return moving, resting


def _mocap(path: Path) -> tuple[FloatArray, FloatArray]:
    header = path.read_text(encoding="utf-8").split("\n", 1)[0].strip().split(",")
    for name in ("time_secs", *QUATERNION):
        if name not in header:
            raise FileFormatError(path, f"no column {name!r}", "line 1")
    columns = [header.index(name) for name in ("time_secs", *QUATERNION)]
    try:
        table = np.loadtxt(path, delimiter=",", skiprows=1, usecols=columns, ndmin=2)
    except ValueError as error:
        raise FileFormatError(path, str(error)) from None
    return table[:, 0], table[:, 1:]


def moving_links(
    density: float = a5.FRESH_WATER,
    change_body: Callable[[int, Any], Any] | None = None,
    cob_at_com: bool = False,
) -> list[Arm]:
    """The arm without link_0, with gravity of 1 m/s^2 along x, y and z of base_link."""
    arms = []
    for axis in np.eye(3):
        arm = a5.load(fluid_density=density, gravity=axis)
        model = arm.model.copy()
        model.inertias[0] = pin.Inertia.Zero()
        displaced = [d for d in arm.displacements if d.joint != "universe"]
        for joint in range(1, model.njoints):
            if change_body is not None:
                model.inertias[joint] = change_body(joint, model.inertias[joint])
        if cob_at_com:
            displaced = [
                replace(d, cob=np.array(model.inertias[model.getJointId(d.joint)].lever))
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


def moments(arms: Sequence[Arm], recording: Recording, level: bool = False) -> FloatArray:
    """Static moment of the moving links about x and y of base_link at the motion's times, (N, 2)."""
    motion = recording.motion
    gravity = _at(motion.time, recording.time, recording.gravity)
    if level:
        gravity = np.broadcast_to([0.0, 0.0, -GRAVITY], gravity.shape)
    q = motion.position[:, :4]
    rest = np.zeros((1, 4))
    per_axis = np.stack([arm.base_wrench_batch(q, rest, rest)[:, 3:5] for arm in arms])
    return np.asarray(np.einsum("nk,knj->nj", gravity, per_axis))


def signals(recording: Recording, moment: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Common times (N,), averaged moment (N, 2) and tilt (N, 2), each without its mean."""
    late = recording.motion.time + DELAY
    margin = AVERAGE / 2
    start, end = (
        max(late[0], recording.time[0]) + margin,
        min(late[-1], recording.time[-1]) - margin,
    )
    time = np.arange(start, end, STEP)
    if time.size < 2:
        raise FileFormatError(recording.name, "the two files have no time in common")
    pair = [_average(time, late, moment), _average(time, recording.time, recording.tilt)]
    m, a = (signal - signal.mean(axis=0) for signal in pair)
    return time, m, a


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
        stiffness: From the first and the second half, for roll and pitch, (2, 2) [N m/rad].
        predicted: Held-out tilt of each recording, (N, 2) [rad].
    """

    r2: FloatArray
    recordings: FloatArray
    stiffness: FloatArray
    predicted: list[FloatArray]


def score(pairs: Sequence[tuple[FloatArray, FloatArray]]) -> Score:
    """Fit compliances on each half of the (moment, tilt) pairs, score them on the other."""
    half = [k % 2 for k in range(len(pairs))]
    compliance = np.empty((2, 2))
    for side in (0, 1):
        fitted = [pair for pair, h in zip(pairs, half, strict=True) if h == side]
        compliance[side] = sum((m * a).sum(axis=0) for m, a in fitted) / sum(
            (m * m).sum(axis=0) for m, _ in fitted
        )
    predicted = [m * compliance[1 - h] for (m, _), h in zip(pairs, half, strict=True)]
    left = np.array(
        [((a - p) ** 2).sum(axis=0) for (_, a), p in zip(pairs, predicted, strict=True)]
    )
    total = np.array([(a**2).sum(axis=0) for _, a in pairs])
    return Score(
        1 - left.sum(axis=0) / total.sum(axis=0), 1 - left / total, 1 / compliance, predicted
    )


def validate(folder: Path) -> dict[str, Any]:
    """Score the model and its controls on a folder of recordings; also what a plot needs."""
    recordings, resting = read(folder)
    models: dict[str, tuple[list[Arm], bool]] = {
        "model": (moving_links(), False),
        "COM and products wrong": (moving_links(change_body=_wrong_body), False),
        "no buoyancy": (moving_links(density=a5.AIR), False),
        "buoyancy at the COM": (moving_links(cob_at_com=True), False),
        "attitude ignored": (moving_links(), True),
    }
    series, scores, course = {}, {}, {}
    for name, (arms, level) in models.items():
        series[name] = [signals(r, moments(arms, r, level)) for r in recordings]
        scores[name] = score([(m, a) for _, m, a in series[name]])
        ours, theirs = (np.vstack([m for _, m, _ in series[key]]) for key in ("model", name))
        course[name] = (ours * theirs).sum(axis=0) / np.sqrt(
            (ours**2).sum(axis=0) * (theirs**2).sum(axis=0)
        )
    return {
        "recordings": [r.name for r in recordings],
        "resting": resting,
        "scores": scores,
        "course": course,
        "series": series["model"],
    }


def record(result: dict[str, Any]) -> dict[str, Any]:
    """The figures of `validate`, made of what JSON knows."""
    return {
        "recordings": result["recordings"],
        "resting": result["resting"],
        "models": {
            name: {
                axis: {
                    "r2": float(s.r2[k]),
                    "r2_of_recordings": [float(x) for x in s.recordings[:, k]],
                    "stiffness_nm_per_rad": [float(x) for x in s.stiffness[:, k]],
                    "course": float(result["course"][name][k]),
                }
                for k, axis in enumerate(AXES)
            }
            for name, s in result["scores"].items()
        },
    }


def text(result: dict[str, Any]) -> str:
    """The figures of `validate` as a table."""
    lines = [
        f"{len(result['recordings'])} recordings of a moving arm"
        + (f" ({len(result['resting'])} at rest left out)" if result["resting"] else ""),
        "",
        f"{'':24}{'held-out R^2':>16}   {'stiffness of the halves [Nm/rad]':>34}   {'course':>14}",
        f"{'':24}{'roll':>8}{'pitch':>8}   {'roll':>17}{'pitch':>17}   {'roll':>7}{'pitch':>7}",
    ]
    for name, s in result["scores"].items():
        stiff = [f"{s.stiffness[0, k]:.2f}, {s.stiffness[1, k]:.2f}" for k in (0, 1)]
        roll, pitch = result["course"][name]
        lines.append(
            f"{name:24}{s.r2[0]:8.3f}{s.r2[1]:8.3f}   {stiff[0]:>17}{stiff[1]:>17}   "
            f"{roll:7.3f}{pitch:7.3f}"
        )
    lines += ["", f"{'held-out R^2 of the model':40}{'roll':>8}{'pitch':>8}"]
    for name, row in zip(result["recordings"], result["scores"]["model"].recordings, strict=True):
        lines.append(f"  {name:38}{row[0]:8.3f}{row[1]:8.3f}")
    return "\n".join(lines)


def plot(result: dict[str, Any], path: Path) -> None:
    """Measured and predicted tilt of up to six recordings, and the scores of all models."""
    from alpha5_model.view.figures import new_figure, write_figure

    names, scores = result["recordings"], result["scores"]
    shown = np.unique(np.linspace(0, len(names) - 1, min(6, len(names))).round().astype(int))
    page = new_figure(15, 2.3 * len(shown) + 3.4)
    grid = page.add_gridspec(len(shown) + 1, 2, height_ratios=[1.0] * len(shown) + [1.35])
    for row, index in enumerate(shown):
        time, _, tilt = result["series"][index]
        predicted = scores["model"].predicted[index]
        for k, axis in ((0, 1), (1, 0)):  # pitch left, roll right
            axes = page.add_subplot(grid[row, k])
            axes.plot(time, np.degrees(tilt[:, axis]), color="#222222", linewidth=1.6)
            axes.plot(time, np.degrees(predicted[:, axis]), color="#D55E00", linewidth=1.6)
            wrong = scores["COM and products wrong"].predicted[index]
            axes.plot(
                time, np.degrees(wrong[:, axis]), color="#999999", linewidth=1, linestyle="--"
            )
            r2 = scores["model"].recordings[index, axis]
            axes.set_title(f"{names[index]}   R² = {r2:.3f}", loc="left", fontsize=10)
            axes.set_ylabel(f"{AXES[axis]} [°]")
            axes.margins(x=0.01)
            if row == 0:
                labels = ["measured by motion capture", "model, stiffness from the other half"]
                labels.append("the wrist's COM on the wrong side")
                axes.legend(labels, fontsize=8, frameon=False, loc="best" if k else "lower left")
            if row == len(shown) - 1:
                axes.set_xlabel("time [s]")
    axes = page.add_subplot(grid[-1, :])
    place = np.arange(len(scores))
    for k, (axis, colour) in enumerate(((1, "#0072B2"), (0, "#E69F00"))):
        values = np.array([s.r2[axis] for s in scores.values()])
        bars = axes.bar(
            place + 0.4 * k - 0.2, np.maximum(values, 0), 0.36, color=colour, label=AXES[axis]
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
    parser.add_argument("--plot", type=Path, help="page of curves, .png, .pdf or .svg")
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    try:
        result = validate(options.folder)
        if options.plot:
            plot(result, options.plot)
    except Alpha5Error as error:
        print(f"validate_recordings: {error}", file=sys.stderr)
        return 2
    print(json.dumps(record(result), indent=2) if options.json else text(result))
    return 0


if __name__ == "__main__":
    sys.exit(main())
