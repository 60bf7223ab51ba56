"""Estimate the weight of an arm from the tilt of the floating vehicle that carries it.

    python scripts/identification/identify_recordings.py FOLDER... [--json]

FOLDERs hold recordings as of `validate_recordings.py`, which are read, left out,
averaged and fitted by its rules: tilt = compliance times static moment, one compliance
for roll and one for pitch, each recording without its mean.

- *Combinations.* The moment of the moving links is linear in eight base parameters, the
  net first moments ``nx`` and ``ny`` of link 1 to link 4. Singular values of what each
  explains, once the two compliances have taken their part, say which combinations the
  attitude fixes, to which share of the size that they have by the tables, and how many
  times better or worse than the printed digits do.
- *Link 3's centre of buoyancy.* Where between the printed point (s = 0) and the
  corrected one (s = 1) does it fit best? Least squares for s, its standard error by
  leaving out each recording in turn (jackknife [Efron1981]); and the held-out R^2 with
  either point. The same again if the arm's axes may be turned about the vehicle's z:
  each recording is then scored with compliances from the others, the turn from all.

Residuals of averaged signals are not independent: their number is divided by their
correlation time.

[Efron1981] Efron, Stein: The jackknife estimate of variance, Annals of Statistics 9(3).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import alpha5_model as a5
from alpha5_model.codegen.regrouping import base_parameters
from alpha5_model.dynamics.kernel_numbers import arm_dimensions
from alpha5_model.dynamics.regression import NAMES, regressor_rows
from alpha5_model.errors import Alpha5Error, FileFormatError
from alpha5_model.studies.arm_numbers import arm_numbers, base_slopes

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from identification import validate_recordings as recordings
from identification import vehicle_tilt
from identification.validate_recordings import interpolated
from identification.vehicle_tilt import plane_rotation

#: What a static moment of the moving links depends on.
MOMENTS = [f"link_{i}.n{axis}" for i in (1, 2, 3, 4) for axis in "xy"]
COLUMNS = [NAMES.index(name) for name in MOMENTS]
#: Parts of a combination below this share of its largest are not shown.
SHOWN = 0.2
#: A standard deviation of so many times its size is none: a common factor is the
#: vehicle's stiffness.
UNSEEN = 100.0


def numbers(corrections: tuple[str, ...] = ()) -> np.ndarray:
    """The eight net first moments in fresh water, (8,) [kg m]."""
    record = a5.parameters(("base_frame", *corrections))
    return base_parameters(record.links, a5.FRESH_WATER, parameters=record)[COLUMNS]


def by_digits() -> np.ndarray:
    """Change of the eight by one standard deviation of each printed number, (K, 8)."""
    of_arm = arm_numbers(a5.parameters())
    # The standard deviation of an even distribution over the digits' interval.
    deviation = of_arm.half_width * 3**-0.5
    return base_slopes(of_arm, a5.FRESH_WATER)[:, COLUMNS] * deviation[:, None]


def linear(
    recording: recordings.Recording, yaw: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Averaged moments per net first moment, and the tilt.

    Args:
        recording: Of a moving arm.
        yaw: By which the arm's axes are turned about the vehicle's z [rad].

    Returns:
        Moments about x and y at each lag, (L, M, 2, 8), and tilt, (M, 2).
    """
    q = np.ascontiguousarray(recording.motion.position[:, :4])
    gravity = interpolated(recording.motion.time, recording.time, recording.gravity)
    gravity[:, :2] = gravity[:, :2] @ plane_rotation(yaw)
    still = np.zeros_like(q)
    dimensions = arm_dimensions(a5.load())
    axes = [
        regressor_rows(q, still, still, g, dimensions)[:, 7:9][..., COLUMNS]
        for g in np.eye(3)
    ]
    rows = plane_rotation(yaw) @ np.einsum("nk,knij->nij", gravity, axes)
    table, tilt = recordings.signals(recording, rows.reshape(len(q), -1))
    return table.reshape(*table.shape[:2], 2, len(COLUMNS)), tilt


