"""A copy of the checkout, and tests that run there in a forked child."""

from __future__ import annotations

import itertools
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import sysconfig
import time
import traceback
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import coverage
import pytest
from mutating.mutants import REPOSITORY, Mutant, is_c
from mutating.statuses import INVALID, KILLED, SURVIVED, TIMEOUT, UNTESTED

#: Imported before the forks. The package is not: each child imports its own.
WARM = (
    "casadi",
    "coal",
    "matplotlib.pyplot",
    "mujoco",
    "numpy",
    "pinocchio",
    "rich.console",
    "scipy.interpolate",
    "scipy.optimize",
    "scipy.spatial.transform",
    "trimesh",
    "typer",
    "xacro",
)
#: A mutant may take so many times the processor time of its tests ...
SLOWER = 3.0
#: ... and so much more [s].
GRACE = 30.0
#: If it waits for something: so many times that by the clock.
CLOCK = 6.0
#: Tests of the sources' text, which any change of them fails.
NOT_ASKED = ("test_the_module_was_compiled_of_these_sources",)
#: Optimisation takes three times as long; the results have the same bits without it.
C_FLAGS = ("-O0", "-ffp-contract=off", "-fno-math-errno", "-Wno-psabi")
_FAILED = 1
_CANNOT_COMPILE = 90
_NO_TEST = 91
_BROKEN = 99
_dates = itertools.count(1_000_000_000)


@dataclass(frozen=True)
class Selection:
    """Tests of one file; without names, all."""

    file: str
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Job:
    """What a child does: run tests with a mutant, or without one and watched.

    Attributes:
        mutant: None: the lines that each test passes are recorded.
        selections: The tests, file by file.
        seconds: Processor time of the tests without a mutant.
    """

    mutant: Mutant | None
    selections: tuple[Selection, ...]
    seconds: float

    @property
    def limit(self) -> float:
        """Processor time after which the child is stopped [s]."""
        return GRACE + SLOWER * self.seconds


@dataclass(frozen=True)
class Outcome:
    """How a job ended, after how much processor time [s], and the failed test."""

    status: str
    seconds: float
    test: str = ""


