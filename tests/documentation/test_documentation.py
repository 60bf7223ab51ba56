"""Every code block of README and the documentation runs, with every public name.

The blocks of a page run one after the other, in one folder and with one set of names,
as a reader would type them. A block in C is written to the file that its first line
names.
"""

from __future__ import annotations

import ast
import inspect
import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pages import DOCS, PAGES, REPOSITORY, blocks
from shared_recordings import RECORDINGS

import alpha5_model as a5
from alpha5_model.cli import COMMANDS, main
from alpha5_model.cli.program import parser_of
from alpha5_model.numbers import arm_schema as schema

#: Languages of blocks that hold nothing to run.
SHOWN = {"", "text", "toctree", "include", "literalinclude", "eval-rst", "xml", "yaml"}
#: Commands of our own that take long: tests of their own run them.
LONG = (
    r"alpha5 sweep .* --workers",
    r"alpha5 calibrate (fit|motors)",
    r"alpha5 demo",
    r"alpha5 check$",
    r"alpha5 workspace --self-collision",
)
#: Commands of other programs, which are not here.
ELSEWHERE = {"git", "cd", "source", "colcon", "conda", "ros2", "gz"}
#: Packages of the conformance run: blocks that import them run where they are.
TOOLS = {"pydrake", "pybullet", "isaaclab"}


def run_shell(text: str) -> None:
    """Run the lines of a block that call ``alpha5``; check other programs' words."""
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(line, comments=True)
        if not words:
            continue
        expected = re.search(r"# exit status (\d)$", line)
        if words[0] == "cc" or words[0].startswith("./"):
            if shutil.which("cc"):
                subprocess.run(words, check=True)
        elif words[0] == "alpha5":
            if not any(re.match(command, line) for command in LONG):
                assert main(words[1:]) == int(expected[1] if expected else 0), line
        else:
            assert known(words), line


def known(words: list[str]) -> bool:
    """Whether a command that is not run names what is there."""
    if words[0] == "make":
        return f"\n{words[1]}:" in (REPOSITORY / "Makefile").read_text("utf-8")
    if words[:3] == ["python", "-m", "pip"]:
        extras = re.findall(r"\w+", "".join(re.findall(r"\[(.+?)\]", " ".join(words))))
        project = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))[
            "project"
        ]
        return set(extras) <= set(project["optional-dependencies"])
    if words[0] == "python":
        return (REPOSITORY / words[1]).is_file()
    return words[0] in ELSEWHERE