def correlation_time(left: np.ndarray) -> float:
    """Samples that count as one: 1 + 2 sum of autocorrelations to their first zero."""
    x = left - left.mean()
    power = np.correlate(x, x, "full")[x.size - 1 :]
    share = power / power[0]
    end = int(np.argmax(share < 0)) or share.size
    return float(1 + 2 * share[1:end].sum())


def combinations(tables: list[np.ndarray], tilts: list[np.ndarray]) -> dict[str, Any]:
    """Which combinations of the eight the attitude fixes."""
    size = numbers()
    digits = by_digits()
    data = np.concatenate([_whitened(tables, tilts, axis, size) for axis in (0, 1)])
    # In units of the size of each moment: the largest of nx and ny of its link.
    scale = np.repeat(np.abs(size.reshape(4, 2)).max(axis=1), 2)
    _, singular_values, ways = np.linalg.svd(data * scale, full_matrices=False)

    found = []
    for singular_value, way in zip(singular_values, ways, strict=True):
        turned = way * np.sign(way[np.abs(way).argmax()])
        direction = turned / scale  # the combination is direction @ moments
        known = np.linalg.norm(digits @ direction)
        found.append(
            {
                "of": _shown_parts(turned),
                "deviation": float(1 / singular_value),
                "by_digits": float(known),
            }
        )
    return {
        "combinations": found,
        "size_kg_m": dict(zip(MOMENTS, scale.tolist(), strict=True)),
    }


def _shown_parts(way: np.ndarray) -> dict[str, float]:
    """The large parts of a combination, by the names of the moments."""
    parts = {}
    for name, part in zip(MOMENTS, way, strict=True):
        if abs(part) > SHOWN:
            parts[name] = float(part)
    return parts


def _whitened(
    tables: list[np.ndarray], tilts: list[np.ndarray], axis: int, size: np.ndarray
) -> np.ndarray:
    """Change of the tilt by each of the eight, over its standard deviation, (M, 8).

    What the compliance can take over is left out.

    Args:
        tables: Moments per net first moment of each recording, (m, 2, 8).
        tilts: Of each recording, (m, 2).
        axis: 0 for roll, 1 for pitch.
        size: The net first moments, (8,).
    """
    rows = np.concatenate([table[:, axis] for table in tables])
    tilt = np.concatenate([tilt[:, axis] for tilt in tilts])
    moment = rows @ size
    compliance = moment @ tilt / (moment @ moment)

    left = tilt - compliance * moment
    ends = np.cumsum([len(table) for table in tables])[:-1]
    time = np.mean([correlation_time(part) for part in np.split(left, ends)])
    slopes = compliance * rows / (left.std() * np.sqrt(time))

    unit = moment / np.linalg.norm(moment)
    return slopes - np.outer(unit, unit @ slopes)


class Turned(NamedTuple):
    """What fits best if the arm's axes may be turned about the vehicle's z.

    Attributes:
        place: Of the COB of link 3: 0 is the printed one, 1 the corrected one.
        yaw: [rad].
    """

    place: float
    yaw: float


def between_turned(tables: list[np.ndarray], tilts: list[np.ndarray]) -> Turned:
    """Where the COB of link 3 fits best, and the yaw, by Gauss-Newton."""
    as_printed = numbers()
    change = numbers(("link3_cob",)) - as_printed
    rows = np.concatenate(tables)
    tilt = np.concatenate(tilts)
    place = 0.0
    yaw = 0.0
    for _ in range(20):
        turn = plane_rotation(yaw)
        moment = rows @ (as_printed + place * change) @ turn.T
        compliance = _compliance(moment, tilt)
        left = (tilt - compliance * moment).ravel()
        slopes = [rows @ change @ turn.T, moment @ plane_rotation(np.pi / 2).T]
        free = [
            compliance
            * (slope - moment * (moment * slope).sum(axis=0) / (moment**2).sum(axis=0))
            for slope in slopes
        ]
        columns = np.stack([slope.ravel() for slope in free], axis=1)
        step, *_ = np.linalg.lstsq(columns, left, rcond=None)
        place += float(step[0])
        yaw += float(step[1])
    return Turned(place=place, yaw=yaw)


