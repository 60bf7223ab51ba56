"""Send random inputs to the package, its readers and its command line.

Each input must be answered, or refused in one line.

    python scripts/fuzzing/fuzz.py                     # 200 000 inputs of all parts
    python scripts/fuzzing/fuzz.py --count 2000 api    # of one part
    python scripts/fuzzing/fuzz.py "alpha5 dh" --seed 7 --first 31 --count 1

The parts are

- api: every public function with arguments of any sort,
- forms: the same functions with good numbers in arrays that are misaligned,
  memory-mapped, packed, swapped, strided or of another type, on the compiled kernels
  and on NumPy's,
- texts: URDF, xacro, recordings, studies and tables, damaged, hostile or made up; names
  of columns; quantities,
- commands: the command line.

These are failures:

- an error outside of the package's tree,
- a refusal of more than one line, or one that a pickle changes,
- NaN in an answer, or an answer to an input without meaning (masked, complex,
  infinite),
- an answer whose bits depend on where the numbers lie, or a changed argument,
- a warning that is not the package's own,
- a program started or another file opened because a file says so,
- a function that refuses all of its good numbers: its inputs show nothing,
- more than half a minute of processor time, or than 2 s for each 100 kB of a file.

Each failure prints the line that repeats it; the status is 1 if there is one. Files are
read from and written into a temporary folder.
"""

from __future__ import annotations

import argparse
import faulthandler
import itertools
import os
import sys
import tempfile
import zlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

import numpy as np

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from fuzzing import api, commands, forms, readers
from fuzzing.cases import Target, outcome

PARTS: dict[str, dict[str, Target]] = {
    "api": api.TARGETS,
    "forms": forms.targets(api.DRAWS),
    "texts": readers.TARGETS,
    "commands": commands.TARGETS,
}
#: Share of the inputs; a call is quick, a command takes its time.
SHARES = {"api": 0.4, "forms": 0.45, "texts": 0.12, "commands": 0.03}
#: Start of a target's name -> its weight within its part, if that is not 1.
WEIGHTS = {
    "jax.": 0.1,
    "a5.identify": 0.05,
    "a5.trajectory.analyse": 0.3,
    "a5.planar.dexterity_map": 0.1,
    "a5.without_self_collision": 0.1,
    "a5.plan": 0.05,
}
#: Inputs that one process works off before it takes others.
CHUNK = 400
#: So many inputs of good numbers, all refused, are drawn wrongly.
ENOUGH = 40
#: Share of the forms that the kernels in NumPy answer.
NUMPY_SHARE = 0.25
#: Target -> parts of its answer that may be NaN or infinite, as documented: branches
#: that do not exist, absent limits, what the motor cannot do, limits that nobody
#: published, a volume of no digits.
ENDLESS = {
    "a5.inverse_kinematics": frozenset({"q"}),
    "a5.inverse_kinematics_pose": frozenset({"q", "rotation_error"}),
    "a5.published_inverse_kinematics": frozenset({"the answer"}),
    "jax.inverse_kinematics": frozenset({"the answer", "q"}),
    "a5.Arm.approach_directions": frozenset({"directions"}),
    "a5.dh.DHLink": frozenset({"lower", "upper"}),
    "a5.dh.DHLink.from_vector": frozenset({"lower", "upper"}),
    "a5.dh.DHChain": frozenset({"lower", "upper"}),
    "a5.dh.DHChain.from_table": frozenset({"lower", "upper"}),
    "a5.dh.DHChain.from_axes": frozenset({"lower", "upper"}),
    "a5.dh.DHChain.alpha5": frozenset({"lower", "upper"}),
    "a5.actuators.Actuator.torque_limits": frozenset({"lower", "upper"}),
    "a5.actuators.Actuator.speed_limits": frozenset({"lower", "upper"}),
    "a5.planar.Arc.parameter": frozenset({"the answer"}),
    "a5.planar.Segment.parameter": frozenset({"the answer"}),
    "a5.identify": frozenset({"lower", "upper", "gains", "deviation", "gain"}),
    "a5.plan": frozenset({"limit"}),
    "urdf": frozenset({"volume"}),
}


