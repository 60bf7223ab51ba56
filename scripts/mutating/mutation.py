"""Mutation testing: do the tests see a random change of one operator or number?

    python scripts/mutating/mutation.py                       # 200 mutants of all rooms
    python scripts/mutating/mutation.py --sample 30 --seed 7 dh C
    python scripts/mutating/mutation.py --at dynamics/batch.py:79       # of one line

Mutants are made of all hand-written Python of the package and of all hand-written C:
the kernels and the templates of the C library. Each room, which is a folder, a module
or all C, has a share of the sample in proportion to its lines.

A test file is run once, to record which test passes which line. A mutant is written
into a copy of the checkout, where a forked child runs the tests of its line, then those
of its file and room, until one fails. The tests in the folder of its room come first.
Mutants that they do not see wait until all others are recorded, and are judged by
these. Results are appended to a file of JSON lines; the same command goes on where it
was stopped.

A mutant that makes the tests endless is reported apart and does not count as killed.
One that no test can see may be named in ``scripts/mutating/equivalent.toml``, with the
reason.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

if __name__ == "__main__":
    sys.path[0] = str(Path(__file__).resolve().parents[1])

from mutating import c_code, python_code
from mutating.mutants import (
    C_ROOM,
    REPOSITORY,
    Mutant,
    Place,
    changed_lines,
    draw,
    is_c,
    is_equivalent,
    room,
    sources,
)
from mutating.proofs import PROOFS
from mutating.sandbox import (
    Job,
    Outcome,
    Sandbox,
    Selection,
    run,
    warm,
)
from mutating.seen import BUDGET, Seen, test_files, tests_of
from mutating.statuses import (
    EQUIVALENT,
    INVALID,
    KILLED,
    SURVIVED,
    TIMEOUT,
    UNTESTED,
    WAITING,
)

BUILD = REPOSITORY / "build" / "mutation"
#: The columns of the table, after the room.
STATUSES = (KILLED, SURVIVED, UNTESTED, TIMEOUT, EQUIVALENT)


def main() -> int:
    """Status 1 if a proof fails or fewer than ``--least`` percent are killed."""
    asked = _arguments()
    texts = sources()
    results = _results(asked.output)
    with tempfile.TemporaryDirectory() as name:
        folders = [Path(name) / str(number) for number in range(asked.jobs)]
        boxes = [Sandbox(folder) for folder in folders]
        warm()
        if not _proved(boxes, texts):
            return 1
        seen = Seen(BUILD / "seen", texts, asked.budget)
        done = _appended(asked.output, texts, results)
        spare = 0
        while True:
            mutants = _mutants(asked, texts, spare)
            _judge(mutants, seen, boxes, results, done)
            # Another mutant in place of each that does not compile.
            invalid = sum(results[m.key]["status"] == INVALID for m in mutants)
            if invalid == spare or asked.at:
                break
            spare = invalid
    own = [results[mutant.key] for mutant in mutants]
    print(table(own))
    print(f"seed {asked.seed}; all mutants: {asked.output}")
    return 0 if own and share(own) >= asked.least else 1


def _judge(
    mutants: Sequence[Mutant],
    seen: Seen,
    boxes: Sequence[Sandbox],
    results: dict[str, dict[str, Any]],
    done: Any,
) -> None:
    """Have each mutant judged by the tests of its room, then the rest by all others."""
    texts = seen.texts
    for mutant in mutants:
        if mutant.key not in results and is_equivalent(mutant, texts[mutant.file]):
            done(Job(mutant, (), 0.0), Outcome(EQUIVALENT, 0.0), boxes[0])

    def at_home(job: Job, outcome: Outcome, box: Sandbox) -> None:
        mutant = job.mutant
        assert mutant is not None
        if outcome.status in (SURVIVED, UNTESTED) and not is_c(mutant.file):
            outcome = Outcome(WAITING, outcome.seconds)
        done(job, outcome, box)

    new = [mutant for mutant in mutants if mutant.key not in results]
    for name, count in Counter(room(m.file) for m in new).most_common():
        print(f"{name}: {count} mutants", flush=True)
        seen.record(boxes, tests_of(name))
        own = [mutant for mutant in new if room(mutant.file) == name]
        run((seen.job_at_home(m) for m in own), boxes, texts, at_home)

    left = [m for m in mutants if results[m.key]["status"] == WAITING]
    if left:
        print(f"all tests: {len(left)} mutants", flush=True)
        seen.record(boxes, test_files())
        run((seen.job_elsewhere(m) for m in left), boxes, texts, done)


def table(results: Sequence[dict[str, Any]]) -> str:
    """Counts of each room, and of all."""
    rooms = sorted({result["room"] for result in results})
    head = f"{'room':<20}" + "".join(f"{status:>12}" for status in STATUSES)
    rows = [head]
    for name in (*rooms, "all"):
        own = [r["status"] for r in results if name in ("all", r["room"])]
        count = Counter(own)
        rows.append(f"{name:<20}" + "".join(f"{count[s]:>12}" for s in STATUSES))
    return "\n".join([*rows, f"killed: {share(results):.1f} %"])


def share(results: Sequence[dict[str, Any]]) -> float:
    """Percent killed, of those that compile and that a test could see."""
    count = Counter(result["status"] for result in results)
    judged = sum(count.values()) - count[EQUIVALENT] - count[INVALID]
    return 100.0 * count[KILLED] / max(judged, 1)


def places(file: Path, text: str) -> list[Place]:
    """Where mutants of a file can be made."""
    return c_code.places(file, text) if is_c(file) else python_code.places(file, text)


def code_lines(file: Path, text: str) -> int:
    """Lines of code of a file."""
    return c_code.code_lines(text) if is_c(file) else python_code.code_lines(text)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rooms", nargs="*", help=f"folders, modules, {C_ROOM}")
    parser.add_argument("--sample", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--least", type=float, default=95.0, help="percent killed")
    parser.add_argument(
        "--budget", type=float, default=BUDGET, help="s of tests, at home and elsewhere"
    )
    parser.add_argument("--at", nargs="*", default=(), metavar="FILE:LINE")
    parser.add_argument("--output", type=Path, default=BUILD / "results.jsonl")
    return parser.parse_args()


def _mutants(
    asked: argparse.Namespace, texts: dict[Path, str], spare: int
) -> list[Mutant]:
    """Those of the places that are asked for, or a sample, with some to spare."""
    if asked.at:
        found = []
        for place in asked.at:
            name, _, line = place.rpartition(":")
            file = Path(name)
            for one in places(file, texts[file]):
                made = one(_unchanged_order)
                found += [m for m in made if m.line == int(line)]
        return found
    unknown = set(asked.rooms) - {room(file) for file in texts}
    if unknown:
        raise SystemExit(f"no such room: {', '.join(sorted(unknown))}")
    chosen = {
        file: text
        for file, text in texts.items()
        if not asked.rooms or room(file) in asked.rooms
    }
    return draw(chosen, places, code_lines, asked.sample + spare, asked.seed)


class _Unchanged:
    def sample(self, choices: Sequence[Any], count: int) -> list[Any]:
        return list(choices)[:count]


_unchanged_order: Any = _Unchanged()


def _results(output: Path) -> dict[str, dict[str, Any]]:
    """Of earlier runs: key of the mutant -> what came of it."""
    if not output.exists():
        return {}
    lines = output.read_text(encoding="utf-8").splitlines()
    return {row["key"]: row for row in map(json.loads, lines)}


def _appended(
    output: Path, texts: dict[Path, str], results: dict[str, dict[str, Any]]
) -> Any:
    """What hears of each job: it writes a line, and shows who lives."""
    output.parent.mkdir(parents=True, exist_ok=True)

    def done(job: Job, outcome: Outcome, box: Sandbox) -> None:
        mutant = job.mutant
        assert mutant is not None
        gone, come = changed_lines(texts[mutant.file], mutant.text)
        row = {
            "key": mutant.key,
            "room": room(mutant.file),
            "file": mutant.file.as_posix(),
            "line": mutant.line,
            "operator": mutant.operator,
            "status": outcome.status,
            "test": outcome.test,
            "seconds": round(outcome.seconds, 1),
            "old": " ".join(gone),
            "new": " ".join(come),
        }
        results[mutant.key] = row
        with output.open("a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        if outcome.status != KILLED:
            place = f"{row['file']}:{row['line']}"
            text = f"{place} {outcome.status}\n- {row['old']}\n+ {row['new']}"
            print(text, flush=True)

    return done


def _proved(boxes: Sequence[Sandbox], texts: dict[Path, str]) -> bool:
    """Mutants that must die do, and those that change nothing live."""
    good = []

    def done(job: Job, outcome: Outcome, box: Sandbox) -> None:
        assert job.mutant is not None
        good.append(outcome.status == job.mutant.operator)
        if not good[-1]:
            said = box.output.read_text("utf-8", "replace")[-2000:]
            print(
                f"{job.mutant.file}: expected {job.mutant.operator}, {outcome}\n{said}"
            )

    jobs = []
    for proof in PROOFS:
        mutant = proof.mutant(texts[Path(proof.file)])
        selections = (Selection(f"tests/{proof.test}.py"),)
        jobs.append(Job(mutant, selections, 300.0))
    run(jobs, boxes, texts, done)
    return all(good)


if __name__ == "__main__":
    sys.exit(main())