def between(tables: list[np.ndarray], tilts: list[np.ndarray]) -> float:
    """Where the COB of link 3 fits best: 0 is the printed one, 1 the corrected one.

    The arm's axes are taken for parallel to the vehicle's. The method is Gauss-Newton.
    """
    as_printed = numbers()
    change = numbers(("link3_cob",)) - as_printed
    rows = np.concatenate(tables)
    tilt = np.concatenate(tilts)
    slope = rows @ change
    s = 0.0
    for _ in range(20):
        moment = rows @ (as_printed + s * change)
        compliance = _compliance(moment, tilt)
        left = tilt - compliance * moment
        # What compliances cannot take over.
        free = compliance * (
            slope - moment * (moment * slope).sum(axis=0) / (moment**2).sum(axis=0)
        )
        s += float((free * left).sum() / (free**2).sum())
    return s


def held_out(
    tables: list[np.ndarray], tilts: list[np.ndarray], of: np.ndarray
) -> list[float]:
    """R^2 of roll and pitch, each recording with compliances from the others."""
    moments = [table @ of for table in tables]
    left = np.zeros(2)
    total = np.zeros(2)
    for k, (moment, tilt) in enumerate(zip(moments, tilts, strict=True)):
        of_others = np.concatenate(_others(moments, k))
        compliance = _compliance(of_others, np.concatenate(_others(tilts, k)))
        left += ((tilt - compliance * moment) ** 2).sum(axis=0)
        total += (tilt**2).sum(axis=0)
    return [float(x) for x in 1 - left / total]


def _others(items: list[np.ndarray], k: int) -> list[np.ndarray]:
    """All but item k."""
    return items[:k] + items[k + 1 :]


def _compliance(moment: np.ndarray, tilt: np.ndarray) -> np.ndarray:
    """Tilt over moment for roll and pitch by least squares, (2,)."""
    return (moment * tilt).sum(axis=0) / (moment**2).sum(axis=0)


def findings(folders: list[Path]) -> dict[str, Any]:
    """Everything, of all folders."""
    read: list[recordings.Recording] = []
    for folder in folders:
        read += recordings.read(folder)[0]
    if len(read) < 3:
        raise FileFormatError(
            folders[0], f"{len(read)} recordings of a moving arm, 3 are needed"
        )

    both = [linear(recording) for recording in read]
    lag, _ = recordings.fit([(table @ numbers(), tilt) for table, tilt in both])
    tables = [table[lag] for table, _ in both]
    tilts = [tilt for _, tilt in both]
    return {
        "recordings": [recording.name for recording in read],
        "lag_s": float(recordings.LAGS[lag]),
        **combinations(tables, tilts),
        "link3_cob": {
            **_cob_of_link_3(tables, tilts),
            "turned": _cob_on_turned_arm(read),
        },
    }


def _cob_of_link_3(tables: list[np.ndarray], tilts: list[np.ndarray]) -> dict[str, Any]:
    """Where the centre of buoyancy of link 3 fits best, and its standard error."""
    n = len(tables)
    without = [between(_others(tables, k), _others(tilts, k)) for k in range(n)]
    return {
        "fits_best_at": between(tables, tilts),
        "standard_error": _jackknife(without),
        "without_each": without,
        "held_out_r2_printed": held_out(tables, tilts, numbers()),
        "held_out_r2_corrected": held_out(tables, tilts, numbers(("link3_cob",))),
    }


