"""Mutation testing: are the tests sharp enough to see a random change of one operator or number?

    python scripts/mutation.py                                  # 300 mutants of all rooms
    python scripts/mutation.py --count 30 --seed 7 description kinematics
    python scripts/mutation.py --at dynamics/statics.py:79      # every mutant of one line

cosmic-ray says where a mutant can be made and makes it; one drawing takes one operator at one place, each
place with the same chance. Here is only what a session of it would cost minutes for: a process that holds
the third-party packages forks once per mutant, in a copy of the checkout, and the child runs the tests that
coverage saw on the changed line, cheapest first, until one fails.

Left out by rule, because they change nothing that a test could see: annotations (compared as syntax trees),
a cache taken off a function, ``strict=True`` of a zip, which asserts what the code itself made so.
"""

from __future__ import annotations

import argparse
import ast
import difflib
import itertools
import os
import pickle
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path

import coverage
import pytest
from cosmic_ray.ast import get_ast
from cosmic_ray.mutating import MutationVisitor
from cosmic_ray.plugins import get_operator, operator_names

REPOSITORY = Path(__file__).resolve().parents[1]
PACKAGE = REPOSITORY / "alpha5_model"
#: The files as they are when the run starts: whoever edits meanwhile does not disturb it.
SOURCES = {
    f.relative_to(PACKAGE): f.read_text(encoding="utf-8") for f in sorted(PACKAGE.rglob("*.py"))
}
ROOMS = (
    "comparison",
    "consistency",
    "description",
    "dh",
    "dynamics",
    "kinematics",
    "meshing",
    "planar",
    "trajectory",
)
#: Tests that drive a browser, a clock or a picture: no room of these is theirs.
NOT_ASKED = ("test_view_", "test_benchmark", "test_demo", "test_fuzz")
#: Imported before the forks; the package itself is not, each child imports its own.
WARM = (
    "numpy",
    "scipy.spatial.transform",
    "scipy.interpolate",
    "scipy.optimize",
    "pinocchio",
    "coal",
    "matplotlib.pyplot",
    "rich.console",
    "typer",
    "xacro",
    "trimesh",
    "mujoco",
)
#: A mutant may take this many times the processor time of its tests unchanged, and this much more [s]; and, if it
#: waits for something, on a busy machine, this many times that by the clock.
SLOWER, GRACE, CLOCK = 3.0, 20.0, 15.0
#: Tests of one mutant, in seconds of the unchanged run.
BUDGET = 60.0
#: At most this many functions are asked before whole files are.
FIRST = 60
_DATES = itertools.count(1_000_000_000)
#: The harness proves itself first: file, part of a line, what it becomes, what must come of it, by which tests.
PROOFS = (
    ("consistency/row.py", '"mm": 1e3', '"mm": 2e3', "killed", "tests/test_audit.py"),
    ("consistency/row.py", "norm(outside)", "norm(-outside)", "survived", "tests/test_audit.py"),
)


@dataclass(frozen=True)
class Mutant:
    """One change: ``text`` is the whole file with it, ``line`` where it starts."""

    file: Path
    line: int
    operator: str
    text: str
    status: str = "not run"
    seconds: float = 0.0

    @property
    def place(self) -> str:
        return f"{self.file}:{self.line}"

    def diff(self) -> str:
        old = SOURCES[self.file]
        lines = difflib.unified_diff(old.splitlines(), self.text.splitlines(), n=0, lineterm="")
        return "\n".join(line for line in list(lines)[2:] if not line.startswith("@@"))


@dataclass(frozen=True)
class Site:
    """A place where a kind of mutant can be made, and the operators that make one."""

    file: Path
    position: tuple[int, int]
    choices: tuple[tuple[str, int], ...]

    def mutants(self) -> Iterator[Mutant]:
        """Those that compile and differ."""
        source = SOURCES[self.file]
        for name, occurrence in self.choices:
            text = MutationVisitor.mutate_code(source, get_operator(name)(), occurrence)
            with suppress(SyntaxError):
                if _meaning(text) != _meaning(source):
                    yield Mutant(self.file, self.position[0], name.split("/")[-1], text)


