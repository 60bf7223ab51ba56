"""Files are written whole or not at all, pipes as they are, and inputs never."""

from __future__ import annotations

import os
import random
import shutil
import socket
import stat
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import Any

import command_parsers
import numpy as np
import pytest

import alpha5_model as a5
from alpha5_model._support.files import read_named, standard_stream
from alpha5_model._support.outputs import check_outputs, output_format
from alpha5_model._support.writing import atomic_write, atomic_write_all
from alpha5_model.cli import COMMANDS as COMMAND_NAMES
from alpha5_model.cli import main
from alpha5_model.errors import (
    FileFormatError,
    InputError,
    OutputError,
    UnknownNameError,
)

ROOT = Path(__file__).resolve().parents[2]
linux = pytest.mark.skipif(not Path("/proc/self/fd").is_dir(), reason="Linux only")
as_root = pytest.mark.skipif(
    not hasattr(os, "geteuid") or os.geteuid() != 0,
    reason="only root may make devices or be nobody",
)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def shell(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A command of bash in a folder, with ``alpha5`` defined."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    before = f'alpha5() {{ "{sys.executable}" -m alpha5_model "$@"; }}; '
    return subprocess.run(
        ["bash", "-c", before + command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )


@linux
@pytest.mark.parametrize("name", ["", ".csv", ".parquet", ".urdf", ".toml"])
def test_an_endless_device_is_refused(tmp_path: Path, name: str) -> None:
    """A link in somebody's archive may lead there."""
    link = tmp_path / f"file{name}"
    link.symlink_to("/dev/zero")
    readers: dict[str, Any] = {
        ".urdf": a5.compare,
        ".toml": lambda path: a5.sweep(path, tmp_path / "out"),
    }
    read = readers.get(name, a5.trajectory.read_motion)
    with pytest.raises(FileFormatError, match="is a device, a "):
        read(link)


@linux
def test_a_pipe_is_read_whole(tmp_path: Path, motion_file: Path) -> None:
    expected = a5.trajectory.read_motion(motion_file).position
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    content = motion_file.read_bytes()
    writer = threading.Thread(target=pipe.write_bytes, args=(content,))
    writer.start()
    found = a5.trajectory.read_motion(pipe).position
    writer.join()
    assert np.array_equal(found, expected)


@pytest.fixture
def motion_file(tmp_path: Path) -> Path:
    time = np.arange(0, 2, 0.05)
    rows = np.column_stack([time, *(1.5 + 0.1 * np.sin(time + k) for k in range(4))])
    path = tmp_path / "motion.csv"
    header = "time,axis_e,axis_d,axis_c,axis_b"
    path.write_text(
        "\n".join([header, *(",".join(map(repr, row.tolist())) for row in rows)])
    )
    return path


def test_symlinks_are_written_through_to_their_target(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    for name in ("old", "dangling"):
        (tmp_path / name).symlink_to(f"second_{name}")
        (tmp_path / f"second_{name}").symlink_to(tmp_path / "there" / name)
    (tmp_path / "there" / "old").write_text("before")
    (tmp_path / "folder").symlink_to("made")  # a folder that is not there yet
    for name in ("old", "dangling", "folder/file"):
        atomic_write(tmp_path / name, f"new {name}")
    for name in ("old", "dangling"):
        assert (tmp_path / name).is_symlink()
        assert (tmp_path / f"second_{name}").is_symlink()
        assert (tmp_path / "there" / name).read_text() == f"new {name}"
    assert (tmp_path / "made" / "file").read_text() == "new folder/file"
    assert names(tmp_path / "there") == ["dangling", "old"]


def test_a_file_keeps_its_mode_and_a_new_one_obeys_the_umask(tmp_path: Path) -> None:
    old = tmp_path / "old"
    new = tmp_path / "new"
    old.write_text("before")
    for mode in (0o600, 0o640, 0o755):
        old.chmod(mode)
        atomic_write(old, "after")
        assert stat.S_IMODE(old.stat().st_mode) == mode
    before = os.umask(0o027)
    try:
        atomic_write(new, "after")
    finally:
        os.umask(before)
    assert stat.S_IMODE(new.stat().st_mode) == 0o640


def test_pipes_are_written_into(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    got = []
    os.mkfifo(pipe)
    reader = threading.Thread(target=lambda: got.append(pipe.read_bytes()))
    reader.start()
    atomic_write_all({pipe: "through\n" * 20_000, tmp_path / "plain": "beside"})
    reader.join(timeout=20)
    assert got == [b"through\n" * 20_000]
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert names(tmp_path) == ["pipe", "plain"]


def test_a_pipe_whose_reader_leaves_is_one_error(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)

    def read_a_little() -> None:
        with pipe.open("rb") as stream:
            stream.read(1)

    reader = threading.Thread(target=read_a_little)
    reader.start()
    with pytest.raises(OutputError, match="Broken pipe"):
        atomic_write_all({tmp_path / "plain": "kept out", pipe: b"x" * 5_000_000})
    reader.join(timeout=20)
    assert names(tmp_path) == ["pipe"]


@pytest.mark.slow
@as_root
@linux
def test_devices_are_written_into(tmp_path: Path) -> None:
    """The devices are made here, so that a failure cannot harm the machine's."""
    try:
        for name, minor in (("null", 3), ("full", 7)):
            os.mknod(tmp_path / name, stat.S_IFCHR | 0o666, os.makedev(1, minor))
        (tmp_path / "null").write_bytes(b"")
    except OSError as error:
        pytest.skip(f"no devices here: {error}")
    (tmp_path / "link.html").symlink_to("null")
    for name in ("null", "link.html"):
        atomic_write(tmp_path / name, "gone")
        assert main(["generate", "sdf", "--output", str(tmp_path / name)]) == 0
    with pytest.raises(OutputError, match="No space left"):
        atomic_write_all(
            {tmp_path / "plain": "kept out", tmp_path / "full": "x" * 100_000}
        )
    assert main(["planar", "2", "1", "--plot", str(tmp_path / "full")]) == 2
    assert main(["generate", "urdf", "--output", str(tmp_path / "null")]) == 0
    for name in ("null", "full"):
        assert stat.S_ISCHR((tmp_path / name).stat().st_mode)
    assert (tmp_path / "link.html").is_symlink()
    assert names(tmp_path) == ["full", "link.html", "null"]


def test_folders_sockets_loops_and_impossible_paths_are_refused(tmp_path: Path) -> None:
    (tmp_path / "loop").symlink_to("pool")
    (tmp_path / "pool").symlink_to("loop")
    (tmp_path / "file").write_text("mine")
    (tmp_path / "to_folder").symlink_to(tmp_path)
    with socket.socket(socket.AF_UNIX) as listener:
        here = Path.cwd()
        os.chdir(tmp_path)  # a socket's path may have about 100 characters only
        try:
            listener.bind("socket")
        finally:
            os.chdir(here)
        before = names(tmp_path)
        for path, words in (
            ("", "it is a folder"),
            ("to_folder", "it is a folder"),
            ("socket", "it is a socket"),
            ("loop", "symbolic links"),
            ("loop/below", "symbolic links"),
            ("file/below", "a part of its path is a file"),
            ("a\0b", "null"),
            ("x" * 5000, "name too long"),
            ("x" * 256, "name too long"),
            ("/proc/nowhere/file", "cannot write"),
        ):
            with pytest.raises(OutputError, match=words) as caught:
                atomic_write(tmp_path / path, "new")
            assert "\n" not in str(caught.value)
            with pytest.raises(OutputError):
                atomic_write_all({tmp_path / "other": "new", tmp_path / path: "new"})
        assert names(tmp_path) == before
    assert (tmp_path / "file").read_text() == "mine"
    atomic_write(tmp_path / ("y" * 255), "the longest name there is")
    with pytest.raises(OutputError, match="surrogates"):
        atomic_write(tmp_path / "text", "\udcff")


def test_a_file_that_cannot_be_replaced_is_one_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stuck = tmp_path / "stuck"
    stuck.write_text("before")

    def fail(self: Path, target: Path) -> Path:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(OutputError, match="stuck: Operation not permitted"):
        atomic_write_all({stuck: "after", tmp_path / "other": "new"})
    assert names(tmp_path) == ["stuck"]
    assert stuck.read_text() == "before"


def test_nothing_is_replaced_if_one_file_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "old").write_text("before")
    (tmp_path / "file").write_text("mine")
    files = {tmp_path / "old": "after", tmp_path / "file" / "below": "new"}
    with pytest.raises(OutputError, match="a part of its path is a file"):
        atomic_write_all(files)
    assert names(tmp_path) == ["file", "old"]
    assert (tmp_path / "old").read_text() == "before"


def test_two_names_of_one_file_are_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("file")
    with pytest.raises(OutputError, match="another name"):
        atomic_write_all({tmp_path / "file": "one", tmp_path / "link": "two"})
    assert names(tmp_path) == ["link"]


@as_root
def test_what_is_read_only_stays(tmp_path: Path) -> None:
    """The command runs as nobody, since root may write everywhere."""
    code = (
        "import sys; from alpha5_model._support.writing import atomic_write\n"
        "from alpha5_model.errors import OutputError\n"
        "import os; os.setuid(65534)\n"
        "for path in sys.argv[1:]:\n"
        "    try: atomic_write(path, 'new')\n"
        "    except OutputError as error: print(error)\n"
    )
    closed = tmp_path / "closed"
    open_ = tmp_path / "open"
    for folder, mode in ((closed, 0o555), (open_, 0o777)):
        folder.mkdir()
        (folder / "file").write_text("mine")
        (folder / "file").chmod(0o444)
        folder.chmod(mode)
    for parent in tmp_path.parents[: len(tmp_path.parents) - 1]:
        if not parent.stat().st_mode & 0o001:
            # Only the user may enter the folders that pytest makes.
            parent.chmod(parent.stat().st_mode | 0o011)
    tmp_path.chmod(0o755)
    paths = [closed / "file", closed / "new", open_ / "file", open_ / "new"]
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, paths)],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert done.stdout.splitlines() == [
        f"cannot write {closed / 'file'}: it is read-only",
        f"cannot write {closed / 'new'}: Permission denied",
        f"cannot write {open_ / 'file'}: it is read-only",
    ]
    assert (closed / "file").read_text() == (open_ / "file").read_text() == "mine"
    assert names(closed) == ["file"]
    assert (open_ / "new").read_text() == "new"


def test_two_file_systems(tmp_path: Path) -> None:
    shared = Path("/dev/shm")
    if not shared.is_dir() or shared.stat().st_dev == tmp_path.stat().st_dev:
        pytest.skip("one file system only")
    folder = shared / f"alpha5-test-{os.getpid()}"
    folder.mkdir()
    try:
        (folder / "old").write_text("old")
        for name in ("old", "new"):
            (tmp_path / name).symlink_to(folder / name)
        atomic_write_all({tmp_path / n: n for n in ("old", "new", "here")})
        assert [(folder / n).read_text() for n in names(folder)] == ["new", "old"]
        assert (tmp_path / "new").is_symlink()
        assert names(tmp_path) == ["here", "new", "old"]
    finally:
        shutil.rmtree(folder)


@pytest.mark.slow
@linux
def test_standard_output_by_any_name(motion_file: Path) -> None:
    """A table or picture is alone on standard output; the rest is on standard error."""
    folder = motion_file.parent
    output = str(folder / "table.csv")
    assert main(["trajectory", str(motion_file), "--output", output]) == 0
    table = (folder / "table.csv").read_text("utf-8")
    done = shell("alpha5 trajectory motion.csv -o -", folder)
    assert (done.returncode, done.stdout) == (0, table)
    assert "TCP: path" in done.stderr
    done = shell(
        "echo first > out; alpha5 trajectory motion.csv -o /dev/stdout >> out", folder
    )
    assert (folder / "out").read_text() == "first\n" + table
    done = shell("alpha5 trajectory motion.csv -o /dev/fd/5 5> five", folder)
    assert (folder / "five").read_text() == table
    assert "TCP: path" in done.stdout
    done = shell("alpha5 planar 2 1 --plot /dev/fd/1 | head -c 4 | tail -c 3", folder)
    assert (done.stdout, "Error" in done.stderr) == ("PNG", False)
    done = shell("alpha5 generate urdf --output -", folder)
    assert done.stdout.startswith("<?xml")
    assert done.stdout.endswith("</robot>\n")
    assert not {"meshes", "-"} & set(names(folder))


@pytest.mark.slow
@linux
def test_a_reader_that_leaves_is_no_error(motion_file: Path) -> None:
    commands = (
        "trajectory motion.csv -o -",
        "trajectory motion.csv --json",
        "generate urdf",
        "workspace",
    )
    for command, reader in zip(
        commands, ("head -n 1", "true", "head -n 1", "true"), strict=True
    ):
        done = shell(
            f"set -o pipefail; alpha5 {command} | {reader}", motion_file.parent
        )
        assert done.returncode == 0
        assert not {"Traceback", "Error", "alpha5:"} & set(done.stderr.split())


def test_the_largest_file_is_read_and_the_next_is_not(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"x" * 2048)
    assert read_named(path, "a file", 2048) == read_named(path, "a file")
    path.write_bytes(b"x" * 2049)
    with pytest.raises(FileFormatError, match="more than 2 KiB, a file is expected"):
        read_named(path, "a file", 2048)


@pytest.mark.usefixtures("capfd")
def test_the_streams_are_told_apart(tmp_path: Path) -> None:
    """Both are files here, each of its own."""
    assert [standard_stream(os.fstat(number)) for number in (1, 2)] == [1, 2]
    (tmp_path / "file").write_text("neither")
    assert standard_stream((tmp_path / "file").stat()) is None


# --- no command writes over what it reads ---------------------------------------------

#: Command, its input {}, its outputs: option -> suffix. All paths of all commands.
COMMANDS = {
    "trajectory": (["trajectory", "{}"], {"--output": ".csv", "--plot": ".png"}),
    "view": (
        ["view", "--motion", "{}"],
        {"--html": ".html", "--image": ".png", "--video": ".mp4"},
    ),
    "compare": (["compare", "{}"], {"--plot": ".png", "--write-arm": ".toml"}),
    "check": (["check", "{}"], {}),
    "dh": (["dh", "--urdf", "{}"], {}),
    "arm": (["arm", "check", "{}"], {}),  # new never writes over a file
    "generate": (["generate", "urdf", "--arm", "{}"], {"--output": ".urdf"}),
    "demo": (["demo"], {}),  # its folder is not read
    "sweep": (["sweep", "{}"], {}),  # a folder is written
    "planar": (["planar", "2", "1"], {"--plot": ".png"}),
    "workspace": (["workspace", "--arm", "{}"], {"--plot": ".png"}),
    "torque": (
        [
            "torque",
            "--arm",
            "{}",
            "--q",
            "3",
            "1",
            "1",
            "0",
            "--water-velocity",
            "1 0 0",
        ],
        {"--plot": ".png"},
    ),
    "ik": (["ik", "0.2", "0", "0.1", "--arm", "{}"], {}),
    "move": (
        ["move", "home", "reach", "--obstacles", "{}"],
        {"--output": ".csv", "--bus": ".csv"},
    ),
    "jaws": (["jaws", "--arm", "{}"], {}),
    "park": (
        ["park", "0.4", "0", "0.1", "--hull", "{}"],
        {"--output": ".csv", "--plot": ".png", "--html": ".html"},
    ),
    "calibrate": (["calibrate", "fit", "{}"], {"--output": ".toml"}),
    "fk": (["fk", "3", "1", "1", "0", "--arm", "{}"], {}),
    "gains": (
        ["gains", "--rate", "200", "--delay", "0", "--arm", "{}"],
        {"--ros2-control": ".yaml"},
    ),
}


def test_no_command_has_a_path_that_is_not_tested_here() -> None:
    read = {
        "file",
        "files",
        "hull",
        "motion",
        "other",
        "urdf",
        "study",
        "arm",
        "obstacles",
        "through",
        "vehicle",
    }
    for command in COMMAND_NAMES:
        parsers = command_parsers.leaves(command).values()
        options = [option for one in parsers for option in command_parsers.options(one)]
        paths = {option.dest for option in options if option.type is Path}
        words, outputs = COMMANDS.get(command, ([], {}))
        known = {option.lstrip("-").replace("-", "_") for option in outputs} | read
        folder = {"output"} if command in ("demo", "sweep") else set()
        if command == "gains":
            folder = {"mjcf"}
        assert paths <= known | folder, command
        assert bool(paths) == (command in COMMANDS)
        assert bool(paths & read) == ("{}" in words)


def spoiling() -> list[tuple[str, str, str]]:
    return [
        (command, option, way)
        for command, (words, outputs) in COMMANDS.items()
        if "{}" in words
        for option in outputs
        for way in ("itself", "around", "symlink", "hard link", "link to link")
    ]


@pytest.mark.parametrize(("command", "option", "way"), spoiling())
def test_no_command_writes_over_its_input(
    command: str,
    option: str,
    way: str,
    motion_file: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    words, outputs = COMMANDS[command]
    source = motion_file.with_name(f"input{outputs[option]}")
    content = motion_file.read_bytes()
    if command == "compare":
        content = Path(a5.URDF_PATH).read_bytes()
    source.write_bytes(content)
    target = source.with_name(f"target{outputs[option]}")
    if way == "itself":
        target = source
    elif way == "around":
        target = source.parent / ".." / source.parent.name / source.name
    elif way == "hard link":
        os.link(source, target)
    else:
        (source.parent / "middle").symlink_to(source.name)
        target.symlink_to("middle" if way == "link to link" else source)
    arguments = [word.format(source) for word in words]
    assert main([*arguments, option, str(target)]) == 2
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert "another file than the one that is read" in err
    assert source.read_bytes() == content


@pytest.mark.parametrize("command", COMMANDS)
def test_nothing_is_written_into_a_file_of_another_kind(
    command: str, motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words, outputs = COMMANDS[command]
    mine = motion_file.with_name("mine.urdf")
    mine.write_bytes(Path(a5.URDF_PATH).read_bytes())
    source = motion_file if command in ("trajectory", "view") else mine
    arguments = [word.format(source) for word in words]
    for option, right in outputs.items():
        for suffix in {".png", ".csv", ".html", ".urdf", ".txt", ".PY"} - {right}:
            target = motion_file.with_name(f"mine{suffix}")
            before = target.read_bytes() if target.exists() else None
            assert main([*arguments, option, str(target)]) == 2
            out, err = capsys.readouterr()
            assert (out, err.count("\n")) == ("", 1)
            assert f"choose from {right}" in err
            assert (target.read_bytes() if target.exists() else None) == before


def test_two_outputs_are_two_files(
    motion_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (motion_file.parent / "arm.png").symlink_to("arm.html")
    (motion_file.parent / "arm.html").write_text("mine")
    view = ["view", "--html", str(motion_file.parent / "arm.html"), "--image"]
    for image in (str(motion_file.parent / "arm.png"), "-"):
        pair = (
            [*view, image] if image != "-" else ["view", "--html", "-", "--image", "-"]
        )
        assert main(pair) == 2
        assert "another file than --html" in capsys.readouterr().err
    assert (motion_file.parent / "arm.html").read_text() == "mine"
    assert main(["demo", "--output", "-"]) == 2
    assert "it is no folder" in capsys.readouterr().err


def test_formats_and_outputs_from_python(tmp_path: Path) -> None:
    assert output_format("x", tmp_path / "A.PNG", (".pdf", ".png")) == ".png"
    assert output_format("x", "-", (".pdf", ".png")) == ".pdf"
    with pytest.raises(UnknownNameError, match=r"unknown x ''; choose from \.pdf"):
        output_format("x", tmp_path / "none", (".pdf",))
    check_outputs(
        [None, tmp_path / "a"], out=(None, ()), other=(tmp_path / "b.c", (".c",))
    )
    with pytest.raises(InputError, match="other: expected another file than --out"):
        check_outputs(
            (), out=(tmp_path / "b.c", (".c",)), other=(tmp_path / "b.c", (".c",))
        )


PARTS_OF_PATHS = (
    "folder",
    "file",
    "link",
    "loop",
    "out",
    "pipe",
    ".",
    "..",
    "",
    "~",
    "-",
    "a b",
    "ä",
    "\n",
    "\0",
    "x" * 300,
    "%s",
    "{}",
    "*",
    "\udc80",
    "file.csv",
    " ",
)


def random_path_within(folder: Path, rng: random.Random) -> Path:
    """A path of one to four random parts that stays within a folder."""
    drawn = "/".join(rng.choice(PARTS_OF_PATHS) for _ in range(rng.randint(1, 4)))
    # Not folder / drawn, which is at the root if drawn begins with "/".
    path = Path(f"{folder}/w/{drawn}")
    outside = not str(os.path.normpath(path)).startswith(f"{folder}/w")
    if ".." in path.parts and outside:
        below = "/".join(path.parts[len(folder.parts) + 1 :])
        path = folder / below.replace("..", ".")
    return path


@pytest.mark.slow
def test_any_path_ends_in_a_file_or_in_one_error(tmp_path: Path) -> None:
    """Random paths are written or refused; what is no plain file stays what it is."""
    rng = random.Random(7)
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("x")
    os.mkfifo(tmp_path / "pipe")
    # With the pipe open for reading, no writer waits for a reader.
    holder = os.open(tmp_path / "pipe", os.O_RDWR)
    for name, to in (("link", "folder"), ("loop", "loop"), ("out", "folder/made")):
        (tmp_path / name).symlink_to(to)
    kinds = {
        "folder": stat.S_IFDIR,
        "pipe": stat.S_IFIFO,
        "link": stat.S_IFLNK,
        "loop": stat.S_IFLNK,
    }
    written = 0
    for _ in range(1500):
        path = random_path_within(tmp_path, rng)
        with suppress(OutputError):
            atomic_write(path, "0123456789")
            written += 1
            # For realpath, "file/.." is the folder and not an error.
            real = Path(os.path.realpath(path))
            assert real.is_fifo() or real.read_text("utf-8") == "0123456789"
        for name, kind in kinds.items():
            assert stat.S_IFMT((tmp_path / name).lstat().st_mode) == kind
        assert path.is_relative_to(tmp_path)
    os.close(holder)
    assert written > 100
    assert not list(tmp_path.rglob(".alpha5-*"))
