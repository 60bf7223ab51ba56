"""Which tests pass which line, from one run of every test file; kept between runs.

A record belongs to the text of its test file: a changed test file is run again. The
lines of a source that changed since are found by comparing the two texts.
"""

from __future__ import annotations

import difflib
import hashlib
import json
import shutil
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from pathlib import Path

import coverage
from mutating.mutants import C_ROOM, REPOSITORY, Mutant, is_c, room
from mutating.python_code import readers, statement
from mutating.sandbox import Job, Outcome, Sandbox, Selection, run
from mutating.statuses import SURVIVED

#: Tests of pages, notebooks, scripts and other tools, or by a browser: they cost
#: minutes and see a mutant by chance only.
NOT_RUN = (
    "test_added_mass_script",
    "test_benchmark",
    "test_conformance",
    "test_demo",
    "test_documentation",
    "test_examples",
    "test_fuzz",
    "test_identify_recordings",
    "test_mutation",
    "test_notebooks",
    "test_real_tools",
    "test_statements",
    "test_validate_recordings",
    "test_view_browser",
    "test_view_collision",
    "test_view_hand",
    "test_view_travel",
)
#: Tests of all records, all public signatures and all that is generated of constants.
#: Classes, defaults and constants are computed by an import, which belongs to no test.
OF_IMPORTS = (
    "tests/package/test_records.py",
    "tests/package/test_public_api.py",
    "tests/codegen/test_generated_sources.py",
)
#: For the C code of the kernels, in this order.
KERNEL_TESTS = (
    "tests/codegen/test_kernels_compiled.py",
    "tests/codegen/test_kernels_arithmetic.py",
    "tests/codegen/test_kernels_transposition.py",
    "tests/codegen/test_rounding.py",
    "tests/codegen/test_collision_kernels.py",
    "tests/codegen/test_collision_kernels_refusals.py",
    "tests/codegen/test_kernels_external.py",
    "tests/codegen/test_kernels_targets.py",
    "tests/kinematics/test_ik_kernels.py",
    "tests/codegen/test_casadi.py",
    "tests/dynamics/test_dynamics_kernels.py",
    "tests/codegen/test_numpy_kernels.py",
    "tests/kinematics/test_ik.py",
    "tests/kinematics/test_own_arm_ik.py",
    "tests/collision/test_self_collision_exact.py",
    "tests/kinematics/test_colliding.py",
    "tests/dynamics/test_dynamics_arm.py",
)
#: For the templates of the C library.
LIBRARY_TESTS = ("tests/codegen/test_c_library.py",)
C_TESTS = (*KERNEL_TESTS, *LIBRARY_TESTS)
#: Room -> the folder of its tests, if that has another name.
HOMES = {
    "__init__.py": "package",
    "__main__.py": "cli",
    "casadi.py": "codegen",
    "errors.py": "package",
    "jax.py": "codegen",
}
#: Processor time of the tests of one mutant without it, at home and elsewhere [s].
BUDGET = 60.0
#: At most this share of it for one test file at a time.
SHARE = 0.3
#: What opening one more test file costs [s].
OPENING = 0.5
#: Test file -> names of tests.
Tests = dict[str, set[str]]
#: A test file may take this long where its lines are recorded [s].
_LONGEST = 1200.0


