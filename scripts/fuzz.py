"""Inputs at random to the package, its readers and its command line: each is answered or refused in one line.

    python scripts/fuzz.py                              # 100 000 inputs, counts per target
    python scripts/fuzz.py --count 2000 --seed 7 api    # one part: api, readers or commands
    python scripts/fuzz.py "alpha5 dh" --seed 7 --first 31 --count 1

A failure is any error outside of the package's tree, a refusal of more than one line or one that a pickle
changes, NaN in an answer, an answer to what has no meaning (masked, complex, infinite), a warning, more
than half a minute. Each prints the line that repeats it; status 1 if there is one. Files are read from and
written into a temporary folder.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import zlib
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from fuzzing import api, commands, readers
from fuzzing.cases import Target, outcome

PARTS: dict[str, dict[str, Target]] = {
    "api": api.TARGETS,
    "readers": readers.TARGETS,
    "commands": commands.TARGETS,
}
#: Share of the inputs; a call is quick, a command takes its time.
SHARES = {"api": 0.85, "readers": 0.11, "commands": 0.04}
#: Target -> parts of its answer that may be NaN or infinite, as documented: branches that do not exist, limits
#: that are none, what the motor cannot do, a volume of no digits.
ENDLESS = {
    "inverse_kinematics": frozenset({"q"}),
    "inverse_kinematics_pose": frozenset({"q", "rotation_error"}),
    "published_inverse_kinematics": frozenset({"the answer"}),
    "Arm.approach_directions": frozenset({"directions"}),
    "DHLink": frozenset({"lower", "upper"}),
    "dh.DHChain.from_table": frozenset({"lower", "upper"}),
    "Actuator.torque_limits": frozenset({"lower", "upper"}),
    "Actuator.speed_limits": frozenset({"lower", "upper"}),
    "urdf": frozenset({"volume"}),
}


def chosen(names: Sequence[str]) -> dict[str, tuple[Target, float]]:
    """Target's name -> target and its share of the inputs."""
    out: dict[str, tuple[Target, float]] = {}
    for part, targets in PARTS.items():
        for name, target in targets.items():
            if not names or part in names or name in names:
                out[name] = (target, SHARES[part] / len(targets))
    whole = sum(share for _, share in out.values())
    return {name: (target, share / whole) for name, (target, share) in out.items()}


def fuzz(
    target: Target,
    name: str,
    seed: int,
    numbers: range,
    folder: Path,
    failed: Callable[[str], None],
) -> Counter[str]:
    """Counts of ``ok``, ``refused`` and ``failed``; each failure is told with what repeats it."""
    counts: Counter[str] = Counter()
    for number in numbers:
        rng = np.random.default_rng([seed, zlib.crc32(name.encode()), number])
        case = target(rng, folder)
        result = outcome(case, ENDLESS.get(name, frozenset()))
        if result not in ("ok", "refused"):
            again = f'scripts/fuzz.py "{name}" --seed {seed} --first {number} --count 1'
            shown = ", ".join(f"{key}={value!r}" for key, value in case.arguments.items())
            failed(ascii(f"{result[:300]} | {again} | {shown[:600]}")[1:-1])
            result = "failed"
        counts[result] += 1
    return counts


def main() -> int:
    """Run; see the top of this file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="parts or targets; all")
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--first", type=int, default=0, help="number of the first input of each target"
    )
    options = parser.parse_args()
    targets = chosen(options.names)
    if not targets:
        parser.error(f"choose from {', '.join((*PARTS, *(n for t in PARTS.values() for n in t)))}")
    os.environ["MPLBACKEND"] = "agg"
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for name, (target, share) in targets.items():
            numbers = range(options.first, options.first + max(1, round(options.count * share)))
            counts = fuzz(
                target,
                name,
                options.seed,
                numbers,
                Path(folder),
                lambda line: print("FAILED", line, flush=True),
            )
            total += counts
            print(
                f"{name:40s} {counts['ok']:7d} ok {counts['refused']:7d} refused {counts['failed']:5d} failed",
                flush=True,
            )
    print(
        f"{total.total()} inputs: {total['ok']} ok, {total['refused']} refused, {total['failed']} failed"
    )
    return 1 if total["failed"] else 0


if __name__ == "__main__":
    sys.exit(main())