class Job(NamedTuple):
    """Inputs of one target.

    Attributes:
        part: Of `PARTS`.
        name: Of the target.
        seed: Of all inputs.
        numbers: Of the inputs.
        kernels: Value of ``ALPHA5_KERNELS``.
    """

    part: str
    name: str
    seed: int
    numbers: range
    kernels: str


class Done(NamedTuple):
    """The result of a job.

    Attributes:
        job: The job.
        counts: Of ``ok``, ``refused`` and ``failed``.
        failures: A line for each.
    """

    job: Job
    counts: Counter[str]
    failures: list[str]


def chosen(names: Sequence[str]) -> dict[str, tuple[str, float]]:
    """Target's name -> its part and its share of the inputs."""
    out: dict[str, tuple[str, float]] = {}
    for part, targets in PARTS.items():
        every = {name: SHARES[part] * weight(name) for name in targets}
        scale = SHARES[part] / sum(every.values())
        for name in targets:
            if not names or part in names or name in names:
                out[name] = (part, every[name] * scale)
    whole = sum(share for _, share in out.values())
    return {name: (part, share / whole) for name, (part, share) in out.items()}


def weight(name: str) -> float:
    """The weight of a target within its part."""
    bare = name.removeprefix("forms ")
    for start, known in WEIGHTS.items():
        if bare.startswith(start):
            return known
    return 1.0


def jobs(names: Sequence[str], count: int, seed: int, first: int) -> list[Job]:
    """All of the work, in pieces of at most `CHUNK` inputs.

    The last inputs of each target of ``forms`` run on the kernels in NumPy.
    """
    made: list[Job] = []
    forced = os.environ.get("ALPHA5_KERNELS", "")
    for name, (part, share) in chosen(names).items():
        wanted = max(1, round(count * share))
        end = first + wanted
        on_numpy = round(wanted * NUMPY_SHARE) if part == "forms" and not forced else 0
        for start in range(first, end, CHUNK):
            stop = min(start + CHUNK, end)
            split = max(start, min(stop, end - on_numpy))
            pieces = ((range(start, split), forced), (range(split, stop), "numpy"))
            for numbers, kernels in pieces:
                if numbers:
                    made.append(
                        Job(
                            part=part,
                            name=name,
                            seed=seed,
                            numbers=numbers,
                            kernels=kernels,
                        )
                    )
    return made


def work(job: Job, mark: Path | None = None) -> Done:
    """Do a job in this process.

    Args:
        job: What to do.
        mark: File for the line that repeats the current input, which may end the
            process.
    """
    failures: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        target = PARTS[job.part][job.name]
        counts = fuzz(
            target,
            job.name,
            job.seed,
            job.numbers,
            Path(folder),
            failures.append,
            mark=mark,
        )
    return Done(job=job, counts=counts, failures=failures)


def fuzz(
    target: Target,
    name: str,
    seed: int,
    numbers: range,
    folder: Path,
    failed: Callable[[str], None],
    mark: Path | None = None,
) -> Counter[str]:
    """Counts of ``ok``, ``refused`` and ``failed``.

    Args:
        target: Draws the inputs.
        name: Of the target.
        seed: Of all inputs.
        numbers: Of the inputs.
        folder: To read from and write into.
        failed: Is called with a line for each failure.
        mark: See `work`.
    """
    counts: Counter[str] = Counter()
    endless = ENDLESS.get(name.removeprefix("forms "), frozenset())
    kernels = os.environ.get("ALPHA5_KERNELS", "")
    before = f"ALPHA5_KERNELS={kernels} " if kernels else ""
    for number in numbers:
        options = f"--seed {seed} --first {number} --count 1"
        again = f'{before}scripts/fuzzing/fuzz.py "{name}" {options}'
        if mark is not None:
            mark.write_text(again, encoding="utf-8")
        rng = np.random.default_rng([seed, zlib.crc32(name.encode()), number])
        case = target(rng, folder)
        result = outcome(case, endless)
        if result not in ("ok", "refused"):
            arguments = [f"{key}={value!r}" for key, value in case.arguments.items()]
            shown = ", ".join(arguments)
            failed(ascii(f"{result[:300]} | {again} | {shown[:600]}")[1:-1])
            result = "failed"
        counts[result] += 1
    if mark is not None:
        mark.unlink(missing_ok=True)
    return counts