class Sandbox:
    """A copy of the checkout in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.checkout = folder / "checkout"
        self.output = folder / "output"
        self.failed = folder / "failed"
        listed = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=REPOSITORY,
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        names = [REPOSITORY / name for name in listed.split("\0") if name]
        for path in [
            *names,
            *REPOSITORY.glob("alpha5_model/codegen/kernels/_compiled.*.so"),
        ]:
            if path.is_file():
                copy = self.checkout / path.relative_to(REPOSITORY)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, copy)
        beside = REPOSITORY.parent / "shared"
        if beside.exists():
            (folder / "shared").symlink_to(beside.resolve())
        subprocess.run(["git", "init", "-q"], cwd=self.checkout, check=True)
        self.package = self.checkout / "alpha5_model"
        kernels = (self.package / "codegen" / "kernels").glob("_compiled.*.so")
        self.module = next(
            kernels, self.package / "codegen" / "kernels" / "_compiled.abi3.so"
        )
        self.compiled = self.module.read_bytes() if self.module.exists() else None

    def write(self, file: Path, text: str) -> None:
        """With a date of its own, by which Python knows what it compiled before."""
        path = self.package / file
        path.write_text(text, encoding="utf-8")
        date = next(_dates)
        os.utime(path, (date, date))

    def compile(self) -> bool:
        """Put the kernels as they are in the copy; whether a compiler takes them."""
        import numpy

        sys.path.insert(0, str(self.checkout))
        digest = import_module("hatch_build").digest()
        source = self.package / "codegen" / "kernels" / "_compiled.c"
        command = [
            "cc",
            "-shared",
            "-fPIC",
            *C_FLAGS,
            f'-DSOURCES="{digest}"',
            f"-I{numpy.get_include()}",
            f"-I{sysconfig.get_path('include')}",
            str(source),
            "-o",
            str(self.module),
            "-lm",
        ]
        self.module.unlink(missing_ok=True)
        return subprocess.run(command, check=False).returncode == 0

    def restore(self, file: Path, text: str) -> None:
        """Take a mutant back, and what was compiled of it."""
        self.write(file, text)
        if is_c(file) and self.compiled is not None:
            self.module.unlink(missing_ok=True)
            self.module.write_bytes(self.compiled)

    def record(self) -> Path:
        """Where a child that is watched leaves what its tests passed."""
        return self.folder / "coverage"

    def times(self) -> Path:
        """Where it leaves the processor time of each test."""
        return self.folder / "times.json"


class Chosen:
    """Plugin of pytest: only the tests of these names, in their order."""

    def __init__(self, names: Sequence[str], failed: Path) -> None:
        self.order = {name: k for k, name in enumerate(names)}
        self.failed = failed
        self.count = 0

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        kept = [item for item in items if item.originalname not in NOT_ASKED]
        if self.order:
            kept = [item for item in kept if item.nodeid in self.order]
            kept.sort(key=lambda item: self.order[item.nodeid])
        items[:] = kept
        self.count = len(kept)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.failed:
            self.failed.write_text(report.nodeid, encoding="utf-8")

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            self.failed.write_text(f"{report.nodeid} (import)", encoding="utf-8")


class Watch:
    """Plugin of pytest: which test passes which line, and the time that it takes."""

    def __init__(self, measure: coverage.Coverage) -> None:
        self.measure = measure
        self.seconds: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: Any) -> Any:
        self.measure.switch_context(item.nodeid)
        start = time.process_time()
        try:
            return (yield)
        finally:
            self.seconds[item.nodeid] = time.process_time() - start
            self.measure.switch_context("")


def warm() -> None:
    """Import what all children need, where it is installed."""
    for name in WARM:
        try:
            import_module(name)
        except ImportError:
            print(f"{name} is not installed: its tests are slower or left out")


def run(
    jobs: Iterable[Job],
    boxes: Sequence[Sandbox],
    texts: dict[Path, str],
    done: Callable[[Job, Outcome, Sandbox], None],
) -> None:
    """One child at a time in each sandbox; ``done`` hears of each job as it ends."""
    waiting = iter(jobs)
    free = list(boxes)
    busy: dict[int, tuple[Job, Sandbox, float]] = {}
    while True:
        while free and (job := next(waiting, None)) is not None:
            box = free.pop()
            busy[_start(job, box)] = (job, box, time.monotonic())
        if not busy:
            return
        time.sleep(0.02)
        for child, (job, box, start) in list(busy.items()):
            outcome = _ended(child, job, box, start)
            if outcome is not None:
                del busy[child]
                if job.mutant is not None:
                    box.restore(job.mutant.file, texts[job.mutant.file])
                free.append(box)
                done(job, outcome, box)


def _start(job: Job, box: Sandbox) -> int:
    box.failed.unlink(missing_ok=True)
    if job.mutant is not None:
        box.write(job.mutant.file, job.mutant.text)
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        status = _BROKEN
        try:
            status = _tests(job, box)
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
    return child


def _ended(child: int, job: Job, box: Sandbox, start: float) -> Outcome | None:
    ended, status, used = os.wait4(child, os.WNOHANG)
    late = time.monotonic() - start > CLOCK * job.limit
    if not ended and not late:
        return None
    if not ended:
        os.killpg(child, signal.SIGKILL)
        _, _, used = os.wait4(child, 0)
        return Outcome(TIMEOUT, used.ru_utime + used.ru_stime)
    code = os.waitstatus_to_exitcode(status)
    known = {
        0: SURVIVED,
        _CANNOT_COMPILE: INVALID,
        _NO_TEST: UNTESTED,
        -signal.SIGXCPU: TIMEOUT,
        -signal.SIGKILL: TIMEOUT,
    }
    test = box.failed.read_text("utf-8") if box.failed.exists() else f"exit {code}"
    status_text = known.get(code, KILLED)
    seconds = used.ru_utime + used.ru_stime
    return Outcome(status_text, seconds, test if status_text == KILLED else "")


def _tests(job: Job, box: Sandbox) -> int:
    """In the child: run the tests in the copy until one fails."""
    _isolate(job, box)
    if job.mutant is not None and is_c(job.mutant.file):
        # A module that cannot be imported fails the tests, which else would skip.
        os.environ["ALPHA5_REQUIRE_KERNELS"] = "1"
        if not box.compile():
            return _CANNOT_COMPILE
    if job.mutant is None:
        return _watched(job, box)
    count = 0
    for selection in job.selections:
        chosen = Chosen(selection.names, box.failed)
        status = _pytest(selection.file, [chosen])
        count += chosen.count
        # 5: no test is left of the file.
        if status not in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED):
            return _FAILED
    return 0 if count else _NO_TEST


def _watched(job: Job, box: Sandbox) -> int:
    (selection,) = job.selections
    box.record().unlink(missing_ok=True)
    measure = coverage.Coverage(
        box.record(), source=[str(box.package)], config_file=False
    )
    measure.set_option("run:relative_files", True)
    watch = Watch(measure)
    measure.start()
    status = _pytest(selection.file, [watch, Chosen((), box.failed)])
    measure.stop()
    measure.save()
    box.times().write_text(json.dumps(watch.seconds), encoding="utf-8")
    return int(status)


def _pytest(file: str, plugins: list[Any]) -> int:
    # A second run in one process finds the plugins imported.
    twice = "ignore::pytest.PytestAssertRewriteWarning"
    options = ["-x", "-q", "-p", "no:cacheprovider", "-W", twice, file]
    return int(pytest.main(options, plugins=plugins))


def _isolate(job: Job, box: Sandbox) -> None:
    os.setsid()
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC
    os.dup2(os.open(box.output, flags), 1)
    os.dup2(1, 2)
    limit = round(job.limit)
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    os.chdir(box.checkout)
    os.environ.update(
        OMP_NUM_THREADS="1",
        OPENBLAS_NUM_THREADS="1",
        PYTHONPATH=str(box.checkout),
        MPLBACKEND="agg",
    )
    # Else a process that a test spawns would import the script that forked this one.
    main = sys.modules["__main__"]
    main.__spec__ = None
    main.__dict__.pop("__file__", None)
    own = (REPOSITORY, REPOSITORY / "scripts")
    others = [path for path in sys.path if Path(path).resolve() not in own]
    sys.path[:] = [str(box.checkout), *others]