class Seen:
    """The records of all test files, in a folder.

    Attributes:
        budget: Processor time of the tests of a mutant, at home and elsewhere [s].
        seconds: Test file -> test -> processor time.
    """

    def __init__(
        self, folder: Path, texts: dict[Path, str], budget: float = BUDGET
    ) -> None:
        self.folder = folder
        self.texts = texts
        self.budget = budget
        self.seconds: dict[str, dict[str, float]] = {}
        self._sources: dict[str, dict[str, str]] = {}
        self._data: dict[str, coverage.CoverageData] = {}
        self._tests_of: dict[Path, dict[str, dict[int, set[str]]]] = {}

    def record(self, boxes: Sequence[Sandbox], asked: Sequence[str]) -> None:
        """Run those of the test files of which there is no record."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._tests_of.clear()
        missing = [
            file for file in asked if file not in self.seconds and not self._read(file)
        ]
        jobs = [Job(None, (Selection(file),), _LONGEST) for file in missing]
        digests = self._keep_sources()

        def done(job: Job, outcome: Outcome, box: Sandbox) -> None:
            file = job.selections[0].file
            print(f"{file}: {outcome.seconds:.0f} s", flush=True)
            if outcome.status != SURVIVED:
                said = box.output.read_text("utf-8", "replace")[-800:]
                print(f"{outcome.test} fails without a mutant; left out:\n{said}")
                return
            shutil.move(box.record(), self._path(file, "coverage"))
            times = json.loads(box.times().read_text("utf-8"))
            test = _digest((box.checkout / file).read_text(encoding="utf-8"))
            record = {"test": test, "sources": digests, "seconds": times}
            self._path(file, "json").write_text(json.dumps(record), encoding="utf-8")
            self._read(file)

        run(jobs, boxes, self.texts, done)

    def job_at_home(self, mutant: Mutant) -> Job:
        """The tests of a mutant in the folder of its room.

        They see most mutants. For these, the tests of other folders need be neither
        recorded nor run.
        """
        if is_c(mutant.file):
            return self._c_job(mutant)
        return self._job(mutant, self._at_home(mutant))

    def job_elsewhere(self, mutant: Mutant) -> Job:
        """All other tests of a mutant, those that are likely to see it first."""
        if is_c(mutant.file):
            return Job(mutant, (), 0.0)
        at_home = self._at_home(mutant)
        asked = frozenset(name for own in at_home for name in own.names)
        selections = self._chosen(self._tiers(mutant), mutant, asked)
        return self._job(mutant, selections)

    def _at_home(self, mutant: Mutant) -> list[Selection]:
        """What the budget affords at home, then all tests of imports besides."""
        of_imports = [
            Selection(file, tuple(self.seconds[file]))
            for file in OF_IMPORTS
            if file in self.seconds
        ]
        asked = frozenset(name for file in of_imports for name in file.names)
        return self._chosen(self._tiers_at_home(mutant), mutant, asked) + of_imports

    def _c_job(self, mutant: Mutant) -> Job:
        files = KERNEL_TESTS
        if "c_library" in mutant.file.parts:
            files = LIBRARY_TESTS
        selections = tuple(Selection(file) for file in files)
        known = [sum(self.seconds.get(file, {}).values()) for file in files]
        return Job(mutant, selections, 2.0 * sum(known))

    def _job(self, mutant: Mutant, selections: list[Selection]) -> Job:
        seconds = OPENING * len(selections)
        for selection in selections:
            known = self.seconds[selection.file]
            seconds += sum(known[name] for name in selection.names)
        return Job(mutant, tuple(selections), seconds)

    def _tiers_at_home(self, mutant: Mutant) -> list[Tests]:
        """Tests of the statement, then all others of their files.

        The folder of tests that mirrors the package comes first: other folders pass
        many lines, and judge few of their results.
        """
        home = home_of(room(mutant.file))
        own = {
            test: by_line
            for test, by_line in self._lines(mutant.file).items()
            if test.startswith(home)
        }
        of_line = _of_statement(self.texts[mutant.file], mutant.line, own)
        beside = {t: set(self.seconds[t]) for t, names in of_line.items() if names}
        return [of_line, beside]

    def _tiers(self, mutant: Mutant) -> list[Tests]:
        """Tests of the statement, then of the file, the room, and the rest.

        Later tiers are needed since what a module or a cache computes once is seen in
        one test, or in none.
        """
        own = self._lines(mutant.file)
        of_line = _of_statement(self.texts[mutant.file], mutant.line, own)
        of_file = {t: set().union(*by_line.values()) for t, by_line in own.items()}
        beside = {t: set(self.seconds[t]) for t, names in of_line.items() if names}
        of_room: Tests = defaultdict(set)
        for file in self.texts:
            if room(file) == room(mutant.file) and not is_c(file):
                for test, by_line in self._lines(file).items():
                    of_room[test] |= set().union(*by_line.values())
        everything = {t: set(names) for t, names in self.seconds.items()}
        return [of_line, of_file, beside, of_room, everything]

    def _chosen(
        self, tiers: list[Tests], mutant: Mutant, asked: frozenset[str]
    ) -> list[Selection]:
        """What the budget affords of the tiers, without what was asked before.

        At first each file of a tier has the same part, so that one whose tests are dear
        is asked, too; then up to `SHARE`.
        """
        weight = {t: len(by_line) for t, by_line in self._lines(mutant.file).items()}
        selections: list[Selection] = []
        total = 0.0
        for tier, most in self._parts(tiers):
            new = {t: names - asked for t, names in tier.items() if names - asked}
            for selection, seconds in self._affordable(new, weight, most):
                if selections and total + seconds > self.budget:
                    continue
                selections.append(selection)
                asked |= set(selection.names)
                total += seconds
        return selections

    def _parts(self, tiers: list[Tests]) -> Iterator[tuple[Tests, float]]:
        """Each tier twice, with what one of its files may take [s]."""
        most = SHARE * self.budget
        for tier in tiers:
            yield tier, min(most, self.budget / max(len(tier), 1))
            yield tier, most

    def _affordable(
        self, tests: dict[str, set[str]], weight: dict[str, int], most: float
    ) -> list[tuple[Selection, float]]:
        """Of each test file what takes so long; first what is cheap and near."""
        found = []
        for file, names in tests.items():
            chosen: list[str] = []
            total = OPENING
            for name in _one_of_each_first(names, self.seconds[file]):
                cost = self.seconds[file][name]
                if not chosen or total + cost <= most:
                    chosen.append(name)
                    total += cost
            found.append((Selection(file, tuple(chosen)), total))
        return sorted(
            found, key=lambda pair: pair[1] / (1 + weight.get(pair[0].file, 0))
        )

    def _lines(self, file: Path) -> dict[str, dict[int, set[str]]]:
        """Test file -> line of the source as it is now -> tests that pass it."""
        if file not in self._tests_of:
            found = {}
            for test, data in self._data.items():
                contexts = data.contexts_by_lineno(f"alpha5_model/{file.as_posix()}")
                old = self._sources[test].get(file.as_posix(), "")
                now = _now(self._text(old), self.texts[file]) if contexts else {}
                by_line = {
                    now[line]: {name for name in names if name}
                    for line, names in contexts.items()
                    if line in now and any(names)
                }
                if by_line:
                    found[test] = by_line
            self._tests_of[file] = found
        return self._tests_of[file]

    def _path(self, test: str, ending: str) -> Path:
        return self.folder / f"{Path(test).stem}.{ending}"

    def _read(self, test: str) -> bool:
        path = self._path(test, "json")
        if not path.exists():
            return False
        record = json.loads(path.read_text(encoding="utf-8"))
        if record["test"] != _digest_of(test):
            return False
        self.seconds[test] = record["seconds"]
        self._sources[test] = record["sources"]
        data = coverage.CoverageData(str(self._path(test, "coverage")))
        data.read()
        self._data[test] = data
        return True

    def _keep_sources(self) -> dict[str, str]:
        digests = {}
        for file, text in self.texts.items():
            digest = _digest(text)
            digests[file.as_posix()] = digest
            (self.folder / f"{digest}.txt").write_text(text, encoding="utf-8")
        return digests

    def _text(self, digest: str) -> str:
        return (self.folder / f"{digest}.txt").read_text(encoding="utf-8")


def home_of(room_: str) -> str:
    """The folder of tests that mirrors a room."""
    return f"tests/{HOMES.get(room_, room_)}/"


def tests_of(room_: str) -> list[str]:
    """The test files that judge the mutants of a room at first."""
    if room_ == C_ROOM:
        return list(C_TESTS)
    home = home_of(room_)
    return [f for f in test_files() if f.startswith(home) or f in OF_IMPORTS]


def test_files() -> list[str]:
    """All that a mutant may be judged by."""
    return [
        file.relative_to(REPOSITORY).as_posix()
        for file in sorted((REPOSITORY / "tests").rglob("test_*.py"))
        if not file.name.startswith(NOT_RUN)
    ]


def _of_statement(text: str, line: int, own: dict[str, dict[int, set[str]]]) -> Tests:
    """The tests that pass the statement around a line of a file.

    Of a statement that an import runs, those that pass its readers, too.

    Args:
        text: Of the file.
        line: Of the file.
        own: Test file -> line of the file -> tests that pass it.
    """
    lines = {*statement(text, line), *readers(text, line)}
    return {test: _tests(by_line, lines) for test, by_line in own.items()}


def _tests(by_line: dict[int, set[str]], lines: Iterable[int]) -> set[str]:
    return {name for line in lines for name in by_line.get(line, ())}


def _one_of_each_first(names: set[str], seconds: dict[str, float]) -> list[str]:
    """Cheapest first, but one case of each test function before all others."""
    rank: dict[str, int] = defaultdict(int)
    ordered = []
    for name in sorted(names, key=lambda n: (seconds[n], n)):
        function = name.partition("[")[0]
        ordered.append((rank[function], seconds[name], name))
        rank[function] += 1
    return [name for _, _, name in sorted(ordered)]


@cache
def _now(old: str, new: str) -> dict[int, int]:
    """Line of the old text -> the same line of the new one."""
    matcher = difflib.SequenceMatcher(None, old.splitlines(), new.splitlines(), False)
    return {
        block.a + k + 1: block.b + k + 1
        for block in matcher.get_matching_blocks()
        for k in range(block.size)
    }


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _digest_of(test: str) -> str:
    return _digest((REPOSITORY / test).read_text(encoding="utf-8"))
