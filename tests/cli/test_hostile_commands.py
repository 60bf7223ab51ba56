"""The command line runs no code of hostile files, reads no other file and is quick.

Each input has a process of its own (`hostile_runner`), whose audit hooks report
programs, connections and files. The files that must not be read are pipes: a process
that opens one, in any language, waits until it is ended.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import hostile_files as files
import pytest

from alpha5_model._support.text import printable

#: Promised for each 100 kB of input, and for less [s].
PROMISED = 2.0
#: What no input of this size may take [bytes].
MEMORY = 500_000_000
NAME = "xcanaryx"
WORD = "XYZZY-4711"
RUNNER = Path(__file__).parents[1] / "support" / "hostile_runner.py"
#: Control characters, which a terminal obeys.
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
#: A plain colour does no harm.
COLOUR = re.compile(r"\x1b\[(0|3[0-7])m")
#: Hundreds of processes.
pytestmark = pytest.mark.slow
COMMANDS_OF_URDFS = (
    ("compare", "--samples", "3"),
    ("dh", "--urdf"),
    ("check",),
)


@dataclass(frozen=True)
class Place:
    """Folders with files that must not be read, and a file that must not be made."""

    work: Path
    secret: Path
    canary: Path

    @classmethod
    def made(cls, folder: Path) -> Place:
        work = folder / "work"
        outside = folder / "outside"
        for place in (work, outside):
            place.mkdir()
            for suffix in ("", ".mcap", ".db3", ".yaml"):
                os.mkfifo(place / f"{NAME}{suffix}")
        (work / "package.xml").write_text("<package><name>pkg</name></package>")
        return cls(work=work, secret=outside / NAME, canary=work / f"{NAME}-made")

    def written(self, kind: str, name: str, text: str, suffix: str) -> Path:
        """The path of a hostile text, in which the words for names are replaced."""
        for word, value in (
            ("SECRET_NAME", NAME),
            ("CANARY_NAME", self.canary.name),
            ("SECRET", str(self.secret)),
            ("CANARY", str(self.canary)),
        ):
            text = text.replace(word, value)
        path = self.work / f"{kind}_{name.replace(' ', '_')}{suffix}"
        path.write_text(text, encoding="utf-8", errors="surrogatepass", newline="")
        return path

    def case(self, path: Path, *words: str) -> dict[str, Any]:
        """Words of the command line, working directory and size of the input."""
        size = sum(p.stat().st_size for p in [path, *path.rglob("*")] if p.is_file())
        args = [words[0], str(path.relative_to(self.work)), *words[1:]]
        if words[-1].startswith("--urdf"):
            args = [*words, str(path.relative_to(self.work))]
        return {"args": args, "folder": str(self.work), "size": size}


def cases(folder: Path) -> dict[str, dict[str, Any]]:
    """Name -> words of the command line, working directory and size of the input."""
    place = Place.made(folder)
    return {
        **cases_of_models(place),
        **cases_of_recordings(place),
        **cases_of_studies(place),
    }


def cases_of_models(place: Place) -> dict[str, dict[str, Any]]:
    found = {}
    for name, text in files.URDFS.items():
        path = place.written("urdf", name, text, ".urdf")
        for words in COMMANDS_OF_URDFS:
            found[f"{words[0]} urdf: {name}"] = place.case(path, *words)
    for name, text in files.XACROS.items():
        path = place.written("xacro", name, text, ".urdf.xacro")
        found[f"compare xacro: {name}"] = place.case(path, "compare")
    return found


def cases_of_recordings(place: Place) -> dict[str, dict[str, Any]]:
    found = {}
    for name, text in files.RECORDINGS.items():
        path = place.written("csv", name, text, ".csv")
        found[f"trajectory csv: {name}"] = place.case(path, "trajectory")
    for name, path in files.bags(place.work, place.secret, place.canary).items():
        found[f"trajectory bag: {name}"] = place.case(path, "trajectory")
    return found


def cases_of_studies(place: Place) -> dict[str, dict[str, Any]]:
    found = {}
    for name, text in files.STUDIES.items():
        path = place.written("study", name, text, ".toml")
        words = ("sweep", "--output", f"swept_{path.stem}")
        found[f"sweep: {name}"] = place.case(path, *words)
    return found


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """Name -> what the process did, with the size of its input."""
    folder = tmp_path_factory.mktemp("hostile")
    given = cases(folder)
    words = folder / "cases.json"
    found = folder / "results.json"
    words.write_text(json.dumps(given), encoding="utf-8")
    environment = os.environ | {
        "ALPHA5_TEST_SECRET": WORD,
        "OMP_NUM_THREADS": "1",
        "COLUMNS": "100",
    }
    command = [sys.executable, str(RUNNER), str(words), str(found)]
    done = subprocess.run(
        command, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    answers = json.loads(found.read_text("utf-8"))
    assert {*answers} == {*given}
    for name, answer in answers.items():
        answer["size"] = given[name]["size"]
    answers["made"] = [str(path) for path in folder.rglob(f"{NAME}-made*")]
    return answers


def told(results: dict[str, Any], wrong: Any) -> dict[str, Any]:
    """Name -> what is wrong with an answer, for all wrong answers."""
    every = {name: wrong(answer) for name, answer in results.items() if name != "made"}
    return {name: what for name, what in every.items() if what}


def test_there_are_many_of_each_kind(results):
    kinds = [name.partition(":")[0] for name in results]
    counts = {kind: kinds.count(kind) for kind in {*kinds}}
    assert counts["compare urdf"] > 40
    assert min(counts[kind] for kind in counts if kind != "made") > 10


def test_no_code_runs_and_no_other_file_is_read(results):
    assert told(results, lambda answer: answer["misdeeds"]) == {}
    assert results["made"] == []


def test_no_secret_is_told(results):
    assert told(results, lambda answer: WORD in answer["out"] + answer["err"]) == {}


def test_each_ends_with_an_answer_or_one_line(results):
    def wrong(answer: dict[str, Any]) -> str:
        out = answer["out"]
        err = answer["err"]
        status = answer["status"]
        lines = [x for x in err.splitlines() if not x.startswith("alpha5: warning: ")]
        if status not in (0, 1, 2):
            return f"status {status}: {err[-300:]}"
        if "Traceback" in out + err:
            return err[-300:]
        if status == 2 and (
            len(lines) != 1 or not lines[0].startswith("alpha5: ") or out
        ):
            return f"not one line: {err[:300]}"
        return (
            ""
            if status == 2 or (out and not lines)
            else f"status {status}: {err[:300]}"
        )

    assert told(results, wrong) == {}


def test_what_has_no_answer_is_refused(results):
    commands = [name for name in results if not name.startswith(("check", "made"))]
    answered = {name for name in commands if results[name]["status"] != 2}
    assert {
        name for name in answered if name.partition(": ")[2] not in files.ANSWERED
    } == set()


def test_a_name_is_just_a_name(results):
    """A name that looks like a program is in the answer as it is, or not at all."""
    for name in files.PROGRAMS:
        assert results[f"compare urdf: program {name}"]["status"] in (0, 1, 2)
    assert results["compare urdf: mesh package"]["status"] == 0


def test_none_takes_long_or_much(results):
    def slow(answer: dict[str, Any]) -> str:
        allowed = PROMISED * max(1.0, answer["size"] / 1e5)
        took = answer["seconds"]
        return f"{took:.1f} s for {answer['size']} bytes" if took > allowed else ""

    def large(answer: dict[str, Any]) -> str:
        return f"{answer['memory'] / 1e6:.0f} MB" if answer["memory"] > MEMORY else ""

    assert told(results, slow) == {}
    assert told(results, large) == {}


def test_nothing_is_printed_that_a_terminal_obeys(results):
    def wrong(answer: dict[str, Any]) -> str:
        found = CONTROL.search(COLOUR.sub("", answer["out"] + answer["err"]))
        return repr(found[0]) if found else ""

    assert told(results, wrong) == {}


def test_control_characters_are_written_out():
    coloured = "\x1b[32magrees\x1b[0m"
    assert printable(f"{coloured} a\tb\n") == f"{coloured} a\tb\n"
    assert printable("\x1b[8mx\x1b]0;t\x07\x9b\u202e\0") == (
        r"\x1b[8mx\x1b]0;t\x07\x9b\u202e\x00"
    )


def test_the_runner_sees_what_is_forbidden(tmp_path):
    """A xacro file that is expanded on request runs a program, and the runner sees it.

    So the tests above can fail.
    """
    mark = tmp_path / f"{NAME}-made"
    program = files.PROGRAMS["subclasses"].replace("CANARY", str(mark))
    text = f'<robot name="x" {files.SPACE}><link name="{program}"/></robot>'
    (tmp_path / "arm.xacro").write_text(text)
    case = {"args": ["compare", "--xacro", "arm.xacro"], "folder": str(tmp_path)}
    (tmp_path / "cases.json").write_text(json.dumps({"xacro": case}))
    words = [str(tmp_path / name) for name in ("cases.json", "results.json")]
    subprocess.run(
        [sys.executable, str(RUNNER), *words], check=True, capture_output=True
    )
    answer = json.loads((tmp_path / "results.json").read_text())["xacro"]
    assert any(misdeed.startswith("os.system") for misdeed in answer["misdeeds"])
    assert mark.exists()


def test_the_program_itself_answers_in_one_line(tmp_path):
    """Without the runner: a process as a user starts it."""
    mark = tmp_path / "made"
    text = files.URDFS["program subclasses"].replace("CANARY", str(mark))
    (tmp_path / "arm.urdf").write_text(text)
    (tmp_path / "arm.xacro").write_text(text)
    for name in ("arm.urdf", "arm.xacro"):
        command = [sys.executable, "-m", "alpha5_model", "compare", name]
        done = subprocess.run(
            command, cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode in (1, 2)
        assert len(done.stderr.splitlines()) == (done.returncode == 2)
        assert not mark.exists()