def run(every: list[Job], folder: Path) -> Iterator[Done]:
    """Results in the order of the jobs, of as many processes as there are processors
    for us.
    """
    if len(every) == 1 and every[0].kernels == os.environ.get("ALPHA5_KERNELS", ""):
        yield work(every[0])
        return
    before = os.environ.get("ALPHA5_KERNELS")
    for kernels in sorted({job.kernels for job in every}):
        os.environ["ALPHA5_KERNELS"] = kernels
        mine = [job for job in every if job.kernels == kernels]
        marks = [folder / f"mark-{kernels}-{k}" for k in range(len(mine))]
        workers = min(len(mine), len(os.sched_getaffinity(0)))
        # With the fault handler, a crash says where it happened.
        pool = ProcessPoolExecutor(workers, get_context("spawn"), faulthandler.enable)
        with pool:
            try:
                yield from pool.map(work, mine, marks)
            except BrokenProcessPool:
                for mark in marks:
                    if mark.exists():
                        line = f"a process ended | {mark.read_text(encoding='utf-8')}"
                        counts = Counter(failed=1)
                        yield Done(job=mine[0], counts=counts, failures=[line])
    os.environ.pop("ALPHA5_KERNELS")
    if before is not None:
        os.environ["ALPHA5_KERNELS"] = before


def told(name: str, counts: Counter[str]) -> str:
    """A line of counts."""
    return (
        f"{name:50s} {counts['ok']:7d} ok {counts['refused']:7d} refused "
        f"{counts['failed']:5d} failed"
    )


def shows_nothing(counts: Counter[str]) -> bool:
    """Whether enough inputs were drawn and none was answered."""
    return counts.total() >= ENOUGH and counts["refused"] == counts.total()


def main() -> int:
    """Run; see the top of this file."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", help="parts or targets; all")
    parser.add_argument("--count", type=int, default=200_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--first", type=int, default=0, help="number of the first input of each target"
    )
    options = parser.parse_args()
    every = jobs(options.names, options.count, options.seed, options.first)
    if not every:
        known = itertools.chain(PARTS, *PARTS.values())
        parser.error(f"choose from {', '.join(known)}")
    os.environ["MPLBACKEND"] = "agg"

    by_part = _counted(every)
    print()
    for part, counts in by_part.items():
        if counts:
            print(told(part, counts))
    total = sum(by_part.values(), Counter[str]())
    print(
        f"{total.total()} inputs: {total['ok']} ok, {total['refused']} refused, "
        f"{total['failed']} failed"
    )
    return 1 if total["failed"] else 0


def _counted(every: list[Job]) -> dict[str, Counter[str]]:
    """Counts of each part; prints failures, and the counts of each target."""
    by_target: dict[str, Counter[str]] = {}
    by_part: dict[str, Counter[str]] = {part: Counter() for part in PARTS}
    left = Counter(job.name for job in every)
    with tempfile.TemporaryDirectory() as folder:
        for done in run(every, Path(folder)):
            name = done.job.name
            for line in done.failures:
                print("FAILED", line, flush=True)
            by_target.setdefault(name, Counter()).update(done.counts)
            by_part[done.job.part].update(done.counts)
            left[name] -= 1
            if left[name] == 0:
                print(told(name, by_target[name]), flush=True)
                if done.job.part == "forms" and shows_nothing(by_target[name]):
                    print(f"FAILED {name}: every good input was refused", flush=True)
                    by_part[done.job.part]["failed"] += 1
    return by_part


if __name__ == "__main__":
    sys.exit(main())