def run_page(page: Path) -> int:
    """Run the blocks of a page in the current folder; returns how many ran."""
    names, ran = {"__name__": "__main__"}, 0
    for block in blocks(page.read_text("utf-8")):
        if block.language == "sh":
            run_shell(block.text)
        elif block.language == "c":
            Path(block.text.split()[1].rstrip(":")).write_text(block.text, "utf-8")
        elif block.language == "python":
            tree = ast.parse(block.text)
            ast.increment_lineno(tree, block.line)
            try:
                exec(compile(tree, str(page), "exec"), names)
            except ModuleNotFoundError as error:
                if error.name not in TOOLS:
                    raise
        else:
            assert block.language in SHOWN, f"{page}:{block.line}: {block.language!r}"
            continue
        ran += 1
    return ran


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", PAGES, ids=lambda page: str(page.relative_to(REPOSITORY))
)
def test_the_code_of_a_page_runs(
    page: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    run_page(page)


@pytest.mark.parametrize(
    "text",
    [
        "```python\nassert False\n```\n",
        "```sh\nalpha5 ik 9 9 9\n```\n",
        "```sh\nmake tea\n```\n",
        "```sh\npython -m pip install '.[tea]'\n```\n",
        "```sh\nrm -rf x\n```\n",
        pytest.param(
            "```c\n/* wrong.c: no program */\nint main(void) { return 1; }\n```\n"
            "```sh\ncc wrong.c -o wrong\n./wrong\n```\n",
            marks=pytest.mark.tools,
        ),
        "```pyhton\n1\n```\n",
        "```python\nimport no_such_tool\n```\n",
    ],
)
def test_a_block_that_does_not_run_is_seen(
    text: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    page = tmp_path / "page.md"
    page.write_text(text, "utf-8")
    monkeypatch.chdir(tmp_path)
    if "cc " in text and not shutil.which("cc"):
        pytest.skip("no C compiler")
    with pytest.raises(
        (AssertionError, ModuleNotFoundError, subprocess.CalledProcessError)
    ):
        run_page(page)


def files_of_a_reader() -> None:
    """What the examples of the help ask for, into the current folder."""
    time = np.linspace(0, 2, 101)
    q = a5.named_pose("home") + 0.1 * np.sin(time)[:, None]
    head = ",".join(["time_secs", *(f"axis_{x}_pos" for x in "edcb")])
    shutil.copy(REPOSITORY / "examples" / "mount_map.toml", "study.toml")
    np.savetxt(
        "recording.csv",
        np.column_stack([time, q]),
        delimiter=",",
        header=head,
        comments="",
    )
    for name, xyz in (("hull", [-0.3, 0.0, 0.2]), ("wall", [0.9, 0.0, 0.0])):
        text = f"[{name}]\nbox = [0.1, 1.0, 0.3]\nxyz = {xyz}\n"
        Path(f"{name}.toml").write_text(text, "utf-8")
    ours = Path(a5.URDF_PATH).read_text("utf-8")
    Path("my_arm.urdf").write_text(ours, "utf-8")
    for number, axis in enumerate("edcb", 1):
        ours = ours.replace(f'"axis_{axis}"', f'"j{number}"')
    Path("other.urdf").write_text(ours, "utf-8")


@pytest.mark.slow
def test_the_examples_of_the_help_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    files_of_a_reader()
    for name in COMMANDS:
        lines = re.findall(
            r"^(?:Example: )?(alpha5 .*)", parser_of(name).description, re.M
        )
        assert lines, name
        for line in lines:
            run_shell(line)


@pytest.mark.slow
def test_the_table_of_public_models_is_what_compare_finds(tmp_path: Path) -> None:
    from robots import public_models

    models = RECORDINGS / "models"
    if not models.is_dir():
        pytest.skip("no public models beside the checkout")
    page, copy = DOCS / "public-models.md", tmp_path / "page.md"
    copy.write_text(page.read_text("utf-8").replace("0.", "9."), "utf-8")
    assert public_models.main([str(models), "--page", str(copy)]) == 0
    between = re.compile(r"(?s)(?<=models: begin -->).*(?=<!-- public models: end)")
    assert (
        between.search(copy.read_text("utf-8"))[0]
        == between.search(page.read_text("utf-8"))[0]
    )


# --- nothing is left out --------------------------------------------------------------


def test_every_public_name_has_its_place_in_the_api_pages() -> None:
    text = "\n".join(page.read_text("utf-8") for page in (DOCS / "api").glob("*.md"))
    named = {
        name.rpartition(".")[2]
        for name in re.findall(r"^\.\. auto\w+:: (\S+)", text, re.M)
    }
    modules = set(re.findall(r"^\.\. automodule:: alpha5_model\.(\S+)", text, re.M))
    # A module has its own page, or each of its names has its own place.
    places = {
        name: getattr(a5, name).__name__.removeprefix("alpha5_model.")
        for name in a5.__all__
        if inspect.ismodule(getattr(a5, name))
    }
    listed = {
        name
        for name, where in places.items()
        if where in modules or f":: alpha5_model.{where}." in text
    }
    names = {name for place in ("paths", "errors") for name in vars(getattr(a5, place))}
    assert set(a5.__all__) - named - listed - names == {"__version__"}


def test_every_key_of_arm_files_is_in_a_page() -> None:
    tables = [schema.MOUNT, schema.LENGTHS, schema.ATTACHED, schema.TOOL, schema.DRIVES]
    tables += [*schema.LINKS.values(), *schema.JOINT_LIMITS.values()]
    text = "".join(page.read_text("utf-8") for page in PAGES)
    keys = {key for table in tables for key in table}
    assert {key for key in keys if f"`{key}`" not in text} == set()