def sites(file: Path) -> list[Site]:
    """All places of a file, in its order."""
    tree = get_ast(SOURCES[file])
    found: dict[tuple[tuple[int, int], str], list[tuple[str, int]]] = defaultdict(list)
    for name in sorted(operator_names()):
        if "Variable" in name:  # these need arguments
            continue
        operator, occurrence = get_operator(name)(), 0
        kind = name.split("/")[-1].split("_")[0]
        for node in _nodes(tree):
            for start, _ in operator.mutation_positions(node):
                cache = kind == "RemoveDecorator" and "cache" in node.get_code()
                if not cache and node.parent.get_code().strip() != "strict=True":
                    found[start, kind].append((name, occurrence))
                occurrence += 1
    return [Site(file, start, tuple(choices)) for (start, _), choices in sorted(found.items())]


def draw(files: Sequence[Path], count: int, seed: int) -> list[Mutant]:
    """``count`` mutants at different places, every place with the same chance."""
    chance = random.Random(seed)
    places = [site for file in files for site in sites(file)]
    chance.shuffle(places)
    drawn: list[Mutant] = []
    for site in places:
        if len(drawn) == count:
            break
        choices = chance.sample(site.choices, len(site.choices))
        if mutant := next(replace(site, choices=tuple(choices)).mutants(), None):
            drawn.append(mutant)
    return drawn


class _Bare(ast.NodeTransformer):
    """A syntax tree without annotations."""

    def visit_arg(self, node: ast.arg) -> ast.arg:
        node.annotation = None
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        node.annotation = ast.Constant(None)
        self.generic_visit(node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.returns = None
        self.generic_visit(node)
        return node


def _meaning(source: str) -> str:
    return ast.dump(_Bare().visit(ast.parse(source)))


def _nodes(node: object) -> Iterator[object]:
    """In the order of cosmic-ray's own walk: a node, then its children."""
    yield node
    for child in getattr(node, "children", ()):
        yield from _nodes(child)


def sandbox(folder: Path) -> Path:
    """A copy of the checkout's files to change and to run tests in."""
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=REPOSITORY, check=True, capture_output=True, text=True,
    ).stdout  # fmt: skip
    copy = folder / "checkout"
    for name in filter(None, names.split("\0")):
        if (REPOSITORY / name).is_file():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(REPOSITORY / name, copy / name)
    beside = REPOSITORY.parent / "shared"
    if beside.exists():
        (folder / "shared").symlink_to(beside.resolve())
    subprocess.run(["git", "init", "-q"], cwd=copy, check=True)
    return copy


class Tests:
    """Which test files pass a line, and how much processor time each takes.

    First the functions that were seen on the line; what a module or a cache computes once was seen in one of
    them only, or in none, so that the whole files have the last word.
    """

    def __init__(self, copies: Sequence[Path], only: Sequence[str] = ()) -> None:
        asked = list(only) or [
            str(file.relative_to(copies[0]))
            for file in sorted((copies[0] / "tests").glob("test_*.py"))
            if not file.name.startswith(NOT_ASKED)
        ]
        self.seconds: dict[str, float] = {}
        self.lines: dict[tuple[Path, str], set[int]] = {}
        self.functions: dict[tuple[Path, int], set[str]] = defaultdict(set)

        def done(job: Job, status: str, seconds: float, copy: Path) -> None:
            test = job.tests[0]
            if status != "survived":
                said = (copy.parent / "output").read_text()[-1000:]
                print(f"{test} fails without any mutant and is left out:\n{said}", flush=True)
                return
            self.seconds[test] = seconds
            measured = coverage.CoverageData(str(copy.parent / "coverage"))
            measured.read()
            for path in measured.measured_files():
                file = Path(path).relative_to(copy / "alpha5_model")
                self.lines[file, test] = set(measured.lines(path) or ())
                for line, contexts in measured.contexts_by_lineno(path).items():
                    names = {context.rpartition(".")[2] for context in contexts if context}
                    self.functions[file, line] |= {f"{test}::{name}" for name in names}

        run([Job(None, (test,), 900.0) for test in asked], copies, done)

    def job(self, mutant: Mutant) -> Job:
        """Those that pass the mutant's statement: first what passes most of its file, within the budget."""
        at = _statement(SOURCES[mutant.file], mutant.line)
        own = {t: lines for (f, t), lines in self.lines.items() if f == mutant.file}
        # A line that only another process passes is seen by none: all tests of its file are asked.
        passing = [t for t, lines in own.items() if lines & at] or list(own)
        # What a module computes as it is read is passed by all; those that work in its room go first.
        near = dict.fromkeys(passing, 0)
        for (file, test), lines in self.lines.items():
            if test in near and file.parts[0] == mutant.file.parts[0]:
                near[test] += len(lines)
        passing.sort(key=lambda t: (-len(self.lines[mutant.file, t]), -near[t], self.seconds[t]))
        ordered: list[str] = []
        total = 0.0
        for test in passing:
            if not ordered or total + self.seconds[test] < BUDGET:
                total += self.seconds[test]
                ordered.append(test)
        files = Job(mutant, tuple(ordered), GRACE + SLOWER * total)
        seen = set().union(*(self.functions[mutant.file, line] for line in at))
        first = sorted(seen, key=lambda t: (passing.index(t.partition("::")[0]), t))[:FIRST]
        return Job(mutant, tuple(first), files.limit, files) if first else files


