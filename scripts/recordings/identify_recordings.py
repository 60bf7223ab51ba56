"""What does the tilt of a floating vehicle say about the arm that it carries?

    python scripts/recordings/identify_recordings.py FOLDER... [--json]

FOLDERs hold recordings as of `validate_recordings.py`, which are read, left out, averaged and fitted by its rules:
tilt = compliance times static moment, one compliance for roll and one for pitch, each recording without its mean.

- *Combinations.* The moment of the moving links is linear in eight base parameters, the net first moments ``nx``
  and ``ny`` of link 1 to link 4. Singular values of what each explains, once the two compliances have taken their
  part, say which combinations the attitude fixes, to which share of the size that they have by the tables, and how
  many times better or worse than the printed digits do.
- *Link 3's centre of buoyancy.* Where between the printed point (s = 0) and the corrected one (s = 1) does it fit
  best? Least squares for s, its standard error by leaving out each recording in turn (jackknife [Efron1981]); and
  the held-out R^2 with either point.

Residuals of averaged signals are not independent: their number is divided by their correlation time.

[Efron1981] Efron, Stein: The jackknife estimate of variance, Annals of Statistics 9(3).
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

import alpha5_model as a5
from alpha5_model.dynamics.regression import NAMES, regressor_rows
from alpha5_model.errors import Alpha5Error, FileFormatError
from alpha5_model.studies.uncertainty import linear_maps, printed

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from recordings import validate_recordings as recordings

#: What a static moment of the moving links depends on.
MOMENTS = [f"link_{i}.n{axis}" for i in (1, 2, 3, 4) for axis in "xy"]
COLUMNS = [NAMES.index(name) for name in MOMENTS]
#: Parts of a combination below this share of its largest are not shown.
SHOWN = 0.2
#: A standard deviation of so many times its size is none: a common factor is the vehicle's stiffness.
UNSEEN = 100.0


def numbers(corrections: tuple[str, ...] = ()) -> np.ndarray:
    """The eight net first moments in fresh water, (8,) [kg m]."""
    middle, _ = printed.intervals(corrections)
    return linear_maps.groups(middle, corrections, a5.FRESH_WATER, a5.parameters())[
        COLUMNS
    ]


def by_digits() -> np.ndarray:
    """What one standard deviation of each printed number is in the eight, (K, 8)."""
    middle, half = printed.intervals(())
    sets = middle + np.diag(half) * 3**-0.5
    return (
        linear_maps.groups(sets, (), a5.FRESH_WATER, a5.parameters())[:, COLUMNS]
        - numbers()
    )


def linear(recording: recordings.Recording) -> tuple[np.ndarray, np.ndarray]:
    """Averaged moments about x and y per net first moment at each lag, (L, M, 2, 8), and the tilt, (M, 2)."""
    q = np.ascontiguousarray(recording.motion.position[:, :4])
    gravity = recordings._at(recording.motion.time, recording.time, recording.gravity)
    still = np.zeros_like(q)
    axes = [regressor_rows(q, still, still, g)[:, 7:9][..., COLUMNS] for g in np.eye(3)]
    rows = np.einsum("nk,knij->nij", gravity, axes)
    table, tilt = recordings.signals(recording, rows.reshape(len(q), -1))
    return table.reshape(*table.shape[:2], 2, len(COLUMNS)), tilt


def correlation_time(left: np.ndarray) -> float:
    """Samples that count as one: 1 + 2 sum of autocorrelations up to their first zero."""
    x = left - left.mean()
    power = np.correlate(x, x, "full")[x.size - 1 :]
    share = power / power[0]
    end = int(np.argmax(share < 0)) or share.size
    return float(1 + 2 * share[1:end].sum())


def combinations(tables: list[np.ndarray], tilts: list[np.ndarray]) -> dict[str, Any]:
    """Which combinations of the eight the attitude fixes."""
    size, digits = numbers(), by_digits()
    whitened = []
    for axis in (0, 1):
        rows = np.concatenate([t[:, axis] for t in tables])
        tilt, moment = np.concatenate([t[:, axis] for t in tilts]), rows @ size
        compliance = moment @ tilt / (moment @ moment)
        ends = np.cumsum([len(t) for t in tables])[:-1]
        left = tilt - compliance * moment
        time = np.mean([correlation_time(part) for part in np.split(left, ends)])
        rows = compliance * rows / (left.std() * np.sqrt(time))
        unit = moment / np.linalg.norm(moment)
        whitened.append(
            rows - np.outer(unit, unit @ rows)
        )  # a factor is the compliance's
    data = np.concatenate(whitened)
    # In units of the size of each moment: the largest of nx and ny of its link.
    scale = np.repeat(np.abs(size.reshape(4, 2)).max(axis=1), 2)
    _, s, ways = np.linalg.svd(data * scale, full_matrices=False)
    found = []
    for value, way in zip(s, ways, strict=True):
        way = way * np.sign(way[np.abs(way).argmax()])
        direction = way / scale  # the combination is direction @ moments
        known = np.linalg.norm(digits @ direction)
        parts = {
            n: float(w) for n, w in zip(MOMENTS, way, strict=True) if abs(w) > SHOWN
        }
        found.append(
            {"of": parts, "deviation": float(1 / value), "by_digits": float(known)}
        )
    return {
        "combinations": found,
        "size_kg_m": dict(zip(MOMENTS, scale.tolist(), strict=True)),
    }


def between(tables: list[np.ndarray], tilts: list[np.ndarray]) -> float:
    """Where between the printed COB of link 3, 0, and the corrected one, 1, it fits best: Gauss-Newton."""
    one, change = numbers(), numbers(("link3_cob",)) - numbers()
    rows, tilt = np.concatenate(tables), np.concatenate(tilts)
    s = 0.0
    for _ in range(20):
        moment, slope = rows @ (one + s * change), rows @ change
        compliance = (moment * tilt).sum(axis=0) / (moment**2).sum(axis=0)
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
    pairs = [(t @ of, tilt) for t, tilt in zip(tables, tilts, strict=True)]
    left, total = np.zeros(2), np.zeros(2)
    for k, (moment, tilt) in enumerate(pairs):
        m, t = (
            np.concatenate([p[i] for j, p in enumerate(pairs) if j != k])
            for i in (0, 1)
        )
        left += ((tilt - (m * t).sum(axis=0) / (m**2).sum(axis=0) * moment) ** 2).sum(
            axis=0
        )
        total += (tilt**2).sum(axis=0)
    return [float(x) for x in 1 - left / total]


def findings(folders: list[Path]) -> dict[str, Any]:
    """Everything, of all folders."""
    read = [r for folder in folders for r in recordings.read(folder)[0]]
    if len(read) < 3:
        raise FileFormatError(
            folders[0], f"{len(read)} recordings of a moving arm, 3 are needed"
        )
    both = [linear(r) for r in read]
    lag, _ = recordings.fit([(table @ numbers(), tilt) for table, tilt in both])
    tables, tilts = [table[lag] for table, _ in both], [tilt for _, tilt in both]
    s = between(tables, tilts)
    each = range(len(read))
    without = [
        between([tables[j] for j in each if j != k], [tilts[j] for j in each if j != k])
        for k in each
    ]
    error = np.sqrt(
        (len(read) - 1) / len(read) * np.sum((without - np.mean(without)) ** 2)
    )
    return {
        "recordings": [r.name for r in read],
        "lag_s": float(recordings.LAGS[lag]),
        **combinations(tables, tilts),
        "link3_cob": {
            "fits_best_at": s,
            "standard_error": float(error),
            "without_each": without,
            "held_out_r2_printed": held_out(tables, tilts, numbers()),
            "held_out_r2_corrected": held_out(tables, tilts, numbers(("link3_cob",))),
        },
    }


def text(found: dict[str, Any]) -> str:
    """The figures as tables."""
    lines = [f"{len(found['recordings'])} recordings, lag {found['lag_s']:.2f} s", ""]
    lines.append(
        f"{'combination, in parts of the sizes of the moments':66}{'data':>8}{'digits':>10}"
    )
    for one in found["combinations"]:
        parts = " ".join(f"{w:+.2f} {n}" for n, w in one["of"].items())
        seen = "unseen" if one["deviation"] > UNSEEN else f"{one['deviation']:.2%}"
        lines.append(f"{parts:66}{seen:>8}{one['by_digits']:>10.2%}")
    cob = found["link3_cob"]
    lines += ["", "link 3's centre of buoyancy: printed is 0, corrected is 1"]
    lines.append(
        f"  fits best at {cob['fits_best_at']:.2f}, standard error {cob['standard_error']:.2f}"
    )
    for name in ("printed", "corrected"):
        roll, pitch = cob[f"held_out_r2_{name}"]
        lines.append(f"  held-out R^2 {name:10} roll {roll:.4f}, pitch {pitch:.4f}")
    return "\n".join(lines)


def main(arguments: list[str] | None = None) -> int:
    """Run the script; 0, or 2 with one line on stderr for folders that cannot be used."""
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