def _cob_on_turned_arm(read: list[recordings.Recording]) -> dict[str, Any]:
    """The same if the arm's axes may be turned about the vehicle's z.

    Gravity is turned by the angle that fits best with the printed numbers, and the
    angle and the centre are then fitted together.
    """
    yaw = vehicle_tilt.fit(read).yaw
    both = [linear(recording, yaw) for recording in read]
    lag, _ = recordings.fit([(table @ numbers(), tilt) for table, tilt in both])
    tables = [table[lag] for table, _ in both]
    tilts = [tilt for _, tilt in both]

    found = between_turned(tables, tilts)
    without = [
        between_turned(_others(tables, k), _others(tilts, k)) for k in range(len(read))
    ]
    turn = plane_rotation(found.yaw)
    along = [turn @ table for table in tables]
    yaw_error = _jackknife([one.yaw for one in without])
    return {
        "fits_best_at": found.place,
        "standard_error": _jackknife([one.place for one in without]),
        "yaw_deg": float(np.degrees(yaw + found.yaw)),
        "yaw_standard_error_deg": float(np.degrees(yaw_error)),
        "held_out_r2_printed": held_out(along, tilts, numbers()),
        "held_out_r2_corrected": held_out(along, tilts, numbers(("link3_cob",))),
    }


def _jackknife(without_each: list[float]) -> float:
    """Standard error from the answers without each recording."""
    n = len(without_each)
    deviations = np.array(without_each) - np.mean(without_each)
    return float(np.sqrt((n - 1) / n * np.sum(deviations**2)))


def text(found: dict[str, Any]) -> str:
    """The figures as tables."""
    head = "combination, in parts of the sizes of the moments"
    lines = [
        f"{len(found['recordings'])} recordings, lag {found['lag_s']:.2f} s",
        "",
        f"{head:66}{'data':>8}{'digits':>10}",
    ]
    for one in found["combinations"]:
        parts = " ".join(f"{w:+.2f} {n}" for n, w in one["of"].items())
        seen = "unseen" if one["deviation"] > UNSEEN else f"{one['deviation']:.2%}"
        lines.append(f"{parts:66}{seen:>8}{one['by_digits']:>10.2%}")
    cob = found["link3_cob"]
    lines += ["", "link 3's centre of buoyancy: printed is 0, corrected is 1"]
    lines.append(
        f"  fits best at {cob['fits_best_at']:.2f}, "
        f"standard error {cob['standard_error']:.2f}"
    )
    lines += _lines_of_scores(cob)
    turned = cob["turned"]
    lines += [
        "if the arm's axes may be turned about the vehicle's z:",
        f"  turned by {turned['yaw_deg']:.1f} deg, "
        f"standard error {turned['yaw_standard_error_deg']:.1f}",
        f"  fits best at {turned['fits_best_at']:.2f}, "
        f"standard error {turned['standard_error']:.2f}",
        *_lines_of_scores(turned),
    ]
    return "\n".join(lines)


def _lines_of_scores(found: dict[str, Any]) -> list[str]:
    """Held-out R^2 with the printed and the corrected centre."""
    lines = []
    for name in ("printed", "corrected"):
        roll, pitch = found[f"held_out_r2_{name}"]
        lines.append(f"  held-out R^2 {name:10} roll {roll:.4f}, pitch {pitch:.4f}")
    return lines


def main(arguments: list[str] | None = None) -> int:
    """Run the script; 2 with one line on stderr if a folder cannot be used, else 0."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("folders", type=Path, nargs="+", metavar="FOLDER")
    parser.add_argument("--json", action="store_true", help="figures as JSON")
    options = parser.parse_args(arguments)
    try:
        found = findings(options.folders)
    except Alpha5Error as error:
        print(f"identify_recordings: {error}", file=sys.stderr)
        return 2
    print(json.dumps(found, indent=2) if options.json else text(found))
    return 0


if __name__ == "__main__":
    sys.exit(main())