def _statement(source: str, line: int) -> set[int]:
    """Lines of the statement around a line, of a compound one its head: coverage skips folded constants."""
    spans = [
        range(node.lineno, (node.body[0].lineno if body else (node.end_lineno or node.lineno) + 1))
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.stmt)
        for body in [isinstance(getattr(node, "body", None), list)]
    ]
    around = [span for span in spans if line in span]
    return {line, *min(around, key=len, default=())}


@dataclass(frozen=True)
class Job:
    """One forked child: these test files with this mutant, or with none and coverage measured."""

    mutant: Mutant | None
    tests: tuple[str, ...]
    limit: float
    then: Job | None = None  # to be run if this one sees nothing


def _environment(copy: Path) -> dict[str, str]:
    alone = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    return {
        **os.environ,
        **alone,
        "PYTHONPATH": str(copy),
        "MPLBACKEND": "agg",
    }


def _write(copy: Path, file: Path, text: str) -> None:
    """With a date of its own, by which Python knows compiled files that are stale."""
    path = copy / "alpha5_model" / file
    path.write_text(text, encoding="utf-8")
    os.utime(path, (date := next(_DATES), date))


def _test(copy: Path, job: Job) -> None:
    """In the forked child: run the tests in the copy, leave with pytest's status."""
    os.setsid()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(os.open(copy.parent / "output", os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)
    os.dup2(1, 2)
    resource.setrlimit(resource.RLIMIT_CPU, (round(job.limit), round(job.limit) + 5))
    os.chdir(copy)
    os.environ.update(_environment(copy))
    own = (REPOSITORY, REPOSITORY / "scripts")
    sys.path[:] = [str(copy), *(p for p in sys.path if Path(p).resolve() not in own)]
    measure = coverage.Coverage(copy.parent / "coverage", source=[str(copy / "alpha5_model")])
    measure.set_option("run:dynamic_context", "test_function")
    if job.mutant is None:
        measure.start()
    status = pytest.main(["-x", "-q", "-p", "no:cacheprovider", *job.tests])
    if job.mutant is None:
        measure.stop()
        measure.save()
    sys.stdout.flush()
    os._exit(status)


def run(
    jobs: Sequence[Job], copies: Sequence[Path], done: Callable[[Job, str, float, Path], None]
) -> None:
    """One child per copy at a time; ``done`` hears of each job as it ends."""
    waiting, free = list(jobs)[::-1], list(copies)
    busy: dict[int, tuple[Job, Path, float]] = {}
    while waiting or busy:
        while waiting and free:
            job, copy = waiting.pop(), free.pop()
            if job.mutant:
                _write(copy, job.mutant.file, job.mutant.text)
            child = os.fork()
            if child == 0:
                try:
                    _test(copy, job)
                except BaseException:
                    traceback.print_exc()
                    sys.stderr.flush()
                os._exit(99)
            busy[child] = (job, copy, time.monotonic())
        time.sleep(0.05)
        for child, (job, copy, start) in list(busy.items()):
            ended, status, used = os.wait4(child, os.WNOHANG)
            if not ended and time.monotonic() - start < CLOCK * job.limit:
                continue
            outcome = "killed (time)"
            if ended:
                known = {0: "survived", 5: "no test", -signal.SIGXCPU: outcome}
                outcome = known.get(os.waitstatus_to_exitcode(status), "killed")
            else:
                os.killpg(child, signal.SIGKILL)
                _, _, used = os.wait4(child, 0)
            del busy[child]
            if job.mutant:
                _write(copy, job.mutant.file, SOURCES[job.mutant.file])
            free.append(copy)
            if job.then and not outcome.startswith("killed"):
                waiting.append(job.then)
                continue
            done(job, outcome, used.ru_utime + used.ru_stime, copy)


def proved(copies: Sequence[Path]) -> bool:
    """One mutant dies, and one that changes nothing lives."""
    jobs, outcomes = [], {}
    for name, old, new, expected, test in PROOFS:
        text = SOURCES[Path(name)]
        line = text[: text.index(old)].count("\n") + 1
        mutant = Mutant(Path(name), line, f"{new}, expected {expected}", text.replace(old, new, 1))
        jobs.append(Job(mutant, (test,), 900.0))

    def done(job: Job, status: str, seconds: float, copy: Path) -> None:
        assert job.mutant is not None
        outcomes[job.mutant.operator] = status

    run(jobs, copies, done)
    for text, status in outcomes.items():
        print(f"proof: {text}: {status}", flush=True)
    return all(text.endswith(status) for text, status in outcomes.items())


def table(results: Sequence[Mutant]) -> str:
    """Markdown: counts per room, then every mutant that lives with its diff, then all."""
    rows = ["| room | mutants | killed | alive | |", "| --- | ---: | ---: | ---: | ---: |"]
    for room in (*ROOMS, "all"):
        own = [m for m in results if room in ("all", m.file.parts[0])]
        killed = sum(m.status.startswith("killed") for m in own)
        if own:
            rows.append(
                f"| {room} | {len(own)} | {killed} | {len(own) - killed} | {killed / len(own):.1%} |"
            )
    alive = [
        f"\n`{m.place}` {m.operator}, {m.status}\n\n```diff\n{m.diff()}\n```"
        for m in results
        if not m.status.startswith("killed")
    ]
    every = [f"| {m.place} | {m.operator} | {m.status} | {m.seconds:.1f} |" for m in results]
    return "\n".join(
        [
            *rows,
            *alive,
            "",
            "| mutant | operator | status | s |",
            "| --- | --- | --- | ---: |",
            *every,
            "",
        ]
    )


def main() -> int:
    """Status 1 if the harness disproves itself or fewer than ``--least`` percent die."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("rooms", nargs="*", default=ROOMS, help=f"of {', '.join(ROOMS)}")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--least", type=float, default=95.0, help="percent that must be killed")
    parser.add_argument(
        "--at", nargs="*", default=(), metavar="FILE:LINE", help="these lines, all mutants of each"
    )
    parser.add_argument(
        "--map", type=Path, help="keep what the tests pass in this file, or take it from there"
    )
    parser.add_argument("--tests", nargs="*", default=(), help="only these test files")
    parser.add_argument("--output", type=Path, default=REPOSITORY / "build" / "mutation.md")
    chosen = parser.parse_args()
    os.nice(19)
    if chosen.at:
        at = {tuple(place.split(":")) for place in chosen.at}
        mutants = [
            m for name in {Path(f) for f, _ in at} for site in sites(name)
            if (str(name), str(site.position[0])) in at for m in site.mutants()
        ]  # fmt: skip
    else:
        files = [file for file in SOURCES if file.parts[0] in chosen.rooms]
        mutants = draw(files, chosen.count, chosen.seed)
    if not mutants:
        parser.error("there is no place for a mutant")
    with tempfile.TemporaryDirectory() as name:
        folders = [Path(name) / str(k) for k in range(max(chosen.jobs, 1))]
        copies = [sandbox(folder) for folder in folders]
        print(f"{len(mutants)} mutants", flush=True)
        for module in WARM:
            import_module(module)
        if chosen.map and chosen.map.exists():
            tests = pickle.loads(chosen.map.read_bytes())
        else:
            tests = Tests(copies, chosen.tests)
            if chosen.map:
                chosen.map.write_bytes(pickle.dumps(tests))
        if not proved(copies):
            return 1
        results: list[Mutant] = []

        def done(job: Job, status: str, seconds: float, copy: Path) -> None:
            assert job.mutant is not None
            results.append(mutant := replace(job.mutant, status=status, seconds=seconds))
            chosen.output.parent.mkdir(parents=True, exist_ok=True)
            chosen.output.write_text(
                table(results), encoding="utf-8"
            )  # so far: a run takes its time
            if not status.startswith("killed"):
                print(f"[{len(results)}] {mutant.place} {status}\n{mutant.diff()}", flush=True)

        jobs = [tests.job(mutant) for mutant in mutants]
        # A line that no test file passes at all: no need to ask.
        for job in jobs:
            if not job.tests:
                done(job, "no test", 0.0, copies[0])
        run([job for job in jobs if job.tests], copies, done)
    killed = sum(m.status.startswith("killed") for m in results)
    print(
        f"{killed} of {len(results)} killed ({killed / max(len(results), 1):.1%}); see {chosen.output}"
    )
    return 0 if results and 100 * killed >= chosen.least * len(results) else 1


if __name__ == "__main__":
    sys.exit(main())
